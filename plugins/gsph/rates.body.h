/* rates.body.h -- one pair of the rate sweep: states at the middle of the pair, the Riemann problem between them
 * along the line of centres, the fluxes. Left is j, right is i: e points from j to i. */
R e[DIM];
R u_l = sph_num(0.0), u_r = sph_num(0.0);
R drho_l = sph_num(0.0), drho_r = sph_num(0.0), dp_l = sph_num(0.0), dp_r = sph_num(0.0);
R du_l = sph_num(0.0), du_r = sph_num(0.0);
for (int a = 0; a < DIM; a++)
    e[a] = dx[a] * rinv;
for (int a = 0; a < DIM; a++) {
    u_l += v_j[a] * e[a];
    u_r += v_i[a] * e[a];
    drho_l += grho_j[a] * dx[a];
    drho_r += grho_i[a] * dx[a];
    dp_l += gp_j[a] * dx[a];
    dp_r += gp_i[a] * dx[a];
    for (int c = 0; c < DIM; c++) {
        du_l += gv_j[a * DIM + c] * dx[c] * e[a];
        du_r += gv_i[a * DIM + c] * dx[c] * e[a];
    }
}
const R closing = u_l - u_r; /* > 0: the two approach */
const R signal = cs_i + cs_j + beta * sph_max(closing, sph_num(0.0));

/* Limited increments over the pair, half of each from either side; none may be larger than the smaller of the
 * two values (of the velocity: than some speeds of sound), so that the states stay positive. */
R rho_l = rho_j, rho_r = rho_i, p_l = p_j, p_r = p_i;
if (limiter > 0.5) {
    const R rho_step = rho_i - rho_j, p_step = p_i - p_j, u_step = -closing;
    const R rho_cap = sph_min(rho_i, rho_j), p_cap = sph_min(p_i, p_j);
    const R u_cap = GSPH_MOST_SOUND * sph_min(cs_i, cs_j);
    rho_l += 0.5 * GSPH_LIMIT(rho_step, drho_l, rho_cap);
    rho_r -= 0.5 * GSPH_LIMIT(rho_step, drho_r, rho_cap);
    p_l += 0.5 * GSPH_LIMIT(p_step, dp_l, p_cap);
    p_r -= 0.5 * GSPH_LIMIT(p_step, dp_r, p_cap);
    u_l += 0.5 * GSPH_LIMIT(u_step, du_l, u_cap);
    u_r -= 0.5 * GSPH_LIMIT(u_step, du_r, u_cap);
}
const R gamma_l = rho_j * cs_j * cs_j / p_j, gamma_r = rho_i * cs_i * cs_i / p_i;
const R per_rho2 = 1.0 / (rho_l * rho_r);
const R c2_l = gamma_l * p_l * rho_r * per_rho2, c2_r = gamma_r * p_r * rho_l * per_rho2;

/* Wave impedances by the shock relation of an ideal gas, q the jump's share: s = q + sqrt(q^2 + c^2); the
 * star velocity is guessed from the Roe average and refined. */
const R root_l = sph_sqrt(rho_l), root_r = sph_sqrt(rho_r);
R u_star = (root_l * u_l + root_r * u_r) / (root_l + root_r);
R z_l = root_l, z_r = root_r, per_z = root_l;
for (int n = 0; n < 2; n++) {
    const R q_l = sph_max(0.25 * (gamma_l + 1.0) * (u_l - u_star), sph_num(0.0));
    const R q_r = sph_max(0.25 * (gamma_r + 1.0) * (u_star - u_r), sph_num(0.0));
    z_l = rho_l * (q_l + sph_sqrt(q_l * q_l + c2_l));
    z_r = rho_r * (q_r + sph_sqrt(q_r * q_r + c2_r));
    per_z = 1.0 / (z_l + z_r);
    u_star = (z_l * u_l + z_r * u_r + p_l - p_r) * per_z;
}
R p_star = sph_max((z_r * p_l + z_l * p_r + z_l * z_r * (u_l - u_r)) * per_z, sph_num(0.0));
#include "exact.body.h"

/* The force of the pair: geometric mean of the volumes, corrected. */
const R dw_i = sph_dw(K, r *hinv_i) * sph_ipow(hinv_i, DIM + 1);
const R dw_j = sph_dw(K, r *hinv_j) * sph_ipow(hinv_j, DIM + 1);
const R flux = -m_j * p_star * (volume_i * dw_i + volume_j * dw_j) / (rho_i * rho_j);
for (int a = 0; a < DIM; a++)
    sph_add(force[a], flux *e[a]);
sph_add(power, flux *u_star);
sph_take_max(fastest, signal);
