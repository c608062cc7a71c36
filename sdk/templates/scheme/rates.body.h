/* rates.body.h -- one pair of momentum and energy; my-plugin.c has the equations. No branches: what
 * holds only where particles approach is chosen by sph_select. */
R approach = sph_num(0.0); /* v_ij . x_ij */
for (int c = 0; c < DIM; c++)
    approach += (v_i[c] - v_j[c]) * dx[c];

const R h = 0.5 * (h_i + h_j);
const R mu =
    sph_select(approach < sph_num(0.0), (h * approach / (r2 + 0.01 * h * h)), sph_num(0.0));
const R viscous = (beta * mu - 0.5 * alpha * (cs_i + cs_j)) * mu / (0.5 * (rho_i + rho_j));
const R pressure = p_i / (rho_i * rho_i) + p_j / (rho_j * rho_j) + viscous;

/* dW/dr, the mean of the kernels of i and j; grad W = slope rinv dx */
const R slope = 0.5 * (sph_ipow(hinv_i, DIM + 1) * sph_dw(K, (r * hinv_i)) +
                       sph_ipow(hinv_j, DIM + 1) * sph_dw(K, (r * hinv_j)));
const R push = m_j * pressure * slope * rinv;
for (int c = 0; c < DIM; c++)
    sph_add(a[c], -1.0 * push * dx[c]);
sph_add(du, (0.5 * push * approach));
sph_take_max(fastest, sph_abs(mu));
