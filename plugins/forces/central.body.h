/* central.body.h -- a -= mu d / s^(n+1), s^2 = d^2 + eps^2, with the potential phi' = mu r s^-(n+1). */
const R centre[3] = {cx, cy, cz};
R d[DIM], s2 = eps * eps;
for (int c = 0; c < DIM; c++) {
    d[c] = x[c] - centre[c];
    s2 += d[c] * d[c];
}
const R strength = mu * sph_pow(s2, -0.5 * (n + 1.0)); /* the frequency's square */
for (int c = 0; c < DIM; c++)
    a[c] -= strength * d[c];
if (n > 1.0 || n < 1.0)
    phi = mu / (1.0 - n) * sph_pow(s2, 0.5 * (1.0 - n));
else
    phi = 0.5 * mu * sph_log(s2);
dt = 1.0 / sqrt(fabs(strength));
