/* sph/boundary.h -- a boundary condition: point or pair functions that act at named moments, at
 * named places of the scheme's recipe. A parameter that a scene sets on the condition reaches
 * every step of it whose function declares that name. */
#ifndef SPH_BOUNDARY_H
#define SPH_BOUNDARY_H

#include <sph/function.h>

SPH_BEGIN_DECLS

#define SPH_KIND_BOUNDARY "sph.boundary/0"
#define SPH_AT_START "start"       /* once, before the first evaluation */
#define SPH_AT_EVALUATE "evaluate" /* at every evaluation of the rates, in the scheme's order */
#define SPH_AT_FINISH "finish"     /* after every step: projections */

/* Which arrays a boundary condition's step acts on. A scene names the condition's own arrays
 * ("array") and those that it bounds ("with"); either may be left out, and means all then. A
 * scheme's steps act on all arrays, from all. */
#define SPH_ON_BOUNDARY 0u /* destinations: its own arrays; sources: those that it bounds */
#define SPH_ON_BOUNDED 1u  /* destinations: those that it bounds; sources: its own */

/* One step of a recipe. */
typedef struct sph_step {
    const char *at;   /* when: SPH_AT_... */
    const char *kind; /* SPH_KIND_FUNCTION, or SPH_KIND_EOS for "the material's own" */
    const char
        *name; /* of the function, of any plugin; ignored for the material's equation of state */
    /* Of a boundary condition: the place among the scheme's steps. Behind the last step of this
     * name ("eos" is the material's equation of state), or before the first one; where the recipe
     * has no such step, or both are NULL, at its end. At most one of the two. */
    const char *after, *before;
    uint32_t on; /* of a boundary condition: SPH_ON_... */
    uint32_t reserved;
} sph_step;

/* Elements of static lists of steps, as SPH_PROP. `at`: SPH_AT_... */
#define SPH_STEP(at, function)                                                                     \
    {                                                                                              \
        (at), SPH_KIND_FUNCTION, (function), NULL, NULL, SPH_ON_BOUNDARY, 0u                       \
    }
#define SPH_STEP_EOS(at)                                                                           \
    {                                                                                              \
        (at), SPH_KIND_EOS, "", NULL, NULL, SPH_ON_BOUNDARY, 0u                                    \
    }
/* Of a boundary condition; after, before: a step's name or NULL; on: SPH_ON_... */
#define SPH_STEP_AT(at, function, after, before, on)                                               \
    {                                                                                              \
        (at), SPH_KIND_FUNCTION, (function), (after), (before), (on), 0u                           \
    }

/* What register_item takes for SPH_KIND_BOUNDARY. It has no code of its own: that is in the
 * functions that its steps name, which are looked up when a scene uses it. */
typedef struct sph_boundary {
    uint32_t size, reserved;
    const sph_item *item; /* params: none of its own; props: none */
    sph_list steps;       /* of sph_step, in order; at least one */
} sph_boundary;

SPH_END_DECLS
#endif
