/* call_per_pair_body.h -- the interaction of a pair, for the plugin and for the loop that has it within:
 * see call_per_pair.h. */
#ifndef CALL_PER_PAIR_BODY_H
#define CALL_PER_PAIR_BODY_H

#include "call_per_pair.h"

/* Wendland's C2 kernel with support 2 h: W = norm (1 - q/2)^4 (1 + 2 q), W' / r = -5 norm (1 - q/2)^3 / h^2,
 * norm = 7 / (4 pi h^2) or 21 / (16 pi h^3). */
static inline double pair_wendland(double r, double hinv, int dim)
{
    const double norm = dim == 2 ? 0.557042300821634 : 0.417781725616225;
    const double t = 1.0 - 0.5 * r * hinv, h2 = hinv * hinv;

    if (t <= 0.0)
        return 0.0;
    return -5.0 * norm * (dim == 2 ? h2 : h2 * hinv) * h2 * t * t * t;
}

/* Adds a pair's part; dw is W' / r. */
static inline void pair_body(const double *in, double *out, double dw, int dim)
{
    const double rho_i = in[PAIR_RHO_I], rho_j = in[PAIR_RHO_J], h = in[PAIR_H];
    double vr = 0.0;

    for (int c = 0; c < dim; c++)
        vr += in[PAIR_DV + c] * in[PAIR_DX + c];
    /* No branch: whether a pair approaches is anyone's guess, the processor's too. With q = mu / rho:
     * one division. */
    const double rho = 0.5 * (rho_i + rho_j);
    const double d = in[PAIR_R] * in[PAIR_R] + 0.01 * h * h;
    const double q = h * (vr < 0.0 ? vr : 0.0) / (d * rho);
    const double viscosity = (in[PAIR_BETA] * q * rho - in[PAIR_ALPHA] * in[PAIR_CS]) * q;
    const double push = in[PAIR_PUSH_I] + in[PAIR_PUSH_J] + viscosity;
    const double s = -in[PAIR_M] * push * dw;
    for (int c = 0; c < dim; c++)
        out[PAIR_A + c] += s * in[PAIR_DX + c];
    out[PAIR_DRHO] += in[PAIR_M] * vr * dw;
}

#endif
