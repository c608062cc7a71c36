/* tests/unit/test_neighbours.c -- lists against all pairs, for clouds of many kinds. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "clouds.h"
#include "domain/sides.h"
#include "neighbours/filter.h"

#define GROUP 8

/* -- All pairs --------------------------------------------------------------------------------- */

static double square(const struct cloud *d, size_t i, const struct cloud *s, size_t j)
{
    double sum = 0;

    for (int a = 0; a < d->dim; a++) {
        double x = d->x[a][i] - s->x[a][j];

        sum += x * x;
    }
    return sum;
}

static double pair_reach(const struct cloud *d, size_t i, const struct cloud *s, size_t j,
                         bool symmetric)
{
    double own = d->scale * d->h[i];

    return symmetric ? fmax(own, s->scale * s->h[j]) : own;
}

/* Bits of the halves of group g that are so near source j: r < reach times `factor`, or where that
 * is allowed r = it. */
static unsigned near_halves(const struct cloud *d, const struct cloud *s, size_t g, size_t j,
                            bool symmetric, double factor, bool equal)
{
    size_t last = g * GROUP + GROUP < d->n ? g * GROUP + GROUP : d->n;
    unsigned halves = 0;

    for (size_t i = g * GROUP; i < last; i++) {
        double reach = pair_reach(d, i, s, j, symmetric) * factor;
        double r = sqrt(square(d, i, s, j));

        if (r < reach || (equal && r == reach)) {
            halves |= i % GROUP < GROUP / 2 ? 1u : 2u;
        }
    }
    return halves;
}

/* For each source, which halves of group g its list makes meet it: bits, and 4 for each time that it
 * is there. */
static void walk_halves(const struct group_list *l, size_t g, unsigned *met)
{
    for (uint64_t n = l->begin[g]; n < l->begin[g + 1]; n++) {
        const sph_span *span = &l->span[n];

        assert_int_equal((span->count - span->common) % 2, 0);
        for (uint32_t k = 0; k < span->count; k++) {
            unsigned halves = k < span->common ? 3 : (k - span->common) % 2 ? 2 : 1;

            met[span->base + l->step[span->first + k]] += 4 + halves;
        }
    }
}

/* The list of a group against all sources: once all that is within reach and skin of a lane, and
 * then for all lanes of that half; nothing that is a thousandth beyond it. */
static void check_group(const struct group_list *l, size_t g, const struct cloud *d,
                        const struct cloud *s, bool symmetric, double skin)
{
    unsigned *met = calloc(s->n + 1, sizeof *met);

    assert_non_null(met);
    walk_halves(l, g, met);
    for (size_t j = 0; j < s->n; j++) {
        unsigned needed = near_halves(d, s, g, j, symmetric, 1 + skin, false);
        /* Reaches of a group that differ by 0.4 % may be taken as one. */
        unsigned allowed = near_halves(d, s, g, j, symmetric, (1 + skin) * 1.005, true);

        if (j / GROUP == g && met[j]) {
            assert_int_equal(met[j] % 4, 3); /* as if they were the destinations */
        }
        if (met[j] >= 8 || (needed & ~met[j]) || (met[j] && !allowed)) {
            fail_msg("group %zu, source %zu: %u times for %u, not for %u", g, j, met[j] / 4,
                     met[j] % 4, needed);
        }
    }
    free(met);
}

/* Steps follow each other, spans too, and no span could have been longer. */
static void check_spans(const struct group_list *l)
{
    uint64_t entries = 0;

    assert_int_equal(l->begin[l->n_group], l->n_span);
    for (size_t g = 0; g < l->n_group; g++) {
        uint64_t before = entries;

        for (uint64_t s = l->begin[g]; s < l->begin[g + 1]; s++) {
            bool base = false;

            assert_int_equal(l->span[s].first, entries);
            assert_true(l->span[s].count > 0 && l->span[s].common <= l->span[s].count);
            for (uint32_t k = 0; k < l->span[s].count; k++) {
                base = base || l->step[entries + k] == 0;
            }
            assert_true(base);
            assert_true(s == l->begin[g] || l->span[s].base - l->span[s - 1].base >= UINT16_MAX);
            entries += l->span[s].count;
        }
        assert_int_equal(group_list_entries(l, g, g + 1), entries - before);
    }
    assert_int_equal(l->n_entry, entries);
    assert_int_equal(group_list_entries(l, 0, l->n_group), entries);
}

static void same_lists(const struct group_list *a, const struct group_list *b)
{
    assert_int_equal(a->n_group, b->n_group);
    assert_int_equal(a->n_span, b->n_span);
    assert_int_equal(a->n_entry, b->n_entry);
    assert_memory_equal(a->begin, b->begin, (a->n_group + 1) * sizeof *a->begin);
    assert_memory_equal(a->span, b->span, a->n_span * sizeof *a->span);
    assert_memory_equal(a->step, b->step, a->n_entry * sizeof *a->step);
}

/* Every manager gives this list. */
static void check_managers(const struct group_list *l, const struct cloud *d, const struct cloud *s,
                           double skin, const struct filter *filter)
{
    const struct neighbour_manager *manager;

    for (size_t k = 1; (manager = neighbour_manager_at(k)) != NULL; k++) {
        struct group_list other = {0};
        struct error e;

        assert_int_equal(filter_make(&other, d, s, l->symmetric, skin, manager, 1, filter, &e), 0);
        same_lists(l, &other);
        assert_true(other.visited > 0 || other.n_entry == 0);
        group_list_fini(&other);
    }
}

static void check_with(const struct cloud *d, const struct cloud *s, const struct filter *filter)
{
    static const double skins[2] = {0, 0.1};
    const struct neighbour_manager *manager = neighbour_manager_at(0);
    struct group_list l = {0};
    struct error e;

    for (int k = 0; k < 4; k++) {
        bool symmetric = k / 2 > 0;
        double skin = skins[k % 2];

        assert_int_equal(filter_make(&l, d, s, symmetric, skin, manager, 1, filter, &e), 0);
        assert_int_equal(l.n_group, (d->n + GROUP - 1) / GROUP);
        assert_int_equal(l.symmetric, symmetric);
        assert_int_equal(l.begin[0], 0);
        for (size_t g = 0; g < l.n_group; g++) {
            check_group(&l, g, d, s, symmetric, skin);
        }
        check_spans(&l);
        assert_true(group_list_bytes(&l) >=
                    8 * (l.n_group + 1) + sizeof *l.span * l.n_span + 2 * l.n_entry);
        check_managers(&l, d, s, skin, filter);
    }
    group_list_fini(&l);
}

static void check(const struct cloud *d, const struct cloud *s)
{
    check_with(d, s, filter_best());
    check_with(d, s, filter_plain());
    if (filter_avx2() && filter_avx2() != filter_best()) {
        check_with(d, s, filter_avx2());
    }
}

/* -- Lists ------------------------------------------------------------------------------------- */

static void few_points(void **state)
{
    static const size_t count[] = {1, 2, 7, 8, 9, 16, 63, 64, 65, 71, 100};

    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        for (size_t k = 0; k < sizeof count / sizeof count[0]; k++) {
            struct owned o = cloud_even(dim, count[k], k + 1);

            check(&o.c, &o.c);
            cloud_free(&o);
        }
    }
}

static void even_clouds(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_even(dim, 1501, 11);

        check(&o.c, &o.c); /* as they come: the tree takes an order of its own */
        cloud_sort(&o, 2 * o.h[0]);
        check(&o.c, &o.c);
        for (size_t i = 0; i < o.c.n; i++) {
            o.h[i] *= 0.9 + 0.2 * o.x[0][i];
        }
        check(&o.c, &o.c);
        cloud_free(&o);
    }
}

static void clustered_clouds(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        for (double ratio = 7; ratio <= 100; ratio += 93) {
            struct owned o = cloud_clustered(dim, 1403, ratio, 5);

            check(&o.c, &o.c);
            cloud_sort(&o, even_h(dim, 1403, 20));
            check(&o.c, &o.c);
            cloud_free(&o);
        }
        struct owned o = cloud_core(dim, 1403, 2, 4);

        cloud_sort(&o, 0.1);
        check(&o.c, &o.c);
        cloud_free(&o);
    }
}

/* A few sources of a hundred times the reach among many small ones, and h = 0. */
static void wild_reaches(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_even(dim, 1100, 3);

        cloud_sort(&o, 2 * o.h[0]);
        for (size_t i = 0; i < o.c.n; i++) {
            o.h[i] *= i % 100 == 7 ? 100 * o.h[i] : i % 13 == 5 ? 0 : 0.2;
        }
        check(&o.c, &o.c);
        memset(o.h, 0, o.c.n * sizeof *o.h);
        check(&o.c, &o.c);
        cloud_free(&o);
    }
}

static void two_clouds(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned d = cloud_even(dim, 403, 21), s = cloud_clustered(dim, 1205, 10, 22);

        d.c.scale = 3;
        check(&d.c, &s.c);
        check(&s.c, &d.c);
        cloud_sort(&d, 0.1);
        cloud_sort(&s, 0.1);
        check(&d.c, &s.c);
        check(&s.c, &d.c);
        /* Apart: empty lists, but for the symmetric reach. */
        for (size_t i = 0; i < s.c.n; i++) {
            s.x[0][i] += 3;
        }
        check(&d.c, &s.c);
        cloud_free(&d);
        cloud_free(&s);
    }
}

static void gather_needs_no_source_h(void **state)
{
    struct owned d = cloud_even(2, 300, 2), s = cloud_even(2, 900, 4);
    struct group_list with = {0}, without = {0};
    struct cloud bare = s.c;
    struct error e;

    (void)state;
    bare.h = NULL;
    assert_int_equal(group_list_make(&with, &d.c, &s.c, false, 0.1, NULL, 1, &e), 0);
    assert_int_equal(group_list_make(&without, &d.c, &bare, false, 0.1, NULL, 1, &e), 0);
    assert_true(with.n_entry > 0);
    same_lists(&with, &without);
    assert_int_equal(group_list_make(&without, &d.c, &bare, true, 0.1, NULL, 1, &e), -1);
    group_list_fini(&with);
    group_list_fini(&without);
    cloud_free(&d);
    cloud_free(&s);
}

/* Sources that stand further apart than a step goes: several spans a group. */
static void many_sources(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned d = cloud_even(dim, 61, 31), s = cloud_even(dim, 200000, 32);
        struct group_list l = {0};
        struct error e;

        for (size_t i = 0; i < d.c.n; i++) {
            d.h[i] = even_h(dim, s.c.n, 20 + (double)i);
        }
        assert_int_equal(group_list_make(&l, &d.c, &s.c, true, 0.1, NULL, 1, &e), 0);
        check_spans(&l);
        assert_true(l.n_span > 2 * l.n_group);
        for (size_t g = 0; g < l.n_group; g++) {
            check_group(&l, g, &d.c, &s.c, true, 0.1);
        }
        group_list_fini(&l);
        cloud_free(&d);
        cloud_free(&s);
    }
}

static void empty_clouds(void **state)
{
    struct owned some = cloud_even(2, 20, 1), none = cloud_new(2, 0);
    struct group_list l = {0};
    struct error e;

    (void)state;
    assert_int_equal(group_list_make(&l, &some.c, &some.c, true, 0, NULL, 2, &e), 0);
    assert_true(l.begin[3] > 0);
    assert_int_equal(group_list_make(&l, &some.c, &none.c, true, 0, NULL, 2, &e), 0);
    assert_int_equal(l.n_group, 3);
    for (size_t g = 0; g <= 3; g++) {
        assert_int_equal(l.begin[g], 0);
    }
    assert_int_equal(group_list_make(&l, &none.c, &some.c, true, 0, NULL, 2, &e), 0);
    assert_int_equal(l.n_group, 0);
    assert_int_equal(l.begin[0], 0);
    group_list_fini(&l);
    cloud_free(&some);
    cloud_free(&none);
}

static void coincident_points(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_even(dim, 700, 8);

        for (size_t i = 0; i < o.c.n; i++) {
            for (int a = 0; a < dim; a++) {
                o.x[a][i] = i % 3 ? 0.25 : o.x[a][i];
            }
        }
        check(&o.c, &o.c);
        cloud_sort(&o, 0.1);
        check(&o.c, &o.c);
        cloud_free(&o);
    }
}

/* Particles that have flown away cost neither memory nor correctness; nor does a far origin. */
static void outliers(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_even(dim, 1201, 9);
        struct error e;
        struct group_list l = {0};

        for (size_t i = 0; i < o.c.n; i += 100) {
            o.x[dim - 1][i] = i % 200 ? 1e9 + (double)i : -1e12;
            o.x[0][i + 1] = 1e9 + 1e-3 * (double)(i % 300);
        }
        o.x[0][700] = 1e100;
        o.x[0][701] = -1e149;
        check(&o.c, &o.c);
        cloud_sort(&o, 0.1);
        check(&o.c, &o.c);
        assert_int_equal(group_list_make(&l, &o.c, &o.c, true, 0.1, NULL, 1, &e), 0);
        assert_true(group_list_bytes(&l) < 1000000);
        group_list_fini(&l);
        for (size_t i = 0; i < o.c.n; i++) {
            o.x[0][i] += 1e6;
        }
        check(&o.c, &o.c);
        cloud_free(&o);
    }
}

static void any_unit_of_length(void **state)
{
    (void)state;
    for (double unit = 1e-30; unit < 1e31; unit *= 1e20) {
        struct owned o = cloud_clustered(3, 900, 10, 6);

        for (size_t i = 0; i < o.c.n; i++) {
            for (int a = 0; a < 3; a++) {
                o.x[a][i] *= unit;
            }
            o.h[i] *= unit;
        }
        cloud_sort(&o, 0.1 * unit);
        check(&o.c, &o.c);
        cloud_free(&o);
    }
}

/* A reach that takes in the whole cloud. */
static void all_pairs(void **state)
{
    struct owned o = cloud_even(3, 1003, 6);

    (void)state;
    for (size_t i = 0; i < o.c.n; i++) {
        o.h[i] = i % 2 ? 1 : 10;
    }
    check(&o.c, &o.c);
    cloud_free(&o);
}

/* With ghosts: the pairs of the periodic cloud, by the nearest images. */
static void periodic_clouds(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_even(dim, 500, 12);
        struct box box = {.dim = dim, .bounded = true, .max = {1, 1, 1}};
        struct particles p;
        struct ghosts ghosts = {0};
        struct group_list l = {0};
        struct error e;
        double reach = 2 * o.h[0];
        size_t listed = 0, wanted = 0;

        cloud_sort(&o, reach);
        particles_init(&p, "gas", dim, &e);
        particles_add(&p, "x", "", "", SPH_VECTOR, &e);
        particles_add(&p, "h", "", "", SPH_SCALAR, &e);
        particles_resize(&p, o.c.n, 0, &e);
        memcpy(particles_real(&p, "h", 0), o.h, o.c.n * sizeof *o.h);
        for (int a = 0; a < dim; a++) {
            box.side[a][0] = box.side[a][1] = SIDE_PERIODIC;
            memcpy(particles_real(&p, "x", (uint32_t)a), o.x[a], o.c.n * sizeof *o.h);
        }
        assert_int_equal(ghosts_make(&ghosts, &box, &p, 1.1 * reach, &e), 0);
        struct cloud d = o.c, s = o.c;

        s.n = p.n + p.n_ghost;
        s.h = particles_real(&p, "h", 0);
        for (int a = 0; a < dim; a++) {
            s.x[a] = particles_real(&p, "x", (uint32_t)a);
        }
        check(&d, &s);
        assert_int_equal(group_list_make(&l, &d, &s, true, 0.1, NULL, 1, &e), 0);
        for (size_t i = 0; i < d.n; i++) {
            for (struct source_walk w = source_walk_begin(&l, i / GROUP);
                 source_walk_next(&l, &w);) {
                listed += square(&d, i, &s, w.source) < reach * reach;
            }
            for (size_t j = 0; j < d.n; j++) {
                double sum = 0;

                for (int a = 0; a < dim; a++) {
                    double x = d.x[a][i] - d.x[a][j];

                    x -= floor(x + 0.5);
                    sum += x * x;
                }
                wanted += sum < reach * reach;
            }
        }
        assert_int_equal(listed, wanted);
        assert_true(wanted > 5 * d.n);
        group_list_fini(&l);
        ghosts_fini(&ghosts);
        particles_fini(&p);
        cloud_free(&o);
    }
}

/* Many chunks; sorted, and in the tree's own order; a list that is used again. */
static void threads_make_no_difference(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        struct owned o = k % 2 ? cloud_clustered(2, 30011, 20, 3) : cloud_even(2, 30011, 3);
        struct group_list one = {0}, more = {0};
        struct error e;

        if (k / 2) {
            cloud_sort(&o, 4 * o.h[0]);
        }
        assert_int_equal(group_list_make(&one, &o.c, &o.c, true, 0.1, NULL, 1, &e), 0);
        assert_true(one.begin[one.n_group] > 0);
        for (int threads = 2; threads <= 4; threads++) {
            assert_int_equal(group_list_make(&more, &o.c, &o.c, true, 0.1, NULL, threads, &e), 0);
            same_lists(&one, &more);
            assert_int_equal(one.candidates, more.candidates);
        }
        assert_int_equal(group_list_make(&more, &o.c, &o.c, true, 0.1, NULL, 1, &e), 0);
        same_lists(&one, &more);
        for (size_t g = 0; g < one.n_group; g += 401) {
            check_group(&one, g, &o.c, &o.c, true, 0.1);
        }
        group_list_fini(&one);
        group_list_fini(&more);
        cloud_free(&o);
    }
}

/* The work of a search stays near the true pairs, whatever the ratio of h: it is no n^2. */
static void work_is_bounded(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        struct owned o = cloud_core(3, 40000, k == 0 ? 1 : 1.5 * k, 3);
        struct group_list l = {0};
        struct error e;
        uint64_t pairs;

        cloud_sort(&o, 2 * even_h(3, 40000, 20));
        assert_int_equal(group_list_make(&l, &o.c, &o.c, false, 0, NULL, 1, &e), 0);
        pairs = GROUP * l.n_entry;
        assert_true(l.candidates < 10 * pairs);
        /* Unsorted, the groups are bad, but the search is still local. */
        uint64_t seed = 5;

        for (size_t i = o.c.n - 1; i > 0; i--) {
            size_t j = (size_t)(random_unit(&seed) * (double)i);

            for (int a = 0; a <= 3; a++) {
                double *x = a < 3 ? o.x[a] : o.h, t = x[i];

                x[i] = x[j];
                x[j] = t;
            }
        }
        assert_int_equal(group_list_make(&l, &o.c, &o.c, false, 0, NULL, 1, &e), 0);
        pairs = GROUP * l.n_entry;
        assert_true(l.candidates < 12 * pairs);
        group_list_fini(&l);
        cloud_free(&o);
    }
}

static void refuses(void **state)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY, 1e200};
    struct owned o = cloud_even(2, 100, 1), other = cloud_even(3, 10, 1),
                 good = cloud_even(2, 50, 2);
    struct group_list l = {0};
    struct error e;
    uint32_t order[100];

    (void)state;
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        double old = o.x[1][37];

        o.x[1][37] = bad[k];
        assert_int_equal(group_list_make(&l, &o.c, &o.c, true, 0.1, NULL, 1, &e), -1);
        assert_non_null(strstr(e.text, "particle 37"));
        assert_int_equal(e.exit_code, EXIT_RUN);
        assert_int_equal(group_list_make(&l, &good.c, &o.c, true, 0.1, NULL, 1, &e), -1);
        assert_non_null(strstr(e.text, "source particle 37"));
        assert_int_equal(group_list_make(&l, &o.c, &good.c, true, 0.1, NULL, 1, &e), -1);
        assert_non_null(strstr(e.text, "destination particle 37"));
        assert_int_equal(cell_order(&o.c, NULL, 0.1, 1, order, &e), -1);
        assert_non_null(strstr(e.text, "particle 37"));
        o.x[1][37] = old;
        old = o.h[99];
        o.h[99] = k == 2 ? -1e-9 : bad[k];
        assert_int_equal(group_list_make(&l, &o.c, &o.c, true, 0.1, NULL, 1, &e), -1);
        assert_non_null(strstr(e.text, "particle 99"));
        o.h[99] = old;
    }
    assert_int_equal(group_list_make(&l, &o.c, &other.c, true, 0.1, NULL, 1, &e), -1);
    assert_int_equal(group_list_make(&l, &o.c, &o.c, true, -0.1, NULL, 1, &e), -1);
    assert_int_equal(group_list_make(&l, &o.c, &o.c, true, NAN, NULL, 1, &e), -1);
    /* And still works. */
    assert_int_equal(group_list_make(&l, &o.c, &o.c, true, 0.1, NULL, 1, &e), 0);
    group_list_fini(&l);
    cloud_free(&o);
    cloud_free(&other);
    cloud_free(&good);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(few_points),         cmocka_unit_test(even_clouds),
        cmocka_unit_test(clustered_clouds),   cmocka_unit_test(wild_reaches),
        cmocka_unit_test(two_clouds),         cmocka_unit_test(gather_needs_no_source_h),
        cmocka_unit_test(many_sources),       cmocka_unit_test(empty_clouds),
        cmocka_unit_test(coincident_points),  cmocka_unit_test(outliers),
        cmocka_unit_test(any_unit_of_length), cmocka_unit_test(all_pairs),
        cmocka_unit_test(periodic_clouds),    cmocka_unit_test(threads_make_no_difference),
        cmocka_unit_test(work_is_bounded),    cmocka_unit_test(refuses),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
