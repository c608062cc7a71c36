/* opencl/survey.cl -- what there is to know of points, and the cells in which they are. */

#define SLICE 4096
#define FAR 1e150 /* squares of distances must be numbers too */

/* -- What there is to know -------- */

/* Of slice s lane l: elements s * SLICE + l, + 8, ...: least and largest of each axis, sum and
 * largest of h, how many numbers are none: out[(s * (2 DIM + 3) + quantity) * 8 + l]. One sum a
 * lane, on all devices alike. */
#if CPU
KERNEL void survey(__global const double *wide, struct points p, uint first, uint has_h,
                   __global double *out)
{
    const uint s = (uint)get_global_id(0);
    const ulong begin = first + (ulong)s * SLICE;
    double8 low[DIM], high[DIM], sum = 0.0, largest = -INFINITY;
    long8 bad = 0;

    if (begin >= p.n) {
        return;
    }
    const uint end = (uint)min(begin + SLICE, (ulong)p.n);

    FOR_AXES
    {
        low[a] = INFINITY;
        high[a] = -INFINITY;
    }
    for (uint i = (uint)begin; i < end; i += 8) {
        const bool whole = end - i >= 8;

        FOR_AXES
        {
            const double8 x = load8(wide + p.x + a * p.plane, i, end);

            low[a] = less(x, low[a]);
            high[a] = more(x, high[a]);
            bad |= ~(fabs(x) < FAR);
        }
        if (has_h) {
            const double8 h = load8(wide + p.h, i, end);

            largest = more(h, largest);
            bad |= ~(h >= 0.0 & h < FAR);
            if (whole) {
                sum += h;
            } else {
                const long8 in = (long8)(0, 1, 2, 3, 4, 5, 6, 7) < (long)(end - i);

                sum = in ? sum + h : sum;
            }
        }
    }
    out += (ulong)s * (2 * DIM + 3) * 8;
    FOR_AXES
    {
        vstore8(low[a], 2 * a, out);
        vstore8(high[a], 2 * a + 1, out);
    }
    vstore8(sum, 2 * DIM, out);
    vstore8(largest, 2 * DIM + 1, out);
    vstore8(convert_double8(bad), 2 * DIM + 2, out);
}
#else
KERNEL void survey(__global const double *wide, struct points p, uint first, uint has_h,
                   __global double *out)
{
    const uint s = (uint)(get_global_id(0) / 8), l = (uint)(get_global_id(0) % 8);
    const ulong begin = first + (ulong)s * SLICE;
    double low[DIM], high[DIM], sum = 0.0, largest = -INFINITY, bad = 0.0;

    if (begin >= p.n) {
        return;
    }
    const ulong end = min(begin + SLICE, (ulong)p.n);

    FOR_AXES
    {
        low[a] = INFINITY;
        high[a] = -INFINITY;
    }
    for (ulong i = begin + l; i < end; i += 8) {
        FOR_AXES
        {
            const double x = wide[p.x + a * p.plane + i];

            low[a] = x < low[a] ? x : low[a];
            high[a] = x > high[a] ? x : high[a];
            bad += !(fabs(x) < FAR);
        }
        if (has_h) {
            const double h = wide[p.h + i];

            largest = h > largest ? h : largest;
            bad += !(h >= 0.0 && h < FAR);
            sum += h;
        }
    }
    out += (ulong)s * (2 * DIM + 3) * 8 + l;
    FOR_AXES
    {
        out[16 * a] = low[a];
        out[16 * a + 8] = high[a];
    }
    out[16 * DIM] = sum;
    out[16 * DIM + 8] = largest;
    out[16 * DIM + 16] = bad;
}
#endif

/* -- Cells -------- */

/* Each point's cell, and how many are in each. */
KERNEL void cells_count(__global const double *wide, struct points p, struct index g,
                        __global uint *cell, __global uint *count)
{
    const ulong begin = (ulong)get_global_id(0) * EACH, end = min(begin + EACH, (ulong)p.n);

    for (ulong i = begin; i < end; i++) {
        const uint c = (uint)cell_of(&g, wide, p, i);

        cell[i] = c;
        atomic_inc(&count[c]);
    }
}

/* Puts points into their cells, in no order: at[c] is where cell c begins and then where it ends. */
KERNEL void cells_scatter(__global const uint *cell, uint n, __global uint *at,
                          __global uint *order)
{
    const ulong begin = (ulong)get_global_id(0) * EACH, end = min(begin + EACH, (ulong)n);

    for (ulong i = begin; i < end; i++) {
        order[atomic_inc(&at[cell[i]])] = (uint)i;
    }
}
