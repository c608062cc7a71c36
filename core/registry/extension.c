/* registry/extension.c -- the host's extensions (see extension.h). What a plugin declares through them
 * is checked and copied beside the item's entry. */
#include "registry/extension.h"

#include "registry/check.h"
#include "registry/copy.h"

#include <math.h>
#include <string.h>

/* -- Of a configuration or a run -------- */

static const sph_table *tables_get(const sph_config *config, const char *param)
{
    const sph_param *p;

    if (!config || !param || !config->table)
        return NULL;
    p = config->item->params.data;
    for (uint32_t i = 0; i < config->item->params.count; i++)
        if (p[i].type == SPH_PARAM_TABLE && strcmp(p[i].name, param) == 0)
            return config->table[i];
    return NULL;
}

static double reductions_value(const sph_batch *b, const char *function, const char *name)
{
    if (!b || !b->run || !function || !name)
        return NAN;
    return b->run->reduction(b->run, function, name);
}

static sph_status time_step_propose(const sph_batch *b, double dt)
{
    if (!b || !b->run || !(dt > 0))
        return SPH_E_INVALID;
    b->run->propose(b->run, dt);
    return SPH_OK;
}

/* -- Of an item -------- */

struct entry *extension_own(struct registry *r, enum kind kind, const char *name, struct error *e)
{
    for (size_t i = 0; check_is_name(name) && i < r->n_entry; i++) {
        struct entry *x = &r->entry[i];
        if (x->kind == kind && x->plugin == r->n_plugin && strcmp(x->item->name, name) == 0)
            return x;
    }
    error_set(e, EXIT_REFUSED, "%s \"%s\" is not registered by this plugin", kind_label[kind],
              check_is_name(name) ? name : "?");
    return NULL;
}

static int check_count(const sph_function *f, const char *field, const char *name, struct error *e)
{
    const sph_prop *p;

    if (!name)
        return 0;
    p = check_is_word(name, false) ? check_find_prop(&f->item->props, name) : NULL;
    if (!p || p->type != SPH_INT32 || !(p->access & SPH_DST_WRITE))
        return error_set(e, EXIT_REFUSED, "%s is \"%s\", which is not declared as a written int32",
                         field, check_is_word(name, false) ? name : "?");
    return 0;
}

static int check_born(const sph_list *props, struct error *e)
{
    const sph_prop *p = props->data;

    if (check_props(props, "born_props", e))
        return -1;
    for (uint32_t i = 0; i < props->count; i++)
        if (p[i].access & SPH_SRC_READ)
            return error_set(e, EXIT_REFUSED,
                             "born_props: \"%s\" is read of sources, but new "
                             "particles have none",
                             p[i].name);
    return 0;
}

static int declare_population(struct registry *r, const char *function, const sph_population *in,
                              struct error *e)
{
    struct entry *x = extension_own(r, KIND_FUNCTION, function, e);
    const sph_population *p;

    if (!x)
        return -1;
    p = in ? copy_population(&x->memory, in, e)
           : (error_set(e, EXIT_REFUSED, "the descriptor is NULL"), NULL);
    if (!p)
        return error_prefix(e, "population of \"%s\"", function);
    if (!p->remove && !p->create)
        error_set(e, EXIT_REFUSED, "neither remove nor create names a property");
    else if (p->born && !p->create)
        error_set(e, EXIT_REFUSED, "born is set, but create names no property");
    else if (!check_count(entry_function(x), "remove", p->remove, e) &&
             !check_count(entry_function(x), "create", p->create, e) &&
             !check_born(&p->born_props, e)) {
        x->population = p;
        return 0;
    }
    return error_prefix(e, "population of \"%s\"", function);
}

static int declare_state(struct registry *r, enum kind kind, const char *name, const sph_state *in,
                         struct error *e)
{
    struct entry *x = extension_own(r, kind, name, e);
    const sph_state *s;

    if (!x)
        return -1;
    s = in ? copy_state(&x->memory, in, e)
           : (error_set(e, EXIT_REFUSED, "the descriptor is NULL"), NULL);
    if (!s)
        return error_prefix(e, "state of \"%s\"", name);
    if (!entry_life(x) || !entry_life(x)->create)
        error_set(e, EXIT_REFUSED, "the item has no life, so no state");
    else if (!s->save || !s->restore)
        error_set(e, EXIT_REFUSED, "%s is NULL", s->save ? "restore" : "save");
    else {
        x->state = s;
        return 0;
    }
    return error_prefix(e, "state of \"%s\"", name);
}

static sph_status population_declare(const sph_host *host, const char *function,
                                     const sph_population *p)
{
    struct registry *r = host ? host->context : NULL;
    struct error e = {0};

    if (!r || !registry_is_loading(r))
        return SPH_E_INVALID;
    return declare_population(r, function, p, &e) ? registry_refuse(r, &e) : SPH_OK;
}

static sph_status state_declare(const sph_host *host, const char *kind, const char *name,
                                const sph_state *s)
{
    struct registry *r = host ? host->context : NULL;
    struct error e = {0};

    if (!r || !registry_is_loading(r))
        return SPH_E_INVALID;
    for (int k = 0; check_is_text(kind) && k < KIND_COUNT; k++)
        if (strcmp(kind, kind_id[k]) == 0)
            return declare_state(r, (enum kind)k, name, s, &e) ? registry_refuse(r, &e) : SPH_OK;
    error_set(&e, EXIT_REFUSED, "state: kind \"%.64s\" is unknown to this sph",
              check_is_text(kind) ? kind : "?");
    return registry_refuse(r, &e);
}

static sph_status fusion_say(const sph_host *host, const sph_fusion *f)
{
    struct registry *r = host ? host->context : NULL;
    struct error e = {0};

    if (!r || !registry_is_loading(r))
        return SPH_E_INVALID;
    return fusion_declare(r, f, &e) ? registry_refuse(r, &e) : SPH_OK;
}

/* -- By id -------- */

static const sph_fusions fusions = {sizeof fusions, 0, fusion_say};
static const sph_tables tables = {sizeof tables, 0, tables_get};
static const sph_reductions reductions = {sizeof reductions, 0, reductions_value};
static const sph_time_step time_step = {sizeof time_step, 0, time_step_propose};
static const sph_population_ext population = {sizeof population, 0, population_declare};
static const sph_state_ext state = {sizeof state, 0, state_declare};

const struct extension extension[] = {
    {SPH_EXT_FUSION, "functions that share a sweep over the neighbours", &fusions},
    {SPH_EXT_POPULATION, "functions that remove and create particles", &population},
    {SPH_EXT_REDUCTIONS, "global sums, minima and maxima, for other functions", &reductions},
    {SPH_EXT_STATE, "an item's own state in a checkpoint", &state},
    {SPH_EXT_TABLES, "tables of numbers as parameters", &tables},
    {SPH_EXT_TIME_STEP, "bounds on the time step that no property holds", &time_step}};
const size_t n_extension = sizeof extension / sizeof *extension;

const void *extension_find(const char *id)
{
    for (size_t i = 0; id && i < n_extension; i++)
        if (strcmp(id, extension[i].id) == 0)
            return extension[i].table;
    return NULL;
}
