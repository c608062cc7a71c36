/* cli/plan.c -- `sph plan SCENE`: what would be modelled, and its cost. */
#include "base/quiet.h"
#include "cli/cli.h"
#include "cli/plan_ranks.h"
#include "cli/scene_options.h"
#include "domain/ranks.h"
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

/* ranks: NULL on one. */
static int print_json(const struct plan *plan, const struct plan_ranks *ranks, struct error *e)
{
    cJSON *json = plan_json(plan);
    int status = json ? 0 : error_memory(e, "the plan", 1);
    if (!status && plan->on_device)
        status = stages_json(plan, json, e);
    if (!status && ranks)
        cJSON_AddItemToObject(json, "ranks", plan_ranks_json(ranks, plan));
    char *text = status ? NULL : cJSON_Print(json);
    if (text)
        puts(text);
    cJSON_free(text);
    cJSON_Delete(json);
    return status;
}

static bool is_first(void)
{
    int rank, ranks;
    ranks_count(&rank, &ranks);
    return rank == 0;
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
        return print_json(plan, NULL, e);
    plan_print(plan, stdout);
    return plan->on_device ? stages_print(plan, stdout, e) : 0;
}

/* What the ranks share: told by the first. */
static int plan_of_ranks(struct plan *plan, struct arguments *a, struct error *e)
{
    struct plan_ranks r;
    int status = plan_ranks_make(&r, &a->scene, plan->scene->ranks.partition, e);
    if (!status && a->json && is_first())
        status = print_json(plan, &r, e);
    else if (!status && is_first()) {
        plan_print(plan, stdout);
        plan_ranks_print(&r, plan, stdout);
    }
    plan_ranks_free(&r);
    return ranks_agree(status, e);
}

static int plan_scene(struct arguments *a, struct error *e)
{
    struct loaded l;
    int rank, ranks;
    ranks_count(&rank, &ranks);
    int status = loaded_make(&l, &a->scene, false, e);
    if (!status && ranks > 1 && !a->kernels)
        status = plan_of_ranks(&l.plan, a, e);
    else if (!status)
        status = ranks_agree(is_first() ? print(&l.plan, a, e) : 0, e);
    loaded_free(&l);
    return status;
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
            "and write, exchanges, expected pairs. Nothing is run. Under mpirun also how its ranks would share the "
            "domain, and what they would send."};
    struct arguments a = {0};
    struct error e = {0};
    int rank, size, kept[2] = {-1, -1};
    ranks_launched(&rank, &size);
    /* As of a run: what is wrong with the words the first says. */
    argp_err_exit_status = rank > 0 ? EXIT_DONE : EXIT_USAGE;
    if (rank > 0)
        quiet_begin(kept);
    argp_parse(&argp, argc, argv, 0, NULL, &a);
    quiet_end(kept);
    int status = ranks_begin(&argc, &argv, &e);
    if (!status)
        status = plan_scene(&a, &e);
    const int code = status ? cli_error(&e) : EXIT_DONE;
    ranks_end();
    return code;
}
