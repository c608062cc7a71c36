/* neighbours/range.h -- the least and the largest of many numbers. */
#ifndef NEIGHBOURS_RANGE_H
#define NEIGHBOURS_RANGE_H

#include <stddef.h>

struct range {
    double least, most;
};

/* INFINITY and -INFINITY if there are none; what is no number is passed over. */
struct range range_of(const double *x, size_t n, int threads);

#endif
