/* check/child.c -- forks, watches and reaps the processes in which plugins run (see child.h). */
#include "check/child.h"

#include "check/watch.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Where verdicts go, and what has come of the line that is being read. */
struct listener {
    struct report *report;
    const char *kind, *item, *check;
    char line[2048];
    size_t length;
    bool finished, failed; /* the child came to its end; it has said a failure */
};

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Standard output and standard error go to `output`: a plugin prints nothing. */
static _Noreturn void in_child(struct subject *s, child_work work, int output)
{
    const struct rlimit none = {0, 0};

    prctl(PR_SET_PDEATHSIG, SIGKILL);
    setrlimit(RLIMIT_CORE, &none);
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    s->registry->log_level = -1;
    watch_begin(s);
    work(s);
    fflush(stdout);
    if (write(s->out, ".\n", 2) != 2)
        _exit(EXIT_RUN);
    _exit(EXIT_DONE);
}

static int heard(struct listener *l, struct error *e)
{
    const char *where = l->line[0] ? strchr("KFN", l->line[0]) : NULL;

    if (strcmp(l->line, ".") == 0)
        l->finished = true;
    if (!where)
        return 0;
    l->failed = l->failed || l->line[0] == 'F';
    return report_add(l->report, (enum verdict)(where - &"KFN"[0]), l->kind, l->item, l->check,
                      l->line + 1, e);
}

/* Reads until the other end is closed; 1: the time is over. */
static int listen_to(struct listener *l, int fd, double deadline, struct error *e)
{
    for (;;) {
        struct pollfd p = {.fd = fd, .events = POLLIN};
        const double left = deadline - now();
        char buffer[4096];
        ssize_t n;

        if (left <= 0)
            return 1;
        if (poll(&p, 1, (int)(1000 * left) + 1) < 0 && errno != EINTR)
            return error_set(e, EXIT_RUN, "waiting for a child process: %s", strerror(errno));
        if (!p.revents)
            continue;
        n = read(fd, buffer, sizeof(buffer));
        if (n <= 0)
            return 0;
        for (ssize_t i = 0; i < n; i++) {
            if (buffer[i] != '\n') {
                if (l->length < sizeof(l->line) - 1)
                    l->line[l->length++] = buffer[i];
                continue;
            }
            l->line[l->length] = '\0';
            l->length = 0;
            if (heard(l, e))
                return -1;
        }
    }
}

static int add(struct listener *l, enum verdict v, struct error *e, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

static int add(struct listener *l, enum verdict v, struct error *e, const char *format, ...)
{
    char text[1024];
    va_list list;

    va_start(list, format);
    vsnprintf(text, sizeof(text), format, list);
    va_end(list);
    return report_add(l->report, v, l->kind, l->item, l->check, text, e);
}

/* The verdict on a child that did not come to its end. */
static int say_end(struct listener *l, const struct subject *s, int status, bool late,
                   double timeout, struct error *e)
{
    const char *stage = s->stage->text;

    if (s->stage->foreign)
        return 0;
    if (late)
        return add(l, VERDICT_FAIL, e, "%s: does not return within %g s", stage, timeout);
    if (l->finished || (l->failed && WIFEXITED(status) && WEXITSTATUS(status) == WATCH_TRAPPED))
        return 0;
    if (WIFSIGNALED(status))
        return add(l, VERDICT_FAIL, e, "%s: ended by signal %d (%s)", stage, WTERMSIG(status),
                   strsignal(WTERMSIG(status)));
    return add(l, VERDICT_FAIL, e, "%s: ended the process, with exit status %d", stage,
               WEXITSTATUS(status));
}

/* What the plugin printed: its first line in a verdict; all of it is shown if the child came to
 * grief, since it may be a sanitizer's report. */
static int say_output(struct listener *l, int output, struct error *e)
{
    char text[4096], first[200];
    ssize_t n = pread(output, text, sizeof(text) - 1, 0);
    off_t at = 0;

    if (n <= 0)
        return 0;
    text[n] = '\0';
    snprintf(first, sizeof(first), "%.150s", text);
    first[strcspn(first, "\n")] = '\0';
    for (; !l->finished && (n = pread(output, text, sizeof(text), at)) > 0; at += n)
        fwrite(text, 1, (size_t)n, stderr);
    return add(l, VERDICT_FAIL, e, "prints, which is the host's affair: \"%s\"", first);
}

static int watch_child(struct listener *l, struct subject *s, pid_t child, int in, double timeout,
                       struct error *e)
{
    int status = 0;
    const int how = listen_to(l, in, now() + timeout, e);

    if (how != 0)
        kill(child, SIGKILL);
    while (waitpid(child, &status, 0) < 0 && errno == EINTR)
        continue;
    return how < 0 ? -1 : say_end(l, s, status, how > 0, timeout, e);
}

int child_run(struct subject *s, const char *item, const char *check, child_work work,
              double timeout, struct report *report, struct error *e)
{
    struct listener l = {.report = report, .item = item, .check = check, .kind = "plugin"};
    int channel[2], status, output = memfd_create("output", MFD_CLOEXEC);
    pid_t child;

    if (s->entry)
        l.kind = subject_kind[s->entry->kind];
    if (output < 0 || pipe2(channel, O_CLOEXEC)) {
        status = error_set(e, EXIT_RUN, "no pipe to a child process: %s", strerror(errno));
        if (output >= 0)
            close(output);
        return status;
    }
    snprintf(s->stage->text, sizeof(s->stage->text), "%s", check);
    s->stage->foreign = 0;
    fflush(NULL);
    s->out = channel[1];
    child = fork();
    if (child == 0)
        in_child(s, work, output);
    close(channel[1]);
    status = child < 0 ? error_set(e, EXIT_RUN, "no child process: %s", strerror(errno))
                       : watch_child(&l, s, child, channel[0], timeout, e);
    if (!status)
        status = say_output(&l, output, e);
    close(channel[0]);
    close(output);
    return status;
}
