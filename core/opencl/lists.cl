/* opencl/lists.cl -- the sources of groups of eight destinations, group by group: counted, then
 * written where the running sums of the counts say; and what is true of them. In doubles and exact,
 * whatever the group looks like: on a processor bundles.cl does most groups faster.
 *
 * counts: planes of `stride` uints, of the groups from `from` on: all sources of a group, those
 * of both halves, of the lower, of the upper one; 1 if it is done here. */

#define MANY (CPU ? 32u : 1u) /* groups that a work item takes */

enum { ALL, BOTH, LOWER, UPPER, HERE };

/* A stretch of groups of the list. */
struct stretch {
    uint from, n, stride, pad;
};

struct found {
    uint n[4]; /* as counts; that of ALL is not looked at */
};

/* Where the k-th of a side goes, from the group's beginning: those of both halves first, what is
 * left over of the longer side next, then lower and upper in turns. */
INLINE uint place_of(const struct found *f, uint side, uint k)
{
    const uint turns = min(f->n[LOWER], f->n[UPPER]);
    const uint common = f->n[BOTH] + max(f->n[LOWER], f->n[UPPER]) - turns;

    if (side == BOTH) {
        return k;
    }
    return k < turns ? common + 2 * k + (side == UPPER) : f->n[BOTH] + k - turns;
}

/* Bits of the sources [first, last), at most eight: seen by the lower half of the lanes, by the
 * upper half. */
INLINE uint2 sees(const struct asked *q, __global const double *wide, struct points src, uint first,
                  uint last)
{
    double8 own = 0.0, x[DIM];
    long8 near[2] = {0, 0};

    FOR_AXES x[a] = load8(wide + src.x + a * src.plane, first, last);
    if (src.scale > 0) {
        own = src.scale * load8(wide + src.h, first, last);
        own *= own;
    }
    UNROLL for (uint l = 0; l < 8; l++)
    {
        double8 r2 = 0.0;

        FOR_AXES
        {
            const double8 d = q->x[a][l] - x[a];

            r2 += d * d;
        }
        near[l / 4] |= r2 <= more((double8)q->r2[l], own);
    }
    return (uint2)(bits_of(convert_char8(near[0])), bits_of(convert_char8(near[1]))) &
           (0xffu >> (8 - (last - first)));
}

/* Those of a side, from `first` on: written, if they are, and counted. */
INLINE void found_add(struct found *f, uint side, uint mask, uint first, __global const uint *order,
                      uint mapped, const struct found *known, __global uint *out)
{
    for (; mask && out; mask &= mask - 1) {
        const uint j = first + first_bit(mask);

        out[place_of(known, side, f->n[side]++)] = mapped ? order[j] : j;
    }
    f->n[side] += popcount(mask);
}

/* Of some of a leaf's sources those that are in the group itself. */
INLINE uint own_of(uint mask, uint first, __global const uint *order, uint mapped, uint group)
{
    uint own = 0;

    if (!mapped) {
        return first / 8 == group ? mask : 0;
    }
    for (; mask; mask &= mask - 1) {
        const uint k = first_bit(mask);

        own |= (uint)(order[first + k] / 8 == group) << k;
    }
    return own;
}

/* Counts them, or writes them to `out` by counts that are known. */
INLINE struct found group_do(const struct asked *q, const struct index *s, INDEX,
                             __global const double *wide, struct points src,
                             __global const uint *order, uint mapped, uint group,
                             const struct found *known, __global uint *out)
{
    struct found f = {{0, 0, 0, 0}};
    struct walk w;
    uint block, mask;

    walk_begin(&w, s, FOUND_IN, q);
    while (walk_next(&w, s, FOUND_IN, q, &block, &mask)) {
        for (; mask; mask &= mask - 1) {
            const uint first = (block * 8 + first_bit(mask)) * 8;
            const uint2 m = sees(q, wide, src, first, min(first + 8, s->n));
            const uint all = m.x | m.y;
            const uint both = (m.x & m.y) | own_of(all, first, order, mapped, group);

            found_add(&f, BOTH, both, first, order, mapped, known, out);
            found_add(&f, LOWER, m.x & ~both, first, order, mapped, known, out);
            found_add(&f, UPPER, m.y & ~both, first, order, mapped, known, out);
        }
    }
    return f;
}

INLINE struct found counted(__global const uint *c, uint stride)
{
    struct found f = {{0, c[BOTH * stride], c[LOWER * stride], c[UPPER * stride]}};

    return f;
}

/* Counts the groups that are done here, or all; or else, `fill`, writes their sources by those counts, and says
 * where turns begin: nothing of a list that has no room for what comes up to here. */
KERNEL void list_make(__global const double *dst_wide, struct points dst, double factor,
                      __global const double *wide, struct points src, struct index s, INDEX,
                      __global const uint *order, uint mapped, struct stretch t, uint fill,
                      uint all, __global uint *counts, __global const uint *first,
                      __global uint *common, __global uint *step, __global const ulong *total,
                      uint slot, ulong room)
{
    const ulong begin = get_global_id(0) * MANY, end = min(begin + MANY, (ulong)t.n);

    for (ulong k = begin; k < end; k++) {
        const uint group = t.from + (uint)k;
        __global uint *c = counts + k;
        const struct found known = counted(c, t.stride);
        struct asked q;
        struct found f;

        if (fill) {
            common[group] = known.n[BOTH] + max(known.n[LOWER], known.n[UPPER]) -
                            min(known.n[LOWER], known.n[UPPER]);
        }
        if (fill ? !c[HERE * t.stride] || total[slot + 1] > room : !all && !c[HERE * t.stride]) {
            continue;
        }
        ask(&q, dst_wide, dst, factor, group * 8, min(group * 8 + 8, dst.n));
        f = group_do(&q, &s, FOUND_IN, wide, src, order, mapped, group, &known,
                     fill ? step + first[group] : 0);
        if (!fill) {
            c[ALL * t.stride] = f.n[BOTH] + f.n[LOWER] + f.n[UPPER];
            c[BOTH * t.stride] = f.n[BOTH];
            c[LOWER * t.stride] = f.n[LOWER];
            c[UPPER * t.stride] = f.n[UPPER];
            c[HERE * t.stride] = 1;
        }
    }
}

/* Of a work group's groups: true pairs within reach, no particle with itself; destinations with
 * more than `most`. Where nobody counts only groups are looked at that may have those. */
KERNEL void list_pairs(__global const double *dst_wide, struct points dst,
                       __global const double *wide, struct points src, uint same, uint groups,
                       uint counts, ulong most, __global const uint *begin,
                       __global const uint *step, __global ulong *out)
{
    __local ulong sums[2 * WG];
    const uint l = (uint)get_local_id(0);
    const ulong first = get_global_id(0) * MANY, last = min(first + MANY, (ulong)groups);
    ulong pairs = 0, crowded = 0;

    for (ulong at = first; at < last; at++) {
        const uint g = (uint)at;
        const uint d = g * 8, end = min(d + 8, dst.n);
        const long8 self = (long8)(0, 1, 2, 3, 4, 5, 6, 7) + (long)d;
        double8 x[DIM], most2;
        long8 n = 0;

        if (!counts && (most == 0 || begin[g + 1] - begin[g] <= most)) {
            continue;
        }
        FOR_AXES x[a] = load8(dst_wide + dst.x + a * dst.plane, d, end);
        most2 = dst.scale * load8(dst_wide + dst.h, d, end);
        most2 = self < (long8)(long)end ? most2 * most2 : (double8)-1.0;
        for (uint k = begin[g]; k < begin[g + 1]; k++) {
            const uint j = step[k];
            const double reach = src.scale > 0 ? src.scale * wide[src.h + j] : 0.0;
            double8 r2 = 0.0, limit = more((double8)(reach * reach), most2);
            long8 in;

            FOR_AXES
            {
                const double8 e = x[a] - wide[src.x + a * src.plane + j];

                r2 += e * e;
            }
            limit = most2 < 0.0 ? most2 : limit;
            in = r2 < limit;
            n -= same ? in & (self != (long8)(long)j) : in;
        }
        pairs += (ulong)(n.s0 + n.s1 + n.s2 + n.s3 + n.s4 + n.s5 + n.s6 + n.s7);
        if (most > 0) {
            const long8 many = n > (long8)(long)most;

            crowded -= (ulong)(many.s0 + many.s1 + many.s2 + many.s3 + many.s4 + many.s5 + many.s6 +
                               many.s7);
        }
    }
    sums[2 * l] = pairs;
    sums[2 * l + 1] = crowded;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (l == 0) {
        for (uint k = 1; k < WG; k++) {
            pairs += sums[2 * k];
            crowded += sums[2 * k + 1];
        }
        out[2 * get_group_id(0)] = pairs;
        out[2 * get_group_id(0) + 1] = crowded;
    }
}
