/* run/advance.c -- one step of the integrator's table, on the columns that the plan's rate table names.
 *
 * What stands between two evaluations is a program of a few lines a component, made anew each time, that
 * is run chunk by chunk, so that each column comes into the cache once. What is held in floats is laid
 * out in doubles for that; positions' mirrors are made in passing, and how far places in quanta have moved
 * since there were lists is seen. What follows the last evaluation of a step may wait for the beginning of
 * the next and be part of its program (run_settle). */
#include "base/clones.h"
#include "run/run.h"
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#define CHUNK SKIN_PIECE
/* Fewer particles than this are done before a second thread has woken. */
#define PARALLEL_FROM 20000

/* A component of a column, in doubles: in place, or laid out. */
struct line {
    int column;
    uint32_t k;
    bool reads, writes, rate; /* rate: looked at, whether it is a number */
};

/* to = base + a (r - r0) of lines; r0 or r may be missing (-1): then without it. */
struct action {
    int to, base, r, r0;
    double a;
};

struct program {
    const struct run *run;
    const struct plan_array *array;
    struct line *line;
    struct action *action;
    size_t n_line, n_action;
};

/* -- Its making --------------------------------------------------------------------------------- */

static int line_of(struct program *g, int column, uint32_t k, bool writes)
{
    size_t i = 0;
    while (i < g->n_line && (g->line[i].column != column || g->line[i].k != k))
        i++;
    if (i == g->n_line)
        g->line[g->n_line++] = (struct line){column, k, !writes, false, false};
    g->line[i].writes = g->line[i].writes || writes;
    return (int)i;
}

/* to = base + a (r - r0), of a component each; columns, -1: missing. */
static void act(struct program *g, uint32_t k, int to, int base, double a, int r, int r0)
{
    struct action x = {.a = a, .r = -1, .r0 = -1};
    x.base = line_of(g, base, k, false);
    if (r >= 0)
        x.r = line_of(g, r, k, false);
    if (r0 >= 0)
        x.r0 = line_of(g, r0, k, false);
    x.to = line_of(g, to, k, true);
    g->action[g->n_action++] = x;
}

/* Trades a rate with its copy, once all have been through the program. */
static bool trades(const struct rate *q)
{
    return q->saved >= 0 && q->anew;
}

static void add(struct program *g, const struct op *op, double step, const struct rate *q,
                uint32_t k)
{
    const bool drifts = q->kind == SPH_DRIFT;
    const double dt = op->a * step;
    switch (op->kind) {
    case OP_KICK:
    case OP_DRIFT:
        if (drifts == (op->kind == OP_DRIFT))
            act(g, k, q->property, q->property, dt, q->rate, -1);
        break;
    case OP_SAVE_STATE:
        act(g, k, q->kept, q->property, 0.0, -1, -1);
        break;
    case OP_SAVE_RATES:
        if (q->saved >= 0 && !trades(q))
            act(g, k, q->saved, q->rate, 0.0, -1, -1);
        break;
    case OP_CORRECT:
        if (q->closed !=
            NO_PASS) /* its pass has done so: what is left is to put both floats in order */
            act(g, k, q->property, q->property, 0.0, -1, -1);
        else if (!drifts)
            act(g, k, q->property, q->property, dt, q->rate, q->saved);
        break;
    case OP_FINISH_DRIFT:
    case OP_FINISH_KICK:
        if (drifts == (op->kind == OP_FINISH_DRIFT))
            act(g, k, q->property, q->kept, dt, q->rate, -1);
        break;
    case OP_EVALUATE:
        break;
    }
}

/* Operations [from, to), none of them an evaluation, over a step of dt. */
static void add_all(struct program *g, size_t from, size_t to, double dt)
{
    const struct plan_array *a = g->array;
    for (size_t i = from; i < to; i++)
        for (size_t q = 0; q < a->n_rate; q++)
            for (uint32_t k = 0; k < a->p.column[a->rate[q].property].ncomp; k++)
                add(g, &g->run->plan->integrator->op[i], dt, &a->rate[q], k);
    for (size_t i = 0; i < g->n_line; i++)
        for (size_t q = 0; q < a->n_rate; q++)
            g->line[i].rate = g->line[i].rate || (g->line[i].writes && //
                                                  a->rate[q].rate == g->line[i].column);
}

static int program_begin(struct program *g, const struct run *r, size_t array, struct error *e)
{
    const struct plan_array *a = &r->plan->array[array];
    size_t components = 0;
    for (size_t q = 0; q < a->n_rate; q++)
        components += a->p.column[a->rate[q].property].ncomp;
    *g = (struct program){.run = r, .array = a};
    const size_t n = components * (r->plan->integrator->n_op + 1) + 1;
    g->line = malloc(4 * (components + 1) * sizeof *g->line);
    g->action = malloc(n * sizeof *g->action);
    return g->line && g->action ? 0 : error_memory(e, "a step", n * sizeof *g->action);
}

static void program_free(struct program *g)
{
    free(g->line);
    free(g->action);
}

/* -- Its run ------------------------------------------------------------------------------------ */

CLONES static void move(double *y, const double *base, double a, const double *r, size_t n)
{
    CLONES_SIMD
    for (size_t i = 0; i < n; i++)
        y[i] = base[i] + a * r[i];
}

CLONES static void correct(double *y, const double *base, double a, const double *r,
                           const double *r0, size_t n)
{
    CLONES_SIMD
    for (size_t i = 0; i < n; i++)
        y[i] = base[i] + a * (r[i] - r0[i]);
}

static void combine(double *y, const double *base, double a, const double *r, const double *r0,
                    size_t n)
{
    if (r0)
        correct(y, base, a, r, r0, n);
    else if (r)
        move(y, base, a, r, n);
    else if (y != base)
        memcpy(y, base, n * sizeof *y);
}

enum { BAD_RATE = 1, BAD_PLACE = 2 };

/* Of the chunk at `first`: positions in quanta that the program has just moved, and still has in doubles. */
static struct skin_change change_of(const struct program *g, size_t first, size_t n, double **at)
{
    const struct plan_array *a = g->array;
    const double *x[3] = {NULL, NULL, NULL};
    for (size_t i = 0; i < g->n_line; i++)
        if (g->line[i].column == a->position && g->line[i].writes)
            x[g->line[i].k] = at[i];
    if (!x[0] || !(a->p.column[a->position].quantum > 0.0) || !g->run->lists_made)
        return (struct skin_change){NAN, NAN};
    return run_change(g->run, (size_t)(a - g->run->plan->array), first, n, x);
}

/* On the chunk at `first`; `room` holds a chunk of every line, `at` a pointer to each. */
static int run_chunk(const struct program *g, size_t first, double **at, double *room,
                     struct skin_change *change)
{
    const struct particles *p = &g->array->p;
    const size_t n = p->n - first < CHUNK ? p->n - first : CHUNK;
    int bad = 0;
    for (size_t i = 0; first + 2 * CHUNK <= p->n && i < g->n_line; i++)
        column_expect(&p->column[g->line[i].column], g->line[i].k, first + CHUNK, CHUNK);
    for (size_t i = 0; i < g->n_line; i++) {
        const struct line *l = &g->line[i];
        const struct column *c = &p->column[l->column];
        const bool doubles = c->size == sizeof(double);
        at[i] = doubles ? (double *)c->data + l->k * c->plane + first : room + i * CHUNK;
        if (!doubles && l->reads)
            column_load(c, l->k, first, n, at[i]);
    }
    for (size_t i = 0; i < g->n_action; i++) {
        const struct action *x = &g->action[i];
        combine(at[x->to], at[x->base], x->a, x->r < 0 ? NULL : at[x->r],
                x->r0 < 0 ? NULL : at[x->r0], n);
    }
    for (size_t i = 0; i < g->n_line; i++) {
        const struct line *l = &g->line[i];
        const struct column *c = &p->column[l->column];
        if (l->rate && any_not_finite(at[i], n))
            bad |= BAD_RATE;
        if (l->writes && c->size != sizeof(double))
            column_store(c, l->k, first, n, at[i]);
        if (l->writes && l->column == g->array->position && c->mirror && g->run->lists_made &&
            !mirror_places(g->run, c, l->k, first, n))
            bad |= BAD_PLACE;
    }
    *change = change_of(g, first, n, at);
    return bad;
}

static int run_program(const struct program *g, int threads, struct skin_change *change,
                       struct error *e)
{
    const long n = (long)g->array->p.n;
    const size_t most = n > PARALLEL_FROM ? (size_t)threads : 1;
    const size_t room = (g->n_line + 1) * CHUNK;
    int bad = 0;
    double moved = 0.0, left = INFINITY, none = 0.0;
    double **at = malloc((g->n_line + 1) * most * sizeof *at);
    double *lent = aligned_alloc(64, room * most * sizeof *lent);
    if (at && lent) {
#pragma omp parallel for schedule(static) num_threads((int)most) reduction(| : bad)                \
    reduction(max : moved) reduction(min : left) reduction(+ : none)
        for (long first = 0; first < n; first += CHUNK) {
            const size_t me = (size_t)omp_get_thread_num();
            struct skin_change here;
            bad |= run_chunk(g, (size_t)first, at + me * (g->n_line + 1), lent + me * room, &here);
            moved = here.moved > moved ? here.moved : moved;
            left = here.room < left ? here.room : left;
            none += here.moved * 0.0;
        }
    }
    *change = (struct skin_change){moved + none, left};
    const int status = at && lent ? bad : error_memory(e, "a step", room * most * sizeof *lent);
    free(at);
    free(lent);
    return status;
}

/* What copies the columns is old; positions' mirrors are not, but of ghosts. */
static void tell(struct run *r, size_t array, const struct program *g, int bad,
                 const struct skin_change *change)
{
    const struct plan_array *a = g->array;
    for (size_t i = 0; i < g->n_line; i++) {
        const int c = g->line[i].column;
        if (!g->line[i].writes)
            continue;
        run_changed(r, array, c);
        if (c == a->position && r->lists_made && !(bad & BAD_PLACE))
            r->mirror_old[array][c] = a->p.n_ghost ? MIRROR_GHOSTS_OLD : MIRROR_FRESH;
    }
    if (change->moved < INFINITY) {
        r->change[array] = *change;
        r->has_change[array] = true;
    }
    r->suspect = r->suspect || (bad & BAD_RATE);
}

/* Rates and their copies trade places. */
static void trade(struct plan_array *a)
{
    for (size_t q = 0; q < a->n_rate; q++)
        if (trades(&a->rate[q]))
            particles_swap(&a->p, a->rate[q].rate, a->rate[q].saved);
}

/* What was left of the step before, then operations [from, to) of this one. */
static int advance(struct run *r, size_t from, size_t to, struct error *e)
{
    const double begin = omp_get_wtime();
    const struct integrator *table = r->plan->integrator;
    bool saves = false;
    for (size_t k = from; k < to; k++)
        saves = saves || table->op[k].kind == OP_SAVE_RATES;
    for (size_t a = 0; a < r->plan->n_array; a++) {
        struct program g;
        struct skin_change change = {NAN, NAN};
        int bad = program_begin(&g, r, a, e);
        if (!bad) {
            add_all(&g, table->n_op - r->left, table->n_op, r->left_dt);
            add_all(&g, from, to, r->dt);
            bad = g.n_action ? run_program(&g, r->threads, &change, e) : 0;
        }
        if (bad >= 0)
            tell(r, a, &g, bad, &change);
        program_free(&g);
        if (bad < 0)
            return -1;
        if (saves)
            trade(&r->plan->array[a]);
    }
    r->left = 0;
    r->lists_suspect = true;
    r->cost.integrate += omp_get_wtime() - begin;
    return 0;
}

/* -- A step ------------------------------------------------------------------------------------- */

int run_settle(struct run *r, struct error *e)
{
    return r->left ? advance(r, 0, 0, e) : 0;
}

static bool has_finish(const struct plan *plan)
{
    for (size_t i = 0; i < plan->n_pass; i++)
        if (plan->pass[i].moment == MOMENT_FINISH)
            return true;
    return false;
}

int run_advance(struct run *r, struct error *e)
{
    const struct integrator *table = r->plan->integrator;
    const double begin = r->time;
    const bool defers = r->defer && !has_finish(r->plan);
    for (size_t k = 0, end; k < table->n_op; k = end) {
        for (end = k; end < table->n_op && table->op[end].kind != OP_EVALUATE;)
            end++;
        if (end == table->n_op && defers) {
            r->left = end - k;
            r->left_dt = r->dt;
            break;
        }
        if (end > k && advance(r, k, end, e))
            return -1;
        if (end == table->n_op)
            break;
        r->time = begin + table->op[end].a * r->dt;
        const struct op *next = end + 1 < table->n_op ? &table->op[end + 1] : NULL;
        r->correct = next && next->kind == OP_CORRECT ? next->a * r->dt : 0.0;
        const int status = run_passes(r, MOMENT_EVALUATE, e);
        r->correct = 0.0;
        if (status)
            return -1;
        end++;
    }
    r->time = begin + r->dt;
    return run_passes(r, MOMENT_FINISH, e) ? -1 : run_population(r, e);
}
