/* plan/backend.c -- whether a run can be on the device that is asked for: every pass needs bodies for it. */
#include "plan/inside.h"
#include <stdio.h>

bool pass_on_device(const struct plan *plan, const struct pass *p, char *why, size_t size)
{
    const struct entry *entry = p->use.entry;
    const char *lacks = NULL;

    if (p->assignment && assignment_device(p->assignment))
        return true;
    if (p->assignment) {
        snprintf(why, size, "the expression of \"%s\" is computed on the processor", p->step);
        return false;
    }
    if (!p->function)
        lacks = entry_eos(entry)->device ? NULL : "equation of state";
    else if (p->shape == SPH_POINT)
        lacks = p->function->device_run ? NULL : "function";
    else if (!p->function->device || (p->before && !p->function->device_before) ||
             (p->after && !p->function->device_after))
        lacks = "function";
    if (!lacks)
        return true;
    snprintf(why, size, "%s \"%s\" of plugin \"%s\" has no device body", lacks, p->use.item->name,
             plan->registry->plugin[entry->plugin].name);
    return false;
}

int backend_decide(struct plan *plan, struct error *e)
{
    char why[512];

    plan->on_device = plan->scene->device.opencl;
    for (size_t i = 0; plan->on_device && i < plan->n_pass; i++) {
        if (pass_on_device(plan, &plan->pass[i], why, sizeof(why)))
            continue;
        if (plan->scene->device.only)
            return error_set(e, EXIT_USAGE,
                             "--device-only: %s, so that this scene can not run on a device", why);
        fprintf(stderr, "sph: %s: the scene runs on the processor\n", why);
        plan->on_device = false;
    }
    return 0;
}
