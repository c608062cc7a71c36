/* opencl/stage_cost.c -- counts a stage's operations and bytes (see stage_cost.h): every column once for each
 * particle, however often a sweep comes back to it, for a cache holds it meanwhile. */
#include "config.h"

#include "opencl/stage_cost.h"

#include "opencl/body_cost.h"
#include "opencl/kernels_private.h"

#include <stdlib.h>
#include <string.h>

#define SUMS (SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)

/* What happens to a column of an array: of destinations, of sources. */
enum { READ = 1, WRITTEN = 2, SOURCE = 4 };

/* A text of a pass's: which branches parameters choose is known. */
static double flops_of(const struct plan *plan, const struct pass *p, const char *text,
                       const char *prelude, const sph_list *param)
{
    struct body_known known[32];
    struct body_text b = {text, prelude, plan->dim, known, 0};

    for (uint32_t i = 0; i < param->count && i < sizeof(known) / sizeof(known[0]); i++) {
        const sph_device_value *v = list_at(param, i);
        known[b.n_known++] = (struct body_known){v->name, p->use.config.value[v->index]};
    }
    return body_flops(&b);
}

static double flops_of_point(const struct plan *plan, const struct pass *p,
                             const sph_device_point *d)
{
    return d ? flops_of(plan, p, d->text, d->prelude, &d->param) : 0.0;
}

static void note_props(uint8_t *what, const struct pass *p, const struct binding *b, bool source)
{
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        const int c = b->column[k];
        if (c < 0)
            continue;
        if (source) {
            what[c] |= prop->access & SPH_SRC_READ ? SOURCE : 0;
            continue;
        }
        what[c] |= prop->access & SPH_DST_READ || p->continues[k] ? READ : 0;
        what[c] |= prop->access & (SPH_DST_WRITE | SUMS) ? WRITTEN : 0;
    }
}

/* Places and smoothing lengths, which every sweep reads. */
static void note_geometry(uint8_t *what, const struct plan *plan, const struct pass *p,
                          size_t array, uint8_t how)
{
    const struct plan_array *a = &plan->array[array];

    what[p->frame ? particles_find(&a->p, plan->frame[p->frame].name) : a->position] |= how;
    what[a->smoothing] |= how;
}

static void note_pass(uint8_t *what, const struct plan *plan, const struct pass *p, size_t array)
{
    const bool pairs = p->shape == SPH_PAIR;

    if (p->dst.array == array) {
        note_props(what, p, &p->dst, false);
        if (pairs)
            note_geometry(what, plan, p, array, READ);
    }
    for (size_t q = 0; pairs && q < p->n_src; q++)
        if (p->src[q].array == array) {
            note_props(what, p, &p->src[q], true);
            note_geometry(what, plan, p, array, SOURCE);
        }
}

/* Bytes of the columns of an array: as destination, and what sources take beyond that. */
static void add_bytes(struct stage_cost *c, const struct plan *plan, const struct arena *arena,
                      const struct stage *s, size_t array, const uint8_t *what)
{
    const struct particles *p = &plan->array[array].p;

    for (size_t k = 0; k < p->n_column; k++) {
        const struct arena_place *at = &arena[array].place[k];
        const double whole = (double)at->size * p->column[k].ncomp;
        const bool floats = s->real == SPH_F32 && at->mirror >= 0;
        c->own_bytes += what[k] & READ ? whole : 0.0;
        c->own_bytes += what[k] & WRITTEN ? whole : 0.0;
        if ((what[k] & SOURCE) && (floats || !(what[k] & READ)))
            c->source_bytes[array] += floats ? 4.0 * p->column[k].ncomp : whole;
    }
}

static void add_flops(struct stage_cost *c, const struct plan *plan, const struct stage *s)
{
    /* Differences, squares and their sum, the root, its inverse, a comparison. */
    c->geometry = 3.0 * plan->dim + 2.0;
    for (size_t k = 0; k < s->n; k++) {
        const struct pass *p = &plan->pass[s->pass[k]];
        const sph_device_body *d = pass_body(p);
        c->pair[k] = d ? flops_of(plan, p, d->text, d->prelude, &d->param) : 0.0;
        c->own_flops += flops_of_point(plan, p, pass_before(p)) +
                        flops_of_point(plan, p, pass_after(p)) +
                        flops_of_point(plan, p, pass_point(p));
    }
}

int stage_cost_make(struct stage_cost *c, const struct plan *plan, const struct arena *arena,
                    const struct stage *s, struct error *e)
{
    *c = (struct stage_cost){.pair = calloc(s->n + 1, sizeof(double)),
                             .source_bytes = calloc(plan->n_array + 1, sizeof(double))};
    if (!c->pair || !c->source_bytes) {
        stage_cost_free(c);
        return error_memory(e, "what stages cost", s->n * sizeof(double));
    }
    for (size_t a = 0; a < plan->n_array; a++) {
        uint8_t *what = calloc(plan->array[a].p.n_column + 1, 1);
        if (!what) {
            stage_cost_free(c);
            return error_memory(e, "what stages cost", plan->array[a].p.n_column);
        }
        for (size_t k = 0; k < s->n; k++)
            note_pass(what, plan, &plan->pass[s->pass[k]], a);
        add_bytes(c, plan, arena, s, a, what);
        free(what);
    }
    add_flops(c, plan, s);
    return 0;
}

void stage_cost_free(struct stage_cost *c)
{
    free(c->pair);
    free(c->source_bytes);
    *c = (struct stage_cost){0};
}
