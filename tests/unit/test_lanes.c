/* test_lanes.c -- exp, log, pow, and the reciprocal root on lanes, for each instruction set of this
 * processor and on an OpenCL device: their errors against long double, special values. Prints the
 * worst errors. */
#include "config.h"

#include "lanes_sets.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 1 << 16 };

/* Arguments, what is right for them, and what came out, of one function and precision. */
static struct {
    bool f32;
    double x[N], y[N];
    long double want[N];
    union {
        double d[N];
        float f[N];
    } in, in2, out;
} t;

static const char *const names[LANES_FUNCTIONS] = {"exp", "log", "pow", "sqrt", "rsqrt", "1/sqrt"};

/* [double, float] */
static const double bars[LANES_FUNCTIONS][2] = {{1, 1},     {1, 1},   {2, 1.5},
                                                {0.5, 0.5}, {1.5, 2}, {1.5, 1.5}};

static double unit(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

/* -- Arguments -------- */

static double least_normal(void)
{
    return t.f32 ? (double)FLT_MIN : DBL_MIN;
}

/* A positive number: of any size, or near 1, or beside the root of a power of 2. */
static double positive(uint64_t *seed, int kind)
{
    const double u = unit(seed), v = unit(seed);

    switch (kind % 4) {
    case 0:
        return ldexp(1 + u, (int)((v - 0.5) * (t.f32 ? 252 : 2044)));
    case 1:
        return 1 + (u - 0.5) * exp2(-(t.f32 ? 24 : 53) * v);
    case 2:
        return M_SQRT2 * (1 + (u - 0.5) * exp2(-30 * v)) * (v < 0.5 ? 1 : 0.5);
    default:
        return 0.25 + 4 * u;
    }
}

static double exp_argument(uint64_t *seed, int kind)
{
    const double u = unit(seed), v = unit(seed), top = t.f32 ? 88.72 : 709.78;
    const double low = t.f32 ? 86.7 : 707.8;

    switch (kind % 4) {
    case 0:
        return u * (low + top) - low;
    case 1: /* where the multiple of ln 2 changes */
        return M_LN2 * (floor(u * (t.f32 ? 250 : 2040)) - (t.f32 ? 124.5 : 1020.5)) *
               (1 + v * 1e-6);
    case 2:
        return (u - 0.5) * exp2(-60 * v);
    default:
        return (u - 0.5) * 4;
    }
}

static void pow_arguments(uint64_t *seed, int kind, double *x, double *y)
{
    const double u = unit(seed), top = t.f32 ? 88.7 : 709.7, low = t.f32 ? 86.4 : 707.5;

    *x = positive(seed, kind);
    if (t.f32)
        *x = (float)*x;
    if (kind & 4)
        *y = (u - 0.5) * 8;
    else /* close to the ends of the range */
        *y = (kind & 8 ? top * (1 - 0.05 * u * u) : -low * (1 - 0.05 * u * u)) / log(*x);
    if (!isfinite(*y) || *y * log(*x) > top || *y * log(*x) < -low)
        *y = 0.5;
}

static long double exact(int function, double x, double y)
{
    switch (function) {
    case LANES_EXP:
        return expl(x);
    case LANES_LOG:
        return logl(x);
    case LANES_POW:
        return powl(x, y);
    case LANES_SQRT:
        return sqrtl(x);
    default:
        return 1 / sqrtl(x);
    }
}

static void make_arguments(int function, bool f32)
{
    uint64_t seed = 17;

    t.f32 = f32;
    for (int k = 0; k < N; k++) {
        double x = 0, y = 0;
        if (function == LANES_EXP)
            x = exp_argument(&seed, k);
        else if (function == LANES_POW)
            pow_arguments(&seed, k, &x, &y);
        else
            x = positive(&seed, k);
        /* Subnormal numbers, too, where they are not taken as 0 on purpose. */
        if (function == LANES_LOG && k % 64 == 0)
            x = ldexp(1 + floor(unit(&seed) * 1e6), f32 ? -149 : -1074);
        t.x[k] = f32 ? (double)(float)x : x;
        t.y[k] = f32 ? (double)(float)y : y;
        t.want[k] = exact(function, t.x[k], t.y[k]);
        if (f32) {
            t.in.f[k] = (float)t.x[k];
            t.in2.f[k] = (float)t.y[k];
        } else {
            t.in.d[k] = t.x[k];
            t.in2.d[k] = t.y[k];
        }
    }
}

/* -- Errors -------- */

static double out(int k)
{
    return t.f32 ? (double)t.out.f[k] : t.out.d[k];
}

/* In units of the last digit of what is right. */
static double ulps(double got, long double want)
{
    const int digits = t.f32 ? FLT_MANT_DIG : DBL_MANT_DIG;
    int exponent;

    if ((long double)got == want)
        return 0;
    frexpl(want, &exponent);
    return (double)fabsl(ldexpl((long double)got - want, digits - exponent));
}

static void worst_error(const char *where, int function)
{
    double worst = 0;
    int at = 0;

    for (int k = 0; k < N; k++) {
        const double error = ulps(out(k), t.want[k]);
        if (!(error <= worst)) {
            worst = error;
            at = k;
        }
    }
    print_message("%-20s %-7s %.3f ulp (bar %g), at %.17g, %.17g\n", where, names[function], worst,
                  bars[function][t.f32], t.x[at], t.y[at]);
    if (!(worst <= bars[function][t.f32]))
        fail_msg("%s of %.17g, %.17g is %.17g, not %.20Lg", names[function], t.x[at], t.y[at],
                 out(at), t.want[at]);
}

/* Under valgrind a long double is a double: no measure for doubles. */
static bool long_is_long(void)
{
    volatile long double one = 1;

    return one + LDBL_EPSILON != one;
}

static void errors_of_all_sets(void **state)
{
    const struct lanes_set *set;

    (void)state;
    for (int f32 = 0; f32 < 2; f32++) {
        for (int function = 0; function < LANES_FUNCTIONS; function++) {
            if (!f32 && !long_is_long())
                continue;
            make_arguments(function, f32);
            for (size_t s = 0; (set = lanes_set(s)); s++) {
                if (set->f32 != f32)
                    continue;
                set->function[function](&t.in, &t.in2, &t.out, N);
                worst_error(set->name, function);
            }
        }
    }
}

/* -- Special values -------- */

enum { NUMBER_OF_SPECIALS = 48 };

/* TINY: the least normal number, which differs by precision. */
#define TINY (-7777.0)
static const struct special {
    int function;
    double x, y, want;
} specials[NUMBER_OF_SPECIALS] = {
    {LANES_EXP, 0, 0, 1},
    {LANES_EXP, -0.0, 0, 1},
    {LANES_EXP, INFINITY, 0, INFINITY},
    {LANES_EXP, -INFINITY, 0, 0},
    {LANES_EXP, NAN, 0, NAN},
    {LANES_EXP, 709.8, 0, INFINITY},
    {LANES_EXP, 1e30, 0, INFINITY},
    {LANES_EXP, -708.1, 0, 0},
    {LANES_EXP, -1e30, 0, 0},
    {LANES_EXP, TINY, 0, 1},
    {LANES_LOG, 0, 0, -INFINITY},
    {LANES_LOG, -0.0, 0, -INFINITY},
    {LANES_LOG, -1, 0, NAN},
    {LANES_LOG, -INFINITY, 0, NAN},
    {LANES_LOG, INFINITY, 0, INFINITY},
    {LANES_LOG, NAN, 0, NAN},
    {LANES_LOG, -NAN, 0, NAN},
    {LANES_LOG, 1, 0, 0},
    {LANES_POW, 0, 0, 1},
    {LANES_POW, NAN, 0, 1},
    {LANES_POW, -1, 0, 1},
    {LANES_POW, INFINITY, 0, 1},
    {LANES_POW, 0, 2, 0},
    {LANES_POW, -0.0, 2, 0},
    {LANES_POW, 0, TINY, 0},
    {LANES_POW, 0, -0.5, INFINITY},
    {LANES_POW, 0, INFINITY, 0},
    {LANES_POW, 0, -INFINITY, INFINITY},
    {LANES_POW, INFINITY, 0.1, INFINITY},
    {LANES_POW, INFINITY, TINY, INFINITY},
    {LANES_POW, INFINITY, -0.1, 0},
    {LANES_POW, 2, INFINITY, INFINITY},
    {LANES_POW, 2, -INFINITY, 0},
    {LANES_POW, 0.5, INFINITY, 0},
    {LANES_POW, 0.5, -1e30, INFINITY},
    {LANES_POW, 3, 1e38, INFINITY},
    {LANES_POW, 3, -1e38, 0},
    {LANES_POW, 1, 1e38, 1},
    {LANES_POW, 1, -3, 1},
    {LANES_POW, -2, 2, NAN},
    {LANES_POW, NAN, 1, NAN},
    {LANES_POW, 2, NAN, NAN},
    {LANES_POW, 4, 0.5, 2},
    {LANES_RSQRT, 0, 0, 0},
    {LANES_RSQRT, -0.0, 0, 0},
    {LANES_RSQRT, 4, 0, 0.5},
    {LANES_RSQRT, NAN, 0, NAN},
    {LANES_SQRT, 0, 0, 0},
};

static void make_specials(int function, bool f32)
{
    memset(&t, 0, sizeof(t));
    t.f32 = f32;
    for (int k = 0; k < NUMBER_OF_SPECIALS; k++) {
        const struct special *s = &specials[k];
        const double x = s->x == TINY ? least_normal() : s->x;
        const double y = s->y == TINY ? least_normal() : s->y;
        if (s->function != function)
            continue;
        if (f32) {
            t.in.f[k] = (float)x;
            t.in2.f[k] = (float)y;
        } else {
            t.in.d[k] = x;
            t.in2.d[k] = y;
        }
    }
}

static void compare_specials(const char *where, int function)
{
    for (int k = 0; k < NUMBER_OF_SPECIALS; k++) {
        const struct special *s = &specials[k];
        if (s->function != function)
            continue;
        if (!(out(k) == s->want || (isnan(out(k)) && isnan(s->want))))
            fail_msg("%s: %s of %g, %g is %.17g, not %g", where, names[function], s->x, s->y,
                     out(k), s->want);
    }
}

static void special_values_of_all_sets(void **state)
{
    const struct lanes_set *set;

    (void)state;
    for (int function = 0; function < LANES_FUNCTIONS; function++) {
        for (size_t s = 0; (set = lanes_set(s)); s++) {
            make_specials(function, set->f32);
            set->function[function](&t.in, &t.in2, &t.out, NUMBER_OF_SPECIALS);
            compare_specials(set->name, function);
        }
    }
}

/* -- OpenCL -------- */

#if SPH_HAVE_OPENCL

#include <CL/cl.h>

static const struct words {
    const char *name;
    bool f32;
    int width;
    const char *text;
} words[] = {
    {"OpenCL double", false, 1,
     "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n"
     "#define SPH_F32_WORDS 0\n"
     "typedef double R; typedef long I; typedef double T;\n"
     "#define sph_select(m, a, b) ((m) & 1 ? (a) : (b))\n"
     "#define sph_bits(a) as_long(a)\n"
     "#define sph_of_bits(a) as_double(a)\n"},
    {"OpenCL double4", false, 4,
     "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n"
     "#define SPH_F32_WORDS 0\n"
     "typedef double4 R; typedef long4 I; typedef double T;\n"
     "#define sph_select(m, a, b) select((b), (a), (m))\n"
     "#define sph_bits(a) as_long4(a)\n"
     "#define sph_of_bits(a) as_double4(a)\n"},
    {"OpenCL float", true, 1,
     "#define SPH_F32_WORDS 1\n"
     "typedef float R; typedef int I; typedef float T;\n"
     "#define sph_select(m, a, b) ((m) & 1 ? (a) : (b))\n"
     "#define sph_bits(a) as_int(a)\n"
     "#define sph_of_bits(a) as_float(a)\n"},
};

static const char tail[] =
    "\n__kernel void run(int f, __global const R *x, __global const R *y, __global R *out)\n"
    "{\n"
    "    const size_t k = get_global_id(0);\n"
    "    out[k] = f == 0 ? sph_exp(x[k]) : f == 1 ? sph_log(x[k]) : sph_pow(x[k], y[k]);\n"
    "}\n";

static char *source_of(const struct words *w)
{
    const char *top = getenv("top_srcdir");
    char path[4096], *text = NULL, part[4096];
    size_t size, n;
    FILE *in, *out_text;

    snprintf(path, sizeof(path), "%s/sdk/sph/lanes-math.h", top ? top : ".");
    in = fopen(path, "r");
    if (!in)
        fail_msg("no %s", path);
    out_text = open_memstream(&text, &size);
    assert_non_null(out_text);
    fprintf(out_text,
            "%s"
            "#define sph_num(a) ((R)((T)(a)))\n"
            "#define sph_int(a) ((I)(a))\n"
            "#define SPH_OF_ISA(name) name\n"
            "#define SPH_FN(type, name, arguments) static type name arguments\n",
            w->text);
    while ((n = fread(part, 1, sizeof(part), in)) > 0)
        fwrite(part, 1, n, out_text);
    fputs(tail, out_text);
    fclose(in);
    assert_int_equal(fclose(out_text), 0);
    return text;
}

static cl_device_id a_device(void)
{
    cl_platform_id platform[16];
    cl_device_id id;
    cl_uint n = 0;
    cl_device_fp_config fp64 = 0;

    if (clGetPlatformIDs(16, platform, &n) != CL_SUCCESS)
        return NULL;
    for (cl_uint k = 0; k < n && k < 16; k++)
        if (clGetDeviceIDs(platform[k], CL_DEVICE_TYPE_ALL, 1, &id, NULL) == CL_SUCCESS &&
            clGetDeviceInfo(id, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof(fp64), &fp64, NULL) ==
                CL_SUCCESS &&
            fp64)
            return id;
    return NULL;
}

struct device {
    cl_device_id id;
    cl_context context;
    cl_command_queue queue;
    cl_mem in, in2, out;
};

/* N values of the function. */
static void run_kernel(const struct device *d, cl_kernel kernel, int function, int width)
{
    const size_t size = (size_t)N * (t.f32 ? sizeof(float) : sizeof(double));
    const size_t items = N / (size_t)width;
    const cl_int f = function;

    assert_int_equal(clEnqueueWriteBuffer(d->queue, d->in, CL_TRUE, 0, size, &t.in, 0, NULL, NULL),
                     CL_SUCCESS);
    assert_int_equal(
        clEnqueueWriteBuffer(d->queue, d->in2, CL_TRUE, 0, size, &t.in2, 0, NULL, NULL),
        CL_SUCCESS);
    assert_int_equal(clSetKernelArg(kernel, 0, sizeof(f), &f), CL_SUCCESS);
    assert_int_equal(clSetKernelArg(kernel, 1, sizeof(d->in), &d->in), CL_SUCCESS);
    assert_int_equal(clSetKernelArg(kernel, 2, sizeof(d->in2), &d->in2), CL_SUCCESS);
    assert_int_equal(clSetKernelArg(kernel, 3, sizeof(d->out), &d->out), CL_SUCCESS);
    assert_int_equal(clEnqueueNDRangeKernel(d->queue, kernel, 1, NULL, &items, NULL, 0, NULL, NULL),
                     CL_SUCCESS);
    assert_int_equal(clEnqueueReadBuffer(d->queue, d->out, CL_TRUE, 0, size, &t.out, 0, NULL, NULL),
                     CL_SUCCESS);
}

static void check_words(const struct device *d, const struct words *w)
{
    char *text = source_of(w), log[1 << 16] = "";
    const char *texts = text;
    cl_program program = clCreateProgramWithSource(d->context, 1, &texts, NULL, NULL);
    cl_kernel kernel;

    if (clBuildProgram(program, 1, &d->id, "-cl-std=CL1.2", NULL, NULL) != CL_SUCCESS) {
        clGetProgramBuildInfo(program, d->id, CL_PROGRAM_BUILD_LOG, sizeof(log) - 1, log, NULL);
        fail_msg("%s: %.1000s", w->name, log);
    }
    kernel = clCreateKernel(program, "run", NULL);
    assert_non_null(kernel);
    for (int function = 0; function <= LANES_POW; function++) {
        make_specials(function, w->f32);
        run_kernel(d, kernel, function, w->width);
        compare_specials(w->name, function);
        if (!w->f32 && !long_is_long())
            continue;
        make_arguments(function, w->f32);
        run_kernel(d, kernel, function, w->width);
        worst_error(w->name, function);
    }
    clReleaseKernel(kernel);
    clReleaseProgram(program);
    free(text);
}

static void the_same_text_on_opencl(void **state)
{
    struct device d = {.id = a_device()};

    (void)state;
    if (!d.id) {
        print_message("no OpenCL device with double precision\n");
        skip();
    }
    d.context = clCreateContext(NULL, 1, &d.id, NULL, NULL, NULL);
    assert_non_null(d.context);
    d.queue = clCreateCommandQueue(d.context, d.id, 0, NULL);
    d.in = clCreateBuffer(d.context, CL_MEM_READ_ONLY, sizeof(t.in), NULL, NULL);
    d.in2 = clCreateBuffer(d.context, CL_MEM_READ_ONLY, sizeof(t.in2), NULL, NULL);
    d.out = clCreateBuffer(d.context, CL_MEM_READ_WRITE, sizeof(t.out), NULL, NULL);
    assert_true(d.queue && d.in && d.in2 && d.out);
    for (size_t k = 0; k < sizeof(words) / sizeof(words[0]); k++)
        check_words(&d, &words[k]);
    clReleaseMemObject(d.in);
    clReleaseMemObject(d.in2);
    clReleaseMemObject(d.out);
    clReleaseCommandQueue(d.queue);
    clReleaseContext(d.context);
}

#else

static void the_same_text_on_opencl(void **state)
{
    (void)state;
    print_message("built without OpenCL\n");
    skip();
}

#endif

/* The leak sanitizer's tracer itself crashes on the threads of the OpenCL driver's compiler (see
 * test_pair_body.c). */
__attribute__((visibility("default"))) int __lsan_is_turned_off(void);
int __lsan_is_turned_off(void)
{
    return 1;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(special_values_of_all_sets),
        cmocka_unit_test(errors_of_all_sets),
        cmocka_unit_test(the_same_text_on_opencl),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
