/* test_loop.c -- the step loop: ends and snapshots on time, steps that grow no faster than they may, the
 * log's rows, and how a run fails. */
#include "config.h"

#include "io/snapshot.h"
#include "motion.h"
#include "run/loop.h"
#include "scratch.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SCENE(edit, time, output)                                                                  \
    "{'dimensions':1,'domain':{'min':[0],'max':[1]},'particles':{'dust':{'fill':{'lattice':"       \
    "'square','count':4},'fields':{'rho':1,'v':[1]}}},'scheme':{'name':'coast','edit':[" edit      \
    "]},'time':" time ",'output':" output "}"
#define BOUND "{'insert':'bound','early':0.1}"

struct result {
    int status;
    struct error error;
    double step[1000], time[1000], dt[1000]; /* of the log */
    int rows;
    char header[512];
};

/* The first three columns of log.csv. */
static void read_log(void **state, struct result *q)
{
    size_t n = 0;
    char *text = scratch_read(scratch_path(state, "out/log.csv"), &n);
    q->rows = 0;
    if (!text)
        return;
    char *line = strchr(text, '\n');
    assert_non_null(line);
    snprintf(q->header, sizeof q->header, "%.*s", (int)(line - text), text);
    for (line++; *line; line = strchr(line, '\n') + 1) {
        assert_in_range(q->rows, 0, 999);
        assert_int_equal(
            sscanf(line, "%lf,%lf,%lf", &q->step[q->rows], &q->time[q->rows], &q->dt[q->rows]), 3);
        q->rows++;
        if (!strchr(line, '\n'))
            break;
    }
    free(text);
}

/* Runs a scene into DIR/out. `spoil`: makes the first particle's "value" a NaN. */
static struct result run(void **state, const char *scene, struct loop_options o, bool spoil)
{
    struct result q = {0};
    struct rig r;
    struct output out;
    rig_open(&r, &motion_items, "%s", scene);
    if (spoil)
        rig_real(&r, 0, "value", 0)[0] = NAN;
    if (output_open(&out, scratch_path(state, "out"), &q.error))
        fail_msg("%s", q.error.text);
    o.scene_path = "scene.json";
    o.threads = 1;
    q.status = loop_run(&r.plan, &out, &o, &q.error);
    output_close(&out);
    rig_close(&r);
    read_log(state, &q);
    return q;
}

static const struct loop_options plain = {.until = NAN, .steps = UINT64_MAX};

static struct result run_well(void **state, const char *scene)
{
    const struct result q = run(state, scene, plain, false);
    if (q.status)
        fail_msg("%s", q.error.text);
    assert_true(q.rows > 0);
    return q;
}

/* Time of snapshot `number`, or NaN if there is none. */
static double snapshot_time(void **state, int number)
{
    struct snapshot s;
    struct error e = {0};
    char name[64];
    snprintf(name, sizeof name, "out/snapshot_%04d.vtkhdf", number);
    if (!scratch_exists(scratch_path(state, name)))
        return NAN;
    if (snapshot_read(&s, scratch_path(state, name), &e))
        fail_msg("%s", e.text);
    const double time = s.time;
    snapshot_free(&s);
    return time;
}

static void check_times(void **state, double every, double begin, double end)
{
    const int n = (int)ceil((end - begin) / every - 1e-6);
    for (int k = 0; k <= n; k++) {
        const double wanted = k == n ? end : begin + k * every;
        const double found = snapshot_time(state, k);
        if (!(found == wanted))
            fail_msg("snapshot %d of %d, every %g: t = %.17g, not %.17g", k, n, every, found,
                     wanted);
    }
    assert_true(isnan(snapshot_time(state, n + 1)));
}

/* Each moment is met exactly, and not by a sliver of a step. */
static void test_on_time(void **state)
{
    static const struct {
        double every, begin, end;
    } cases[] = {{0.3, 0, 0.9}, {0.07, 0, 0.5}, {0.1, 0, 0.7},
                 {0.2, -1, 1},  {5, 0, 1},      {0.01, 3, 3.1}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        char text[2048];
        snprintf(text, sizeof text, SCENE(BOUND, "{'begin':%g,'end':%g,'cfl':0.2}", "{'every':%g}"),
                 cases[k].begin, cases[k].end, cases[k].every);
        const struct result q = run_well(state, text);
        check_times(state, cases[k].every, cases[k].begin, cases[k].end);
        assert_true(q.time[q.rows - 1] == cases[k].end);
        for (int i = 2; i < q.rows; i++)
            assert_true(q.dt[i] > 0.4 * fmin(q.dt[i - 1], 0.2 * 0.1));
        for (int i = 1; i < q.rows; i++)
            assert_true(fabs(q.time[i] - q.time[i - 1] - q.dt[i]) <
                        1e-14 + 1e-14 * fabs(q.time[i]));
    }
}

static void test_growth(void **state)
{
    const double cfl = 0.2, early = 0.01, late = 1;
    const struct result q = run_well(
        state, SCENE("{'insert':'bound','early':0.01,'late':1}", "{'end':4,'cfl':0.2}", "{}"));
    assert_true(fabs(q.dt[1] / (0.1 * cfl * early) - 1) < 1e-12); /* a tenth at first */
    bool full_early = false, full_late = false;
    for (int i = 2; i < q.rows; i++) {
        /* The bound is that of the evaluation before. */
        const double most = cfl * (q.time[i - 1] < 0.5 ? early : late);
        assert_true(q.dt[i] <= 1.2 * q.dt[i - 1] * (1 + 1e-12));
        assert_true(q.dt[i] <= most * (1 + 1e-12));
        assert_true(q.dt[i] >= fmin(1.2 * q.dt[i - 1], most) * 0.45); /* halved at the end alone */
        full_early = full_early || fabs(q.dt[i] / (cfl * early) - 1) < 1e-12;
        full_late = full_late || fabs(q.dt[i] / (cfl * late) - 1) < 1e-12;
    }
    assert_true(full_early && full_late);
}

static void test_given_steps(void **state)
{
    struct result q = run_well(state, SCENE("", "{'end':1,'dt':0.1}", "{}"));
    assert_int_equal(q.rows, 11);
    for (int i = 1; i < 11; i++)
        assert_true(fabs(q.dt[i] - 0.1) < 1e-14);
    q = run_well(state, SCENE(BOUND, "{'end':1,'dt_max':0.01}", "{}"));
    for (int i = 1; i < q.rows; i++)
        assert_true(q.dt[i] <= 0.01);
    q = run_well(state, SCENE("", "{'end':1,'dt':0.1,'steps':3}", "{}"));
    assert_int_equal(q.rows, 4);
    assert_true(fabs(snapshot_time(state, 1) - 0.3) < 1e-15);
    struct loop_options o = plain;
    o.steps = 0;
    q = run(state, SCENE("", "{'end':1,'dt':0.1}", "{}"), o, false);
    assert_int_equal(q.status, 0);
    assert_true(snapshot_time(state, 1) == 0);
    o = plain;
    o.until = 0.25;
    q = run(state, SCENE("", "{'end':1,'dt':0.1}", "{'every':0.2}"), o, false);
    assert_int_equal(q.status, 0);
    assert_true(snapshot_time(state, 1) == 0.2 && snapshot_time(state, 2) == 0.25);
}

static void test_log_rows(void **state)
{
    struct result q = run_well(state, SCENE("", "{'end':1,'dt':0.1}", "{'log':{'steps':4}}"));
    assert_int_equal(q.rows, 4); /* 0, 4, 8 and the last */
    assert_true(q.step[1] == 4 && q.step[2] == 8 && q.step[3] == 10);
    q = run_well(state, SCENE("", "{'end':1,'dt':0.01}", "{'log':{'every':0.25}}"));
    assert_int_equal(q.rows, 5);
    for (int i = 0; i < 5; i++)
        assert_true(fabs(q.time[i] - 0.25 * i) < 0.0101);
    /* A reduction that two arrays share is one column. */
    q = run_well(state,
                 "{'dimensions':1,'domain':{'min':[0],'max':[2]},'particles':{"
                 "'one':{'fill':{'lattice':'square','count':4,'in':{'box':{'min':[0],'max':[1]}}},"
                 "'fields':{'rho':1,'value':'x + 1'}},"
                 "'two':{'fill':{'lattice':'square','count':4,'in':{'box':{'min':[1],'max':[2]}}},"
                 "'fields':{'rho':1,'value':'x + 1'}}},'scheme':{'name':'coast','edit':["
                 "{'insert':'measure'}]},'time':{'end':1,'dt':0.5}}");
    assert_string_equal(q.header, "step,time,dt,kinetic,internal,potential,momentum_x,mass,least,"
                                  "most,total,wall_s");
    char *text = scratch_read(scratch_path(state, "out/log.csv"), NULL);
    assert_non_null(strstr(text, "\n0,0,0,0,0,0,0,2,1.125,2.875,16,"));
    free(text);
}

/* The summary of the last run: its status; `reason` is what it begins with. */
static void check_summary(void **state, const char *status, const char *reason)
{
    char *text = scratch_read(scratch_path(state, "out/summary.json"), NULL);
    assert_non_null(text);
    cJSON *root = cJSON_Parse(text);
    assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(root, "status")), status);
    if (reason)
        assert_non_null(strstr(cJSON_GetStringValue(cJSON_GetObjectItem(root, "reason")), reason));
    cJSON_Delete(root);
    free(text);
}

static void test_failures(void **state)
{
    struct result q = run(state, SCENE("", "{'end':1}", "{}"), plain, false);
    assert_int_not_equal(q.status, 0);
    assert_int_equal(q.error.exit_code, EXIT_USAGE);
    assert_non_null(strstr(q.error.text, "no function of the scene bounds the time step"));
    check_summary(state, "failed", "no function");
    /* A bound that is no number must not pass for no bound, nor hide behind another. */
    q = run(state, SCENE(BOUND ",{'insert':'measure'}", "{'end':1,'dt_max':0.1}", "{}"), plain,
            true);
    assert_int_not_equal(q.status, 0);
    assert_int_equal(q.error.exit_code, EXIT_RUN);
    assert_non_null(strstr(q.error.text, "the time step is no longer a number at step 0"));
    check_summary(state, "failed", q.error.text);
    assert_true(snapshot_time(state, 0) == 0);
    q = run(state, SCENE("{'insert':'bound','early':0}", "{'end':1}", "{}"), plain, false);
    assert_int_equal(q.error.exit_code, EXIT_RUN);
    assert_non_null(strstr(q.error.text, "the time step collapsed to 0"));
}

static void test_stopped(void **state)
{
    static const volatile int stop = 1;
    struct loop_options o = plain;
    o.stop = &stop;
    const struct result q = run(state, SCENE(BOUND, "{'end':1}", "{}"), o, false);
    assert_int_equal(q.status, 0);
    assert_int_equal(q.rows, 1);
    check_summary(state, "stopped", NULL);
    assert_true(snapshot_time(state, 1) == 0);
}

int main(void)
{
#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        IN_SCRATCH(test_on_time),  IN_SCRATCH(test_growth),   IN_SCRATCH(test_given_steps),
        IN_SCRATCH(test_log_rows), IN_SCRATCH(test_failures), IN_SCRATCH(test_stopped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
