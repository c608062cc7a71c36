/* density.body.h -- one pair of the density sweep: the sum and its derivative with h_i. */
const R q = r * hinv_i;
const R scale = m_j * sph_ipow(hinv_i, DIM);
const R w = sph_w(K, q);
sph_add(rho, scale * w);
/* d/dh of h^-d w(r/h) = -h^-(d+1) (d w + q w') */
sph_add(omega, -scale * hinv_i * ((double)DIM * w + q * sph_dw(K, q)));
