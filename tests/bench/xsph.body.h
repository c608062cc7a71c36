/* xsph.body.h -- one pair of the mean velocity of a particle's neighbours, beside its own. */
const R share = m_j / rho_j * sph_w(K, r *hinv_i) * sph_ipow(hinv_i, DIM);
for (int c = 0; c < DIM; c++)
    sph_add(drift[c], share *(v_j[c] - v_i[c]));
