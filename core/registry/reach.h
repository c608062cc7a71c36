/* registry/reach.h -- is there memory behind a pointer of a plugin's? A descriptor with a
 * pointer that was never set, or never relocated, is refused with a sentence instead of ending
 * the program. Pointers to memory that is there but means something else cannot be told from
 * right ones. */
#ifndef REGISTRY_REACH_H
#define REGISTRY_REACH_H

#include <stdbool.h>
#include <stddef.h>

/* All of [p, p + n) may be read. Not for NULL. */
bool reach_bytes(const void *p, size_t n);
/* All of the string up to its end, or its first `most` bytes if it is longer. false for NULL. */
bool reach_text(const char *s, size_t most);

#endif
