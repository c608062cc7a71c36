/* cli/check.c -- `sph check SCENE`: everything that can be wrong with a scene, short of running it. */
#include "cli/cli.h"
#include "cli/scene_options.h"
#include "plan/bodies.h"
#include "run/run.h"

static const struct argp_child children[] = {{&scene_argp, 0, NULL, 0}, {0}};

static error_t parse(int key, char *arg, struct argp_state *state)
{
    (void)arg;
    if (key != ARGP_KEY_INIT)
        return ARGP_ERR_UNKNOWN;
    state->child_inputs[0] = state->input;
    return 0;
}

/* What would be built for the device is built. `asked`: by --device; else a device that is not there is no
 * mistake of the scene. */
static int try_device(struct plan *plan, bool asked, struct error *e)
{
    struct run run;
    struct error why = {0};
    int status = plan->on_device ? run_init(&run, plan, 1, SPH_PATH_BEST, false, &why) : 0;
    if (plan->on_device)
        run_free(&run);
    if (!status || (!asked && why.exit_code != EXIT_REFUSED))
        return 0;
    bodies_blame(plan, &why);
    *e = why;
    return status;
}

/* Texts that the scene brings are compiled, where there is a device. */
static int try_texts(const struct scene_options *o, struct error *e)
{
    struct scene_options on_device = *o;
    struct loaded l;
    on_device.device_opencl = true;
    int status = loaded_make(&l, &on_device, false, e) || try_device(&l.plan, false, e);
    loaded_free(&l);
    return status;
}

static int try_all(struct plan *plan, const struct scene_options *o, struct error *e)
{
    if (bodies_fit(plan, e))
        return -1;
    return plan->on_device ? try_device(plan, true, e) : bodies_any(plan) ? try_texts(o, e) : 0;
}

int cli_check(int argc, char **argv)
{
    static const struct argp argp = {
        .parser = parse,
        .children = children,
        .args_doc = "SCENE.json",
        .doc =
            "Checks a scene: errors are told by file, line and column. Particles are made, texts for devices are "
            "compiled where there is one, nothing is run."};
    struct scene_options o = {0};
    struct loaded l;
    struct error e = {0};
    argp_err_exit_status = EXIT_USAGE;
    argp_parse(&argp, argc, argv, 0, NULL, &o);
    int status = loaded_make(&l, &o, false, &e);
    if (!status)
        status = plan_fill(&l.plan, &e);
    if (!status)
        status = try_all(&l.plan, &o, &e);
    if (!status)
        for (size_t a = 0; a < l.plan.n_array; a++)
            printf("%s: %zu particles of \"%s\"\n", o.path, l.plan.array[a].p.n,
                   l.plan.array[a].p.name);
    loaded_free(&l);
    return status ? cli_error(&e) : EXIT_DONE;
}
