/* rig.h -- for tests of plan and run: a scene's text and functions of the test's own made into a plan,
 * without any file. */
#ifndef TESTS_UNIT_RIG_H
#define TESTS_UNIT_RIG_H

#include "plan/plan.h"

#define RIG_MOST 16

/* What the rig's plugin registers, besides the kernel "thing" (the cubic spline of mock.c). Each list ends
 * with NULL. */
struct rig_items {
    const sph_function *function[RIG_MOST];
    const sph_eos *eos[RIG_MOST];
    const sph_scheme *scheme[RIG_MOST];
    const sph_boundary *boundary[RIG_MOST];
    sph_status (*more)(const sph_host *); /* called last in init; or NULL */
};

struct rig {
    char *text;
    struct document document;
    struct scene scene;
    struct registry registry;
    struct plan plan;
    bool has_document, has_scene, has_registry, has_plan;
};

/* `scene`: JSON with ' in place of ", printf-like. Until rig_close, not to be moved; rig_close also
 * after a failure. The particles are filled. */
int rig_make(struct rig *r, const struct rig_items *items, struct error *e, const char *scene, ...)
    __attribute__((format(printf, 4, 5)));
/* As above; the test fails if it cannot. */
void rig_open(struct rig *r, const struct rig_items *items, const char *scene, ...)
    __attribute__((format(printf, 3, 4)));
void rig_close(struct rig *r);
/* The test fails unless the scene is refused with EXIT_USAGE and a sentence that holds `text`. */
void rig_refused(const struct rig_items *items, const char *text, const char *scene, ...)
    __attribute__((format(printf, 3, 4)));

/* Component c of a real column of array `a`; the test fails if there is none. */
double *rig_real(const struct rig *r, size_t a, const char *column, uint32_t c);

#endif
