/* opencl/ops_advance.c -- operations of the integrator's table on a device, as run/advance.c does them. They are
 * written down as a program of actions, which one kernel goes through for every particle. A program holds
 * for steps of any length, so it stays on the device and is found again at the next step. */
#include "opencl/ops_private.h"

#include <stdlib.h>
#include <string.h>

/* As in ops_words.cl, read there byte for byte. Slots: those of component 0. */
enum { ACTION_SWAPS = 1, ACTION_RATE = 2 };
struct action {
    uint32_t to, base, also, r, r0, r2, ncomp, what;
    double w, w_also, a, a2;
};

struct making {
    const struct plan_array *pa;
    struct arena *a;
    struct action *action;
    size_t n;
    bool *written; /* [column] */
};

/* Whether a column is the rate of any property. */
static bool is_rate(const struct plan_array *pa, int column)
{
    for (size_t q = 0; q < pa->n_rate; q++)
        if (pa->rate[q].rate == column)
            return true;
    return false;
}

/* The rate of a rate, or -1: of a velocity the acceleration. */
static int rate_of(const struct plan_array *pa, int column)
{
    for (size_t q = 0; q < pa->n_rate; q++)
        if (pa->rate[q].property == column)
            return pa->rate[q].rate;
    return -1;
}

/* to = base + a dt (r - r0); columns, -1: missing. */
static struct action *act(struct making *m, int to, int base, double a, int r, int r0)
{
    struct action *x = &m->action[m->n++];
    *x = (struct action){.to = ops_slot(m->a, to),
                         .base = ops_slot(m->a, base),
                         .also = SLOT_MISSING,
                         .r = ops_slot(m->a, r),
                         .r0 = ops_slot(m->a, r0),
                         .r2 = SLOT_MISSING,
                         .ncomp = m->a->p->column[to].ncomp,
                         .what = is_rate(m->pa, to) ? ACTION_RATE : 0,
                         .w = 1.0,
                         .a = a};
    m->written[to] = true;
    return x;
}

static void add_combination(struct making *m, const struct op *op, const struct rate *q)
{
    int slot[SLOT_COUNT] = {SLOT_NOW}, n = 0;
    for (int s = SLOT_NOW; s < SLOT_COUNT; s++)
        if (op->weight[s] != 0.0)
            slot[n++] = s;
    struct action *x =
        act(m, q->kept[op->to], q->kept[slot[0]], op->a, op->a != 0.0 ? q->rate : -1, -1);
    x->w = op->weight[slot[0]];
    if (n > 1) {
        x->also = ops_slot(m->a, q->kept[slot[1]]);
        x->w_also = op->weight[slot[1]];
    }
    x->r2 = ops_slot(m->a, op->a2 != 0.0 ? rate_of(m->pa, q->rate) : -1);
    x->a2 = op->a2;
}

static void add(struct making *m, const struct op *op, const struct rate *q)
{
    if (!(op->on & q->kind))
        return;
    switch (op->kind) {
    case OP_COMBINE:
        add_combination(m, op, q);
        break;
    case OP_SWAP:
        act(m, q->kept[SLOT_0], q->property, 0.0, -1, -1)->what |= ACTION_SWAPS;
        m->written[q->property] = true;
        break;
    case OP_SAVE_RATES:
        if (q->saved >= 0)
            act(m, q->saved, q->rate, 0.0, -1, -1);
        break;
    case OP_CORRECT:
        if (q->closed == NO_PASS) /* else its pass has done so */
            act(m, q->property, q->property, op->a, q->rate, q->saved);
        break;
    case OP_EVALUATE:
        break;
    }
}

/* -- Programs on the device -------- */

void ops_forget_programs(struct ops *o)
{
    for (size_t k = 0; k < OPS_PROGRAMS; k++) {
        device_release(o->d, &o->advance[k].buffer);
        free(o->advance[k].actions);
        o->advance[k] = (struct ops_program){0};
    }
}

/* The program with these actions: one that is there, or a new one. Takes the memory of `action`. */
static const struct ops_program *program_of(struct ops *o, struct action *action, size_t bytes,
                                            struct error *e)
{
    for (size_t k = 0; k < OPS_PROGRAMS; k++)
        if (o->advance[k].bytes == bytes && memcmp(o->advance[k].actions, action, bytes) == 0) {
            free(action);
            return &o->advance[k];
        }
    struct ops_program *p = &o->advance[o->n_advance++ % OPS_PROGRAMS];
    free(p->actions);
    p->actions = action;
    p->bytes = 0; /* until it is there */
    if (device_reserve(o->d, &p->buffer, bytes, "integrator", e) ||
        device_write(o->d, &p->buffer, 0, action, bytes, e))
        return NULL;
    p->bytes = bytes;
    return p;
}

static int launch(struct ops *o, struct arena *a, const struct ops_program *p, double dt,
                  struct error *e)
{
    const uint64_t plane = a->plane, n = a->n;
    const uint32_t n_action = (uint32_t)(p->bytes / sizeof(struct action));
    return OPS_LAUNCH(o, K_ADVANCE, ops_items(o, n), e, DEVICE_BUFFER(&a->wide),
                      DEVICE_BUFFER(&a->narrow), DEVICE_VALUE(plane), DEVICE_BUFFER(&p->buffer),
                      DEVICE_VALUE(n_action), DEVICE_VALUE(dt), DEVICE_VALUE(n),
                      DEVICE_BUFFER(&o->words));
}

/* All that the rates name is on the device. */
static int bring(struct arena *a, const struct plan_array *pa, struct error *e)
{
    for (size_t q = 0; q < pa->n_rate; q++) {
        const struct rate *r = &pa->rate[q];
        const int column[] = {r->property, r->rate, r->saved, r->kept[SLOT_0], r->kept[SLOT_1]};
        for (size_t k = 0; k < sizeof column / sizeof column[0]; k++)
            if (ops_bring(a, column[k], e))
                return -1;
    }
    return 0;
}

static int run(struct ops *o, struct making *m, double dt, struct error *e)
{
    if (m->n == 0) {
        free(m->action);
        return 0;
    }
    const struct ops_program *p = program_of(o, m->action, m->n * sizeof *m->action, e);
    if (!p || launch(o, m->a, p, dt, e))
        return -1;
    for (size_t c = 0; c < m->a->p->n_column; c++)
        if (m->written[c])
            arena_written_here(m->a, (int)c);
    return 0;
}

int ops_advance(struct ops *o, struct arena *a, const struct plan_array *pa, const struct op *op,
                size_t from, size_t to, double dt, bool *bad, struct error *e)
{
    const size_t most = (to - from) * pa->n_rate + 1;
    struct making m = {.pa = pa, .a = a};
    uint32_t flags = 0;
    if (bad)
        *bad = false;
    if (bring(a, pa, e))
        return -1;
    m.action = calloc(most, sizeof *m.action);
    m.written = calloc(a->p->n_column + 1, sizeof *m.written);
    if (!m.action || !m.written) {
        free(m.action);
        free(m.written);
        return error_memory(e, "a step", most * sizeof *m.action);
    }
    for (size_t i = from; i < to; i++)
        for (size_t q = 0; q < pa->n_rate; q++)
            add(&m, &op[i], &pa->rate[q]);
    int status = run(o, &m, dt, e);
    free(m.written);
    if (!status && bad)
        status = ops_flags(o, &flags, e);
    if (bad)
        *bad = flags & OPS_BAD_RATE;
    return status;
}
