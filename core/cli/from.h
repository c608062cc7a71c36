/* cli/from.h -- what `sph new-plugin --from` makes a plugin of: functions that a scene brings as texts. */
#ifndef CLI_FROM_H
#define CLI_FROM_H

#include "cli/scene_options.h"

/* A file that goes into the project; name NULL: the end. */
struct from_file {
    const char *name; /* in the project: within path */
    const char *path, *text;
};

struct from {
    struct loaded loaded;
    char *scene,
        *function;    /* that were asked for; function NULL: all that `body` belongs to, or all */
    const char *body; /* as the user gave it, or NULL */
    const struct entry **entry;
    size_t n; /* functions that become native */
    struct from_file *file;
    size_t n_file;
};

/* "SCENE.json", "SCENE.json:FUNCTION", or a body's file, which one scene in its folder names. On failure the
 * caller still calls from_free. */
int from_open(struct from *f, const char *what, struct error *e);
void from_free(struct from *f);

/* The names of all bodies and preludes, with a blank between, in fresh memory. */
char *from_headers(const struct from *f);
/* "`drag`, a drag; `other`, ...", likewise. */
char *from_words(const struct from *f);
/* Those files as they are, the scene with the plugin in their place (scene.json), and NAME.c, in `folder`. */
int from_write(const struct from *f, const char *folder, const char *name, struct error *e);

/* from_source.c: NAME.c. */
int from_source(const struct from *f, const char *name, FILE *out);

#endif
