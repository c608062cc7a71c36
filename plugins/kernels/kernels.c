/* kernels.c -- the plugin "kernels": B-splines and Wendland functions, as data, and a Gaussian. */
#include <sph/plugin.h>

#include "kernels.h"

static sph_status init(const sph_host *host)
{
    for (int i = 0; i < N_BSPLINES; i++) {
        const sph_status status = host->register_item(host, SPH_KIND_KERNEL, &bspline[i]);
        if (status != SPH_OK)
            return status;
    }
    for (int i = 0; i < N_WENDLANDS; i++) {
        const sph_status status = host->register_item(host, SPH_KIND_KERNEL, &wendland[i]);
        if (status != SPH_OK)
            return status;
    }
    return host->register_item(host, SPH_KIND_KERNEL, &gaussian);
}

SPH_PLUGIN("kernels", "0.1", "BSD-3-Clause",
           "smoothing kernels: B-splines, Wendland functions, a Gaussian", init, NULL)
