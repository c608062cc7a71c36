/* mark.body.h -- before the pairs: 1 for all. */
if (age < -1e-9)
    sph_fail(0);
if (age > 1000.0)
    sph_fail(1);
mark = 1.0;
