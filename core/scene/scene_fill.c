/* scene/scene_fill.c -- one entry of "fill": how particles come into a region. */
#include "base/text.h"
#include "scene/scene_private.h"
#include <math.h>
#include <string.h>

static int compile_lattice(struct scene *s, const cJSON *node, struct scene_fill *f,
                           struct error *e)
{
    static const char *const names[] = {"square", "cubic", "hexagonal", "bcc", "fcc"};
    static const enum lattice lattice_of[] = {LATTICE_SQUARE, LATTICE_SQUARE, LATTICE_HEXAGONAL,
                                              LATTICE_BCC, LATTICE_FCC};
    size_t i = 0;
    if (scene_word(s, node, "lattice", "lattice", names, COUNT(names), &i, e) < 0)
        return -1;
    f->kind = FILL_LATTICE;
    f->lattice = lattice_of[i];
    if (f->lattice == LATTICE_HEXAGONAL && s->dim < 2)
        return document_fail(s->doc, json_get(node, "lattice"), e,
                             "a hexagonal lattice needs 2 or 3 dimensions; in 1 give \"square\"");
    if ((f->lattice == LATTICE_BCC || f->lattice == LATTICE_FCC) && s->dim < 3)
        return document_fail(s->doc, json_get(node, "lattice"), e,
                             "the lattice \"%s\" needs 3 dimensions; in %d give \"%s\"", names[i],
                             s->dim, s->dim == 2 ? "hexagonal" : "square");
    return 0;
}

static int compile_glass(struct scene *s, const cJSON *node, struct scene_fill *f, struct error *e)
{
    static const char *const keys[] = {"sweeps", "noise"};
    const cJSON *glass = json_get(node, "glass");
    long long sweeps = 200;
    f->kind = FILL_GLASS;
    f->noise = .01;
    if (json_keys(s->doc, glass, keys, COUNT(keys), e) < 0 ||
        json_integer(s->doc, glass, "sweeps", false, 1, 1000000, &sweeps, e) < 0 ||
        json_positive(s->doc, glass, "noise", false, "density noise", &f->noise, e) < 0)
        return -1;
    f->sweeps = (uint64_t)sweeps;
    return 0;
}

static int compile_file(struct scene *s, const cJSON *node, struct scene_fill *f, struct error *e)
{
    const cJSON *item;
    char brief[JSON_BRIEF];
    f->kind = FILL_FILE;
    if (json_string(s->doc, node, "file", true, &f->file, e) < 0 ||
        json_string(s->doc, node, "array", false, &f->file_array, e) < 0)
        return -1;
    f->rename = json_get(node, "rename");
    if (f->rename && !cJSON_IsObject(f->rename))
        return document_fail(s->doc, f->rename, e,
                             "give an object: the file's name of a column, and the scene's");
    cJSON_ArrayForEach(item, f->rename)
    {
        if (!cJSON_IsString(item) || !item->valuestring[0])
            return document_fail(s->doc, item, e, "%s is not a name in double quotes",
                                 json_brief(item, brief));
    }
    return json_positive(s->doc, node, "spacing", false, "spacing", &f->spacing, e);
}

/* How fine: exactly one of three. */
static int compile_size(struct scene *s, const cJSON *node, struct scene_fill *f, struct error *e)
{
    long long count = 0;
    int given = (json_get(node, "spacing") != NULL) + (json_get(node, "count") != NULL) +
                (json_get(node, "mass") != NULL);
    if (given != 1)
        return document_fail(s->doc, node, e, "%s; give one of \"spacing\", \"count\" and \"mass\"",
                             given ? "the fill's size is given twice"
                                   : "the fill's size is missing");
    if (json_positive(s->doc, node, "spacing", false, "spacing", &f->spacing, e) < 0 ||
        json_integer(s->doc, node, "count", false, 1, 1ll << 52, &count, e) < 0 ||
        json_positive(s->doc, node, "mass", false, "mass", &f->mass, e) < 0)
        return -1;
    f->count = (uint64_t)count;
    return 0;
}

static int compile_jitter(struct scene *s, const cJSON *node, struct scene_fill *f, struct error *e)
{
    long long seed = 1;
    if (json_number(s->doc, node, "jitter", false, &f->jitter, e) < 0 ||
        json_integer(s->doc, node, "seed", false, 0, 1ll << 52, &seed, e) < 0)
        return -1;
    if (f->jitter < 0 || f->jitter > .5)
        return document_fail(s->doc, json_get(node, "jitter"), e,
                             "%.15g is not a jitter; give a fraction of the spacing, 0 to 0.5",
                             f->jitter);
    f->seed = (uint64_t)seed;
    return 0;
}

static int compile_region(struct scene *s, const cJSON *node, struct scene_fill *f, struct error *e)
{
    const cJSON *in = json_get(node, "in");
    double min[3], max[3];
    if (in && scene_shape(s, in, &f->shape, e) < 0)
        return -1;
    if (s->box.bounded)
        return 0;
    if (!f->shape)
        return document_fail(s->doc, node, e,
                             "the key \"in\" is missing, and the scene has no \"domain\" to fill");
    if (!shape_bounds(f->shape, min, max))
        return document_fail(s->doc, in, e,
                             "the shape is unbounded, and the scene has no \"domain\" to bound it");
    return 0;
}

int scene_fill(struct scene *s, const cJSON *node, struct scene_fill *f, struct error *e)
{
    static const char *const lattice_keys[] = {"lattice", "in",     "spacing", "count",
                                               "mass",    "jitter", "seed",    "fields"};
    static const char *const glass_keys[] = {"glass", "in",   "spacing", "count",
                                             "mass",  "seed", "fields"};
    static const char *const file_keys[] = {"file", "array", "rename", "spacing", "fields"};
    static const char *const all_keys[] = {"lattice", "glass", "file",   "in",
                                           "spacing", "count", "mass",   "jitter",
                                           "seed",    "array", "rename", "fields"};
    f->node = node;
    f->reached = scene_alloc(s, 1, sizeof *f->reached, e);
    if (!f->reached)
        return -1;
    *f->reached = NAN;
    if (json_keys(s->doc, node, all_keys, COUNT(all_keys), e) < 0)
        return -1;
    int kinds = (json_get(node, "lattice") != NULL) + (json_get(node, "glass") != NULL) +
                (json_get(node, "file") != NULL);
    if (kinds != 1)
        return document_fail(s->doc, node, e,
                             "a fill has one of \"lattice\", \"glass\" and \"file\"");
    if (json_get(node, "file")) {
        if (json_keys(s->doc, node, file_keys, COUNT(file_keys), e) < 0)
            return -1;
        return compile_file(s, node, f, e);
    }
    if (json_get(node, "lattice")) {
        if (json_keys(s->doc, node, lattice_keys, COUNT(lattice_keys), e) < 0 ||
            compile_lattice(s, node, f, e) < 0)
            return -1;
    } else if (json_keys(s->doc, node, glass_keys, COUNT(glass_keys), e) < 0 ||
               compile_glass(s, node, f, e) < 0) {
        return -1;
    }
    if (compile_size(s, node, f, e) < 0 || compile_jitter(s, node, f, e) < 0)
        return -1;
    return compile_region(s, node, f, e);
}
