/* rates.body.h -- one pair of the rate sweep: states at the middle of the pair, the Riemann problem between them
 * along the line of centres, the fluxes. Left is j, right is i: e points from j to i. */
R u_l = sph_num(0.0), u_r = sph_num(0.0);
R drho_l = sph_num(0.0), drho_r = sph_num(0.0), dp_l = sph_num(0.0), dp_r = sph_num(0.0);
R du_l = sph_num(0.0), du_r = sph_num(0.0);
for (int a = 0; a < DIM; a++) {
    u_l += v_j[a] * dx[a];
    u_r += v_i[a] * dx[a];
    drho_l += grho_j[a] * dx[a];
    drho_r += grho_i[a] * dx[a];
    dp_l += gp_j[a] * dx[a];
    dp_r += gp_i[a] * dx[a];
    for (int c = 0; c < DIM; c++) {
        du_l += gv_j[a * DIM + c] * dx[c] * dx[a];
        du_r += gv_i[a * DIM + c] * dx[c] * dx[a];
    }
}
u_l *= rinv;
u_r *= rinv;
du_l *= rinv;
du_r *= rinv;
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
/* The exact solution of the pair's Riemann problem, by Newton's method from the approximate one: a
 * fixed number of iterations, shocks and rarefactions chosen by select (Toro 2009, eq. 4.5-4.9, 4.37). */
if (riemann < 0.5) {
    const R c_l = sph_sqrt(c2_l), c_r = sph_sqrt(c2_r);
    const R least = sph_num(1e-12) * (p_l + p_r) + sph_num(1e-300);
    const R A_l = 2.0 / ((gamma_l + 1.0) * rho_l), B_l = (gamma_l - 1.0) / (gamma_l + 1.0) * p_l;
    const R A_r = 2.0 / ((gamma_r + 1.0) * rho_r), B_r = (gamma_r - 1.0) / (gamma_r + 1.0) * p_r;
    const R n_l = 0.5 * (gamma_l - 1.0) / gamma_l, n_r = 0.5 * (gamma_r - 1.0) / gamma_r;
    const R z = 0.5 * (n_l + n_r);
    R star = sph_max(p_star, least), f_l = sph_num(0.0), f_r = sph_num(0.0);
    for (int n = 0; n <= GSPH_NEWTON; n++) {
        const R shock_l = sph_sqrt(A_l / (star + B_l)), shock_r = sph_sqrt(A_r / (star + B_r));
        const R w_l = sph_pow_where(in & (B)(star <= p_l), star / p_l, n_l);
        const R w_r = sph_pow_where(in & (B)(star <= p_r), star / p_r, n_r);
        f_l = sph_select(star > p_l, (star - p_l) * shock_l,
                         2.0 * c_l / (gamma_l - 1.0) * (w_l - 1.0));
        f_r = sph_select(star > p_r, (star - p_r) * shock_r,
                         2.0 * c_r / (gamma_r - 1.0) * (w_r - 1.0));
        if (n == GSPH_NEWTON)
            break; /* the last round only evaluates f, for the velocity */
        const R g_l = sph_select(star > p_l, shock_l * (1.0 - 0.5 * (star - p_l) / (star + B_l)),
                                 c_l / gamma_l * w_l / star);
        const R g_r = sph_select(star > p_r, shock_r * (1.0 - 0.5 * (star - p_r) / (star + B_r)),
                                 c_r / gamma_r * w_r / star);
        const R f = f_l + f_r + u_r - u_l, slope = g_l + g_r;
        /* Where both sides rarefy Newton's method runs in p^z: exact in one step for equal gammas. */
        const B both = in & (B)(star < sph_min(p_l, p_r));
        const R base = sph_max(1.0 - z * f / (star * slope), sph_num(0.0));
        const R next =
            sph_select(both, star * sph_pow_where(both, base, 1.0 / z), star - f / slope);
        star = sph_max(next, least);
    }
    p_star = star;
    u_star = 0.5 * (u_l + u_r + f_r - f_l);
}

/* The force of the pair, along dx: geometric mean of the volumes, corrected. */
const R slope = sph_grad(K, volume_i, r, hinv_i) + sph_grad(K, volume_j, r, hinv_j);
const R flux = m_j * p_star * slope / (rho_i * rho_j);
for (int a = 0; a < DIM; a++)
    sph_sub(force[a], flux *dx[a]);
sph_sub(power, flux *u_star *r);
sph_take_max(fastest, signal);
