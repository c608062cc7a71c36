/* gradients.body.h -- one pair of the gradient sweep: moments and differences, weighted with -w'(q) / r. */
const R slope = -m_j * (sph_dw_q(K, r *hinv_i) * hinv_i);
const R weight = slope / rho_j;
sph_add(spread, slope *r2);
const R drho = rho_i - rho_j, dp = p_i - p_j;
for (int a = 0; a < DIM; a++) {
    const R wd = weight * dx[a];
    sph_add(grho[a], wd * drho);
    sph_add(gp[a], wd * dp);
    for (int c = 0; c < DIM; c++) {
        sph_add(moment[a * DIM + c], wd * dx[c]);
        sph_add(gv[c * DIM + a], wd * (v_i[c] - v_j[c]));
    }
}
