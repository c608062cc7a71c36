/* opencl/ops_reduce.cl -- many numbers to one. A work group takes CHUNK particles, each of its items always the
 * same, and merges what they have in a tree; then one group merges what the groups have. So the order does
 * not depend on the device. */
#define GROUP 64
#define CHUNK 4096
#define SUM 3u
#define LEAST 1u
#define MOST 2u

static inline double start_of(uint op)
{
    return op == SUM ? 0.0 : op == LEAST ? (double)INFINITY : -(double)INFINITY;
}

/* A NaN comes through. */
static inline double merge(uint op, double a, double b)
{
    if (op == SUM || isnan(a) || isnan(b))
        return a + b;
    return op == LEAST ? fmin(a, b) : fmax(a, b);
}

/* Eight at once, but for NaNs, of which *none keeps account: fmin is slow on lanes. */
static inline double8 merge_8(uint op, double8 a, double8 b, long8 *none)
{
    *none |= b != b;
    if (op == SUM)
        return a + b;
    return select(a, b, op == LEAST ? b < a : b > a);
}

static inline double across(uint op, double8 a, long8 none)
{
    a = select(a, (double8)((double)NAN), none);
    return merge(op, merge(op, merge(op, a.s0, a.s4), merge(op, a.s2, a.s6)),
                 merge(op, merge(op, a.s1, a.s5), merge(op, a.s3, a.s7)));
}

/* Of all items of a group; right in item 0. To be reached by all. */
static inline double group_merge(uint op, double mine, local double *share)
{
    const uint me = get_local_id(0);
    barrier(CLK_LOCAL_MEM_FENCE);
    share[me] = mine;
#if WIDE == 8 /* a processor's items come one after the other: the last need not wait for the first */
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint s = GROUP / 2; s > 0 && me == 0; s /= 2)
        for (uint k = 0; k < s; k++)
            share[k] = merge(op, share[k], share[k + s]);
#else
    for (uint s = GROUP / 2; s > 0; s /= 2) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (me < s)
            share[me] = merge(op, share[me], share[me + s]);
    }
#endif
    return share[me];
}

/* What an item has in its k-th turn: from `i` on 8 numbers, those behind n left out. Items of a GPU stand side by
 * side; one of a processor has numbers that do, where the order does not matter: it reads ahead of them. */
#define TURNS (CHUNK / GROUP / 8)
static inline ulong turn_of(uint k, bool ordered)
{
    const uint me = get_local_id(0);
    const uint turn = WIDE == 8 && !ordered ? me * TURNS + k : k * GROUP + me;
    return (ulong)get_group_id(0) * CHUNK + turn * 8;
}

static inline long8 inside(ulong i, ulong n)
{
    const long8 at = (long8)((long)i) + (long8)(0, 1, 2, 3, 4, 5, 6, 7);
    return at < (long8)((long)n);
}

kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void
reduce_column(global const double *wide, global const float *narrow, ulong plane, uint slot,
              uint mass, ulong n, uint op, global double *part)
{
    local double share[GROUP];
    double8 all = start_of(op);
    long8 none = 0;
    for (uint k = 0; k < TURNS; k++) {
        const ulong i = turn_of(k, op == SUM);
        if (i >= n)
            break;
        double8 value = get_8(wide, narrow, slot, 0, plane, i);
        if (mass != MISSING)
            value = get_8(wide, narrow, mass, 0, plane, i) * value;
        all = merge_8(op, all, select((double8)start_of(op), value, inside(i, n)), &none);
    }
    const double group = group_merge(op, across(op, all, none), share);
    if (get_local_id(0) == 0)
        part[get_group_id(0)] = group;
}

/* The squares of how far particles have moved, and what is left of their reach; NaN where a number is none. */
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void
skin_change(global const double *wide, global const float *narrow, ulong plane, uint position,
            uint smoothing, ulong n, global const double *x, global const double *h, ulong stride,
            double relative, global double *part)
{
    local double share[GROUP];
    double8 most = 0.0, room = (double)INFINITY;
    long8 none = 0;
    for (uint k = 0; k < TURNS; k++) {
        const ulong i = turn_of(k, false);
        if (i >= n)
            break;
        double8 r2 = 0.0;
        for (uint c = 0; c < DIM; c++) {
            const double8 d = get_8(wide, narrow, position, c, plane, i) -
                              vload8(0, x + c * stride + i);
            r2 += d * d;
        }
        const double8 left = (1.0 + relative) * vload8(0, h + i) -
                             get_8(wide, narrow, smoothing, 0, plane, i);
        const long8 in = inside(i, n);
        none |= in & ((r2 + left) * 0.0 != 0.0);
        most = select(most, r2, in & (r2 > most));
        room = select(room, left, in & (left < room));
    }
    const double moved = group_merge(MOST, across(MOST, most, none), share);
    const double least = group_merge(LEAST, across(LEAST, room, none), share);
    if (get_local_id(0) == 0) {
        part[get_group_id(0)] = moved;
        part[get_num_groups(0) + get_group_id(0)] = least;
    }
}

/* One group: n parts from `first` on to a result; its root if `root`, times `factor`. */
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void
reduce_parts(global const double *part, ulong first, ulong n, uint op, uint root, double factor,
             global double *result, ulong to)
{
    local double share[GROUP];
    double all = start_of(op);
    for (ulong i = get_local_id(0); i < n; i += GROUP)
        all = merge(op, all, part[first + i]);
    all = group_merge(op, all, share);
    if (get_local_id(0) == 0 && get_group_id(0) == 0)
        result[to] = (root ? sqrt(all) : all) * factor;
}
