/* check/checks.h -- the table of checks: small and independent of each other, each in a file of its
 * own. */
#ifndef CHECK_CHECKS_H
#define CHECK_CHECKS_H

#include "check/bench.h"
#include "check/child.h"

#define CHECK_KIND(k) (1u << (k))
#define CHECK_RUNS (CHECK_KIND(KIND_FUNCTION) | CHECK_KIND(KIND_EOS) | CHECK_KIND(KIND_EXACT))
#define CHECK_ALL (CHECK_KIND(KIND_COUNT) - 1u)

struct check {
    const char *name, *doc;
    uint32_t kinds; /* CHECK_KIND bits of those that it is for */
    child_work work;
    bool calm; /* not made of an item that has failed already: it would fall over the same fault */
    double patience; /* times the longest time that a check may take */
};
extern const struct check check_table[];
extern const size_t n_check;

void check_declared(const struct subject *s);     /* check_declared.c */
void check_integral(const struct subject *s);     /* check_kernel.c */
void check_life(const struct subject *s);         /* check_life.c */
void check_state(const struct subject *s);        /* check_state.c */
void check_eos(const struct subject *s);          /* check_eos.c */
void check_calls(const struct subject *s);        /* check_calls.c */
void check_kept(const struct subject *s);         /* check_kept.c */
void check_conservation(const struct subject *s); /* check_conservation.c */
void check_recipe(const struct subject *s);       /* check_recipe.c */
void check_paths(const struct subject *s);        /* check_paths.c */
void check_device(const struct subject *s);       /* check_device.c */
/* The part of check_device that is for what destinations do alone: `run` of point functions and
 * equations of state, `before` and `after`; in check_points.c. */
void check_points(const struct subject *s);

/* table.c: what of an item is called: the function, or run and inverse. At most 2; returns how
 * many. */
size_t passes_of(const struct entry *x, struct pass_spec out[2]);

#endif
