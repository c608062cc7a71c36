/* registry/registry.h -- what the loaded plugins have registered, by kind and name; the host's
 * function table behind which they register. One registry a run, filled by the loader. */
#ifndef REGISTRY_REGISTRY_H
#define REGISTRY_REGISTRY_H

#include "base/error.h"
#include <sph/plugin.h>
#include <stdbool.h>
#include <stddef.h>

enum kind {
    KIND_FUNCTION,
    KIND_EOS,
    KIND_BOUNDARY,
    KIND_KERNEL,
    KIND_SCHEME,
    KIND_EXACT,
    KIND_COUNT
};

/* "function", "equation of state", ... and the SPH_KIND_... id. */
extern const char *const kind_label[KIND_COUNT];
extern const char *const kind_id[KIND_COUNT];

/* A registered thing. `descriptor` is the host's own copy, grown to today's size: fields that an
 * older plugin did not have hold their documented defaults. So are its item, its life and all its
 * lists: their elements have today's size, optional strings (unit, source, ...) are "" where the
 * plugin left NULL, choices excepted. The strings themselves stay the plugin's. */
struct entry {
    enum kind kind;
    const sph_item *item;
    const void *descriptor;           /* sph_function, sph_eos, ... by kind */
    size_t plugin;                    /* index into registry.plugin */
    const sph_population *population; /* of a function; or NULL */
    const sph_state *state;           /* or NULL */
    const char *const *part;          /* of a function that does the work of n_part others */
    size_t n_part;
    bool text;    /* of a function: it has no native code, only a text for devices */
    void *memory; /* private: what the copies lie in */
};

struct plugin {
    char *path, *name, *version, *license, *doc; /* copies */
    uint32_t abi_major, abi_minor;
    void *handle; /* of the loader; NULL: not from a file */
    void (*close)(void *handle);
    const sph_plugin *descriptor; /* the host's own copy, grown as above */
};

/* Not to be copied or moved while it is in use: the host's table points back to it. */
struct registry {
    struct plugin *plugin;
    size_t n_plugin;
    struct entry *entry;
    size_t n_entry;
    sph_host host;
    int log_level; /* messages of plugins above it are dropped; others go to stderr */
    int rank; /* of several: on others than the first all but errors are dropped, as that one says the same */
    struct error last; /* the sentence of the last host->fail, per thread-safe lock inside */
    void *lock;        /* private */
};

int registry_init(struct registry *r, struct error *e);
/* Calls every plugin's fini, closes it, frees all. */
void registry_fini(struct registry *r);

/* Lets a plugin register: calls `entry`, checks what it returns, then its init. For the loader, and
 * for tests whose plugins are no files. Fails (EXIT_REFUSED) with a sentence that names `path`; the
 * registry is then as it was, and `handle` still the caller's. On success the registry calls
 * close(handle) when it is done with the plugin; close may be NULL. [main] */
int registry_add(struct registry *r, const char *path, sph_plugin_entry_fn entry, void *handle,
                 void (*close)(void *handle), struct error *e);

/* Functions that come as texts for devices, from no file: registered together as the plugin `name`, checked
 * as any plugin's. Their `run`, `before` and `after` are there and fail. What they point to is copied, but
 * for strings, which outlive the registry. On failure *failed is the index of the one that is wrong, or n,
 * and nothing is registered. [main] */
struct registry_texts {
    const char *name, *version, *doc, *path;
    const sph_function *const *function;
    size_t n;
};
int registry_add_texts(struct registry *r, const struct registry_texts *texts, size_t *failed,
                       struct error *e);

/* For extensions, whose functions a plugin calls in its init: does one run now; the plugin is to be
 * refused with this sentence (returns SPH_E_INVALID). */
bool registry_is_loading(const struct registry *r);
sph_status registry_refuse(struct registry *r, const struct error *e);

/* A loaded plugin by its name; NULL if there is none. */
const struct plugin *registry_plugin(const struct registry *r, const char *name);
/* By kind and name; NULL if there is none. */
const struct entry *registry_find(const struct registry *r, enum kind kind, const char *name);
/* Names of all entries of a kind; the caller frees the array (not the strings). */
const char **registry_names(const struct registry *r, enum kind kind, size_t *n);

/* Typed access; the entry's kind must fit. */
static inline const sph_function *entry_function(const struct entry *x)
{
    return (const sph_function *)x->descriptor;
}
static inline const sph_eos *entry_eos(const struct entry *x)
{
    return (const sph_eos *)x->descriptor;
}
static inline const sph_kernel *entry_kernel(const struct entry *x)
{
    return (const sph_kernel *)x->descriptor;
}
static inline const sph_scheme *entry_scheme(const struct entry *x)
{
    return (const sph_scheme *)x->descriptor;
}
static inline const sph_boundary *entry_boundary(const struct entry *x)
{
    return (const sph_boundary *)x->descriptor;
}
static inline const sph_exact *entry_exact(const struct entry *x)
{
    return (const sph_exact *)x->descriptor;
}

/* The life of an item, or NULL if it or its kind has none. */
static inline const sph_life *entry_life(const struct entry *x)
{
    return x->kind == KIND_FUNCTION ? entry_function(x)->life
           : x->kind == KIND_EOS    ? entry_eos(x)->life
           : x->kind == KIND_EXACT  ? entry_exact(x)->life
                                    : NULL;
}

/* Whether it has bodies for a device in place of all that it does there: a function or an equation of
 * state. Of other kinds: true, for there is nothing of theirs to run. */
bool entry_on_device(const struct entry *x);

/* Element i of a list of the ABI, whatever its stride. */
static inline const void *list_at(const sph_list *l, uint32_t i)
{
    return (const char *)l->data + (size_t)i * l->stride;
}

/* Parameters of one use of an item, checked against its declarations. value[i] belongs to declared
 * parameter i. Opaque to plugins as sph_config. */
struct sph_config {
    const sph_item *item;
    double *value;
    const sph_table **table; /* [params], NULL where none; NULL: none at all. Not owned */
};
/* All at their defaults (NaN where mandatory). */
int config_init(struct sph_config *c, const sph_item *item, struct error *e);
void config_fini(struct sph_config *c);
/* Sets one by number or by word (exactly one of number/word is used: word if not NULL). Fails with
 * "X must lie between ..", "X is one of a, b", without naming the place: the caller adds that. */
int config_set(struct sph_config *c, const char *name, double number, const char *word,
               struct error *e);
/* Sets one that is a table, which outlives the configuration. */
int config_set_table(struct sph_config *c, const char *name, const sph_table *table,
                     struct error *e);
/* Fails if a mandatory parameter is still unset. */
int config_check(const struct sph_config *c, struct error *e);

/* The plugin's last host->fail message, or a default text for the status. Copies to out. */
void registry_reason(struct registry *r, sph_status status, char *out, size_t size);

#endif
