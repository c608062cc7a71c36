/* neighbours/far.h -- which groups of a list have sources that come late: those of other ranks. */
#ifndef NEIGHBOURS_FAR_H
#define NEIGHBOURS_FAR_H

#include "neighbours/neighbours.h"

/* far[g], of n_group: whether group g has a source with an index of `from` or more. */
void group_list_far(const struct group_list *list, size_t from, bool *far, int threads);

#endif
