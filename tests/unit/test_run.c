/* test_run.c -- a plan in motion: lists and ghosts against sums over all pairs and images,
 * passes that iterate, reductions, threads. */
#include "config.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "moving.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

#define PERIODIC "{'x':'periodic','y':'periodic'}"
#define MIRROR "{'x':'mirror','y':'mirror'}"

/* -- Lists and ghosts ---------------------------------------------------------------------------- */

/* Particles that fly about. The sums stand in the evaluation behind a pass that makes what they read. */
static void fly(struct motion *m, const char *sides, int n, const char *integrator, int threads)
{
    rig_open(
        &m->rig, &motion_items,
        "{'dimensions':2,'domain':{'min':[0,0],'max':[1,1],'sides':%s},'particles':{'dust':{"
        "'fill':{'lattice':'square','count':%d,'jitter':0.3},'fields':{'rho':1,"
        "'h0':'1.4 * spacing * (1 + 0.2 * sin(7 * x + 5 * y))','colour':'cos(90 * x) + y',"
        "'v':['sin(40 * x + 17 * y)','cos(71 * x - 23 * y)']}}},'scheme':{'name':'coast','edit':["
        "{'insert':'breathe','before':'shade'},{'insert':'gather'},{'insert':'gather-both'}]},"
        "'time':{'end':1,'integrator':'%s'}}",
        sides, n, integrator);
    begin(m, threads);
    passes(m, MOMENT_START);
    passes(m, MOMENT_EVALUATE);
}

static void check_all_pairs(const struct motion *m, const char *what)
{
    static const size_t itself[] = {0};
    for (int both = 0; both < 2; both++) {
        const double error = motion_error(&m->run, both != 0, 0, itself, 1);
        if (!(error < 1e-13))
            fail_msg("%s, %s: wrong by %g at step %d", what, both ? "gather-both" : "gather", error,
                     (int)m->run.step);
    }
    /* Nobody is further outside than the skin lets a particle go before it is wrapped. */
    const struct box *box = &m->rig.scene.box;
    for (uint32_t c = 0; c < (uint32_t)box->dim; c++)
        for (size_t i = 0; i < m->rig.plan.array[0].p.n; i++) {
            const double x = rig_real(&m->rig, 0, "x", c)[i];
            assert_true(x > -0.1 || box->side[c][0] == SIDE_OPEN);
            assert_true(x < 1.1 || box->side[c][1] == SIDE_OPEN);
        }
}

/* With lists that are used again and a sort now and then, each sum is the sum over all pairs and
 * images. */
static void test_all_pairs(void **state)
{
    static const char *const sides[] = {"{}", PERIODIC, MIRROR,
                                        "{'x':'periodic','y':['mirror','open']}"};
    static const char *const integrators[] = {"kdk", "pec", "rk4", "verlet2"};
    (void)state;
    for (size_t k = 0; k < COUNT(sides); k++) {
        struct motion m;
        fly(&m, sides[k], 100, integrators[k], 1);
        assert_true(m.run.skin >= 0.1); /* lists are used again */
        for (int n = 0; n < 80; n++) {
            /* Some evaluate in mid-step: their sums are of other places than those at the end. */
            if (!integrator_ends_evaluated(m.rig.plan.integrator))
                passes(&m, MOMENT_EVALUATE);
            check_all_pairs(&m, sides[k]);
            steps(&m, 0.005, 1);
        }
        assert_in_range(m.run.cost.list_builds, 20, 80);
        assert_in_range(m.run.cost.sorts, 2, 10);
        end(&m);
    }
}

/* Columns that were written anew reach the ghosts, and no sooner than they are asked for. */
static void test_ghosts_refreshed(void **state)
{
    static const char *const sides[] = {PERIODIC, MIRROR};
    (void)state;
    for (size_t k = 0; k < COUNT(sides); k++) {
        struct motion m;
        fly(&m, sides[k], 100, "kdk", 1);
        const struct plan_array *a = &m.rig.plan.array[0];
        assert_true(a->p.n_ghost > 0);
        const int q = particles_find(&a->p, "q"), colour = particles_find(&a->p, "colour");
        assert_false(m.run.stale[0][q]);
        assert_true(m.run.stale[0][colour]); /* which nobody reads from a source */
        /* Time stands in q: a ghost that kept the old value is wrong by dt. No list is made anew. */
        const uint64_t builds = m.run.cost.list_builds;
        m.run.time += 1e-6;
        passes(&m, MOMENT_EVALUATE);
        assert_int_equal(m.run.cost.list_builds, builds);
        check_all_pairs(&m, sides[k]);
        end(&m);
    }
}

/* Two particles that a periodic side parts. One has left the box, which is not wrapped in the midst of an
 * evaluation, when a growing h makes the lists anew: both then come within reach before the
 * next time. */
static void test_beyond_the_side(void **state)
{
    struct motion m;
    (void)state;
    rig_open(
        &m.rig, &motion_items,
        "{'dimensions':1,'domain':{'min':[0],'max':[1],'sides':{'x':'periodic'}},'particles':{'dust':{'fill':"
        "{'lattice':'square','count':2},'fields':{'rho':1,'h0':0.06}}},'scheme':{'name':'coast','edit':["
        "{'insert':'breathe','before':'shade','depth':0.02},{'insert':'gather'},"
        "{'insert':'gather-both'}]},'time':{'end':1}}");
    rig_real(&m.rig, 0, "x", 0)[0] = 0.0005;
    rig_real(&m.rig, 0, "x", 0)[1] = 0.8597;
    rig_real(&m.rig, 0, "v", 0)[0] = -0.0055;
    rig_real(&m.rig, 0, "v", 0)[1] = 0.0055;
    /* h = 1, 1.02, 1.02 times h0 at t = 0, 1, 2: see breathe. */
    const double grown = asin(1.0);
    for (size_t i = 0; i < 2; i++) {
        rig_real(&m.rig, 0, "colour", 0)[i] = 0;
        rig_real(&m.rig, 0, "h", 0)[i] = 0.06;
    }
    begin(&m, 1);
    passes(&m, MOMENT_EVALUATE);
    for (int n = 0; n < 2; n++) {
        for (size_t i = 0; i < 2; i++)
            rig_real(&m.rig, 0, "colour", 0)[i] = grown - 9 * (n + 1);
        steps(&m, 1, 1);
        check_all_pairs(&m, "beyond the side");
    }
    assert_int_equal(m.run.cost.list_builds, 2);
    assert_true(rig_real(&m.rig, 0, "x", 0)[0] < 0);
    end(&m);
}

/* Pair functions of the start and of the finish find lists that fit, however far the particles went since the
 * evaluation. */
static void test_pairs_at_start_and_finish(void **state)
{
    static const size_t itself[] = {0};
    struct motion m;
    (void)state;
    rig_open(
        &m.rig, &motion_items,
        "{'dimensions':1,'domain':{'min':[0],'max':[1],'sides':{'x':'periodic'}},'particles':{'dust':{'fill':"
        "{'lattice':'square','count':20},'fields':{'rho':1,'colour':'x','v':['sin(9 * x)']}}},'scheme':{'name':'coast','edit':["
        "{'replace':'shade','with':'shade','at':'start'},{'insert':'gather','at':'start'},"
        "{'insert':'shade'},{'insert':'gather-both','at':'finish'}]},'time':{'end':1,'integrator':'pec'}}");
    begin(&m, 1);
    passes(&m, MOMENT_START);
    assert_true(motion_error(&m.run, false, 0, itself, 1) < 1e-14);
    passes(&m, MOMENT_EVALUATE);
    for (int n = 0; n < 5; n++) {
        steps(&m, 0.2, 1);
        assert_true(motion_error(&m.run, true, 0, itself, 1) < 1e-14);
    }
    end(&m);
}

/* Sources of several arrays add up; those not named stay out. */
static void test_several_sources(void **state)
{
    static const size_t all[] = {0, 1}, second[] = {1};
    struct motion m;
    (void)state;
    rig_open(
        &m.rig, &motion_items,
        "{'dimensions':2,'domain':{'min':[0,0],'max':[2,1],'sides':{'x':'open','y':'periodic'}},'particles':{"
        "'one':{'fill':{'lattice':'square','spacing':0.1,'jitter':0.3,'in':{'box':{'min':[0,0],'max':[1,1]}}},"
        "'fields':{'rho':1,'colour':'x','v':['y','x'],'h0':0.1}},"
        "'two':{'fill':{'lattice':'square','spacing':0.08,'jitter':0.3,'in':{'box':{'min':[1,0],'max':[2,1]}}},"
        "'fields':{'rho':2,'colour':'y','v':['-y',1],'h0':0.14}}},"
        "'scheme':{'name':'coast','edit':[{'insert':'breathe','before':'shade'},"
        "{'insert':'gather'},{'insert':'gather-both','to':'one','from':'two'}]},'time':{'end':1}}");
    begin(&m, 1);
    passes(&m, MOMENT_EVALUATE);
    for (int n = 0; n < 30; n++) {
        assert_true(motion_error(&m.run, false, 0, all, 2) < 1e-13);
        assert_true(motion_error(&m.run, false, 1, all, 2) < 1e-13);
        assert_true(motion_error(&m.run, true, 0, second, 1) < 1e-13);
        steps(&m, 0.004, 1);
    }
    assert_true(m.run.cost.list_builds > 3);
    assert_int_equal(plan_pair(&m.rig.plan, 1, 0)->reach,
                     SPH_GATHER); /* two from one: only gather asks */
    end(&m);
}

/* A NaN in one particle's position is told, whatever stands behind it in the array. */
static void test_lost_particle(void **state)
{
    struct motion m;
    struct error e = {0};
    (void)state;
    fly(&m, "{}", 100, "kdk", 1);
    rig_real(&m.rig, 0, "x", 1)[3] = NAN;
    assert_int_not_equal(run_passes(&m.run, MOMENT_EVALUATE, &e), 0);
    assert_non_null(strstr(e.text, "dust"));
    assert_int_equal(e.exit_code, EXIT_RUN);
    end(&m);
}

/* -- Iteration ----------------------------------------------------------------------------------- */

static void test_unfinished_only(void **state)
{
    struct motion m;
    (void)state;
    rig_open(
        &m.rig, &motion_items,
        "{'dimensions':1,'domain':{'min':[0],'max':[1]},'particles':{'dust':{'fill':{'lattice':'square',"
        "'count':43},'fields':{'rho':1,'need':1}}},'scheme':{'name':'coast','edit':["
        "{'insert':'count-up'}]},'time':{'end':1}}");
    double *need = rig_real(&m.rig, 0, "need", 0), *done = rig_real(&m.rig, 0, "done", 0);
    need[9] = 2;
    need[12] = 4;
    need[24] = 99; /* six sweeps are the most */
    need[42] = 3;  /* in the last group, which is short */
    begin(&m, 1);
    passes(&m, MOMENT_EVALUATE);
    for (size_t i = 0; i < 43; i++) {
        static const double group[] = {1, 4, 1, 6, 1, 3};
        if (done[i] != group[i / 8])
            fail_msg("particle %zu: %g sweeps", i, done[i]);
    }
    assert_int_equal(m.run.cost.unfinished, 1);
    assert_int_equal(m.rig.plan.pass[1].sweeps, 6);
    end(&m);
}

/* h grows fivefold within one iteration: lists and ghosts follow. */
static void test_growth(void **state)
{
    static const size_t itself[] = {0};
    struct motion m;
    (void)state;
    rig_open(
        &m.rig, &motion_items,
        "{'dimensions':2,'domain':{'min':[0,0],'max':[1,1],'sides':{'x':'periodic','y':'mirror'}},"
        "'particles':{'dust':{'fill':{'lattice':'square','count':400,'jitter':0.3},'h_over_dx':0.3,"
        "'fields':{'rho':1,'colour':'x','v':['y','-x']}}},'scheme':{'name':'coast','edit':["
        "{'insert':'widen','before':'shade','enough':25},{'insert':'gather'}]},'time':{'end':1}}");
    begin(&m, 1);
    passes(&m, MOMENT_EVALUATE);
    assert_true(m.run.cost.list_builds > 2);
    assert_true(motion_error(&m.run, false, 0, itself, 1) < 1e-13);
    const struct particles *p = &m.rig.plan.array[0].p;
    const double *found = rig_real(&m.rig, 0, "found", 0), *h = rig_real(&m.rig, 0, "h", 0);
    const int32_t *again = p->column[particles_find(p, "again")].data;
    for (size_t i = 0; i < p->n; i++) {
        assert_int_equal(again[i], 0);
        assert_true(found[i] >= 25 && found[i] < 80);
        assert_true(h[i] > 0.04 && h[i] < 0.12);
    }
    end(&m);
}

/* -- Reductions ---------------------------------------------------------------------------------- */

static void test_reductions(void **state)
{
    struct motion m;
    (void)state;
    rig_open(&m.rig, &motion_items,
             "{'dimensions':1,'domain':{'min':[0],'max':[2]},'particles':{"
             "'one':{'fill':{'lattice':'square','count':5,'in':{'box':{'min':[0],'max':[1]}}},"
             "'fields':{'rho':1,'value':'x'}},"
             "'two':{'fill':{'lattice':'square','count':5,'in':{'box':{'min':[1],'max':[2]}}},"
             "'fields':{'rho':1,'value':'-x'}}},"
             "'scheme':{'name':'coast','edit':[{'insert':'measure'}]},'time':{'end':1}}");
    begin(&m, 1);
    passes(&m, MOMENT_EVALUATE);
    /* least, most, total, bound of one; then of two */
    static const double expected[] = {0.1, 0.9, 2.5, 0.1, -1.9, -1.1, -7.5, -1.9};
    assert_int_equal(m.rig.plan.n_reduction, COUNT(expected));
    for (size_t i = 0; i < COUNT(expected); i++)
        assert_true(fabs(m.run.reduced[i] - expected[i]) < 1e-14);
    assert_true(fabs(m.run.dt_bound + 1.9) < 1e-14);
    /* A NaN comes through, wherever it stands: no other particle, no other array hides it. */
    for (size_t a = 0; a < 2; a++)
        for (size_t i = 0; i < 5; i++) {
            double *value = rig_real(&m.rig, a, "value", 0), kept = value[i];
            value[i] = NAN;
            passes(&m, MOMENT_EVALUATE);
            for (size_t k = 0; k < 4; k++) {
                assert_true(isnan(m.run.reduced[4 * a + k]));
                assert_true(m.run.reduced[4 * (1 - a) + k] == m.run.reduced[4 * (1 - a) + k]);
            }
            assert_true(isnan(m.run.dt_bound));
            value[i] = kept;
        }
    passes(&m, MOMENT_EVALUATE);
    assert_true(fabs(m.run.dt_bound + 1.9) < 1e-14);
    end(&m);
}

/* -- Threads ------------------------------------------------------------------------------------- */

static void test_threads(void **state)
{
    static const int threads[] = {2, 3, 5};
    struct motion one;
    (void)state;
    fly(&one, PERIODIC, 1600, "kdk", 1);
    steps(&one, 0.002, 40);
    assert_true(one.run.cost.sorts > 1);
    for (size_t k = 0; k < COUNT(threads); k++) {
        struct motion many;
        fly(&many, PERIODIC, 1600, "kdk", threads[k]);
        steps(&many, 0.002, 40);
        const struct particles *p = &one.rig.plan.array[0].p, *q = &many.rig.plan.array[0].p;
        assert_int_equal(p->n_column, q->n_column);
        for (size_t c = 0; c < p->n_column; c++)
            for (uint32_t part = 0; part < p->column[c].ncomp; part++) {
                const size_t size = p->column[c].size;
                const char *a = (char *)p->column[c].data + part * p->column[c].plane * size;
                const char *b = (char *)q->column[c].data + part * q->column[c].plane * size;
                if (memcmp(a, b, p->n * size) != 0)
                    fail_msg("\"%s\" is another with %d threads", p->column[c].name, threads[k]);
            }
        end(&many);
    }
    end(&one);
}

/* -- Rates add up -------------------------------------------------------------------------------- */

static void pulled(const char *edits, double times_x, double constant)
{
    struct motion m;

    rig_open(
        &m.rig, &motion_items,
        "{'dimensions':2,'domain':{'min':[0,0],'max':[1,1]},'particles':{'mass':{'fill':"
        "{'lattice':'square','count':4},'fields':{'rho':1,'v':[0,0]}}},'scheme':{'name':'swing',"
        "'edit':[%s]},'time':{'end':1}}",
        edits);
    begin(&m, 2);
    for (int k = 0; k < 3; k++) /* whatever the last evaluation has left */
        passes(&m, MOMENT_EVALUATE);
    for (size_t i = 0; i < 4; i++) {
        const double x = rig_real(&m.rig, 0, "x", 0)[i];
        assert_true(rig_real(&m.rig, 0, "a", 0)[i] == times_x * x + constant);
        assert_true(rig_real(&m.rig, 0, "pulled", 0)[i] == 1);
    }
    end(&m);
}

/* Alone, beside a function that sets the rate, beside its like; what is no rate begins anew. */
static void rates_add_up(void **state)
{
    (void)state;
    pulled("{'insert':'pull','after':'spring'}", -1, 1);
    pulled("{'insert':'pull','after':'spring'},{'insert':'pull','after':'spring'}", -1, 2);
    pulled("{'insert':'pull','after':'spring'},{'delete':'spring'}", 0, 1.25);
    pulled("{'replace':'spring','with':'pull'},{'insert':'pull','after':'pull'}", 0, 2.25);
    pulled("{'insert':'pull','before':'spring'}", -1, 0); /* spring sets it anew */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rates_add_up),
        cmocka_unit_test(test_all_pairs),
        cmocka_unit_test(test_ghosts_refreshed),
        cmocka_unit_test(test_beyond_the_side),
        cmocka_unit_test(test_pairs_at_start_and_finish),
        cmocka_unit_test(test_several_sources),
        cmocka_unit_test(test_lost_particle),
        cmocka_unit_test(test_unfinished_only),
        cmocka_unit_test(test_growth),
        cmocka_unit_test(test_reductions),
        cmocka_unit_test(test_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
