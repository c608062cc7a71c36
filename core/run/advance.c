/* run/advance.c -- one step of the integrator's table, on the columns that the plan's rate table names.
 *
 * What stands between two evaluations is a program of a few lines a component, made anew each time, that
 * is run chunk by chunk, so that each column comes into the cache once. What is held in floats is laid
 * out in doubles for that; positions' mirrors are made in passing, and how far places in quanta have moved
 * since there were lists is seen. What follows the last evaluation of a step may wait for the beginning of
 * the next and be part of its program (run_settle). */
#include "base/clones.h"
#include "run/device.h"
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
    bool settles;             /* written by what was left of the step before */
};

/* to = w base + w_also also + a (r - r0) + a2 r2 of lines; other lines than to and base may be missing
 * (-1): then without them.
 * swaps: to and base trade their values instead. */
struct action {
    int to, base, also, r, r0, r2;
    double w, w_also, a, a2;
    bool swaps;
};

struct program {
    const struct run *run;
    const struct plan_array *array;
    struct line *line;
    struct action *action;
    size_t n_line, n_action;
    size_t n_left; /* actions that were left of the step before */
};

/* -- Its making --------------------------------------------------------------------------------- */

static int line_of(struct program *g, int column, uint32_t k, bool writes)
{
    size_t i = 0;
    while (i < g->n_line && (g->line[i].column != column || g->line[i].k != k))
        i++;
    if (i == g->n_line)
        g->line[g->n_line++] = (struct line){.column = column, .k = k, .reads = !writes};
    g->line[i].writes = g->line[i].writes || writes;
    return (int)i;
}

/* The column's component as a line of an action; column -1: missing. */
static int line_read(struct program *g, int column, uint32_t k)
{
    return column < 0 ? -1 : line_of(g, column, k, false);
}

/* to = base + a (r - r0), of a component each; columns, -1: missing. */
static struct action *act(struct program *g, uint32_t k, int to, int base, double a, int r, int r0)
{
    struct action *x = &g->action[g->n_action++];
    *x = (struct action){.a = a, .w = 1.0, .also = -1, .r2 = -1};
    x->base = line_read(g, base, k);
    x->r = line_read(g, r, k);
    x->r0 = line_read(g, r0, k);
    x->to = line_of(g, to, k, true);
    return x;
}

/* Trades a rate with its copy, once all have been through the program. */
static bool trades(const struct rate *q)
{
    return q->saved >= 0 && q->anew;
}

/* The rate of a rate, or -1: of a velocity the acceleration. */
static int rate_of(const struct plan_array *a, int column)
{
    for (size_t q = 0; q < a->n_rate; q++)
        if (a->rate[q].property == column)
            return a->rate[q].rate;
    return -1;
}

static void add_combination(struct program *g, const struct op *op, double step,
                            const struct rate *q, uint32_t k)
{
    const int second = op->a2 != 0.0 ? rate_of(g->array, q->rate) : -1;
    int slot[SLOT_COUNT] = {SLOT_NOW}, n = 0;
    for (int s = SLOT_NOW; s < SLOT_COUNT; s++)
        if (op->weight[s] != 0.0) {
            slot[n++] = s;
            line_read(g, q->kept[s], k); /* before it is written, if it is */
        }
    struct action *x =
        act(g, k, q->kept[op->to], q->kept[slot[0]], op->a * step, op->a != 0.0 ? q->rate : -1, -1);
    x->w = op->weight[slot[0]];
    if (n > 1) {
        x->also = line_read(g, q->kept[slot[1]], k);
        x->w_also = op->weight[slot[1]];
    }
    x->r2 = line_read(g, second, k);
    x->a2 = op->a2 * step * step;
}

static void add(struct program *g, const struct op *op, double step, const struct rate *q,
                uint32_t k)
{
    if (!(op->on & q->kind))
        return;
    switch (op->kind) {
    case OP_COMBINE:
        add_combination(g, op, step, q, k);
        break;
    case OP_SWAP:
        act(g, k, q->kept[SLOT_0], q->property, 0.0, -1, -1)->swaps = true;
        line_of(g, q->property, k, true);
        break;
    case OP_SAVE_RATES:
        if (q->saved >= 0 && !trades(q))
            act(g, k, q->saved, q->rate, 0.0, -1, -1);
        break;
    case OP_CORRECT:
        if (q->closed !=
            NO_PASS) /* its pass has done so: what is left is to put both floats in order */
            act(g, k, q->property, q->property, 0.0, -1, -1);
        else
            act(g, k, q->property, q->property, op->a * step, q->rate, q->saved);
        break;
    case OP_EVALUATE:
        break;
    }
}

/* What has been added so far ends a step: where other actions follow, it is brought to what the
 * columns can hold, as it would be if the step had been settled. So no bit depends on whether
 * somebody looked between. */
static void end_step(struct program *g)
{
    g->n_left = g->n_action;
    for (size_t i = 0; i < g->n_line; i++)
        g->line[i].settles = g->line[i].writes;
}

/* Operations [from, to), none of them an evaluation, over a step of dt. */
static void add_all(struct program *g, size_t from, size_t to, double dt)
{
    const struct plan_array *a = g->array;
    for (size_t i = from; i < to; i++)
        for (size_t q = 0; q < a->n_rate; q++)
            for (uint32_t k = 0; k < a->p.column[a->rate[q].property].ncomp; k++)
                add(g, &g->run->op[i], dt, &a->rate[q], k);
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
    /* The property, its slots, the rate and its copy. */
    g->line = malloc((SLOT_COUNT + 2) * (components + 1) * sizeof *g->line);
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

CLONES static void blend(double *y, double w, const double *base, double w_also, const double *also,
                         size_t n)
{
    CLONES_SIMD
    for (size_t i = 0; i < n; i++)
        y[i] = w * base[i] + w_also * also[i];
}

static void swap(double *restrict a, double *restrict b, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const double other = a[i];
        a[i] = b[i];
        b[i] = other;
    }
}

/* `at`: where the lines are. */
static void combine(const struct action *x, double *const *at, size_t n)
{
    double *y = at[x->to];
    const double *base = at[x->base];
    if (x->swaps) {
        swap(y, at[x->base], n);
        return;
    }
    if (x->also >= 0) {
        blend(y, x->w, base, x->w_also, at[x->also], n);
        base = y;
    }
    if (x->r0 >= 0)
        correct(y, base, x->a, at[x->r], at[x->r0], n);
    else if (x->r >= 0)
        move(y, base, x->a, at[x->r], n);
    else if (y != base)
        memcpy(y, base, n * sizeof *y);
    if (x->r2 >= 0)
        move(y, y, x->a2, at[x->r2], n);
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

/* Lines that are not held in doubles, through their columns and back. */
static void settle_chunk(const struct program *g, size_t first, size_t n, double *const *at)
{
    for (size_t i = 0; i < g->n_line; i++) {
        const struct line *l = &g->line[i];
        const struct column *c = &g->array->p.column[l->column];
        if (!l->settles || c->size == sizeof(double))
            continue;
        column_store(c, l->k, first, n, at[i]);
        column_load(c, l->k, first, n, at[i]);
    }
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
        if (i > 0 && i == g->n_left)
            settle_chunk(g, first, n, at);
        combine(&g->action[i], at, n);
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
    if (r->device)
        return run_device_advance(r, from, to, e);
    const double begin = omp_get_wtime();
    const struct integrator *table = r->plan->integrator;
    bool saves = false;
    for (size_t k = from; k < to; k++)
        saves = saves || r->op[k].kind == OP_SAVE_RATES;
    for (size_t a = 0; a < r->plan->n_array; a++) {
        struct program g;
        struct skin_change change = {NAN, NAN};
        int bad = program_begin(&g, r, a, e);
        if (!bad) {
            add_all(&g, table->n_op - r->left, table->n_op, r->left_dt);
            end_step(&g);
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

/* The table of this step. What is left of the last one goes by the old. */
static int take_table(struct run *r, struct error *e)
{
    const struct integrator *table = r->plan->integrator;
    if (table->adapt) {
        if (run_settle(r, e))
            return -1;
        memcpy(r->adapted, table->op, table->n_op * sizeof *table->op);
        table->adapt(r->adapted, r->step, r->dt_last > 0.0 ? r->dt / r->dt_last : NAN);
    }
    r->op = table->adapt ? r->adapted : table->op;
    r->dt_last = r->dt;
    return 0;
}

int run_advance(struct run *r, struct error *e)
{
    const size_t n_op = r->plan->integrator->n_op;
    const double begin = r->time;
    if (take_table(r, e))
        return -1;
    const bool defers = r->defer && !has_finish(r->plan);
    for (size_t k = 0, end; k < n_op; k = end) {
        for (end = k; end < n_op && r->op[end].kind != OP_EVALUATE;)
            end++;
        if (end == n_op && defers) {
            r->left = end - k;
            r->left_dt = r->dt;
            break;
        }
        if (end > k && advance(r, k, end, e))
            return -1;
        if (end == n_op)
            break;
        r->time = begin + r->op[end].a * r->dt;
        const struct op *next = end + 1 < n_op ? &r->op[end + 1] : NULL;
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
