/* finish.body.h -- of one particle, what its pairs' fluxes accelerate and heat it by. v here is the predicted velocity
 * v + dt a (or its half, at mid-step), made with the acceleration of the last evaluation, which still stands in
 * "a". With dt/2 (a_new - a_old) added it is the one that both integrators end up with, and the work a.v then
 * takes from u just what v gains: the total energy is kept to second order or better. */
R work = 0.0;
for (int c = 0; c < DIM; c++) {
    work += force[c] * (v[c] + 0.5 * b->dt * (force[c] - a[c]));
    a[c] = force[c];
}
du = power - work;
dt = h / fmax(fastest, 2.0 * cs);
