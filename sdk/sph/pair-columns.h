/* sph/pair-columns.h -- how a loop gets at columns: the lists of pair-loop.h turned into pointers,
 * for all forms of the loop; the inside of pair-group.h, pair-list.h and pair-reference.h, which
 * includes it a second time to take the words away. T is what the columns hold. */
#ifndef SPH_COLUMNS_ON
#define SPH_COLUMNS_ON
#define SPH_P(column, c) ((SPH_HELD *)(column).data + (size_t)(c) * (column).plane)
/* Columns of sources, of destinations. */
#define SPH_S_S(name, k) const SPH_HELD *const name##_s = SPH_P(b->src[k], 0);
#define SPH_S_V(name, k) SPH_S_N(name, k, DIM)
#define SPH_S_M(name, k) SPH_S_N(name, k, DIM *DIM)
#define SPH_S_N(name, k, n)                                                                        \
    const SPH_HELD *name##_s[n];                                                                   \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        name##_s[sph_c] = SPH_P(b->src[k], sph_c);
/* Where in a span the k-th source is that half of a group has to meet (0 the lower, 1 the upper). */
#define SPH_AT_HALF(k, common, half) ((k) < (common) ? (k) : 2u * (k) - (common) + (half))
/* Accumulators at their start. */
#define SPH_A_S(name, k) R name = sph_num(0.0);
#define SPH_A_V(name, k) SPH_A_N(name, DIM)
#define SPH_A_M(name, k) SPH_A_N(name, DIM *DIM)
#define SPH_A_N(name, n)                                                                           \
    R name[n];                                                                                     \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        name[sph_c] = sph_num(0.0);
#define SPH_A_MIN(name, k) R name = sph_num(INFINITY);
#define SPH_A_MAX(name, k) R name = sph_num(-INFINITY);
#define SPH_PARAM_OF(name, k) const T name = (T)b->param[k];
/* Positions: doubles, or whole numbers of quanta beside floats. */
#if SPH_F32_WORDS
#define SPH_X(column, c) ((const int32_t *)(column).data + (size_t)(c) * (column).plane)
#define SPH_X_HELD int32_t
#else
#define SPH_X(column, c) ((const double *)(column).data + (size_t)(c) * (column).plane)
#define SPH_X_HELD double
#endif
#else
#undef SPH_COLUMNS_ON
#undef SPH_P
#undef SPH_S_S
#undef SPH_S_V
#undef SPH_S_M
#undef SPH_S_N
#undef SPH_AT_HALF
#undef SPH_A_S
#undef SPH_A_V
#undef SPH_A_M
#undef SPH_A_N
#undef SPH_A_MIN
#undef SPH_A_MAX
#undef SPH_PARAM_OF
#undef SPH_X
#undef SPH_X_HELD
#endif
