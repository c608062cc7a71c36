/* my-plugin.body.h -- one pair of the sweep in my-plugin.c. R is a real number in every lane:
 * several destinations i are worked on at once, each with the same source j. sph/lanes.h has the
 * words. Both sides get the same, with opposite sign and times their masses: what one loses the
 * other gains. */

/* dW/dr, the mean of the kernels of i and j */
const R slope = 0.5 * (sph_ipow(hinv_i, DIM + 1) * sph_dw(K, (r * hinv_i)) +
                       sph_ipow(hinv_j, DIM + 1) * sph_dw(K, (r * hinv_j)));
/* rinv is 1 / r. sph_add adds in those lanes only where j is within reach of i. */
sph_add(rate, 4.0 * diffusivity * m_j / (rho_i + rho_j) * (c_i - c_j) * slope * rinv);
