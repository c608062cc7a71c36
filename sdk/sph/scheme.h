/* sph/scheme.h -- a scheme: a recipe of operations, which a scene may edit. A parameter set on the
 * scheme reaches every step whose function declares that name. */
#ifndef SPH_SCHEME_H
#define SPH_SCHEME_H

#include <sph/batch.h>
#include <sph/boundary.h>

SPH_BEGIN_DECLS

#define SPH_KIND_SCHEME "sph.scheme/0"

/* What register_item takes for SPH_KIND_SCHEME. It has no code of its own: the functions, kernel
 * and integrator that it names are looked up when a scene uses it, and may be other plugins'. */
typedef struct sph_scheme {
    uint32_t size, reserved;
    const sph_item *item;   /* params: none of its own; props: none */
    const char *kernel;     /* default kernel, by name; NULL: none, for recipes without pairs */
    const char *integrator; /* default integrator, by name */
    double cfl;             /* default time-step number, a pure number > 0 */
    sph_list steps;         /* of sph_step, in order; at least one */
    sph_list rates;         /* of sph_rate: those no function declares, x by v among them */
    uint32_t reals; /* what a run takes unless its user says otherwise: SPH_F32: pair sums in
                             * floats, where positions' differences stay exact ("mixed"); 0 or SPH_F64:
                             * doubles throughout */
    uint32_t reserved2;
} sph_scheme;

SPH_END_DECLS
#endif
