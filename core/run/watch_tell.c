/* run/watch_tell.c -- the sentence of a stopped run: what, where, when, the particle's values, and what is
 * likely behind it. Reads columns; keeps the failure in the run's struct watch. */
#include "run/watch.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

/* What is likely, and what to try. */
static const char *const hint[WATCH_CAUSES] = {
    [WATCH_NOT_FINITE] =
        "two particles at one place, a division by zero, or a step that was too long: "
        "look at the state before, or try a smaller time.cfl",
    [WATCH_DENSITY] =
        "particles that fly apart faster than a step can follow: try a smaller time.cfl, or "
        "a scheme that sums the density",
    [WATCH_INTERNAL_ENERGY] =
        "an expanding region gave more work than it had heat: try a smaller time.cfl, or a scheme that "
        "evolves entropy or conserves the total energy",
    [WATCH_ESCAPED] =
        "a close encounter or a hole in a wall threw it out: try a smaller time.cfl or "
        "a thicker wall, or allow more with watch.escaped",
    [WATCH_TIME_STEP] =
        "this particle is squeezed or torn as no step can follow: look at its values, and "
        "try a smaller time.cfl from the start",
    [WATCH_ENERGY] =
        "an instability feeds on steps that are too long or on forces that do not conserve "
        "energy: try a smaller time.cfl or more dissipation; if it comes from outside, raise "
        "watch.energy.above",
    [WATCH_NEIGHBOURS] =
        "its smoothing length ran away or particles have clumped: look at h, or raise "
        "watch.neighbours.above if it is meant",
};

struct text {
    char to[900];
    size_t used;
};

static void add(struct text *t, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void add_list(struct text *t, const char *format, va_list arguments)
{
    const size_t room = sizeof t->to - t->used;
    const int n = vsnprintf(t->to + t->used, room, format, arguments);
    if (n > 0)
        t->used += (size_t)n < room ? (size_t)n : room - 1;
}

static void add(struct text *t, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_list(t, format, arguments);
    va_end(arguments);
}

/* A particle's value; of several components "(1, 2)". */
static void add_value(struct text *t, const struct column *c, size_t i)
{
    if (c->ncomp == 1) {
        add(t, "%g", column_get(c, 0, i));
        return;
    }
    for (uint32_t k = 0; k < c->ncomp; k++)
        add(t, "%s%g", k ? ", " : "(", column_get(c, k, i));
    add(t, ")");
}

/* Those of the usual columns that it has. */
static void add_values(struct text *t, const struct sign *s)
{
    static const char *const usual[] = {"rho", "u", "p", "v", "h", "m"};
    const char *between = "; ";
    for (size_t k = 0; k < sizeof usual / sizeof usual[0]; k++) {
        const int at = particles_find(&s->array->p, usual[k]);
        if (at < 0 || !column_is_real(&s->array->p.column[at]) ||
            isnan(column_get(&s->array->p.column[at], 0, s->particle)) ||
            (s->column && strcmp(s->column, usual[k]) == 0))
            continue;
        add(t, "%s%s = ", between, usual[k]);
        add_value(t, &s->array->p.column[at], s->particle);
        between = ", ";
    }
}

struct failure watch_record(const struct run *r, const struct sign *s)
{
    struct failure f = {.happened = true, .cause = s->cause, .step = r->step, .time = r->time};
    snprintf(f.pass, sizeof f.pass, "%s", s->by ? s->by : "");
    if (!s->array)
        return f;
    f.array = s->array;
    f.particle = ((const int64_t *)s->array->p.column[s->array->id].data)[s->particle];
    for (int c = 0; c < r->plan->dim; c++)
        f.x[c] = column_get(&s->array->p.column[s->array->position], (uint32_t)c, s->particle);
    return f;
}

static bool is_made(const struct run *r, size_t array, int column)
{
    for (size_t i = 0; i < r->watch->done; i++)
        if (r->plan->pass[i].moment == MOMENT_EVALUATE &&
            pass_writes(&r->plan->pass[i], array, column))
            return true;
    return false;
}

void watch_forget(const struct run *r)
{
    if (!r->watch->sorted)
        return;
    for (size_t a = 0; a < r->plan->n_array; a++)
        for (size_t c = 0; c < r->plan->array[a].p.n_column; c++) {
            const struct particles *p = &r->plan->array[a].p;
            const struct column *k = &p->column[c];
            if (k->state || !column_is_real(k) || is_made(r, a, (int)c))
                continue;
            for (uint32_t q = 0; q < k->ncomp; q++)
                for (size_t i = 0; i < p->n; i++)
                    column_set(k, q, i, NAN);
        }
}

int watch_fail(const struct run *r, const struct sign *s, struct error *e, const char *what, ...)
{
    struct text t = {.used = 0};
    va_list arguments;
    watch_forget(r);
    va_start(arguments, what);
    add_list(&t, what, arguments);
    va_end(arguments);
    if (s->array) {
        const struct column *x = &s->array->p.column[s->array->position];
        add(&t, " at x = (");
        for (uint32_t c = 0; c < x->ncomp; c++)
            add(&t, "%s%g", c ? ", " : "", column_get(x, c, s->particle));
        add(&t, "),");
    }
    add(&t, "%s step %llu, t = %g", s->array ? "" : " at", (unsigned long long)r->step, r->time);
    if (s->others)
        add(&t, ", like %zu others%s", s->others, r->domain ? " of its rank" : "");
    if (s->array)
        add_values(&t, s);
    r->watch->failure = watch_record(r, s);
    return error_set(e, EXIT_RUN, "%s; likely %s", t.to, hint[s->cause]);
}
