/* opencl/body_cost.h -- how much arithmetic a body is, counted in its text: for what share of a device's rate a sweep
 * reaches. Text alone. */
#ifndef OPENCL_BODY_COST_H
#define OPENCL_BODY_COST_H

#include <stddef.h>

/* A parameter that is known. */
struct body_known {
    const char *name;
    double value;
};
struct body_text {
    const char *text;
    const char *prelude; /* macros, or NULL */
    int dim;
    const struct body_known *known; /* [n_known] */
    size_t n_known;
};

/* Additions, multiplications, divisions and roots are 1 each, a kernel's value 8, an exponential or logarithm 15, a
 * power 30. Loops up to DIM or a number count so often, macros wherever they are called (their arguments once).
 * `if (NAME < NUMBER)` of a known parameter counts when it is so; of all other branches each counts. */
double body_flops(const struct body_text *b);

#endif
