/* sph/each-isa.h -- includes the header SPH_EACH_ISA once for each instruction set that a plugin is
 * compiled for, and with SPH_EACH_F32 defined twice: for doubles, then for floats. There SPH_ISA (a
 * suffix), SPH_WIDTH (lanes of a vector) and SPH_F32_WORDS (1: reals are floats) are defined, the
 * words of lanes.h are there for that set, and all functions are compiled for it. SPH_FORM_LIST is
 * defined where lists for single destinations are faster than groups (pair-list.h). With
 * SPH_NO_MULTIVERSION defined there is the plain set alone. */

/* The plain set: what every processor of the architecture has (on x86-64: SSE2, 16 bytes). Two doubles
 * in a vector: lists cost 13 ns a pair where groups cost 23; four floats: groups 8, lists 11. */
#if defined(__x86_64__)
#include <immintrin.h>
#define SPH_SSE2_WORDS
#endif
#define SPH_FORM_LIST
#define SPH_ISA base_f64
#define SPH_WIDTH 2
#define SPH_F32_WORDS 0
#ifndef SPH_LANES_base_f64
#define SPH_LANES_base_f64
#include <sph/lanes.h>
#endif
#include SPH_EACH_ISA
#undef SPH_ISA
#undef SPH_WIDTH
#undef SPH_F32_WORDS
#undef SPH_FORM_LIST
#ifdef SPH_EACH_F32
#define SPH_ISA base_f32
#define SPH_WIDTH 4
#define SPH_F32_WORDS 1
#ifndef SPH_LANES_base_f32
#define SPH_LANES_base_f32
#include <sph/lanes.h>
#endif
#include SPH_EACH_ISA
#undef SPH_ISA
#undef SPH_WIDTH
#undef SPH_F32_WORDS
#endif
#undef SPH_SSE2_WORDS

#if defined(__x86_64__) && !defined(SPH_NO_MULTIVERSION)

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma,bmi,bmi2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma,bmi,bmi2")
#endif
#define SPH_AVX2_WORDS
#define SPH_ISA avx2_f64
#define SPH_WIDTH 4
#define SPH_F32_WORDS 0
#ifndef SPH_LANES_avx2_f64
#define SPH_LANES_avx2_f64
#include <sph/lanes.h>
#endif
#include SPH_EACH_ISA
#undef SPH_ISA
#undef SPH_WIDTH
#undef SPH_F32_WORDS
#ifdef SPH_EACH_F32
#define SPH_ISA avx2_f32
#define SPH_WIDTH 8
#define SPH_F32_WORDS 1
#ifndef SPH_LANES_avx2_f32
#define SPH_LANES_avx2_f32
#include <sph/lanes.h>
#endif
#include SPH_EACH_ISA
#undef SPH_ISA
#undef SPH_WIDTH
#undef SPH_F32_WORDS
#endif
#undef SPH_AVX2_WORDS
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#if defined(__clang__)
#pragma clang attribute push(                                                                      \
    __attribute__((target("avx2,fma,bmi,bmi2,avx512f,avx512vl,avx512dq,avx512bw"))),               \
    apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma,bmi,bmi2,avx512f,avx512vl,avx512dq,avx512bw")
#endif
#define SPH_AVX512_WORDS
#define SPH_ISA avx512_f64
#define SPH_WIDTH 8
#define SPH_F32_WORDS 0
#ifndef SPH_LANES_avx512_f64
#define SPH_LANES_avx512_f64
#include <sph/lanes.h>
#endif
#include SPH_EACH_ISA
#undef SPH_ISA
#undef SPH_WIDTH
#undef SPH_F32_WORDS
#ifdef SPH_EACH_F32
#define SPH_ISA avx512_f32
#define SPH_WIDTH 8
#define SPH_F32_WORDS 1
#ifndef SPH_LANES_avx512_f32
#define SPH_LANES_avx512_f32
#include <sph/lanes.h>
#endif
#include SPH_EACH_ISA
#undef SPH_ISA
#undef SPH_WIDTH
#undef SPH_F32_WORDS
#endif
#undef SPH_AVX512_WORDS
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

/* Which of them this processor has. */
#define SPH_HAS_AVX2 (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
#define SPH_HAS_AVX512                                                                             \
    (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&                    \
     __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))

#endif
