/* integrators/integrator.c -- finds an integrator by name; what its table asks for. */
#include "integrators/families.h"
#include <string.h>

static const struct integrator *const all[] = {
    &integrator_kdk, &integrator_dkd,   &integrator_symplectic, &integrator_verlet2,
    &integrator_pec, &integrator_pece,  &integrator_rk2,        &integrator_ssp_rk3,
    &integrator_rk4, &integrator_euler,
};
static const char *const names[] = {"kdk",  "dkd", "symplectic", "verlet2", "pec",
                                    "pece", "rk2", "ssp-rk3",    "rk4",     "euler"};

const struct integrator *integrator_find(const char *name)
{
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        if (strcmp(all[i]->name, name) == 0)
            return all[i];
    return NULL;
}

const char *const *integrator_names(size_t *n)
{
    *n = sizeof names / sizeof names[0];
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
