/* cli/plan.c -- `sph plan SCENE`: what would be modelled, and its cost. */
#include "cli/cli.h"
#include "cli/scene_options.h"

static const struct argp_child children[] = {{&scene_argp, 0, NULL, 0}, {0}};

enum { KEY_JSON = 'j' };
static const struct argp_option options[] = {{"json", KEY_JSON, NULL, 0, "Print JSON", 0}, {0}};

struct arguments {
    struct scene_options scene;
    bool json;
};

static error_t parse(int key, char *arg, struct argp_state *state)
{
    struct arguments *a = state->input;
    (void)arg;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &a->scene;
        return 0;
    case KEY_JSON:
        a->json = true;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

int cli_plan(int argc, char **argv)
{
    static const struct argp argp = {
        .options = options,
        .parser = parse,
        .children = children,
        .args_doc = "SCENE.json",
        .doc =
            "Shows what a scene would model: arrays, bytes per particle, passes with what they read "
            "and write, exchanges, expected pairs. Nothing is run."};
    struct arguments a = {0};
    struct loaded l;
    struct error e = {0};
    argp_err_exit_status = EXIT_USAGE;
    argp_parse(&argp, argc, argv, 0, NULL, &a);
    int status = loaded_make(&l, &a.scene, false, &e);
    if (!status && a.json) {
        cJSON *json = plan_json(&l.plan);
        char *text = cJSON_Print(json);
        if (text)
            puts(text);
        cJSON_free(text);
        cJSON_Delete(json);
    } else if (!status) {
        plan_print(&l.plan, stdout);
    }
    loaded_free(&l);
    return status ? cli_error(&e) : EXIT_DONE;
}
