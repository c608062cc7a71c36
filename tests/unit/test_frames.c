/* test_frames.c -- neighbours in places other than the position: followed where they move, found once where
 * they are frozen, through sorts and changes of the population; and what is refused. Each neighbour adds
 * a whole number, so that sums are exact in any order. */
#include "config.h"

#include "io/checkpoint.h"
#include "rig.h"
#include "run/run.h"
#include "scratch.h"

#include "../walk.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SIZE(type) ((uint32_t)sizeof(type))
#define SUPPORT 2.0 /* of the kernel "thing" */
#define ITEM(variable, name_, params_)                                                             \
    static const sph_item variable##_item = {.size = SIZE(sph_item),                               \
                                             .dims = SPH_ALL_DIMS,                                 \
                                             .name = name_,                                        \
                                             .doc = "a mock",                                      \
                                             .params = params_,                                    \
                                             .props = SPH_LIST(variable##_props)}

static double *at(const sph_column *column, uint32_t c)
{
    return (double *)column->data + c * column->plane;
}

/* -- Functions: the sum of "key" over the neighbours ---------------------------------------------- */

enum { X, X0, KEY, SUM };

/* By the places in column k; of the position where k is SUM. */
static sph_status add_keys(const sph_batch *b, int k)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        const double reach = SUPPORT * at(&b->h_dst, 0)[i];
        for (struct walk w = walk_begin(b, i); walk_next(&w);) {
            double r2 = 0;
            for (uint32_t c = 0; c < b->dim; c++) {
                const double d = at(k == SUM ? &b->x_dst : &b->dst[k], c)[i] -
                                 at(k == SUM ? &b->x_src : &b->src[k], c)[w.j];
                r2 += d * d;
            }
            if (r2 < reach * reach)
                at(&b->dst[SUM], 0)[i] += at(&b->src[KEY], 0)[w.j];
        }
    }
    return SPH_OK;
}

/* By x_dst, x_src: what the host takes for the places. */
static sph_status of_places(const sph_batch *b)
{
    return add_keys(b, SUM);
}

/* By where X began: neighbours that were found once are all there, wherever X has gone. */
static sph_status of_first(const sph_batch *b)
{
    return add_keys(b, X0);
}

#define SUMS(variable, name, sum)                                                                  \
    static const sph_prop variable##_props[] = {                                                   \
        {"X", "m", "", SPH_VECTOR, SPH_DST_READ | SPH_SRC_READ, NAN},                              \
        {"X0", "m", "", SPH_VECTOR, SPH_DST_READ | SPH_SRC_READ, NAN},                             \
        {"key", "", "", SPH_SCALAR, SPH_SRC_READ, 0},                                              \
        {sum, "", "", SPH_SCALAR, SPH_DST_SUM, 0},                                                 \
    };                                                                                             \
    ITEM(variable, name, SPH_NO_LIST);                                                             \
    static const sph_function variable
SUMS(plain, "plain", "of_x") = {.size = SIZE(sph_function),
                                .shape = SPH_PAIR,
                                .item = &plain_item,
                                .run = of_places,
                                .reach = SPH_GATHER,
                                .reach_scale = 1};
SUMS(follow, "follow", "of_X") = {.size = SIZE(sph_function),
                                  .shape = SPH_PAIR,
                                  .item = &follow_item,
                                  .run = of_places,
                                  .reach = SPH_GATHER,
                                  .reach_scale = 1,
                                  .reals = SPH_F64 | SPH_F32,
                                  .over = "X"};
SUMS(keep, "keep", "of_X0") = {.size = SIZE(sph_function),
                               .shape = SPH_PAIR,
                               .item = &keep_item,
                               .run = of_first,
                               .reach = SPH_GATHER,
                               .reach_scale = 1,
                               .frozen = 1,
                               .over = "X"};
SUMS(keep_twice, "keep-twice", "of_X0_again") = {.size = SIZE(sph_function),
                                                 .shape = SPH_PAIR,
                                                 .item = &keep_twice_item,
                                                 .run = of_first,
                                                 .reach = SPH_GATHER,
                                                 .reach_scale = 1,
                                                 .frozen = 1,
                                                 .over = "X"};

/* X = X0 (1 + rate t) */
static sph_status stretch_run(const sph_batch *b)
{
    for (uint32_t c = 0; c < b->dim; c++)
        for (uint64_t i = b->first; i < b->first + b->count; i++)
            at(&b->dst[0], c)[i] = at(&b->dst[1], c)[i] * (1 + b->param[0] * b->time);
    return SPH_OK;
}

/* X = X0 = x */
static sph_status settle_run(const sph_batch *b)
{
    for (uint32_t c = 0; c < b->dim; c++)
        for (uint64_t i = b->first; i < b->first + b->count; i++)
            at(&b->dst[0], c)[i] = at(&b->dst[1], c)[i] = at(&b->dst[2], c)[i];
    return SPH_OK;
}

static const sph_prop settle_props[] = {
    {"X", "m", "", SPH_VECTOR, SPH_DST_WRITE, NAN},
    {"X0", "m", "", SPH_VECTOR, SPH_DST_WRITE, NAN},
    {"x", "m", "", SPH_VECTOR, SPH_DST_READ, NAN},
};
ITEM(settle, "settle", SPH_NO_LIST);
static const sph_function settle = {
    .size = SIZE(sph_function), .shape = SPH_POINT, .item = &settle_item, .run = settle_run};

static const sph_param stretch_params[] = {SPH_PARAM("rate", "", "", 1, 1, 0)};
static const sph_prop stretch_props[] = {
    {"X", "m", "", SPH_VECTOR, SPH_DST_WRITE, NAN},
    {"X0", "m", "", SPH_VECTOR, SPH_DST_READ, NAN},
};
ITEM(stretch, "stretch", SPH_LIST(stretch_params));
static const sph_function stretch = {
    .size = SIZE(sph_function), .shape = SPH_POINT, .item = &stretch_item, .run = stretch_run};

/* X advances with W = V. */
static sph_status flow_run(const sph_batch *b)
{
    for (uint32_t c = 0; c < b->dim; c++)
        for (uint64_t i = b->first; i < b->first + b->count; i++)
            at(&b->dst[0], c)[i] = at(&b->dst[1], c)[i];
    return SPH_OK;
}

static const sph_prop flow_props[] = {
    {"W", "m/s", "", SPH_VECTOR, SPH_DST_WRITE, 0},
    {"V", "m/s", "", SPH_VECTOR, SPH_DST_READ, 0},
    {"X", "m", "", SPH_VECTOR, SPH_DST_READ, NAN},
};
static const sph_rate flow_rates[] = {{"X", "W", SPH_KICK, 0}};
ITEM(flow, "flow", SPH_NO_LIST);
static const sph_function flow = {.size = SIZE(sph_function),
                                  .shape = SPH_POINT,
                                  .item = &flow_item,
                                  .run = flow_run,
                                  .rates = SPH_LIST(flow_rates)};

/* Removes and doubles what the test has marked. */
static sph_status cull_run(const sph_batch *b)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        ((int32_t *)b->dst[0].data)[i] = at(&b->dst[2], 0)[i] > 0;
        ((int32_t *)b->dst[1].data)[i] = at(&b->dst[2], 0)[i] < 0;
        at(&b->dst[2], 0)[i] = 0;
    }
    return SPH_OK;
}

static sph_status cull_born(const sph_batch *b)
{
    for (uint64_t i = b->first; i < b->first + b->count; i++)
        for (int k = 0; k < 3; k++)
            at(&b->dst[k], 0)[i] += 0.013;
    return SPH_OK;
}

static const sph_prop cull_props[] = {
    {"gone", "", "", SPH_INT32, SPH_DST_WRITE, 0},
    {"made", "", "", SPH_INT32, SPH_DST_WRITE, 0},
    {"marked", "", "", SPH_SCALAR, SPH_DST_UPDATE, 0},
};
static const sph_prop cull_born_props[] = {
    {"x", "m", "", SPH_VECTOR, SPH_DST_UPDATE, NAN},
    {"X", "m", "", SPH_VECTOR, SPH_DST_UPDATE, NAN},
    {"X0", "m", "", SPH_VECTOR, SPH_DST_UPDATE, NAN},
};
ITEM(cull, "cull", SPH_NO_LIST);
static const sph_function cull = {
    .size = SIZE(sph_function), .shape = SPH_POINT, .item = &cull_item, .run = cull_run};
static const sph_population cull_population = {.size = SIZE(sph_population),
                                               .remove = "gone",
                                               .create = "made",
                                               .born = cull_born,
                                               .born_props = SPH_LIST(cull_born_props)};

static sph_status declare(const sph_host *host)
{
    const sph_population_ext *population =
        (const sph_population_ext *)host->extension(host, SPH_EXT_POPULATION);
    return population->declare(host, "cull", &cull_population);
}

/* x by v, and nothing else. */
static sph_status nothing(const sph_batch *b)
{
    (void)b;
    return SPH_OK;
}
static const sph_prop rest_props[] = {{"v", "m/s", "", SPH_VECTOR, SPH_DST_READ, 0}};
ITEM(rest, "rest", SPH_NO_LIST);
static const sph_function rest = {
    .size = SIZE(sph_function), .shape = SPH_POINT, .item = &rest_item, .run = nothing};
static const sph_step steps[] = {SPH_STEP(SPH_AT_EVALUATE, "rest")};
static const sph_rate rates[] = {{"x", "v", SPH_DRIFT, 0}};
static const sph_item scheme_item = {
    .size = SIZE(sph_item), .dims = SPH_ALL_DIMS, .name = "coast", .doc = "a mock"};
static const sph_scheme scheme = {.size = SIZE(sph_scheme),
                                  .item = &scheme_item,
                                  .kernel = "thing",
                                  .integrator = "kdk",
                                  .cfl = 0.25,
                                  .steps = SPH_LIST(steps),
                                  .rates = SPH_LIST(rates)};

static const struct rig_items items = {
    .function = {&plain, &follow, &keep, &keep_twice, &settle, &stretch, &flow, &cull, &rest, NULL},
    .scheme = {&scheme, NULL},
    .more = declare};

/* -- The same by hand ----------------------------------------------------------------------------- */

static double by_hand(const struct rig *r, const char *place, size_t i)
{
    const double *h = rig_real(r, 0, "h", 0), *key = rig_real(r, 0, "key", 0);
    const double *x = rig_real(r, 0, place, 0), *y = rig_real(r, 0, place, 1);
    const double reach = SUPPORT * h[i];
    double sum = 0;
    for (size_t j = 0; j < r->plan.array[0].p.n; j++) {
        const double dx = x[i] - x[j], dy = y[i] - y[j];
        if (dx * dx + dy * dy < reach * reach)
            sum += key[j];
    }
    return sum;
}

static void check(const struct rig *r, const char *sum, const char *place, unsigned long long step)
{
    for (size_t i = 0; i < r->plan.array[0].p.n; i++) {
        const double found = rig_real(r, 0, sum, 0)[i], good = by_hand(r, place, i);
        if (found < good || found > good)
            fail_msg("\"%s\" of particle %zu at step %llu is %g, not %g", sum, i, step, found,
                     good);
    }
}

struct motion {
    struct rig rig;
    struct run run;
};

#define SCENE(sides, edits, more)                                                                  \
    "{'dimensions':2,'domain':{'min':[0,0],'max':[1,1],'sides':" sides "},'particles':{'dust':{"   \
    "'fill':{'lattice':'square','count':144,'jitter':0.3},'columns':{'V':['3 * x - y','x']},"      \
    "'fields':{'rho':1,'X':['x','y'],'X0':['x','y'],'v':['sin(40 * x + 17 * y)','cos(71 * x - "    \
    "23 * y)']}}},'scheme':{'name':'coast','edit':[" edits "]},'time':{'end':1}" more "}"
#define ALL                                                                                        \
    "{'insert':'plain','after':'rest'},{'insert':'follow','after':'rest'},"                        \
    "{'insert':'keep','after':'rest'}"

static void begin(struct motion *m, const char *text)
{
    struct error e = {0};
    rig_open(&m->rig, &items, "%s", text);
    const struct particles *p = &m->rig.plan.array[0].p;
    for (size_t i = 0; i < p->n; i++)
        rig_real(&m->rig, 0, "key", 0)[i] = (double)(1 + i);
    if (run_init(&m->run, &m->rig.plan, 2, SPH_PATH_BEST, false, &e) ||
        run_passes(&m->run, MOMENT_START, &e) || run_passes(&m->run, MOMENT_EVALUATE, &e))
        fail_msg("%s", e.text);
    m->run.dt = 0.005;
}

static void advance(struct motion *m)
{
    struct error e = {0};
    if (run_advance(&m->run, &e))
        fail_msg("%s", e.text);
    m->run.step++;
}

static void end(struct motion *m)
{
    run_free(&m->run);
    rig_close(&m->rig);
}

/* -- Tests ---------------------------------------------------------------------------------------- */

/* X stands still while x flies about: lists over X outlast all sorts of the particles. */
static void x_moves(void **state)
{
    struct motion m;
    (void)state;
    begin(&m, SCENE("{}", ALL ",{'insert':'keep-twice','after':'rest'}", ",'precision':'mixed'"));
    assert_int_equal(m.rig.plan.n_frame, 3); /* x, X, X frozen */
    assert_int_equal(m.rig.plan.n_list, 3);  /* keep and keep-twice share one */
    for (size_t i = 0; i < m.rig.plan.n_pass; i++)
        assert_true(m.rig.plan.pass[i].shape != SPH_PAIR || m.rig.plan.pass[i].real == SPH_F64);
    struct run_memory early = {0};
    for (unsigned n = 0; n < 120; n++) {
        check(&m.rig, "of_x", "x", n);
        check(&m.rig, "of_X", "X0", n);
        check(&m.rig, "of_X0", "X0", n);
        check(&m.rig, "of_X0_again", "X0", n);
        advance(&m);
        if (n == 40)
            early = run_memory(&m.run);
    }
    assert_in_range(m.run.cost.sorts, 2, 20);
    /* The dust spreads, so the lists in x shrink; those in X are what they were. */
    const struct run_memory late = run_memory(&m.run);
    assert_in_range(late.lists, 1, 2 * early.lists);
    assert_in_range(late.places, 1, 2 * early.places);
    end(&m);
}

/* A function writes X: lists over X follow, those in x do not care, frozen ones keep the first neighbours. */
static void follow_written(const char *text, bool frozen)
{
    struct motion m;
    begin(&m, text);
    const size_t groups = m.rig.plan.array[0].p.n / SPH_LANES;
    for (size_t k = 0; k < m.rig.plan.n_list; k++) /* far from all pairs */
        assert_in_range(m.run.list[k].n_entry, 1, groups * m.rig.plan.array[0].p.n / 2);
    for (unsigned n = 0; n < 120; n++) {
        check(&m.rig, "of_x", "x", n);
        check(&m.rig, "of_X", "X", n);
        if (frozen)
            check(&m.rig, "of_X0", "X0", n);
        advance(&m);
    }
    assert_true(m.run.cost.sorts > 1);
    end(&m);
}

static void X_is_written(void **state)
{
    (void)state;
    follow_written(SCENE("{}", ALL ",{'insert':'stretch','rate':0.6,'before':'rest'}", ""), true);
}

/* Together by 40 %: as many more neighbours come. */
static void X_contracts(void **state)
{
    (void)state;
    follow_written(SCENE("{}", ALL ",{'insert':'stretch','rate':-0.7,'before':'rest'}", ""), true);
}

/* X has a rate: the integrator moves it. */
static void X_has_a_rate(void **state)
{
    (void)state;
    follow_written(SCENE("{}", ALL ",{'insert':'flow','after':'rest'}", ""), true);
}

/* The first places are taken at the start, by a function: neighbours in them are found after that. */
static void X_is_made_at_the_start(void **state)
{
    (void)state;
    follow_written(
        "{'dimensions':2,'domain':{'min':[0,0],'max':[1,1]},'particles':{'dust':{'fill':"
        "{'lattice':'square','count':144,'jitter':0.3},'fields':{'rho':1,'v':["
        "'sin(40 * x + 17 * y)','cos(71 * x - 23 * y)']}}},'scheme':{'name':'coast','edit':["
        "{'insert':'settle','at':'start'}," ALL "]},'time':{'end':1}}",
        true);
}

/* ... and a sum at the end of a step finds lists that fit. */
static void at_the_finish(void **state)
{
    struct motion m;
    (void)state;
    begin(&m, SCENE("{}",
                    "{'insert':'flow','after':'rest'},{'insert':'follow','at':'finish'},"
                    "{'insert':'plain','at':'finish'}",
                    ""));
    m.run.dt = 0.04;
    for (unsigned n = 0; n < 20; n++) {
        advance(&m);
        check(&m.rig, "of_X", "X", n);
        check(&m.rig, "of_x", "x", n);
    }
    end(&m);
}

/* Particles that leave and that are made, in the midst of it: frozen neighbours are those of who is there. */
static void population(void **state)
{
    struct motion m;
    struct error e = {0};
    (void)state;
    begin(&m, SCENE("{}", ALL ",{'insert':'cull','at':'finish'}", ""));
    for (unsigned n = 0; n < 40; n++) {
        const struct particles *p = &m.rig.plan.array[0].p;
        const size_t before = p->n;
        if (n % 5 == 2)
            for (size_t i = n; i < before; i += 20)
                rig_real(&m.rig, 0, "marked", 0)[i] = i % 40 == n ? -1 : 1;
        advance(&m);
        if (run_passes(&m.run, MOMENT_EVALUATE, &e))
            fail_msg("%s", e.text);
        check(&m.rig, "of_x", "x", n);
        check(&m.rig, "of_X", "X", n);
        check(&m.rig, "of_X0", "X0", n);
    }
    assert_true(m.run.cost.created > 8);
    end(&m);
}

/* All columns of two runs, ghosts and what is made anew at each evaluation aside. */
static void check_same(const struct rig *a, const struct rig *b, unsigned long long step)
{
    const struct particles *p = &a->plan.array[0].p, *q = &b->plan.array[0].p;
    if (p->n != q->n)
        fail_msg("%zu and %zu particles at step %llu", p->n, q->n, step);
    for (size_t c = 0; c < p->n_column; c++)
        for (uint32_t k = 0; k < p->column[c].ncomp; k++) {
            const struct column *x = &p->column[c], *y = &q->column[c];
            if (memcmp((char *)x->data + k * x->plane * x->size,
                       (char *)y->data + k * y->plane * y->size, p->n * x->size) != 0)
                fail_msg("\"%s\" has other bits at step %llu", x->name, step);
        }
}

/* Out of a checkpoint, at any step: the same lists in every frame, through sorts, removals and births. */
static void checkpoints(void **state)
{
    const char *text = SCENE("{}", ALL ",{'insert':'cull','at':'finish'}", "");
    const char *path = scratch_path(state, "checkpoint_00000000.h5");
    for (unsigned stop = 1; stop < 70; stop += 4) {
        struct motion m[2];
        struct checkpoint file;
        struct error e = {0};
        begin(&m[0], text);
        rig_open(&m[1].rig, &items, "%s", text);
        if (run_init(&m[1].run, &m[1].rig.plan, 1, SPH_PATH_BEST, false, &e))
            fail_msg("%s", e.text);
        for (unsigned n = 0; n < 100; n++) {
            if (n == stop) {
                if (checkpoint_create(&file, path, &e) ||
                    checkpoint_finish(&file, run_store(&m[0].run, &file.store, &e), &e) ||
                    checkpoint_open(&file, path, &e) || run_store(&m[1].run, &file.store, &e))
                    fail_msg("%s", e.text);
                checkpoint_close(&file);
            }
            for (int k = 0; k <= (n >= stop); k++) {
                const size_t all = m[k].rig.plan.array[0].p.n;
                for (size_t i = n; n % 5 == 2 && i < all; i += 20)
                    rig_real(&m[k].rig, 0, "marked", 0)[i] = i % 40 == n ? -1 : 1;
                advance(&m[k]);
                if (n % 2 && run_passes(&m[k].run, MOMENT_EVALUATE, &e))
                    fail_msg("%s", e.text);
            }
            if (n >= stop)
                check_same(&m[0].rig, &m[1].rig, n);
        }
        assert_int_equal(m[0].run.cost.list_builds, m[1].run.cost.list_builds);
        assert_int_equal(m[0].run.cost.pairs, m[1].run.cost.pairs);
        assert_true(m[1].run.cost.created > 8 && m[1].run.cost.sorts > 2);
        end(&m[0]);
        end(&m[1]);
    }
}

/* Two arrays, one asked for: no other list is kept. */
static void pairs_not_asked_for(void **state)
{
    struct rig r;
    (void)state;
    rig_open(&r, &items,
             "{'dimensions':1,'domain':{'min':[0],'max':[2]},'particles':{"
             "'one':{'fill':{'lattice':'square','spacing':0.1,'in':{'box':{'min':[0],'max':[1]}}},"
             "'fields':{'rho':1,'X':['x'],'X0':['x']}},"
             "'two':{'fill':{'lattice':'square','spacing':0.1,'in':{'box':{'min':[1],'max':[2]}}},"
             "'fields':{'rho':1,'X':['x'],'X0':['x']}}},'scheme':{'name':'coast','edit':["
             "{'insert':'plain','to':'one','from':'two'},{'insert':'keep','to':'two','from':'two'},"
             "{'insert':'follow','to':'two'}]},'time':{'end':1}}");
    const struct plan *plan = &r.plan;
    assert_int_equal(plan->n_list, 4); /* one-two; two-two; two-one, two-two */
    assert_non_null(plan_pair(plan, 0, 1));
    assert_null(plan_pair(plan, 0, 0));
    assert_null(plan_pair(plan, 1, 0));
    assert_null(plan_pair(plan, 1, 1));
    for (size_t k = 0; k < plan->n_list; k++)
        assert_true(plan->list[k].frame < plan->n_frame);
    assert_int_equal(plan->n_frame, 3);
    struct run run;
    struct error e = {0};
    if (run_init(&run, &r.plan, 1, SPH_PATH_BEST, false, &e) ||
        run_passes(&run, MOMENT_EVALUATE, &e))
        fail_msg("%s", e.text);
    run_free(&run);
    rig_close(&r);
}

static void sides(void **state)
{
    (void)state;
    rig_refused(&items,
                "keep looks for neighbours in \"X\", which is not possible in a domain with "
                "periodic or mirror sides",
                "%s", SCENE("{'x':'periodic'}", ALL, ""));
    rig_refused(&items, "follow looks for neighbours in \"X\", which is not possible", "%s",
                SCENE("{'y':['open','mirror']}", "{'insert':'follow'}", ""));
    struct motion m; /* what nobody uses does no harm */
    begin(&m, SCENE("{'x':'periodic'}", "{'insert':'plain'}", ""));
    end(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(x_moves),
        cmocka_unit_test_setup_teardown(checkpoints, scratch_setup, scratch_teardown),
        cmocka_unit_test(X_is_written),
        cmocka_unit_test(X_contracts),
        cmocka_unit_test(X_has_a_rate),
        cmocka_unit_test(X_is_made_at_the_start),
        cmocka_unit_test(at_the_finish),
        cmocka_unit_test(population),
        cmocka_unit_test(pairs_not_asked_for),
        cmocka_unit_test(sides),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
