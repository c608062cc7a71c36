/* scene/scene.c -- a document as a scene: the parts at the top, and what all parts use. The
 * particles are in scene_particles.c and scene_fill.c, the recipe in scene_scheme.c, time and
 * results in scene_output.c. Touches the document and its own memory; loads nothing, resolves no
 * name of a plugin. */
#include "scene/scene.h"
#include "base/text.h"
#include "scene/expression.h"
#include "scene/scene_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pieces of memory and shapes, freed together. */
struct scene_memory {
    struct scene_memory *next;
    struct shape *shape;
    void *piece;
};

static struct scene_memory *remember(struct scene *s, void *piece, struct shape *shape)
{
    struct scene_memory *m = calloc(1, sizeof *m);
    if (m) {
        *m = (struct scene_memory){s->memory, shape, piece};
        s->memory = m;
    }
    return m;
}

void *scene_alloc(struct scene *s, size_t n, size_t size, struct error *e)
{
    void *piece = calloc(n ? n : 1, size);
    if (!piece || !remember(s, piece, NULL)) {
        free(piece);
        error_memory(e, "the scene", n * size);
        return NULL;
    }
    return piece;
}

int scene_shape(struct scene *s, const cJSON *node, struct shape **out, struct error *e)
{
    if (shape_compile(out, s->doc, node, s->dim, e) < 0)
        return -1;
    if (remember(s, NULL, *out))
        return 0;
    shape_free(*out);
    *out = NULL;
    return error_memory(e, "a shape", 0);
}

void scene_free(struct scene *s)
{
    while (s->memory) {
        struct scene_memory *m = s->memory;
        s->memory = m->next;
        shape_free(m->shape);
        free(m->piece);
        free(m);
    }
    *s = (struct scene){0};
}

/* -- Variables and expressions --------------------------------------------------------------- */

const char *const scene_variables[SCENE_VARIABLES] = {"x", "y", "z", "r", "spacing"};

void scene_values(const double *x, int dim, double spacing, double values[SCENE_VARIABLES])
{
    for (int i = 0; i < 3; i++)
        values[i] = i < dim ? x[i] : 0;
    values[3] = fmax(hypot(hypot(values[0], values[1]), values[2]), DBL_MIN);
    values[4] = spacing;
}

int scene_check_expression(const struct scene *s, const cJSON *node, size_t n, struct error *e)
{
    struct expression *x;
    struct error inner = {0};
    char brief[JSON_BRIEF];
    if (!cJSON_IsString(node))
        return document_fail(s->doc, node, e, "%s is not an expression in double quotes",
                             json_brief(node, brief));
    if (expression_new(&x, node->valuestring, scene_variables, n, &inner) < 0)
        return document_fail(s->doc, node, e, "%s", inner.text);
    expression_free(x);
    return 0;
}

static int check_component(const struct scene *s, const cJSON *node, struct error *e)
{
    char brief[JSON_BRIEF];
    if (cJSON_IsNumber(node) && isfinite(node->valuedouble))
        return 0;
    if (cJSON_IsString(node))
        return scene_check_expression(s, node, SCENE_VARIABLES, e);
    return document_fail(s->doc, node, e, "%s is neither a number nor an expression",
                         json_brief(node, brief));
}

int scene_check_field(const struct scene *s, const cJSON *node, struct error *e)
{
    const cJSON *item;
    if (!cJSON_IsArray(node))
        return check_component(s, node, e);
    int n = cJSON_GetArraySize(node);
    if (n < 1 || n > 9)
        return document_fail(s->doc, node, e, "%d components; give one for each of the property's",
                             n);
    cJSON_ArrayForEach(item, node)
    {
        if (check_component(s, item, e) < 0)
            return -1;
    }
    return 0;
}

/* -- Texts ----------------------------------------------------------------------------------- */

int scene_strings(struct scene *s, const cJSON *object, const char *key, const char ***out,
                  size_t *n, struct error *e)
{
    const cJSON *node = json_get(object, key), *item;
    char brief[JSON_BRIEF];
    if (!node)
        return 0;
    size_t count = cJSON_IsArray(node) ? (size_t)cJSON_GetArraySize(node) : 1, i = 0;
    const char **list = scene_alloc(s, count, sizeof *list, e);
    if (!list)
        return -1;
    for (item = cJSON_IsArray(node) ? node->child : node; i < count; item = item->next) {
        if (!cJSON_IsString(item) || !item->valuestring[0])
            return document_fail(s->doc, item, e, "%s is not a name in double quotes",
                                 json_brief(item, brief));
        list[i++] = item->valuestring;
    }
    *out = list;
    *n = count;
    return 0;
}

int scene_word(const struct scene *s, const cJSON *object, const char *key, const char *what,
               const char *const *words, size_t n, size_t *index, struct error *e)
{
    const char *word = NULL;
    char hint[512], brief[JSON_BRIEF];
    if (json_string(s->doc, object, key, false, &word, e) < 0)
        return -1;
    if (!word)
        return 0;
    for (size_t i = 0; i < n; i++)
        if (!strcmp(word, words[i])) {
            *index = i;
            return 0;
        }
    const cJSON *node = json_get(object, key);
    return document_fail(s->doc, node, e, "unknown %s %s%s", what, json_brief(node, brief),
                         text_suggest(hint, sizeof hint, word, words, n));
}

int scene_array_name(const struct scene *s, const cJSON *object, const char *key, bool required,
                     const char **out, struct error *e)
{
    size_t index = SIZE_MAX;
    const char *names[64], *word = NULL;
    size_t n = s->n_array < COUNT(names) ? s->n_array : COUNT(names);
    for (size_t i = 0; i < n; i++)
        names[i] = s->array[i].name;
    if (json_string(s->doc, object, key, required, &word, e) < 0)
        return -1;
    for (size_t i = 0; word && i < s->n_array; i++)
        if (!strcmp(s->array[i].name, word)) {
            *out = s->array[i].name;
            return 0;
        }
    return word ? scene_word(s, object, key, "array", names, n, &index, e) : 0;
}

int scene_name(const struct scene *s, const cJSON *node, bool dash, struct error *e)
{
    const char *name = node->string;
    size_t n = strlen(name);
    bool good = n > 0 && n < 64 && !(name[0] >= '0' && name[0] <= '9') && name[0] != '-';
    for (const char *c = name; good && *c; c++)
        good = (*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || (*c >= '0' && *c <= '9') ||
               *c == '_' || (dash && *c == '-');
    if (good)
        return 0;
    cJSON key = {.type = cJSON_String, .valuestring = node->string};
    char brief[JSON_BRIEF];
    return document_fail_key(s->doc, node, e, "%s is not a name: give letters, digits%s and \"_\"",
                             json_brief(&key, brief), dash ? ", \"-\"" : "");
}

/* -- The parts at the top -------------------------------------------------------------------- */

static int compile_side(struct scene *s, const cJSON *node, enum side *side, struct error *e)
{
    static const char *const words[] = {"open", "periodic", "mirror"};
    char hint[256], brief[JSON_BRIEF];
    for (size_t i = 0; cJSON_IsString(node) && i < COUNT(words); i++)
        if (!strcmp(node->valuestring, words[i])) {
            *side = (enum side)i; /* in the order of enum side */
            return 0;
        }
    return document_fail(s->doc, node, e, "%s is not a side%s", json_brief(node, brief),
                         text_suggest(hint, sizeof hint,
                                      cJSON_IsString(node) ? node->valuestring : "", words,
                                      COUNT(words)));
}

static int compile_sides(struct scene *s, const cJSON *node, struct error *e)
{
    static const char *const axes[] = {"x", "y", "z"};
    if (json_keys(s->doc, node, axes, (size_t)s->dim, e) < 0)
        return -1;
    for (int i = 0; i < s->dim; i++) {
        const cJSON *axis = json_get(node, axes[i]);
        enum side *side = s->box.side[i];
        if (!axis)
            continue;
        if (cJSON_IsArray(axis) && cJSON_GetArraySize(axis) != 2)
            return document_fail(s->doc, axis, e, "%d sides; give two, the low and the high one",
                                 cJSON_GetArraySize(axis));
        const cJSON *low = cJSON_IsArray(axis) ? axis->child : axis;
        const cJSON *high = cJSON_IsArray(axis) ? low->next : axis;
        if (compile_side(s, low, &side[0], e) < 0 || compile_side(s, high, &side[1], e) < 0)
            return -1;
        if ((side[0] == SIDE_PERIODIC) != (side[1] == SIDE_PERIODIC))
            return document_fail(
                s->doc, axis, e,
                "one side is periodic and its opposite is not; give \"periodic\" for both");
    }
    return 0;
}

static int compile_domain(struct scene *s, const cJSON *node, struct error *e)
{
    static const char *const keys[] = {"min", "max", "sides"};
    s->box.dim = s->dim;
    if (!node)
        return 0;
    if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
        json_vector(s->doc, node, "min", true, s->dim, s->box.min, e) < 0 ||
        json_vector(s->doc, node, "max", true, s->dim, s->box.max, e) < 0)
        return -1;
    for (int i = 0; i < s->dim; i++)
        if (s->box.min[i] >= s->box.max[i])
            return document_fail(s->doc, node, e,
                                 "the domain is empty: along %c, min %.15g is not below max %.15g",
                                 "xyz"[i], s -> box.min[i], s->box.max[i]);
    s->box.bounded = true;
    const cJSON *sides = json_get(node, "sides");
    return sides ? compile_sides(s, sides, e) : 0;
}

/* {"name": .., parameters} or a bare name. */
static int compile_material(struct scene *s, const cJSON *node, struct scene_material *m,
                            struct error *e)
{
    static const char *const keys[] = {"eos"}, *const eos_keys[] = {"name"};
    m->name = node->string;
    m->node = node;
    if (scene_name(s, node, true, e) < 0 || json_keys(s->doc, node, keys, COUNT(keys), e) < 0)
        return -1;
    m->eos_node = json_get(node, "eos");
    if (!m->eos_node)
        return 0;
    if (cJSON_IsString(m->eos_node)) {
        m->eos_params = document_rest(s->doc, m->eos_node, NULL, 0);
        if (!m->eos_params)
            return error_memory(e, "a material", 0);
        return json_string(s->doc, node, "eos", true, &m->eos, e);
    }
    if (!cJSON_IsObject(m->eos_node)) {
        char brief[JSON_BRIEF];
        return document_fail(
            s->doc, m->eos_node, e,
            "%s is not an equation of state; give its name, or an object with \"name\"",
            json_brief(m->eos_node, brief));
    }
    m->eos_params = document_rest(s->doc, m->eos_node, eos_keys, 1);
    if (!m->eos_params)
        return error_memory(e, "a material", 0);
    return json_string(s->doc, m->eos_node, "name", true, &m->eos, e);
}

static int compile_materials(struct scene *s, const cJSON *node, struct error *e)
{
    const cJSON *item;
    if (!node)
        return 0;
    if (!cJSON_IsObject(node))
        return document_fail(s->doc, node, e, "give an object: a name for each material");
    s->material = scene_alloc(s, (size_t)cJSON_GetArraySize(node), sizeof *s->material, e);
    if (!s->material)
        return -1;
    cJSON_ArrayForEach(item, node)
    {
        if (compile_material(s, item, &s->material[s->n_material], e) < 0)
            return -1;
        s->n_material++;
    }
    return 0;
}

static int compile_boundaries(struct scene *s, const cJSON *node, struct error *e)
{
    static const char *const keys[] = {"name", "array", "with"};
    const cJSON *item;
    if (!node)
        return 0;
    if (!cJSON_IsArray(node))
        return document_fail(s->doc, node, e, "give an array of boundary conditions");
    s->boundary = scene_alloc(s, (size_t)cJSON_GetArraySize(node), sizeof *s->boundary, e);
    if (!s->boundary)
        return -1;
    cJSON_ArrayForEach(item, node)
    {
        struct scene_boundary *b = &s->boundary[s->n_boundary];
        b->node = item;
        if (!cJSON_IsObject(item))
            return document_fail(s->doc, item, e,
                                 "a boundary condition is an object with \"name\"");
        if (json_string(s->doc, item, "name", true, &b->name, e) < 0 ||
            scene_arrays(s, item, "array", &b->array, &b->n_array, e) < 0 ||
            scene_arrays(s, item, "with", &b->with, &b->n_with, e) < 0)
            return -1;
        b->params = document_rest(s->doc, item, keys, COUNT(keys));
        if (!b->params)
            return error_memory(e, "a boundary condition", 0);
        s->n_boundary++;
    }
    return 0;
}

static int compile_limits(struct scene *s, const cJSON *node, struct error *e)
{
    static const char *const keys[] = {"particles"};
    long long particles = (long long)FILL_LIMIT;
    if (node &&
        (json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
         json_integer(s->doc, node, "particles", false, 1, 4000000000ll, &particles, e) < 0))
        return -1;
    s->limit = (uint64_t)particles;
    return 0;
}

static int compile_kernel(struct scene *s, const cJSON *node, struct error *e)
{
    static const char *const keys[] = {"name"};
    s->kernel.node = node;
    if (!node)
        return 0;
    if (cJSON_IsString(node))
        return json_string(s->doc, s->doc->root, "kernel", true, &s->kernel.name, e);
    if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0)
        return -1;
    return json_string(s->doc, node, "name", true, &s->kernel.name, e);
}

static int compile_neighbours(struct scene *s, const cJSON *node, struct error *e)
{
    static const char *const keys[] = {"skin", "manager"};
    s->neighbours.node = node;
    s->neighbours.skin = NAN;
    if (!node)
        return 0;
    if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
        json_number(s->doc, node, "skin", false, &s->neighbours.skin, e) < 0 ||
        json_string(s->doc, node, "manager", false, &s->neighbours.manager, e) < 0)
        return -1;
    if (s->neighbours.skin < 0 || s->neighbours.skin > 1)
        return document_fail(s->doc, json_get(node, "skin"), e,
                             "%.15g is not a skin; give a fraction of the support, 0 to 1",
                             s->neighbours.skin);
    return 0;
}

/* How several processes share the domain. */
static int compile_ranks(struct scene *s, const cJSON *node, struct error *e)
{
    static const char *const keys[] = {"partition", "imbalance", "weights"};
    static const char *const words[] = {"rcb", "rib", "hsfc", "slab"};
    static const char *const weights[] = {"pairs", "time"};
    size_t by_time = 0;
    s->ranks.partition = 0;
    s->ranks.imbalance = 1.01;
    if (!node)
        return 0;
    if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
        scene_word(s, node, "partition", "way to cut the domain", words, COUNT(words),
                   &s->ranks.partition, e) < 0 ||
        json_number(s->doc, node, "imbalance", false, &s->ranks.imbalance, e) < 0 ||
        scene_word(s, node, "weights", "way to weigh particles", weights, COUNT(weights), &by_time,
                   e) < 0)
        return -1;
    s->ranks.by_time = by_time == 1;
    if (s->ranks.imbalance < 1.0)
        return document_fail(s->doc, json_get(node, "imbalance"), e,
                             "%.15g is no bound: the largest share is never less than the mean, 1",
                             s->ranks.imbalance);
    return 0;
}

static int compile_precision(struct scene *s, const cJSON *root, struct error *e)
{
    static const char *const words[] = {"double", "mixed", "single"};
    size_t word = COUNT(words);
    if (scene_word(s, root, "precision", "precision", words, COUNT(words), &word, e) < 0)
        return -1;
    s->precision = word < COUNT(words) ? words[word] : NULL;
    return 0;
}

static int compile_head(struct scene *s, const cJSON *root, struct error *e)
{
    static const char *const units[] = {"none", "SI", "cgs"};
    long long dim = 0;
    size_t unit = 0;
    s->title = "";
    if (json_string(s->doc, root, "title", false, &s->title, e) < 0 ||
        json_integer(s->doc, root, "dimensions", true, 1, 3, &dim, e) < 0 ||
        scene_strings(s, root, "plugins", &s->plugin, &s->n_plugin, e) < 0 ||
        scene_word(s, root, "units", "system of units", units, COUNT(units), &unit, e) < 0)
        return -1;
    s->dim = (int)dim;
    s->units = units[unit];
    return 0;
}

static int compile(struct scene *s, const cJSON *root, struct error *e)
{
    static const char *const keys[] = {
        "$schema",   "title",      "dimensions", "plugins", "units",  "domain",
        "materials", "particles",  "boundaries", "scheme",  "kernel", "time",
        "limits",    "neighbours", "precision",  "compare", "probes", "profiles",
        "output",    "watch",      "functions",  "ranks"};
    if (!root->child)
        return document_fail(s->doc, root, e, "the scene is empty");
    if (json_keys(s->doc, root, keys, COUNT(keys), e) < 0 || compile_head(s, root, e) < 0 ||
        compile_domain(s, json_get(root, "domain"), e) < 0 ||
        compile_materials(s, json_get(root, "materials"), e) < 0 ||
        compile_limits(s, json_get(root, "limits"), e) < 0 ||
        scene_particles(s, json_get(root, "particles"), e) < 0 ||
        compile_boundaries(s, json_get(root, "boundaries"), e) < 0 ||
        scene_functions(s, json_get(root, "functions"), e) < 0 ||
        scene_scheme(s, json_get(root, "scheme"), e) < 0 ||
        compile_kernel(s, json_get(root, "kernel"), e) < 0 ||
        scene_time(s, json_get(root, "time"), e) < 0 ||
        compile_neighbours(s, json_get(root, "neighbours"), e) < 0 ||
        compile_ranks(s, json_get(root, "ranks"), e) < 0 || compile_precision(s, root, e) < 0 ||
        scene_compares(s, json_get(root, "compare"), e) < 0 ||
        scene_probes(s, json_get(root, "probes"), e) < 0 ||
        scene_profiles(s, json_get(root, "profiles"), e) < 0 ||
        scene_watches(s, json_get(root, "watch"), e) < 0)
        return -1;
    return scene_output(s, json_get(root, "output"), e);
}

int scene_compile(struct scene *s, struct document *d, struct error *e)
{
    *s = (struct scene){.doc = d};
    int status = compile(s, d->root, e);
    if (status < 0)
        scene_free(s);
    return status;
}
