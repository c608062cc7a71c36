/* registry/loader.h -- finds plugins, looks at them before they are mapped, loads them with libltdl
 * (local scope, all symbols bound now), checks their descriptors and lets them register. */
#ifndef REGISTRY_LOADER_H
#define REGISTRY_LOADER_H

#include "registry/registry.h"

/* Loads a plugin by path (has a slash, or ends in .so and exists) or by name. Names are looked
 * for in SPH_PLUGIN_PATH (colon-separated), the user's folder ($XDG_DATA_HOME/sph/plugins-0) and
 * the system's (SPH_PLUGINDIR, or relative to the program), each as NAME.so. "NAME.so" with no
 * such file here is taken as the name NAME. SPH_PLUGIN_PATH=:: switches all three off. A plugin
 * that is loaded already is not loaded twice. Refused (EXIT_REFUSED) with one sentence naming
 * the file: not found (with the folders searched and the nearest name), not readable, not ELF,
 * other machine, truncated or damaged, a file, folder or symbolic link that others own or may
 * write to, missing entry, missing symbol (the linker's own words), wrong magic, ABI major.minor
 * (both named), a struct too small or absurdly large, failing init, duplicate names (both files
 * named), contradictory descriptors (item and field named), a changed floating point mode, a
 * file that was exchanged while it was being loaded. A refused plugin leaves nothing behind,
 * neither entry nor mapping. [main] */
int loader_load(struct registry *r, const char *name_or_path, struct error *e);

/* A descriptor of the file that a plugin was loaded from, open for reading as long as the plugin is
 * loaded; -1: it is from no file. */
int loader_descriptor(const struct plugin *p);

/* The folders that are searched, in order. Caller frees with loader_folders_free. */
char **loader_folders(size_t *n);
void loader_folders_free(char **folders, size_t n);

/* Loads every plugin in the search folders, for `sph info`; those refused are reported to `refused`
 * (called with the sentence) and skipped. */
int loader_load_all(struct registry *r, void (*refused)(const char *sentence, void *),
                    void *context, struct error *e);

#endif
