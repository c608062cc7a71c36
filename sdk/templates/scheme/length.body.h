/* length.body.h -- for one particle: the smoothing length follows the density. */
h = eta * pow(m / rho, 1.0 / DIM);
