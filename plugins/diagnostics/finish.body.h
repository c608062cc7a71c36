/* finish.body.h -- one that is alone gets the support: snapshots and probes want a number, and farther it is. */
nearest = fmin(nearest, K->support *h);
