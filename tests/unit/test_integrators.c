/* test_integrators.c -- the integrators on oscillators whose solution is known: orders, decay, resumption,
 * what is left for the next step, sides. (Of whole runs: tests/accuracy/integrators.py.) */
#include "config.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "moving.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* Some of these grow on purpose, so nothing is watched for but what is not a number. */
static void swing(struct motion *m, const char *integrator, double damping)
{
    rig_open(
        &m->rig, &motion_items,
        "{'dimensions':2,'domain':{'min':[0,0],'max':[1,1]},'particles':{'mass':{'fill':"
        "{'lattice':'square','count':4},'fields':{'rho':1,'v':['y',0]}}},'scheme':{'name':'swing',"
        "'damping':%g},'time':{'end':1,'integrator':'%s'},'watch':false}",
        damping, integrator);
    begin(m, 1);
    passes(m, MOMENT_EVALUATE);
}

/* Largest error of x and v at t = 2 in n steps; x'' = -x - c x', x(0) = x0, x'(0) = v0. */
static double swing_error(const char *integrator, double c, int n)
{
    struct motion m;
    double x0[2][4], v0[2][4], worst = 0;
    swing(&m, integrator, c);
    for (uint32_t k = 0; k < 2; k++) {
        memcpy(x0[k], rig_real(&m.rig, 0, "x", k), sizeof x0[k]);
        memcpy(v0[k], rig_real(&m.rig, 0, "v", k), sizeof v0[k]);
    }
    steps(&m, 2.0 / n, n);
    assert_true(fabs(m.run.time - 2) < 1e-12);
    const double t = 2, w = sqrt(1 - c * c / 4), fade = exp(-c * t / 2);
    for (uint32_t k = 0; k < 2; k++)
        for (size_t i = 0; i < 4; i++) {
            const double b = (v0[k][i] + c / 2 * x0[k][i]) / w;
            const double x = fade * (x0[k][i] * cos(w * t) + b * sin(w * t));
            const double v = -c / 2 * x + fade * w * (b * cos(w * t) - x0[k][i] * sin(w * t));
            worst = fmax(worst, fabs(rig_real(&m.rig, 0, "x", k)[i] - x));
            worst = fmax(worst, fabs(rig_real(&m.rig, 0, "v", k)[i] - v));
        }
    end(&m);
    return worst;
}

/* Those of "verlet2" show only over many of its cycles: tests/accuracy/integrators.py. */
static void test_orders(void **state)
{
    static const double damping[] = {0, 0.5};
    size_t count;
    const char *const *name = integrator_names(&count);
    (void)state;
    for (size_t k = 0; k < count; k++)
        for (size_t c = 0; c < COUNT(damping) && strcmp(name[k], "verlet2") != 0; c++)
            for (int n = 40; n <= 160; n *= 2) {
                const double ratio =
                    swing_error(name[k], damping[c], n) / swing_error(name[k], damping[c], 2 * n);
                const double expected = pow(2, integrator_find(name[k])->order);
                if (!(ratio > 0.9 * expected && ratio < 1.15 * expected))
                    fail_msg("%s, damping %g, %d steps: the error falls by %g", name[k], damping[c],
                             n, ratio);
            }
}

/* Of the velocity, after steps of `reach` over the damping's rate. */
static double decayed(const char *integrator, double reach)
{
    const double damping = 100;
    struct motion m;
    double most = 0;
    swing(&m, integrator, damping);
    steps(&m, reach / damping, 1200);
    for (size_t i = 0; i < 4; i++)
        most = fmax(most, fabs(rig_real(&m.rig, 0, "v", 0)[i]));
    end(&m);
    return most;
}

/* How fast a decay each follows: the figures of core/integrators/README. */
static void test_decay(void **state)
{
    static const struct {
        const char *name;
        double limit;
    } each[] = {{"kdk", 1},      {"dkd", 1},         {"pec", 1},   {"symplectic", 2},
                {"pece", 2},     {"rk2", 2},         {"euler", 2}, {"ssp-rk3", 2.5127},
                {"rk4", 2.7853}, {"verlet2", 0.1353}};
    (void)state;
    for (size_t k = 0; k < COUNT(each); k++) {
        const double below = decayed(each[k].name, 0.97 * each[k].limit);
        const double above = decayed(each[k].name, 1.03 * each[k].limit);
        if (!(below < 0.1 && above > 10))
            fail_msg("%s: 1200 steps near its limit leave %g and %g", each[k].name, below, above);
    }
}

/* All columns, the number of the step and the length of the last one are all that a run goes on from. */
static void test_resumed(void **state)
{
    size_t count;
    const char *const *name = integrator_names(&count);
    (void)state;
    for (size_t k = 0; k < count; k++) {
        struct motion whole, part;
        swing(&whole, name[k], 0.1);
        swing(&part, name[k], 0.1);
        steps(&whole, 0.02, 20);
        steps(&whole, 0.03, 10);
        struct particles *from = &whole.rig.plan.array[0].p, *to = &part.rig.plan.array[0].p;
        for (size_t c = 0; c < from->n_column; c++)
            memcpy(to->column[c].data, from->column[c].data,
                   from->column[c].ncomp * from->column[c].plane * from->column[c].size);
        part.run.step = whole.run.step;
        part.run.time = whole.run.time;
        part.run.dt_last = whole.run.dt_last;
        steps(&whole, 0.025, 20); /* the 40th is among them */
        steps(&part, 0.025, 20);
        for (uint32_t c = 0; c < 2; c++)
            for (size_t i = 0; i < from->n; i++)
                if (rig_real(&whole.rig, 0, "x", c)[i] != rig_real(&part.rig, 0, "x", c)[i] ||
                    rig_real(&whole.rig, 0, "v", c)[i] != rig_real(&part.rig, 0, "v", c)[i])
                    fail_msg("%s does not go on as it would have", name[k]);
        end(&whole);
        end(&part);
    }
}

/* What is kept of a position goes with it through a side, in the midst of a step too. */
static void test_kept_through_sides(void **state)
{
    static const char *const side[] = {"periodic", "mirror"};
    size_t count;
    const char *const *name = integrator_names(&count);
    (void)state;
    for (size_t k = 0; k < count; k++)
        for (size_t s = 0; s < COUNT(side); s++) {
            struct motion m;
            double before[8];
            rig_open(&m.rig, &motion_items,
                     "{'dimensions':1,'domain':{'min':[0],'max':[1],'sides':{'x':'%s'}},"
                     "'particles':{'dust':{'fill':{'lattice':'square','count':8},'fields':{'rho':1,"
                     "'v':['1.7 + x']}}},'scheme':{'name':'coast','edit':[{'insert':'gather'}]},"
                     "'time':{'end':1,'integrator':'%s'}}",
                     side[s], name[k]);
            begin(&m, 1);
            memcpy(before, rig_real(&m.rig, 0, "x", 0), sizeof before);
            passes(&m, MOMENT_EVALUATE);
            steps(&m, 0.02, 100);
            for (size_t i = 0; i < 8; i++) {
                const double period = s ? 2 : 1;
                const size_t id = (size_t)((int64_t *)m.rig.plan.array[0]
                                               .p.column[m.rig.plan.array[0].id]
                                               .data)[i];
                const double far = before[id] + 2 * (1.7 + before[id]);
                const double x = rig_real(&m.rig, 0, "x", 0)[i];
                /* The last step may have left it outside. */
                const double off = fmin(fabs(remainder(x - far, period)),
                                        s ? fabs(remainder(x + far, period)) : 1);
                if (!(off < 1e-12))
                    fail_msg("%s, %s side: off by %g", name[k], side[s], off);
            }
            end(&m);
        }
}

/* What a step leaves for the next to do comes to the same bits, whenever it is settled. */
static void test_deferred(void **state)
{
    static const char *const integrator[] = {"kdk", "dkd", "pec"};
    (void)state;
    for (size_t k = 0; k < COUNT(integrator); k++) {
        struct motion now, later;
        struct error e = {0};
        swing(&now, integrator[k], 0.1);
        swing(&later, integrator[k], 0.1);
        later.run.defer = true;
        for (int n = 1; n < 8; n++) {
            steps(&now, 0.01 * n, n);
            steps(&later, 0.01 * n, n);
            assert_true(later.run.left > 0);
            assert_int_equal(run_settle(&later.run, &e), 0);
            assert_int_equal(later.run.left, 0);
            for (uint32_t c = 0; c < 2; c++)
                for (size_t i = 0; i < now.rig.plan.array[0].p.n; i++) {
                    assert_true(rig_real(&now.rig, 0, "x", c)[i] ==
                                rig_real(&later.rig, 0, "x", c)[i]);
                    assert_true(rig_real(&now.rig, 0, "v", c)[i] ==
                                rig_real(&later.rig, 0, "v", c)[i]);
                }
        }
        end(&now);
        end(&later);
    }
}

/* Without damping the leapfrog runs backwards as it ran forwards. */
static void test_reversible(void **state)
{
    struct motion m;
    double before[4];
    (void)state;
    swing(&m, "kdk", 0);
    memcpy(before, rig_real(&m.rig, 0, "x", 0), sizeof before);
    steps(&m, 0.1, 50);
    assert_true(fabs(rig_real(&m.rig, 0, "x", 0)[0] - before[0]) > 0.01);
    for (uint32_t k = 0; k < 2; k++)
        for (size_t i = 0; i < 4; i++)
            rig_real(&m.rig, 0, "v", k)[i] *= -1;
    steps(&m, 0.1, 50);
    for (size_t i = 0; i < 4; i++)
        assert_true(fabs(rig_real(&m.rig, 0, "x", 0)[i] - before[i]) < 1e-13);
    end(&m);
}

static void test_drift(void **state)
{
    size_t count;
    const char *const *integrators = integrator_names(&count);
    (void)state;
    for (size_t k = 0; k < count; k++) {
        struct motion m;
        double before[8];
        rig_open(
            &m.rig, &motion_items,
            "{'dimensions':1,'domain':{'min':[0],'max':[1]},'particles':{'dust':{'fill':{'lattice':"
            "'square','count':8},'fields':{'rho':1,'v':['1 + x']}}},'scheme':'coast',"
            "'time':{'end':1,'integrator':'%s'}}",
            integrators[k]);
        begin(&m, 1);
        memcpy(before, rig_real(&m.rig, 0, "x", 0), sizeof before);
        passes(&m, MOMENT_EVALUATE);
        steps(&m, 0.01, 100);
        for (size_t i = 0; i < 8; i++)
            assert_true(fabs(rig_real(&m.rig, 0, "x", 0)[i] - (2 * before[i] + 1)) < 1e-13);
        end(&m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_orders),   cmocka_unit_test(test_decay),
        cmocka_unit_test(test_resumed),  cmocka_unit_test(test_kept_through_sides),
        cmocka_unit_test(test_deferred), cmocka_unit_test(test_reversible),
        cmocka_unit_test(test_drift),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
