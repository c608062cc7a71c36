/* gradients.c -- gradients of density, pressure and velocity, exact for linear fields: differences weighted
 * with the kernel's slope, times the inverse of their moment matrix. */
#include "gsph.h"
#include <math.h>

enum { M, RHO, P, V, GRHO, GP, GV, MOMENT, SPREAD };
enum { SHARE };

static const sph_param params[] = {
    SPH_PARAM("volume_share", "",
              "how much of the gradients' volume correction the forces take: 0 none, 1 all", 0.4,
              0.0, 1.0),
};

static const sph_prop props[] = {
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_SRC_READ, NAN),
    SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN),
    SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ | SPH_DST_SWEEP,
             NAN),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_READ | SPH_SRC_READ | SPH_DST_SWEEP, 0.0),
    SPH_PROP("grad_rho", "kg/m^(d+1)", "gradient of the density", SPH_VECTOR,
             SPH_DST_SUM | SPH_WORK, 0.0),
    SPH_PROP("grad_p", "J/m^(d+1)", "gradient of the pressure", SPH_VECTOR, SPH_DST_SUM | SPH_WORK,
             0.0),
    SPH_PROP("grad_v", "1/s", "velocity gradient, a row a component", SPH_MATRIX,
             SPH_DST_SUM | SPH_WORK, 0.0),
    SPH_PROP("moment", "", "moment matrix of the gradients", SPH_MATRIX, SPH_DST_SUM | SPH_WORK,
             0.0),
    SPH_PROP("volume", "", "volume correction of the forces", SPH_SCALAR, SPH_DST_SUM | SPH_WORK,
             0.0),
};

#define SPH_LOOP sweep
#define SPH_LOOP_I(S, V_, M_) S(rho, RHO) S(p, P) V_(v, V)
#define SPH_LOOP_J(S, V_, M_) S(m, M) S(rho, RHO) S(p, P) V_(v, V)
#define SPH_LOOP_SUM(S, V_, M_)                                                                    \
    V_(grho, GRHO) V_(gp, GP) M_(gv, GV) M_(moment, MOMENT) S(spread, SPREAD)
#define SPH_LOOP_REACH SPH_GATHER
#define SPH_LOOP_BODY "gradients.body.h"
#define SPH_LOOP_F32
#define SPH_LOOP_DEVICE gradients_device
#include <sph/pair-loop.h>

/* Inverse of a symmetric positive matrix of one to three rows, by cofactors; the ridge keeps a particle with
 * too few neighbours finite, its gradient small. */
static void invert(uint32_t d, double a[9], double out[9])
{
    double trace = 0.0;
    for (uint32_t k = 0; k < d; k++)
        trace += a[k * d + k];
    for (uint32_t k = 0; k < d; k++)
        a[k * d + k] += 1e-10 * trace + 1e-300;
    if (d == 1) {
        out[0] = 1.0 / a[0];
    } else if (d == 2) {
        double s = 1.0 / (a[0] * a[3] - a[1] * a[2]);
        out[0] = s * a[3];
        out[1] = -s * a[1];
        out[2] = -s * a[2];
        out[3] = s * a[0];
    } else {
        double c[9];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                c[3 * j + i] =
                    a[3 * ((i + 1) % 3) + (j + 1) % 3] * a[3 * ((i + 2) % 3) + (j + 2) % 3] -
                    a[3 * ((i + 1) % 3) + (j + 2) % 3] * a[3 * ((i + 2) % 3) + (j + 1) % 3];
        double s = 1.0 / (a[0] * c[0] + a[1] * c[3] + a[2] * c[6]);
        for (int k = 0; k < 9; k++)
            out[k] = s * c[k];
    }
}

/* g = inverse * g, for the vector that stands in planes first, first + 1, ... of a column. */
static void multiply(const sph_column *column, uint32_t first, uint64_t i, uint32_t d,
                     const double *inverse)
{
    double g[3] = {0.0, 0.0, 0.0};
    for (uint32_t a = 0; a < d; a++)
        for (uint32_t c = 0; c < d; c++)
            g[a] += inverse[a * d + c] * gsph_plane(column, first + c)[i];
    for (uint32_t a = 0; a < d; a++)
        gsph_plane(column, first + a)[i] = g[a];
}

static sph_status correct(const sph_batch *b)
{
    const uint32_t d = b->dim;
    const double *rho = gsph_plane(&b->dst[RHO], 0);
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        double moment[9], inverse[9];
        for (uint32_t k = 0; k < d * d; k++)
            moment[k] = gsph_plane(&b->dst[MOMENT], k)[i];
        double trace = 0.0;
        for (uint32_t k = 0; k < d; k++)
            trace += moment[k * d + k];
        /* Both are sums of -r w'(q): one over the neighbours' volumes, one over the particle's own. */
        double *volume = gsph_plane(&b->dst[SPREAD], 0) + i;
        *volume = trace > 0.0 ? 1.0 + b->param[SHARE] * (*volume / (rho[i] * trace) - 1.0) : 1.0;
        if (!(trace > 0.0)) /* nobody is near: the sums are 0, and so are the gradients */
            continue;
        invert(d, moment, inverse);
        multiply(&b->dst[GRHO], 0, i, d, inverse);
        multiply(&b->dst[GP], 0, i, d, inverse);
        for (uint32_t c = 0; c < d; c++)
            multiply(&b->dst[GV], c * d, i, d, inverse);
    }
    return SPH_OK;
}

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "gsph-gradients",
    .doc = "gradients of density, pressure and velocity for the reconstruction",
    .source = "exact for linear fields by matrix inversion, as Garcia-Senz et al. 2012, "
              "doi:10.1051/0004-6361/201117939, eq. 5-7",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_function gsph_gradients = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .run = sweep,
    .after = correct,
    .reach = SPH_GATHER,
    .reach_scale = 1.0,
    .device = &gradients_device,
    .reals = SPH_F64 | SPH_F32,
};
