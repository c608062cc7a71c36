/* opencl/own_order.cl -- an order of the search's own: keys to sort points by, and a copy of them in
 * that order. */

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

/* The cells' numbers along the axes, bit by bit in turns: as octree.c has it. */
INLINE ulong morton_of(const struct index *g, __global const double *wide, struct points p, ulong i)
{
    ulong key = 0;

    FOR_AXES
    {
        const ulong c = along(g, a, wide[p.x + a * p.plane + i]);

        key |= (DIM == 3 ? spread3(c) : DIM == 2 ? spread2(c) : c) << a;
    }
    return key;
}

/* Of each point its cell's number, or its place along Morton's curve; and its index. */
KERNEL void keys(__global const double *wide, struct points p, struct index g, uint morton,
                 __global ulong *key, __global uint *order)
{
    const ulong begin = (ulong)get_global_id(0) * EACH, end = min(begin + EACH, (ulong)p.n);

    for (ulong i = begin; i < end; i++) {
        key[i] = morton ? morton_of(&g, wide, p, i) : cell_of(&g, wide, p, i);
        order[i] = (uint)i;
    }
}
