/* test_descriptors.c -- descriptors that contradict themselves are refused with one sentence that
 * names file, item and field; whatever their numbers are, none crashes. */
#include "config.h"

#include "mock.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

struct slip {
    enum kind kind;
    const char *says;
    uint32_t *number;
    uint32_t value;
    double *real;
    double real_value;
    const char **text;
    const char *text_value;
    void *pointer; /* a pointer of any type: set byte by byte */
    const void *pointer_value;
};
#define NUMBER(place, n) .number = &(place), .value = (n)
#define REAL(place, x) .real = &(place), .real_value = (x)
#define TEXT(place, s) .text = &(place), .text_value = (s)
#define POINTER(place, p) .pointer = (void *)&(place), .pointer_value = (p)

/* The function gets a body for devices: its property 0 is then read at the sources too. */
static bool with_device;

static void add_device(void)
{
    mock.function.device = &mock.device;
    mock.prop[0].access = SPH_DST_READ | SPH_SRC_READ;
}

/* The function gets a body for devices of `after`: `again` is then read too. */
static bool with_point;

static sph_status create_nothing(const sph_host *host, const sph_config *config, uint32_t dim,
                                 void **out)
{
    (void)host;
    (void)config;
    (void)dim;
    (void)out;
    return SPH_OK;
}

static void add_point(void)
{
    mock.function.after = mock.function.run;
    mock.function.device_after = &mock.point;
    mock.life.create = create_nothing;
    mock.prop[2].access = SPH_DST_UPDATE;
}

static void each_is_refused(const struct slip *slips, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const char *why;
        mock_reset(slips[i].kind);
        if (with_device)
            add_device();
        if (with_point)
            add_point();
        if (slips[i].number)
            *slips[i].number = slips[i].value;
        if (slips[i].real)
            *slips[i].real = slips[i].real_value;
        if (slips[i].text)
            *slips[i].text = slips[i].text_value;
        if (slips[i].pointer)
            memcpy(slips[i].pointer, &slips[i].pointer_value, sizeof slips[i].pointer_value);
        why = mock_refusal();
        if (!why || !strstr(why, slips[i].says))
            fail_msg("%s, not %s", why ? why : "accepted", slips[i].says);
        assert_non_null(strstr(why, MOCK_FILE));
        assert_non_null(strstr(why, kind_label[slips[i].kind]));
        assert_null(strchr(why, '\n'));
    }
}
#define ALL_REFUSED(slips) each_is_refused((slips), sizeof(slips) / sizeof((slips)[0]))

static void faultless_ones_are_taken(void **state)
{
    (void)state;
    mock_reset(KIND_COUNT);
    const char *why = mock_refusal();
    if (why)
        fail_msg("%s", why);
    assert_int_equal(mock.finished, 1);
    mock.function.shape = SPH_POINT;
    assert_null(mock_refusal());
}

static void items(void **state)
{
    static char long_name[100];
    const struct slip slips[] = {
        {KIND_EXACT, "name of the item is missing", TEXT(mock.item.name, NULL)},
        {KIND_EXACT, "name of the item is missing", TEXT(mock.item.name, "")},
        {KIND_EXACT, "name of the item is not a word", TEXT(mock.item.name, "Thing")},
        {KIND_EXACT, "name of the item is not a word", TEXT(mock.item.name, "a b")},
        {KIND_EXACT, "name of the item is not a word", TEXT(mock.item.name, "th\xc3\xbcng")},
        {KIND_EXACT, "name of the item is not a word", TEXT(mock.item.name, long_name)},
        {KIND_EXACT, "\"thing\": dims is 0", NUMBER(mock.item.dims, 0)},
        {KIND_EXACT, "\"thing\": dims has unknown bits", NUMBER(mock.item.dims, 0x10)},
        {KIND_EXACT, "\"thing\": dims has unknown bits", NUMBER(mock.item.dims, 1)},
        {KIND_EXACT, "\"thing\": doc is missing", TEXT(mock.item.doc, NULL)},
        {KIND_EXACT, "\"thing\": doc is missing", TEXT(mock.item.doc, "")},
        {KIND_EXACT, "\"thing\": doc is missing", TEXT(mock.item.doc, "two\nlines")},
        {KIND_EXACT, "\"thing\": doc is missing", TEXT(mock.item.doc, "bad \xff byte")},
        {KIND_EXACT, "size of the item is 8 bytes", NUMBER(mock.item.size, 8)},
        {KIND_EXACT, "absurd", NUMBER(mock.item.size, 0x10000001)},
        {KIND_EXACT, "list of props says 3 elements, but its data is NULL",
         POINTER(mock.item.props.data, NULL)},
        {KIND_EXACT, "list of props has a stride of 4", NUMBER(mock.item.props.stride, 4)},
        {KIND_EXACT, "list of params says 4000000000", NUMBER(mock.item.params.count, 4000000000u)},
    };

    (void)state;
    memset(long_name, 'a', sizeof(long_name) - 1);
    ALL_REFUSED(slips);
}

static void properties(void **state)
{
    static const struct slip slips[] = {
        {KIND_EXACT, "name of props[1] is not a word", TEXT(mock.prop[1].name, NULL)},
        {KIND_EXACT, "name of props[1] is not a word", TEXT(mock.prop[1].name, "p*")},
        {KIND_EXACT, "property \"rho\" is declared twice", TEXT(mock.prop[1].name, "rho")},
        {KIND_EXACT, "type of property \"p\" is 0", NUMBER(mock.prop[1].type, 0)},
        {KIND_EXACT, "type of property \"p\" is 7", NUMBER(mock.prop[1].type, 7)},
        {KIND_EXACT, "access of property \"rho\" is none", NUMBER(mock.prop[0].access, 0)},
        {KIND_EXACT, "access of property \"rho\" has unknown bits",
         NUMBER(mock.prop[0].access, 257)},
        {KIND_EXACT, "more than one of write, sum, max and min", NUMBER(mock.prop[0].access, 12)},
        {KIND_EXACT, "is for the sweep alone (SPH_DST_SWEEP), but an exact solution has none",
         NUMBER(mock.prop[0].access, SPH_DST_READ | SPH_DST_SWEEP)},
        {KIND_EXACT, "which goes with SPH_DST_READ and nothing that sets it",
         NUMBER(mock.prop[0].access, SPH_DST_UPDATE | SPH_DST_SWEEP)},
        {KIND_FUNCTION, "which goes with SPH_DST_READ and nothing that sets it",
         NUMBER(mock.prop[0].access, SPH_SRC_READ | SPH_DST_SWEEP)},
        {KIND_EXACT, "unit of property \"p\" is not", TEXT(mock.prop[1].unit, "\n")},
        {KIND_EXACT, "doc of property \"p\" is not", TEXT(mock.prop[1].doc, "\xc3")},
        {KIND_EXACT, "read at the sources", NUMBER(mock.prop[0].access, SPH_SRC_READ)},
        {KIND_EOS, "read at the sources", NUMBER(mock.prop[0].access, SPH_SRC_READ)},
    };

    (void)state;
    ALL_REFUSED(slips);
}

static void parameters(void **state)
{
    static const struct slip slips[] = {
        {KIND_EXACT, "name of parameter 0 is not a word", TEXT(mock.param[0].name, "")},
        {KIND_EXACT, "parameter \"solver\" is declared twice", TEXT(mock.param[0].name, "solver")},
        {KIND_EXACT, "default of parameter \"gamma\" is 11", REAL(mock.param[0].def, 11)},
        {KIND_EXACT, "default of parameter \"gamma\" is 0", REAL(mock.param[0].def, 0)},
        {KIND_EXACT, "default of parameter \"gamma\" is inf", REAL(mock.param[0].def, INFINITY)},
        {KIND_EXACT, "range of parameter \"gamma\" is not a number", REAL(mock.param[0].min, NAN)},
        {KIND_EXACT, "choices of parameter \"solver\"", TEXT(mock.param[1].choices, "")},
        {KIND_EXACT, "choices of parameter \"solver\"", TEXT(mock.param[1].choices, "a||b")},
        {KIND_EXACT, "choices of parameter \"solver\"", TEXT(mock.param[1].choices, "a|b|")},
        {KIND_EXACT, "choices of parameter \"solver\"", TEXT(mock.param[1].choices, "a|b|a")},
        {KIND_EXACT, "default of parameter \"solver\" is 2", REAL(mock.param[1].def, 2)},
        {KIND_EXACT, "default of parameter \"solver\" is 0.5", REAL(mock.param[1].def, .5)},
    };

    (void)state;
    ALL_REFUSED(slips);
}

/* What a sweep works in, and the places of its neighbours. */
static void loops(void **state)
{
    static const struct slip slips[] = {
        {KIND_FUNCTION, "reals is 4, which this sph does not know", NUMBER(mock.function.reals, 4)},
        {KIND_FUNCTION, "reals is 4294967295", NUMBER(mock.function.reals, ~0u)},
        {KIND_FUNCTION, "frozen is 1, but over names no property", NUMBER(mock.function.frozen, 1)},
        {KIND_FUNCTION, "frozen is 2, neither 0 nor 1", NUMBER(mock.function.frozen, 2),
         TEXT(mock.function.over, "rho")},
        {KIND_FUNCTION, "over is \"X\", which is not declared as a vector",
         TEXT(mock.function.over, "X")},
        {KIND_FUNCTION, "over is \"rho\", which is not declared as a vector",
         TEXT(mock.function.over, "rho")},
        {KIND_FUNCTION, "over is \"?\"", TEXT(mock.function.over, "two words\n")},
        {KIND_FUNCTION, "over is \"?\"", TEXT(mock.function.over, "")},
        {KIND_FUNCTION, "read of destinations and sources", TEXT(mock.function.over, "rho"),
         NUMBER(mock.prop[0].type, SPH_VECTOR)},
        {KIND_FUNCTION, "over is set, but a point function has no neighbours",
         TEXT(mock.function.over, "rho"), NUMBER(mock.function.shape, SPH_POINT)},
    };

    (void)state;
    ALL_REFUSED(slips);
    /* A vector that is read on one side only; on both, it will do. */
    const uint32_t access[] = {SPH_DST_READ, SPH_SRC_READ, SPH_DST_WRITE | SPH_SRC_READ,
                               SPH_DST_READ | SPH_SRC_READ};
    for (int k = 0; k < 4; k++) {
        mock_reset(KIND_FUNCTION);
        mock.function.over = "rho";
        mock.function.frozen = k % 2 ? 1 : 0;
        mock.function.reals = SPH_F64 | SPH_F32;
        mock.function.reductions = (sph_list)SPH_NO_LIST; /* rho is theirs, and a scalar */
        mock.prop[0].type = SPH_VECTOR;
        mock.prop[0].access = access[k];
        const char *why = mock_refusal();
        assert_true(k < 3 ? why && strstr(why, "read of destinations and sources") : !why);
    }
}

static void device_bodies(void **state)
{
    static char endless[(1u << 20) + 1];
    const struct slip slips[] = {
        {KIND_FUNCTION, "size of the device body is 8 bytes", NUMBER(mock.device.size, 8)},
        {KIND_FUNCTION, "reach of the device body is 3", NUMBER(mock.device.reach, 3)},
        {KIND_FUNCTION, "reach of the device body is symmetric, that of the function gather",
         NUMBER(mock.device.reach, SPH_SYMMETRIC)},
        {KIND_FUNCTION, "self of the device body is 2", NUMBER(mock.device.self, 2)},
        {KIND_FUNCTION, "text of the device body is missing", TEXT(mock.device.text, NULL)},
        {KIND_FUNCTION, "text of the device body is missing", TEXT(mock.device.text, "")},
        {KIND_FUNCTION, "text of the device body is longer", TEXT(mock.device.text, endless)},
        {KIND_FUNCTION, "file of the device body's text is missing", TEXT(mock.device.file, NULL)},
        {KIND_FUNCTION, "file of the device body's text is missing", TEXT(mock.device.file, "\n")},
        {KIND_FUNCTION, "file of the device body's prelude is missing",
         TEXT(mock.device.prelude, "#define A")},
        {KIND_FUNCTION, "i[0] of the device body has no name", TEXT(mock.value[0].name, NULL)},
        {KIND_FUNCTION, "j[0] of the device body has no name", TEXT(mock.value[1].name, "a b")},
        {KIND_FUNCTION, "sum[0] of the device body has no name", TEXT(mock.value[2].name, "sph_w")},
        {KIND_FUNCTION, "min of the device body: \"least\" is property 3, but 3 are declared",
         NUMBER(mock.value[3].index, 3)},
        {KIND_FUNCTION, "type of \"most\" is 2, that of the property \"p\" 1",
         NUMBER(mock.value[4].type, SPH_VECTOR)},
        {KIND_FUNCTION, "type of \"most\" is 1, that of the property \"again\" 5",
         NUMBER(mock.value[4].index, 2)},
        {KIND_FUNCTION, "property \"p\" is not declared as read at the destination",
         NUMBER(mock.value[0].index, 1)},
        {KIND_FUNCTION, "property \"p\" is not declared as read at the sources",
         NUMBER(mock.value[1].index, 1)},
        {KIND_FUNCTION, "property \"rho\" is not declared as written",
         NUMBER(mock.value[2].index, 0)},
        {KIND_FUNCTION, "param of the device body: \"gamma\" is parameter 3, but 3 are declared",
         NUMBER(mock.value[5].index, 3)},
        {KIND_FUNCTION, "list of i of the device body has a stride of 4",
         NUMBER(mock.device.i.stride, 4)},
        {KIND_FUNCTION, "list of param of the device body says 4000000000",
         NUMBER(mock.device.param.count, 4000000000u)},
    };

    (void)state;
    memset(endless, ' ', sizeof(endless) - 1);
    with_device = true;
    ALL_REFUSED(slips);
    mock_reset(KIND_FUNCTION);
    add_device();
    assert_null(mock_refusal());
    mock.device.i = (sph_list){mock.value, 2, sizeof(mock.value[0])};
    assert_non_null(strstr(mock_refusal(), "i of the device body names \"rho\" twice"));
    mock_reset(KIND_FUNCTION);
    mock.function.device = &mock.device;
    mock.function.shape = SPH_POINT;
    assert_non_null(strstr(mock_refusal(), "\"thing\": device is set, but the shape is not pair"));
    with_device = false;
}

static void bodies_of_points(void **state)
{
    const struct slip slips[] = {
        {KIND_FUNCTION, "size of the device_after is 8 bytes", NUMBER(mock.point.size, 8)},
        {KIND_FUNCTION, "h of device_after is 2, neither 0 nor 1", NUMBER(mock.point.h, 2)},
        {KIND_FUNCTION, "text of device_after is missing", TEXT(mock.point.text, "")},
        {KIND_FUNCTION, "file of device_after's text is missing", TEXT(mock.point.file, NULL)},
        {KIND_FUNCTION, "file of device_after's prelude is missing",
         TEXT(mock.point.prelude, "#define A")},
        {KIND_FUNCTION, "in[0] of device_after has no name", TEXT(mock.at[0].name, "sph_w")},
        {KIND_FUNCTION, "state[0] of device_after has no name", TEXT(mock.at[4].name, "1a")},
        {KIND_FUNCTION, "lists of device_after name \"rho\" twice", TEXT(mock.at[3].name, "rho")},
        {KIND_FUNCTION, "in of device_after: \"rho\" is property 3, but 3 are declared",
         NUMBER(mock.at[0].index, 3)},
        {KIND_FUNCTION,
         "inout of device_after: type of \"again\" is 1, that of the property "
         "\"again\" 5; it must be the same, and no int64",
         NUMBER(mock.at[2].type, SPH_SCALAR)},
        {KIND_FUNCTION, "out of device_after: property \"rho\" is not declared as written",
         NUMBER(mock.at[1].index, 0)},
        {KIND_FUNCTION, "in of device_after: property \"rho\" is for the sweep alone",
         NUMBER(mock.prop[0].access, SPH_DST_READ | SPH_DST_SWEEP)},
        {KIND_FUNCTION, "in of device_after: property \"rho\" is not declared as read",
         NUMBER(mock.prop[0].access, SPH_SRC_READ)},
        {KIND_FUNCTION, "param of device_after: \"gamma\" is parameter 3, but 3 are declared",
         NUMBER(mock.at[3].index, 3)},
        {KIND_FUNCTION, "state of device_after: \"own\" is number 4096, which is absurd",
         NUMBER(mock.at[4].index, 4096)},
        {KIND_FUNCTION, "state of device_after is read, but the item has no life",
         POINTER(mock.function.life, NULL)},
        {KIND_FUNCTION, "fail[0] of device_after is not one line", TEXT(mock.fail[0], "a\nb")},
        {KIND_FUNCTION, "list of in of device_after has a stride of 4",
         NUMBER(mock.point.in.stride, 4)},
        {KIND_FUNCTION, "device_after is set, but after is NULL",
         POINTER(mock.function.after, NULL)},
        {KIND_FUNCTION, "device_run is set, but the shape is not point",
         POINTER(mock.function.device_run, &mock.point)},
        {KIND_FUNCTION, "device_before is set, but before is NULL",
         POINTER(mock.function.device_before, &mock.point)},
    };

    (void)state;
    with_point = true;
    ALL_REFUSED(slips);
    mock_reset(KIND_FUNCTION);
    add_point();
    assert_null(mock_refusal());
    mock.at[0].name = "h"; /* a name like any other */
    assert_null(mock_refusal());
    mock.point.h = 1;
    assert_non_null(strstr(mock_refusal(), "in of device_after names \"h\", which is the smooth"));
    mock_reset(KIND_FUNCTION);
    add_point();
    mock.at[1] = (sph_device_value){"other", 2, SPH_INT32};
    assert_non_null(strstr(
        mock_refusal(), "lists of device_after have property \"again\" twice, in out and inout"));
    mock.point.in.count = 0;
    mock.at[1] = (sph_device_value){"p", 1, SPH_SCALAR};
    mock.at[2] = (sph_device_value){"rho", 0, SPH_SCALAR};
    assert_non_null(strstr(mock_refusal(),
                           "inout of device_after: property \"rho\" is not declared "
                           "as written"));
    with_point = false;
}

/* Alone, it reads nothing that is not declared so, and overwrites nothing that adds up. */
static void bodies_of_eos(void **state)
{
    (void)state;
    mock_reset(KIND_EOS);
    mock.eos.device = &mock.point;
    mock.life.create = create_nothing;
    mock.prop[2].access = SPH_DST_UPDATE;
    assert_null(mock_refusal());
    mock.point.h = 1;
    assert_non_null(strstr(mock_refusal(), "h of device is 1, but it is not of a pair function"));
    mock.point.h = 0;
    mock.prop[1].access = SPH_DST_SUM;
    mock.prop[2].access = SPH_DST_WRITE | SPH_DST_READ;
    assert_non_null(strstr(mock_refusal(), "out of device: property \"p\" is declared as one that "
                                           "others write too: it belongs into inout"));
    mock.prop[1].access = SPH_DST_WRITE;
    mock.at[0] = (sph_device_value){"p", 1, SPH_SCALAR};
    mock.point.out.count = 0;
    assert_non_null(
        strstr(mock_refusal(), "in of device: property \"p\" is not declared as read at the"));
}

static void functions(void **state)
{
    static const struct slip slips[] = {
        {KIND_FUNCTION, "size of the descriptor is 40", NUMBER(mock.function.size, 40)},
        {KIND_FUNCTION, "shape is 3", NUMBER(mock.function.shape, 3)},
        {KIND_FUNCTION, "reach is 0", NUMBER(mock.function.reach, 0)},
        {KIND_FUNCTION, "reach_scale is -1", REAL(mock.function.reach_scale, -1)},
        {KIND_FUNCTION, "reach_scale is nan", REAL(mock.function.reach_scale, NAN)},
        {KIND_FUNCTION, "reach_scale is 1e+06", REAL(mock.function.reach_scale, 1e6)},
        {KIND_FUNCTION, "unfinished is set, but max_sweeps is 0",
         NUMBER(mock.function.max_sweeps, 0)},
        {KIND_FUNCTION, "max_sweeps is 4294967295", NUMBER(mock.function.max_sweeps, ~0u)},
        {KIND_FUNCTION, "unfinished names no property", TEXT(mock.function.unfinished, NULL)},
        {KIND_FUNCTION, "unfinished is \"u\", which is not", TEXT(mock.function.unfinished, "u")},
        {KIND_FUNCTION, "unfinished is \"p\", which is not", TEXT(mock.function.unfinished, "p")},
        {KIND_FUNCTION, "not declared as a written int32",
         NUMBER(mock.prop[2].access, SPH_DST_READ)},
        {KIND_FUNCTION, "rate of \"u\" is \"a\", which is not", TEXT(mock.rate[0].rate, "a")},
        {KIND_FUNCTION, "rate of \"u\" is \"rho\", which is not", TEXT(mock.rate[0].rate, "rho")},
        {KIND_FUNCTION, "\"p\" is its own rate", TEXT(mock.rate[0].property, "p")},
        {KIND_FUNCTION, "rates[0] does not name", TEXT(mock.rate[0].property, NULL)},
        {KIND_FUNCTION, "are of different types", TEXT(mock.rate[0].property, "again")},
        {KIND_FUNCTION, "kind of the rate of \"u\" is 9", NUMBER(mock.rate[0].kind, 9)},
        {KIND_FUNCTION, "name of reductions[0]", TEXT(mock.reduction[0].name, NULL)},
        {KIND_FUNCTION, "is of \"T\", which is not declared",
         TEXT(mock.reduction[0].property, "T")},
        {KIND_FUNCTION, "names no property", TEXT(mock.reduction[0].property, NULL)},
        {KIND_FUNCTION, "which is not a scalar", TEXT(mock.reduction[0].property, "again")},
        {KIND_FUNCTION, "op of reduction \"least\" is 0", NUMBER(mock.reduction[0].op, 0)},
        {KIND_FUNCTION, "use of reduction \"least\" is 4", NUMBER(mock.reduction[0].use, 4)},
        {KIND_FUNCTION, "but is no minimum", NUMBER(mock.reduction[0].op, SPH_REDUCE_MAX)},
        {KIND_FUNCTION, "but no sum", NUMBER(mock.reduction[0].use, SPH_USE_INTERNAL)},
        {KIND_FUNCTION, "size of the life is 0", NUMBER(mock.life.size, 0)},
    };

    (void)state;
    ALL_REFUSED(slips);
}

static void kernels(void **state)
{
    static const struct slip slips[] = {
        {KIND_KERNEL, "integral in 1 dimensions is 2.4", REAL(mock.kernel.norm[1], .4)},
        {KIND_KERNEL, "integral in 3 dimensions is 1.0000000",
         REAL(mock.kernel.norm[3], .0795774716)},
        {KIND_KERNEL, "norm[2] is nan", REAL(mock.kernel.norm[2], NAN)},
        {KIND_KERNEL, "norm[2] is 0", REAL(mock.kernel.norm[2], 0)},
        {KIND_KERNEL, "support is inf", REAL(mock.kernel.support, INFINITY)},
        {KIND_KERNEL, "support is 3, but the largest knot", REAL(mock.kernel.support, 3)},
        {KIND_KERNEL, "knot of terms[1][0] is 2, not within 0", REAL(mock.kernel.support, 1.5)},
        {KIND_KERNEL, "knot of terms[1][1] is -1", REAL(mock.term[1].knot, -1)},
        {KIND_KERNEL, "coef of terms[1][1] is not finite", REAL(mock.term[1].coef, NAN)},
        {KIND_KERNEL, "power of terms[1][0] is 1", NUMBER(mock.term[0].power, 1)},
        {KIND_KERNEL, "power of terms[1][0] is 4294967295", NUMBER(mock.term[0].power, ~0u)},
        {KIND_KERNEL, "terms[2] is empty", NUMBER(mock.kernel.terms[2].count, 0)},
        {KIND_KERNEL, "params: an item of this kind has none",
         POINTER(mock.kernel.item, &mock.item)},
        {KIND_KERNEL, "item is NULL", POINTER(mock.kernel.item, NULL)},
    };

    (void)state;
    ALL_REFUSED(slips);
}

static void recipes(void **state)
{
    static const struct slip slips[] = {
        {KIND_SCHEME, "kernel is not a name", TEXT(mock.scheme.kernel, "")},
        {KIND_SCHEME, "integrator is not a name", TEXT(mock.scheme.integrator, "K D K")},
        {KIND_SCHEME, "cfl is 0", REAL(mock.scheme.cfl, 0)},
        {KIND_SCHEME, "cfl is inf", REAL(mock.scheme.cfl, INFINITY)},
        {KIND_SCHEME, "steps is empty", NUMBER(mock.scheme.steps.count, 0)},
        {KIND_SCHEME, "at of steps[0]", TEXT(mock.step[0].at, "later")},
        {KIND_SCHEME, "at of steps[0]", TEXT(mock.step[0].at, NULL)},
        {KIND_SCHEME, "kind of steps[1]", TEXT(mock.step[1].kind, "sph.kernel/0")},
        {KIND_SCHEME, "steps[0] names no function", TEXT(mock.step[0].name, NULL)},
        {KIND_BOUNDARY, "steps is empty", NUMBER(mock.boundary.steps.count, 0)},
        {KIND_BOUNDARY, "kind of steps[0]", TEXT(mock.step[0].kind, NULL)},
        {KIND_EOS, "inverse_props: none is written", NUMBER(mock.inverse_prop[0].access, 1)},
        {KIND_EOS, "inverse_props: none is written", NUMBER(mock.eos.inverse_props.count, 0)},
        {KIND_EOS, "props: none is written", NUMBER(mock.item.props.count, 1)},
        {KIND_EXACT, "props: none is written", NUMBER(mock.item.props.count, 0)},
    };

    (void)state;
    ALL_REFUSED(slips);
}

static void expect(const char *says)
{
    const char *why = mock_refusal();

    if (!why || !strstr(why, says) || !strstr(why, MOCK_FILE))
        fail_msg("%s, not %s", why ? why : "accepted", says);
}

static void missing_code(void **state)
{
    (void)state;
    mock_reset(KIND_FUNCTION);
    mock.function.run = NULL;
    expect("function \"thing\": run is NULL");
    mock_reset(KIND_EOS);
    mock.eos.run = NULL;
    expect("equation of state \"thing\": run is NULL");
    mock_reset(KIND_EOS);
    mock.eos.inverse = NULL;
    expect("inverse is NULL, but inverse_props are declared");
    mock_reset(KIND_EXACT);
    mock.exact.run = NULL;
    expect("exact solution \"thing\": run is NULL");
}

static void plugins(void **state)
{
    (void)state;
    mock_reset(KIND_COUNT);
    mock.plugin.magic = 1;
    expect("magic number 0x00000001");
    mock_reset(KIND_COUNT);
    mock.plugin.abi_major = 7;
    expect("built for the plugin ABI 7.");
    expect("but this sph has 0.");
    mock_reset(KIND_COUNT);
    mock.plugin.abi_minor = 0;
    expect("built for the plugin ABI 0.0, but this sph has 0.");
    mock_reset(KIND_COUNT);
    mock.plugin.size = 20;
    expect("size of the plugin's descriptor is 20 bytes");
    mock_reset(KIND_COUNT);
    mock.plugin.name = "Mock";
    expect("name of the plugin");
    mock_reset(KIND_COUNT);
    mock.plugin.version = NULL;
    expect("version of the plugin");
    mock_reset(KIND_COUNT);
    mock.plugin.init = NULL;
    expect("init of the plugin is NULL");
    mock_reset(KIND_COUNT);
    mock.twice = 1;
    expect("function \"thing\" is registered twice");
    mock_reset(KIND_EOS);
    mock.kind_id = "sph.universe/0";
    expect("its init failed: kind \"sph.universe/0\" is unknown to this sph");
    mock.kind_id = "bad \xff";
    expect("is unknown to this sph");
}

static void starts(void **state)
{
    (void)state;
    mock_reset(KIND_FUNCTION);
    mock.prop[0].start = NAN; /* read: the scene must give it */
    assert_null(mock_refusal());
    mock.prop[1].access = SPH_DST_SUM;
    assert_null(mock_refusal());
    mock.prop[1].start = NAN;
    expect("start of property \"p\" is not a number");
}

/* -- Mutations -------- */

static uint32_t next_random(uint64_t *s)
{
    *s = *s * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*s >> 33);
}

/* Any of the numbers of any descriptor, set to anything: taken, or refused with one sentence; no
 * crash. A list's count may only fall or be absurd: behind its end lies what no host can know. */
static void mutations_do_no_harm(void **state)
{
    static const uint32_t odd[] = {0, 1, 2, 3, 4, 7, 8, 63, 64, 1024, 65537, 0x7fffffff, ~0u};
    static const double odd_real[] = {0, -1, 1, 1e-300, 1e300, NAN, INFINITY, -INFINITY, .5};
    uint32_t *const numbers[] = {
        &mock.prop[0].type,     &mock.prop[1].type,     &mock.prop[0].access,
        &mock.prop[2].access,   &mock.item.size,        &mock.item.dims,
        &mock.plain_item.dims,  &mock.life.size,        &mock.function.size,
        &mock.function.shape,   &mock.function.reach,   &mock.function.max_sweeps,
        &mock.eos.size,         &mock.kernel.size,      &mock.scheme.size,
        &mock.exact.size,       &mock.boundary.size,    &mock.rate[0].kind,
        &mock.reduction[0].op,  &mock.reduction[0].use, &mock.term[0].power,
        &mock.term[1].power,    &mock.plugin.size,      &mock.plugin.magic,
        &mock.plugin.abi_major, &mock.plugin.abi_minor};
    double *const reals[] = {&mock.prop[1].start,  &mock.param[0].def,   &mock.param[0].min,
                             &mock.param[0].max,   &mock.param[1].def,   &mock.function.reach_scale,
                             &mock.kernel.support, &mock.kernel.norm[1], &mock.kernel.norm[3],
                             &mock.term[0].coef,   &mock.term[0].knot,   &mock.term[1].knot,
                             &mock.scheme.cfl};
    sph_list *const lists[] = {&mock.item.props,       &mock.item.params,
                               &mock.function.rates,   &mock.function.reductions,
                               &mock.kernel.terms[2],  &mock.scheme.steps,
                               &mock.eos.inverse_props};
    uint64_t seed = 1;
    int refused = 0;

#define ANY(array) (array)[next_random(&seed) % (sizeof(array) / sizeof((array)[0]))]
    (void)state;
    for (int i = 0; i < 10000; i++) {
        const uint32_t slips = 1 + next_random(&seed) % 3;
        const char *why;
        mock_reset(KIND_COUNT);
        for (uint32_t k = 0; k < slips; k++) {
            const uint32_t where = next_random(&seed) % 8;
            sph_list *list = ANY(lists);
            uint32_t *number = ANY(numbers);
            double *real = ANY(reals);
            if (where < 4)
                *number = ANY(odd);
            else if (where < 6)
                *real = ANY(odd_real);
            else if (where < 7)
                list->count = next_random(&seed) % 2 ? 0 : 1025 + next_random(&seed);
            else
                list->stride =
                    next_random(&seed) % 2 ? next_random(&seed) % 8 : 65537 + next_random(&seed);
        }
        why = mock_refusal();
        if (!why)
            continue;
        refused++;
        assert_true(strlen(why) > 20 && !strchr(why, '\n'));
        assert_non_null(strstr(why, MOCK_FILE));
    }
    assert_true(refused > 5000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(faultless_ones_are_taken),
        cmocka_unit_test(items),
        cmocka_unit_test(properties),
        cmocka_unit_test(parameters),
        cmocka_unit_test(functions),
        cmocka_unit_test(loops),
        cmocka_unit_test(device_bodies),
        cmocka_unit_test(bodies_of_points),
        cmocka_unit_test(bodies_of_eos),
        cmocka_unit_test(kernels),
        cmocka_unit_test(recipes),
        cmocka_unit_test(missing_code),
        cmocka_unit_test(plugins),
        cmocka_unit_test(starts),
        cmocka_unit_test(mutations_do_no_harm),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
