/* momentum.c -- acceleration by pressure, artificial viscosity and gravity, and the time step that they
 * allow. */
#include "wcsph.h"
#include <math.h>

enum { M, V, RHO, P_RHO2, CS, DRHO, A, DT };
enum { ALPHA, BETA, GRAVITY };

static const sph_param params[] = {WCSPH_VISCOSITY, WCSPH_GRAVITY};

static const sph_prop props[] = {
    WCSPH_M,   WCSPH_V,
    WCSPH_RHO, WCSPH_P_RHO2(WCSPH_READ | SPH_DST_SWEEP),
    WCSPH_CS,  SPH_PROP("drho", "kg/m^d/s", "rate of the density", SPH_SCALAR, SPH_DST_READ, 0.0),
    WCSPH_A,   WCSPH_DT,
};

#define SPH_LOOP sweep
#define SPH_LOOP_I(S, V_, M_) V_(v, V) S(rho, RHO) S(p_rho2, P_RHO2) S(cs, CS)
#define SPH_LOOP_J(S, V_, M_) S(m, M) SPH_LOOP_I(S, V_, M_)
#define SPH_LOOP_SUM(S, V_, M_) V_(a, A)
#define SPH_LOOP_PARAM(P_) P_(alpha, ALPHA) P_(beta, BETA)
#define SPH_LOOP_BODY "momentum.body.h"
#define SPH_LOOP_F32
/* Runs seldom: rates.c stands in for it. */
#define SPH_LOOP_ANY_KERNEL
#define SPH_LOOP_DEVICE wcsph_momentum_device
#include <sph/pair-loop.h>

enum { PIECE = 64 };

/* Adds gravity; a2: the square of the whole. */
static void add_gravity(const sph_batch *b, const struct wcsph_finish *at, uint64_t first, int n,
                        double *restrict a2)
{
    for (int k = 0; k < n; k++)
        a2[k] = 0.0;
    for (uint32_t c = 0; c < b->dim; c++) {
        const double g = b->param[at->gravity + c];
        double *restrict a = (double *)b->dst[at->a].data + (size_t)c * b->dst[at->a].plane + first;
        for (int k = 0; k < n; k++) {
            a[k] += g;
            a2[k] += a[k] * a[k];
        }
    }
}

/* Of n particles: whether the force's bound is the smaller one anywhere. */
static int is_forced(const double *restrict h, const double *restrict a2, const double *restrict dt,
                     int n)
{
    int forced = 0;
    for (int k = 0; k < n; k++) {
        const double square = dt[k] * dt[k];
        forced |= h[k] * h[k] < square * square * a2[k];
    }
    return forced;
}

/* Viscosity's bound is Monaghan's (1989, J. Comput. Phys. 82, 1, eq. 3.4) with |mu| <= h |div v|, of which
 * the continuity equation has just given -drho / rho; the force's is sqrt(h / |a|), in units of which the
 * scene's cfl is meant: the roots are taken where it matters. In pieces, so that several particles are
 * worked on at once. */
sph_status wcsph_finish(const sph_batch *b, const struct wcsph_finish *at)
{
    const double alpha = b->param[at->alpha], beta = b->param[at->beta];
    const double of_cs = 1.0 + 0.6 * alpha, of_mu = 1.0 + 0.6 * beta;
    double a2[PIECE];
    for (uint64_t i = b->first, end = b->first + b->count; i < end; i += PIECE) {
        const double *h = (const double *)b->h_dst.data + i;
        const double *rho = (const double *)b->dst[at->rho].data + i;
        const double *cs = (const double *)b->dst[at->cs].data + i;
        const double *drho = (const double *)b->dst[at->drho].data + i;
        double *restrict dt = (double *)b->dst[at->dt].data + i;
        const int n = end - i < PIECE ? (int)(end - i) : PIECE;
        add_gravity(b, at, i, n, a2);
        for (int k = 0; k < n; k++)
            dt[k] = h[k] * rho[k] / (of_cs * cs[k] * rho[k] + of_mu * h[k] * fabs(drho[k]));
        if (is_forced(h, a2, dt, n))
            for (int k = 0; k < n; k++)
                dt[k] = fmin(dt[k], sqrt(h[k] / sqrt(a2[k])));
    }
    return SPH_OK;
}

static sph_status finish(const sph_batch *b)
{
    static const struct wcsph_finish at = {RHO, CS, DRHO, A, DT, ALPHA, BETA, GRAVITY};
    return wcsph_finish(b, &at);
}

static const sph_rate rates[] = {
    SPH_RATE("v", "a", SPH_KICK),
};

static const sph_reduction reductions[] = {WCSPH_REDUCTIONS};

static const sph_item item = {
    .size = SIZE(sph_item),
    .dims = SPH_ALL_DIMS,
    .name = "wcsph-momentum",
    .doc = "acceleration by pressure, artificial viscosity and gravity",
    .source = "Monaghan 1992, doi:10.1146/annurev.aa.30.090192.002551, eq. 3.1, 4.1-4.2",
    .params = SPH_LIST(params),
    .props = SPH_LIST(props),
};

const sph_function wcsph_momentum = {
    .size = SIZE(sph_function),
    .shape = SPH_PAIR,
    .item = &item,
    .run = sweep,
    .after = finish,
    .reach = SPH_SYMMETRIC,
    .reach_scale = 1.0,
    .rates = SPH_LIST(rates),
    .reductions = SPH_LIST(reductions),
    .device = &wcsph_momentum_device,
    .reals = SPH_F64 | SPH_F32,
};
