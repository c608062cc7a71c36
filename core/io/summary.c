/* summary.c -- what a run came to, as summary.json. The table for people is in summary_table.c. */
#include "config.h"

#include "io/summary.h"

#include "base/text.h"
#include <cairo.h>
#include <hdf5.h>
#include <math.h>
#include <sph/abi.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* -- Numbers ----------------------------------------------------------------------------------- */

double summary_ns_per_pair(const struct summary *s)
{
    double seconds = 0;
    uint64_t pairs = 0;
    for (size_t i = 0; i < s->n_pass; i++)
        if (s->pass[i].pairs > 0) {
            seconds += s->pass[i].seconds;
            pairs += s->pass[i].pairs;
        }
    if (pairs == 0) {
        seconds = s->cost.loop;
        pairs = s->cost.pairs;
    }
    return pairs ? 1e9 * seconds / (double)pairs : (double)NAN;
}

double summary_us_per_update(const struct summary *s)
{
    const uint64_t n = s->cost.particle_updates;
    return n ? 1e6 * s->cost.loop / (double)n : (double)NAN;
}

/* -- JSON -------------------------------------------------------------------------------------- */

/* A tree in the making; `failed` once memory ran out. */
struct maker {
    bool failed;
};

/* Takes `item`, which may be NULL, into the object (by name) or the array (name NULL). */
static cJSON *put(struct maker *m, cJSON *into, const char *name, cJSON *item)
{
    if (item && into &&
        (name ? cJSON_AddItemToObject(into, name, item) : cJSON_AddItemToArray(into, item)))
        return item;
    cJSON_Delete(item);
    m->failed = true;
    return NULL;
}

static cJSON *put_object(struct maker *m, cJSON *into, const char *name)
{
    return put(m, into, name, cJSON_CreateObject());
}

static void put_number(struct maker *m, cJSON *into, const char *name, double value)
{
    put(m, into, name, isfinite(value) ? cJSON_CreateNumber(value) : cJSON_CreateNull());
}

static void put_count(struct maker *m, cJSON *into, const char *name, uint64_t value)
{
    put_number(m, into, name, (double)value);
}

/* A text that is not UTF-8 (a path may be anything) would not be JSON. */
static void put_text(struct maker *m, cJSON *into, const char *name, const char *text)
{
    if (!text) {
        put(m, into, name, cJSON_CreateNull());
        return;
    }
    char *clean = text_format("%s", text);
    size_t bad;
    while (clean && (bad = text_invalid_utf8(clean, strlen(clean))) != (size_t)-1)
        clean[bad] = '?';
    put(m, into, name, clean ? cJSON_CreateString(clean) : NULL);
    free(clean);
}

static void put_vector(struct maker *m, cJSON *into, const char *name, const double *value, int n)
{
    cJSON *list = put(m, into, name, cJSON_CreateArray());
    for (int i = 0; i < n; i++)
        put_number(m, list, NULL, value[i]);
}

static void put_particles(struct maker *m, cJSON *root, const struct summary *s)
{
    cJSON *particles = put_object(m, root, "particles");
    for (size_t i = 0; i < s->n_array; i++)
        put_count(m, particles, s->array_name[i], s->array_n[i]);
}

static void put_errors(struct maker *m, cJSON *root, const struct summary *s)
{
    cJSON *errors = put_object(m, root, "errors");
    for (size_t i = 0; i < s->n_error; i++) {
        const struct summary_error *from = &s->error[i];
        char *name = text_format("%s", from->field);
        /* Compared again: "fluid.rho@REFERENCE"; and again: "fluid.rho@REFERENCE.2". */
        for (int k = 1; name && cJSON_GetObjectItemCaseSensitive(errors, name); k++) {
            free(name);
            name = k == 1 ? text_format("%s@%s", from->field, from->reference)
                          : text_format("%s@%s.%d", from->field, from->reference, k);
        }
        cJSON *error = name ? put_object(m, errors, name) : NULL;
        put_number(m, error, "l1", from->l1);
        put_number(m, error, "l1_rel", from->l1_rel);
        put_number(m, error, "l2", from->l2);
        put_number(m, error, "l2_rel", from->l2_rel);
        put_number(m, error, "linf", from->linf);
        put_vector(m, error, "linf_at", from->linf_at, s->dim);
        put_count(m, error, "n", from->n);
        put_count(m, error, "outside", from->outside);
        if (!isnan(from->time))
            put_number(m, error, "time", from->time);
        put_text(m, error, "reference", from->reference);
        free(name);
    }
}

static void put_course(struct maker *m, cJSON *probe, const struct summary_course *from)
{
    cJSON *course = put_object(m, probe, "reference");
    put_text(m, course, "reference", from->reference);
    put_number(m, course, "begin", from->begin);
    put_number(m, course, "end", from->end);
    put_number(m, course, "l1", from->l1);
    put_number(m, course, "l1_rel", from->l1_rel);
    put_number(m, course, "l2", from->l2);
    put_number(m, course, "l2_rel", from->l2_rel);
    put_number(m, course, "linf", from->linf);
}

/* A number each, or of several points a list each. */
static void put_values(struct maker *m, cJSON *probe, const struct summary_probe *from)
{
    cJSON *values = put_object(m, probe, "values");
    for (size_t k = 0; k < from->n_of; k++) {
        if (from->n_point == 1) {
            put_number(m, values, from->of[k], from->values[k]);
            continue;
        }
        cJSON *list = put(m, values, from->of[k], cJSON_CreateArray());
        for (size_t i = 0; i < from->n_point; i++)
            put_number(m, list, NULL, from->values[i * from->n_of + k]);
    }
}

static void put_probes(struct maker *m, cJSON *root, const struct summary *s)
{
    cJSON *probes = put_object(m, root, "probes");
    for (size_t i = 0; i < s->n_probe; i++) {
        cJSON *probe = put_object(m, probes, s->probe[i].name);
        put_number(m, probe, "value", s->probe[i].value);
        put_number(m, probe, "expected", s->probe[i].expected);
        if (s->probe[i].of)
            put_values(m, probe, &s->probe[i]);
        if (s->probe[i].file) {
            put_text(m, probe, "file", s->probe[i].file);
            put_count(m, probe, "rows", s->probe[i].rows);
        }
        if (s->probe[i].course.reference)
            put_course(m, probe, &s->probe[i].course);
    }
}

static void put_profiles(struct maker *m, cJSON *root, const struct summary *s)
{
    if (!s->n_profile)
        return;
    cJSON *profiles = put_object(m, root, "profiles");
    for (size_t i = 0; i < s->n_profile; i++) {
        cJSON *profile = put_object(m, profiles, s->profile[i].name);
        put_text(m, profile, "file", s->profile[i].file);
        put_count(m, profile, "rows", s->profile[i].rows);
    }
}

static void put_conservation(struct maker *m, cJSON *root, const struct summary *s)
{
    cJSON *c = put_object(m, root, "conservation");
    put_number(m, c, "energy_drift", s->energy_drift);
    put_vector(m, c, "momentum_drift", s->momentum_drift, s->dim);
    put_vector(m, c, "angular_drift", s->dim == 2 ? s->angular_drift + 2 : s->angular_drift,
               s->dim == 3   ? 3
               : s->dim == 2 ? 1
                             : 0);
    put_number(m, c, "mass_drift", s->mass_drift);
}

/* Passes of the same name are one entry: their times add up. */
static void put_passes(struct maker *m, cJSON *cost, const struct summary *s)
{
    cJSON *passes = put_object(m, cost, "pass_s"), *counts = put_object(m, cost, "pass_pairs"),
          *swept = put_object(m, cost, "pass_sweeps");
    for (size_t i = 0; i < s->n_pass; i++) {
        double seconds = 0;
        uint64_t pairs = 0, sweeps = 0;
        if (cJSON_HasObjectItem(passes, s->pass[i].name))
            continue;
        for (size_t k = i; k < s->n_pass; k++)
            if (strcmp(s->pass[k].name, s->pass[i].name) == 0) {
                seconds += s->pass[k].seconds;
                pairs += s->pass[k].pairs;
                sweeps += s->pass[k].sweeps;
            }
        put_number(m, passes, s->pass[i].name, seconds);
        put_count(m, counts, s->pass[i].name, pairs);
        put_count(m, swept, s->pass[i].name, sweeps);
    }
    if (s->shared)
        put(m, cost, "pass_in", cJSON_Duplicate(s->shared, 1));
}

static void put_memory(struct maker *m, cJSON *cost, const struct summary_memory *memory)
{
    cJSON *o = put_object(m, cost, "memory_per_particle");
    put_number(m, o, "columns", memory->columns);
    put_number(m, o, "mirrors", memory->mirrors);
    put_number(m, o, "lists", memory->lists);
    put_number(m, o, "places", memory->places);
    put_number(m, o, "ghosts", memory->ghosts);
    put_number(m, o, "search", memory->search);
}

static void put_cost(struct maker *m, cJSON *root, const struct summary *s)
{
    cJSON *c = put_object(m, root, "cost");
    put_number(m, c, "wall_s", s->cost.wall);
    put_number(m, c, "loop_s", s->cost.loop);
    put_number(m, c, "neighbour_s", s->cost.neighbour);
    put_number(m, c, "integrate_s", s->cost.integrate);
    put_passes(m, c, s);
    put_number(m, c, "io_s", s->cost.io);
    put_number(m, c, "mpi_s", s->cost.mpi);
    put_count(m, c, "particle_updates", s->cost.particle_updates);
    put_count(m, c, "pairs", s->cost.pairs);
    put_count(m, c, "list_builds", s->cost.list_builds);
    put_count(m, c, "sorts", s->cost.sorts);
    put_count(m, c, "h_sweeps", s->cost.h_sweeps);
    put_number(m, c, "ns_per_pair", summary_ns_per_pair(s));
    put_number(m, c, "us_per_particle_update", summary_us_per_update(s));
    put_count(m, c, "peak_rss_bytes", s->cost.peak_rss);
    put_number(m, c, "bytes_per_particle", s->cost.bytes_per_particle);
    put_memory(m, c, &s->cost.memory);
    put_count(m, c, "threads", (uint64_t)(s->threads > 0 ? s->threads : 1));
    put_count(m, c, "ranks", (uint64_t)(s->ranks > 0 ? s->ranks : 1));
}

static void put_plan(struct maker *m, cJSON *root, const struct summary *s)
{
    cJSON *plan =
        put(m, root, "plan", s->plan ? cJSON_Duplicate(s->plan, 1) : cJSON_CreateObject());
    if (cJSON_IsObject(plan) && !cJSON_HasObjectItem(plan, "arrays"))
        put_object(m, plan, "arrays");
    if (cJSON_IsObject(plan) && !cJSON_HasObjectItem(plan, "passes"))
        put(m, plan, "passes", cJSON_CreateArray());
}

static void put_versions(struct maker *m, cJSON *root)
{
    unsigned major = 0, minor = 0, release = 0;
    char text[64];
    cJSON *v = put_object(m, root, "versions");
    put_text(m, v, "sph", PACKAGE_VERSION);
    snprintf(text, sizeof text, "%u.%u", SPH_ABI_MAJOR, SPH_ABI_MINOR);
    put_text(m, v, "abi", text);
#ifdef __VERSION__
#ifdef __clang__
    put_text(m, v, "compiler", __VERSION__);
#else
    put_text(m, v, "compiler", "gcc " __VERSION__);
#endif
#endif
    H5get_libversion(&major, &minor, &release);
    snprintf(text, sizeof text, "%u.%u.%u", major, minor, release);
    put_text(m, v, "hdf5", text);
    put_text(m, v, "cjson", cJSON_Version());
    put_text(m, v, "cairo", cairo_version_string());
}

static void put_plugins(struct maker *m, cJSON *root, const struct summary *s)
{
    cJSON *list = put(m, root, "plugins", cJSON_CreateArray());
    for (size_t i = 0; i < s->n_plugin; i++) {
        char abi[32];
        cJSON *plugin = put_object(m, list, NULL);
        snprintf(abi, sizeof abi, "%u.%u", s->plugin[i].abi_major, s->plugin[i].abi_minor);
        put_text(m, plugin, "name", s->plugin[i].name);
        put_text(m, plugin, "version", s->plugin[i].version);
        put_text(m, plugin, "abi", abi);
        put_text(m, plugin, "file", s->plugin[i].file);
    }
}

static void put_occurrence(struct maker *m, cJSON *into, const struct summary_watch *w, int dim)
{
    put_text(m, into, "array", w->array);
    if (w->array) {
        put_number(m, into, "particle", (double)w->particle);
        put_vector(m, into, "x", w->x, dim);
    }
    put_text(m, into, "pass", w->pass);
    put_count(m, into, "step", w->step);
    put_number(m, into, "time", w->time);
}

static void put_watch(struct maker *m, cJSON *root, const struct summary *s)
{
    if (s->failure) {
        cJSON *failure = put_object(m, root, "failure");
        put_text(m, failure, "cause", s->failure->cause);
        put_occurrence(m, failure, s->failure, s->dim);
    }
    cJSON *watch = put_object(m, root, "watch");
    for (size_t i = 0; i < s->n_watch; i++) {
        cJSON *one = put_object(m, watch, s->watch[i].cause);
        put_count(m, one, "count", s->watch[i].n);
        if (s->watch[i].happened)
            put_occurrence(m, put_object(m, one, "first"), &s->watch[i], s->dim);
    }
}

cJSON *summary_json(const struct summary *s)
{
    struct maker m = {false};
    cJSON *root = cJSON_CreateObject();
    put_text(&m, root, "status", s->status);
    if (s->reason)
        put_text(&m, root, "reason", s->reason);
    put_watch(&m, root, s);
    put_text(&m, root, "scene", s->scene);
    put_text(&m, root, "title", s->title);
    put_particles(&m, root, s);
    put_count(&m, root, "steps", s->steps);
    put_number(&m, root, "time", s->time);
    put_errors(&m, root, s);
    put_probes(&m, root, s);
    put_profiles(&m, root, s);
    put_conservation(&m, root, s);
    put_cost(&m, root, s);
    if (s->device)
        put(&m, root, "device", cJSON_Duplicate(s->device, 1));
    if (s->on_ranks)
        put(&m, root, "ranks", cJSON_Duplicate(s->on_ranks, 1));
    put_plan(&m, root, s);
    put_versions(&m, root);
    put_plugins(&m, root, s);
    put_text(&m, root, "picture", s->picture);
    if (!m.failed)
        return root;
    cJSON_Delete(root);
    return NULL;
}

int summary_write(const struct summary *s, const struct output *o, struct error *e)
{
    cJSON *root = summary_json(s);
    char *text = root ? cJSON_Print(root) : NULL, *line = text ? text_format("%s\n", text) : NULL;
    const int result = line ? output_write(o, "summary.json", line, strlen(line), e)
                            : error_memory(e, "summary.json", 1u << 16);
    free(line);
    cJSON_free(text);
    cJSON_Delete(root);
    return result;
}
