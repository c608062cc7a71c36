/* density.c -- density summation solved together with the smoothing length: h = eta (m / rho(h))^(1/d), by
 * Newton's method from the h of the last evaluation, kept within 0.7 and 1.4 of it a sweep. */
#include "gsph.h"
#include <math.h>

enum { M, H, RHO, OMEGA, BUSY };
enum { ETA, TOLERANCE };

static const sph_param params[] = {
    {"eta", "", "smoothing length in units of (m / rho)^(1/d)", 1.3, 1.0, 4.0, NULL},
    {"h_tolerance", "", "relative change of h at which its iteration ends", 1e-6, 1e-15, 1e-2, NULL},
};

static const sph_prop props[] = {
    {"m", "kg", "mass", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN},
    {"h", "m", "smoothing length", SPH_SCALAR, SPH_DST_UPDATE, NAN},
    {"rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_SUM, 0.0},
    {"omega", "", "grad-h correction: 1 + (h / (d rho)) d rho / d h", SPH_SCALAR, SPH_DST_SUM, 0.0},
    {"h_busy", "", "1 while the iteration of h goes on", SPH_INT32, SPH_DST_WRITE, 0.0},
};

#define SPH_LOOP sweep
#define SPH_LOOP_J(S, V, MAT) S(m, M)
#define SPH_LOOP_SUM(S, V, MAT) S(rho, RHO) S(omega, OMEGA)
#define SPH_LOOP_REACH SPH_GATHER
#define SPH_LOOP_SELF 1
#define SPH_LOOP_BODY "density.body.h"
#include <sph/pair-loop.h>

/* From the sums to the next h; a particle that is done keeps its h, so that its sums stay right. */
static sph_status update(const sph_batch *b)
{
    const double eta = b->param[ETA], tolerance = b->param[TOLERANCE], d = b->dim;
    const double *m = gsph_plane(&b->dst[M], 0);
    double *h = gsph_plane(&b->dst[H], 0), *rho = gsph_plane(&b->dst[RHO], 0);
    double *omega = gsph_plane(&b->dst[OMEGA], 0);
    int32_t *busy = b->dst[BUSY].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        double wanted = m[i] * pow(eta / h[i], d); /* the density that fits this h */
        double slope = -d * wanted / h[i] - omega[i];
        double next = h[i] - (wanted - rho[i]) / slope;
        if (!(next > 0.7 * h[i]))
            next = 0.7 * h[i];
        if (next > 1.4 * h[i])
            next = 1.4 * h[i];
        busy[i] = fabs(next - h[i]) > tolerance * h[i];
        omega[i] = 1.0 + h[i] / (d * rho[i]) * omega[i];
        if (busy[i])
            h[i] = next;
    }
    return SPH_OK;
}

static const sph_item item = {
    SIZE(sph_item),
    SPH_ALL_DIMS,
    "gsph-density",
    "density summation, solved together with the smoothing length",
    "Springel & Hernquist 2002, doi:10.1046/j.1365-8711.2002.05445.x, eq. 7-8",
    SPH_LIST(params),
    SPH_LIST(props),
};

const sph_function gsph_density = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .run = sweep,
    .after = update,
    .reach = SPH_GATHER,
    .max_sweeps = 50,
    .unfinished = "h_busy",
    .reach_scale = 1.0,
};
