/* tests/unit/clouds.h -- clouds of points of many kinds, for the tests of neighbours and of
 * order. */
#ifndef TESTS_CLOUDS_H
#define TESTS_CLOUDS_H

#include "neighbours/neighbours.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static inline double random_unit(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

/* -- Clouds ------------------------------------------------------------------------------------ */

struct owned {
    struct cloud c;
    double *x[3], *h;
};

static inline struct owned cloud_new(int dim, size_t n)
{
    struct owned o = {.c = {.dim = dim, .n = n, .scale = 2}};

    for (int a = 0; a < dim; a++) {
        o.c.x[a] = o.x[a] = calloc(n + 1, sizeof(double)); /* not a byte after the last is read */
        assert_non_null(o.x[a]);
    }
    o.c.h = o.h = calloc(n + 1, sizeof(double));
    assert_non_null(o.h);
    return o;
}

static inline void cloud_free(struct owned *o)
{
    for (int a = 0; a < 3; a++) {
        free(o->x[a]);
    }
    free(o->h);
}

/* h at which a point of an even cloud in the unit box has about `count` neighbours. */
static inline double even_h(int dim, size_t n, double count)
{
    static const double ball[4] = {0, 2, 3.14159265, 4.18879020};

    return 0.5 * pow(count / (ball[dim] * (double)(n ? n : 1)), 1.0 / dim);
}

static inline struct owned cloud_even(int dim, size_t n, uint64_t seed)
{
    struct owned o = cloud_new(dim, n);

    for (size_t i = 0; i < n; i++) {
        for (int a = 0; a < dim; a++) {
            o.x[a][i] = random_unit(&seed);
        }
        o.h[i] = even_h(dim, n, 20);
    }
    return o;
}

/* Dense balls in a thin gas; h by the place's density, `ratio` at most. */
static inline struct owned cloud_clustered(int dim, size_t n, double ratio, uint64_t seed)
{
    struct owned o = cloud_even(dim, n, seed);
    double thin = even_h(dim, n, 20);

    for (size_t i = 0; i < n; i++) {
        double size = i % 4 == 0 ? 1 : 1 / ratio * (1 + (double)(i % 7));

        for (int a = 0; a < dim; a++) {
            double centre = size < 1 ? 0.2 + 0.2 * (double)(i % 3) : 0;

            o.x[a][i] = centre + size * o.x[a][i];
        }
        o.h[i] = thin * size * (0.8 + 0.4 * random_unit(&seed));
    }
    return o;
}

/* A dense core in a thin gas, smoothly: radii to the power p, h by the local density. */
static inline struct owned cloud_core(int dim, size_t n, double p, uint64_t seed)
{
    struct owned o = cloud_even(dim, n, seed);

    for (size_t i = 0; i < n; i++) {
        double r = 1e-9;

        for (int a = 0; a < dim; a++) {
            r += (o.x[a][i] - 0.5) * (o.x[a][i] - 0.5);
        }
        r = sqrt(r);
        for (int a = 0; a < dim; a++) {
            o.x[a][i] = (o.x[a][i] - 0.5) * pow(r, p - 1);
        }
        o.h[i] *= pow(p * pow(r, dim * (p - 1)), 1.0 / dim);
    }
    return o;
}

/* A lattice of m points along each axis, spacing 1, every point moved by up to a tenth; h for 75
 * neighbours in 3D and 21 in 2D. */
static inline struct owned cloud_lattice(int dim, size_t m, uint64_t seed)
{
    size_t n = dim == 3 ? m * m * m : dim == 2 ? m * m : m;
    struct owned o = cloud_new(dim, n);

    for (size_t i = 0; i < n; i++) {
        size_t q = i;

        for (int a = 0; a < dim; a++) {
            o.x[a][i] = (double)(q % m) + 0.2 * random_unit(&seed) - 0.1;
            q /= m;
        }
        o.h[i] = 1.3;
    }
    return o;
}

/* Such a lattice's points in a ball, drawn towards its centre, h following the spacing: over 100
 * times as wide at the edge as in the middle. */
static inline struct owned cloud_clump(int dim, size_t m, uint64_t seed)
{
    struct owned o = cloud_lattice(dim, m, seed);
    double middle = (double)(m - 1) / 2, least = 9e-3 * pow(3, 1.0 / dim);
    size_t n = 0;

    for (size_t i = 0; i < o.c.n; i++) {
        double r2 = 0;

        for (int a = 0; a < dim; a++) {
            r2 += (o.x[a][i] - middle) * (o.x[a][i] - middle) / (middle * middle);
        }
        for (int a = 0; a < dim && r2 < 1; a++) {
            o.x[a][n] = (o.x[a][i] - middle) * (least + r2);
        }
        if (r2 < 1) {
            o.h[n++] = 1.3 * pow(pow(least + r2, dim - 1) * (least + 3 * r2), 1.0 / dim);
        }
    }
    o.c.n = n;
    return o;
}

static inline void cloud_shuffle(struct owned *o, uint64_t seed)
{
    for (size_t i = o->c.n; i-- > 1;) {
        size_t j = (size_t)(random_unit(&seed) * (double)i);

        for (int a = 0; a <= o->c.dim; a++) {
            double *x = a < o->c.dim ? o->x[a] : o->h, t = x[i];

            x[i] = x[j];
            x[j] = t;
        }
    }
}

static inline void cloud_sort(struct owned *o, double cell)
{
    size_t n = o->c.n;
    uint32_t *order = malloc((n + 1) * sizeof *order);
    double *old = malloc((n + 1) * sizeof *old);
    struct error e;

    assert_int_equal(cell_order(&o->c, NULL, cell, 1, order, &e), 0);
    for (int k = 0; k <= o->c.dim; k++) {
        double *x = k < o->c.dim ? o->x[k] : o->h;

        memcpy(old, x, n * sizeof *x);
        for (size_t i = 0; i < n; i++) {
            x[i] = old[order[i]];
        }
    }
    free(order);
    free(old);
}

#endif
