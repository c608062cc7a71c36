/* exact.body.h -- the exact solution of the pair's Riemann problem, by Newton's method from the approximate one: a
 * fixed number of iterations, shocks and rarefactions chosen by select (Toro 2009, eq. 4.5-4.9, 4.37). */
if (riemann < 0.5) {
    const R least = 1e-12 * (p_l + p_r);
    const R A_l = 2.0 / ((gamma_l + 1.0) * rho_l), B_l = (gamma_l - 1.0) / (gamma_l + 1.0) * p_l;
    const R A_r = 2.0 / ((gamma_r + 1.0) * rho_r), B_r = (gamma_r - 1.0) / (gamma_r + 1.0) * p_r;
    const R z_l = 0.5 * (gamma_l - 1.0) / gamma_l, z_r = 0.5 * (gamma_r - 1.0) / gamma_r;
    R star = sph_max(p_star, least), f_l = sph_num(0.0), f_r = sph_num(0.0);
    for (int k = 0; k < 9; k++) {
        const R root_a = sph_sqrt(A_l / (star + B_l)), root_b = sph_sqrt(A_r / (star + B_r));
        const R w_l = sph_pow(star / p_l, z_l), w_r = sph_pow(star / p_r, z_r);
        f_l = sph_select(star > p_l, (star - p_l) * root_a, 2.0 * c_l / (gamma_l - 1.0) * (w_l - 1.0));
        f_r = sph_select(star > p_r, (star - p_r) * root_b, 2.0 * c_r / (gamma_r - 1.0) * (w_r - 1.0));
        const R d_l = sph_select(star > p_l, root_a * (1.0 - 0.5 * (star - p_l) / (star + B_l)),
                                 c_l / gamma_l * w_l / star);
        const R d_r = sph_select(star > p_r, root_b * (1.0 - 0.5 * (star - p_r) / (star + B_r)),
                                 c_r / gamma_r * w_r / star);
        /* The last round only evaluates f, for the velocity. */
        const R next = sph_max(star - (f_l + f_r + u_r - u_l) / (d_l + d_r), sph_max(0.05 * star, least));
        star = k < 8 ? next : star;
    }
    p_star = star;
    u_star = 0.5 * (u_l + u_r + f_r - f_l);
}
