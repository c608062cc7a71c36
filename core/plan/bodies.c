/* plan/bodies.c -- makes descriptors of the functions that a scene brings (see bodies.h): one property for all
 * the lists that name it, its access from the lists, its type and words from the scene or from whoever else
 * declares it. */
#include "plan/bodies.h"
#include "base/text.h"
#include "scene/functions.h"
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SETS (SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)

/* A body's lists as the ABI has them, by enum scene_list, and its parameters. */
struct lists {
    sph_device_value *value[LISTS], *param;
    uint32_t n_param;
};

/* One function's descriptor with all that it points to. */
struct made {
    const struct scene *scene;
    const struct registry *registry;
    const struct scene_function *from;
    sph_prop *prop;
    const cJSON **node; /* [n_prop]: who named it first */
    uint32_t n_prop;
    struct lists run, before, after;
    sph_item item;
    sph_device_body pair;
    sph_device_point point[3]; /* run, before, after */
    sph_function function;
};

static sph_status only_text(const sph_batch *b)
{
    return b->host->fail(b->host, SPH_E_INVALID, "the function has only a text, for devices");
}

static sph_list list_of(const void *data, size_t n, size_t stride)
{
    return (sph_list){n ? data : NULL, (uint32_t)n, (uint32_t)stride};
}

/* -- What others say of a property ----------------------------------------------------------- */

/* Among those that an item declares; one that it reads only is preferred: that says where it starts. */
static void look_in(const sph_list *props, const char *name, sph_prop *found, bool *read)
{
    for (uint32_t i = 0; i < props->count; i++) {
        const sph_prop *p = list_at(props, i);
        const bool reads = !(p->access & SETS);
        if (strcmp(p->name, name) != 0 || (found->type && (*read || !reads)))
            continue;
        *found = *p;
        *read = reads;
    }
}

static void look_in_scene(const struct scene *s, const char *name, sph_prop *found)
{
    static const sph_prop basic[] = {
        SPH_PROP("x", "m", "position", SPH_VECTOR, SPH_DST_READ, 0),
        SPH_PROP("h", "m", "smoothing length", SPH_SCALAR, SPH_DST_READ, NAN),
        SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_DST_READ, NAN),
    };
    for (size_t i = 0; !found->type && i < sizeof basic / sizeof *basic; i++)
        if (strcmp(basic[i].name, name) == 0)
            *found = basic[i];
    for (size_t f = 0; f < s->n_function; f++)
        for (size_t k = 0; k < s->function[f].n_property; k++) {
            const struct scene_property *p = &s->function[f].property[k];
            if (!found->type && p->type && strcmp(p->name, name) == 0)
                *found = (sph_prop)SPH_PROP(name, p->unit, p->doc, p->type, SPH_DST_WRITE, NAN);
        }
    for (size_t a = 0; a < s->n_array; a++)
        for (size_t k = 0; k < s->array[a].n_column; k++)
            if (!found->type && strcmp(s->array[a].column[k].name, name) == 0)
                *found = (sph_prop)SPH_PROP(name, "", "the scene's own", s->array[a].column[k].type,
                                            SPH_DST_READ, NAN);
}

/* type 0: nobody declares it. *read: `start` is where it begins. */
static sph_prop look_up(const struct made *m, const char *name, bool *read)
{
    sph_prop found = {0};
    *read = false;
    for (size_t i = 0; i < m->registry->n_entry; i++) {
        const struct entry *x = &m->registry->entry[i];
        if (x->kind == KIND_FUNCTION || x->kind == KIND_EOS)
            look_in(&x->item->props, name, &found, read);
        if (x->kind == KIND_EOS)
            look_in(&entry_eos(x)->inverse_props, name, &found, read);
    }
    look_in_scene(m->scene, name, &found);
    *read = found.type && !(found.access & SETS);
    return found;
}

static const struct scene_property *own_words(const struct scene_function *f, const char *name)
{
    for (size_t k = 0; k < f->n_property; k++)
        if (strcmp(f->property[k].name, name) == 0)
            return &f->property[k];
    return NULL;
}

/* -- Properties ------------------------------------------------------------------------------ */

/* What a list says of the access; `behind`: in "before" or "after" of a pair function. */
static uint32_t access_of(enum scene_list list, const sph_prop *p, bool behind)
{
    switch (list) {
    case LIST_I:
        return SPH_DST_READ | SPH_DST_SWEEP;
    case LIST_J:
        return SPH_SRC_READ;
    case LIST_SUM:
        return SPH_DST_SUM;
    case LIST_MIN:
        return SPH_DST_MIN;
    case LIST_MAX:
        return SPH_DST_MAX;
    /* Behind the pairs, what they and `before` set is there, and may be changed: it is a sum all the same. */
    case LIST_IN:
        return behind && (p->access & SETS) ? 0 : SPH_DST_READ;
    case LIST_OUT:
        return behind && (p->access & SETS) ? 0 : SPH_DST_WRITE;
    case LIST_INOUT:
        return behind && (p->access & SETS) ? 0 : SPH_DST_READ | SPH_DST_WRITE;
    case LISTS:
        break;
    }
    return 0;
}

/* The index of a property, which is new to the function or not. */
static uint32_t index_of(struct made *m, const struct scene_value *v)
{
    for (uint32_t i = 0; i < m->n_prop; i++)
        if (strcmp(m->prop[i].name, v->property) == 0)
            return i;
    m->prop[m->n_prop].name = v->property;
    m->node[m->n_prop] = v->node;
    return m->n_prop++;
}

static int add_values(struct made *m, const struct scene_body *b, struct lists *out, bool behind,
                      struct error *e)
{
    for (int l = 0; b->node && l < LISTS; l++) {
        out->value[l] = calloc(b->n_value[l] + 1, sizeof *out->value[l]);
        if (!out->value[l])
            return error_memory(e, "a function of the scene", b->n_value[l]);
        for (size_t k = 0; k < b->n_value[l]; k++) {
            const uint32_t i = index_of(m, &b->value[l][k]);
            sph_prop *p = &m->prop[i];
            /* What more than the sweep touches is no longer for the sweep alone. */
            if (l != LIST_I && l != LIST_J)
                p->access &= ~SPH_DST_SWEEP;
            p->access |= access_of((enum scene_list)l, p, behind);
            out->value[l][k] = (sph_device_value){b->value[l][k].name, i, 0};
        }
    }
    out->param = calloc(m->from->n_param + 1, sizeof *out->param);
    if (!out->param)
        return error_memory(e, "a function of the scene", m->from->n_param);
    for (size_t k = 0; b->node && k < m->from->n_param; k++)
        if (scene_body_uses(b, m->from->param[k].name))
            out->param[out->n_param++] = (sph_device_value){m->from->param[k].name, (uint32_t)k, 0};
    return 0;
}

static double start_of(const sph_prop *p, const sph_prop *known, bool read)
{
    return p->access & SPH_DST_MIN   ? INFINITY
           : p->access & SPH_DST_MAX ? -INFINITY
           : p->access & SETS        ? 0
           : known->type && read     ? known->start
                                     : NAN;
}

/* Type, unit, words and start of property i. */
static int describe(struct made *m, uint32_t i, struct error *e)
{
    const struct document *d = m->scene->doc;
    sph_prop *p = &m->prop[i];
    const struct scene_property *own = own_words(m->from, p->name);
    bool read;
    const sph_prop known = look_up(m, p->name, &read);
    if (own && own->type && known.type && own->type != known.type)
        return document_fail(d, own->node, e,
                             "\"%s\" is declared by others already, and is of another type there",
                             p->name);
    p->type = own && own->type ? own->type : known.type;
    if (!p->type)
        return document_fail(d, m->node[i], e,
                             "no plugin that is loaded declares \"%s\": give its type, "
                             "\"properties\": {\"%s\": \"scalar\"}",
                             p->name, p->name);
    p->unit = own && own->unit ? own->unit : known.unit ? known.unit : "";
    p->doc = own && own->doc ? own->doc : known.doc ? known.doc : "";
    p->start = own && !isinf(own->start) ? own->start : start_of(p, &known, read);
    if ((p->access & SPH_DST_SWEEP) && (p->access & (SETS)))
        p->access &= ~SPH_DST_SWEEP;
    if (own && own->work)
        p->access |= SPH_WORK;
    return 0;
}

static void set_types(struct lists *out, const struct scene_body *b, const sph_prop *prop)
{
    for (int l = 0; b->node && l < LISTS; l++)
        for (size_t k = 0; k < b->n_value[l]; k++)
            out->value[l][k].type = prop[out->value[l][k].index].type;
}

static int make_props(struct made *m, struct error *e)
{
    const struct scene_function *f = m->from;
    const struct scene_body *const bodies[] = {&f->run, &f->before, &f->after};
    struct lists *const lists[] = {&m->run, &m->before, &m->after};
    size_t most = 1;
    for (int b = 0; b < 3; b++)
        for (int l = 0; l < LISTS; l++)
            most += bodies[b]->n_value[l];
    m->prop = calloc(most, sizeof *m->prop);
    m->node = calloc(most, sizeof *m->node);
    if (!m->prop || !m->node)
        return error_memory(e, "a function of the scene", most * sizeof *m->prop);
    for (int b = 0; b < 3; b++)
        if (add_values(m, bodies[b], lists[b], b > 0, e))
            return -1;
    for (uint32_t i = 0; i < m->n_prop; i++)
        if (describe(m, i, e))
            return -1;
    for (int b = 0; b < 3; b++)
        set_types(lists[b], bodies[b], m->prop);
    return 0;
}

/* -- Descriptors ----------------------------------------------------------------------------- */

static sph_list values(const struct scene_body *b, const struct lists *l, enum scene_list list)
{
    return list_of(l->value[list], b->n_value[list], sizeof(sph_device_value));
}

static void make_pair(struct made *m)
{
    const struct scene_function *f = m->from;
    const struct scene_body *b = &f->run;
    m->pair = (sph_device_body){
        .size = (uint32_t)sizeof m->pair,
        .reach = f->reach,
        .self = f->self,
        .text = b->text,
        .file = b->file,
        .prelude = b->prelude,
        .prelude_file = b->prelude_file,
        .i = values(b, &m->run, LIST_I),
        .j = values(b, &m->run, LIST_J),
        .sum = values(b, &m->run, LIST_SUM),
        .min = values(b, &m->run, LIST_MIN),
        .max = values(b, &m->run, LIST_MAX),
        .param = list_of(m->run.param, m->run.n_param, sizeof(sph_device_value)),
    };
}

/* Sums of a function of one particle are read and added to. */
static void make_point(sph_device_point *out, const struct scene_body *b, const struct lists *l,
                       bool pair)
{
    const bool sums = b->n_value[LIST_SUM] > 0;
    if (!b->node)
        return;
    *out = (sph_device_point){
        .size = (uint32_t)sizeof *out,
        .h = pair && scene_body_uses(b, "h"),
        .text = b->text,
        .file = b->file,
        .prelude = b->prelude,
        .prelude_file = b->prelude_file,
        .in = values(b, l, LIST_IN),
        .out = values(b, l, LIST_OUT),
        .inout = values(b, l, sums ? LIST_SUM : LIST_INOUT),
        .param = list_of(l->param, l->n_param, sizeof(sph_device_value)),
        .fail = list_of(b->fail, b->n_fail, sizeof *b->fail),
    };
}

/* "inout" and "sum" of a body of one particle as one list, the latter's. */
static int join_sums(const struct scene_body *b, struct lists *l, struct error *e)
{
    const size_t n = b->n_value[LIST_SUM], m = b->n_value[LIST_INOUT];
    sph_device_value *both = calloc(n + m + 1, sizeof *both);
    if (!both)
        return error_memory(e, "a function of the scene", n + m);
    memcpy(both, l->value[LIST_SUM], n * sizeof *both);
    memcpy(both + n, l->value[LIST_INOUT], m * sizeof *both);
    free(l->value[LIST_SUM]);
    l->value[LIST_SUM] = both;
    return 0;
}

static int make_function(struct made *m, struct error *e)
{
    const struct scene_function *f = m->from;
    const bool pair = f->shape == SPH_PAIR;
    if (make_props(m, e))
        return -1;
    m->item = (sph_item){.size = (uint32_t)sizeof m->item,
                         .dims = f->dims,
                         .name = f->name,
                         .doc = f->doc,
                         .source = f->source,
                         .params = list_of(f->param, f->n_param, sizeof *f->param),
                         .props = list_of(m->prop, m->n_prop, sizeof *m->prop)};
    m->function = (sph_function){
        .size = (uint32_t)sizeof m->function,
        .shape = f->shape,
        .item = &m->item,
        .run = only_text,
        .before = f->before.node ? only_text : NULL,
        .after = f->after.node ? only_text : NULL,
        .reach = f->reach,
        .reach_scale = f->reach_scale,
        .reals = f->reals,
        .rates = list_of(f->rate, f->n_rate, sizeof *f->rate),
        .reductions = list_of(f->reduction, f->n_reduction, sizeof *f->reduction),
        .device = pair ? &m->pair : NULL,
        .device_run = pair ? NULL : &m->point[0],
        .device_before = f->before.node ? &m->point[1] : NULL,
        .device_after = f->after.node ? &m->point[2] : NULL,
    };
    if (pair)
        make_pair(m);
    else if (join_sums(&f->run, &m->run, e))
        return -1;
    if (!pair)
        make_point(&m->point[0], &f->run, &m->run, false);
    make_point(&m->point[1], &f->before, &m->before, true);
    make_point(&m->point[2], &f->after, &m->after, true);
    if (!pair)
        m->point[0].inout.count = (uint32_t)(f->run.n_value[LIST_SUM] + f->run.n_value[LIST_INOUT]);
    return 0;
}

static void lists_free(struct lists *l)
{
    for (int k = 0; k < LISTS; k++)
        free(l->value[k]);
    free(l->param);
}

static void made_free(struct made *m)
{
    lists_free(&m->run);
    lists_free(&m->before);
    lists_free(&m->after);
    free(m->prop);
    free(m->node);
}

/* -- All of a scene -------------------------------------------------------------------------- */

/* FNV-1a, 64 bits, of all texts: a run that goes on from a checkpoint wants the same. */
static void hash(uint64_t *h, const char *text)
{
    for (; text && *text; text++)
        *h = (*h ^ (unsigned char)*text) * 0x100000001b3u;
    *h = (*h ^ 0xffu) * 0x100000001b3u;
}

static void version_of(const struct scene *s, char out[32])
{
    uint64_t h = 0xcbf29ce484222325u;
    for (size_t i = 0; i < s->n_function; i++) {
        const struct scene_function *f = &s->function[i];
        const struct scene_body *const bodies[] = {&f->run, &f->before, &f->after};
        for (int b = 0; b < 3; b++) {
            hash(&h, bodies[b]->text);
            hash(&h, bodies[b]->prelude);
        }
    }
    snprintf(out, 32, "text-%016" PRIx64, h);
}

static int add_all(struct registry *r, const struct scene *s, struct made *made,
                   const sph_function **function, struct error *e)
{
    char version[32];
    const struct registry_texts texts = {.name = BODIES_PLUGIN,
                                         .version = version,
                                         .doc = "functions that the scene brings",
                                         .path = s->doc->path,
                                         .function = function,
                                         .n = s->n_function};
    struct error why = {0};
    size_t failed;
    version_of(s, version);
    for (size_t i = 0; i < s->n_function; i++) {
        made[i] = (struct made){.scene = s, .registry = r, .from = &s->function[i]};
        function[i] = &made[i].function;
        if (make_function(&made[i], e))
            return -1;
    }
    if (!registry_add_texts(r, &texts, &failed, &why))
        return 0;
    const cJSON *all = json_get(s->doc->root, "functions");
    return document_fail(s->doc, failed < s->n_function ? s->function[failed].node : all, e, "%s",
                         why.text);
}

int bodies_register(struct registry *r, const struct scene *s, struct error *e)
{
    if (s->n_function == 0)
        return 0;
    struct made *made = calloc(s->n_function, sizeof *made);
    const sph_function **function = calloc(s->n_function, sizeof *function);
    int status = made && function ? add_all(r, s, made, function, e)
                                  : error_memory(e, "functions of the scene", s->n_function);
    for (size_t i = 0; made && i < s->n_function; i++)
        made_free(&made[i]);
    free(made);
    free((void *)function);
    return status;
}

/* -- In a plan ------------------------------------------------------------------------------- */

static bool has_text(const struct pass *p)
{
    return p->use.entry && p->use.entry->text;
}

/* The edit that put the pass there. */
static const cJSON *node_of(const struct plan *plan, const struct pass *p)
{
    for (size_t k = 0; k < plan->n_step; k++)
        if (plan->step[k].node && strcmp(plan->step[k].name, p->step) == 0)
            return plan->step[k].node;
    return plan->scene->scheme.node;
}

bool bodies_any(const struct plan *plan)
{
    for (size_t i = 0; i < plan->n_pass; i++)
        if (has_text(&plan->pass[i]))
            return true;
    return false;
}

int bodies_fit(const struct plan *plan, struct error *e)
{
    char why[512];
    for (size_t i = 0; bodies_any(plan) && i < plan->n_pass; i++) {
        const struct pass *p = &plan->pass[i];
        if (!pass_on_device(plan, p, why, sizeof why))
            return document_fail(plan->scene->doc, node_of(plan, p), e,
                                 "%s, but functions of the scene have only a text, for devices: "
                                 "make them a plugin with sph new-plugin NAME --from %s",
                                 why, plan->scene->doc->path);
    }
    return 0;
}

/* Whether the sentence begins with the file's name. */
static bool is_about(const struct error *e, const char *file)
{
    const size_t n = file ? strlen(file) : 0;
    return n && strncmp(e->text, file, n) == 0 && e->text[n] == ':';
}

void bodies_blame(const struct plan *plan, struct error *e)
{
    for (size_t i = 0; e->exit_code == EXIT_REFUSED && i < plan->scene->n_function; i++) {
        const struct scene_function *f = &plan->scene->function[i];
        const struct scene_body *const bodies[] = {&f->run, &f->before, &f->after};
        for (int b = 0; b < 3; b++)
            if (is_about(e, bodies[b]->file) || is_about(e, bodies[b]->prelude_file))
                e->exit_code = EXIT_USAGE;
    }
}

int bodies_need_device(const struct plan *plan, struct error *e)
{
    for (size_t i = 0; !plan->on_device && i < plan->n_pass; i++) {
        const struct pass *p = &plan->pass[i];
        if (has_text(p))
            return document_fail(
                plan->scene->doc, node_of(plan, p), e,
                "function \"%s\" of the scene has only a text: run with --device opencl, or make "
                "it a plugin with sph new-plugin NAME --from %s:%s",
                p->use.item->name, plan->scene->doc->path, p->use.item->name);
    }
    return 0;
}
