/* density.body.h -- one pair of the density summation, the particle itself among them. R is a real
 * number in every lane: several destinations i are worked on at once, each with the same source j.
 * sph/lanes.h has the words; sph_add adds in those lanes only where j is within reach of i. */
sph_add(rho, (m_j * sph_ipow(hinv_i, DIM) * sph_w(K, (r * hinv_i))));
