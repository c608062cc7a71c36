/* call_per_pair_plugin.c -- the plugin that is called for every pair: see call_per_pair.h. */
#include "call_per_pair_body.h"

#define EXPORT __attribute__((visibility("default")))

EXPORT void pair_2(const double *in, double *out, pair_kernel_fn kernel);
EXPORT void pair_3(const double *in, double *out, pair_kernel_fn kernel);
EXPORT double kernel_2(double r, double hinv);
EXPORT double kernel_3(double r, double hinv);

void pair_2(const double *in, double *out, pair_kernel_fn kernel)
{
    pair_body(in, out, kernel(in[PAIR_R], in[PAIR_HINV]), 2);
}

void pair_3(const double *in, double *out, pair_kernel_fn kernel)
{
    pair_body(in, out, kernel(in[PAIR_R], in[PAIR_HINV]), 3);
}

double kernel_2(double r, double hinv)
{
    return pair_wendland(r, hinv, 2);
}

double kernel_3(double r, double hinv)
{
    return pair_wendland(r, hinv, 3);
}
