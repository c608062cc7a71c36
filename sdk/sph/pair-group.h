/* sph/pair-group.h -- the loop over groups, for one instruction set, dimension and shape of kernel;
 * the inside of pair-dims.h. SPH_WIDTH destinations of a group stand in the lanes of R; their common
 * sources are walked once, each broadcast: no gather, no horizontal sum, no scatter. */

#define SPH_HELD T
#include <sph/pair-columns.h>

/* Destination values into lanes; source values, the same in every lane. */
#define SPH_I_S(name, k) const R name##_i = SPH_OF_ISA(sph_load_)(SPH_P(b->dst[k], 0) + i);
#define SPH_I_V(name, k) SPH_I_N(name, k, DIM)
#define SPH_I_M(name, k) SPH_I_N(name, k, DIM *DIM)
#define SPH_I_N(name, k, n)                                                                        \
    R name##_i[n];                                                                                 \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        name##_i[sph_c] = SPH_OF_ISA(sph_load_)(SPH_P(b->dst[k], sph_c) + i);
#define SPH_J_S(name, k) const R name##_j = sph_num(name##_s[j]);
#define SPH_J_V(name, k) SPH_J_N(name, DIM)
#define SPH_J_M(name, k) SPH_J_N(name, DIM *DIM)
#define SPH_J_N(name, n)                                                                           \
    R name##_j[n];                                                                                 \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        name##_j[sph_c] = sph_num(name##_s[sph_c][j]);
/* Stores the lanes that are particles. */
#define SPH_O_S(name, k) SPH_O_N(&name, k, 1)
#define SPH_O_V(name, k) SPH_O_N(name, k, DIM)
#define SPH_O_M(name, k) SPH_O_N(name, k, DIM *DIM)
#define SPH_O_N(array, k, n)                                                                       \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        for (int l = 0; l < lanes; l++)                                                            \
            SPH_P(b->dst[k], sph_c)[i + (uint64_t)l] += (array)[sph_c][l];
#define SPH_O_MIN(name, k) SPH_O_LEAST(name, k, <)
#define SPH_O_MAX(name, k) SPH_O_LEAST(name, k, >)
#define SPH_O_LEAST(name, k, is)                                                                   \
    for (int l = 0; l < lanes; l++) {                                                              \
        T *const sph_o = SPH_P(b->dst[k], 0) + i + l;                                              \
        *sph_o = name[l] is * sph_o || name[l] != name[l] ? name[l] : *sph_o;                      \
    }

/* dx and r2 from source j. */
#if SPH_F32_WORDS
#define SPH_APART_ALONG(c, j) __builtin_convertvector(x_i[c] - x_s[c][j], R) * quantum
#else
#define SPH_APART_ALONG(c, j) x_i[c] - x_s[c][j]
#endif
#define SPH_APART(dx, r2, j)                                                                       \
    for (int sph_c = 0; sph_c < DIM; sph_c++) {                                                    \
        (dx)[sph_c] = SPH_APART_ALONG(sph_c, j);                                                   \
        (r2) += (dx)[sph_c] * (dx)[sph_c];                                                         \
    }

static sph_status SPH_LOOP_NAME(const sph_batch *b)
{
    FORM sph_local;
    SPH_OF_ISA(sph_form_)(&sph_local, b->kernel);
    const FORM *const K = &sph_local;
    const SPH_X_HELD *x_s[DIM];
    for (int c = 0; c < DIM; c++)
        x_s[c] = SPH_X(b->x_src, c);
    const T *const h_s = SPH_P(b->h_src, 0);
#if SPH_F32_WORDS
    const T quantum = (T)b->quantum;
#endif
    SPH_LOOP_J(SPH_S_S, SPH_S_V, SPH_S_M)
    SPH_LOOP_PARAM(SPH_PARAM_OF)
    const uint64_t end = b->first + b->count;

    for (uint64_t i = b->first; i < end; i += SPH_WIDTH) {
        const uint64_t sph_g = i / SPH_LANES;
        const int lanes = end - i < SPH_WIDTH ? (int)(end - i) : SPH_WIDTH;
        /* What tells the self pair: no source has the number -1. */
        B number;
        for (int l = 0; l < SPH_WIDTH; l++)
            number[l] = SPH_LOOP_SELF || !b->same ? -1 : (SPH_INT)i + l;
#if SPH_F32_WORDS
        B x_i[DIM];
        for (int c = 0; c < DIM; c++)
            x_i[c] = *(const B *)(const void *)(SPH_X(b->x_dst, c) + i);
#else
        R x_i[DIM];
        for (int c = 0; c < DIM; c++)
            x_i[c] = SPH_OF_ISA(sph_load_)(SPH_X(b->x_dst, c) + i);
#endif
        const R h_i = SPH_OF_ISA(sph_load_)(SPH_P(b->h_dst, 0) + i);
        const R hinv_i = (T)1.0 / h_i, reach2_i = K->support * h_i * (K->support * h_i);
        (void)hinv_i;
        SPH_LOOP_I(SPH_I_S, SPH_I_V, SPH_I_M)
        SPH_LOOP_SUM(SPH_A_S, SPH_A_V, SPH_A_M)
        SPH_LOOP_MIN(SPH_A_MIN)
        SPH_LOOP_MAX(SPH_A_MAX)

        for (uint64_t sph_s = b->begin[sph_g]; sph_s < b->begin[sph_g + 1]; sph_s++) {
            const uint32_t sph_base = b->span[sph_s].base, sph_n = b->span[sph_s].count;
            const uint16_t *const sph_steps = b->list + b->span[sph_s].first;
            if (sph_n == 0)
                continue;
            /* Of each pair what its body waits for longest, the root, is begun while the pair before
             * it is worked on: the processor's own reordering does not reach that far. */
            size_t sph_next = (size_t)sph_base + sph_steps[0];
            R sph_dx[DIM], sph_r2 = {0};
            SPH_APART(sph_dx, sph_r2, sph_next)
            R sph_r = sph_sqrt(sph_r2), sph_rinv = sph_rsqrt(sph_r2);
            for (uint32_t sph_k = 0; sph_k < sph_n; sph_k++) {
                const size_t j = sph_next;
                const R r2 = sph_r2, r = sph_r, rinv = sph_rinv;
                R dx[DIM];
                for (int c = 0; c < DIM; c++)
                    dx[c] = sph_dx[c];
                sph_next = (size_t)sph_base + sph_steps[sph_k + 1 < sph_n ? sph_k + 1 : sph_k];
                sph_r2 = sph_num(0.0);
                SPH_APART(sph_dx, sph_r2, sph_next)
                sph_r = sph_sqrt(sph_r2);
                sph_rinv = sph_rsqrt(sph_r2);
                const R h_j = SPH_UNIFORM ? h_i : sph_num(h_s[j]);
                const R hinv_j = SPH_UNIFORM ? hinv_i : sph_num((T)1.0 / h_s[j]);
                const T reach_j = SPH_UNIFORM ? (T)0.0 : K->support * h_s[j];
                const R reach2 = SPH_UNIFORM || SPH_LOOP_REACH == SPH_GATHER
                                     ? reach2_i
                                     : sph_max(reach2_i, sph_num(reach_j * reach_j));
                const SPH_OF_ISA(sph_lanes_in) sph_within =
                    SPH_OF_ISA(sph_within_)(r2, reach2, number, SPH_OF_ISA(sph_whole_)((SPH_INT)j));
                const B in = SPH_OF_ISA(sph_mask_of_)(sph_within);
                (void)in;
                (void)dx;
                (void)rinv;
                (void)r;
                (void)h_j;
                (void)hinv_j;
                SPH_LOOP_J(SPH_J_S, SPH_J_V, SPH_J_M)
#include <sph/pair-bodies.h>
            }
        }
        SPH_LOOP_SUM(SPH_O_S, SPH_O_V, SPH_O_M)
        SPH_LOOP_MIN(SPH_O_MIN)
        SPH_LOOP_MAX(SPH_O_MAX)
    }
    return SPH_OK;
}

#undef SPH_I_S
#undef SPH_I_V
#undef SPH_I_M
#undef SPH_I_N
#undef SPH_J_S
#undef SPH_J_V
#undef SPH_J_M
#undef SPH_J_N
#undef SPH_O_S
#undef SPH_O_V
#undef SPH_O_M
#undef SPH_O_N
#undef SPH_O_MIN
#undef SPH_O_MAX
#undef SPH_O_LEAST
#undef SPH_APART
#undef SPH_APART_ALONG
#include <sph/pair-columns.h>
#undef SPH_HELD
