/* test_output.c -- the output folder: claimed once, cleared of our own files only, never half
 * written. */
#include "config.h"

#include "io/output.h"

#include "scratch.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

static void claims_once(void **state)
{
    struct output a, b;
    struct error e = {0};
    char pid[32];
    const char *dir = scratch_path(state, "deep/er/out");
    assert_int_equal(output_open(&a, dir, &e), 0);
    assert_int_equal(output_open(&b, dir, &e), -1);
    assert_int_equal(e.exit_code, EXIT_USAGE);
    snprintf(pid, sizeof pid, "process %ld", (long)getpid());
    assert_non_null(strstr(e.text, "in use"));
    assert_non_null(strstr(e.text, pid));
    output_close(&b); /* harmless */
    output_close(&a);
    assert_false(scratch_exists(scratch_path(state, "deep/er/out/.sph-lock")));
    assert_int_equal(output_open(&b, dir, &e), 0);
    output_close(&b);
}

static void refuses_what_is_no_folder(void **state)
{
    struct output o;
    struct error e = {0};
    scratch_write(scratch_path(state, "file"), "x", 1);
    assert_int_equal(output_open(&o, scratch_path(state, "file"), &e), -1);
    assert_non_null(strstr(e.text, "not a folder"));
    assert_int_equal(output_open(&o, scratch_path(state, "file/in"), &e), -1);
    assert_int_equal(output_open(&o, "", &e), -1);
    assert_int_equal(output_open(&o, "/proc/no/such", &e), -1);
    assert_int_equal(e.exit_code, EXIT_USAGE);
}

static void clears_its_own(void **state)
{
    static const char png[] = "\x89PNG\r\n\x1a\n....IHDR.................tEXt"
                              "Software\0sph....";
    static const char other_png[] = "\x89PNG\r\n\x1a\n....IHDR.................tEXtSoftware\0xyz";
    static const struct {
        const char *name, *text;
        size_t n;
        bool ours;
    } file[] = {
        {"snapshot_0000.vtkhdf", "x", 1, true},
        {"snapshot_12345.vtkhdf", "x", 1, true},
        {"log.csv", "step,time,dt,kinetic\n", 21, true},
        {"summary.json", "{\n\t\"status\":\t\"done\"}", 20, true},
        {"density.png", png, sizeof png, true},
        {".sph-aside-summary.json", "{", 1, true},
        {"photo.png", other_png, sizeof other_png, false},
        {"snapshot_0000.vtkhdf.bak", "x", 1, false},
        {"snapshot_.vtkhdf", "x", 1, false},
        {"checkpoint_00000010.h5", "x", 1, true},
        {"checkpoint_123456789.h5", "x", 1, true},
        {"checkpoint_0001.h5", "x", 1, false},
        {"notes.txt", "x", 1, false},
    };
    struct output o;
    struct error e = {0};
    for (size_t i = 0; i < sizeof file / sizeof file[0]; i++)
        scratch_write(scratch_path(state, file[i].name), file[i].text, file[i].n);
    assert_int_equal(output_open(&o, scratch_path(state, ""), &e), 0);
    for (size_t i = 0; i < sizeof file / sizeof file[0]; i++)
        assert_int_equal(scratch_exists(scratch_path(state, file[i].name)), !file[i].ours);
    output_close(&o);
}

static void keeps_others(void **state)
{
    struct output o;
    struct error e = {0};
    scratch_write(scratch_path(state, "log.csv"), "date,money\n", 11);
    scratch_write(scratch_path(state, "snapshot_0000.vtkhdf"), "x", 1);
    assert_int_equal(output_open(&o, scratch_path(state, ""), &e), -1);
    assert_non_null(strstr(e.text, "log.csv"));
    assert_true(scratch_exists(scratch_path(state, "snapshot_0000.vtkhdf")));
    /* The claim is given back. */
    unlink(scratch_path(state, "log.csv"));
    assert_int_equal(output_claim(&o, scratch_path(state, ""), &e), 0);
    assert_true(scratch_exists(scratch_path(state, "snapshot_0000.vtkhdf")));
    output_close(&o);
}

static void writes_whole(void **state)
{
    struct output o;
    struct error e = {0};
    assert_int_equal(output_open(&o, scratch_path(state, "out"), &e), 0);
    assert_int_equal(output_write(&o, "summary.json", "one", 3, &e), 0);
    assert_int_equal(output_write(&o, "summary.json", "three", 5, &e), 0);
    char *text = scratch_read(scratch_path(state, "out/summary.json"), NULL);
    assert_string_equal(text, "three");
    free(text);

    char *temporary = output_begin(&o, "a.png"), *shown = output_shown(temporary);
    assert_string_equal(shown, scratch_path(state, "out/a.png"));
    free(shown);
    assert_int_equal(output_commit(&o, temporary, "a.png", &e), -1); /* nobody wrote it */
    scratch_write(temporary, "png", 3);
    assert_int_equal(output_commit(&o, temporary, "a.png", &e), 0);
    assert_false(scratch_exists(temporary));
    assert_true(scratch_exists(scratch_path(state, "out/a.png")));
    scratch_write(temporary, "png", 3);
    char *copy = strdup(temporary);
    output_drop(temporary);
    assert_false(scratch_exists(copy));
    free(copy);
    output_close(&o);
}

static void tells_of_a_full_disk(void **state)
{
    struct output o;
    struct error e = {0};
    char big[20000] = {0};
    assert_int_equal(output_open(&o, scratch_path(state, "out"), &e), 0);
    assert_int_equal(output_write(&o, "summary.json", "good", 4, &e), 0);
    scratch_limit(8192);
    const int result = output_write(&o, "summary.json", big, sizeof big, &e);
    scratch_limit(0);
    assert_int_equal(result, -1);
    assert_int_equal(e.exit_code, EXIT_RUN);
    assert_non_null(strstr(e.text, "out/summary.json"));
    assert_null(strstr(e.text, "aside"));
    assert_false(scratch_exists(scratch_path(state, "out/.sph-aside-summary.json")));
    char *text = scratch_read(scratch_path(state, "out/summary.json"), NULL);
    assert_string_equal(text, "good");
    free(text);
    output_close(&o);

    assert_int_equal(output_write_path("/dev/full", "x", 1, &e), -1);
    assert_non_null(strstr(e.text, "/dev/full: No space"));
    assert_true(scratch_exists("/dev/full"));
    assert_int_equal(output_write_path("/dev/null", "x", 1, &e), 0);
    assert_int_equal(output_write_path(scratch_path(state, "no/such"), "x", 1, &e), -1);
    assert_int_equal(output_write_path(scratch_path(state, "there"), "x", 1, &e), 0);
}

static void knows_names(void **state)
{
    (void)state;
    assert_true(output_is_snapshot("snapshot_0000.vtkhdf"));
    assert_true(output_is_snapshot("snapshot_10000.vtkhdf"));
    assert_false(output_is_snapshot("snapshot_0000.vtkhdf~"));
    assert_false(output_is_snapshot("snapshot_00a0.vtkhdf"));
    assert_false(output_is_snapshot("my_snapshot_0000.vtkhdf"));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        TEST(claims_once),    TEST(refuses_what_is_no_folder),
        TEST(clears_its_own), TEST(keeps_others),
        TEST(writes_whole),   TEST(tells_of_a_full_disk),
        TEST(knows_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
