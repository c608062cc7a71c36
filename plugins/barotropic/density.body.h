/* density.body.h -- one pair of the density: m_j W, at the mean of both 1/h. */
const R hinv = 0.5 * (hinv_i + hinv_j);
sph_add(rho, m_j *sph_ipow(hinv, DIM) * sph_w(K, r *hinv));
