/* opencl/ops_words.cl -- what the core's kernels on columns have in common: where a column's values are, and
 * which of them stand in 4 bytes. A slot is a number of planes in its buffer; NARROW tells which buffer.
 * DIM and WIDE (a work item does 8 particles, or 1) come from the command line of the build. */
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

#define NARROW 0x80000000u
#define MISSING 0xffffffffu
#define FLAG_RATE 1u
#define FLAG_NOWHERE 2u
#define FLAG_ORDER 4u

/* As ops_advance.c fills it: to = w base + w_also also + a dt (r - r0) + a2 dt^2 r2 of ncomp components, but for
 * what is MISSING; without `also` w counts as 1. */
#define ACTION_SWAPS 1u /* to and base trade their values instead */
#define ACTION_RATE 2u  /* to is a rate, and looked at */
struct action {
    uint to, base, also, r, r0, r2, ncomp, what;
    double w, w_also, a, a2;
};

static inline ulong at_of(uint slot, uint k, ulong plane)
{
    return ((slot & ~NARROW) + k) * plane;
}

static inline double real_get(global const double *wide, global const float *narrow, uint slot,
                              uint k, ulong plane, ulong i)
{
    const ulong at = at_of(slot, k, plane) + i;
    return slot & NARROW ? (double)narrow[at] : wide[at];
}

static inline void real_set(global double *wide, global float *narrow, uint slot, uint k,
                            ulong plane, ulong i, double value)
{
    const ulong at = at_of(slot, k, plane) + i;
    if (slot & NARROW)
        narrow[at] = (float)value;
    else
        wide[at] = value;
}
