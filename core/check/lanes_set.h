/* check/lanes_set.h -- a kernel evaluated with the words of sph/lanes.h; the inside of lanes.c,
 * included by sph/each-isa.h once for each instruction set. */
static void SPH_OF_ISA(evaluate)(const sph_kernel_form *form, const double *q, double *w,
                                 double *dw, size_t n)
{
    for (size_t i = 0; i + SPH_WIDTH <= n; i += SPH_WIDTH) {
        const SPH_OF_ISA(sph_lanes) at = SPH_OF_ISA(sph_load_)(q + i);
        const SPH_OF_ISA(sph_lanes) value = SPH_OF_ISA(sph_w_)(form, at);
        const SPH_OF_ISA(sph_lanes) slope = SPH_OF_ISA(sph_dw_)(form, at);
        for (size_t l = 0; l < SPH_WIDTH; l++) {
            w[i + l] = value[l];
            dw[i + l] = slope[l];
        }
    }
}
