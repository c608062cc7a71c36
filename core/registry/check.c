/* registry/check.c -- the checks of each kind (see check.h). Reads host's copies only, whose lists
 * and optional texts are there; names and pointers to code may still be NULL. */
#include "registry/check.h"

#include <math.h>
#include <string.h>

#define WRITES (SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)
#define SWEEPS_MAX 100000u
#define REACH_MAX 16.0

/* Names and kinds of a list of rates. `props`: what the item declares; NULL: not to be compared. */
static int check_rates(const sph_list *rates, const sph_list *props, struct error *e)
{
    const sph_rate *r = rates->data;

    for (uint32_t i = 0; i < rates->count; i++) {
        const sph_prop *rate, *property;

        if (!check_is_word(r[i].property, false) || !check_is_word(r[i].rate, false))
            return error_set(e, EXIT_REFUSED, "rates[%u] does not name a property and its rate", i);
        if (strcmp(r[i].property, r[i].rate) == 0)
            return error_set(e, EXIT_REFUSED, "rates[%u]: \"%s\" is its own rate", i, r[i].rate);
        if (r[i].kind != SPH_KICK && r[i].kind != SPH_DRIFT)
            return error_set(e, EXIT_REFUSED, "kind of the rate of \"%s\" is %u, which is unknown",
                             r[i].property, r[i].kind);
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(r[i].property, r[k].property) == 0)
                return error_set(e, EXIT_REFUSED, "\"%s\" has two rates", r[i].property);
        if (!props)
            continue;
        rate = check_find_prop(props, r[i].rate);
        property = check_find_prop(props, r[i].property);
        if (!rate || !(rate->access & WRITES))
            return error_set(e, EXIT_REFUSED,
                             "rate of \"%s\" is \"%s\", which is not declared as written",
                             r[i].property, r[i].rate);
        if (property && property->type != rate->type)
            return error_set(e, EXIT_REFUSED, "\"%s\" and its rate \"%s\" are of different types",
                             r[i].property, r[i].rate);
    }
    return 0;
}

static int check_reduction(const sph_reduction *r, uint32_t i, const sph_list *props,
                           struct error *e)
{
    const sph_prop *p;

    if (!check_is_word(r->name, true))
        return error_set(e, EXIT_REFUSED, "name of reductions[%u] is not a word", i);
    if (!check_is_word(r->property, false))
        return error_set(e, EXIT_REFUSED, "reduction \"%s\" names no property", r->name);
    p = check_find_prop(props, r->property);
    if (!p)
        return error_set(e, EXIT_REFUSED, "reduction \"%s\" is of \"%s\", which is not declared",
                         r->name, r->property);
    if (p->type != SPH_SCALAR)
        return error_set(e, EXIT_REFUSED, "reduction \"%s\" is of \"%s\", which is not a scalar",
                         r->name, r->property);
    if (r->op < SPH_REDUCE_MIN || r->op > SPH_REDUCE_SUM)
        return error_set(e, EXIT_REFUSED, "op of reduction \"%s\" is %u, which is unknown", r->name,
                         r->op);
    if (r->use > SPH_USE_POTENTIAL)
        return error_set(e, EXIT_REFUSED, "use of reduction \"%s\" is %u, which is unknown",
                         r->name, r->use);
    if (r->use == SPH_USE_TIME_STEP && r->op != SPH_REDUCE_MIN)
        return error_set(e, EXIT_REFUSED,
                         "reduction \"%s\" bounds the time step, but is no minimum", r->name);
    if (r->use > SPH_USE_TIME_STEP && r->op != SPH_REDUCE_SUM)
        return error_set(e, EXIT_REFUSED, "reduction \"%s\" is an energy, but no sum", r->name);
    return 0;
}

static int check_reductions(const sph_list *reductions, const sph_list *props, struct error *e)
{
    const sph_reduction *r = reductions->data;

    for (uint32_t i = 0; i < reductions->count; i++) {
        if (check_reduction(&r[i], i, props, e))
            return -1;
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(r[i].name, r[k].name) == 0)
                return error_set(e, EXIT_REFUSED, "reduction \"%s\" is declared twice", r[i].name);
    }
    return 0;
}

/* A point function has no sources. */
static int check_no_sources(const sph_list *props, const char *what, struct error *e)
{
    const sph_prop *p = props->data;

    for (uint32_t i = 0; i < props->count; i++) {
        if (p[i].access & SPH_SRC_READ)
            return error_set(e, EXIT_REFUSED,
                             "property \"%s\" is read at the sources, but %s has none", p[i].name,
                             what);
        if (p[i].access & SPH_DST_SWEEP)
            return error_set(e, EXIT_REFUSED,
                             "property \"%s\" is for the sweep alone (SPH_DST_SWEEP), but %s has "
                             "none",
                             p[i].name, what);
    }
    return 0;
}

static int check_sweeps(const sph_function *f, struct error *e)
{
    const sph_prop *p;

    if (f->max_sweeps == 0 && f->unfinished)
        return error_set(e, EXIT_REFUSED, "unfinished is set, but max_sweeps is 0");
    if (f->max_sweeps == 0)
        return 0;
    if (f->max_sweeps > SWEEPS_MAX)
        return error_set(e, EXIT_REFUSED, "max_sweeps is %u, which is absurd (limit %u)",
                         f->max_sweeps, SWEEPS_MAX);
    if (!check_is_word(f->unfinished, false))
        return error_set(e, EXIT_REFUSED, "max_sweeps is %u, but unfinished names no property",
                         f->max_sweeps);
    p = check_find_prop(&f->item->props, f->unfinished);
    if (!p || p->type != SPH_INT32 || !(p->access & SPH_DST_WRITE))
        return error_set(e, EXIT_REFUSED,
                         "unfinished is \"%s\", which is not declared as a written int32",
                         f->unfinished);
    return 0;
}

/* What the sweeps work in, and where. */
static int check_loop(const sph_function *f, struct error *e)
{
    const sph_prop *p;

    if (f->reals & ~(SPH_F64 | SPH_F32))
        return error_set(e, EXIT_REFUSED, "reals is %u, which this sph does not know", f->reals);
    if (f->frozen > 1 || (f->frozen && !f->over))
        return error_set(e, EXIT_REFUSED, "frozen is %u, %s", f->frozen,
                         f->over ? "neither 0 nor 1" : "but over names no property");
    if (!f->over)
        return 0;
    if (f->shape != SPH_PAIR)
        return error_set(e, EXIT_REFUSED, "over is set, but a point function has no neighbours");
    p = check_is_word(f->over, false) ? check_find_prop(&f->item->props, f->over) : NULL;
    if (!p || p->type != SPH_VECTOR || !(p->access & SPH_DST_READ) || !(p->access & SPH_SRC_READ))
        return error_set(e, EXIT_REFUSED,
                         "over is \"%s\", which is not declared as a vector that is read of "
                         "destinations and sources",
                         check_is_word(f->over, false) ? f->over : "?");
    return 0;
}

static int check_function(const sph_function *f, struct error *e)
{
    if (f->shape != SPH_POINT && f->shape != SPH_PAIR)
        return error_set(e, EXIT_REFUSED, "shape is %u, neither point nor pair", f->shape);
    if (!f->run)
        return error_set(e, EXIT_REFUSED, "run is NULL");
    if (f->shape == SPH_PAIR && f->reach != SPH_GATHER && f->reach != SPH_SYMMETRIC)
        return error_set(e, EXIT_REFUSED, "reach is %u, neither gather nor symmetric", f->reach);
    if (!(f->reach_scale > 0 && f->reach_scale <= REACH_MAX))
        return error_set(e, EXIT_REFUSED, "reach_scale is %g, not within 0 and %g", f->reach_scale,
                         REACH_MAX);
    if (f->shape == SPH_POINT && check_no_sources(&f->item->props, "a point function", e))
        return -1;
    if (check_sweeps(f, e) || check_loop(f, e) || check_devices(f, e) ||
        check_rates(&f->rates, &f->item->props, e))
        return -1;
    return check_reductions(&f->reductions, &f->item->props, e);
}

/* Does a list of properties write any, or with `of`, any that `of` reads? */
static bool writes_any(const sph_list *props, const sph_list *of)
{
    const sph_prop *p = props->data;

    for (uint32_t i = 0; i < props->count; i++) {
        const sph_prop *other = of ? check_find_prop(of, p[i].name) : NULL;
        if ((p[i].access & SPH_DST_WRITE) && (!of || (other && (other->access & SPH_DST_READ))))
            return true;
    }
    return false;
}

static int check_eos(const sph_eos *eos, struct error *e)
{
    if (!eos->run)
        return error_set(e, EXIT_REFUSED, "run is NULL");
    if (!writes_any(&eos->item->props, NULL))
        return error_set(e, EXIT_REFUSED, "props: none is written");
    if (check_no_sources(&eos->item->props, "an equation of state", e) || check_device_eos(eos, e))
        return -1;
    if (!eos->inverse)
        return eos->inverse_props.count == 0
                   ? 0
                   : error_set(e, EXIT_REFUSED, "inverse is NULL, but inverse_props are declared");
    if (check_props(&eos->inverse_props, "inverse_props", e) ||
        check_no_sources(&eos->inverse_props, "an equation of state", e))
        return -1;
    if (!writes_any(&eos->inverse_props, &eos->item->props))
        return error_set(e, EXIT_REFUSED, "inverse_props: none is written that run reads");
    return 0;
}

static int check_exact(const sph_exact *x, struct error *e)
{
    if (!x->run)
        return error_set(e, EXIT_REFUSED, "run is NULL");
    if (!writes_any(&x->item->props, NULL))
        return error_set(e, EXIT_REFUSED, "props: none is written");
    return check_no_sources(&x->item->props, "an exact solution", e);
}

static int check_steps(const sph_list *steps, struct error *e)
{
    const sph_step *s = steps->data;

    if (steps->count == 0)
        return error_set(e, EXIT_REFUSED, "steps is empty");
    for (uint32_t i = 0; i < steps->count; i++) {
        if (!check_is_text(s[i].at) ||
            (strcmp(s[i].at, SPH_AT_START) != 0 && strcmp(s[i].at, SPH_AT_EVALUATE) != 0 &&
             strcmp(s[i].at, SPH_AT_FINISH) != 0))
            return error_set(e, EXIT_REFUSED, "at of steps[%u] is none of start, evaluate, finish",
                             i);
        if (!check_is_text(s[i].kind) ||
            (strcmp(s[i].kind, SPH_KIND_FUNCTION) != 0 && strcmp(s[i].kind, SPH_KIND_EOS) != 0))
            return error_set(e, EXIT_REFUSED, "kind of steps[%u] is neither %s nor %s", i,
                             SPH_KIND_FUNCTION, SPH_KIND_EOS);
        if (strcmp(s[i].kind, SPH_KIND_FUNCTION) == 0 && !check_is_name(s[i].name))
            return error_set(e, EXIT_REFUSED, "steps[%u] names no function", i);
        if (s[i].on != SPH_ON_BOUNDARY && s[i].on != SPH_ON_BOUNDED)
            return error_set(e, EXIT_REFUSED, "on of steps[%u] is %u, which is unknown", i,
                             s[i].on);
        if (s[i].after && s[i].before)
            return error_set(e, EXIT_REFUSED, "steps[%u] has both after and before", i);
        if ((s[i].after && !check_is_name(s[i].after)) ||
            (s[i].before && !check_is_name(s[i].before)))
            return error_set(e, EXIT_REFUSED, "%s of steps[%u] is not the name of a step",
                             s[i].after ? "after" : "before", i);
    }
    return 0;
}

/* Of kinds that are recipes or data. */
static int check_nothing_declared(const sph_item *item, struct error *e)
{
    if (item->params.count > 0)
        return error_set(e, EXIT_REFUSED, "params: an item of this kind has none of its own");
    if (item->props.count > 0)
        return error_set(e, EXIT_REFUSED, "props: an item of this kind has none of its own");
    return 0;
}

static int check_boundary(const sph_boundary *b, struct error *e)
{
    return check_nothing_declared(b->item, e) ? -1 : check_steps(&b->steps, e);
}

/* A scheme's steps act on all arrays and stand in order. */
static int check_plain_steps(const sph_list *steps, struct error *e)
{
    const sph_step *s = steps->data;

    for (uint32_t i = 0; i < steps->count; i++)
        if (s[i].on != SPH_ON_BOUNDARY || s[i].after || s[i].before)
            return error_set(e, EXIT_REFUSED,
                             "steps[%u] has %s, which is for boundary conditions only", i,
                             s[i].after    ? "after"
                             : s[i].before ? "before"
                                           : "on");
    return 0;
}

static int check_scheme(const sph_scheme *s, struct error *e)
{
    if (check_nothing_declared(s->item, e))
        return -1;
    if (s->kernel && !check_is_name(s->kernel))
        return error_set(e, EXIT_REFUSED, "kernel is not a name");
    if (!check_is_name(s->integrator))
        return error_set(e, EXIT_REFUSED, "integrator is not a name");
    if (!(s->cfl > 0 && isfinite(s->cfl)))
        return error_set(e, EXIT_REFUSED, "cfl is %g, not a positive number", s->cfl);
    return check_steps(&s->steps, e) || check_plain_steps(&s->steps, e)
               ? -1
               : check_rates(&s->rates, NULL, e);
}

int check_descriptor(enum kind kind, const void *descriptor, struct error *e)
{
    switch (kind) {
    case KIND_FUNCTION:
        return check_item(((const sph_function *)descriptor)->item, e)
                   ? -1
                   : check_function(descriptor, e);
    case KIND_EOS:
        return check_item(((const sph_eos *)descriptor)->item, e) ? -1 : check_eos(descriptor, e);
    case KIND_BOUNDARY:
        return check_item(((const sph_boundary *)descriptor)->item, e)
                   ? -1
                   : check_boundary(descriptor, e);
    case KIND_KERNEL:
        return check_item(((const sph_kernel *)descriptor)->item, e) ||
                       check_nothing_declared(((const sph_kernel *)descriptor)->item, e)
                   ? -1
                   : check_kernel(descriptor, e);
    case KIND_SCHEME:
        return check_item(((const sph_scheme *)descriptor)->item, e) ? -1
                                                                     : check_scheme(descriptor, e);
    case KIND_EXACT:
        return check_item(((const sph_exact *)descriptor)->item, e) ? -1
                                                                    : check_exact(descriptor, e);
    case KIND_COUNT:
        break;
    }
    return error_set(e, EXIT_REFUSED, "unknown kind");
}
