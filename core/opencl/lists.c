/* temporary */
#include "opencl/lists.h"
#include <stdlib.h>
#include <string.h>
struct device_search { struct device *d; int dim; const struct neighbour_manager *manager; };
int device_search_open(struct device_search **out, struct device *d, int dim, const struct neighbour_manager *manager, struct error *e)
{ *out = calloc(1, sizeof **out); (*out)->d = d; (*out)->dim = dim; (*out)->manager = manager; (void)e; return 0; }
void device_search_close(struct device_search *s) { free(s); }
static struct cloud host(struct device_search *s, const struct device_cloud *c)
{
    struct cloud out = {.dim = c->dim, .n = c->n, .scale = c->scale};
    struct error e;
    for (int k = 0; k <= c->dim; k++) {
        double *x = calloc(c->n + 64, sizeof *x);
        uint32_t slot = k < c->dim ? c->x_slot + (uint32_t)k : c->h_slot;
        if (c->n) device_read(s->d, c->wide, (slot * c->plane + c->first) * 8, x, c->n * 8, &e);
        if (k < c->dim) out.x[k] = x; else out.h = x;
    }
    return out;
}
static void drop(struct cloud *c) { for (int k = 0; k < c->dim; k++) free((void *)(uintptr_t)c->x[k]); free((void *)(uintptr_t)c->h); }
int device_list_make(struct device_search *s, struct device_list *list, const struct device_cloud *dst, const struct device_cloud *src, bool symmetric, double skin, bool counted, uint64_t most, struct error *e)
{
    struct cloud a = host(s, dst), b = host(s, src);
    struct group_list g = {0};
    (void)most;
    int status = group_list_make(&g, &a, &b, symmetric, skin, s->manager, 2, e);
    if (!status) {
        uint32_t *begin = calloc(g.n_group + 1, 4), *common = calloc(g.n_group + 1, 4), *step = malloc((g.n_entry + 1) * 4), n = 0;
        for (size_t k = 0; k < g.n_group; k++) {
            begin[k] = n;
            for (uint64_t q = g.begin[k]; q < g.begin[k + 1]; q++)
                for (uint32_t i = 0; i < g.span[q].common; i++) step[n++] = g.span[q].base + g.step[g.span[q].first + i];
            common[k] = n - begin[k];
            for (uint64_t q = g.begin[k]; q < g.begin[k + 1]; q++)
                for (uint32_t i = g.span[q].common; i < g.span[q].count; i++) step[n++] = g.span[q].base + g.step[g.span[q].first + i];
        }
        begin[g.n_group] = n;
        list->n_group = g.n_group; list->n_entry = n;
        if (counted) list->n_pair = group_list_count(&g, &a, &b, 2) - (dst->wide == src->wide ? dst->n : 0);
        device_reserve(s->d, &list->begin, (g.n_group + 1) * 4, "lists", e); device_write(s->d, &list->begin, 0, begin, (g.n_group + 1) * 4, e);
        device_reserve(s->d, &list->common, (g.n_group + 1) * 4, "lists", e); device_write(s->d, &list->common, 0, common, (g.n_group + 1) * 4, e);
        device_reserve(s->d, &list->step, (n + 1) * 4, "lists", e); device_write(s->d, &list->step, 0, step, n * 4, e);
        free(begin); free(common); free(step);
    }
    group_list_fini(&g); drop(&a); drop(&b);
    return status;
}
void device_list_release(struct device *d, struct device_list *list) { device_release(d, &list->begin); device_release(d, &list->common); device_release(d, &list->step); }
int device_order(struct device_search *s, const struct device_cloud *points, uint32_t id_slot, struct device_buffer *order, struct error *e)
{
    struct cloud a = host(s, points);
    int64_t *id = malloc(a.n * 8 + 8); uint32_t *o = malloc(a.n * 4 + 4);
    device_read(s->d, points->wide, id_slot * points->plane * 8, id, a.n * 8, e);
    int status = cell_order(&a, id, cell_best(&a), 2, o, e);
    device_reserve(s->d, order, a.n * 4, "order", e); device_write(s->d, order, 0, o, a.n * 4, e);
    free(id); free(o); drop(&a);
    return status;
}
