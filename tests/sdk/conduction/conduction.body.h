/* conduction.body.h -- what one neighbour j adds to the rate of the temperature of i. */

/* F = (x_i - x_j) . grad W / r^2 = (dW/dr) / r, with the mean of the kernels of i and j. It is
 * negative: heat flows from the warmer to the colder particle. */
const R q_i = r * hinv_i;
const R q_j = r * hinv_j;
const R slope_i = sph_ipow(hinv_i, DIM + 1) * sph_dw(K, q_i);
const R slope_j = sph_ipow(hinv_j, DIM + 1) * sph_dw(K, q_j);
const R F = 0.5 * (slope_i + slope_j) * rinv;
const R k = 4.0 * k_i * k_j / (k_i + k_j);
sph_add(rate, m_j / (rho_i * rho_j) * k * (T_i - T_j) * F / c_i);
