/* call_per_pair.c -- what a pair costs with a call for each, with the body in the loop, and with both
 * when particles lie in memory without order. 250 047 particles in 3D, 250 000 in 2D, as a disturbed
 * lattice with h = 1.3 spacings, in cell order; one thread.
 *   call_per_pair [SIDE_3D SIDE_2D [PLUGIN.so]] */
#include "call_per_pair.h"
#include "machine.h"

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { REPEATS = 5, FLOPS = 46 /* of a pair in 3D, roots and divisions as one */ };

struct fluid {
    struct pair_case c;
    double *columns; /* x y z, vx vy vz, m rho p h: n each */
    size_t *first;
    uint32_t *neighbour;
};

static uint64_t state = 1;

static double random_unit(void)
{
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(state >> 11) / 9007199254740992.0;
}

static void *need(void *memory)
{
    if (!memory) {
        fputs("no memory\n", stderr);
        exit(1);
    }
    return memory;
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
    double *x = need(malloc(n * (size_t)dim * sizeof(*x)));

    for (size_t i = 0; i < n; i++) {
        size_t rest = i;
        for (int c = dim - 1; c >= 0; c--) {
            const double at = (double)(rest % (size_t)side) + 0.5 + 0.2 * (random_unit() - 0.5);
            x[i * (size_t)dim + (size_t)c] = at / side;
            rest /= (size_t)side;
        }
    }
    return x;
}

/* The place of each point in cell order; the grid's cells are filled. */
static uint32_t *order(struct grid *g, const double *x, uint32_t n)
{
    uint32_t *place = need(malloc(n * sizeof(*place)));
    const size_t count = cells(g), dim = (size_t)g->dim;

    g->start = need(calloc(count + 2, sizeof(*g->start)));
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

static void fill(struct fluid *f, int dim, int side)
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
    f->columns = need(malloc(10 * n * sizeof(*f->columns)));
    uint32_t *place = order(&g, x, c->n);
    for (size_t i = 0; i < n; i++) {
        double *at = f->columns + place[i];
        for (size_t k = 0; k < 3; k++) {
            at[k * n] = k < (size_t)dim ? x[i * (size_t)dim + k] : 0.0;
            at[(3 + k) * n] = random_unit() - 0.5;
        }
        at[6 * n] = dim == 3 ? dx * dx * dx : dx * dx;
        at[7 * n] = 1.0 + 0.01 * random_unit();
        at[8 * n] = random_unit();
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
    f->first = need(malloc((n + 1) * sizeof(*f->first)));
    f->neighbour = need(malloc(n * (dim == 3 ? 100 : 32) * sizeof(*f->neighbour)));
    f->first[0] = 0;
    for (uint32_t i = 0; i < c->n; i++)
        f->first[i + 1] = list_of(f, &g, i, f->first[i]);
    c->first = f->first;
    c->neighbour = f->neighbour;
    free(x);
    free(place);
    free(g.start);
}

static struct pair_rates rates_new(uint32_t n)
{
    const size_t size = n;
    double *all = need(calloc(5 * size, sizeof(*all)));
    return (struct pair_rates){{all, all + size, all + 2 * size}, all + 3 * size, all + 4 * size};
}

/* rms difference of accelerations and density rates, relative; particle k of b was was[k] of a. */
static double difference(const struct pair_rates *a, const struct pair_rates *b, uint32_t n,
                         const uint32_t *was)
{
    double worst = 0.0;

    for (int c = 0; c < 4; c++) {
        const double *of_a = c < 3 ? a->a[c] : a->drho, *of_b = c < 3 ? b->a[c] : b->drho;
        double square = 0.0, size = 0.0;
        for (uint32_t k = 0; k < n; k++) {
            const double value = of_a[was ? was[k] : k];
            square += (of_b[k] - value) * (of_b[k] - value);
            size += value * value;
        }
        if (size > 0.0 && sqrt(square / size) > worst)
            worst = sqrt(square / size);
    }
    return worst;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

struct plugin {
    pair_fn pair;
    pair_kernel_fn kernel;
};

/* All four in turn, several times; returns 1 if their numbers differ. */
static int measure(int dim, int side, struct plugin plugin, const struct machine *machine)
{
    static const char *const name[] = {"a call for each pair", "the body in the loop",
                                       "a call, no order", "in the loop, no order"};
    struct fluid f;
    const uint32_t *was;
    double seconds[4][REPEATS];

    fill(&f, dim, side);
    struct pair_case *shuffled = need(pair_shuffle(&f.c, 7, &was));
    struct pair_rates reference = rates_new(f.c.n), other = rates_new(f.c.n);
    const double pairs = (double)pair_count(&f.c);
    double worst = 0.0;
    for (int k = 0; k < REPEATS; k++) {
        seconds[0][k] = pair_sweep_called(&f.c, &reference, plugin.pair, plugin.kernel);
        seconds[1][k] = pair_sweep_inlined(&f.c, &other);
        worst = fmax(worst, difference(&reference, &other, f.c.n, NULL));
        seconds[2][k] = pair_sweep_called(shuffled, &other, plugin.pair, plugin.kernel);
        worst = fmax(worst, difference(&reference, &other, f.c.n, was));
        seconds[3][k] = pair_sweep_inlined(shuffled, &other);
        worst = fmax(worst, difference(&reference, &other, f.c.n, was));
    }
    printf("%dD, %u particles, %.2f neighbours    ns/pair  us/particle  beside the first", dim,
           f.c.n, pairs / f.c.n);
    printf(dim == 3 ? "  share of the FMA peak\n" : "\n");
    double first = 0.0;
    for (int k = 0; k < 4; k++) {
        qsort(seconds[k], REPEATS, sizeof(double), by_size);
        const double median = seconds[k][REPEATS / 2];
        first = k == 0 ? median : first;
        printf("  %-38s %7.2f %12.3f %17.2f", name[k], 1e9 * median / pairs, 1e6 * median / f.c.n,
               median / first);
        if (dim == 3 && machine->fma_f64 > 0.0)
            printf("%21.1f %%", 1e-7 * FLOPS * pairs / median / machine->fma_f64);
        printf("\n");
    }
    printf("  they differ by %.1e (rms, relative)\n", worst);
    pair_shuffle_free(shuffled);
    free(reference.a[0]);
    free(other.a[0]);
    free(f.columns);
    free(f.first);
    free(f.neighbour);
    return !(worst < 1e-11);
}

static struct plugin find(void *module, int dim)
{
    struct plugin p;
    void *pair = dlsym(module, dim == 3 ? "pair_3" : "pair_2");
    void *kernel = dlsym(module, dim == 3 ? "kernel_3" : "kernel_2");

    /* ISO C has no cast from an object's pointer to a function's. */
    memcpy(&p.pair, &pair, sizeof(pair));
    memcpy(&p.kernel, &kernel, sizeof(kernel));
    return p;
}

int main(int argc, char **argv)
{
    const char *build = getenv("top_builddir");
    char path[4096];
    struct machine machine;

    snprintf(path, sizeof(path), "%s/tests/bench/.libs/call_per_pair_plugin.so",
             build ? build : ".");
    const char *file = argc > 3 ? argv[3] : path;
    void *module = dlopen(file, RTLD_NOW | RTLD_LOCAL);
    if (!module || !find(module, 2).pair || !find(module, 3).kernel) {
        fprintf(stderr, "%s is not that plugin: %s\n", file, dlerror());
        return 1;
    }
    machine_measure(&machine, 1);
    int failed = measure(3, argc > 1 ? atoi(argv[1]) : 63, find(module, 3), &machine);
    failed |= measure(2, argc > 2 ? atoi(argv[2]) : 500, find(module, 2), &machine);
    dlclose(module);
    if (failed)
        printf("the numbers differ\n");
    return failed;
}
