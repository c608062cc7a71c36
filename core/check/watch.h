/* check/watch.h -- memory that a plugin may touch, and the words for when it touches other: pages
 * are protected, and a fault there becomes the child's last verdict. In the child alone. */
#ifndef CHECK_WATCH_H
#define CHECK_WATCH_H

#include "check/subject.h"
#include "particles/particles.h"

/* Exit status of a child whose last verdict came from a fault. */
#define WATCH_TRAPPED 99

void watch_begin(const struct subject *s);

/* Particles whose columns live on pages of their own (`guarded`); access[c]: what is declared of
 * column c: 0 nothing, 1 read, 2 read and write. Both must outlive the child. `closed` is the
 * sentence's end for all of them once they are shut for good, else NULL. */
struct watched {
    const struct particles *particles;
    const int *access;
    const char *closed;
};
void watch_particles(struct watched *w);

/* Zeroed memory that ends where a page begins that nobody may touch; `what` is what stands behind
 * it, in the sentence "touches ..., beyond its end". NULL: none is to be had. */
void *watch_memory(size_t bytes, const char *what);
void watch_release(const void *memory);
/* From now on it is read only. */
void watch_seal(const void *memory);

#endif
