/* domain/slab.c -- see slab.h. Weighted quantiles by bisection, all cuts at a time: each rank has its points in
 * order with what lies below each. */
#include "domain/slab.h"
#include "config.h"
#include "domain/ranks.h"
#include <math.h>
#include <stdlib.h>

int slab_open(struct slab *s, int dim, struct error *e)
{
    int rank;
    *s = (struct slab){.dim = dim};
    ranks_count(&rank, &s->ranks);
    s->cut = calloc((size_t)s->ranks, sizeof *s->cut);
    return s->cut ? 0 : error_memory(e, "the domain", (size_t)s->ranks * sizeof *s->cut);
}

void slab_close(struct slab *s)
{
    free(s->cut);
    *s = (struct slab){0};
}

int slab_store(struct slab *s, struct store *store, struct error *e)
{
    int32_t axis = s->axis;
    if (store_block(store, "slabs", STORE_I32, &axis, 1, e) ||
        store_block(store, "slab_cuts", STORE_F64, s->cut, (size_t)s->ranks - 1, e))
        return -1;
    if (axis < 0 || axis >= s->dim)
        return store_broken(store, e, "the cuts of the domain");
    s->axis = axis;
    return 0;
}

int slab_owner(const struct slab *s, const double *x)
{
    int rank = 0;
    while (rank + 1 < s->ranks && x[s->axis] >= s->cut[rank])
        rank++;
    return rank;
}

#if SPH_HAVE_MPI
#include <mpi.h>

#define TURNS 60 /* of a bisection: to the last bits of a double */

struct point {
    double x, below; /* below: weight of the rank's points before it */
};

static int by_place(const void *a, const void *b)
{
    const double p = ((const struct point *)a)->x, q = ((const struct point *)b)->x;
    return (p > q) - (p < q);
}

static int sum(double *value, int n, struct error *e)
{
    return MPI_Allreduce(MPI_IN_PLACE, value, n, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD)
               ? error_set(e, EXIT_RUN, "MPI fails: the domain is not cut")
               : 0;
}

/* The longest side of the box that holds all points; it reaches from *lo to *hi. */
static int find_axis(struct slab *s, const double *const *x, size_t n, double *lo, double *hi,
                     struct error *e)
{
    double end[6]; /* the lower ones negative: all are maxima */
    for (int a = 0; a < s->dim; a++) {
        end[2 * a] = end[2 * a + 1] = -INFINITY;
        for (size_t i = 0; i < n; i++) {
            end[2 * a] = fmax(end[2 * a], -x[a][i]);
            end[2 * a + 1] = fmax(end[2 * a + 1], x[a][i]);
        }
    }
    if (MPI_Allreduce(MPI_IN_PLACE, end, 2 * s->dim, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD))
        return error_set(e, EXIT_RUN, "MPI fails: the domain is not cut");
    s->axis = 0;
    for (int a = 1; a < s->dim; a++)
        if (end[2 * a] + end[2 * a + 1] > end[2 * s->axis] + end[2 * s->axis + 1])
            s->axis = a;
    *lo = -end[2 * s->axis];
    *hi = end[2 * s->axis + 1];
    return 0;
}

/* What lies below a place. */
static double below(const struct point *p, size_t n, double x)
{
    size_t lo = 0, hi = n;
    while (lo < hi) {
        const size_t mid = lo + (hi - lo) / 2;
        if (p[mid].x < x)
            lo = mid + 1;
        else
            hi = mid;
    }
    return p[lo].below;
}

/* Between lo[k], with too little below it, and hi[k]; `try`: room for as many numbers. */
static int bisect(struct slab *s, const struct point *p, size_t n, double *lo, double *hi,
                  double *try, struct error *e)
{
    const int cuts = s->ranks - 1;
    double all = p[n].below;
    if (sum(&all, 1, e))
        return -1;
    for (int turn = 0; turn < TURNS; turn++) {
        for (int k = 0; k < cuts; k++)
            try[k] = below(p, n, 0.5 * (lo[k] + hi[k]));
        if (sum(try, cuts, e))
            return -1;
        for (int k = 0; k < cuts; k++)
            *(try[k] < all * (k + 1) / s->ranks ? &lo[k] : &hi[k]) = 0.5 * (lo[k] + hi[k]);
    }
    /* Many points may stand at one place: they go to where the sum comes nearer. */
    for (int k = 0; k < cuts; k++) {
        try[k] = below(p, n, lo[k]);
        try[cuts + k] = below(p, n, hi[k]);
    }
    if (sum(try, 2 * cuts, e))
        return -1;
    for (int k = 0; k < cuts; k++) {
        const double want = all * (k + 1) / s->ranks;
        s->cut[k] = fabs(try[k] - want) < fabs(try[cuts + k] - want) ? lo[k] : hi[k];
    }
    return 0;
}

int slab_cut(struct slab *s, const double *const *x, const float *weight, size_t n, struct error *e)
{
    const size_t cuts = (size_t)s->ranks - 1;
    struct point *p = malloc((n + 1) * sizeof *p);
    double *room = malloc((4 * cuts + 1) * sizeof *room);
    double lo = 0.0, hi = 0.0, weigh = 0.0;
    int status = ranks_agree(p && room ? 0 : error_memory(e, "the domain", n * sizeof *p), e);
    if (!status)
        status = find_axis(s, x, n, &lo, &hi, e);
    if (!status) {
        for (size_t i = 0; i < n; i++)
            p[i] = (struct point){x[s->axis][i], (double)weight[i]};
        qsort(p, n, sizeof *p, by_place);
        for (size_t i = 0; i < n; i++) {
            const double own = p[i].below;
            p[i].below = weigh;
            weigh += own;
        }
        p[n] = (struct point){INFINITY, weigh};
        for (size_t k = 0; k < cuts; k++) {
            room[k] = lo;
            room[cuts + k] = hi;
        }
        status = bisect(s, p, n, room, room + cuts, room + 2 * cuts, e);
    }
    free(p);
    free(room);
    return status;
}

#else

int slab_cut(struct slab *s, const double *const *x, const float *weight, size_t n, struct error *e)
{
    (void)s;
    (void)x;
    (void)weight;
    (void)n;
    return error_set(e, EXIT_USAGE, "built without MPI: one rank only");
}

#endif
