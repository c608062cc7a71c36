/* scene/scene_output.c -- "time" and "output": how long, and what is to be written. */
#include "scene/scene_private.h"
#include <math.h>

int scene_time(struct scene *s, const cJSON *node, struct error *e)
{
    static const char *const keys[] = {"integrator", "begin",  "end",  "cfl",
                                       "dt",         "dt_max", "steps"};
    long long steps = -1;
    s->time.node = node;
    s->time.cfl = s->time.dt = NAN;
    s->time.dt_max = INFINITY;
    s->time.steps = UINT64_MAX;
    if (!node)
        return document_fail(s->doc, s->doc->root, e, "the key \"time\" is missing");
    if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
        json_string(s->doc, node, "integrator", false, &s->time.integrator, e) < 0 ||
        json_number(s->doc, node, "begin", false, &s->time.begin, e) < 0 ||
        json_number(s->doc, node, "end", true, &s->time.end, e) < 0 ||
        json_positive(s->doc, node, "cfl", false, "time-step number", &s->time.cfl, e) < 0 ||
        json_positive(s->doc, node, "dt", false, "time step", &s->time.dt, e) < 0 ||
        json_positive(s->doc, node, "dt_max", false, "time step", &s->time.dt_max, e) < 0 ||
        json_integer(s->doc, node, "steps", false, 0, 1ll << 52, &steps, e) < 0)
        return -1;
    if (s->time.end <= s->time.begin)
        return document_fail(s->doc, json_get(node, "end"), e,
                             "the end %.15g is not after the begin %.15g", s->time.end,
                             s->time.begin);
    if (steps >= 0)
        s->time.steps = (uint64_t)steps;
    return 0;
}

static int compile_log(struct scene *s, const cJSON *node, struct error *e)
{
    static const char *const keys[] = {"steps", "every"};
    long long steps = 1;
    if (!node)
        return 0;
    if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0)
        return -1;
    if (json_get(node, "steps") && json_get(node, "every"))
        return document_fail(s->doc, node, e, "give \"steps\" or \"every\", not both");
    if (json_integer(s->doc, node, "steps", false, 1, 1ll << 52, &steps, e) < 0)
        return -1;
    s->output.log_steps = (uint64_t)steps;
    return json_positive(s->doc, node, "every", false, "time interval", &s->output.log_every, e);
}

static int compile_checkpoint(struct scene *s, const cJSON *node, struct error *e)
{
    static const char *const keys[] = {"steps", "every", "keep"};
    long long steps = 0, keep = 2;
    if (!node)
        return 0;
    if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0)
        return -1;
    if (!json_get(node, "steps") == !json_get(node, "every"))
        return document_fail(s->doc, node, e, "give \"steps\" or \"every\"%s",
                             json_get(node, "every") ? ", not both" : "");
    if (json_integer(s->doc, node, "steps", false, 1, 1ll << 52, &steps, e) < 0 ||
        json_positive(s->doc, node, "every", false, "time interval", &s->output.checkpoint.every,
                      e) < 0 ||
        json_integer(s->doc, node, "keep", false, 1, 1ll << 52, &keep, e) < 0)
        return -1;
    s->output.checkpoint.wanted = true;
    s->output.checkpoint.steps = (uint64_t)steps;
    s->output.checkpoint.keep = (uint64_t)keep;
    return 0;
}

static int compile_picture(struct scene *s, const cJSON *node, struct error *e)
{
    static const char *const keys[] = {"array", "field", "min", "max", "map", "size"};
    static const char *const maps[] = {"viridis", "magma", "coolwarm", "grey"};
    size_t map = 0;
    double min = NAN, max = NAN;
    s->output.picture.map = maps[0];
    if (!node || cJSON_IsFalse(node))
        return 0;
    s->output.picture.wanted = true;
    if (cJSON_IsTrue(node))
        return 0;
    if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
        scene_array_name(s, node, "array", false, &s->output.picture.array, e) < 0 ||
        json_string(s->doc, node, "field", false, &s->output.picture.of, e) < 0 ||
        json_number(s->doc, node, "min", false, &min, e) < 0 ||
        json_number(s->doc, node, "max", false, &max, e) < 0 ||
        scene_word(s, node, "map", "colour map", maps, COUNT(maps), &map, e) < 0 ||
        json_positive(s->doc, node, "size", false, "size", &s->output.picture.size, e) < 0)
        return -1;
    s->output.picture.map = maps[map];
    if (isnan(min) != isnan(max))
        return document_fail(s->doc, node, e, "give both \"min\" and \"max\" or neither");
    if (min >= max)
        return document_fail(s->doc, json_get(node, "min"), e, "min %.15g is not below max %.15g",
                             min, max);
    s->output.picture.range = !isnan(min);
    s->output.picture.min = min;
    s->output.picture.max = max;
    return 0;
}

int scene_output(struct scene *s, const cJSON *node, struct error *e)
{
    static const char *const keys[] = {"every", "log", "checkpoint", "picture"};
    s->output.node = node;
    s->output.every = s->output.log_every = s->output.checkpoint.every = INFINITY;
    s->output.log_steps = 1;
    s->output.picture.min = s->output.picture.max = NAN;
    s->output.picture.map = "viridis";
    if (!node)
        return 0;
    if (json_keys(s->doc, node, keys, COUNT(keys), e) < 0 ||
        json_positive(s->doc, node, "every", false, "time interval", &s->output.every, e) < 0)
        return -1;
    if (compile_log(s, json_get(node, "log"), e) < 0 ||
        compile_checkpoint(s, json_get(node, "checkpoint"), e) < 0)
        return -1;
    return compile_picture(s, json_get(node, "picture"), e);
}
