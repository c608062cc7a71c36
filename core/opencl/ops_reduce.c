/* opencl/ops_reduce.c -- one number of many, on a device: sums, extremes, how far particles have moved, how many
 * values are wrong. Each is begun, and left among the results; who wants several waits but once. */
#include "opencl/ops_private.h"
#include <math.h>

/* As in ops_reduce.cl. */
#define GROUP 64u
#define CHUNK 4096u

/* Work groups for n particles; one if there are none, which sets what a sum or an extreme begins with. */
static uint64_t groups_for(size_t n)
{
    return n > CHUNK ? (n + CHUNK - 1) / CHUNK : 1;
}

static int reserve(struct ops *o, uint64_t parts, struct error *e)
{
    return device_reserve(o->d, &o->part, parts * sizeof(double), "reductions", e);
}

/* The groups' parts from `first` on become result k. */
static int gather(struct ops *o, uint64_t first, uint64_t groups, uint32_t op, bool root,
                  double factor, size_t k, struct error *e)
{
    const uint32_t is_root = root;
    const uint64_t to = k + sizeof(struct ops_words) / sizeof(double);
    return OPS_LAUNCH(o, K_PARTS, GROUP, e, DEVICE_BUFFER(&o->part), DEVICE_VALUE(first),
                      DEVICE_VALUE(groups), DEVICE_VALUE(op), DEVICE_VALUE(is_root),
                      DEVICE_VALUE(factor), DEVICE_BUFFER(&o->words), DEVICE_VALUE(to));
}

int ops_reduce_begin(struct ops *o, const struct arena *a, int column, uint32_t component, int mass,
                     uint32_t op, size_t k, struct error *e)
{
    const uint64_t plane = a->plane, n = a->n, groups = groups_for(n);
    const uint32_t value = ops_slot(a, column) + component, by = ops_slot(a, mass);
    if (reserve(o, groups, e) ||
        OPS_LAUNCH(o, K_REDUCE, groups * GROUP, e, DEVICE_BUFFER(&a->wide),
                   DEVICE_BUFFER(&a->narrow), DEVICE_VALUE(plane), DEVICE_VALUE(value),
                   DEVICE_VALUE(by), DEVICE_VALUE(n), DEVICE_VALUE(op), DEVICE_BUFFER(&o->part)))
        return -1;
    return gather(o, 0, groups, op, false, 1.0, k, e);
}

int ops_reduce(struct ops *o, const struct arena *a, int column, uint32_t component, int mass,
               uint32_t op, double *out, struct error *e)
{
    return ops_reduce_begin(o, a, column, component, mass, op, OPS_RESULTS - 1, e) ||
                   device_read(o->d, &o->words,
                               sizeof(struct ops_words) + (OPS_RESULTS - 1) * sizeof *out, out,
                               sizeof *out, e)
               ? -1
               : 0;
}

/* -- Lists: are they still right? -------- */

/* Elements from one component of what is kept to the next; as many behind the last are read as a column has. */
size_t ops_skin_stride(const struct ops_skin *s)
{
    return (s->n + 2 * PARTICLES_PAD - 1) / PARTICLES_PAD * PARTICLES_PAD + 16;
}

static int keep(struct ops *o, struct device_buffer *to, const struct arena *a, int column,
                uint32_t ncomp, const struct ops_skin *s, struct error *e)
{
    const uint64_t plane = a->plane, stride = ops_skin_stride(s), n = s->n;
    const uint32_t slot = ops_slot(a, column);
    if (device_reserve(o->d, to, ncomp * stride * sizeof(double), "places of particles", e))
        return -1;
    return OPS_LAUNCH(o, K_SKIN_KEEP, ops_items(o, n), e, DEVICE_BUFFER(&a->wide),
                      DEVICE_BUFFER(&a->narrow), DEVICE_VALUE(plane), DEVICE_VALUE(slot),
                      DEVICE_VALUE(ncomp), DEVICE_BUFFER(to), DEVICE_VALUE(stride),
                      DEVICE_VALUE(n));
}

int ops_skin_keep(struct ops *o, struct ops_skin *s, const struct arena *a, int position,
                  int smoothing, struct error *e)
{
    s->n = a->n;
    return keep(o, &s->x, a, position, (uint32_t)o->dim, s, e) ||
                   keep(o, &s->h, a, smoothing, 1, s, e)
               ? -1
               : 0;
}

int ops_skin_begin(struct ops *o, const struct ops_skin *s, const struct arena *a, int position,
                   int smoothing, double scale, double skin, size_t k, struct error *e)
{
    const uint64_t plane = a->plane, n = a->n, groups = groups_for(n), stride = ops_skin_stride(s);
    const uint32_t x = ops_slot(a, position), h = ops_slot(a, smoothing);
    if (s->n != a->n || !s->x.mem) /* of others: NaN */
        return device_fill(o->d, &o->words, sizeof(struct ops_words) + k * sizeof(double),
                           UINT32_MAX, 2 * sizeof(double), e);
    if (reserve(o, 2 * groups, e) ||
        OPS_LAUNCH(o, K_SKIN, groups * GROUP, e, DEVICE_BUFFER(&a->wide), DEVICE_BUFFER(&a->narrow),
                   DEVICE_VALUE(plane), DEVICE_VALUE(x), DEVICE_VALUE(h), DEVICE_VALUE(n),
                   DEVICE_BUFFER(&s->x), DEVICE_BUFFER(&s->h), DEVICE_VALUE(stride),
                   DEVICE_VALUE(skin), DEVICE_BUFFER(&o->part)))
        return -1;
    return gather(o, 0, groups, SPH_REDUCE_MAX, true, 1.0, k, e) ||
                   gather(o, groups, groups, SPH_REDUCE_MIN, false, scale, k + 1, e)
               ? -1
               : 0;
}

int ops_skin_change(struct ops *o, const struct ops_skin *s, const struct arena *a, int position,
                    int smoothing, double scale, double skin, double *moved, double *room,
                    struct error *e)
{
    double both[2];
    if (ops_skin_begin(o, s, a, position, smoothing, scale, skin, OPS_RESULTS - 2, e) ||
        device_read(o->d, &o->words, sizeof(struct ops_words) + (OPS_RESULTS - 2) * sizeof *both,
                    both, sizeof both, e))
        return -1;
    *moved = both[0];
    *room = both[1];
    return 0;
}

void ops_skin_release(struct ops *o, struct ops_skin *s)
{
    device_release(o->d, &s->x);
    device_release(o->d, &s->h);
    s->n = 0;
}
