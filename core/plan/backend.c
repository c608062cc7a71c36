/* plan/backend.c -- whether a run can be on the device that is asked for: every pass needs bodies for it. */
#include "plan/inside.h"
#include <stdio.h>

bool pass_on_device(const struct plan *plan, const struct pass *p, char *why, size_t size)
{
    const struct entry *entry = p->use.entry;

    if (p->assignment ? assignment_device(p->assignment) != NULL : entry_on_device(entry))
        return true;
    if (p->assignment)
        snprintf(why, size, "the expression of \"%s\" is computed on the processor", p->step);
    else
        snprintf(why, size, "%s \"%s\" of plugin \"%s\" has no device body",
                 p->function ? "function" : "equation of state", p->use.item->name,
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
        if (plan->registry->rank == 0)
            fprintf(stderr, "sph: %s: the scene runs on the processor\n", why);
        plan->on_device = false;
    }
    return 0;
}
