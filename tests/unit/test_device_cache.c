/* test_device_cache.c -- what is kept of built programs: taken where it fits, built anew where it does not, held
 * to its room; and that a second process has all it needs. Skips itself where there is no device. */
#include "config.h"

#include "opencl/device.h"
#include "opencl/device_cache.h"
#include "opencl/devices.h"
#include "scratch.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>

#include <cmocka.h>

static const char text[] = "__kernel void twice(__global float *a) { a[get_global_id(0)] *= 2; }\n";
/* Takes a while to compile. */
static const char slow_text[] =
    "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n"
    "#define SLOW(name, p)                                                          \\\n"
    "__kernel __attribute__((reqd_work_group_size(64, 1, 1)))                      \\\n"
    "void name(__global double *a, const ulong n)                                  \\\n"
    "{                                                                             \\\n"
    "    const size_t i = get_global_id(0);                                        \\\n"
    "    if (i >= 64 || i >= n)                                                    \\\n"
    "        return;                                                               \\\n"
    "    double s = a[i];                                                          \\\n"
    "    for (int k = 0; k < p; k++)                                               \\\n"
    "        s += exp(s * k) * log(fabs(s) + 2) * sin(s) * pow(fabs(s), 0.1 * p);  \\\n"
    "    a[i] = s;                                                                 \\\n"
    "}\n"
    "SLOW(one, 5)\nSLOW(two, 6)\nSLOW(three, 7)\nSLOW(four, 8)\nSLOW(five, 9)\n";
enum { SLOW_KERNELS = 5 };

static struct error e;

/* Builds in a device of its own, which thus knows nothing of before; how, by counts. */
static void build_again(const char *source, const char *options, unsigned cached, unsigned built)
{
    struct device *d;
    struct device_program *p;
    struct device_kernel *k;
    unsigned c, b;

    assert_int_equal(device_open(&d, 0, &e), 0);
    assert_int_equal(device_build(d, &p, source, options, "test kernels", &e), 0);
    assert_int_equal(device_kernel(d, p, "twice", NULL, &k, &e), 0);
    assert_true(device_build_seconds(d, &c, &b) > 0);
    assert_int_equal(c, cached);
    assert_int_equal(b, built);
    device_close(d);
}

/* The names of the files in a folder that is no other's, at most `room`. */
static size_t files_in(const char *path, char name[][300], size_t room)
{
    DIR *dir = opendir(path);
    struct dirent *entry;
    size_t n = 0;

    if (!dir)
        return 0;
    while ((entry = readdir(dir)))
        if (entry->d_name[0] != '.') {
            assert_true(n < room);
            snprintf(name[n++], 300, "%s", entry->d_name);
        }
    closedir(dir);
    return n;
}

static void test_entries(void **state)
{
    const char *dir = scratch_path(state, "of/the/cache");
    char name[4][300], path[700], *before = getenv("SPH_CACHE_DIR");
    char *kept, *data;
    size_t n = 0;

    before = before ? strdup(before) : NULL;
    setenv("SPH_CACHE_DIR", dir, 1);
    build_again(text, "", 0, 1);
    build_again(text, NULL, 1, 0);
    assert_int_equal(files_in(dir, name, 4), 1);
    snprintf(path, sizeof(path), "%s/%s", dir, name[0]);
    kept = scratch_read(path, &n);
    data = malloc(n + 1);
    assert_true(kept && data && n > 100);
    /* A changed bit anywhere, a cut end, more than there was, nothing: built anew, and whole again. */
    for (size_t k = 0; k < 9; k++) {
        memcpy(data, kept, n);
        data[k * (n - 1) / 8] ^= 4;
        scratch_write(path, data, n);
        build_again(text, "", 0, 1);
        build_again(text, "", 1, 0);
    }
    scratch_write(path, kept, n - 1);
    build_again(text, "", 0, 1);
    data[n] = 0;
    memcpy(data, kept, n);
    scratch_write(path, data, n + 1);
    build_again(text, "", 0, 1);
    scratch_write(path, data, 0);
    build_again(text, "", 0, 1);
    /* Whole, and the driver will not have it. */
    setenv("SPH_FAULT", "clCreateProgramWithBinary:1:-42", 1);
    build_again(text, "", 0, 1);
    setenv("SPH_FAULT", "clBuildProgram:1:-11", 1);
    build_again(text, "", 0, 1);
    unsetenv("SPH_FAULT");
    /* Of another source, with other options. */
    build_again(text, "-DOTHER", 0, 1);
    assert_int_equal(files_in(dir, name, 4), 2);
    free(kept);
    free(data);
    /* No folder can be there; none is wanted. */
    scratch_write(scratch_path(state, "file"), "", 0);
    setenv("SPH_CACHE_DIR", scratch_path(state, "file/folder"), 1);
    build_again(text, "", 0, 1);
    setenv("SPH_CACHE_DIR", "", 1);
    build_again(text, "", 0, 1);
    if (before)
        setenv("SPH_CACHE_DIR", before, 1);
    free(before);
}

/* More than there is room for: what was asked for last stays. */
static void test_room(void **state)
{
    enum { ENTRIES = 10, BYTES = 30 << 20 };
    char name[20][300], *data = calloc(1, BYTES), *before = getenv("SPH_CACHE_DIR");
    const char *dir = scratch_path(state, "full");
    size_t n = 0;

    assert_non_null(data);
    before = before ? strdup(before) : NULL;
    setenv("SPH_CACHE_DIR", dir, 1);
    for (uint64_t k = 0; k < ENTRIES; k++) {
        void *first;
        cache_put(&(struct cache_key){{k, 1}}, data, BYTES);
        first = cache_get(&(struct cache_key){{0, 1}}, &n);
        assert_true(first && n == BYTES);
        free(first);
    }
    assert_int_equal(files_in(dir, name, 20), (256 << 20) / (BYTES + 48));
    assert_null(cache_get(&(struct cache_key){{1, 1}}, &n));
    /* A full disk leaves nothing. */
    scratch_limit(1 << 20);
    cache_put(&(struct cache_key){{7, 7}}, data, BYTES);
    scratch_limit(0);
    assert_null(cache_get(&(struct cache_key){{7, 7}}, &n));
    assert_int_equal(files_in(dir, name, 20), (256 << 20) / (BYTES + 48));
    free(data);
    if (before)
        setenv("SPH_CACHE_DIR", before, 1);
    else
        unsetenv("SPH_CACHE_DIR");
    free(before);
}

/* -- Several processes at once -------- */

/* Takes the turn, says so, and after a while puts an entry, or dies. */
static pid_t other(const struct cache_key *k, bool dies)
{
    int pipes[2];
    char word = 0;
    assert_int_equal(pipe(pipes), 0);
    const pid_t child = fork();
    if (child == 0) {
        bool waited;
        const int turn = cache_begin(k, &waited);
        const ssize_t n = write(pipes[1], "1", 1);
        usleep(300000);
        if (dies || n != 1 || turn < 0)
            _exit(1);
        cache_put(k, "entry", 6);
        cache_end(k, turn);
        _exit(0);
    }
    assert_true(child > 0);
    assert_int_equal(read(pipes[0], &word, 1), 1);
    close(pipes[0]);
    close(pipes[1]);
    return child;
}

static void test_turns(void **state)
{
    const struct cache_key k = {{5, 9}};
    char *before = getenv("SPH_CACHE_DIR"), name[4][300], *data;
    const char *dir = scratch_path(state, "turns");
    bool waited;
    size_t n;

    before = before ? strdup(before) : NULL;
    setenv("SPH_CACHE_DIR", dir, 1);
    for (int dies = 1; dies >= 0; dies--) {
        const pid_t child = other(&k, dies);
        const int turn = cache_begin(&k, &waited);
        assert_true(turn >= 0 && waited);
        data = cache_get(&k, &n);
        assert_true(dies ? data == NULL : data && n == 6);
        free(data);
        cache_end(&k, turn);
        int status;
        assert_int_equal(waitpid(child, &status, 0), child);
    }
    const int turn = cache_begin(&k, &waited);
    assert_true(turn >= 0 && !waited);
    cache_end(&k, turn);
    assert_int_equal(files_in(dir, name, 4), 1);
    setenv("SPH_CACHE_DIR", "", 1);
    assert_int_equal(cache_begin(&k, &waited), -1);
    cache_end(&k, -1);
    if (before)
        setenv("SPH_CACHE_DIR", before, 1);
    free(before);
}

/* -- A second process -------- */

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* What a process of its own does: all of a run's kernels, on few and on many particles. Writes the seconds. */
static int launch_all(const char *file)
{
    static const char *const name[SLOW_KERNELS] = {"one", "two", "three", "four", "five"};
    struct opencl_device *list;
    struct device *d;
    struct device_program *p;
    struct device_buffer a = {0};
    size_t n_list;
    double seconds[2];
    int status;

    if (opencl_devices(&list, &n_list, &e) ||
        device_open(&d, 0, &e)) /* as `sph` does, in this order */
        return 1;
    free(list);
    seconds[0] = now();
    status = device_build(d, &p, slow_text, "", "test kernels", &e) ||
             device_reserve(d, &a, 8 * 100000, "test", &e);
    for (int k = 0; k < SLOW_KERNELS && !status; k++) {
        struct device_kernel *kernel;
        status = device_kernel(d, p, name[k], NULL, &kernel, &e);
        for (uint64_t n = 100; n <= 100000 && !status; n *= 1000) {
            const struct device_arg arg[] = {DEVICE_BUFFER(&a), DEVICE_VALUE(n)};
            status = device_launch(d, kernel, n, arg, 2, &e) || device_finish(d, &e);
        }
    }
    seconds[0] = now() - seconds[0];
    seconds[1] = device_build_seconds(d, NULL, NULL);
    scratch_write(file, seconds, sizeof(seconds));
    device_close(d);
    return status ? 1 : 0;
}

/* In a process that finds nothing of the driver's own cache. [s] */
static void launch_elsewhere(void **state, const char *drivers, double seconds[2])
{
    const char *file = scratch_path(state, drivers);
    char folder[600], *data;
    int status;
    size_t n = 0;
    pid_t pid;

    snprintf(folder, sizeof(folder), "%s.cache", file);
    assert_int_equal(mkdir(folder, 0700), 0);
    pid = fork();
    if (pid == 0) {
        setenv("POCL_CACHE_DIR", folder, 1);
        execl("/proc/self/exe", "test_device_cache", file, (char *)NULL);
        _exit(127);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_int_equal(status, 0);
    data = scratch_read(file, &n);
    assert_true(data && n == 2 * sizeof(double));
    memcpy(seconds, data, n);
    free(data);
}

static void test_second_process(void **state)
{
    char *before = getenv("SPH_CACHE_DIR");
    double first[2], second[2];

    before = before ? strdup(before) : NULL;
    setenv("SPH_CACHE_DIR", scratch_path(state, "kept"), 1);
    launch_elsewhere(state, "first", first);
    launch_elsewhere(state, "second", second);
    print_message("%d kernels: %.3f s, of which %.3f s build; kept: %.3f s, of which %.3f s\n",
                  SLOW_KERNELS, first[0], first[1], second[0], second[1]);
    assert_true(second[1] < 0.5 * first[1]);
    assert_true(second[0] < 0.5 * first[0]);
    if (before)
        setenv("SPH_CACHE_DIR", before, 1);
    else
        unsetenv("SPH_CACHE_DIR");
    free(before);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_entries, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_room, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_turns, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_second_process, scratch_setup, scratch_teardown),
    };
    struct device *d;

    if (argc > 1)
        return launch_all(argv[1]);
    if (device_open(&d, 0, &e)) {
        print_message("skipped: %s\n", e.text);
        return 77;
    }
    device_close(d);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
