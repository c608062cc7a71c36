/* scene/scene_measure.c -- "compare", "probes" and "profiles": what is to be measured. */
#include "scene/scene_private.h"
#include <math.h>
#include <string.h>

/* -- Comparisons ------------------------------------------------------------------------------- */

static int compile_exact(struct scene *s, const cJSON *node, struct scene_compare *c,
                         struct error *e)
{
    static const char *const keys[] = {"array", "exact", "where", "fields", "every", "at"};
    if (json_string(s->doc, node, "exact", true, &c->exact, e) < 0 ||
        scene_strings(s, node, "fields", &c->fields, &c->n_fields, e) < 0)
        return -1;
    c->params = document_rest(s->doc, node, keys, COUNT(keys));
    return c->params ? 0 : error_memory(e, "a comparison", 0);
}

/* {"v.x": "u"}: of the table, column u is v.x. */
static int compile_columns(struct scene *s, const cJSON *fields, struct scene_compare *c,
                           struct error *e)
{
    const size_t n = (size_t)cJSON_GetArraySize(fields);
    const cJSON *item;
    c->fields = scene_alloc(s, n, sizeof *c->fields, e);
    c->columns = scene_alloc(s, n, sizeof *c->columns, e);
    if (!c->fields || !c->columns)
        return -1;
    cJSON_ArrayForEach(item, fields)
    {
        if (!cJSON_IsString(item) || !item->valuestring[0])
            return document_fail(s->doc, item, e, "give the name of the table's column");
        c->fields[c->n_fields] = item->string;
        c->columns[c->n_fields++] = item->valuestring;
    }
    return 0;
}

/* Which of the table's columns is which property. */
static int compile_fields(struct scene *s, const cJSON *node, struct scene_compare *c,
                          struct error *e)
{
    const cJSON *fields = json_get(node, "fields");
    if (cJSON_IsObject(fields))
        return compile_columns(s, fields, c, e);
    if (scene_strings(s, node, "fields", &c->fields, &c->n_fields, e) < 0)
        return -1;
    c->columns = c->fields;
    return 0;
}

static int compile_table(struct scene *s, const cJSON *node, struct scene_compare *c,
                         struct error *e)
{
    static const char *const keys[] = {"array", "table",  "along", "axis", "center",
                                       "where", "fields", "every", "at",   "time"};
    c->table = json_get(node, "table");
    if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
        scene_along(s, node, &c->along, e) < 0 || scene_about(s, node, &c->about, e) < 0 ||
        scene_time_of(s, node, &c->time, e) < 0)
        return -1;
    if (!isnan(c->time) && moments_any(&c->when))
        return document_fail(s->doc, json_get(node, "time"), e,
                             "a table for one time is compared then: leave out \"every\" and "
                             "\"at\"");
    if (!isnan(c->time)) {
        c->when.at = &c->time;
        c->when.n_at = 1;
    }
    return compile_fields(s, node, c, e);
}

int scene_compares(struct scene *s, const cJSON *node, struct error *e)
{
    const cJSON *item;
    void *list = NULL;
    if (scene_list(s, node, "comparisons", sizeof *s->compare, &list, e) < 0)
        return -1;
    s->compare = list;
    cJSON_ArrayForEach(item, node)
    {
        struct scene_compare *c = &s->compare[s->n_compare];
        c->node = item;
        c->time = NAN;
        if (!cJSON_IsObject(item))
            return document_fail(s->doc, item, e, "a comparison is an object");
        if (json_get(item, "table") && json_get(item, "exact"))
            return document_fail(s->doc, item, e, "give \"exact\" or \"table\", not both");
        if (scene_array_name(s, item, "array", true, &c->array, e) < 0 ||
            scene_where(s, item, &c->where, e) < 0 ||
            scene_moments(s, item, true, &c->when, e) < 0 ||
            (json_get(item, "table") ? compile_table : compile_exact)(s, item, c, e) < 0)
            return -1;
        s->n_compare++;
    }
    return 0;
}

/* -- Probes ------------------------------------------------------------------------------------ */

static int compile_crossing(struct scene *s, const cJSON *node, struct scene_probe *p,
                            struct error *e)
{
    static const char *const keys[] = {"of", "shell", "level"};
    const cJSON *crossing = json_get(node, "crossing");
    p->kind = PROBE_CROSSING;
    if (json_keys(s->doc, crossing, keys, COUNT(keys), e) < 0 ||
        json_string(s->doc, crossing, "of", true, &p->of, e) < 0 ||
        json_positive(s->doc, crossing, "shell", true, "width", &p->shell, e) < 0)
        return -1;
    return json_number(s->doc, crossing, "level", true, &p->level, e);
}

/* Of all particles, or of those in a region. */
static int compile_number(struct scene *s, const cJSON *node, struct scene_probe *p,
                          const char *key, struct error *e)
{
    static const char *const points[] = {"of", "plain"};
    for (size_t i = 0; i < COUNT(points); i++)
        if (json_get(node, points[i]))
            return document_fail_key(s->doc, json_get(node, points[i]), e,
                                     "\"%s\" is for a probe \"at\" points", points[i]);
    if (scene_array_name(s, node, "array", true, &p->array, e) < 0 ||
        scene_where(s, node, &p->where, e) < 0 || scene_about(s, node, &p->sample.about, e) < 0)
        return -1;
    if (p->kind == PROBE_CROSSING)
        return compile_crossing(s, node, p, e);
    return json_string(s->doc, node, key, true, &p->of, e);
}

static int compile_points(struct scene *s, const cJSON *node, struct scene_probe *p,
                          struct error *e)
{
    if (json_get(node, "where"))
        return document_fail_key(s->doc, json_get(node, "where"), e,
                                 "a probe \"at\" points sees all particles near them: leave out "
                                 "\"where\"");
    return scene_sample(s, node, &p->sample, e) < 0 ? -1 : scene_points(s, node, &p->sample, e);
}

static int compile_probe(struct scene *s, const cJSON *node, struct scene_probe *p, struct error *e)
{
    static const char *const keys[] = {
        "name", "array", "where", "expected", "mean",   "min",   "max",   "sum",      "crossing",
        "at",   "of",    "plain", "axis",     "center", "every", "steps", "reference"};
    static const char *const kinds[] = {"mean", "min", "max", "sum", "crossing", "at"};
    static const enum probe_kind kind_of[] = {PROBE_MEAN, PROBE_MIN,      PROBE_MAX,
                                              PROBE_SUM,  PROBE_CROSSING, PROBE_POINTS};
    size_t n = 0, kind = 0;
    p->node = node;
    p->expected = NAN;
    if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
        json_string(s->doc, node, "name", true, &p->name, e) < 0 ||
        json_number(s->doc, node, "expected", false, &p->expected, e) < 0 ||
        scene_moments(s, node, false, &p->when, e) < 0)
        return -1;
    for (size_t i = 0; i < COUNT(kinds); i++)
        if (json_get(node, kinds[i])) {
            kind = i;
            n++;
        }
    if (n != 1)
        return document_fail(s->doc, node, e,
                             "a probe has one of \"mean\", \"min\", \"max\", \"sum\", "
                             "\"crossing\" and \"at\"");
    p->kind = kind_of[kind];
    if ((p->kind == PROBE_POINTS ? compile_points(s, node, p, e)
                                 : compile_number(s, node, p, kinds[kind], e)) < 0 ||
        scene_reference(s, node, &p->when, &p->reference, e) < 0)
        return -1;
    if (p->reference.table && p->kind == PROBE_POINTS && p->sample.n_point != 1)
        return document_fail(s->doc, json_get(node, "reference"), e,
                             "a probe with a reference is at one point");
    return 0;
}

/* The i-th name of a list whose names stand in `name`: new, and good for a file's. */
static int check_name(const struct scene *s, const cJSON *node, const char *what, const char *name,
                      const char *earlier, struct error *e)
{
    if (strlen(name) > 200)
        return document_fail(s->doc, json_get(node, "name"), e, "a name has at most 200 letters");
    if (!earlier)
        return 0;
    if (!strcmp(name, earlier))
        return document_fail(s->doc, json_get(node, "name"), e, "an earlier %s has this name",
                             what);
    if (scene_same_file(name, earlier))
        return document_fail(s->doc, json_get(node, "name"), e,
                             "an earlier %s is called \"%.60s\", and their files' names would be "
                             "one",
                             what, earlier);
    return 0;
}

int scene_probes(struct scene *s, const cJSON *node, struct error *e)
{
    const cJSON *item;
    void *list = NULL;
    if (scene_list(s, node, "probes", sizeof *s->probe, &list, e) < 0)
        return -1;
    s->probe = list;
    cJSON_ArrayForEach(item, node)
    {
        const struct scene_probe *p = &s->probe[s->n_probe];
        if (compile_probe(s, item, &s->probe[s->n_probe], e) < 0 ||
            check_name(s, item, "probe", p->name, NULL, e))
            return -1;
        for (size_t i = 0; i < s->n_probe; i++)
            if (check_name(s, item, "probe", p->name, s->probe[i].name, e))
                return -1;
        s->n_probe++;
    }
    return 0;
}

/* -- Profiles ---------------------------------------------------------------------------------- */

#define BINS_MOST 1000000

static int compile_bins(struct scene *s, const cJSON *node, struct scene_profile *p,
                        struct error *e)
{
    long long bins = 50;
    if (scene_along(s, node, &p->along, e) < 0 || scene_where(s, node, &p->where, e) < 0 ||
        json_integer(s->doc, node, "bins", false, 1, BINS_MOST, &bins, e) < 0)
        return -1;
    p->min = p->along == ALONG_R ? 0.0 : s->box.bounded ? s->box.min[p->along] : NAN;
    p->max = p->along != ALONG_R && s->box.bounded ? s->box.max[p->along] : NAN;
    if (json_number(s->doc, node, "min", isnan(p->min), &p->min, e) < 0 ||
        json_number(s->doc, node, "max", isnan(p->max), &p->max, e) < 0)
        return -1;
    if (!(p->min < p->max))
        return document_fail(s->doc, node, e, "min %.15g is not below max %.15g", p->min, p->max);
    p->bins = (size_t)bins;
    return 0;
}

/* Along bins a table runs over the bins' coordinate. */
static int compile_reference(struct scene *s, const cJSON *node, bool line, struct scene_profile *p,
                             struct error *e)
{
    static const char *const exact_keys[] = {"exact"};
    static const char *const line_keys[] = {"table", "fields", "along"};
    static const char *const bin_keys[] = {"table", "fields"};
    const cJSON *reference = json_get(node, "reference");
    struct scene_compare *c = &p->reference;
    if (!reference)
        return 0;
    c->node = reference;
    c->about = p->sample.about;
    c->along = p->along;
    c->table = json_get(reference, "table");
    if (!cJSON_IsObject(reference) || !c->table == !json_get(reference, "exact"))
        return document_fail(s->doc, reference, e,
                             "a profile's reference is an object with \"exact\" or \"table\"");
    if (!c->table) {
        c->params = document_rest(s->doc, reference, exact_keys, COUNT(exact_keys));
        return !c->params ? error_memory(e, "a reference", 0)
                          : json_string(s->doc, reference, "exact", true, &c->exact, e);
    }
    if ((line ? json_keys(s->doc, reference, line_keys, COUNT(line_keys), e)
              : json_keys(s->doc, reference, bin_keys, COUNT(bin_keys), e)) < 0 ||
        (line && scene_along(s, reference, &c->along, e) < 0))
        return -1;
    return compile_fields(s, reference, c, e);
}

static int compile_profile(struct scene *s, const cJSON *node, struct scene_profile *p,
                           struct error *e)
{
    static const char *const line_keys[] = {"name", "array",  "of",    "from",
                                            "to",   "points", "plain", "center",
                                            "axis", "every",  "steps", "reference"};
    static const char *const bin_keys[] = {"name",  "array", "of",       "along", "bins",
                                           "min",   "max",   "center",   "axis",  "where",
                                           "every", "steps", "reference"};
    const bool line = json_get(node, "from") || json_get(node, "to");
    p->node = node;
    if (cJSON_IsObject(node) && !line && !json_get(node, "along"))
        return document_fail(s->doc, node, e,
                             "a profile goes \"from\" a point \"to\" another, or \"along\" a "
                             "coordinate");
    if ((line ? json_keys(s->doc, node, line_keys, COUNT(line_keys), e)
              : json_keys(s->doc, node, bin_keys, COUNT(bin_keys), e)) < 0 ||
        json_string(s->doc, node, "name", true, &p->name, e) < 0 ||
        scene_sample(s, node, &p->sample, e) < 0 || scene_moments(s, node, false, &p->when, e) < 0)
        return -1;
    if ((line ? scene_line(s, node, &p->sample, e) : compile_bins(s, node, p, e)) < 0)
        return -1;
    return compile_reference(s, node, line, p, e);
}

int scene_profiles(struct scene *s, const cJSON *node, struct error *e)
{
    const cJSON *item;
    void *list = NULL;
    if (scene_list(s, node, "profiles", sizeof *s->profile, &list, e) < 0)
        return -1;
    s->profile = list;
    cJSON_ArrayForEach(item, node)
    {
        const struct scene_profile *p = &s->profile[s->n_profile];
        if (compile_profile(s, item, &s->profile[s->n_profile], e) < 0 ||
            check_name(s, item, "profile", p->name, NULL, e))
            return -1;
        for (size_t i = 0; i < s->n_profile; i++)
            if (check_name(s, item, "profile", p->name, s->profile[i].name, e))
                return -1;
        s->n_profile++;
    }
    return 0;
}
