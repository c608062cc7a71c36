/* check/lanes_set.h -- a kernel evaluated with the words of sph/lanes.h; the inside of lanes.c,
 * included by sph/each-isa.h once for each instruction set and precision. */
static void SPH_OF_ISA(evaluate)(const sph_kernel_form *form, const double *q, int shape,
                                 const struct lanes_out *out, size_t n)
{
    SPH_OF_ISA(sph_form) local;

    SPH_OF_ISA(sph_form_)(&local, form);
    for (size_t i = 0; i + SPH_WIDTH <= n; i += SPH_WIDTH) {
        SPH_OF_ISA(sph_lanes) at = {0}, w, dw, dw_q;
        for (size_t l = 0; l < SPH_WIDTH; l++)
            at[l] = (SPH_OF_ISA(sph_real))q[i + l];
        /* A shape is a constant where a loop is compiled for it. */
        w = shape == SPH_SHAPE_C2   ? SPH_OF_ISA(sph_w_)(&local, at, SPH_SHAPE_C2)
            : shape == SPH_SHAPE_C4 ? SPH_OF_ISA(sph_w_)(&local, at, SPH_SHAPE_C4)
                                    : SPH_OF_ISA(sph_w_)(&local, at, SPH_SHAPE_ANY);
        dw = shape == SPH_SHAPE_C2   ? SPH_OF_ISA(sph_dw_)(&local, at, SPH_SHAPE_C2)
             : shape == SPH_SHAPE_C4 ? SPH_OF_ISA(sph_dw_)(&local, at, SPH_SHAPE_C4)
                                     : SPH_OF_ISA(sph_dw_)(&local, at, SPH_SHAPE_ANY);
        dw_q = shape == SPH_SHAPE_C2   ? SPH_OF_ISA(sph_dw_q_)(&local, at, SPH_SHAPE_C2)
               : shape == SPH_SHAPE_C4 ? SPH_OF_ISA(sph_dw_q_)(&local, at, SPH_SHAPE_C4)
                                       : SPH_OF_ISA(sph_dw_q_)(&local, at, SPH_SHAPE_ANY);
        for (size_t l = 0; l < SPH_WIDTH; l++) {
            out->w[i + l] = (double)w[l];
            out->dw[i + l] = (double)dw[l];
            out->dw_q[i + l] = (double)dw_q[l];
        }
    }
}
