/* call_per_pair.h -- the design that sweeps are measured against: a loop in the program that calls a
 * function of a plugin for every pair, and that one another for the kernel. Weakly compressible SPH,
 * double: continuity, momentum with p / rho^2 and artificial viscosity (Monaghan 1992,
 * doi:10.1146/annurev.aa.30.090192.002551, eq. 3.3 and 4.1), Wendland's C2 kernel. A pair takes one square root and two divisions. */
#ifndef CALL_PER_PAIR_H
#define CALL_PER_PAIR_H

#include <stddef.h>
#include <stdint.h>

/* Particles, a column each, and their neighbours. Those of i are neighbour[first[i]] up to before
 * neighbour[first[i + 1]]; i itself or some beyond the support may be among them and add nothing. */
struct pair_case {
    int dim; /* 2 or 3 */
    uint32_t n;
    const double *x[3], *v[3];
    const double *m, *rho, *p, *h;
    const size_t *first;
    const uint32_t *neighbour;
    double cs;          /* [m/s] speed of sound */
    double alpha, beta; /* of the artificial viscosity */
};

struct pair_rates {
    double *a[3]; /* [m/s^2] */
    double *drho; /* [kg/m^d/s] */
    double *work; /* p / rho^2, once a sweep */
};

/* What crosses the border for a pair. */
enum {
    PAIR_DX,
    PAIR_DV = 3,
    PAIR_R = 6,
    PAIR_H,
    PAIR_HINV, /* 1 / h */
    PAIR_M,
    PAIR_RHO_I,
    PAIR_RHO_J,
    PAIR_PUSH_I, /* p / rho^2 */
    PAIR_PUSH_J,
    PAIR_CS,
    PAIR_ALPHA,
    PAIR_BETA,
    PAIR_IN
};
enum { PAIR_A, PAIR_DRHO = 3, PAIR_OUT };

/* W'(r) / r, of 1 / h. */
typedef double (*pair_kernel_fn)(double r, double hinv);
/* Adds one pair's part to out; both arrays as above. */
typedef void (*pair_fn)(const double *in, double *out, pair_kernel_fn kernel);

/* Pairs within the support, 2 h with the mean of both h; each counts twice, as i <- j and j <- i. */
size_t pair_count(const struct pair_case *c);

/* One sweep; the result is the seconds that this thread has computed. */
double pair_sweep_called(const struct pair_case *c, const struct pair_rates *r, pair_fn pair,
                         pair_kernel_fn kernel);
double pair_sweep_inlined(const struct pair_case *c, const struct pair_rates *r);

/* The same particles in random order, neighbours renumbered: particle k was was[k]. All arrays in one
 * allocation, which pair_shuffle_free() frees. NULL without memory. */
struct pair_case *pair_shuffle(const struct pair_case *c, uint64_t seed, const uint32_t **was);
void pair_shuffle_free(struct pair_case *c);

#endif
