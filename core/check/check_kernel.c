/* check/check_kernel.c -- the check `integral`: a kernel as loops see it (sph/kernel-value.h and
 * the vector words of sph/lanes.h), integrated and differentiated numerically, apart from what the
 * loader computes. */
#include "check/checks.h"
#include "check/lanes.h"

#include "registry/kernel_form.h"

#include <float.h>
#include <math.h>
#include <sph/kernel-value.h>
#include <string.h>

#define INTEGRAL_TOLERANCE 1e-9
#define SLOPE_TOLERANCE 1e-6
#define LANES_TOLERANCE 1e-12 /* of W(0); slopes: a hundred times that */
/* In floats. The pieces of a spline are largest at 0, where they nearly cancel. */
#define FLOATS_TOLERANCE 1e-4
#define POINTS 512

/* Gauss and Legendre's rule of 8 points, on -1 to 1: M. Abramowitz & I. A. Stegun, Handbook of
 * Mathematical Functions (1972), table 25.4. */
static const double node[4] = {0.183434642495649805, 0.525532409916328986, 0.796666477413626740,
                               0.960289856497536232};
static const double weight[4] = {0.362683783378361983, 0.313706645877887287, 0.222381034453374471,
                                 0.101228536290376259};

struct tried {
    const struct subject *subject;
    const sph_kernel *kernel;
    sph_kernel_form form;
    int dim;
    double integral, second, slope; /* errors; the second moment */
    double lanes[2];                /* errors of doubles, of floats */
    bool failed;
};

/* int q^power W dV over a shell of the unit-h kernel. */
static double shell(const struct tried *t, double from, double to, int power)
{
    static const double area[4] = {0, 2, 2 * 3.14159265358979323846, 4 * 3.14159265358979323846};
    double sum = 0;

    for (int i = 0; i < 8; i++) {
        const double x = i < 4 ? -node[i] : node[i - 4];
        const double q = 0.5 * (from + to) + 0.5 * (to - from) * x;
        sum += weight[i % 4] * pow(q, t->dim - 1 + power) * sph_kernel_w(&t->form, q);
    }
    return area[t->dim] * 0.5 * (to - from) * sum;
}

/* In pieces within which W is smooth: between knots, or the cells of a table. */
static double moment(const struct tried *t, int power)
{
    const sph_kernel_form *f = &t->form;
    const uint32_t parts = 16;
    double sum = 0;

    for (uint32_t i = 0; i < f->n_table; i++)
        sum += shell(t, i / f->cells, (i + 1) / f->cells, power);
    for (uint32_t k = 0; k < f->n_pieces; k++) { /* the outermost knot first */
        const double from = k + 1 < f->n_pieces ? f->piece[k + 1].knot : 0;
        const double width = (f->piece[k].knot - from) / parts;
        for (uint32_t i = 0; i < parts; i++)
            sum += shell(t, from + i * width, from + (i + 1) * width, power);
    }
    return sum;
}

/* A kernel that is given as a function is tried itself, not its table, whose slope fits its values
 * anyway. */
static double value(const struct tried *t, double q)
{
    return t->kernel->value ? t->form.norm * t->kernel->value(q, t->form.dim)
                            : sph_kernel_w(&t->form, q);
}

static double slope(const struct tried *t, double q)
{
    return t->kernel->slope ? t->form.norm * t->kernel->slope(q, t->form.dim)
                            : sph_kernel_dw(&t->form, q);
}

/* Central differences of two widths, their leading error taken out. */
static double difference(const struct tried *t, double q, double step)
{
    const double wide = (value(t, q + step) - value(t, q - step)) / (2 * step);
    const double narrow = (value(t, q + step / 2) - value(t, q - step / 2)) / step;

    return (4 * narrow - wide) / 3;
}

static bool near_knot(const struct tried *t, double q, double step)
{
    for (uint32_t k = 0; k < t->form.n_pieces; k++)
        if (fabs(q - t->form.piece[k].knot) <= step)
            return true;
    return q <= step || q >= t->form.support - step;
}

static void try_slope(struct tried *t)
{
    const double step = 1e-3 * t->form.support;
    double largest = DBL_MIN;

    for (int i = 0; i <= POINTS; i++)
        largest = fmax(largest, fabs(slope(t, t->form.support * i / POINTS)));
    for (int i = 1; i < POINTS && !t->failed; i++) {
        const double q = t->form.support * i / POINTS;
        const double given = slope(t, q), found = difference(t, q, step);
        if (near_knot(t, q, step))
            continue;
        t->slope = fmax(t->slope, fabs(given - found) / largest);
        if (fabs(given - found) <= SLOPE_TOLERANCE * largest)
            continue;
        say(t->subject, VERDICT_FAIL,
            "slope differs from the derivative of W at q = %g in %d dimensions: %.9g against %.9g",
            q, t->dim, given, found);
        t->failed = true;
    }
}

static void try_ends(struct tried *t)
{
    const double inside = t->form.support * (1 - 1e-9), w0 = sph_kernel_w(&t->form, 0);
    double lowest = 0, at = 0;

    for (int i = 0; i <= POINTS; i++) {
        const double q = t->form.support * i / POINTS, w = sph_kernel_w(&t->form, q);
        if (w < lowest) {
            lowest = w;
            at = q;
        }
    }
    if (sph_kernel_w(&t->form, t->form.support) != 0 ||
        sph_kernel_dw(&t->form, t->form.support) != 0) {
        say(t->subject, VERDICT_FAIL, "is not 0 at the support %g in %d dimensions",
            t->form.support, t->dim);
        t->failed = true;
    }
    if (lowest < -1e-12 * w0)
        say(t->subject, VERDICT_NOTE, "W is negative in %d dimensions: %.3g W(0) at q = %g", t->dim,
            lowest / w0, at);
    if (fabs(sph_kernel_w(&t->form, inside)) > 1e-6 * w0)
        say(t->subject, VERDICT_NOTE,
            "W jumps to 0 at the support in %d dimensions, from %.3g W(0)", t->dim,
            sph_kernel_w(&t->form, inside) / w0);
    if (fabs(sph_kernel_dw(&t->form, inside)) > 1e-6 * w0)
        say(t->subject, VERDICT_NOTE, "the slope of W jumps to 0 at the support in %d dimensions",
            t->dim);
}

static void try_lanes(struct tried *t, size_t set, bool compiled_in)
{
    double q[POINTS], w[POINTS], dw[POINTS], dw_q[POINTS];
    const struct lanes_out out = {w, dw, dw_q};
    const double scale = fabs(sph_kernel_w(&t->form, 0));
    const int floats = lanes_of_floats(set);
    const double bar = floats ? FLOATS_TOLERANCE : LANES_TOLERANCE;

    for (int i = 0; i < POINTS; i++) /* and beyond the support */
        q[i] = (float)(1.25 * t->form.support * i / POINTS);
    lanes_kernel(set, &t->form, q, compiled_in, &out, POINTS);
    for (int i = 0; i < POINTS && !t->failed; i++) {
        const double value = sph_kernel_w(&t->form, q[i]), slope = sph_kernel_dw(&t->form, q[i]);
        const double one = fabs(w[i] - value) / scale;
        const double other =
            fmax(fabs(dw[i] - slope), i ? fabs(dw_q[i] * q[i] - slope) : 0) / scale;
        t->lanes[floats] = fmax(t->lanes[floats], fmax(one, other));
        if (one <= bar && other <= 100 * bar)
            continue;
        say(t->subject, VERDICT_FAIL,
            "vector form (%s) differs at q = %g in %d dimensions: W %.9g against %.9g, slope %.9g "
            "(%.9g by q) against %.9g",
            lanes_name(set), q[i], t->dim, w[i], value, dw[i], dw_q[i] * q[i], slope);
        t->failed = true;
    }
}

static void try_dimension(struct tried *t)
{
    struct error e = {0};
    double error;

    if (kernel_form_make(&t->form, t->kernel, t->dim, &e)) {
        say(t->subject, VERDICT_FAIL, "%s", e.text);
        t->failed = true;
        return;
    }
    error = fabs(moment(t, 0) - 1);
    t->integral = fmax(t->integral, error);
    t->second = moment(t, 2);
    if (!(error <= INTEGRAL_TOLERANCE)) {
        say(t->subject, VERDICT_FAIL, "integral in %d dimensions is %.12g, not 1", t->dim,
            moment(t, 0));
        t->failed = true;
    } else if (!isfinite(t->second)) {
        say(t->subject, VERDICT_FAIL, "second moment in %d dimensions is %g", t->dim, t->second);
        t->failed = true;
    }
    if (!t->failed)
        try_slope(t);
    if (!t->failed)
        try_ends(t);
    for (size_t set = 0; set < lanes_count(); set++)
        for (int compiled_in = 0; compiled_in < 2; compiled_in++)
            try_lanes(t, set, compiled_in);
    kernel_form_fini(&t->form);
}

void check_integral(const struct subject *s)
{
    struct tried t = {.subject = s, .kernel = entry_kernel(s->entry)};
    char dims[40], moments[80] = "";
    size_t n = 0;

    for (t.dim = 1; t.dim <= 3; t.dim++) {
        if (!subject_works_in(s, t.dim))
            continue;
        stage(s, "the kernel in %d dimensions", t.dim);
        try_dimension(&t);
        if (n < sizeof(moments))
            n += (size_t)snprintf(moments + n, sizeof(moments) - n, "%s%.4g", n ? ", " : "",
                                  t.second);
    }
    if (t.failed)
        return;
    subject_dims(s, dims, sizeof(dims));
    say(s, VERDICT_OK, "integral 1 in %s (error %.1g), second moment %s h^2", dims, t.integral,
        moments);
    say(s, VERDICT_OK, "slope is the derivative of W (error %.1g), both 0 at the support", t.slope);
    say(s, VERDICT_OK, "vector forms up to %s give the same (difference %.1g; in floats %.1g)",
        lanes_name(lanes_count() - 2), t.lanes[0], t.lanes[1]);
}
