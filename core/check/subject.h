/* check/subject.h -- what a check is given: one registered item, the values that the user chose for
 * it, and a way to say its verdicts. Checks run in a child process (child.h), one at a time. */
#ifndef CHECK_SUBJECT_H
#define CHECK_SUBJECT_H

#include "check/report.h"
#include "plan/plan.h"
#include "registry/registry.h"

#define SUBJECT_WORD 64 /* bytes of an item's or a property's name */

/* --set ITEM.NAME=VALUE or LOW:HIGH, of a parameter or a property. */
struct setting {
    const char *argument; /* as given */
    char item[SUBJECT_WORD], name[SUBJECT_WORD];
    const char *value; /* behind the '=' */
    double low, high;  /* of a property; NaN: no numbers */
};

/* What the child does now, for a verdict on a call that does not return; shared with the parent. */
struct stage {
    char text[256];
    int foreign; /* 1: other items run, whose faults are not this one's */
};

struct subject {
    struct registry *registry;
    const struct entry *entry;
    struct setting *setting;
    size_t n_setting;
    struct stage *stage;
    int out; /* the pipe to the parent */
};

/* "function", "eos", ...: short words for the lines. */
extern const char *const subject_kind[KIND_COUNT];

/* One verdict; printf-like. In the child. */
void say(const struct subject *s, enum verdict v, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* What is done now, as "run in 2 dimensions, 1000 particles". */
void stage(const struct subject *s, const char *format, ...) __attribute__((format(printf, 2, 3)));

bool subject_works_in(const struct subject *s, int dim);
/* "1, 2, 3 dimensions" */
const char *subject_dims(const struct subject *s, char *out, size_t size);

/* A use of the item with the user's values, defaults, and where there are none, values of ours. Not
 * yet created. Fails if a table is mandatory, or a value wrong. */
int subject_configure(const struct subject *s, struct use *u, struct error *e);
/* The value that a parameter without default is given. */
double subject_invented(const sph_param *p);
/* The user's setting of a name of this item, or NULL. */
const struct setting *subject_setting(const struct subject *s, const char *name);

/* Parses one --set; fails (EXIT_USAGE) if it has not the form. Whether the name exists is not seen.
 */
int setting_parse(struct setting *out, const char *argument, struct error *e);
/* Fails unless all settings name an item of a plugin from `first` on, and something that it
 * declares. */
int settings_check(const struct registry *r, size_t first, const struct setting *setting, size_t n,
                   struct error *e);

#endif
