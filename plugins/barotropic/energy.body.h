/* energy.body.h -- nothing is left to do: the reduction is all. */
