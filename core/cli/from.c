/* cli/from.c -- finds the functions that a plugin is made of (see from.h), and writes the files of its project
 * beside NAME.c, which from_source.c writes. */
#include "cli/from.h"
#include "base/text.h"
#include "plan/bodies.h"
#include "scene/functions.h"
#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* -- Which scene ----------------------------------------------------------------------------- */

static const char *base_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static bool ends_in_json(const char *name)
{
    const size_t n = strlen(name);
    return n > 5 && strcmp(name + n - 5, ".json") == 0;
}

static int is_scene(const struct dirent *entry)
{
    return entry->d_name[0] != '.' && ends_in_json(entry->d_name);
}

/* Whether member "body" of `node`, of the scene's, is that file. */
static bool names_body(const struct document *d, const cJSON *node, const struct stat *body)
{
    const cJSON *name = json_get(node, "body");
    struct stat st;
    bool same = false;
    char *path = cJSON_IsString(name) ? document_relative(d, name->valuestring) : NULL;
    if (path && stat(path, &st) == 0)
        same = st.st_dev == body->st_dev && st.st_ino == body->st_ino;
    free(path);
    return same;
}

static bool function_has(const struct document *d, const cJSON *function, const struct stat *body)
{
    return names_body(d, function, body) || names_body(d, json_get(function, "before"), body) ||
           names_body(d, json_get(function, "after"), body);
}

static bool scene_has(const char *path, const struct stat *body)
{
    struct document d;
    const cJSON *function;
    bool found = false;
    if (document_load(&d, path, NULL))
        return false;
    cJSON_ArrayForEach(function, json_get(d.root, "functions"))
    {
        found = found || function_has(&d, function, body);
    }
    document_free(&d);
    return found;
}

/* The one scene in the body's folder that names it. */
static int find_scene(struct from *f, const char *body, struct error *e)
{
    struct dirent **list = NULL;
    struct stat st;
    char *folder = text_format("%.*s", (int)(base_of(body) - body), body), *path;
    int n = -1, status = 0;
    if (!folder)
        return error_memory(e, "a path", strlen(body));
    if (stat(body, &st) != 0)
        status = error_set(e, EXIT_USAGE, "--from: %s: %s", body, strerror(errno));
    else if (!S_ISREG(st.st_mode))
        status = error_set(e, EXIT_USAGE, "--from: %s is no file", body);
    else if ((n = scandir(*folder ? folder : ".", &list, is_scene, alphasort)) < 0)
        status = error_set(e, EXIT_USAGE, "--from: %s: %s", folder, strerror(errno));
    for (int i = 0; i < n; i++) {
        path = status ? NULL : text_format("%s%s", folder, list[i]->d_name);
        if (path && scene_has(path, &st)) {
            if (f->scene)
                status = error_set(e, EXIT_USAGE,
                                   "--from: both %s and %s name %s: give --from SCENE.json, or "
                                   "--from SCENE.json:FUNCTION",
                                   f->scene, path, body);
            else
                f->scene = strdup(path);
        }
        free(path);
        free(list[i]);
    }
    free(list);
    if (!status && !f->scene)
        status = error_set(e, EXIT_USAGE,
                           "--from: no scene beside %s (a file *.json) names it in its "
                           "\"functions\", which say what it reads and writes",
                           body);
    free(folder);
    return status;
}

/* -- Which functions ------------------------------------------------------------------------- */

static bool is_wanted(const struct from *f, const struct scene_function *function,
                      const struct stat *body)
{
    if (f->function)
        return strcmp(f->function, function->name) == 0;
    return !f->body || function_has(f->loaded.scene.doc, function->node, body);
}

static int choose(struct from *f, struct error *e)
{
    const struct scene *s = &f->loaded.scene;
    struct stat body = {0};
    char near[512];
    if (s->n_function == 0)
        return error_set(e, EXIT_USAGE, "--from: %s has no \"functions\"", f->scene);
    f->entry = calloc(s->n_function, sizeof *f->entry);
    const char **known = calloc(s->n_function, sizeof *known);
    if (f->body)
        stat(f->body, &body);
    for (size_t i = 0; f->entry && known && i < s->n_function; i++) {
        known[i] = s->function[i].name;
        if (is_wanted(f, &s->function[i], &body))
            f->entry[f->n++] = registry_find(&f->loaded.registry, KIND_FUNCTION, known[i]);
    }
    if (!f->entry || !known)
        error_memory(e, "functions", s->n_function);
    else if (f->n == 0)
        error_set(
            e, EXIT_USAGE, "--from: %s brings no function \"%s\"%s", f->scene,
            f->function ? f->function : "",
            text_suggest(near, sizeof near, f->function ? f->function : "", known, s->n_function));
    free((void *)known);
    return f->n ? 0 : -1;
}

/* -- Which files ----------------------------------------------------------------------------- */

static int add_file(struct from *f, const char *path, const char *text, struct error *e)
{
    if (!path)
        return 0;
    const char *name = base_of(path);
    for (size_t i = 0; i < f->n_file; i++) {
        if (strcmp(f->file[i].name, name) != 0)
            continue;
        if (strcmp(f->file[i].text, text) == 0)
            return 0;
        return error_set(e, EXIT_USAGE,
                         "--from: %s and %s would be one file in the project: rename one",
                         f->file[i].path, path);
    }
    if (name[strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._+-")])
        return error_set(e, EXIT_USAGE,
                         "--from: the name of %s does not go into a Makefile: give it one of "
                         "letters, digits, \".\", \"-\" and \"_\"",
                         path);
    struct from_file *grown = realloc(f->file, (f->n_file + 1) * sizeof *grown);
    if (!grown)
        return error_memory(e, "files", (f->n_file + 1) * sizeof *grown);
    f->file = grown;
    f->file[f->n_file++] = (struct from_file){name, path, text};
    return 0;
}

/* Those of all functions of the scene: what stays in it goes on needing its own. */
static int collect(struct from *f, struct error *e)
{
    const struct scene *s = &f->loaded.scene;
    for (size_t i = 0; i < s->n_function; i++) {
        const struct scene_function *x = &s->function[i];
        const struct scene_body *const body[] = {&x->run, &x->before, &x->after};
        for (int b = 0; b < 3; b++)
            if (add_file(f, body[b]->file, body[b]->text, e) ||
                add_file(f, body[b]->prelude_file, body[b]->prelude, e))
                return -1;
    }
    return 0;
}

int from_open(struct from *f, const char *what, struct error *e)
{
    const char *colon = strstr(what, ".json:");
    *f = (struct from){0};
    if (colon) {
        f->scene = text_format("%.*s", (int)(colon - what) + 5, what);
        f->function = strdup(colon + 6);
        if (!f->scene || !f->function)
            return error_memory(e, "a path", strlen(what));
    } else if (ends_in_json(what)) {
        f->scene = strdup(what);
    } else {
        f->body = what;
        if (find_scene(f, what, e))
            return -1;
    }
    if (!f->scene)
        return error_memory(e, "a path", strlen(what));
    const struct scene_options options = {.path = f->scene};
    return loaded_open(&f->loaded, &options, e) || choose(f, e) || collect(f, e) ? -1 : 0;
}

void from_free(struct from *f)
{
    loaded_free(&f->loaded);
    free(f->scene);
    free(f->function);
    free((void *)f->entry);
    free(f->file);
}

/* -- Words and files ------------------------------------------------------------------------- */

char *from_headers(const struct from *f)
{
    char *all = strdup("");
    for (size_t i = 0; all && i < f->n_file; i++) {
        char *more = text_format("%s%s%s", all, i ? " " : "", f->file[i].name);
        free(all);
        all = more;
    }
    return all;
}

char *from_words(const struct from *f)
{
    char *all = strdup("");
    for (size_t i = 0; all && i < f->n; i++) {
        char *more = text_format("%s%s`%s` (%s)", all, i ? ", " : "", f->entry[i]->item->name,
                                 f->entry[i]->item->doc);
        free(all);
        all = more;
    }
    return all;
}

/* In a copy of the scene: members "body" and "prelude" of an object name files of the project. */
static void shorten(cJSON *node)
{
    static const char *const keys[] = {"body", "prelude"};
    for (int k = 0; k < 2; k++) {
        cJSON *name = cJSON_GetObjectItemCaseSensitive(node, keys[k]);
        if (cJSON_IsString(name)) {
            char *base = strdup(base_of(name->valuestring));
            if (base)
                cJSON_SetValuestring(name, base);
            free(base);
        }
    }
}

/* The functions that stay with the scene. */
static void keep_others(const struct from *f, cJSON *root)
{
    cJSON *functions = cJSON_GetObjectItemCaseSensitive(root, "functions"), *next;
    for (cJSON *x = functions ? functions->child : NULL; x; x = next) {
        const cJSON *name = json_get(x, "name");
        next = x->next;
        bool gone = false;
        for (size_t i = 0; i < f->n; i++)
            gone = gone || strcmp(f->entry[i]->item->name, name->valuestring) == 0;
        if (gone) {
            cJSON_Delete(cJSON_DetachItemViaPointer(functions, x));
            continue;
        }
        shorten(x);
        shorten(cJSON_GetObjectItemCaseSensitive(x, "before"));
        shorten(cJSON_GetObjectItemCaseSensitive(x, "after"));
    }
    if (functions && !functions->child)
        cJSON_DeleteItemFromObjectCaseSensitive(root, "functions");
}

/* The scene with the plugin in place of the texts; the caller frees it with cJSON_free. */
static char *scene_text(const struct from *f, const char *name)
{
    cJSON *root = cJSON_Duplicate(f->loaded.doc.root, true);
    cJSON *plugins = cJSON_GetObjectItemCaseSensitive(root, "plugins");
    if (!root)
        return NULL;
    cJSON_DeleteItemFromObjectCaseSensitive(root, "$schema");
    keep_others(f, root);
    if (!cJSON_IsArray(plugins)) {
        cJSON *list = cJSON_CreateArray();
        if (plugins)
            cJSON_AddItemToArray(list, cJSON_DetachItemFromObjectCaseSensitive(root, "plugins"));
        cJSON_AddItemToObject(root, "plugins", list);
        plugins = list;
    }
    cJSON_AddItemToArray(plugins, cJSON_CreateString(name));
    char *text = cJSON_Print(root);
    cJSON_Delete(root);
    return text;
}

/* A new file; text NULL: NAME.c is written. */
static int write_file(const struct from *f, const char *folder, const char *name, const char *text,
                      const char *plugin, struct error *e)
{
    char *path = text_format("%s/%s", folder, name);
    FILE *out = path ? fopen(path, "wxe") : NULL;
    bool bad = !out;
    if (out)
        bad = text ? fputs(text, out) < 0 : from_source(f, plugin, out) != 0;
    bad = (out && ferror(out)) || bad;
    bad = (out && fclose(out) != 0) || bad;
    if (bad)
        error_set(e, errno == EEXIST ? EXIT_USAGE : EXIT_RUN, "%s cannot be written: %s",
                  path ? path : name, strerror(errno));
    free(path);
    return bad ? -1 : 0;
}

int from_write(const struct from *f, const char *folder, const char *name, struct error *e)
{
    char *scene = scene_text(f, name), *source = text_format("%s.c", name);
    char *text = scene ? text_format("%s\n", scene) : NULL;
    int status = 0;
    if (!source || !text)
        status = error_memory(e, "a scene", 0);
    for (size_t i = 0; !status && i < f->n_file; i++)
        status = write_file(f, folder, f->file[i].name, f->file[i].text, name, e);
    status = status || write_file(f, folder, "scene.json", text, name, e) ||
             write_file(f, folder, source, NULL, name, e);
    cJSON_free(scene);
    free(text);
    free(source);
    return status ? -1 : 0;
}
