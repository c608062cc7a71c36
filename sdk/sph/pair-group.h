/* sph/pair-group.h -- the loop itself, for one instruction set and dimension; the inside of
 * pair-dims.h. SPH_WIDTH destinations of a group stand in the lanes of R; their common source list
 * is walked once, each source broadcast: no gather, no horizontal sum, no scatter. */

#define SPH_P(column, c) ((double *)(column).data + (size_t)(c) * (column).plane)

/* Destination values into lanes. */
#define SPH_I_S(name, k) const R name##_i = SPH_OF_ISA(sph_load_)(SPH_P(b->dst[k], 0) + i);
#define SPH_I_V(name, k)                                                                           \
    R name##_i[DIM];                                                                               \
    for (int c = 0; c < DIM; c++)                                                                  \
        name##_i[c] = SPH_OF_ISA(sph_load_)(SPH_P(b->dst[k], c) + i);
#define SPH_I_M(name, k)                                                                           \
    R name##_i[DIM * DIM];                                                                         \
    for (int c = 0; c < DIM * DIM; c++)                                                            \
        name##_i[c] = SPH_OF_ISA(sph_load_)(SPH_P(b->dst[k], c) + i);
/* Source columns, then their values broadcast. */
#define SPH_S_S(name, k) const double *const name##_s = SPH_P(b->src[k], 0);
#define SPH_S_V(name, k)                                                                           \
    const double *name##_s[DIM];                                                                   \
    for (int c = 0; c < DIM; c++)                                                                  \
        name##_s[c] = SPH_P(b->src[k], c);
#define SPH_S_M(name, k)                                                                           \
    const double *name##_s[DIM * DIM];                                                             \
    for (int c = 0; c < DIM * DIM; c++)                                                            \
        name##_s[c] = SPH_P(b->src[k], c);
#define SPH_J_S(name, k) const R name##_j = sph_num(name##_s[j]);
#define SPH_J_V(name, k)                                                                           \
    R name##_j[DIM];                                                                               \
    for (int c = 0; c < DIM; c++)                                                                  \
        name##_j[c] = sph_num(name##_s[c][j]);
#define SPH_J_M(name, k)                                                                           \
    R name##_j[DIM * DIM];                                                                         \
    for (int c = 0; c < DIM * DIM; c++)                                                            \
        name##_j[c] = sph_num(name##_s[c][j]);
/* Accumulators: made, and stored for the lanes that are particles. */
#define SPH_A_S(name, k) R name = {0};
#define SPH_A_V(name, k) R name[DIM] = {{0}};
#define SPH_A_M(name, k) R name[DIM * DIM] = {{0}};
#define SPH_A_MIN(name, k) R name = sph_num(INFINITY);
#define SPH_A_MAX(name, k) R name = sph_num(-INFINITY);
#define SPH_O_S(name, k)                                                                           \
    for (int l = 0; l < lanes; l++)                                                                \
        SPH_P(b->dst[k], 0)[i + (uint64_t)l] += name[l];
#define SPH_O_V(name, k)                                                                           \
    for (int c = 0; c < DIM; c++)                                                                  \
        for (int l = 0; l < lanes; l++)                                                            \
            SPH_P(b->dst[k], c)[i + (uint64_t)l] += name[c][l];
#define SPH_O_M(name, k)                                                                           \
    for (int c = 0; c < DIM * DIM; c++)                                                            \
        for (int l = 0; l < lanes; l++)                                                            \
            SPH_P(b->dst[k], c)[i + (uint64_t)l] += name[c][l];
#define SPH_O_MIN(name, k)                                                                         \
    for (int l = 0; l < lanes; l++)                                                                \
        SPH_P(b->dst[k], 0)[i + (uint64_t)l] = fmin(SPH_P(b->dst[k], 0)[i + (uint64_t)l], name[l]);
#define SPH_O_MAX(name, k)                                                                         \
    for (int l = 0; l < lanes; l++)                                                                \
        SPH_P(b->dst[k], 0)[i + (uint64_t)l] = fmax(SPH_P(b->dst[k], 0)[i + (uint64_t)l], name[l]);
#define SPH_PARAM_OF(name, k) const double name = b->param[k];

static sph_status SPH_LOOP_NAME(SPH_ISA)(const sph_batch *b)
{
    const sph_kernel_form *const K = b->kernel;
    const double *x_s[DIM];
    for (int c = 0; c < DIM; c++)
        x_s[c] = SPH_P(b->x_src, c);
    const double *const h_s = SPH_P(b->h_src, 0);
    SPH_LOOP_J(SPH_S_S, SPH_S_V, SPH_S_M)
    SPH_LOOP_PARAM(SPH_PARAM_OF)
    R lane_number;
    for (int l = 0; l < SPH_WIDTH; l++)
        lane_number[l] = l;
    const uint64_t end = b->first + b->count;

    for (uint64_t i = b->first; i < end; i += SPH_WIDTH) {
        const uint64_t sph_g = i / SPH_LANES;
        const int lanes = end - i < SPH_WIDTH ? (int)(end - i) : SPH_WIDTH;
        R x_i[DIM];
        for (int c = 0; c < DIM; c++)
            x_i[c] = SPH_OF_ISA(sph_load_)(SPH_P(b->x_dst, c) + i);
        const R h_i = SPH_OF_ISA(sph_load_)(SPH_P(b->h_dst, 0) + i);
        const R hinv_i = 1.0 / h_i;
        const R number = lane_number + (double)i;
        SPH_LOOP_I(SPH_I_S, SPH_I_V, SPH_I_M)
        SPH_LOOP_SUM(SPH_A_S, SPH_A_V, SPH_A_M)
        SPH_LOOP_MIN(SPH_A_MIN)
        SPH_LOOP_MAX(SPH_A_MAX)

        for (uint64_t sph_k = b->begin[sph_g]; sph_k < b->begin[sph_g + 1]; sph_k++) {
            const uint32_t j = b->list[sph_k];
            R dx[DIM];
            R r2 = {0};
            for (int c = 0; c < DIM; c++) {
                dx[c] = x_i[c] - x_s[c][j];
                r2 += dx[c] * dx[c];
            }
            const R h_j = sph_num(h_s[j]);
            const R reach = K->support * (SPH_LOOP_REACH == SPH_GATHER ? h_i : sph_max(h_i, h_j));
            B in = (B)(r2 < reach * reach);
            const B self = (B)(number == sph_num(b->same ? (double)j : -1.0));
#if !SPH_LOOP_SELF
            in &= ~self;
#endif
            const R r = sph_sqrt(r2);
            const R rinv = sph_select(r2 > sph_num(0.0), 1.0 / r, sph_num(0.0));
            const R hinv_j = sph_num(1.0 / h_s[j]);
            (void)self;
            (void)rinv;
            (void)hinv_j;
            (void)hinv_i;
            SPH_LOOP_J(SPH_J_S, SPH_J_V, SPH_J_M)
            {
#include SPH_LOOP_BODY
            }
        }
        SPH_LOOP_SUM(SPH_O_S, SPH_O_V, SPH_O_M)
        SPH_LOOP_MIN(SPH_O_MIN)
        SPH_LOOP_MAX(SPH_O_MAX)
    }
    return SPH_OK;
}

#undef SPH_P
#undef SPH_I_S
#undef SPH_I_V
#undef SPH_I_M
#undef SPH_S_S
#undef SPH_S_V
#undef SPH_S_M
#undef SPH_J_S
#undef SPH_J_V
#undef SPH_J_M
#undef SPH_A_S
#undef SPH_A_V
#undef SPH_A_M
#undef SPH_A_MIN
#undef SPH_A_MAX
#undef SPH_O_S
#undef SPH_O_V
#undef SPH_O_M
#undef SPH_O_MIN
#undef SPH_O_MAX
#undef SPH_PARAM_OF
