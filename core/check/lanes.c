/* check/lanes.c -- compiles the SDK's vector words for each instruction set, as pair-loop.h does
 * (see lanes.h). Arithmetic, no more. */
#include "check/lanes.h"

#include <sph/kernel-value.h>
#include <stdint.h>

#define SPH_EACH_ISA "check/lanes_set.h"
#include <sph/each-isa.h>

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
    return SPH_HAS_AVX2 && SPH_HAS_AVX512 ? 3 : SPH_HAS_AVX2 ? 2 : 1;
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
