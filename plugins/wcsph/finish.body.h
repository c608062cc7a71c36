/* finish.body.h -- of one particle: gravity, and the time step that it allows. Viscosity's bound is Monaghan's (1989,
 * J. Comput. Phys. 82, 1, eq. 3.4) with |mu| <= h |div v|, of which the continuity equation has just given
 * -drho / rho; the force's is sqrt(h / |a|), in units of which the scene's cfl is meant: the roots are taken
 * where it matters. */
const R gravity[3] = {gx, gy, gz};
R a2 = 0.0;
for (int c = 0; c < DIM; c++) {
    a[c] += gravity[c];
    a2 += a[c] * a[c];
}
dt = h * rho / ((1.0 + 0.6 * alpha) * cs * rho + (1.0 + 0.6 * beta) * h * fabs(drho));
const R square = dt * dt;
if (h * h < square * square * a2)
    dt = sph_min(sqrt(h / sqrt(a2)), dt);
