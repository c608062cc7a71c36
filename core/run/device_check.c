/* run/device_check.c -- what speaks against a run on a device: known before the device is opened; and whether it has
 * failed since. */
#include "run/device.h"

#include "plan/device_memory.h"

static int check_memory(const struct plan *plan, const struct device_facts *f, struct error *e)
{
    const struct device_memory m = plan_device_memory(plan);
    const double memory = (double)f->memory, largest = (double)f->largest;

    if (m.total <= memory && m.largest <= largest)
        return 0;
    return error_set(
        e, EXIT_RUN,
        "the scene needs about %.3g MB on device \"%s\", which has %.3g MB, and %.3g MB in one "
        "buffer (%s), which may have %.3g MB: take fewer particles, another device or --device "
        "cpu",
        1e-6 * m.total, f->name, 1e-6 * memory, 1e-6 * m.largest,
        m.largest_of ? m.largest_of : "none", 1e-6 * largest);
}

int run_check(const struct plan *plan, uint32_t path, bool audit, struct error *e)
{
    struct device_facts facts;

    if (!plan->on_device)
        return 0;
    if (audit)
        return error_set(e, EXIT_USAGE,
                         "--audit watches what plugins do on the processor: leave --device out");
    if (path != SPH_PATH_BEST)
        return error_set(e, EXIT_USAGE,
                         "--path chooses among the processor's pair loops: leave --device out");
    if (device_look(plan->scene->device.number, &facts, e))
        return -1;
    if (!facts.fp64)
        return error_set(
            e, EXIT_USAGE,
            "device \"%s\" has no double precision, which the state is kept in: take another "
            "(`sph info --devices'), or --device cpu",
            facts.name);
    return check_memory(plan, &facts, e);
}

bool run_device_failed(const struct run *r, bool *lost)
{
    *lost = false;
    return r->device && r->device->d && device_failed(r->device->d, lost);
}
