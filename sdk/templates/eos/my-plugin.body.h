/* my-plugin.body.h -- pressure and speed of sound of one particle. */
const R room = 1 - covolume * rho;
if (!(room > 0))
    sph_fail(0); /* compressed beyond its covolume it has no state: the run ends */
p = (gamma - 1) * rho * u / room;
cs = sqrt(gamma * fmax(p, 0.0) / (rho * room));
