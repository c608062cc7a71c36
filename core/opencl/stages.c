/* opencl/stages.c -- cuts a moment's passes into stages (see stages.h). Reads the plan alone. */
#include "opencl/stages.h"

#include <stdlib.h>
#include <string.h>

#define WRITES (SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)

/* What a pass does with a column, in any role. */
enum { OWN = 1, OTHERS = 2, WRITTEN = 4, SUMMED = 8 };

/* Position and h of both sides are read by every pair. */
static unsigned geometry(const struct plan *plan, const struct pass *p, size_t array, int column)
{
    const struct plan_array *a = &plan->array[array];
    const bool place = column == a->smoothing ||
                       (p->frame ? strcmp(a->p.column[column].name, plan->frame[p->frame].name) == 0
                                 : column == a->position);
    unsigned what = 0;

    if (p->shape != SPH_PAIR || !place)
        return 0;
    if (p->dst.array == array)
        what |= OWN;
    for (size_t s = 0; s < p->n_src; s++)
        if (p->src[s].array == array)
            what |= OTHERS;
    return what;
}

static unsigned touches(const struct plan *plan, const struct pass *p, size_t array, int column)
{
    unsigned what = geometry(plan, p, array, column);

    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        if (p->dst.array == array && p->dst.column[k] == column) {
            what |= prop->access & SPH_DST_READ ? OWN : 0;
            what |= prop->access & WRITES ? WRITTEN : 0;
            what |= (prop->access & WRITES) == SPH_DST_SUM ? SUMMED : 0;
        }
        for (size_t s = 0; s < p->n_src; s++)
            if (p->src[s].array == array && p->src[s].column[k] == column &&
                (prop->access & SPH_SRC_READ))
                what |= OTHERS;
    }
    return what;
}

static bool reduces(const struct plan *plan, size_t pass, size_t array, int column)
{
    for (size_t i = 0; i < plan->n_reduction; i++) {
        const struct reduction *r = &plan->reduction[i];
        if (r->pass == pass && (column < 0 || (r->array == array && r->column == column)))
            return true;
    }
    return false;
}

/* A function's prepare may ask for any reduction. */
static bool asks(const struct pass *p)
{
    return p->function && p->function->prepare;
}

/* Whether the second must stay behind the first, and behind all that the first has done for everybody. */
static bool depends(const struct plan *plan, size_t first, size_t second)
{
    const struct pass *p = &plan->pass[first], *q = &plan->pass[second];

    if ((asks(q) && reduces(plan, first, 0, -1)) || (asks(p) && asks(q)))
        return true;
    for (size_t a = 0; a < plan->n_array; a++)
        for (int c = 0; c < (int)plan->array[a].p.n_column; c++) {
            const unsigned x = touches(plan, p, a, c), y = touches(plan, q, a, c);
            if (((x & WRITTEN) && y) || ((y & WRITTEN) && x))
                return true;
        }
    return false;
}

/* Both do nothing with a column but add to it, the second to what the first began, and nobody looks at the sum
 * in between. */
static bool add_up(const struct pass *p, const struct pass *q, int column, unsigned x, unsigned y)
{
    if (x != (WRITTEN | SUMMED) || y != (WRITTEN | SUMMED) || p->after || q->before)
        return false;
    for (uint32_t k = 0; k < q->use.item->props.count; k++)
        if (q->dst.column[k] == column &&
            (((const sph_prop *)list_at(&q->use.item->props, k))->access & SPH_DST_SUM))
            return q->continues[k];
    return false;
}

/* Whether pass q may be done in a stage that has p already, of one array. `early`: q's sweep is done before what
 * p writes is there. */
static bool together(const struct plan *plan, size_t first, size_t second, bool early)
{
    const struct pass *p = &plan->pass[first], *q = &plan->pass[second];
    const size_t array = p->dst.array;

    if (asks(q) && reduces(plan, first, 0, -1))
        return false;
    for (int c = 0; c < (int)plan->array[array].p.n_column; c++) {
        const unsigned x = touches(plan, p, array, c), y = touches(plan, q, array, c);
        if (((x & WRITTEN) && (y & OTHERS)) || ((y & WRITTEN) && (x & OTHERS)))
            return false;
        if ((y & WRITTEN) && reduces(plan, first, array, c))
            return false;
        if ((x & WRITTEN) && (y & OWN) && q->real == SPH_F32 && plan->array[array].mirrored[c])
            return false; /* its mirror is made between stages */
        if (early && (((x & WRITTEN) && y) || ((y & WRITTEN) && x)) && !add_up(p, q, c, x, y))
            return false;
    }
    return true;
}

static bool same_lists(const struct pass *p, const struct pass *q)
{
    for (size_t s = 0; s < q->n_src; s++)
        for (size_t k = 0; k < p->n_src; k++)
            if (p->src[k].array == q->src[s].array && p->list[k] != q->list[s])
                return false;
    return true;
}

static bool joins(const struct plan *plan, const struct stage *s, size_t pass)
{
    const struct pass *q = &plan->pass[pass];

    if (s->array != q->dst.array || s->iterates || s->phased || q->max_sweeps ||
        (q->shape == SPH_PAIR && !q->local))
        return false;
    for (size_t k = 0; k < s->n; k++) {
        const struct pass *p = &plan->pass[s->pass[k]];
        const bool both = p->shape == SPH_PAIR && q->shape == SPH_PAIR;
        if (both && (p->real != q->real || p->frame != q->frame || !same_lists(p, q)))
            return false;
        if (!together(plan, s->pass[k], pass, q->shape == SPH_PAIR && k >= s->n_head))
            return false;
    }
    return true;
}

/* The stage that the pass may join, the later ones having nothing to do with it; or n. */
static size_t place_for(const struct plan *plan, const struct stage *stage, size_t n, size_t pass)
{
    for (size_t k = n; k-- > 0;) {
        if (joins(plan, &stage[k], pass))
            return k;
        for (size_t i = 0; i < stage[k].n; i++)
            if (depends(plan, stage[k].pass[i], pass))
                return n;
    }
    return n;
}

static int append(struct stage *s, const struct plan *plan, size_t pass, struct error *e)
{
    const struct pass *p = &plan->pass[pass];
    size_t *bigger = realloc(s->pass, (s->n + 1) * sizeof(*bigger));
    const bool head = s->n_head == s->n;

    if (!bigger)
        return error_memory(e, "the stages", (s->n + 1) * sizeof(*bigger));
    s->pass = bigger;
    s->pass[s->n++] = pass;
    if (head && p->shape == SPH_POINT)
        s->n_head = s->n;
    if (head && p->shape == SPH_PAIR) {
        s->real = p->real;
        s->frame = p->frame;
    }
    s->array = p->dst.array;
    s->iterates = p->max_sweeps > 0;
    s->phased = p->shape == SPH_PAIR && !p->local;
    return 0;
}

int stages_plan(const struct plan *plan, enum moment moment, bool fuse, struct stage **out,
                size_t *n, struct error *e)
{
    struct stage *stage = calloc(plan->n_pass + 1, sizeof(*stage));

    *n = 0;
    *out = stage;
    if (!stage)
        return error_memory(e, "the stages", plan->n_pass * sizeof(*stage));
    for (size_t i = 0; i < plan->n_pass; i++) {
        if (plan->pass[i].moment != moment)
            continue;
        const size_t k = fuse ? place_for(plan, stage, *n, i) : *n;
        *n += k == *n;
        if (append(&stage[k], plan, i, e)) {
            stages_free(stage, *n);
            *out = NULL;
            *n = 0;
            return -1;
        }
    }
    return 0;
}

void stages_free(struct stage *stage, size_t n)
{
    for (size_t k = 0; stage && k < n; k++)
        free(stage[k].pass);
    free(stage);
}
