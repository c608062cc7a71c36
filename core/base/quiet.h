/* base/quiet.h -- what a library prints by itself goes nowhere meanwhile. */
#ifndef BASE_QUIET_H
#define BASE_QUIET_H

/* Standard output and standard error go to /dev/null until quiet_end; `kept` is theirs. Of the whole
 * process: only where no other thread prints. [main] */
void quiet_begin(int kept[2]);
void quiet_end(const int kept[2]);

#endif
