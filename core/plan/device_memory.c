/* plan/device_memory.c -- see device_memory.h. Knows how much core/opencl keeps for a particle, and nothing of
 * OpenCL: it is asked where none is there. */
#include "plan/device_memory.h"
#include <math.h>

/* Entries of the lists of eight destinations over the true neighbours of one, at a skin of a tenth: what they share
 * is listed once. Measured with several kernels and schemes, ordered and disordered; by dimension. */
static const double entries_per_neighbour[4] = {0.0, 3.3, 2.7, 2.6};
/* Entries for a destination that a list has room for from the start (opencl/lists.c). */
static const double entries_first[4] = {0.0, 8.0, 16.0, 40.0};
/* What does not grow with the particles: slots of a slab of groups, tables, results. */
#define FIXED 6.6e6
/* Layers of ghosts are not as even as volumes are. */
#define SPARE 1.1

/* The largest smoothing length: of the particles, or of those that will be made. */
static double largest_h(const struct plan *plan)
{
    const struct box *box = &plan->scene->box;
    double volume = 1.0, n = 0.0, factor = 0.0, most = 0.0;
    for (size_t a = 0; a < plan->n_array; a++) {
        const struct plan_array *pa = &plan->array[a];
        const struct column *h = &pa->p.column[pa->smoothing];
        for (size_t i = 0; i < pa->p.n; i++)
            most = fmax(most, column_get(h, 0, i));
        n += (double)plan_count(plan, a);
        factor = fmax(factor, pa->scene->h_factor);
    }
    for (int c = 0; c < plan->dim; c++)
        volume *= box->max[c] - box->min[c];
    return most > 0.0 ? most : n > 0.0 ? factor * pow(volume / n, 1.0 / plan->dim) : 0.0;
}

/* Particles and ghosts over particles. */
static double with_ghosts(const struct plan *plan)
{
    const struct box *box = &plan->scene->box;
    const double h = box->bounded && plan->has_kernel ? largest_h(plan) : 0.0;
    const double margin = h * plan->kernel.support * plan->reach_scale * (1.0 + plan->skin);
    double all = 1.0;
    for (int c = 0; box->bounded && c < plan->dim; c++)
        for (int side = 0; side < 2; side++)
            if (box->side[c][side] != SIDE_OPEN)
                all *= 1.0 + fmin(margin / (box->max[c] - box->min[c]), 1.0);
    return all;
}

size_t plan_ghosts(const struct plan *plan, size_t array)
{
    return (size_t)((double)plan_count(plan, array) * SPARE * (with_ghosts(plan) - 1.0));
}

static void keep_largest(struct device_memory *m, double bytes, const char *of)
{
    if (bytes > m->largest) {
        m->largest = bytes;
        m->largest_of = of;
    }
}

/* Bytes of columns of 8, with `wide`, and of all else. */
static double column_bytes(const struct plan_array *a, bool wide)
{
    double bytes = 0.0;
    for (size_t c = 0; c < a->p.n_column; c++) {
        const struct column *column = &a->p.column[c];
        const bool is_wide = column->size == 8 && !a->in_floats[c];
        bytes += is_wide && wide     ? 8.0 * column->ncomp
                 : !is_wide && !wide ? 4.0 * column->ncomp
                                     : 0;
        bytes += !wide && (a->mirrored[c] || column->mirror) ? 4.0 * column->ncomp : 0.0;
    }
    return bytes;
}

static double list_bytes(const struct plan *plan, const struct plan_list *l, double all)
{
    const double n = (double)plan_count(plan, l->dst);
    const double of = (double)plan_count(plan, l->src) / fmax(all, 1.0);
    const double entries = plan_neighbours(plan, l->dst) * of * entries_per_neighbour[plan->dim] *
                           pow((1.0 + plan->skin) / 1.1, plan->dim) / SPH_LANES;
    return 4.0 * n * fmax(entries, entries_first[plan->dim]);
}

/* Of the search for a particle: boxes, cells, an order. Where it is not the particles' own: a copy of places and h,
 * keys and indices, both twice as they are sorted. */
static double search_bytes(const struct plan *plan)
{
    const double dim = plan->dim, own = 2.0 * dim + 1.0 + 20.0;
    return !plan->manager || plan->manager == neighbour_manager_default()
               ? own
               : own + 8.0 * (dim + 1.0) + 24.0;
}

struct device_memory plan_device_memory(const struct plan *plan)
{
    struct device_memory m = {.search = FIXED};
    double all = 0.0, most = 0.0;
    for (size_t a = 0; a < plan->n_array; a++) {
        const double n = (double)plan_count(plan, a), ghosts = (double)plan_ghosts(plan, a);
        const double wide = column_bytes(&plan->array[a], true),
                     narrow = column_bytes(&plan->array[a], false);
        all += n;
        most = fmax(most, n + ghosts);
        m.columns += (wide + narrow) * (n + ghosts) + 5.0 * ghosts;
        keep_largest(&m, wide * (n + ghosts), plan->array[a].p.name);
        keep_largest(&m, narrow * (n + ghosts), plan->array[a].p.name);
        /* Places at which lists were made. */
        m.search += 8.0 * (plan->dim + 1) * n * (double)plan->n_frame;
    }
    for (size_t k = 0; k < plan->n_list; k++) {
        const double bytes = list_bytes(plan, &plan->list[k], all);
        m.lists += bytes + (double)plan_count(plan, plan->list[k].dst);
        keep_largest(&m, bytes, "neighbour lists");
    }
    m.search += plan->n_list ? most * search_bytes(plan) : 0.0;
    m.total = m.columns + m.search + m.lists;
    return m;
}

void plan_print_device_memory(const struct plan *plan, FILE *out)
{
    const struct device_memory m = plan_device_memory(plan);
    fprintf(out,
            "device memory: about %.3g MB: columns %.3g, neighbour lists %.3g, search %.3g\n"
            "               the largest buffer %.3g (%s)\n",
            1e-6 * m.total, 1e-6 * m.columns, 1e-6 * m.lists, 1e-6 * m.search, 1e-6 * m.largest,
            m.largest_of ? m.largest_of : "none");
}
