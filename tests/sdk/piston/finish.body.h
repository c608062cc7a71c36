/* finish.body.h -- of one particle of the piston, from the sums over the gas to its state. Who is not reached by gas
 * keeps what it had. The mass follows the density, so that what the gas sums up over the wall is gas of its own
 * density; the volume stays. */
if (weight > 0) {
    const R per = 1 / weight, mean = per * sum_p;
    m = volume * per * sum_rho;
    /* An accelerated wall stands in its own weight: -a . sum W rho (x_wall - x_gas). */
    p = fmax(mean - per * acceleration * lever[0], 0.1 * mean); /* it does not pull */
    cs = per * sum_cs;
}
rho = m / volume; /* not the scheme's sum, which lacks what is behind the wall */
