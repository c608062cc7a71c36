/* opencl/ops_columns.cl -- kernels on columns, particle by particle: mirrors, order, the integrator. */

/* Of a work item: its particles, at most n, all at once or one by one. */
#if WIDE == 8
#define EACH(n, all, one)                                                                          \
    ulong i = (ulong)get_global_id(0) * 8;                                                         \
    if (i + 8 <= (n)) {                                                                            \
        all;                                                                                       \
    } else {                                                                                       \
        for (; i < (n); i++) {                                                                     \
            one;                                                                                   \
        }                                                                                          \
    }
#else
#define EACH(n, all, one)                                                                          \
    const ulong i = get_global_id(0);                                                              \
    if (i < (n)) {                                                                                 \
        one;                                                                                       \
    }
#endif

kernel void mirror_floats(global const double *wide, global float *narrow, ulong plane, uint from,
                          uint to, uint ncomp, ulong n)
{
    EACH(n, for (uint k = 0; k < ncomp; k++) mirror_8(wide, narrow, from, to, k, plane, i),
         for (uint k = 0; k < ncomp; k++) mirror_1(wide, narrow, from, to, k, plane, i))
}

kernel void mirror_places(global const double *wide, global float *narrow, ulong plane, uint from,
                          uint to, double cx, double cy, double cz, double inverse, ulong n,
                          global uint *flags)
{
    const double centre[3] = {cx, cy, cz};
    uint bad = 0;
    EACH(n,
         for (uint k = 0; k < DIM; k++) bad |=
         place_8(wide, narrow, from, to, k, plane, centre[k], inverse, i),
         for (uint k = 0; k < DIM; k++) bad |=
         place_1(wide, narrow, from, to, k, plane, centre[k], inverse, i))
    if (bad)
        atomic_or(flags, bad);
}

kernel void skin_keep(global const double *wide, global const float *narrow, ulong plane, uint slot,
                      uint ncomp, global double *kept, ulong stride, ulong n)
{
    EACH(n, for (uint k = 0; k < ncomp; k++)
                keep_8(wide, narrow, slot, k, plane, kept + k * stride, i),
         for (uint k = 0; k < ncomp; k++)
             keep_1(wide, narrow, slot, k, plane, kept + k * stride, i))
}

kernel void advance(global double *wide, global float *narrow, ulong plane,
                    constant struct action *action, uint n_action, double dt, ulong n,
                    global uint *flags)
{
    uint bad = 0;
    EACH(n, bad |= advance_8(wide, narrow, plane, action, n_action, dt, i),
         bad |= advance_1(wide, narrow, plane, action, n_action, dt, i))
    if (bad)
        atomic_or(flags, bad);
}

/* to[i] = from[order[i]] of a plane, bit for bit. */
kernel void permute(global const ulong *wide, global const uint *narrow, ulong plane, uint slot,
                    global const uint *order, global ulong *to, uint n, global uint *flags)
{
    const uint i = get_global_id(0);
    if (i >= n)
        return;
    uint old = order[i];
    if (old >= n) {
        atomic_or(flags, FLAG_ORDER);
        old = 0;
    }
    if (slot & NARROW)
        ((global uint *)to)[i] = narrow[at_of(slot, 0, plane) + old];
    else
        to[i] = wide[at_of(slot, 0, plane) + old];
}
