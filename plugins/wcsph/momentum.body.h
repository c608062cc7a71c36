/* momentum.body.h -- one pair of the momentum equation: pressures in the symmetric form, artificial
 * viscosity between particles that approach. */
const R slope = sph_grad(K, m_j, r, 0.5 * (hinv_i + hinv_j));
R closing = (v_i[0] - v_j[0]) * dx[0];
for (int c = 1; c < DIM; c++)
    closing += (v_i[c] - v_j[c]) * dx[c];
const R h = 0.5 * (h_i + h_j);
/* hard: mu over h (rho_i + rho_j), with one division for both mu's and that of the mean density. */
const R soft = r2 + sph_num(0.01) * (h * h), twice = rho_i + rho_j;
const R hard = sph_min(closing, sph_num(0.0)) * (1.0 / (soft * twice));
const R quadratic = (beta + beta) * (h * h), linear = alpha * h;
const R viscosity = hard * (quadratic * (hard * twice) - linear * (cs_i + cs_j));
const R push = slope * (p_rho2_i + p_rho2_j + viscosity);
for (int c = 0; c < DIM; c++)
    sph_sub(a[c], push *dx[c]);
