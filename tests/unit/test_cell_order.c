/* tests/unit/test_cell_order.c -- the order of cells: what it promises, for clouds of many
 * kinds. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "clouds.h"
#include "neighbours/range.h"

static void check_permutation(const uint32_t *order, size_t n)
{
    char *seen = calloc(n + 1, 1);

    for (size_t i = 0; i < n; i++) {
        assert_true(order[i] < n);
        assert_false(seen[order[i]]);
        seen[order[i]] = 1;
    }
    free(seen);
}

static void orders_by_cells(void **state)
{
    struct error e;

    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        /* Few enough a cell that none is divided. */
        size_t n = 3000;
        double cell = pow(8.0 / (double)n, 1.0 / dim);
        struct owned o = cloud_even(dim, n, 77);
        uint32_t *order = malloc(n * sizeof *order);

        for (size_t i = 0; i < n; i++) {
            o.x[0][i] -= 0.5; /* cells count from a multiple of the edge, not from zero */
        }
        assert_int_equal(cell_order(&o.c, NULL, cell, 1, order, &e), 0);
        check_permutation(order, n);
        for (size_t i = 0; i + 1 < n; i++) {
            double key[2] = {0, 0};

            for (int k = 0; k < 2; k++) {
                for (int a = dim - 1; a >= 0; a--) {
                    key[k] = 10000 * key[k] + floor(o.x[a][order[i + (size_t)k]] / cell);
                }
            }
            assert_true(key[0] <= key[1]);
            if (!(key[0] < key[1])) {
                assert_true(o.x[0][order[i]] <= o.x[0][order[i + 1]]);
            }
        }
        free(order);
        cloud_free(&o);
    }
}

/* Equal positions by id; the same whatever order the points came in. */
static void order_follows_the_id(void **state)
{
    struct owned o = cloud_clustered(2, 2000, 30, 5);
    size_t n = o.c.n;
    int64_t *id = malloc(n * sizeof *id), *first = malloc(n * sizeof *id);
    uint32_t *order = malloc(n * sizeof *order);
    struct error e;

    (void)state;
    for (size_t i = 0; i < n; i++) {
        id[i] = (int64_t)i;
        if (i % 5 == 0) {
            o.x[0][i] = o.x[1][i] = 0.3;
        }
    }
    for (int round = 0; round < 3; round++) {
        uint64_t seed = (uint64_t)round;

        assert_int_equal(cell_order(&o.c, id, 0.05, 1, order, &e), 0);
        check_permutation(order, n);
        for (size_t i = 0; i < n; i++) {
            if (round == 0) {
                first[i] = id[order[i]];
            } else {
                assert_int_equal(id[order[i]], first[i]);
            }
        }
        for (size_t i = n - 1; i > 0; i--) {
            size_t j = (size_t)(random_unit(&seed) * (double)i);
            int64_t k = id[i];

            id[i] = id[j];
            id[j] = k;
            for (int a = 0; a < 2; a++) {
                double t = o.x[a][i];

                o.x[a][i] = o.x[a][j];
                o.x[a][j] = t;
            }
        }
    }
    free(order);
    free(id);
    free(first);
    cloud_free(&o);
}

/* Any edge, any cloud: outliers, coincident points, one cell or far too many. */
static void orders_anything(void **state)
{
    static const double edge[] = {1e-300, 1e-12, 0.01, 1, 1e300, 0, -1, NAN};
    struct error e;

    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_clustered(dim, 3000, 100, 2);
        uint32_t *order = malloc(o.c.n * sizeof *order);

        for (size_t i = 0; i < o.c.n; i++) {
            if (i % 3 == 0) {
                o.x[0][i] = 0.5;
            }
            if (i % 500 == 1) {
                o.x[dim - 1][i] = pow(10, (double)(i / 20));
            }
        }
        for (size_t k = 0; k < sizeof edge / sizeof edge[0]; k++) {
            assert_int_equal(cell_order(&o.c, NULL, edge[k], 1, order, &e), 0);
            check_permutation(order, o.c.n);
        }
        o.c.n = 0;
        assert_int_equal(cell_order(&o.c, NULL, 1, 1, order, &e), 0);
        free(order);
        cloud_free(&o);
    }
}

/* Many points, in cells of many widths, in a cloud in which some cells are crowded. */
static void threads_make_no_difference(void **state)
{
    static const double edge[] = {0.001, 0.03, 0.2, 3, 0};
    struct error e;

    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_clustered(dim, 20011, 30, 2);
        size_t bytes = o.c.n * sizeof(uint32_t);
        uint32_t *one = malloc(bytes), *more = malloc(bytes);

        for (size_t k = 0; k < sizeof edge / sizeof edge[0]; k++) {
            assert_int_equal(cell_order(&o.c, NULL, edge[k], 1, one, &e), 0);
            check_permutation(one, o.c.n);
            for (int threads = 2; threads < 6; threads++) {
                assert_int_equal(cell_order(&o.c, NULL, edge[k], threads, more, &e), 0);
                assert_memory_equal(one, more, bytes);
            }
        }
        free(one);
        free(more);
        cloud_free(&o);
    }
}

/* The best edge is so many spacings whatever the reach is, at surfaces too, and it is found for any
 * cloud: no number may keep it from ending. */
static void best_edge_follows_the_spacing(void **state)
{
    static const double wild[] = {NAN, INFINITY, -INFINITY, 1e200, -1e300};

    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_lattice(dim, dim == 3 ? 31 : dim == 2 ? 170 : 5000, 3);
        double spacings = dim == 3 ? 2.0 : 3.2;

        for (double h = 1.1; h < 1.6; h += 0.1) {
            for (size_t i = 0; i < o.c.n; i++) {
                o.h[i] = h;
            }
            assert_true(fabs(cell_best(&o.c) / spacings - 1) < 0.04);
        }
        o.h[0] = 100; /* a range that is wide: three reaches or more */
        assert_true(cell_best(&o.c) > 3 * 2 * 1.5);
        o.h[0] = 1.5;
        for (size_t k = 0; k < sizeof wild / sizeof wild[0]; k++) {
            o.x[dim - 1][7] = wild[k];
            assert_true(cell_best(&o.c) > 0);
            o.x[dim - 1][7] = 0;
            o.h[7] = wild[k];
            (void)cell_best(&o.c);
            o.h[7] = 1.5;
        }
        o.c.n = 1;
        assert_true(cell_best(&o.c) > 0);
        o.c.n = 0;
        assert_false(cell_best(&o.c) > 0);
        cloud_free(&o);
    }
}

static void ranges(void **state)
{
    const size_t n = 40000;
    double *x = calloc(n, sizeof *x);
    uint64_t seed = 9;

    (void)state;
    assert_non_null(x);
    for (size_t i = 0; i < n; i++) {
        x[i] = random_unit(&seed) - 0.3;
    }
    x[13] = NAN;
    for (size_t m = 0; m < n; m = m < 40 ? m + 1 : m * 3) {
        double least = INFINITY, most = -INFINITY;

        for (size_t i = 0; i < m; i++) {
            least = fmin(least, x[i]);
            most = fmax(most, x[i]);
        }
        for (int threads = 1; threads < 4; threads++) {
            struct range r = range_of(x, m, threads);

            assert_memory_equal(&r.least, &least, sizeof least);
            assert_memory_equal(&r.most, &most, sizeof most);
        }
    }
    free(x);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(orders_by_cells),
        cmocka_unit_test(order_follows_the_id),
        cmocka_unit_test(orders_anything),
        cmocka_unit_test(threads_make_no_difference),
        cmocka_unit_test(best_edge_follows_the_spacing),
        cmocka_unit_test(ranges),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
