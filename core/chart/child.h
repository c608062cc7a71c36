/* chart/child.h -- one run as a child process of this same program. */
#ifndef CHART_CHILD_H
#define CHART_CHILD_H

#include "base/error.h"
#include <stdbool.h>

struct child_outcome {
    int status;       /* as waitpid gives it */
    bool late;        /* it was ended because its time was over */
    bool interrupted; /* it was ended because we are asked to end */
    double seconds;   /* of wall time */
    char words[1024]; /* its last line on standard error */
};

/* Called a few times a second while the child runs. */
typedef void (*child_tick)(void *data, double seconds);

/* Blocks SIGCHLD, SIGINT and SIGTERM, which child_run then waits for, and gives them back. */
void child_signals(bool block);

/* Starts `sph ARGUMENT...` and waits for its end. After `limit` seconds it is told to end, and killed
 * some seconds later. It dies with us, however we die. An interrupt (SIGINT, SIGTERM) kills it. Fails
 * only for want of processes or memory. */
int child_run(char *const *argument, double limit, child_tick tick, void *data,
              struct child_outcome *o, struct error *e);

#endif
