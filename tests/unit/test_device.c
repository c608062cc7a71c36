/* test_device.c -- an open device: memory, transfers, launches, times, programs, failures. What
 * is read in compilers' logs is tested everywhere; the rest skips itself where there is no device. Calls of
 * OpenCL go by way of tests/opencl/faults.c. */
#include "config.h"

#include "opencl/device.h"
#include "opencl/device_log.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 1000 };

static const char text[] =
    "__kernel void twice(__global double *a, const uint n, const double by)\n"
    "{ const size_t i = get_global_id(0); if (i < n) a[i] *= by; }\n"
    "__kernel __attribute__((reqd_work_group_size(32, 1, 1)))\n"
    "void turn(__global const double *a, __global double *b, __local double *t, const uint n)\n"
    "{ const size_t i = get_global_id(0), l = get_local_id(0);\n"
    "  t[l] = i < n ? a[i] : 0.0;\n"
    "  barrier(CLK_LOCAL_MEM_FENCE);\n"
    "  if (i < n) b[i] = t[(l + 1) % 32] + (double)get_local_size(0); }\n";

static struct device *device;
static struct error e;

static void test_buffers(void **state)
{
    struct device_buffer a = {0}, b = {0};
    double in[N], out[N];
    size_t most;

    (void)state;
    for (int i = 0; i < N; i++)
        in[i] = i + 0.5;
    assert_int_equal(device_reserve(device, &a, sizeof(in), "test", &e), 0);
    assert_int_equal(device_reserve(device, &b, sizeof(in), "test", &e), 0);
    assert_true(a.bytes >= sizeof(in));
    assert_int_equal(device_bytes(device, &most), a.bytes + b.bytes);
    assert_int_equal(device_read(device, &a, 0, out, sizeof(out), &e), 0);
    for (int i = 0; i < N; i++)
        assert_true(out[i] == 0);
    assert_int_equal(device_write(device, &a, 0, in, sizeof(in), &e), 0);
    assert_int_equal(device_copy(device, &b, 8, &a, 16, 80, &e), 0);
    assert_int_equal(device_fill(device, &b, 40, 0, 8, &e), 0);
    assert_int_equal(device_read(device, &b, 8, out, 80, &e), 0);
    for (int i = 0; i < 10; i++)
        assert_true(out[i] == (i == 4 ? 0 : i + 2.5));
    device_release(device, &a);
    device_release(device, &b);
    assert_int_equal(device_bytes(device, &most), 0);
    assert_true(most >= 2 * sizeof(in));
}

static void test_launch(void **state)
{
    struct device_program *p;
    struct device_kernel *twice, *turn;
    struct device_buffer a = {0}, b = {0};
    const struct device_time *time;
    const uint32_t n = N;
    const double by = 3;
    double in[N], out[N];
    size_t n_time, seen = 0;

    (void)state;
    for (int i = 0; i < N; i++)
        in[i] = i;
    if (device_build(device, &p, text, NULL, "test kernels", &e))
        fail_msg("%s", e.text);
    assert_int_equal(device_kernel(device, p, "twice", NULL, &twice, &e), 0);
    assert_int_equal(device_kernel(device, p, "turn", "turning", &turn, &e), 0);
    assert_int_equal(device_reserve(device, &a, sizeof(in), "test", &e), 0);
    assert_int_equal(device_reserve(device, &b, sizeof(in), "test", &e), 0);
    assert_int_equal(device_write(device, &a, 0, in, sizeof(in), &e), 0);
    {
        const struct device_arg arg[] = {DEVICE_BUFFER(&a), DEVICE_VALUE(n), DEVICE_VALUE(by)};
        assert_int_equal(device_launch(device, twice, N, arg, 3, &e), 0);
        assert_int_equal(device_launch(device, twice, 0, arg, 3, &e), 0);
    }
    {
        const struct device_arg arg[] = {DEVICE_BUFFER(&a), DEVICE_BUFFER(&b),
                                         DEVICE_LOCAL(32 * sizeof(double)), DEVICE_VALUE(n)};
        assert_int_equal(device_launch(device, turn, N, arg, 4, &e), 0);
    }
    assert_int_equal(device_read(device, &b, 0, out, sizeof(out), &e), 0);
    for (int i = 0; i < N; i++) {
        const int from = i / 32 * 32 + (i + 1) % 32;
        assert_true(out[i] == (from < N ? 3 * from : 0) + 32);
    }
    time = device_times(device, &n_time);
    for (size_t i = 0; i < n_time; i++)
        if (strcmp(time[i].name, "turning") == 0 || strcmp(time[i].name, "twice") == 0) {
            seen++;
            assert_int_equal(time[i].launches, 1);
            assert_true(time[i].seconds > 0);
        }
    assert_int_equal(seen, 2);
    device_program_free(device, p);
    device_release(device, &a);
    device_release(device, &b);
}

/* More launches than events are kept for, and writes that do not wait. */
static void test_many_launches(void **state)
{
    enum { LAUNCHES = 5000 };
    struct device_program *p;
    struct device_kernel *twice;
    struct device_buffer a = {0};
    const struct device_time *time;
    const uint32_t n = N;
    const double by = 1;
    double x[N], sum = 0;
    uint64_t launches = 0;
    size_t n_time;

    (void)state;
    time = device_times(device, &n_time);
    for (size_t i = 0; i < n_time; i++)
        launches += strcmp(time[i].name, "twice") == 0 ? time[i].launches : 0;
    assert_int_equal(device_build(device, &p, text, "", "test kernels", &e), 0);
    assert_int_equal(device_kernel(device, p, "twice", NULL, &twice, &e), 0);
    assert_int_equal(device_reserve(device, &a, sizeof(x), "test", &e), 0);
    for (int k = 0; k < LAUNCHES; k++) {
        const struct device_arg arg[] = {DEVICE_BUFFER(&a), DEVICE_VALUE(n), DEVICE_VALUE(by)};
        x[0] = k;
        assert_int_equal(device_write(device, &a, 8 * (size_t)(k % N), x, 8, &e), 0);
        x[0] = NAN; /* what is to be written has been taken */
        assert_int_equal(device_launch(device, twice, N, arg, 3, &e), 0);
    }
    assert_int_equal(device_finish(device, &e), 0);
    assert_int_equal(device_read(device, &a, 0, x, sizeof(x), &e), 0);
    for (int i = 0; i < N; i++)
        sum += fabs(x[i] - (LAUNCHES - N + i));
    assert_true(sum == 0);
    time = device_times(device, &n_time);
    for (size_t i = 0; i < n_time; i++)
        launches -= strcmp(time[i].name, "twice") == 0 ? time[i].launches : 0;
    assert_int_equal(launches, (uint64_t)-LAUNCHES);
    device_program_free(device, p);
    device_release(device, &a);
}

/* Buffers that grow begin with zeros again; what is of another size than asked for does not matter. */
static void test_growth(void **state)
{
    struct device_buffer a = {0};
    double x[64];
    void *mem;

    (void)state;
    assert_int_equal(device_reserve(device, &a, 0, "test", &e), 0);
    assert_non_null(a.mem);
    mem = a.mem;
    assert_int_equal(device_reserve(device, &a, a.bytes, "test", &e), 0);
    assert_ptr_equal(a.mem, mem);
    assert_int_equal(device_fill(device, &a, 0, 7, a.bytes, &e), 0);
    assert_int_equal(device_reserve(device, &a, sizeof(x), "test", &e), 0);
    assert_int_equal(device_read(device, &a, 0, x, sizeof(x), &e), 0);
    for (int i = 0; i < 64; i++)
        assert_true(x[i] == 0);
    device_release(device, &a);
    device_release(device, &a);
}

/* -- Mistakes -------- */

#define SAYS(part)                                                                                 \
    do {                                                                                           \
        if (!strstr(e.text, part))                                                                 \
            fail_msg("\"%s\" says nothing of \"%s\"", e.text, part);                               \
    } while (0)

/* After each the device works as before. */
static void test_mistakes(void **state)
{
    struct device_buffer a = {0};
    struct device_program *p;
    struct device_kernel *k;
    double x[100];

    (void)state;
    assert_int_equal(device_open(&(struct device *){NULL}, 999, &e), -1);
    assert_int_equal(e.exit_code, EXIT_USAGE);
    SAYS("no OpenCL device 999: there ");
    SAYS("--devices");
    assert_int_equal(device_reserve(device, &a, 64, "test", &e), 0);
    assert_int_equal(device_read(device, &a, 0, x, sizeof(x), &e), -1);
    SAYS("to read bytes 0 to 800 of a buffer of 128");
    assert_int_equal(device_write(device, &a, SIZE_MAX - 3, x, 8, &e), -1);
    assert_int_equal(device_build(device, &p, text, NULL, "test kernels", &e), 0);
    assert_int_equal(device_kernel(device, p, "thrice", NULL, &k, &e), -1);
    SAYS("has no kernel thrice");
    assert_int_equal(device_kernel(device, p, "twice", NULL, &k, &e), 0);
    assert_int_equal(device_launch(device, k, 1, &DEVICE_BUFFER(&a), 1, &e), -1);
    SAYS("kernel twice takes 3 arguments, not 1");
    device_program_free(device, p);
    device_release(device, &a);
    assert_int_equal(device_finish(device, &e), 0);
}

static void test_build_errors(void **state)
{
    static const char in_file[] = "#define STRANGE(a) ((a).nothing)\n"
                                  "#line 41 \"gas.body.h\"\n"
                                  "__kernel void k(__global float *a)\n"
                                  "{\n"
                                  "    a[0] = 1;\n"
                                  "    a[1] = nowhere_declared;\n"
                                  "    a[2] = 1\n"
                                  "}\n";
    static const char in_macro[] = "#line 7 \"macros.h\"\n"
                                   "#define STRANGE(a) ((a).nothing)\n"
                                   "#line 3 \"k.cl\"\n"
                                   "__kernel void k(__global float *a) { a[0] = STRANGE(a[0]); }\n";
    struct device_program *p;

    (void)state;
    assert_int_equal(device_build(device, &p, in_file, "", "the sweeps", &e), -1);
    assert_int_equal(e.exit_code, EXIT_REFUSED);
    assert_int_equal(strncmp(e.text, "gas.body.h:44: does not compile on \"", 36), 0);
    SAYS("nowhere_declared");
    assert_string_equal(device_build_file(device), "gas.body.h");
    assert_int_equal(device_build(device, &p, in_macro, "", "the sweeps", &e), -1);
    SAYS("k.cl:3: does not compile");
    assert_int_equal(device_build(device, &p, in_file + 33 + 22, "", "the sweeps", &e), -1);
    SAYS("the sweeps, line 4: does not compile");
    assert_null(device_build_file(device));
    assert_int_equal(device_build(device, &p, text, "--no-such-option", "the sweeps", &e), -1);
    SAYS("the sweeps");
    assert_int_equal(device_finish(device, &e), 0);
}

/* -- Failures of the device -------- */

/* Opens it anew with that fault. */
static struct device *faulty(const char *fault)
{
    struct device *d;

    setenv("SPH_FAULT", fault, 1);
    if (device_open(&d, 0, &e))
        d = NULL;
    return d;
}

static void no_fault(struct device *d)
{
    unsetenv("SPH_FAULT");
    device_close(d);
}

static void test_nothing_there(void **state)
{
    struct device *d;

    (void)state;
    assert_null(faulty("no-devices"));
    assert_int_equal(e.exit_code, EXIT_USAGE);
    SAYS("no OpenCL device: install");
    SAYS("pocl-opencl-icd");
    SAYS("--device cpu");
    assert_null(faulty("clCreateContext:1:-6"));
    assert_int_equal(e.exit_code, EXIT_RUN);
    SAYS("fails to open a context: CL_OUT_OF_HOST_MEMORY (-6)");
    d = faulty("no-fp64");
    assert_int_equal(device_need_fp64(d, &e), -1);
    SAYS("has no double precision");
    no_fault(d);
    assert_int_equal(device_need_fp64(device, &e), 0);
}

static void test_out_of_memory(void **state)
{
    struct device_buffer a = {0}, b = {0};
    struct device *d = faulty("memory:1000000");

    (void)state;
    assert_int_equal(device_reserve(d, &a, 1000001, "neighbour lists", &e), -1);
    assert_int_equal(e.exit_code, EXIT_RUN);
    SAYS("has no room for neighbour lists: 1000064 bytes, where one buffer has at most 1000000");
    assert_int_equal(device_reserve(d, &a, 600000, "particles", &e), 0);
    assert_int_equal(device_reserve(d, &b, 600000, "neighbour lists", &e), -1);
    SAYS("no room for neighbour lists: 600064 bytes beside the 600064 in use, of 1000000");
    assert_int_equal(device_reserve(d, &a, 900000, "particles", &e), 0);
    device_release(d, &a);
    assert_int_equal(device_reserve(d, &b, SIZE_MAX - 7, "all", &e), -1);
    no_fault(d);
    d = faulty("clCreateBuffer:1:-4");
    assert_int_equal(device_reserve(d, &a, 600000, "particles", &e), -1);
    SAYS("gives no room for particles, 600064 bytes");
    SAYS("CL_MEM_OBJECT_ALLOCATION_FAILURE (-4)");
    assert_int_equal(device_bytes(d, NULL), 0);
    assert_int_equal(device_reserve(d, &a, 600000, "particles", &e), 0);
    no_fault(d);
    d = faulty("clEnqueueFillBuffer:1:-4"); /* found out late */
    a = (struct device_buffer){0};
    assert_int_equal(device_reserve(d, &a, 600000, "particles", &e), -1);
    assert_int_equal(device_bytes(d, NULL), 0);
    assert_null(a.mem);
    no_fault(d);
}

/* Once lost, always lost, and each call says why. */
static void lose(const char *fault, const char *sentence)
{
    struct device *d = faulty(fault);
    struct device_program *p;
    struct device_kernel *k;
    struct device_buffer a = {0};
    const uint32_t n = N;
    const double by = 1;
    const struct device_arg arg[] = {DEVICE_BUFFER(&a), DEVICE_VALUE(n), DEVICE_VALUE(by)};
    double x[N] = {0};
    int status = device_reserve(d, &a, sizeof(x), "test", &e) ||
                 device_build(d, &p, text, NULL, "test kernels", &e) ||
                 device_kernel(d, p, "twice", NULL, &k, &e);

    for (int i = 0; i < 3 && !status; i++)
        status = device_write(d, &a, 0, x, sizeof(x), &e) || device_launch(d, k, N, arg, 3, &e) ||
                 device_copy(d, &a, 0, &a, 64, 64, &e) || device_read(d, &a, 0, x, 64, &e) ||
                 device_finish(d, &e);
    assert_true(status);
    assert_int_equal(e.exit_code, EXIT_RUN);
    SAYS(sentence);
    e.text[0] = '\0';
    assert_int_equal(device_read(d, &a, 0, x, 8, &e), -1);
    SAYS(sentence);
    assert_int_equal(device_reserve(d, &a, 1 << 20, "test", &e), -1);
    SAYS(sentence);
    no_fault(d);
}

static void test_lost(void **state)
{
    (void)state;
    lose("clEnqueueNDRangeKernel:2:-5", "fails to run twice: CL_OUT_OF_RESOURCES (-5)");
    lose("clEnqueueReadBuffer:3:-5", "fails to read 64 bytes: CL_OUT_OF_RESOURCES (-5)");
    lose("clEnqueueWriteBuffer:1:-6", "fails to write 8000 bytes: CL_OUT_OF_HOST_MEMORY (-6)");
    lose("clEnqueueCopyBuffer:1:-36", "fails to copy 64 bytes: CL_INVALID_COMMAND_QUEUE (-36)");
    lose("clFinish:2:-36", "fails to finish what was asked of it: CL_INVALID_COMMAND_QUEUE (-36)");
    lose("clWaitForEvents:1:-14", "fails to do what was asked of it: CL_EXEC_STATUS");
}

/* -- Rates -------- */

static void test_measure(void **state)
{
    struct device_rates first, again;
    size_t before, after;

    (void)state;
    device_bytes(device, &before);
    if (device_measure(device, &first, &e))
        fail_msg("%s", e.text);
    assert_int_equal(device_measure(device, &again, &e), 0);
    assert_memory_equal(&first, &again, sizeof(first));
    assert_true(first.bytes > 1e8 && first.flops_f32 > 1e8 && first.flops_f64 > 1e8);
    assert_true(first.bytes < 1e14 && first.flops_f32 < 1e16 && first.flops_f64 < 1e16);
    assert_int_equal(device_bytes(device, &after), 0);
    assert_int_equal(before, after);
    print_message("%.1f GB/s, %.1f GFlop/s single, %.1f GFlop/s double precision\n",
                  1e-9 * first.bytes, 1e-9 * first.flops_f32, 1e-9 * first.flops_f64);
}

/* -- Logs -------- */

static void test_logs(void **state)
{
    static const char source[] = "#define A 1\n"             /* 1 */
                                 "#line 20 \"gas.body.h\"\n" /* 2 */
                                 "x = 1;\n"                  /* 3, 20 */
                                 "y = nowhere;\n"            /* 4, 21 */
                                 "#line 4 \"other.h\"\n"     /* 5 */
                                 "z = nothing;\n"            /* 6, 4 */
                                 "x = 1;\n";                 /* 7, 5 */
    static const struct {
        const char *log, *file, *message;
        unsigned long line;
    } known[] = {
        /* PoCL */
        {"warning: gas.body.h:20:1: error-prone\nerror: gas.body.h:21:5: no 'nowhere'\n"
         "error: x.h:1:1: more\n",
         "gas.body.h", "no 'nowhere'", 21},
        {"error: other.h:5:10 <Spelling=gas.body.h:20:3>: member: of what\n", "other.h",
         "member: of what", 5},
        {"error: /tmp/tempfile_x.cl:1:9: bad\n", "", "bad", 1},
        /* clang, AMD */
        {"In file included from k:1:\ngas.body.h:21:5: error: no 'nowhere'\ny = nowhere;\n    ^\n",
         "gas.body.h", "no 'nowhere'", 21},
        {"/tmp/comgr-1/input/CompileSource:1:9: fatal error: bad\n", "", "bad", 1},
        /* NVIDIA: no name; lines counted as #line says, or from the begin; quoted, or not */
        {"<kernel>:21:5: error: no 'nowhere'\ny = nowhere;\n    ^\n", "gas.body.h", "no 'nowhere'",
         21},
        {"<kernel>:4:5: error: no 'nothing'\n  z = nothing;\n      ^\n", "other.h", "no 'nothing'",
         4},
        {"<kernel>:4:5: error: no 'nowhere'\ny = nowhere;\n    ^\n", "gas.body.h", "no 'nowhere'",
         21},
        {"<kernel>:6:5: error: no 'nothing'\n", "other.h", "no 'nothing'", 4},
        {"<kernel>(21): error: no \"nowhere\"\n", "gas.body.h", "no \"nowhere\"", 21},
        {"<kernel>:999:5: error: far\n", "", "far", 999},
        {"ptxas error   : Entry function 'k' uses too much shared data\n", "",
         "Entry function 'k' uses too much shared data", 0},
        /* Intel */
        {"2:21:5: error: no 'nowhere'\ny = nowhere;\n", "gas.body.h", "no 'nowhere'", 21},
        {"error: linking failed\n", "", "linking failed", 0},
    };
    struct device_complaint c;

    (void)state;
    for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++) {
        assert_true(device_log_read(source, known[i].log, &c));
        assert_string_equal(c.file, known[i].file);
        assert_string_equal(c.message, known[i].message);
        assert_int_equal(c.line, known[i].line);
    }
    assert_false(device_log_read(source, "", &c));
    assert_false(
        device_log_read(source, "all is well\nwarning: errors may come, an error too", &c));
    assert_true(device_log_read("", "<kernel>:3:1: error: x", &c));
    assert_true(device_log_read("#line\n#line 7\n#line 7 \"x\n", "a:7:1: error: x", &c));
}

static int open_it(void **state)
{
    (void)state;
    return device_open(&device, 0, &e);
}

static int close_it(void **state)
{
    (void)state;
    device_close(device);
    return 0;
}

int main(void)
{
    const struct CMUnitTest logs[] = {cmocka_unit_test(test_logs)};
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_buffers),       cmocka_unit_test(test_growth),
        cmocka_unit_test(test_launch),        cmocka_unit_test(test_many_launches),
        cmocka_unit_test(test_mistakes),      cmocka_unit_test(test_build_errors),
        cmocka_unit_test(test_nothing_there), cmocka_unit_test(test_out_of_memory),
        cmocka_unit_test(test_lost),          cmocka_unit_test(test_measure),
    };
    const int failed = cmocka_run_group_tests(logs, NULL, NULL);
    struct device *d;

    if (device_open(&d, 0, &e)) {
        print_message("skipped: %s\n", e.text);
        return failed ? failed : 77;
    }
    device_close(d);
    return failed + cmocka_run_group_tests(tests, open_it, close_it);
}
