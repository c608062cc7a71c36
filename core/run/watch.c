/* run/watch.c -- see watch.h. Columns are looked at in one go through memory, in blocks that threads share;
 * only when something is wrong is the particle looked for. Knows the contract's names of columns, and no
 * more of what they stand for. */
#include "run/watch.h"
#include "run/domain.h"
#include "run/frames.h"
#include "base/clones.h"
#include "run/region.h"
#include <float.h>
#include <stdlib.h>
#include <string.h>

#define PIECE 512
#define PARALLEL_FROM 20000
/* No step is called long that takes more than this of the run: what bounds it is just not there yet. */
#define LONGEST_SHARE 0.01
/* A clock that advances by less than this of its reading stands still. */
#define STANDSTILL 1e-15
#define NEARLY_STILL 1e-12

/* What is wrong with which columns: a density of 0 is, an internal energy is not. */
static const struct {
    const char *name;
    enum watch_cause cause;
    double least;
} contract[] = {
    {"rho", WATCH_DENSITY, DBL_TRUE_MIN},
    {"u", WATCH_INTERNAL_ENERGY, 0.0},
};

/* -- Looking ------------------------------------------------------------------------------------ */

/* Of n numbers those below `least` or above `most`; with `none` also those that are no number. */
CLONES static long count_outside(const double *x, size_t n, double least, double most, int none)
{
    long bad = 0;
#pragma omp simd reduction(+ : bad)
    for (size_t i = 0; i < n; i++)
        bad += (x[i] < least) | (x[i] > most) | (none & (x[i] != x[i]));
    return bad;
}

static long count_column(const struct run *r, const struct column *c, uint32_t k, size_t n,
                         double least, double most, bool none)
{
    long bad = 0;
#pragma omp parallel for schedule(static) num_threads(r->threads) reduction(+ : bad) if (n > PARALLEL_FROM)
    for (size_t first = 0; first < n; first += PIECE) {
        const size_t some = n - first < PIECE ? n - first : PIECE;
        double room[PIECE];
        const double *x = room;
        if (c->size == sizeof(double))
            x = (const double *)c->data + k * c->plane + first;
        else
            column_load(c, k, first, some, room);
        bad += count_outside(x, some, least, most, none);
    }
    return bad;
}

/* -- Beginning ---------------------------------------------------------------------------------- */

bool watch_has_rate(const struct plan_array *a, int column)
{
    for (size_t q = 0; q < a->n_rate; q++)
        if (a->rate[q].property == column)
            return true;
    return false;
}

/* An energy that an equation of state makes of the density may be counted from anywhere. */
static bool is_derived(const struct plan *plan, size_t array, int column)
{
    for (size_t i = 0; i < plan->n_pass; i++) {
        const struct pass *p = &plan->pass[i];
        if (!p->function && !p->assignment && pass_writes(p, array, column))
            return true;
    }
    return false;
}

static void add_columns(struct run *r, size_t array)
{
    const struct plan_array *a = &r->plan->array[array];
    for (size_t k = 0; k < sizeof contract / sizeof contract[0]; k++) {
        const int at = particles_find(&a->p, contract[k].name);
        if (at < 0 || !column_is_real(&a->p.column[at]) || a->p.column[at].ncomp != 1 ||
            r->watch->scene[contract[k].cause].action == WATCH_OFF ||
            !plan_changes(r->plan, array, at) ||
            (contract[k].cause == WATCH_INTERNAL_ENERGY && is_derived(r->plan, array, at)))
            continue;
        r->watch->column[r->watch->n_column++] =
            (struct watched){.array = array,
                             .column = at,
                             .cause = contract[k].cause,
                             .least = contract[k].least,
                             .integrated = watch_has_rate(a, at)};
    }
}

int watch_open(struct run *r, struct error *e)
{
    const size_t n = r->plan->n_array;
    struct watch *w = r->watch = calloc(1, sizeof *w);
    if (!w)
        return error_memory(e, "the watch", sizeof *w);
    w->scene = r->plan->scene->watch;
    w->column = calloc(n * (sizeof contract / sizeof contract[0]) + 1, sizeof *w->column);
    w->here = calloc(n * WATCH_CAUSES + 1, sizeof *w->here);
    if (!w->column || !w->here)
        return error_memory(e, "the watch", n * sizeof *w->column);
    for (size_t a = 0; a < n; a++)
        add_columns(r, a);
    return 0;
}

void watch_close(struct run *r)
{
    if (r->watch) {
        free(r->watch->column);
        free(r->watch->here);
    }
    free(r->watch);
    r->watch = NULL;
}

/* The least and the largest of all particles' component k of x. */
static void extent(const struct run *r, uint32_t k, double *low, double *high)
{
    *low = INFINITY;
    *high = -INFINITY;
    for (size_t a = 0; a < r->plan->n_array; a++) {
        const struct plan_array *pa = &r->plan->array[a];
        for (size_t i = 0; i < pa->p.n; i++) {
            const double x = column_get(&pa->p.column[pa->position], k, i);
            *low = x < *low ? x : *low;
            *high = x > *high ? x : *high;
        }
    }
}

/* Beyond an open side so many sizes of the domain, or of all that is there at the start. A mirror throws
 * back what crosses it, but nothing sane crosses it by a whole domain in a step. */
static int set_bounds(struct run *r, struct error *e)
{
    static const uint32_t op[6] = {SPH_REDUCE_MIN, SPH_REDUCE_MIN, SPH_REDUCE_MIN,
                                   SPH_REDUCE_MAX, SPH_REDUCE_MAX, SPH_REDUCE_MAX};
    const struct box *box = &r->plan->scene->box;
    struct watch *w = r->watch;
    double ends[6] = {0.0}, *low = ends, *high = ends + 3, size = 0.0;
    for (int c = 0; c < r->plan->dim; c++) {
        low[c] = box->min[c];
        high[c] = box->max[c];
        if (!box->bounded)
            extent(r, (uint32_t)c, &low[c], &high[c]);
    }
    if (run_share_numbers(r, ends, op, 6, e))
        return -1;
    for (int c = 0; c < r->plan->dim; c++)
        size = fmax(size, high[c] - low[c]);
    for (int c = 0; c < r->plan->dim; c++)
        for (int side = 0; side < 2; side++) {
            const enum side is = box->bounded ? box->side[c][side] : SIDE_OPEN;
            const double far = is == SIDE_MIRROR ? high[c] - low[c]
                               : is == SIDE_OPEN && size > 0.0
                                   ? w->scene[WATCH_ESCAPED].limit * size
                                   : INFINITY;
            const double at = side ? high[c] + far : low[c] - far;
            *(side ? &w->high[c] : &w->low[c]) = fmin(fmax(at, -DBL_MAX), DBL_MAX);
        }
    return 0;
}

/* -- What was found ----------------------------------------------------------------------------- */

void watch_step(struct run *r)
{
    const size_t n = r->plan->n_array;
    for (size_t c = 0; c < WATCH_CAUSES; c++)
        for (size_t a = 0; a < n; a++) {
            r->watch->count[c].n += r->watch->here[c * n + a];
            r->watch->here[c * n + a] = 0;
        }
}

long long watch_id(const struct plan_array *a, size_t i)
{
    return (long long)((const int64_t *)a->p.column[a->id].data)[i];
}

/* Who made it, in a sentence. */
const char *watch_made_by(char *text, size_t size, const char *by)
{
    if (strcmp(by, WATCH_SCENE) == 0)
        snprintf(text, size, "in the initial state");
    else if (strcmp(by, WATCH_INTEGRATOR) == 0)
        snprintf(text, size, "by the integrator");
    else
        snprintf(text, size, "by pass %s", by);
    return text;
}

/* The same of a column; what the integrator made it of is told as well. */
const char *watch_column_made_by(char *text, size_t size, const struct run *r, size_t array,
                                 int column, const char *by)
{
    const struct plan_array *a = &r->plan->array[array];
    watch_made_by(text, size, by);
    const size_t used = strlen(text);
    for (size_t q = 0; strcmp(by, WATCH_INTEGRATOR) == 0 && q < a->n_rate; q++)
        if (a->rate[q].property == column)
            snprintf(text + used, size - used, " with \"%s\" of %s",
                     a->p.column[a->rate[q].rate].name, finite_writer(r, array, a->rate[q].rate));
    return text;
}

static int look_at(struct run *r, const struct watched *k, double least, const char *by,
                   struct error *e)
{
    const struct plan_array *a = &r->plan->array[k->array];
    const struct column *c = &a->p.column[k->column];
    const long bad = count_column(r, c, 0, a->p.n, least, INFINITY, false);
    if (!bad && !watch_counts_together(r, k->cause))
        return 0;
    struct sign s = {.cause = k->cause, .array = a, .others = (size_t)bad, .by = by};
    double worst = INFINITY;
    s.column = c->name;
    s.others -= bad > 0;
    for (size_t i = 0; bad && i < a->p.n; i++)
        if (column_get(c, 0, i) < worst) {
            worst = column_get(c, 0, i);
            s.particle = i;
        }
    char who[320];
    s.weight = -worst;
    if (watch_counts(r, k->cause))
        return watch_count(r, &s, (uint64_t)bad, e);
    watch_column_made_by(who, sizeof who, r, k->array, k->column, by);
    return watch_fail(r, &s, e, "%s of particle %lld of \"%s\" became %g %s,", c->name,
                      watch_id(a, s.particle), a->p.name, worst, who);
}

/* -- Before an evaluation ----------------------------------------------------------------------- */

static bool is_outside(const struct run *r, const struct plan_array *a, size_t i)
{
    bool out = false;
    for (int c = 0; c < r->plan->dim; c++) {
        const double x = column_get(&a->p.column[a->position], (uint32_t)c, i);
        out = out || !(x >= r->watch->low[c] && x <= r->watch->high[c]);
    }
    return out;
}

static int nowhere(struct run *r, const struct plan_array *a, size_t i, struct error *e)
{
    const struct sign s = {
        .cause = WATCH_NOT_FINITE, .array = a, .particle = i, .by = WATCH_INTEGRATOR};
    return watch_fail(r, &s, e,
                      "the integrator made \"%s\" infinite or not a number for particle %lld of "
                      "array \"%s\"",
                      a->p.column[a->position].name, watch_id(a, i), a->p.name);
}

/* Those that left: all are gone through, since some component of some is outside; or none, if nobody has. */
static int left(struct run *r, const struct plan_array *a, bool any, const bool *inside,
                struct error *e)
{
    struct sign s = {
        .cause = WATCH_ESCAPED, .array = a, .by = r->watch->begun ? WATCH_INTEGRATOR : WATCH_SCENE};
    uint64_t n = 0;
    for (size_t i = 0; any && i < a->p.n; i++) {
        for (int c = 0; c < r->plan->dim; c++)
            if (!isfinite(column_get(&a->p.column[a->position], (uint32_t)c, i)))
                return nowhere(r, a, i, e);
        if (inside ? inside[i] : !is_outside(r, a, i))
            continue;
        s.particle = n++ ? s.particle : i;
    }
    s.others = n ? n - 1 : 0;
    if (watch_counts(r, WATCH_ESCAPED))
        return n || r->domain ? watch_count(r, &s, n, e) : 0;
    if (!n || r->watch->scene[WATCH_ESCAPED].action == WATCH_OFF)
        return 0;
    char who[160];
    return watch_fail(r, &s, e, "particle %lld of \"%s\" was moved %s out of %s, to a place",
                      watch_id(a, s.particle), a->p.name, watch_made_by(who, sizeof who, s.by),
                      inside                        ? "the region of watch.escaped.where"
                      : r->plan->scene->box.bounded ? "the domain"
                                                    : "all reach");
}

static int look_where(struct run *r, const struct plan_array *a, struct error *e)
{
    const char *where = r->watch->scene[WATCH_ESCAPED].where;
    if (!where || r->watch->scene[WATCH_ESCAPED].action == WATCH_OFF)
        return 0;
    bool *inside = calloc(a->p.n + 1, sizeof *inside);
    if (!inside)
        return error_memory(e, "the watch", a->p.n);
    int status = region_select(a, where, inside, e);
    if (!status)
        status = left(r, a, true, inside, e);
    free(inside);
    return status;
}

static int look_for_escaped(struct run *r, size_t array, struct error *e)
{
    const struct plan_array *a = &r->plan->array[array];
    long bad = 0;
    for (int c = 0; c < r->plan->dim; c++)
        bad += count_column(r, &a->p.column[a->position], (uint32_t)c, a->p.n, r->watch->low[c],
                            r->watch->high[c], true);
    if ((bad || watch_counts_together(r, WATCH_ESCAPED)) && left(r, a, bad, NULL, e))
        return -1;
    return look_where(r, a, e);
}

int watch_places(struct run *r, bool all, struct error *e)
{
    const struct scene_watch *rule = &r->watch->scene[WATCH_ESCAPED];
    const bool always = rule->where || rule->action == WATCH_COUNT;
    if (!r->watch->bounded && set_bounds(r, e))
        return -1;
    r->watch->bounded = true;
    for (size_t a = 0; a < r->plan->n_array; a++)
        if ((always || all == frame_has(r, 0, a)) && look_for_escaped(r, a, e))
            return -1;
    return 0;
}

int watch_state(struct run *r, struct error *e)
{
    struct watch *w = r->watch;
    const bool first = !w->begun;
    for (size_t k = 0; k < w->n_column; k++) {
        struct watched *c = &w->column[k];
        const struct plan_array *a = &r->plan->array[c->array];
        /* An internal energy may be counted from anywhere: whoever begins below 0 means it. */
        if (first && c->cause == WATCH_INTERNAL_ENERGY) {
            uint64_t below = (uint64_t)count_column(r, &a->p.column[c->column], 0, a->p.n, c->least,
                                                    INFINITY, false);
            if (run_share_count(r, &below, e))
                return -1;
            c->may_be = below > 0;
        }
        if (c->integrated && !c->may_be &&
            look_at(r, c, c->least, first ? WATCH_SCENE : WATCH_INTEGRATOR, e))
            return -1;
    }
    const int status = watch_places(r, false, e);
    w->begun = true;
    return status;
}

/* -- After a pass ------------------------------------------------------------------------------- */

/* A sum over other arrays alone is rightly 0 far from them. */
static bool sums_over_others(const struct pass *p, size_t array)
{
    for (size_t s = 0; s < p->n_src; s++)
        if (p->src[s].array == array)
            return false;
    return p->shape == SPH_PAIR;
}

int watch_pass(struct run *r, const struct pass *p, struct error *e)
{
    for (size_t k = 0; k < r->watch->n_column; k++) {
        const struct watched *c = &r->watch->column[k];
        const size_t array = p->dst.array;
        if (c->array == array && !c->may_be && pass_writes(p, array, c->column) &&
            finite_finished(r, p, array, c->column, false) &&
            look_at(r, c, sums_over_others(p, array) ? 0.0 : c->least, p->name, e))
            return -1;
    }
    return 0;
}

/* -- Steps and totals --------------------------------------------------------------------------- */

/* Who bounds the step: NULL if no reduction does. */
static const struct reduction *bound_of(const struct run *r, double dt)
{
    for (size_t i = 0; i < r->plan->n_reduction; i++) {
        const struct reduction *d = &r->plan->reduction[i];
        if (d->declared->use == SPH_USE_TIME_STEP && r->reduced[i] <= r->dt_bound &&
            r->plan->cfl * r->dt_bound <= dt * (1.0 + 1e-9))
            return d;
    }
    return NULL;
}

static struct sign who_bounds(const struct run *r, double dt)
{
    struct sign s = {.cause = WATCH_TIME_STEP};
    const struct reduction *d = bound_of(r, dt);
    if (!d)
        return s;
    s.by = r->plan->pass[d->pass].name;
    const struct plan_array *a = &r->plan->array[d->array];
    double least = INFINITY;
    for (size_t i = 0; i < a->p.n; i++)
        if (column_get(&a->p.column[d->column], 0, i) < least) {
            least = column_get(&a->p.column[d->column], 0, i);
            s.array = a;
            s.particle = i;
        }
    s.weight = -least;
    return s;
}

int watch_time_step(struct run *r, double dt, double span, struct error *e)
{
    struct watch *w = r->watch;
    const struct scene_watch *rule = &w->scene[WATCH_TIME_STEP];
    const double clock = fmax(fabs(r->time), span),
                 longest = fmin(w->longest, LONGEST_SHARE * span);
    const bool stands = !(dt > STANDSTILL * clock);
    const bool collapsed = !(dt > NEARLY_STILL * clock) || dt < rule->limit * longest;
    w->longest = dt < INFINITY ? fmax(w->longest, dt) : w->longest;
    if (!stands && (!collapsed || rule->action == WATCH_OFF))
        return 0;
    if (run_fetch(r, e))
        return -1;
    const struct sign s = who_bounds(r, dt);
    enum watch_blame blame;
    if (watch_blame(r, &s, &blame, e))
        return -1;
    if (!stands && watch_counts(r, WATCH_TIME_STEP))
        return watch_count_event(r, &s, blame, e);
    if (blame == WATCH_THEIRS)
        return -1;
    const struct reduction *d = bound_of(r, dt);
    char of[320] = "";
    if (s.array)
        snprintf(of, sizeof of, ", bounded by \"%s\" of pass %s for particle %lld of \"%s\"",
                 d->declared->name, s.by, watch_id(s.array, s.particle), s.array->p.name);
    return watch_fail(r, &s, e,
                      "the time step collapsed to %g, %.3g times the longest of the run%s", dt,
                      w->longest > 0.0 ? dt / w->longest : 0.0, of);
}

/* The particle with the most kinetic energy. */
static struct sign who_moves(const struct run *r)
{
    struct sign s = {.cause = WATCH_ENERGY};
    double most = -1.0;
    for (size_t k = 0; k < r->plan->n_array; k++) {
        const struct plan_array *a = &r->plan->array[k];
        for (size_t i = 0; a->velocity >= 0 && i < a->p.n; i++) {
            double v2 = 0.0;
            for (uint32_t c = 0; c < a->p.column[a->velocity].ncomp; c++)
                v2 += pow(column_get(&a->p.column[a->velocity], c, i), 2);
            if (column_get(&a->p.column[a->mass], 0, i) * v2 > most) {
                most = column_get(&a->p.column[a->mass], 0, i) * v2;
                s.array = a;
                s.particle = i;
            }
        }
    }
    s.weight = most;
    return s;
}

int watch_energy(struct run *r, const struct totals *first, const struct totals *now,
                 struct error *e)
{
    const struct scene_watch *rule = &r->watch->scene[WATCH_ENERGY];
    const double begin = first->kinetic + first->internal + first->potential;
    const double grown = now->kinetic + now->internal + now->potential - begin;
    const double parts = fabs(first->kinetic) + fabs(first->internal) + fabs(first->potential);
    /* Of whoever tells the kinetic energy alone nothing is known: from rest it may grow to anything. */
    const double scale = !isnan(rule->scale) ? rule->scale : now->has_energy ? parts : 0.0;
    if (rule->action == WATCH_OFF || !(scale > 0.0) || !(fabs(grown) > rule->limit * scale))
        return 0;
    if (run_fetch(r, e))
        return -1;
    const struct sign s = who_moves(r);
    enum watch_blame blame;
    if (watch_blame(r, &s, &blame, e))
        return -1;
    if (watch_counts(r, WATCH_ENERGY))
        return watch_count_event(r, &s, blame, e);
    if (blame == WATCH_THEIRS)
        return -1;
    char who[160] = "";
    if (s.array)
        snprintf(who, sizeof who, ", the most kinetic energy has particle %lld of \"%s\",",
                 watch_id(s.array, s.particle), s.array->p.name);
    return watch_fail(r, &s, e, "the total energy went from %g to %g, by %.3g times its scale %g%s",
                      begin, begin + grown, fabs(grown) / scale, scale, who);
}
