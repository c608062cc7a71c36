/* frames.body.h -- one pair of a sum: m_j W, wherever dx is taken. */
sph_add(sum, m_j *sph_ipow(hinv_i, DIM) * sph_w(K, r *hinv_i));
