/* paths.body.h -- one pair of the sweeps of paths.c: sums, each beside that of its terms' absolute
 * values, and extremes; beyond the support it gives NaN. */
const R q = PATHS_Q(r * hinv_i, r *hinv_j);
const R edge = sph_sqrt(4.0 - q * q);
const R w = share * m_j * h_j * sph_w(K, q) * edge;
sph_add(sum, w);
sph_add(sum_abs, sph_abs(w));
const R slope = m_j * sph_ipow(hinv_i, DIM) * sph_dw_q(K, q) + sph_grad(K, m_j, r, hinv_i);
for (int a = 0; a < DIM; a++) {
    const R push = slope * dx[a] + sph_dw(K, q) * (v_i[a] - v_j[a]) * (dx[a] * rinv);
    sph_sub(flow[a], push);
    sph_add(flow_abs[a], sph_abs(push));
}
const B closing = (B)(v_i[0] > v_j[0]);
sph_take_min(least, sph_select(closing &in, m_j, m_j + h_j) + sph_min(q, sph_num(b->dt)));
sph_take_max(most, sph_sign(v_i[0] - v_j[0]) * sph_max(m_i, m_j) + edge);
