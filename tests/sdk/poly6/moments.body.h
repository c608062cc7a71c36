/* moments.body.h -- one pair of the moments' sweep. */
const R q = r * hinv_i;
const R volume = m_j * sph_ipow(hinv_i, DIM);
sph_add(s0, volume *sph_w(K, q));
sph_add(s2, volume *q *q *sph_w(K, q));
sph_add(slope, -volume *q *sph_dw(K, q) * (1.0 / DIM));
