/* run/device_cost.c -- what a run on a device costs: the device's own time into the run's costs, pairs, operations
 * and bytes of every stage. Its report in summary.json is device_report.c's. */
#include "run/device.h"

#include <stdlib.h>
#include <string.h>

int run_device_cost_open(struct run *r, struct error *e)
{
    struct run_device *d = r->device;
    const size_t n = d->first[MOMENT_COUNT];

    d->work = calloc(n + 1, sizeof(*d->work));
    d->told = calloc(SPAN_STAGES + 2 * n, sizeof(*d->told));
    if (!d->work || !d->told)
        return error_memory(e, "what stages cost", n * sizeof(*d->work));
    for (size_t k = 0; k < n; k++)
        if (stage_cost_make(&d->work[k].cost, r->plan, d->arena, &d->stage[k], e))
            return -1;
    return 0;
}

void run_device_cost_close(struct run *r)
{
    struct run_device *d = r->device;

    for (size_t k = 0; d->work && k < d->first[MOMENT_COUNT]; k++)
        stage_cost_free(&d->work[k].cost);
    free(d->work);
    free(d->told);
}

struct pass *run_device_timed(const struct run *r, const struct stage *s)
{
    return &r->plan->pass[s->pass[s->n_head < s->n ? s->n_head : 0]];
}

/* -- Work -------- */

static bool listed(const struct run *r, const struct stage *s, size_t list)
{
    for (size_t k = 0; k < s->n; k++) {
        const struct pass *p = &r->plan->pass[s->pass[k]];
        for (size_t q = 0; p->shape == SPH_PAIR && q < p->n_src; q++)
            if (p->list[q] == list)
                return true;
    }
    return false;
}

void run_device_count(struct run *r, size_t stage, double part)
{
    const struct run_device *d = r->device;
    const struct stage *s = &d->stage[stage];
    struct device_work *w = &d->work[stage];
    const double n = part * (double)d->arena[s->array].n;

    w->flops += n * w->cost.own_flops;
    w->bytes += n * w->cost.own_bytes;
    for (size_t k = 0; k < s->n; k++) {
        struct pass *p = &r->plan->pass[s->pass[k]];
        p->sweeps++;
        for (size_t q = 0; p->shape == SPH_PAIR && q < p->n_src; q++) {
            const size_t list = p->list[q];
            const uint64_t pairs =
                (uint64_t)(part * d->share[list] * (double)d->list[list].n_entry);
            p->pairs += pairs;
            w->pairs += pairs;
            r->cost.pairs += pairs;
            w->flops += (double)pairs * w->cost.pair[k];
        }
    }
    /* A list is read once, whatever passes share it. */
    for (size_t k = 0; k < r->plan->n_list; k++) {
        const struct device_list *list = &d->list[k];
        const size_t src = r->plan->list[k].src;
        if (!listed(r, s, k))
            continue;
        w->flops += part * d->share[k] * (double)list->n_entry * w->cost.geometry;
        w->bytes += part * (4.0 * (double)list->n_entry + 8.0 * (double)list->n_group);
        w->bytes += (double)(d->arena[src].n + d->arena[src].n_ghost) * w->cost.source_bytes[src];
    }
}

/* -- Time -------- */

void run_device_costs(struct run *r)
{
    struct run_device *d = r->device;
    const struct device_span *span;
    size_t n;

    span = device_spans(d->d, &n);
    for (size_t k = 0; k < n && k < SPAN_STAGES + 2 * d->first[MOMENT_COUNT]; k++) {
        const double all = span[k].busy + span[k].idle, more = all - d->told[k];
        d->told[k] = all;
        if (k == SPAN_LISTS)
            r->cost.neighbour += more;
        else if (k == SPAN_INTEGRATE)
            r->cost.integrate += more;
        else if (k >= SPAN_STAGES)
            run_device_timed(r, &d->stage[(k - SPAN_STAGES) / 2])->seconds += more;
    }
}

struct run_memory run_device_memory(const struct run *r)
{
    const struct run_device *d = r->device;
    struct run_memory m = {0};
    size_t most = 0;

    for (size_t k = 0; k < r->plan->n_list; k++)
        m.lists += d->list[k].begin.bytes + d->list[k].common.bytes + d->list[k].step.bytes;
    for (size_t k = 0; k < r->plan->n_array * r->plan->n_frame; k++)
        m.places += d->skin[k].x.bytes + d->skin[k].h.bytes;
    size_t columns = 0;
    for (size_t a = 0; a < r->plan->n_array; a++) {
        m.ghosts += d->ghosts[a].parent.bytes + d->ghosts[a].image.bytes;
        columns += d->arena[a].wide.bytes + d->arena[a].narrow.bytes;
    }
    device_bytes(d->d, &most);
    const size_t known = columns + m.lists + m.places + m.ghosts;
    m.search = most > known ? most - known : 0;
    return m;
}
