/* opencl/order.cl -- the order of cells: order.c's and edge.c's of the neighbours, comparison by
 * comparison. */

#define CELL_MOST 32u /* points of a cell that are sorted by x alone */

/* -- How full cells are -------- */

/* Of a stretch of counts: the sum of their squares, the sum of those that are not less than `least`, and how
 * many these are. */
KERNEL void full_sums(__global const uint *count, uint n, uint each, double least,
                      __global ulong *out)
{
    const ulong begin = get_global_id(0) * (ulong)each, end = min(begin + each, (ulong)n);
    ulong squares = 0, sum = 0, cells = 0;

    if (begin >= n) {
        return;
    }
    for (ulong k = begin; k < end; k++) {
        const bool full = count[k] >= least;

        squares += (ulong)count[k] * count[k];
        sum += full ? count[k] : 0;
        cells += full;
    }
    out += 3 * get_global_id(0);
    out[0] = squares;
    out[1] = sum;
    out[2] = cells;
}

/* -- Within a cell -------- */

/* Sorts the points of cells by x; end[c] is where cell c ends. Crowded ones are put on a list,
 * crowd[1] and on, of crowd[0]. */
KERNEL void cells_sort(__global const double *wide, struct points p, ulong id, uint cells,
                       __global const uint *end, __global uint *order, __global uint *crowd)
{
    const ulong first = get_global_id(0) * (ulong)EACH, last = min(first + EACH, (ulong)cells);
    double x[CELL_MOST];
    uint index[CELL_MOST];

    for (ulong c = first; c < last; c++) {
        const uint begin = c > 0 ? end[c - 1] : 0, n = end[c] - begin;

        if (n > CELL_MOST) {
            crowd[1 + atomic_inc(crowd)] = (uint)c;
            continue;
        }
        for (uint k = 0; k < n; k++) {
            const uint i = order[begin + k];
            const double xi = wide[p.x + i];
            uint q = k;

            for (; q > 0; q--) {
                const double xq = x[q - 1];

                if (!(xi < xq || (!(xi > xq) && before_id(wide, id, i, index[q - 1])))) {
                    break;
                }
                x[q] = xq;
                index[q] = index[q - 1];
            }
            x[q] = xi;
            index[q] = i;
        }
        for (uint k = 0; k < n; k++) {
            order[begin + k] = index[k];
        }
    }
}
