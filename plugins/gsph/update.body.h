/* update.body.h -- of one particle, from the sums to the next h. One that is done keeps its h, so that its sums
 * stay right. */
const R self = m * own * sph_ipow(1.0 / h, DIM), fitting = m * sph_ipow(eta / h, DIM);
rho += self;
slope -= (R)DIM * self / h;
/* Newton's step of h^d rho(h), which rises with h wherever the others stand; that of rho(h) - fitting turns its
 * sign where many of them are within a thin particle's support. */
R next = h + (fitting - rho) / ((R)DIM * rho / h + slope);
if (!(next > 0.7 * h))
    next = 0.7 * h;
if (next > 1.4 * h)
    next = 1.4 * h;
busy = fabs(next - h) > tolerance *h;
if (busy)
    h = next;
