/* opencl/search.cl -- which sources are near a box: leaves of eight sources, which stand side by
 * side in the search's order, and how those are found that may be.
 *
 * SEARCH 0: a tree of bounding boxes, eight leaves to a block and eight blocks to one above, each
 * box with the largest reach in it, for sources that stand in cell order or in Morton order. 1:
 * cells of a grid as wide as the largest reach, begin[cell] being the first source of each. 2: the
 * same cells by sorted keys, found by bisection, for boxes that are mostly empty; there, boxes are
 * of leaves alone. What is found may have leaves too many: the filter of lists.cl decides. Leaves
 * come ascending, each once. INDEX: the structure as arguments `rows`, what finds a row of cells in
 * a grid, and `box`, the boxes. */

/* Every reach is enlarged so much where leaves are left out as a whole, as on the host. */
#define MARGIN 1e-4
#define BLOCK ((2 * DIM + 1) * 8) /* doubles: lo, hi of each axis, reach, of eight boxes each */

/* What is asked for, by eight lanes: sources nearer to one of them than the larger of its reach and
 * their own. The box is around all of them; spread: it is much larger than a reach. */
struct asked {
    double x[DIM][8], r2[8];
    double lo[DIM], hi[DIM], reach, least;
    uint spread;
};

/* Lanes of destinations [first, last), at most eight; fewer are filled up with the last one. */
INLINE void ask(struct asked *q, __global const double *wide, struct points p, double factor,
                uint first, uint last)
{
    const double8 reach = factor * load8(wide + p.h, first, last);
    double sum = 0.0;

    vstore8(reach * reach, 0, q->r2);
    q->reach = most_of(reach);
    q->least = least_of(reach);
    FOR_AXES
    {
        const double8 x = load8(wide + p.x + a * p.plane, first, last);

        vstore8(x, 0, q->x[a]);
        q->lo[a] = least_of(x);
        q->hi[a] = most_of(x);
        sum += (q->hi[a] - q->lo[a]) * (q->hi[a] - q->lo[a]);
    }
    q->spread = !(sum <= 4 * q->least * q->least);
}

/* -- Boxes -------- */

/* scattered[1]: leaves that are much larger than a reach, their own or `typical`. */
KERNEL void leaves_make(__global const double *wide, struct points p, __global double *box,
                        uint blocks, double typical, __global uint *scattered)
{
    uint bad = 0;
    const ulong begin = (ulong)get_global_id(0) * (CPU ? 64 : 1);
    const ulong end = min(begin + (CPU ? 64 : 1), (ulong)blocks);

    for (ulong block = begin; block < end; block++) {
        __global double *out = box + block * BLOCK;

        for (uint k = 0; k < 8; k++) {
            const ulong first = (block * 8 + k) * 8, last = min(first + 8, (ulong)p.n);
            double reach = 0.0, longest = 0.0;

            if (first >= last) {
                FOR_AXES
                {
                    out[16 * a + k] = INFINITY;
                    out[16 * a + 8 + k] = -INFINITY;
                }
                out[16 * DIM + k] = 0.0;
                continue;
            }
            FOR_AXES
            {
                const double8 x = load8(wide + p.x + a * p.plane, (uint)first, (uint)last);
                const double low = least_of(x), high = most_of(x);

                out[16 * a + k] = low;
                out[16 * a + 8 + k] = high;
                longest = fmax(longest, high - low);
            }
            if (p.scale > 0) {
                reach = p.scale * most_of(load8(wide + p.h, (uint)first, (uint)last));
            }
            out[16 * DIM + k] = reach;
            bad += longest > 4 * fmax(reach, typical);
        }
    }
    if (bad > 0) {
        atomic_add(&scattered[1], bad);
    }
}

/* Boxes of a level around the blocks of the one below. */
KERNEL void boxes_make(__global double *box, uint below, uint nodes, uint to, uint blocks)
{
    const ulong block = get_global_id(0);

    if (block >= blocks) {
        return;
    }
    __global double *out = box + (to + block) * BLOCK;

    for (uint k = 0; k < 8; k++) {
        const ulong node = block * 8 + k;
        __global const double *in = box + (below + min(node, (ulong)nodes - 1)) * BLOCK;
        const bool is = node < nodes;

        FOR_AXES
        {
            out[16 * a + k] = is ? least_of(vload8(2 * a, in)) : INFINITY;
            out[16 * a + 8 + k] = is ? most_of(vload8(2 * a + 1, in)) : -INFINITY;
        }
        out[16 * DIM + k] = is ? most_of(vload8(2 * DIM, in)) : 0.0;
    }
}

/* Which of a block's boxes are near the box asked for. */
INLINE uint near_box(const struct index *s, __global const double *box, const struct asked *q,
                     uint level, uint block)
{
    __global const double *b = box + (ulong)(s->offset[level] + block) * BLOCK;
    const uint rest = s->nodes[level] - block * 8;
    double8 gap = 0.0, reach = vload8(2 * DIM, b);

    FOR_AXES
    {
        const double8 below = vload8(2 * a, b) - q->hi[a], above = q->lo[a] - vload8(2 * a + 1, b);
        const double8 d = more(more(below, above), (double8)0.0);

        gap += d * d;
    }
    reach = more(reach, (double8)q->reach) * (1 + MARGIN);
    return bits_of(convert_char8(gap <= reach * reach)) & (rest < 8 ? (1u << rest) - 1 : 0xffu);
}

/* Which of them are near one of the lanes. */
INLINE uint near_lanes(const struct index *s, __global const double *box, const struct asked *q,
                       uint level, uint block)
{
    __global const double *b = box + (ulong)(s->offset[level] + block) * BLOCK;
    const double8 reach = vload8(2 * DIM, b), own = reach * reach;
    long8 near = 0;

    for (uint l = 0; l < 8; l++) {
        double8 gap = 0.0;

        FOR_AXES
        {
            const double8 below = vload8(2 * a, b) - q->x[a][l];
            const double8 above = q->x[a][l] - vload8(2 * a + 1, b);
            const double8 d = more(more(below, above), (double8)0.0);

            gap += d * d;
        }
        near |= gap <= more((double8)q->r2[l], own) * ((1 + MARGIN) * (1 + MARGIN));
    }
    return bits_of(convert_char8(near));
}

/* ... or, if spread, near a lane. */
INLINE uint near_mask(const struct index *s, __global const double *box, const struct asked *q,
                      uint level, uint block, uint mask)
{
    mask &= near_box(s, box, q, level, block);
    return q->spread && mask ? mask & near_lanes(s, box, q, level, block) : mask;
}

#if SEARCH == 0
/* -- A tree of them -------- */

#define ROWS __global const uint * /* none */

struct walk {
    uint level, top, block[LEVELS], mask[LEVELS];
};

INLINE void walk_down(struct walk *w, const struct index *s, __global const double *box,
                      const struct asked *q, uint level, uint block)
{
    w->level = level;
    w->block[level] = block;
    w->mask[level] = near_mask(s, box, q, level, block, 0xffu);
}

INLINE void walk_begin(struct walk *w, const struct index *s, ROWS rows, __global const double *box,
                       const struct asked *q)
{
    w->top = s->n_level - 1;
    walk_down(w, s, box, q, w->top, 0);
}

/* The next block of eight leaves, and which of them: its number is eight times that of the first.
 * False: there are no more. */
INLINE bool walk_next(struct walk *w, const struct index *s, ROWS rows, __global const double *box,
                      const struct asked *q, uint *block, uint *mask)
{
    for (;;) {
        while (w->mask[w->level] == 0) {
            if (w->level == w->top) {
                return false;
            }
            w->level++;
        }
        if (w->level == 0) {
            *block = w->block[0];
            *mask = w->mask[0];
            w->mask[0] = 0;
            return true;
        }
        const uint m = w->mask[w->level], node = w->block[w->level] * 8 + first_bit(m);

        w->mask[w->level] = m & (m - 1);
        walk_down(w, s, box, q, w->level - 1, node);
    }
}

#else
/* -- Cells -------- */

#if SEARCH == 1
#define ROWS __global const uint * /* begin */

/* Sources of the cells before this one. */
INLINE uint before_cell(const struct index *s, ROWS begin, ulong cell)
{
    return begin[cell];
}
#else
#define ROWS __global const ulong * /* key */

INLINE uint before_cell(const struct index *s, ROWS key, ulong cell)
{
    uint first = 0, n = s->n;

    while (n > 0) {
        const uint half_n = n / 2;
        const bool below = key[first + half_n] < cell;

        first += below ? half_n + 1 : 0;
        n = below ? n - half_n - 1 : half_n;
    }
    return first;
}
#endif

/* A row of cells at a time, in which the lanes (spread: each for itself) have stretches of leaves. */
struct walk {
    ulong y, z, from[3], to[3];
    uint n, at, first[8], last[8];
    bool done;
};

/* Leaves from the first source of row y, z near [lo, hi] to the last one. */
INLINE void walk_stretch(struct walk *w, const struct index *s, ROWS rows, double lo, double hi,
                         double reach)
{
    const ulong row = w->z * s->step[2] + w->y * s->step[1];
    const uint a = before_cell(s, rows, row + along(s, 0, lo - reach));
    const uint b = before_cell(s, rows, row + along(s, 0, hi + reach) + 1);

    w->first[w->n] = a / 8;
    w->last[w->n] = a < b ? (b - 1) / 8 + 1 : 0;
    w->n++;
}

#if DIM > 1
INLINE bool row_near(const struct index *s, uint axis, ulong row, double x, double reach)
{
    return row >= along(s, axis, x - reach) && row <= along(s, axis, x + reach);
}
#endif

INLINE void walk_row(struct walk *w, const struct index *s, ROWS rows, const struct asked *q)
{
    w->n = 0;
    if (!q->spread) {
        walk_stretch(w, s, rows, q->lo[0], q->hi[0], fmax(q->reach, s->reach) * (1 + MARGIN));
        return;
    }
    for (uint l = 0; l < 8; l++) {
        const double reach = fmax(sqrt(q->r2[l]), s->reach) * (1 + MARGIN);

#if DIM > 1
        if (!row_near(s, 1, w->y, q->x[1][l], reach)) {
            continue;
        }
#endif
#if DIM > 2
        if (!row_near(s, 2, w->z, q->x[2][l], reach)) {
            continue;
        }
#endif
        walk_stretch(w, s, rows, q->x[0][l], q->x[0][l], reach);
    }
}

INLINE void walk_begin(struct walk *w, const struct index *s, ROWS rows, __global const double *box,
                       const struct asked *q)
{
    const double reach = fmax(q->reach, s->reach) * (1 + MARGIN);

    for (uint a = 0; a < 3; a++) {
        w->from[a] = w->to[a] = 0;
    }
    for (uint a = 1; a < DIM; a++) {
        w->from[a] = along(s, a, q->lo[a] - reach);
        w->to[a] = along(s, a, q->hi[a] + reach);
    }
    w->y = w->from[1];
    w->z = w->from[2];
    w->at = 0;
    w->done = false;
    walk_row(w, s, rows, q);
}

INLINE bool walk_next(struct walk *w, const struct index *s, ROWS rows, __global const double *box,
                      const struct asked *q, uint *block, uint *mask)
{
    while (!w->done) {
        uint first = NONE, last = 0;

        for (uint k = 0; k < w->n; k++) {
            const uint f = max(w->first[k], w->at);

            if (w->last[k] > w->at && f <= first) {
                last = f < first ? w->last[k] : max(last, w->last[k]);
                first = f;
            }
        }
        if (first != NONE) {
            const uint end = min(last, first / 8 * 8 + 8);

            *block = first / 8;
            *mask = near_mask(s, box, q, 0, *block, (0xffu >> (8 - (end - first))) << first % 8);
            w->at = end;
            if (*mask) {
                return true;
            }
            continue;
        }
        if (w->y < w->to[1]) {
            w->y++;
        } else if (w->z < w->to[2]) {
            w->y = w->from[1];
            w->z++;
        } else {
            w->done = true;
            return false;
        }
        walk_row(w, s, rows, q);
    }
    return false;
}
#endif

#define INDEX ROWS rows, __global const double *box
#define FOUND_IN rows, box
