/* linear.body.h -- p = c0^2 (rho - rho0) + p0. With e = rho / rho0 - 1:
 * u = c0^2 (ln(1 + e) - e / (1 + e)) + p0 / rho0 e / (1 + e). */
const R excess = (rho - rho0) / rho0, part = excess / (1.0 + excess);
p = c0 * c0 * (rho - rho0) + p0;
cs = c0;
u = c0 * c0 * (log1p(excess) - part) + p0 / rho0 * part;
