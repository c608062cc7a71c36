/* registry/registry.c -- what is registered, and the host's function table behind which plugins
 * register. Knows neither files nor libltdl: the loader brings the plugin's entry. */
#include "config.h"

#include "registry/registry.h"

#include "base/text.h"
#include "registry/check.h"
#include "registry/copy.h"
#include "registry/crash.h"
#include "registry/extension.h"
#include "registry/fpmode.h"
#include "registry/reach.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const kind_label[KIND_COUNT] = {
    "function", "equation of state", "boundary condition", "kernel", "scheme", "exact solution"};
const char *const kind_id[KIND_COUNT] = {SPH_KIND_FUNCTION, SPH_KIND_EOS,    SPH_KIND_BOUNDARY,
                                         SPH_KIND_KERNEL,   SPH_KIND_SCHEME, SPH_KIND_EXACT};

/* Behind registry.lock. `last` and what is here are touched under the mutex, or in main alone. */
struct guard {
    pthread_mutex_t mutex;
    const char *loading; /* file of the plugin whose init runs; NULL: none does */
    int refused;         /* it registered something that was refused */
    struct error why;    /* the first such sentence */
};

static struct registry *registry_of(const sph_host *host)
{
    return host ? host->context : NULL;
}

/* A plugin's message, made one line of valid text. */
static const char *one_line(const char *message, char *out, size_t size)
{
    if (!reach_text(message, size - 1))
        message = "(a message that is not there)";
    snprintf(out, size, "%.*s", (int)size - 1, message);
    text_one_line(out);
    return out;
}

static void keep(struct registry *r, const char *sentence)
{
    struct guard *g = r->lock;

    pthread_mutex_lock(&g->mutex);
    r->last.text[0] = '\0';
    error_set(&r->last, EXIT_RUN, "%s", sentence);
    pthread_mutex_unlock(&g->mutex);
}

/* -- The host's function table -------- */

static sph_status host_fail(const sph_host *host, sph_status status, const char *message)
{
    struct registry *r = registry_of(host);
    char text[sizeof(r->last.text)];

    if (r && message)
        keep(r, one_line(message, text, sizeof(text)));
    return status;
}

static const void *host_extension(const sph_host *host, const char *id)
{
    (void)host;
    return extension_find(id);
}

static void host_log(const sph_host *host, int32_t level, const char *message)
{
    static const char *const word[] = {"error: ", "warning: ", "", "debug: "};
    const struct registry *r = registry_of(host);
    char text[1024];

    if (!r || !message || level > r->log_level || (r->rank > 0 && level > SPH_LOG_ERROR))
        return;
    if (level < SPH_LOG_ERROR || level > SPH_LOG_DEBUG)
        level = SPH_LOG_INFO;
    fprintf(stderr, "sph: %s%s\n", word[level], one_line(message, text, sizeof(text)));
}

static double host_param(const sph_config *config, const char *name)
{
    const sph_param *p;

    if (!config || !name)
        return NAN;
    p = config->item->params.data;
    for (uint32_t i = 0; i < config->item->params.count; i++)
        if (strcmp(p[i].name, name) == 0)
            return config->value[i];
    return NAN;
}

static int find_kind(const char *id)
{
    for (int i = 0; check_is_text(id) && i < KIND_COUNT; i++)
        if (strcmp(id, kind_id[i]) == 0)
            return i;
    return -1;
}

static int append(struct registry *r, const struct entry *x, struct error *e)
{
    struct entry *grown = realloc(r->entry, (r->n_entry + 1) * sizeof(*grown));

    if (!grown)
        return error_memory(e, "the registry", (r->n_entry + 1) * sizeof(*grown));
    r->entry = grown;
    r->entry[r->n_entry++] = *x;
    return 0;
}

/* Copies, checks and keeps a descriptor of the plugin that is being loaded. */
static int add_item(struct registry *r, enum kind kind, const void *descriptor, struct error *e)
{
    struct entry x = {.kind = kind, .plugin = r->n_plugin};
    const struct entry *other;
    const char *name;

    x.descriptor = copy_descriptor(kind, descriptor, &x.memory, e);
    if (!x.descriptor) {
        error_prefix(e, "%s", kind_label[kind]);
        goto fail;
    }
    x.item = copy_item_of(kind, x.descriptor);
    name = x.item->name;
    if (!check_is_name(name)) {
        error_set(e, EXIT_REFUSED, "%s: name of the item %s", kind_label[kind],
                  !name || (check_is_text(name) && !name[0])
                      ? "is missing"
                      : "is not a word of a-z, 0-9 and - (at most 63 of them)");
        goto fail;
    }
    if (check_descriptor(kind, x.descriptor, e)) {
        error_prefix(e, "%s \"%s\"", kind_label[kind], name);
        goto fail;
    }
    other = registry_find(r, kind, name);
    if (other && other->plugin == r->n_plugin) {
        error_set(e, EXIT_REFUSED, "%s \"%s\" is registered twice", kind_label[kind], name);
        goto fail;
    }
    if (other) {
        error_set(e, EXIT_REFUSED, "%s \"%s\" is registered already, by %s", kind_label[kind], name,
                  r->plugin[other->plugin].path);
        goto fail;
    }
    if (append(r, &x, e))
        goto fail;
    return 0;
fail:
    copy_free(x.memory);
    return -1;
}

static sph_status host_register_item(const sph_host *host, const char *kind, const void *descriptor)
{
    struct registry *r = registry_of(host);
    struct guard *g;
    struct error e = {0};
    int k;

    if (!r)
        return SPH_E_INVALID;
    g = r->lock;
    if (!g->loading) {
        keep(r, "register_item was called outside of init");
        return SPH_E_INVALID;
    }
    k = find_kind(kind);
    if (k < 0) {
        error_set(&e, EXIT_REFUSED, "kind \"%.64s\" is unknown to this sph",
                  check_is_text(kind) ? kind : "?");
        keep(r, e.text);
        return SPH_E_UNKNOWN;
    }
    if (!descriptor)
        error_set(&e, EXIT_REFUSED, "%s: descriptor is NULL", kind_label[k]);
    else if (add_item(r, (enum kind)k, descriptor, &e) == 0)
        return SPH_OK;
    return registry_refuse(r, &e);
}

bool registry_is_loading(const struct registry *r)
{
    return ((const struct guard *)r->lock)->loading != NULL;
}

sph_status registry_refuse(struct registry *r, const struct error *e)
{
    struct guard *g = r->lock;

    keep(r, e->text);
    if (!g->refused)
        g->why = *e;
    g->refused = 1;
    return SPH_E_INVALID;
}

/* -- Life -------- */

int registry_init(struct registry *r, struct error *e)
{
    struct guard *g = calloc(1, sizeof(*g));

    memset(r, 0, sizeof(*r));
    if (!g)
        return error_memory(e, "the registry", sizeof(*g));
    if (pthread_mutex_init(&g->mutex, NULL)) {
        free(g);
        return error_set(e, EXIT_RUN, "no mutex is to be had");
    }
    r->lock = g;
    r->log_level = SPH_LOG_WARNING;
    r->host = (sph_host){.size = (uint32_t)sizeof(sph_host),
                         .abi_major = SPH_ABI_MAJOR,
                         .abi_minor = SPH_ABI_MINOR,
                         .context = r,
                         .name = "sph",
                         .version = PACKAGE_VERSION,
                         .register_item = host_register_item,
                         .extension = host_extension,
                         .log = host_log,
                         .fail = host_fail,
                         .param = host_param};
    return 0;
}

static void plugin_free(struct plugin *p)
{
    free(p->path);
    free(p->name);
    free(p->version);
    free(p->license);
    free(p->doc);
    free((void *)p->descriptor);
}

static void drop_entries(struct registry *r, size_t from)
{
    while (r->n_entry > from)
        copy_free(r->entry[--r->n_entry].memory);
}

static void run_fini(struct registry *r, const struct plugin *p)
{
    const uint64_t mode = fpmode_get();

    if (p->descriptor->fini)
        p->descriptor->fini(&r->host);
    fpmode_set(mode);
}

void registry_fini(struct registry *r)
{
    drop_entries(r, 0);
    while (r->n_plugin > 0) {
        struct plugin *p = &r->plugin[--r->n_plugin];
        crash_watch(p->path, "being closed");
        run_fini(r, p);
        if (p->handle && p->close)
            p->close(p->handle);
        crash_forget();
        plugin_free(p);
    }
    free(r->entry);
    free(r->plugin);
    if (r->lock) {
        pthread_mutex_destroy(&((struct guard *)r->lock)->mutex);
        free(r->lock);
    }
    memset(r, 0, sizeof(*r));
}

/* -- Adding a plugin -------- */

/* Magic and version stand where they always will; only then does the size mean anything. */
static int check_border(const sph_plugin *in, struct error *e)
{
    uint32_t head[4]; /* size, magic, major, minor */

    if (!in)
        return error_set(e, EXIT_REFUSED, "its sph_plugin_entry returns NULL");
    if (!reach_bytes(in, sizeof(head)))
        return error_set(e, EXIT_REFUSED, "its sph_plugin_entry returns %p, where nothing is",
                         (const void *)in);
    memcpy(head, in, sizeof(head));
    if (head[1] != SPH_PLUGIN_MAGIC)
        return error_set(e, EXIT_REFUSED,
                         "its descriptor has the magic number 0x%08x, not 0x%08x: it is no plugin "
                         "of sph",
                         head[1], SPH_PLUGIN_MAGIC);
    if (head[2] != SPH_ABI_MAJOR || head[3] > SPH_ABI_MINOR ||
        (SPH_ABI_MAJOR == 0 && head[3] != SPH_ABI_MINOR))
        return error_set(e, EXIT_REFUSED,
                         "it was built for the plugin ABI %u.%u, but this sph has %u.%u", head[2],
                         head[3], SPH_ABI_MAJOR, SPH_ABI_MINOR);
    return 0;
}

/* Of code no more can be asked. */
static bool is_code(const void *address)
{
    return reach_bytes(address, 1);
}

static int copy_plugin(sph_plugin *out, const sph_plugin *in, struct error *e)
{
    if (check_border(in, e) ||
        copy_struct(out, sizeof(*out), in, offsetof(sph_plugin, fini) + sizeof(out->fini),
                    "plugin's descriptor", e))
        return -1;
    if (!check_is_name(out->name))
        return error_set(e, EXIT_REFUSED, "name of the plugin is not a word of a-z, 0-9 and -");
    if (!check_is_text(out->version) || out->version[0] == '\0')
        return error_set(e, EXIT_REFUSED, "version of the plugin is missing");
    if (out->license && !check_is_text(out->license))
        return error_set(e, EXIT_REFUSED, "license of the plugin is not one line of UTF-8 text");
    if (out->doc && !check_is_text(out->doc))
        return error_set(e, EXIT_REFUSED, "doc of the plugin is not one line of UTF-8 text");
    if (!out->init)
        return error_set(e, EXIT_REFUSED, "init of the plugin is NULL");
    if (!is_code((const void *)(uintptr_t)out->init) ||
        (out->fini && !is_code((const void *)(uintptr_t)out->fini)))
        return error_set(e, EXIT_REFUSED, "%s of the plugin is an address where nothing is",
                         is_code((const void *)(uintptr_t)out->init) ? "fini" : "init");
    return 0;
}

static int fill_plugin(struct plugin *p, const char *path, const sph_plugin *in, struct error *e)
{
    sph_plugin *d = calloc(1, sizeof(*d));

    p->descriptor = d;
    if (!d)
        return error_memory(e, "a plugin", sizeof(*d));
    if (copy_plugin(d, in, e))
        return -1;
    p->path = strdup(path);
    p->name = strdup(d->name);
    p->version = strdup(d->version);
    p->license = strdup(d->license ? d->license : "");
    p->doc = strdup(d->doc ? d->doc : "");
    p->abi_major = d->abi_major;
    p->abi_minor = d->abi_minor;
    if (!p->path || !p->name || !p->version || !p->license || !p->doc)
        return error_memory(e, "a plugin", sizeof(*p));
    return 0;
}

/* Undoes what the plugin's `what` did to the floating point mode, and refuses the plugin for it:
 * every other one would compute otherwise. */
static int restore_mode(uint64_t mode, const char *what, struct error *e)
{
    if (fpmode_get() == mode)
        return 0;
    fpmode_set(mode);
    return error_set(e, EXIT_REFUSED, "%s changes the floating point mode of the program", what);
}

/* Runs init with registering switched on. */
static int run_init(struct registry *r, const struct plugin *p, struct error *e)
{
    struct guard *g = r->lock;
    const uint64_t mode = fpmode_get();
    sph_status status;
    int changed;

    g->loading = p->path;
    g->refused = 0;
    g->why = (struct error){0};
    r->last.text[0] = '\0';
    status = p->descriptor->init(&r->host);
    g->loading = NULL;
    changed = restore_mode(mode, "its init", e);
    if (status == SPH_OK && (g->refused || changed))
        run_fini(r, p); /* it went on as if nothing was, but half a plugin is none */
    if (g->refused)
        return error_set(e, EXIT_REFUSED, "%s", g->why.text);
    if (status != SPH_OK) {
        char reason[512];
        registry_reason(r, status, reason, sizeof(reason));
        return error_set(e, EXIT_REFUSED, "its init failed: %s", reason);
    }
    return changed;
}

int registry_add(struct registry *r, const char *path, sph_plugin_entry_fn entry, void *handle,
                 void (*close)(void *handle), struct error *e)
{
    const size_t n_entry = r->n_entry;
    struct plugin p = {.handle = handle, .close = close};
    struct plugin *grown = realloc(r->plugin, (r->n_plugin + 1) * sizeof(*grown));
    const uint64_t mode = fpmode_get();
    const struct plugin *other;
    const sph_plugin *in;

    if (!grown)
        return error_memory(e, "the registry", (r->n_plugin + 1) * sizeof(*grown));
    r->plugin = grown;
    in = entry();
    if (restore_mode(mode, "its sph_plugin_entry", e) || fill_plugin(&p, path, in, e))
        goto fail;
    other = registry_plugin(r, p.name);
    if (other) {
        error_set(e, EXIT_REFUSED, "its name, \"%s\", is that of a plugin loaded already, %s",
                  p.name, other->path);
        goto fail;
    }
    r->plugin[r->n_plugin] = p;
    if (run_init(r, &p, e))
        goto fail;
    r->n_plugin++;
    return 0;
fail:
    drop_entries(r, n_entry);
    plugin_free(&p);
    return error_prefix(e, "plugin %s", path);
}

static sph_status nothing_to_do(const sph_host *host)
{
    (void)host;
    return SPH_OK;
}

int registry_add_texts(struct registry *r, const struct registry_texts *texts, size_t *failed,
                       struct error *e)
{
    const sph_plugin descriptor = {.size = (uint32_t)sizeof(descriptor),
                                   .magic = SPH_PLUGIN_MAGIC,
                                   .abi_major = SPH_ABI_MAJOR,
                                   .abi_minor = SPH_ABI_MINOR,
                                   .name = texts->name,
                                   .version = texts->version,
                                   .license = "",
                                   .doc = texts->doc,
                                   .init = nothing_to_do};
    const size_t n_entry = r->n_entry;
    struct plugin p = {0}, *grown = realloc(r->plugin, (r->n_plugin + 1) * sizeof(*grown));

    *failed = texts->n;
    if (!grown)
        return error_memory(e, "the registry", (r->n_plugin + 1) * sizeof(*grown));
    r->plugin = grown;
    if (fill_plugin(&p, texts->path, &descriptor, e))
        goto fail;
    if (registry_plugin(r, p.name)) {
        error_set(e, EXIT_REFUSED, "its functions are the plugin \"%s\", but %s has that name",
                  p.name, registry_plugin(r, p.name)->path);
        goto fail;
    }
    r->plugin[r->n_plugin] = p;
    for (size_t i = 0; i < texts->n; i++) {
        if (add_item(r, KIND_FUNCTION, texts->function[i], e)) {
            *failed = i;
            goto fail;
        }
        r->entry[r->n_entry - 1].text = true;
    }
    r->n_plugin++;
    return 0;
fail:
    drop_entries(r, n_entry);
    plugin_free(&p);
    return -1;
}

/* -- Asking -------- */

const struct plugin *registry_plugin(const struct registry *r, const char *name)
{
    for (size_t i = 0; i < r->n_plugin; i++)
        if (strcmp(r->plugin[i].name, name) == 0)
            return &r->plugin[i];
    return NULL;
}

const struct entry *registry_find(const struct registry *r, enum kind kind, const char *name)
{
    for (size_t i = 0; name && i < r->n_entry; i++)
        if (r->entry[i].kind == kind && strcmp(r->entry[i].item->name, name) == 0)
            return &r->entry[i];
    return NULL;
}

const char **registry_names(const struct registry *r, enum kind kind, size_t *n)
{
    const char **names = malloc((r->n_entry + 1) * sizeof(*names));

    *n = 0;
    for (size_t i = 0; names && i < r->n_entry; i++)
        if (r->entry[i].kind == kind)
            names[(*n)++] = r->entry[i].item->name;
    return names;
}

static const char *status_text(sph_status status)
{
    switch (status) {
    case SPH_OK:
        return "it gave no reason";
    case SPH_E_INVALID:
        return "invalid argument or descriptor (it gave no reason)";
    case SPH_E_UNKNOWN:
        return "something is unknown to this sph (it gave no reason)";
    case SPH_E_ABI:
        return "version or size does not fit (it gave no reason)";
    case SPH_E_NOMEM:
        return "out of memory";
    case SPH_E_NUMERIC:
        return "a number is not finite or nothing converges (it gave no reason)";
    default:
        return NULL;
    }
}

void registry_reason(struct registry *r, sph_status status, char *out, size_t size)
{
    struct guard *g = r->lock;
    const char *text = status_text(status);

    pthread_mutex_lock(&g->mutex);
    if (r->last.text[0])
        snprintf(out, size, "%s", r->last.text);
    else if (text)
        snprintf(out, size, "%s", text);
    else
        snprintf(out, size, "status %d (it gave no reason)", (int)status);
    r->last.text[0] = '\0';
    pthread_mutex_unlock(&g->mutex);
}

bool entry_on_device(const struct entry *x)
{
    const sph_function *f;

    if (x->kind == KIND_EOS)
        return entry_eos(x)->device != NULL;
    if (x->kind != KIND_FUNCTION)
        return true;
    f = entry_function(x);
    if (f->shape == SPH_POINT)
        return f->device_run != NULL;
    return f->device && (!f->before || f->device_before) && (!f->after || f->device_after);
}
