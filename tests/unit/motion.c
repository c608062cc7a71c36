/* motion.c -- see motion.h. */
#include "config.h"

#include "motion.h"

#include "../walk.h"
#include <math.h>
#include <string.h>

#define SIZE(type) ((uint32_t)sizeof(type))

#define FUNCTION(variable, name, params)                                                           \
    static const sph_item variable##_item = {                                                      \
        SIZE(sph_item), SPH_ALL_DIMS, name, "a mock", "", params, SPH_LIST(variable##_props)};     \
    static const sph_function variable

static double *at(const sph_column *column, uint32_t c)
{
    return (double *)column->data + c * column->plane;
}

/* -- Point functions ----------------------------------------------------------------------------- */

static sph_status spring_run(const sph_batch *b)
{
    for (uint32_t c = 0; c < b->dim; c++)
        for (uint64_t i = b->first; i < b->first + b->count; i++)
            at(&b->dst[2], c)[i] = -at(&b->dst[0], c)[i] - b->param[0] * at(&b->dst[1], c)[i];
    return SPH_OK;
}

static const sph_param spring_params[] = {SPH_PARAM("damping", "", "", 0, 1, 0)};
static const sph_prop spring_props[] = {
    {"x", "", "", SPH_VECTOR, SPH_DST_READ, 0},
    {"v", "", "", SPH_VECTOR, SPH_DST_READ, 0},
    {"a", "", "", SPH_VECTOR, SPH_DST_WRITE, 0},
};
static const sph_rate spring_rates[] = {{"v", "a", SPH_KICK, 0}};
FUNCTION(spring, "spring", SPH_LIST(spring_params)) = {.size = SIZE(sph_function),
                                                       .shape = SPH_POINT,
                                                       .item = &spring_item,
                                                       .run = spring_run,
                                                       .reach_scale = 1,
                                                       .rates = SPH_LIST(spring_rates)};

static sph_status pull_run(const sph_batch *b)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        at(&b->dst[0], 0)[i] += 1, at(&b->dst[1], 0)[i] += 1;
    return SPH_OK;
}

static const sph_prop pull_props[] = {
    {"a", "", "", SPH_VECTOR, SPH_DST_SUM, 0.25},
    {"pulled", "", "", SPH_SCALAR, SPH_DST_SUM, 0},
    {"v", "", "", SPH_VECTOR, SPH_DST_READ, 0},
};
FUNCTION(pull, "pull", SPH_NO_LIST) = {.size = SIZE(sph_function),
                                       .shape = SPH_POINT,
                                       .item = &pull_item,
                                       .run = pull_run,
                                       .reach_scale = 1,
                                       .rates = SPH_LIST(spring_rates)};

static sph_status bound_run(const sph_batch *b)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        at(&b->dst[0], 0)[i] = b->param[b->time < 0.5 ? 0 : 1];
    return SPH_OK;
}

static const sph_param bound_params[] = {SPH_PARAM("early", "", "", 0.1, 1, 0),
                                         SPH_PARAM("late", "", "", 0.1, 1, 0)};
static const sph_prop bound_props[] = {{"dt", "", "", SPH_SCALAR, SPH_DST_WRITE, 0}};
static const sph_reduction bound_reductions[] = {{"dt", "dt", SPH_REDUCE_MIN, SPH_USE_TIME_STEP}};
FUNCTION(bound, "bound", SPH_LIST(bound_params)) = {.size = SIZE(sph_function),
                                                    .shape = SPH_POINT,
                                                    .item = &bound_item,
                                                    .run = bound_run,
                                                    .reach_scale = 1,
                                                    .reductions = SPH_LIST(bound_reductions)};

static sph_status nothing(const sph_batch *b)
{
    (void)b;
    return SPH_OK;
}

static const sph_prop measure_props[] = {{"value", "", "", SPH_SCALAR, SPH_DST_READ, 1}};
static const sph_reduction measure_reductions[] = {
    {"least", "value", SPH_REDUCE_MIN, SPH_USE_NONE},
    {"most", "value", SPH_REDUCE_MAX, SPH_USE_NONE},
    {"total", "value", SPH_REDUCE_SUM, SPH_USE_NONE},
    {"bound", "value", SPH_REDUCE_MIN, SPH_USE_TIME_STEP},
};
FUNCTION(measure, "measure", SPH_NO_LIST) = {.size = SIZE(sph_function),
                                             .shape = SPH_POINT,
                                             .item = &measure_item,
                                             .run = nothing,
                                             .reach_scale = 1,
                                             .reductions = SPH_LIST(measure_reductions)};

static sph_status count_up_run(const sph_batch *b)
{
    int32_t *again = b->dst[2].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        at(&b->dst[1], 0)[i] += 1;
        again[i] = at(&b->dst[1], 0)[i] < at(&b->dst[0], 0)[i];
    }
    return SPH_OK;
}

static const sph_prop count_up_props[] = {
    {"need", "", "", SPH_SCALAR, SPH_DST_READ, 1},
    {"done", "", "", SPH_SCALAR, SPH_DST_UPDATE, 0},
    {"again", "", "", SPH_INT32, SPH_DST_WRITE, 0},
};
FUNCTION(count_up, "count-up", SPH_NO_LIST) = {.size = SIZE(sph_function),
                                               .shape = SPH_POINT,
                                               .item = &count_up_item,
                                               .run = count_up_run,
                                               .max_sweeps = 6,
                                               .unfinished = "again",
                                               .reach_scale = 1};

static sph_status breathe_run(const sph_batch *b)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        at(&b->dst[0], 0)[i] =
            at(&b->dst[1], 0)[i] * (1 + b->param[0] * sin(9 * b->time + at(&b->dst[2], 0)[i]));
    return SPH_OK;
}

static const sph_param breathe_params[] = {SPH_PARAM("depth", "", "", 0.05, 1, 0)};
static const sph_prop breathe_props[] = {
    {"h", "", "", SPH_SCALAR, SPH_DST_WRITE, NAN},
    {"h0", "", "", SPH_SCALAR, SPH_DST_READ, NAN},
    {"colour", "", "", SPH_SCALAR, SPH_DST_READ, 0},
};
FUNCTION(breathe, "breathe", SPH_LIST(breathe_params)) = {.size = SIZE(sph_function),
                                                          .shape = SPH_POINT,
                                                          .item = &breathe_item,
                                                          .run = breathe_run,
                                                          .reach_scale = 1};

static sph_status shade_run(const sph_batch *b)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        at(&b->dst[2], 0)[i] = at(&b->dst[0], 0)[i] + b->time;
    for (uint32_t c = 0; c < b->dim; c++)
        for (uint64_t i = b->first; i < b->first + b->count; i++)
            at(&b->dst[3], c)[i] = at(&b->dst[1], c)[i] + (c == 0 ? b->time : 0);
    return SPH_OK;
}

static const sph_prop shade_props[] = {
    {"colour", "", "", SPH_SCALAR, SPH_DST_READ, 0},
    {"v", "", "", SPH_VECTOR, SPH_DST_READ, 0},
    {"q", "", "", SPH_SCALAR, SPH_DST_WRITE, 0},
    {"w", "", "", SPH_VECTOR, SPH_DST_WRITE, 0},
};
FUNCTION(shade, "shade", SPH_NO_LIST) = {.size = SIZE(sph_function),
                                         .shape = SPH_POINT,
                                         .item = &shade_item,
                                         .run = shade_run,
                                         .reach_scale = 1};

/* -- Pair functions ------------------------------------------------------------------------------ */

static double distance(const sph_batch *b, uint64_t i, uint64_t j)
{
    double r2 = 0;
    for (uint32_t c = 0; c < b->dim; c++) {
        const double d = at(&b->x_dst, c)[i] - at(&b->x_src, c)[j];
        r2 += d * d;
    }
    return sqrt(r2);
}

static double weight(double r, double reach)
{
    return r < reach ? (1 - r / reach) * (1 - r / reach) : 0;
}

static sph_status gather_run(const sph_batch *b)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        for (struct walk w = walk_begin(b, i); walk_next(&w);) {
            const uint64_t j = w.j;
            const double f = weight(distance(b, i, j), MOTION_SUPPORT * at(&b->h_dst, 0)[i]);
            const double mf = at(&b->src[0], 0)[j] * f;
            at(&b->dst[3], 0)[i] += mf * at(&b->src[1], 0)[j];
            for (uint32_t c = 0; c < b->dim; c++)
                at(&b->dst[4], c)[i] += mf * at(&b->src[2], c)[j];
        }
    return SPH_OK;
}

static const sph_prop gather_props[] = {
    {"m", "", "", SPH_SCALAR, SPH_SRC_READ, NAN}, {"q", "", "", SPH_SCALAR, SPH_SRC_READ, NAN},
    {"w", "", "", SPH_VECTOR, SPH_SRC_READ, NAN}, {"s", "", "", SPH_SCALAR, SPH_DST_SUM, 0},
    {"sv", "", "", SPH_VECTOR, SPH_DST_SUM, 0},
};
FUNCTION(gather, "gather", SPH_NO_LIST) = {.size = SIZE(sph_function),
                                           .shape = SPH_PAIR,
                                           .item = &gather_item,
                                           .run = gather_run,
                                           .reach = SPH_GATHER,
                                           .reach_scale = 1};

static sph_status wide_run(const sph_batch *b)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        for (struct walk w = walk_begin(b, i); walk_next(&w);) {
            const uint64_t j = w.j;
            const double h = fmax(at(&b->h_dst, 0)[i], at(&b->h_src, 0)[j]);
            at(&b->dst[2], 0)[i] += at(&b->src[0], 0)[j] * at(&b->src[1], 0)[j] *
                                    weight(distance(b, i, j), MOTION_SUPPORT * h);
        }
    return SPH_OK;
}

static const sph_prop wide_props[] = {
    {"m", "", "", SPH_SCALAR, SPH_SRC_READ, NAN},
    {"q", "", "", SPH_SCALAR, SPH_SRC_READ, NAN},
    {"both", "", "", SPH_SCALAR, SPH_DST_SUM, 0},
};
FUNCTION(wide, "gather-both", SPH_NO_LIST) = {.size = SIZE(sph_function),
                                              .shape = SPH_PAIR,
                                              .item = &wide_item,
                                              .run = wide_run,
                                              .reach = SPH_SYMMETRIC,
                                              .reach_scale = 1};

static sph_status widen_run(const sph_batch *b)
{
    if (!b->dst[3].data)
        return SPH_E_INVALID;
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        for (struct walk w = walk_begin(b, i); walk_next(&w);)
            at(&b->dst[1], 0)[i] += distance(b, i, w.j) < MOTION_SUPPORT * at(&b->dst[0], 0)[i];
    return SPH_OK;
}

static sph_status widen_after(const sph_batch *b)
{
    int32_t *again = b->dst[2].data;
    if (b->dst[3].data) /* for the sweep alone */
        return SPH_E_INVALID;
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        again[i] = at(&b->dst[1], 0)[i] < b->param[0];
        if (again[i])
            at(&b->dst[0], 0)[i] *= 4.0 / 3;
    }
    return SPH_OK;
}

static const sph_param widen_params[] = {SPH_PARAM("enough", "", "", 1, 1, 0)};
static const sph_prop widen_props[] = {
    {"h", "", "", SPH_SCALAR, SPH_DST_UPDATE, NAN},
    {"found", "", "", SPH_SCALAR, SPH_DST_SUM, 0},
    {"again", "", "", SPH_INT32, SPH_DST_WRITE, 0},
    {"rho", "", "", SPH_SCALAR, SPH_DST_READ | SPH_DST_SWEEP, 0},
};
FUNCTION(widen, "widen", SPH_LIST(widen_params)) = {.size = SIZE(sph_function),
                                                    .shape = SPH_PAIR,
                                                    .item = &widen_item,
                                                    .run = widen_run,
                                                    .after = widen_after,
                                                    .reach = SPH_GATHER,
                                                    .max_sweeps = 20,
                                                    .unfinished = "again",
                                                    .reach_scale = 1};

/* -- Schemes ------------------------------------------------------------------------------------- */

static const sph_rate rates[] = {{"x", "v", SPH_DRIFT, 0}};
static const sph_step swing_steps[] = {SPH_STEP(SPH_AT_EVALUATE, "spring")};
static const sph_step coast_steps[] = {SPH_STEP(SPH_AT_EVALUATE, "shade")};
static const sph_item swing_item = {SIZE(sph_item), SPH_ALL_DIMS, "swing", "a mock", "",
                                    SPH_NO_LIST,    SPH_NO_LIST};
static const sph_item coast_item = {SIZE(sph_item), SPH_ALL_DIMS, "coast", "a mock", "",
                                    SPH_NO_LIST,    SPH_NO_LIST};
static const sph_scheme swing = {SIZE(sph_scheme),
                                 0,
                                 &swing_item,
                                 "thing",
                                 "kdk",
                                 0.25,
                                 SPH_LIST(swing_steps),
                                 SPH_LIST(rates),
                                 0,
                                 0};
static const sph_scheme coast = {SIZE(sph_scheme),
                                 0,
                                 &coast_item,
                                 "thing",
                                 "kdk",
                                 0.25,
                                 SPH_LIST(coast_steps),
                                 SPH_LIST(rates),
                                 0,
                                 0};

const struct rig_items motion_items = {
    {&spring, &pull, &bound, &measure, &count_up, &breathe, &shade, &gather, &wide, &widen, NULL},
    {NULL},
    {&swing, &coast, NULL},
    {NULL},
    NULL};

/* -- The same by hand ---------------------------------------------------------------------------- */

/* The columns of an array, looked up once. */
struct view {
    const double *x[3], *h, *m, *q, *w[3];
    size_t n;
};

static struct view view(const struct run *r, size_t a)
{
    const struct particles *p = &r->plan->array[a].p;
    struct view v = {.n = p->n,
                     .h = particles_real(p, "h", 0),
                     .m = particles_real(p, "m", 0),
                     .q = particles_real(p, "q", 0)};
    for (int c = 0; c < p->dim; c++) {
        v.x[c] = particles_real(p, "x", (uint32_t)c);
        v.w[c] = particles_real(p, "w", (uint32_t)c);
    }
    return v;
}

/* Image `k` (0: itself, 1, 2: across the low, the high side) of x along an axis; *sign of the component of a
 * vector. False: there is none. */
static bool image(const struct box *box, int axis, int k, double *x, double *sign)
{
    *sign = 1;
    if (k == 0)
        return true;
    const enum side side = box->bounded ? box->side[axis][k - 1] : SIDE_OPEN;
    const double length = box->max[axis] - box->min[axis];
    if (side == SIDE_PERIODIC)
        *x += k == 1 ? -length : length;
    else if (side == SIDE_MIRROR) {
        *x = 2 * (k == 1 ? box->min[axis] : box->max[axis]) - *x;
        *sign = -1;
    }
    return side != SIDE_OPEN;
}

struct sum {
    double s, sv[3];
};

/* Adds what particle j of `src` and all its images give to particle i of `dst`. */
static void add_images(const struct run *r, bool both, const struct view *dst, size_t i,
                       const struct view *src, size_t j, struct sum *sum)
{
    const int dim = r->plan->dim;
    const int images = dim == 1 ? 3 : dim == 2 ? 9 : 27;
    const double h = both ? fmax(dst->h[i], src->h[j]) : dst->h[i];
    for (int k = 0; k < images; k++) {
        double r2 = 0, sign[3];
        bool there = true;
        for (int c = 0, rest = k; c < dim; c++, rest /= 3) {
            double x = src->x[c][j];
            there = image(&r->plan->scene->box, c, rest % 3, &x, &sign[c]) && there;
            r2 += (dst->x[c][i] - x) * (dst->x[c][i] - x);
        }
        if (!there)
            continue;
        const double mf = src->m[j] * weight(sqrt(r2), MOTION_SUPPORT * h);
        sum->s += mf * src->q[j];
        for (int c = 0; c < dim; c++)
            sum->sv[c] += sign[c] * mf * src->w[c][j];
    }
}

double motion_error(const struct run *r, bool both, size_t dst, const size_t *src, size_t n_src)
{
    const struct view to = view(r, dst);
    const struct particles *p = &r->plan->array[dst].p;
    const double *s = particles_real(p, both ? "both" : "s", 0);
    double worst = 0, scale = 0;
    for (size_t i = 0; i < to.n; i++) {
        struct sum sum = {0};
        for (size_t k = 0; k < n_src; k++) {
            const struct view from = view(r, src[k]);
            for (size_t j = 0; j < from.n; j++)
                add_images(r, both, &to, i, &from, j, &sum);
        }
        const double error = fabs(sum.s - s[i]);
        worst = isnan(error) || error > worst ? error : worst; /* a NaN stays */
        scale = fmax(scale, fabs(sum.s));
        for (int c = 0; !both && c < r->plan->dim; c++) {
            const double vector = fabs(sum.sv[c] - particles_real(p, "sv", (uint32_t)c)[i]);
            worst = isnan(vector) || vector > worst ? vector : worst;
        }
    }
    return worst / scale;
}
