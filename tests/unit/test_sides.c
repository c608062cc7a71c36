/* tests/unit/test_sides.c -- wrapping, and ghosts against all images found the long way. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "domain/sides.h"
#include "neighbours/neighbours.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double random_unit(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

static struct box make_box(int dim, enum side low, enum side high)
{
    struct box b = {.dim = dim, .bounded = true};

    for (int a = 0; a < 3; a++) {
        b.min[a] = -1 - a;
        b.max[a] = 1;
        b.side[a][0] = low;
        b.side[a][1] = high;
    }
    return b;
}

/* x, v, h, a tensor, a matrix, integers; all but the position are made of the index. */
static struct particles make(int dim, size_t n, const struct box *box, uint64_t seed)
{
    struct particles p;
    struct error e;

    assert_int_equal(particles_init(&p, "fluid", dim, &e), 0);
    particles_add(&p, "x", "", "", SPH_VECTOR, &e);
    particles_add(&p, "v", "", "", SPH_VECTOR, &e);
    particles_add(&p, "h", "", "", SPH_SCALAR, &e);
    particles_add(&p, "s", "", "", SPH_SYM, &e);
    particles_add(&p, "m", "", "", SPH_MATRIX, &e);
    particles_add(&p, "i", "", "", SPH_INT32, &e);
    particles_add(&p, "l", "", "", SPH_INT64, &e);
    assert_int_equal(particles_resize(&p, n, 0, &e), 0);
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < 5; k++) {
            p.column[k].state = true;
            for (uint32_t c = 0; c < p.column[k].ncomp; c++) {
                ((double *)p.column[k].data)[c * p.column[k].plane + i] =
                    (double)(1 + i + 1000 * c + 100000 * k);
            }
        }
        for (int a = 0; a < dim; a++) {
            double *x = particles_real(&p, "x", (uint32_t)a);

            x[i] = box->min[a] + (box->max[a] - box->min[a]) * random_unit(&seed);
        }
        ((int32_t *)p.column[5].data)[i] = (int32_t)i + 7;
        ((int64_t *)p.column[6].data)[i] = (int64_t)i << 40;
    }
    return p;
}

/* -- Wrapping ---------------------------------------------------------------------------------- */

static void wraps_periodic(void **state)
{
    struct box box = make_box(2, SIDE_PERIODIC, SIDE_PERIODIC);
    struct particles p = make(2, 6, &box, 1);
    double *x = particles_real(&p, "x", 0), *y = particles_real(&p, "x", 1);
    double *v = particles_real(&p, "v", 0);
    static const double in[6] = {0.5, 1.25, -1.25, 1, 9.5, 0};
    static const double want[6] = {0.5, -0.75, 0.75, -1, -0.5, -1};

    (void)state;
    memcpy(x, in, sizeof in);
    for (int i = 0; i < 6; i++) {
        y[i] = 0;
    }
    x[5] = nextafter(-1, -2);
    assert_int_equal(sides_wrap(&box, &p), 5);
    for (int i = 0; i < 6; i++) {
        if (i < 5) {
            assert_true(fabs(x[i] - want[i]) < 1e-14);
        }
        assert_true(x[i] >= -1 && x[i] < 1);
        assert_true(y[i] == 0);
        assert_true(v[i] == 100001 + i);
    }
    assert_int_equal(sides_wrap(&box, &p), 0);
    /* A hair before the side: the other end, in floating point, is the side itself. */
    box.min[0] = 0;
    for (int i = 0; i < 6; i++) {
        x[i] = -1e-30;
    }
    assert_int_equal(sides_wrap(&box, &p), 6);
    assert_true(x[0] == 0);
    particles_fini(&p);
}

static void reflects(void **state)
{
    struct box box = make_box(2, SIDE_MIRROR, SIDE_MIRROR);
    struct particles p = make(2, 5, &box, 1);
    double *x = particles_real(&p, "x", 0), *y = particles_real(&p, "x", 1);
    static const double in[5] = {0.5, 1.25, -1.25, 3.5, -9.75};

    (void)state;
    memcpy(x, in, sizeof in);
    for (int i = 0; i < 5; i++) {
        y[i] = 0;
    }
    assert_int_equal(sides_wrap(&box, &p), 4);
    for (int i = 0; i < 5; i++) {
        /* Followed by hand, side after side. */
        double q = in[i];
        int turns = 0;

        while (q < -1 || q > 1) {
            q = q < -1 ? -2 - q : 2 - q;
            turns++;
        }
        assert_true(fabs(x[i] - q) < 1e-14);
        assert_int_equal(turns, (int)ceil((fabs(in[i]) - 1) / 2 - 1e-9));
        double sign = turns % 2 ? -1 : 1;

        assert_true(particles_real(&p, "v", 0)[i] == sign * (100001 + i));
        assert_true(particles_real(&p, "v", 1)[i] == 101001 + i);
        assert_true(particles_real(&p, "h", 0)[i] == 200001 + i);
        assert_true(particles_real(&p, "s", 0)[i] == 300001 + i);          /* xx */
        assert_true(particles_real(&p, "s", 1)[i] == sign * (301001 + i)); /* xy */
        assert_true(particles_real(&p, "s", 2)[i] == 302001 + i);          /* yy */
        assert_true(particles_real(&p, "m", 2)[i] == sign * (402001 + i)); /* yx */
        assert_true(particles_real(&p, "m", 3)[i] == 403001 + i);
    }
    particles_fini(&p);
}

static void leaves_open_sides(void **state)
{
    struct box box = make_box(1, SIDE_MIRROR, SIDE_OPEN);
    struct particles p = make(1, 3, &box, 1);
    double *x = particles_real(&p, "x", 0);

    (void)state;
    x[0] = -1.5;
    x[1] = 1.5;
    x[2] = NAN;
    assert_int_equal(sides_wrap(&box, &p), 1);
    assert_true(x[0] == -0.5 && x[1] == 1.5 && isnan(x[2]));
    x[0] = -1.5;
    box.bounded = false;
    assert_int_equal(sides_wrap(&box, &p), 0);
    assert_true(x[0] == -1.5);
    particles_fini(&p);
}

/* -- Ghosts ------------------------------------------------------------------------------------ */

/* What an image (0 none, 1 low, 2 high) makes of a coordinate; NAN if that side has none. */
static double image(const struct box *b, int a, int which, double x)
{
    if (which == 0) {
        return x;
    }
    if (b->side[a][which - 1] == SIDE_PERIODIC) {
        return which == 1 ? x - (b->max[a] - b->min[a]) : x + (b->max[a] - b->min[a]);
    }
    if (b->side[a][which - 1] == SIDE_MIRROR) {
        return 2 * (which == 1 ? b->min[a] : b->max[a]) - x;
    }
    return NAN;
}

/* Every image of every particle that lies within the margin of the box is there once, no other. */
static void check_ghosts(const struct box *b, struct particles *p, const struct ghosts *g,
                         double margin)
{
    size_t expected = 0;

    assert_int_equal(g->n, p->n_ghost);
    for (size_t i = 0; i < p->n; i++) {
        for (int code = 1; code < (p->dim == 1 ? 3 : p->dim == 2 ? 9 : 27); code++) {
            double at[3] = {0};
            int rest = code, bits = 0;
            bool wanted = true;
            size_t found = 0;

            for (int a = 0; a < p->dim; a++, rest /= 3) {
                at[a] = image(b, a, rest % 3, particles_real(p, "x", (uint32_t)a)[i]);
                bits |= rest % 3 << 2 * a;
                wanted = wanted && at[a] > b->min[a] - margin && at[a] < b->max[a] + margin;
            }
            for (size_t q = 0; q < g->n; q++) {
                if (g->parent[q] == i && g->image[q] == bits) {
                    found++;
                    for (int a = 0; a < p->dim; a++) {
                        double x = particles_real(p, "x", (uint32_t)a)[p->n + q];

                        assert_true(fabs(x - at[a]) < 1e-14);
                    }
                    assert_true(particles_real(p, "h", 0)[p->n + q] ==
                                particles_real(p, "h", 0)[i]);
                }
            }
            assert_int_equal(found, wanted);
            expected += wanted;
        }
    }
    assert_int_equal(expected, g->n);
}

static void makes_all_ghosts(void **state)
{
    static const enum side sides[4][2] = {{SIDE_PERIODIC, SIDE_PERIODIC},
                                          {SIDE_MIRROR, SIDE_MIRROR},
                                          {SIDE_MIRROR, SIDE_OPEN},
                                          {SIDE_OPEN, SIDE_MIRROR}};
    struct ghosts g = {0};
    struct error e;

    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        for (int k = 0; k < 16; k++) {
            struct box box = make_box(dim, sides[k / 4][0], sides[k / 4][1]);
            struct particles p = make(dim, 40, &box, (uint64_t)k);

            box.side[1][0] = sides[k % 4][0]; /* mixed along y */
            box.side[1][1] = sides[k % 4][1];
            for (double margin = 0; margin < 2; margin += 0.49) {
                assert_int_equal(ghosts_make(&g, &box, &p, margin, &e), 0);
                check_ghosts(&box, &p, &g, margin);
                assert_true(particles_is_valid(&p));
            }
            particles_fini(&p);
        }
    }
    ghosts_fini(&g);
}

static void open_or_unbounded_makes_none(void **state)
{
    struct box box = make_box(2, SIDE_OPEN, SIDE_OPEN);
    struct particles p = make(2, 40, &box, 1);
    struct ghosts g = {0};
    struct error e;

    (void)state;
    assert_int_equal(ghosts_make(&g, &box, &p, 10, &e), 0);
    assert_int_equal(p.n_ghost, 0);
    box = make_box(2, SIDE_PERIODIC, SIDE_PERIODIC);
    box.bounded = false;
    assert_int_equal(ghosts_make(&g, &box, &p, 10, &e), 0);
    assert_int_equal(p.n_ghost, 0);
    particles_fini(&p);
    ghosts_fini(&g);
}

static void refuses_thin_boxes(void **state)
{
    struct box box = make_box(1, SIDE_PERIODIC, SIDE_PERIODIC);
    struct particles p = make(1, 5, &box, 1);
    struct ghosts g = {0};
    struct error e;

    (void)state;
    assert_int_equal(ghosts_make(&g, &box, &p, 2, &e), 0); /* as wide as the margin: all seen */
    assert_int_equal(g.n, 10);
    assert_int_equal(ghosts_make(&g, &box, &p, 2.001, &e), -1);
    assert_non_null(strstr(e.text, "larger box"));
    assert_non_null(strstr(e.text, "fluid"));
    assert_non_null(strstr(e.text, "along x"));
    assert_int_equal(ghosts_make(&g, &box, &p, NAN, &e), -1);
    box = make_box(1, SIDE_MIRROR, SIDE_MIRROR);
    assert_int_equal(ghosts_make(&g, &box, &p, 2.001, &e), -1);
    box = make_box(1, SIDE_MIRROR, SIDE_OPEN); /* one mirror shows all, however near */
    assert_int_equal(ghosts_make(&g, &box, &p, 50, &e), 0);
    assert_int_equal(g.n, 5);
    particles_fini(&p);
    ghosts_fini(&g);
}

/* What a component turns into: the sign by hand for two and three dimensions. */
static void refreshes(void **state)
{
    static const char *const sym[4] = {"", "xx", "xx xy yy", "xx xy xz yy yz zz"};
    struct box box = make_box(3, SIDE_MIRROR, SIDE_MIRROR);
    struct ghosts g = {0};
    struct error e;

    (void)state;
    box.side[2][0] = box.side[2][1] = SIDE_PERIODIC;
    for (int dim = 1; dim <= 3; dim++) {
        struct particles p = make(dim, 30, &box, 4);

        assert_int_equal(ghosts_make(&g, &box, &p, 0.7, &e), 0);
        assert_true(g.n > 0);
        for (int c = 0; c < (int)p.n_column; c++) {
            ghosts_refresh(&g, &box, &p, c);
        }
        for (size_t q = 0; q < g.n; q++) {
            size_t i = g.parent[q], to = p.n + q;
            double sign[3] = {1, 1, 1};

            for (int a = 0; a < 2; a++) { /* z is periodic */
                sign[a] = (g.image[q] >> 2 * a & 3) ? -1 : 1;
            }
            for (uint32_t c = 0; c < (uint32_t)dim; c++) {
                const double *v = particles_real(&p, "v", c);

                assert_true(v[to] == sign[c] * v[i]);
            }
            for (uint32_t c = 0; c < p.column[3].ncomp; c++) {
                const double *s = particles_real(&p, "s", c);

                assert_true(s[to] ==
                            sign[sym[dim][3 * c] - 'x'] * sign[sym[dim][3 * c + 1] - 'x'] * s[i]);
            }
            for (uint32_t c = 0; c < p.column[4].ncomp; c++) {
                const double *m = particles_real(&p, "m", c);

                assert_true(m[to] == sign[c / (uint32_t)dim] * sign[c % (uint32_t)dim] * m[i]);
            }
            assert_int_equal(((int32_t *)p.column[5].data)[to], (int32_t)i + 7);
            assert_int_equal(((int64_t *)p.column[6].data)[to], (int64_t)i << 40);
        }
        check_ghosts(&box, &p, &g, 0.7);
        particles_fini(&p);
    }
    ghosts_fini(&g);
}

/* Ghosts stand in cell order, so that lists of them are short and the same however they came. */
static void ghosts_are_in_order(void **state)
{
    struct error e;

    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct box box = make_box(dim, SIDE_PERIODIC, SIDE_PERIODIC);
        struct particles p = make(dim, 500, &box, 5);
        struct ghosts g = {0};
        struct cloud cloud = {.dim = dim};
        uint32_t *order;

        assert_int_equal(ghosts_make(&g, &box, &p, 0.3, &e), 0);
        assert_true(g.n > 20);
        order = malloc(g.n * sizeof *order);
        cloud.n = g.n;
        for (int a = 0; a < dim; a++) {
            cloud.x[a] = particles_real(&p, "x", (uint32_t)a) + p.n;
        }
        assert_int_equal(cell_order(&cloud, NULL, 0.3, 1, order, &e), 0);
        for (size_t k = 0; k < g.n; k++) {
            assert_int_equal(order[k], k);
        }
        free(order);
        particles_fini(&p);
        ghosts_fini(&g);
    }
}

static void needs_positions(void **state)
{
    struct box box = make_box(1, SIDE_PERIODIC, SIDE_PERIODIC);
    struct particles p;
    struct ghosts g = {0};
    struct error e;

    (void)state;
    particles_init(&p, "ball", 1, &e);
    particles_resize(&p, 3, 0, &e);
    assert_int_equal(ghosts_make(&g, &box, &p, 1, &e), -1);
    assert_non_null(strstr(e.text, "ball"));
    assert_int_equal(sides_wrap(&box, &p), 0);
    particles_fini(&p);
    /* An array without particles is no error. */
    particles_init(&p, "ball", 1, &e);
    particles_add(&p, "x", "", "", SPH_VECTOR, &e);
    assert_int_equal(ghosts_make(&g, &box, &p, 1e9, &e), 0);
    particles_fini(&p);
    ghosts_fini(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wraps_periodic),
        cmocka_unit_test(reflects),
        cmocka_unit_test(leaves_open_sides),
        cmocka_unit_test(makes_all_ghosts),
        cmocka_unit_test(open_or_unbounded_makes_none),
        cmocka_unit_test(refuses_thin_boxes),
        cmocka_unit_test(refreshes),
        cmocka_unit_test(ghosts_are_in_order),
        cmocka_unit_test(needs_positions),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
