/* sph/eos.h -- an equation of state: a point function on the state of a material. */
#ifndef SPH_EOS_H
#define SPH_EOS_H

#include <sph/batch.h>
#include <sph/device.h>
#include <sph/item.h>

SPH_BEGIN_DECLS

#define SPH_KIND_EOS "sph.eos/0"

/* What register_item takes for SPH_KIND_EOS. Its parameters are set in a scene's material. */
typedef struct sph_eos {
    uint32_t size, reserved;
    const sph_item *item; /* props: what `run` reads (rho, u) and writes (p, cs); no sources */
    const sph_life *life; /* or NULL */
    sph_range_fn run;     /* from rho and u to p and cs, at the scheme's SPH_KIND_EOS. [worker] */
    /* The inverse, for initial states given by what `run` writes: from p and rho to u. The host
     * uses it where a scene gives a field that run writes instead of one that it reads. [worker],
     * once, before the first step */
    sph_range_fn inverse;           /* or NULL */
    sph_list inverse_props;         /* of sph_prop; columns of the inverse's batch, in this order */
    const sph_device_point *device; /* `run` for a device (device.h); NULL: none */
} sph_eos;

SPH_END_DECLS
#endif
