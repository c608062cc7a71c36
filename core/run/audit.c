/* run/audit.c -- the audit: while a pass runs, the pages of every column that it has not declared are out of
 * reach, and those that it only reads are read-only; what it must set is filled with a mark beforehand
 * and looked at afterwards. The memory protection catches what a plugin does through pointers kept from
 * elsewhere; the sentence names pass, column and what was tried. Slow: for tests and plugin authors.
 *
 * A signal handler can be given nothing, so the audited run stands in the one mutable global here. */
#include "run/run.h"
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct audit {
    const struct pass *pass;
    struct sigaction before;
};

static struct run *volatile audited;

/* No bit pattern that arithmetic gives: a NaN with a payload of ours. */
static const uint64_t mark = 0x7ff4a0d1700dbeefull;

/* An element of a column that is NULL stands below this address; nothing is ever mapped there. */
#define NULL_REGION ((uintptr_t)1 << 30)

/* What may be done with a column: 0 nothing, 1 read, 2 read and write. */
static int declared(const struct pass *p, size_t array, int column)
{
    if (pass_writes(p, array, column))
        return 2;
    for (uint32_t k = 0; k < p->use.item->props.count; k++)
        if (p->dst.array == array && p->dst.column[k] == column)
            return 1;
    return pass_reads_source(p, array, column) ? 1 : 0;
}

/* While the pass runs the core itself corrects the column, chunk by chunk (closing.h): it cannot be
 * kept from being written. Only in floats; in double nothing is closed, and all is watched. */
static bool is_closed(const struct run *r, const struct pass *p, size_t array, int column)
{
    const struct plan_array *a = &r->plan->array[array];
    for (size_t q = 0; q < a->n_rate; q++)
        if (a->rate[q].property == column && a->rate[q].closed == (size_t)(p - r->plan->pass))
            return true;
    return false;
}

static void trap(int signal_number, siginfo_t *info, void *context)
{
    static const char *const word[] = {"does not declare", "declares only to read",
                                       "may write, but not beyond its end"};
    (void)context;
    struct run *r = audited;
    char line[512] = "";
    for (size_t a = 0; r && r->audit->pass && a < r->plan->n_array; a++) {
        const struct particles *p = &r->plan->array[a].p;
        int c = particles_at_address(p, info->si_addr);
        if (c < 0)
            continue;
        /* snprintf is not promised to be safe here; the process ends either way. */
        snprintf(line, sizeof line, "sph: audit: %s touched \"%s\" of array \"%s\", which it %s\n",
                 r->audit->pass->name, p->column[c].name, p->name,
                 word[declared(r->audit->pass, a, c)]);
        ssize_t written = write(STDERR_FILENO, line, strlen(line));
        (void)written;
        _exit(EXIT_RUN);
    }
    if (r && r->audit->pass && (uintptr_t)info->si_addr < NULL_REGION) {
        snprintf(
            line, sizeof line,
            "sph: audit: %s followed a NULL pointer, such as the sources' column of a property "
            "that it does not declare with SPH_SRC_READ, or in before or after that of one which it "
            "declares with SPH_DST_SWEEP\n",
            r->audit->pass->name);
        ssize_t written = write(STDERR_FILENO, line, strlen(line));
        (void)written;
        _exit(EXIT_RUN);
    }
    /* Not ours: let it end the process as it would have. */
    signal(signal_number, SIG_DFL);
    raise(signal_number);
}

int audit_open(struct run *r, struct error *e)
{
    r->audit = calloc(1, sizeof *r->audit);
    if (!r->audit)
        return error_memory(e, "the audit", sizeof *r->audit);
    struct sigaction action = {0};
    action.sa_sigaction = trap;
    action.sa_flags = SA_SIGINFO;
    sigemptyset(&action.sa_mask);
    audited = r;
    if (sigaction(SIGSEGV, &action, &r->audit->before))
        return error_set(e, EXIT_RUN, "the audit cannot watch memory");
    return 0;
}

void audit_close(struct run *r)
{
    if (!r->audit)
        return;
    sigaction(SIGSEGV, &r->audit->before, NULL);
    audited = NULL;
    free(r->audit);
    r->audit = NULL;
}

/* Set by the pass whatever stood there before, in one go. */
static bool must_set(const struct pass *p, const sph_prop *prop, const struct column *column)
{
    return !p->max_sweeps && (prop->access & SPH_DST_WRITE) && !(prop->access & SPH_DST_READ) &&
           column->size == sizeof mark;
}

void audit_begin(struct run *r, const struct pass *p)
{
    if (!r->audit)
        return;
    const struct particles *dst = &r->plan->array[p->dst.array].p;
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        const struct column *column = &dst->column[p->dst.column[k]];
        if (!must_set(p, list_at(&p->use.item->props, k), column))
            continue;
        for (uint32_t c = 0; c < column->ncomp; c++)
            for (size_t i = 0; i < dst->n; i++)
                memcpy((char *)column->data + (c * column->plane + i) * sizeof mark, &mark,
                       sizeof mark);
    }
    r->audit->pass = p;
    for (size_t a = 0; a < r->plan->n_array; a++) {
        const struct plan_array *pa = &r->plan->array[a];
        bool source = false;
        for (size_t s = 0; s < p->n_src; s++)
            source = source || p->src[s].array == a;
        for (size_t c = 0; c < pa->p.n_column; c++) {
            int access = is_closed(r, p, a, (int)c) ? 2 : declared(p, a, (int)c);
            bool geometry = (int)c == pa->position || (int)c == pa->smoothing;
            if (geometry && p->shape == SPH_PAIR && (source || a == p->dst.array) && !access)
                access = 1;
            particles_guard(&r->plan->array[a].p, (int)c, access);
        }
    }
}

int audit_end(struct run *r, const struct pass *p, struct error *e)
{
    if (!r->audit)
        return 0;
    for (size_t a = 0; a < r->plan->n_array; a++)
        for (size_t c = 0; c < r->plan->array[a].p.n_column; c++)
            particles_guard(&r->plan->array[a].p, (int)c, 2);
    r->audit->pass = NULL;
    const struct particles *dst = &r->plan->array[p->dst.array].p;
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        const struct column *column = &dst->column[p->dst.column[k]];
        if (!must_set(p, prop, column))
            continue;
        for (uint32_t c = 0; c < column->ncomp; c++)
            for (size_t i = 0; i < dst->n; i++)
                if (memcmp((char *)column->data + (c * column->plane + i) * sizeof mark, &mark,
                           sizeof mark) == 0)
                    return error_set(
                        e, EXIT_RUN,
                        "audit: %s declares that it writes \"%s\" but left particle %zu "
                        "of array \"%s\" unset",
                        p->name, column->name, i, dst->name);
    }
    return 0;
}
