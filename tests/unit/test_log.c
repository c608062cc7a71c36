/* test_log.c -- log.csv: its columns, its numbers, a full disk; the progress line. */
#include "config.h"

#include "io/log.h"

#include "scratch.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

static const char *const extra_name[] = {"rho.max", "a, \"b\""};
static const double extra[] = {16.5, 1.0 / 3.0};

static struct log_row row_of(uint64_t step)
{
    return (struct log_row){.step = step,
                            .time = 0.1,
                            .dt = 1e-3,
                            .kinetic = 0.5,
                            .internal = (double)NAN,
                            .momentum = {1, 2, 3},
                            .angular = {4, 5, 6},
                            .mass = 7,
                            .extra_name = extra_name,
                            .extra = extra,
                            .n_extra = 2,
                            .wall = 1.25};
}

static void has_rows(void **state)
{
    static const char *const header[] = {
        "step,time,dt,kinetic,internal,potential,momentum_x,mass,rho.max,\"a, \"\"b\"\"\",wall_s\n",
        "step,time,dt,kinetic,internal,potential,momentum_x,momentum_y,angular_z,mass,rho.max,"
        "\"a, \"\"b\"\"\",wall_s\n",
        "step,time,dt,kinetic,internal,potential,momentum_x,momentum_y,momentum_z,angular_x,"
        "angular_y,angular_z,mass,rho.max,\"a, \"\"b\"\"\",wall_s\n"};
    const char *path = scratch_path(state, "log.csv");
    for (int dim = 1; dim <= 3; dim++) {
        struct log l;
        struct error e = {0};
        const struct log_row first = row_of(0), second = row_of(10);
        assert_int_equal(log_open(&l, path, dim, &e), 0);
        assert_int_equal(log_write(&l, &first, &e), 0);
        char *early = scratch_read(path, NULL); /* it grows by the row */
        assert_non_null(strstr(early, "\n0,"));
        free(early);
        assert_int_equal(log_write(&l, &second, &e), 0);
        assert_int_equal(log_close(&l, &e), 0);
        assert_int_equal(log_close(&l, &e), 0);
        char *text = scratch_read(path, NULL);
        assert_int_equal(strncmp(text, header[dim - 1], strlen(header[dim - 1])), 0);
        if (dim == 2)
            assert_string_equal(text + strlen(header[1]),
                                "0,0.10000000000000001,0.001,0.5,nan,0,1,2,6,7,16.5,"
                                "0.33333333333333331,1.250\n"
                                "10,0.10000000000000001,0.001,0.5,nan,0,1,2,6,7,16.5,"
                                "0.33333333333333331,1.250\n");
        free(text);
    }
}

static void tells_of_a_full_disk(void **state)
{
    struct log l;
    struct error e = {0};
    struct log_row row = row_of(0);
    assert_int_equal(log_open(&l, "/dev/full", 2, &e), 0);
    assert_int_equal(log_write(&l, &row, &e), -1);
    assert_int_equal(e.exit_code, EXIT_RUN);
    assert_non_null(strstr(e.text, "/dev/full: No space"));
    log_close(&l, &e);

    const char *path = scratch_path(state, "log.csv");
    uint64_t rows = 0;
    assert_int_equal(log_open(&l, path, 2, &e), 0);
    scratch_limit(1000);
    while (rows < 100 && log_write(&l, &row, &e) == 0)
        row.step = ++rows;
    scratch_limit(0);
    assert_in_range(rows, 5, 20);
    char *text = scratch_read(path, NULL);
    assert_int_equal(text[strlen(text) - 1], '\n'); /* whole rows only */
    free(text);
    /* There is room again: it goes on where it was. */
    assert_int_equal(log_write(&l, &row, &e), 0);
    assert_int_equal(log_close(&l, &e), 0);
    text = scratch_read(path, NULL);
    char last[32];
    snprintf(last, sizeof last, "\n%d,", (int)rows);
    assert_non_null(strstr(text, last));
    uint64_t lines = 0;
    for (const char *c = text; *c; c++)
        lines += *c == '\n';
    assert_int_equal(lines, rows + 2);
    free(text);
    assert_int_equal(log_open(&l, scratch_path(state, "no/such/log.csv"), 2, &e), -1);
}

static void shows_progress(void **state)
{
    (void)state;
    char line[80];
    struct progress p = {.begin = 0, .end = 2};
    progress_line(line, sizeof line, &p, 120, 0.5, 1.25e-3, 2.1e-5, 100);
    assert_string_equal(
        line, " 25 %  step 120  t 0.5  dt 1.25e-03  energy drift 2.1e-05  ETA 5 min 00 s");
    p.end = INFINITY;
    progress_line(line, sizeof line, &p, 120, 0.5, 1.25e-3, (double)NAN, 100);
    assert_non_null(strstr(line, "ETA ?"));
    p.end = 1e9;
    progress_line(line, sizeof line, &p, UINT64_MAX, 1e-300, 1e-300, 1e-300, 1e300);
    assert_in_range(strlen(line), 10, 79);
    progress_start(&p, false, 0, 1);
    assert_false(p.on);
    progress_show(&p, 1, 0.5, 0.1, 0);
    progress_end(&p);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        TEST(has_rows),
        TEST(tells_of_a_full_disk),
        TEST(shows_progress),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
