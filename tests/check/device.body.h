/* device.body.h -- one pair of wrong_device.c, with every word that a body has, and with NaN in
 * pairs that are out of reach. */
const R q = r * hinv_i;
const B near = (B)(q < sph_num(1.0)), closing = (B)(v_i[0] < v_j[0]);
const R either = sph_select(near | closing, sph_num(1.0), sph_num(0.25));
const R both = sph_select((near & ~closing) | ~in, sph_num(1.0), sph_num(0.5));
const R edge = 1.0 + sph_sqrt(TWO - NEARER(q, r *hinv_j));
const R power = sph_pow_where(in & near, 1.5 + q, 0.3 * sph_num(b->dt) + 1.7);
sph_add(mass, share *m_j *either *both *sph_w(K, q) * sph_ipow(hinv_i, DIM));
sph_add(edges, sph_select(near, sph_num(0.0), edge) + power * sph_num(b->time));
for (int a = 0; a < DIM; a++) {
    sph_add(slope[a], m_j * sph_dw(K, q) * rinv * dx[a] * sph_sign(v_i[a] - v_j[a]));
    for (int c = 0; c < DIM; c++)
        sph_add(shear[a * DIM + c], (g_i[a * DIM + c] - g_j[c * DIM + a]) * sph_abs(dx[c]));
}
if (weight > 0.5)
    sph_take_min(nearest, NEARER(r, sph_num(K->support)) * sph_num(0.5) + r2);
sph_take_max(largest, sph_abs(m_i *h_j - m_j * h_i) / edge);
