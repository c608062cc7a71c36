/* border.body.h -- one pair of a weakly compressible sweep: continuity, and momentum with a
 * viscosity. */
const R slope = sph_ipow(hinv_i, DIM + 1) * sph_dw(K, r *hinv_i) * rinv;
R closing = sph_num(0.0);
for (int a = 0; a < DIM; a++)
    closing += (v_i[a] - v_j[a]) * dx[a];
sph_add(drho, m_j *slope *closing);
const R mu = sph_min(closing, sph_num(0.0)) * h_i / (r2 + sph_num(0.01) * h_i * h_i);
const R push = p_i / (rho_i * rho_i) + p_j / (rho_j * rho_j) - alpha * mu / (0.5 * (rho_i + rho_j));
for (int a = 0; a < DIM; a++)
    sph_add(acc[a], -m_j *push *slope *dx[a]);
