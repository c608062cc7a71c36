/* scene/fill_overlap.c -- particles of different origin that stand too near to one another:
 * found with a hash of cells as wide as the largest distance that matters. */
#include "scene/fill_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct hash {
    const struct near_cloud *cloud;
    double cell;
    uint32_t mask;
    uint32_t *begin; /* [mask + 2] */
    uint32_t *index; /* [n], by bucket */
};

static uint32_t bucket_of(const struct hash *h, const int64_t cell[3])
{
    uint64_t mix = 0;
    for (int i = 0; i < h->cloud->dim; i++) {
        mix = (mix ^ (uint64_t)cell[i]) * 0x9e3779b97f4a7c15u;
        mix ^= mix >> 32;
    }
    return (uint32_t)mix & h->mask;
}

static void cell_at(const struct hash *h, size_t i, int64_t cell[3])
{
    for (int c = 0; c < 3; c++) {
        double x = c < h->cloud->dim ? floor(h->cloud->x[c][i] / h->cell) : 0;
        cell[c] = x > -9e15 && x < 9e15 ? (int64_t)x : 0;
    }
}

static int hash_init(struct hash *h, const struct near_cloud *c, struct error *e)
{
    double widest = 0;
    uint32_t size = 16;
    for (size_t i = 0; i < c->n; i++)
        widest = fmax(widest, c->spacing[i]);
    while (size < c->n && size < 1u << 30)
        size *= 2;
    *h = (struct hash){.cloud = c, .cell = c->near * widest, .mask = size - 1};
    if (c->n >= UINT32_MAX)
        return error_set(e, EXIT_USAGE, "%zu particles are too many", c->n);
    h->begin = calloc((size_t)size + 1, sizeof *h->begin);
    h->index = calloc(c->n + 1, sizeof *h->index);
    if (!h->begin || !h->index)
        return error_memory(e, "the search for overlaps", c->n * sizeof *h->index);
    int64_t cell[3];
    for (size_t i = 0; i < c->n; i++) {
        cell_at(h, i, cell);
        h->begin[bucket_of(h, cell) + 1]++;
    }
    for (uint32_t b = 0; b < size; b++)
        h->begin[b + 1] += h->begin[b];
    for (size_t i = c->n; i-- > 0;) { /* from the end: begin[b + 1] walks down to begin[b] */
        cell_at(h, i, cell);
        h->index[--h->begin[bucket_of(h, cell) + 1]] = (uint32_t)i;
    }
    /* Now begin[b + 1] is where bucket b begins. */
    memmove(h->begin, h->begin + 1, size * sizeof *h->begin);
    h->begin[size] = (uint32_t)c->n;
    return 0;
}

static bool overlap(const struct near_cloud *c, size_t i, size_t j)
{
    double r2 = 0, near = c->near * fmin(c->spacing[i], c->spacing[j]);
    if (c->group[i] == c->group[j])
        return false;
    for (int k = 0; k < c->dim; k++)
        r2 += (c->x[k][i] - c->x[k][j]) * (c->x[k][i] - c->x[k][j]);
    return r2 < near * near;
}

/* A later particle that overlaps i, or n. */
static size_t partner(const struct hash *h, size_t i)
{
    int64_t here[3], cell[3];
    int range[3];
    cell_at(h, i, here);
    for (int c = 0; c < 3; c++)
        range[c] = c < h->cloud->dim ? 1 : 0;
    for (int z = -range[2]; z <= range[2]; z++)
        for (int y = -range[1]; y <= range[1]; y++)
            for (int x = -1; x <= 1; x++) {
                cell[0] = here[0] + x;
                cell[1] = here[1] + y;
                cell[2] = here[2] + z;
                uint32_t b = bucket_of(h, cell);
                for (uint32_t k = h->begin[b]; k < h->begin[b + 1]; k++)
                    if (h->index[k] > i && overlap(h->cloud, i, h->index[k]))
                        return h->index[k];
            }
    return h->cloud->n;
}

int near_pair(const struct near_cloud *c, bool *found, size_t *i, size_t *j, struct error *e)
{
    struct hash h;
    *found = false;
    int status = hash_init(&h, c, e);
    for (*i = 0; !status && *i < c->n; ++*i) {
        *j = partner(&h, *i);
        if (*j < c->n) {
            *found = true;
            break;
        }
    }
    free(h.begin);
    free(h.index);
    return status;
}

int fill_check_overlap(const struct particles *arrays, size_t n, const struct scene *s,
                       struct error *e)
{
    size_t total = 0, at = 0, i, j;
    bool found = false;
    for (size_t a = 0; a < n; a++)
        total += arrays[a].n;
    if (n < 2 || !total)
        return 0;
    double *x = calloc(total * 4, sizeof *x);
    uint32_t *group = calloc(total, sizeof *group);
    int status = x && group ? 0 : error_memory(e, "the search for overlaps", total * 4 * sizeof *x);
    struct near_cloud cloud = {.dim = s->dim, .near = NEAR_OVERLAP, .n = total, .group = group};
    for (size_t a = 0; !status && a < n; a++) {
        const double *h = particles_real(&arrays[a], "h", 0);
        for (size_t k = 0; k < arrays[a].n; k++, at++) {
            for (int c = 0; c < s->dim; c++)
                x[(size_t)c * total + at] = particles_real(&arrays[a], "x", (uint32_t)c)[k];
            x[3 * total + at] = h[k] / s->array[a].h_factor;
            group[at] = (uint32_t)a;
        }
    }
    for (int c = 0; c < 3 && x; c++)
        cloud.x[c] = x + (size_t)c * total;
    cloud.spacing = x ? x + 3 * total : NULL;
    if (!status)
        status = near_pair(&cloud, &found, &i, &j, e);
    if (found) {
        const struct scene_array *one = &s->array[group[i]], *two = &s->array[group[j]];
        status = document_fail(
            s->doc, two->node, e,
            "\"%s\" overlaps \"%s\": particles of both stand near (%.6g, %.6g, %.6g), "
            "less than a quarter of their spacing apart",
            two->name, one->name, x[i], x[total + i], x[2 * total + i]);
    }
    free(x);
    free(group);
    return status;
}
