/* sph/point-range.h -- the loop over the destinations in one dimension; the inside of point-loop.h. */

#include <sph/pair-words.h>
#define SPH_SHAPE 0

/* Where the planes of a value begin. */
#define SPH_PLANES(type, name, k) SPH_PLANES_##type(name, k)
#define SPH_PLANES_scalar(name, k) double *const name##_sph = (double *)b->dst[k].data;
#define SPH_PLANES_int32(name, k) int32_t *const name##_sph = (int32_t *)b->dst[k].data;
#define SPH_PLANES_vector(name, k) SPH_PLANES_N(name, k, DIM)
#define SPH_PLANES_matrix(name, k) SPH_PLANES_N(name, k, DIM *DIM)
#define SPH_PLANES_sym(name, k) SPH_PLANES_N(name, k, DIM *(DIM + 1) / 2)
#define SPH_PLANES_N(name, k, n)                                                                   \
    double *name##_sph[n];                                                                         \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        name##_sph[sph_c] = (double *)b->dst[k].data + (size_t)sph_c * b->dst[k].plane;
/* It is read, */
#define SPH_GET(type, name, k) SPH_GET_##type(name)
#define SPH_GET_scalar(name) R name = name##_sph[sph_i];
#define SPH_GET_int32(name) int name = (int)name##_sph[sph_i];
#define SPH_GET_vector(name) SPH_GET_N(name, DIM)
#define SPH_GET_matrix(name) SPH_GET_N(name, DIM *DIM)
#define SPH_GET_sym(name) SPH_GET_N(name, DIM *(DIM + 1) / 2)
#define SPH_GET_N(name, n)                                                                         \
    R name[n];                                                                                     \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        name[sph_c] = name##_sph[sph_c][sph_i];
/* alone, */
#define SPH_GET_IN(type, name, k) SPH_GET_IN_##type(name)
#define SPH_GET_IN_scalar(name) const SPH_GET_scalar(name)
#define SPH_GET_IN_int32(name) const SPH_GET_int32(name)
#define SPH_GET_IN_vector(name) SPH_GET_vector(name)
#define SPH_GET_IN_matrix(name) SPH_GET_matrix(name)
#define SPH_GET_IN_sym(name) SPH_GET_sym(name)
/* or not, */
#define SPH_NEW(type, name, k) SPH_NEW_##type(name)
#define SPH_NEW_scalar(name) R name;
#define SPH_NEW_int32(name) int name;
#define SPH_NEW_vector(name) R name[DIM];
#define SPH_NEW_matrix(name) R name[DIM * DIM];
#define SPH_NEW_sym(name) R name[DIM * (DIM + 1) / 2];
/* and put back. */
#define SPH_SET(type, name, k) SPH_SET_##type(name)
#define SPH_SET_scalar(name) name##_sph[sph_i] = name;
#define SPH_SET_int32(name) name##_sph[sph_i] = (int32_t)name;
#define SPH_SET_vector(name) SPH_SET_N(name, DIM)
#define SPH_SET_matrix(name) SPH_SET_N(name, DIM *DIM)
#define SPH_SET_sym(name) SPH_SET_N(name, DIM *(DIM + 1) / 2)
#define SPH_SET_N(name, n)                                                                         \
    for (int sph_c = 0; sph_c < n; sph_c++)                                                        \
        name##_sph[sph_c][sph_i] = name[sph_c];
#define SPH_NUMBER_PARAM(name, k) const T name = b->param[k];
#define SPH_NUMBER_STATE(name, k) const T name = ((const double *)b->state)[k];

#ifdef SPH_POINT_FAIL
#define sph_fail(k)                                                                                \
    do {                                                                                           \
        return b->host->fail(b->host, SPH_E_NUMERIC, SPH_CAT(SPH_POINT_LOOP, sentence)[k]);        \
    } while (0)
#endif

static sph_status SPH_CAT(SPH_POINT_LOOP, DIM)(const sph_batch *b)
{
    /* All of it 0: W = 0 where a scene has no kernel. */
    static sph_kernel_form sph_none;
    FORM sph_local;
    SPH_OF_ISA(sph_form_)(&sph_local, b->kernel ? b->kernel : &sph_none);
    const FORM *const K = &sph_local;
    (void)K;
#ifdef SPH_POINT_H
    const double *const sph_h = (const double *)b->h_dst.data;
#endif
    SPH_POINT_PARAM(SPH_NUMBER_PARAM)
    SPH_POINT_STATE(SPH_NUMBER_STATE)
    SPH_POINT_IN(SPH_PLANES)
    SPH_POINT_INOUT(SPH_PLANES)
    SPH_POINT_OUT(SPH_PLANES)
    const uint64_t sph_end = b->first + b->count;

    /* Columns do not overlap. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC ivdep
#endif
    for (uint64_t sph_i = b->first; sph_i < sph_end; sph_i++) {
#ifdef SPH_POINT_H
        const R h = sph_h[sph_i];
#endif
        SPH_POINT_IN(SPH_GET_IN)
        SPH_POINT_INOUT(SPH_GET)
        SPH_POINT_OUT(SPH_NEW){
#include SPH_POINT_BODY
        } SPH_POINT_INOUT(SPH_SET) SPH_POINT_OUT(SPH_SET)
    }
    return SPH_OK;
}

#undef SPH_PLANES
#undef SPH_PLANES_scalar
#undef SPH_PLANES_int32
#undef SPH_PLANES_vector
#undef SPH_PLANES_matrix
#undef SPH_PLANES_sym
#undef SPH_PLANES_N
#undef SPH_GET
#undef SPH_GET_scalar
#undef SPH_GET_int32
#undef SPH_GET_vector
#undef SPH_GET_matrix
#undef SPH_GET_sym
#undef SPH_GET_N
#undef SPH_GET_IN
#undef SPH_GET_IN_scalar
#undef SPH_GET_IN_int32
#undef SPH_GET_IN_vector
#undef SPH_GET_IN_matrix
#undef SPH_GET_IN_sym
#undef SPH_NEW
#undef SPH_NEW_scalar
#undef SPH_NEW_int32
#undef SPH_NEW_vector
#undef SPH_NEW_matrix
#undef SPH_NEW_sym
#undef SPH_SET
#undef SPH_SET_scalar
#undef SPH_SET_int32
#undef SPH_SET_vector
#undef SPH_SET_matrix
#undef SPH_SET_sym
#undef SPH_SET_N
#undef SPH_NUMBER_PARAM
#undef SPH_NUMBER_STATE
#undef sph_fail
#undef SPH_SHAPE
#include <sph/pair-words.h>
