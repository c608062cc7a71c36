/* integrators/integrator.c -- finds an integrator by name. */
#include "integrators/families.h"
#include <string.h>

static const struct integrator *const all[] = {&integrator_kdk, &integrator_pec};
static const char *const names[] = {"kdk", "pec"};

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
