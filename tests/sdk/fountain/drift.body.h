/* drift.body.h -- nothing: the rate is all. */
