/* plan/exchange.c -- see exchange.h. Steps are gone through with nothing but a flag for each column: whether its
 * ghosts are out of date. After the first step every further one is like the one before. */
#include "plan/exchange.h"
#include <stdlib.h>
#include <string.h>

#define STEPS 3 /* gone through; the last is kept */

struct going {
    const struct plan *plan;
    struct exchanges *x;
    bool **stale;      /* [array][column] */
    size_t evaluation; /* of the step */
};

void exchanges_free(struct exchanges *x)
{
    free(x->at);
    free(x->column);
    *x = (struct exchanges){0};
}

static int begin(struct exchanges *x, size_t pass, size_t evaluation, bool again, struct error *e)
{
    if (x->n == x->capacity) {
        const size_t capacity = 2 * x->capacity + 16;
        struct exchange *at = realloc(x->at, capacity * sizeof *at);
        if (!at)
            return error_memory(e, "exchanges", capacity * sizeof *at);
        x->at = at;
        x->capacity = capacity;
    }
    x->at[x->n++] = (struct exchange){pass, evaluation, again, x->n_column, 0};
    return 0;
}

/* An exchange of nothing is none. */
static void end(struct exchanges *x)
{
    x->n -= x->at[x->n - 1].n == 0;
}

/* The column's ghosts are wanted. */
static int want(struct going *g, size_t array, int column, struct error *e)
{
    struct exchanges *x = g->x;
    if (column < 0 || !g->stale[array][column])
        return 0;
    if (x->n_column == x->column_capacity) {
        const size_t capacity = 2 * x->column_capacity + 64;
        struct exchange_column *more = realloc(x->column, capacity * sizeof *more);
        if (!more)
            return error_memory(e, "exchanges", capacity * sizeof *more);
        x->column = more;
        x->column_capacity = capacity;
    }
    x->column[x->n_column++] = (struct exchange_column){array, column};
    x->at[x->n - 1].n++;
    g->stale[array][column] = false;
    return 0;
}

/* -- A pass -------- */

/* Before a sweep: all that it reads of sources, their places and smoothing lengths included; and what the pass
 * corrects as it ends (run/closing.c), as ghosts take its values before. */
static int before_sweep(struct going *g, size_t pass, bool again, bool corrects, struct error *e)
{
    const struct pass *p = &g->plan->pass[pass];
    const struct plan_array *dst = &g->plan->array[p->dst.array];
    if (begin(g->x, pass, g->evaluation, again, e))
        return -1;
    for (size_t q = 0; corrects && q < dst->n_rate; q++)
        if (dst->rate[q].closed == pass && want(g, p->dst.array, dst->rate[q].property, e))
            return -1;
    for (size_t s = 0; p->shape == SPH_PAIR && s < p->n_src; s++) {
        const struct plan_array *a = &g->plan->array[p->src[s].array];
        for (uint32_t k = 0; k < p->use.item->props.count; k++)
            if (want(g, p->src[s].array, p->src[s].column[k], e))
                return -1;
        if (want(g, p->src[s].array, a->position, e) || want(g, p->src[s].array, a->smoothing, e))
            return -1;
    }
    end(g->x);
    return 0;
}

static void written(struct going *g, const struct pass *p)
{
    for (uint32_t k = 0; k < p->use.item->props.count; k++)
        if (p->dst.column[k] >= 0 && pass_writes(p, p->dst.array, p->dst.column[k]))
            g->stale[p->dst.array][p->dst.column[k]] = true;
}

static int passes(struct going *g, enum moment moment, bool corrects, struct error *e)
{
    for (size_t i = 0; i < g->plan->n_pass; i++) {
        const struct pass *p = &g->plan->pass[i];
        if (p->moment != moment)
            continue;
        if (before_sweep(g, i, false, corrects, e))
            return -1;
        written(g, p);
        if (!p->max_sweeps || (moment == MOMENT_EVALUATE && g->evaluation > 0))
            continue; /* further sweeps are alike in all evaluations */
        if (before_sweep(g, i, true, corrects, e))
            return -1;
        written(g, p);
    }
    return 0;
}

/* -- A step -------- */

/* What an operation of the integrator writes. */
static void advanced(struct going *g, const struct op *op)
{
    for (size_t i = 0; i < g->plan->n_array; i++) {
        const struct plan_array *a = &g->plan->array[i];
        for (size_t q = 0; q < a->n_rate; q++) {
            const struct rate *r = &a->rate[q];
            if (!(op->on & r->kind))
                continue;
            const bool swaps = op->kind == OP_SWAP;
            const int to = op->kind == OP_COMBINE      ? r->kept[op->to]
                           : swaps                     ? r->kept[SLOT_0]
                           : op->kind == OP_SAVE_RATES ? r->saved
                                                       : r->property;
            if (to >= 0)
                g->stale[i][to] = true;
            if (swaps)
                g->stale[i][r->property] = true;
        }
    }
}

static int step(struct going *g, struct error *e)
{
    const struct integrator *table = g->plan->integrator;
    g->evaluation = 0;
    for (size_t k = 0; k < table->n_op; k++) {
        const struct op *op = &table->op[k];
        if (op->kind != OP_EVALUATE) {
            advanced(g, op);
            continue;
        }
        const bool corrects = k + 1 < table->n_op && op[1].kind == OP_CORRECT && op[1].a != 0.0;
        if (passes(g, MOMENT_EVALUATE, corrects, e))
            return -1;
        g->evaluation++;
    }
    return passes(g, MOMENT_FINISH, false, e);
}

int exchanges_make(struct exchanges *x, const struct plan *plan, struct error *e)
{
    struct going g = {.plan = plan, .x = x};
    int status = 0;
    *x = (struct exchanges){0};
    g.stale = calloc(plan->n_array + 1, sizeof *g.stale);
    if (!g.stale)
        return error_memory(e, "exchanges", plan->n_array * sizeof *g.stale);
    for (size_t a = 0; !status && a < plan->n_array; a++) {
        const size_t n = plan->array[a].p.n_column;
        g.stale[a] = malloc(n + 1);
        if (g.stale[a])
            memset(g.stale[a], true, n);
        else
            status = error_memory(e, "exchanges", n);
    }
    for (int k = 0; !status && k < STEPS; k++) {
        x->n = x->n_column = 0;
        status = step(&g, e);
    }
    for (size_t a = 0; a < plan->n_array; a++)
        free(g.stale[a]);
    free(g.stale);
    return status;
}

/* -- Bytes -------- */

/* Of an element: a value in doubles, in floats, or in two parts of four bytes each. */
static size_t element(const struct plan_array *a, int column)
{
    const struct column *c = &a->p.column[column];
    const bool parts = a->in_two[column] || (a->in_quanta && column == a->position);
    return c->ncomp * (parts || !(a->in_floats[column] || c->type == SPH_INT32) ? 8 : 4);
}

size_t exchange_bytes(const struct exchanges *x, const struct exchange *one,
                      const struct plan *plan, const size_t *n)
{
    size_t bytes = 0;
    for (size_t k = one->first; k < one->first + one->n; k++) {
        const struct exchange_column *c = &x->column[k];
        bytes += (n[c->array] * element(&plan->array[c->array], c->column) + 7) / 8 * 8;
    }
    return bytes;
}
