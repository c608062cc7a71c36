/* cli/main.c -- the program: chooses the command, which does the rest. `run` may be left out. */
#include "config.h"

#include "base/text.h"
#include "cli/cli.h"
#include "domain/ranks.h"

#include <sph/abi.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct {
    const char *name, *title; /* argv[0] of the command */
    int (*run)(int argc, char **argv);
    const char *doc;
} commands[] = {
    {"run", "sph run", cli_run, "run a scene (the word may be left out)"},
    {"info", "sph info", cli_info, "what the plugins offer: parameters, units, ranges, sources"},
    {"plan", "sph plan", cli_plan, "what would be modelled for a scene, and its cost"},
    {"check", "sph check", cli_check, "errors of a scene, by line and column; nothing is run"},
    {"render", "sph render", cli_render, "pictures of snapshots"},
    {"chart", "sph chart", cli_chart, "error against cost for a family of runs"},
    {"new-plugin", "sph new-plugin", cli_new_plugin, "a plugin project to begin with"},
};
#define N_COMMANDS (sizeof(commands) / sizeof(commands[0]))

/* Options whose value may be the next argument, which then is neither command nor scene. */
static const char *const with_value[] = {"--load",   "--out",       "--set",    "--threads",
                                         "--device", "--precision", "--resume", "--serve",
                                         "--until",  "--steps"};
#define N_WITH_VALUE (sizeof(with_value) / sizeof(with_value[0]))

static int help(void)
{
    puts("Usage: sph [run] SCENE.json [OPTION...]\n"
         "  or:  sph COMMAND [OPTION...] [ARGUMENT...]\n"
         "Smoothed particle hydrodynamics: a scene names plugins, materials and shapes;\n"
         "sph runs it on the threads of one process, with the same results for any number.\n"
         "\n"
         "Commands:");
    for (size_t i = 0; i < N_COMMANDS; i++)
        printf("  %-10s %s\n", commands[i].name, commands[i].doc);
    puts("\n"
         "  -?, --help      this text; `sph COMMAND --help' tells a command's options\n"
         "  -V, --version   version of the program and of its plugin ABI\n"
         "\n"
         "Plugins are looked for in SPH_PLUGIN_PATH, in ~/.local/share/sph and where sph\n"
         "is installed. Exit status: 0 done, 1 the run failed, 2 the command line or the\n"
         "scene is wrong, 3 a plugin is refused.");
    return EXIT_DONE;
}

static int version(void)
{
    printf("sph %s (plugin ABI %u.%u)\n", PACKAGE_VERSION, SPH_ABI_MAJOR, SPH_ABI_MINOR);
    puts("License: BSD-3-Clause. There is no warranty, to the extent permitted by law.");
    return EXIT_DONE;
}

static bool is_one_of(const char *word, const char *a, const char *b)
{
    return strcmp(word, a) == 0 || strcmp(word, b) == 0;
}

/* Also of its beginnings, which argp takes as well: --thr 4. */
static bool takes_next(const char *option)
{
    const size_t n = strlen(option);

    for (size_t i = 0; i < N_WITH_VALUE; i++)
        if (n > 2 && strncmp(option, with_value[i], n) == 0)
            return true;
    return false;
}

/* Index of the first argument that is no option and no option's value; argc if there is none. */
static int first_word(int argc, char **argv)
{
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--") == 0)
            return i + 1 < argc ? i + 1 : argc;
        if (argv[i][0] != '-' || argv[i][1] == '\0')
            return i;
        if (takes_next(argv[i]))
            i++;
    }
    return argc;
}

static bool is_given(int end, char **argv, const char *a, const char *b)
{
    for (int i = 1; i < end; i++)
        if (is_one_of(argv[i], a, b))
            return true;
    return false;
}

/* It starts runs of its own, which would take themselves for ranks. */
static int refuse_ranks(int size)
{
    struct error e = {0};
    error_set(&e, EXIT_USAGE,
              "`sph chart' starts runs of its own: start it without mpirun, not on %d ranks", size);
    return cli_error(&e);
}

/* Takes the command's word out of the arguments. Of many ranks all run; whatever else there is the first does alone. */
static int run_command(size_t command, int word, int argc, char **argv)
{
    if (word < argc) {
        memmove(&argv[word], &argv[word + 1], (size_t)(argc - word) * sizeof(*argv));
        argc--;
    }
    argv[0] = (char *)commands[command].title;
    int rank, size;
    ranks_launched(&rank, &size);
    if (rank > 0 && commands[command].run != cli_run && commands[command].run != cli_plan)
        return EXIT_DONE;
    if (size > 1 && commands[command].run == cli_chart)
        return refuse_ranks(size);
    return commands[command].run(argc, argv);
}

/* A word that can be no scene: neither a file nor named like one. */
static int not_a_command(const char *word)
{
    const char *names[N_COMMANDS];
    char hint[256];
    struct error e = {0};

    for (size_t i = 0; i < N_COMMANDS; i++)
        names[i] = commands[i].name;
    error_set(&e, EXIT_USAGE, "\"%s\" is neither a command nor a scene file%s", word,
              text_suggest(hint, sizeof(hint), word, names, N_COMMANDS));
    return cli_error(&e);
}

static int dispatch(int argc, char **argv)
{
    const int word = first_word(argc, argv);
    int rank, size;

    ranks_launched(&rank, &size);
    if (is_given(word, argv, "--version", "-V"))
        return rank > 0 ? EXIT_DONE : version();
    for (size_t i = 0; word < argc && i < N_COMMANDS; i++)
        if (strcmp(argv[word], commands[i].name) == 0 && strcmp(argv[word - 1], "--") != 0)
            return run_command(i, word, argc, argv);
    if (is_given(word, argv, "--help", "-?"))
        return rank > 0 ? EXIT_DONE : help();
    if (argc == 1) {
        const struct error e = {EXIT_USAGE, "no scene is given (`sph --help' tells more)"};
        return cli_error(&e);
    }
    if (word < argc && !strpbrk(argv[word], "./") && access(argv[word], F_OK) != 0)
        return not_a_command(argv[word]);
    return run_command(0, argc, argc, argv);
}

/* Threads that wait for others should sleep, not spin: beside any other work on the machine spinning
 * costs several times the run. The OpenMP library reads its policy once, before main, so the program
 * starts itself again with it set, unless the user has set it. */
static void sleep_when_waiting(char **argv)
{
    if (getenv("OMP_WAIT_POLICY") || getenv("GOMP_SPINCOUNT"))
        return;
    if (setenv("OMP_WAIT_POLICY", "passive", 1) == 0)
        execv("/proc/self/exe", argv); /* where that fails the run is slower, no more */
}

int main(int argc, char **argv)
{
    signal(SIGXFSZ, SIG_IGN); /* a size limit comes back as an error of write, whoever writes */
    sleep_when_waiting(argv);
    int status = dispatch(argc, argv);

    /* A full disk must not pass for a success. */
    if (fflush(stdout) != 0 || ferror(stdout)) {
        const struct error e = {EXIT_RUN, "standard output cannot be written"};
        if (status == EXIT_DONE)
            status = cli_error(&e);
    }
    return status;
}
