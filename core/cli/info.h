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

/* Versions of what is built in. */
void info_build(void);
/* The OpenCL devices. */
int info_devices(struct error *e);

/* Words of the ABI's numbers. */
const char *info_type(uint32_t type);
/* "read, sources, write, ..." */
const char *info_access(uint32_t access, char *out, size_t size);
/* Of a choice: its word. Copies to out. */
const char *info_default(const sph_param *p, char *out, size_t size);

#endif
