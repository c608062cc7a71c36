/* tests/unit/test_scene.c -- a whole scene compiled, and what is refused where. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const char whole[] =
    "{\"title\": \"T\", \"dimensions\": 2, \"plugins\": [\"a\", \"b\"], \"units\": \"SI\",\n"
    "\"domain\": {\"min\": [-1, 0], \"max\": [1, 2], \"sides\": {\"x\": \"periodic\", \"y\": "
    "[\"mirror\", \"open\"]}},\n"
    "\"materials\": {\"gas\": {\"eos\": {\"name\": \"some\", \"//\": \"why\", \"gamma\": 1.4}}, "
    "\"dust\": {}, \"water\": {\"eos\": \"stiff\"}},\n"
    "\"particles\": {\"fluid\": {\"material\": \"gas\", \"h_over_dx\": 1.5, \"fill\": [\n"
    "  {\"lattice\": \"square\", \"in\": {\"box\": {\"min\": [-1, 0], \"max\": [0, 2]}}, "
    "\"spacing\": 0.1, \"jitter\": 0.2, \"seed\": 7, \"fields\": {\"u\": 2}},\n"
    "  {\"glass\": {\"sweeps\": 5}, \"in\": {\"box\": {\"min\": [0, 0], \"max\": [1, 2]}}, "
    "\"count\": 100}],\n"
    "  \"fields\": {\"rho\": 1, \"u\": \"1 + x\", \"v\": [\"-x/r\", 0]},\n"
    "  \"columns\": {\"label\": {\"type\": \"int32\", \"value\": \"x > 0\"}, \"tracer\": 1.5, "
    "\"drift\": [0, 1]}},\n"
    " \"wall\": {\"fill\": {\"file\": \"w.csv\", \"rename\": {\"X\": \"x\"}, \"spacing\": 0.1}}},\n"
    "\"boundaries\": [{\"name\": \"b\", \"on\": \"wall\"}],\n"
    "\"scheme\": {\"name\": \"s\", \"alpha\": 1, \"edit\": [\n"
    "  {\"insert\": \"f\", \"before\": \"g\", \"alpha\": 2}, {\"delete\": \"d\"}, {\"replace\": "
    "\"r\", \"with\": \"w\"},\n"
    "  {\"operation\": \"summation\", \"function\": \"f\", \"of\": \"rho\", \"to\": [\"fluid\"], "
    "\"from\": \"wall\", \"at\": \"finish\"},\n"
    "  {\"operation\": \"assignment\", \"of\": \"label\", \"expression\": \"x > 0\", \"after\": "
    "\"g\"}]},\n"
    "\"kernel\": {\"name\": \"k\"}, \"limits\": {\"particles\": 1000},\n"
    "\"time\": {\"integrator\": \"kdk\", \"begin\": 1, \"end\": 2, \"cfl\": 0.3, \"dt_max\": 0.1, "
    "\"steps\": 9},\n"
    "\"neighbours\": {\"skin\": 0.2},\n"
    "\"compare\": [{\"array\": \"fluid\", \"exact\": \"e\", \"where\": \"r < 1\", \"fields\": "
    "[\"rho\"], \"gamma\": 1.4}],\n"
    "\"probes\": [{\"name\": \"a\", \"array\": \"fluid\", \"mean\": \"rho\", \"expected\": 16},\n"
    "  {\"name\": \"b\", \"array\": \"fluid\", \"crossing\": {\"of\": \"rho\", \"shell\": 0.02, "
    "\"level\": 10}}],\n"
    "\"output\": {\"every\": 0.1, \"log\": {\"steps\": 10}, \"picture\": {\"field\": \"rho\", "
    "\"min\": 0, \"max\": 17, \"map\": \"magma\"}}}";

static void open_whole(struct document *d, struct scene *s)
{
    struct error e = {0};
    if (document_parse(d, "s.json", whole, sizeof whole - 1, &e) < 0 || scene_compile(s, d, &e) < 0)
        fail_msg("%s", e.text);
}

static void test_head(void **state)
{
    struct document d;
    struct scene s;
    (void)state;
    open_whole(&d, &s);
    assert_string_equal(s.title, "T");
    assert_int_equal(s.dim, 2);
    assert_int_equal(s.n_plugin, 2);
    assert_string_equal(s.plugin[1], "b");
    assert_string_equal(s.units, "SI");
    assert_int_equal(s.limit, 1000);
    assert_true(s.box.bounded && s.box.min[0] == -1 && s.box.max[1] == 2);
    assert_int_equal(s.box.side[0][0], SIDE_PERIODIC);
    assert_int_equal(s.box.side[0][1], SIDE_PERIODIC);
    assert_int_equal(s.box.side[1][0], SIDE_MIRROR);
    assert_int_equal(s.box.side[1][1], SIDE_OPEN);
    assert_int_equal(s.n_material, 3);
    assert_string_equal(s.material[0].eos, "some");
    assert_int_equal(cJSON_GetArraySize(s.material[0].eos_params), 1);
    assert_null(s.material[1].eos);
    assert_string_equal(s.material[2].eos, "stiff");
    assert_string_equal(s.kernel.name, "k");
    assert_string_equal(s.time.integrator, "kdk");
    assert_true(s.time.begin == 1 && s.time.end == 2 && s.time.cfl == .3 && isnan(s.time.dt));
    assert_true(s.time.dt_max == .1 && s.time.steps == 9 && s.neighbours.skin == .2);
    assert_true(s.output.every == .1 && s.output.log_steps == 10 && isinf(s.output.log_every));
    assert_true(s.output.picture.wanted && s.output.picture.range && s.output.picture.max == 17);
    assert_string_equal(s.output.picture.map, "magma");
    assert_int_equal(s.n_boundary, 1);
    scene_free(&s);
    document_free(&d);
}

static void test_particles(void **state)
{
    struct document d;
    struct scene s;
    (void)state;
    open_whole(&d, &s);
    assert_int_equal(s.n_array, 2);
    const struct scene_array *a = &s.array[0];
    assert_string_equal(a->name, "fluid");
    assert_int_equal(a->material, 0);
    assert_true(a->h_factor == 1.5);
    assert_int_equal(a->n_fill, 2);
    assert_int_equal(a->fill[0].kind, FILL_LATTICE);
    assert_true(a->fill[0].spacing == .1 && a->fill[0].jitter == .2 && a->fill[0].seed == 7);
    assert_int_equal(a->fill[1].kind, FILL_GLASS);
    assert_int_equal(a->fill[1].count, 100);
    assert_int_equal(a->fill[1].sweeps, 5);
    assert_int_equal(a->n_field, 3);
    assert_int_equal(a->n_fill_field[0], 1);
    assert_int_equal(a->n_fill_field[1], 0);
    assert_int_equal(a->n_column, 3);
    assert_int_equal(a->column[0].type, SPH_INT32);
    assert_int_equal(a->column[1].type, SPH_SCALAR);
    assert_int_equal(a->column[2].type, SPH_VECTOR);
    assert_int_equal(s.array[1].material, SIZE_MAX);
    assert_int_equal(s.array[1].fill[0].kind, FILL_FILE);
    assert_string_equal(s.array[1].fill[0].file, "w.csv");
    scene_free(&s);
    document_free(&d);
}

static void test_recipe(void **state)
{
    struct document d;
    struct scene s;
    (void)state;
    open_whole(&d, &s);
    assert_string_equal(s.scheme.name, "s");
    assert_int_equal(cJSON_GetArraySize(s.scheme.params), 1);
    assert_int_equal(s.scheme.n_edit, 5);
    const struct scene_edit *x = s.scheme.edit;
    assert_int_equal(x[0].kind, EDIT_INSERT_BEFORE);
    assert_string_equal(x[0].function, "f");
    assert_string_equal(x[0].anchor, "g");
    assert_string_equal(x[0].at, "evaluate");
    assert_int_equal(cJSON_GetArraySize(x[0].params), 1);
    assert_int_equal(x[1].kind, EDIT_DELETE);
    assert_string_equal(x[1].anchor, "d");
    assert_int_equal(x[2].kind, EDIT_REPLACE);
    assert_string_equal(x[2].anchor, "r");
    assert_string_equal(x[2].function, "w");
    assert_int_equal(x[3].kind, EDIT_APPEND);
    assert_string_equal(x[3].operation, "summation");
    assert_string_equal(x[3].of, "rho");
    assert_string_equal(x[3].at, "finish");
    assert_int_equal(x[3].n_to, 1);
    assert_string_equal(x[3].from[0], "wall");
    assert_int_equal(x[4].kind, EDIT_INSERT_AFTER);
    assert_string_equal(x[4].expression, "x > 0");
    assert_null(x[4].function);
    assert_int_equal(s.n_compare, 1);
    assert_int_equal(cJSON_GetArraySize(s.compare[0].params), 1);
    assert_string_equal(s.compare[0].where, "r < 1");
    assert_int_equal(s.n_probe, 2);
    assert_int_equal(s.probe[0].kind, PROBE_MEAN);
    assert_true(s.probe[0].expected == 16 && isnan(s.probe[1].expected));
    assert_int_equal(s.probe[1].kind, PROBE_CROSSING);
    assert_true(s.probe[1].shell == .02 && s.probe[1].level == 10);
    scene_free(&s);
    document_free(&d);
}

/* The whole scene with one --set: what it says. */
static const struct {
    const char *set, *part;
} wrong[] = {
    {"titel=T", "/titel: unknown key \"titel\" (did you mean \"title\"?)"},
    {"dimensions=4", "4 is too large"},
    {"dimensions=2.5", "not a whole number"},
    {"dimensions=3", "2 numbers in 3 dimensions"},
    {"units=si", "known are: none, SI, cgs"},
    {"plugins=[1]", "/plugins/0: 1 is not a name"},
    {"domain.min=[1, 0]", "the domain is empty: along x"},
    {"domain.sides.x=perodic", "did you mean \"periodic\"?"},
    {"domain.sides.y=[\"periodic\", \"open\"]", "is periodic and its opposite is not"},
    {"domain.sides.y=[\"open\"]", "1 sides; give two"},
    {"domain.sides.z=open", "unknown key \"z\""},
    {"materials.gas.eso=1", "unknown key \"eso\""},
    {"materials.gas.eos=7", "7 is not an equation of state"},
    {"materials.g$s={}", "is not a name"},
    {"particles={}", "the scene is empty"},
    {"particles.fluid={}", "the key \"fill\" is missing"},
    {"particles.fluid.material=gs", "unknown material \"gs\" (did you mean \"gas\"?)"},
    {"particles.fluid.fill=[]", "no fill"},
    {"particles.fluid.fill={\"spacing\": 1}", "one of \"lattice\", \"glass\" and \"file\""},
    {"particles.fluid.fill.0.spacing=-0.1", "-0.1 is not a spacing; give a positive number"},
    {"particles.fluid.fill.0.spacing=0", "0 is not a spacing"},
    {"particles.fluid.fill.0.spacing=nan", "\"nan\" is not a number"},
    {"particles.fluid.fill.0.count=5", "given twice"},
    {"particles.fluid.fill.0.lattice=sqare", "did you mean \"square\"?"},
    {"particles.fluid.fill.0.lattice=fcc", "needs 3 dimensions"},
    {"particles.fluid.fill.0.jitter=2", "2 is not a jitter"},
    {"particles.fluid.fill.1.jitter=0.1", "unknown key \"jitter\""},
    {"particles.fluid.fill.1.glass.sweeps=0", "0 is too small"},
    {"particles.fluid.fields.u=1 +", "ends too early"},
    {"particles.fluid.fields.u=q", "unknown name \"q\""},
    {"particles.fluid.fields.u=true", "neither a number nor an expression"},
    {"particles.fluid.fields.v=[1, 2, 3]", "3 components of a vector in 2 dimensions"},
    {"particles.fluid.fields.x=[1, 2]", "given by \"fill\""},
    {"particles.fluid.columns.label.type=int", "unknown type \"int\""},
    {"particles.fluid.columns.drift=[0]", "1 component; give 2"},
    {"particles.fluid.columns.m=1", "has the column \"m\" already"},
    {"particles.fluid.h_over_dx=0", "0 is not a ratio"},
    {"boundaries={}", "array of boundary conditions"},
    {"boundaries.0={}", "the key \"name\" is missing"},
    {"scheme=7", "7 is not a scheme"},
    {"scheme.name=7", "7 is not text"},
    {"scheme.edit={}", "array of edits"},
    {"scheme.edit.0={\"insert\": \"a\", \"delete\": \"b\"}", "an edit has one of"},
    {"scheme.edit.0.with=w", "\"with\" does not go with \"insert\""},
    {"scheme.edit.3.operation=sum", "unknown operation \"sum\""},
    {"scheme.edit.3.to=fluids", "unknown array \"fluids\" (did you mean \"fluid\"?)"},
    {"scheme.edit.3.at=end", "unknown moment \"end\""},
    {"scheme.edit.4.of=1", "1 is not text"},
    {"kernel.nam=k", "unknown key \"nam\""},
    {"limits.particles=0", "0 is too small"},
    {"time.end=0.5", "the end 0.5 is not after the begin 1"},
    {"time.cfl=0", "0 is not a time-step number"},
    {"time.steps=-1", "-1 is too small"},
    {"neighbours.skin=-1", "-1 is not a skin"},
    {"compare.0.array=fluit", "unknown array \"fluit\""},
    {"compare.0.where=r <", "ends too early"},
    {"compare.0.where=spacing > 1", "unknown name \"spacing\""},
    {"probes.0.min=rho", "a probe has one of"},
    {"probes.1.crossing.shell=0", "0 is not a width"},
    {"probes.1.name=a", "an earlier probe has this name"},
    {"output.every=0", "0 is not a time interval"},
    {"output.log.every=1", "not both"},
    {"output.checkpoint.keep=10", "give \"steps\" or \"every\""},
    {"output.checkpoint={\"steps\": 1, \"every\": 1}", "not both"},
    {"output.picture.map=blue", "unknown colour map \"blue\""},
    {"output.picture.min=20", "min 20 is not below max 17"},
    {"time=null", "null is not an object"},
};

static void test_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(wrong); i++) {
        struct document d;
        struct scene s;
        struct error e = {0};
        assert_int_equal(document_parse(&d, "s.json", whole, sizeof whole - 1, &e), 0);
        assert_int_equal(document_set(&d, wrong[i].set, &e), 0);
        if (scene_compile(&s, &d, &e) == 0)
            fail_msg("taken: %s", wrong[i].set);
        assert_int_equal(e.exit_code, EXIT_USAGE);
        if (!strstr(e.text, wrong[i].part))
            fail_msg("\"%s\" does not hold \"%s\"", e.text, wrong[i].part);
        if (strncmp(e.text, "--set ", 6) != 0 && strncmp(e.text, "s.json:", 7) != 0)
            fail_msg("\"%s\" does not name its place", e.text);
        document_free(&d);
    }
}

/* Every key that must be there. */
static void test_missing(void **state)
{
    static const char *const texts[] = {
        "{}",
        "{\"title\": \"a\"}",
        "{\"dimensions\": 1}",
        "{\"dimensions\": 1, \"particles\": {\"a\": {\"fill\": {\"lattice\": \"square\", \"count\": "
        "1}}}}",
        "{\"dimensions\": 1, \"domain\": {\"min\": [0], \"max\": [1]}, \"particles\": {\"a\": "
        "{\"fill\": {\"lattice\": \"square\", \"count\": 1}}}}",
        "{\"dimensions\": 1, \"domain\": {\"min\": [0], \"max\": [1]}, \"particles\": {\"a\": "
        "{\"fill\": {\"lattice\": \"square\", \"count\": 1}}}, \"scheme\": \"s\"}",
        "{\"dimensions\": 1, \"domain\": {\"min\": [0], \"max\": [1]}, \"particles\": {\"a\": "
        "{\"fill\": {\"lattice\": \"square\", \"count\": 1}}}, \"scheme\": \"s\", \"time\": {}}",
    };
    static const char *const parts[] = {"the scene is empty",       "\"dimensions\" is missing",
                                        "\"particles\" is missing", "the key \"in\" is missing",
                                        "\"scheme\" is missing",    "\"time\" is missing",
                                        "\"end\" is missing"};
    (void)state;
    for (size_t i = 0; i < COUNT(texts); i++) {
        struct document d;
        struct scene s;
        struct error e = {0};
        assert_int_equal(document_parse(&d, "s.json", texts[i], strlen(texts[i]), &e), 0);
        assert_int_equal(scene_compile(&s, &d, &e), -1);
        if (!strstr(e.text, parts[i]))
            fail_msg("\"%s\" does not hold \"%s\"", e.text, parts[i]);
        document_free(&d);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_head),    cmocka_unit_test(test_particles),
        cmocka_unit_test(test_recipe),  cmocka_unit_test(test_refused),
        cmocka_unit_test(test_missing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
