/* test_opencl_kernels.c -- the passes of whole scenes as kernels against the native ones, on the same particles and
 * lists: every column that a pass writes. With vectors, and with a work item a destination, which is what other
 * devices get; in doubles and in floats. Skips itself where there is no device. */
#include "config.h"

#include "on_device.h"
#include "spread.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define WRITES (SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)
#define BAR_DOUBLE 1e-12
#define BAR_MIXED 1e-5

static size_t number;
static bool there;

/* -- Scenes -------- */

#define LINE "'dimensions':1,'domain':{'min':[0],'max':[1]"
#define SQUARE "'dimensions':2,'domain':{'min':[0,0],'max':[1,1]"
#define CUBE "'dimensions':3,'domain':{'min':[0,0,0],'max':[1,1,1]"
#define V1 "'v':['sin(7 * x)']"
#define V2 "'v':['sin(7 * x + y)','cos(5 * x - y)']"
#define V3 "'v':['sin(7 * x + y)','cos(5 * x - y)','sin(9 * z - x)']"
#define FILL(n) "'fill':{'lattice':'square','count':" #n ",'jitter':0.3}"
#define WATER                                                                                      \
    "'plugins':['kernels','eos','wcsph','barotropic','forces','diagnostics'],'materials':{'m':{'eos':{'name':'tait','rho0':1,'c0':10}}},"
#define GAS                                                                                        \
    "'plugins':['kernels','eos','gsph'],'materials':{'m':{'eos':{'name':'ideal-gas','gamma':1.4}}},"
#define SOFT                                                                                       \
    "'plugins':['kernels','eos','barotropic'],'materials':{'m':{'eos':{'name':'linear','rho0':1,'c0':10}}},"
#define OF_WATER "'rho':'1 + 0.02 * sin(5 * x)'"
#define H "'h':'1.3 * spacing'"
#define H_VARIES "'h':'1.3 * spacing * (1 + 0.2 * sin(6 * x))'"
#define OF_GAS "'rho':1,'p':'1 + 0.2 * x'"
#define FLUID(fill, fields) "'particles':{'fluid':{'material':'m'," fill ",'fields':{" fields "}}},"
#define END "'time':{'end':1}}"

struct trial_scene {
    const char *name, *scene;
    const sph_plugin *(*entry)(void);
    double
        shrink; /* what h is multiplied by before, so that an iteration has something to do; 0: nothing */
};

static const struct trial_scene scenes[] = {
    {"wcsph 1D",
     "{" LINE "}," WATER FLUID(FILL(101), OF_WATER "," H "," V1) "'scheme':{'name':'wcsph'}," END,
     0, 0},
    {"wcsph 2D, one h",
     "{" SQUARE "}," WATER FLUID(FILL(900), OF_WATER "," H "," V2) "'scheme':{'name':'wcsph'}," END,
     0, 0},
    {"wcsph 2D, periodic, h varies, viscous, gravity",
     "{" SQUARE ",'sides':{'x':'periodic','y':'mirror'}}," WATER FLUID(
         FILL(900), OF_WATER
         "," H_VARIES
         "," V2) "'kernel':'wendland-c4','scheme':{'name':'wcsph','alpha':0.3,'beta':0.7,'gy':-9.81}," END,
     0, 0},
    {"wcsph 3D",
     "{" CUBE "}," WATER FLUID(
         FILL(1331), OF_WATER "," H "," V3) "'kernel':'wendland-c6','scheme':{'name':'wcsph'}," END,
     0, 0},
    {"wcsph 2D, the nearest, a force, another momentum",
     "{" SQUARE "}," WATER FLUID(
         FILL(700), OF_WATER
         "," H
         "," V2) "'kernel':'quintic-spline','scheme':{'name':'wcsph','edit':[{'insert':'nearest'},{'insert':'body-force','gx':2},"
                 "{'insert':'barotropic-momentum'}]}," END,
     0, 0},
    {"wcsph 2D, two arrays",
     "{" SQUARE "}," WATER
     "'particles':{'left':{'material':'m','fill':{'lattice':'square','spacing':0.033,'jitter':0.3,'in':{'box':{'min':[0,0],'max':[0.5,1]}}},'fields':{" OF_WATER
     "," H "," V2 "}},"
     "'right':{'material':'m','fill':{'lattice':'square','spacing':0.029,'jitter':0.3,'in':{'box':{'min':[0.5,0],'max':[1,1]}}},'fields':{" OF_WATER
     "," H "," V2 "}}},"
     "'scheme':{'name':'wcsph'}," END,
     0, 0},
    {"barotropic 2D",
     "{" SQUARE
     "}," SOFT FLUID(FILL(900), OF_WATER
                     "," H "," V2) "'kernel':'cubic-spline','scheme':{'name':'barotropic'}," END,
     0, 0},
    {"barotropic 3D, a tabulated kernel",
     "{" CUBE "}," SOFT FLUID(
         FILL(1000), OF_WATER
         "," H "," V3) "'kernel':'gaussian','scheme':{'name':'barotropic-continuity'}," END,
     0, 0},
    {"gsph 1D, mirrors",
     "{" LINE ",'sides':{'x':'mirror'}}," GAS FLUID(FILL(203),
                                                    OF_GAS "," V1) "'scheme':{'name':'gsph'}," END,
     0, 0.97},
    {"gsph 2D, periodic",
     "{" SQUARE ",'sides':{'x':'periodic','y':'periodic'}}," GAS FLUID(
         FILL(900), OF_GAS "," V2) "'scheme':{'name':'gsph','limiter':'van-leer'}," END,
     0, 0.97},
    {"gsph 2D, exact Riemann solver",
     "{" SQUARE
     "}," GAS FLUID(FILL(700), OF_GAS "," V2) "'scheme':{'name':'gsph','riemann':'exact'}," END,
     0, 0.98},
    {"gsph 3D",
     "{" CUBE "}," GAS FLUID(FILL(1331), OF_GAS
                             "," V3) "'kernel':'quartic-spline','scheme':{'name':'gsph'}," END,
     0, 0.98},
    {"expressions",
     "{" SQUARE "}," WATER "'particles':{'fluid':{'material':'m'," FILL(
         700) ",'columns':{'twice':0,'label':{'type':'int32','value':7}},"
              "'fields':{" OF_WATER "," H_VARIES "," V2 "}}},"
              "'scheme':{'name':'wcsph','edit':["
              "{'operation':'assignment','of':'twice','expression':'max(rho, x^2, 1) * (x < 0.5 ? sin(9 * y) : "
              "-sqrt(r + t)) + !(y > 0.3)'},"
              "{'operation':'assignment','of':'label','expression':'9 * twice - 3 * (y > x & m < 1)'}]}," END,
     0, 0},
    {"all that a pass may have",
     "{" SQUARE ",'sides':{'x':'periodic'}}," WATER FLUID(
         FILL(700), OF_WATER
         "," H_VARIES
         "," V2) "'scheme':{'name':'wcsph','edit':[{'insert':'spread','kind':'more'}]}," END,
     spread_entry, 0},
};
#define N_SCENES (sizeof(scenes) / sizeof(scenes[0]))

/* -- Comparison -------- */

struct copies {
    char **column; /* [array * 256 + column] */
};

static char **copy_of(const struct on_device *o)
{
    char **all = calloc(o->plan.n_array * 256, sizeof(*all));
    assert_non_null(all);
    for (size_t a = 0; a < o->plan.n_array; a++)
        for (size_t k = 0; k < o->plan.array[a].p.n_column; k++) {
            const struct column *c = &o->plan.array[a].p.column[k];
            const size_t bytes = c->ncomp * c->plane * c->size;
            all[a * 256 + k] = malloc(bytes);
            assert_non_null(all[a * 256 + k]);
            memcpy(all[a * 256 + k], c->data, bytes);
        }
    return all;
}

static void copy_back(struct on_device *o, char **all)
{
    for (size_t a = 0; a < o->plan.n_array; a++)
        for (size_t k = 0; k < o->plan.array[a].p.n_column; k++) {
            const struct column *c = &o->plan.array[a].p.column[k];
            for (uint32_t q = 0; q < c->ncomp; q++)
                memcpy((char *)c->data + q * c->plane * c->size,
                       all[a * 256 + k] + q * c->plane * c->size, o->plan.array[a].p.n * c->size);
            run_changed(&o->run, a, (int)k);
        }
}

static void copy_free(const struct on_device *o, char **all)
{
    for (size_t k = 0; k < o->plan.n_array * 256; k++)
        free(all[k]);
    free(all);
}

static bool is_written(const struct on_device *o, size_t a, int column)
{
    for (size_t i = 0; i < o->plan.n_pass; i++)
        if (o->plan.pass[i].moment == MOMENT_EVALUATE && pass_writes(&o->plan.pass[i], a, column))
            return true;
    return false;
}

/* What an evaluation makes anew does not stand there already. */
static void spoil(struct on_device *o)
{
    for (size_t i = 0; i < o->plan.n_pass; i++) {
        const struct pass *p = &o->plan.pass[i];
        for (uint32_t k = 0; p->moment == MOMENT_EVALUATE && k < p->use.item->props.count; k++) {
            const sph_prop *prop = list_at(&p->use.item->props, k);
            const bool anew = (prop->access & WRITES) == SPH_DST_WRITE
                                  ? !(prop->access & (SPH_DST_READ | SPH_SRC_READ))
                                  : (prop->access & WRITES) != 0 && !p->continues[k];
            const struct particles *own = &o->plan.array[p->dst.array].p;
            const struct column *c = anew ? &own->column[p->dst.column[k]] : NULL;
            for (uint32_t q = 0; c && c->size == 8 && q < c->ncomp; q++)
                for (size_t n = 0; n < own->n; n++)
                    ((double *)c->data)[q * c->plane + n] = 777.0;
        }
    }
}

static double distance(const struct column *c, const char *want, size_t n)
{
    double square = 0.0, size = 0.0;

    for (uint32_t q = 0; q < c->ncomp; q++)
        for (size_t i = 0; i < n; i++) {
            const size_t at = q * c->plane + i;
            const double a = c->type == SPH_INT32 ? (double)((const int32_t *)c->data)[at]
                                                  : ((const double *)c->data)[at];
            const double b = c->type == SPH_INT32
                                 ? (double)((const int32_t *)(const void *)want)[at]
                                 : ((const double *)(const void *)want)[at];
            square += (a - b) * (a - b);
            size += b * b;
        }
    return sqrt(square / (size > 0.0 ? size : 1.0));
}

static void compare(const struct on_device *o, char **want, double bar, const char *what)
{
    for (size_t a = 0; a < o->plan.n_array; a++)
        for (int k = 0; k < (int)o->plan.array[a].p.n_column; k++) {
            const struct particles *p = &o->plan.array[a].p;
            if (!is_written(o, a, k))
                continue;
            const double off = distance(&p->column[k], want[a * 256 + (size_t)k], p->n);
            if (!(off <= bar))
                fail_msg("%s: %s.%s is off by %g", what, p->name, p->column[k].name, off);
        }
}

/* From the state after one evaluation on: another natively, and from the same there. */
static void try(const struct trial_scene *t, const struct on_device_as *as)
{
    struct on_device o;
    struct error e = {0};
    char what[256];

    snprintf(what, sizeof(what), "%s, %s, %s, %s", t->name, as->precision,
             as->vectors ? "vectors" : "single", as->fuse ? "together" : "apart");
    if (on_device_open(&o, number, as, &e))
        fail_msg("%s: %s", what, e.text);
    for (size_t a = 0; t->shrink > 0.0 && a < o.plan.n_array; a++) {
        const struct plan_array *pa = &o.plan.array[a];
        for (size_t i = 0; i < pa->p.n; i++)
            ((double *)pa->p.column[pa->smoothing].data)[i] *= t->shrink;
        run_changed(&o.run, a, pa->smoothing);
        o.run.lists_suspect = true;
    }
    spoil(&o);
    char **before = copy_of(&o);
    if (run_passes(&o.run, MOMENT_EVALUATE, &e))
        fail_msg("%s: %s", what, e.text);
    char **want = copy_of(&o);
    copy_back(&o, before);
    if (on_device_run(&o, &e))
        fail_msg("%s: %s", what, e.text);
    compare(&o, want, strcmp(as->precision, "mixed") == 0 ? BAR_MIXED : BAR_DOUBLE, what);
    copy_free(&o, before);
    copy_free(&o, want);
    on_device_close(&o);
}

static void test_scenes(void **state)
{
    (void)state;
    if (!there)
        skip();
    for (size_t k = 0; k < N_SCENES; k++)
        for (int form = 0; form < 4; form++) {
            if (form >= 2 && (size_t)form % 2 != k % 2)
                continue;
            /* With vectors as a run does it; a work item a destination, and a pass a stage. */
            const struct on_device_as as = {
                scenes[k].scene, form % 2 ? "mixed" : "double", 1, form < 2, form < 2,
                scenes[k].entry};
            try(&scenes[k], &as);
        }
}

/* -- Failures -------- */

static const char heavy[] = "{" SQUARE "}," WATER FLUID(
    FILL(100), OF_WATER "," H "," V2) "'scheme':{'name':'wcsph','edit':[{'insert':'spread'}]}," END;

static void test_fail(void **state)
{
    const struct on_device_as as = {heavy, "double", 1, true, true, spread_entry};
    struct on_device o;
    struct error e = {0};
    bool failed = true;

    (void)state;
    if (!there)
        skip();
    if (on_device_open(&o, number, &as, &e) || on_device_run(&o, &e))
        fail_msg("%s", e.text);
    assert_int_equal(kernels_failed(o.kernels, &failed, &e), 0);
    assert_false(failed);
    for (size_t i = 0; i < o.plan.n_pass; i++)
        if (strcmp(o.plan.pass[i].step, "spread") == 0)
            o.plan.pass[i].use.config.value[1] = 1e-9;
    o.run.step = 4;
    assert_int_equal(on_device_run(&o, &e), 0);
    assert_int_equal(kernels_failed(o.kernels, &failed, &e), 0);
    assert_true(failed);
    assert_int_equal(e.exit_code, EXIT_RUN);
    assert_string_equal(e.text, "spread(fluid) at step 4, t = 0: a particle is too heavy");
    assert_int_equal(kernels_failed(o.kernels, &failed, &e), 0);
    assert_false(failed);
    on_device_close(&o);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scenes),
        cmocka_unit_test(test_fail),
    };
    struct error e = {0};

    there = on_device_there(&number, &e);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
