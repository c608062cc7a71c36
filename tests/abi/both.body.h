/* both.body.h -- one pair of both.c, with every word that a body has. */
const R q = r * hinv_i;
const R near = sph_select(q < sph_num(1.0), sph_num(1.0), sph_sign(q));
sph_add(count, share *near + 0.0 * sph_w(K, q) * sph_ipow(hinv_i, DIM));
for (int a = 0; a < DIM; a++)
    sph_add(slope[a], m_j *sph_dw(K, q) * rinv * dx[a]);
sph_take_min(nearest, sph_sqrt(r2) + sph_max(q - q, sph_num(0.0)) * sph_min(q, h_j *hinv_j));
sph_take_max(largest, sph_abs(m_i - m_j) * sph_pow_where(in, q + 1.0, q - q));
