/* check/child.h -- runs a plugin's code in a child process, so that a crash, an endless loop or an
 * exit there is a verdict here. */
#ifndef CHECK_CHILD_H
#define CHECK_CHILD_H

#include "check/subject.h"

/* What is done in the child; says its verdicts with say(). */
typedef void (*child_work)(const struct subject *s);

/* Runs `work` for at most `timeout` seconds and adds what it says to the report, under the name of
 * the subject's item (without entry: as kind "plugin", `item`). Says itself what went wrong if the
 * child does not come to its end. Fails only for want of processes or memory. */
int child_run(struct subject *s, const char *item, const char *check, child_work work,
              double timeout, struct report *report, struct error *e);

#endif
