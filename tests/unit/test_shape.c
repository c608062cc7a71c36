/* tests/unit/test_shape.c -- inside and bounds of every shape, and shapes that are none. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene/shape.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* The shape of {"s": text}; `d` is freed by the caller. */
static int compile(struct document *d, const char *text, int dim, struct shape **s, struct error *e)
{
    char whole[1024];
    snprintf(whole, sizeof whole, "{\"s\": %s}", text);
    memset(e, 0, sizeof *e);
    if (document_parse(d, "s.json", whole, strlen(whole), e) < 0)
        fail_msg("%s", e->text);
    return shape_compile(s, d, json_get(d->root, "s"), dim, e);
}

static bool inside(const char *text, int dim, double x, double y, double z)
{
    struct document d;
    struct shape *s;
    struct error e;
    const double at[3] = {x, y, z};
    if (compile(&d, text, dim, &s, &e) < 0)
        fail_msg("%s", e.text);
    bool result = shape_inside(s, at);
    shape_free(s);
    document_free(&d);
    return result;
}

#define BOX "{\"box\": {\"min\": [0, 0], \"max\": [1, 2]}}"
#define DISC "{\"sphere\": {\"center\": [1, 1], \"radius\": 0.5}}"
#define BELOW "{\"half-space\": {\"point\": [0, 1], \"normal\": [0, 1]}}"
#define ABOVE "{\"half-space\": {\"point\": [0, 1], \"normal\": [0, -1]}}"
#define ROD                                                                                        \
    "{\"cylinder\": {\"center\": [0, 0, 1], \"axis\": [0, 0, 2], \"radius\": 0.5, \"length\": 2}}"

static void test_inside(void **state)
{
    (void)state;
    assert_true(inside(BOX, 2, .5, 1.5, 0));
    assert_true(inside(BOX, 2, 0, 0, 0)); /* lower faces belong to it */
    assert_false(inside(BOX, 2, 1, .5, 0));
    assert_false(inside(BOX, 2, .5, 2, 0));
    assert_true(inside(DISC, 2, 1.3, 1.3, 0));
    assert_false(inside(DISC, 2, 1.4, 1.4, 0));
    assert_true(inside(BELOW, 2, 9, .5, 0));
    assert_false(inside(BELOW, 2, 9, 1, 0)); /* an upper face */
    assert_true(inside(ABOVE, 2, 9, 1, 0));  /* the same as a lower one */
    assert_true(inside(ROD, 3, .4, 0, 0));
    assert_false(inside(ROD, 3, .4, 0, 2));
    assert_false(inside(ROD, 3, .4, .4, 1));
    assert_true(inside("{\"sphere\": {\"center\": [1], \"radius\": 1}}", 1, 0, 0, 0));
    assert_false(inside("{\"sphere\": {\"center\": [1], \"radius\": 1}}", 1, 2, 0, 0));
    assert_true(inside("{\"union\": [" BOX ", " DISC "]}", 2, 1.2, 1, 0));
    assert_false(inside("{\"intersection\": [" BOX ", " DISC "]}", 2, 1.2, 1, 0));
    assert_true(inside("{\"intersection\": [" BOX ", " DISC "]}", 2, .8, 1, 0));
    assert_false(inside("{\"difference\": [" BOX ", " DISC "]}", 2, .8, 1, 0));
    assert_true(inside("{\"difference\": [" BOX ", " DISC ", " BELOW "]}", 2, .1, 1.9, 0));
}

/* Boxes side by side and half-spaces back to back share no point, and leave none out. */
static void test_faces(void **state)
{
    (void)state;
    for (int i = 0; i <= 20; i++) {
        double y = .1 * i;
        assert_int_equal(inside(BELOW, 2, 0, y, 0) + inside(ABOVE, 2, 0, y, 0), 1);
    }
}

static void test_bounds(void **state)
{
    struct document d;
    struct shape *s;
    struct error e;
    double min[3], max[3];
    (void)state;
    assert_int_equal(compile(&d, "{\"union\": [" BOX ", " DISC "]}", 2, &s, &e), 0);
    assert_true(shape_bounds(s, min, max));
    assert_true(min[0] == 0 && max[0] == 1.5 && min[1] == 0 && max[1] == 2 && max[2] == 0);
    assert_false(shape_is_box(s));
    shape_free(s);
    document_free(&d);
    assert_int_equal(compile(&d, BELOW, 2, &s, &e), 0);
    assert_false(shape_bounds(s, min, max));
    assert_true(max[1] == 1 && isinf(min[1]) && isinf(max[0]));
    shape_free(s);
    document_free(&d);
    assert_int_equal(compile(&d, "{\"intersection\": [" BOX ", " BELOW "]}", 2, &s, &e), 0);
    assert_true(shape_bounds(s, min, max));
    assert_true(max[1] == 1 && max[0] == 1);
    shape_free(s);
    document_free(&d);
    assert_int_equal(compile(&d, ROD, 3, &s, &e), 0);
    assert_true(shape_bounds(s, min, max));
    assert_true(min[2] == 0 && max[2] == 2 && min[0] == -.5 && max[1] == .5);
    shape_free(s);
    document_free(&d);
}

static void test_refused(void **state)
{
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"1", "/s: 1 is not a shape"},
        {"{}", "a shape has one key, not 0"},
        {"{\"box\": {}, \"sphere\": {}}", "one key, not 2"},
        {"{\"bax\": {}}", "did you mean \"box\"?"},
        {"{\"box\": {\"min\": [0, 0]}}", "/s/box: the key \"max\" is missing"},
        {"{\"box\": {\"min\": [0, 0], \"max\": [1]}}", "1 number in 2 dimensions"},
        {"{\"box\": {\"min\": [0, 3], \"max\": [1, 2]}}", "along y, min 3 is not below max 2"},
        {"{\"sphere\": {\"center\": [0, 0], \"radius\": 0}}", "0 is not a radius"},
        {"{\"half-space\": {\"point\": [0, 0], \"normal\": [0, 0]}}", "no direction"},
        {ROD, "a cylinder needs 3 dimensions"},
        {"{\"union\": []}", "at least one shape"},
        {"{\"union\": {}}", "at least one shape"},
        {"{\"difference\": [" BOX ", {\"sphere\": {\"center\": [0, 0], \"radius\": \"a\"}}]}",
         "/s/difference/1/sphere/radius: \"a\" is not a number"},
        {"{\"sphere\": {\"centre\": [0, 0], \"radius\": 1}}", "did you mean \"center\"?"},
    };
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct document d;
        struct shape *s;
        struct error e;
        if (compile(&d, cases[i].text, 2, &s, &e) == 0)
            fail_msg("taken: %s", cases[i].text);
        assert_null(s);
        if (!strstr(e.text, cases[i].part))
            fail_msg("\"%s\" does not hold \"%s\"", e.text, cases[i].part);
        document_free(&d);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_inside),
        cmocka_unit_test(test_faces),
        cmocka_unit_test(test_bounds),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
