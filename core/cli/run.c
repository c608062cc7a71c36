/* cli/run.c -- `sph [run] SCENE`: a scene from file to results. */
#include "base/quiet.h"
#include "cli/cli.h"
#include "cli/scene_options.h"
#include "domain/ranks.h"
#include "plan/bodies.h"
#include "run/loop.h"
#include <errno.h>
#include <math.h>
#include <omp.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

static const struct argp_child children[] = {{&scene_argp, 0, NULL, 0}, {0}};

enum {
    KEY_OUT = 'o',
    KEY_THREADS = 't',
    KEY_QUIET = 'q',
    KEY_VERBOSE = 'v',
    KEY_UNTIL = 256,
    KEY_STEPS,
    KEY_PATH,
    KEY_DRY,
    KEY_AUDIT,
    KEY_RESUME,
    KEY_STRICT
};

static const struct argp_option options[] = {
    {"out", KEY_OUT, "DIR", 0, "Folder for the results (default: the scene's name, here)", 0},
    {"threads", KEY_THREADS, "N", 0,
     "Threads (default: the processors there are); the results are the same", 0},
    {"until", KEY_UNTIL, "T", 0, "End at time T instead of the scene's", 0},
    {"steps", KEY_STEPS, "N", 0, "End after N steps", 0},
    {"resume", KEY_RESUME, "FILE", 0,
     "Go on from a checkpoint: a file, or \"latest\", the newest good one in --out; the scene may be left "
     "out",
     0},
    {"path", KEY_PATH, "WORD", 0,
     "How pair loops run, to compare: best (default), reference (a pair at a time, in double), "
     "extended (in long double), base, avx2, avx512",
     0},
    {"dry-run", KEY_DRY, NULL, 0,
     "Do everything but the steps: check, make the particles, show the plan", 0},
    {"strict", KEY_STRICT, NULL, 0,
     "Every sum in the order of the particles' ids, or exact: the same bits on any number of ranks (slower)",
     0},
    {"audit", KEY_AUDIT, NULL, 0, "Prove that passes touch only what they declare (slow)", 0},
    {"quiet", KEY_QUIET, NULL, 0, "No progress, no table", 0},
    {"verbose", KEY_VERBOSE, NULL, 0, "Show the plan, and what plugins say", 0},
    {0},
};

struct arguments {
    struct scene_options scene;
    const char *out, *resume;
    int threads;
    double until;
    uint64_t steps;
    uint32_t path;
    bool dry, audit, quiet, verbose, strict;
};

static double number(struct argp_state *state, const char *option, const char *text, double min,
                     bool whole)
{
    char *end;
    errno = 0;
    double value = strtod(text, &end);
    if (end == text || *end || errno || !isfinite(value) || value < min ||
        (whole && value > 9e15) || (whole && floor(value) < value))
        argp_error(state, "--%s: \"%s\" is no %s of at least %g", option, text,
                   whole ? "whole number" : "number", min);
    return value;
}

/* SPH_PATH_... by name. */
static uint32_t path(struct argp_state *state, const char *text)
{
    static const char *const name[] = {"best", "reference", "extended", "base", "avx2", "avx512"};
    for (uint32_t k = 0; k < sizeof name / sizeof name[0]; k++)
        if (strcmp(text, name[k]) == 0)
            return k;
    argp_error(state, "--path: \"%s\" is none of best, reference, extended, base, avx2 and avx512",
               text);
    return SPH_PATH_BEST;
}

static error_t parse(int key, char *arg, struct argp_state *state)
{
    struct arguments *a = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &a->scene;
        a->scene.optional = true; /* until it is known whether a checkpoint brings one */
        return 0;
    case ARGP_KEY_END:
        if (!a->scene.path && !a->resume)
            argp_error(state, "no scene is given");
        if (a->resume && a->dry)
            argp_error(state, "--dry-run and --resume do not go together");
        if (a->resume && strcmp(a->resume, "latest") == 0 && !a->scene.path && !a->out)
            argp_error(state, "--resume latest: give the scene, or the folder by --out");
        return 0;
    case KEY_RESUME:
        a->resume = arg;
        return 0;
    case KEY_OUT:
        a->out = arg;
        return 0;
    case KEY_THREADS:
        a->threads = (int)fmin(number(state, "threads", arg, 1.0, true), 4096.0);
        return 0;
    case KEY_UNTIL:
        a->until = number(state, "until", arg, -INFINITY, false);
        return 0;
    case KEY_STEPS:
        a->steps = (uint64_t)number(state, "steps", arg, 0.0, true);
        return 0;
    case KEY_PATH:
        a->path = path(state, arg);
        return 0;
    case KEY_DRY:
        a->dry = true;
        return 0;
    case KEY_STRICT:
        a->strict = true;
        return 0;
    case KEY_AUDIT:
        a->audit = true;
        return 0;
    case KEY_QUIET:
        a->quiet = true;
        return 0;
    case KEY_VERBOSE:
        a->verbose = true;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* A handler can be given nothing; it may set this and no more. */
static volatile int interrupted;

static void interrupt(int signal_number)
{
    (void)signal_number;
    interrupted = 1;
}

/* "tube" of "examples/tube.json". */
static void default_out(const char *scene, char *out, size_t size)
{
    const char *slash = strrchr(scene, '/');
    snprintf(out, size, "%s", slash ? slash + 1 : scene);
    char *dot = strrchr(out, '.');
    if (dot && dot != out)
        *dot = '\0';
    if (strcmp(out, slash ? slash + 1 : scene) == 0)
        snprintf(out, size, "sph-out");
}

/* The folder of results, in fresh memory: --out, or where the checkpoint stands, or by the scene's name. */
static char *out_folder(const struct arguments *a)
{
    char folder[512];
    if (a->out)
        return strdup(a->out);
    if (a->resume && strcmp(a->resume, "latest") != 0)
        return resume_folder(a->resume);
    default_out(a->scene.path, folder, sizeof folder);
    return strdup(folder);
}

static bool is_first(void)
{
    int rank, size;
    ranks_count(&rank, &size);
    return rank == 0;
}

static int run(const struct arguments *a, struct loaded *l, const char *folder,
               struct resume *resume, struct error *e)
{
    struct output out;
    struct loop_options o = {.scene_path = a->scene.path,
                             .until = a->until,
                             .steps = a->steps,
                             .progress = !a->quiet,
                             .table = !a->quiet,
                             .audit = a->audit,
                             .threads = a->threads,
                             .path = a->path,
                             .stop = &interrupted,
                             .resume = resume};
    double end = isnan(a->until) ? l->scene.time.end : a->until;
    if (!(end >= l->scene.time.begin)) /* on all ranks */
        return error_set(e, EXIT_USAGE, "--until %g lies before the scene's begin, %g", end,
                         l->scene.time.begin);
    out = (struct output){.lock = -1};
    if (ranks_agree(run_check(&l->plan, a->path, a->audit, e), e) ||
        ranks_agree(is_first() ? output_claim(&out, folder, e) : 0, e))
        return -1;
    signal(SIGINT, interrupt);
    signal(SIGTERM, interrupt);
    int status = loop_run(&l->plan, &out, &o, e);
    bodies_blame(&l->plan, e);
    output_close(&out);
    return status;
}

static int run_or_show(const struct arguments *a, const char *folder, struct resume *resume,
                       struct error *e)
{
    struct loaded l;
    int status = loaded_make(&l, &a->scene, a->audit, e);
    l.plan.strict = a->strict;
    if (!status && a->verbose)
        l.registry.log_level = SPH_LOG_INFO;
    if (!status && !resume)
        status = ranks_agree(plan_fill(&l.plan, e), e);
    if (!status && !resume && (a->dry || a->verbose) && is_first())
        plan_print(&l.plan, stdout);
    if (!status && !a->dry)
        status = ranks_agree(bodies_need_device(&l.plan, e), e) || run(a, &l, folder, resume, e);
    loaded_free(&l);
    return status;
}

/* From the beginning, or from a checkpoint, which brings its scene if none is given. */
static int run_from(struct arguments *a, struct error *e)
{
    struct resume resume;
    char *folder = out_folder(a);
    if (!folder)
        return error_memory(e, "a path", 1);
    int status = 0;
    if (!a->resume) {
        status = run_or_show(a, folder, NULL, e);
    } else {
        status = resume_open_together(&resume, a->resume, folder, e);
        if (!status && !a->scene.path) {
            a->scene.path = resume.origin.scene_path;
            a->scene.text = resume.origin.scene;
            a->scene.before = resume.origin.set;
            a->scene.n_before = resume.origin.n_set;
        }
        if (!status)
            status = run_or_show(a, folder, &resume, e);
        resume_close(&resume);
    }
    free(folder);
    return status;
}

int cli_run(int argc, char **argv)
{
    static const struct argp argp = {
        .options = options,
        .parser = parse,
        .children = children,
        .args_doc = "SCENE.json\n--resume FILE",
        .doc =
            "Runs a scene. The folder of results holds snapshots (snapshot_NNNN.vtkhdf: open them in "
            "ParaView), log.csv and summary.json.\v"
            "Exit status: 0 done; 1 the run failed, the last good state is kept; 2 the command line or the "
            "scene is wrong; 3 a plugin is refused."};
    struct arguments a = {.threads = omp_get_num_procs(), .until = NAN, .steps = UINT64_MAX};
    struct error e = {0};
    int rank, size, kept[2] = {-1, -1};
    ranks_launched(&rank, &size);
    /* What is wrong with the words the first says. No other may end with an error: mpirun would kill it. */
    argp_err_exit_status = rank > 0 ? EXIT_DONE : EXIT_USAGE;
    if (rank > 0)
        quiet_begin(kept);
    argp_parse(&argp, argc, argv, 0, NULL, &a);
    quiet_end(kept);
    int status = ranks_begin(&argc, &argv, &e);
    if (a.path == SPH_PATH_REFERENCE || a.path == SPH_PATH_EXTENDED)
        a.scene.precision = precision_name[PRECISION_DOUBLE];
    if (!status)
        status = run_from(&a, &e);
    int code = status ? cli_error(&e) : interrupted ? EXIT_RUN : EXIT_DONE;
    ranks_end();
    return code;
}
