/* check/watch.c -- protected memory and the handler of faults (see watch.h). A signal handler can
 * be given nothing, so what it looks through stands in the one mutable global here. */
#include "check/watch.h"

#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define MOST 4096
#define HANDLER_STACK 65536

struct piece {
    char *pages, *data;
    uintptr_t end; /* a page that nobody may touch begins here */
    const char *what;
};

static struct {
    const struct subject *subject;
    struct watched *watched[MOST];
    struct piece piece[MOST];
    size_t n_watched, n_piece, page;
} watch;

static bool say_column(const void *address)
{
    for (size_t i = watch.n_watched; i-- > 0;) {
        const struct watched *w = watch.watched[i];
        const int c = particles_at_address(w->particles, address);
        const char *why;
        if (c < 0)
            continue;
        why = w->closed           ? w->closed
              : w->access[c] == 0 ? "which it does not declare"
              : w->access[c] == 1 ? "which it declares only to read"
                                  : "which it may write, but not beyond its end";
        say(watch.subject, VERDICT_FAIL, "%s: touches \"%s\", %s", watch.subject->stage->text,
            w->particles->column[c].name, why);
        return true;
    }
    return false;
}

static bool say_piece(const void *address)
{
    const uintptr_t a = (uintptr_t)address;

    for (size_t i = watch.n_piece; i-- > 0;) {
        const struct piece *p = &watch.piece[i];
        if (a < (uintptr_t)p->pages || a >= p->end + watch.page)
            continue;
        say(watch.subject, VERDICT_FAIL,
            a < p->end ? "%s: writes %s" : "%s: touches %s, beyond its end",
            watch.subject->stage->text, p->what);
        return true;
    }
    return false;
}

static void say_signal(int number, const void *address)
{
    const char *stage = watch.subject->stage->text;

    if (number == SIGFPE)
        say(watch.subject, VERDICT_FAIL, "%s: divides an integer by zero", stage);
    else if (number == SIGABRT)
        say(watch.subject, VERDICT_FAIL, "%s: aborts", stage);
    else if (number == SIGILL)
        say(watch.subject, VERDICT_FAIL, "%s: runs into an illegal instruction", stage);
    else if ((uintptr_t)address < 65536)
        say(watch.subject, VERDICT_FAIL, "%s: follows a NULL pointer (address %p)", stage, address);
    else
        say(watch.subject, VERDICT_FAIL, "%s: touches memory that is nobody's (address %p)", stage,
            address);
}

/* Prints with functions that are not promised to be safe here; the process ends either way. */
static void trap(int number, siginfo_t *info, void *context)
{
    const bool memory = number == SIGSEGV || number == SIGBUS;

    (void)context;
    if (watch.subject->stage->foreign)
        _exit(WATCH_TRAPPED);
    if (!memory || (!say_column(info->si_addr) && !say_piece(info->si_addr)))
        say_signal(number, memory ? info->si_addr : NULL);
    _exit(WATCH_TRAPPED);
}

void watch_begin(const struct subject *s)
{
    static const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
    static char space[HANDLER_STACK]; /* a stack that has run over cannot hold the handler */
    const stack_t stack = {.ss_sp = space, .ss_size = sizeof(space)};
    struct sigaction action = {0};
    const long page = sysconf(_SC_PAGESIZE);

    watch.subject = s;
    watch.page = page > 0 ? (size_t)page : 4096;
    sigaltstack(&stack, NULL);
    action.sa_sigaction = trap;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK;
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof(signals) / sizeof(signals[0]); i++)
        sigaction(signals[i], &action, NULL);
}

void watch_particles(struct watched *w)
{
    if (watch.n_watched < MOST)
        watch.watched[watch.n_watched++] = w;
}

void *watch_memory(size_t bytes, const char *what)
{
    /* Structs and numbers of up to 8 bytes: the end of the last stands at the page. */
    const size_t whole = (bytes + 7) / 8 * 8;
    const size_t pages = (whole + watch.page - 1) / watch.page * watch.page;
    char *data =
        mmap(NULL, pages + watch.page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);

    if (data == MAP_FAILED || mprotect(data + pages, watch.page, PROT_NONE))
        return NULL;
    if (watch.n_piece < MOST)
        watch.piece[watch.n_piece++] =
            (struct piece){data, data + pages - whole, (uintptr_t)(data + pages), what};
    return data + pages - whole;
}

static struct piece *piece_of(const void *memory)
{
    for (size_t i = 0; memory && i < watch.n_piece; i++)
        if (watch.piece[i].data == memory)
            return &watch.piece[i];
    return NULL;
}

void watch_release(const void *memory)
{
    struct piece *p = piece_of(memory);

    if (!p)
        return;
    munmap(p->pages, p->end - (uintptr_t)p->pages + watch.page);
    *p = watch.piece[--watch.n_piece];
}

void watch_seal(const void *memory)
{
    const struct piece *p = piece_of(memory);

    if (p && p->end > (uintptr_t)p->pages)
        mprotect(p->pages, p->end - (uintptr_t)p->pages, PROT_READ);
}
