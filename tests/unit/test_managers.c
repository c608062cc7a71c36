/* tests/unit/test_managers.c -- what the managers of neighbour lists promise beyond right lists,
 * which test_neighbours.c is about: names, work, memory, and the same bits for any number of
 * threads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "clouds.h"

#define SKIN 0.1

static void are_found_by_name(void **state)
{
    static const char *const names[] = {"boxes", "cells", "radix", "octree"};
    const struct neighbour_manager *m;
    size_t n = 0;

    (void)state;
    for (; (m = neighbour_manager_at(n)) != NULL; n++) {
        assert_string_equal(m->name, names[n]);
        assert_ptr_equal(neighbour_manager_find(m->name), m);
        assert_true(strlen(m->doc) > 20);
    }
    assert_int_equal(n, 4);
    assert_ptr_equal(neighbour_manager_at(NEIGHBOURS_OCTREE), neighbour_manager_find("octree"));
    assert_null(neighbour_manager_find("octre"));
    assert_null(neighbour_manager_find(""));
    assert_non_null(neighbour_manager_default());
}

/* Sources looked at and distances computed, for every true pair. */
struct work {
    double visited, distances;
};

static struct work measure(const struct cloud *c, bool symmetric, const struct neighbour_manager *m)
{
    struct group_list l = {0};
    struct error e;
    struct work w;
    double pairs;

    assert_int_equal(group_list_make(&l, c, c, symmetric, SKIN, m, 2, &e), 0);
    assert_ptr_equal(l.manager, m);
    pairs = (double)group_list_count(&l, c, c, 2);
    w.visited = (double)l.visited / pairs;
    w.distances = (double)l.candidates / pairs;
    group_list_fini(&l);
    return w;
}

/* The bar: h that range over a factor of 100 cost the octree at most twice the work for a pair that
 * one h costs. Cells are as wide as the largest reach, and cost more the further h range. */
static void wide_ranges_cost_little(void **state)
{
    struct owned even = cloud_lattice(3, 63, 1), clump = cloud_clump(3, 58, 1);
    double least = INFINITY, most = 0;

    (void)state;
    for (size_t i = 0; i < clump.c.n; i++) {
        least = fmin(least, clump.h[i]);
        most = fmax(most, clump.h[i]);
    }
    assert_true(most / least > 100);
    cloud_sort(&even, cell_best(&even.c));
    cloud_sort(&clump, cell_best(&clump.c));
    print_message("sources looked at, and distances computed, for each true pair\n");
    for (int symmetric = 0; symmetric < 2; symmetric++) {
        const struct neighbour_manager *m;
        struct work cells = {0};

        for (size_t k = 0; (m = neighbour_manager_at(k)) != NULL; k++) {
            struct work one = measure(&even.c, symmetric, m);
            struct work wide = measure(&clump.c, symmetric, m);

            print_message("  %-7s %-9s one h %5.1f %5.1f   h within %.0f %6.1f %5.1f\n", m->name,
                          symmetric ? "symmetric" : "gather", one.visited, one.distances,
                          most / least, wide.visited, wide.distances);
            if (k == NEIGHBOURS_CELLS) {
                cells = wide;
            }
            if (k == NEIGHBOURS_OCTREE) {
                assert_true(wide.visited <= 2 * one.visited);
                assert_true(wide.distances <= 2 * one.distances);
                assert_true(cells.visited > 2 * wide.visited);
            }
        }
    }
    cloud_free(&even);
    cloud_free(&clump);
}

/* An empty box, outliers, coincident points: memory is bounded by the number of points. */
static void memory_is_bounded(void **state)
{
    const struct neighbour_manager *m;

    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        for (int kind = 0; kind < 4; kind++) {
            struct owned o = cloud_even(dim, 20000, 3);

            for (size_t i = 0; i < o.c.n; i++) {
                if (kind == 1 && i % 1000 == 0) {
                    o.x[dim - 1][i] = 1e6 * (double)i; /* flown away */
                } else if (kind == 2) {
                    /* Nearer and nearer to a corner: a tree of many levels. */
                    for (int a = 0; a < dim; a++) {
                        o.x[a][i] *= pow(0.5, (double)(i % 60));
                    }
                    o.h[i] *= pow(0.5, (double)(i % 60));
                } else if (kind == 3 && i % 100) {
                    o.h[i] = 0;
                }
            }
            cloud_sort(&o, cell_best(&o.c));
            for (size_t k = 0; (m = neighbour_manager_at(k)) != NULL; k++) {
                struct group_list l = {0};
                struct error e;
                double bytes;

                assert_int_equal(group_list_make(&l, &o.c, &o.c, false, SKIN, m, 1, &e), 0);
                bytes = (double)l.search_bytes / (double)o.c.n;
                if (!(bytes > 1 && bytes < 600)) {
                    fail_msg("%s, %dD, kind %d: %g bytes a particle", m->name, dim, kind, bytes);
                }
                group_list_fini(&l);
            }
            cloud_free(&o);
        }
    }
}

static void threads_make_no_difference(void **state)
{
    const struct neighbour_manager *m;

    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        struct owned o = kind ? cloud_clustered(3, 20011, 20, 3) : cloud_even(2, 30011, 3);

        cloud_sort(&o, cell_best(&o.c));
        for (size_t k = 0; (m = neighbour_manager_at(k)) != NULL; k++) {
            struct group_list one = {0}, more = {0};
            struct error e;

            assert_int_equal(group_list_make(&one, &o.c, &o.c, true, SKIN, m, 1, &e), 0);
            for (int threads = 2; threads <= 5; threads++) {
                assert_int_equal(group_list_make(&more, &o.c, &o.c, true, SKIN, m, threads, &e), 0);
                assert_int_equal(one.n_span, more.n_span);
                assert_int_equal(one.n_entry, more.n_entry);
                assert_int_equal(one.visited, more.visited);
                assert_int_equal(one.candidates, more.candidates);
                assert_memory_equal(one.begin, more.begin, (one.n_group + 1) * sizeof *one.begin);
                assert_memory_equal(one.span, more.span, one.n_span * sizeof *one.span);
                assert_memory_equal(one.step, more.step, one.n_entry * sizeof *one.step);
            }
            group_list_fini(&one);
            group_list_fini(&more);
        }
        cloud_free(&o);
    }
}

/* The count of true pairs, against the long way. */
static void counts_true_pairs(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_clustered(dim, 1003, 10, 4);

        for (int symmetric = 0; symmetric < 2; symmetric++) {
            struct group_list l = {0};
            struct error e;
            uint64_t pairs = 0;

            for (size_t i = 0; i < o.c.n; i++) {
                for (size_t j = 0; j < o.c.n; j++) {
                    double reach = 2 * (symmetric ? fmax(o.h[i], o.h[j]) : o.h[i]), r2 = 0;

                    for (int a = 0; a < dim; a++) {
                        r2 += (o.x[a][i] - o.x[a][j]) * (o.x[a][i] - o.x[a][j]);
                    }
                    pairs += r2 < reach * reach;
                }
            }
            assert_int_equal(group_list_make(&l, &o.c, &o.c, symmetric, SKIN, NULL, 1, &e), 0);
            for (int threads = 1; threads < 4; threads++) {
                assert_int_equal(group_list_count(&l, &o.c, &o.c, threads), pairs);
            }
            group_list_fini(&l);
        }
        cloud_free(&o);
    }
}

/* -- Too many neighbours ------------------------------------------------------------------------ */

static uint64_t neighbours_of(const struct cloud *c, size_t i, bool symmetric)
{
    uint64_t n = 0;

    for (size_t j = 0; j < c->n; j++) {
        double reach = c->scale * (symmetric ? fmax(c->h[i], c->h[j]) : c->h[i]), r2 = 0;

        for (int a = 0; a < c->dim; a++) {
            r2 += (c->x[a][i] - c->x[a][j]) * (c->x[a][i] - c->x[a][j]);
        }
        n += j != i && r2 < reach * reach;
    }
    return n;
}

/* Of points of which some see too many: all are counted, and the first is the same for any number of
 * threads. Then the list that is to end there fails, and its memory is good for another. */
static void check_crowd(struct owned *o, uint64_t most, bool symmetric)
{
    uint64_t n = 0, of_first = 0;
    size_t first = SIZE_MAX;

    for (size_t i = 0; i < o->c.n; i++) {
        uint64_t k = neighbours_of(&o->c, i, symmetric);

        n += k > most;
        if (k > most && first == SIZE_MAX) {
            first = i;
            of_first = k;
        }
    }
    for (int threads = 1; threads <= 4; threads += 3) {
        struct group_list l = {.crowd = {.most = most}};
        struct error e;

        assert_int_equal(group_list_make(&l, &o->c, &o->c, symmetric, 0.1, NULL, threads, &e), 0);
        assert_int_equal(l.crowd.n, n);
        for (int stops = 0; stops < 2 && n > 0; stops++) {
            assert_int_equal(l.crowd.first, first);
            assert_int_equal(l.crowd.neighbours, of_first);
            l.crowd.stops = true;
            assert_int_equal(group_list_make(&l, &o->c, &o->c, symmetric, 0.1, NULL, threads, &e),
                             -1);
            assert_int_equal(l.n_entry, 0);
        }
        l.crowd.most = o->c.n;
        assert_int_equal(group_list_make(&l, &o->c, &o->c, symmetric, 0.1, NULL, threads, &e), 0);
        assert_int_equal(l.crowd.n, 0);
        group_list_fini(&l);
    }
}

static void crowds(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_even(dim, 9000, 7);

        check_crowd(&o, 60, false);
        for (size_t i = 5003; i < 9000; i += 1500) {
            o.h[i] *= 6;
        }
        check_crowd(&o, 60, false);
        check_crowd(&o, 60, true);
        check_crowd(&o, 9000, true);
        cloud_free(&o);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(are_found_by_name), cmocka_unit_test(wide_ranges_cost_little),
        cmocka_unit_test(memory_is_bounded), cmocka_unit_test(threads_make_no_difference),
        cmocka_unit_test(counts_true_pairs), cmocka_unit_test(crowds),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
