/* run/earlier.h -- what a run that did not end has left in the folder where another begins: its newest good checkpoint,
 * which is kept until the other has come as far. */
#ifndef RUN_EARLIER_H
#define RUN_EARLIER_H

#include "io/output.h"

struct earlier {
    bool any;
    uint64_t step;
    double time;
};

/* Clears a claimed folder. Of a run there that did not end the newest good checkpoint is kept as OUTPUT_EARLIER, which
 * is told on stderr, with the way to go on from it. */
int earlier_clear(struct earlier *was, const struct output *o, struct error *e);
/* Looks whether there is one: for a run that goes on. */
void earlier_find(struct earlier *was, const struct output *o);
/* This run has come to `step`: away with it if that is as far. */
void earlier_pass(struct earlier *was, const struct output *o, uint64_t step);

#endif
