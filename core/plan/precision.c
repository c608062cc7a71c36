/* plan/precision.c -- which sweeps work in floats, and how each column is held. A sweep in floats needs all
 * its columns in floats; what an integrator advances is held in two floats then (but in a run of single
 * precision), and in doubles with a mirror what a function without floats sums or the core itself works on. */
#include "plan/inside.h"
#include <stdlib.h>
#include <string.h>

const char *const precision_name[3] = {"double", "mixed", "single"};

static bool takes_floats(const struct pass *p)
{
    return p->shape == SPH_PAIR && p->frame == 0 && p->function &&
           (p->function->reals & SPH_F32) != 0;
}

/* What a pair pass touches, in either role. */
static void mark(const struct pass *p, bool **touched)
{
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        if (p->dst.column[k] >= 0)
            touched[p->dst.array][p->dst.column[k]] = true;
        for (size_t s = 0; s < p->n_src; s++)
            if (p->src[s].column[k] >= 0)
                touched[p->src[s].array][p->src[s].column[k]] = true;
    }
}

static void mark_geometry(const struct plan *plan, const struct pass *p, bool **touched)
{
    const struct plan_array *dst = &plan->array[p->dst.array];
    touched[p->dst.array][dst->position] = touched[p->dst.array][dst->smoothing] = true;
    for (size_t s = 0; s < p->n_src; s++) {
        const struct plan_array *src = &plan->array[p->src[s].array];
        touched[p->src[s].array][src->position] = touched[p->src[s].array][src->smoothing] = true;
    }
}

/* A pair pass writes it, or something is advanced with it. */
static bool is_summed(const struct plan *plan, size_t array, int column)
{
    for (size_t i = 0; i < plan->n_pass; i++)
        if (plan->pass[i].shape == SPH_PAIR && pass_writes(&plan->pass[i], array, column))
            return true;
    for (size_t k = 0; k < plan->array[array].n_rate; k++)
        if (plan->array[array].rate[k].rate == column)
            return true;
    return false;
}

/* Where pairs work in floats so does what is made anew at each evaluation: pressures on the way to what the
 * pairs read. */
static void mark_made_anew(const struct plan_array *a, bool *touched)
{
    for (size_t c = 0; touched[a->position] && c < a->p.n_column; c++)
        touched[c] = touched[c] || !a->p.column[c].state;
}

/* Columns whose doubles somebody needs: sums in doubles, particles that are born, the core. */
static void keep_doubles(struct plan *plan, bool **doubles)
{
    for (size_t i = 0; i < plan->n_pass; i++) {
        const struct pass *p = &plan->pass[i];
        const sph_population *d = p->use.entry ? p->use.entry->population : NULL;
        if (p->shape == SPH_PAIR && p->real == SPH_F64) {
            mark(p, doubles);
            mark_geometry(plan, p, doubles);
        }
        for (uint32_t k = 0; d && k < d->born_props.count; k++) {
            const sph_prop *prop = list_at(&d->born_props, k);
            doubles[p->dst.array][particles_find(&plan->array[p->dst.array].p, prop->name)] = true;
        }
    }
    /* Neighbours are looked for in doubles. An h that stays as it is can be laid out in them for that; places
     * go into doubles and back, which is worth its time in 3D alone: there memory bounds a run. */
    for (size_t a = 0; a < plan->n_array; a++) {
        const int h = plan->array[a].smoothing, x = plan->array[a].position;
        doubles[a][x] =
            doubles[a][x] || plan->dim < 3 || plan->n_frame > 1 || is_summed(plan, a, x);
        doubles[a][h] = doubles[a][h] || plan->n_frame > 1 || plan_changes(plan, a, h);
        /* A device holds everything in doubles: what a destination does alone it does in them. Sweeps
         * in floats read mirrors. */
        for (size_t c = 0; plan->on_device && c < plan->array[a].p.n_column; c++)
            doubles[a][c] = true;
    }
}

static void decide(const struct plan *plan, struct plan_array *a, const bool *floats,
                   const bool *doubles)
{
    for (size_t c = 0; c < a->p.n_column; c++) {
        if (!floats[c] || !column_is_real(&a->p.column[c]))
            continue;
        if ((int)c == a->position && !doubles[c]) {
            a->in_quanta = true;
            continue;
        }
        a->mirrored[c] = doubles[c];
        a->in_floats[c] = !doubles[c];
        for (size_t k = 0; plan->precision != PRECISION_SINGLE && k < a->n_rate; k++)
            a->in_two[c] = a->in_two[c] || (!doubles[c] && a->rate[k].property == (int)c);
    }
}

/* With room for what the integrator will keep: of every rate, and of what it advances. */
static int make_room(struct plan_array *a, struct error *e)
{
    const size_t n = a->p.n_column + SLOT_COUNT * a->n_rate + 1;
    a->in_floats = calloc(n, sizeof *a->in_floats);
    a->in_two = calloc(n, sizeof *a->in_two);
    a->mirrored = calloc(n, sizeof *a->mirrored);
    return a->in_floats && a->in_two && a->mirrored ? 0 : error_memory(e, "the plan", n);
}

int precision_decide(struct plan *plan, struct error *e)
{
    const char *wanted = plan->scene->precision;
    const size_t n = plan->n_array;
    bool **floats = calloc(2 * n + 1, sizeof *floats), **doubles = floats ? floats + n : NULL;
    int status = floats ? 0 : error_memory(e, "the plan", n * sizeof *floats);
    plan->precision =
        plan->scheme && plan->scheme->reals == SPH_F32 ? PRECISION_MIXED : PRECISION_DOUBLE;
    for (int k = 0; wanted && k < 3; k++)
        if (strcmp(wanted, precision_name[k]) == 0)
            plan->precision = (enum precision)k;
    for (size_t a = 0; !status && a < n; a++) {
        struct plan_array *pa = &plan->array[a];
        floats[a] = calloc(pa->p.n_column + 1, sizeof **floats);
        doubles[a] = calloc(pa->p.n_column + 1, sizeof **doubles);
        status = floats[a] && doubles[a] ? make_room(pa, e)
                                         : error_memory(e, "the plan", pa->p.n_column);
    }
    for (size_t i = 0; !status && i < plan->n_pass; i++) {
        struct pass *p = &plan->pass[i];
        p->real = plan->precision != PRECISION_DOUBLE && takes_floats(p) ? SPH_F32 : SPH_F64;
        if (p->real == SPH_F64)
            continue;
        mark(p, floats);
        mark_geometry(plan, p, floats);
    }
    for (size_t a = 0; !status && a < n; a++)
        mark_made_anew(&plan->array[a], floats[a]);
    if (!status)
        keep_doubles(plan, doubles);
    for (size_t a = 0; a < n && floats; a++) {
        if (!status)
            decide(plan, &plan->array[a], floats[a], doubles[a]);
        free(floats[a]);
        free(doubles[a]);
    }
    free(floats);
    return status;
}

size_t plan_bytes(const struct plan *plan, size_t array)
{
    const struct plan_array *a = &plan->array[array];
    size_t bytes = 0;
    for (size_t c = 0; c < a->p.n_column; c++) {
        const struct column *column = &a->p.column[c];
        const size_t size = a->in_floats[c] ? sizeof(float) : column->size;
        bytes += column->ncomp * (size + (a->mirrored[c] || a->in_two[c] ? sizeof(float) : 0));
    }
    return bytes;
}
