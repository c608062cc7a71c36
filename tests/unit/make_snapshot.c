/* make_snapshot.c -- writes a small snapshot whose contents are known in closed form, for
 * tests/snapshot.py:  make_snapshot FILE [DIM [PER_SIDE]] */
#include "config.h"

#include "io/snapshot.h"
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>

/* Array "fluid": a lattice of n per side with every type of property; "wall": one row without
 * most. */
static int fill(struct particles *fluid, struct particles *wall, int dim, size_t n, struct error *e)
{
    size_t total = 1;
    for (int k = 0; k < dim; k++)
        total *= n;
    if (particles_init(fluid, "fluid", dim, e) || particles_init(wall, "wall", dim, e) ||
        particles_add(fluid, "x", "m", "position", SPH_VECTOR, e) < 0 ||
        particles_add(fluid, "v", "m/s", "velocity", SPH_VECTOR, e) < 0 ||
        particles_add(fluid, "m", "kg", "mass", SPH_SCALAR, e) < 0 ||
        particles_add(fluid, "rho", "kg/m^d", "density", SPH_SCALAR, e) < 0 ||
        particles_add(fluid, "stress", "Pa", "a symmetric tensor", SPH_SYM, e) < 0 ||
        particles_add(fluid, "grad", "1/s", "a matrix", SPH_MATRIX, e) < 0 ||
        particles_add(fluid, "id", "", "number", SPH_INT64, e) < 0 ||
        particles_add(fluid, "kind", "", "number", SPH_INT32, e) < 0 ||
        particles_add(wall, "x", "m", "position", SPH_VECTOR, e) < 0 ||
        particles_add(wall, "rho", "kg/m^d", "density", SPH_SCALAR, e) < 0 ||
        particles_resize(fluid, total, 7, e) || particles_resize(wall, n, 0, e))
        return -1;
    for (size_t i = 0; i < fluid->n_column; i++)
        fluid->column[i].output = true;
    for (size_t i = 0; i < wall->n_column; i++)
        wall->column[i].output = true;
    for (size_t i = 0; i < total; i++) {
        double r2 = 0;
        for (size_t k = 0, rest = i; k < (size_t)dim; k++, rest /= n) {
            const double x = ((double)(rest % n) + 0.5) / (double)n;
            particles_real(fluid, "x", (uint32_t)k)[i] = x;
            particles_real(fluid, "v", (uint32_t)k)[i] = x * (double)(k + 1);
            r2 += x * x;
        }
        particles_real(fluid, "m", 0)[i] = 1.0 / (double)total;
        particles_real(fluid, "rho", 0)[i] = 1 + r2;
        for (uint32_t k = 0; k < property_ncomp(SPH_SYM, dim); k++)
            particles_real(fluid, "stress", k)[i] = (double)i + 0.125 * k;
        for (uint32_t k = 0; k < property_ncomp(SPH_MATRIX, dim); k++)
            particles_real(fluid, "grad", k)[i] = -(double)i - 0.125 * k;
        ((int64_t *)fluid->column[particles_find(fluid, "id")].data)[i] =
            ((int64_t)1 << 60) + (int64_t)i;
        ((int32_t *)fluid->column[particles_find(fluid, "kind")].data)[i] = (int32_t)(i % 3);
    }
    for (size_t i = 0; i < n; i++) {
        particles_real(wall, "x", 0)[i] = ((double)i + 0.5) / (double)n;
        if (dim > 1)
            particles_real(wall, "x", 1)[i] = -0.5 / (double)n;
        particles_real(wall, "rho", 0)[i] = 3;
    }
    return 0;
}

int main(int argc, char **argv)
{
    struct error e = {0};
    struct particles array[2] = {0};
    const int dim = argc > 2 ? atoi(argv[2]) : 2;
    const size_t n = argc > 3 ? strtoul(argv[3], NULL, 10) : 10;
    const struct snapshot_meta meta = {
        .scene_path = "scene.json",
        .scene_text = "{\"title\": \"Größe\"}\n",
        .title = "Größe",
        .units = "SI",
        .version = "0.1",
        .time = 0.6,
        .step = 812,
    };
    if (argc < 2 || dim < 1 || dim > 3) {
        fputs("usage: make_snapshot FILE [DIM [PER_SIDE]]\n", stderr);
        return EXIT_USAGE;
    }
    signal(SIGXFSZ, SIG_IGN);
    int result = fill(&array[0], &array[1], dim, n, &e);
    if (result == 0)
        result = snapshot_write(argv[1], array, 2, &meta, &e);
    if (result)
        fprintf(stderr, "make_snapshot: %s\n", e.text);
    particles_fini(&array[0]);
    particles_fini(&array[1]);
    return result ? e.exit_code : EXIT_DONE;
}
