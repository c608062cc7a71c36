/* test_csv.c -- files of rows: written whole, gone on with, cut off, read back, a full disk. */
#include "config.h"

#include "io/csv.h"

#include "scratch.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

static void put_row(struct csv *c, uint64_t step, double time, double value)
{
    csv_count(c, step);
    csv_number(c, time);
    csv_number(c, value);
    csv_end_row(c);
}

static void put_head(struct csv *c)
{
    csv_name(c, "step");
    csv_name(c, "time");
    csv_name(c, "a, \"b\"");
    csv_end_row(c);
}

#define HEAD "step,time,\"a, \"\"b\"\"\"\n"

static void is_written_whole(void **state)
{
    const char *path = scratch_path(state, "a.csv");
    struct csv c;
    struct error e = {0};
    assert_int_equal(csv_open(&c, path, CSV_NEW, &e), 0);
    put_head(&c);
    put_row(&c, 0, 0.1, 1.0 / 3.0);
    char *text = scratch_read(path, NULL); /* nothing before it is committed */
    assert_string_equal(text, "");
    free(text);
    assert_int_equal(csv_commit(&c, &e), 0);
    put_row(&c, 7, 0.2, (double)-NAN);
    assert_int_equal(csv_commit(&c, &e), 0);
    assert_int_equal(c.rows, 3);
    assert_int_equal(csv_close(&c, &e), 0);
    assert_int_equal(csv_close(&c, &e), 0);
    text = scratch_read(path, NULL);
    assert_string_equal(text, HEAD "0,0.10000000000000001,0.33333333333333331\n"
                                   "7,0.20000000000000001,nan\n");
    free(text);
    assert_int_equal(csv_open(&c, path, CSV_NEW, &e), -1);
    assert_int_equal(e.exit_code, EXIT_USAGE);
    assert_non_null(strstr(e.text, "is not of an earlier run"));
}

static void is_cut_and_gone_on_with(void **state)
{
    const char *path = scratch_path(state, "a.csv");
    struct csv c;
    struct error e = {0};
    assert_int_equal(csv_cut_from(path, 3, &e), 0); /* not there */
    assert_int_equal(csv_open(&c, path, CSV_OVER, &e), 0);
    put_head(&c);
    for (uint64_t step = 0; step < 10; step += 2)
        for (int k = 0; k < 2; k++)
            put_row(&c, step, 0.5 * (double)step, k);
    fputs("10,3.", c.file); /* killed in the midst */
    assert_int_equal(csv_commit(&c, &e), 0);
    assert_int_equal(csv_close(&c, &e), 0);
    assert_int_equal(csv_cut_from(path, 100, &e), 0);
    assert_int_equal(csv_cut_from(path, 6, &e), 0);
    assert_int_equal(csv_cut_from(path, 5, &e), 0);
    assert_int_equal(csv_open(&c, path, CSV_GO_ON, &e), 0);
    assert_int_equal(c.rows, 7);
    assert_int_equal(csv_head(&c, HEAD, &e), 0);
    assert_int_equal(csv_head(&c, "step,time\n", &e), -1);
    assert_non_null(strstr(e.text, "other columns"));
    put_row(&c, 6, 3, 0);
    assert_int_equal(csv_commit(&c, &e), 0);
    assert_int_equal(c.rows, 8);
    assert_int_equal(csv_close(&c, &e), 0);
    char *text = scratch_read(path, NULL);
    assert_string_equal(text, HEAD "0,0,0\n0,0,1\n2,1,0\n2,1,1\n4,2,0\n4,2,1\n6,3,0\n");
    free(text);
}

static void is_read_back(void **state)
{
    static const char *const names[] = {"time", "value"}, *const wrong[] = {"time", "valu"};
    const char *path = scratch_path(state, "a.csv");
    struct csv c;
    struct error e = {0};
    double *value[2];
    size_t n;
    assert_int_equal(csv_open(&c, path, CSV_OVER, &e), 0);
    csv_name(&c, "step");
    csv_name(&c, "time");
    csv_name(&c, "value");
    csv_end_row(&c);
    for (uint64_t step = 0; step < 1000; step++)
        put_row(&c, step, (double)step / 3.0, step == 5 ? (double)NAN : sqrt((double)step));
    assert_int_equal(csv_close(&c, &e), 0);
    assert_int_equal(csv_read_two(path, names, value, &n, &e), 0);
    assert_int_equal(n, 1000);
    assert_true(isnan(value[1][5]));
    for (size_t i = 0; i < n; i++) {
        assert_true(!(value[0][i] < (double)i / 3.0 || value[0][i] > (double)i / 3.0));
        assert_true(i == 5 || !(value[1][i] < sqrt((double)i) || value[1][i] > sqrt((double)i)));
    }
    free(value[0]);
    free(value[1]);
    assert_int_equal(csv_read_two(path, wrong, value, &n, &e), -1);
    assert_non_null(strstr(e.text, "no column \"valu\""));
}

static void takes_back_what_is_not_whole(void **state)
{
    (void)state;
    struct csv c;
    struct error e = {0};
    if (csv_open(&c, "/dev/full", CSV_OVER, &e))
        skip();
    put_row(&c, 0, 0, 0);
    assert_int_equal(csv_commit(&c, &e), -1);
    assert_non_null(strstr(e.text, "/dev/full"));
    csv_close(&c, &e);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {TEST(is_written_whole), TEST(is_cut_and_gone_on_with),
                                       TEST(is_read_back), TEST(takes_back_what_is_not_whole)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
