/* run/device_check.c -- what speaks against a run on a device: known before the device is opened; and whether it has
 * failed since. */
#include "run/device.h"

#include "opencl/devices.h"
#include "plan/device_memory.h"
#include "domain/ranks.h"
#include "run/domain.h"

#include <stdlib.h>
#include <string.h>

/* `sharing`: ranks that each need as much of it. */
static int check_memory(const struct plan *plan, const struct device_facts *f, int sharing,
                        struct error *e)
{
    const struct device_memory m = plan_device_memory(plan);
    const double memory = (double)f->memory / sharing, largest = (double)f->largest;
    char ranks[64] = "";

    if (m.total <= memory && m.largest <= largest)
        return 0;
    if (sharing > 1)
        snprintf(ranks, sizeof(ranks), " for each of %d ranks", sharing);
    return error_set(
        e, EXIT_RUN,
        "the scene needs about %.3g MB on device \"%s\", which has %.3g MB%s, and %.3g MB in one "
        "buffer (%s), which may have %.3g MB: take fewer particles, another device or --device "
        "cpu",
        1e-6 * m.total, f->name, 1e-6 * memory, ranks, 1e-6 * m.largest,
        m.largest_of ? m.largest_of : "none", 1e-6 * largest);
}

static int check_device(const struct plan *plan, size_t number, int sharing, struct error *e)
{
    struct device_facts facts;

    if (device_look(number, &facts, e))
        return -1;
    if (!facts.fp64)
        return error_set(
            e, EXIT_USAGE,
            "device \"%s\" has no double precision, which the state is kept in: take another "
            "(`sph info --devices'), or --device cpu",
            facts.name);
    return check_memory(plan, &facts, sharing, e);
}

int run_check(const struct plan *plan, uint32_t path, bool audit, struct error *e)
{
    if (!plan->on_device)
        return 0;
    if (audit)
        return error_set(e, EXIT_USAGE,
                         "--audit watches what plugins do on the processor: leave --device out");
    if (path != SPH_PATH_BEST)
        return error_set(e, EXIT_USAGE,
                         "--path chooses among the processor's pair loops: leave --device out");
    /* Of several ranks each looks at its own device, for its own particles, when it knows them. */
    int rank, ranks;
    ranks_count(&rank, &ranks);
    if (ranks == 1)
        return check_device(plan, plan->scene->device.number, 1, e);
    if (plan->strict)
        return error_set(e, EXIT_USAGE,
                         "--strict holds for several ranks on the processor only: leave --device "
                         "or --strict out");
    return 0;
}

/* The devices that are of the same type as the first. */
static size_t count_like_first(const struct opencl_device *list, size_t n)
{
    size_t like = 0;

    for (size_t k = 0; k < n; k++)
        like += strcmp(list[k].type, list[0].type) == 0;
    return like;
}

/* ... the k-th of them. */
static size_t find_like_first(const struct opencl_device *list, size_t n, size_t k)
{
    for (size_t i = 0; i < n; i++)
        if (strcmp(list[i].type, list[0].type) == 0 && k-- == 0)
            return i;
    return 0;
}

int run_device_choose(struct run *r, struct error *e)
{
    struct opencl_device *list;
    size_t n, like = 1;
    int rank, ranks;

    r->device->number = r->plan->scene->device.number;
    if (!run_shared(r))
        return 0;
    if (opencl_devices(&list, &n, e))
        return -1;
    wire_host(r->domain->wire, &rank, &ranks);
    if (!r->plan->scene->device.numbered && n > 0) {
        like = count_like_first(list, n);
        r->device->number = find_like_first(list, n, (size_t)rank % like);
    }
    free(list);
    /* Ranks that take the same: those before this one, itself, and those behind it. */
    const int mine = rank % (int)like;
    return check_device(r->plan, r->device->number, (ranks - 1 - mine) / (int)like + 1, e);
}

bool run_device_failed(const struct run *r, bool *lost)
{
    *lost = false;
    return r->device && r->device->d && device_failed(r->device->d, lost);
}
