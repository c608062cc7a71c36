/* scene/scene_watch.c -- "watch": what a run does about signs that it has gone wrong. */
#include "scene/scene_private.h"
#include <math.h>
#include <string.h>

const char *const watch_keys[] = {"not-finite", "density", "internal-energy", "escaped",
                                  "time-step",  "energy",  "neighbours"};

static const char *const actions[] = {"stop", "count",
                                      "off"}; /* in the order of enum watch_action */

/* The key of a cause's limit, and what it is; NULL: it has none. */
static const struct {
    const char *key, *what;
    double value;
} limit_of[WATCH_CAUSES] = {
    [WATCH_ESCAPED] = {"margin", "margin", 100.0},
    [WATCH_TIME_STEP] = {"below", "fraction of the longest step", 1e-6},
    [WATCH_ENERGY] = {"above", "multiple of the energy at the start", 10.0},
    [WATCH_NEIGHBOURS] = {"above", "number of neighbours", 0.0},
};

/* In 3D 5000: smoothing lengths of four times the usual. */
static const double neighbours_most[4] = {0.0, 500.0, 2000.0, 5000.0};

static void defaults(struct scene *s)
{
    for (size_t c = 0; c < WATCH_CAUSES; c++)
        s->watch[c] =
            (struct scene_watch){.action = WATCH_STOP, .limit = limit_of[c].value, .scale = NAN};
    s->watch[WATCH_NEIGHBOURS].limit = neighbours_most[s->dim];
}

static int compile_action(struct scene *s, const cJSON *object, const char *key,
                          struct scene_watch *w, struct error *e)
{
    size_t action = w->action;
    if (scene_word(s, object, key, "action", actions, COUNT(actions), &action, e) < 0)
        return -1;
    w->action = (enum watch_action)action;
    return 0;
}

/* What an object may hold for a cause. */
static int check_keys(struct scene *s, const cJSON *node, size_t cause, struct error *e)
{
    static const char *const keys[] = {"action"};
    static const char *const escaped_keys[] = {"action", "margin", "where"};
    static const char *const time_step_keys[] = {"action", "below"};
    static const char *const energy_keys[] = {"action", "above", "scale"};
    static const char *const neighbours_keys[] = {"action", "above"};
    switch ((enum watch_cause)cause) {
    case WATCH_ESCAPED:
        return json_keys(s->doc, node, escaped_keys, COUNT(escaped_keys), e);
    case WATCH_TIME_STEP:
        return json_keys(s->doc, node, time_step_keys, COUNT(time_step_keys), e);
    case WATCH_ENERGY:
        return json_keys(s->doc, node, energy_keys, COUNT(energy_keys), e);
    case WATCH_NEIGHBOURS:
        return json_keys(s->doc, node, neighbours_keys, COUNT(neighbours_keys), e);
    default:
        return json_keys(s->doc, node, keys, COUNT(keys), e);
    }
}

static int compile_details(struct scene *s, const cJSON *node, size_t cause, struct error *e)
{
    struct scene_watch *w = &s->watch[cause];
    if (check_keys(s, node, cause, e) < 0 || compile_action(s, node, "action", w, e) < 0)
        return -1;
    if (limit_of[cause].key && json_positive(s->doc, node, limit_of[cause].key, false,
                                             limit_of[cause].what, &w->limit, e) < 0)
        return -1;
    if (cause == WATCH_TIME_STEP && !(w->limit < 1.0))
        return document_fail(s->doc, json_get(node, "below"), e,
                             "%.15g is not a fraction of the longest step; give one below 1",
                             w->limit);
    if (cause == WATCH_ENERGY)
        return json_positive(s->doc, node, "scale", false, "energy", &w->scale, e);
    const cJSON *where = cause == WATCH_ESCAPED ? json_get(node, "where") : NULL;
    if (where && scene_check_expression(s, where, SCENE_REGION_VARIABLES, e) < 0)
        return -1;
    w->where = where ? where->valuestring : NULL;
    return 0;
}

static int compile_cause(struct scene *s, const cJSON *node, size_t cause, struct error *e)
{
    const cJSON *of = json_get(node, watch_keys[cause]);
    struct scene_watch *w = &s->watch[cause];
    char brief[JSON_BRIEF];
    if (!of)
        return 0;
    if (cJSON_IsFalse(of))
        w->action = WATCH_OFF;
    else if (!cJSON_IsString(of) && !cJSON_IsObject(of))
        return document_fail(s->doc, of, e,
                             "%s is not an action; give \"stop\", \"count\", \"off\" or an object",
                             json_brief(of, brief));
    else if (cJSON_IsString(of) ? compile_action(s, node, watch_keys[cause], w, e) < 0
                                : compile_details(s, of, cause, e) < 0)
        return -1;
    if (cause == WATCH_NOT_FINITE && w->action != WATCH_STOP)
        return document_fail(s->doc, of, e,
                             "a value that is not finite always stops the run: nothing follows "
                             "from it but others");
    return 0;
}

int scene_watches(struct scene *s, const cJSON *node, struct error *e)
{
    defaults(s);
    if (!node || cJSON_IsTrue(node))
        return 0;
    if (cJSON_IsFalse(node)) {
        for (size_t c = 0; c < WATCH_CAUSES; c++)
            s->watch[c].action = c == WATCH_NOT_FINITE ? WATCH_STOP : WATCH_OFF;
        return 0;
    }
    if (json_keys(s->doc, node, watch_keys, WATCH_CAUSES, e) < 0)
        return -1;
    for (size_t c = 0; c < WATCH_CAUSES; c++)
        if (compile_cause(s, node, c, e) < 0)
            return -1;
    return 0;
}
