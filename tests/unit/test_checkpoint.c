/* test_checkpoint.c -- the file of a checkpoint: blocks of every type come back as they were; sizes, missing
 * blocks, cut and changed files; which files are checkpoints, and which of them stay. */
#include "config.h"

#include "io/checkpoint.h"
#include "scratch.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define LARGE ((size_t)300000)

struct things {
    uint8_t u8[3];
    uint16_t u16[3];
    uint32_t u32[3];
    uint64_t u64[3];
    int32_t i32[3];
    int64_t i64[3];
    float f32[3];
    double f64[5];
    bool flag[3];
    size_t count, n, none;
    double *large;
    uint16_t *nothing;
    char *text, *empty, *no_text;
};

static int things_store(struct things *t, struct store *s, struct error *e)
{
    store_enter(s, "thing", 7);
    int status = store_block(s, "u8", STORE_U8, t->u8, 3, e) ||
                 store_block(s, "u16", STORE_U16, t->u16, 3, e) ||
                 store_block(s, "u32", STORE_U32, t->u32, 3, e) ||
                 store_block(s, "u64", STORE_U64, t->u64, 3, e);
    store_enter(s, "part", 0);
    status = status || store_block(s, "i32", STORE_I32, t->i32, 3, e) ||
             store_block(s, "i64", STORE_I64, t->i64, 3, e) ||
             store_block(s, "f32", STORE_F32, t->f32, 3, e) ||
             store_block(s, "f64", STORE_F64, t->f64, 5, e);
    store_leave(s);
    status = status || store_flags(s, "flag", t->flag, 3, e) ||
             store_count(s, "count", &t->count, e) ||
             store_array(s, "large", STORE_F64, &t->large, &t->n, 5, e) ||
             store_array(s, "nothing", STORE_U16, &t->nothing, &t->none, 5, e);
    store_leave(s);
    status = status || store_text(s, "text", &t->text, e) || store_text(s, "empty", &t->empty, e) ||
             store_text(s, "no_text", &t->no_text, e);
    return status ? -1 : 0;
}

static void things_free(struct things *t)
{
    free(t->large);
    free(t->nothing);
    free(t->text);
    free(t->empty);
    free(t->no_text);
}

static void write_things(const char *path)
{
    struct things t = {{0, 1, 255},
                       {0, 1, UINT16_MAX},
                       {0, 1, UINT32_MAX},
                       {0, 1, UINT64_MAX},
                       {INT32_MIN, 0, INT32_MAX},
                       {INT64_MIN, 0, INT64_MAX},
                       {-0.0f, FLT_MIN, FLT_MAX},
                       {-0.0, DBL_TRUE_MIN, NAN, -INFINITY, 0.1},
                       {true, false, true},
                       SIZE_MAX,
                       LARGE,
                       0,
                       calloc(LARGE, sizeof(double)),
                       NULL,
                       strdup("a text \xc3\xa4\n"),
                       strdup(""),
                       NULL};
    struct checkpoint c;
    struct error e = {0};
    for (size_t i = 0; i < LARGE; i++)
        t.large[i] = 1.0 / (double)(i + 1);
    if (checkpoint_create(&c, path, &e) ||
        checkpoint_finish(&c, things_store(&t, &c.store, &e), &e))
        fail_msg("%s", e.text);
    things_free(&t);
}

static void comes_back(void **state)
{
    const char *path = scratch_path(state, "checkpoint_00000001.h5");
    struct checkpoint c;
    struct error e = {0};
    struct things t = {0};
    write_things(path);
    if (checkpoint_open(&c, path, &e) || things_store(&t, &c.store, &e))
        fail_msg("%s", e.text);
    const double f64[] = {-0.0, DBL_TRUE_MIN, NAN, -INFINITY, 0.1};
    const float f32[] = {-0.0f, FLT_MIN, FLT_MAX};
    assert_memory_equal(t.u8, ((uint8_t[]){0, 1, 255}), 3);
    assert_memory_equal(t.u16, ((uint16_t[]){0, 1, UINT16_MAX}), 6);
    assert_memory_equal(t.u32, ((uint32_t[]){0, 1, UINT32_MAX}), 12);
    assert_memory_equal(t.u64, ((uint64_t[]){0, 1, UINT64_MAX}), 24);
    assert_memory_equal(t.i32, ((int32_t[]){INT32_MIN, 0, INT32_MAX}), 12);
    assert_memory_equal(t.i64, ((int64_t[]){INT64_MIN, 0, INT64_MAX}), 24);
    assert_memory_equal(t.f32, f32, sizeof f32);
    assert_memory_equal(t.f64, f64, sizeof f64);
    assert_true(t.flag[0] && !t.flag[1] && t.flag[2]);
    assert_true(t.count == SIZE_MAX && t.none == 0 && t.n == LARGE);
    for (size_t i = 0; i < LARGE; i++)
        assert_true(t.large[i] * (double)(i + 1) > 0.999);
    assert_string_equal(t.text, "a text \xc3\xa4\n");
    assert_string_equal(t.empty, "");
    assert_null(t.no_text);

    /* What is asked for is not what is there. */
    double two[2];
    assert_string_equal(c.store.group, "");
    assert_int_equal(store_block(&c.store, "thing7/part0/f64", STORE_F64, two, 2, &e), -1);
    assert_non_null(
        strstr(e.text, "is a broken checkpoint: thing7/part0/f64 has 5 elements, not 2"));
    assert_int_equal(store_block(&c.store, "thing8/u8", STORE_U8, two, 1, &e), -1);
    assert_non_null(strstr(e.text, "thing8/u8 is missing"));
    assert_int_equal(e.exit_code, EXIT_USAGE);
    assert_false(store_has(&c.store, "thing7/u9"));
    assert_true(store_has(&c.store, "thing7/u8"));
    things_free(&t);
    checkpoint_close(&c);
}

static bool opens(const char *path, const char *says)
{
    struct checkpoint c;
    struct error e = {0};
    if (checkpoint_open(&c, path, &e) == 0) {
        checkpoint_close(&c);
        return true;
    }
    assert_int_equal(e.exit_code, EXIT_USAGE);
    assert_null(strchr(e.text, '\n'));
    if (says && !strstr(e.text, says))
        fail_msg("\"%s\" is not in: %s", says, e.text);
    return false;
}

/* Every place of the large block is guarded, and cut files are told. */
static void is_guarded(void **state)
{
    const char *path = scratch_path(state, "good.h5"), *bad = scratch_path(state, "bad.h5");
    size_t n = 0, found = 0;
    write_things(path);
    char *data = scratch_read(path, &n);
    assert_true(opens(path, NULL));
    assert_true(n > LARGE * sizeof(double));
    for (size_t k = 1; k < 40; k++) {
        scratch_write(bad, data, n * k / 40);
        assert_false(opens(bad, NULL));
        data[n * k / 40] ^= 16;
        scratch_write(bad, data, n);
        found += !opens(bad, NULL);
        data[n * k / 40] ^= 16;
    }
    assert_true(found >= 38); /* one may hit what nobody reads */
    scratch_write(bad, "", 0);
    assert_false(opens(bad, "it is not an HDF5 file"));
    assert_false(opens(scratch_path(state, "none.h5"), "No such file"));
    free(data);
}

static void full_disk(void **state)
{
    struct error e = {0};
    struct checkpoint c;
    const char *path = scratch_path(state, "full.h5");
    double *large = calloc(LARGE, sizeof *large);
    size_t n = LARGE;
    scratch_limit(100000);
    assert_int_equal(checkpoint_create(&c, path, &e), 0);
    const int status = store_array(&c.store, "large", STORE_F64, &large, &n, 0, &e);
    assert_int_equal(checkpoint_finish(&c, status, &e), -1);
    scratch_limit(0);
    assert_int_equal(e.exit_code, EXIT_RUN);
    assert_non_null(strstr(e.text, "full.h5: File too large"));
    assert_false(scratch_exists(path));
    assert_int_equal(checkpoint_create(&c, "/proc/none.h5", &e), -1);
    free(large);
}

static void a_folder_of_them(void **state)
{
    static const struct {
        const char *name;
        long long step;
    } name[] = {{"checkpoint_00000010.h5", 10},
                {"checkpoint_00000000.h5", 0},
                {"checkpoint_123456789.h5", 123456789},
                {"checkpoint_000000010.h5", -1},
                {"checkpoint_0010.h5", -1},
                {"checkpoint_-0000010.h5", -1},
                {"checkpoint_00000010.h5.bak", -1},
                {".sph-aside-checkpoint_00000010.h5", -1},
                {"checkpoint_99999999999999999999999.h5", -1},
                {"snapshot_0000.vtkhdf", -1}};
    struct output o;
    struct error e = {0};
    long long *step;
    assert_int_equal(output_open(&o, scratch_path(state, "folder"), &e), 0);
    for (size_t k = 0; k < sizeof name / sizeof name[0]; k++) {
        char *path = output_path(&o, name[k].name);
        assert_int_equal(output_checkpoint_step(name[k].name), name[k].step);
        scratch_write(path, "x", 1);
        free(path);
    }
    assert_int_equal(checkpoint_list(o.dir, &step, &e), 3);
    assert_true(step[0] == 123456789 && step[1] == 10 && step[2] == 0);
    free(step);
    checkpoint_prune(&o, 2);
    assert_int_equal(checkpoint_list(o.dir, &step, &e), 2);
    free(step);
    checkpoint_prune(&o, 2);
    assert_false(scratch_exists(scratch_path(state, "folder/checkpoint_00000000.h5")));
    assert_true(scratch_exists(scratch_path(state, "folder/checkpoint_00000010.h5")));
    assert_true(scratch_exists(scratch_path(state, "folder/checkpoint_0010.h5")));
    /* A run that goes on from step 10 with its second snapshot. */
    assert_int_equal(output_cut(&o, 1, 10, &e), 0);
    assert_true(scratch_exists(scratch_path(state, "folder/checkpoint_00000010.h5")));
    assert_true(scratch_exists(scratch_path(state, "folder/snapshot_0000.vtkhdf")));
    assert_false(scratch_exists(scratch_path(state, "folder/checkpoint_123456789.h5")));
    assert_int_equal(output_cut(&o, 0, 9, &e), 0);
    assert_false(scratch_exists(scratch_path(state, "folder/checkpoint_00000010.h5")));
    assert_false(scratch_exists(scratch_path(state, "folder/snapshot_0000.vtkhdf")));
    output_close(&o);
    assert_int_equal(checkpoint_list(scratch_path(state, "none"), &step, &e), -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(comes_back, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(is_guarded, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(full_disk, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(a_folder_of_them, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests_name("checkpoint", tests, NULL, NULL);
}
