/* sph/boundary.h -- a boundary condition: point or pair functions that act at named moments. */
#ifndef SPH_BOUNDARY_H
#define SPH_BOUNDARY_H

#include <sph/function.h>

SPH_BEGIN_DECLS

#define SPH_KIND_BOUNDARY "sph.boundary/0"
#define SPH_AT_START "start"       /* once, before the first evaluation */
#define SPH_AT_EVALUATE "evaluate" /* at every evaluation of the rates, in the scheme's order */
#define SPH_AT_FINISH "finish"     /* after every step: projections */

/* One step of a recipe. */
typedef struct sph_step {
    const char *at;   /* SPH_AT_... */
    const char *kind; /* SPH_KIND_FUNCTION, or SPH_KIND_EOS for "the material's own" */
    const char *name; /* of the function; ignored for the material's equation of state */
} sph_step;

typedef struct sph_boundary {
    uint32_t size, reserved;
    const sph_item *item;
    sph_list steps; /* of sph_step */
} sph_boundary;

SPH_END_DECLS
#endif
