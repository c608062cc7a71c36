/* turn.body.h -- the places X of other neighbours move. */
X[0] += 0.002 * X[DIM - 1];
