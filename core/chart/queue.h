/* chart/queue.h -- makes the runs of a chart that have no result yet, one after the other. */
#ifndef CHART_QUEUE_H
#define CHART_QUEUE_H

#include "chart/results.h"

struct queue_options {
    bool keep;     /* the folders of finished runs, whole */
    bool progress; /* a line on a terminal */
};

/* The wanted runs without a row, or with one that is tried again: what was refused, and what came to no
 * end in another time. */
size_t queue_left(const struct chart *c, const struct results *s);

/* Makes them. The results are written whole after each, so that whatever ends us loses one run at
 * most; what a killed one left is swept away. *made counts them; *interrupted: we were asked to end. */
int queue_run(const struct chart *c, struct results *s, const struct output *o,
              const struct queue_options *q, size_t *made, bool *interrupted, struct error *e);

#endif
