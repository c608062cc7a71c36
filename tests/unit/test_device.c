/* test_device.c -- an open device: memory, transfers, launches, times, programs, failures. Skips itself
 * where there is no device. */
#include "config.h"

#include "opencl/device.h"

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
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_buffers),
        cmocka_unit_test(test_launch),
    };
    struct device *d;

    if (device_open(&d, 0, &e)) {
        print_message("skipped: %s\n", e.text);
        return 77;
    }
    device_close(d);
    return cmocka_run_group_tests(tests, open_it, close_it);
}
