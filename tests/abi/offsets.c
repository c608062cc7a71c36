/* offsets.c -- nothing of the ABI moves: where each member stood when frozen/offsets.def was made,
 * there it stands. Compiling is the test (gate.py); 64-bit machines only. */
#include <sph/plugin.h>

#if UINTPTR_MAX == 0xffffffffffffffffu

#define AT(type, member, offset)                                                                   \
    _Static_assert(offsetof(type, member) == (offset), #type "." #member " has moved");

/* Behind the last member there is no room that a new one could take unseen: its presence shows in the
 * size. */
#define GROWS(type, last, bytes)                                                                   \
    _Static_assert(sizeof(type) >= (bytes), #type " has shrunk");                                  \
    _Static_assert(offsetof(type, last) + sizeof(((type *)0)->last) == (bytes),                    \
                   #type " ends in padding");

/* Stands by value in other structs, so it can never grow. */
#define FIXED(type, last, bytes)                                                                   \
    _Static_assert(sizeof(type) == (bytes), #type " stands in other structs: its size is fixed");

#include "frozen/offsets.def"

#endif
