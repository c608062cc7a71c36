/* exact.body.h -- the exact solution of the pair's Riemann problem, by Newton's method from the approximate one: a
 * fixed number of iterations, shocks and rarefactions chosen by select (Toro 2009, eq. 4.5-4.9, 4.37). */
if (riemann < 0.5) {
    const R c_l = sph_sqrt(c2_l), c_r = sph_sqrt(c2_r);
    const R least = 1e-12 * (p_l + p_r) + 1e-300;
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
