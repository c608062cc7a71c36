/* moments.body.h -- the kernel's sum, and that of its second moments. */
const R w = m_j / rho_j * sph_ipow(hinv_i, DIM) * sph_w(K, (r * hinv_i));
sph_add(one, w);
for (int c = 0; c < DIM; c++)
    for (int d = 0; d < DIM; d++)
        sph_add(moment[c * DIM + d], w *dx[c] * dx[d]);
