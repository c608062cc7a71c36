/* run/forecast.c -- see forecast.h. Begins a run up to its first lists, or up to the first evaluation where that sets
 * smoothing lengths, looks at them, and lets go. */
#include "run/forecast.h"
#include "run/domain.h"
#include <stdlib.h>
#include <string.h>

static double squared(double x)
{
    return x * x;
}

static bool is_pair(const struct run *r, const struct plan_list *l, size_t i, size_t j)
{
    const struct plan_array *dst = &r->plan->array[l->dst], *src = &r->plan->array[l->src];
    double reach = column_get(&dst->p.column[dst->smoothing], 0, i), r2 = 0.0;
    if (l->reach == SPH_SYMMETRIC)
        reach = fmax(reach, column_get(&src->p.column[src->smoothing], 0, j));
    for (uint32_t c = 0; c < (uint32_t)r->plan->dim; c++)
        r2 += squared(column_get(&dst->p.column[dst->position], c, i) -
                      column_get(&src->p.column[src->position], c, j));
    return r2 < squared(reach * r->plan->kernel.support * r->plan->reach_scale);
}

/* Pairs of a list whose source is another rank's. */
static uint64_t across(const struct run *r, size_t k)
{
    const struct plan_list *l = &r->plan->list[k];
    const struct group_list *list = &r->list[k];
    const size_t n = r->plan->array[l->dst].p.n,
                 own = r->plan->array[l->src].p.n + r->ghosts[l->src].n;
    uint64_t pairs = 0;
    for (size_t g = 0; g < list->n_group; g++)
        for (struct source_walk w = source_walk_begin(list, g); source_walk_next(list, &w);)
            for (size_t i = g * SPH_LANES; w.source >= own && i < (g + 1) * SPH_LANES && i < n; i++)
                pairs += is_pair(r, l, i, w.source);
    return pairs;
}

static int look(struct run *r, struct forecast_rank *mine, struct error *e)
{
    const struct plan *plan = r->plan;
    *mine = (struct forecast_rank){.peers = r->domain->halo.n_peer};
    for (size_t a = 0; a < plan->n_array; a++) {
        mine->particles += plan->array[a].p.n;
        mine->ghosts += r->domain->halo.n_ghost[a] - r->ghosts[a].n;
    }
    for (size_t k = 0; k < plan->n_list; k++) {
        if (plan->list[k].frame)
            continue;
        mine->pairs += r->list[k].true_share * (double)r->list[k].n_entry;
        mine->across += across(r, k);
    }
    return run_domain_cost(r, &mine->cost, e);
}

/* What this rank sends in each exchange. */
static int find_sent(const struct run *r, struct forecast *f, struct error *e)
{
    const struct halo *h = &r->domain->halo;
    size_t *n = calloc(r->plan->n_array + 1, sizeof *n);
    if (!n)
        return error_memory(e, "the forecast", r->plan->n_array * sizeof *n);
    for (size_t k = 0; k < h->n_peer; k++) {
        for (size_t a = 0; a < r->plan->n_array; a++)
            n[a] = h->peer[k].part[a].n_send;
        for (size_t i = 0; i < f->exchanges.n; i++) {
            const size_t bytes = exchange_bytes(&f->exchanges, &f->exchanges.at[i], r->plan, n);
            f->sent[i].bytes += bytes;
            f->sent[i].messages += bytes > 0;
        }
    }
    free(n);
    return 0;
}

static int share(const struct run *r, struct forecast *f, const struct forecast_rank *mine,
                 struct error *e)
{
    struct wire *wire = r->domain->wire;
    const struct halo_sent by = forecast_sent(f, SIZE_MAX);
    uint64_t *sum = malloc((2 * f->exchanges.n + 1) * sizeof *sum);
    if (!sum)
        return error_memory(e, "the forecast", 2 * f->exchanges.n * sizeof *sum);
    for (size_t i = 0; i < f->exchanges.n; i++) {
        sum[2 * i] = f->sent[i].messages;
        sum[2 * i + 1] = f->sent[i].bytes;
    }
    const int status = wire_gather(wire, mine, sizeof *mine, f->of, e) ||
                               wire_gather(wire, &by, sizeof by, f->by, e) ||
                               wire_sum(wire, sum, 2 * f->exchanges.n, e)
                           ? -1
                           : 0;
    for (size_t i = 0; i < f->exchanges.n; i++)
        f->sent[i] = (struct halo_sent){sum[2 * i], sum[2 * i + 1]};
    free(sum);
    return status;
}

static int tell(struct run *r, struct forecast *f, struct error *e)
{
    struct forecast_rank mine;
    f->ranks = wire_size(r->domain->wire);
    /* Smoothing lengths that the first evaluation sets are not the scene's: neither are the ghosts. */
    if (r->h_fixed ? run_lists(r, false, e)
                   : run_passes(r, MOMENT_START, e) || run_passes(r, MOMENT_EVALUATE, e))
        return -1;
    if (exchanges_make(&f->exchanges, r->plan, e))
        return -1;
    f->of = calloc((size_t)f->ranks, sizeof *f->of);
    f->by = calloc((size_t)f->ranks, sizeof *f->by);
    f->sent = calloc(f->exchanges.n + 1, sizeof *f->sent);
    if (!f->of || !f->by || !f->sent)
        return error_memory(e, "the forecast", (size_t)f->ranks * sizeof *f->of);
    return look(r, &mine, e) || find_sent(r, f, e) || share(r, f, &mine, e) ? -1 : 0;
}

int forecast_make(struct forecast *f, struct plan *plan, struct error *e)
{
    struct run r = {0};
    *f = (struct forecast){0};
    int status = run_init(&r, plan, 1, SPH_PATH_BEST, false, e);
    if (!status && !r.domain)
        status = error_set(e, EXIT_RUN, "a forecast is of several ranks");
    if (!status)
        status = tell(&r, f, e);
    status = run_domain_agree(&r, status, e);
    run_free(&r);
    return status;
}

void forecast_free(struct forecast *f)
{
    free(f->of);
    free(f->sent);
    free(f->by);
    exchanges_free(&f->exchanges);
    *f = (struct forecast){0};
}

struct forecast_rank forecast_sum(const struct forecast *f)
{
    struct forecast_rank s = {0};
    for (int k = 0; k < f->ranks; k++) {
        s.particles += f->of[k].particles;
        s.ghosts += f->of[k].ghosts;
        s.peers += f->of[k].peers;
        s.across += f->of[k].across;
        s.pairs += f->of[k].pairs;
        s.cost += f->of[k].cost;
    }
    return s;
}

double forecast_balance(const struct forecast *f)
{
    double most = 0.0;
    const double sum = forecast_sum(f).cost;
    for (int k = 0; k < f->ranks; k++)
        most = fmax(most, f->of[k].cost);
    return sum > 0.0 ? most * f->ranks / sum : 1.0;
}

struct halo_sent forecast_sent(const struct forecast *f, size_t evaluation)
{
    struct halo_sent s = {0};
    for (size_t i = 0; i < f->exchanges.n; i++) {
        const struct exchange *x = &f->exchanges.at[i];
        if (x->again || (evaluation != SIZE_MAX && x->evaluation != evaluation))
            continue;
        s.messages += f->sent[i].messages;
        s.bytes += f->sent[i].bytes;
    }
    return s;
}
