/* opencl.c -- what sweeps cost on an OpenCL device that is a processor (PoCL), beside the native ones on the same
 * core: the passes of an evaluation, each in turn natively and there, in one thread; the least processor time of all
 * rounds is shown, which company disturbs least. A program of bars: at most 1.2 times the native pass. Exit status
 * 77 without a device.
 *   opencl [PARTICLES [ROUNDS]] */
#include "config.h"

#include "../unit/on_device.h"
#include "run/chunks.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define BAR 1.2

static const char *const scheme[] = {
    "'plugins':['kernels','eos','wcsph'],'materials':{'w':{'eos':{'name':'tait','rho0':1,'c0':10}}},"
    "'scheme':{'name':'wcsph'}",
    "'plugins':['kernels','eos','gsph'],'materials':{'w':{'eos':{'name':'ideal-gas','gamma':1.4}}},"
    "'scheme':{'name':'gsph'}",
};
static const char *const fields[] = {"'rho':'1 + 0.01 * x','h':'1.3 * spacing'",
                                     "'rho':1,'p':'1 + 0.2 * x'"};
static const char *const scheme_name[] = {"wcsph", "gsph"};

static void scene_of(char *text, size_t size, int which, int dim, int n)
{
    static const char *const box[] = {"'min':[0,0],'max':[1,1]", "'min':[0,0,0],'max':[1,1,1]"};
    static const char *const flow[] = {"['sin(7 * x + y)','cos(5 * x - y)']",
                                       "['sin(7 * x + y)','cos(5 * x - y)','sin(9 * z - x)']"};

    snprintf(text, size,
             "{'dimensions':%d,%s,'domain':{%s},'particles':{'fluid':{'material':'w','fill':{"
             "'lattice':'square','count':%d,'jitter':0.2},'fields':{%s,'v':%s}}},'time':{'end':1}}",
             dim, scheme[which], box[dim - 2], n, fields[which], flow[dim - 2]);
}

/* Of a stage: the least processor time so far. */
struct quickest {
    double native, device;
};

/* Of all threads: OpenCL's do the work there, this one here. */
static double cpu(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int natively(struct on_device *o, const struct stage *s, double *seconds, struct error *e)
{
    const uint64_t n = o->plan.array[s->array].p.n;
    const size_t chunks = (n + CHUNK - 1) / CHUNK;
    struct ranges all = {.first = calloc(2 * chunks + 1, sizeof(uint64_t)), .n = chunks};
    int status = all.first ? 0 : error_memory(e, "ranges", chunks);

    all.count = all.first + chunks;
    for (size_t k = 0; !status && k < chunks; k++) {
        all.first[k] = k * CHUNK;
        all.count[k] = n - k * CHUNK < CHUNK ? n - k * CHUNK : CHUNK;
    }
    const double begin = cpu();
    for (size_t k = 0; !status && k < s->n; k++)
        status = chunks_run(&o->run, &o->plan.pass[s->pass[k]], &all, e);
    *seconds = cpu() - begin;
    free(all.first);
    return status;
}

/* One sweep of each stage. */
static int turn(struct on_device *o, struct quickest *q, struct error *e)
{
    const struct kernel_now now = on_device_now(o);

    for (size_t k = 0; k < o->n_stage; k++) {
        double native;
        if (natively(o, &o->stage[k], &native, e))
            return -1;
        const double begin = cpu();
        if (kernels_launch(o->kernels, k, o->arena, o->list, &now, e) || device_finish(o->d, e))
            return -1;
        q[k].device = fmin(q[k].device, cpu() - begin);
        q[k].native = fmin(q[k].native, native);
    }
    return 0;
}

static void show(const struct on_device *o, const struct quickest *q, const char *what, int *missed)
{
    for (size_t k = 0; k < o->n_stage; k++) {
        const struct stage *s = &o->stage[k];
        const struct pass *p = &o->plan.pass[s->pass[s->n_head < s->n ? s->n_head : 0]];
        const struct group_list *list = &o->run.list[p->n_src ? p->list[0] : 0];
        const double pairs = list->true_share * (double)list->n_entry;
        if (s->n_head == s->n)
            continue;
        const double ratio = q[k].device / q[k].native;
        *missed += !(ratio <= BAR);
        printf("%-15s %-20s %7.3f %7.3f  %5.2f  %s\n", what, p->step, 1e9 * q[k].native / pairs,
               1e9 * q[k].device / pairs, ratio, ratio <= BAR ? "OK" : "MISS");
    }
}

static int measure(size_t number, int which, int dim, const char *precision, int n, int rounds,
                   int *missed, struct error *e)
{
    struct on_device o;
    struct quickest *q = NULL;
    char text[4096], what[64];

    scene_of(text, sizeof(text), which, dim, n);
    snprintf(what, sizeof(what), "%s %dD %s", scheme_name[which], dim, precision);
    const struct on_device_as as = {text, precision, 1, true, true, NULL};
    int status = on_device_open(&o, number, &as, e);
    if (!status)
        q = calloc(o.n_stage + 1, sizeof(*q));
    for (size_t k = 0; q && k < o.n_stage; k++)
        q[k].native = q[k].device = INFINITY;
    if (!status)
        status = q ? on_device_put(&o, e) : error_memory(e, "times", 1);
    for (int k = 0; !status && k < rounds; k++)
        status = turn(&o, q, e);
    if (!status)
        show(&o, q, what, missed);
    free(q);
    on_device_close(&o);
    return status;
}

int main(int argc, char **argv)
{
    const int n = argc > 1 ? atoi(argv[1]) : 60000, rounds = argc > 2 ? atoi(argv[2]) : 15;
    static const char *const precision[] = {"double", "mixed"};
    struct error e = {0};
    size_t number;
    int missed = 0, status = 0;

    setenv("POCL_MAX_PTHREAD_COUNT", "1", 0);
    if (!on_device_there(&number, &e)) {
        printf("%s\n", e.text);
        return 77;
    }
    printf("ns a pair, %d particles, one thread    native  device  ratio\n", n);
    for (int k = 0; !status && k < 8; k++)
        status = measure(number, k / 4, 2 + k % 2, precision[k / 2 % 2], n, rounds, &missed, &e);
    if (status)
        fprintf(stderr, "%s\n", e.text);
    else
        printf("%d of them cost more than %g times the native pass\n", missed, BAR);
    return status ? 1 : 0;
}
