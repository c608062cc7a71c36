/* test_plan.c -- a scene compiled against declarations: columns, state, passes, pairs of arrays, parameters,
 * rates, first state; and what is refused. The functions do nothing: a plan looks at declarations
 * alone. */
#include "config.h"

#include "rig.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SIZE(type) ((uint32_t)sizeof(type))
#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* -- What the test's plugin declares ------------------------------------------------------------- */

static sph_status nothing(const sph_batch *b)
{
    (void)b;
    return SPH_OK;
}

#define ITEM(variable, name, params)                                                               \
    static const sph_item variable##_item = {                                                      \
        SIZE(sph_item), SPH_ALL_DIMS, name, "a mock", "", params, SPH_LIST(variable##_props)}

static const sph_param sum_params[] = {SPH_PARAM("alpha", "", "", 1, 0, 10)};
static const sph_prop sum_props[] = {
    {"m", "kg", "", SPH_SCALAR, SPH_SRC_READ, NAN},
    {"rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_SUM, 0},
};
ITEM(sum, "sum", SPH_LIST(sum_params));
static const sph_function sum = {.size = SIZE(sph_function),
                                 .shape = SPH_PAIR,
                                 .item = &sum_item,
                                 .run = nothing,
                                 .reach = SPH_GATHER,
                                 .reach_scale = 1};

static const sph_param push_params[] = {SPH_PARAM("beta", "", "", 2, 1, 0),
                                        SPH_PARAM("alpha", "", "", 3, 0, 10),
                                        SPH_PARAM_CHOICE("form", "", 0, "even|odd")};
static const sph_prop push_props[] = {
    {"rho", "kg/m^d", "", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN},
    {"p", "J/m^d", "", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN},
    {"v", "m/s", "velocity", SPH_VECTOR, SPH_DST_READ | SPH_SRC_READ, 0},
    {"a", "m/s^2", "", SPH_VECTOR, SPH_DST_SUM, 0},
    {"near", "m", "", SPH_SCALAR, SPH_DST_MIN, INFINITY},
    {"last", "m", "", SPH_SCALAR, SPH_DST_UPDATE, 7},
    {"colour", "", "given or refused", SPH_SCALAR, SPH_SRC_READ, NAN},
    {"dt", "s", "", SPH_SCALAR, SPH_DST_WRITE, 0},
};
static const sph_rate push_rates[] = {{"v", "a", SPH_KICK, 0}};
static const sph_reduction push_reductions[] = {
    {"dt", "dt", SPH_REDUCE_MIN, SPH_USE_TIME_STEP},
};
ITEM(push, "push", SPH_LIST(push_params));
static const sph_function push = {.size = SIZE(sph_function),
                                  .shape = SPH_PAIR,
                                  .item = &push_item,
                                  .run = nothing,
                                  .reach = SPH_SYMMETRIC,
                                  .reach_scale = 1.5,
                                  .rates = SPH_LIST(push_rates),
                                  .reductions = SPH_LIST(push_reductions)};

static const sph_prop other_props[] = {{"b", "m/s^2", "", SPH_VECTOR, SPH_DST_WRITE, 0},
                                       {"v", "m/s", "velocity", SPH_VECTOR, SPH_DST_READ, 0}};
static const sph_rate other_rates[] = {{"v", "b", SPH_KICK, 0}};
ITEM(other, "other-rate", SPH_NO_LIST);
static const sph_function other = {.size = SIZE(sph_function),
                                   .shape = SPH_POINT,
                                   .item = &other_item,
                                   .run = nothing,
                                   .reach_scale = 1,
                                   .rates = SPH_LIST(other_rates)};

static const sph_prop lost_props[] = {{"b", "m/s^2", "", SPH_VECTOR, SPH_DST_WRITE, 0}};
ITEM(lost, "lost-rate", SPH_NO_LIST);
static const sph_function lost = {.size = SIZE(sph_function),
                                  .shape = SPH_POINT,
                                  .item = &lost_item,
                                  .run = nothing,
                                  .reach_scale = 1,
                                  .rates = SPH_LIST(other_rates)};

static const sph_prop mark_props[] = {{"once", "", "", SPH_SCALAR, SPH_DST_WRITE, 0}};
ITEM(mark, "mark", SPH_NO_LIST);
static const sph_function mark = {.size = SIZE(sph_function),
                                  .shape = SPH_POINT,
                                  .item = &mark_item,
                                  .run = nothing,
                                  .reach_scale = 1};

static const sph_prop clip_props[] = {
    {"p", "", "", SPH_SCALAR, SPH_DST_READ, 0},
    {"clipped", "", "", SPH_SCALAR, SPH_DST_UPDATE, 5},
    {"shown", "", "", SPH_SCALAR, SPH_DST_WRITE, 0},
};
ITEM(clip, "clip", SPH_NO_LIST);
static const sph_function clip = {.size = SIZE(sph_function),
                                  .shape = SPH_POINT,
                                  .item = &clip_item,
                                  .run = nothing,
                                  .reach_scale = 1};

static const sph_prop flat_props[] = {{"c", "", "", SPH_SCALAR, SPH_DST_WRITE, 0}};
static const sph_item flat_item = {SIZE(sph_item),      SPH_DIM2, "flat", "a mock", "", SPH_NO_LIST,
                                   SPH_LIST(flat_props)};
static const sph_function flat = {.size = SIZE(sph_function),
                                  .shape = SPH_POINT,
                                  .item = &flat_item,
                                  .run = nothing,
                                  .reach_scale = 1};

/* p = k rho u, and back. */
static sph_status gas_run(const sph_batch *b)
{
    (void)b;
    return SPH_OK;
}

static sph_status gas_inverse(const sph_batch *b)
{
    const double *rho = b->dst[0].data, *p = b->dst[1].data;
    double *u = b->dst[2].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        u[i] = p[i] / (b->param[0] * rho[i]);
    return SPH_OK;
}

static const sph_param gas_params[] = {SPH_PARAM("k", "", "", 2, 1, 9)};
static const sph_prop gas_props[] = {
    {"rho", "", "", SPH_SCALAR, SPH_DST_READ, NAN},
    {"u", "J/kg", "energy", SPH_SCALAR, SPH_DST_READ, NAN},
    {"p", "", "", SPH_SCALAR, SPH_DST_WRITE, 0},
};
static const sph_prop gas_inverse_props[] = {
    {"rho", "", "", SPH_SCALAR, SPH_DST_READ, NAN},
    {"p", "", "", SPH_SCALAR, SPH_DST_READ, NAN},
    {"u", "", "", SPH_SCALAR, SPH_DST_WRITE, 0},
};
ITEM(gas, "gas", SPH_LIST(gas_params));
static const sph_eos gas = {
    SIZE(sph_eos), 0, &gas_item, NULL, gas_run, gas_inverse, SPH_LIST(gas_inverse_props), NULL};

static const sph_step flow_steps[] = {
    SPH_STEP(SPH_AT_START, "mark"),  SPH_STEP(SPH_AT_EVALUATE, "sum"),
    SPH_STEP_EOS(SPH_AT_EVALUATE),   SPH_STEP(SPH_AT_EVALUATE, "push"),
    SPH_STEP(SPH_AT_FINISH, "clip"),
};
static const sph_rate flow_rates[] = {{"x", "v", SPH_DRIFT, 0}};
static const sph_item flow_item = {SIZE(sph_item), SPH_ALL_DIMS, "flow", "a mock", "",
                                   SPH_NO_LIST,    SPH_NO_LIST};
static const sph_scheme flow = {
    SIZE(sph_scheme),     0, &flow_item, "thing", "kdk", 0.25, SPH_LIST(flow_steps),
    SPH_LIST(flow_rates), 0, 0};

static const sph_item flat_scheme_item = {SIZE(sph_item), SPH_DIM2,   "flat-flow", "a mock", "",
                                          SPH_NO_LIST,    SPH_NO_LIST};
static const sph_scheme flat_flow = {SIZE(sph_scheme),
                                     0,
                                     &flat_scheme_item,
                                     "thing",
                                     "kdk",
                                     0.25,
                                     SPH_LIST(flow_steps),
                                     SPH_NO_LIST,
                                     0,
                                     0};

static const sph_step shore_steps[] = {
    SPH_STEP(SPH_AT_EVALUATE, "clip"),
    SPH_STEP(SPH_AT_START, "mark"),
};
static const sph_item shore_item = {SIZE(sph_item), SPH_ALL_DIMS, "shore", "a mock", "",
                                    SPH_NO_LIST,    SPH_NO_LIST};
static const sph_boundary shore = {SIZE(sph_boundary), 0, &shore_item, SPH_LIST(shore_steps)};

static const struct rig_items items = {{&sum, &push, &other, &lost, &mark, &clip, &flat, NULL},
                                       {&gas, NULL},
                                       {&flow, &flat_flow, NULL},
                                       {&shore, NULL},
                                       NULL};

/* -- Scenes -------------------------------------------------------------------------------------- */

#define HEAD                                                                                       \
    "{'dimensions':1,'domain':{'min':[0],'max':[1]},'materials':{'gas':{'eos':{'name':'gas'}}},"
#define FLUID_WITH(fields)                                                                         \
    "'fluid':{'material':'gas','fill':{'lattice':'square','in':{'box':{'min':[0],'max':[0.5]}},"   \
    "'count':10},'fields':{" fields "}"
#define FLUID FLUID_WITH("'rho':1,'u':2") ",'columns':{'colour':1}}"
/* No material. */
#define WALL                                                                                       \
    "'wall':{'fill':{'lattice':'square','in':{'box':{'min':[0.5],'max':[1]}},'count':4},"          \
    "'fields':{'rho':1},'columns':{'colour':1,'p':1}}"
#define ONE(scheme) HEAD "'particles':{" FLUID "},'scheme':" scheme ",'time':{'end':1}}"
#define TWO(scheme) HEAD "'particles':{" FLUID "," WALL "},'scheme':" scheme ",'time':{'end':1}}"
#define EDIT(edit) "{'name':'flow','edit':[" edit "]}"

static int column(const struct rig *r, size_t a, const char *name)
{
    return particles_find(&r->plan.array[a].p, name);
}

static const struct column *column_at(const struct rig *r, size_t a, const char *name)
{
    const int c = column(r, a, name);
    if (c < 0)
        fail_msg("no column \"%s\"", name);
    return &r->plan.array[a].p.column[c];
}

/* "mark(fluid) sum(fluid) ...", each with its moment's first letter before it if `moments`. */
static const char *passes(const struct rig *r)
{
    static char text[1024];
    text[0] = '\0';
    for (int moment = 0; moment < MOMENT_COUNT; moment++)
        for (size_t i = 0; i < r->plan.n_pass; i++)
            if ((int)r->plan.pass[i].moment == moment) {
                const size_t n = strlen(text);
                snprintf(text + n, sizeof text - n, "%s%c:%s", n ? " " : "", moment_name[moment][0],
                         r->plan.pass[i].name);
            }
    return text;
}

#define assert_passes(scheme, text)                                                                \
    do {                                                                                           \
        struct rig rig;                                                                            \
        rig_open(&rig, &items, ONE(scheme));                                                       \
        assert_string_equal(passes(&rig), text);                                                   \
        rig_close(&rig);                                                                           \
    } while (0)

/* -- Columns ------------------------------------------------------------------------------------- */

static void test_columns(void **state)
{
    static const char *const all[] = {"x",  "h",    "m",       "id",    "rho",  "u",
                                      "p",  "v",    "a",       "near",  "last", "colour",
                                      "dt", "once", "clipped", "shown", "a.0"};
    struct rig r;
    (void)state;
    rig_open(&r, &items, ONE("'flow'"));
    for (size_t i = 0; i < COUNT(all); i++)
        column_at(&r, 0, all[i]);
    /* ... and no other. */
    assert_int_equal(r.plan.array[0].p.n_column, COUNT(all));
    assert_int_equal(column_at(&r, 0, "v")->type, SPH_VECTOR);
    assert_int_equal(column_at(&r, 0, "v")->ncomp, 1);
    assert_string_equal(column_at(&r, 0, "v")->unit, "m/s");
    assert_true(column_at(&r, 0, "rho")->output);
    assert_false(column_at(&r, 0, "a.0")->output);
    assert_int_equal(r.plan.array[0].position, column(&r, 0, "x"));
    assert_int_equal(r.plan.array[0].velocity, column(&r, 0, "v"));
    rig_close(&r);
}

/* State: what must outlive an evaluation. */
static void test_state(void **state)
{
    static const char *const kept[] = {"x",   "h",    "m",      "id",   "u",       "v",    "a",
                                       "a.0", "last", "colour", "once", "clipped", "shown"};
    static const char *const made_anew[] = {"rho", "p", "near", "dt"};
    struct rig r;
    (void)state;
    rig_open(&r, &items, ONE("'flow'"));
    for (size_t i = 0; i < COUNT(kept); i++)
        if (!column_at(&r, 0, kept[i])->state)
            fail_msg("\"%s\" is no state", kept[i]);
    for (size_t i = 0; i < COUNT(made_anew); i++)
        if (column_at(&r, 0, made_anew[i])->state)
            fail_msg("\"%s\" is state", made_anew[i]);
    rig_close(&r);
}

/* The predictor-corrector keeps states, the leapfrog rates; nothing is kept that is not needed. */
static void test_integrator_columns(void **state)
{
    struct rig r;
    (void)state;
    rig_open(&r, &items,
             HEAD "'particles':{" FLUID "},'scheme':'flow','time':{'end':1,'integrator':'pec'}}");
    assert_true(column(&r, 0, "x.0") >= 0 && column(&r, 0, "v.0") >= 0);
    assert_true(column(&r, 0, "a.0") < 0 && column(&r, 0, "u.0") < 0);
    assert_true(column_at(&r, 0, "x.0")->state && column_at(&r, 0, "v.0")->state);
    rig_close(&r);
    rig_open(&r, &items, ONE("'flow'"));
    assert_true(column(&r, 0, "x.0") < 0 && column(&r, 0, "v.0") < 0 && column(&r, 0, "v.0") < 0);
    rig_close(&r);
}

static void test_rates(void **state)
{
    struct rig r;
    (void)state;
    rig_open(&r, &items, ONE("'flow'"));
    const struct plan_array *a = &r.plan.array[0];
    assert_int_equal(a->n_rate, 2);
    for (size_t i = 0; i < 2; i++) {
        const bool drifts = a->rate[i].property == column(&r, 0, "x");
        assert_int_equal(a->rate[i].kind, drifts ? SPH_DRIFT : SPH_KICK);
        assert_int_equal(a->rate[i].property, column(&r, 0, drifts ? "x" : "v"));
        assert_int_equal(a->rate[i].rate, column(&r, 0, drifts ? "v" : "a"));
    }
    rig_close(&r);
    /* An array that no function gives a rate stays where it is. */
    rig_open(&r, &items, TWO(EDIT("{'replace':'push','with':'push','to':'fluid'}")));
    assert_int_equal(r.plan.array[0].n_rate, 2);
    assert_int_equal(r.plan.array[1].n_rate, 1); /* x by v: push reads the wall's v */
    assert_true(column(&r, 1, "a") < 0 && column(&r, 1, "near") < 0);
    rig_close(&r);
    rig_refused(
        &items,
        "lost-rate(fluid) advances \"v\" with \"b\", but no function of the recipe declares "
        "the property \"v\"",
        ONE(EDIT("{'replace':'push','with':'lost-rate'}")));
    rig_refused(&items, "v has two rates", ONE(EDIT("{'insert':'other-rate','after':'push'}")));
}

/* -- Passes -------------------------------------------------------------------------------------- */

#define WHOLE "s:mark(fluid) e:sum(fluid) e:eos(fluid) e:push(fluid) f:clip(fluid)"

static void test_edits(void **state)
{
    (void)state;
    assert_passes("'flow'", WHOLE);
    assert_passes(EDIT("{'delete':'clip'}"),
                  "s:mark(fluid) e:sum(fluid) e:eos(fluid) e:push(fluid)");
    assert_passes(EDIT("{'insert':'other-rate','before':'sum'},{'delete':'push'}"),
                  "s:mark(fluid) e:other-rate(fluid) e:sum(fluid) e:eos(fluid) f:clip(fluid)");
    assert_passes(
        EDIT("{'insert':'clip','after':'eos'}"),
        "s:mark(fluid) e:sum(fluid) e:eos(fluid) e:clip(fluid) e:push(fluid) f:clip(fluid)");
    assert_passes(EDIT("{'replace':'push','with':'other-rate'}"),
                  "s:mark(fluid) e:sum(fluid) e:eos(fluid) e:other-rate(fluid) f:clip(fluid)");
    /* At the end; in the evaluation unless it says otherwise. */
    assert_passes(
        EDIT("{'insert':'mark'}"),
        "s:mark(fluid) e:sum(fluid) e:eos(fluid) e:push(fluid) e:mark(fluid) f:clip(fluid)");
    assert_passes(EDIT("{'insert':'mark','at':'finish'}"), WHOLE " f:mark(fluid)");
    assert_passes(
        EDIT("{'operation':'assignment','function':'eos'}"),
        "s:mark(fluid) e:sum(fluid) e:eos(fluid) e:push(fluid) e:eos(fluid) f:clip(fluid)");
    /* The place of the anchor is its moment, too. */
    assert_passes(EDIT("{'replace':'mark','with':'clip'}"),
                  "s:clip(fluid) e:sum(fluid) e:eos(fluid) e:push(fluid) f:clip(fluid)");
    assert_passes(
        EDIT("{'insert':'clip','after':'mark'}"),
        "s:mark(fluid) s:clip(fluid) e:sum(fluid) e:eos(fluid) e:push(fluid) f:clip(fluid)");
    assert_passes(
        EDIT("{'insert':'mark','before':'clip'}"),
        "s:mark(fluid) e:sum(fluid) e:eos(fluid) e:push(fluid) f:mark(fluid) f:clip(fluid)");
    assert_passes(EDIT("{'replace':'mark','with':'clip','at':'evaluate'}"),
                  "e:clip(fluid) e:sum(fluid) e:eos(fluid) e:push(fluid) f:clip(fluid)");
    /* An edit sees what the one before it has left. */
    assert_passes(EDIT("{'insert':'other-rate','before':'push'},{'delete':'push'},"
                       "{'replace':'other-rate','with':'push'}"),
                  WHOLE);
}

static void test_operations(void **state)
{
    struct rig r;
    (void)state;
    rig_open(
        &r, &items,
        ONE(EDIT("{'operation':'summation','function':'sum','of':'rho'},"
                 "{'operation':'integration','function':'push','of':'v'},"
                 "{'operation':'assignment','function':'mark','of':'once'},"
                 "{'operation':'assignment','of':'once','expression':'2 * rho','at':'finish'}")));
    assert_string_equal(passes(&r),
                        "s:mark(fluid) e:sum(fluid) e:eos(fluid) e:push(fluid) e:sum(fluid) "
                        "e:push(fluid) e:mark(fluid) f:clip(fluid) f:once(fluid)");
    rig_close(&r);
    rig_refused(&items, "mark is no summation",
                ONE(EDIT("{'operation':'summation','function':'mark','of':'once'}")));
    rig_refused(&items, "sum does not set \"p\"",
                ONE(EDIT("{'operation':'summation','function':'sum','of':'p'}")));
    rig_refused(&items, "sum is no integration: it declares no rate of \"rho\"",
                ONE(EDIT("{'operation':'integration','function':'sum','of':'rho'}")));
    rig_refused(&items, "sum is no integration",
                ONE(EDIT("{'operation':'integration','function':'sum'}")));
    rig_refused(&items, "sum is no assignment",
                ONE(EDIT("{'operation':'assignment','function':'sum','of':'rho'}")));
    rig_refused(&items, "push does not set \"v\"",
                ONE(EDIT("{'operation':'summation','function':'push','of':'v'}")));
    rig_refused(&items, "eos is no summation",
                ONE(EDIT("{'operation':'summation','function':'eos','of':'p'}")));
    rig_refused(&items, "eos does not set \"rho\"",
                ONE(EDIT("{'operation':'assignment','function':'eos','of':'rho'}")));
    rig_refused(&items, "no property \"ones\" to assign to",
                ONE(EDIT("{'operation':'assignment','of':'ones','expression':'1'}")));
    rig_refused(&items, "\"v\" is no scalar",
                ONE(EDIT("{'operation':'assignment','of':'v','expression':'1'}")));
    rig_refused(&items, "nonsense",
                ONE(EDIT("{'operation':'assignment','of':'once','expression':'nonsense'}")));
}

/* An expression declares what it mentions, and no more. */
static void test_assignment(void **state)
{
    struct rig r;
    (void)state;
    rig_open(&r, &items,
             ONE(EDIT("{'operation':'assignment','of':'once','expression':'p + 2 * colour',"
                      "'after':'push'}")));
    const struct pass *p = &r.plan.pass[4];
    assert_string_equal(p->name, "once(fluid)");
    assert_true(pass_writes(p, 0, column(&r, 0, "once")));
    assert_false(pass_writes(p, 0, column(&r, 0, "p")));
    bool reads_p = false, reads_u = false;
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        reads_p = reads_p || strcmp(prop->name, "p") == 0;
        reads_u = reads_u || strcmp(prop->name, "u") == 0;
    }
    assert_true(reads_p);
    assert_false(reads_u);
    rig_close(&r);
}

static void test_unknown(void **state)
{
    (void)state;
    rig_refused(&items, "no scheme \"flaw\" is registered (did you mean \"flow\"?)", ONE("'flaw'"));
    rig_refused(&items, "scene.json:1:", ONE("'flaw'"));
    rig_refused(&items, "no function \"psh\" is registered (did you mean \"push\"?)",
                ONE(EDIT("{'insert':'psh'}")));
    rig_refused(&items, "the recipe has no step \"pus\" (did you mean \"push\"?)",
                ONE(EDIT("{'delete':'pus'}")));
    rig_refused(&items, "the recipe has no step \"sum\"",
                ONE(EDIT("{'delete':'sum'},{'delete':'sum'}")));
    rig_refused(&items, "unknown array \"fluids\" (did you mean \"fluid\"?)",
                ONE(EDIT("{'insert':'mark','to':'fluids'}")));
    rig_refused(&items, "unknown array \"wal\"",
                TWO(EDIT("{'insert':'sum','from':['fluid','wal']}")));
    rig_refused(&items, "no integrator \"kkd\" (did you mean \"kdk\"?)",
                HEAD "'particles':{" FLUID
                     "},'scheme':'flow','time':{'end':1,'integrator':'kkd'}}");
    rig_refused(&items, "no kernel \"thin\" is registered (did you mean \"thing\"?)",
                HEAD "'particles':{" FLUID "},'scheme':'flow','kernel':'thin','time':{'end':1}}");
    rig_refused(&items, "no equation of state \"gass\" is registered (did you mean \"gas\"?)",
                "{'dimensions':1,'domain':{'min':[0],'max':[1]},'materials':{'gas':{'eos':'gass'}},"
                "'particles':{" FLUID "},'scheme':'flow','time':{'end':1}}");
    rig_refused(&items, "\"flat-flow\" does not work in 1 dimensions", ONE("'flat-flow'"));
    rig_refused(&items, "flat does not work in 1 dimensions", ONE(EDIT("{'insert':'flat'}")));
    rig_refused(
        &items, "has no equation of state",
        TWO(EDIT("{'replace':'push','with':'push','to':'fluid'},{'insert':'eos','to':'wall'}")));
    rig_refused(&items, "the scheme has no steps",
                ONE(EDIT("{'delete':'mark'},{'delete':'sum'},{'delete':'eos'},{'delete':'push'},"
                         "{'delete':'clip'}")));
}

#define BOUNDED(boundary)                                                                          \
    HEAD "'particles':{" FLUID "},'scheme':'flow','time':{'end':1},'boundaries':[" boundary "]}"

/* A boundary condition's steps come behind the scheme's of the same moment. */
static void test_boundaries(void **state)
{
    struct rig r;
    (void)state;
    rig_open(&r, &items, BOUNDED("{'name':'shore'}"));
    assert_string_equal(passes(&r), "s:mark(fluid) s:mark(fluid) e:sum(fluid) e:eos(fluid) "
                                    "e:push(fluid) e:clip(fluid) f:clip(fluid)");
    rig_close(&r);
    rig_refused(&items, "no boundary condition \"shor\" is registered (did you mean \"shore\"?)",
                BOUNDED("{'name':'shor'}"));
    rig_refused(&items, "/boundaries/0", BOUNDED("{'name':'shore','on':'fluid'}"));
    rig_refused(&items, "/boundaries/0", BOUNDED("{}"));
}

static void test_reports(void **state)
{
    (void)state;
#define PROBE(probe)                                                                               \
    HEAD "'particles':{" FLUID "},'scheme':'flow','time':{'end':1},'probes':[" probe "]}"
    rig_refused(&items, "array \"fluid\" has no property \"rhoo\" (did you mean \"rho\"?)",
                PROBE("{'name':'a','array':'fluid','mean':'rhoo'}"));
    rig_refused(&items, "no exact solution \"e\" is registered",
                HEAD "'particles':{" FLUID "},'scheme':'flow','time':{'end':1},"
                     "'compare':[{'array':'fluid','exact':'e'}]}");
}

/* -- Pairs of arrays ----------------------------------------------------------------------------- */

static uint32_t pair(const struct rig *r, size_t dst, size_t src)
{
    const struct plan_list *l = plan_pair(&r->plan, dst, src);
    return l ? l->reach : 0;
}

static const struct pass *pass_named(const struct rig *r, const char *name)
{
    for (size_t i = 0; i < r->plan.n_pass; i++)
        if (strcmp(r->plan.pass[i].name, name) == 0)
            return &r->plan.pass[i];
    fail_msg("no pass \"%s\"", name);
    return NULL;
}

static void test_pairs(void **state)
{
    struct rig r;
    (void)state;
    rig_open(&r, &items, TWO("'flow'"));
    for (size_t k = 0; k < 4; k++)
        assert_int_equal(pair(&r, k / 2, k % 2), SPH_SYMMETRIC);
    assert_true(r.plan.reach_scale == 1.5);
    rig_close(&r);
    /* The larger reach stays, whichever function comes last. */
    rig_open(&r, &items, TWO(EDIT("{'insert':'sum'}")));
    for (size_t k = 0; k < 4; k++)
        assert_int_equal(pair(&r, k / 2, k % 2), SPH_SYMMETRIC);
    rig_close(&r);
    /* Fluid from all, wall from the fluid: wall and wall never meet. */
    rig_open(&r, &items,
             TWO(EDIT("{'replace':'push','with':'push','to':'fluid','from':'fluid'},"
                      "{'replace':'sum','with':'sum','to':'fluid'},"
                      "{'insert':'sum','after':'sum','to':'wall','from':'fluid'}")));
    assert_int_equal(pair(&r, 0, 0), SPH_SYMMETRIC);
    assert_int_equal(pair(&r, 0, 1), SPH_GATHER);
    assert_int_equal(pair(&r, 1, 0), SPH_GATHER);
    assert_int_equal(pair(&r, 1, 1), 0);
    assert_string_equal(passes(&r),
                        "s:mark(fluid) s:mark(wall) e:sum(fluid) e:sum(wall) e:eos(fluid) "
                        "e:push(fluid) f:clip(fluid) f:clip(wall)");
    assert_int_equal(pass_named(&r, "sum(fluid)")->n_src, 2);
    assert_int_equal(pass_named(&r, "sum(wall)")->n_src, 1);
    assert_true(pass_reads_source(pass_named(&r, "sum(wall)"), 0, column(&r, 0, "m")));
    assert_false(pass_reads_source(pass_named(&r, "sum(wall)"), 1, column(&r, 1, "m")));
    assert_true(pass_writes(pass_named(&r, "sum(wall)"), 1, column(&r, 1, "rho")));
    /* The wall is nobody's source of colour, nor gets what it is not asked for. */
    assert_true(column(&r, 1, "near") < 0 && column(&r, 1, "a") < 0 && column(&r, 1, "u") < 0);
    rig_close(&r);
}

/* -- Parameters ---------------------------------------------------------------------------------- */

static double param(const struct rig *r, const char *pass, const char *name)
{
    const struct use *u = &pass_named(r, pass)->use;
    for (uint32_t k = 0; k < u->item->params.count; k++)
        if (strcmp(((const sph_param *)list_at(&u->item->params, k))->name, name) == 0)
            return u->config.value[k];
    fail_msg("%s has no parameter \"%s\"", pass, name);
    return NAN;
}

static void test_parameters(void **state)
{
    struct rig r;
    (void)state;
    rig_open(&r, &items, ONE("'flow'"));
    assert_true(param(&r, "sum(fluid)", "alpha") == 1 && param(&r, "push(fluid)", "alpha") == 3);
    assert_true(r.plan.cfl == 0.25);
    rig_close(&r);
    /* The scheme's reach everyone who declares them; a step's own come after. */
    rig_open(&r, &items,
             TWO("{'name':'flow','alpha':5,'form':'odd','edit':["
                 "{'replace':'sum','with':'sum','to':'wall'},"
                 "{'insert':'sum','before':'sum','to':'fluid','alpha':6}]}"));
    assert_true(param(&r, "sum(fluid)", "alpha") == 6);
    assert_true(param(&r, "sum(wall)", "alpha") == 5);
    assert_true(param(&r, "push(fluid)", "alpha") == 5 && param(&r, "push(wall)", "alpha") == 5);
    assert_true(param(&r, "push(fluid)", "form") == 1 && param(&r, "push(fluid)", "beta") == 2);
    rig_close(&r);
    rig_refused(&items, "the scheme \"flow\" has no parameter \"alfa\" (did you mean \"alpha\"?)",
                ONE("{'name':'flow','alfa':5}"));
    rig_refused(&items, "/scheme/alpha", ONE("{'name':'flow','alpha':11}"));
    rig_refused(&items, "/scheme/alpha", ONE("{'name':'flow','alpha':[1]}"));
    rig_refused(&items, "form", ONE("{'name':'flow','form':'sideways'}"));
    rig_refused(&items, "sum has no parameter \"beta\"", ONE(EDIT("{'insert':'sum','beta':1}")));
    rig_refused(
        &items, "gas has no parameter \"kk\" (did you mean \"k\"?)",
        "{'dimensions':1,'domain':{'min':[0],'max':[1]},'materials':{'gas':{'eos':{'name':'gas',"
        "'kk':1}}},'particles':{" FLUID "},'scheme':'flow','time':{'end':1}}");
}

/* -- First state --------------------------------------------------------------------------------- */

#define FIELDS(fields)                                                                             \
    HEAD "'particles':{" FLUID_WITH(fields) "}},'scheme':'flow','time':{'end':1}}"

static void test_first_state(void **state)
{
    struct rig r;
    (void)state;
    rig_open(&r, &items, FIELDS("'rho':4,'u':2,'colour':1"));
    for (size_t i = 0; i < 10; i++) {
        assert_true(rig_real(&r, 0, "u", 0)[i] == 2 && rig_real(&r, 0, "v", 0)[i] == 0);
        assert_true(rig_real(&r, 0, "last", 0)[i] == 7 && rig_real(&r, 0, "clipped", 0)[i] == 5);
        assert_true(rig_real(&r, 0, "a", 0)[i] == 0);
    }
    rig_close(&r);
    /* p in place of u: the equation of state turned round, with its parameter. */
    rig_open(&r, &items, FIELDS("'rho':4,'p':'8 + x','colour':1"));
    for (size_t i = 0; i < 10; i++) {
        const double x = rig_real(&r, 0, "x", 0)[i];
        assert_true(fabs(rig_real(&r, 0, "u", 0)[i] - (8 + x) / 8) < 1e-14);
    }
    rig_close(&r);
    /* u given besides: p is only where it starts. */
    rig_open(&r, &items, FIELDS("'rho':4,'p':8,'u':3,'colour':1"));
    assert_true(rig_real(&r, 0, "u", 0)[0] == 3);
    rig_close(&r);
}

static void test_missing_state(void **state)
{
    (void)state;
    rig_refused(&items,
                "/particles/fluid: nothing gives the initial \"u\" (energy): add it to \"fields\"",
                FIELDS("'rho':4,'colour':1"));
    rig_refused(&items, "nothing gives the initial \"colour\"", FIELDS("'rho':4,'u':1"));
    rig_refused(&items, "must give \"rho\" too", FIELDS("'m':1,'p':1,'colour':1"));
    rig_refused(&items, "unknown field \"colou\" (did you mean \"colour\"?)",
                FIELDS("'rho':4,'u':1,'colou':1"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_columns),
        cmocka_unit_test(test_state),
        cmocka_unit_test(test_integrator_columns),
        cmocka_unit_test(test_rates),
        cmocka_unit_test(test_edits),
        cmocka_unit_test(test_operations),
        cmocka_unit_test(test_assignment),
        cmocka_unit_test(test_unknown),
        cmocka_unit_test(test_boundaries),
        cmocka_unit_test(test_reports),
        cmocka_unit_test(test_pairs),
        cmocka_unit_test(test_parameters),
        cmocka_unit_test(test_first_state),
        cmocka_unit_test(test_missing_state),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
