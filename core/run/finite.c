/* run/finite.c -- which pass gave what is no number? The rates, which everything else follows
 * from, are looked at after every evaluation; all that a pass writes, where the run logs
 * (run.look). So the pass is found while the state that it worked on is still good. Reads
 * columns, no more. Of several ranks the one whose particle it is speaks: of a pass at once, before others hear
 * of its values; of rates, which others' may have spoilt already, once it is clear whose were first. */
#include "base/clones.h"
#include "run/foremost.h"
#include "run/watch.h"
#include <float.h>
#include <math.h>

/* By the sum of what is 0 for a number and none for others. */
CLONES bool any_not_finite(const double *value, size_t n)
{
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (size_t i = 0; i < n; i++)
        sum += value[i] * 0.0;
    return isnan(sum);
}

CLONES bool any_not_finite4(const float *value, size_t n)
{
    float sum = 0.0f;
#pragma omp simd reduction(+ : sum)
    for (size_t i = 0; i < n; i++)
        sum += value[i] * 0.0f;
    return isnan(sum);
}

/* The first element that is no number, or with `finite` that is not finite; n: there is none. */
static size_t first_bad(const double *value, size_t n, bool finite)
{
    const double most = finite ? DBL_MAX : INFINITY;
    long bad = 0;
    const long end = (long)n;
#pragma omp simd reduction(+ : bad)
    for (long i = 0; i < end; i++)
        bad += !(fabs(value[i]) <= most);
    for (size_t i = 0; bad && i < n; i++)
        if (!(fabs(value[i]) <= most))
            return i;
    return n;
}

static size_t first_bad4(const float *value, size_t n, bool finite)
{
    const float most = finite ? FLT_MAX : INFINITY;
    long bad = 0;
    const long end = (long)n;
#pragma omp simd reduction(+ : bad)
    for (long i = 0; i < end; i++)
        bad += !(fabsf(value[i]) <= most);
    for (size_t i = 0; bad && i < n; i++)
        if (!(fabsf(value[i]) <= most))
            return i;
    return n;
}

/* The first bad element of a column, over its components; false: there is none. */
static bool find_bad(const struct plan_array *a, int column, bool finite, size_t *particle,
                     double *value)
{
    const struct column *c = &a->p.column[column];
    for (uint32_t k = 0; column_is_real(c) && k < c->ncomp; k++) {
        const size_t at = k * c->plane;
        *particle = c->quantum > 0.0 ? first_bad4(c->low + at, a->p.n, finite)
                    : c->size == sizeof(float)
                        ? first_bad4((const float *)c->data + at, a->p.n, finite)
                        : first_bad((const double *)c->data + at, a->p.n, finite);
        if (*particle < a->p.n) {
            *value = column_get(c, k, *particle);
            return true;
        }
    }
    return false;
}

static int tell(const struct run *r, const char *who, const struct plan_array *a, int column,
                size_t i, double value, struct error *e)
{
    const char *name = a->p.column[column].name;
    const struct sign s = {
        .cause = WATCH_NOT_FINITE, .array = a, .particle = i, .by = who, .column = name};
    return watch_fail(r, &s, e, "%s made \"%s\" %s for particle %lld of array \"%s\"", who, name,
                      isnan(value) ? "not a number" : "infinite",
                      (long long)((const int64_t *)a->p.column[a->id].data)[i], a->p.name);
}

/* A pass that goes on with a sum hides nothing of what earlier ones put into it. */
static bool goes_on(const struct pass *p, int column)
{
    for (uint32_t k = 0; k < p->use.item->props.count; k++)
        if (p->dst.column[k] == column && p->continues[k])
            return true;
    return false;
}

bool finite_finished(const struct run *r, const struct pass *p, size_t array, int column, bool sums)
{
    for (const struct pass *q = p + 1; q < r->plan->pass + r->plan->n_pass; q++)
        if (q->moment == p->moment && pass_writes(q, array, column) &&
            !(sums && goes_on(q, column)))
            return false;
    return true;
}

/* LATE: after all passes of the moment: what a later pass has made anew is that one's. */
enum when { AT_ONCE, LATE, TRACE };

/* A particle's value that is no number, or not finite. */
struct bad {
    const struct plan_array *array;
    int column;
    size_t particle;
    double value;
};

static bool pass_is_bad(const struct run *r, const struct pass *p, enum when when, struct bad *out)
{
    const struct plan_array *a = &r->plan->array[p->dst.array];
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        const int column = p->dst.column[k];
        *out = (struct bad){.array = a, .column = column};
        if (column >= 0 && (when == TRACE || !(prop->access & SPH_WORK)) &&
            (when == AT_ONCE || finite_finished(r, p, p->dst.array, column, true)) &&
            pass_writes(p, p->dst.array, column) &&
            find_bad(a, column, false, &out->particle, &out->value))
            return true;
    }
    return false;
}

static int check(const struct run *r, const struct pass *p, enum when when, struct error *e)
{
    struct bad b;
    return pass_is_bad(r, p, when, &b) ? tell(r, p->name, b.array, b.column, b.particle, b.value, e)
                                       : 0;
}

int finite_pass(const struct run *r, const struct pass *p, struct error *e)
{
    return check(r, p, AT_ONCE, e);
}

int finite_pass_late(const struct run *r, const struct pass *p, struct error *e)
{
    return check(r, p, LATE, e);
}

/* The first pass of this rank of which something is bad, in the order of the search; NULL: none. */
static const struct pass *trace(const struct run *r, struct bad *out, size_t *order)
{
    static const enum moment moments[] = {MOMENT_EVALUATE, MOMENT_FINISH, MOMENT_START};
    *order = 0;
    for (size_t m = 0; m < sizeof moments / sizeof moments[0]; m++)
        for (size_t i = 0; i < r->plan->n_pass; i++, ++*order)
            if (r->plan->pass[i].moment == moments[m] &&
                pass_is_bad(r, &r->plan->pass[i], TRACE, out))
                return &r->plan->pass[i];
    return NULL;
}

/* What a rank has found as so manieth, among others. */
static struct foremost found(const struct bad *b, bool any, size_t order)
{
    struct foremost f = {.key = NAN};
    if (any) {
        f.key = -(double)order;
        f.id = watch_id(b->array, b->particle);
    }
    return f;
}

int finite_trace(const struct run *r, struct error *e)
{
    struct bad b;
    size_t order;
    const struct pass *p = trace(r, &b, &order);
    struct foremost f = found(&b, p != NULL, order);
    if (foremost_find(r, &f, NULL, 0, e))
        return -1;
    return f.mine ? tell(r, p->name, b.array, b.column, b.particle, b.value, e) : f.any ? -1 : 0;
}

const char *finite_writer(const struct run *r, size_t array, int column)
{
    const char *name = "the evaluation";
    for (size_t i = 0; i < r->plan->n_pass; i++)
        if (r->plan->pass[i].moment == MOMENT_EVALUATE &&
            pass_writes(&r->plan->pass[i], array, column))
            name = r->plan->pass[i].name;
    return name;
}

/* The first rate of this rank that is not finite; false: there is none. */
static bool find_rate(const struct run *r, struct bad *out, size_t *order)
{
    *order = 0;
    for (size_t k = 0; k < r->plan->n_array; k++) {
        const struct plan_array *a = &r->plan->array[k];
        for (size_t q = 0; q < a->n_rate; q++, ++*order) {
            *out = (struct bad){.array = a, .column = a->rate[q].rate};
            if (find_bad(a, out->column, true, &out->particle, &out->value))
                return true;
        }
    }
    return false;
}

/* The search is for those who have seen one: closing.c and advance.c, which look at all that is written. By now all
 * ranks know whether anybody has. */
int finite_rates(struct run *r, struct error *e)
{
    struct bad b;
    size_t order;
    if (!r->suspect)
        return 0;
    r->suspect = false;
    const bool any = find_rate(r, &b, &order);
    struct foremost f = found(&b, any, order);
    bool none = any && isnan(b.value);
    if (foremost_find(r, &f, &none, sizeof none, e) || (f.any && none && finite_trace(r, e)))
        return -1;
    if (!f.mine)
        return f.any ? -1 : 0;
    return tell(r, finite_writer(r, (size_t)(b.array - r->plan->array), b.column), b.array,
                b.column, b.particle, b.value, e);
}
