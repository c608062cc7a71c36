/* tests/unit/test_skin.c -- when neighbour lists must be made anew: never later than exact numbers
 * say, and hardly sooner. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "clouds.h"
#include "neighbours/skin.h"

#define SKIN 0.1

static struct owned copy(const struct owned *o)
{
    struct owned c = cloud_new(o->c.dim, o->c.n);

    for (int a = 0; a < o->c.dim; a++) {
        memcpy(c.x[a], o->x[a], o->c.n * sizeof(double));
    }
    memcpy(c.h, o->h, o->c.n * sizeof(double));
    c.c.scale = o->c.scale;
    return c;
}

/* As the core asks: of each cloud what has changed, then of all. */
static bool still_hold(const struct skin *s, const struct cloud *c, size_t n, double relative,
                       int threads)
{
    struct skin_change all = {0, INFINITY};

    for (size_t k = 0; k < n; k++) {
        all = skin_both(all, skin_change(&s[k], &c[k], relative, threads));
    }
    return skin_holds(all);
}

/* By how much the lists still hold, in units of the skin of the particle that decides. */
static double exact_room(const struct owned *then, const struct owned *now)
{
    double d2 = 0, least = INFINITY;

    for (size_t i = 0; i < then->c.n; i++) {
        double r2 = 0;

        for (int a = 0; a < then->c.dim; a++) {
            r2 += (now->x[a][i] - then->x[a][i]) * (now->x[a][i] - then->x[a][i]);
        }
        d2 = fmax(d2, r2);
    }
    for (size_t i = 0; i < then->c.n; i++) {
        double h = then->h[i];
        double left = ((1 + SKIN) * h - now->h[i]) * then->c.scale - 2 * sqrt(d2);

        least = fmin(least, left / (SKIN * h * then->c.scale));
    }
    return least;
}

/* Moves and grows by random amounts up to these parts of h. */
static void change(const struct owned *then, struct owned *now, double move, double grow,
                   uint64_t seed)
{
    for (size_t i = 0; i < then->c.n; i++) {
        for (int a = 0; a < then->c.dim; a++) {
            now->x[a][i] = then->x[a][i] + move * then->h[i] * (2 * random_unit(&seed) - 1);
        }
        now->h[i] = then->h[i] * (1 + grow * random_unit(&seed));
    }
}

static void check(const struct owned *then)
{
    struct owned now = copy(then);
    struct skin s = {0};
    struct error e;
    int held = 0, failed = 0;

    assert_int_equal(skin_keep(&s, &then->c, 1, &e), 0);
    assert_true(still_hold(&s, &now.c, 1, SKIN, 1));
    for (int k = 0; k < 400; k++) {
        double move = 0.12 * (k % 20) / 20, grow = 0.11 * (k / 20) / 20, room;
        bool holds;

        change(then, &now, move, grow, (uint64_t)k);
        holds = still_hold(&s, &now.c, 1, SKIN, 1 + k % 3);
        room = exact_room(then, &now);
        if (holds) {
            assert_true(room >= 0);
            held++;
        } else {
            assert_true(room < 0.02);
            failed++;
        }
    }
    assert_true(then->c.n == 0 || (held > 20 && failed > 20));
    skin_fini(&s);
    cloud_free(&now);
}

static void errs_on_the_safe_side(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_even(dim, 1003, 7);

        check(&o); /* blocks as wide as the box: as they are */
        cloud_sort(&o, 2 * o.h[0]);
        check(&o);
        for (size_t i = 0; i < o.c.n; i++) {
            o.h[i] *= 0.8 + 0.04 * (double)(i % 10);
            o.x[0][i] += 1e6 * o.h[i];
        }
        check(&o);
        o.x[0][17] = 1e30; /* flown away */
        check(&o);
        cloud_free(&o);
    }
}

/* One particle alone, at each place of a block, decides. */
static void one_decides(void **state)
{
    struct owned then = cloud_even(3, 70, 3), now = copy(&then);
    struct skin s[2] = {{0}};
    struct cloud clouds[2] = {now.c, now.c};
    struct error e;
    double reach = then.c.scale * then.h[0];

    (void)state;
    assert_int_equal(skin_keep(&s[0], &then.c, 2, &e), 0);
    assert_int_equal(skin_keep(&s[1], &then.c, 2, &e), 0);
    for (size_t i = 0; i < then.c.n; i++) {
        double *x = &now.x[i % 3][i], old = *x;

        *x = old + 0.049 * reach;
        assert_true(still_hold(s, clouds, 2, SKIN, 1));
        assert_true(fabs(skin_change(s, &now.c, SKIN, 1).moved / (0.049 * reach) - 1) < 0.02);
        *x = old - 0.051 * reach;
        assert_false(still_hold(s, clouds, 2, SKIN, 1));
        *x = NAN;
        assert_false(still_hold(s, clouds, 2, SKIN, 2));
        assert_true(isnan(skin_change(s, &now.c, SKIN, 1).moved));
        *x = INFINITY;
        assert_false(still_hold(s, clouds, 2, SKIN, 2));
        *x = old;
        now.h[i] = then.h[i] * 1.099;
        assert_true(still_hold(s, clouds, 2, SKIN, 1));
        now.h[i] = then.h[i] * 1.1001;
        assert_false(still_hold(s, clouds, 2, SKIN, 1));
        now.h[i] = NAN;
        assert_false(still_hold(s, clouds, 2, SKIN, 1));
        now.h[i] = then.h[i];
        assert_true(still_hold(s, clouds, 2, SKIN, 1));
    }
    /* Another number of particles is another cloud. */
    clouds[1].n--;
    assert_false(still_hold(s, clouds, 2, SKIN, 1));
    clouds[1].n = 0;
    assert_int_equal(skin_keep(&s[1], &clouds[1], 1, &e), 0);
    assert_true(still_hold(s, clouds, 2, SKIN, 1));
    skin_fini(&s[0]);
    skin_fini(&s[1]);
    cloud_free(&then);
    cloud_free(&now);
}

static void little_memory(void **state)
{
    static const double most[4] = {0, 7, 10, 12};

    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct owned o = cloud_lattice(dim, dim == 3 ? 40 : dim == 2 ? 250 : 60000, 3);
        struct skin s = {0};
        struct error e;
        double bytes;

        cloud_sort(&o, 2.6);
        assert_int_equal(skin_keep(&s, &o.c, 2, &e), 0);
        assert_true(still_hold(&s, &o.c, 1, SKIN, 2));
        bytes = (double)skin_bytes(&s) / (double)o.c.n;
        print_message("%dD: %.1f bytes a particle\n", dim, bytes);
        assert_true(bytes < most[dim]);
        skin_fini(&s);
        cloud_free(&o);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errs_on_the_safe_side),
        cmocka_unit_test(one_decides),
        cmocka_unit_test(little_memory),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
