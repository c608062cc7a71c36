/* decay.body.h -- for one particle: c falls to 1/e in the time tau. */
dc -= c / tau;
