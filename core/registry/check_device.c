/* registry/check_device.c -- checks the bodies for a device that a function or an equation of state
 * brings, of pairs and of points: their texts, and that their lists are of what the item declares.
 * Whether a text compiles is seen where it is built. */
#include "registry/check.h"
#include "registry/reach.h"

#include <string.h>

#define TEXT_MAX ((size_t)1 << 20)
#define STATE_MAX 4096u /* doubles */
#define PAIR_TYPES (1u << SPH_SCALAR | 1u << SPH_VECTOR | 1u << SPH_MATRIX)
#define POINT_TYPES (PAIR_TYPES | 1u << SPH_SYM | 1u << SPH_INT32)
#define WRITES (SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)

/* What a list may name. */
struct rule {
    const char *of, *list;
    uint32_t access; /* one of these bits must be declared; 0: parameters */
    const char *words;
    uint32_t types; /* bits 1 << SPH_SCALAR ... */
    bool scalar;
};

/* An identifier that is none of the SDK's. */
static bool is_identifier(const char *s)
{
    return check_is_word(s, false) && strncmp(s, "sph_", 4) != 0 && strncmp(s, "SPH_", 4) != 0;
}

/* `of`: whose it is, "the device body" or a member of the descriptor. */
static int check_text(const char *text, const char *file, const char *what, const char *of,
                      struct error *e)
{
    if (!reach_text(text, TEXT_MAX) || text[0] == '\0')
        return error_set(e, EXIT_REFUSED, "%s of %s is missing", what, of);
    if (strnlen(text, TEXT_MAX) == TEXT_MAX)
        return error_set(e, EXIT_REFUSED, "%s of %s is longer than %zu bytes", what, of, TEXT_MAX);
    if (!check_is_text(file) || file[0] == '\0')
        return error_set(e, EXIT_REFUSED,
                         "file of %s's %s is missing or not one line of UTF-8 text", of, what);
    return 0;
}

static int check_param_value(const sph_device_value *v, const sph_item *item, const char *of,
                             struct error *e)
{
    const sph_param *params = item->params.data;

    if (v->index >= item->params.count)
        return error_set(e, EXIT_REFUSED,
                         "param of %s: \"%s\" is parameter %u, but %u are declared", of, v->name,
                         v->index, item->params.count);
    if (params[v->index].type != SPH_PARAM_NUMBER)
        return error_set(e, EXIT_REFUSED, "param of %s: \"%s\" is the parameter \"%s\", a table",
                         of, v->name, params[v->index].name);
    return 0;
}

static int check_prop_value(const sph_device_value *v, const struct rule *rule,
                            const sph_item *item, struct error *e)
{
    const sph_prop *props = item->props.data;
    const sph_prop *p;

    if (v->index >= item->props.count)
        return error_set(e, EXIT_REFUSED, "%s of %s: \"%s\" is property %u, but %u are declared",
                         rule->list, rule->of, v->name, v->index, item->props.count);
    p = &props[v->index];
    if (v->type != p->type || !(1u << v->type & rule->types))
        return error_set(e, EXIT_REFUSED,
                         "%s of %s: type of \"%s\" is %u, that of the property \"%s\" %u; it must "
                         "be the same, and %s",
                         rule->list, rule->of, v->name, v->type, p->name, p->type,
                         rule->types == POINT_TYPES ? "no int64" : "scalar, vector or matrix");
    if (rule->scalar && v->type != SPH_SCALAR)
        return error_set(e, EXIT_REFUSED, "%s of %s: \"%s\" is not a scalar", rule->list, rule->of,
                         v->name);
    if (!(p->access & rule->access))
        return error_set(e, EXIT_REFUSED, "%s of %s: property \"%s\" is not declared as %s",
                         rule->list, rule->of, p->name, rule->words);
    return 0;
}

static int check_name(const sph_device_value *v, uint32_t i, const char *list, const char *of,
                      struct error *e)
{
    if (is_identifier(v->name))
        return 0;
    return error_set(e, EXIT_REFUSED,
                     "%s[%u] of %s has no name of its own: letters, digits and _, not beginning "
                     "with sph_",
                     list, i, of);
}

static int check_values(const sph_list *list, const struct rule *rule, const sph_item *item,
                        struct error *e)
{
    const sph_device_value *v = list->data;

    for (uint32_t i = 0; i < list->count; i++) {
        if (check_name(&v[i], i, rule->list, rule->of, e))
            return -1;
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(v[i].name, v[k].name) == 0)
                return error_set(e, EXIT_REFUSED, "%s of %s names \"%s\" twice", rule->list,
                                 rule->of, v[i].name);
        if (rule->access ? check_prop_value(&v[i], rule, item, e)
                         : check_param_value(&v[i], item, rule->of, e))
            return -1;
    }
    return 0;
}

/* -- Bodies of pairs -------- */

static int check_pairs(const sph_function *f, struct error *e)
{
    static const char of[] = "the device body";
    static const struct rule rules[] = {
        {of, "i", SPH_DST_READ, "read at the destination", PAIR_TYPES, false},
        {of, "j", SPH_SRC_READ, "read at the sources", PAIR_TYPES, false},
        {of, "sum", WRITES, "written", PAIR_TYPES, false},
        {of, "min", WRITES, "written", PAIR_TYPES, true},
        {of, "max", WRITES, "written", PAIR_TYPES, true},
        {of, "param", 0, "", 0, false},
    };
    const sph_device_body *d = f->device;
    const sph_list *const lists[] = {&d->i, &d->j, &d->sum, &d->min, &d->max, &d->param};

    if (f->shape != SPH_PAIR)
        return error_set(e, EXIT_REFUSED, "device is set, but the shape is not pair");
    if (d->reach != SPH_GATHER && d->reach != SPH_SYMMETRIC)
        return error_set(e, EXIT_REFUSED,
                         "reach of the device body is %u, neither gather nor symmetric", d->reach);
    if (d->reach == SPH_SYMMETRIC && f->reach == SPH_GATHER)
        return error_set(e, EXIT_REFUSED,
                         "reach of the device body is symmetric, that of the function gather");
    if (d->self > 1)
        return error_set(e, EXIT_REFUSED, "self of the device body is %u, neither 0 nor 1",
                         d->self);
    if (check_text(d->text, d->file, "text", of, e) ||
        (d->prelude && check_text(d->prelude, d->prelude_file, "prelude", of, e)))
        return -1;
    for (size_t i = 0; i < sizeof(rules) / sizeof(rules[0]); i++)
        if (check_values(lists[i], &rules[i], f->item, e))
            return -1;
    return 0;
}

/* -- Bodies of points -------- */

/* Where a body stands. */
struct place {
    const char *of;
    const sph_item *item;
    const sph_life *life;
    bool pair;   /* of a pair function: before or after */
    bool behind; /* after: what the function writes is there by then */
};

enum { IN, OUT, INOUT, PARAM, STATE, POINT_LISTS };
static const char *const point_list[POINT_LISTS] = {"in", "out", "inout", "param", "state"};

/* What the declaration does not say alone: when a value is there to be read. */
static int check_use(const struct place *at, const sph_device_value *v, int list, struct error *e)
{
    const sph_prop *p = (const sph_prop *)at->item->props.data + v->index;

    if (at->pair && p->access & SPH_DST_SWEEP)
        return error_set(e, EXIT_REFUSED,
                         "%s of %s: property \"%s\" is for the sweep alone (SPH_DST_SWEEP)",
                         point_list[list], at->of, p->name);
    if (list == INOUT && !(p->access & WRITES))
        return error_set(e, EXIT_REFUSED, "inout of %s: property \"%s\" is not declared as written",
                         at->of, p->name);
    if (list == OUT && !at->pair && !(p->access & SPH_DST_WRITE))
        return error_set(e, EXIT_REFUSED,
                         "out of %s: property \"%s\" is declared as one that others write too: it "
                         "belongs into inout",
                         at->of, p->name);
    return 0;
}

/* No name and no property stands in the lists twice. */
static int check_twice(const sph_list *const lists[POINT_LISTS], const struct place *at, int list,
                       const sph_device_value *v, struct error *e)
{
    for (int l = 0; l <= list; l++) {
        const sph_device_value *w = lists[l]->data;
        for (uint32_t k = 0; k < lists[l]->count && &w[k] != v; k++) {
            if (strcmp(w[k].name, v->name) == 0)
                return error_set(e, EXIT_REFUSED, "lists of %s name \"%s\" twice", at->of, v->name);
            if (l <= INOUT && list <= INOUT && w[k].index == v->index)
                return error_set(e, EXIT_REFUSED,
                                 "lists of %s have property \"%s\" twice, in %s and %s", at->of,
                                 ((const sph_prop *)at->item->props.data)[v->index].name,
                                 point_list[l], point_list[list]);
        }
    }
    return 0;
}

static int check_point_lists(const sph_device_point *d, const struct place *at, struct error *e)
{
    const uint32_t sums = SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN;
    const struct rule rules[POINT_LISTS] = {
        {at->of, "in",
         SPH_DST_READ | (at->behind ? WRITES
                         : at->pair ? sums
                                    : 0),
         "read at the destination", POINT_TYPES, false},
        {at->of, "out", WRITES, "written", POINT_TYPES, false},
        {at->of, "inout", SPH_DST_READ | (at->behind ? WRITES : sums), "read at the destination",
         POINT_TYPES, false},
        {at->of, "param", 0, "", 0, false},
        {at->of, "state", 0, "", 0, false},
    };
    const sph_list *const lists[POINT_LISTS] = {&d->in, &d->out, &d->inout, &d->param, &d->state};

    for (int l = 0; l < POINT_LISTS; l++) {
        if (l != STATE && check_values(lists[l], &rules[l], at->item, e))
            return -1;
        for (uint32_t k = 0; k < lists[l]->count; k++) {
            const sph_device_value *v = list_at(lists[l], k);
            if (check_name(v, k, point_list[l], at->of, e) || check_twice(lists, at, l, v, e) ||
                (l <= INOUT && check_use(at, v, l, e)))
                return -1;
            if (d->h && strcmp(v->name, "h") == 0)
                return error_set(e, EXIT_REFUSED,
                                 "%s of %s names \"h\", which is the smoothing length there",
                                 point_list[l], at->of);
            if (l == STATE && v->index >= STATE_MAX)
                return error_set(e, EXIT_REFUSED,
                                 "state of %s: \"%s\" is number %u, which is absurd (limit %u)",
                                 at->of, v->name, v->index, STATE_MAX);
        }
    }
    if (d->state.count > 0 && !(at->life && at->life->create))
        return error_set(e, EXIT_REFUSED, "state of %s is read, but the item has no life", at->of);
    return 0;
}

static int check_point(const sph_device_point *d, const struct place *at, struct error *e)
{
    if (!d)
        return 0;
    if (d->h > 1 || (d->h && !at->pair))
        return error_set(e, EXIT_REFUSED, "h of %s is %u, %s", at->of, d->h,
                         d->h > 1 ? "neither 0 nor 1" : "but it is not of a pair function");
    if (check_text(d->text, d->file, "text", at->of, e) ||
        (d->prelude && check_text(d->prelude, d->prelude_file, "prelude", at->of, e)) ||
        check_point_lists(d, at, e))
        return -1;
    for (uint32_t k = 0; k < d->fail.count; k++) {
        const char *sentence = *(const char *const *)list_at(&d->fail, k);
        if (!check_is_text(sentence) || sentence[0] == '\0')
            return error_set(e, EXIT_REFUSED, "fail[%u] of %s is not one line of UTF-8 text", k,
                             at->of);
    }
    return 0;
}

int check_devices(const sph_function *f, struct error *e)
{
    const struct {
        const char *of, *shape, *member;
        const sph_device_point *point;
        sph_range_fn native;
        bool fits;
    } points[] = {
        {"device_run", "point", "run", f->device_run, f->run, f->shape == SPH_POINT},
        {"device_before", "pair", "before", f->device_before, f->before, f->shape == SPH_PAIR},
        {"device_after", "pair", "after", f->device_after, f->after, f->shape == SPH_PAIR},
    };

    if (f->device && check_pairs(f, e))
        return -1;
    for (size_t i = 0; i < sizeof(points) / sizeof(points[0]); i++) {
        const struct place at = {points[i].of, f->item, f->life, f->shape == SPH_PAIR, i == 2};
        if (points[i].point && !points[i].fits)
            return error_set(e, EXIT_REFUSED, "%s is set, but the shape is not %s", at.of,
                             points[i].shape);
        if (points[i].point && !points[i].native)
            return error_set(e, EXIT_REFUSED, "%s is set, but %s is NULL", at.of, points[i].member);
        if (check_point(points[i].point, &at, e))
            return -1;
    }
    return 0;
}

int check_device_eos(const sph_eos *eos, struct error *e)
{
    const struct place at = {"device", eos->item, eos->life, false, false};

    return check_point(eos->device, &at, e);
}
