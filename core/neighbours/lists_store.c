/* neighbours/lists_store.c -- a neighbour list goes into a checkpoint as it is, and comes back: sums over pairs
 * have its order, so a list made anew would change their last bits. */
#include "neighbours/neighbours.h"

#include <stdlib.h>
#include <string.h>

#define SPARE 64 /* elements behind each array */

/* What leads from one array into the next stays within it, and every source is one of n_src. */
static bool list_fits(const struct group_list *l, size_t n_begin, size_t n_dst, size_t n_src)
{
    if (n_dst == SIZE_MAX) {
        return true;
    }
    if (n_begin == 0) {
        return l->n_span == 0 && l->n_entry == 0;
    }
    if (n_begin - 1 != (n_dst + SPH_LANES - 1) / SPH_LANES || l->begin[0] != 0 ||
        l->begin[n_begin - 1] != l->n_span) {
        return false;
    }
    for (size_t g = 0; g + 1 < n_begin; g++) {
        if (l->begin[g] > l->begin[g + 1]) {
            return false;
        }
    }
    for (size_t s = 0; s < l->n_span; s++) {
        const sph_span *span = &l->span[s];

        if (span->first > l->n_entry || span->count > l->n_entry - span->first) {
            return false;
        }
        for (size_t k = 0; k < span->count; k++) {
            if ((size_t)span->base + l->step[span->first + k] >= n_src) {
                return false;
            }
        }
    }
    return true;
}

int group_list_store(struct group_list *l, struct store *s, size_t n_dst, size_t n_src,
                     struct error *e)
{
    size_t begin = l->begin ? l->n_group + 1 : 0, bytes = l->n_span * sizeof *l->span;
    size_t entries = (size_t)l->n_entry;
    char *manager = NULL;
    int status = 0;

    if (!s->reading && l->manager && !(manager = strdup(l->manager->name))) {
        return error_memory(e, "a name", 1);
    }
    status =
        store_array(s, "begin", STORE_U64, &l->begin, &begin, SPARE, e) ||
                store_array(s, "span", STORE_U8, &l->span, &bytes, SPARE * sizeof *l->span, e) ||
                store_array(s, "step", STORE_U16, &l->step, &entries, SPARE, e) ||
                store_flags(s, "symmetric", &l->symmetric, 1, e) ||
                store_f64(s, "true_share", &l->true_share, e) ||
                store_u64(s, "visited", &l->visited, e) ||
                store_u64(s, "candidates", &l->candidates, e) ||
                store_u64(s, "search_bytes", &l->search_bytes, e) ||
                store_text(s, "manager", &manager, e)
            ? -1
            : 0;
    if (s->reading && status == 0) {
        l->n_group = begin ? begin - 1 : 0;
        l->n_span = bytes / sizeof *l->span;
        l->n_entry = entries;
        l->group_capacity = begin;
        l->span_capacity = l->n_span;
        l->step_capacity = entries;
        l->manager = manager ? neighbour_manager_find(manager) : NULL;
        if (!list_fits(l, begin, n_dst, n_src)) {
            status = store_broken(s, e, "%s is no neighbour list of these particles", s->group);
        }
    }
    if (s->reading && status != 0) {
        group_list_fini(l);
    }
    free(manager);
    return status;
}
