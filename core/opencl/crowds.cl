/* opencl/crowds.cl -- the order of points in a cell that has too many to be sorted by x alone: as edge.c's of
 * the neighbours, comparison by comparison. */

#define GROUP 8u
#define STACK 40 /* halvings of a crowd, and more */

/* Its members, by their places in the whole order: where they are, and in the last number their
 * index. */
struct crowd {
    __global double4 *m;
    __global const double *wide;
    ulong id;
    bool turned[3]; /* axes along which it is walked from high to low */
    ulong seed;
};

INLINE double coordinate(double4 m, uint axis)
{
    return axis == 0 ? m.s0 : axis == 1 ? m.s1 : m.s2;
}

INLINE uint index_of(double4 m)
{
    return (uint)as_ulong(m.s3);
}

INLINE bool member_before(const struct crowd *c, double4 a, double4 b, uint axis)
{
    const double x = coordinate(a, axis), y = coordinate(b, axis);
    const bool below = x<y, above = x> y;

    return below || above ? below != c->turned[axis]
                          : before_id(c->wide, c->id, index_of(a), index_of(b));
}

INLINE void member_swap(const struct crowd *c, uint k, uint q)
{
    const double4 m = c->m[k];

    c->m[k] = c->m[q];
    c->m[q] = m;
}

/* One of [first, last), in the middle of three that were drawn: which changes the time, not the
 * result. */
INLINE uint draw_pivot(struct crowd *c, uint first, uint last, uint axis)
{
    uint p[3];

    for (int k = 0; k < 3; k++) {
        c->seed = c->seed * 6364136223846793005UL + 1442695040888963407UL;
        p[k] = first + (uint)((c->seed >> 33) % (last - first));
    }
    for (int k = 0; k < 3; k++) {
        const double4 m = c->m[p[k]];

        if (member_before(c, c->m[p[(k + 1) % 3]], m, axis) &&
            member_before(c, m, c->m[p[(k + 2) % 3]], axis)) {
            return p[k];
        }
    }
    return p[0];
}

/* Puts those in front that come before place `want` along an axis, of [first, last) (Hoare's FIND). */
INLINE void part(struct crowd *c, uint first, uint last, uint want, uint axis)
{
    while (last - first > 1) {
        const uint pivot = draw_pivot(c, first, last, axis);
        uint low = first;

        member_swap(c, pivot, last - 1);
        const double4 p = c->m[last - 1];
        const double px = coordinate(p, axis);
        const bool turned = c->turned[axis];

        for (uint k = first; k + 1 < last; k++) {
            const double4 here = c->m[k];
            const double x = coordinate(here, axis);
            bool is_before = turned ? x > px : x < px;

            if (x == px) {
                is_before = before_id(c->wide, c->id, index_of(here), index_of(p));
            }
            /* Changes places in any case: which are before the pivot no processor foresees. */
            c->m[k] = c->m[low];
            c->m[low] = here;
            low += is_before;
        }
        member_swap(c, low, last - 1);
        if (want == low || want == low + 1) {
            return;
        }
        if (want < low) {
            last = low;
        } else {
            first = low + 1;
        }
    }
}

INLINE uint longest_axis(const struct crowd *c, uint first, uint last)
{
    double4 lo = INFINITY, hi = -INFINITY;
    double extent = -1;
    uint axis = 0;

    for (uint k = first; k < last; k++) {
        const double4 m = c->m[k];

        lo = m < lo ? m : lo;
        hi = m > hi ? m : hi;
    }
    FOR_AXES
    {
        if (coordinate(hi, a) - coordinate(lo, a) > extent) {
            extent = coordinate(hi, a) - coordinate(lo, a);
            axis = a;
        }
    }
    return axis;
}

/* Halves members across their longest extent until they are in groups, which begin at multiples of
 * eight; a group is sorted by x. Cells are walked upwards along x, and along the others in turns. */
KERNEL void crowds_sort(__global const double *wide, struct points p, ulong id, uint row,
                        __global const uint *end, __global uint *order, __global const uint *crowd,
                        __global double4 *copy)
{
    const uint k = (uint)get_global_id(0);
    uint from[STACK], to[STACK], depth = 1;

    if (k >= crowd[0]) {
        return;
    }
    const uint cell = crowd[1 + k];
    const bool turn = cell % row % 2 != 0;
    struct crowd c = {copy, wide, id, {false, turn, turn}, cell};

    from[0] = cell > 0 ? end[cell - 1] : 0;
    to[0] = end[cell];
    for (uint q = from[0]; q < to[0]; q++) {
        double x[3] = {0.0, 0.0, 0.0};

        FOR_AXES x[a] = wide[p.x + a * p.plane + order[q]];
        copy[q] = (double4)(x[0], x[1], x[2], as_double((ulong)order[q]));
    }
    while (depth > 0) {
        const uint first = from[--depth], last = to[depth];
        const uint begin = first / GROUP, stop = last / GROUP + (last % GROUP > 0);

        if (stop - begin < 2) {
            for (uint q = first + 1; q < last; q++) {
                for (uint r = q; r > first && member_before(&c, c.m[r], c.m[r - 1], 0); r--) {
                    member_swap(&c, r, r - 1);
                }
            }
            for (uint q = first; q < last; q++) {
                order[q] = index_of(c.m[q]);
            }
            continue;
        }
        const uint middle = (begin + (stop - begin + 1) / 2) * GROUP;

        part(&c, first, last, middle, longest_axis(&c, first, last));
        from[depth] = first;
        to[depth++] = middle;
        from[depth] = middle;
        to[depth++] = last;
    }
}
