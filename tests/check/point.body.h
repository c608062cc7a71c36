/* point.body.h -- one particle of wrong_device.c alone, with every word and type that a body has. */
const R q = fmin(sph_abs(speed[0]), 1.9) + TWO * 0.01;
const B fast = speed[0] > 0.1;
R trace = 0.0, longest = sph_max(m, sph_min(share, 0.5));
for (int i = 0; i < DIM; i++) {
    trace += shape[i * DIM + i];
    for (int j = 0; j < DIM; j++)
        longest = sph_max(longest, sph_abs(shape[i * DIM + j]));
}
int k = 0;
for (int i = 0; i < DIM; i++)
    for (int j = i; j < DIM; j++) {
        stress[k] = 0.5 * (shape[i * DIM + j] + shape[j * DIM + i]) - (i == j ? trace / DIM : 0.0);
        k++;
    }
if (!(longest > 0.0))
    sph_fail(0);
for (int i = 0; i < DIM; i++)
    if (weight > 0.5)
        pull[i] += share * speed[i] * sph_ipow(q, DIM);
if (fast)
    calls = calls + 1;
energy = sph_sqrt(sph_exp(-q)) + sph_log(1.0 + m) + sph_pow(m, q) + sph_rsqrt(m) + cbrt(m) +
         sph_sign(speed[0]) + sph_select(fast, sph_num(1.0), sph_num(2.0)) + b->time + b->dt;
if (K->support > 0.0)
    energy += sph_w(K, q) + sph_dw(K, q) + sph_dw_q(K, q);
