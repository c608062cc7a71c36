/* opencl/body_cost.h -- how much arithmetic a body is, counted in its text: for what share of a device's rate a sweep
 * reaches. Text alone. */
#ifndef OPENCL_BODY_COST_H
#define OPENCL_BODY_COST_H

/* Additions, multiplications, divisions and roots are 1 each, a kernel's value 8, an exponential or logarithm 15, a
 * power 30. Loops up to DIM or a number count so often. What stands in macros of a prelude does not count. */
double body_flops(const char *text, int dim);

#endif
