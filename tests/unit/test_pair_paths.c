/* test_pair_paths.c -- the loops that pair-loop.h makes, by every path and in both precisions,
 * against the plain loop in long doubles: random clouds of one to three dimensions with odd numbers
 * of particles, some of them in one place; gather and symmetric reach; kernels that are compiled in,
 * a spline of two pieces, a table; one smoothing length and many; sources far apart in memory. */
#include "config.h"

#include "paths.h"
#include "registry/kernel_form.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Of the sum of absolute terms, or of SHARE of the largest of those: a destination whose neighbours
 * are all at the kernel's edge has small terms, with few digits. */
#define BAR_F64 1e-14
#define BAR_F32 2e-6
#define SHARE 1e-2
#define START 0.125
#define QUANTUM 0x1p-24 /* 100 boxes are less than 2^31 of it */

enum { N = 45, NEAR = 301, CUT = 16, COMPONENTS = 9 }; /* destinations; sources; a range ends */
enum { DOUBLES, FLOATS };

enum form { C2, C4, SPLINE, TABLE, N_FORMS };
static const char *const form_name[] = {"C2", "C4", "spline", "table"};

struct setup {
    int dim;
    const struct paths_sweep *sweep;
    enum form form;
    bool same, one_h;
    double offset;   /* of all positions, in boxes of side 1 */
    uint32_t stride; /* from one source to the next in memory, past the destinations */
};

static const struct property {
    const char *name;
    uint32_t type, terms; /* the sums of absolute terms; 0: an extreme */
    bool second;          /* of the second body */
} properties[PATHS_COUNT] = {
    [PATHS_M] = {"m", SPH_SCALAR, 0, false},
    [PATHS_V] = {"v", SPH_VECTOR, 0, false},
    [PATHS_G] = {"g", SPH_MATRIX, 0, false},
    [PATHS_SUM] = {"sum", SPH_SCALAR, PATHS_SUM_ABS, false},
    [PATHS_SUM_ABS] = {"sum_abs", SPH_SCALAR, PATHS_SUM_ABS, false},
    [PATHS_MIXED] = {"mixed", SPH_SCALAR, PATHS_MIXED_ABS, true},
    [PATHS_MIXED_ABS] = {"mixed_abs", SPH_SCALAR, PATHS_MIXED_ABS, true},
    [PATHS_FLOW] = {"flow", SPH_VECTOR, PATHS_FLOW_ABS, false},
    [PATHS_FLOW_ABS] = {"flow_abs", SPH_VECTOR, PATHS_FLOW_ABS, false},
    [PATHS_SHEAR] = {"shear", SPH_MATRIX, PATHS_SHEAR_ABS, true},
    [PATHS_SHEAR_ABS] = {"shear_abs", SPH_MATRIX, PATHS_SHEAR_ABS, true},
    [PATHS_LEAST] = {"least", SPH_SCALAR, 0, false},
    [PATHS_MOST] = {"most", SPH_SCALAR, 0, false},
};

/* Columns in both precisions. */
struct cloud {
    const struct setup *setup;
    sph_column x[2], h[2], dst[2][PATHS_COUNT], src[2][PATHS_COUNT];
    uint64_t begin[N / SPH_LANES + 2];
    sph_span *span;
    uint16_t *step;
    sph_kernel_form kernel;
};

struct result {
    double value[PATHS_COUNT][COMPONENTS][N];
};

/* -- Columns -------- */

static double unit(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

static sph_column column(size_t n, uint32_t type, int dim, size_t size)
{
    const size_t plane = (n + 2 * SPH_LANES + 15) / 16 * 16;
    const int ncomp = type == SPH_SCALAR ? 1 : type == SPH_VECTOR ? dim : dim * dim;
    sph_column c = {aligned_alloc(64, (size_t)ncomp * plane * size), plane, type, (uint32_t)ncomp};

    assert_non_null(c.data);
    memset(c.data, 0xff, (size_t)ncomp * plane * size); /* NaN */
    return c;
}

/* A number that both precisions hold. */
static void set(const sph_column *doubles, const sph_column *floats, size_t k, size_t i,
                double value)
{
    ((float *)floats->data)[k * floats->plane + i] = (float)value;
    ((double *)doubles->data)[k * doubles->plane + i] = (double)(float)value;
}

static double x_of(const struct cloud *p, size_t k, size_t i)
{
    return ((const double *)p->x[DOUBLES].data)[k * p->x[DOUBLES].plane + i];
}

static void set_x(struct cloud *p, size_t k, size_t i, double value)
{
    const double quanta = round(value / QUANTUM) + p->setup->offset / QUANTUM;

    ((double *)p->x[DOUBLES].data)[k * p->x[DOUBLES].plane + i] = quanta * QUANTUM;
    ((int32_t *)p->x[FLOATS].data)[k * p->x[FLOATS].plane + i] = (int32_t)quanta;
}

static void make_columns(struct cloud *p, size_t n_src)
{
    static const size_t size[2] = {sizeof(double), sizeof(float)};
    const int dim = p->setup->dim;

    for (int real = 0; real < 2; real++) {
        p->x[real] = column(n_src, SPH_VECTOR, dim, size[real]);
        p->h[real] = column(n_src, SPH_SCALAR, dim, size[real]);
        for (int k = 0; k < PATHS_COUNT; k++)
            if (k <= PATHS_G)
                p->dst[real][k] = p->src[real][k] =
                    column(n_src, properties[k].type, dim, size[real]);
            else
                p->dst[real][k] = column(N, properties[k].type, dim, size[real]);
    }
}

static void free_cloud(struct cloud *p)
{
    for (int real = 0; real < 2; real++) {
        free(p->x[real].data);
        free(p->h[real].data);
        for (int k = 0; k < PATHS_COUNT; k++)
            free(p->dst[real][k].data);
    }
    free(p->span);
    free(p->step);
    kernel_form_fini(&p->kernel);
}

/* -- Clouds -------- */

/* Where source k stands in memory; between them nothing is a number. */
static uint32_t place(const struct setup *s, uint32_t k)
{
    return k < N ? k : N + (k - N) * s->stride;
}

static void make_particles(struct cloud *p)
{
    static const double length[4] = {0, 0.03, 0.1, 0.17};
    const struct setup *s = p->setup;
    uint64_t seed = 11;

    for (uint32_t k = 0; k < NEAR; k++) {
        const uint32_t i = place(s, k);
        const double h = length[s->dim] * (1 + 0.4 * unit(&seed));
        set(&p->h[0], &p->h[1], 0, i, s->one_h ? length[s->dim] : h);
        for (int c = 0; c < s->dim; c++)
            set_x(p, (size_t)c, i, unit(&seed));
        for (int q = PATHS_M; q <= PATHS_G; q++)
            for (uint32_t c = 0; c < p->src[0][q].ncomp; c++)
                set(&p->src[0][q], &p->src[1][q], c, i,
                    q == PATHS_M ? 0.1 + unit(&seed) : unit(&seed) - 0.5);
    }
    /* Three in one place, two of them destinations. */
    for (int c = 0; c < s->dim; c++) {
        set_x(p, (size_t)c, 19, x_of(p, (size_t)c, 3) - s->offset);
        set_x(p, (size_t)c, place(s, NEAR - 2), x_of(p, (size_t)c, 3) - s->offset);
    }
}

/* Bit 0: source j is near one of the lower lanes of group g; bit 1: of the upper. */
static unsigned is_near(const struct cloud *p, uint64_t g, uint32_t j)
{
    const double *h = p->h[0].data;
    unsigned near = 0;

    for (uint64_t i = g * SPH_LANES; i < N && i < (g + 1) * SPH_LANES; i++) {
        double r2 = 0;
        for (int c = 0; c < p->setup->dim; c++)
            r2 += pow(x_of(p, (size_t)c, i) - x_of(p, (size_t)c, j), 2);
        if (sqrt(r2) < 2.01 * fmax(h[i], h[j]))
            near |= i % SPH_LANES < SPH_LANES / 2 ? 1u : 2u;
    }
    return near;
}

/* Those of a span in the making, by who has to meet them. */
struct making {
    uint32_t n[3], source[3][NEAR]; /* all lanes, the lower, the upper */
};

/* What has no partner is for all. */
static void end_span(struct cloud *p, struct making *m, uint64_t *n_span, uint64_t *n_step)
{
    const uint32_t turns = m->n[1] < m->n[2] ? m->n[1] : m->n[2], n = m->n[0] + m->n[1] + m->n[2];
    uint32_t base = UINT32_MAX, all[NEAR], at = 0;

    if (n == 0)
        return;
    for (int by = 0; by < 3; by++)
        for (uint32_t k = by ? turns : 0; k < m->n[by]; k++)
            all[at++] = m->source[by][k];
    p->span[*n_span] = (sph_span){*n_step, 0, (uint16_t)n, (uint16_t)at};
    for (uint32_t k = 0; k < 2 * turns; k++)
        all[at++] = m->source[1 + k % 2][k / 2];
    for (uint32_t k = 0; k < n; k++)
        base = all[k] < base ? all[k] : base;
    for (uint32_t k = 0; k < n; k++)
        p->step[(*n_step)++] = (uint16_t)(all[k] - base);
    p->span[(*n_span)++].base = base;
    memset(m->n, 0, sizeof(m->n));
}

/* Those within reach and some beyond; every other group has all, for all lanes. */
static void make_lists(struct cloud *p)
{
    const uint64_t groups = (N + SPH_LANES - 1) / SPH_LANES;
    uint64_t n_span = 0, n_step = 0, seed = 5, turns = 0;
    struct making m = {{0}, {{0}}};

    p->span = calloc(groups * NEAR, sizeof(*p->span));
    p->step = calloc(groups * NEAR, sizeof(*p->step));
    assert_true(p->span && p->step);
    for (uint64_t g = 0; g < groups; g++) {
        uint32_t first = 0;
        p->begin[g] = n_span;
        for (uint32_t k = 0; k < NEAR; k++) {
            const uint32_t j = place(p->setup, k);
            unsigned near = is_near(p, g, j);
            if (g % 2 && !near && unit(&seed) > 0.2)
                continue;
            if (!near && g % 2)
                near = unit(&seed) > 0.5 ? 1 : 2;
            if (m.n[0] + m.n[1] + m.n[2] == 0)
                first = j;
            if (j - first >= UINT16_MAX) {
                end_span(p, &m, &n_span, &n_step);
                first = j;
            }
            const int by = g % 2 && near != 3 && j / SPH_LANES != g ? (int)near : 0;
            m.source[by][m.n[by]++] = j;
        }
        end_span(p, &m, &n_span, &n_step);
        for (uint64_t s = p->begin[g]; s < n_span; s++)
            turns += (uint64_t)(p->span[s].count - p->span[s].common) / 2;
        assert_true(p->setup->stride < 300 || n_span - p->begin[g] > 1);
    }
    assert_true(turns > 0);
    p->begin[groups] = n_span;
}

static double bell(double q, uint32_t dim)
{
    (void)dim;
    return exp(-2 * q * q) * pow(1 - q / 2, 3);
}

static double bell_slope(double q, uint32_t dim)
{
    (void)dim;
    return exp(-2 * q * q) * (-4 * q * pow(1 - q / 2, 3) - 1.5 * pow(1 - q / 2, 2));
}

static void make_kernel(struct cloud *p)
{
    static const sph_kernel_term c2[] = {{20, 2, 4, 0}, {-8, 2, 5, 0}};
    static const sph_kernel_term c4[] = {
        {56 / 192., 2, 6, 0}, {-88 / 384., 2, 7, 0}, {35 / 768., 2, 8, 0}};
    static const sph_kernel_term spline[] = {{1, 2, 3, 0}, {-4, 1, 3, 0}};
    static const sph_list lists[] = {SPH_LIST(c2), SPH_LIST(c4), SPH_LIST(spline)};
    static const int shapes[N_FORMS] = {1, 2, 0, 0};
    static const sph_item item = {.size = sizeof(item), .dims = SPH_ALL_DIMS, .name = "kernel"};
    const int dim = p->setup->dim;
    sph_kernel kernel = {
        .size = sizeof(kernel), .item = &item, .support = 2, .norm = {0, 0.7, 0.7, 0.7}};
    struct error e;

    if (p->setup->form == TABLE) {
        kernel.value = bell;
        kernel.slope = bell_slope;
    } else {
        kernel.terms[dim] = lists[p->setup->form];
    }
    if (kernel_form_make(&p->kernel, &kernel, dim, &e))
        fail_msg("%s", e.text);
    assert_int_equal(paths_shape(&p->kernel), shapes[p->setup->form]);
}

static void make_cloud(struct cloud *p, const struct setup *s)
{
    *p = (struct cloud){.setup = s};
    make_columns(p, place(s, NEAR));
    make_particles(p);
    make_lists(p);
    make_kernel(p);
}

/* -- Runs -------- */

static sph_batch batch_of(const struct cloud *p, int real, uint32_t path)
{
    static const double share = 0.7;
    const struct setup *s = p->setup;

    return (sph_batch){.size = sizeof(sph_batch),
                       .dim = (uint32_t)s->dim,
                       .real = real == FLOATS ? SPH_F32 : SPH_F64,
                       .lanes = SPH_LANES,
                       .n_dst = N,
                       .n_src = place(s, NEAR),
                       .begin = p->begin,
                       .span = p->span,
                       .list = p->step,
                       .same = s->same,
                       .path = path,
                       .quantum = real == FLOATS ? QUANTUM : 0,
                       .uniform_h = s->one_h,
                       .x_dst = p->x[real],
                       .x_src = p->x[real],
                       .h_dst = p->h[real],
                       .h_src = p->h[real],
                       .dst = p->dst[real],
                       .src = p->src[real],
                       .n_columns = PATHS_COUNT,
                       .n_params = 1,
                       .param = &share,
                       .kernel = &p->kernel,
                       .dt = 0.75};
}

/* In two ranges; the second ends within a group. */
static void run(const struct cloud *p, int real, uint32_t path, struct result *out)
{
    sph_batch b = batch_of(p, real, path);

    for (int k = PATHS_G + 1; k < PATHS_COUNT; k++)
        for (uint32_t c = 0; c < b.dst[k].ncomp; c++)
            for (size_t i = 0; i < N; i++)
                set(&p->dst[0][k], &p->dst[1][k], c, i, START);
    b.count = CUT;
    assert_int_equal(p->setup->sweep->run(&b), SPH_OK);
    b.first = CUT;
    b.count = N - CUT;
    assert_int_equal(p->setup->sweep->run(&b), SPH_OK);
    memset(out, 0, sizeof(*out));
    for (int k = PATHS_G + 1; k < PATHS_COUNT; k++)
        for (uint32_t c = 0; c < b.dst[k].ncomp; c++)
            for (size_t i = 0; i < N; i++)
                out->value[k][c][i] =
                    real == FLOATS ? (double)((const float *)b.dst[k].data)[c * b.dst[k].plane + i]
                                   : ((const double *)b.dst[k].data)[c * b.dst[k].plane + i];
}

static double worst[2];

static void compare(const struct cloud *p, const struct result *want, const struct result *got,
                    int real, uint32_t path)
{
    const struct setup *s = p->setup;

    for (int k = PATHS_G + 1; k < PATHS_COUNT; k++) {
        const struct property *q = &properties[k];
        for (int c = 0; c < COMPONENTS; c++) {
            const double *terms = want->value[q->terms ? q->terms : (uint32_t)k][c];
            double largest = 0;
            for (int i = 0; i < N; i++)
                largest = fmax(largest, fabs(terms[i]));
            for (int i = 0; i < N; i++) {
                const double a = got->value[k][c][i], b = want->value[k][c][i];
                const double far = a == b ? 0 : fabs(a - b) / fmax(fabs(terms[i]), SHARE * largest);
                worst[real] = fmax(worst[real], far);
                if (!(far <= (real == FLOATS ? BAR_F32 : BAR_F64)))
                    fail_msg("%s in %d dimensions, %s, %s, %s: by path %u in %s, %s[%d] of %d is "
                             "%.17g, not %.17g: %.2g of its terms",
                             s->sweep->name, s->dim, form_name[s->form],
                             s->same ? "same" : "others", s->one_h ? "one h" : "many h", path,
                             real == FLOATS ? "floats" : "doubles", q->name, c, i, a, b, far);
            }
        }
    }
}

static const uint32_t paths[] = {
    SPH_PATH_BEST,
    SPH_PATH_REFERENCE,
    SPH_PATH_BASE,
    SPH_PATH_AVX2,
    SPH_PATH_AVX512,
    SPH_PATH_ANY_KERNEL + SPH_PATH_BEST,
    SPH_PATH_ANY_KERNEL + SPH_PATH_BASE,
    SPH_PATH_ANY_KERNEL + SPH_PATH_AVX2,
    SPH_PATH_ANY_KERNEL + SPH_PATH_AVX512,
};
enum { N_PATHS = sizeof(paths) / sizeof(paths[0]) };

static void try_setup(const struct setup *s)
{
    static struct result want, got;
    struct cloud cloud;

    make_cloud(&cloud, s);
    run(&cloud, DOUBLES, SPH_PATH_EXTENDED, &want);
    for (int k = PATHS_G + 1; k < PATHS_COUNT; k++)
        for (int i = 0; i < N; i++)
            if (!isfinite(want.value[k][0][i]))
                fail_msg("%s of %d is %g", properties[k].name, i, want.value[k][0][i]);
    assert_true(want.value[PATHS_SUM_ABS][0][7] > START);
    assert_true(s->sweep->second == (want.value[PATHS_MIXED_ABS][0][7] > START));
    for (int real = 0; real < 2; real++)
        for (int k = 0; k < N_PATHS; k++) {
            run(&cloud, real, paths[k], &got);
            compare(&cloud, &want, &got, real, paths[k]);
        }
    free_cloud(&cloud);
}

/* -- Tests -------- */

static void every_path_gives_the_same(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (int k = 0; k < PATHS_SWEEPS; k++)
            for (enum form form = 0; form < N_FORMS; form++)
                for (int bits = 0; bits < 4; bits++) {
                    const struct setup s = {dim, &paths_sweeps[k], form, bits & 1, bits & 2, 0, 1};
                    try_setup(&s);
                }
    print_message("of the sum of absolute terms: doubles %.1e, floats %.1e\n", worst[0], worst[1]);
}

/* More than 65535 between sources: a group has several spans. */
static void sources_far_apart(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (int k = 0; k < PATHS_SWEEPS; k++) {
            const struct setup s = {dim, &paths_sweeps[k], C2, true, false, 0, 600};
            try_setup(&s);
        }
}

/* Differences of positions are exact, so that the same bits come out wherever the box is. */
static void far_from_the_origin(void **state)
{
    static const double offsets[] = {16, 100, -100};
    static struct result here, there;
    struct cloud cloud;

    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (int k = 0; k < PATHS_SWEEPS; k++)
            for (int path = 0; path < N_PATHS; path++)
                for (int real = 0; real < 2; real++) {
                    struct setup s = {dim, &paths_sweeps[k], C4, true, true, 0, 1};
                    make_cloud(&cloud, &s);
                    run(&cloud, real, paths[path], &here);
                    free_cloud(&cloud);
                    for (int o = 0; o < 3; o++) {
                        s.offset = offsets[o];
                        make_cloud(&cloud, &s);
                        run(&cloud, real, paths[path], &there);
                        assert_memory_equal(&here, &there, sizeof(here));
                        free_cloud(&cloud);
                    }
                }
}

/* A loop without SPH_LOOP_F32 says no, rather than take floats for doubles. */
static void doubles_alone(void **state)
{
    const struct setup s = {2, &paths_sweeps[0], C2, true, false, 0, 1};
    struct cloud cloud;
    sph_batch b;

    (void)state;
    make_cloud(&cloud, &s);
    b = batch_of(&cloud, FLOATS, SPH_PATH_BEST);
    b.count = CUT;
    assert_int_equal(paths_doubles(&b), SPH_E_INVALID);
    b = batch_of(&cloud, DOUBLES, SPH_PATH_BEST);
    b.count = CUT;
    assert_int_equal(paths_doubles(&b), SPH_OK);
    free_cloud(&cloud);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_path_gives_the_same),
        cmocka_unit_test(sources_far_apart),
        cmocka_unit_test(far_from_the_origin),
        cmocka_unit_test(doubles_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
