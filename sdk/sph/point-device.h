/* sph/point-device.h -- the body of one particle as data, for devices; the inside of point-loop.h, where
 * SPH_POINT_DEVICE is defined. */

#include <sph/device-text.h>

#define SPH_DEVICE_TEXT SPH_CAT(sph_text, SPH_POINT_DEVICE)
#define SPH_DEVICE_MACROS SPH_CAT(sph_macros, SPH_POINT_DEVICE)

SPH_BEGIN_DECLS
SPH_DEVICE_EMBED(SPH_DEVICE_TEXT, SPH_DEVICE_SYMBOL(SPH_DEVICE_TEXT),
                 SPH_DEVICE_INCBIN(SPH_POINT_BODY));
#ifdef SPH_POINT_PRELUDE
SPH_DEVICE_EMBED(SPH_DEVICE_MACROS, SPH_DEVICE_SYMBOL(SPH_DEVICE_MACROS),
                 SPH_DEVICE_INCBIN(SPH_POINT_PRELUDE));
#define SPH_DEVICE_PRELUDE SPH_DEVICE_MACROS, SPH_POINT_PRELUDE
#else
#define SPH_DEVICE_PRELUDE NULL, NULL
#endif
SPH_END_DECLS

/* The lists as values. Each ends with an element that is not counted, since C has no empty
 * array. */
#define SPH_DEVICE_scalar SPH_SCALAR
#define SPH_DEVICE_vector SPH_VECTOR
#define SPH_DEVICE_matrix SPH_MATRIX
#define SPH_DEVICE_sym SPH_SYM
#define SPH_DEVICE_int32 SPH_INT32
#define SPH_DEVICE_V(type, name, k) {#name, (uint32_t)(k), SPH_DEVICE_##type},
#define SPH_DEVICE_P(name, k) {#name, (uint32_t)(k), 0u},
#define SPH_DEVICE_END                                                                             \
    {                                                                                              \
        NULL, 0u, 0u                                                                               \
    }
#define SPH_DEVICE_ARRAY(list) static const sph_device_value SPH_CAT(SPH_POINT_DEVICE, list)[]
#define SPH_DEVICE_LIST(list)                                                                      \
    {                                                                                              \
        SPH_CAT(SPH_POINT_DEVICE, list),                                                           \
            (uint32_t)(sizeof(SPH_CAT(SPH_POINT_DEVICE, list)) / sizeof(sph_device_value)) - 1u,   \
            (uint32_t)sizeof(sph_device_value)                                                     \
    }

SPH_DEVICE_ARRAY(in) = {SPH_POINT_IN(SPH_DEVICE_V) SPH_DEVICE_END};
SPH_DEVICE_ARRAY(out) = {SPH_POINT_OUT(SPH_DEVICE_V) SPH_DEVICE_END};
SPH_DEVICE_ARRAY(inout) = {SPH_POINT_INOUT(SPH_DEVICE_V) SPH_DEVICE_END};
SPH_DEVICE_ARRAY(parameters) = {SPH_POINT_PARAM(SPH_DEVICE_P) SPH_DEVICE_END};
SPH_DEVICE_ARRAY(state) = {SPH_POINT_STATE(SPH_DEVICE_P) SPH_DEVICE_END};

static const sph_device_point SPH_POINT_DEVICE = {
    (uint32_t)sizeof(sph_device_point),
#ifdef SPH_POINT_H
    1u,
#else
    0u,
#endif
    SPH_DEVICE_TEXT,
    SPH_POINT_BODY,
    SPH_DEVICE_PRELUDE,
    SPH_DEVICE_LIST(in),
    SPH_DEVICE_LIST(out),
    SPH_DEVICE_LIST(inout),
    SPH_DEVICE_LIST(parameters),
    SPH_DEVICE_LIST(state),
#ifdef SPH_POINT_FAIL
    SPH_LIST(SPH_CAT(SPH_POINT_LOOP, sentence)),
#else
    {NULL, 0u, 0u},
#endif
};

#undef SPH_DEVICE_TEXT
#undef SPH_DEVICE_MACROS
#undef SPH_DEVICE_PRELUDE
#undef SPH_DEVICE_scalar
#undef SPH_DEVICE_vector
#undef SPH_DEVICE_matrix
#undef SPH_DEVICE_sym
#undef SPH_DEVICE_int32
#undef SPH_DEVICE_V
#undef SPH_DEVICE_P
#undef SPH_DEVICE_END
#undef SPH_DEVICE_ARRAY
#undef SPH_DEVICE_LIST
