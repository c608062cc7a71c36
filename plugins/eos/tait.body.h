/* tait.body.h -- p = B ((rho / rho0)^gamma - 1) + p0, c = c0 (rho / rho0)^((gamma - 1) / 2). Whole exponents, water's
 * 7 first, without a call. */
const R ratio = rho * (1.0 / rho0), modulus = c0 * c0 * rho0 / gamma;
R whole = ratio, root = 1.0; /* gamma = 1 */
if (gamma == 7.0) {
    const R square = ratio * ratio;
    whole = square * square * square * ratio;
    root = ratio * ratio * ratio;
} else if (gamma == 3.0) {
    whole = ratio * ratio * ratio;
    root = ratio;
} else if (gamma != 1.0) {
    whole = sph_pow(ratio, gamma);
    root = sph_pow(ratio, 0.5 * (gamma - 1.0));
}
p = modulus * (whole - 1.0) + p0;
cs = c0 * root;
