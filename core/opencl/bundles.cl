/* opencl/bundles.cl -- the same lists for processors, by vectors, as worker.c and filter.c make
 * them: groups that stand side by side share a search and a copy of the leaves found, in floats
 * relative to their common centre (a bundle). A group whose lanes are far apart, or that has more
 * sources than ROOM_MOST, is left to lists.cl; whether it is depends on the points alone. Slots
 * that have too little room say in `need` how much they want.
 *
 * A work item takes BUNDLE_RUN groups; which of them are a bundle does not depend on how many
 * work items there are. */

#if CPU
#define BUNDLE_RUN 48u
#define BUNDLE_MOST 12u   /* groups */
#define BUNDLE_SPREAD 2.0 /* half the diagonal of its box, in units of its smallest reach */
#define SPREAD_MOST 8.0   /* ... of a group's */
#define LEAVES 512u       /* of a bundle */
#define UNIFORM 1.004f    /* reaches of a group that differ less are taken as one */
#define ROOM_MOST 2048u   /* sources of a side of a group */
#define PACK (DIM + 2)    /* of a leaf: x, square of the distance to the centre, of the reach */

/* Destinations that are looked after together. */
struct span {
    double lo[DIM], hi[DIM], reach, least;
};

INLINE void span_of(struct span *s, __global const double *wide, struct points p, double factor,
                    uint group)
{
    const uint first = group * 8, last = min(first + 8, p.n);
    const double8 reach = factor * load8(wide + p.h, first, last);

    s->reach = most_of(reach);
    s->least = least_of(reach);
    FOR_AXES
    {
        const double8 x = load8(wide + p.x + a * p.plane, first, last);

        s->lo[a] = least_of(x);
        s->hi[a] = most_of(x);
    }
}

INLINE bool span_within(const struct span *s, double reaches)
{
    const double most = 2 * reaches * s->least;
    double sum = 0;

    FOR_AXES sum += (s->hi[a] - s->lo[a]) * (s->hi[a] - s->lo[a]);
    return s->least > 0 && sum <= most * most;
}

INLINE struct span span_join(struct span s, const struct span *t)
{
    s.reach = fmax(s.reach, t->reach);
    s.least = fmin(s.least, t->least);
    FOR_AXES
    {
        s.lo[a] = fmin(s.lo[a], t->lo[a]);
        s.hi[a] = fmax(s.hi[a], t->hi[a]);
    }
    return s;
}

/* Numbers of the bits of a mask, from `base` on; room for eight. Table: of each mask its bits'
 * numbers. */
INLINE uint put_bits(uint *out, __global const uchar *table, uint mask, uint base)
{
    vstore8(convert_uint8(vload8(mask, table)) + base, 0, out);
    return popcount(mask);
}

INLINE void put_entries(__global uint *out, __global const uchar *table, uint mask, uint base)
{
    vstore8(convert_uint8(vload8(mask, table)) + base, 0, out);
}

/* The leaves near a bundle; more than LEAVES: there are too many. */
INLINE uint bundle_find(uint *leaf, const struct span *b, const struct index *s, INDEX,
                        __global const uchar *table)
{
    struct asked q;
    struct walk w;
    uint block, mask, n = 0;

    q.spread = 0;
    q.reach = b->reach;
    FOR_AXES
    {
        q.lo[a] = b->lo[a];
        q.hi[a] = b->hi[a];
    }
    walk_begin(&w, s, FOUND_IN, &q);
    while (walk_next(&w, s, FOUND_IN, &q, &block, &mask)) {
        n += put_bits(leaf + n, table, mask, block * 8);
        if (n > LEAVES) {
            break;
        }
    }
    return n;
}

INLINE float least_f(float8 v)
{
    const float4 p = v.lo < v.hi ? v.lo : v.hi;
    const float2 q = p.lo < p.hi ? p.lo : p.hi;

    return q.x < q.y ? q.x : q.y;
}

INLINE float most_f(float8 v)
{
    const float4 p = v.lo > v.hi ? v.lo : v.hi;
    const float2 q = p.lo > p.hi ? p.lo : p.hi;

    return q.x > q.y ? q.x : q.y;
}

/* Copies leaves relative to a centre, in units of 1 / inverse; boxes of eight are [lo, hi of each
 * axis, reach]. */
INLINE void bundle_pack(float8 *pack, float *box, const uint *leaf, uint n, const double *centre,
                        double inverse, __global const double *wide, struct points p)
{
    for (uint k = 0; k < ((n + 7) & ~7u); k++) {
        float *b = box + k / 8 * ((2 * DIM + 1) * 8) + k % 8;

        if (k >= n) {
            FOR_AXES
            {
                b[16 * a] = INFINITY;
                b[16 * a + 8] = -INFINITY;
            }
            b[16 * DIM] = 0;
            continue;
        }
        const uint first = leaf[k] * 8, last = min(first + 8, p.n);
        float8 s = 0.0f, reach = 0.0f;

        FOR_AXES
        {
            double8 x = (load8(wide + p.x + a * p.plane, first, last) - centre[a]) * inverse;
            float8 f;

            x = less(more(x, (double8)-1e18), (double8)1e18); /* squares must stay numbers */
            f = convert_float8(x);
            pack[k * PACK + a] = f;
            s += f * f;
            b[16 * a] = least_f(f);
            b[16 * a + 8] = most_f(f);
        }
        if (p.scale > 0) {
            reach = convert_float8(p.scale * inverse * load8(wide + p.h, first, last));
        }
        if (last - first < 8) {
            const int8 in = (int8)(0, 1, 2, 3, 4, 5, 6, 7) < (int)(last - first);

            s = in ? s : (float8)INFINITY;
        }
        pack[k * PACK + DIM] = s;
        pack[k * PACK + DIM + 1] = reach * reach;
        b[16 * DIM] = most_f(reach);
    }
}

/* A group's lanes i and 4 + i, side by side; a source b is seen if s - 2 a.b + a^2 <= max(reach^2,
 * r2). */
struct lanes {
    float16 m2a[4][DIM], a2[4], r2[4];
    float lo[DIM], hi[DIM], reach;
    bool uniform;
};

#define TWICE(v, i, k) ((float16)((float8)((v).s##i), (float8)((v).s##k)))
#define SPREAD(to, v)                                                                              \
    do {                                                                                           \
        to[0] = TWICE(v, 0, 4);                                                                    \
        to[1] = TWICE(v, 1, 5);                                                                    \
        to[2] = TWICE(v, 2, 6);                                                                    \
        to[3] = TWICE(v, 3, 7);                                                                    \
    } while (0)

INLINE void lanes_of(struct lanes *t, __global const double *wide, struct points p, double factor,
                     uint group, const double *centre, double inverse)
{
    const uint first = group * 8, last = min(first + 8, p.n);
    const float8 reach = convert_float8(factor * inverse * load8(wide + p.h, first, last));
    const float8 reach2 = reach * reach;
    double8 a2 = 0.0;

    t->reach = most_f(reach);
    t->uniform = t->reach <= UNIFORM * least_f(reach);
    SPREAD(t->r2, reach2);
    FOR_AXES
    {
        const double8 x = (load8(wide + p.x + a * p.plane, first, last) - centre[a]) * inverse;
        const float8 f = convert_float8(x), m2 = -2.0f * f;

        a2 += x * x;
        t->lo[a] = least_f(f);
        t->hi[a] = most_f(f);
        t->m2a[0][a] = TWICE(m2, 0, 4);
        t->m2a[1][a] = TWICE(m2, 1, 5);
        t->m2a[2][a] = TWICE(m2, 2, 6);
        t->m2a[3][a] = TWICE(m2, 3, 7);
    }
    const float8 near2 = convert_float8(a2);

    SPREAD(t->a2, near2);
}

/* Which of a bundle's leaves are near a group. */
INLINE uint group_leaves(uint *chosen, const float *box, uint n, const struct lanes *t,
                         __global const uchar *table)
{
    uint found = 0;

    for (uint k = 0; k < n; k += 8) {
        const float *b = box + k * (2 * DIM + 1);
        float8 gap = 0.0f, reach = vload8(2 * DIM, b);

        FOR_AXES
        {
            const float8 below = vload8(2 * a, b) - t->hi[a],
                         above = t->lo[a] - vload8(2 * a + 1, b);
            float8 d = below > above ? below : above;

            d = d > 0.0f ? d : (float8)0.0f;
            gap += d * d;
        }
        reach = (reach > t->reach ? reach : (float8)t->reach) * (1 + (float)MARGIN);
        found += put_bits(chosen + found, table, bits_of(convert_char8(gap <= reach * reach)), k);
    }
    return found;
}

/* Bits of the sources of a leaf: seen by the lower half of the lanes, by the upper half. */
INLINE uint2 see(const float8 *p, const struct lanes *t, float16 reach2, bool uniform)
{
    const float16 s = (float16)(p[DIM], p[DIM]);
    float16 r2 = (float16)(p[DIM + 1], p[DIM + 1]), any_near, own_near;

    UNROLL for (uint i = 0; i < 4; i++)
    {
        float16 d = t->a2[i];

        FOR_AXES d += t->m2a[i][a] * (float16)(p[a], p[a]);
        any_near = i > 0 && any_near < d ? any_near : d;
        if (!uniform) {
            const float16 o = d - t->r2[i];

            own_near = i > 0 && own_near < o ? own_near : o;
        }
    }
    int16 hit;

    if (uniform) {
        r2 = r2 > reach2 ? r2 : reach2;
        hit = any_near <= r2 - s;
    } else {
        hit = any_near <= r2 - s | own_near <= -s;
    }
    const ulong2 m = as_ulong2(convert_char16(hit));

    return (uint2)(bits_of(as_char8(m.x)), bits_of(as_char8(m.y)));
}

/* The sources of a group, to its slot: those of both halves, of the lower, of the upper one, `room`
 * each. Where that is not enough they are counted. */
INLINE void group_take(struct found *f, __global uint *slot, uint room, const float8 *pack,
                       const float *box, const uint *leaf, uint n, uint *chosen,
                       const struct lanes *t, uint own, __global const uchar *table, bool uniform)
{
    const uint many = group_leaves(chosen, box, n, t, table);
    const float16 reach2 = t->reach * t->reach;
    uint both = 0, low = 0, high = 0;

    for (uint k = 0; k < many; k++) {
        const uint l = leaf[chosen[k]];
        const uint2 m = see(pack + chosen[k] * PACK, t, reach2, uniform);
        const uint all = m.x | m.y, common = l == own ? all : m.x & m.y;

        if (max(both, max(low, high)) + 8 <= room) {
            put_entries(slot + both, table, common, l * 8);
            put_entries(slot + room + low, table, m.x & ~common, l * 8);
            put_entries(slot + 2 * room + high, table, m.y & ~common, l * 8);
        }
        both += popcount(common);
        low += popcount(m.x & ~common);
        high += popcount(m.y & ~common);
    }
    f->n[BOTH] = both;
    f->n[LOWER] = low;
    f->n[UPPER] = high;
}

/* Numbers in the search's order become indices; the group's own places, at most eight, go to both
 * halves. */
INLINE void group_map(struct found *f, __global uint *slot, uint room, __global const uint *order,
                      uint group)
{
    for (uint k = 0; k < f->n[BOTH]; k++) {
        slot[k] = order[slot[k]];
    }
    for (uint side = LOWER; side <= UPPER; side++) {
        __global uint *from = slot + (side - BOTH) * room;
        uint kept = 0;

        for (uint k = 0; k < f->n[side]; k++) {
            const uint index = order[from[k]];

            if (index / 8 != group) {
                from[kept++] = index;
            } else {
                slot[f->n[BOTH]++] = index;
            }
        }
        f->n[side] = kept;
    }
}

KERNEL void bundles_look(__global const double *dst_wide, struct points dst, double factor,
                         __global const double *wide, struct points src, struct index s, INDEX,
                         __global const uint *order, uint mapped, struct stretch t,
                         __global uint *counts, __global uint *slots, uint room,
                         __global uint *need, __global const uchar *table)
{
    const uint first = t.from + (uint)get_global_id(0) * BUNDLE_RUN;
    const uint last = min(first + BUNDLE_RUN, t.from + t.n);
    float8 pack[LEAVES * PACK];
    float near[LEAVES * (2 * DIM + 1)];
    uint leaf[LEAVES + 8], chosen[LEAVES + 8];
    struct span next;

    if (first >= last) {
        return;
    }
    span_of(&next, dst_wide, dst, factor, first);
    for (uint group = first; group < last;) {
        struct span b = next;
        const struct span alone = next;
        const bool whole = span_within(&b, SPREAD_MOST);
        uint end = group + 1, n = LEAVES + 1;

        for (; end < last; end++) {
            span_of(&next, dst_wide, dst, factor, end);
            const struct span both = span_join(b, &next);

            if (!whole || end - group == BUNDLE_MOST || !span_within(&both, BUNDLE_SPREAD)) {
                break;
            }
            b = both;
        }
        if (whole) {
            n = bundle_find(leaf, &b, &s, FOUND_IN, table);
            if (n > LEAVES && end > group + 1) {
                b = alone;
                end = group + 1;
                if (end < last) {
                    span_of(&next, dst_wide, dst, factor, end);
                }
                n = bundle_find(leaf, &b, &s, FOUND_IN, table);
            }
        }
        const double inverse = 1 / b.reach;
        double centre[DIM];

        FOR_AXES centre[a] = b.lo[a] + (b.hi[a] - b.lo[a]) / 2;
        if (n <= LEAVES) {
            bundle_pack(pack, near, leaf, n, centre, inverse, wide, src);
        }
        for (; group < end; group++) {
            const uint k = group - t.from;
            __global uint *slot = slots + (ulong)k * 3 * room;
            struct found f = {{0, 0, 0, 0}};
            bool here = n > LEAVES;
            uint most = 0;

            if (!here) {
                struct lanes lanes;

                lanes_of(&lanes, dst_wide, dst, factor, group, centre, inverse);
                if (lanes.uniform) {
                    group_take(&f, slot, room, pack, near, leaf, n, chosen, &lanes,
                               mapped ? NONE : group, table, true);
                } else {
                    group_take(&f, slot, room, pack, near, leaf, n, chosen, &lanes,
                               mapped ? NONE : group, table, false);
                }
                most = max(f.n[BOTH], max(f.n[LOWER], f.n[UPPER])) + 16;
                here = most > ROOM_MOST;
            }
            if (!here && most > room) {
                atomic_max(need, most);
            } else if (!here && mapped) {
                group_map(&f, slot, room, order, group);
            }
            counts[k + ALL * t.stride] = f.n[BOTH] + f.n[LOWER] + f.n[UPPER];
            counts[k + BOTH * t.stride] = f.n[BOTH];
            counts[k + LOWER * t.stride] = f.n[LOWER];
            counts[k + UPPER * t.stride] = f.n[UPPER];
            counts[k + HERE * t.stride] = here;
        }
    }
}

/* Copies eight at a time, and up to seven too many, unless exactly. */
INLINE void copy_to(__global uint *restrict out, __global const uint *restrict in, uint n,
                    bool exact)
{
    const uint end = exact ? n & ~7u : n;
    uint i = 0;

    for (; i < end; i += 8) {
        vstore8(vload8(0, in + i), 0, out + i);
    }
    for (; i < n; i++) {
        out[i] = in[i];
    }
}

/* From the slots into the list. */
KERNEL void bundles_put(struct stretch t, __global const uint *counts,
                        __global const uint *restrict slots, uint room, __global const uint *first,
                        __global uint *restrict step, __global const ulong *total, uint slot,
                        ulong list_room, __global const uint *need)
{
    const ulong begin = get_global_id(0) * BUNDLE_RUN, end = min(begin + BUNDLE_RUN, (ulong)t.n);

    if (total[slot + 1] > list_room || *need > room) {
        return;
    }
    for (ulong k = begin; k < end; k++) {
        const struct found f = counted(counts + k, t.stride);
        const uint longer = f.n[LOWER] > f.n[UPPER] ? LOWER : UPPER;
        const uint turns = min(f.n[LOWER], f.n[UPPER]), more_of = f.n[longer] - turns;
        __global const uint *restrict both = slots + k * 3 * room;
        __global const uint *restrict low = both + room, *restrict high = low + room;
        __global const uint *restrict rest = (longer == LOWER ? low : high) + turns;
        __global uint *restrict out = step + first[t.from + k];

        if (counts[k + HERE * t.stride]) {
            continue;
        }
        /* What is too much stands where the run's next groups are put, and nowhere else. */
        const bool exact = first[t.from + end] - first[t.from + k + 1] < 16;

        copy_to(out, both, f.n[BOTH], exact);
        out += f.n[BOTH];
        copy_to(out, rest, more_of, exact);
        out += more_of;
        for (uint i = 0; i < (exact ? turns & ~7u : turns); i += 8) {
            const uint8 p = vload8(0, low + i), q = vload8(0, high + i);

            vstore16((uint16)(p.s0, q.s0, p.s1, q.s1, p.s2, q.s2, p.s3, q.s3, p.s4, q.s4, p.s5,
                              q.s5, p.s6, q.s6, p.s7, q.s7),
                     0, out + 2 * i);
        }
        for (uint i = turns & ~7u; i < turns && exact; i++) {
            out[2 * i] = low[i];
            out[2 * i + 1] = high[i];
        }
    }
}
#endif
