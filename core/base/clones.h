/* base/clones.h -- for loops over columns: a function marked CLONES is compiled for AVX2 as well, and the
 * processor chooses when the program starts. No multiply-add is formed in either, so both give the same
 * bits. Sanitizers do not go along with such a choice. */
#ifndef BASE_CLONES_H
#define BASE_CLONES_H

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__ELF__) &&         \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CLONES __attribute__((target_clones("avx2", "default")))
#else
#define CLONES
#endif

/* clang says that it cannot where gcc can, and does so as a warning. */
#ifdef __clang__
#define CLONES_SIMD
#else
#define CLONES_SIMD _Pragma("omp simd")
#endif

#endif
