/* plan/measures.c -- what a scene wants measured, held against its arrays and the registry: exact solutions,
 * tables, names of properties. Everything that can be wrong with it is told before the run. */
#include "base/text.h"
#include "plan/inside.h"
#include "plan/measured.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct plan_array *array_named(const struct plan *plan, const char *name)
{
    for (size_t a = 0; a < plan->n_array; a++)
        if (strcmp(plan->array[a].p.name, name) == 0)
            return &plan->array[a];
    return NULL;
}

static int check_property(const struct plan *plan, const struct plan_array *a, const char *of,
                          const cJSON *node, struct error *e)
{
    const struct particles *p = &a->p;
    struct measured m;
    bool component;
    const char *name[128];
    char near[512];
    size_t n = 0;
    if (measured_find(p, of, &m, &component) == 0)
        return 0;
    if (component) {
        const struct column *c = &p->column[m.column];
        const char *has = c->type == SPH_VECTOR ? (const char *const[]){"", "x, r", "x, y, r, phi",
                                                                        "x, y, z, r, phi"}[p->dim]
                          : c->ncomp > 1        ? "0, 1, ..."
                                                : "none";
        return document_fail(plan->scene->doc, node, e,
                             "array \"%s\" has no property \"%s\": components of \"%s\" are %s",
                             p->name, of, c->name, has);
    }
    for (size_t c = 0; c < p->n_column && n < 128; c++)
        if (p->column[c].output)
            name[n++] = p->column[c].name;
    return document_fail(plan->scene->doc, node, e, "array \"%s\" has no property \"%s\"%s",
                         p->name, of, text_suggest(near, sizeof near, of, name, n));
}

/* Of a list of names, or of a bare one: the JSON of the i-th. */
static const cJSON *name_node(const cJSON *object, const char *key, size_t i)
{
    const cJSON *list = json_get(object, key);
    return cJSON_IsArray(list) || cJSON_IsObject(list) ? cJSON_GetArrayItem(list, (int)i) : list;
}

/* -- Tables ------------------------------------------------------------------------------------ */

static int check_rises(const struct plan *plan, const struct table *t, size_t column,
                       const cJSON *node, struct error *e)
{
    const double *x = t->column[column].value;
    for (size_t i = 1; i < t->n; i++)
        if (!(x[i] > x[i - 1]))
            return document_fail(plan->scene->doc, node, e,
                                 "column \"%s\" of the table does not rise: %.15g, %.15g in rows "
                                 "%zu, %zu",
                                 t->column[column].name, x[i - 1], x[i], i, i + 1);
    return 0;
}

static int find_column(const struct plan *plan, const struct table *t, const char *name,
                       const cJSON *node, struct error *e)
{
    const char *known[128];
    char near[512];
    size_t n = 0;
    if (table_find(t, name) >= 0)
        return 0;
    for (; n < t->n_column && n < 128; n++)
        known[n] = t->column[n].name;
    return document_fail(plan->scene->doc, node, e, "the table has no column \"%s\"%s", name,
                         text_suggest(near, sizeof near, name, known, n));
}

size_t plan_table_along(const struct table *t, enum along along)
{
    static const char *const names[] = {"x", "y", "z", "r"};
    const int named = table_find(t, names[along]);
    return named < 0 ? 0 : (size_t)named;
}

/* The table, its rows in order, with the columns that the scene names. */
static int load_table(struct plan *plan, const struct scene_compare *c, struct table *t,
                      struct error *e)
{
    if (plan_table(t, plan->scene->doc, c->table, e) ||
        check_rises(plan, t, plan_table_along(t, c->along), c->table, e))
        return -1;
    for (size_t k = 0; k < c->n_fields; k++)
        if (find_column(plan, t, c->columns[k], name_node(c->node, "fields", k), e))
            return -1;
    return 0;
}

static int bind_table(struct plan *plan, size_t i, const struct plan_array *a, struct error *e)
{
    const struct scene_compare *c = &plan->scene->compare[i];
    struct table *t = &plan->compare_table[i];
    struct measured m;
    bool component;
    size_t known = c->n_fields;
    if (load_table(plan, c, t, e))
        return -1;
    const size_t along = plan_table_along(t, c->along);
    for (size_t k = 0; !c->n_fields && k < t->n_column; k++)
        known += k != along && measured_find(&a->p, t->column[k].name, &m, &component) == 0;
    if (known == 0)
        return document_fail(plan->scene->doc, c->table, e,
                             "no column of the table is called like a property of \"%s\": say "
                             "which is which by \"fields\": {\"rho\": \"COLUMN\"}",
                             c->array);
    return 0;
}

/* -- Comparisons ------------------------------------------------------------------------------- */

static int bind_exact(struct plan *plan, const struct scene_compare *c, struct use *u,
                      struct error *e)
{
    const struct scene *s = plan->scene;
    const struct entry *entry = registry_find(plan->registry, KIND_EXACT, c->exact);
    if (!entry)
        return plan_unknown(plan, c->node, KIND_EXACT, c->exact, e);
    const sph_exact *x = entry_exact(entry);
    if (!(x->item->dims & (1u << plan->dim)))
        return document_fail(s->doc, c->node, e,
                             "the exact solution \"%s\" is not for %d dimensions", c->exact,
                             plan->dim);
    if (use_init(u, entry, x->item, x->life, e))
        return -1;
    if (use_set_all(u, s->doc, c->params, e))
        return -1;
    struct error why = {0};
    if (use_create(u, plan->registry, plan->dim, &why))
        return document_fail(s->doc, c->node, e, "%s", why.text);
    return 0;
}

/* That the solution gives each of the fields, or the components of it. */
static int check_exact_fields(const struct plan *plan, size_t i, const struct plan_array *a,
                              struct error *e)
{
    const struct scene_compare *c = &plan->scene->compare[i];
    const sph_item *item = plan->exact[i].item;
    for (size_t k = 0; k < c->n_fields; k++) {
        const cJSON *node = name_node(c->node, "fields", k);
        const char *name[64];
        char near[512];
        struct measured m;
        bool missing, known = false;
        size_t n = 0;
        if (check_property(plan, a, c->fields[k], node, e))
            return -1;
        measured_find(&a->p, c->fields[k], &m, &missing);
        for (uint32_t q = 0; q < item->props.count && n < 64; q++) {
            const sph_prop *prop = list_at(&item->props, q);
            if (!(prop->access & SPH_DST_WRITE))
                continue;
            name[n++] = prop->name;
            known = known || strcmp(prop->name, a->p.column[m.column].name) == 0;
        }
        if (!known || m.kind == MEASURED_RADIAL || m.kind == MEASURED_AZIMUTHAL)
            return document_fail(
                plan->scene->doc, node, e, "the exact solution \"%s\" does not give \"%s\"%s",
                c->exact, c->fields[k], text_suggest(near, sizeof near, c->fields[k], name, n));
    }
    return 0;
}

static int bind_compare(struct plan *plan, size_t i, struct error *e)
{
    const struct scene_compare *c = &plan->scene->compare[i];
    const struct plan_array *a = array_named(plan, c->array);
    if (!a)
        return document_fail(plan->scene->doc, c->node, e, "there is no particle array \"%s\"",
                             c->array);
    if (!c->table)
        return bind_exact(plan, c, &plan->exact[i], e) ? -1 : check_exact_fields(plan, i, a, e);
    if (bind_table(plan, i, a, e))
        return -1;
    for (size_t k = 0; k < c->n_fields; k++)
        if (check_property(plan, a, c->fields[k], name_node(c->node, "fields", k), e))
            return -1;
    return 0;
}

/* -- Probes and profiles ----------------------------------------------------------------------- */

static int check_sample(const struct plan *plan, const cJSON *node, const struct scene_sample *s,
                        bool by_kernel, struct error *e)
{
    for (size_t i = 0; i < s->n_array; i++) {
        const struct plan_array *a = array_named(plan, s->array[i]);
        if (particles_find(&a->p, "rho") < 0)
            return document_fail(plan->scene->doc, name_node(node, "array", i), e,
                                 "array \"%s\" has no density \"rho\", of which its particles' "
                                 "volumes are made",
                                 s->array[i]);
        for (size_t k = 0; k < s->n_of; k++)
            if (check_property(plan, a, s->of[k], name_node(node, "of", k), e))
                return -1;
    }
    if (by_kernel && !plan->has_kernel)
        return document_fail(
            plan->scene->doc, node, e,
            "values at points are interpolated by the kernel: name one (\"kernel\")");
    return 0;
}

static int bind_reference(struct plan *plan, size_t i, struct error *e)
{
    const struct scene_probe *p = &plan->scene->probe[i];
    const struct scene_reference *q = &p->reference;
    const cJSON *node = json_get(p->node, "reference");
    struct table *t = &plan->probe_table[i];
    bool known = !q->of || p->kind != PROBE_POINTS;
    for (size_t k = 0; !known && k < p->sample.n_of; k++)
        known = strcmp(q->of, p->sample.of[k]) == 0;
    if (!known || (q->of && p->kind != PROBE_POINTS && strcmp(q->of, p->of) != 0))
        return document_fail(plan->scene->doc, json_get(node, "of"), e,
                             "the probe does not measure \"%s\"", q->of);
    if (plan_table(t, plan->scene->doc, q->table, e))
        return -1;
    if ((q->time && find_column(plan, t, q->time, json_get(node, "time"), e)) ||
        (q->value && find_column(plan, t, q->value, json_get(node, "value"), e)))
        return -1;
    if (!q->value && t->n_column < 2)
        return document_fail(plan->scene->doc, q->table, e,
                             "the table has one column; a course in time has two");
    return check_rises(plan, t, q->time ? (size_t)table_find(t, q->time) : 0, q->table, e);
}

static int bind_probe(struct plan *plan, size_t i, struct error *e)
{
    const struct scene_probe *p = &plan->scene->probe[i];
    if (p->kind == PROBE_POINTS) {
        if (check_sample(plan, p->node, &p->sample, true, e))
            return -1;
    } else {
        const struct plan_array *a = array_named(plan, p->array);
        if (!a)
            return document_fail(plan->scene->doc, p->node, e, "there is no particle array \"%s\"",
                                 p->array);
        if (check_property(plan, a, p->of, p->node, e))
            return -1;
    }
    return p->reference.table ? bind_reference(plan, i, e) : 0;
}

/* Of an exact solution components are known, of a table only what is called so. */
bool plan_profile_gives(const struct plan *plan, size_t i, size_t k, size_t *column)
{
    const struct scene_profile *p = &plan->scene->profile[i];
    const struct scene_compare *c = &p->reference;
    const char *of = p->sample.of[k], *name = c->n_fields ? NULL : of;
    if (!c->node)
        return false;
    for (size_t q = 0; c->table && q < c->n_fields; q++)
        if (strcmp(c->fields[q], of) == 0)
            name = c->columns[q];
    const int found = c->table && name ? table_find(&plan->profile_table[i], name) : -1;
    *column = found < 0 ? 0 : (size_t)found;
    bool given = found >= 0;
    for (uint32_t q = 0; !c->table && q < plan->profile_exact[i].item->props.count; q++) {
        const sph_prop *prop = list_at(&plan->profile_exact[i].item->props, q);
        const size_t n = strlen(prop->name);
        given = given || ((prop->access & SPH_DST_WRITE) && strncmp(of, prop->name, n) == 0 &&
                          (of[n] == '\0' || of[n] == '.'));
    }
    return given;
}

static int bind_profile_reference(struct plan *plan, size_t i, struct error *e)
{
    const struct scene_profile *p = &plan->scene->profile[i];
    const struct scene_compare *c = &p->reference;
    size_t column, known = 0;
    if (!c->node)
        return 0;
    if (c->table ? load_table(plan, c, &plan->profile_table[i], e)
                 : bind_exact(plan, c, &plan->profile_exact[i], e))
        return -1;
    for (size_t k = 0; k < c->n_fields; k++) {
        bool wanted = false;
        for (size_t q = 0; q < p->sample.n_of; q++)
            wanted = wanted || strcmp(p->sample.of[q], c->fields[k]) == 0;
        if (!wanted)
            return document_fail(plan->scene->doc, name_node(c->node, "fields", k), e,
                                 "the profile is not of \"%s\"", c->fields[k]);
    }
    const sph_item *item = plan->profile_exact[i].item;
    for (uint32_t q = 0; item && q < item->props.count; q++) {
        const sph_prop *prop = list_at(&item->props, q);
        if (!(prop->access & SPH_DST_WRITE) && strcmp(prop->name, "x") != 0)
            return document_fail(plan->scene->doc, c->node, e,
                                 "the exact solution \"%s\" needs \"%s\" of particles; a profile "
                                 "has places alone",
                                 c->exact, prop->name);
    }
    for (size_t k = 0; k < p->sample.n_of; k++)
        known += plan_profile_gives(plan, i, k, &column);
    if (known == 0)
        return document_fail(plan->scene->doc, c->node, e,
                             "the reference gives nothing that the profile is \"of\"");
    return 0;
}

/* -- All --------------------------------------------------------------------------------------- */

int asked_bind(struct plan *plan, struct error *e)
{
    const struct scene *s = plan->scene;
    plan->exact = calloc(s->n_compare + 1, sizeof *plan->exact);
    plan->compare_table = calloc(s->n_compare + 1, sizeof *plan->compare_table);
    plan->probe_table = calloc(s->n_probe + 1, sizeof *plan->probe_table);
    plan->profile_exact = calloc(s->n_profile + 1, sizeof *plan->profile_exact);
    plan->profile_table = calloc(s->n_profile + 1, sizeof *plan->profile_table);
    if (!plan->exact || !plan->compare_table || !plan->probe_table || !plan->profile_exact ||
        !plan->profile_table)
        return error_memory(e, "the plan", s->n_compare * sizeof *plan->exact);
    for (size_t i = 0; i < s->n_compare; i++)
        if (bind_compare(plan, i, e))
            return -1;
    for (size_t i = 0; i < s->n_probe; i++)
        if (bind_probe(plan, i, e))
            return -1;
    for (size_t i = 0; i < s->n_profile; i++)
        if (check_sample(plan, s->profile[i].node, &s->profile[i].sample, s->profile[i].bins == 0,
                         e) ||
            bind_profile_reference(plan, i, e))
            return -1;
    return 0;
}

void asked_free(struct plan *plan)
{
    for (size_t i = 0; plan->exact && i < plan->scene->n_compare; i++)
        if (plan->exact[i].item)
            use_fini(&plan->exact[i], plan->registry);
    for (size_t i = 0; plan->compare_table && i < plan->scene->n_compare; i++)
        table_free(&plan->compare_table[i]);
    for (size_t i = 0; plan->probe_table && i < plan->scene->n_probe; i++)
        table_free(&plan->probe_table[i]);
    for (size_t i = 0; plan->profile_exact && i < plan->scene->n_profile; i++)
        if (plan->profile_exact[i].item)
            use_fini(&plan->profile_exact[i], plan->registry);
    for (size_t i = 0; plan->profile_table && i < plan->scene->n_profile; i++)
        table_free(&plan->profile_table[i]);
    free(plan->profile_exact);
    free(plan->profile_table);
    free(plan->exact);
    free(plan->compare_table);
    free(plan->probe_table);
}
