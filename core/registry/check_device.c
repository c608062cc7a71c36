/* registry/check_device.c -- checks the body for a device that a pair function brings: its
 * texts, and that its lists are of what the item declares. Whether the text compiles is seen
 * where it is built. */
#include "registry/check.h"
#include "registry/reach.h"

#include <string.h>

#define TEXT_MAX ((size_t)1 << 20)
#define WRITES (SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)

/* What a list may name. */
struct rule {
    const char *list;
    uint32_t access; /* one of these bits must be declared; 0: parameters */
    const char *words;
    bool scalar;
};

/* An identifier that is none of the SDK's. */
static bool is_identifier(const char *s)
{
    return check_is_word(s, false) && strncmp(s, "sph_", 4) != 0 && strncmp(s, "SPH_", 4) != 0;
}

static int check_text(const char *text, const char *file, const char *what, struct error *e)
{
    if (!reach_text(text, TEXT_MAX) || text[0] == '\0')
        return error_set(e, EXIT_REFUSED, "%s of the device body is missing", what);
    if (strnlen(text, TEXT_MAX) == TEXT_MAX)
        return error_set(e, EXIT_REFUSED, "%s of the device body is longer than %zu bytes", what,
                         TEXT_MAX);
    if (!check_is_text(file) || file[0] == '\0')
        return error_set(e, EXIT_REFUSED,
                         "file of the device body's %s is missing or not one line of UTF-8 text",
                         what);
    return 0;
}

static int check_param_value(const sph_device_value *v, const sph_item *item, struct error *e)
{
    const sph_param *params = item->params.data;

    if (v->index >= item->params.count)
        return error_set(e, EXIT_REFUSED,
                         "param of the device body: \"%s\" is parameter %u, but %u are declared",
                         v->name, v->index, item->params.count);
    if (params[v->index].type != SPH_PARAM_NUMBER)
        return error_set(e, EXIT_REFUSED,
                         "param of the device body: \"%s\" is the parameter \"%s\", a table",
                         v->name, params[v->index].name);
    return 0;
}

static int check_prop_value(const sph_device_value *v, const struct rule *rule,
                            const sph_item *item, struct error *e)
{
    const sph_prop *props = item->props.data;
    const sph_prop *p;

    if (v->index >= item->props.count)
        return error_set(e, EXIT_REFUSED,
                         "%s of the device body: \"%s\" is property %u, but %u are declared",
                         rule->list, v->name, v->index, item->props.count);
    p = &props[v->index];
    if (v->type != p->type ||
        (v->type != SPH_SCALAR && v->type != SPH_VECTOR && v->type != SPH_MATRIX))
        return error_set(e, EXIT_REFUSED,
                         "%s of the device body: type of \"%s\" is %u, that of the property \"%s\" "
                         "%u; it must be the same, and scalar, vector or matrix",
                         rule->list, v->name, v->type, p->name, p->type);
    if (rule->scalar && v->type != SPH_SCALAR)
        return error_set(e, EXIT_REFUSED, "%s of the device body: \"%s\" is not a scalar",
                         rule->list, v->name);
    if (!(p->access & rule->access))
        return error_set(e, EXIT_REFUSED,
                         "%s of the device body: property \"%s\" is not declared as %s", rule->list,
                         p->name, rule->words);
    return 0;
}

static int check_values(const sph_list *list, const struct rule *rule, const sph_item *item,
                        struct error *e)
{
    const sph_device_value *v = list->data;

    for (uint32_t i = 0; i < list->count; i++) {
        if (!is_identifier(v[i].name))
            return error_set(e, EXIT_REFUSED,
                             "%s[%u] of the device body has no name of its own: letters, digits "
                             "and _, not beginning with sph_",
                             rule->list, i);
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(v[i].name, v[k].name) == 0)
                return error_set(e, EXIT_REFUSED, "%s of the device body names \"%s\" twice",
                                 rule->list, v[i].name);
        if (rule->access ? check_prop_value(&v[i], rule, item, e)
                         : check_param_value(&v[i], item, e))
            return -1;
    }
    return 0;
}

int check_device_body(const sph_function *f, struct error *e)
{
    static const struct rule rules[] = {
        {"i", SPH_DST_READ, "read at the destination", false},
        {"j", SPH_SRC_READ, "read at the sources", false},
        {"sum", WRITES, "written", false},
        {"min", WRITES, "written", true},
        {"max", WRITES, "written", true},
        {"param", 0, "", false},
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
    if (check_text(d->text, d->file, "text", e) ||
        (d->prelude && check_text(d->prelude, d->prelude_file, "prelude", e)))
        return -1;
    for (size_t i = 0; i < sizeof(rules) / sizeof(rules[0]); i++)
        if (check_values(lists[i], &rules[i], f->item, e))
            return -1;
    return 0;
}
