/* opencl/sort.cl -- sums that run along an array, and a stable sort of keys with their values. A
 * work item takes a stretch of its own; what comes out is the same for any number of them.
 *
 * WG: work items of a group; SORT_BITS: of a digit. SORTS 0: the sums, 1: the sorts. */

#define KERNEL __kernel __attribute__((reqd_work_group_size(WG, 1, 1)))
#define SORT_BINS (1u << SORT_BITS)

/* -- Running sums -------- */

#if !SORTS

/* What comes before a work item's own sum, of one group; *all: the sum of all. */
static ulong group_before(ulong mine, __local ulong *room, ulong *all)
{
    const uint l = (uint)get_local_id(0);
    ulong before = 0, sum = 0;

    room[l] = mine;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint k = 0; k < WG; k++) {
        before += k < l ? room[k] : 0;
        sum += room[k];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    *all = sum;
    return before;
}

static uint stretch_first(uint n, uint item, uint items)
{
    return (uint)((ulong)n * item / items);
}

/* One group does it all: out[i] = total[slot] + in[0] + ... in[i - 1], likewise out[n]; total[slot
 * + 1] is the sum with all 64 bits. */
KERNEL void scan_whole(__global const uint *in, uint in_at, uint n, __global uint *out, uint out_at,
                       __global ulong *total, uint slot)
{
    __local ulong room[WG];
    const uint l = (uint)get_local_id(0);
    const uint first = stretch_first(n, l, WG), last = stretch_first(n, l + 1, WG);
    ulong sum = 0, all;

    if (get_group_id(0) > 0) {
        return;
    }
    in += in_at;
    out += out_at;
    for (uint i = first; i < last; i++) {
        sum += in[i];
    }
    sum = total[slot] + group_before(sum, room, &all);
    for (uint i = first; i < last; i++) {
        const uint here = in[i];

        out[i] = (uint)sum;
        sum += here;
    }
    if (l == WG - 1) {
        out[n] = (uint)sum;
        total[slot + 1] = sum;
    }
}

/* The sums of stretches. */
KERNEL void scan_sums(__global const uint *in, uint in_at, uint n, uint each, __global ulong *part)
{
    const uint c = (uint)get_global_id(0);
    const ulong first = (ulong)c * each;
    const uint last = (uint)min(first + each, (ulong)n);
    ulong sum = 0;

    if (first >= n) {
        return;
    }
    for (uint i = (uint)first; i < last; i++) {
        sum += in[in_at + i];
    }
    part[c] = sum;
}

/* What comes before each of them. */
KERNEL void scan_parts(__global ulong *part, uint n, __global ulong *total, uint slot)
{
    __local ulong room[WG];
    const uint l = (uint)get_local_id(0);
    const uint first = stretch_first(n, l, WG), last = stretch_first(n, l + 1, WG);
    ulong sum = 0, all;

    if (get_group_id(0) > 0) {
        return;
    }
    for (uint i = first; i < last; i++) {
        sum += part[i];
    }
    sum = total[slot] + group_before(sum, room, &all);
    for (uint i = first; i < last; i++) {
        const ulong here = part[i];

        part[i] = sum;
        sum += here;
    }
    if (l == WG - 1) {
        total[slot + 1] = sum;
    }
}

KERNEL void scan_out(__global const uint *in, uint in_at, uint n, uint each,
                     __global const ulong *part, __global uint *out, uint out_at)
{
    const uint c = (uint)get_global_id(0);
    const ulong first = (ulong)c * each;
    const uint last = (uint)min(first + each, (ulong)n);
    uint sum;

    if (first >= n) {
        return;
    }
    sum = (uint)part[c];
    for (uint i = (uint)first; i < last; i++) {
        const uint here = in[in_at + i];

        out[out_at + i] = sum;
        sum += here;
    }
    if (last == n) {
        out[out_at + n] = sum;
    }
}

#else

/* -- A digit -------- */

/* count[digit * stretches + stretch]: how many keys of a stretch have the digit; then, as running
 * sums, where they go. */
#define SORT(KEY)                                                                                  \
    KERNEL void sort_count_##KEY(__global const KEY *key, uint n, uint each, uint stretches,       \
                                 uint shift, __global uint *count)                                 \
    {                                                                                              \
        const uint c = (uint)get_global_id(0);                                                     \
        const ulong first = (ulong)c * each;                                                       \
        const uint last = (uint)min(first + each, (ulong)n);                                       \
        uint mine[SORT_BINS];                                                                      \
                                                                                                   \
        if (c >= stretches) {                                                                      \
            return;                                                                                \
        }                                                                                          \
        for (uint d = 0; d < SORT_BINS; d++) {                                                     \
            mine[d] = 0;                                                                           \
        }                                                                                          \
        for (uint i = (uint)first; i < last; i++) {                                                \
            mine[(uint)(key[i] >> shift) & (SORT_BINS - 1)]++;                                     \
        }                                                                                          \
        for (uint d = 0; d < SORT_BINS; d++) {                                                     \
            count[d * stretches + c] = mine[d];                                                    \
        }                                                                                          \
    }                                                                                              \
                                                                                                   \
    KERNEL void sort_move_##KEY(__global const KEY *key, __global const uint *value, uint n,       \
                                uint each, uint stretches, uint shift, __global const uint *count, \
                                __global KEY *to_key, __global uint *to_value)                     \
    {                                                                                              \
        const uint c = (uint)get_global_id(0);                                                     \
        const ulong first = (ulong)c * each;                                                       \
        const uint last = (uint)min(first + each, (ulong)n);                                       \
        uint mine[SORT_BINS];                                                                      \
                                                                                                   \
        if (c >= stretches) {                                                                      \
            return;                                                                                \
        }                                                                                          \
        for (uint d = 0; d < SORT_BINS; d++) {                                                     \
            mine[d] = count[d * stretches + c];                                                    \
        }                                                                                          \
        for (uint i = (uint)first; i < last; i++) {                                                \
            const KEY k = key[i];                                                                  \
            const uint to = mine[(uint)(k >> shift) & (SORT_BINS - 1)]++;                          \
                                                                                                   \
            to_key[to] = k;                                                                        \
            to_value[to] = value[i];                                                               \
        }                                                                                          \
    }

SORT(uint)
SORT(ulong)

#endif
