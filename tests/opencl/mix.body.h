/* mix.body.h -- one pair of a diffusion: differences of q, weighted. */
sph_add(dq, m_j *sph_ipow(hinv_i, DIM) * sph_w(K, r *hinv_i) * (q_j - q_i));
