/* sph/each-isa.h -- includes the header SPH_EACH_ISA once for each instruction set that a plugin is
 * compiled for, as the inside of pair-loop.h. There SPH_ISA (a suffix) and SPH_WIDTH (lanes of a
 * vector) are defined, the words of lanes.h are there for that set, and all functions are compiled
 * for it. With SPH_NO_MULTIVERSION defined there is the plain set alone. */

/* The plain set: what every processor of the architecture has (on x86-64: SSE2, two lanes). */
#define SPH_ISA base
#define SPH_WIDTH 2
#ifndef SPH_LANES_base
#define SPH_LANES_base
#include <sph/lanes.h>
#endif
#include SPH_EACH_ISA
#undef SPH_ISA
#undef SPH_WIDTH

#if defined(__x86_64__) && !defined(SPH_NO_MULTIVERSION)

#define SPH_ISA avx2
#define SPH_WIDTH 4
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma,bmi,bmi2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma,bmi,bmi2")
#endif
#ifndef SPH_LANES_avx2
#define SPH_LANES_avx2
#include <sph/lanes.h>
#endif
#include SPH_EACH_ISA
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#undef SPH_ISA
#undef SPH_WIDTH

#define SPH_ISA avx512
#define SPH_WIDTH 8
#if defined(__clang__)
#pragma clang attribute push(                                                                      \
    __attribute__((target("avx2,fma,bmi,bmi2,avx512f,avx512vl,avx512dq,avx512bw"))),               \
    apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma,bmi,bmi2,avx512f,avx512vl,avx512dq,avx512bw")
#endif
#ifndef SPH_LANES_avx512
#define SPH_LANES_avx512
#include <sph/lanes.h>
#endif
#include SPH_EACH_ISA
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#undef SPH_ISA
#undef SPH_WIDTH

/* Which of them this processor has. */
#define SPH_HAS_AVX2 (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
#define SPH_HAS_AVX512                                                                             \
    (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&                    \
     __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))

#endif
