/* check/lanes.c -- compiles the SDK's vector words for each instruction set and precision, as
 * pair-loop.h does (see lanes.h). Arithmetic, no more. */
#include "check/lanes.h"

#include <sph/kernel-value.h>
#include <stdint.h>

#define SPH_EACH_F32
#define SPH_EACH_ISA "check/lanes_set.h"
#include <sph/each-isa.h>

typedef void (*evaluate)(const sph_kernel_form *, const double *, int, const struct lanes_out *,
                         size_t);

static const struct {
    const char *name;
    evaluate run;
    bool floats;
} sets[] = {
    {"base", evaluate_base_f64, false},     {"base, floats", evaluate_base_f32, true},
#if defined(__x86_64__)
    {"avx2", evaluate_avx2_f64, false},     {"avx2, floats", evaluate_avx2_f32, true},
    {"avx512", evaluate_avx512_f64, false}, {"avx512, floats", evaluate_avx512_f32, true},
#endif
};

size_t lanes_count(void)
{
#if defined(__x86_64__)
    return SPH_HAS_AVX2 && SPH_HAS_AVX512 ? 6 : SPH_HAS_AVX2 ? 4 : 2;
#else
    return 2;
#endif
}

const char *lanes_name(size_t set)
{
    return sets[set].name;
}

bool lanes_of_floats(size_t set)
{
    return sets[set].floats;
}

void lanes_kernel(size_t set, const sph_kernel_form *form, const double *q, bool compiled_in,
                  const struct lanes_out *out, size_t n)
{
    sets[set].run(form, q, compiled_in ? sph_kernel_shape(form) : SPH_SHAPE_ANY, out, n);
}
