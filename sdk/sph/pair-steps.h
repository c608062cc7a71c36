/* sph/pair-steps.h -- the steps of a group through one part of a span; the inside of pair-group.h.
 * SPH_STEPS of them; source SPH_AT(k) of sph_steps stands in every lane. With SPH_TURNS there are
 * two: this one in the lower half of the lanes, the one after it in the upper. */

/* What column p holds of sources j; what array a holds for each of them. */
#ifdef SPH_TURNS
#define SPH_SOURCES 2
#define SPH_OF_COLUMN(p, j) SPH_OF_ISA(sph_halves_)((p) + (j)[0], (p) + (j)[1])
#define SPH_OF_WHOLE_COLUMN(p, j) SPH_OF_ISA(sph_whole_halves_)((p) + (j)[0], (p) + (j)[1])
#define SPH_OF_EACH(a) SPH_OF_ISA(sph_halves_)((a), (a) + 1)
#define SPH_WITHIN(r2, reach2, j) SPH_OF_ISA(sph_near_)(r2, reach2)
#else
#define SPH_SOURCES 1
#define SPH_OF_COLUMN(p, j) sph_num((p)[(j)[0]])
#define SPH_OF_WHOLE_COLUMN(p, j) SPH_OF_ISA(sph_whole_)((p)[(j)[0]])
#define SPH_OF_EACH(a) sph_num((a)[0])
#define SPH_WITHIN(r2, reach2, j)                                                                  \
    SPH_OF_ISA(sph_within_)(r2, reach2, number, SPH_OF_ISA(sph_whole_)((SPH_INT)(j)[0]))
#endif
#define SPH_J_S(name, k) const R name##_j = SPH_OF_COLUMN(name##_s, j);
#define SPH_J_V(name, k) SPH_J_N(name, DIM)
#define SPH_J_M(name, k) SPH_J_N(name, DIM *DIM)
#define SPH_J_N(name, n)                                                                           \
    R name##_j[n];                                                                                 \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        name##_j[sph_c] = SPH_OF_COLUMN(name##_s[sph_c], j);
/* Two indices in one vector, as gcc would have them, must be taken out of it again. */
#if defined(SPH_TURNS)
#define SPH_ONE_BY_ONE(j) __asm__("" : "+r"(j));
#else
#define SPH_ONE_BY_ONE(j)
#endif
/* Begins step k: its sources, how far away they are, and the roots of that. */
#if SPH_F32_WORDS
#define SPH_APART(c)                                                                               \
    __builtin_convertvector(x_i[c] - SPH_OF_WHOLE_COLUMN(x_s[c], sph_next), R) * quantum
#else
#define SPH_APART(c) x_i[c] - SPH_OF_COLUMN(x_s[c], sph_next)
#endif
#define SPH_BEGIN_STEP(k)                                                                          \
    for (uint32_t sph_c = 0; sph_c < SPH_SOURCES; sph_c++)                                         \
        sph_next[sph_c] = (size_t)sph_base + sph_steps[SPH_AT(k) + sph_c];                         \
    SPH_ONE_BY_ONE(sph_next[SPH_SOURCES - 1])                                                      \
    sph_r2 = sph_num(0.0);                                                                         \
    for (int sph_c = 0; sph_c < DIM; sph_c++) {                                                    \
        sph_dx[sph_c] = SPH_APART(sph_c);                                                          \
        sph_r2 += sph_dx[sph_c] * sph_dx[sph_c];                                                   \
    }                                                                                              \
    sph_r = sph_sqrt(sph_r2);                                                                      \
    sph_rinv = sph_rsqrt(sph_r2);

/* Of each pair what its body waits for longest, the root, is begun while the pair before it is worked
 * on: the processor's own reordering does not reach that far. */
size_t sph_next[SPH_SOURCES];
R sph_dx[DIM], sph_r2, sph_r, sph_rinv;
SPH_BEGIN_STEP(0u)
for (uint32_t sph_k = 0; sph_k < SPH_STEPS; sph_k++) {
    size_t j[SPH_SOURCES];
    const R r2 = sph_r2, r = sph_r, rinv = sph_rinv;
    R dx[DIM];
    for (int c = 0; c < SPH_SOURCES; c++)
        j[c] = sph_next[c];
    for (int c = 0; c < DIM; c++)
        dx[c] = sph_dx[c];
    const uint32_t sph_after = sph_k + 1 < SPH_STEPS ? sph_k + 1 : sph_k;
    SPH_BEGIN_STEP(sph_after)
    T sph_hinv[SPH_SOURCES];
    for (int c = 0; c < SPH_SOURCES; c++)
        sph_hinv[c] = (T)1.0 / (SPH_UNIFORM ? (T)1.0 : h_s[j[c]]);
    const R h_j = SPH_UNIFORM ? h_i : SPH_OF_COLUMN(h_s, j);
    const R sph_reach_j = K->support * h_j;
    const R hinv_j = SPH_UNIFORM ? hinv_i : SPH_OF_EACH(sph_hinv);
    const R reach2 = SPH_UNIFORM || SPH_LOOP_REACH == SPH_GATHER
                         ? reach2_i
                         : sph_max(reach2_i, sph_reach_j * sph_reach_j);
    const SPH_OF_ISA(sph_lanes_in) sph_within = SPH_WITHIN(r2, reach2, j);
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

#undef SPH_SOURCES
#undef SPH_OF_COLUMN
#undef SPH_OF_WHOLE_COLUMN
#undef SPH_OF_EACH
#undef SPH_WITHIN
#undef SPH_J_S
#undef SPH_J_V
#undef SPH_J_M
#undef SPH_J_N
#undef SPH_APART
#undef SPH_ONE_BY_ONE
#undef SPH_BEGIN_STEP
