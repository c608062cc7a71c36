/* run/device_report.c -- "device" of summary.json: what a run on a device cost there, by kernels, transfers and
 * stages, and what part that is of what the device reaches. Reads alone, but that it waits for the device and
 * lets it be measured. */
#include "run/device.h"
#include "run/domain.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void number(cJSON *to, const char *key, double value)
{
    cJSON_AddItemToObject(to, key,
                          isfinite(value) ? cJSON_CreateNumber(value) : cJSON_CreateNull());
}

/* Not a number where nothing was done, or nobody knows. */
static double per(double a, double b)
{
    return b > 0.0 ? a / b : (double)NAN;
}

/* -- Kernels, transfers -------- */

static bool is_transfer(const char *name)
{
    return strcmp(name, "read") == 0 || strcmp(name, "write") == 0 || strcmp(name, "copy") == 0 ||
           strcmp(name, "fill") == 0;
}

static int by_time(const void *a, const void *b)
{
    const struct device_time *const *x = a, *const *y = b;

    return ((*x)->seconds < (*y)->seconds) - ((*x)->seconds > (*y)->seconds);
}

static void put_kernels(cJSON *to, const struct device_time *time, size_t n)
{
    const struct device_time **sorted = malloc((n + 1) * sizeof(*sorted));
    cJSON *list = cJSON_AddArrayToObject(to, "kernels");
    double all = 0.0;
    size_t k = 0;

    for (size_t i = 0; sorted && i < n; i++)
        if (!is_transfer(time[i].name) && time[i].launches) {
            sorted[k++] = &time[i];
            all += time[i].seconds;
        }
    if (sorted)
        qsort(sorted, k, sizeof(*sorted), by_time);
    for (size_t i = 0; i < k; i++) {
        cJSON *one = cJSON_CreateObject();
        cJSON_AddStringToObject(one, "name", sorted[i]->name);
        number(one, "seconds", sorted[i]->seconds);
        number(one, "launches", (double)sorted[i]->launches);
        number(one, "share", per(sorted[i]->seconds, all));
        cJSON_AddItemToArray(list, one);
    }
    free(sorted);
}

static void put_transfers(cJSON *to, const struct device_time *time, size_t n)
{
    cJSON *all = cJSON_AddObjectToObject(to, "transfers");

    for (size_t i = 0; i < n; i++) {
        if (!is_transfer(time[i].name))
            continue;
        cJSON *one = cJSON_AddObjectToObject(all, time[i].name);
        number(one, "bytes", (double)time[i].bytes);
        number(one, "seconds", time[i].seconds);
        number(one, "count", (double)time[i].launches);
    }
}

/* -- Stages -------- */

/* What was done in a time, and which of the two limits of the device is nearer. */
static void put_rates(cJSON *to, double seconds, double flops, double bytes, double flops_most,
                      double bytes_most)
{
    const double rate = per(per(flops, seconds), flops_most);
    const double bandwidth = per(per(bytes, seconds), bytes_most);

    number(to, "flops_per_s", per(flops, seconds));
    number(to, "bytes_per_s", per(bytes, seconds));
    number(to, "share_of_rate", rate);
    number(to, "share_of_bandwidth", bandwidth);
    if (isfinite(rate) && isfinite(bandwidth))
        cJSON_AddStringToObject(to, "limit", rate > bandwidth ? "rate" : "bandwidth");
}

static void put_stage(cJSON *list, const struct run *r, size_t k, double seconds,
                      const struct device_rates *rates)
{
    const struct stage *s = &r->device->stage[k];
    const struct device_work *w = &r->device->work[k];
    cJSON *one = cJSON_CreateObject();
    cJSON *passes = cJSON_AddArrayToObject(one, "passes");

    for (size_t i = 0; i < s->n; i++)
        cJSON_AddItemToArray(passes, cJSON_CreateString(r->plan->pass[s->pass[i]].name));
    cJSON_AddStringToObject(one, "at", moment_name[r->plan->pass[s->pass[0]].moment]);
    number(one, "seconds", seconds);
    number(one, "sweeps", (double)w->sweeps);
    number(one, "pairs", (double)w->pairs);
    if (w->pairs) {
        cJSON_AddStringToObject(one, "sums_in", s->real == SPH_F32 ? "floats" : "doubles");
        number(one, "ns_per_pair", per(1e9 * seconds, (double)w->pairs));
        number(one, "flops_per_pair", per(w->flops, (double)w->pairs));
    }
    put_rates(one, seconds, w->flops, w->bytes,
              s->real == SPH_F32 && w->pairs ? rates->flops_f32 : rates->flops_f64, rates->bytes);
    cJSON_AddItemToArray(list, one);
}

/* All stages that sweep, as if they were one. */
static void put_sweeps(cJSON *to, const struct run *r, const struct device_span *span, size_t n,
                       const struct device_rates *rates)
{
    const struct run_device *d = r->device;
    double seconds = 0.0, flops = 0.0, bytes = 0.0, pairs = 0.0, at_rate = 0.0;
    cJSON *all = cJSON_AddObjectToObject(to, "sweeps");

    for (size_t k = 0; k < d->first[MOMENT_COUNT] && SPAN_STAGES + 2 * k < n; k++) {
        const struct device_work *w = &d->work[k];
        if (!w->pairs)
            continue;
        seconds += span[SPAN_STAGES + 2 * k].busy;
        pairs += (double)w->pairs;
        flops += w->flops;
        bytes += w->bytes;
        at_rate += per(w->flops, d->stage[k].real == SPH_F32 ? rates->flops_f32 : rates->flops_f64);
    }
    number(all, "seconds", seconds);
    number(all, "pairs", pairs);
    number(all, "ns_per_pair", per(1e9 * seconds, pairs));
    /* Each stage against the rate of its own precision. */
    put_rates(all, seconds, flops, bytes, per(flops, at_rate), rates->bytes);
}

static void put_stages(cJSON *to, const struct run *r, const struct device_span *span, size_t n,
                       const struct device_rates *rates)
{
    cJSON *list = cJSON_AddArrayToObject(to, "stages");

    for (size_t k = 0; k < r->device->first[MOMENT_COUNT]; k++)
        put_stage(list, r, k, SPAN_STAGES + 2 * k < n ? span[SPAN_STAGES + 2 * k].busy : 0.0,
                  rates);
    put_sweeps(to, r, span, n, rates);
}

/* -- The whole -------- */

/* Of each rank the number of its device. */
static void put_taken(cJSON *to, const struct run *r)
{
    if (r->device->taken && run_shared(r))
        cJSON_AddItemToObject(to, "of_ranks",
                              cJSON_CreateIntArray(r->device->taken, wire_size(r->domain->wire)));
}

static void put_facts(cJSON *to, const struct run *r)
{
    struct device *d = r->device->d;
    const struct device_facts *f = device_facts(d);
    unsigned cached, built;
    size_t most;
    const double seconds = device_build_seconds(d, &cached, &built);

    device_bytes(d, &most);
    cJSON_AddStringToObject(to, "name", f->name);
    cJSON_AddStringToObject(to, "platform", f->platform);
    cJSON_AddStringToObject(to, "driver", f->driver);
    cJSON_AddStringToObject(to, "type", f->type);
    number(to, "number", (double)r->device->number);
    put_taken(to, r);
    number(to, "bytes_most", (double)most);
    number(to, "build_s", seconds);
    number(to, "programs_built", built);
    number(to, "programs_from_cache", cached);
}

cJSON *run_device_report(struct run *r)
{
    struct device *d = r->device->d;
    cJSON *root = cJSON_CreateObject();
    struct device_rates rates = {0};
    struct error ignored = {0};
    size_t n_time, n_span;
    double busy = 0.0;

    if (!root)
        return NULL;
    put_facts(root, r);
    /* Before it is measured, which is none of the run's work. */
    const struct device_time *time = device_times(d, &n_time);
    for (size_t i = 0; i < n_time; i++)
        busy += time[i].seconds;
    number(root, "busy_s", busy);
    put_kernels(root, time, n_time);
    put_transfers(root, time, n_time);
    const struct device_span *span = device_spans(d, &n_span);
    struct device_span *kept = malloc((n_span + 1) * sizeof(*kept));
    if (kept && n_span)
        memcpy(kept, span, n_span * sizeof(*kept));
    if (device_measure(d, &rates, &ignored))
        rates = (struct device_rates){0};
    cJSON *limits = cJSON_AddObjectToObject(root, "limits");
    number(limits, "bytes_per_s", per(rates.bytes, 1.0));
    number(limits, "flops_per_s_f32", per(rates.flops_f32, 1.0));
    number(limits, "flops_per_s_f64", per(rates.flops_f64, 1.0));
    if (kept)
        put_stages(root, r, kept, n_span, &rates);
    free(kept);
    return root;
}

cJSON *run_device_shared(const struct run *r)
{
    const struct run_device *d = r->device;
    cJSON *root = cJSON_CreateObject();

    for (size_t k = 0; root && k < d->first[MOMENT_COUNT]; k++)
        for (size_t i = 0; i < d->stage[k].n; i++) {
            const struct pass *p = &r->plan->pass[d->stage[k].pass[i]],
                              *timed = run_device_timed(r, &d->stage[k]);
            if (p != timed && strcmp(p->name, timed->name) != 0 &&
                !cJSON_HasObjectItem(root, p->name))
                cJSON_AddStringToObject(root, p->name, timed->name);
        }
    return root;
}
