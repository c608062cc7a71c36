/* run/lists.c -- neighbour lists and ghosts of a run: made when they are no longer right, reused until then.
 * Everything is decided by displacements and counters, never by time, so that a run repeats itself. */
#include "run/run.h"
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* Lists are made so often between two sorts of the particles. */
#define BUILDS_PER_SORT 16

static double support(const struct plan *plan)
{
    return plan->kernel.support * plan->reach_scale;
}

static bool asks(const struct plan *plan)
{
    for (size_t k = 0; k < plan->n_array * plan->n_array; k++)
        if (plan->pair[k])
            return true;
    return false;
}

static double largest_h(const struct plan_array *a)
{
    double h = 0.0;
    const double *column = a->p.column[a->smoothing].data;
    for (size_t i = 0; i < a->p.n; i++)
        h = fmax(h, column[i]);
    return h;
}

static double *position(const struct plan_array *a, int c)
{
    const struct column *x = &a->p.column[a->position];
    return (double *)x->data + (size_t)c * x->plane;
}

static double largest_displacement(const struct run *r)
{
    double d2max = 0.0;
    for (size_t a = 0; a < r->plan->n_array; a++) {
        const struct plan_array *pa = &r->plan->array[a];
        size_t n = pa->p.n;
        for (size_t i = 0; i < n; i++) {
            double d2 = 0.0;
            for (int c = 0; c < r->plan->dim; c++) {
                double d = position(pa, c)[i] - r->reference[a][(size_t)c * n + i];
                d2 += d * d;
            }
            if (isnan(d2))
                return NAN; /* must not pass for "has not moved", nor be forgotten at the next particle */
            d2max = fmax(d2max, d2);
        }
    }
    return sqrt(d2max);
}

static bool still_right(const struct run *r)
{
    if (!r->lists_made)
        return false;
    const double d = 2.0 * largest_displacement(r) / support(r->plan);
    if (!(d < INFINITY))
        return false;
    for (size_t a = 0; a < r->plan->n_array; a++) {
        const struct plan_array *pa = &r->plan->array[a];
        const double *h = pa->p.column[pa->smoothing].data;
        const double *h0 = r->reference[a] + (size_t)r->plan->dim * pa->p.n;
        for (size_t i = 0; i < pa->p.n; i++)
            if (!(d + h[i] - h0[i] <= r->skin * h0[i]))
                return false;
    }
    return true;
}

static int sort_array(struct run *r, size_t array, struct error *e)
{
    struct plan_array *a = &r->plan->array[array];
    size_t n = a->p.n;
    if (n < 2)
        return 0;
    const double *h = a->p.column[a->smoothing].data;
    double mean = 0.0;
    for (size_t i = 0; i < n; i++)
        mean += h[i];
    mean /= (double)n;
    struct cloud cloud = {.dim = r->plan->dim, .n = n, .h = h, .scale = support(r->plan)};
    for (int c = 0; c < r->plan->dim; c++)
        cloud.x[c] = position(a, c);
    uint32_t *order = malloc(n * sizeof *order);
    if (!order)
        return error_memory(e, "the order of particles", n * sizeof *order);
    int status = cell_order(&cloud, a->p.column[a->id].data, support(r->plan) * mean, order, e);
    if (!status)
        status = particles_permute(&a->p, order, e);
    free(order);
    return status;
}

/* How far a particle stands outside the box. Nothing is wrapped in the midst of an evaluation, so it may have
 * left by what it moved since its start. */
static double largest_overshoot(const struct run *r)
{
    const struct box *box = &r->plan->scene->box;
    double most = 0.0;
    for (size_t a = 0; box->bounded && a < r->plan->n_array; a++)
        for (int c = 0; c < r->plan->dim; c++) {
            const double *x = position(&r->plan->array[a], c);
            for (size_t i = 0; i < r->plan->array[a].p.n; i++) {
                if (box->side[c][0] != SIDE_OPEN)
                    most = fmax(most, box->min[c] - x[i]);
                if (box->side[c][1] != SIDE_OPEN)
                    most = fmax(most, x[i] - box->max[c]);
            }
        }
    return most;
}

static int make_ghosts(struct run *r, struct error *e)
{
    double margin = 0.0;
    for (size_t a = 0; a < r->plan->n_array; a++)
        margin = fmax(margin, largest_h(&r->plan->array[a]));
    margin = margin * support(r->plan) * (1.0 + r->skin) + largest_overshoot(r);
    for (size_t a = 0; a < r->plan->n_array; a++) {
        struct particles *p = &r->plan->array[a].p;
        if (particles_resize(p, p->n, 0, e) ||
            ghosts_make(&r->ghosts[a], &r->plan->scene->box, p, margin, e))
            return -1;
        for (size_t c = 0; c < p->n_column; c++)
            r->stale[a][c] = p->n_ghost > 0;
        r->stale[a][r->plan->array[a].position] = false;
        r->stale[a][r->plan->array[a].smoothing] = false;
    }
    return 0;
}

static int keep_reference(struct run *r, struct error *e)
{
    for (size_t a = 0; a < r->plan->n_array; a++) {
        const struct plan_array *pa = &r->plan->array[a];
        size_t n = pa->p.n, planes = (size_t)r->plan->dim + 1;
        if (r->reference_n[a] != n) {
            free(r->reference[a]);
            r->reference[a] = malloc((n ? n : 1) * planes * sizeof(double));
            if (!r->reference[a])
                return error_memory(e, "positions of the lists", n * planes * sizeof(double));
            r->reference_n[a] = n;
        }
        for (int c = 0; c < r->plan->dim; c++)
            memcpy(r->reference[a] + (size_t)c * n, position(pa, c), n * sizeof(double));
        memcpy(r->reference[a] + (size_t)r->plan->dim * n, pa->p.column[pa->smoothing].data,
               n * sizeof(double));
    }
    return 0;
}

static struct cloud cloud_of(const struct run *r, size_t array, bool ghosts)
{
    const struct plan_array *a = &r->plan->array[array];
    struct cloud cloud = {.dim = r->plan->dim, .scale = support(r->plan)};
    cloud.n = a->p.n + (ghosts ? a->p.n_ghost : 0);
    cloud.h = a->p.column[a->smoothing].data;
    for (int c = 0; c < r->plan->dim; c++)
        cloud.x[c] = position(a, c);
    return cloud;
}

/* True pairs are counted when the particles are sorted; in between their share of the lists is taken to last. */
static int make_lists(struct run *r, bool counted, struct error *e)
{
    size_t n = r->plan->n_array;
    for (size_t d = 0; d < n; d++)
        for (size_t s = 0; s < n; s++) {
            uint32_t reach = r->plan->pair[d * n + s];
            if (!reach)
                continue;
            struct cloud dst = cloud_of(r, d, false), src = cloud_of(r, s, true);
            if (group_list_make(&r->list[d * n + s], &dst, &src, reach == SPH_SYMMETRIC, r->skin,
                                r->threads, e))
                return error_prefix(e, "neighbours of \"%s\"", r->plan->array[d].p.name);
            struct group_list *list = &r->list[d * n + s];
            uint64_t entries = list->begin[list->n_group];
            if (counted && entries)
                list->true_share = (double)group_list_count(list, &dst, &src) / (double)entries;
        }
    return 0;
}

int run_lists(struct run *r, bool within, struct error *e)
{
    if (!asks(r->plan)) {
        for (size_t a = 0; !within && a < r->plan->n_array; a++)
            sides_wrap(&r->plan->scene->box, &r->plan->array[a].p);
        return 0;
    }
    double begin = omp_get_wtime();
    int status = 0;
    if (!still_right(r)) {
        bool sort = !within && (!r->lists_made || ++r->builds_since_sort >= BUILDS_PER_SORT);
        if (!within) {
            for (size_t a = 0; a < r->plan->n_array; a++)
                sides_wrap(&r->plan->scene->box, &r->plan->array[a].p);
            for (size_t a = 0; !status && sort && a < r->plan->n_array; a++)
                status = sort_array(r, a, e);
            if (sort) {
                r->builds_since_sort = 0;
                r->cost.sorts++;
            }
        }
        if (!status)
            status = make_ghosts(r, e) || make_lists(r, sort, e) || keep_reference(r, e) ? -1 : 0;
        r->lists_made = !status;
        r->cost.list_builds++;
    }
    r->lists_suspect = false;
    r->cost.neighbour += omp_get_wtime() - begin;
    return status;
}

void run_refresh(struct run *r, size_t array, int column)
{
    if (!r->stale[array][column])
        return;
    double begin = omp_get_wtime();
    ghosts_refresh(&r->ghosts[array], &r->plan->scene->box, &r->plan->array[array].p, column);
    r->stale[array][column] = false;
    r->cost.neighbour += omp_get_wtime() - begin;
}

size_t run_list_bytes(const struct run *r)
{
    size_t bytes = 0;
    for (size_t k = 0; k < r->plan->n_array * r->plan->n_array; k++)
        bytes += group_list_bytes(&r->list[k]);
    return bytes;
}
