/* run/watch_store.c -- what a watch has seen so far goes into a checkpoint and comes back. A scene may watch for
 * other things as it goes on: what the file does not know stays as it was opened. */
#include "run/watch.h"
#include <stdlib.h>
#include <string.h>

static int failure_store(struct run *r, struct failure *f, struct store *s, struct error *e)
{
    struct plan *plan = r->plan;
    uint64_t number[4] = {f->happened, f->cause, SIZE_MAX, f->step};
    double real[4] = {f->x[0], f->x[1], f->x[2], f->time};
    if (f->array)
        number[2] = (uint64_t)(f->array - plan->array);
    if (store_block(s, "number", STORE_U64, number, 4, e) ||
        store_block(s, "real", STORE_F64, real, 4, e) ||
        store_block(s, "particle", STORE_I64, &f->particle, 1, e) ||
        store_block(s, "pass", STORE_U8, f->pass, sizeof f->pass, e))
        return -1;
    if (!s->reading)
        return 0;
    if (number[1] >= WATCH_CAUSES)
        return store_broken(s, e, "a failure of no known cause");
    f->happened = number[0] != 0;
    f->cause = (enum watch_cause)number[1];
    f->array = number[2] < plan->n_array ? &plan->array[number[2]] : NULL;
    f->step = number[3];
    memcpy(f->x, real, sizeof f->x);
    f->time = real[3];
    f->pass[sizeof f->pass - 1] = '\0';
    return 0;
}

/* Array, column, cause of each, and whether it was wrong at the start. */
static int columns_store(struct watch *w, struct store *s, struct error *e)
{
    uint64_t *known = calloc(4 * w->n_column + 1, sizeof *known);
    size_t n = 4 * w->n_column;
    if (!known)
        return error_memory(e, "a checkpoint", n * sizeof *known);
    for (size_t k = 0; k < w->n_column; k++) {
        const struct watched *c = &w->column[k];
        const uint64_t of[4] = {c->array, (uint64_t)c->column, c->cause, c->may_be};
        memcpy(known + 4 * k, of, sizeof of);
    }
    const int status = store_array(s, "columns", STORE_U64, &known, &n, 0, e);
    for (size_t i = 0; !status && s->reading && i + 4 <= n; i += 4)
        for (size_t k = 0; k < w->n_column; k++) {
            struct watched *c = &w->column[k];
            if (c->array == known[i] && (uint64_t)c->column == known[i + 1] &&
                (uint64_t)c->cause == known[i + 2])
                c->may_be = known[i + 3] != 0;
        }
    free(known);
    return status;
}

int watch_store(struct run *r, struct store *s, struct error *e)
{
    struct watch *w = r->watch;
    store_enter(s, "watch", 0);
    int status =
        store_block(s, "low", STORE_F64, w->low, 3, e) ||
                store_block(s, "high", STORE_F64, w->high, 3, e) ||
                store_flags(s, "bounded", &w->bounded, 1, e) ||
                store_flags(s, "begun", &w->begun, 1, e) ||
                store_flags(s, "evaluated", &w->evaluated, 1, e) ||
                store_flags(s, "sorted", &w->sorted, 1, e) || store_count(s, "done", &w->done, e) ||
                store_f64(s, "longest", &w->longest, e) || store_f64(s, "energy", &w->energy, e) ||
                store_block(s, "here", STORE_U64, w->here, WATCH_CAUSES * r->plan->n_array, e) ||
                columns_store(w, s, e)
            ? -1
            : 0;
    for (size_t k = 0; !status && k < WATCH_CAUSES; k++) {
        store_enter(s, "count", k);
        status = store_u64(s, "n", &w->count[k].n, e) || failure_store(r, &w->count[k].first, s, e)
                     ? -1
                     : 0;
        store_leave(s);
    }
    store_leave(s);
    return status;
}
