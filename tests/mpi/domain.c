/* tests/mpi/domain.c -- the domain manager by itself, under mpirun: particles are cut, moved, and given ghosts,
 * and each rank compares what it has with all pairs of all particles, which it makes anew from their numbers.
 *
 *     domain SEED        prints "ok" on rank 0, or what is wrong
 */
#include "config.h"
#include "domain/halo.h"
#include "domain/migrate.h"
#include "domain/partition.h"
#include "domain/ranks.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ARRAYS 2
#define X 0

enum { HOW_EVEN, HOW_CORNER, HOW_LUMPS, HOW_ALONE, HOWS };

struct world {
    int dim, how;
    size_t n[ARRAYS];
    uint64_t seed;
    struct box box;
};

static int wrong;

static void expect(int is, const char *what, int rank, long a, long b)
{
    if (is)
        return;
    if (wrong++ < 5)
        fprintf(stderr, "rank %d: %s (%ld, %ld)\n", rank, what, a, b);
}

/* A number in [0, 1) of particle i of array a. */
static double number(const struct world *w, size_t a, size_t i, unsigned k)
{
    uint64_t z = w->seed + 0x9e3779b97f4a7c15ull * (a * 1000003 + i * 64 + k + 1);
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ z >> 27) * 0x94d049bb133111ebull;
    return (double)((z ^ z >> 31) >> 11) / 9007199254740992.0;
}

static double place(const struct world *w, size_t a, size_t i, int c)
{
    const double u = number(w, a, i, (unsigned)c), lo = w->box.min[c], hi = w->box.max[c];
    if (w->how == HOW_CORNER)
        return lo + 0.05 * (hi - lo) * u;
    if (w->how == HOW_LUMPS)
        return lo + (hi - lo) * (0.1 + 0.2 * u + (number(w, a, i, 40) < 0.5 ? 0.0 : 0.65));
    return lo + (hi - lo) * u;
}

static double reach_of(const struct world *w, size_t a, size_t i)
{
    return 0.01 + 0.05 * number(w, a, i, 30) * number(w, a, i, 31);
}

/* Component k of column c, as a real particle has it. */
static double value(const struct world *w, size_t a, size_t i, int column, unsigned k)
{
    if (column == X)
        return place(w, a, i, (int)k);
    if (column == 1)
        return reach_of(w, a, i);
    return number(w, a, i, 50 + 10 * (unsigned)column + k) - 0.5;
}

static int columns_make(struct particles *p, int dim, struct error *e)
{
    return particles_init(p, "a", dim, e) || particles_add(p, "x", "", "", SPH_VECTOR, e) < 0 ||
           particles_add(p, "h", "", "", SPH_SCALAR, e) < 0 ||
           particles_add(p, "v", "", "", SPH_VECTOR, e) < 0 ||
           particles_add(p, "s", "", "", SPH_SYM, e) < 0 ||
           particles_add(p, "f", "", "", SPH_VECTOR, e) < 0 ||
           particles_add(p, "id", "", "", SPH_INT64, e) < 0 ||
           particles_add(p, "k", "", "", SPH_INT32, e) < 0;
}

/* This rank's share, by number: as far from any order in space as can be. */
static int fill(const struct world *w, struct particles *p, size_t a, int rank, int ranks,
                struct error *e)
{
    size_t n = 0;
    for (size_t i = 0; i < w->n[a]; i++)
        n += (int)(i % (size_t)ranks) == rank;
    if (particles_resize(p, n, 0, e))
        return -1;
    n = 0;
    for (size_t i = (size_t)rank; i < w->n[a]; i += (size_t)ranks, n++) {
        for (int c = 0; c < 5; c++)
            for (uint32_t k = 0; k < p->column[c].ncomp; k++)
                column_set(&p->column[c], k, n, value(w, a, i, c, k));
        ((int64_t *)p->column[5].data)[n] = (int64_t)i;
        ((int32_t *)p->column[6].data)[n] = (int32_t)(i * 7);
    }
    for (size_t c = 0; c < p->n_column; c++)
        p->column[c].state = true;
    /* One in floats, one in two of them. */
    return particles_hold(p, 4, sizeof(float), false, e) ||
           particles_hold(p, 3, sizeof(float), true, e);
}

static double near_to(double a, double b)
{
    return fabs(a - b);
}

/* All that particle or ghost q carries is particle i's, as it is in an image. */
static void check_values(const struct world *w, const struct particles *p, size_t a, size_t q,
                         unsigned code, int rank)
{
    const size_t i = (size_t)((int64_t *)p->column[5].data)[q];
    for (int c = 0; c < 5; c++)
        for (uint32_t k = 0; k < p->column[c].ncomp; k++) {
            const double is = column_get(&p->column[c], k, q);
            const double ought =
                sides_value(&w->box, w->dim, &p->column[c], k, code, value(w, a, i, c, k));
            const double bar = c == 4 ? 1e-7 : c == 3 ? 1e-13 : 0.0;
            expect(near_to(is, ought) <= bar, "a value", rank, c, (long)q);
        }
    expect(((int32_t *)p->column[6].data)[q] == (int32_t)(i * 7), "a whole number", rank, (long)q,
           0);
}

/* Where particle i of array a stands as an image; false: there is none. */
static int image_place(const struct world *w, size_t a, size_t i, unsigned code, double *x)
{
    for (int c = 0; c < w->dim; c++) {
        const unsigned image = code >> 2 * c & 3u;
        x[c] = place(w, a, i, c);
        if (image == 3u || (image && !sides_has_image(&w->box, c, image)))
            return 0;
        if (image)
            x[c] = sides_image(&w->box, c, image, x[c]);
    }
    return code >> 2 * w->dim == 0;
}

/* Every source that a destination of this rank sees is there, once. */
static void check_sources(const struct world *w, const struct particles *p, const struct halo *h,
                          const struct halo_want *want, double factor, int rank)
{
    const struct particles *dst = &p[want->dst], *src = &p[want->src];
    unsigned *seen = calloc(w->n[want->src] * 64 + 1, sizeof *seen);
    for (size_t q = 0; q < src->n + src->n_ghost; q++) {
        const size_t i = (size_t)((int64_t *)src->column[5].data)[q];
        const unsigned code = q < src->n ? 0 : h->image[want->src][q - src->n];
        expect(i < w->n[want->src] && code < 64, "who a ghost is", rank, (long)q, (long)code);
        if (i < w->n[want->src] && code < 64)
            seen[i * 64 + code]++;
    }
    for (size_t k = 0; k < w->n[want->src] * 64; k++)
        expect(seen[k] < 2, "a source that is there twice", rank, (long)(k / 64), (long)(k % 64));
    for (size_t d = 0; d < dst->n; d++) {
        const size_t me = (size_t)((int64_t *)dst->column[5].data)[d];
        for (size_t j = 0; j < w->n[want->src]; j++)
            for (unsigned code = 0; code < 64; code++) {
                double x[3], r2 = 0.0;
                if (!image_place(w, want->src, j, code, x))
                    continue;
                for (int c = 0; c < w->dim; c++) {
                    const double dx = x[c] - place(w, want->dst, me, c);
                    r2 += dx * dx;
                }
                double reach = reach_of(w, want->dst, me);
                if (want->symmetric)
                    reach = fmax(reach, reach_of(w, want->src, j));
                reach *= factor;
                expect(!(r2 < reach * reach) || seen[j * 64 + code], "a source that lacks", rank,
                       (long)j, (long)code);
            }
    }
    free(seen);
}

/* Whether a ghost at x, particle i, may be of use to some destination that a want is for: within reach of the box of
 * all of this rank's. */
static int may_need(const struct world *w, const struct particles *dst,
                    const struct halo_want *want, size_t i, const double *x, double factor)
{
    double reach = want->symmetric ? reach_of(w, want->src, i) : 0.0, gap2 = 0.0;
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t d = 0; d < dst->n; d++) {
        reach = fmax(reach, column_get(&dst->column[1], 0, d));
        for (int c = 0; c < w->dim; c++) {
            lo[c] = fmin(lo[c], column_get(&dst->column[X], (uint32_t)c, d));
            hi[c] = fmax(hi[c], column_get(&dst->column[X], (uint32_t)c, d));
        }
    }
    for (int c = 0; c < w->dim; c++) {
        const double gap = fmax(fmax(lo[c] - x[c], x[c] - hi[c]), 0.0);
        gap2 += gap * gap;
    }
    reach *= factor * 1.01;
    return gap2 <= reach * reach;
}

/* No ghost is there for nothing. */
static void check_needed(const struct world *w, const struct particles *p, const struct halo *h,
                         const struct halo_want *want, size_t n_want, double factor, int rank)
{
    for (size_t a = 0; a < ARRAYS; a++)
        for (size_t q = 0; q < p[a].n_ghost; q++) {
            const size_t i = (size_t)((int64_t *)p[a].column[5].data)[p[a].n + q];
            double x[3] = {0.0};
            int needed = 0;
            if (!image_place(w, a, i, h->image[a][q], x))
                continue; /* check_sources says so */
            for (size_t k = 0; k < n_want; k++)
                needed = needed ||
                         (want[k].src == a && may_need(w, &p[want[k].dst], &want[k], i, x, factor));
            expect(needed, "a ghost that nobody needs", rank, (long)i, h->image[a][q]);
        }
}

static int one(const struct world *w, enum partitioner which, struct wire *wire, struct error *e)
{
    const int rank = wire_rank(wire), ranks = wire_size(wire);
    const struct halo_want want[] = {{0, 0, 0, true}, {0, 1, 0, false}, {1, 0, 0, true}};
    struct particles p[ARRAYS] = {{0}};
    struct ghosts own[ARRAYS] = {{0}};
    struct cloud cloud[ARRAYS] = {{0}};
    struct partition *part = NULL;
    struct halo halo;
    size_t n_all = 0, sent = 0;
    for (size_t a = 0; a < ARRAYS; a++)
        if (columns_make(&p[a], w->dim, e) || fill(w, &p[a], a, rank, ranks, e))
            return -1;
    if (halo_open(&halo, wire, ARRAYS, e))
        return -1;
    /* Cut, then move. */
    if (ranks > 1) {
        for (size_t a = 0; a < ARRAYS; a++)
            n_all += p[a].n;
        double *x[3];
        float *weight = malloc((n_all + 1) * sizeof *weight);
        int *owner = malloc((n_all + 1) * sizeof *owner);
        for (int c = 0; c < 3; c++)
            x[c] = calloc(n_all + 1, sizeof *x[c]);
        size_t at = 0;
        for (size_t a = 0; a < ARRAYS; a++)
            for (size_t i = 0; i < p[a].n; i++, at++) {
                weight[at] = (float)(1 + i % 3);
                for (int c = 0; c < w->dim; c++)
                    x[c][at] = column_get(&p[a].column[X], (uint32_t)c, i);
            }
        if (partition_open(&part, which, w->dim, e) ||
            partition_cut(part, (const double *const *)x, weight, n_all, e))
            return -1;
        at = 0;
        for (size_t a = 0; a < ARRAYS; a++) {
            for (size_t i = 0; i < p[a].n; i++) {
                double here[3] = {0};
                for (int c = 0; c < w->dim; c++)
                    here[c] = x[c][at + i];
                owner[at + i] = partition_owner(part, here);
            }
            const size_t before = p[a].n;
            if (migrate(wire, &p[a], owner + at, &sent, e))
                return -1;
            at += before;
        }
        free(weight);
        free(owner);
        for (int c = 0; c < 3; c++)
            free(x[c]);
    }
    uint64_t total[ARRAYS];
    for (size_t a = 0; a < ARRAYS; a++) {
        total[a] = p[a].n;
        for (size_t i = 0; i < p[a].n; i++)
            check_values(w, &p[a], a, i, 0, rank);
    }
    if (wire_sum(wire, total, ARRAYS, e))
        return -1;
    for (size_t a = 0; a < ARRAYS; a++)
        expect(total[a] == w->n[a], "how many there are", rank, (long)total[a], (long)w->n[a]);
    /* Ghosts. */
    for (size_t a = 0; a < ARRAYS; a++) {
        cloud[a] = (struct cloud){.dim = w->dim, .n = p[a].n, .scale = 1.0};
        for (int c = 0; c < w->dim; c++)
            cloud[a].x[c] = particles_real(&p[a], "x", (uint32_t)c);
        cloud[a].h = particles_real(&p[a], "h", 0);
    }
    const struct halo_job job = {.box = &w->box,
                                 .n_array = ARRAYS,
                                 .n_frame = 1,
                                 .cloud = cloud,
                                 .want = want,
                                 .n_want = 3,
                                 .factor = 1.1};
    if (halo_make(&halo, &job, own, e))
        return -1;
    struct halo_column column[2 * 7];
    size_t n = 0;
    for (size_t a = 0; a < ARRAYS; a++) {
        if (particles_resize(&p[a], p[a].n, halo.n_ghost[a], e))
            return -1;
        for (int c = 0; c < 7; c++) {
            ghosts_refresh(&own[a], &w->box, &p[a], c);
            column[n++] = (struct halo_column){&p[a], a, c};
        }
    }
    const struct wire_count before = wire_count(wire);
    if (halo_begin(&halo, &w->box, column, n, e) || halo_finish(&halo, column, n, e))
        return -1;
    const struct wire_count after = wire_count(wire);
    expect(after.bytes - before.bytes == halo_bytes(&halo, column, n), "bytes that were sent", rank,
           (long)(after.bytes - before.bytes), (long)halo_bytes(&halo, column, n));
    for (size_t a = 0; a < ARRAYS; a++)
        for (size_t g = 0; g < p[a].n_ghost; g++)
            check_values(w, &p[a], a, p[a].n + g, halo.image[a][g], rank);
    for (size_t k = 0; k < 3; k++)
        check_sources(w, p, &halo, &want[k], 1.1, rank);
    check_needed(w, p, &halo, want, 3, 1.1, rank);
    halo_close(&halo);
    partition_close(part);
    for (size_t a = 0; a < ARRAYS; a++) {
        ghosts_fini(&own[a]);
        particles_fini(&p[a]);
    }
    return 0;
}

static int all(uint64_t seed, struct wire *wire, struct error *e)
{
    static const enum side sides[][2] = {{SIDE_OPEN, SIDE_OPEN},
                                         {SIDE_PERIODIC, SIDE_PERIODIC},
                                         {SIDE_MIRROR, SIDE_OPEN},
                                         {SIDE_MIRROR, SIDE_MIRROR}};
    for (int dim = 1; dim <= 3; dim++)
        for (int how = 0; how < HOWS; how++)
            for (int which = 0; which < PARTITIONERS; which++) {
                struct world w = {.dim = dim,
                                  .how = how,
                                  .n = {how == HOW_ALONE    ? 1
                                        : how == HOW_CORNER ? 5
                                                            : 150,
                                        how == HOW_ALONE ? 0 : (size_t)how * 40},
                                  .seed = seed + (uint64_t)(dim * 100 + how * 10 + which)};
                w.box = (struct box){.dim = dim, .bounded = true};
                for (int a = 0; a < 3; a++) {
                    w.box.max[a] = 1.0 - 0.4 * (double)(a == 1);
                    for (int s = 0; s < 2; s++)
                        w.box.side[a][s] = sides[(a + how + which) % 4][s];
                }
                if (one(&w, (enum partitioner)which, wire, e))
                    return -1;
            }
    return 0;
}

int main(int argc, char **argv)
{
    struct error e = {0};
    struct wire *wire = NULL;
    int status = ranks_begin(&argc, &argv, &e) || wire_open(&wire, &e) ? -1 : 0;
    if (!status)
        status = all(argc > 1 ? strtoull(argv[1], NULL, 10) : 1, wire, &e);
    uint64_t missed = (uint64_t)wrong;
    if (!status)
        status = wire_sum(wire, &missed, 1, &e);
    if (status)
        fprintf(stderr, "rank %d: %s\n", wire_rank(wire), e.text);
    else if (wire_rank(wire) == 0)
        printf("%s, %d ranks\n", missed ? "WRONG" : "ok", wire_size(wire));
    wire_close(wire);
    ranks_end();
    return status || missed ? 1 : 0;
}
