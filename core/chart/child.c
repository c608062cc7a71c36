/* chart/child.c -- starts a run, watches its time, and reaps it. */
#include "config.h"

#include "chart/child.h"

#include "base/text.h"
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define GRACE 10.0 /* [s] between the word that time is over and the end */
#define TICK 0.25  /* [s] */

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void our_signals(sigset_t *set)
{
    sigemptyset(set);
    sigaddset(set, SIGCHLD);
    sigaddset(set, SIGINT);
    sigaddset(set, SIGTERM);
}

void child_signals(bool block)
{
    sigset_t set;
    our_signals(&set);
    sigprocmask(block ? SIG_BLOCK : SIG_UNBLOCK, &set, NULL);
}

/* A group of its own: the terminal's interrupt is for us, who then end the child. */
static _Noreturn void in_child(char *const *argument, int words, pid_t parent)
{
    const int null = open("/dev/null", O_RDWR | O_CLOEXEC);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent)
        _exit(EXIT_RUN);
    setpgid(0, 0);
    child_signals(false);
    dup2(null, STDIN_FILENO);
    dup2(null, STDOUT_FILENO);
    dup2(words, STDERR_FILENO);
    execv("/proc/self/exe", argument);
    fprintf(stderr, "sph: cannot start itself: %s\n", strerror(errno));
    _exit(EXIT_RUN);
}

/* The last line that says something, without "sph: ". */
static void last_line(int fd, char *out, size_t size)
{
    char text[4096];
    const off_t length = lseek(fd, 0, SEEK_END);
    const off_t from = length > (off_t)sizeof text - 1 ? length - (off_t)sizeof text + 1 : 0;
    ssize_t n = length > 0 ? pread(fd, text, sizeof text - 1, from) : 0;
    while (n > 0 && (text[n - 1] == '\n' || text[n - 1] == ' '))
        n--;
    text[n > 0 ? n : 0] = '\0';
    const char *line = strrchr(text, '\n');
    line = line ? line + 1 : text;
    if (strncmp(line, "sph: ", 5) == 0)
        line += 5;
    snprintf(out, size, "%.*s", (int)size - 1, line);
    text_one_line(out);
}

/* The next signal of ours, or 0 after a tick. */
static int next_signal(double seconds)
{
    sigset_t set;
    const double wait = fmax(fmin(seconds, TICK), 0.001);
    const struct timespec t = {0, (long)(1e9 * wait)};
    our_signals(&set);
    const int signal_number = sigtimedwait(&set, NULL, &t);
    return signal_number > 0 ? signal_number : 0;
}

static void watch(pid_t child, double limit, child_tick tick, void *data, struct child_outcome *o)
{
    const double begin = now();
    double deadline = begin + limit;
    while (waitpid(child, &o->status, WNOHANG) != child) {
        const int got = next_signal(deadline - now());
        if (got == SIGINT || got == SIGTERM) {
            o->interrupted = true;
            kill(child, SIGKILL);
        } else if (now() >= deadline) {
            kill(child, o->late ? SIGKILL : SIGTERM);
            o->late = true;
            deadline = now() + GRACE;
        }
        tick(data, now() - begin);
    }
    o->seconds = now() - begin;
}

int child_run(char *const *argument, double limit, child_tick tick, void *data,
              struct child_outcome *o, struct error *e)
{
    *o = (struct child_outcome){0};
    const pid_t parent = getpid();
    const int words = memfd_create("words", MFD_CLOEXEC);
    if (words < 0)
        return error_set(e, EXIT_RUN, "no room for a run's messages: %s", strerror(errno));
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0)
        in_child(argument, words, parent);
    if (child < 0) {
        close(words);
        return error_set(e, EXIT_RUN, "a run cannot be started: %s", strerror(errno));
    }
    watch(child, limit, tick, data, o);
    last_line(words, o->words, sizeof o->words);
    close(words);
    return 0;
}
