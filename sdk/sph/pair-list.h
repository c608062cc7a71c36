/* sph/pair-list.h -- the loop over single destinations, for vectors of two doubles: the
 * sources within reach are listed first, then SPH_WIDTH of them at a time stand in the lanes of R.
 * The inside of pair-dims.h, in place of pair-group.h. */

#define SPH_HELD T
#include <sph/pair-columns.h>
#define SPH_NEAR 256 /* sources looked at before those within reach are worked on */

/* Destination values, the same in every lane; source values into lanes. */
#define SPH_I_S(name, k) const R name##_i = sph_num(SPH_P(b->dst[k], 0)[i]);
#define SPH_I_V(name, k) SPH_I_N(name, k, DIM)
#define SPH_I_M(name, k) SPH_I_N(name, k, DIM *DIM)
#define SPH_I_N(name, k, n)                                                                        \
    R name##_i[n];                                                                                 \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        name##_i[sph_c] = sph_num(SPH_P(b->dst[k], sph_c)[i]);
#define SPH_J_S(name, k) const R name##_j = SPH_OF_ISA(sph_gather_)(name##_s, sph_near + sph_q);
#define SPH_J_V(name, k) SPH_J_N(name, DIM)
#define SPH_J_M(name, k) SPH_J_N(name, DIM *DIM)
#define SPH_J_N(name, n)                                                                           \
    R name##_j[n];                                                                                 \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        name##_j[sph_c] = SPH_OF_ISA(sph_gather_)(name##_s[sph_c], sph_near + sph_q);
/* Sums over the lanes. */
#define SPH_O_S(name, k) SPH_O_N(&name, k, 1)
#define SPH_O_V(name, k) SPH_O_N(name, k, DIM)
#define SPH_O_M(name, k) SPH_O_N(name, k, DIM *DIM)
#define SPH_O_N(array, k, n)                                                                       \
    for (int sph_c = 0; sph_c < n; sph_c++) {                                                      \
        T sph_o = (array)[sph_c][0];                                                               \
        for (int l = 1; l < SPH_WIDTH; l++)                                                        \
            sph_o += (array)[sph_c][l];                                                            \
        SPH_P(b->dst[k], sph_c)[i] += sph_o;                                                       \
    }
#define SPH_O_MIN(name, k) SPH_O_LEAST(name, k, <)
#define SPH_O_MAX(name, k) SPH_O_LEAST(name, k, >)
#define SPH_O_LEAST(name, k, is)                                                                   \
    for (int l = 0; l < SPH_WIDTH; l++) {                                                          \
        T *const sph_o = SPH_P(b->dst[k], 0) + i;                                                  \
        *sph_o = name[l] is * sph_o || name[l] != name[l] ? name[l] : *sph_o;                      \
    }

static sph_status SPH_LOOP_NAME(const sph_batch *b)
{
    FORM sph_local;
    SPH_OF_ISA(sph_form_)(&sph_local, b->kernel);
    const FORM *const K = &sph_local;
    const SPH_X_HELD *x_s[DIM], *x_d[DIM];
    for (int c = 0; c < DIM; c++) {
        x_s[c] = SPH_X(b->x_src, c);
        x_d[c] = SPH_X(b->x_dst, c);
    }
    const T *const h_s = SPH_P(b->h_src, 0);
    SPH_LOOP_J(SPH_S_S, SPH_S_V, SPH_S_M)
    SPH_LOOP_PARAM(SPH_PARAM_OF)
    const uint64_t end = b->first + b->count, sph_self = SPH_LOOP_SELF || !b->same;
    B sph_first;
    for (int l = 0; l < SPH_WIDTH; l++)
        sph_first[l] = l;

    for (uint64_t i = b->first; i < end; i++) {
        const uint64_t sph_g = i / SPH_LANES;
        const T sph_h = SPH_P(b->h_dst, 0)[i], reach2_i = K->support * sph_h * (K->support * sph_h);
        const R h_i = sph_num(sph_h), hinv_i = sph_num((T)1.0 / sph_h);
        (void)h_i;
        (void)hinv_i;
        SPH_LOOP_I(SPH_I_S, SPH_I_V, SPH_I_M)
        SPH_LOOP_SUM(SPH_A_S, SPH_A_V, SPH_A_M)
        SPH_LOOP_MIN(SPH_A_MIN)
        SPH_LOOP_MAX(SPH_A_MAX)

        const uint32_t sph_half = i % SPH_LANES >= SPH_LANES / 2u;
        for (uint64_t sph_s = b->begin[sph_g]; sph_s < b->begin[sph_g + 1]; sph_s++) {
            const uint32_t sph_base = b->span[sph_s].base, sph_common = b->span[sph_s].common,
                           sph_all = sph_common + (b->span[sph_s].count - sph_common) / 2u;
            const uint16_t *const sph_steps = b->list + b->span[sph_s].first;
            for (uint32_t sph_k = 0; sph_k < sph_all; sph_k += SPH_NEAR) {
                const uint32_t sph_end = sph_all - sph_k < SPH_NEAR ? sph_all : sph_k + SPH_NEAR;
                uint32_t sph_near[SPH_NEAR + SPH_WIDTH];
                int sph_found = 0;
                for (uint32_t sph_q = sph_k; sph_q < sph_end; sph_q++) {
                    const uint32_t j =
                        sph_base + sph_steps[SPH_AT_HALF(sph_q, sph_common, sph_half)];
                    T d2 = 0, reach2 = reach2_i;
                    for (int c = 0; c < DIM; c++) {
                        const T d = x_d[c][i] - x_s[c][j];
                        d2 += d * d;
                    }
                    if (!SPH_UNIFORM && SPH_LOOP_REACH != SPH_GATHER) {
                        const T reach_j = K->support * h_s[j] * (K->support * h_s[j]);
                        reach2 = reach_j > reach2 ? reach_j : reach2;
                    }
                    sph_near[sph_found] = j;
                    sph_found += (d2 < reach2) & (int)(sph_self | (j != i));
                }
                for (int l = 0; l < SPH_WIDTH && sph_found > 0; l++)
                    sph_near[sph_found + l] = sph_near[0]; /* what idle lanes look at */
                for (int sph_q = 0; sph_q < sph_found; sph_q += SPH_WIDTH) {
                    const B in = sph_first < (SPH_INT)(sph_found - sph_q);
                    R dx[DIM], r2 = {0};
                    for (int c = 0; c < DIM; c++) {
                        dx[c] = x_d[c][i] - SPH_OF_ISA(sph_gather_)(x_s[c], sph_near + sph_q);
                        r2 += dx[c] * dx[c];
                    }
                    const R h_j =
                        SPH_UNIFORM ? h_i : SPH_OF_ISA(sph_gather_)(h_s, sph_near + sph_q);
                    const SPH_OF_ISA(sph_lanes_in) sph_within = in;
                    SPH_ROOTS(r2);
                    const R hinv_j = SPH_UNIFORM ? hinv_i : (T)1.0 / h_j;
                    (void)in;
                    (void)sph_within;
                    (void)rinv;
                    (void)r;
                    (void)hinv_j;
                    SPH_LOOP_J(SPH_J_S, SPH_J_V, SPH_J_M)
#include <sph/pair-bodies.h>
                }
            }
        }
        SPH_LOOP_SUM(SPH_O_S, SPH_O_V, SPH_O_M)
        SPH_LOOP_MIN(SPH_O_MIN)
        SPH_LOOP_MAX(SPH_O_MAX)
    }
    return SPH_OK;
}

#undef SPH_NEAR
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
#include <sph/pair-columns.h>
#undef SPH_HELD
