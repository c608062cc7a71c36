/* test_snapshot.c -- what is written is read back; a full disk leaves nothing; foreign and
 * damaged files are told of. tests/snapshot.py has h5py and VTK read the same files. */
#include "config.h"

#include "io/snapshot.h"

#include "scratch.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <hdf5.h>
#include <sys/wait.h>

#define N 70000 /* more than a slab */

static const struct snapshot_meta meta = {.scene_path = "scene.json",
                                          .scene_text = "{\"title\": \"Größe\"}",
                                          .title = "Größe",
                                          .units = "SI",
                                          .version = "0.1",
                                          .time = 0.1,
                                          .step = 812};

static void all_out(struct particles *p)
{
    for (size_t i = 0; i < p->n_column; i++)
        p->column[i].output = true;
}

/* "fluid" with columns of many types, and "wall" that lacks most. */
static void make(struct particles p[2], size_t n)
{
    struct error e = {0};
    assert_int_equal(particles_init(&p[0], "fluid", 2, &e), 0);
    assert_int_equal(particles_init(&p[1], "wall", 2, &e), 0);
    particles_add(&p[0], "x", "m", "position", SPH_VECTOR, &e);
    particles_add(&p[0], "v", "m/s", "velocity", SPH_VECTOR, &e);
    particles_add(&p[0], "s", "Pa", "stress", SPH_SYM, &e);
    particles_add(&p[0], "id", "", "number", SPH_INT64, &e);
    particles_add(&p[0], "kind", "", "number", SPH_INT32, &e);
    particles_add(&p[0], "hidden", "", "", SPH_SCALAR, &e);
    particles_add(&p[1], "rho", "kg/m^d", "density", SPH_SCALAR, &e);
    particles_add(&p[1], "x", "m", "position", SPH_VECTOR, &e);
    assert_int_equal(particles_resize(&p[0], n, 9, &e), 0);
    assert_int_equal(particles_resize(&p[1], 2, 0, &e), 0);
    all_out(&p[0]);
    all_out(&p[1]);
    p[0].column[particles_find(&p[0], "hidden")].output = false;
    for (size_t i = 0; i < n; i++) {
        for (uint32_t k = 0; k < 2; k++) {
            particles_real(&p[0], "x", k)[i] = (double)i + 0.25 * k;
            particles_real(&p[0], "v", k)[i] = -(double)i - 0.25 * k;
        }
        for (uint32_t k = 0; k < 3; k++)
            particles_real(&p[0], "s", k)[i] = 1e-3 * (double)i + k;
        ((int64_t *)p[0].column[particles_find(&p[0], "id")].data)[i] =
            (int64_t)1 << 40 | (int64_t)i;
        ((int32_t *)p[0].column[particles_find(&p[0], "kind")].data)[i] = (int32_t)(i % 3);
    }
    particles_real(&p[1], "rho", 0)[1] = 5;
    particles_real(&p[1], "x", 1)[1] = -3;
}

static void fini(struct particles p[2])
{
    particles_fini(&p[0]);
    particles_fini(&p[1]);
}

static void check_column(const struct snapshot *s, const char *name, uint32_t ncomp, size_t i,
                         double first)
{
    const struct snapshot_column *c = snapshot_find(s, name);
    assert_non_null(c);
    assert_int_equal(c->ncomp, ncomp);
    const double value = c->value[i * ncomp];
    assert_true(value == first || (isnan(value) && isnan(first)));
}

static void reads_back(void **state)
{
    struct particles p[2];
    struct error e = {0};
    struct snapshot s;
    const char *path = scratch_path(state, "a.vtkhdf");
    make(p, N);
    assert_int_equal(snapshot_write(path, p, 2, &meta, &e), 0);
    fini(p);
    assert_int_equal(snapshot_read(&s, path, &e), 0);
    assert_int_equal(s.dim, 2);
    assert_true(s.time == 0.1);
    assert_int_equal(s.step, 812);
    assert_string_equal(s.title, meta.title);
    assert_string_equal(s.units, meta.units);
    assert_string_equal(s.scene_text, meta.scene_text);
    assert_string_equal(s.x_unit, "m");
    assert_int_equal(s.n, N + 2);
    assert_int_equal(s.n_array, 2);
    assert_string_equal(s.array_name[1], "wall");
    assert_int_equal(s.array[N - 1], 0);
    assert_int_equal(s.array[N], 1);
    assert_true(s.x[3 * (N - 1)] == N - 1 && s.x[3 * (N - 1) + 1] == N - 1 + 0.25);
    assert_true(s.x[3 * (N + 1) + 1] == -3 && s.x[3 * (N + 1) + 2] == 0);
    assert_null(snapshot_find(&s, "hidden"));
    assert_null(snapshot_find(&s, "array"));
    assert_null(snapshot_find(&s, "x"));
    assert_int_equal(s.n_column, 5);
    const size_t at[] = {0, 1, 32767, 32768, 65535, 65536, N - 1};
    for (size_t k = 0; k < sizeof at / sizeof at[0]; k++) {
        const double i = (double)at[k];
        check_column(&s, "v", 3, at[k], -i);
        check_column(&s, "s", 3, at[k], 1e-3 * i);
        check_column(&s, "id", 1, at[k], 1099511627776.0 + i);
        check_column(&s, "kind", 1, at[k], fmod(i, 3));
        check_column(&s, "rho", 1, at[k], (double)NAN);
        assert_true(snapshot_find(&s, "s")->value[3 * at[k] + 2] == 1e-3 * i + 2);
        assert_true(snapshot_find(&s, "v")->value[3 * at[k] + 2] == 0);
    }
    check_column(&s, "rho", 1, N + 1, 5);
    check_column(&s, "v", 3, N, (double)NAN);
    check_column(&s, "id", 1, N, -1);
    check_column(&s, "kind", 1, N, -1);
    assert_string_equal(snapshot_find(&s, "rho")->unit, "kg/m^d");
    assert_string_equal(snapshot_find(&s, "rho")->doc, "density");
    snapshot_free(&s);
    snapshot_free(&s);
}

static void reads_back_nothing(void **state)
{
    struct particles p[2];
    struct error e = {0};
    struct snapshot s;
    make(p, 0);
    assert_int_equal(snapshot_write(scratch_path(state, "a"), p, 1, &meta, &e), 0);
    assert_int_equal(snapshot_read(&s, scratch_path(state, "a"), &e), 0);
    assert_int_equal(s.n, 0);
    assert_int_equal(s.n_column, 4);
    snapshot_free(&s);
    fini(p);
}

static void tells_of_a_full_disk(void **state)
{
    struct particles p[2];
    struct error e = {0};
    /* Of every length, so that every kind of write meets the end. */
    const rlim_t room[] = {1, 700, 3000, 10000, 40000, 100000, 500000};
    const char *path = scratch_path(state, ".sph-aside-a.vtkhdf");
    make(p, 10000);
    for (size_t i = 0; i < sizeof room / sizeof room[0]; i++) {
        scratch_limit(room[i]);
        const int result = snapshot_write(path, p, 2, &meta, &e);
        scratch_limit(0);
        assert_int_equal(result, -1);
        assert_int_equal(e.exit_code, EXIT_RUN);
        assert_non_null(strstr(e.text, "/a.vtkhdf: File too large"));
        assert_false(scratch_exists(path));
        assert_int_equal(H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL), 0);
    }
    assert_int_equal(snapshot_write("/dev/full", p, 2, &meta, &e), -1);
    assert_non_null(strstr(e.text, "/dev/full: No space"));
    assert_true(scratch_exists("/dev/full"));
    assert_int_equal(snapshot_write(scratch_path(state, "no/such"), p, 2, &meta, &e), -1);
    assert_int_equal(snapshot_write(path, p, 2, &meta, &e), 0);
    fini(p);
}

static void refuses_columns(void **state)
{
    struct particles p[2];
    struct error e = {0};
    const char *const bad[] = {"a/b", ".", "array"}, *path = scratch_path(state, "a");
    for (size_t i = 0; i < 3; i++) {
        make(p, 3);
        particles_add(&p[0], bad[i], "", "", SPH_SCALAR, &e);
        all_out(&p[0]);
        assert_int_equal(snapshot_write(path, p, 2, &meta, &e), -1);
        assert_non_null(strstr(e.text, bad[i]));
        fini(p);
    }
    make(p, 3);
    particles_add(&p[1], "v", "", "", SPH_SCALAR, &e);
    all_out(&p[1]);
    assert_int_equal(snapshot_write(path, p, 2, &meta, &e), -1);
    assert_non_null(strstr(e.text, "\"v\""));
    assert_false(scratch_exists(path));
    fini(p);
}

/* A file that says `what` is its points, made by hand. */
static void write_foreign(const char *path, int rank, hsize_t n, hsize_t ncomp, hid_t type)
{
    const hsize_t extent[2] = {n, ncomp};
    const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t group = H5Gcreate2(file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t space = H5Screate_simple(rank, extent, NULL);
    const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[2] = {1000, 3};
    if (n > 1000) /* huge by word only: no chunk is ever written */
        H5Pset_chunk(list, rank, chunk);
    H5Dclose(H5Dcreate2(group, "Points", type, space, H5P_DEFAULT, list, H5P_DEFAULT));
    H5Pclose(list);
    H5Sclose(space);
    H5Gclose(group);
    H5Fclose(file);
}

static void refuses_foreign_files(void **state)
{
    struct snapshot s;
    struct error e = {0};
    const char *path = scratch_path(state, "a");
    assert_int_equal(snapshot_read(&s, path, &e), -1);
    assert_int_equal(e.exit_code, EXIT_USAGE);
    assert_non_null(strstr(e.text, "No such file"));
    assert_int_equal(snapshot_read(&s, scratch_path(state, ""), &e), -1);
    assert_int_equal(snapshot_read(&s, "/dev/zero", &e), -1);
    scratch_write(path, "hello", 5);
    assert_int_equal(snapshot_read(&s, path, &e), -1);
    assert_non_null(strstr(e.text, "not an HDF5 file"));
    H5Fclose(H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    assert_int_equal(snapshot_read(&s, path, &e), -1);
    assert_non_null(strstr(e.text, "VTKHDF"));
    write_foreign(path, 2, 10, 2, H5T_NATIVE_DOUBLE);
    assert_int_equal(snapshot_read(&s, path, &e), -1);
    write_foreign(path, 1, 10, 3, H5T_NATIVE_DOUBLE);
    assert_int_equal(snapshot_read(&s, path, &e), -1);
    write_foreign(path, 2, 10, 3, H5T_C_S1);
    assert_int_equal(snapshot_read(&s, path, &e), -1);
    write_foreign(path, 2, (hsize_t)1 << 40, 3, H5T_NATIVE_DOUBLE);
    assert_int_equal(snapshot_read(&s, path, &e), -1);
    /* Without columns and field data: nothing but points. */
    write_foreign(path, 2, 10, 3, H5T_NATIVE_FLOAT);
    if (snapshot_read(&s, path, &e) == 0) {
        assert_int_equal(s.n, 10);
        assert_int_equal(s.n_array, 1);
        assert_string_equal(s.title, "");
        snapshot_free(&s);
    }
}

/* Reads a file that may be damaged, in another process: HDF5 may leak there, and must not hang or
 * crash. Whether it ended as it should. */
static bool reading_ends(const char *path)
{
    int status = -1;
    const pid_t child = fork();
    if (child == 0) {
        struct snapshot s;
        struct error e = {0};
        alarm(60);
        const int result = snapshot_read(&s, path, &e);
        const bool good = result == 0 || strstr(e.text, "cannot read ");
        /* Another program ends in our place: it has no leaks that a checker could count. */
        execlp("sh", "sh", "-c", good ? "exit 0" : "exit 1", (char *)NULL);
        _exit(2);
    }
    return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) &&
           WEXITSTATUS(status) == 0;
}

static void survives_damage(void **state)
{
    struct particles p[2];
    struct error e = {0};
    size_t n = 0;
    uint32_t random = 12345;
    const char *path = scratch_path(state, "a");
    make(p, 20);
    assert_int_equal(snapshot_write(path, p, 2, &meta, &e), 0);
    fini(p);
    char *good = scratch_read(path, &n), *bad = malloc(n);
    for (int round = 0; round < 300; round++) {
        size_t length = n;
        memcpy(bad, good, n);
        for (int k = 0; k <= round % 10; k++) {
            random = random * 1664525u + 1013904223u;
            bad[random % n] ^= (char)(1u << (random >> 29));
        }
        if (round % 5 == 0)
            length = random % n;
        scratch_write(path, bad, length);
        assert_true(reading_ends(path));
    }
    free(bad);
    free(good);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        TEST(reads_back),      TEST(reads_back_nothing),    TEST(tells_of_a_full_disk),
        TEST(refuses_columns), TEST(refuses_foreign_files), TEST(survives_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
