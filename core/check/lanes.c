/* check/lanes.c -- compiles the SDK's vector words for each instruction set, as pair-loop.h does
 * (see lanes.h). Arithmetic, no more. */
#include "check/lanes.h"

#include <sph/kernel-value.h>
#include <stdint.h>

#define SPH_ISA base
#define SPH_WIDTH 2
#include "check/lanes_set.h"
#undef SPH_ISA
#undef SPH_WIDTH

#if defined(__x86_64__)

#define SPH_ISA avx2
#define SPH_WIDTH 4
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma,bmi,bmi2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma,bmi,bmi2")
#endif
#include "check/lanes_set.h"
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
#include "check/lanes_set.h"
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#undef SPH_ISA
#undef SPH_WIDTH

#endif

typedef void (*evaluate)(const sph_kernel_form *, const double *, double *, double *, size_t);

static const struct {
    const char *name;
    evaluate run;
} sets[] = {
    {"base", evaluate_base},
#if defined(__x86_64__)
    {"avx2", evaluate_avx2},
    {"avx512", evaluate_avx512},
#endif
};

size_t lanes_count(void)
{
#if defined(__x86_64__)
    const int wide = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    const int wider = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");

    return wide && wider ? 3 : wide ? 2 : 1;
#else
    return 1;
#endif
}

const char *lanes_name(size_t set)
{
    return sets[set].name;
}

void lanes_kernel(size_t set, const sph_kernel_form *form, const double *q, double *w, double *dw,
                  size_t n)
{
    sets[set].run(form, q, w, dw, n);
}
