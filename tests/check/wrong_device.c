/* wrong_device.c -- functions of pairs and of points with a body for devices: one of each is right, made
 * by pair-loop.h or point-loop.h, and uses all that a body may; in the others the text or the lists made by hand are not those
 * of the native loop. */
#include "device.macros.h"
#include "wrong.h"

#include <math.h>

enum { M, V, G, MASS, EDGES, SLOPE, SHEAR, NEAREST, LARGEST };
static const sph_prop props[] = {
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, 1),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_READ | SPH_SRC_READ, 0),
    SPH_PROP("g", "", "a matrix", SPH_MATRIX, SPH_DST_READ | SPH_SRC_READ, 0),
    SPH_PROP("mass", "", "a sum", SPH_SCALAR, SPH_DST_SUM, 3),
    SPH_PROP("edges", "", "a sum", SPH_SCALAR, SPH_DST_SUM, -1),
    SPH_PROP("slope", "", "a sum", SPH_VECTOR, SPH_DST_SUM, 0),
    SPH_PROP("shear", "", "a sum", SPH_MATRIX, SPH_DST_SUM, 0),
    SPH_PROP("nearest", "", "a minimum", SPH_SCALAR, SPH_DST_MIN, 1e9),
    SPH_PROP("largest", "", "a maximum", SPH_SCALAR, SPH_DST_MAX, 0),
};
enum { WEIGHT, SHARE };
static const sph_param params[] = {
    SPH_PARAM_CHOICE("weight", "a choice", 1.0, "no|yes"),
    SPH_PARAM("share", "", "a factor", 0.7, 0, 1),
};

#define SPH_LOOP whole
#define SPH_LOOP_I(S, V_, M_) S(m, M) V_(v, V) M_(g, G)
#define SPH_LOOP_J(S, V_, M_) SPH_LOOP_I(S, V_, M_)
#define SPH_LOOP_SUM(S, V_, M_) S(mass, MASS) S(edges, EDGES) V_(slope, SLOPE) M_(shear, SHEAR)
#define SPH_LOOP_MIN(S) S(nearest, NEAREST)
#define SPH_LOOP_MAX(S) S(largest, LARGEST)
#define SPH_LOOP_PARAM(P) P(weight, WEIGHT) P(share, SHARE)
#define SPH_LOOP_BODY "device.body.h"
#define SPH_LOOP_DEVICE whole_device
#define SPH_LOOP_PRELUDE "device.macros.h"
#include <sph/pair-loop.h>

/* The same body for other pairs. */
#define SPH_LOOP near_and_self
#define SPH_LOOP_I(S, V_, M_) S(m, M) V_(v, V) M_(g, G)
#define SPH_LOOP_J(S, V_, M_) SPH_LOOP_I(S, V_, M_)
#define SPH_LOOP_SUM(S, V_, M_) S(mass, MASS) S(edges, EDGES) V_(slope, SLOPE) M_(shear, SHEAR)
#define SPH_LOOP_MIN(S) S(nearest, NEAREST)
#define SPH_LOOP_MAX(S) S(largest, LARGEST)
#define SPH_LOOP_PARAM(P) P(weight, WEIGHT) P(share, SHARE)
#define SPH_LOOP_REACH SPH_GATHER
#define SPH_LOOP_SELF 1
#define SPH_LOOP_BODY "device.body.h"
#define SPH_LOOP_DEVICE self_device
#define SPH_LOOP_PRELUDE "device.macros.h"
#include <sph/pair-loop.h>

/* -- What a particle does alone -------- */

enum { A_M, A_SPEED, A_SHAPE, A_PULL, A_CALLS, A_ENERGY, A_STRESS };
static const sph_prop alone_props[] = {
    SPH_PROP("m", "kg", "mass", SPH_SCALAR, SPH_DST_READ, 1),
    SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_READ, 0),
    SPH_PROP("g", "", "a matrix", SPH_MATRIX, SPH_DST_READ, 0),
    SPH_PROP("pull", "", "a sum", SPH_VECTOR, SPH_DST_SUM, 0),
    SPH_PROP("calls", "", "a number", SPH_INT32, SPH_DST_UPDATE, 0),
    SPH_PROP("energy", "", "a number", SPH_SCALAR, SPH_DST_WRITE, 0),
    SPH_PROP("stress", "", "a tensor", SPH_SYM, SPH_DST_WRITE, 0),
};

#define SPH_POINT_LOOP alone
#define SPH_POINT_IN(P) P(scalar, m, A_M) P(vector, speed, A_SPEED) P(matrix, shape, A_SHAPE)
#define SPH_POINT_INOUT(P) P(vector, pull, A_PULL) P(int32, calls, A_CALLS)
#define SPH_POINT_OUT(P) P(scalar, energy, A_ENERGY) P(sym, stress, A_STRESS)
#define SPH_POINT_PARAM(P) P(weight, WEIGHT) P(share, SHARE)
#define SPH_POINT_FAIL "wrong-device: nothing is long"
#define SPH_POINT_BODY "point.body.h"
#define SPH_POINT_DEVICE alone_device
#define SPH_POINT_PRELUDE "device.macros.h"
#include <sph/point-loop.h>

/* -- Their copies, with one fault each -------- */

static sph_device_point alone_factor, alone_swapped, alone_failing, alone_broken;

static sph_device_body factor, reach, self, swapped, silent, broken;

#define FUNCTION(variable, name_, dims_, loop, body)                                               \
    static const sph_item variable##_item = {                                                      \
        SIZE(sph_item), (dims_), name_, "tries a device", "", SPH_LIST(params), SPH_LIST(props)};  \
    static const sph_function variable = {.size = SIZE(sph_function),                              \
                                          .shape = SPH_PAIR,                                       \
                                          .item = &variable##_item,                                \
                                          .run = loop,                                             \
                                          .reach = SPH_SYMMETRIC,                                  \
                                          .reach_scale = 1,                                        \
                                          .device = &(body)}
FUNCTION(f_whole, "every-word", SPH_ALL_DIMS, whole, whole_device);
FUNCTION(f_self, "with-self", SPH_ALL_DIMS, near_and_self, self_device);
FUNCTION(f_factor, "other-factor", SPH_DIM2, whole, factor);
FUNCTION(f_reach, "other-reach", SPH_DIM3, whole, reach);
FUNCTION(f_self_less, "without-self", SPH_DIM1, near_and_self, self);
FUNCTION(f_swapped, "swapped-values", SPH_DIM2, whole, swapped);
FUNCTION(f_silent, "no-maximum", SPH_DIM2, whole, silent);
FUNCTION(f_broken, "no-such-word", SPH_DIM2, whole, broken);

#define ALONE(variable, name_, dims_, body)                                                        \
    static const sph_item variable##_item = {SIZE(sph_item),         (dims_), name_,               \
                                             "tries a device alone", "",      SPH_LIST(params),    \
                                             SPH_LIST(alone_props)};                               \
    static const sph_function variable = {.size = SIZE(sph_function),                              \
                                          .shape = SPH_POINT,                                      \
                                          .item = &variable##_item,                                \
                                          .run = alone,                                            \
                                          .device_run = &(body)}
ALONE(a_whole, "alone-every-word", SPH_ALL_DIMS, alone_device);
ALONE(a_factor, "alone-other-factor", SPH_DIM2, alone_factor);
ALONE(a_swapped, "alone-swapped-values", SPH_DIM3, alone_swapped);
ALONE(a_failing, "alone-failing", SPH_DIM1, alone_failing);
ALONE(a_broken, "alone-no-such-word", SPH_DIM2, alone_broken);

static const sph_device_value swapped_param[] = {{"share", WEIGHT, 0}, {"weight", SHARE, 0}};

/* A text, and what is put behind it. */
static void append(char *out, size_t size, const char *text, const char *more)
{
    size_t k = 0;

    for (; k < size - 1 && *text; k++)
        out[k] = *text++;
    for (; k < size - 1 && *more; k++)
        out[k] = *more++;
    out[k] = 0;
}

static void make_copies(void)
{
    /* Wrong by 1e-11 of a term. */
    static const char other[] = "sph_add(mass, share * m_j * 1e-11);\n";
    static char text[4096], alone_text[4096];

    factor = reach = swapped = silent = broken = whole_device;
    self = self_device;
    append(text, sizeof(text), whole_device.text, other);
    factor.text = text;
    reach.reach = SPH_GATHER;
    self.self = 0;
    swapped.param = (sph_list)SPH_LIST(swapped_param);
    silent.text = "/* nothing */";
    broken.file = "broken.body.h";
    broken.text = "R q = r * hinv_i;\n\nsph_add(mass, q * no_such_word);\n";
    alone_factor = alone_swapped = alone_failing = alone_broken = alone_device;
    append(alone_text, sizeof(alone_text), alone_device.text, "energy *= 1.0 + 1e-12;\n");
    alone_factor.text = alone_text;
    alone_swapped.param = (sph_list)SPH_LIST(swapped_param);
    alone_failing.text = "if (m > 0.0)\n    sph_fail(0);\n";
    alone_broken.file = "broken.body.h";
    alone_broken.text = "\nenergy = no_such_word;\n";
}

static sph_status init(const sph_host *host)
{
    static const sph_function *const all[] = {
        &f_whole,  &f_self,  &f_factor, &f_reach,   &f_self_less, &f_swapped, &f_silent,
        &f_broken, &a_whole, &a_factor, &a_swapped, &a_failing,   &a_broken};

    make_copies();
    for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++) {
        const sph_status status = host->register_item(host, SPH_KIND_FUNCTION, all[i]);
        if (status != SPH_OK)
            return status;
    }
    return SPH_OK;
}

SPH_PLUGIN("wrong-device", "1.0", "BSD-3-Clause", "bodies for devices", init, NULL)
