/* lanes_sets.c -- lane functions for each instruction set (see lanes_sets.h). */
#include "lanes_sets.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#define SPH_ISA base_f64
#define SPH_SET_NAME "base, 2 doubles"
#define SPH_WIDTH 2
#define SPH_F32_WORDS 0
#include "lanes_set.h"

#define SPH_ISA base_f32
#define SPH_SET_NAME "base, 4 floats"
#define SPH_WIDTH 4
#define SPH_F32_WORDS 1
#include "lanes_set.h"

#if defined(__x86_64__)

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma,bmi,bmi2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma,bmi,bmi2")
#endif

#define SPH_ISA avx2_f64
#define SPH_SET_NAME "avx2, 4 doubles"
#define SPH_WIDTH 4
#define SPH_F32_WORDS 0
#include "lanes_set.h"

#define SPH_ISA avx2_f32
#define SPH_SET_NAME "avx2, 8 floats"
#define SPH_WIDTH 8
#define SPH_F32_WORDS 1
#include "lanes_set.h"

#if defined(__clang__)
#pragma clang attribute pop
#pragma clang attribute push(                                                                      \
    __attribute__((target("avx2,fma,bmi,bmi2,avx512f,avx512vl,avx512dq,avx512bw"))),               \
    apply_to = function)
#else
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx2,fma,bmi,bmi2,avx512f,avx512vl,avx512dq,avx512bw")
#endif

#define SPH_ISA avx512_f64
#define SPH_SET_NAME "avx512, 8 doubles"
#define SPH_WIDTH 8
#define SPH_F32_WORDS 0
#include "lanes_set.h"

#define SPH_ISA avx512_f32
#define SPH_SET_NAME "avx512, 8 floats"
#define SPH_WIDTH 8
#define SPH_F32_WORDS 1
#include "lanes_set.h"

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#endif

const struct lanes_set *lanes_set(size_t k)
{
    const struct lanes_set *set[6] = {&lanes_set_base_f64, &lanes_set_base_f32};
    size_t n = 2;

#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        set[n++] = &lanes_set_avx2_f64;
        set[n++] = &lanes_set_avx2_f32;
    }
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")) {
        set[n++] = &lanes_set_avx512_f64;
        set[n++] = &lanes_set_avx512_f32;
    }
#endif
    return k < n ? set[k] : NULL;
}
