/* cli/check.c -- `sph check SCENE`: everything that can be wrong with a scene, short of running it. */
#include "cli/cli.h"
#include "cli/scene_options.h"

static const struct argp_child children[] = {{&scene_argp, 0, NULL, 0}, {0}};

static error_t parse(int key, char *arg, struct argp_state *state)
{
    (void)arg;
    if (key != ARGP_KEY_INIT)
        return ARGP_ERR_UNKNOWN;
    state->child_inputs[0] = state->input;
    return 0;
}

int cli_check(int argc, char **argv)
{
    static const struct argp argp = {
        .parser = parse,
        .children = children,
        .args_doc = "SCENE.json",
        .doc =
            "Checks a scene: errors are told by file, line and column. Particles are made, nothing is run."};
    struct scene_options o = {0};
    struct loaded l;
    struct error e = {0};
    argp_err_exit_status = EXIT_USAGE;
    argp_parse(&argp, argc, argv, 0, NULL, &o);
    int status = loaded_make(&l, &o, false, &e);
    if (!status)
        status = plan_fill(&l.plan, &e);
    if (!status)
        for (size_t a = 0; a < l.plan.n_array; a++)
            printf("%s: %zu particles of \"%s\"\n", o.path, l.plan.array[a].p.n,
                   l.plan.array[a].p.name);
    loaded_free(&l);
    return status ? cli_error(&e) : EXIT_DONE;
}
