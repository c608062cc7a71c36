/* opencl/points.cl -- points on a device, what there is to know of them, and the cells in which
 * they are.
 *
 * DIM: dimensions; CPU: explicit vectors pay; WG: work items of a group; EACH: things that a work
 * item takes one after the other. The structs are those of search.h. */
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

#define KERNEL __kernel __attribute__((reqd_work_group_size(WG, 1, 1)))
#define INLINE static inline __attribute__((always_inline))

#define NONE 0xffffffffu
#define LEVELS 12
#define SLICE 4096
#define FAR 1e150 /* squares of distances must be numbers too */
/* Compilers leave short loops as they are unless told. */
#define UNROLL _Pragma("unroll")
#define FOR_AXES UNROLL for (uint a = 0; a < DIM; a++)

struct points {
    ulong x, h, plane;
    double scale;
    uint n, pad;
};

struct index {
    double low[3], last[3], inverse, reach;
    ulong step[3];
    uint n, n_leaf, n_level, pad, offset[LEVELS], nodes[LEVELS];
};

/* Numbers of eight lanes; what is no number is passed over by `less` and `more`, as it is on the
 * host. */
INLINE double8 less(double8 x, double8 than)
{
    return x < than ? x : than;
}

INLINE double8 more(double8 x, double8 than)
{
    return x > than ? x : than;
}

INLINE double least_of(double8 v)
{
    const double4 p = v.lo < v.hi ? v.lo : v.hi;
    const double2 q = p.lo < p.hi ? p.lo : p.hi;

    return q.x < q.y ? q.x : q.y;
}

INLINE double most_of(double8 v)
{
    const double4 p = v.lo > v.hi ? v.lo : v.hi;
    const double2 q = p.lo > p.hi ? p.lo : p.hi;

    return q.x > q.y ? q.x : q.y;
}

/* Elements first ... first + 7, those beyond `last` as the one before it. */
INLINE double8 load8(__global const double *x, uint first, uint last)
{
    if (last - first >= 8) {
        return vload8(0, x + first);
    }
    const uint m = last - 1 - first;

    return (double8)(x[first], x[first + min(1u, m)], x[first + min(2u, m)], x[first + min(3u, m)],
                     x[first + min(4u, m)], x[first + min(5u, m)], x[first + min(6u, m)],
                     x[first + min(7u, m)]);
}

/* Eight masks of 0 or -1 to a bit each. */
INLINE uint bits_of(char8 mask)
{
    return (uint)((as_ulong(mask) & 0x8040201008040201UL) * 0x0101010101010101UL >> 56);
}

INLINE uint first_bit(uint mask)
{
    return 31 - clz(mask & -mask);
}

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

/* -- An order of the search's own -------- */

/* to: planes of `plane` elements, position and h. */
KERNEL void gather(__global const double *wide, struct points p, uint has_h,
                   __global const uint *order, __global double *to, ulong plane)
{
    const ulong begin = (ulong)get_global_id(0) * EACH, end = min(begin + EACH, (ulong)p.n);

    FOR_AXES
    {
        for (ulong i = begin; i < end; i++) {
            to[a * plane + i] = wide[p.x + a * p.plane + order[i]];
        }
    }
    for (ulong i = begin; i < end && has_h; i++) {
        to[DIM * plane + i] = wide[p.h + order[i]];
    }
}

/* -- Cells -------- */

/* The number along an axis of the cell that holds x, or is nearest to it. */
INLINE ulong along(const struct index *g, uint axis, double x)
{
    double q = (x - g->low[axis]) * g->inverse;

    q = q < g->last[axis] ? q : g->last[axis];
    return q > 0 ? (ulong)q : 0;
}

INLINE ulong cell_of(const struct index *g, __global const double *wide, struct points p, ulong i)
{
    ulong cell = along(g, 0, wide[p.x + i]);

    for (uint a = 1; a < DIM; a++) {
        cell += g->step[a] * along(g, a, wide[p.x + a * p.plane + i]);
    }
    return cell;
}

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

KERNEL void cells_key(__global const double *wide, struct points p, struct index g,
                      __global ulong *key, __global uint *order)
{
    const ulong begin = (ulong)get_global_id(0) * EACH, end = min(begin + EACH, (ulong)p.n);

    for (ulong i = begin; i < end; i++) {
        key[i] = cell_of(&g, wide, p, i);
        order[i] = (uint)i;
    }
}

/* The lowest 21 bits, two apart. */
INLINE ulong spread3(ulong x)
{
    x = (x | x << 32) & 0x001f00000000ffffUL;
    x = (x | x << 16) & 0x001f0000ff0000ffUL;
    x = (x | x << 8) & 0x100f00f00f00f00fUL;
    x = (x | x << 4) & 0x10c30c30c30c30c3UL;
    return (x | x << 2) & 0x1249249249249249UL;
}

/* The lowest 30 bits, one apart. */
INLINE ulong spread2(ulong x)
{
    x = (x | x << 16) & 0x0000ffff0000ffffUL;
    x = (x | x << 8) & 0x00ff00ff00ff00ffUL;
    x = (x | x << 4) & 0x0f0f0f0f0f0f0f0fUL;
    x = (x | x << 2) & 0x3333333333333333UL;
    return (x | x << 1) & 0x5555555555555555UL;
}

/* Of octree.c: the cells' numbers along the axes, bit by bit in turns. */
KERNEL void morton_key(__global const double *wide, struct points p, struct index g,
                       __global ulong *key, __global uint *order)
{
    const ulong begin = (ulong)get_global_id(0) * EACH, end = min(begin + EACH, (ulong)p.n);

    for (ulong i = begin; i < end; i++) {
        ulong k = 0;

        FOR_AXES
        {
            const ulong c = along(&g, a, wide[p.x + a * p.plane + i]);

            k |= (DIM == 3 ? spread3(c) : DIM == 2 ? spread2(c) : c) << a;
        }
        key[i] = k;
        order[i] = (uint)i;
    }
}
