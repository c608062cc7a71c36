/* tests/unit/test_json.c -- documents: what is refused and where, --set, typed access,
 * references. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene/json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static int parse(struct document *d, const char *text, struct error *e)
{
    memset(e, 0, sizeof *e);
    return document_parse(d, "s.json", text, strlen(text), e);
}

static void assert_starts(const char *text, const char *start)
{
    if (strncmp(text, start, strlen(start)) != 0)
        fail_msg("\"%s\" does not start with \"%s\"", text, start);
}

static void assert_holds(const char *text, const char *part)
{
    if (!strstr(text, part))
        fail_msg("\"%s\" does not hold \"%s\"", text, part);
}

static const struct {
    const char *text, *start, *part;
} wrong[] = {
    {"", "s.json:1:1: ", "empty"},
    {" \n ", "s.json:2:2: ", "empty"},
    {"[1]", "s.json:1:1: ", "object"},
    {"{\"a\": 1,}", "s.json:1:9: ", "comma"},
    {"{\"a\": [1,]}", "s.json:1:10: ", "missing before \"]\""},
    {"{\"a\" 1}", "s.json:1:6: ", "\":\" is missing"},
    {"{\"a\": 1 \"b\": 2}", "s.json:1:9: ", "\",\" or \"}\""},
    {"{\"a\": [1 2]}", "s.json:1:10: ", "\",\" or \"]\""},
    {"{a: 1}", "s.json:1:2: ", "double quotes"},
    {"{'a': 1}", "s.json:1:2: ", "double quotes"},
    {"{\"a\": 'b'}", "s.json:1:7: ", "double quotes"},
    {"{\n  \"a\": {\n", "s.json:3:1: ", "object that begins in line 2, column 8"},
    {"{\"a\": [1, 2", "s.json:1:12: ", "array that begins in line 1, column 7"},
    {"{\"a\": \"b", "s.json:1:9: ", "string that begins in line 1, column 7"},
    {"{\"a\": \"b\n\"}", "s.json:1:7: ", "not closed in its line"},
    {"{\"a\":", "s.json:1:6: ", "object that begins"},
    {"{\"a\"", "s.json:1:5: ", "object that begins"},
    {"{\"a\": NaN}", "s.json:1:7: ", "NaN is not a number"},
    {"{\"a\": -Infinity}", "s.json:1:8: ", "Infinity is not a number"},
    {"{\"a\": 1e999}", "s.json:1:7: ", "too large"},
    {"{\"a\": 01}", "s.json:1:7: ", "0 and another digit"},
    {"{\"a\": 1.}", "s.json:1:7: ", "decimal point"},
    {"{\"a\": .5}", "s.json:1:7: ", "unexpected \".\""},
    {"{\"a\": +5}", "s.json:1:7: ", "unexpected \"+\""},
    {"{\"a\": 1e}", "s.json:1:7: ", "exponent"},
    {"{\"a\": -}", "s.json:1:7: ", "begins with a digit"},
    {"{\"a\": True}", "s.json:1:7: ", "did you mean \"true\"?"},
    {"{\"a\": gsph}", "s.json:1:7: ", "double quotes"},
    {"{\"a\": 1} x", "s.json:1:10: ", "behind the end"},
    {"{\"a\": 1 // b\n}", "s.json:1:9: ", "is missing here"},
    {"{// b\n}", "s.json:1:2: ", "no comments"},
    {"{\"a\": \"\\q\"}", "s.json:1:8: ", "unknown escape"},
    {"{\"a\": \"\\u12\"}", "s.json:1:8: ", "four hexadecimal digits"},
    {"{\"a\": \"\\u0000\"}", "s.json:1:8: ", "\\u0000"},
    {"{\"a\": \"\\ud800\"}", "s.json:1:8: ", "surrogate"},
    {"{\"a\": \"\\udc00\"}", "s.json:1:8: ", "surrogate"},
    {"{\"a\": \"\001\"}", "s.json:1:8: ", "control character 0x01"},
    {"{\"\xc3\xa9\": \xff}", "s.json:1:7: ", "0xff is not UTF-8"},
    {"{\"a\": 1,\n \"b\": {\"c\": 1, \"d\": 2, \"c\": 3}}",
     "s.json:2:24: /b/c: ", "already, in line 2, column 8"},
    {"{\"a\": 1, \"\\u0061\": 2}", "s.json:1:10: /a: ", "already"},
    {"{\"a\": "
     "1000000000000000000000000000000000000000000000000000000000000000000000000000000000000}",
     "s.json:1:7: ", "at most 63"},
};

static void test_syntax(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(wrong); i++) {
        struct document d;
        struct error e;
        if (parse(&d, wrong[i].text, &e) == 0)
            fail_msg("taken: %s", wrong[i].text);
        assert_int_equal(e.exit_code, EXIT_USAGE);
        assert_starts(e.text, wrong[i].start);
        assert_holds(e.text, wrong[i].part);
        assert_null(strchr(e.text, '\n'));
    }
}

static void test_depth(void **state)
{
    char text[300] = "{\"a\":";
    struct document d;
    struct error e;
    (void)state;
    for (int depth = 62; depth <= 64; depth++) { /* and the object around them */
        char *at = text + 5;
        memset(at, '[', (size_t)depth);
        memset(at + depth, ']', (size_t)depth);
        strcpy(at + 2 * depth, "}");
        int status = parse(&d, text, &e);
        assert_int_equal(status, depth < DOCUMENT_DEPTH ? 0 : -1);
        if (!status)
            document_free(&d);
        else
            assert_holds(e.text, "nested deeper than 64");
    }
    size_t n = 1 << 20;
    char *deep = malloc(n + 1);
    memset(deep, '[', n);
    deep[n] = '\0';
    assert_int_equal(document_parse(&d, "s.json", deep, n, &e), -1);
    free(deep);
}

static void test_places(void **state)
{
    struct document d;
    struct error e;
    char pointer[64];
    (void)state;
    /* A byte order mark, a comment, a character of two bytes before what is pointed at. */
    assert_int_equal(parse(&d,
                           "\xef\xbb\xbf{\"//\": 1, \"//\": 2,\n"
                           "  \"p\xc3\xa4\": {\"a/b~\": [10, {\"c\": true}]}}",
                           &e),
                     0);
    const cJSON *p = json_get(d.root, "p\xc3\xa4"), *list = json_get(p, "a/b~");
    const cJSON *c = json_get(cJSON_GetArrayItem(list, 1), "c");
    assert_int_equal(cJSON_GetArraySize(d.root), 1);
    assert_string_equal(document_pointer(&d, c, pointer, sizeof pointer), "/p\xc3\xa4/a~1b~0/1/c");
    assert_int_equal(document_fail(&d, c, &e, "is %d", 7), -1);
    assert_string_equal(e.text, "s.json:2:29: /p\xc3\xa4/a~1b~0/1/c: is 7");
    assert_int_equal(document_fail_key(&d, c, &e, "is %d", 7), -1);
    assert_starts(e.text, "s.json:2:24: ");
    document_fail(&d, d.root, &e, "x");
    assert_string_equal(e.text, "s.json:1:2: x");
    document_free(&d);
}

static void test_set(void **state)
{
    struct document d;
    struct error e;
    double x = 0;
    const char *word = NULL;
    (void)state;
    assert_int_equal(parse(&d, "{\"time\": {\"end\": 1}, \"list\": [1, {\"a\": 2}]}", &e), 0);
    assert_int_equal(document_set(&d, "time.end=2.5", &e), 0);
    assert_int_equal(document_set(&d, "list.1.a=3", &e), 0);
    assert_int_equal(document_set(&d, "list.2=[4]", &e), 0);
    assert_int_equal(document_set(&d, "output.log.steps=10", &e), 0);
    assert_int_equal(document_set(&d, "scheme.name=mpm", &e), 0);
    assert_int_equal(document_set(&d, "where=-x/r", &e), 0);
    json_number(&d, json_get(d.root, "time"), "end", true, &x, &e);
    assert_true(x == 2.5);
    json_number(&d, cJSON_GetArrayItem(json_get(d.root, "list"), 1), "a", true, &x, &e);
    assert_true(x == 3);
    assert_int_equal(cJSON_GetArraySize(json_get(d.root, "list")), 3);
    json_number(&d, json_get(json_get(d.root, "output"), "log"), "steps", true, &x, &e);
    assert_true(x == 10);
    json_string(&d, json_get(d.root, "scheme"), "name", true, &word, &e);
    assert_string_equal(word, "mpm");
    json_string(&d, d.root, "where", true, &word, &e);
    assert_string_equal(word, "-x/r");
    document_fail(&d, json_get(json_get(d.root, "time"), "end"), &e, "x");
    assert_string_equal(e.text, "--set time.end=2.5: /time/end: x");
    document_fail(&d, json_get(d.root, "time"), &e, "x");
    assert_string_equal(e.text, "s.json:1:10: /time: x");
    document_free(&d);
}

static void test_set_wrong(void **state)
{
    static const struct {
        const char *set, *part;
    } cases[] = {{"time", "PATH=VALUE"},
                 {"=1", "PATH=VALUE"},
                 {"time.end=", "value is missing"},
                 {"time..end=1", "before a dot"},
                 {"time.=1", "before \"=\""},
                 {"title.a=1", "has no members"},
                 {"list.x=1", "not an index"},
                 {"list.5=1", "give 0 to 1"},
                 {"list.-1=1", "not an index"},
                 {"time={\"end\": 1", "character 10"},
                 {"time.end=1e999", "too large"},
                 {"title=\xff", "UTF-8"}};
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct document d;
        struct error e;
        assert_int_equal(parse(&d, "{\"title\": \"a\", \"time\": {}, \"list\": [1]}", &e), 0);
        assert_int_equal(document_set(&d, cases[i].set, &e), -1);
        assert_int_equal(e.exit_code, EXIT_USAGE);
        assert_starts(e.text, "--set ");
        assert_holds(e.text, cases[i].part);
        document_free(&d);
    }
}

static void test_access(void **state)
{
    static const char *const keys[] = {"spacing", "fill"};
    struct document d;
    struct error e;
    double x = 7, v[3];
    long long n = 7;
    bool b = false;
    const char *s = "default";
    (void)state;
    assert_int_equal(
        parse(&d, "{\"fil\": -0.1, \"n\": 2.5, \"s\": \"\", \"v\": [1, 2], \"b\": true}", &e), 0);
    assert_int_equal(json_number(&d, d.root, "absent", false, &x, &e), 0);
    assert_true(x == 7);
    assert_int_equal(json_number(&d, d.root, "absent", true, &x, &e), -1);
    assert_string_equal(e.text, "s.json:1:1: the key \"absent\" is missing");
    assert_int_equal(json_number(&d, d.root, "v", true, &x, &e), -1);
    assert_holds(e.text, "/v: an array is not a number");
    assert_int_equal(json_positive(&d, d.root, "fil", true, "spacing", &x, &e), -1);
    assert_holds(e.text, "/fil: -0.1 is not a spacing; give a positive number");
    assert_int_equal(json_integer(&d, d.root, "n", true, 0, 9, &n, &e), -1);
    assert_holds(e.text, "2.5 is not a whole number");
    assert_int_equal(json_string(&d, d.root, "n", true, &s, &e), -1);
    assert_int_equal(json_string(&d, d.root, "s", true, &s, &e), -1);
    assert_holds(e.text, "empty");
    assert_int_equal(json_bool(&d, d.root, "b", true, &b, &e), 0);
    assert_true(b);
    assert_int_equal(json_bool(&d, d.root, "n", true, &b, &e), -1);
    assert_int_equal(json_vector(&d, d.root, "v", true, 3, v, &e), -1);
    assert_holds(e.text, "2 numbers in 3 dimensions; give 3");
    assert_int_equal(json_vector(&d, d.root, "v", true, 2, v, &e), 0);
    assert_true(v[0] == 1 && v[1] == 2 && v[2] == 0);
    assert_int_equal(json_keys(&d, d.root, keys, 2, &e), -1);
    assert_holds(e.text, "s.json:1:2: /fil: unknown key \"fil\" (did you mean \"fill\"?)");
    document_free(&d);
}

/* References keep keys, values, children and places of the originals. */
static void test_rest(void **state)
{
    static const char *const known[] = {"name"};
    struct document d;
    struct error e;
    char pointer[32];
    (void)state;
    assert_int_equal(parse(&d, "{\"eos\": {\"name\": \"gas\", \"gamma\": 1.4, \"k\": [1]}}", &e),
                     0);
    const cJSON *rest = document_rest(&d, json_get(d.root, "eos"), known, 1);
    assert_non_null(rest);
    assert_int_equal(cJSON_GetArraySize(rest), 2);
    const cJSON *gamma = json_get(rest, "gamma");
    assert_true(cJSON_IsNumber(gamma) && gamma->valuedouble == 1.4);
    assert_int_equal(cJSON_GetArraySize(json_get(rest, "k")), 1);
    document_fail(&d, gamma, &e, "x");
    assert_string_equal(e.text, "s.json:1:34: /eos/gamma: x");
    assert_string_equal(document_pointer(&d, rest, pointer, sizeof pointer), "/eos");
    document_free(&d);
}

static void test_files(void **state)
{
    struct document d;
    struct error e = {0};
    char path[] = "/tmp/sph-test-json-XXXXXX";
    (void)state;
    assert_int_equal(document_load(&d, "/nowhere/s.json", &e), -1);
    assert_holds(e.text, "/nowhere/s.json: cannot be read");
    assert_int_equal(document_load(&d, "/tmp", &e), -1);
    assert_holds(e.text, "is a folder");
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(document_load(&d, path, &e), -1);
    assert_holds(e.text, "empty");
    assert_int_equal(write(fd, "{\"a\": 1}", 8), 8);
    assert_int_equal(document_load(&d, path, &e), 0);
    assert_string_equal(d.path, path);
    document_free(&d);
    assert_int_equal(ftruncate(fd, (off_t)DOCUMENT_BYTES + 1), 0);
    assert_int_equal(document_load(&d, path, &e), -1);
    assert_holds(e.text, "larger than 64 MiB");
    close(fd);
    unlink(path);
}

/* Every document cut anywhere, and with any byte changed, is taken or refused, and nothing is
 * lost. */
static void test_damage(void **state)
{
    static const char text[] =
        "{\"a\": [1, -2.5e3, \"\\u00e9\\n\", {\"b\": null}], \"c\": {\"d\": true, \"e\": false}}";
    char copy[sizeof text];
    (void)state;
    for (size_t i = 0; i < sizeof text - 1; i++)
        for (int byte = -1; byte < 256; byte += byte < 0 ? 1 : 13) {
            struct document d;
            struct error e = {0};
            size_t n = byte < 0 ? i : sizeof text - 1;
            memcpy(copy, text, sizeof text);
            if (byte >= 0)
                copy[i] = (char)byte;
            if (document_parse(&d, "s.json", copy, n, &e) == 0)
                document_free(&d);
            else
                assert_starts(e.text, "s.json:1:");
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_syntax),    cmocka_unit_test(test_depth),
        cmocka_unit_test(test_places),    cmocka_unit_test(test_set),
        cmocka_unit_test(test_set_wrong), cmocka_unit_test(test_access),
        cmocka_unit_test(test_rest),      cmocka_unit_test(test_files),
        cmocka_unit_test(test_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
