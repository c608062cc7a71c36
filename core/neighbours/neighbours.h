/* neighbours/neighbours.h -- source lists for groups of destinations.
 *
 * A group is SPH_LANES consecutive destinations (the last may be short); its list holds every
 * source that may lie within reach of any of them: r < reach_i, and for symmetric lists also r <
 * reach_j, both enlarged by the skin. A list stays right while 2 * largest displacement since it
 * was made + growth of reach_i <= skin * reach_i(then) for every particle. A list is without
 * repeats. A source that one half of the lanes alone can be near is for that half alone, if it finds a
 * partner of the other half (sph_span.common), which saves a fifth of a sweep's steps; what is for
 * all ascends in index, and behind it those that found none. Sources up to 0.5 % beyond the enlarged reach may be in
 * it.
 *
 * Where the sources have an order in which they are to be visited (cloud.visits) it is that, for all lanes, and
 * spans begin anew wherever it leaves 65535 indices.
 *
 * Sort the sources by cell_order now and then: those out of all order are sorted aside, which
 * costs about as much again, and a group whose destinations are far apart costs twenty times
 * another. */
#ifndef NEIGHBOURS_NEIGHBOURS_H
#define NEIGHBOURS_NEIGHBOURS_H

#include "base/error.h"
#include "base/store.h"
#include <sph/batch.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct visits;

/* Points in up to three dimensions with their reach (support radius); not owned. */
struct cloud {
    int dim;
    size_t n;
    const double *x[3];
    const double *h; /* smoothing length; reach = scale * h */
    double scale;
    const struct visits
        *visits; /* NULL: lists visit sources as suits them; else in this order (visit.h) */
};

/* Destinations with more neighbours than somebody foresees. */
struct overflow {
    uint64_t most;       /* more are too many: asked for by the caller; 0: nobody asks */
    bool stops;          /* then nothing more is made, and making the list fails */
    uint64_t n;          /* destinations with too many; of a list that fails not all are found */
    size_t first;        /* the first of them */
    uint64_t neighbours; /* that it has within reach (no skin, itself not counted) */
};

/* The sources of group g: span[s].base + step[span[s].first + k], k < span[s].count, for begin[g] <=
 * s < begin[g + 1]. A new span begins only where a source is UINT16_MAX or more beyond the base.
 * Spans and steps of a group follow those of the one before. */
struct group_list {
    uint64_t *begin; /* [n_group + 1]: into span */
    sph_span *span;  /* [n_span] */
    uint16_t *step;  /* [n_entry] */
    size_t n_group, n_span;
    uint64_t n_entry;
    size_t group_capacity, span_capacity, step_capacity;
    bool symmetric;
    struct overflow crowd;
    double true_share; /* set by who counts (group_list_count): true pairs per entry of the list */
    const struct neighbour_manager *manager; /* who made it */
    /* Sources that the manager looked at, times the destinations that asked; of these pairs, those
     * whose distance was computed; bytes that the search had at most, the list not counted. */
    uint64_t visited, candidates, search_bytes;
};

/* Who finds the sources near a place. All give the same lists, bit for bit. */
enum neighbour_manager_id {
    NEIGHBOURS_BOXES,
    NEIGHBOURS_CELLS,
    NEIGHBOURS_RADIX,
    NEIGHBOURS_OCTREE
};

struct neighbour_manager {
    const char *name, *doc;
    const struct manager_calls *calls;
};

/* The k-th (enum neighbour_manager_id); NULL if there are fewer. */
const struct neighbour_manager *neighbour_manager_at(size_t k);
/* NULL if none has this name. */
const struct neighbour_manager *neighbour_manager_find(const char *name);
/* The one taken where none is asked for: "boxes", which was the fastest of all for even particles
 * and for reaches that range over a factor of 100 (make bench prints both). "octree" looks at a
 * fifth fewer sources in the latter, but must put all in an order of its own first. */
const struct neighbour_manager *neighbour_manager_default(void);

/* Lists for destinations dst over sources src (which may be the same arrays, self pairs
 * included). `skin` is relative (0.1). manager: NULL for neighbour_manager_default. threads: how
 * many OpenMP threads; the result is the same for any. src->h may be NULL if !symmetric. Fails,
 * naming the particle by its index, if a position or smoothing length is not a number that can be
 * (finite, h >= 0). Begin with a list of zeros; one that is made again uses its memory again. */
int group_list_make(struct group_list *list, const struct cloud *dst, const struct cloud *src,
                    bool symmetric, double skin, const struct neighbour_manager *manager,
                    int threads, struct error *e);
/* Directed pairs within reach (no skin, self pairs included) among those that the list offers. */
uint64_t group_list_count(const struct group_list *list, const struct cloud *dst,
                          const struct cloud *src, int threads);
/* Entries of groups [first, end). */
static inline uint64_t group_list_entries(const struct group_list *list, size_t first, size_t end)
{
    uint64_t a = list->begin[first], b = list->begin[end];

    return (b < list->n_span ? list->span[b].first : list->n_entry) -
           (a < list->n_span ? list->span[a].first : list->n_entry);
}

/* Goes through a group's sources: for (struct source_walk w = source_walk_begin(list, g);
 * source_walk_next(list, &w);) ... w.source */
struct source_walk {
    uint64_t span, end;
    uint32_t k, source;
};

static inline struct source_walk source_walk_begin(const struct group_list *list, size_t group)
{
    struct source_walk w = {.span = list->begin[group], .end = list->begin[group + 1]};

    return w;
}

static inline bool source_walk_next(const struct group_list *list, struct source_walk *w)
{
    if (w->span < w->end && w->k == list->span[w->span].count) {
        w->span++;
        w->k = 0;
    }
    if (w->span == w->end) {
        return false;
    }
    w->source = list->span[w->span].base + list->step[list->span[w->span].first + w->k++];
    return true;
}

/* Into a checkpoint or out of it, as it is: of n_dst destinations and n_src sources (SIZE_MAX: not looked at,
 * since the list is no longer in use). */
int group_list_store(struct group_list *list, struct store *s, size_t n_dst, size_t n_src,
                     struct error *e);

void group_list_fini(struct group_list *list);
size_t group_list_bytes(const struct group_list *list);

/* The order that puts points into linear cell order (cells of edge `cell`, x fastest, sorted by x
 * and then by id within a cell): order[i] = old index of the i-th. id may be NULL. The same for any
 * number of threads, and however the points stood before if the ids differ. Cells that hold many
 * points are divided into groups of lists, and in a box that is mostly empty larger cells are
 * taken. */
int cell_order(const struct cloud *points, const int64_t *id, double cell, int threads,
               uint32_t *order, struct error *e);
/* The edge that is best for lists, in mean spacings of the points: 2 in 3D, where a group is then about
 * as wide as long and the next one along x follows it; 3.2 in 2D, for the same.
 * Three reaches where those range widely, so that dense places are divided by their own density. */
double cell_best(const struct cloud *points);

#endif
