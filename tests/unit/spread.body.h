/* spread.body.h -- see spread.h. */
const R weight = m_j * sph_w(K, r *SPREAD_MEAN(hinv_i, hinv_j));
sph_add(total, weight *(share_j + guess_i * guess_j));
for (int c = 0; c < DIM; c++)
    sph_sub(flow[c], weight *sph_sign(dx[c]) * sph_exp(-sph_abs(dx[c])));
sph_take_min(least, share_j + r);
sph_take_max(most, share_j - r + sph_num(0.25) * sph_log(1.0 + r2) * sph_pow(m_j, sph_num(0.5)));
