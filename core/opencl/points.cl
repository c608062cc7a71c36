/* opencl/points.cl -- points on a device, and the number of the cell in which one is: what all
 * kernels of the search are made of.
 *
 * DIM: dimensions; CPU: explicit vectors pay; WG: work items of a group; EACH: things that a work
 * item takes one after the other. The structs are those of search.h. */
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

#define KERNEL __kernel __attribute__((reqd_work_group_size(WG, 1, 1)))
#define INLINE static inline __attribute__((always_inline))

#define NONE 0xffffffffu
#define LEVELS 12
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

/* -- Order -------- */

/* At the same place: by id, then by index. */
INLINE bool before_id(__global const double *wide, ulong id, uint i, uint j)
{
    const long p = as_long(wide[id + i]), q = as_long(wide[id + j]);

    return p != q ? p < q : i < j;
}
