/* tests/unit/test_read.c -- particles from files: CSV, plain HDF5, snapshots of ours. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "io/h5.h"
#include "io/snapshot.h"
#include "scene/read.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static char folder[] = "/tmp/sph-test-read-XXXXXX";
static char path[64];

static int make_folder(void **state)
{
    (void)state;
    if (!mkdtemp(folder))
        return -1;
    snprintf(path, sizeof path, "%s/file", folder);
    return 0;
}

static int remove_folder(void **state)
{
    (void)state;
    unlink(path);
    return rmdir(folder);
}

static int read_text(struct table *t, const char *text, struct error *e)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    memset(e, 0, sizeof *e);
    return table_read(t, path, NULL, e);
}

static void test_csv(void **state)
{
    struct table t;
    struct error e;
    (void)state;
    assert_int_equal(read_text(&t,
                               "\xef\xbb\xbf# made by hand\r\n x , \"y\",v.x\r\n\r\n1,2,-3e-1\r\n"
                               "# more\r\n4 ,5, 6\r\n",
                               &e),
                     0);
    assert_int_equal(t.n, 2);
    assert_int_equal(t.n_column, 3);
    assert_int_equal(table_find(&t, "y"), 1);
    assert_int_equal(table_find(&t, "v.x"), 2);
    assert_int_equal(table_find(&t, "v"), -1);
    assert_true(t.column[2].value[0] == -.3 && t.column[0].value[1] == 4);
    assert_false(t.snapshot);
    table_free(&t);
}

static void test_csv_wrong(void **state)
{
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"", "file: is empty"},
        {"# nothing\n", "file: is empty"},
        {"1,2\n3,4\n", "file:1:1: 1 is a number; a line of column names"},
        {"x,,y\n", "file:1:3: a column without a name"},
        {"x,y,x\n", "file:1:5: the column \"x\" stands there twice"},
        {"x,y\n1,2\n1\n", "file:3: 1 cell for 2 columns"},
        {"x,y\n1,2,3\n", "file:2:5: more cells than the 2 columns"},
        {"x,y\n1,abc\n", "file:2:3: \"abc\" in column \"y\" is not a number"},
        {"x,y\n1,\n", "file:2:3: \"\" in column \"y\" is not a number"},
        {"x,y\nnan,2\n", "file:2:1: \"nan\""},
        {"x,y\n1,2e999\n", "file:2:3: \"2e999\""},
        {"x,y\n1,2 3\n", "file:2:3: \"2 3\""},
        {"x,\xff\n", "not UTF-8"},
    };
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct table t;
        struct error e;
        if (read_text(&t, cases[i].text, &e) == 0)
            fail_msg("taken: %s", cases[i].text);
        assert_int_equal(e.exit_code, EXIT_USAGE);
        if (!strstr(e.text, cases[i].part))
            fail_msg("\"%s\" does not hold \"%s\"", e.text, cases[i].part);
    }
}

static void test_missing(void **state)
{
    struct table t;
    struct error e = {0};
    (void)state;
    assert_int_equal(table_read(&t, "/nowhere/file", NULL, &e), -1);
    assert_non_null(strstr(e.text, "/nowhere/file: cannot be read"));
    assert_int_equal(table_read(&t, folder, NULL, &e), -1);
    assert_non_null(strstr(e.text, "is a folder"));
    assert_int_equal(read_text(&t, "\211HDF\r\n\032\nnot really", &e), -1);
    assert_int_equal(e.exit_code, EXIT_USAGE);
    assert_int_equal(read_text(&t, "x\n1\n", &e), 0);
    table_free(&t);
    assert_int_equal(table_read(&t, path, "fluid", &e), -1);
    assert_non_null(strstr(e.text, "is no snapshot"));
}

static void write_set(hid_t file, const char *name, int rank, hsize_t rows, hsize_t columns,
                      const double *value)
{
    const hsize_t size[2] = {rows, columns};
    hid_t space = H5Screate_simple(rank, size, NULL);
    hid_t set =
        H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, value);
    H5Dclose(set);
    H5Sclose(space);
}

static void test_hdf5(void **state)
{
    static const double x[] = {1, 2, 3, 4, 5, 6}, rho[] = {7, 8};
    struct table t;
    struct error e = {0};
    (void)state;
    unlink(path);
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    write_set(file, "x", 2, 2, 3, x);
    write_set(file, "rho", 1, 2, 1, rho);
    write_set(file, "v", 2, 2, 2, x);
    H5Fclose(file);
    if (table_read(&t, path, NULL, &e) < 0)
        fail_msg("%s", e.text);
    assert_int_equal(t.n, 2);
    assert_int_equal(t.n_column, 6);
    assert_true(t.column[table_find(&t, "z")].value[1] == 6);
    assert_true(t.column[table_find(&t, "rho")].value[1] == 8);
    assert_true(t.column[table_find(&t, "v.y")].value[0] == 2);
    table_free(&t);

    file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    write_set(file, "u", 1, 3, 1, x);
    H5Fclose(file);
    assert_int_equal(table_read(&t, path, NULL, &e), -1);
    assert_non_null(strstr(e.text, "rows"));
}

static void test_snapshot(void **state)
{
    struct particles p[2];
    struct snapshot_meta meta = {
        .scene_path = "s.json", .scene_text = "{}", .title = "t", .units = "none", .version = "0"};
    struct table t;
    struct error e = {0};
    (void)state;
    for (int a = 0; a < 2; a++) {
        assert_int_equal(particles_init(&p[a], a ? "wall" : "fluid", 2, &e), 0);
        particles_add(&p[a], "x", "m", "", SPH_VECTOR, &e);
        particles_add(&p[a], a ? "q" : "rho", "", "", SPH_SCALAR, &e);
        for (size_t c = 0; c < p[a].n_column; c++)
            p[a].column[c].output = p[a].column[c].state = true;
        assert_int_equal(particles_resize(&p[a], 3, 0, &e), 0);
        for (size_t i = 0; i < 3; i++) {
            particles_real(&p[a], "x", 0)[i] = 10. * a + (double)i;
            particles_real(&p[a], a ? "q" : "rho", 0)[i] = 5;
        }
    }
    unlink(path);
    if (snapshot_write(path, p, 2, &meta, &e) < 0)
        fail_msg("%s", e.text);
    if (table_read(&t, path, "wall", &e) < 0)
        fail_msg("%s", e.text);
    assert_true(t.snapshot);
    assert_int_equal(t.n, 3);
    assert_true(t.column[table_find(&t, "x")].value[2] == 12);
    assert_true(t.column[table_find(&t, "q")].value[2] == 5);
    assert_int_equal(table_find(&t, "rho"), -1); /* the wall has none */
    table_free(&t);
    assert_int_equal(table_read(&t, path, NULL, &e), 0);
    assert_int_equal(t.n, 6);
    table_free(&t);
    assert_int_equal(table_read(&t, path, "wal", &e), -1);
    assert_non_null(strstr(e.text, "did you mean \"wall\"?"));
    particles_fini(&p[0]);
    particles_fini(&p[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_csv),      cmocka_unit_test(test_csv_wrong),
        cmocka_unit_test(test_missing),  cmocka_unit_test(test_hdf5),
        cmocka_unit_test(test_snapshot),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
