/* opencl/look.cl -- the kernels of look.c. DIM is defined in front of it. A work item takes a block of particles. */
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

/* A component to look at: element `at` of its buffer and the n - 1 behind it. */
typedef struct {
    ulong at;
    double least, most;
    uint size, reserved;
} entry;

/* Block `get_global_id(0) % blocks` of entry `get_global_id(0) / blocks`. */
__kernel void look_columns(__global const double *wide, __global const float *narrow,
                           __global const entry *entries, const uint n_entry, const uint n,
                           const uint block, const uint blocks, __global uint *wrong)
{
    const uint id = (uint)get_global_id(0), k = id / blocks;
    if (k >= n_entry)
        return;
    const uint first = id % blocks * block, end = min(first + block, n);
    const double least = entries[k].least, most = entries[k].most;
    int bad = 0;
    if (entries[k].size == 8) {
        __global const double *x = wide + entries[k].at;
        for (uint i = first; i < end; i++)
            bad |= !(x[i] >= least) | !(x[i] <= most);
    } else {
        __global const float *x = narrow + entries[k].at;
        for (uint i = first; i < end; i++)
            bad |= !((double)x[i] >= least) | !((double)x[i] <= most);
    }
    if (bad)
        *wrong = 1; /* whoever writes, writes this */
}

/* Groups of 8 with a flag that is set, of every block. */
__kernel void look_groups(__global const int *narrow, const ulong at, const uint n, const uint block,
                          __global uint *part)
{
    const uint b = (uint)get_global_id(0), first = b * block;
    if (first >= n)
        return;
    const uint end = min(first + block, n);
    __global const int *flags = narrow + at;
    uint found = 0;
    for (uint i = first; i < end; i += 8) {
        int any = 0;
        for (uint k = i; k < min(i + 8, end); k++)
            any |= flags[k];
        found += any != 0;
    }
    part[b] = found;
}

/* mass, kinetic, momentum's and angular momentum's scales, momentum, angular momentum: of every block. */
#define SUMS 10
__kernel void look_totals(__global const double *wide, __global const float *narrow,
                          const ulong m_at, const uint m_size, const ulong x_at, const ulong v_at,
                          const uint v_size, const ulong plane, const uint n, const uint block,
                          __global double *part)
{
    const uint b = (uint)get_global_id(0), first = b * block;
    if (first >= n)
        return;
    const uint end = min(first + block, n);
    double sum[SUMS];
    for (int k = 0; k < SUMS; k++)
        sum[k] = 0.0;
    for (uint i = first; i < end; i++) {
        const double m = m_size == 8 ? wide[m_at + i] : m_size == 4 ? (double)narrow[m_at + i] : 0.0;
        double x[3] = {0.0, 0.0, 0.0}, v[3] = {0.0, 0.0, 0.0}, v2 = 0.0, x2 = 0.0;
        for (int c = 0; c < DIM; c++) {
            x[c] = wide[x_at + c * plane + i];
            v[c] = v_size == 8   ? wide[v_at + c * plane + i]
                   : v_size == 4 ? (double)narrow[v_at + c * plane + i]
                                 : 0.0;
            v2 += v[c] * v[c];
            x2 += x[c] * x[c];
        }
        sum[0] += m;
        sum[1] += 0.5 * m * v2;
        sum[2] += m * sqrt(v2);
        sum[3] += m * sqrt(v2 * x2);
        for (int c = 0; c < 3; c++) {
            const int d = (c + 1) % 3, f = (c + 2) % 3;
            sum[4 + c] += m * v[c];
            sum[7 + c] += m * (x[d] * v[f] - x[f] * v[d]);
        }
    }
    for (int k = 0; k < SUMS; k++)
        part[b * SUMS + k] = sum[k];
}
