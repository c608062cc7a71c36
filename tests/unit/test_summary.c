/* test_summary.c -- summary.json keeps its contract; the table fits a terminal. */
#include "config.h"

#include "io/summary.h"

#include "scratch.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

static const char *const array_name[] = {"fluid", "wall"};
static const uint64_t array_n[] = {10000, 400};
#define ERROR(FIELD, REFERENCE, L1, L1_REL, L2, LINF, N)                                           \
    {                                                                                              \
        .field = FIELD, .reference = REFERENCE, .l1 = L1, .l1_rel = L1_REL, .l2 = L2,              \
        .linf = LINF, .n = N, .time = (double)NAN                                                  \
    }
static const struct summary_error errors[] = {
    ERROR("fluid.rho", "exact-a", .31, .12, .5, 9.3, 10000),
    ERROR("fluid.p", "exact-a", 1.234e-15, .12, 1e300, 9.3, 1),
    ERROR("fluid.rho", "exact-b", (double)NAN, 1, 1, 1, 0),
    ERROR("fluid.rho", "exact-b", 4, 1, 1, 1, 0)};
static const char *const of[] = {"p", "sum"};
static const double values[] = {1, .5, 2, (double)NAN};
static const struct summary_probe probes[] = {
    {.name = "plateau density", .value = 15.41, .expected = 16},
    {.name = "hole at the centre", .value = 0.25, .expected = (double)NAN},
    {.name = "P",
     .value = 1,
     .expected = (double)NAN,
     .file = "probe_P.csv",
     .rows = 6,
     .of = of,
     .n_of = 2,
     .n_point = 2,
     .values = values,
     .course = {.reference = "p.csv", .begin = 0, .end = 2, .l1 = .25, .l2_rel = (double)NAN}}};
static const struct summary_profile profiles[] = {{"axis", "profile_axis.csv", 202}};
static const struct summary_pass passes[] = {
    {"rates", 10, 1000000000, 10}, {"state", 1, 0, 10}, {"rates", 2, 1000000000, 10}};
static const struct summary_plugin plugins[] = {{"demo", "0.1", "/x/demo.so", 0, 1}};

static struct summary example(void)
{
    return (struct summary){.status = "done",
                            .scene = "examples/demo.json",
                            .title = "A demonstration",
                            .n_array = 2,
                            .array_name = array_name,
                            .array_n = array_n,
                            .steps = 812,
                            .time = 0.6,
                            .error = errors,
                            .n_error = 4,
                            .probe = probes,
                            .n_probe = 3,
                            .profile = profiles,
                            .n_profile = 1,
                            .energy_drift = 2.1e-5,
                            .momentum_drift = {1e-17, (double)INFINITY, 0},
                            .angular_drift = {7, 8, 9},
                            .dim = 2,
                            .cost = {.wall = 12.3,
                                     .loop = 12,
                                     .neighbour = 2,
                                     .integrate = 1,
                                     .io = .1,
                                     .particle_updates = 8120000,
                                     .pairs = 2000000000,
                                     .list_builds = 80,
                                     .h_sweeps = 1700,
                                     .peak_rss = 1 << 20,
                                     .bytes_per_particle = 312},
                            .pass = passes,
                            .n_pass = 3,
                            .plugin = plugins,
                            .n_plugin = 1,
                            .threads = 2,
                            .ranks = 1,
                            .picture = "out/density.png"};
}

/* The value at a path of keys; NULL if there is none. */
static const cJSON *at(const cJSON *json, const char *path)
{
    char copy[256], *rest = copy;
    snprintf(copy, sizeof copy, "%s", path);
    for (char *key = strtok_r(copy, "/", &rest); key && json; key = strtok_r(NULL, "/", &rest))
        json = cJSON_GetObjectItemCaseSensitive(json, key);
    return json;
}

static void assert_near(double value, double expected, double tolerance)
{
    assert_true(fabs(value - expected) <= tolerance);
}

static double number_at(const cJSON *json, const char *path)
{
    const cJSON *item = at(json, path);
    assert_true(cJSON_IsNumber(item));
    return item->valuedouble;
}

static void keeps_its_contract(void **state)
{
    struct output o;
    struct error e = {0};
    struct summary s = example();
    cJSON *plan = cJSON_CreateObject();
    cJSON_AddItemToObject(plan, "arrays", cJSON_CreateObject());
    s.plan = plan;
    assert_int_equal(output_open(&o, scratch_path(state, "out"), &e), 0);
    assert_int_equal(summary_write(&s, &o, &e), 0);
    output_close(&o);
    cJSON_Delete(plan);
    char *text = scratch_read(scratch_path(state, "out/summary.json"), NULL);
    cJSON *json = cJSON_Parse(text);
    assert_non_null(json);

    assert_string_equal(at(json, "status")->valuestring, "done");
    assert_string_equal(at(json, "scene")->valuestring, "examples/demo.json");
    assert_near(number_at(json, "particles/fluid"), 10000, 0);
    assert_near(number_at(json, "steps"), 812, 0);
    assert_near(number_at(json, "time"), 0.6, 0);
    assert_near(number_at(json, "errors/fluid.rho/l1"), 0.31, 0);
    assert_near(number_at(json, "errors/fluid.rho/l1_rel"), 0.12, 0);
    assert_near(number_at(json, "errors/fluid.rho/l2"), 0.5, 0);
    assert_near(number_at(json, "errors/fluid.rho/linf"), 9.3, 0);
    assert_string_equal(at(json, "errors/fluid.rho/reference")->valuestring, "exact-a");
    assert_true(cJSON_IsNull(at(json, "errors/fluid.rho@exact-b/l1")));
    assert_near(number_at(json, "errors/fluid.rho@exact-b.2/l1"), 4, 0);
    assert_near(number_at(json, "probes/P/value"), 1, 0);
    assert_near(number_at(json, "probes/P/rows"), 6, 0);
    assert_string_equal(at(json, "probes/P/file")->valuestring, "probe_P.csv");
    assert_near(cJSON_GetArrayItem(at(json, "probes/P/values/p"), 1)->valuedouble, 2, 0);
    assert_true(cJSON_IsNull(cJSON_GetArrayItem(at(json, "probes/P/values/sum"), 1)));
    assert_near(number_at(json, "probes/P/reference/l1"), .25, 0);
    assert_true(cJSON_IsNull(at(json, "probes/P/reference/l2_rel")));
    assert_null(at(json, "probes/plateau density/file"));
    assert_near(number_at(json, "profiles/axis/rows"), 202, 0);
    assert_near(number_at(json, "conservation/energy_drift"), 2.1e-5, 0);
    assert_int_equal(cJSON_GetArraySize(at(json, "conservation/momentum_drift")), 2);
    assert_true(cJSON_IsNull(cJSON_GetArrayItem(at(json, "conservation/momentum_drift"), 1)));
    assert_near(cJSON_GetArrayItem(at(json, "conservation/angular_drift"), 0)->valuedouble, 9, 0);
    assert_near(number_at(json, "conservation/mass_drift"), 0, 0);
    static const char *const cost[] = {"wall_s",
                                       "loop_s",
                                       "neighbour_s",
                                       "io_s",
                                       "mpi_s",
                                       "particle_updates",
                                       "pairs",
                                       "ns_per_pair",
                                       "us_per_particle_update",
                                       "peak_rss_bytes",
                                       "bytes_per_particle"};
    for (size_t i = 0; i < sizeof cost / sizeof cost[0]; i++)
        assert_true(cJSON_IsNumber(cJSON_GetObjectItem(at(json, "cost"), cost[i])));
    assert_near(number_at(json, "cost/pass_s/rates"), 12, 1e-12);
    assert_near(number_at(json, "cost/pass_s/state"), 1, 0);
    assert_near(number_at(json, "cost/ns_per_pair"), 6, 1e-12);
    assert_true(cJSON_IsObject(at(json, "plan/arrays")));
    assert_true(cJSON_IsArray(at(json, "plan/passes")));
    assert_string_equal(at(json, "versions/sph")->valuestring, PACKAGE_VERSION);
    const cJSON *plugin = cJSON_GetArrayItem(at(json, "plugins"), 0);
    assert_string_equal(at(plugin, "name")->valuestring, "demo");
    assert_string_equal(at(plugin, "version")->valuestring, "0.1");
    assert_string_equal(at(plugin, "abi")->valuestring, "0.1");
    assert_string_equal(at(plugin, "file")->valuestring, "/x/demo.so");
    cJSON_Delete(json);
    free(text);
}

static void stands_bare(void **state)
{
    (void)state;
    const struct summary s = {.status = "failed", .reason = "bad \xff bytes", .time = (double)NAN};
    cJSON *json = summary_json(&s);
    assert_non_null(json);
    assert_string_equal(at(json, "reason")->valuestring, "bad ? bytes");
    assert_true(cJSON_IsNull(at(json, "time")));
    assert_true(cJSON_IsNull(at(json, "cost/ns_per_pair")));
    cJSON_Delete(json);
    char *text = NULL;
    size_t n;
    FILE *out = open_memstream(&text, &n);
    summary_table(&s, out);
    fclose(out);
    assert_non_null(strstr(text, "failed"));
    free(text);
}

static void table_fits(void **state)
{
    (void)state;
    char *text = NULL;
    size_t n, width = 0;
    struct summary s = example();
    FILE *out = open_memstream(&text, &n);
    summary_table(&s, out);
    fclose(out);
    for (const char *c = text; *c; c++) {
        width = *c == '\n' ? 0 : width + (((unsigned char)*c & 0xC0) != 0x80);
        assert_in_range(width, 0, 80);
        assert_false(*c == '\n' && c > text && c[-1] == ' ');
    }
    assert_non_null(strstr(text, "plateau density     15.41         (expected 16)\n"));
    assert_non_null(strstr(text, "6 ns per pair, 1.48 us per particle update, 12.3 s\n"));
    assert_non_null(strstr(text, "picture             out/density.png\n"));
    free(text);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        TEST(keeps_its_contract),
        TEST(stands_bare),
        TEST(table_fits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
