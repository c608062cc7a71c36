/* sph/time_step.h -- extension: a bound on the time step that no property of the particles holds,
 * such as a moving wall's own. (One that does is a reduction with SPH_USE_TIME_STEP.) */
#ifndef SPH_TIME_STEP_H
#define SPH_TIME_STEP_H

#include <sph/batch.h>

SPH_BEGIN_DECLS

#define SPH_EXT_TIME_STEP "sph.time-step/0"

typedef struct sph_time_step {
    uint32_t size, reserved;
    /* The next step shall be no longer than dt [s]; the scene's cfl is not applied to it. The
     * smallest of all proposals since the last step began holds, and is then forgotten: propose at
     * every evaluation. SPH_E_INVALID if dt is not a positive number, and without a run
     * (batch->run NULL). [any], from a function's prepare, before, run and after */
    sph_status (*propose)(const sph_batch *, double dt);
} sph_time_step;

SPH_END_DECLS
#endif
