/* opencl/search.h -- what neighbour lists and order on a device share: points, what is known of
 * them, the search structure. The structs are those of points.cl, member for member. For lists.c,
 * order.c, search.c alone. */
#ifndef OPENCL_SEARCH_H
#define OPENCL_SEARCH_H

#include "opencl/lists.h"
#include "opencl/sort.h"

#define SEARCH_LEVELS 12 /* 8^11 leaves and sources have room in 32 bits */
#define SEARCH_SLICE 4096

/* Points in a buffer of doubles: where x[0] and h of the first are; reach = scale * h. */
struct search_points {
    uint64_t x, h, plane;
    double scale;
    uint32_t n, pad;
};

/* Leaves of eight points in the search's order, and how those near a place are found. */
struct search_index {
    double low[3], last[3], inverse; /* of cells: corner, cells along an axis less one, edge */
    double reach;                    /* the largest of a source; 0 if it does not count */
    uint64_t step[3];                /* of a cell's number along an axis */
    uint32_t n, n_leaf, n_level, pad;
    uint32_t offset[SEARCH_LEVELS], nodes[SEARCH_LEVELS]; /* of boxes: blocks of eight */
};

/* What is known of a cloud. */
struct search_survey {
    double least[3], most[3], h_sum, h_most;
    bool good;
};

enum search_kind { SEARCH_TREE, SEARCH_CELLS, SEARCH_KEYS };

enum {
    K_SURVEY,
    K_CELL,
    K_SCATTER,
    K_LEAVES,
    K_BOXES,
    K_LIST,
    K_PAIRS,
    K_LOOK,
    K_PUT,
    K_FULL,
    K_SORT_CELLS,
    K_GATHER,
    K_KEYS,
    K_CROWDS,
    SEARCH_KERNELS
};
/* Programs: what every search needs, an order of its own, crowded cells. */
enum search_set { SEARCH_ALL, SEARCH_OWN_ORDER, SEARCH_CROWDS, SEARCH_SETS };

struct device_search {
    struct device *d;
    struct device_sort *sort;
    int dim;
    bool cpu, own_order; /* own_order: sources are read through an order of the search's own */
    enum search_kind kind;
    bool morton;
    struct device_program *program[SEARCH_SETS];
    struct device_kernel *kernel[SEARCH_KERNELS];
    struct device_buffer survey, box, copy, order, key, cell, begin, total, tables;
    struct device_buffer slot, counts, pairs, need;
    uint32_t room; /* of a side of a group's slot */
    void *host;    /* what is read back */
    size_t host_size;
};

#define SEARCH_LAUNCH(s, k, items, ...)                                                            \
    device_launch((s)->d, (s)->kernel[k], items, (struct device_arg[]){__VA_ARGS__},               \
                  sizeof((struct device_arg[]){__VA_ARGS__}) / sizeof(struct device_arg), e)

/* Work items for n things, so many to each. */
static inline size_t search_items(size_t n, size_t each)
{
    return (n + each - 1) / each;
}

/* Things that a work item takes one after the other where each is little work. */
static inline uint32_t search_each(const struct device_search *s)
{
    return s->cpu ? 4096 : 1;
}

/* device_search_open, for a processor or for another kind of device. */
int search_open(struct device_search **out, struct device *d, int dim,
                const struct neighbour_manager *manager, bool cpu, struct error *e);
/* Builds a program, unless it is there: compilers take a fraction of a second a kernel. */
int search_need(struct device_search *s, enum search_set set, struct error *e);
/* Room on the host for what is read back; NULL: no memory. */
void *search_room(struct device_search *s, size_t bytes, struct error *e);
struct search_points search_points_of(const struct device_cloud *c);
/* Waits. */
int search_look(struct device_search *s, const struct device_cloud *c, size_t first, bool h,
                struct search_survey *out, struct error *e);
/* Fails where a number is none or too far away. */
int search_check(const struct search_survey *v, const char *role, struct error *e);

/* Each point's cell (s->cell) and how many are in each (s->begin, with one element more). */
struct grid;
int search_cells(struct device_search *s, const struct device_cloud *c, const struct grid *g,
                 struct search_index *ix, struct error *e);
/* Makes the structure in which sources are sought. all: what is known of them and of the
 * destinations; factor enlarges reaches; typical: reach of a destination, query: the largest of
 * all. *p: the sources in the search's order, which are s->copy, and s->order their indices, if
 * s->own_order is then set. */
int search_make(struct device_search *s, const struct device_cloud *src,
                const struct search_survey *all, bool symmetric, double factor, double typical,
                double query, struct search_index *ix, struct search_points *p, struct error *e);

#endif
