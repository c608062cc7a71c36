/* registry/crash.c -- see crash.h. A signal handler can be given nothing, so what it needs stands in
 * mutable globals, here and nowhere else. */
#include "config.h"

#include "registry/crash.h"

#include "base/error.h"

#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const struct {
    int number;
    const char *name;
} known[] = {
    {SIGSEGV, "segmentation fault"}, {SIGBUS, "bus error"}, {SIGILL, "illegal instruction"},
    {SIGFPE, "arithmetic error"},    {SIGABRT, "abort"},    {SIGTRAP, "trap"},
    {SIGSYS, "forbidden call"}};
#define N_KNOWN (sizeof(known) / sizeof(known[0]))

static const char *volatile file, *volatile doing;
static struct sigaction before[N_KNOWN];
static stack_t stack_before;
static char stack[65536]; /* of its own: the crash may be a stack that is full */

static void tell(const char *name)
{
    char line[4600];
    /* snprintf is not promised to be safe here; the process ends either way. */
    const int n = snprintf(line, sizeof(line), "sph: plugin %s: it crashed (%s) while it was %s\n",
                           file, name, doing);
    const ssize_t written =
        write(STDERR_FILENO, line, n < (int)sizeof(line) ? (size_t)n : sizeof(line) - 1);

    (void)written;
}

static void crashed(int number)
{
    size_t k = 0;

    while (k + 1 < N_KNOWN && known[k].number != number)
        k++;
    tell(known[k].name);
    _exit(EXIT_REFUSED);
}

void crash_watch(const char *path, const char *what)
{
    const stack_t own = {.ss_sp = stack, .ss_size = sizeof(stack)};
    struct sigaction action;

    memset(&action, 0, sizeof(action));
    action.sa_handler = crashed;
    action.sa_flags = SA_ONSTACK;
    sigemptyset(&action.sa_mask);
    file = path;
    doing = what;
    sigaltstack(&own, &stack_before);
    for (size_t k = 0; k < N_KNOWN; k++) {
        sigaction(known[k].number, &action, &before[k]);
        if (before[k].sa_handler != SIG_DFL)
            sigaction(known[k].number, &before[k], NULL);
    }
}

void crash_forget(void)
{
    for (size_t k = 0; k < N_KNOWN; k++)
        sigaction(known[k].number, &before[k], NULL);
    sigaltstack(&stack_before, NULL);
}
