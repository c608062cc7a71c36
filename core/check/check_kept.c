/* check/check_kept.c -- the check `kept`: an item is called after all others of its plugin, and
 * after itself, once their columns are shut for good: who reads one now has kept the pointer. */
#include "check/checks.h"
#include "check/sweep.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#define LONGEST 1   /* seconds that another item may take */
#define CAME_BACK 7 /* exit status; 0 would be an exit of its own */

static const struct style whole = {"in one piece", 0, false, 1, false, 0, 0};

/* Its results do not matter here; false if it cannot be called. */
static bool call_once(const struct subject *s)
{
    struct bench_shape shape = {1, LAYOUT_CLUSTER, 100, true, 0};
    struct pass_spec *spec = calloc(2, sizeof(*spec)); /* a bench points to it until the end */
    struct error e = {0};
    size_t n = spec ? passes_of(s->entry, spec) : 0;

    while (!subject_works_in(s, shape.dim))
        shape.dim++;
    for (size_t i = 0; i < n; i++) {
        struct bench *b = calloc(1, sizeof(*b));
        struct sweep sweep;
        int status = b ? bench_make(b, s, &spec[i], &shape, &e) : -1;
        if (status)
            return false;
        status = sweep_begin(&sweep, b, &e) || sweep_run(&sweep, b, &whole, &e);
        sweep_end(&sweep, b);
        bench_close(b);
        if (status)
            return false;
    }
    return n > 0;
}

/* Would it come back? A fault of another item is that item's own verdict, and must not end this
 * check. */
static bool comes_back(const struct subject *s)
{
    const struct itimerval most = {{0, 0}, {LONGEST, 0}};
    const pid_t child = fork();
    int status = 1;

    if (child == 0) {
        signal(SIGALRM, SIG_DFL);
        setitimer(ITIMER_REAL, &most, NULL);
        call_once(s);
        _exit(CAME_BACK);
    }
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR)
        continue;
    return child > 0 && WIFEXITED(status) && WEXITSTATUS(status) == CAME_BACK;
}

/* What another item prints is not this one's either. */
static void call_foreign(const struct subject *s)
{
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    const int out = dup(STDOUT_FILENO);

    fflush(stdout);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    s->stage->foreign = 1;
    if (comes_back(s))
        call_once(s);
    s->stage->foreign = 0;
    fflush(stdout);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    close(out);
    close(nowhere);
}

void check_kept(const struct subject *s)
{
    const struct registry *r = s->registry;
    bool good = true;

    for (size_t i = 0; i < r->n_entry; i++) {
        struct subject other = *s;
        other.entry = &r->entry[i];
        if (other.entry == s->entry || other.entry->plugin != s->entry->plugin)
            continue;
        call_foreign(&other);
    }
    for (int i = 0; i < 2 && good; i++)
        good = call_once(s);
    if (good)
        say(s, VERDICT_OK, "keeps no pointer from an earlier call or another item");
}
