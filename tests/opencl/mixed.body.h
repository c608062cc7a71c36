/* mixed.body.h -- q takes what its neighbours gave. */
q += 0.05 * dq;
