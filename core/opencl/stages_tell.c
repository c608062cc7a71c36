/* opencl/stages_tell.c -- stages told for people and machines (see stages_tell.h). */
#include "config.h"

#include "opencl/stages_tell.h"

#include "opencl/kernels.h"

#include <stdlib.h>
#include <string.h>

/* The stages of all moments, one behind the other. */
struct all_stages {
    struct stage *stage;
    size_t n;
};

static void all_free(struct all_stages *all)
{
    stages_free(all->stage, all->n);
}

static int all_make(struct all_stages *all, const struct plan *plan, struct error *e)
{
    *all = (struct all_stages){NULL, 0};
    for (int m = 0; m < MOMENT_COUNT; m++) {
        struct stage *stage, *grown;
        size_t n;
        if (stages_plan(plan, (enum moment)m, plan->scene->scheme.fuse, &stage, &n, e)) {
            all_free(all);
            return -1;
        }
        grown = realloc(all->stage, (all->n + n + 1) * sizeof(*grown));
        if (!grown) {
            stages_free(stage, n);
            all_free(all);
            return error_memory(e, "the stages", n * sizeof(*stage));
        }
        all->stage = grown;
        memcpy(grown + all->n, stage, n * sizeof(*stage));
        free(stage);
        all->n += n;
    }
    return 0;
}

static const struct pass *pass_of(const struct plan *plan, const struct stage *s, size_t k)
{
    return &plan->pass[s->pass[k]];
}

static bool sweeps(const struct stage *s)
{
    return s->n_head < s->n;
}

/* Whether some pass of the stage has sources in that array. */
static bool sweeps_over(const struct plan *plan, const struct stage *s, size_t array)
{
    for (size_t k = 0; k < s->n; k++) {
        const struct pass *p = pass_of(plan, s, k);
        for (size_t q = 0; p->shape == SPH_PAIR && q < p->n_src; q++)
            if (p->src[q].array == array)
                return true;
    }
    return false;
}

static size_t n_pairs(const struct plan *plan, const struct stage *s)
{
    size_t n = 0;

    for (size_t k = 0; k < s->n; k++)
        n += pass_of(plan, s, k)->shape == SPH_PAIR;
    return n;
}

/* -- People -------- */

static void print_stage(const struct plan *plan, const struct stage *s, size_t number, FILE *out)
{
    int column = fprintf(out, "  %2zu  %-9s", number, moment_name[pass_of(plan, s, 0)->moment]);

    for (size_t k = 0; k < s->n; k++) {
        const char *name = pass_of(plan, s, k)->name;
        if (column + (int)strlen(name) + 2 > 79)
            column = fprintf(out, "\n%*s", 15, "") - 1;
        column += fprintf(out, " %s%s", name, k + 1 < s->n ? "," : "");
    }
    fputs("\n", out);
    if (!sweeps(s))
        return;
    fprintf(out, "%*s%s over", 16, "", n_pairs(plan, s) > 1 ? "one sweep for all" : "a sweep");
    for (size_t a = 0; a < plan->n_array; a++)
        if (sweeps_over(plan, s, a))
            fprintf(out, " %s", plan->array[a].p.name);
    fprintf(out, ", in %s%s%s\n", s->real == SPH_F32 ? "floats" : "doubles",
            s->iterates ? ", repeated" : "", s->phased ? ", in three parts" : "");
}

int stages_print(const struct plan *plan, FILE *out, struct error *e)
{
    struct all_stages all;

    if (all_make(&all, plan, e))
        return -1;
    fprintf(out, "device opencl:%zu: kernels, and the passes that each does for a particle\n",
            plan->scene->device.number);
    for (size_t k = 0; k < all.n; k++)
        print_stage(plan, &all.stage[k], k + 1, out);
    fprintf(out, "transfers\n"
                 "  at the start     all columns, once\n"
                 "  in a step        some numbers: what bounds the time step, sums, how long the\n"
                 "                   lists are, whether they hold\n"
                 "  for output       the columns that are written\n");
    all_free(&all);
    return 0;
}

/* -- Machines -------- */

static cJSON *stage_json(const struct plan *plan, const struct stage *s)
{
    cJSON *one = cJSON_CreateObject();
    cJSON *passes = cJSON_AddArrayToObject(one, "passes");

    for (size_t k = 0; k < s->n; k++)
        cJSON_AddItemToArray(passes, cJSON_CreateString(pass_of(plan, s, k)->name));
    cJSON_AddStringToObject(one, "at", moment_name[pass_of(plan, s, 0)->moment]);
    cJSON_AddStringToObject(one, "array", plan->array[s->array].p.name);
    cJSON_AddNumberToObject(one, "pair_passes", (double)n_pairs(plan, s));
    if (!sweeps(s))
        return one;
    cJSON *sources = cJSON_AddArrayToObject(one, "sources");
    for (size_t a = 0; a < plan->n_array; a++)
        if (sweeps_over(plan, s, a))
            cJSON_AddItemToArray(sources, cJSON_CreateString(plan->array[a].p.name));
    cJSON_AddStringToObject(one, "sums_in", s->real == SPH_F32 ? "floats" : "doubles");
    cJSON_AddBoolToObject(one, "repeated", s->iterates);
    cJSON_AddBoolToObject(one, "in_three_parts", s->phased);
    return one;
}

int stages_json(const struct plan *plan, cJSON *into, struct error *e)
{
    struct all_stages all;

    if (all_make(&all, plan, e))
        return -1;
    cJSON *device = cJSON_AddObjectToObject(into, "device");
    cJSON_AddNumberToObject(device, "number", (double)plan->scene->device.number);
    cJSON *list = cJSON_AddArrayToObject(device, "stages");
    for (size_t k = 0; k < all.n; k++)
        cJSON_AddItemToArray(list, stage_json(plan, &all.stage[k]));
    cJSON *transfers = cJSON_AddObjectToObject(device, "transfers");
    cJSON_AddStringToObject(transfers, "start", "columns");
    cJSON_AddStringToObject(transfers, "step", "numbers");
    cJSON_AddStringToObject(transfers, "output", "columns");
    all_free(&all);
    return 0;
}

/* -- Source -------- */

/* Where columns will stand, of arrays without particles. */
static int make_arenas(struct plan *plan, struct arena *arena, struct error *e)
{
    for (size_t a = 0; a < plan->n_array; a++) {
        struct plan_array *pa = &plan->array[a];
        for (size_t c = 0; c < pa->p.n_column; c++)
            if (pa->mirrored[c] && !pa->p.column[c].mirror && particles_mirror(&pa->p, (int)c, e))
                return -1;
        if (arena_plan(&arena[a], &pa->p, e))
            return -1;
    }
    return 0;
}

int stages_print_kernels(struct plan *plan, bool vectors, FILE *out, struct error *e)
{
    struct arena *arena = calloc(plan->n_array + 1, sizeof(*arena));
    struct all_stages all = {NULL, 0};
    char *text = NULL;

    if (!arena)
        return error_memory(e, "the kernels", plan->n_array * sizeof(*arena));
    if (!make_arenas(plan, arena, e) && !all_make(&all, plan, e)) {
        text = kernels_source(plan, arena, all.stage, all.n, vectors, e);
        all_free(&all);
    }
    for (size_t a = 0; a < plan->n_array; a++)
        arena_fini(&arena[a]);
    free(arena);
    if (!text)
        return -1;
    fputs(text, out);
    free(text);
    return 0;
}
