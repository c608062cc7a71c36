/* test_fusion.c -- functions that one other does in one sweep: what is declared of them, and refused; which
 * steps of a recipe the plan puts together, and which not. */
#include "config.h"

#include "rig.h"

#include <sph/fusion.h>

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#define SIZE(type) ((uint32_t)sizeof(type))
#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define LIST(array, n)                                                                             \
    (sph_list)                                                                                     \
    {                                                                                              \
        (array), (uint32_t)(n), SIZE((array)[0])                                                   \
    }

/* -- A plugin: "left" and "right" are parts of "both", with "last" of "all" ------------------------- */

static sph_status nothing(const sph_batch *b)
{
    (void)b;
    return SPH_OK;
}

#define M                                                                                          \
    {                                                                                              \
        "m", "", "", SPH_SCALAR, SPH_SRC_READ, 0                                                   \
    }
#define V                                                                                          \
    {                                                                                              \
        "v", "", "", SPH_VECTOR, SPH_DST_READ | SPH_SRC_READ, 0                                    \
    }
#define L(access)                                                                                  \
    {                                                                                              \
        "l", "", "", SPH_SCALAR, access, 0                                                         \
    }
#define R(access)                                                                                  \
    {                                                                                              \
        "r", "", "", SPH_SCALAR, access, 0                                                         \
    }
#define ALPHA SPH_PARAM("alpha", "", "", 1, 1, 0)
#define BETA SPH_PARAM("beta", "", "", 1, 1, 0)
#define GAIN SPH_PARAM("gain", "", "", 1, 1, 0)

static const sph_rate left_rate[] = {SPH_RATE("m", "l", SPH_KICK)};
static const sph_reduction right_reduction[] = {
    SPH_REDUCTION("most", "r", SPH_REDUCE_MAX, SPH_USE_NONE)};
static sph_prop left_prop[3], right_prop[3], both_prop[4], last_prop[1], all_prop[5];
static sph_param left_param[2], right_param[2], both_param[3];
static sph_item left_item, right_item, both_item, last_item, all_item;
static sph_function left, right, both, last, all;
static const char *both_part[2], *all_part[3];
static sph_fusion fusion, fusion_of_all;
static const sph_fusion *declared;
static bool with_all;
static sph_status declare_status;

#define SET(array, ...) memcpy(array, ((__typeof__(array)){__VA_ARGS__}), sizeof(array))

static sph_function pair(sph_item *item, const char *name, sph_list props, sph_list params)
{
    *item = (sph_item){.size = SIZE(sph_item),
                       .dims = SPH_ALL_DIMS,
                       .name = name,
                       .doc = "a mock",
                       .params = params,
                       .props = props};
    return (sph_function){.size = SIZE(sph_function),
                          .shape = SPH_PAIR,
                          .item = item,
                          .run = nothing,
                          .reach = SPH_SYMMETRIC,
                          .reach_scale = 1};
}

static int reset(void **state)
{
    (void)state;
    SET(left_prop, M, V, L(SPH_DST_SUM));
    SET(right_prop, M, V, R(SPH_DST_SUM));
    SET(both_prop, M, V, L(SPH_DST_SUM), R(SPH_DST_SUM));
    SET(last_prop, {"z", "", "", SPH_SCALAR, SPH_DST_SUM, 0});
    SET(all_prop, M, V, L(SPH_DST_SUM), R(SPH_DST_SUM), {"z", "", "", SPH_SCALAR, SPH_DST_SUM, 0});
    SET(left_param, ALPHA, GAIN);
    SET(right_param, BETA, GAIN);
    SET(both_param, ALPHA, BETA, GAIN);
    left = pair(&left_item, "left", LIST(left_prop, 3), LIST(left_param, 2));
    right = pair(&right_item, "right", LIST(right_prop, 3), LIST(right_param, 2));
    both = pair(&both_item, "both", LIST(both_prop, 4), LIST(both_param, 3));
    last = pair(&last_item, "last", LIST(last_prop, 1), (sph_list)SPH_NO_LIST);
    all = pair(&all_item, "all", LIST(all_prop, 5), LIST(both_param, 3));
    SET(both_part, "left", "right");
    SET(all_part, "left", "right", "last");
    fusion = (sph_fusion){SIZE(sph_fusion), 0, "both", LIST(both_part, 2)};
    fusion_of_all = (sph_fusion){SIZE(sph_fusion), 0, "all", LIST(all_part, 3)};
    declared = &fusion;
    with_all = true;
    return 0;
}

static sph_status declare(const sph_host *host)
{
    const sph_fusions *fusions = (const sph_fusions *)host->extension(host, SPH_EXT_FUSION);
    declare_status = fusions->declare(host, declared);
    return declare_status == SPH_OK && with_all ? fusions->declare(host, &fusion_of_all)
                                                : declare_status;
}

static const sph_step steps[] = {SPH_STEP(SPH_AT_EVALUATE, "left"),
                                 SPH_STEP(SPH_AT_EVALUATE, "right")};
static const sph_item scheme_item = {
    .size = SIZE(sph_item), .dims = SPH_ALL_DIMS, .name = "plain", .doc = "a mock"};
static const sph_scheme scheme = {.size = SIZE(sph_scheme),
                                  .item = &scheme_item,
                                  .kernel = "thing",
                                  .integrator = "kdk",
                                  .cfl = 0.5,
                                  .steps = SPH_LIST(steps)};
static const struct rig_items items = {.function = {&left, &right, &both, &last, &all, NULL},
                                       .scheme = {&scheme, NULL},
                                       .more = declare};

#define ARRAY "{'fill':{'lattice':'square','count':4},'fields':{'rho':1}}"
#define ONE(scheme)                                                                                \
    "{'dimensions':1,'domain':{'min':[0],'max':[1]},'particles':{'a':" ARRAY "},'scheme':" scheme  \
    ",'time':{'end':1}}"
#define TWO(scheme)                                                                                \
    "{'dimensions':1,'domain':{'min':[0],'max':[2]},'particles':{'a':{'fill':{'lattice':"          \
    "'square','count':4,'in':{'box':{'min':[0],'max':[1]}}},'fields':{'rho':1}},'b':{'fill':{"     \
    "'lattice':'square','count':4,'in':{'box':{'min':[1],'max':[2]}}},'fields':{'rho':1}}},"       \
    "'scheme':" scheme ",'time':{'end':1}}"

/* -- Declarations ---------------------------------------------------------------------------------- */

static void refused(const char *text)
{
    struct rig r;
    struct error e = {0};
    if (!rig_make(&r, &items, &e, ONE("'plain'")))
        fail_msg("accepted, in place of: %s", text);
    if (!strstr(e.text, text) || strchr(e.text, '\n'))
        fail_msg("says: %s\nin place of: %s", e.text, text);
    assert_int_equal(e.exit_code, EXIT_REFUSED);
    assert_int_equal(declare_status, SPH_E_INVALID);
    rig_close(&r);
    reset(NULL);
}

static void what_contradicts_itself_is_refused(void **state)
{
    static sph_life life = {SIZE(sph_life), 0, NULL, NULL};
    static sph_prop again[] = {
        M, V, L(SPH_DST_SUM), {"again", "", "", SPH_INT32, SPH_DST_WRITE, 0}};
    (void)state;
    declared = NULL;
    refused("fusion: the descriptor is NULL");
    fusion.size = 12;
    refused("fusion");
    fusion.function = NULL;
    refused("fusion: function \"?\" is not registered by this plugin");
    fusion.function = "neither";
    refused("fusion: function \"neither\" is not registered by this plugin");
    both_part[1] = "rihgt";
    refused("fusion \"both\": function \"rihgt\" is not registered by this plugin");
    both_part[1] = NULL;
    refused("fusion \"both\": function \"?\" is not registered by this plugin");
    fusion.parts.count = 1;
    refused("fusion \"both\": it is no pair function with at least two parts");
    fusion.parts = (sph_list)SPH_NO_LIST;
    refused("fusion \"both\": it is no pair function with at least two parts");
    fusion.parts.data = NULL;
    refused("fusion \"both\"");
    both_item.props = LIST(both_prop, 3);
    refused("\"both\" does not declare the property \"r\" as its part \"right\" does");
    both_prop[1].access = SPH_DST_READ;
    refused("\"both\" does not declare the property \"v\" as its part \"left\" does");
    both_prop[2].type = SPH_VECTOR;
    refused("\"both\" does not declare the property \"l\" as its part \"left\" does");
    both_item.params = LIST(both_param, 2);
    refused("\"both\" does not declare the parameter \"gain\" of its part \"left\"");
    both_item.params = LIST(both_param + 1, 2);
    refused("\"both\" does not declare the parameter \"alpha\" of its part \"left\"");
    both_param[2].def = 2;
    refused("the parameter \"gain\" of \"both\" has another type or default than that of its part");
    both_item.dims = SPH_DIM2;
    refused("\"both\" is for fewer dimensions than its part \"left\"");
    left.rates = (sph_list)SPH_LIST(left_rate);
    refused("\"both\" does not declare \"l\" as the rate of \"m\", as its part \"left\" does");
    right.reductions = (sph_list)SPH_LIST(right_reduction);
    refused("\"both\" does not declare the reduction \"most\" as its part \"right\" does");
    left.reach = SPH_GATHER;
    refused("\"left\" is no pair function of the same reach in one sweep and without prepare and "
            "life, so it cannot be a part of \"both\"");
    right.reach_scale = 2;
    refused("\"right\" is no pair function of the same reach");
    right.reach_scale = 0.5;
    refused("\"right\" is no pair function of the same reach");
    left_item.props = LIST(again, 4);
    left.max_sweeps = 3;
    left.unfinished = "again";
    refused("\"left\" is no pair function of the same reach in one sweep");
    right.prepare = nothing;
    refused("\"right\" is no pair function of the same reach in one sweep and without prepare");
    right.life = &life;
    refused("\"right\" is no pair function of the same reach in one sweep and without prepare");
    right.over = "v";
    refused("\"right\" is no pair function of the same reach");
    left_prop[0].access = left_prop[1].access = SPH_DST_READ;
    left.shape = SPH_POINT;
    refused("\"left\" is no pair function");
    both_prop[0].access = both_prop[1].access = SPH_DST_READ;
    both.shape = SPH_POINT;
    refused("fusion \"both\": it is no pair function with at least two parts");
}

/* -- Plans ----------------------------------------------------------------------------------------- */

/* The passes by name, in order: "both(a)". */
static void passes(const char *const *name, size_t n, const char *text)
{
    struct rig r;
    rig_open(&r, &items, "%s", text);
    for (size_t i = 0; i < r.plan.n_pass; i++)
        if (i >= n || strcmp(r.plan.pass[i].name, name[i]) != 0)
            fail_msg("pass %zu is %s, not %s, of: %s", i, r.plan.pass[i].name,
                     i < n ? name[i] : "none", r.text);
    assert_int_equal(r.plan.n_pass, n);
    rig_close(&r);
}
#define PASSES(text, ...)                                                                          \
    passes((const char *const[]){__VA_ARGS__}, COUNT(((const char *const[]){__VA_ARGS__})), text)

static void steps_that_follow_each_other(void **state)
{
    (void)state;
    PASSES(ONE("'plain'"), "both(a)");
    PASSES(TWO("'plain'"), "both(a)", "both(b)");
    PASSES(ONE("{'name':'plain','fuse':true}"), "both(a)");
    PASSES(ONE("{'name':'plain','fuse':false}"), "left(a)", "right(a)");
    /* As many as one function does; what is left stays by itself. */
    PASSES(ONE("{'name':'plain','edit':[{'insert':'last','after':'right'}]}"), "all(a)");
    PASSES(ONE("{'name':'plain','edit':[{'insert':'last','after':'right'},{'insert':'last',"
               "'after':'last'}]}"),
           "all(a)", "last(a)");
    PASSES(ONE("{'name':'plain','edit':[{'insert':'last','before':'left'}]}"), "last(a)",
           "both(a)");
    PASSES(ONE("{'name':'plain','edit':[{'insert':'left'},{'insert':'right'}]}"), "both(a)",
           "both(a)");
    PASSES(ONE("{'name':'plain','edit':[{'insert':'right'},{'insert':'left'}]}"), "both(a)",
           "right(a)", "left(a)");
}

static void steps_that_do_not(void **state)
{
    (void)state;
    PASSES(ONE("{'name':'plain','edit':[{'insert':'last','after':'left'}]}"), "left(a)", "last(a)",
           "right(a)");
    PASSES(ONE("{'name':'plain','edit':[{'operation':'assignment','of':'l','expression':'1',"
               "'after':'left'}]}"),
           "left(a)", "l(a)", "right(a)");
    PASSES(ONE("{'name':'plain','edit':[{'delete':'left'}]}"), "right(a)");
    PASSES(ONE("{'name':'plain','edit':[{'delete':'right'}]}"), "left(a)");
    PASSES(ONE("{'name':'plain','edit':[{'delete':'left'},{'insert':'left','after':'right'}]}"),
           "right(a)", "left(a)");
    PASSES(ONE("{'name':'plain','edit':[{'replace':'right','with':'last'}]}"), "left(a)",
           "last(a)");
    PASSES(ONE("{'name':'plain','edit':[{'replace':'right','with':'right'}]}"), "both(a)");
    PASSES(ONE("{'name':'plain','edit':[{'replace':'right','with':'right','at':'finish'}]}"),
           "left(a)", "right(a)");
    /* Other destinations, other sources. */
    PASSES(TWO("{'name':'plain','edit':[{'replace':'right','with':'right','to':'a'}]}"), "left(a)",
           "left(b)", "right(a)");
    PASSES(TWO("{'name':'plain','edit':[{'replace':'right','with':'right','from':'b'}]}"),
           "left(a)", "left(b)", "right(a)", "right(b)");
    PASSES(TWO("{'name':'plain','edit':[{'replace':'left','with':'left','to':'b','from':'a'},"
               "{'replace':'right','with':'right','to':'b','from':'a'}]}"),
           "both(b)");
    PASSES(TWO("{'name':'plain','edit':[{'insert':'last','after':'right','to':'b'}]}"), "both(a)",
           "both(b)", "last(b)");
}

static double value(const struct rig *r, const char *param)
{
    const struct use *u = &r->plan.pass[0].use;
    for (uint32_t i = 0; i < u->item->params.count; i++)
        if (strcmp(((const sph_param *)list_at(&u->item->params, i))->name, param) == 0)
            return u->config.value[i];
    fail_msg("no parameter \"%s\"", param);
    return 0;
}

static void parameters(const char *text, double alpha, double beta, double gain)
{
    struct rig r;
    rig_open(&r, &items, "%s", text);
    assert_string_equal(r.plan.pass[0].name, "both(a)");
    if (value(&r, "alpha") != alpha || value(&r, "beta") != beta || value(&r, "gain") != gain)
        fail_msg("alpha %g, beta %g, gain %g, not %g, %g, %g, of: %s", value(&r, "alpha"),
                 value(&r, "beta"), value(&r, "gain"), alpha, beta, gain, r.text);
    rig_close(&r);
}

/* A parameter that one part was given itself reaches that part alone. */
static void parameters_of_parts(void **state)
{
    (void)state;
    parameters(ONE("{'name':'plain','alpha':5,'beta':6,'gain':7}"), 5, 6, 7);
    parameters(ONE("{'name':'plain','edit':[{'replace':'left','with':'left','alpha':3}]}"), 3, 1,
               1);
    parameters(ONE("{'name':'plain','alpha':5,'beta':6,'edit':[{'replace':'right','with':'right',"
                   "'beta':4}]}"),
               5, 4, 1);
    /* ... the scene's word for all steps, too, gives way to it, whichever part it was given. */
    parameters(ONE("{'name':'plain','alpha':5,'beta':6,'edit':[{'replace':'left','with':'left',"
                   "'alpha':4}]}"),
               4, 6, 1);
    /* The last step, of a function that would want another behind it. */
    PASSES(ONE("{'name':'plain','edit':[{'delete':'left'},{'replace':'right','with':'left',"
               "'alpha':4}]}"),
           "left(a)");
    PASSES(ONE("{'name':'plain','edit':[{'replace':'left','with':'left','gain':3}]}"), "left(a)",
           "right(a)");
    PASSES(ONE("{'name':'plain','edit':[{'replace':'right','with':'right','gain':3}]}"), "left(a)",
           "right(a)");
}

/* Plan and its JSON name the parts. */
static void parts_are_told(void **state)
{
    struct rig r;
    (void)state;
    rig_open(&r, &items, ONE("'plain'"));
    cJSON *json = plan_json(&r.plan);
    const cJSON *pass = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "passes"), 0);
    const cJSON *parts = cJSON_GetObjectItem(pass, "parts");
    assert_int_equal(cJSON_GetArraySize(parts), 2);
    assert_string_equal(cJSON_GetArrayItem(parts, 0)->valuestring, "left");
    assert_string_equal(cJSON_GetArrayItem(parts, 1)->valuestring, "right");
    cJSON_Delete(json);
    rig_close(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(what_contradicts_itself_is_refused, reset),
        cmocka_unit_test_setup(steps_that_follow_each_other, reset),
        cmocka_unit_test_setup(steps_that_do_not, reset),
        cmocka_unit_test_setup(parameters_of_parts, reset),
        cmocka_unit_test_setup(parts_are_told, reset),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
