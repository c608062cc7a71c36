/* run/domain_cuts.c -- who holds which particles (see run/domain.h): the domain cut at first, what particles cost, the
 * domain cut anew, and particles moved to where they belong. */
#include "domain/migrate.h"
#include "domain/ranks.h"
#include "run/device.h"
#include "run/domain.h"
#include <math.h>
#include <omp.h>
#include <stdlib.h>

/* -- At first -------- */

static void place_of(const struct plan_array *a, int dim, size_t i, double x[3])
{
    for (int c = 0; c < dim; c++)
        x[c] = column_get(&a->p.column[a->position], (uint32_t)c, i);
}

/* Cuts, by every size-th of all particles, which every rank has. */
static int cut_first(struct run *r, struct error *e)
{
    const struct plan *plan = r->plan;
    const size_t ranks = (size_t)wire_size(r->domain->wire),
                 me = (size_t)wire_rank(r->domain->wire);
    size_t n = 0, k = 0;
    for (size_t a = 0; a < plan->n_array; a++)
        n += plan->array[a].p.n;
    if (n == 0) /* they come out of a checkpoint */
        return 0;
    double *x = malloc((3 * (n / ranks + 1)) * sizeof *x);
    float *weight = malloc((n / ranks + 1) * sizeof *weight);
    if (ranks_agree(x && weight ? 0 : error_memory(e, "the domain", n * sizeof *x), e)) {
        free(x);
        free(weight);
        return -1;
    }
    double *const at[3] = {x, x + n / ranks + 1, x + 2 * (n / ranks + 1)};
    n = 0;
    for (size_t a = 0; a < plan->n_array; a++)
        for (size_t i = 0; i < plan->array[a].p.n; i++) {
            double here[3];
            if (k++ % ranks != me)
                continue;
            place_of(&plan->array[a], plan->dim, i, here);
            for (int c = 0; c < plan->dim; c++)
                at[c][n] = here[c];
            weight[n++] = 1.0f;
        }
    const int status = partition_cut(r->domain->partition, (const double *const *)at, weight, n, e);
    free(x);
    free(weight);
    return status;
}

static int keep_own(struct run *r, struct error *e)
{
    const struct plan *plan = r->plan;
    const int me = wire_rank(r->domain->wire);
    for (size_t a = 0; a < plan->n_array; a++) {
        struct plan_array *pa = &plan->array[a];
        uint32_t *index = malloc((pa->p.n + 1) * sizeof *index);
        size_t n = 0;
        if (!index)
            return error_memory(e, "the domain", pa->p.n * sizeof *index);
        for (size_t i = 0; i < pa->p.n; i++) {
            double x[3];
            place_of(pa, plan->dim, i, x);
            if (partition_owner(r->domain->partition, x) == me)
                index[n++] = (uint32_t)i;
        }
        const int status = particles_gather(&pa->p, index, n, e);
        free(index);
        if (status)
            return -1;
    }
    return 0;
}

int run_domain_cut(struct run *r, struct error *e)
{
    return cut_first(r, e) || keep_own(r, e) ? -1 : 0;
}

/* -- What particles cost -------- */

/* What a particle costs beside its pairs, and an image of it: in pairs. */
#define POINT 20.0f
#define IMAGE 16.0f
#define PACE_MOST 10.0 /* by which measured time may change it */

/* Sweeps of an evaluation that walk a list. */
static size_t sweeps_of(const struct plan *plan, size_t list)
{
    size_t n = 0;
    for (size_t i = 0; i < plan->n_pass; i++)
        for (size_t s = 0; plan->pass[i].moment == MOMENT_EVALUATE && s < plan->pass[i].n_src; s++)
            n += plan->pass[i].shape == SPH_PAIR && plan->pass[i].list[s] == list;
    return n;
}

/* Of an array's particles, by the lists there are: a group's pairs are its particles' in equal parts. */
static double weigh(struct run *r, size_t array, float *weight)
{
    const struct plan *plan = r->plan;
    const size_t n = plan->array[array].p.n;
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        weight[i] = POINT;
    for (size_t k = 0; r->lists_made && k < r->ghosts[array].n; k++)
        weight[r->ghosts[array].parent[k]] += IMAGE;
    for (size_t k = 0; r->lists_made && k < plan->n_list; k++) {
        const struct group_list *list = &r->list[k];
        const double each = list->true_share * (double)sweeps_of(plan, k);
        if (plan->list[k].dst != array)
            continue;
        if (r->device)
            run_device_weigh(r, k, (double)sweeps_of(plan, k), weight);
        for (size_t g = 0; g < list->n_group; g++) {
            const size_t first = g * SPH_LANES, end = first + SPH_LANES < n ? first + SPH_LANES : n;
            const double pairs = each * (double)group_list_entries(list, g, g + 1);
            for (size_t i = first; i < end; i++)
                weight[i] += (float)(pairs / (double)(end - first));
        }
    }
    for (size_t i = 0; i < n; i++)
        sum += (double)weight[i];
    return sum;
}

/* How much more than the mean the rank with the most has. */
static int find_imbalance(struct run *r, double mine, struct error *e)
{
    static const uint32_t op[2] = {SPH_REDUCE_MAX, SPH_REDUCE_SUM};
    double value[2] = {mine, mine};
    if (run_share_numbers(r, value, op, 2, e))
        return -1;
    r->domain->imbalance =
        value[1] > 0.0 ? value[0] * (double)wire_size(r->domain->wire) / value[1] : 1.0;
    return 0;
}

static int room_for(struct run_domain *d, size_t n, struct error *e)
{
    if (n <= d->capacity)
        return 0;
    const size_t capacity = n + n / 8 + 64;
    free(d->owner);
    free(d->weight);
    free(d->place);
    d->owner = malloc(capacity * sizeof *d->owner);
    d->weight = malloc(capacity * sizeof *d->weight);
    d->place = malloc(3 * capacity * sizeof *d->place);
    d->capacity = d->owner && d->weight && d->place ? capacity : 0;
    return d->capacity ? 0 : error_memory(e, "the domain", capacity * sizeof *d->place);
}

int run_domain_cost(struct run *r, double *cost, struct error *e)
{
    struct run_domain *d = r->domain;
    const struct plan *plan = r->plan;
    size_t n = 0, at = 0;
    for (size_t a = 0; a < plan->n_array; a++)
        n += plan->array[a].p.n;
    if (room_for(d, n, e))
        return -1;
    *cost = 0.0;
    for (size_t a = 0; a < plan->n_array; a++) {
        *cost += weigh(r, a, d->weight + at);
        at += plan->array[a].p.n;
    }
    return 0;
}

/* Every particle's weight, and how even the shares are. */
static int weigh_all(struct run *r, struct error *e)
{
    double sum;
    return run_domain_cost(r, &sum, e) || find_imbalance(r, sum, e) ? -1 : 0;
}

int run_domain_uneven(struct run *r, bool *uneven, struct error *e)
{
    *uneven = false;
    if (!r->domain)
        return 0;
    if (weigh_all(r, e))
        return -1;
    *uneven = r->domain->imbalance > r->plan->scene->ranks.imbalance;
    return 0;
}

/* A clock that stands still while this rank waits for others. */
static double clock_of(const struct run *r)
{
    return omp_get_wtime() - wire_count(r->domain->wire).seconds;
}

void run_domain_step(struct run *r, bool begins)
{
    struct run_domain *d = r->domain;
    if (!d)
        return;
    if (begins)
        d->idle += clock_of(r) - d->ended;
    else
        d->ended = clock_of(r);
}

/* A rank that takes longer for its share than others for theirs, since particles were weighed before, has particles
 * that weigh more. What was known counts half: a moment's noise does not move everything. */
static int pace(struct run *r, double cost, size_t n, struct error *e)
{
    static const uint32_t op[2] = {SPH_REDUCE_SUM, SPH_REDUCE_SUM};
    struct run_domain *d = r->domain;
    const double busy = clock_of(r) - d->idle;
    /* What it costs now it has cost since then, or nearly. */
    double sum[2] = {busy - d->busy, cost};
    const double mine = sum[1] > 0.0 ? sum[0] / sum[1] : 0.0;
    if (d->timed && run_share_numbers(r, sum, op, 2, e))
        return -1;
    if (d->timed && mine > 0.0 && sum[0] > 0.0 && sum[1] > 0.0)
        d->pace = fmin(fmax(0.5 * (d->pace + mine * sum[1] / sum[0]), 1.0 / PACE_MOST), PACE_MOST);
    d->busy = busy;
    d->timed = true;
    for (size_t i = 0; i < n; i++)
        d->weight[i] *= (float)d->pace;
    return 0;
}

/* How even the shares will be once the n particles at these places, whose weights are known, have gone to where they
 * belong: those that have crossed a cut since are not yet there, and count for whom they come to. */
static int foresee_imbalance(struct run *r, double *const *place, size_t n, struct error *e)
{
    struct run_domain *d = r->domain;
    const size_t ranks = (size_t)wire_size(d->wire);
    double *share = calloc(ranks, sizeof *share), most = 0.0, sum = 0.0;
    uint32_t *op = calloc(ranks, sizeof *op);
    int status = share && op ? 0 : error_memory(e, "the domain", ranks * sizeof *share);
    for (size_t i = 0; !status && i < n; i++) {
        const double x[3] = {place[0][i], place[1][i], place[2][i]};
        share[partition_owner(d->partition, x)] += (double)d->weight[i];
    }
    for (size_t k = 0; !status && k < ranks; k++)
        op[k] = SPH_REDUCE_SUM;
    if (!status)
        status = run_share_numbers(r, share, op, ranks, e);
    for (size_t k = 0; !status && k < ranks; k++) {
        most = share[k] > most ? share[k] : most;
        sum += share[k];
    }
    if (!status)
        d->imbalance = sum > 0.0 ? most * (double)ranks / sum : 1.0;
    free(share);
    free(op);
    return status;
}

/* -- Cut anew -------- */

/* Cuts anew if the shares have come to differ too much. */
static int balance(struct run *r, struct error *e)
{
    struct run_domain *d = r->domain;
    const struct plan *plan = r->plan;
    size_t at = 0;
    double cost;
    if (run_domain_cost(r, &cost, e))
        return -1;
    if (!r->lists_made)
        return 0;
    double *const place[3] = {d->place, d->place + d->capacity, d->place + 2 * d->capacity};
    for (size_t a = 0; a < plan->n_array; a++)
        for (size_t i = 0; i < plan->array[a].p.n; i++, at++) {
            double x[3] = {0.0, 0.0, 0.0};
            place_of(&plan->array[a], plan->dim, i, x);
            for (int c = 0; c < 3; c++)
                place[c][at] = x[c];
        }
    if ((plan->scene->ranks.by_time && pace(r, cost, at, e)) || foresee_imbalance(r, place, at, e))
        return -1;
    if (!(d->imbalance > plan->scene->ranks.imbalance))
        return 0;
    d->cuts++;
    return partition_cut(d->partition, (const double *const *)place, d->weight, at, e);
}

int run_domain_move(struct run *r, struct error *e)
{
    struct run_domain *d = r->domain;
    if (!d)
        return 0;
    const struct wire_count before = wire_count(d->wire);
    if (balance(r, e))
        return -1;
    for (size_t a = 0; a < r->plan->n_array; a++) {
        struct plan_array *pa = &r->plan->array[a];
        size_t sent;
        if (room_for(d, pa->p.n, e))
            return -1;
        for (size_t i = 0; i < pa->p.n; i++) {
            double x[3];
            place_of(pa, r->plan->dim, i, x);
            d->owner[i] = partition_owner(d->partition, x);
        }
        if (migrate(d->wire, &pa->p, d->owner, &sent, e))
            return -1;
        d->moved += sent;
    }
    halo_count(d->wire, &d->for_moves, &before);
    return 0;
}
