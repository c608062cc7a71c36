/* state.body.h -- one pair of a wall particle i and a gas particle j. The kernel is the wider one's, so that
 * whoever sees the wall is seen by it. */
const R hinv = sph_min(hinv_i, hinv_j);
const R w = sph_ipow(hinv, DIM) * sph_w(K, r *hinv);
sph_add(weight, w);
sph_add(sum_rho, w *rho_j);
sph_add(sum_p, w *p_j);
sph_add(sum_cs, w *cs_j);
for (int a = 0; a < DIM; a++)
    sph_add(lever[a], w *rho_j *dx[a]);
sph_take_min(h_near, h_j);
