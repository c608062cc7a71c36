/* tests/unit/test_opencl_sort.c -- running sums and sorts on a device, of many sizes. Skips itself
 * where there is no device. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "device_clouds.h"
#include "opencl/sort.h"

static struct device *device;
static struct device_sort *sort;
static struct error e;

static const size_t sizes[] = {0, 1, 7, 63, 64, 65, 1000, 16384, 16385, 100000, 1000000};
#define SIZES (sizeof sizes / sizeof sizes[0])

static void sums_run_along(void **state)
{
    struct device_buffer in = {0}, out = {0}, total = {0};

    (void)state;
    assert_int_equal(device_reserve(device, &total, 32, "test", &e), 0);
    for (size_t k = 0; k < SIZES; k++) {
        const size_t n = sizes[k];
        uint32_t *x = malloc((n + 1) * 4), *y = malloc((n + 6) * 4);
        uint64_t sum[4] = {0, 5, 0, 0}, seed = 7 + k, all = 5;

        for (size_t i = 0; i < n; i++) {
            x[i] = (uint32_t)(random_unit(&seed) * (i % 100 == 3 ? 4e9 : 1000));
        }
        assert_int_equal(device_reserve(device, &in, (n + 4) * 4, "test", &e), 0);
        assert_int_equal(device_reserve(device, &out, (n + 6) * 4, "test", &e), 0);
        assert_int_equal(device_write(device, &total, 0, sum, sizeof sum, &e), 0);
        assert_int_equal(device_fill(device, &out, 0, 77, (n + 6) * 4, &e), 0);
        assert_int_equal(n ? device_write(device, &in, 12, x, n * 4, &e) : 0, 0);
        assert_int_equal(device_scan(sort, &in, 3, n, &out, 2, &total, 1, &e), 0);
        assert_int_equal(device_read(device, &out, 0, y, (n + 6) * 4, &e), 0);
        assert_int_equal(device_read(device, &total, 0, sum, sizeof sum, &e), 0);
        assert_true(y[0] == 77 && y[1] == 77 && y[n + 3] == 77);
        for (size_t i = 0; i <= n; i++) {
            assert_int_equal(y[i + 2], (uint32_t)all);
            all += i < n ? x[i] : 0;
        }
        assert_true(sum[0] == 0 && sum[1] == 5 && sum[2] == all && sum[3] == 0);
        free(x);
        free(y);
    }
    device_release(device, &in);
    device_release(device, &out);
    device_release(device, &total);
}

static uint64_t key_at(const void *key, size_t bytes, size_t i)
{
    return bytes == 4 ? ((const uint32_t *)key)[i] : ((const uint64_t *)key)[i];
}

static void sort_of(size_t n, size_t bytes, unsigned bits)
{
    struct device_buffer key = {0}, value = {0};
    uint64_t *in = calloc(n + 1, 8), *out = calloc(n + 1, 8), seed = n + bits;
    uint32_t *v = malloc((n + 1) * 4);
    uint8_t *seen = calloc(n + 1, 1);

    for (size_t i = 0; i < n; i++) {
        uint64_t k =
            (uint64_t)(random_unit(&seed) * 9e15) << 11 ^ (uint64_t)(9e9 * random_unit(&seed));

        k = bits < 64 ? k & ((1ull << bits) - 1) : k;
        if (bytes == 4) {
            ((uint32_t *)in)[i] = (uint32_t)k;
        } else {
            in[i] = k;
        }
        v[i] = (uint32_t)i;
    }
    assert_int_equal(device_reserve(device, &key, (n + 1) * bytes, "test", &e), 0);
    assert_int_equal(device_reserve(device, &value, (n + 1) * 4, "test", &e), 0);
    assert_int_equal(n ? device_write(device, &key, 0, in, n * bytes, &e) : 0, 0);
    assert_int_equal(n ? device_write(device, &value, 0, v, n * 4, &e) : 0, 0);
    assert_int_equal(device_sort_pairs(sort, &key, &value, n, bytes, bits, &e), 0);
    assert_int_equal(n ? device_read(device, &key, 0, out, n * bytes, &e) : 0, 0);
    assert_int_equal(n ? device_read(device, &value, 0, v, n * 4, &e) : 0, 0);
    for (size_t i = 0; i < n; i++) {
        assert_true(v[i] < n && !seen[v[i]]);
        seen[v[i]] = 1;
        assert_true(key_at(out, bytes, i) == key_at(in, bytes, v[i]));
        if (i > 0) {
            const uint64_t p = key_at(out, bytes, i - 1), q = key_at(out, bytes, i);

            assert_true(p < q || (p == q && v[i - 1] < v[i]));
        }
    }
    device_release(device, &key);
    device_release(device, &value);
    free(in);
    free(out);
    free(v);
    free(seen);
}

static void equal_keys_keep_their_order(void **state)
{
    (void)state;
    for (size_t k = 0; k < SIZES; k++) {
        sort_of(sizes[k], 4, 3);
        sort_of(sizes[k], 4, 17);
        sort_of(sizes[k], 4, 32);
        sort_of(sizes[k], 8, 5);
        sort_of(sizes[k], 8, 33);
        sort_of(sizes[k], 8, 63);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(sums_run_along),
                                       cmocka_unit_test(equal_keys_keep_their_order)};
    int status = 0;

    device = any_device();
    if (!device) {
        print_message("no OpenCL device with double precision: skipped\n");
        return 77;
    }
    for (int cpu = 0; cpu < 2 && status == 0; cpu++) {
        assert_int_equal(device_sort_open(&sort, device, cpu, &e), 0);
        status = cmocka_run_group_tests(tests, NULL, NULL);
        device_sort_close(sort);
    }
    device_close(device);
    return status;
}
