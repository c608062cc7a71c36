/* scene/scene_declared.c -- what a function of the scene declares besides its bodies: properties, as far as no
 * plugin does, parameters, rates and reductions. */
#include "scene/functions.h"
#include "base/text.h"
#include "scene/scene_private.h"
#include <math.h>
#include <string.h>

static int fail_object(const struct scene *s, const cJSON *node, const char *what, struct error *e)
{
    return document_fail(s->doc, node, e, "give an object: %s", what);
}

/* Room for an element for each member of `node`, an object; an absent one has none. */
static int begin(struct scene *s, const cJSON *node, const char *what, size_t size, void **out,
                 struct error *e)
{
    if (!node)
        return 0;
    if (!cJSON_IsObject(node))
        return fail_object(s, node, what, e);
    *out = scene_alloc(s, (size_t)cJSON_GetArraySize(node), size, e);
    return *out ? 0 : -1;
}

/* The member's key as a name that bodies can use. */
static int check_name(const struct scene *s, const cJSON *node, struct error *e)
{
    if (scene_is_identifier(node->string))
        return 0;
    return document_fail_key(s->doc, node, e,
                             "\"%s\" is not a name: give letters, digits and \"_\", not beginning "
                             "with sph_",
                             node->string);
}

/* -- Properties ------------------------------------------------------------------------------ */

static const char *const type_words[] = {"scalar", "vector", "sym", "matrix", "int32"};

static int compile_property(struct scene *s, const cJSON *node, struct scene_property *p,
                            struct error *e)
{
    static const char *const keys[] = {"type", "unit", "doc", "start", "work"};
    char hint[256], brief[JSON_BRIEF];
    const cJSON *type = cJSON_IsString(node) ? node : json_get(node, "type");
    *p = (struct scene_property){.node = node, .name = node->string, .start = INFINITY};
    if (check_name(s, node, e) < 0)
        return -1;
    if (!cJSON_IsString(node) && (json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
                                  json_string(s->doc, node, "unit", false, &p->unit, e) < 0 ||
                                  json_string(s->doc, node, "doc", false, &p->doc, e) < 0 ||
                                  json_number(s->doc, node, "start", false, &p->start, e) < 0 ||
                                  json_bool(s->doc, node, "work", false, &p->work, e) < 0))
        return -1;
    for (size_t i = 0; cJSON_IsString(type) && i < COUNT(type_words); i++)
        if (!strcmp(type->valuestring, type_words[i]))
            p->type = (uint32_t)i + 1; /* in the order of SPH_SCALAR ... */
    if (type && !p->type)
        return document_fail(s->doc, type, e, "unknown type %s%s", json_brief(type, brief),
                             text_suggest(hint, sizeof hint,
                                          cJSON_IsString(type) ? type->valuestring : "", type_words,
                                          COUNT(type_words)));
    return 0;
}

/* Whether one of the body's lists has the property. */
static bool body_has(const struct scene_body *b, const char *property)
{
    for (int l = 0; l < LISTS; l++)
        for (size_t k = 0; k < b->n_value[l]; k++)
            if (!strcmp(b->value[l][k].property, property))
                return true;
    return false;
}

static int compile_properties(struct scene *s, const cJSON *node, struct scene_function *f,
                              struct error *e)
{
    const cJSON *item;
    void *list = NULL;
    if (begin(s, node, "properties by name, {\"q\": \"scalar\"}", sizeof *f->property, &list, e) <
        0)
        return -1;
    f->property = list;
    cJSON_ArrayForEach(item, node)
    {
        if (compile_property(s, item, &f->property[f->n_property], e) < 0)
            return -1;
        if (!body_has(&f->run, item->string) && !body_has(&f->before, item->string) &&
            !body_has(&f->after, item->string))
            return document_fail_key(
                s->doc, item, e, "no list of the function has the property \"%s\"", item->string);
        f->n_property++;
    }
    return 0;
}

/* -- Parameters ------------------------------------------------------------------------------ */

/* 0.01, or an object; without "default" the user must give it. */
static int compile_parameter(struct scene *s, const cJSON *node, sph_param *p, struct error *e)
{
    static const char *const keys[] = {"default", "min", "max", "unit", "doc"};
    double min = -INFINITY, max = INFINITY;
    *p = (sph_param)SPH_PARAM(node->string, "", "", NAN, 1, 0);
    if (check_name(s, node, e) < 0)
        return -1;
    if (scene_is_taken(node->string, false))
        return document_fail_key(
            s->doc, node, e, "the body has another \"%s\" already: call the parameter otherwise",
            node->string);
    if (cJSON_IsNumber(node) && isfinite(node->valuedouble)) {
        p->def = node->valuedouble;
        return 0;
    }
    if (!cJSON_IsObject(node))
        return document_fail(s->doc, node, e,
                             "give the parameter's default, a number, or an object with "
                             "\"default\", \"min\", \"max\"");
    if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
        json_number(s->doc, node, "default", false, &p->def, e) < 0 ||
        json_number(s->doc, node, "min", false, &min, e) < 0 ||
        json_number(s->doc, node, "max", false, &max, e) < 0 ||
        json_string(s->doc, node, "unit", false, &p->unit, e) < 0 ||
        json_string(s->doc, node, "doc", false, &p->doc, e) < 0)
        return -1;
    if (min > max)
        return document_fail(s->doc, node, e, "min %.15g is above max %.15g", min, max);
    if (p->def < min || p->def > max)
        return document_fail(s->doc, json_get(node, "default"), e,
                             "the default %.15g is not within %.15g and %.15g", p->def, min, max);
    if (isfinite(min) || isfinite(max)) {
        p->min = min;
        p->max = max;
    }
    return 0;
}

/* A parameter has the same name in all bodies, beside their lists. */
static int check_unique(const struct scene *s, const cJSON *item, const struct scene_function *f,
                        struct error *e)
{
    const struct scene_body *const bodies[] = {&f->run, &f->before, &f->after};
    for (size_t b = 0; b < COUNT(bodies); b++)
        for (int l = LIST_SUM; l < LISTS; l++)
            for (size_t k = 0; k < bodies[b]->n_value[l]; k++)
                if (!strcmp(bodies[b]->value[l][k].name, item->string))
                    return document_fail_key(s->doc, item, e, "\"%s\" is named in \"%s\" already",
                                             item->string, scene_list_key[l]);
    return 0;
}

static int compile_parameters(struct scene *s, const cJSON *node, struct scene_function *f,
                              struct error *e)
{
    const cJSON *item;
    void *list = NULL;
    if (begin(s, node, "parameters by name, {\"k\": 0.01}", sizeof *f->param, &list, e) < 0)
        return -1;
    f->param = list;
    cJSON_ArrayForEach(item, node)
    {
        if (compile_parameter(s, item, &f->param[f->n_param++], e) < 0 ||
            check_unique(s, item, f, e) < 0)
            return -1;
    }
    return 0;
}

/* -- Rates and reductions -------------------------------------------------------------------- */

/* {"v": "a"}; of a position {"X": {"rate": "V", "kind": "drift"}}. */
static int compile_rate(struct scene *s, const cJSON *node, sph_rate *r, struct error *e)
{
    static const char *const keys[] = {"rate", "kind"}, *const kinds[] = {"kick", "drift"};
    size_t kind = 0;
    r->property = node->string;
    r->kind = SPH_KICK;
    if (check_name(s, node, e) < 0)
        return -1;
    if (cJSON_IsString(node)) {
        r->rate = node->valuestring;
    } else if (!cJSON_IsObject(node)) {
        return document_fail(s->doc, node, e, "give the name of the property that is its rate");
    } else if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
               json_string(s->doc, node, "rate", true, &r->rate, e) < 0 ||
               scene_word(s, node, "kind", "kind of rate", kinds, COUNT(kinds), &kind, e) < 0) {
        return -1;
    }
    r->kind = kind == 0 ? SPH_KICK : SPH_DRIFT;
    return 0;
}

static int compile_rates(struct scene *s, const cJSON *node, struct scene_function *f,
                         struct error *e)
{
    const cJSON *item;
    void *list = NULL;
    if (begin(s, node, "{\"v\": \"a\"} where a is the rate of v", sizeof *f->rate, &list, e) < 0)
        return -1;
    f->rate = list;
    cJSON_ArrayForEach(item, node)
    {
        if (compile_rate(s, item, &f->rate[f->n_rate++], e) < 0)
            return -1;
    }
    return 0;
}

/* {"min": "dt", "use": "time-step"}. */
static int compile_reduction(struct scene *s, const cJSON *node, sph_reduction *r, struct error *e)
{
    static const char *const keys[] = {"min", "max", "sum", "use"};
    static const char *const uses[] = {"none", "time-step", "internal", "potential"};
    size_t use = 0, n = 0;
    r->name = node->string;
    if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0)
        return -1;
    for (size_t i = 0; i < 3; i++)
        if (json_get(node, keys[i])) {
            n++;
            r->op = (uint32_t)i + 1; /* in the order of SPH_REDUCE_MIN ... */
            if (json_string(s->doc, node, keys[i], true, &r->property, e) < 0)
                return -1;
        }
    if (n != 1)
        return document_fail(s->doc, node, e,
                             "a reduction has one of \"min\", \"max\" and \"sum\": the property "
                             "that it is of");
    if (scene_word(s, node, "use", "use", uses, COUNT(uses), &use, e) < 0)
        return -1;
    r->use = (uint32_t)use; /* in the order of SPH_USE_NONE ... */
    return 0;
}

static int compile_reductions(struct scene *s, const cJSON *node, struct scene_function *f,
                              struct error *e)
{
    const cJSON *item;
    void *list = NULL;
    if (begin(s, node, "reductions by name, {\"dt\": {\"min\": \"dt\"}}", sizeof *f->reduction,
              &list, e) < 0)
        return -1;
    f->reduction = list;
    cJSON_ArrayForEach(item, node)
    {
        if (compile_reduction(s, item, &f->reduction[f->n_reduction++], e) < 0)
            return -1;
    }
    return 0;
}

int scene_declared(struct scene *s, const cJSON *node, struct scene_function *f, struct error *e)
{
    if (compile_properties(s, json_get(node, "properties"), f, e) < 0 ||
        compile_parameters(s, json_get(node, "parameters"), f, e) < 0 ||
        compile_rates(s, json_get(node, "rates"), f, e) < 0)
        return -1;
    return compile_reductions(s, json_get(node, "reductions"), f, e);
}
