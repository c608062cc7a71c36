/* cli/info.h -- the parts of `sph info`. Private to cli/info*.c. */
#ifndef CLI_INFO_H
#define CLI_INFO_H

#include "registry/registry.h"

/* What was asked for. Indices into the registry's lists. */
struct info_choice {
    size_t *entry, n_entry;
    size_t *plugin, n_plugin;
    bool detail; /* all of it, not a line each */
};

/* To stdout, readable at 80 columns. */
void info_text(const struct registry *r, const struct info_choice *c);
/* One JSON object on stdout. */
int info_json(const struct registry *r, const struct info_choice *c, struct error *e);

/* What a plugin may ask the host for, by id. */
void info_extensions(void);
/* Versions of what is built in. */
void info_build(void);
/* The OpenCL devices. */
int info_devices(struct error *e);

/* The kinds in one word each, as in "kernel/NAME". */
extern const char *const info_kind[KIND_COUNT];
/* Has a slash, and is not "KIND/NAME". */
bool info_is_path(const char *id);
bool info_names_plugin(const struct plugin *p, const char *id);
bool info_names_entry(const struct entry *x, const char *id);
/* Says that there is none of that name, and which is near. Returns -1. */
int info_unknown(const struct registry *r, const char *id, struct error *e);

/* Numbers with dots between. */
bool info_is_version(const char *text);
/* By their numbers: 0.10 is after 0.9, 1 is 1.0. What follows the numbers of `version` does not
 * count. */
bool info_at_least(const char *version, const char *least);
/* Is a plugin or an item of that name here, its plugin of at least that version (NULL: any)? */
bool info_exists(const struct registry *r, const char *id, const char *least);

/* Words of the ABI's numbers. */
const char *info_type(uint32_t type);
/* "read, sources, write, ..." */
const char *info_access(uint32_t access, char *out, size_t size);
/* Of a choice: its word. Copies to out. */
const char *info_default(const sph_param *p, char *out, size_t size);

#endif
