/* scene/scene_functions.c -- "functions": bodies in text files beside the scene, and the lists of what they
 * read and write. Reads those files. What else a function declares is in scene_declared.c. */
#include "scene/functions.h"
#include "base/text.h"
#include "scene/scene_private.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Of a body's file [bytes]. */
#define BODY_MOST ((size_t)1 << 20)

const char *const scene_list_key[LISTS] = {"i", "j", "sum", "min", "max", "in", "out", "inout"};

/* -- Files ----------------------------------------------------------------------------------- */

/* A whole file into memory of the scene, ended by NUL; NULL with a sentence that does not name it. */
static char *read_text(struct scene *s, const char *path, size_t *n, struct error *e)
{
    struct stat about;
    FILE *file = fopen(path, "rbe");
    char *text = NULL;
    if (!file || fstat(fileno(file), &about) != 0)
        error_set(e, EXIT_USAGE, "cannot be read: %s", strerror(errno));
    else if (!S_ISREG(about.st_mode))
        error_set(e, EXIT_USAGE, "is no file");
    else if ((size_t)about.st_size > BODY_MOST)
        error_set(e, EXIT_USAGE, "is larger than %zu KiB; a body is a short text", BODY_MOST >> 10);
    else
        text = scene_alloc(s, (size_t)about.st_size + 1, 1, e);
    if (text) {
        *n = fread(text, 1, (size_t)about.st_size, file);
        if (ferror(file)) {
            error_set(e, EXIT_USAGE, "cannot be read: %s", strerror(errno));
            text = NULL;
        }
    }
    if (file)
        fclose(file);
    return text;
}

static bool is_blank(const char *text)
{
    return text[strspn(text, " \t\r\n")] == '\0';
}

/* Member `key` of node, the name of a file: opened, looked at, kept. */
static int read_member(struct scene *s, const cJSON *node, const char *key, bool required,
                       const char **file, const char **text, struct error *e)
{
    const char *name = NULL;
    struct error why = {0};
    size_t n = 0, wrong, line, column;
    if (json_string(s->doc, node, key, required, &name, e) < 0)
        return -1;
    if (!name)
        return 0;
    const cJSON *at = json_get(node, key);
    char *found = document_relative(s->doc, name), *path = NULL;
    if (found && (path = scene_alloc(s, strlen(found) + 1, 1, e)))
        memcpy(path, found, strlen(found) + 1);
    free(found);
    if (!path)
        return error_memory(e, "a path", strlen(name));
    char *all = read_text(s, path, &n, &why);
    if (!all)
        return document_fail(s->doc, at, e, "%s: %s", path, why.text);
    if (strlen(all) != n)
        return document_fail(s->doc, at, e, "%s: byte %zu is 0: that is no text", path,
                             strlen(all));
    if ((wrong = text_invalid_utf8(all, n)) != (size_t)-1) {
        for (line = column = 1, n = 0; n < wrong; n++, column++)
            if (all[n] == '\n') {
                line++;
                column = 0;
            }
        return document_fail(s->doc, at, e, "%s:%zu:%zu: byte 0x%02x is not UTF-8", path, line,
                             column, (unsigned char)all[wrong]);
    }
    if (is_blank(all))
        return document_fail(s->doc, at, e, "%s: the text is empty", path);
    *file = path;
    *text = all;
    return 0;
}

/* -- Lists ----------------------------------------------------------------------------------- */

bool scene_is_identifier(const char *name)
{
    const size_t n =
        strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_");
    return n > 0 && n < 64 && !name[n] && name[0] != '_' && !(name[0] >= '0' && name[0] <= '9') &&
           strncmp(name, "sph_", 4) != 0 && strncmp(name, "SPH_", 4) != 0;
}

bool scene_is_taken(const char *name, bool side)
{
    static const char *const sides[] = {"h", "hinv"}; /* h_i, hinv_j */
    static const char *const words[] = {
        "b",       "dx",       "h",      "h_i",    "h_j",     "hinv_i",   "hinv_j",   "in",
        "r",       "r2",       "rinv",   "B",      "DIM",     "K",        "M",        "R",
        "T",       "FORM",     "INT",    "auto",   "bool",    "break",    "case",     "char",
        "const",   "constant", "do",     "double", "else",    "float",    "for",      "global",
        "half",    "if",       "inline", "int",    "kernel",  "local",    "long",     "main",
        "private", "restrict", "return", "short",  "signed",  "sizeof",   "static",   "struct",
        "switch",  "typedef",  "uchar",  "uint",   "ulong",   "unsigned", "ushort",   "union",
        "void",    "volatile", "while",  "goto",   "default", "continue", "register", "extern",
        "enum"};
    const char *const *known = side ? sides : words;
    for (size_t i = 0; i < (side ? COUNT(sides) : COUNT(words)); i++)
        if (!strcmp(name, known[i]))
            return true;
    return false;
}

static int add_value(struct scene *s, const cJSON *item, const char *name, enum scene_list list,
                     struct scene_body *b, struct error *e)
{
    char brief[JSON_BRIEF];
    if (!cJSON_IsString(item) || !scene_is_identifier(item->valuestring))
        return document_fail(s->doc, item, e,
                             "%s is not the name of a property: give letters, digits and \"_\"",
                             json_brief(item, brief));
    if (name && !scene_is_identifier(name))
        return document_fail_key(s->doc, item, e,
                                 "\"%s\" is no name for a body: give letters, digits and \"_\", "
                                 "not beginning with sph_",
                                 name);
    struct scene_value v = {item, name ? name : item->valuestring, item->valuestring};
    /* Of a point function h is a property like any other. */
    const bool plain = !strcmp(v.name, "h") && json_get(b->node, "name") && list >= LIST_IN;
    if (!plain && scene_is_taken(v.name, list == LIST_I || list == LIST_J))
        return document_fail(s->doc, item, e,
                             "the body has another \"%s\" already: give this one a name of its "
                             "own, {\"my_%s\": \"%s\"}",
                             v.name, v.name, v.property);
    for (int l = 0; l < LISTS; l++)
        for (size_t k = 0; k < b->n_value[l]; k++)
            if (!strcmp(b->value[l][k].name, v.name) &&
                (l == (int)list ||
                 (l != LIST_I && l != LIST_J && list != LIST_I && list != LIST_J)))
                return document_fail(s->doc, item, e, "\"%s\" is named in \"%s\" already", v.name,
                                     scene_list_key[l]);
    b->value[list][b->n_value[list]++] = v;
    return 0;
}

/* "rho", ["rho", "m"], or {"NAME": "rho"} where the body calls it otherwise. */
static int compile_list(struct scene *s, const cJSON *node, enum scene_list list,
                        struct scene_body *b, struct error *e)
{
    const cJSON *at = json_get(node, scene_list_key[list]), *item;
    if (!at)
        return 0;
    const bool several = cJSON_IsArray(at) || cJSON_IsObject(at);
    b->value[list] =
        scene_alloc(s, several ? (size_t)cJSON_GetArraySize(at) : 1, sizeof **b->value, e);
    if (!b->value[list])
        return -1;
    if (!several)
        return add_value(s, at, NULL, list, b, e);
    cJSON_ArrayForEach(item, at)
    {
        if (add_value(s, item, cJSON_IsObject(at) ? item->string : NULL, list, b, e) < 0)
            return -1;
    }
    return 0;
}

/* Behind the comment that begins at `at`; `at` itself if none does. */
static const char *skip_comment(const char *at)
{
    const char *end = at[0] != '/'   ? NULL
                      : at[1] == '*' ? strstr(at + 2, "*/")
                      : at[1] == '/' ? strchr(at, '\n')
                                     : NULL;
    if (at[0] == '/' && (at[1] == '*' || at[1] == '/'))
        return end ? end + (at[1] == '*' ? 2 : 1) : at + strlen(at);
    return at;
}

bool scene_body_uses(const struct scene_body *b, const char *name)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";
    const size_t length = strlen(name);
    if (b->prelude || strstr(b->text, "##"))
        return true;
    for (const char *at = b->text; *at;) {
        const char *behind = skip_comment(at);
        const size_t n = strspn(at, letters);
        if (n == length && strncmp(at, name, n) == 0)
            return true;
        at = behind > at ? behind : at + (n ? n : 1);
    }
    return false;
}

/* What a body does not name it does not read: a slip of the pen. */
static int check_used(const struct scene *s, const struct scene_body *b, struct error *e)
{
    for (int l = 0; l < LISTS; l++)
        for (size_t k = 0; k < b->n_value[l]; k++) {
            const struct scene_value *v = &b->value[l][k];
            const char *side = l == LIST_I ? "_i" : l == LIST_J ? "_j" : "";
            char name[80];
            snprintf(name, sizeof name, "%s%s", v->name, side);
            if (!scene_body_uses(b, name))
                return document_fail(s->doc, v->node, e,
                                     "%s does not use \"%s\": leave it out of \"%s\"", b->file,
                                     name, scene_list_key[l]);
        }
    return 0;
}

static int compile_body(struct scene *s, const cJSON *node, struct scene_body *b, struct error *e)
{
    b->node = node;
    if (read_member(s, node, "body", true, &b->file, &b->text, e) < 0 ||
        read_member(s, node, "prelude", false, &b->prelude_file, &b->prelude, e) < 0 ||
        scene_strings(s, node, "fail", &b->fail, &b->n_fail, e) < 0)
        return -1;
    for (int l = 0; l < LISTS; l++)
        if (compile_list(s, node, (enum scene_list)l, b, e) < 0)
            return -1;
    return check_used(s, b, e);
}

/* Member `key` of a pair function: a body of one particle. */
static int compile_point(struct scene *s, const cJSON *function, const char *key,
                         struct scene_body *b, struct error *e)
{
    static const char *const keys[] = {"body", "prelude", "in", "out", "inout", "fail"};
    const cJSON *node = json_get(function, key);
    if (!node)
        return 0;
    if (!cJSON_IsObject(node))
        return document_fail(
            s->doc, node, e,
            "give an object with \"body\" and the lists \"in\", \"out\", \"inout\"");
    return json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ? -1 : compile_body(s, node, b, e);
}

/* -- A function ------------------------------------------------------------------------------ */

static int compile_dims(struct scene *s, const cJSON *node, struct scene_function *f,
                        struct error *e)
{
    const cJSON *at = json_get(node, "dimensions"), *item;
    char brief[JSON_BRIEF];
    f->dims = at ? 0 : SPH_ALL_DIMS;
    int n = cJSON_IsArray(at) ? cJSON_GetArraySize(at) : at ? 1 : 0;
    if (at && n == 0)
        return document_fail(s->doc, at, e, "no dimension is given; give 1, 2, 3 or several");
    for (item = cJSON_IsArray(at) ? at->child : at; n > 0; n--, item = item->next) {
        int dim = 1;
        while (cJSON_IsNumber(item) && dim <= 3 && item->valuedouble != dim)
            dim++;
        if (!cJSON_IsNumber(item) || dim > 3)
            return document_fail(s->doc, item, e, "%s is no number of dimensions; give 1, 2 or 3",
                                 json_brief(item, brief));
        f->dims |= 1u << dim;
    }
    return 0;
}

/* Of functions, as of plugins'. */
static int compile_name(struct scene *s, const cJSON *node, const char **name, struct error *e)
{
    if (json_string(s->doc, node, "name", true, name, e) < 0)
        return -1;
    const size_t n = strspn(*name, "abcdefghijklmnopqrstuvwxyz0123456789-");
    if (**name >= 'a' && !(*name)[n] && n < 64)
        return 0;
    return document_fail(s->doc, json_get(node, "name"), e,
                         "\"%s\" is no name for a function: give a small letter, then small "
                         "letters, digits and \"-\"",
                         *name);
}

/* Without "shape": of pairs, unless there are only lists that bodies of one particle have. */
static int compile_shape(struct scene *s, const cJSON *node, struct scene_function *f,
                         struct error *e)
{
    static const char *const shapes[] = {"point", "pair"};
    const bool pair = json_get(node, "i") || json_get(node, "j");
    const bool point = json_get(node, "in") || json_get(node, "out") || json_get(node, "inout");
    size_t shape = point && !pair ? 0 : 1;
    if (scene_word(s, node, "shape", "shape", shapes, COUNT(shapes), &shape, e) < 0)
        return -1;
    f->shape = shape == 0 ? SPH_POINT : SPH_PAIR;
    return 0;
}

static int compile_pair(struct scene *s, const cJSON *node, struct scene_function *f,
                        struct error *e)
{
    static const char *const reaches[] = {"gather", "symmetric"};
    size_t reach = 1;
    bool self = false, floats = false;
    f->reach_scale = 1;
    if (scene_word(s, node, "reach", "reach", reaches, COUNT(reaches), &reach, e) < 0 ||
        json_bool(s->doc, node, "self", false, &self, e) < 0 ||
        json_bool(s->doc, node, "floats", false, &floats, e) < 0 ||
        json_positive(s->doc, node, "reach_scale", false, "factor", &f->reach_scale, e) < 0 ||
        compile_point(s, node, "before", &f->before, e) < 0 ||
        compile_point(s, node, "after", &f->after, e) < 0)
        return -1;
    f->reach = reach == 0 ? SPH_GATHER : SPH_SYMMETRIC;
    f->self = self;
    f->reals = floats ? SPH_F64 | SPH_F32 : SPH_F64;
    return 0;
}

static int check_keys(struct scene *s, const cJSON *node, uint32_t shape, struct error *e)
{
    static const char *const pair_keys[] = {
        "name",       "doc",        "source",      "shape",     "dimensions", "body",
        "prelude",    "i",          "j",           "sum",       "min",        "max",
        "reach",      "self",       "reach_scale", "floats",    "before",     "after",
        "properties", "parameters", "rates",       "reductions"};
    static const char *const point_keys[] = {
        "name", "doc",   "source", "shape", "dimensions", "body",       "prelude", "in",
        "out",  "inout", "sum",    "fail",  "properties", "parameters", "rates",   "reductions"};
    return shape == SPH_PAIR ? json_keys(s->doc, node, pair_keys, COUNT(pair_keys), e)
                             : json_keys(s->doc, node, point_keys, COUNT(point_keys), e);
}

static int compile_function(struct scene *s, const cJSON *node, struct scene_function *f,
                            struct error *e)
{
    f->node = node;
    f->source = "";
    f->reach_scale = 1;
    if (!cJSON_IsObject(node))
        return document_fail(s->doc, node, e, "a function is an object with \"name\" and \"body\"");
    if (compile_shape(s, node, f, e) < 0 || check_keys(s, node, f->shape, e) < 0 ||
        compile_name(s, node, &f->name, e) < 0 ||
        json_string(s->doc, node, "doc", false, &f->doc, e) < 0 ||
        json_string(s->doc, node, "source", false, &f->source, e) < 0 ||
        compile_dims(s, node, f, e) < 0 || compile_body(s, node, &f->run, e) < 0 ||
        (f->shape == SPH_PAIR && compile_pair(s, node, f, e) < 0))
        return -1;
    if (!f->doc)
        f->doc = "a function of the scene";
    return scene_declared(s, node, f, e);
}

int scene_functions(struct scene *s, const cJSON *node, struct error *e)
{
    const cJSON *item;
    void *list = NULL;
    if (scene_list(s, node, "functions", sizeof *s->function, &list, e) < 0)
        return -1;
    s->function = list;
    cJSON_ArrayForEach(item, node)
    {
        struct scene_function *f = &s->function[s->n_function];
        if (compile_function(s, item, f, e) < 0)
            return -1;
        for (size_t k = 0; k < s->n_function; k++)
            if (!strcmp(s->function[k].name, f->name))
                return document_fail(s->doc, json_get(item, "name"), e,
                                     "an earlier function has the name \"%s\" already", f->name);
        s->n_function++;
    }
    return 0;
}
