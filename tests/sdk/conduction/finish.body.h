/* finish.body.h -- of one particle, when all neighbours have added to it. */
heat = c * temperature;
step = rho * c * h * h / k;
