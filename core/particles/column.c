/* particles/column.c -- many elements of a column at once, whatever it is held in; two columns that trade
 * their memory. */
#include "base/clones.h"
#include "particles/particles.h"
#include <string.h>

void particles_swap(struct particles *p, int a, int b)
{
    struct column *one = &p->column[a], *other = &p->column[b], old = *one;

    one->data = other->data;
    one->low = other->low;
    one->plane = other->plane;
    other->data = old.data;
    other->low = old.low;
    other->plane = old.plane;
}

CLONES static void widen(double *restrict to, const float *restrict from, size_t n)
{
    CLONES_SIMD
    for (size_t i = 0; i < n; i++)
        to[i] = (double)from[i];
}

CLONES static void join(double *restrict to, const float *restrict high, const float *restrict low,
                        size_t n)
{
    CLONES_SIMD
    for (size_t i = 0; i < n; i++)
        to[i] = (double)high[i] + (double)low[i];
}

CLONES static void narrow(float *restrict to, const double *restrict from, size_t n)
{
    CLONES_SIMD
    for (size_t i = 0; i < n; i++)
        to[i] = (float)from[i];
}

CLONES static void split(float *restrict high, float *restrict low, const double *restrict from,
                         size_t n)
{
    CLONES_SIMD
    for (size_t i = 0; i < n; i++) {
        const float near = (float)from[i];
        high[i] = near;
        low[i] = column_rest(from[i], near);
    }
}

CLONES static void from_quanta(double *restrict to, const int32_t *restrict whole,
                               const float *restrict rest, double centre, double quantum, size_t n)
{
    CLONES_SIMD
    for (size_t i = 0; i < n; i++)
        to[i] = centre + quantum * ((double)whole[i] + (double)rest[i]);
}

CLONES static void to_quanta(int32_t *restrict whole, float *restrict rest,
                             const double *restrict from, double centre, double inverse, size_t n)
{
    CLONES_SIMD
    for (size_t i = 0; i < n; i++) {
        const double quanta = (from[i] - centre) * inverse;
        whole[i] = quanta_whole(quanta);
        rest[i] = (float)(quanta - (double)whole[i]);
    }
}

void column_load(const struct column *c, uint32_t k, size_t first, size_t n, double *to)
{
    const size_t at = k * c->plane + first;

    if (c->size == sizeof(double))
        memcpy(to, (const double *)c->data + at, n * sizeof *to);
    else if (c->quantum > 0.0)
        from_quanta(to, (const int32_t *)c->data + at, c->low + at, c->centre[k], c->quantum, n);
    else if (c->low)
        join(to, (const float *)c->data + at, c->low + at, n);
    else
        widen(to, (const float *)c->data + at, n);
}

void column_store(const struct column *c, uint32_t k, size_t first, size_t n, const double *from)
{
    const size_t at = k * c->plane + first;

    if (c->size == sizeof(double))
        memcpy((double *)c->data + at, from, n * sizeof *from);
    else if (c->quantum > 0.0)
        to_quanta((int32_t *)c->data + at, c->low + at, from, c->centre[k], 1.0 / c->quantum, n);
    else if (c->low)
        split((float *)c->data + at, c->low + at, from, n);
    else
        narrow((float *)c->data + at, from, n);
}

/* Into the cache of the second level; the first has no room to spare. */
static void expect(const void *from, size_t bytes)
{
    for (size_t at = 0; at < bytes; at += 64)
        __builtin_prefetch((const char *)from + at, 0, 2);
}

void column_expect(const struct column *c, uint32_t k, size_t first, size_t n)
{
    const size_t at = k * c->plane + first;

    expect((const char *)c->data + at * c->size, n * c->size);
    if (c->low)
        expect(c->low + at, n * sizeof(float));
    if (c->mirror)
        expect((const char *)c->mirror + at * sizeof(float), n * sizeof(float));
}
