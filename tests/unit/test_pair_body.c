/* test_pair_body.c -- pair bodies on an OpenCL device against a plain loop over all pairs:
 * reach, the self pair, ranges, kernels of both forms, what must not be touched; what is
 * reported of bodies and batches that are wrong. Without a device the text alone is looked at. */
#include "config.h"

#include "opencl/pair_body.h"
#include "opencl/pair_source.h"
#include "registry/kernel_form.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 43, SOURCES = 61, PLANE = 64, GROUPS = (N + SPH_LANES - 1) / SPH_LANES };
enum { CUT = 20 }; /* sources in a group's first span */
enum { M, V, SUM, REST, FLOW, LEAST, MOST, N_PROPS };

static const char body_text[] =
    "/* The kernel; out of reach the root is NaN. */\n"
    "const R q = r * hinv_i, s = REACH(q, r * hinv_j);\n"
    "sph_add(sum, share * m_j * (sph_w(K, q) + sph_sqrt(4.0 - s * s)));\n"
    "for (int a = 0; a < DIM; a++)\n"
    "    sph_sub(flow[a], sph_dw(K, q) * rinv * (v_j[a] - v_i[a]));\n"
    "sph_add(rest, sph_grad(K, m_j, r, hinv_i) * r2);\n"
    "const T third = 1.0 / 3.0;\n"
    "sph_add(rest, sph_dw_q(K, q) * r2 * sph_rsqrt(1.0 + q) + sph_exp(-m_j));\n"
    "sph_sub(rest, sph_log(m_j) * sph_pow(m_j, q) + sph_pow_where(in, q, sph_num(third)));\n"
    "sph_take_min(least, m_j + b->dt);\n"
    "sph_take_max(most, m_j * TWICE + b->time);\n";
static const sph_device_value body_i[] = {{"v", V, SPH_VECTOR}};
static const sph_device_value body_j[] = {{"m", M, SPH_SCALAR}, {"v", V, SPH_VECTOR}};
static const sph_device_value body_sum[] = {
    {"sum", SUM, SPH_SCALAR}, {"rest", REST, SPH_SCALAR}, {"flow", FLOW, SPH_VECTOR}};
static const sph_device_value body_min[] = {{"least", LEAST, SPH_SCALAR}};
static const sph_device_value body_max[] = {{"most", MOST, SPH_SCALAR}};
static const sph_device_value body_param[] = {{"share", 1, 0}};

static const sph_device_body right = {.size = sizeof(sph_device_body),
                                      .reach = SPH_GATHER,
                                      .text = body_text,
                                      .file = "some.body.h",
                                      .prelude = "#define TWICE 2.0\n#define REACH(a, b) (a)",
                                      .prelude_file = "some.macros.h",
                                      .i = SPH_LIST(body_i),
                                      .j = SPH_LIST(body_j),
                                      .sum = SPH_LIST(body_sum),
                                      .min = SPH_LIST(body_min),
                                      .max = SPH_LIST(body_max),
                                      .param = SPH_LIST(body_param)};

/* Particles in a box of side 1; the sources are the destinations and some more, all in every
 * list. */
static struct cloud {
    int dim;
    double x[3 * PLANE], h[PLANE], m[PLANE], v[3 * PLANE];
    double sum[PLANE], rest[PLANE], flow[3 * PLANE], least[PLANE], most[PLANE];
    uint64_t begin[GROUPS + 1];
    sph_span span[2 * GROUPS];
    uint16_t list[GROUPS * SOURCES];
    sph_column dst[N_PROPS], src[N_PROPS];
    double param[2];
    sph_kernel_form kernel;
} cloud;

static double unit(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

static double bell(double q, uint32_t dim)
{
    (void)dim;
    return pow(fmax(0, 2 - q), 3) - 4 * pow(fmax(0, 1 - q), 3);
}

static double bell_slope(double q, uint32_t dim)
{
    (void)dim;
    return -3 * pow(fmax(0, 2 - q), 2) + 12 * pow(fmax(0, 1 - q), 2);
}

enum form { TWO_PIECES, ONE_PIECE, TABLE, N_FORMS };

static void make_kernel(int dim, enum form form)
{
    static const sph_kernel_term terms[] = {{1, 2, 3, 0}, {-4, 1, 3, 0}};
    static const sph_kernel_term wendland[] = {{5. / 16, 2, 4, 0}, {-2. / 16, 2, 5, 0}};
    static const sph_item item = {.size = sizeof(item), .dims = SPH_ALL_DIMS, .name = "bell"};
    sph_kernel kernel = {.size = sizeof(kernel),
                         .item = &item,
                         .support = 2,
                         .norm = {0, 1. / 6, 5 / (14 * M_PI), 1 / (4 * M_PI)}};
    struct error e;

    if (form == TABLE) {
        kernel.value = bell;
        kernel.slope = bell_slope;
    } else {
        kernel.terms[dim] =
            form == ONE_PIECE ? (sph_list)SPH_LIST(wendland) : (sph_list)SPH_LIST(terms);
    }
    assert_int_equal(kernel_form_make(&cloud.kernel, &kernel, dim, &e), 0);
}

static sph_column column(double *data, uint32_t type)
{
    return (sph_column){data, PLANE, type, type == SPH_VECTOR ? (uint32_t)cloud.dim : 1};
}

static void reset_sums(void)
{
    for (int i = 0; i < PLANE; i++) {
        cloud.sum[i] = 5;
        cloud.rest[i] = -2;
        cloud.least[i] = 2;
        cloud.most[i] = -1;
    }
    memset(cloud.flow, 0, sizeof(cloud.flow));
}

/* Bit 0: source j may be within reach of the lower lanes of group g; bit 1: of the upper. */
static unsigned is_near(uint64_t g, int j)
{
    unsigned near = 0;

    for (uint64_t i = g * SPH_LANES; i < (g + 1) * SPH_LANES && i < N; i++) {
        double r2 = 0;
        for (int c = 0; c < cloud.dim; c++)
            r2 += pow(cloud.x[(uint64_t)c * PLANE + i] - cloud.x[(uint64_t)c * PLANE + (uint64_t)j],
                      2);
        if (sqrt(r2) < 2.01 * fmax(cloud.h[i], cloud.h[j]))
            near |= i % SPH_LANES < SPH_LANES / 2 ? 1u : 2u;
    }
    return near;
}

/* A group's second span: those that one half of it alone can meet take turns, if they find a partner. */
static void make_turns(uint64_t g, sph_span *span, uint16_t *list)
{
    uint16_t half[2][SOURCES], n[2] = {0, 0}, at = 0;

    for (int j = CUT; j < SOURCES; j++) {
        const unsigned near = is_near(g, j);
        if (near == 3 || (uint64_t)j / SPH_LANES == g)
            list[at++] = (uint16_t)(j - CUT);
        else
            half[near == 2][n[near == 2]++] = (uint16_t)(j - CUT);
    }
    for (int which = 0; which < 2; which++)
        while (n[which] > n[!which])
            list[at++] = half[which][--n[which]];
    span->common = at;
    for (uint16_t k = 0; k < 2 * n[0]; k++)
        list[at++] = half[k % 2][k / 2];
}

/* Two spans a group. They stand in the list in reverse order of the groups: nothing says that they
 * follow each other. */
static void make_lists(void)
{
    uint64_t turns = 0;

    for (uint64_t g = 0; g < GROUPS; g++) {
        const uint64_t at = (GROUPS - 1 - g) * SOURCES;
        cloud.begin[g] = 2 * g;
        cloud.span[2 * g] = (sph_span){at, 0, CUT, CUT};
        cloud.span[2 * g + 1] = (sph_span){at + CUT, CUT, SOURCES - CUT, 0};
        for (uint64_t k = 0; k < CUT; k++)
            cloud.list[at + k] = (uint16_t)k;
        make_turns(g, &cloud.span[2 * g + 1], cloud.list + at + CUT);
        turns += (uint64_t)(SOURCES - CUT) - cloud.span[2 * g + 1].common;
    }
    assert_true(turns > 0 || cloud.dim == 1); /* there all are near */
    cloud.begin[GROUPS] = 2 * GROUPS;
}

static void make_cloud(int dim, enum form form)
{
    uint64_t seed = 7;

    memset(&cloud, 0, sizeof(cloud));
    cloud.dim = dim;
    for (int i = 0; i < 3 * PLANE; i++) {
        cloud.x[i] = i % PLANE < SOURCES ? unit(&seed) : NAN;
        cloud.v[i] = unit(&seed);
    }
    for (int i = 0; i < PLANE; i++) {
        cloud.h[i] = 0.1 + 0.15 * unit(&seed);
        cloud.m[i] = unit(&seed);
    }
    make_lists();
    cloud.dst[V] = cloud.src[V] = column(cloud.v, SPH_VECTOR);
    cloud.src[M] = column(cloud.m, SPH_SCALAR);
    cloud.dst[SUM] = column(cloud.sum, SPH_SCALAR);
    cloud.dst[REST] = column(cloud.rest, SPH_SCALAR);
    cloud.dst[FLOW] = column(cloud.flow, SPH_VECTOR);
    cloud.dst[LEAST] = column(cloud.least, SPH_SCALAR);
    cloud.dst[MOST] = column(cloud.most, SPH_SCALAR);
    cloud.param[0] = NAN;
    cloud.param[1] = 0.3;
    reset_sums();
    make_kernel(dim, form);
}

static sph_batch batch(uint64_t first, uint64_t count, uint32_t same)
{
    return (sph_batch){.size = sizeof(sph_batch),
                       .dim = (uint32_t)cloud.dim,
                       .real = SPH_F64,
                       .lanes = SPH_LANES,
                       .first = first,
                       .count = count,
                       .n_dst = N,
                       .n_src = SOURCES,
                       .begin = cloud.begin,
                       .span = cloud.span,
                       .list = cloud.list,
                       .same = same,
                       .x_dst = column(cloud.x, SPH_VECTOR),
                       .x_src = column(cloud.x, SPH_VECTOR),
                       .h_dst = column(cloud.h, SPH_SCALAR),
                       .h_src = column(cloud.h, SPH_SCALAR),
                       .dst = cloud.dst,
                       .src = cloud.src,
                       .n_columns = N_PROPS,
                       .n_params = 2,
                       .param = cloud.param,
                       .kernel = &cloud.kernel,
                       .time = 0.25,
                       .dt = 0.125};
}

/* -- The plain loop -------- */

struct sums {
    double sum, rest, flow[3], least, most;
};

static double distance(int i, int j)
{
    double r2 = 0;

    for (int c = 0; c < cloud.dim; c++)
        r2 += pow(cloud.x[c * PLANE + i] - cloud.x[c * PLANE + j], 2);
    return sqrt(r2);
}

static struct sums plain(int i, const sph_device_body *d, bool same)
{
    struct sums out = {5, -2, {0, 0, 0}, 2, -1};

    for (int j = 0; j < SOURCES; j++) {
        const double r = distance(i, j), q = r / cloud.h[i];
        const double h = d->reach == SPH_GATHER ? cloud.h[i] : fmax(cloud.h[i], cloud.h[j]);
        const double s = r / h;
        if (r >= 2 * h || (same && i == j && !d->self))
            continue;
        out.sum += 0.3 * cloud.m[j] * (kernel_form_w(&cloud.kernel, q) + sqrt(4 - s * s));
        out.rest += exp(-cloud.m[j]) - log(cloud.m[j]) * pow(cloud.m[j], q) - cbrt(q);
        if (r > 0)
            out.rest += kernel_form_dw(&cloud.kernel, q) / q * r * r *
                        (1 / sqrt(1 + q) + cloud.m[j] * pow(cloud.h[i], -cloud.dim - 2));
        for (int c = 0; c < cloud.dim && r > 0; c++)
            out.flow[c] += kernel_form_dw(&cloud.kernel, q) / r *
                           (cloud.v[c * PLANE + i] - cloud.v[c * PLANE + j]);
        out.least = fmin(out.least, cloud.m[j] + 0.125);
        out.most = fmax(out.most, 2 * cloud.m[j] + 0.25);
    }
    return out;
}

static void near_to(double got, double want, const char *what, int i)
{
    if (!(fabs(got - want) <= 1e-13 * (1 + fabs(want))) && !(isnan(got) && isnan(want)))
        fail_msg("%s of %d is %.17g, not %.17g", what, i, got, want);
}

static void compare(const sph_device_body *d, int first, int end, bool same)
{
    for (int i = 0; i < PLANE; i++) {
        struct sums want = {5, -2, {0, 0, 0}, 2, -1};
        if (i >= first && i < end)
            want = plain(i, d, same);
        near_to(cloud.sum[i], want.sum, "sum", i);
        near_to(cloud.rest[i], want.rest, "rest", i);
        for (int c = 0; c < cloud.dim; c++)
            near_to(cloud.flow[c * PLANE + i], want.flow[c], "flow", i);
        near_to(cloud.least[i], want.least, "least", i);
        near_to(cloud.most[i], want.most, "most", i);
    }
}

/* -- Tests -------- */

static size_t device;

static void need_device(void)
{
    struct error e;

    if (pair_body_device(&device, &e) == 0)
        return;
    print_message("%s\n", e.text);
    skip();
}

static struct pair_body *built(const sph_function *f, bool measured)
{
    struct pair_body *p;
    struct error e;

    if (pair_body_build(&p, device, f, cloud.dim, measured, &e))
        fail_msg("%s", e.text);
    return p;
}

static void ran(struct pair_body *p, const sph_batch *b, bool absolute)
{
    struct error e;

    if (pair_body_run(p, b, absolute, &e))
        fail_msg("%s", e.text);
}

static void run_and_compare(const sph_device_body *d, int dim)
{
    const sph_function f = {.size = sizeof(f), .device = d};
    struct pair_body *p;
    sph_batch b;

    make_cloud(dim, TWO_PIECES);
    p = built(&f, false);
    for (enum form form = 0; form < N_FORMS; form++) {
        make_cloud(dim, form);
        b = batch(0, N, 0);
        ran(p, &b, false);
        compare(d, 0, N, false);
        reset_sums();
        b = batch(16, 21, 1);
        ran(p, &b, false);
        compare(d, 16, 37, true);
        b.count = 0;
        ran(p, &b, false);
        compare(d, 16, 37, true);
        kernel_form_fini(&cloud.kernel);
    }
    pair_body_free(p);
}

static void gives_the_plain_sums(void **state)
{
    (void)state;
    need_device();
    for (int dim = 1; dim <= 3; dim++)
        run_and_compare(&right, dim);
}

static void reach_and_self(void **state)
{
    sph_device_body wide = right;

    (void)state;
    need_device();
    wide.self = 1;
    run_and_compare(&wide, 2);
    /* In reach of either the root is a number. */
    wide.reach = SPH_SYMMETRIC;
    wide.prelude = "#define TWICE 2.0\n#define REACH sph_min";
    wide.self = 0;
    run_and_compare(&wide, 2);
}

static void absolute_terms(void **state)
{
    const sph_function f = {.size = sizeof(f), .device = &right};
    struct pair_body *p;
    double terms = 0;
    sph_batch b;

    (void)state;
    need_device();
    make_cloud(1, TWO_PIECES);
    p = built(&f, true);
    b = batch(0, 8, 1);
    ran(p, &b, false);
    compare(&right, 0, 8, true);
    reset_sums();
    ran(p, &b, true);
    for (int j = 0; j < SOURCES; j++) {
        const double r = distance(3, j);
        if (r > 0 && r < 2 * cloud.h[3])
            terms +=
                fabs(kernel_form_dw(&cloud.kernel, r / cloud.h[3]) / r * (cloud.v[3] - cloud.v[j]));
    }
    near_to(cloud.flow[3], terms, "absolute flow", 3);
    pair_body_free(p);
    kernel_form_fini(&cloud.kernel);
}

static void refused(const sph_device_body *d, int code, const char *says)
{
    const sph_function f = {.size = sizeof(f), .device = d};
    struct pair_body *p;
    struct error e;

    assert_int_equal(pair_body_build(&p, device, &f, 2, false, &e), -1);
    assert_null(p);
    if (e.exit_code != code || !strstr(e.text, says) || strchr(e.text, '\n'))
        fail_msg("%s", e.text);
}

static void wrong_bodies_and_batches(void **state)
{
    const sph_function f = {.size = sizeof(f), .device = &right};
    sph_device_body wrong = right;
    struct pair_body *p;
    sph_batch b;
    struct error e;

    (void)state;
    need_device();
    wrong.text = "const R q = r;\nsph_add(sum, nothing);\n";
    refused(&wrong, EXIT_REFUSED, "some.body.h:2");
    wrong.text = "sph_add(sum, r)";
    refused(&wrong, EXIT_REFUSED, "some.body.h");
    wrong = right;
    wrong.prelude = "\n#error none\n";
    refused(&wrong, EXIT_REFUSED, "some.macros.h:2");
    assert_int_equal(pair_body_build(&p, 1000, &f, 2, false, &e), -1);
    assert_string_equal(e.text, "there is no OpenCL device 1000");

    make_cloud(2, TWO_PIECES);
    p = built(&f, false);
    b = batch(0, N, 1);
    b.real = SPH_F32;
    assert_int_equal(pair_body_run(p, &b, false, &e), -1);
    b = batch(0, N, 1);
    b.kernel = NULL;
    assert_int_equal(pair_body_run(p, &b, false, &e), -1);
    b = batch(0, N, 1);
    cloud.src[M].data = NULL;
    assert_int_equal(pair_body_run(p, &b, false, &e), -1);
    assert_non_null(strstr(e.text, "not in the batch"));
    for (int i = 0; i < PLANE; i++)
        assert_true(cloud.sum[i] == 5);
    pair_body_free(p);
    kernel_form_fini(&cloud.kernel);
}

/* The name of a file may hold anything; a column is handed over once. */
static void the_text(void **state)
{
    sph_device_body odd = right;
    struct pair_column *columns;
    struct error e;
    char *text;
    size_t n;

    (void)state;
    odd.file = "a \"b\"\\c.h";
    odd.sum = (sph_list){body_sum, 1, sizeof(body_sum[0])};
    odd.min = (sph_list){body_sum, 1, sizeof(body_sum[0])};
    text = pair_source(&odd, 3, false, &e);
    assert_non_null(text);
    assert_non_null(strstr(text, "\n#line 1 \"a \\\"b\\\"\\\\c.h\"\n/* The kernel;"));
    assert_non_null(strstr(text, "\n#line 1 \"some.macros.h\"\n#define TWICE 2.0\n#define REACH"));
    assert_non_null(strstr(text, "\n#define DIM 3\n"));
    free(text);
    assert_int_equal(pair_columns(&columns, &n, &odd, &e), 0);
    assert_int_equal(n, 5); /* v, sum, most; m, v of the sources */
    assert_true(columns[1].index == SUM && columns[1].written && !columns[1].source);
    assert_true(columns[4].index == V && !columns[4].written && columns[4].source);
    free(columns);
}

/* The leak sanitizer's tracer itself crashes on the threads of the OpenCL driver's compiler (seen with
 * pocl 3.1): errors of addresses are still found here, leaks are not. */
__attribute__((visibility("default"))) int __lsan_is_turned_off(void);
int __lsan_is_turned_off(void)
{
    return 1;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_text),
        cmocka_unit_test(gives_the_plain_sums),
        cmocka_unit_test(reach_and_self),
        cmocka_unit_test(absolute_terms),
        cmocka_unit_test(wrong_bodies_and_batches),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
