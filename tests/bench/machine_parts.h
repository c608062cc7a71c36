/* machine_parts.h -- what machine_measure() is made of. */
#ifndef MACHINE_PARTS_H
#define MACHINE_PARTS_H

#include "machine.h"

enum { MACHINE_REPEATS = 12 }; /* of each figure, the best of which counts */

/* [s] this thread has computed, and the clock on the wall. */
double machine_cpu_time(void);
double machine_wall_time(void);

/* The arithmetic (machine_core.c) and the memory (machine_memory.c). m->threads is set. */
void machine_core(struct machine *m);
void machine_memory(struct machine *m);

#endif
