/* scene/glass.c -- a glass by relaxation. Random points in a box repel their neighbours by the
 * potential (1 - r / reach)^2, whose Fourier transform is positive in up to three dimensions:
 * its least energy is the most even density, and long waves of density decay like short ones
 * (Gneiting 2002, doi:10.1006/jmva.2001.2056; the idea of glasses by repulsion: White 1996,
 * astro-ph/9410043). Descent with momentum; a gather over cells, so that threads change no bit. */
#include "scene/glass.h"
#include "scene/random.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define REACH 2.6    /* of the repulsion and of the density's kernel, in spacings */
#define MOMENTUM .85 /* kept of the last step */
#define LONGEST .25  /* step, in spacings */

/* Points and their images behind the sides, sorted into cells at least as wide as the reach. */
struct cells {
    size_t n, capacity, n_cell;
    size_t side[3];
    double low[3], width[3], reach;
    double *x[3];      /* [n], as made: the points, then images */
    double *sorted[3]; /* [n], by cell */
    size_t *parent;    /* [n]: the point; SIZE_MAX for images; by cell */
    size_t *begin;     /* [n_cell + 1] */
    size_t begin_capacity;
};

struct relax {
    struct glass *g;
    double spacing;
    struct cells cells;
    double *step[3]; /* [n]: the last step, then the next */
    double *density; /* [n] */
};

/* -- Cells ----------------------------------------------------------------------------------- */

static int cells_reserve(struct cells *c, size_t n, int dim)
{
    if (n <= c->capacity)
        return 0;
    size_t capacity = n + n / 4 + 64;
    for (int a = 0; a < dim; a++) {
        double *x = realloc(c->x[a], capacity * sizeof *x);
        if (x)
            c->x[a] = x;
        double *sorted = realloc(c->sorted[a], capacity * sizeof *sorted);
        if (sorted)
            c->sorted[a] = sorted;
        if (!x || !sorted)
            return -1;
    }
    size_t *parent = realloc(c->parent, capacity * sizeof *parent);
    if (!parent)
        return -1;
    c->parent = parent;
    c->capacity = capacity;
    return 0;
}

/* Images of everything so far, across the two sides of axis a. */
static int add_images(struct cells *c, const struct glass *g, int a)
{
    size_t n = c->n;
    double width = g->max[a] - g->min[a];
    for (size_t i = 0; i < n; i++) {
        double x = c->x[a][i];
        for (int high = 0; high < 2; high++) {
            double image = high ? 2 * g->max[a] - x : 2 * g->min[a] - x;
            bool near = high ? g->max[a] - x < c->reach : x - g->min[a] < c->reach;
            if (g->periodic[a])
                image = high ? x - width : x + width;
            if (!near)
                continue;
            if (cells_reserve(c, c->n + 1, g->dim) < 0)
                return -1;
            for (int b = 0; b < g->dim; b++)
                c->x[b][c->n] = b == a ? image : c->x[b][i];
            c->n++;
        }
    }
    return 0;
}

static size_t cell_index(const struct cells *c, int a, double x)
{
    double k = floor((x - c->low[a]) / c->width[a]);
    if (!(k > 0))
        return 0;
    return k < (double)(c->side[a] - 1) ? (size_t)k : c->side[a] - 1;
}

static size_t cell_of(const struct cells *c, int dim, size_t i)
{
    size_t cell = 0;
    for (int a = dim - 1; a >= 0; a--)
        cell = cell * c->side[a] + cell_index(c, a, c->x[a][i]);
    return cell;
}

/* Cells as wide as the reach; wider ones where a long thin box would have many more than points. */
static void size_cells(struct cells *c, const struct glass *g)
{
    double side[3] = {1, 1, 1}, most = 4 * (double)c->n + 64;
    for (int a = 0; a < g->dim; a++) {
        c->low[a] = g->min[a] - c->reach;
        c->width[a] = c->reach;
        side[a] = floor((g->max[a] - g->min[a]) / c->reach) + 3;
    }
    while (side[0] * side[1] * side[2] > most) {
        int longest = 0;
        for (int a = 1; a < g->dim; a++)
            longest = side[a] > side[longest] ? a : longest;
        c->width[longest] *= 2;
        side[longest] = floor((g->max[longest] - g->min[longest]) / c->width[longest]) + 3;
    }
    c->n_cell = 1;
    for (int a = 0; a < 3; a++) {
        c->side[a] = (size_t)side[a];
        c->n_cell *= c->side[a];
    }
}

/* A counting sort: within a cell in the order of the points. */
static int sort_cells(struct cells *c, const struct glass *g)
{
    size_cells(c, g);
    if (c->n_cell + 1 > c->begin_capacity) {
        size_t *begin = realloc(c->begin, (c->n_cell + 1) * sizeof *begin);
        if (!begin)
            return -1;
        c->begin = begin;
        c->begin_capacity = c->n_cell + 1;
    }
    memset(c->begin, 0, (c->n_cell + 1) * sizeof *c->begin);
    for (size_t i = 0; i < c->n; i++)
        c->begin[cell_of(c, g->dim, i) + 1]++;
    for (size_t k = 0; k < c->n_cell; k++)
        c->begin[k + 1] += c->begin[k];
    for (size_t i = 0; i < c->n; i++) {
        size_t at = c->begin[cell_of(c, g->dim, i)]++;
        for (int a = 0; a < g->dim; a++)
            c->sorted[a][at] = c->x[a][i];
        c->parent[at] = i < g->n ? i : SIZE_MAX;
    }
    memmove(c->begin + 1, c->begin, c->n_cell * sizeof *c->begin);
    c->begin[0] = 0;
    return 0;
}

static int cells_make(struct cells *c, const struct glass *g)
{
    if (cells_reserve(c, g->n, g->dim) < 0)
        return -1;
    for (int a = 0; a < g->dim; a++)
        memcpy(c->x[a], g->x[a], g->n * sizeof(double));
    c->n = g->n;
    for (int a = 0; a < g->dim; a++)
        if (add_images(c, g, a) < 0)
            return -1;
    return sort_cells(c, g);
}

static void cells_fini(struct cells *c)
{
    for (int a = 0; a < 3; a++) {
        free(c->x[a]);
        free(c->sorted[a]);
    }
    free(c->parent);
    free(c->begin);
}

/* -- Forces ---------------------------------------------------------------------------------- */

/* Adds the push of sources [begin, end) on the point at x; returns the kernel's sum. */
static double push(const struct cells *c, int dim, size_t begin, size_t end, const double x[3],
                   double force[3])
{
    double sum = 0, inverse = 1 / c->reach;
    for (size_t j = begin; j < end; j++) {
        double d[3] = {0, 0, 0}, r2 = 0;
        for (int a = 0; a < dim; a++) {
            d[a] = x[a] - c->sorted[a][j];
            r2 += d[a] * d[a];
        }
        if (r2 >= c->reach * c->reach)
            continue;
        double r = sqrt(r2), q = r * inverse, t = 1 - q;
        sum += t * t * t * t * (1 + 4 * q); /* any smooth bell will do */
        if (r > 0)
            for (int a = 0; a < dim; a++)
                force[a] += t * d[a] / r;
    }
    return sum;
}

/* Force and density of the point that stands at `at` in cell order. */
static double gather(const struct cells *c, int dim, size_t at, double force[3])
{
    double x[3] = {0, 0, 0}, density = 0;
    size_t cell[3] = {0, 0, 0}, low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    for (int a = 0; a < dim; a++) {
        x[a] = c->sorted[a][at];
        cell[a] = cell_index(c, a, x[a]);
        low[a] = cell[a] ? cell[a] - 1 : 0;
        high[a] = cell[a] + 1 < c->side[a] ? cell[a] + 1 : cell[a];
    }
    for (size_t z = low[2]; z <= high[2]; z++)
        for (size_t y = low[1]; y <= high[1]; y++) {
            size_t row = (z * c->side[1] + y) * c->side[0];
            density += push(c, dim, c->begin[row + low[0]], c->begin[row + high[0] + 1], x, force);
        }
    return density;
}

/* Back into the box: around a periodic axis, mirrored at others. */
static double keep_inside(const struct glass *g, int a, double x)
{
    double width = g->max[a] - g->min[a];
    if (g->periodic[a])
        x -= width * floor((x - g->min[a]) / width);
    else if (x < g->min[a])
        x = 2 * g->min[a] - x;
    else if (x > g->max[a])
        x = 2 * g->max[a] - x;
    return x >= g->min[a] && x < g->max[a] ? x : g->min[a];
}

/* One sweep; the noise is that of the positions before it. */
static int sweep(struct relax *s, double rate, double *noise)
{
    struct glass *g = s->g;
    struct cells *c = &s->cells;
    if (cells_make(c, g) < 0)
        return -1;
#pragma omp parallel for schedule(static)
    for (size_t at = 0; at < c->n; at++) {
        size_t i = c->parent[at];
        double force[3] = {0, 0, 0}, length = 0;
        if (i == SIZE_MAX)
            continue;
        s->density[i] = gather(c, g->dim, at, force);
        for (int a = 0; a < g->dim; a++) {
            s->step[a][i] = MOMENTUM * s->step[a][i] + rate * force[a];
            length += s->step[a][i] * s->step[a][i];
        }
        length = sqrt(length);
        double scale = length > LONGEST * s->spacing ? LONGEST * s->spacing / length : 1;
        for (int a = 0; a < g->dim; a++)
            s->step[a][i] *= scale;
    }
    double mean = 0, square = 0;
    for (size_t i = 0; i < g->n; i++)
        mean += s->density[i];
    mean /= (double)g->n;
    for (size_t i = 0; i < g->n; i++)
        square += (s->density[i] - mean) * (s->density[i] - mean);
    *noise = sqrt(square / (double)g->n) / mean;
    return 0;
}

/* -- Relaxation ------------------------------------------------------------------------------ */

static int relax(struct relax *s)
{
    struct glass *g = s->g;
    /* Neighbours within reach of a point: the stiffness that the rate must fit. */
    static const double ball[] = {1, 2, 3.14159265358979, 4.18879020478639};
    double neighbours = ball[g->dim] * pow(s->cells.reach / s->spacing, g->dim);
    double rate = .5 * s->cells.reach / neighbours;
    g->done = 0;
    for (;;) {
        if (sweep(s, rate, &g->reached) < 0)
            return -1;
        if (g->reached <= g->noise || g->done >= g->sweeps)
            return 0;
        for (int a = 0; a < g->dim; a++)
            for (size_t i = 0; i < g->n; i++)
                g->x[a][i] = keep_inside(g, a, g->x[a][i] + s->step[a][i]);
        g->done++;
    }
}

/* Evenly spread, then shaken by up to a spacing: a start by chance alone has long waves of
 * density, which a short-ranged force evens out last. The sequence: multiples of the powers of 1
 * / phi, phi^(d + 1) = phi + 1, modulo 1 (Roberts 2018, after Kronecker). */
static void scatter(struct relax *s)
{
    static const double phi[] = {1, 1.6180339887498949, 1.3247179572447461, 1.2207440846057595};
    struct glass *g = s->g;
    struct random random;
    double shift[3];
    random_init(&random, g->seed);
    for (int a = 0; a < g->dim; a++)
        shift[a] = random_unit(&random);
    for (size_t i = 0; i < g->n; i++)
        for (int a = 0; a < g->dim; a++) {
            double t = shift[a] + (double)(i + 1) * pow(phi[g->dim], -(a + 1));
            double x = g->min[a] + (g->max[a] - g->min[a]) * (t - floor(t));
            double shake = s->spacing * (2 * random_unit(&random) - 1);
            g->x[a][i] = keep_inside(g, a, x + shake);
        }
}

static int start(struct relax *s)
{
    struct glass *g = s->g;
    double volume = 1, narrow = INFINITY;
    for (int a = 0; a < g->dim; a++) {
        volume *= g->max[a] - g->min[a];
        narrow = fmin(narrow, g->max[a] - g->min[a]);
        g->x[a] = calloc(g->n + 1, sizeof(double));
        s->step[a] = calloc(g->n + 1, sizeof(double));
        if (!g->x[a] || !s->step[a])
            return -1;
    }
    s->density = calloc(g->n + 1, sizeof(double));
    if (!s->density)
        return -1;
    s->spacing = pow(volume / (double)g->n, 1. / g->dim);
    s->cells.reach = fmin(REACH * s->spacing, narrow); /* one image a side is enough */
    scatter(s);
    return 0;
}

int glass_make(struct glass *g, struct error *e)
{
    struct relax s = {.g = g};
    int status = start(&s);
    if (!status)
        status = relax(&s);
    cells_fini(&s.cells);
    for (int a = 0; a < 3; a++)
        free(s.step[a]);
    free(s.density);
    if (status < 0) {
        glass_free(g);
        return error_memory(e, "a glass", g->n * 12 * sizeof(double));
    }
    return 0;
}

void glass_free(struct glass *g)
{
    for (int a = 0; a < 3; a++) {
        free(g->x[a]);
        g->x[a] = NULL;
    }
}
