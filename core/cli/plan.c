/* cli/plan.c -- `sph plan SCENE`: what would be modelled, and its cost. */
#include "cli/cli.h"
#include "cli/scene_options.h"
#include "opencl/stages_tell.h"
#include <string.h>

static const struct argp_child children[] = {{&scene_argp, 0, NULL, 0}, {0}};

enum { KEY_JSON = 'j', KEY_KERNELS = 256 };
static const struct argp_option options[] = {
    {"json", KEY_JSON, NULL, 0, "Print JSON", 0},
    {"kernels", KEY_KERNELS, "cpu|gpu", OPTION_ARG_OPTIONAL,
     "With --device opencl: print the OpenCL C that the scene becomes, instead; in the form that is built for "
     "processors (the default) or for GPUs",
     0},
    {0}};

struct arguments {
    struct scene_options scene;
    bool json, kernels, gpu;
};

static error_t parse(int key, char *arg, struct argp_state *state)
{
    struct arguments *a = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &a->scene;
        return 0;
    case KEY_JSON:
        a->json = true;
        return 0;
    case KEY_KERNELS:
        a->kernels = true;
        a->gpu = arg && strcmp(arg, "gpu") == 0;
        if (arg && !a->gpu && strcmp(arg, "cpu") != 0)
            argp_error(state, "--kernels: \"%s\" is neither cpu nor gpu", arg);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int print_json(const struct plan *plan, struct error *e)
{
    cJSON *json = plan_json(plan);
    int status = json ? 0 : error_memory(e, "the plan", 1);
    if (!status && plan->on_device)
        status = stages_json(plan, json, e);
    char *text = status ? NULL : cJSON_Print(json);
    if (text)
        puts(text);
    cJSON_free(text);
    cJSON_Delete(json);
    return status;
}

/* On a device also its stages. */
static int print(struct plan *plan, const struct arguments *a, struct error *e)
{
    if (a->kernels && !plan->scene->device.opencl)
        return error_set(e, EXIT_USAGE,
                         "--kernels prints what is built for a device: give --device opencl");
    if (a->kernels && !plan->on_device) /* why has been said */
        return error_set(e, EXIT_USAGE,
                         "there are no kernels of a scene that runs on the processor");
    if (a->kernels)
        return stages_print_kernels(plan, !a->gpu, stdout, e);
    if (a->json)
        return print_json(plan, e);
    plan_print(plan, stdout);
    return plan->on_device ? stages_print(plan, stdout, e) : 0;
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
    if (!status)
        status = print(&l.plan, &a, &e);
    loaded_free(&l);
    return status ? cli_error(&e) : EXIT_DONE;
}
