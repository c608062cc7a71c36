/* sph/pair-group.h -- the loop over groups, for one instruction set, dimension and shape of kernel;
 * the inside of pair-dims.h. SPH_WIDTH destinations of a group stand in the lanes of R; their
 * sources are walked once, each broadcast to all lanes or to half of them: no gather, no horizontal
 * sum, no scatter. */

#define SPH_HELD T
#include <sph/pair-columns.h>

/* Destination values into lanes. */
#define SPH_I_S(name, k) const R name##_i = SPH_OF_ISA(sph_load_)(SPH_P(b->dst[k], 0) + i);
#define SPH_I_V(name, k) SPH_I_N(name, k, DIM)
#define SPH_I_M(name, k) SPH_I_N(name, k, DIM *DIM)
#define SPH_I_N(name, k, n)                                                                        \
    R name##_i[n];                                                                                 \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        name##_i[sph_c] = SPH_OF_ISA(sph_load_)(SPH_P(b->dst[k], sph_c) + i);
/* Stores the lanes that are particles. */
#define SPH_O_S(name, k) SPH_O_N(&name, k, 1)
#define SPH_O_V(name, k) SPH_O_N(name, k, DIM)
#define SPH_O_M(name, k) SPH_O_N(name, k, DIM *DIM)
#define SPH_O_N(array, k, n)                                                                       \
    for (int sph_c = 0; sph_c < n; sph_c++) {                                                      \
        T *const sph_o = SPH_P(b->dst[k], sph_c) + i;                                              \
        const R sph_sum = (array)[sph_c];                                                          \
        if (lanes == SPH_WIDTH)                                                                    \
            *(R *)(void *)sph_o += sph_sum;                                                        \
        else                                                                                       \
            for (int l = 0; l < lanes; l++)                                                        \
                sph_o[l] += sph_sum[l];                                                            \
    }
#define SPH_O_MIN(name, k) SPH_O_LEAST(name, k, <)
#define SPH_O_MAX(name, k) SPH_O_LEAST(name, k, >)
#define SPH_O_LEAST(name, k, is)                                                                   \
    for (int l = 0; l < lanes; l++) {                                                              \
        T *const sph_o = SPH_P(b->dst[k], 0) + i + l;                                              \
        *sph_o = name[l] is * sph_o || name[l] != name[l] ? name[l] : *sph_o;                      \
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
            const uint32_t sph_base = b->span[sph_s].base, sph_common = b->span[sph_s].common,
                           sph_turns = (b->span[sph_s].count - sph_common) / 2u;
            const uint16_t *const sph_steps = b->list + b->span[sph_s].first;
#if SPH_WIDTH == SPH_LANES
#define SPH_STEPS sph_common
#define SPH_AT(k) (k)
#else
            /* Half a group, whose turns follow what is common. */
            const uint32_t sph_half = i % SPH_LANES >= SPH_LANES / 2u;
#define SPH_STEPS (sph_common + sph_turns)
#define SPH_AT(k) SPH_AT_HALF(k, sph_common, sph_half)
#endif
            if (SPH_STEPS) {
#include <sph/pair-steps.h>
            }
#undef SPH_STEPS
#undef SPH_AT
#if SPH_WIDTH == SPH_LANES
#define SPH_TURNS
#define SPH_STEPS sph_turns
#define SPH_AT(k) (sph_common + 2u * (k))
            if (SPH_STEPS) {
#include <sph/pair-steps.h>
            }
#undef SPH_TURNS
#undef SPH_STEPS
#undef SPH_AT
#endif
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
#undef SPH_O_S
#undef SPH_O_V
#undef SPH_O_M
#undef SPH_O_N
#undef SPH_O_MIN
#undef SPH_O_MAX
#undef SPH_O_LEAST
#include <sph/pair-columns.h>
#undef SPH_HELD
