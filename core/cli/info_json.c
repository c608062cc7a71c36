/* cli/info_json.c -- `sph info --json`: one object with "abi", "extensions", "plugins" and
 * "items" on stdout. */
#include "config.h"

#include "cli/info.h"
#include "integrators/integrator.h"
#include "registry/extension.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* cJSON's adders return NULL when out of memory; so does this, to be told once, at the end. */
static cJSON *number(cJSON *object, const char *key, double value)
{
    return isfinite(value) ? cJSON_AddNumberToObject(object, key, value)
                           : cJSON_AddNullToObject(object, key);
}

static cJSON *element(cJSON *array)
{
    cJSON *object = cJSON_CreateObject();

    if (!cJSON_AddItemToArray(array, object)) {
        cJSON_Delete(object);
        return NULL;
    }
    return object;
}

/* "one|other" */
static void words(cJSON *object, const char *key, const char *list, const char *separators)
{
    cJSON *array = cJSON_AddArrayToObject(object, key);

    while (*list) {
        char word[80];
        const size_t n = strcspn(list, separators);
        snprintf(word, sizeof(word), "%.*s", (int)n, list);
        if (n > 0)
            cJSON_AddItemToArray(array, cJSON_CreateString(word));
        list += n;
        list += strspn(list, separators);
        list += strspn(list, " ");
    }
}

static void param_json(cJSON *array, const sph_param *p)
{
    cJSON *o = element(array);
    char value[128];

    cJSON_AddStringToObject(o, "name", p->name);
    cJSON_AddStringToObject(o, "unit", p->unit);
    cJSON_AddStringToObject(o, "doc", p->doc);
    cJSON_AddStringToObject(o, "type",
                            p->type == SPH_PARAM_TABLE ? "table"
                            : p->choices               ? "word"
                                                       : "number");
    if (p->type == SPH_PARAM_TABLE) {
        cJSON_AddBoolToObject(o, "mandatory", isnan(p->def));
        return;
    }
    if (!p->choices) {
        number(o, "default", p->def);
        number(o, "min", p->min <= p->max ? p->min : NAN);
        number(o, "max", p->min <= p->max ? p->max : NAN);
        return;
    }
    if (info_default(p, value, sizeof(value))[0])
        cJSON_AddStringToObject(o, "default", value);
    else
        cJSON_AddNullToObject(o, "default");
    words(o, "choices", p->choices, "|");
}

static void props_json(cJSON *object, const char *key, const sph_list *props)
{
    cJSON *array = cJSON_AddArrayToObject(object, key);
    const sph_prop *p = props->data;

    for (uint32_t i = 0; i < props->count; i++) {
        cJSON *o = element(array);
        char access[128];
        cJSON_AddStringToObject(o, "name", p[i].name);
        cJSON_AddStringToObject(o, "unit", p[i].unit);
        cJSON_AddStringToObject(o, "doc", p[i].doc);
        cJSON_AddStringToObject(o, "type", info_type(p[i].type));
        words(o, "access", info_access(p[i].access, access, sizeof(access)), ",");
        if (p[i].access & (SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN))
            number(o, "start", p[i].start);
    }
}

static void rates_json(cJSON *object, const sph_list *rates)
{
    cJSON *array = cJSON_AddArrayToObject(object, "rates");
    const sph_rate *r = rates->data;

    for (uint32_t i = 0; i < rates->count; i++) {
        cJSON *o = element(array);
        cJSON_AddStringToObject(o, "property", r[i].property);
        cJSON_AddStringToObject(o, "rate", r[i].rate);
        cJSON_AddStringToObject(o, "kind", r[i].kind == SPH_DRIFT ? "drift" : "kick");
    }
}

static void reductions_json(cJSON *object, const sph_list *reductions)
{
    static const char *const op[] = {"", "min", "max", "sum"};
    static const char *const use[] = {"none", "time-step", "internal", "potential"};
    cJSON *array = cJSON_AddArrayToObject(object, "reductions");
    const sph_reduction *r = reductions->data;

    for (uint32_t i = 0; i < reductions->count; i++) {
        cJSON *o = element(array);
        cJSON_AddStringToObject(o, "name", r[i].name);
        cJSON_AddStringToObject(o, "property", r[i].property);
        cJSON_AddStringToObject(o, "op", op[r[i].op]);
        cJSON_AddStringToObject(o, "use", use[r[i].use]);
    }
}

static void steps_json(cJSON *object, const sph_list *steps)
{
    cJSON *array = cJSON_AddArrayToObject(object, "steps");
    const sph_step *s = steps->data;

    for (uint32_t i = 0; i < steps->count; i++) {
        const bool eos = strcmp(s[i].kind, SPH_KIND_EOS) == 0;
        cJSON *o = element(array);
        cJSON_AddStringToObject(o, "at", s[i].at);
        cJSON_AddStringToObject(o, "kind", kind_label[eos ? KIND_EOS : KIND_FUNCTION]);
        if (!eos)
            cJSON_AddStringToObject(o, "name", s[i].name);
        if (s[i].after)
            cJSON_AddStringToObject(o, "after", s[i].after);
        if (s[i].before)
            cJSON_AddStringToObject(o, "before", s[i].before);
        if (s[i].on == SPH_ON_BOUNDED)
            cJSON_AddStringToObject(o, "on", "bounded");
    }
}

static void function_json(cJSON *o, const sph_function *f)
{
    cJSON_AddStringToObject(o, "shape", f->shape == SPH_PAIR ? "pair" : "point");
    if (f->shape == SPH_PAIR) {
        cJSON_AddStringToObject(o, "reach", f->reach == SPH_GATHER ? "gather" : "symmetric");
        number(o, "reach_scale", f->reach_scale);
    }
    if (f->max_sweeps > 0)
        number(o, "max_sweeps", f->max_sweeps);
    rates_json(o, &f->rates);
    reductions_json(o, &f->reductions);
}

static void backends_json(cJSON *o, const struct entry *x)
{
    words(o, "backends", entry_on_device(x) ? "cpu|opencl" : "cpu", "|");
}

static void specific_json(cJSON *o, const struct entry *x)
{
    switch (x->kind) {
    case KIND_FUNCTION:
        function_json(o, entry_function(x));
        backends_json(o, x);
        break;
    case KIND_EOS:
        props_json(o, "inverse_properties", &entry_eos(x)->inverse_props);
        backends_json(o, x);
        break;
    case KIND_KERNEL:
        number(o, "support", entry_kernel(x)->support);
        cJSON_AddStringToObject(o, "form", entry_kernel(x)->value ? "function" : "terms");
        break;
    case KIND_SCHEME:
        if (entry_scheme(x)->kernel)
            cJSON_AddStringToObject(o, "kernel", entry_scheme(x)->kernel);
        cJSON_AddStringToObject(o, "integrator", entry_scheme(x)->integrator);
        number(o, "cfl", entry_scheme(x)->cfl);
        steps_json(o, &entry_scheme(x)->steps);
        rates_json(o, &entry_scheme(x)->rates);
        break;
    case KIND_BOUNDARY:
        steps_json(o, &entry_boundary(x)->steps);
        break;
    case KIND_EXACT:
    case KIND_COUNT:
        break;
    }
}

/* What the plugin has said through extensions. */
static void extras_json(cJSON *o, const struct entry *x)
{
    const sph_population *p = x->population;

    if (p && p->remove)
        cJSON_AddStringToObject(o, "remove", p->remove);
    if (p && p->create)
        cJSON_AddStringToObject(o, "create", p->create);
    if (x->state)
        number(o, "state_format", x->state->format);
}

static void entry_json(cJSON *array, const struct registry *r, const struct entry *x)
{
    cJSON *o = element(array);
    const sph_param *p = x->item->params.data;
    cJSON *list;

    char id[96];

    snprintf(id, sizeof(id), "%s/%s", info_kind[x->kind], x->item->name);
    cJSON_AddStringToObject(o, "name", x->item->name);
    cJSON_AddStringToObject(o, "id", id);
    cJSON_AddStringToObject(o, "kind", kind_label[x->kind]);
    cJSON_AddStringToObject(o, "plugin", r->plugin[x->plugin].name);
    cJSON_AddStringToObject(o, "version", r->plugin[x->plugin].version);
    cJSON_AddStringToObject(o, "file", r->plugin[x->plugin].path);
    cJSON_AddStringToObject(o, "doc", x->item->doc);
    cJSON_AddStringToObject(o, "source", x->item->source);
    list = cJSON_AddArrayToObject(o, "dimensions");
    for (int d = 1; d <= 3; d++)
        if (x->item->dims >> d & 1u)
            cJSON_AddItemToArray(list, cJSON_CreateNumber(d));
    list = cJSON_AddArrayToObject(o, "parameters");
    for (uint32_t i = 0; i < x->item->params.count; i++)
        param_json(list, &p[i]);
    props_json(o, "properties", &x->item->props);
    specific_json(o, x);
    extras_json(o, x);
}

static void plugin_json(cJSON *array, const struct plugin *p)
{
    cJSON *o = element(array);
    char abi[32];

    snprintf(abi, sizeof(abi), "%u.%u", p->abi_major, p->abi_minor);
    cJSON_AddStringToObject(o, "name", p->name);
    cJSON_AddStringToObject(o, "version", p->version);
    cJSON_AddStringToObject(o, "license", p->license);
    cJSON_AddStringToObject(o, "doc", p->doc);
    cJSON_AddStringToObject(o, "abi", abi);
    cJSON_AddStringToObject(o, "file", p->path);
}

static void integrators_json(cJSON *array)
{
    size_t n;
    const char *const *name = integrator_names(&n);

    for (size_t i = 0; i < n; i++) {
        const struct integrator *x = integrator_find(name[i]);
        cJSON *o = element(array);
        cJSON_AddStringToObject(o, "name", x->name);
        cJSON_AddStringToObject(o, "doc", x->doc);
        cJSON_AddStringToObject(o, "source", x->source);
        cJSON_AddNumberToObject(o, "order", x->order);
        cJSON_AddNumberToObject(o, "evaluations", x->evaluations);
        cJSON_AddNumberToObject(o, "knee", x->knee);
    }
}

int info_json(const struct registry *r, const struct info_choice *c, struct error *e)
{
    cJSON *root = cJSON_CreateObject();
    char abi[32];
    cJSON *list;
    char *text;

    snprintf(abi, sizeof(abi), "%u.%u", SPH_ABI_MAJOR, SPH_ABI_MINOR);
    cJSON_AddStringToObject(root, "sph", PACKAGE_VERSION);
    cJSON_AddStringToObject(root, "abi", abi);
    list = cJSON_AddArrayToObject(root, "extensions");
    for (size_t i = 0; i < n_extension; i++)
        cJSON_AddItemToArray(list, cJSON_CreateString(extension[i].id));
    integrators_json(cJSON_AddArrayToObject(root, "integrators"));
    list = cJSON_AddArrayToObject(root, "plugins");
    for (size_t i = 0; i < c->n_plugin; i++)
        plugin_json(list, &r->plugin[c->plugin[i]]);
    list = cJSON_AddArrayToObject(root, "items");
    for (size_t i = 0; i < c->n_entry; i++)
        entry_json(list, r, &r->entry[c->entry[i]]);
    text = cJSON_Print(root);
    cJSON_Delete(root);
    if (!text)
        return error_memory(e, "the output", 0);
    puts(text);
    cJSON_free(text);
    return 0;
}
