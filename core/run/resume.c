/* run/resume.c -- see resume.h. */
#include "config.h"

#include "run/resume.h"

#include "base/text.h"
#include "domain/ranks.h"
#include "domain/wire.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -- Where a checkpoint comes from -------------------------------------------------------------- */

void origin_free(struct origin *o)
{
    for (size_t k = 0; o->set && k < o->n_set; k++)
        free(o->set[k]);
    free(o->set);
    free(o->version);
    free(o->scene);
    free(o->scene_path);
    free(o->plugins);
    free(o->precision);
    free(o->processor);
    free(o->device);
    *o = (struct origin){0};
}

static char *plugins_of(const struct registry *r)
{
    char *all = strdup("");
    for (size_t k = 0; all && k < r->n_plugin; k++) {
        char *more = text_format("%s%s\t%s\n", all, r->plugin[k].name, r->plugin[k].version);
        free(all);
        all = more;
    }
    return all;
}

static const char *processor(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
        return "avx512";
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? "avx2" : "base";
#else
    return "base";
#endif
}

int origin_make(struct origin *o, const struct plan *plan, uint32_t path, uint64_t ranks,
                const char *scene_path, struct error *e)
{
    const struct document *d = plan->scene->doc;
    *o = (struct origin){.path = path, .ranks = ranks, .strict = plan->strict};
    o->version = strdup(PACKAGE_VERSION);
    o->scene = strdup(d->text);
    o->scene_path = realpath(scene_path, NULL);
    if (!o->scene_path)
        o->scene_path = strdup(scene_path);
    o->plugins = plugins_of(plan->registry);
    o->precision = strdup(precision_name[plan->precision]);
    o->processor = strdup(processor());
    o->device = strdup(plan->on_device ? "opencl" : "cpu");
    o->set = calloc(d->n_set + 1, sizeof *o->set);
    bool good = o->version && o->scene && o->scene_path && o->plugins && o->precision &&
                o->processor && o->device && o->set;
    for (; good && o->n_set < d->n_set; o->n_set++) {
        o->set[o->n_set] = strdup(d->set[o->n_set]);
        good = o->set[o->n_set] != NULL;
    }
    if (good)
        return 0;
    origin_free(o);
    return error_memory(e, "a checkpoint", d->length);
}

int origin_store(struct origin *o, struct store *s, struct error *e)
{
    size_t n = o->n_set;
    if (store_text(s, "version", &o->version, e) || store_text(s, "scene", &o->scene, e) ||
        store_text(s, "scene_path", &o->scene_path, e) ||
        store_text(s, "plugins", &o->plugins, e) || store_text(s, "precision", &o->precision, e) ||
        store_text(s, "processor", &o->processor, e) || store_text(s, "device", &o->device, e) ||
        store_u64(s, "path", &o->path, e) || store_u64(s, "ranks", &o->ranks, e) ||
        store_u64(s, "strict", &o->strict, e) || store_count(s, "n_set", &n, e))
        return -1;
    if (!o->version || !o->scene || !o->scene_path || !o->plugins || !o->precision ||
        !o->processor || !o->device || n > 100000 || o->ranks < 1 || o->ranks > INT32_MAX)
        return store_broken(s, e, "it does not tell of its scene");
    if (s->reading)
        o->set = calloc(n + 1, sizeof *o->set);
    if (!o->set)
        return error_memory(e, "a checkpoint", n);
    for (o->n_set = 0; o->n_set < n; o->n_set++) {
        char name[32];
        snprintf(name, sizeof name, "set%zu", o->n_set);
        if (store_text(s, name, &o->set[o->n_set], e))
            return -1;
        if (!o->set[o->n_set])
            return store_broken(s, e, "%s is missing", name);
    }
    return 0;
}

/* -- Of a run that failed ----------------------------------------------------------------------- */

bool resume_has_failed(struct store *s)
{
    return store_has(s, "failed/step");
}

int resume_failure_store(struct resume_failure *f, struct store *s, struct error *e)
{
    return store_text(s, "failed/cause", &f->cause, e) ||
                   store_text(s, "failed/reason", &f->reason, e) ||
                   store_u64(s, "failed/step", &f->step, e) ||
                   store_f64(s, "failed/time", &f->time, e)
               ? -1
               : 0;
}

void resume_failure_free(struct resume_failure *f)
{
    free(f->cause);
    free(f->reason);
    *f = (struct resume_failure){0};
}

static int refuse_failed(struct resume *r, struct error *e)
{
    struct resume_failure f = {0};
    if (resume_failure_store(&f, &r->file.store, e) == 0)
        error_set(e, EXIT_USAGE,
                  "%s is the state of a run that failed%s%s%s at step %llu, t = %g, to look at "
                  "(h5py, h5ls) and not to go on from",
                  r->path, f.cause ? " (" : "", f.cause ? f.cause : "", f.cause ? ")" : "",
                  (unsigned long long)f.step, f.time);
    resume_failure_free(&f);
    return -1;
}

/* -- Which one ---------------------------------------------------------------------------------- */

/* failed: whether it is refused for being of a failure. known: another rank has looked at all of it. */
static int open_file(struct resume *r, const char *path, bool known, bool *failed, struct error *e)
{
    *failed = false;
    *r = (struct resume){.path = strdup(path)};
    if (!r->path)
        return error_memory(e, "a path", strlen(path));
    if ((known ? checkpoint_open_known : checkpoint_open)(&r->file, path, e)) {
        free(r->path);
        *r = (struct resume){0};
        return -1;
    }
    *failed = resume_has_failed(&r->file.store);
    if (*failed ? refuse_failed(r, e) : origin_store(&r->origin, &r->file.store, e)) {
        resume_close(r);
        return -1;
    }
    return 0;
}

/* aloud: tells of those that are passed over. */
static int open_latest(struct resume *r, const char *dir, bool aloud, struct error *e)
{
    long long *step;
    bool failed;
    const long n = checkpoint_list(dir, &step, e);
    int status = n < 0 ? -1 : 1;
    struct error why = {0};
    for (long k = 0; k < n && status == 1; k++) {
        char name[64];
        output_checkpoint_name(name, sizeof name, (unsigned long long)step[k]);
        char *path = text_format("%s/%s", dir, name);
        if (!path) {
            status = error_memory(e, "a path", strlen(dir));
        } else if (open_file(r, path, false, &failed, &why) == 0) {
            status = 0;
        } else if (aloud && k + 1 < n) {
            fprintf(stderr, "sph: %s; the one before it is taken\n", why.text);
        }
        free(path);
    }
    free(step);
    if (status == 1 && why.text[0])
        return error_set(e, EXIT_USAGE, "no good checkpoint is in %s: %s", dir, why.text);
    if (status == 1)
        return error_set(e, EXIT_USAGE, "no checkpoint is in the folder %s", dir);
    return status;
}

/* Adds to the refusal of a failed state what may be gone on from instead. */
static void name_good(const char *file, struct error *e)
{
    const struct error said = *e;
    struct error ignored = {0};
    struct resume good;
    char *folder = resume_folder(file);
    if (folder && open_latest(&good, folder, false, &ignored) == 0) {
        error_set(e, EXIT_USAGE, "%s; the newest good checkpoint there is %s", said.text,
                  good.path);
        resume_close(&good);
    } else {
        error_set(e, EXIT_USAGE, "%s; no good checkpoint is beside it", said.text);
    }
    free(folder);
}

int resume_open(struct resume *r, const char *what, const char *dir, struct error *e)
{
    bool failed;
    *r = (struct resume){0};
    if (strcmp(what, "latest") == 0)
        return open_latest(r, dir, true, e);
    const int status = open_file(r, what, false, &failed, e);
    if (failed)
        name_good(what, e);
    return status;
}

/* Rank 0's path, in fresh memory. */
static int tell_path(struct wire *w, const char *mine, char **path, struct error *e)
{
    uint64_t n = mine ? strlen(mine) + 1 : 0;
    if (wire_tell(w, &n, sizeof n, e))
        return -1;
    *path = calloc(n + 1, 1);
    if (!*path)
        return error_memory(e, "a path", n);
    if (mine)
        memcpy(*path, mine, n);
    return wire_tell(w, *path, n, e);
}

int resume_open_together(struct resume *r, const char *what, const char *dir, struct error *e)
{
    int rank, size;
    char *path = NULL;
    struct wire *w = NULL;
    bool failed;
    ranks_count(&rank, &size);
    *r = (struct resume){0};
    if (ranks_agree(rank == 0 ? resume_open(r, what, dir, e) : 0, e) || wire_open(&w, e)) {
        resume_close(r);
        return -1;
    }
    int status = tell_path(w, r->path, &path, e);
    if (status)
        wire_alarm(w);
    else if (rank > 0)
        status = open_file(r, path, true, &failed, e);
    status = ranks_agree(status, e);
    wire_close(w);
    free(path);
    if (status)
        resume_close(r);
    return status;
}

void resume_close(struct resume *r)
{
    if (r->path)
        checkpoint_close(&r->file);
    origin_free(&r->origin);
    free(r->path);
    *r = (struct resume){0};
}

/* -- Whether it agrees -------------------------------------------------------------------------- */

/* What a run may be given anew as it goes on. */
static const struct json_skip may_differ[] = {
    {"time", "end"},    {"time", "steps"}, {NULL, "output"}, {NULL, "compare"}, {NULL, "probes"},
    {NULL, "profiles"}, {NULL, "watch"},   {NULL, "ranks"},  {NULL, "title"},   {NULL, "$schema"}};

static int scenes_differ(const struct resume *r, const struct document *was,
                         const struct document *is, const struct json_difference *d,
                         struct error *e)
{
    char at[256], a[JSON_BRIEF], b[JSON_BRIEF];
    document_pointer(d->is ? is : was, d->is ? d->is : d->was, at, sizeof at);
    if (d->order)
        return error_set(e, EXIT_USAGE,
                         "%s cannot go on from %s: its keys stand in another order, from %s on",
                         is->path, r->path, at);
    return error_set(e, EXIT_USAGE,
                     "%s cannot go on from %s, whose scene differs: %s is %s here and %s there",
                     is->path, r->path, at, d->is ? json_brief(d->is, a) : "missing",
                     d->was ? json_brief(d->was, b) : "missing");
}

static int check_scene(const struct resume *r, const struct document *is, struct error *e)
{
    struct document was;
    struct json_difference d;
    int status = 0;
    if (document_parse(&was, r->path, r->origin.scene, strlen(r->origin.scene), e))
        return -1;
    for (size_t k = 0; !status && k < r->origin.n_set; k++)
        status = document_set(&was, r->origin.set[k], e);
    if (!status &&
        json_differ(was.root, is->root, may_differ, sizeof may_differ / sizeof may_differ[0], &d))
        status = scenes_differ(r, &was, is, &d, e);
    document_free(&was);
    return status;
}

/* Every plugin of then is there, and is the same. */
static int check_plugins(const struct resume *r, const struct registry *registry, struct error *e)
{
    for (const char *line = r->origin.plugins; *line;) {
        const int n = (int)strcspn(line, "\t"), whole = (int)strcspn(line, "\n");
        const char *version = line + (n < whole ? n + 1 : whole);
        const int m = (int)(line + whole - version);
        const struct plugin *found = NULL;
        for (size_t k = 0; !found && k < registry->n_plugin; k++)
            if ((int)strlen(registry->plugin[k].name) == n &&
                strncmp(registry->plugin[k].name, line, (size_t)n) == 0)
                found = &registry->plugin[k];
        if (!found)
            return error_set(e, EXIT_USAGE,
                             "%s was made with the plugin \"%.*s\", which is not loaded", r->path,
                             n, line);
        if ((int)strlen(found->version) != m || strncmp(found->version, version, (size_t)m) != 0)
            return error_set(e, EXIT_USAGE,
                             "%s was made with version %.*s of the plugin \"%s\"; here it is %s",
                             r->path, m, version, found->name, found->version);
        line += whole + (line[whole] != '\0');
    }
    return 0;
}

int resume_check(const struct resume *r, const struct plan *plan, uint32_t path, struct error *e)
{
    static const char *const name[] = {"best", "reference", "extended", "base", "avx2", "avx512"};
    const struct origin *o = &r->origin;
    const uint64_t paths = sizeof name / sizeof name[0];
    if (strcmp(o->version, PACKAGE_VERSION) != 0)
        return error_set(e, EXIT_USAGE, "%s was made by sph %s; this is sph %s", r->path,
                         o->version, PACKAGE_VERSION);
    if (check_scene(r, plan->scene->doc, e) || check_plugins(r, plan->registry, e))
        return -1;
    if (strcmp(o->precision, precision_name[plan->precision]) != 0)
        return error_set(e, EXIT_USAGE, "%s was made in precision \"%s\", not \"%s\"", r->path,
                         o->precision, precision_name[plan->precision]);
    if ((strcmp(o->device, "cpu") != 0) != plan->on_device)
        return error_set(e, EXIT_USAGE, "%s was made with --device %s, not %s", r->path, o->device,
                         plan->on_device ? "opencl" : "cpu");
    if (o->path != path)
        return error_set(e, EXIT_USAGE, "%s was made with --path %s, not %s", r->path,
                         o->path < paths ? name[o->path] : "of another kind",
                         path < paths ? name[path] : "another");
    if ((o->strict != 0) != plan->strict)
        return error_set(e, EXIT_USAGE, "%s was made %s --strict; go on %s it", r->path,
                         o->strict ? "with" : "without", o->strict ? "with" : "without");
    int rank, size;
    ranks_count(&rank, &size);
    if (strcmp(o->processor, processor()) != 0 && rank == 0)
        fprintf(stderr,
                "sph: %s was made on a processor with %s, this one has %s: last bits may differ\n",
                r->path, o->processor, processor());
    return 0;
}

/* -- Folders ------------------------------------------------------------------------------------ */

char *resume_folder(const char *file)
{
    const char *slash = strrchr(file, '/');
    return slash ? text_format("%.*s", slash == file ? 1 : (int)(slash - file), file) : strdup(".");
}

bool resume_is_in(const struct resume *r, const char *dir)
{
    char *file = realpath(r->path, NULL), *there = realpath(dir, NULL);
    char *folder = file ? resume_folder(file) : NULL;
    const bool same = folder && there && strcmp(folder, there) == 0;
    free(file);
    free(there);
    free(folder);
    return same;
}
