/* spread_before.body.h -- see spread.h. */
guess = guess * SPREAD_HALF + tick * b->dt;
if (kind > 0.5)
    guess += 1.0;
