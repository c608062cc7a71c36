/* run/mirrors.c -- columns' copies in 4 bytes, for sweeps in floats: a state column's as floats; the
 * position's as whole numbers of a quantum, whose differences are exact wherever in the domain they are
 * taken. Made when a sweep reads them and their column has changed. Only of what must be in doubles all
 * the time (plan/precision.c): two floats, or quanta and a rest, need no mirror. */
#include "base/clones.h"
#include "run/domain.h"
#include <math.h>
#include <omp.h>

/* A quantum may be so much of the smallest smoothing length at most. */
#define COARSEST 1e-5

CLONES static int places(int32_t *restrict to, const double *restrict from, double centre,
                         double inverse, size_t n)
{
    int bad = 0;
#pragma omp simd reduction(| : bad)
    for (size_t i = 0; i < n; i++) {
        const double q = (from[i] - centre) * inverse;
        bad |= !(fabs(q) < 1073741824.0); /* a difference of two has room */
        to[i] = (int32_t)(q + copysign(0.5, q));
    }
    return bad;
}

bool mirror_places(const struct run *r, const struct column *c, uint32_t k, size_t first, size_t n)
{
    const size_t at = k * c->plane + first;
    return !places((int32_t *)c->mirror + at, (const double *)c->data + at, r->centre[k],
                   1.0 / r->quantum, n);
}

#define PIECE 2048

int run_mirror(struct run *r, size_t array, int column, struct error *e)
{
    const struct plan_array *a = &r->plan->array[array];
    const struct column *c = &a->p.column[column];
    const uint8_t old = r->mirror_old[array][column];
    const long begin = old == MIRROR_GHOSTS_OLD ? (long)a->p.n : 0;
    const long end = (long)(a->p.n + a->p.n_ghost);
    if (!c->mirror || old == MIRROR_FRESH)
        return 0;
    int bad = 0;
    for (uint32_t k = 0; k < c->ncomp; k++) {
        const double *from = (const double *)c->data + k * c->plane;
        float *to = (float *)c->mirror + k * c->plane;
#pragma omp parallel for num_threads(r->threads) reduction(| : bad) if (end - begin > 50000)
        for (long first = begin; first < end; first += PIECE) {
            const long last = end - first < PIECE ? end : first + PIECE;
            if (column == a->position)
                bad |= !mirror_places(r, c, k, (size_t)first, (size_t)(last - first));
            else
                for (long i = first; i < last; i++)
                    to[i] = (float)from[i];
        }
    }
    if (bad)
        return error_set(e, EXIT_RUN, "a particle of array \"%s\" is nowhere, or left the domain",
                         a->p.name);
    r->mirror_old[array][column] = MIRROR_FRESH;
    return 0;
}

int run_mirror_frame(struct run *r, double margin, struct error *e)
{
    static const uint32_t op[6] = {SPH_REDUCE_MIN, SPH_REDUCE_MIN, SPH_REDUCE_MIN,
                                   SPH_REDUCE_MAX, SPH_REDUCE_MAX, SPH_REDUCE_MAX};
    const struct box *box = &r->plan->scene->box;
    const struct plan *plan = r->plan;
    /* Who has which images depends on the ranks: then what can be is taken, not what is. */
    const bool of_all_images = plan->strict || r->domain;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int c = 0; c < plan->dim; c++)
        for (size_t a = 0; a < plan->n_array; a++) {
            const struct plan_array *pa = &plan->array[a];
            const struct column *x = &pa->p.column[pa->position];
            const double *at = (const double *)x->data + (size_t)c * x->plane;
            const size_t n = pa->p.n + (of_all_images ? 0 : pa->p.n_ghost);
            for (size_t i = 0; i < n; i++) {
                low[c] = at[i] < low[c] ? at[i] : low[c];
                high[c] = at[i] > high[c] ? at[i] : high[c];
            }
        }
    double of_all[6] = {low[0], low[1], low[2], high[0], high[1], high[2]};
    if (run_share_numbers(r, of_all, op, 6, e))
        return -1;
    /* Images stand beyond the sides, no further than they are looked for. */
    for (int c = 0; of_all_images && c < plan->dim; c++) {
        if (box->bounded && sides_has_image(box, c, IMAGE_LOW))
            of_all[c] = fmin(of_all[c], box->min[c] - margin);
        if (box->bounded && sides_has_image(box, c, IMAGE_HIGH))
            of_all[3 + c] = fmax(of_all[3 + c], box->max[c] + margin);
    }
    return run_mirror_frame_of(r, of_all, of_all + 3, e);
}

int run_mirror_frame_of(struct run *r, const double *low, const double *high, struct error *e)
{
    const struct plan *plan = r->plan;
    double longest = 0.0, h = INFINITY, h_high = 0.0;
    for (size_t a = 0; a < plan->n_array; a++) {
        h = fmin(h, r->h_low[a]);
        h_high = fmax(h_high, r->h_high[a]);
    }
    for (int c = 0; c < plan->dim; c++) {
        r->centre[c] = low[c] <= high[c] ? low[c] + 0.5 * (high[c] - low[c]) : 0.0;
        longest = low[c] <= high[c] ? fmax(longest, high[c] - low[c]) : longest;
    }
    /* Room to move in until the lists are made anew, and for what lies beyond the domain then. */
    longest = 1.05 * longest + 4.0 * plan->kernel.support * plan->reach_scale * h_high;
    r->quantum = longest > 0.0 ? longest / 2147483648.0 : 1.0;
    for (size_t a = 0; a < plan->n_array; a++)
        r->mirror_old[a][plan->array[a].position] = MIRROR_OLD;
    bool floats = false;
    for (size_t i = 0; i < plan->n_pass; i++)
        floats = floats || plan->pass[i].real == SPH_F32;
    if (floats && h > 0.0 && r->quantum > COARSEST * h)
        return error_set(e, EXIT_RUN,
                         "precision \"%s\" cannot tell neighbours apart: the domain is %.3g times "
                         "the smallest smoothing length wide; take \"double\"",
                         precision_name[plan->precision], longest / h);
    return 0;
}
