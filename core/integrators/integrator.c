/* integrators/integrator.c -- finds an integrator by name; what its table asks for. */
#include "integrators/families.h"
#include <string.h>

static const struct integrator *const all[] = {
    &integrator_kdk, &integrator_dkd,   &integrator_symplectic, &integrator_verlet2,
    &integrator_pec, &integrator_pece,  &integrator_rk2,        &integrator_ssp_rk3,
    &integrator_rk4, &integrator_euler,
};

#define INTEGRATORS (sizeof all / sizeof all[0])

const struct integrator *integrator_find(const char *name)
{
    for (size_t i = 0; i < INTEGRATORS; i++)
        if (strcmp(all[i]->name, name) == 0)
            return all[i];
    return NULL;
}

const char *const *integrator_names(size_t *n)
{
    static const char *names[INTEGRATORS];
    for (size_t i = 0; i < INTEGRATORS; i++)
        names[i] = all[i]->name;
    *n = INTEGRATORS;
    return names;
}

bool integrator_keeps(const struct integrator *i, uint32_t on, enum slot slot)
{
    for (size_t k = 0; k < i->n_op; k++)
        if (i->op[k].kind == OP_COMBINE && i->op[k].to == slot && (i->op[k].on & on))
            return true;
    return false;
}

bool integrator_saves_rates(const struct integrator *i)
{
    for (size_t k = 0; k < i->n_op; k++)
        if (i->op[k].kind == OP_SAVE_RATES)
            return true;
    return false;
}

bool integrator_ends_evaluated(const struct integrator *i)
{
    size_t k = i->n_op;
    while (k > 0 && i->op[k - 1].kind == OP_CORRECT)
        k--; /* of what was predicted: the sums were of that */
    return k > 0 && i->op[k - 1].kind == OP_EVALUATE && i->op[k - 1].a >= 1.0;
}
