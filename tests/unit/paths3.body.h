/* paths3.body.h -- the shortest body. */
sph_add(sum, m_j);
