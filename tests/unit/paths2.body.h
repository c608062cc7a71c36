/* paths2.body.h -- a second body of a pair, with the words and types that the first has not. */
const T other = (T)1.0 - share;
const R q = PATHS_Q(r * hinv_i, r *hinv_j);
const R w = m_j * sph_w(K, q) * sph_rsqrt(1.0 + r2);
const R mixed_ij = w * (sph_exp(-q) - sph_num(0.3) * sph_log(m_i + m_j)) -
                   share * w * sph_pow(m_j, q) + other * w * sph_pow_where(in, q, m_i);
sph_sub(mixed, mixed_ij);
sph_add(mixed_abs, sph_abs(mixed_ij));
for (int a = 0; a < DIM; a++)
    for (int c = 0; c < DIM; c++) {
        const R part = (g_i[a * DIM + c] - g_j[c * DIM + a]) * w;
        sph_add(shear[a * DIM + c], part);
        sph_sub(shear_abs[a * DIM + c], -sph_abs(part));
    }
