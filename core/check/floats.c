/* check/floats.c -- see floats.h. */
#include "check/floats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BITS 30 /* of a position, at most */

/* -- Rounding -------- */

static bool is_real(const struct column *c)
{
    return c->type != SPH_INT32 && c->type != SPH_INT64;
}

static double farthest(const struct particles *p, int column)
{
    const struct column *c = &p->column[column];
    double most = 0;

    for (uint32_t k = 0; k < c->ncomp; k++)
        for (size_t i = 0; i < p->n + p->n_ghost; i++)
            most = fmax(most, fabs(((const double *)c->data)[k * c->plane + i]));
    return most;
}

static void round_column(const struct particles *p, int column, double quantum)
{
    const struct column *c = &p->column[column];

    for (uint32_t k = 0; k < c->ncomp; k++)
        for (size_t i = 0; i < p->n + p->n_ghost; i++) {
            double *value = (double *)c->data + k * c->plane + i;
            *value = quantum > 0 ? quantum * round(*value / quantum) : (float)*value;
        }
}

double floats_round(struct bench *b)
{
    const double most = fmax(farthest(&b->own, b->x), farthest(&b->other, b->x));
    const double quantum = exp2(ceil(log2(fmax(most, 1e-30))) - BITS);
    const struct particles *const arrays[] = {&b->own, &b->other};

    for (int a = 0; a < 2; a++)
        for (size_t c = 0; c < arrays[a]->n_column; c++)
            if (is_real(&arrays[a]->column[c]))
                round_column(arrays[a], (int)c, (int)c == b->x ? quantum : 0);
    return quantum;
}

/* -- Copies -------- */

/* Of a column, with room for what may be read past its end. NULL: no memory. quantum > 0: of
 * positions. */
static void *copy_of(const struct particles *p, int column, double quantum, const char *what)
{
    const struct column *c = &p->column[column];
    const size_t n = c->ncomp * c->plane, used = p->n + p->n_ghost;
    /* Whole cache lines, so that the beginning stands at one. */
    void *copy = watch_memory((n + 2 * SPH_LANES + 15) / 16 * 16 * sizeof(float), what);

    for (size_t k = 0; copy && k < n; k++) {
        const double value = ((const double *)c->data)[k];
        if (quantum > 0)
            ((int32_t *)copy)[k] = k % c->plane < used ? (int32_t)round(value / quantum) : 0;
        else
            ((float *)copy)[k] = (float)value;
    }
    return copy;
}

static int copy(sph_column *out, const struct particles *p, int column, double quantum,
                const char *what, struct error *e)
{
    *out = particles_column(p, column);
    if (!is_real(&p->column[column]))
        return 0;
    out->data = copy_of(p, column, quantum, what);
    return out->data ? 0 : error_memory(e, "a column of floats", p->column[column].plane);
}

static int copy_property(struct floats *f, const struct bench *b, uint32_t k, struct error *e)
{
    const char *name = bench_prop(b, k)->name;
    const uint32_t access = bench_prop(b, k)->access;

    if (access & (BENCH_WRITES | SPH_DST_READ) &&
        copy(&f->dst[k], &b->own, b->own_column[k], 0, name, e))
        return -1;
    if (!(access & SPH_SRC_READ))
        return 0;
    if (f->dst[k].data)
        f->src[0][k] = f->dst[k];
    else if (copy(&f->src[0][k], &b->own, b->own_column[k], 0, name, e))
        return -1;
    return copy(&f->src[1][k], &b->other, b->other_column[k], 0, name, e);
}

int floats_make(struct floats *f, const struct bench *b, double quantum, struct error *e)
{
    const size_t n = bench_count(b) + 1u;
    const struct particles *const arrays[] = {&b->own, &b->other};

    *f = (struct floats){.quantum = quantum,
                         .dst = calloc(n, sizeof(sph_column)),
                         .src = {calloc(n, sizeof(sph_column)), calloc(n, sizeof(sph_column))}};
    if (!f->dst || !f->src[0] || !f->src[1])
        return error_memory(e, "columns of floats", n);
    for (int a = 0; a < 2; a++)
        if (copy(&f->x[a], arrays[a], b->x, quantum, "x", e) ||
            copy(&f->h[a], arrays[a], b->h, 0, "h", e))
            return -1;
    for (uint32_t k = 0; k < bench_count(b); k++)
        if (copy_property(f, b, k, e))
            return -1;
    return 0;
}

void floats_free(struct floats *f, const struct bench *b)
{
    for (int a = 0; a < 2; a++) {
        watch_release(f->x[a].data);
        watch_release(f->h[a].data);
    }
    for (uint32_t k = 0; f->dst && f->src[0] && f->src[1] && k < bench_count(b); k++) {
        watch_release(f->dst[k].data);
        watch_release(f->src[0][k].data);
        watch_release(f->src[1][k].data);
    }
    free(f->dst);
    free(f->src[0]);
    free(f->src[1]);
    *f = (struct floats){0};
}

void floats_batch(const struct floats *f, sph_batch *batch, int k)
{
    batch->real = SPH_F32;
    batch->quantum = f->quantum;
    batch->x_dst = f->x[0];
    batch->h_dst = f->h[0];
    batch->x_src = f->x[k];
    batch->h_src = f->h[k];
    batch->dst = f->dst;
    batch->src = f->src[k];
}

void floats_take(const struct floats *f, struct bench *b)
{
    for (uint32_t k = 0; k < bench_count(b); k++) {
        const struct column *c = bench_column(b, k);
        if (!(bench_prop(b, k)->access & BENCH_WRITES) || !is_real(c))
            continue;
        for (uint32_t q = 0; q < c->ncomp; q++)
            for (size_t i = 0; i < b->own.n; i++)
                ((double *)c->data)[q * c->plane + i] =
                    (double)((const float *)f->dst[k].data)[q * c->plane + i];
    }
}
