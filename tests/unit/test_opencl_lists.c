/* tests/unit/test_opencl_lists.c -- neighbour lists and the order of particles on a device against
 * those of the host, with every manager, as for processors and as for others. Skips itself where
 * there is no device. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "device_clouds.h"
#include "opencl/search.h"

#define LANES 8
#define SKIN 0.1

static struct device *device;
static struct error e;

/* Kept, for it takes its time to open one: of a dimension and a manager, for a processor or not. */
static struct device_search *kept[4][4][2];

static struct device_search *search_for(int dim, size_t manager, bool cpu)
{
    struct device_search **s = &kept[dim][manager][cpu];

    if (!*s && search_open(s, device, dim, neighbour_manager_at(manager), cpu, &e) != 0) {
        fail_msg("%s", e.text);
    }
    return *s;
}

/* -- Lists ------------------------------------------------------------------------------------- */

/* Bit 0: the lower half of a group's lanes is within so many reaches of source j, bit 1: the upper. */
static unsigned sees(const struct cloud *dst, const struct cloud *src, bool symmetric, size_t group,
                     size_t j, double reaches)
{
    unsigned halves = 0;

    for (size_t i = group * LANES; i < (group + 1) * LANES && i < dst->n; i++) {
        double reach = dst->scale * dst->h[i], r2 = 0;

        if (symmetric) {
            reach = fmax(reach, src->scale * src->h[j]);
        }
        for (int a = 0; a < dst->dim; a++) {
            r2 += (dst->x[a][i] - src->x[a][j]) * (dst->x[a][i] - src->x[a][j]);
        }
        reach *= reaches;
        halves |= (unsigned)(reaches > 1 + SKIN ? r2 <= reach * reach : r2 < reach * reach)
                  << (i % LANES >= LANES / 2);
    }
    return halves;
}

struct lists {
    uint32_t *begin, *common, *step;
};

static struct lists fetch(const struct device_list *l)
{
    struct lists out = {malloc((l->n_group + 1) * 4), malloc((l->n_group + 1) * 4),
                        malloc((l->n_entry + 1) * 4)};

    assert_int_equal(device_read(device, &l->begin, 0, out.begin, (l->n_group + 1) * 4, &e), 0);
    assert_int_equal(
        l->n_group ? device_read(device, &l->common, 0, out.common, l->n_group * 4, &e) : 0, 0);
    assert_int_equal(
        l->n_entry ? device_read(device, &l->step, 0, out.step, l->n_entry * 4, &e) : 0, 0);
    return out;
}

static void lists_free(struct lists *l)
{
    free(l->begin);
    free(l->common);
    free(l->step);
}

/* A device's list has what the host's has within reach, each half's sources once, and nothing
 * beyond. */
static void compare(const struct group_list *host, const struct device_list *list,
                    const struct cloud *dst, const struct cloud *src, bool symmetric, bool same)
{
    struct lists l = fetch(list);
    uint8_t *seen = calloc(src->n + 1, 1);

    assert_int_equal(list->n_group, (dst->n + LANES - 1) / LANES);
    assert_int_equal(l.begin[0], 0);
    assert_int_equal(l.begin[list->n_group], list->n_entry);
    for (size_t g = 0; g < list->n_group; g++) {
        const uint32_t n = l.begin[g + 1] - l.begin[g], *step = l.step + l.begin[g];

        assert_true(l.begin[g] <= l.begin[g + 1] && l.common[g] <= n);
        assert_int_equal((n - l.common[g]) % 2, 0);
        for (uint32_t k = 0; k < n; k++) {
            const unsigned halves = k < l.common[g] ? 3 : (k - l.common[g]) % 2 ? 2 : 1;

            assert_true(step[k] < src->n);
            assert_int_equal(seen[step[k]], 0);
            seen[step[k]] = (uint8_t)halves;
            assert_true(sees(dst, src, symmetric, g, step[k], 1.005 * (1 + SKIN)) != 0);
            if (same && step[k] / LANES == g) {
                assert_int_equal(halves, 3);
            }
        }
        for (struct source_walk w = source_walk_begin(host, g); source_walk_next(host, &w);) {
            const unsigned must = sees(dst, src, symmetric, g, w.source, 1 + SKIN);

            assert_int_equal(seen[w.source] & must, must);
        }
        for (uint32_t k = 0; k < n; k++) {
            seen[step[k]] = 0;
        }
    }
    lists_free(&l);
    free(seen);
}

static uint64_t crowded(const struct group_list *host, const struct cloud *dst,
                        const struct cloud *src, bool symmetric, bool same, uint64_t most)
{
    uint64_t all = 0;

    for (size_t i = 0; i < dst->n; i++) {
        const struct cloud one = {.dim = dst->dim,
                                  .n = 1,
                                  .x = {dst->x[0] + i, dst->dim > 1 ? dst->x[1] + i : NULL,
                                        dst->dim > 2 ? dst->x[2] + i : NULL},
                                  .h = dst->h + i,
                                  .scale = dst->scale};
        uint64_t n = 0;

        for (struct source_walk w = source_walk_begin(host, i / LANES);
             source_walk_next(host, &w);) {
            n += sees(&one, src, symmetric, 0, w.source, 1) && !(same && w.source == i);
        }
        all += n > most;
    }
    return all;
}

static void lists_of(const struct cloud *dst, const struct cloud *src, bool same)
{
    struct there to = cloud_there(device, same ? src : dst, NULL, 5), from = to;
    uint64_t self = 0;

    to.c.n = dst->n;
    to.c.wide = from.c.wide = &to.wide;
    if (!same) {
        from = cloud_there(device, src, NULL, 0);
        from.c.wide = &from.wide;
    }
    for (size_t i = 0; same && i < dst->n; i++) {
        self += dst->scale * dst->h[i] > 0;
    }
    /* Of others than processors some are enough: every program takes its time to build. */
    for (size_t k = 0; neighbour_manager_at(k / 2); k++) {
        if (k % 2 == 0 && (dst->dim == 1 || (dst->dim == 3 && k / 2 != NEIGHBOURS_RADIX))) {
            continue;
        }
        struct device_search *s = search_for(dst->dim, k / 2, k % 2);
        struct device_list l = {.n_group = 0};

        for (int symmetric = 0; symmetric < 2; symmetric++) {
            struct group_list host = {0};
            const uint64_t most = 15;
            uint64_t pairs;

            assert_int_equal(group_list_make(&host, dst, src, symmetric, SKIN, NULL, 2, &e), 0);
            pairs = group_list_count(&host, dst, src, 2);
            if (device_list_make(s, &l, &to.c, &from.c, symmetric, SKIN, true, most, &e) != 0) {
                fail_msg("%s", e.text);
            }
            compare(&host, &l, dst, src, symmetric, same);
            assert_int_equal(l.n_pair, pairs - (dst->n && src->n ? self : 0));
            assert_int_equal(l.crowded, crowded(&host, dst, src, symmetric, same, most));
            assert_true(device_list_make(s, &l, &to.c, &from.c, symmetric, SKIN, false, 0, &e) ==
                        0);
            assert_true(l.n_pair == 0 && l.crowded == 0);
            group_list_fini(&host);
        }
        device_list_release(device, &l);
    }
    device_release(device, &to.wide);
    if (!same) {
        device_release(device, &from.wide);
    }
}

static void sort_cloud(struct owned *o)
{
    cloud_sort(o, cell_best(&o->c));
}

static void even_clouds(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_even(dim, 20011, 5);
        struct owned l = cloud_lattice(dim, dim == 3 ? 27 : dim == 2 ? 140 : 5000, 3);

        sort_cloud(&o);
        lists_of(&o.c, &o.c, true);
        cloud_shuffle(&l, 3);
        sort_cloud(&l);
        lists_of(&l.c, &l.c, true);
        for (size_t i = 0; i < o.c.n; i++) { /* each alone, or nearly so */
            o.h[i] *= 0.02;
        }
        lists_of(&o.c, &o.c, true);
        cloud_free(&o);
        cloud_free(&l);
    }
}

/* A lattice as scenes make them, on whose cells' borders many points are. */
static void lattices(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_lattice(dim, dim == 3 ? 20 : 100, 3);

        for (size_t i = 0; i < o.c.n; i++) {
            for (int a = 0; a < dim; a++) {
                o.x[a][i] = 0.025 * floor(o.x[a][i] + 0.5);
            }
            o.h[i] = 0.025 * 1.23;
        }
        sort_cloud(&o);
        lists_of(&o.c, &o.c, true);
        cloud_free(&o);
    }
}

static void wide_ranges(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_clustered(dim, 9000, 100, 5);
        struct owned c = cloud_clump(dim, dim == 3 ? 25 : dim == 2 ? 110 : 3000, 1);

        sort_cloud(&o);
        lists_of(&o.c, &o.c, true);
        sort_cloud(&c);
        lists_of(&c.c, &c.c, true);
        cloud_free(&o);
        cloud_free(&c);
    }
}

/* In no order at all, and in one that is spoiled. */
static void any_order(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_even(dim, 6000, 9);

        lists_of(&o.c, &o.c, true);
        sort_cloud(&o);
        for (size_t i = 0; i + 9 < o.c.n; i += 97) {
            for (int a = 0; a < dim; a++) {
                const double t = o.x[a][i];

                o.x[a][i] = o.x[a][o.c.n - 1 - i];
                o.x[a][o.c.n - 1 - i] = t;
            }
        }
        lists_of(&o.c, &o.c, true);
        cloud_free(&o);
    }
}

static void ghosts_and_two_arrays(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_even(dim, 5000, 9), other = cloud_even(dim, 3001, 4);
        struct cloud real = o.c;

        sort_cloud(&o);
        real.n = 4011; /* the others are ghosts: last in order, which stand apart from it */
        for (size_t i = real.n; i < o.c.n; i++) {
            o.x[0][i] += i % 2 ? 0.3 : -0.3;
        }
        lists_of(&real, &o.c, true);
        sort_cloud(&other);
        for (size_t i = 0; i < other.c.n; i++) {
            other.h[i] *= 2;
            other.x[0][i] += 0.5;
        }
        lists_of(&o.c, &other.c, false);
        cloud_free(&o);
        cloud_free(&other);
    }
}

static void small_and_odd(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        static const size_t sizes[] = {0, 1, 2, 7, 8, 9, 63, 64, 65, 513};
        struct owned none = cloud_even(dim, 0, 3);

        for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
            struct owned o = cloud_even(dim, sizes[k], 9);

            sort_cloud(&o);
            lists_of(&o.c, &o.c, true);
            lists_of(&o.c, &none.c, false);
            lists_of(&none.c, &o.c, false);
            for (size_t i = 0; i < sizes[k]; i++) { /* all at one place; some reach nowhere */
                for (int a = 0; a < dim; a++) {
                    o.x[a][i] = 0.5;
                }
                o.h[i] = i % 3 ? 0.1 : 0;
            }
            lists_of(&o.c, &o.c, true);
            cloud_free(&o);
        }
        cloud_free(&none);
    }
}

/* Outliers in an empty box; one that reaches everything; more sources than a slot or a bundle has
 * room for. */
static void far_and_near(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_even(dim, 7000, 9);

        for (size_t i = 0; i < o.c.n; i += 500) {
            o.x[dim - 1][i] = 1e7 * (double)i;
        }
        sort_cloud(&o);
        lists_of(&o.c, &o.c, true);
        o.h[3333] = 10;
        lists_of(&o.c, &o.c, true);
        cloud_free(&o);
        o = cloud_even(dim, 4000, 9);
        for (size_t i = 0; i < o.c.n; i++) {
            o.h[i] = (i % 64 < 32 ? 0.2 : 0.15) * (dim == 3 ? 1.75 : 1);
        }
        sort_cloud(&o);
        lists_of(&o.c, &o.c, true);
        cloud_free(&o);
    }
}

static void wrong_numbers(void **state)
{
    static const double wrong[] = {NAN, INFINITY, -INFINITY, 1e200};

    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        for (size_t k = 0; k < 5 * sizeof wrong / sizeof wrong[0]; k++) {
            const double w = wrong[k / 5];
            struct owned o = cloud_even(dim, 1003, 9);
            struct device_buffer order = {0};
            struct device_list l = {.n_group = 0};
            struct device_search *s = search_for(dim, 0, true);
            struct there t;

            *(k % 2 ? &o.h[k * 50] : &o.x[dim - 1][k % 4 ? k * 50 : 1002]) = w;
            t = cloud_there(device, &o.c, NULL, 0);
            t.c.wide = &t.wide;
            assert_int_equal(device_list_make(s, &l, &t.c, &t.c, true, SKIN, true, 0, &e), -1);
            assert_int_equal(e.exit_code, EXIT_RUN);
            assert_int_equal(l.n_group, 0);
            assert_int_equal(device_order(s, &t.c, 0, &order, &e), -1);
            assert_int_equal(e.exit_code, EXIT_RUN);
            device_list_release(device, &l);
            device_release(device, &order);
            device_release(device, &t.wide);
            cloud_free(&o);
        }
    }
}

/* -- Order ------------------------------------------------------------------------------------- */

static void order_of(const struct owned *o)
{
    const size_t n = o->c.n;
    uint32_t *host = malloc((n + 1) * 4), *there = malloc((n + 1) * 4);
    int64_t *id = malloc((n + 1) * sizeof *id);
    struct device_buffer order = {0};
    struct there t;

    for (size_t i = 0; i < n; i++) {
        id[i] = (int64_t)(i * 7919 % n) - 50;
    }
    t = cloud_there(device, &o->c, id, 5);
    t.c.wide = &t.wide;
    assert_int_equal(cell_order(&o->c, id, cell_best(&o->c), 2, host, &e), 0);
    for (int round = o->c.dim != 2; round < 2; round++) {
        if (device_order(search_for(o->c.dim, 0, round), &t.c, 0, &order, &e) != 0) {
            fail_msg("%s", e.text);
        }
        assert_int_equal(n ? device_read(device, &order, 0, there, n * 4, &e) : 0, 0);
        for (size_t i = 0; i < n; i++) {
            assert_int_equal(there[i], host[i]);
        }
    }
    device_release(device, &order);
    device_release(device, &t.wide);
    free(host);
    free(there);
    free(id);
}

static void orders_as_the_host(void **state)
{
    static const size_t sizes[] = {0, 1, 2, 9, 100, 4095, 4096, 4097, 300000};

    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
            struct owned o = cloud_even(dim, sizes[k], 9),
                         c = cloud_clustered(dim, sizes[k], 100, 5);

            order_of(&o);
            order_of(&c);
            for (size_t i = 0; i < o.c.n; i++) {
                if (i % 3 == 0) { /* coincident, and in one line */
                    o.x[0][i] = 0.25;
                }
                if (i % 9 == 0 && dim > 1) {
                    o.x[1][i] = i % 2 ? 0.0 : -0.0;
                }
            }
            order_of(&o);
            cloud_free(&o);
            cloud_free(&c);
        }
    }
}

static void orders_lattices(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_lattice(dim, dim == 3 ? 60 : dim == 2 ? 450 : 100000, 3);
        struct owned c = cloud_clump(dim, dim == 3 ? 50 : dim == 2 ? 400 : 100000, 1);

        order_of(&o);
        cloud_shuffle(&o, 4);
        order_of(&o);
        order_of(&c);
        for (int k = 0; k < 3; k++) {
            struct owned l = cloud_lattice(dim, dim == 3 ? 40 : 200, 3);

            for (size_t i = 0; i < l.c.n; i++) {
                for (int a = 0; a < dim; a++) {
                    l.x[a][i] = (k + 1) / 40.0 * floor(l.x[a][i] + 0.5) - k;
                }
                l.h[i] = (k + 1) / 40.0 * 1.3;
            }
            order_of(&l);
            cloud_shuffle(&l, 4);
            order_of(&l);
            cloud_free(&l);
        }
        cloud_free(&o);
        cloud_free(&c);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(even_clouds),           cmocka_unit_test(lattices),
        cmocka_unit_test(wide_ranges),           cmocka_unit_test(any_order),
        cmocka_unit_test(ghosts_and_two_arrays), cmocka_unit_test(small_and_odd),
        cmocka_unit_test(far_and_near),          cmocka_unit_test(wrong_numbers),
        cmocka_unit_test(orders_as_the_host),    cmocka_unit_test(orders_lattices)};
    int status;

    device = any_device();
    if (!device) {
        print_message("no OpenCL device with double precision: skipped\n");
        return 77;
    }
    status = cmocka_run_group_tests(tests, NULL, NULL);
    for (struct device_search **s = &kept[0][0][0]; s <= &kept[3][3][1]; s++) {
        device_search_close(*s);
    }
    device_close(device);
    return status;
}
