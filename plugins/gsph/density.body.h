/* density.body.h -- one pair of the density sweep: the sum over the others, and its derivative with h_i. */
const R q = r * hinv_i;
const R scale = m_j * sph_ipow(hinv_i, DIM);
sph_add(rho, scale *sph_w(K, q));
/* d/dh of h^-d w(r/h) = -h^-(d+1) (d w + q w') */
sph_add(slope, -scale *hinv_i *((double)DIM *sph_w(K, q) + q * sph_dw(K, q)));
