/* fluid.c -- the disturbed lattice, its order in memory, and a list of neighbours for each particle. */
#include "fluid.h"
#include "bench.h"

static uint64_t state = 1;

double fluid_random(void)
{
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(state >> 11) / 9007199254740992.0;
}

/* Cells of the width of the support, row by row. */
struct grid {
    int dim, side;
    double width;
    uint32_t *start; /* of each cell's particles, and where the last one ends */
};

static size_t cells(const struct grid *g)
{
    const size_t side = (size_t)g->side;
    return g->dim == 3 ? side * side * side : side * side;
}

static int cell_coordinate(const struct grid *g, double x)
{
    const int k = (int)(x / g->width);
    return k < 0 ? 0 : k < g->side ? k : g->side - 1;
}

static size_t cell_of(const struct grid *g, const double *x)
{
    size_t cell = 0;

    for (int c = g->dim - 1; c >= 0; c--)
        cell = cell * (size_t)g->side + (size_t)cell_coordinate(g, x[c]);
    return cell;
}

/* A disturbed lattice in the unit box, y and z fastest, so that within a cell x grows. */
static double *disturbed(int dim, int side)
{
    const size_t n = (size_t)side * (size_t)side * (size_t)(dim == 3 ? side : 1);
    double *x = bench_need(malloc(n * (size_t)dim * sizeof(*x)));

    for (size_t i = 0; i < n; i++) {
        size_t rest = i;
        for (int c = dim - 1; c >= 0; c--) {
            const double at = (double)(rest % (size_t)side) + 0.5 + 0.2 * (fluid_random() - 0.5);
            x[i * (size_t)dim + (size_t)c] = at / side;
            rest /= (size_t)side;
        }
    }
    return x;
}

/* The place of each point in cell order; the grid's cells are filled. */
static uint32_t *order(struct grid *g, const double *x, uint32_t n)
{
    uint32_t *place = bench_need(malloc(n * sizeof(*place)));
    const size_t count = cells(g), dim = (size_t)g->dim;

    g->start = bench_need(calloc(count + 2, sizeof(*g->start)));
    for (uint32_t i = 0; i < n; i++)
        g->start[cell_of(g, x + i * dim) + 2]++;
    for (size_t k = 2; k < count + 2; k++)
        g->start[k] += g->start[k - 1];
    for (uint32_t i = 0; i < n; i++)
        place[i] = g->start[cell_of(g, x + i * dim) + 1]++;
    return place;
}

/* Those of particle i, from `end` on; the new end. */
static size_t list_of(const struct fluid *f, const struct grid *g, uint32_t i, size_t end)
{
    const struct pair_case *c = &f->c;
    int low[3] = {0}, high[3] = {0};

    for (int k = 0; k < c->dim; k++) {
        const int at = cell_coordinate(g, c->x[k][i]);
        low[k] = at > 0 ? at - 1 : 0;
        high[k] = at < g->side - 1 ? at + 1 : at;
    }
    for (int z = low[2]; z <= high[2]; z++) {
        for (int y = low[1]; y <= high[1]; y++) {
            const size_t row = ((size_t)z * (size_t)g->side + (size_t)y) * (size_t)g->side;
            for (uint32_t j = g->start[row + (size_t)low[0]];
                 j < g->start[row + (size_t)high[0] + 1]; j++) {
                double r2 = 0.0;
                for (int k = 0; k < c->dim; k++)
                    r2 += (c->x[k][i] - c->x[k][j]) * (c->x[k][i] - c->x[k][j]);
                if (j != i && r2 < 4.0 * c->h[i] * c->h[i])
                    f->neighbour[end++] = j;
            }
        }
    }
    return end;
}

void fluid_fill(struct fluid *f, int dim, int side)
{
    const double dx = 1.0 / side, h = 1.3 * dx;
    struct grid g = {.dim = dim, .side = (int)(1.0 / (2.0 * h)), .width = 0.0};
    struct pair_case *c = &f->c;
    double *x = disturbed(dim, side);

    g.side = g.side > 0 ? g.side : 1;
    g.width = 1.0 / g.side;
    *c = (struct pair_case){.dim = dim, .cs = 10.0, .alpha = 0.1, .beta = 0.0};
    c->n = (uint32_t)(side * side * (dim == 3 ? side : 1));
    const size_t n = c->n;
    f->columns = bench_need(malloc(10 * n * sizeof(*f->columns)));
    uint32_t *place = order(&g, x, c->n);
    for (size_t i = 0; i < n; i++) {
        double *at = f->columns + place[i];
        for (size_t k = 0; k < 3; k++) {
            at[k * n] = k < (size_t)dim ? x[i * (size_t)dim + k] : 0.0;
            at[(3 + k) * n] = fluid_random() - 0.5;
        }
        at[6 * n] = dim == 3 ? dx * dx * dx : dx * dx;
        at[7 * n] = 1.0 + 0.01 * fluid_random();
        at[8 * n] = fluid_random();
        at[9 * n] = h;
    }
    for (size_t k = 0; k < 3; k++) {
        c->x[k] = f->columns + k * n;
        c->v[k] = f->columns + (3 + k) * n;
    }
    c->m = f->columns + 6 * n;
    c->rho = f->columns + 7 * n;
    c->p = f->columns + 8 * n;
    c->h = f->columns + 9 * n;
    /* With room for the densest places of such a lattice. */
    f->first = bench_need(malloc((n + 1) * sizeof(*f->first)));
    f->neighbour = bench_need(malloc(n * (dim == 3 ? 100 : 32) * sizeof(*f->neighbour)));
    f->first[0] = 0;
    for (uint32_t i = 0; i < c->n; i++)
        f->first[i + 1] = list_of(f, &g, i, f->first[i]);
    c->first = f->first;
    c->neighbour = f->neighbour;
    free(x);
    free(place);
    free(g.start);
}

void fluid_free(struct fluid *f)
{
    free(f->columns);
    free(f->first);
    free(f->neighbour);
}

struct pair_rates fluid_rates(uint32_t n)
{
    const size_t size = n;
    double *all = bench_need(calloc(5 * size, sizeof(*all)));
    return (struct pair_rates){{all, all + size, all + 2 * size}, all + 3 * size, all + 4 * size};
}

void fluid_rates_free(struct pair_rates *r)
{
    free(r->a[0]);
}
