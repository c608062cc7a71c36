/* test_extensions.c -- what plugins ask for by id: tables, reductions, bounds on the time step, particles
 * removed and created, a state of their own; and boundary conditions, which place steps among a
 * scheme's. */
#include "config.h"

#include "rig.h"
#include "run/loop.h"
#include "run/run.h"
#include "scratch.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SIZE(type) ((uint32_t)sizeof(type))
#define ITEM(variable, name_, params_, props_)                                                     \
    static const sph_item variable = {.size = SIZE(sph_item),                                      \
                                      .dims = SPH_ALL_DIMS,                                        \
                                      .name = name_,                                               \
                                      .doc = "a mock",                                             \
                                      .params = params_,                                           \
                                      .props = props_}

static double *real(const sph_batch *b, uint32_t k)
{
    return (double *)b->dst[k].data;
}

/* -- "follow": x by a table, the state made of it ------------------------------------------------- */

struct follow {
    const sph_table *table;
    const double *t, *v;
    double turns; /* counted by prepare */
};

static double last_seen; /* what `follow` saw of the reduction */
static uint64_t prepared;

static sph_status follow_create(const sph_host *host, const sph_config *config, uint32_t dim,
                                void **state)
{
    const sph_tables *tables = (const sph_tables *)host->extension(host, SPH_EXT_TABLES);
    struct follow *f = calloc(1, sizeof *f);

    (void)dim;
    *state = f;
    f->table = tables->get(config, "path");
    assert_null(tables->get(config, "speed"));
    assert_true(host->param(config, "path") == (f->table ? 1 : 0));
    if (!f->table)
        return SPH_OK;
    f->t = sph_table_column(f->table, "t");
    f->v = sph_table_column(f->table, "v");
    return f->t && f->v ? SPH_OK : (host->fail)(host, SPH_E_INVALID, "path needs columns t and v");
}

static void follow_destroy(const sph_host *host, void *state)
{
    (void)host;
    free(state);
}

static sph_status follow_prepare(const sph_batch *b)
{
    const sph_reductions *reductions =
        (const sph_reductions *)b->host->extension(b->host, SPH_EXT_REDUCTIONS);
    const sph_time_step *time_step =
        (const sph_time_step *)b->host->extension(b->host, SPH_EXT_TIME_STEP);
    struct follow *f = b->state;

    assert_true(b->dst == NULL && b->count == 0 && b->x_dst.data == NULL);
    prepared++;
    f->turns++;
    last_seen = reductions->value(b, "follow", "fastest");
    assert_true(isnan(reductions->value(b, "follow", "slowest")));
    assert_int_equal(time_step->propose(b, -1), SPH_E_INVALID);
    assert_int_equal(time_step->propose(b, NAN), SPH_E_INVALID);
    return time_step->propose(b, b->param[1]);
}

static sph_status follow_run(const sph_batch *b)
{
    const struct follow *f = b->state;
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        real(b, 0)[i] = f->table ? sph_table_linear(f->table, f->t, f->v, b->time) : 1;
    return SPH_OK;
}

static const sph_param follow_params[] = {
    SPH_PARAM_OF_TABLE("path", "velocity against time", 0),
    SPH_PARAM("speed", "", "bound on the time step", 1, 0, 10)};
static const sph_prop follow_props[] = {
    SPH_PROP("v", "", "", SPH_VECTOR, SPH_DST_WRITE, 0),
};
static const sph_prop fast_props[] = {
    SPH_PROP("speed", "", "", SPH_SCALAR, SPH_DST_WRITE, 0),
};
ITEM(follow_item, "follow", SPH_LIST(follow_params), SPH_LIST(fast_props));
static const sph_life follow_life = {SIZE(sph_life), 0, follow_create, follow_destroy};
static const sph_reduction follow_reductions[] = {
    SPH_REDUCTION("fastest", "speed", SPH_REDUCE_MAX, SPH_USE_NONE)};
static const sph_function follow = {.size = SIZE(sph_function),
                                    .shape = SPH_POINT,
                                    .item = &follow_item,
                                    .life = &follow_life,
                                    .run = follow_run,
                                    .prepare = follow_prepare,
                                    .reductions = SPH_LIST(follow_reductions)};

/* "push": v = speed of `follow`, so that x moves. */
static sph_status push_run(const sph_batch *b)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        real(b, 0)[i] = 1;
    return SPH_OK;
}
ITEM(push_item, "push", SPH_NO_LIST, SPH_LIST(follow_props));
static const sph_function push = {
    .size = SIZE(sph_function), .shape = SPH_POINT, .item = &push_item, .run = push_run};

/* "bound": a bound on the time step in a property, so none where no particles are. */
static sph_status bound_run(const sph_batch *b)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        real(b, 0)[i] = 0.1;
    return SPH_OK;
}
static const sph_prop bound_props[] = {
    SPH_PROP("bound", "s", "", SPH_SCALAR, SPH_DST_WRITE, 0),
};
ITEM(bound_item, "bound", SPH_NO_LIST, SPH_LIST(bound_props));
static const sph_reduction bound_reductions[] = {
    SPH_REDUCTION("dt", "bound", SPH_REDUCE_MIN, SPH_USE_TIME_STEP)};
static const sph_function bound = {.size = SIZE(sph_function),
                                   .shape = SPH_POINT,
                                   .item = &bound_item,
                                   .run = bound_run,
                                   .reductions = SPH_LIST(bound_reductions)};

/* -- "gate": particles leave beyond `end`, and as many come in at 0 -------------------------------- */

static sph_status gate_run(const sph_batch *b)
{
    int32_t *gone = b->dst[1].data, *made = b->dst[2].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        gone[i] = real(b, 0)[i] > b->param[0];
        made[i] = (int32_t)b->param[1] * gone[i];
    }
    return SPH_OK;
}

static sph_status gate_born(const sph_batch *b)
{
    const int32_t *sibling = b->dst[1].data;
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        real(b, 0)[i] -= b->param[0] * sibling[i]; /* one length back for each of them */
        real(b, 2)[i] = sibling[i];
    }
    return SPH_OK;
}

static const sph_param gate_params[] = {SPH_PARAM("end", "", "", 1, 1, 0),
                                        SPH_PARAM("copies", "", "", 1, 1, 0)};
static const sph_prop gate_props[] = {
    SPH_PROP("x", "", "", SPH_VECTOR, SPH_DST_READ, NAN),
    SPH_PROP("gone", "", "", SPH_INT32, SPH_DST_WRITE, 0),
    SPH_PROP("made", "", "", SPH_INT32, SPH_DST_WRITE, 0),
};
static const sph_prop gate_born_props[] = {
    SPH_PROP("x", "", "", SPH_VECTOR, SPH_DST_UPDATE, NAN),
    SPH_PROP("made", "", "", SPH_INT32, SPH_DST_READ, 0),
    SPH_PROP("mark", "", "", SPH_SCALAR, SPH_DST_WRITE, 0),
};
ITEM(gate_item, "gate", SPH_LIST(gate_params), SPH_LIST(gate_props));
static const sph_function gate = {
    .size = SIZE(sph_function), .shape = SPH_POINT, .item = &gate_item, .run = gate_run};
static sph_population gate_population;

/* -- A scheme, boundary conditions ---------------------------------------------------------------- */

static sph_status nothing(const sph_batch *b)
{
    (void)b;
    return SPH_OK;
}
#define NOTHING(variable, name_)                                                                   \
    ITEM(variable##_item, name_, SPH_LIST(gate_params), SPH_LIST(touch_props));                    \
    static const sph_function variable = {.size = SIZE(sph_function),                              \
                                          .shape = SPH_PAIR,                                       \
                                          .item = &variable##_item,                                \
                                          .run = nothing,                                          \
                                          .reach = SPH_GATHER}
static const sph_prop touch_props[] = {
    SPH_PROP("m", "", "", SPH_SCALAR, SPH_DST_READ | SPH_SRC_READ, NAN)};
NOTHING(first, "first");
NOTHING(second, "second");
NOTHING(wall, "wall");
NOTHING(lid, "lid");

static const sph_step steps[] = {SPH_STEP(SPH_AT_EVALUATE, "first"),
                                 SPH_STEP(SPH_AT_EVALUATE, "second")};
static const sph_rate rates[] = {SPH_RATE("x", "v", SPH_DRIFT)};
ITEM(scheme_item, "plain", SPH_NO_LIST, SPH_NO_LIST);
static const sph_scheme scheme = {.size = SIZE(sph_scheme),
                                  .item = &scheme_item,
                                  .kernel = "thing",
                                  .integrator = "kdk",
                                  .cfl = 0.5,
                                  .steps = SPH_LIST(steps)};
static const sph_step move_steps[] = {SPH_STEP(SPH_AT_EVALUATE, "follow"),
                                      SPH_STEP(SPH_AT_EVALUATE, "push")};
ITEM(move_item, "move", SPH_NO_LIST, SPH_NO_LIST);
static const sph_scheme move = {.size = SIZE(sph_scheme),
                                .item = &move_item,
                                .kernel = "thing",
                                .integrator = "kdk",
                                .cfl = 0.5,
                                .steps = SPH_LIST(move_steps),
                                .rates = SPH_LIST(rates)};

static const sph_step wall_steps[] = {
    SPH_STEP_AT(SPH_AT_EVALUATE, "wall", "first", NULL, SPH_ON_BOUNDED),
    SPH_STEP_AT(SPH_AT_EVALUATE, "lid", "first", NULL, SPH_ON_BOUNDARY),
    SPH_STEP_AT(SPH_AT_FINISH, "wall", NULL, "second", SPH_ON_BOUNDARY),
    SPH_STEP_AT(SPH_AT_FINISH, "lid", "nowhere", NULL, SPH_ON_BOUNDARY)};
ITEM(wall_boundary_item, "walled", SPH_NO_LIST, SPH_NO_LIST);
static const sph_boundary walled = {
    .size = SIZE(sph_boundary), .item = &wall_boundary_item, .steps = SPH_LIST(wall_steps)};

static sph_state follow_state;
static const char *state_kind;
static sph_status declare_status;

static sph_status declare(const sph_host *host)
{
    const sph_population_ext *population =
        (const sph_population_ext *)host->extension(host, SPH_EXT_POPULATION);
    const sph_state_ext *state = (const sph_state_ext *)host->extension(host, SPH_EXT_STATE);

    assert_null(host->extension(host, "sph.telepathy/0"));
    assert_null(host->extension(host, NULL));
    declare_status = population->declare(host, "gate", &gate_population);
    if (declare_status == SPH_OK)
        declare_status = state->declare(host, state_kind, "follow", &follow_state);
    return declare_status;
}

static const struct rig_items items = {
    .function = {&follow, &push, &bound, &gate, &first, &second, &wall, &lid, NULL},
    .eos = {NULL},
    .scheme = {&scheme, &move, NULL},
    .boundary = {&walled, NULL},
    .more = declare};

static sph_status save(const sph_host *host, const void *state, const sph_writer *out)
{
    const struct follow *f = state;
    (void)host;
    return out->write(out, &f->turns, sizeof f->turns);
}

static sph_status restore(const sph_host *host, void *state, uint32_t format, const void *bytes,
                          uint64_t n)
{
    struct follow *f = state;
    if (format != 7 || n != sizeof f->turns)
        return (host->fail)(host, SPH_E_ABI, "unknown format of the state");
    memcpy(&f->turns, bytes, sizeof f->turns);
    return SPH_OK;
}

static void defaults(void)
{
    gate_population = (sph_population){.size = SIZE(sph_population),
                                       .remove = "gone",
                                       .create = "made",
                                       .born = gate_born,
                                       .born_props = SPH_LIST(gate_born_props)};
    follow_state = (sph_state){SIZE(sph_state), 7, save, restore};
    state_kind = SPH_KIND_FUNCTION;
    prepared = 0;
    last_seen = 0;
}

static int reset(void **state)
{
    defaults();
    return scratch_setup(state);
}

#define SCENE(scheme, more)                                                                        \
    "{'dimensions':1,'domain':{'min':[0],'max':[1]},'particles':{'row':{'fill':{'lattice':"        \
    "'square','count':10,'in':{'box':{'min':[0],'max':[0.5]}}},'fields':{'rho':1}},'rest':{"       \
    "'fill':{'lattice':'square','count':4,'in':{'box':{'min':[0.5],'max':[1]}}},'fields':{"        \
    "'rho':1}}},'scheme':" scheme ",'time':{'end':1}" more "}"
#define ONE(scheme, more)                                                                          \
    "{'dimensions':1,'domain':{'min':[0],'max':[1]},'particles':{'row':{'fill':"                   \
    "{'lattice':'square','count':10},'fields':{'rho':1,'v':[1]},'columns':{'mark':0}}},'scheme'"   \
    ":" scheme ",'time':{'end':1}" more "}"

/* -- Tables --------------------------------------------------------------------------------------- */

static void begin(struct run *run, struct rig *rig)
{
    struct error e = {0};
    if (run_init(run, &rig->plan, 2, SPH_PATH_BEST, false, &e) || run_passes(run, MOMENT_START, &e) ||
        run_passes(run, MOMENT_EVALUATE, &e))
        fail_msg("%s", e.text);
}

static void tables(void **state)
{
    struct rig rig;
    struct run run;

    (void)state;
    rig_open(&rig, &items, ONE("{'name':'move','path':{'t':[0,2,4],'v':[1,3,0]}}", ""));
    begin(&run, &rig);
    assert_true(rig_real(&rig, 0, "speed", 0)[9] == 1);
    run.time = 1;
    struct error e = {0};
    assert_int_equal(run_passes(&run, MOMENT_EVALUATE, &e), 0);
    assert_true(rig_real(&rig, 0, "speed", 0)[0] == 2);
    run.time = 9;
    assert_int_equal(run_passes(&run, MOMENT_EVALUATE, &e), 0);
    assert_true(rig_real(&rig, 0, "speed", 0)[0] == 0);
    run_free(&run);
    rig_close(&rig);

    rig_refused(&items, "path needs columns t and v", ONE("{'name':'move','path':{'t':[0]}}", ""));
    rig_refused(&items, "/scheme/path/t: a column of a table is an array of numbers",
                ONE("{'name':'move','path':{'t':5}}", ""));
    rig_refused(&items, "/scheme: follow: path needs columns t and v",
                ONE("{'name':'move','path':{'t':[0]}}", ""));
    rig_refused(&items, "as long as the others (2)",
                ONE("{'name':'move','path':{'t':[0,1],'v':[1]}}", ""));
    rig_refused(&items, "a table holds numbers", ONE("{'name':'move','path':{'t':['a']}}", ""));
    rig_refused(&items, "the table has no rows", ONE("{'name':'move','path':{'t':[]}}", ""));
    rig_refused(&items, "the table has no rows", ONE("{'name':'move','path':{}}", ""));
    rig_refused(&items, "path is a table", ONE("{'name':'move','path':3}", ""));
    rig_refused(&items, "/no/such.csv: cannot be read",
                ONE("{'name':'move','path':'/no/such.csv'}", ""));
}

static void tables_of_files(void **state)
{
    static const char text[] = "# measured\nt,v\n0,4\n1,6\n";
    const char *path = scratch_path(state, "motion.csv");
    struct rig rig;
    struct run run;

    scratch_write(path, text, sizeof text - 1);
    rig_open(&rig, &items, ONE("{'name':'move','path':'%s'}", ""), path);
    begin(&run, &rig);
    assert_true(rig_real(&rig, 0, "speed", 0)[3] == 4);
    run_free(&run);
    rig_close(&rig);
}

/* -- Reductions, time steps, preparing ------------------------------------------------------------- */

static void reductions(void **state)
{
    struct rig rig;
    struct run run;
    struct error e = {0};

    (void)state;
    rig_open(&rig, &items, SCENE("{'name':'move','path':{'t':[0,2],'v':[1,3]},'speed':0.25}", ""));
    assert_int_equal(run_init(&run, &rig.plan, 2, SPH_PATH_BEST, false, &e), 0);
    assert_int_equal(run_passes(&run, MOMENT_EVALUATE, &e), 0);
    assert_int_equal(prepared, 2); /* once an array */
    assert_true(isfinite(run.proposed) && run.proposed == 0.25);
    run.time = 1;
    assert_int_equal(run_passes(&run, MOMENT_EVALUATE, &e), 0);
    /* The second array's turn: the first has done this evaluation, the second the last. */
    assert_true(last_seen == 2);
    assert_int_equal(prepared, 4);
    run_free(&run);
    rig_close(&rig);
}

/* -- Population ------------------------------------------------------------------------------------ */

#define GATED ",'edit':[{'operation':'assignment','function':'gate','at':'finish'%s}]"

static void one_in_one_out(void **state)
{
    struct rig rig;
    struct run run;
    struct error e = {0};

    (void)state;
    rig_open(&rig, &items, ONE("{'name':'move'" GATED "}", ""), "");
    begin(&run, &rig);
    run.dt = 0.05;
    for (int k = 0; k < 60; k++)
        if (run_advance(&run, &e))
            fail_msg("%s", e.text);
    /* A row 0.1 apart that went round three times: as it was, in places a length back. */
    const struct particles *p = &rig.plan.array[0].p;
    const int64_t *id = p->column[rig.plan.array[0].id].data;
    bool seen[10] = {false};
    assert_int_equal(p->n, 10);
    assert_int_equal(run.cost.created, 30);
    for (size_t i = 0; i < p->n; i++) {
        const double x = rig_real(&rig, 0, "x", 0)[i], place = (x - 0.05) / 0.1;
        assert_true(fabs(place - round(place)) < 1e-9 && x > 0 && x < 1);
        assert_false(seen[(int)round(place)]);
        seen[(int)round(place)] = true;
        assert_true(id[i] >= 30 && id[i] < 40);
        for (size_t k = 0; k < i; k++)
            assert_true(id[i] != id[k]);
        assert_true(rig_real(&rig, 0, "mark", 0)[i] == 1);
        assert_true(rig_real(&rig, 0, "m", 0)[i] == rig_real(&rig, 0, "m", 0)[0]);
    }
    run_free(&run);
    rig_close(&rig);
}

/* Siblings are told apart; a function that only takes away leaves none. */
static void siblings_and_none(void **state)
{
    struct rig rig;
    struct run run;
    struct error e = {0};

    (void)state;
    rig_open(&rig, &items, ONE("{'name':'move'" GATED "}", ""), ",'copies':3,'end':0.93");
    begin(&run, &rig);
    run.dt = 0.02;
    assert_int_equal(run_advance(&run, &e), 0); /* one of ten goes, three come: 12 */
    assert_int_equal(rig.plan.array[0].p.n, 12);
    for (size_t i = 9; i < 12; i++) {
        assert_true(rig_real(&rig, 0, "mark", 0)[i] == (double)(i - 8));
        assert_true(fabs(rig_real(&rig, 0, "x", 0)[i] - (0.97 - 0.93 * (double)(i - 8))) < 1e-12);
    }
    run_free(&run);
    rig_close(&rig);

    rig_open(&rig, &items, ONE("{'name':'move'" GATED "}", ""), ",'copies':0,'end':-1");
    begin(&run, &rig);
    run.dt = 0.02;
    for (int k = 0; k < 3; k++)
        if (run_advance(&run, &e))
            fail_msg("%s", e.text);
    assert_int_equal(rig.plan.array[0].p.n, 0);
    run_free(&run);
    rig_close(&rig);

    rig_open(&rig, &items, ONE("{'name':'move'" GATED "}", ""), ",'copies':-2,'end':0");
    begin(&run, &rig);
    run.dt = 0.02;
    assert_int_not_equal(run_advance(&run, &e), 0);
    assert_non_null(strstr(e.text, "gate(row) at step 0: made of a particle is -2"));
    run_free(&run);
    rig_close(&rig);

    rig_refused(&items, "stands at \"finish\", not at \"evaluate\"",
                ONE("{'name':'move','edit':[{'operation':'assignment','function':'gate'}]}", ""));
}

/* All particles leave: nothing bounds the time step any more and there is nothing to draw, and the
 * run comes to its end all the same. */
static void the_last_one_leaves(void **state)
{
    struct rig rig;
    struct output out;
    struct error e = {0};
    const struct loop_options options = {
        .scene_path = "scene.json", .until = NAN, .steps = UINT64_MAX, .threads = 1};

    rig_open(&rig, &items,
             ONE("{'name':'move','edit':[{'replace':'follow','with':'bound'},{'operation':"
                 "'assignment','function':'gate','at':'finish','copies':0,'end':0.5}]}",
                 ",'output':{'picture':{'field':'v'}}"));
    assert_int_equal(output_open(&out, scratch_path(state, "out"), &e), 0);
    if (loop_run(&rig.plan, &out, &options, &e))
        fail_msg("%s", e.text);
    assert_int_equal(rig.plan.array[0].p.n, 0);
    output_close(&out);
    rig_close(&rig);
}

/* Without pairs there are no lists, and particles come round all the same. */
static void wrapped_without_lists(void **state)
{
    struct rig rig;
    struct run run;
    struct error e = {0};

    (void)state;
    rig_open(&rig, &items,
             "{'dimensions':1,'domain':{'min':[0],'max':[1],'sides':{'x':'periodic'}},"
             "'particles':{'row':{'fill':{'lattice':'square','count':10},'fields':{'rho':1,"
             "'v':[1]}}},'scheme':'move','time':{'end':1}}");
    begin(&run, &rig);
    run.dt = 0.25;
    for (int k = 0; k < 10; k++)
        assert_int_equal(run_advance(&run, &e), 0);
    for (size_t i = 0; i < 10; i++)
        assert_true(rig_real(&rig, 0, "x", 0)[i] >= 0 && rig_real(&rig, 0, "x", 0)[i] <= 1);
    run_free(&run);
    rig_close(&rig);
}

static void refused(const char *text)
{
    struct rig rig;
    struct error e = {0};

    if (!rig_make(&rig, &items, &e, ONE("{'name':'move'}", "")))
        fail_msg("accepted, in place of: %s", text);
    if (!strstr(e.text, text))
        fail_msg("says: %s\nin place of: %s", e.text, text);
    assert_int_equal(e.exit_code, EXIT_REFUSED);
    assert_int_equal(declare_status, SPH_E_INVALID);
    rig_close(&rig);
}

static void what_contradicts_itself_is_refused(void **state)
{
    (void)state;
    defaults();
    gate_population.remove = gate_population.create = NULL;
    refused("population of \"gate\": neither remove nor create");
    defaults();
    gate_population.create = NULL;
    refused("population of \"gate\": born is set, but create");
    defaults();
    gate_population.remove = "x";
    refused("population of \"gate\": remove is \"x\", which is not declared as a written int32");
    defaults();
    gate_population.create = "nothing";
    refused("create is \"nothing\", which is not declared");
    defaults();
    gate_population.born_props = (sph_list)SPH_LIST(touch_props);
    refused("born_props: \"m\" is read of sources, but new particles have none");
    defaults();
    gate_population.size = 12;
    refused("population of \"gate\": size of the descriptor is 12 bytes");
    defaults();
    follow_state.save = NULL;
    refused("state of \"follow\": save is NULL");
    defaults();
    follow_state.restore = NULL;
    refused("state of \"follow\": restore is NULL");
    defaults();
    state_kind = (const char *)(uintptr_t)8;
    refused("state: kind \"?\" is unknown to this sph");
}

/* -- State ----------------------------------------------------------------------------------------- */

static void states(void **state)
{
    struct rig rig;
    struct run run;
    struct error e = {0};
    struct use_state saved;

    (void)state;
    rig_open(&rig, &items, ONE("{'name':'move'}", ""));
    begin(&run, &rig);
    struct use *u = &rig.plan.pass[0].use;
    struct follow *f = u->state;
    assert_true(use_has_state(u) && !use_has_state(&rig.plan.pass[1].use));
    f->turns = 42;
    assert_int_equal(use_save(u, &rig.registry, &saved, &e), 0);
    assert_int_equal(saved.n, sizeof f->turns);
    assert_int_equal(saved.format, 7);
    f->turns = 0;
    assert_int_equal(use_restore(u, &rig.registry, &saved, &e), 0);
    assert_true(f->turns == 42);
    saved.format = 8;
    assert_int_not_equal(use_restore(u, &rig.registry, &saved, &e), 0);
    assert_string_equal(e.text,
                        "follow: its state cannot be restored: unknown format of the state");
    free(saved.bytes);
    run_free(&run);
    rig_close(&rig);
}

/* -- Boundary conditions ---------------------------------------------------------------------------- */

static void places_and_arrays(void **state)
{
    static const char *const order[] = {"first(row)", "first(rest)", "wall(row)",    "lid(rest)",
                                        "wall(rest)", "second(row)", "second(rest)", "lid(rest)"};
    struct rig rig;

    (void)state;
    rig_open(&rig, &items,
             SCENE("'plain'", ",'boundaries':[{'name':'walled','array':'rest','with':['row'],"
                              "'end':7}]"));
    const struct plan *plan = &rig.plan;
    assert_int_equal(plan->n_pass, sizeof order / sizeof *order);
    for (size_t i = 0; i < plan->n_pass; i++)
        assert_string_equal(plan->pass[i].name, order[i]);
    assert_int_equal(plan->pass[0].n_src, 2);
    assert_int_equal(plan->pass[2].n_src, 1);
    assert_int_equal(plan->pass[2].src[0].array, 1); /* the bounded, from the boundary */
    assert_int_equal(plan->pass[3].src[0].array, 0);
    assert_int_equal(plan->pass[4].moment, MOMENT_FINISH);
    assert_true(plan->pass[2].use.config.value[0] == 7 && plan->pass[0].use.config.value[0] == 1);
    rig_close(&rig);

    rig_refused(&items, "the boundary condition \"walled\" has no parameter \"ends\" (did you",
                SCENE("'plain'", ",'boundaries':[{'name':'walled','ends':7}]"));
    rig_refused(&items, "unknown array \"rost\" (did you mean \"rest\"?)",
                SCENE("'plain'", ",'boundaries':[{'name':'walled','array':'rost'}]"));
    rig_refused(&items, "no boundary condition \"wall\" is registered (did you mean \"walled\"?)",
                SCENE("'plain'", ",'boundaries':[{'name':'wall'}]"));
}

/* What an edit puts in the place of a boundary condition's step acts where that did, with its
 * parameters; what it takes out leaves the condition's parameters what they are. */
static void edits_of_boundary_steps(void **state)
{
    struct rig rig;

    (void)state;
    rig_open(&rig, &items,
             SCENE("{'name':'plain','edit':[{'replace':'lid','with':'second'},{'delete':'wall'}]}",
                   ",'boundaries':[{'name':'walled','array':'rest','with':['row'],'end':7}]"));
    const struct plan *plan = &rig.plan;
    assert_int_equal(plan->n_pass, 7);
    assert_string_equal(plan->pass[2].name, "second(rest)");
    assert_true(plan->pass[2].use.config.value[0] == 7 && plan->pass[2].src[0].array == 0);
    rig_close(&rig);

    rig_open(&rig, &items,
             SCENE("{'name':'plain','edit':[{'delete':'lid'},{'delete':'lid'},{'delete':'wall'},"
                   "{'delete':'wall'}]}",
                   ",'boundaries':[{'name':'walled','end':7}]"));
    assert_int_equal(rig.plan.n_pass, 4);
    rig_close(&rig);

    rig_refused(&items, "/boundaries/0/array: no array is named",
                SCENE("'plain'", ",'boundaries':[{'name':'walled','array':[]}]"));
    rig_refused(&items, "/scheme/foo: the recipe has no parameter \"foo\"",
                ONE("{'foo':1,'edit':[{'operation':'assignment','function':'push'}]}", ""));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(tables, reset, scratch_teardown),
        cmocka_unit_test_setup_teardown(tables_of_files, reset, scratch_teardown),
        cmocka_unit_test_setup_teardown(reductions, reset, scratch_teardown),
        cmocka_unit_test_setup_teardown(one_in_one_out, reset, scratch_teardown),
        cmocka_unit_test_setup_teardown(siblings_and_none, reset, scratch_teardown),
        cmocka_unit_test_setup_teardown(what_contradicts_itself_is_refused, reset,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(states, reset, scratch_teardown),
        cmocka_unit_test_setup_teardown(places_and_arrays, reset, scratch_teardown),
        cmocka_unit_test_setup_teardown(the_last_one_leaves, reset, scratch_teardown),
        cmocka_unit_test_setup_teardown(wrapped_without_lists, reset, scratch_teardown),
        cmocka_unit_test_setup_teardown(edits_of_boundary_steps, reset, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
