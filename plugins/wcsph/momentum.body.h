/* momentum.body.h -- one pair of the momentum equation: pressures in the symmetric form, artificial
 * viscosity between particles that approach. */
const R hinv = 0.5 * (hinv_i + hinv_j);
const R slope = m_j * (sph_ipow(hinv, DIM + 2) * sph_dw_q(K, r *hinv));
R closing = (v_i[0] - v_j[0]) * dx[0];
for (int c = 1; c < DIM; c++)
    closing += (v_i[c] - v_j[c]) * dx[c];
const R h = 0.5 * (h_i + h_j);
/* One division for all: 1 / (rho_i rho_j), mu = h closing / (r^2 + h^2 / 100), 1 / mean rho. */
const R soft = r2 + sph_num(0.01) * (h * h), twice = rho_i + rho_j, rho2 = rho_i * rho_j;
const R both = soft * twice, per = 1.0 / (rho2 * both), per_both = per * rho2;
const R mu = h * sph_min(closing, sph_num(0.0)) * (per_both * twice);
const R viscosity = mu * ((beta + beta) * mu - alpha * (cs_i + cs_j)) * (per_both * soft);
const R push = slope * ((p_i + p_j) * (per * both) + viscosity);
for (int c = 0; c < DIM; c++)
    sph_sub(a[c], push *dx[c]);
