/* opencl/ops_sides.cl -- particles that have left the domain, and ghosts: as domain/sides.c has them. */
#define IMAGE_LOW 1u
#define IMAGE_HIGH 2u

#define OPEN 0u
#define PERIODIC 1u
#define MIRROR 2u

/* As ops_sides.c fills it. */
struct sides {
    double min[4], max[4];
    uint low[4], high[4]; /* PERIODIC: both sides are */
};

static inline double image_of(constant struct sides *s, uint axis, uint image, double x)
{
    const double min = s->min[axis], max = s->max[axis];
    if (s->low[axis] == PERIODIC)
        return image == IMAGE_LOW ? x - (max - min) : x + (max - min);
    return image == IMAGE_LOW ? 2.0 * min - x : 2.0 * max - x;
}

/* -- Wrapping -------- */

static inline double wrap_periodic(double x, double min, double max)
{
    const double length = max - min;
    x -= length * floor((x - min) / length);
    return x < min || x >= max ? min : x;
}

static inline double wrap_mirror(constant struct sides *s, uint axis, double x, bool *flipped)
{
    const double min = s->min[axis], max = s->max[axis], length = max - min;
    const bool low = s->low[axis] == MIRROR, high = s->high[axis] == MIRROR;
    *flipped = false;
    if (low && high && (x < min || x > max)) {
        double t = fmod(x - min, 2.0 * length);
        t = t < 0.0 ? t + 2.0 * length : t;
        *flipped = t > length;
        return *flipped ? fmin(fmax(max - (t - length), min), max) : min + t;
    }
    if ((low && x < min) || (high && x > max)) {
        *flipped = true;
        return 2.0 * (x < min ? min : max) - x;
    }
    return x;
}

/* table: slots of kept positions (n_kept), then pairs of a slot and of the axes whose mirrors turn it, a bit
 * each (n_turned). words: see struct ops_words. */
static bool wrap_axis(global double *wide, global float *narrow, ulong plane, uint position,
                      constant struct sides *s, constant uint *table, uint n_kept, uint n_turned,
                      ulong i, uint axis)
{
    const double old = wide[at_of(position, axis, plane) + i];
    bool flipped = false;
    if ((old >= s->min[axis] && old < s->max[axis]) || !isfinite(old))
        return false;
    const double x = s->low[axis] == PERIODIC ? wrap_periodic(old, s->min[axis], s->max[axis])
                                              : wrap_mirror(s, axis, old, &flipped);
    wide[at_of(position, axis, plane) + i] = x;
    for (uint k = 0; k < n_kept; k++) {
        const double kept = real_get(wide, narrow, table[k], axis, plane, i);
        real_set(wide, narrow, table[k], axis, plane, i,
                 flipped ? old + x - kept : kept + (x - old));
    }
    constant uint *turned = table + n_kept;
    for (uint k = 0; flipped && k < n_turned; k++)
        if (turned[2 * k + 1] >> axis & 1u)
            real_set(wide, narrow, turned[2 * k], 0, plane, i,
                     -real_get(wide, narrow, turned[2 * k], 0, plane, i));
    return flipped || x < old || x > old;
}

kernel void wrap(global double *wide, global float *narrow, ulong plane, uint position,
                 constant struct sides *s, constant uint *table, uint n_kept, uint n_turned,
                 ulong n, global uint *words)
{
    const ulong i = get_global_id(0);
    bool here = false;
    if (i >= n)
        return;
    for (uint axis = 0; axis < DIM; axis++)
        here = wrap_axis(wide, narrow, plane, position, s, table, n_kept, n_turned, i, axis) || here;
    if (here)
        atomic_inc(words + 1);
}

/* -- Ghosts -------- */

#define SHARE 64 /* particles of a work item that counts and fills */

static inline bool near_side(constant struct sides *s, uint axis, uint image, double x,
                             double margin)
{
    const bool at_low = (image == IMAGE_LOW) != (s->low[axis] == PERIODIC);
    return (at_low ? x - s->min[axis] : s->max[axis] - x) < margin;
}

/* The images across both sides of an axis, where there are any (images: a bit each), of the first `present`
 * that stand there: how many, share by share, those below first. */
kernel void ghosts_count(global const double *wide, ulong plane, uint position,
                         constant struct sides *s, uint axis, uint images, double margin,
                         ulong present, uint shares, global uint *count)
{
    const uint me = get_global_id(0);
    if (me >= shares)
        return;
    const ulong first = (ulong)me * SHARE, end = min(first + SHARE, present);
    global const double *x = wide + at_of(position, axis, plane);
    uint low = 0, high = 0;
    for (ulong i = first; i < end; i++) {
        low += images & IMAGE_LOW && near_side(s, axis, IMAGE_LOW, x[i], margin);
        high += images & IMAGE_HIGH && near_side(s, axis, IMAGE_HIGH, x[i], margin);
    }
    count[me] = low;
    count[shares + me] = high;
}

/* One work group: each number becomes the sum of those before it; the whole sum comes behind them. */
#define SCANNERS 256
kernel __attribute__((reqd_work_group_size(SCANNERS, 1, 1))) void scan(global uint *count, uint n)
{
    local uint share[SCANNERS];
    const uint me = get_local_id(0);
    const uint each = (n + SCANNERS - 1) / SCANNERS;
    const uint first = min(me * each, n), end = min(first + each, n);
    uint sum = 0;
    for (uint i = first; i < end; i++)
        sum += count[i];
    share[me] = sum;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint step = 1; step < SCANNERS; step *= 2) {
        const uint below = me >= step ? share[me - step] : 0;
        barrier(CLK_LOCAL_MEM_FENCE);
        share[me] += below;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    uint before = share[me] - sum;
    for (uint i = first; i < end; i++) {
        const uint here = count[i];
        count[i] = before;
        before += here;
    }
    if (me == SCANNERS - 1)
        count[n] = share[me];
}

/* The k-th ghost is a copy of particle or ghost i. */
static void ghost_fill(global double *wide, ulong plane, uint position, constant struct sides *s,
                       uint axis, uint image, ulong n, ulong i, ulong k, global uint *parent,
                       global uchar *images)
{
    parent[k] = i < n ? (uint)i : parent[i - n];
    images[k] = (uchar)((i < n ? 0u : images[i - n]) | image << 2 * axis);
    for (uint c = 0; c < DIM; c++) {
        global double *x = wide + at_of(position, c, plane);
        x[n + k] = c == axis ? image_of(s, axis, image, x[i]) : x[i];
    }
}

/* before: as `scan` leaves it; n_ghost: those of earlier axes. */
kernel void ghosts_fill(global double *wide, ulong plane, uint position, constant struct sides *s,
                        uint axis, uint images, double margin, ulong present, uint shares,
                        global const uint *before, ulong n, global uint *parent,
                        global uchar *image)
{
    const uint me = get_global_id(0);
    if (me >= shares)
        return;
    const ulong first = (ulong)me * SHARE, end = min(first + SHARE, present), n_ghost = present - n;
    ulong low = n_ghost + before[me], high = n_ghost + before[shares + me];
    global const double *x = wide + at_of(position, axis, plane);
    for (ulong i = first; i < end; i++) {
        if (images & IMAGE_LOW && near_side(s, axis, IMAGE_LOW, x[i], margin))
            ghost_fill(wide, plane, position, s, axis, IMAGE_LOW, n, i, low++, parent, image);
        if (images & IMAGE_HIGH && near_side(s, axis, IMAGE_HIGH, x[i], margin))
            ghost_fill(wide, plane, position, s, axis, IMAGE_HIGH, n, i, high++, parent, image);
    }
}

/* A component of the position. */
kernel void refresh_position(global double *wide, ulong plane, uint position,
                             constant struct sides *s, ulong n, ulong n_ghost,
                             global const uint *parent, global const uchar *image)
{
    const ulong q = get_global_id(0);
    if (q >= n_ghost)
        return;
    for (uint c = 0; c < DIM; c++) {
        global double *x = wide + at_of(position, c, plane);
        const uint across = image[q] >> 2 * c & 3u;
        const double value = x[parent[q]];
        x[n + q] = across ? image_of(s, c, across, value) : value;
    }
}

/* Which image bits turn component k: byte k of `turning`. An odd number of them turns the sign. */
static inline ulong turned(ulong turning, uint image)
{
    const uint bits = image & (uint)turning;
    return ((bits & 3u) != 0) ^ ((bits & 12u) != 0) ^ ((bits & 48u) != 0);
}

/* Any other column, bit for bit. turning: of components 0 to 7, and of the ninth. */
kernel void refresh_wide(global ulong *wide, ulong plane, uint slot, uint ncomp, ulong turning,
                         ulong turning_8, ulong n, ulong n_ghost, global const uint *parent,
                         global const uchar *image, global float *narrow, uint mirror)
{
    const ulong q = get_global_id(0);
    if (q >= n_ghost)
        return;
    for (uint k = 0; k < ncomp; k++) {
        global ulong *x = wide + at_of(slot, k, plane);
        const ulong sign = turned((k < 8 ? turning >> 8 * k : turning_8) & 255u, image[q]);
        const ulong value = x[parent[q]] ^ sign << 63;
        x[n + q] = value;
        if (mirror != MISSING)
            narrow[at_of(mirror, k, plane) + n + q] = (float)as_double(value);
    }
}

kernel void refresh_narrow(global uint *narrow, ulong plane, uint slot, uint ncomp, ulong turning,
                           ulong turning_8, ulong n, ulong n_ghost, global const uint *parent,
                           global const uchar *image)
{
    const ulong q = get_global_id(0);
    if (q >= n_ghost)
        return;
    for (uint k = 0; k < ncomp; k++) {
        global uint *x = narrow + at_of(slot, k, plane);
        const uint sign = (uint)turned((k < 8 ? turning >> 8 * k : turning_8) & 255u, image[q]);
        x[n + q] = x[parent[q]] ^ sign << 31;
    }
}

/* -- For other ranks -------- */

/* Real particles' values as they are in images, component by component, from element `at` of `out` on. position:
 * whether the column is. */
kernel void pack_wide(global const ulong *wide, ulong plane, uint slot, uint ncomp, ulong turning,
                      ulong turning_8, constant struct sides *s, uint position, ulong n,
                      global const uint *index, global const uchar *image, global ulong *out,
                      ulong at)
{
    const ulong q = get_global_id(0);
    if (q >= n)
        return;
    for (uint k = 0; k < ncomp; k++) {
        const ulong value = wide[at_of(slot, k, plane) + index[q]];
        const uint across = image[q] >> 2 * k & 3u;
        const ulong sign = turned((k < 8 ? turning >> 8 * k : turning_8) & 255u, image[q]);
        if (position)
            out[at + k * n + q] =
                across ? as_ulong(image_of(s, k, across, as_double(value))) : value;
        else
            out[at + k * n + q] = value ^ sign << 63;
    }
}

kernel void pack_narrow(global const uint *narrow, ulong plane, uint slot, uint ncomp,
                        ulong turning, ulong turning_8, ulong n, global const uint *index,
                        global const uchar *image, global uint *out, ulong at)
{
    const ulong q = get_global_id(0);
    if (q >= n)
        return;
    for (uint k = 0; k < ncomp; k++) {
        const uint sign = (uint)turned((k < 8 ? turning >> 8 * k : turning_8) & 255u, image[q]);
        out[at + k * n + q] = narrow[at_of(slot, k, plane) + index[q]] ^ sign << 31;
    }
}
