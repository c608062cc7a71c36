/* run/region.c -- regions of a scene, as expressions. */
#include "run/region.h"
#include "scene/expression.h"

int region_select(const struct plan_array *a, const char *where, bool *inside, struct error *e)
{
    struct expression *x = NULL;
    if (where && expression_new(&x, where, scene_variables, SCENE_REGION_VARIABLES, e))
        return -1;
    for (size_t i = 0; i < a->p.n; i++) {
        double at[3] = {0.0, 0.0, 0.0}, v[SCENE_VARIABLES];
        for (int c = 0; c < a->p.dim; c++)
            at[c] = column_get(&a->p.column[a->position], (uint32_t)c, i);
        scene_values(at, a->p.dim, 0.0, v);
        inside[i] = !x || expression_at(x, v) != 0.0;
    }
    expression_free(x);
    return 0;
}
