/* spread.macros.h -- see spread.h. */
#define SPREAD_HALF 0.5
#define SPREAD_MEAN(a, b) (SPREAD_HALF * ((a) + (b)))
