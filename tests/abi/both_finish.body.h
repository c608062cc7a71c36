/* both_finish.body.h -- what both.c makes of one particle's sums, with every word that a body has. */
const R q = fmin(sph_sqrt(nearest * nearest), K->support *h) * sph_rsqrt(h * h);
const B alone = count < 0.5 * share;
if (!(nearest >= 0.0))
    sph_fail(0);
if (!(largest < 1e200))
    sph_fail(1);
crowd += sph_select(alone, 0.0, 1.0) > 0.5;
largest += 0.0 *
           (sph_w(K, q) + sph_dw(K, q) + sph_dw_q(K, q) + sph_exp(-q) + sph_log(1.0 + q) +
            sph_pow(q, 2.0) + sph_sign(q) + sph_ipow(q, DIM)) *
           (b->time + b->dt + (double)b->step + sph_abs(sph_num(-1.0)));
int k = 0;
for (int i = 0; i < DIM; i++)
    for (int j = 0; j < DIM; j++) {
        outer[i * DIM + j] = slope[i] * slope[j];
        if (j >= i)
            part[k++] = sph_max(slope[i] * slope[j], sph_min(-1e300, q));
    }
