/* sph/pair-reference.h -- the plain loop: one pair at a time, in double or long double, no vectors,
 * with libm's functions. What every other form of the loop is compared with; the inside of
 * pair-loop.h. */

#include <sph/pair-words.h>
#define SPH_SHAPE 0
#define SPH_HELD double
#include <sph/pair-columns.h>

#define SPH_I_S(name, k) const R name##_i = SPH_P(b->dst[k], 0)[i];
#define SPH_I_V(name, k) SPH_I_N(name, k, DIM)
#define SPH_I_M(name, k) SPH_I_N(name, k, DIM *DIM)
#define SPH_I_N(name, k, n)                                                                        \
    R name##_i[n];                                                                                 \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        name##_i[sph_c] = SPH_P(b->dst[k], sph_c)[i];
#define SPH_J_S(name, k) const R name##_j = name##_s[j];
#define SPH_J_V(name, k) SPH_J_N(name, DIM)
#define SPH_J_M(name, k) SPH_J_N(name, DIM *DIM)
#define SPH_J_N(name, n)                                                                           \
    R name##_j[n];                                                                                 \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        name##_j[sph_c] = name##_s[sph_c][j];
#define SPH_O_S(name, k) SPH_P(b->dst[k], 0)[i] = (double)(SPH_P(b->dst[k], 0)[i] + name);
#define SPH_O_V(name, k) SPH_O_N(name, k, DIM)
#define SPH_O_M(name, k) SPH_O_N(name, k, DIM *DIM)
#define SPH_O_N(name, k, n)                                                                        \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        SPH_P(b->dst[k], sph_c)[i] = (double)(SPH_P(b->dst[k], sph_c)[i] + name[sph_c]);
#define SPH_O_MIN(name, k) SPH_P(b->dst[k], 0)[i] = (double)sph_min(name, SPH_P(b->dst[k], 0)[i]);
#define SPH_O_MAX(name, k) SPH_P(b->dst[k], 0)[i] = (double)sph_max(name, SPH_P(b->dst[k], 0)[i]);

static sph_status SPH_CAT(SPH_CAT(SPH_LOOP, SPH_ISA), DIM)(const sph_batch *b)
{
    FORM sph_local;
    SPH_OF_ISA(sph_form_)(&sph_local, b->kernel);
    const FORM *const K = &sph_local;
    const double *x_s[DIM], *x_d[DIM];
    for (int c = 0; c < DIM; c++) {
        x_s[c] = SPH_X(b->x_src, c);
        x_d[c] = SPH_X(b->x_dst, c);
    }
    const double *const h_s = SPH_P(b->h_src, 0);
    SPH_LOOP_J(SPH_S_S, SPH_S_V, SPH_S_M)
    SPH_LOOP_PARAM(SPH_PARAM_OF)

    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        const uint64_t sph_g = i / SPH_LANES;
        const R h_i = SPH_P(b->h_dst, 0)[i], hinv_i = (R)1.0 / h_i;
        (void)hinv_i;
        SPH_LOOP_I(SPH_I_S, SPH_I_V, SPH_I_M)
        SPH_LOOP_SUM(SPH_A_S, SPH_A_V, SPH_A_M)
        SPH_LOOP_MIN(SPH_A_MIN)
        SPH_LOOP_MAX(SPH_A_MAX)
        for (uint64_t sph_s = b->begin[sph_g]; sph_s < b->begin[sph_g + 1]; sph_s++)
            for (uint32_t sph_k = 0; sph_k < b->span[sph_s].count; sph_k++) {
                const size_t j =
                    (size_t)b->span[sph_s].base + b->list[b->span[sph_s].first + sph_k];
                R dx[DIM], r2 = (R)0.0;
                for (int c = 0; c < DIM; c++) {
                    dx[c] = (R)x_d[c][i] - (R)x_s[c][j];
                    r2 += dx[c] * dx[c];
                }
                const R h_j = h_s[j], hinv_j = (R)1.0 / h_j;
                const R reach =
                    K->support * (SPH_LOOP_REACH == SPH_GATHER ? h_i : sph_max(h_i, h_j));
                if (!(r2 < reach * reach) || (!SPH_LOOP_SELF && b->same && i == j))
                    continue;
                const B in = 1, sph_within = 1;
                SPH_ROOTS(r2);
                (void)in;
                (void)sph_within;
                (void)rinv;
                (void)r;
                (void)hinv_j;
                SPH_LOOP_J(SPH_J_S, SPH_J_V, SPH_J_M)
#include <sph/pair-bodies.h>
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
#include <sph/pair-columns.h>
#undef SPH_HELD
#undef SPH_SHAPE
#include <sph/pair-words.h>
