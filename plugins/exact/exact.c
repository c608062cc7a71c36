/* exact.c -- the plugin "exact": exact solutions, for error norms. */
#include <sph/plugin.h>

#include "exact.h"

static sph_status init(const sph_host *host)
{
    static const sph_exact *const all[] = {
        /* gases */
        &riemann,
        &noh,
        &sedov,
        &acoustic_wave,
        &gresho,
        /* liquids */
        &taylor_green,
        &poiseuille,
        &couette,
        &standing_wave,
        &elliptical_drop,
        &hydrostatics,
        &rotating_patch,
        /* solids */
        &plate,
        &planar_impact,
    };
    sph_status status = SPH_OK;

    for (size_t k = 0; k < sizeof(all) / sizeof(all[0]) && status == SPH_OK; k++)
        status = host->register_item(host, SPH_KIND_EXACT, all[k]);
    return status;
}

SPH_PLUGIN("exact", "0.1", "BSD-3-Clause",
           "exact solutions: gases (shock tubes, implosion, explosion, waves, a vortex), liquids "
           "(viscous flows, waves, a drop, a tank), solids (plate, impact)",
           init, NULL)
