/* sph/pair-device.h -- the loop's body as data, for devices; the inside of pair-loop.h, where
 * SPH_LOOP_DEVICE is defined. */

#include <sph/device-text.h>

#define SPH_DEVICE_TEXT SPH_CAT(sph_text, SPH_LOOP_DEVICE)
#define SPH_DEVICE_MACROS SPH_CAT(sph_macros, SPH_LOOP_DEVICE)
/* Several bodies: each in a scope of its own. */
#define SPH_DEVICE_NEXT(file) ".ascii \"}\\n{\\n\"\n" SPH_DEVICE_INCBIN(file)
#if defined(SPH_LOOP_BODY_4)
#define SPH_DEVICE_BODIES                                                                          \
    SPH_DEVICE_INCBIN(SPH_LOOP_BODY)                                                               \
    SPH_DEVICE_NEXT(SPH_LOOP_BODY_2)                                                               \
    SPH_DEVICE_NEXT(SPH_LOOP_BODY_3) SPH_DEVICE_NEXT(SPH_LOOP_BODY_4)
#elif defined(SPH_LOOP_BODY_3)
#define SPH_DEVICE_BODIES                                                                          \
    SPH_DEVICE_INCBIN(SPH_LOOP_BODY)                                                               \
    SPH_DEVICE_NEXT(SPH_LOOP_BODY_2) SPH_DEVICE_NEXT(SPH_LOOP_BODY_3)
#elif defined(SPH_LOOP_BODY_2)
#define SPH_DEVICE_BODIES SPH_DEVICE_INCBIN(SPH_LOOP_BODY) SPH_DEVICE_NEXT(SPH_LOOP_BODY_2)
#else
#define SPH_DEVICE_BODIES SPH_DEVICE_INCBIN(SPH_LOOP_BODY)
#endif

SPH_BEGIN_DECLS
SPH_DEVICE_EMBED(SPH_DEVICE_TEXT, SPH_DEVICE_SYMBOL(SPH_DEVICE_TEXT), SPH_DEVICE_BODIES);
#ifdef SPH_LOOP_PRELUDE
SPH_DEVICE_EMBED(SPH_DEVICE_MACROS, SPH_DEVICE_SYMBOL(SPH_DEVICE_MACROS),
                 SPH_DEVICE_INCBIN(SPH_LOOP_PRELUDE));
#define SPH_DEVICE_PRELUDE SPH_DEVICE_MACROS, SPH_LOOP_PRELUDE
#else
#define SPH_DEVICE_PRELUDE NULL, NULL
#endif
SPH_END_DECLS

/* The lists as values. Each ends with an element that is not counted, since C has no empty
 * array. */
#define SPH_DEVICE_S(name, k) {#name, (uint32_t)(k), SPH_SCALAR},
#define SPH_DEVICE_V(name, k) {#name, (uint32_t)(k), SPH_VECTOR},
#define SPH_DEVICE_M(name, k) {#name, (uint32_t)(k), SPH_MATRIX},
#define SPH_DEVICE_P(name, k) {#name, (uint32_t)(k), 0u},
#define SPH_DEVICE_END                                                                             \
    {                                                                                              \
        NULL, 0u, 0u                                                                               \
    }
#define SPH_DEVICE_ARRAY(list) static const sph_device_value SPH_CAT(SPH_LOOP_DEVICE, list)[]
#define SPH_DEVICE_LIST(list)                                                                      \
    {                                                                                              \
        SPH_CAT(SPH_LOOP_DEVICE, list),                                                            \
            (uint32_t)(sizeof(SPH_CAT(SPH_LOOP_DEVICE, list)) / sizeof(sph_device_value)) - 1u,    \
            (uint32_t)sizeof(sph_device_value)                                                     \
    }

SPH_DEVICE_ARRAY(values_i) = {SPH_LOOP_I(SPH_DEVICE_S, SPH_DEVICE_V, SPH_DEVICE_M) SPH_DEVICE_END};
SPH_DEVICE_ARRAY(values_j) = {SPH_LOOP_J(SPH_DEVICE_S, SPH_DEVICE_V, SPH_DEVICE_M) SPH_DEVICE_END};
SPH_DEVICE_ARRAY(sums) = {SPH_LOOP_SUM(SPH_DEVICE_S, SPH_DEVICE_V, SPH_DEVICE_M) SPH_DEVICE_END};
SPH_DEVICE_ARRAY(minima) = {SPH_LOOP_MIN(SPH_DEVICE_S) SPH_DEVICE_END};
SPH_DEVICE_ARRAY(maxima) = {SPH_LOOP_MAX(SPH_DEVICE_S) SPH_DEVICE_END};
SPH_DEVICE_ARRAY(parameters) = {SPH_LOOP_PARAM(SPH_DEVICE_P) SPH_DEVICE_END};

static const sph_device_body SPH_LOOP_DEVICE = {
    (uint32_t)sizeof(sph_device_body),
    SPH_LOOP_REACH,
    SPH_LOOP_SELF,
    0u,
    SPH_DEVICE_TEXT,
    SPH_LOOP_BODY,
    SPH_DEVICE_PRELUDE,
    SPH_DEVICE_LIST(values_i),
    SPH_DEVICE_LIST(values_j),
    SPH_DEVICE_LIST(sums),
    SPH_DEVICE_LIST(minima),
    SPH_DEVICE_LIST(maxima),
    SPH_DEVICE_LIST(parameters),
};

#undef SPH_DEVICE_NEXT
#undef SPH_DEVICE_BODIES
#undef SPH_DEVICE_TEXT
#undef SPH_DEVICE_MACROS
#undef SPH_DEVICE_PRELUDE
#undef SPH_DEVICE_S
#undef SPH_DEVICE_V
#undef SPH_DEVICE_M
#undef SPH_DEVICE_P
#undef SPH_DEVICE_END
#undef SPH_DEVICE_ARRAY
#undef SPH_DEVICE_LIST
