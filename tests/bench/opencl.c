/* opencl.c -- what sweeps cost on an OpenCL device that is a processor (PoCL), beside the native ones on the same
 * core: the passes of an evaluation, each in turn natively and there, in one thread; the quickest of all rounds is
 * shown, which company disturbs least. A program of bars: at most 1.2 times the native pass. Exit status 77 without
 * a device.
 *   opencl [PARTICLES [ROUNDS]] */
#include "config.h"

#include "../unit/on_device.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

/* Of a stage: the quickest so far. */
struct quickest {
    double native, device;
    uint64_t pairs; /* of one round */
};

static double device_seconds(struct on_device *o)
{
    size_t n;
    const struct device_time *t = device_times(o->d, &n);
    double sum = 0.0;

    for (size_t i = 0; i < n; i++)
        if (strchr(t[i].name, '(')) /* kernels of stages: the arrays' names */
            sum += t[i].seconds;
    return sum;
}

static void add(const struct on_device *o, const struct stage *s, double *seconds, uint64_t *pairs)
{
    for (size_t k = 0; k < s->n; k++) {
        *seconds += o->plan.pass[s->pass[k]].seconds;
        *pairs += o->plan.pass[s->pass[k]].pairs;
    }
}

static int turn(struct on_device *o, struct quickest *q, struct error *e)
{
    double *before = calloc(2 * o->n_stage + 1, sizeof(*before));
    uint64_t *pairs = calloc(o->n_stage + 1, sizeof(*pairs));
    int status = before && pairs ? 0 : error_memory(e, "times", o->n_stage);

    for (size_t k = 0; !status && k < o->n_stage; k++)
        add(o, &o->stage[k], &before[k], &pairs[k]);
    if (!status)
        status = run_passes(&o->run, MOMENT_EVALUATE, e);
    for (size_t k = 0; !status && k < o->n_stage; k++) {
        double seconds = -before[k], begin = device_seconds(o);
        uint64_t all = 0;
        add(o, &o->stage[k], &seconds, &all);
        status = on_device_stage(o, k, e);
        const double device = device_seconds(o) - begin;
        q[k].native = fmin(q[k].native, seconds);
        q[k].device = fmin(q[k].device, device);
        q[k].pairs = all - pairs[k];
    }
    free(before);
    free(pairs);
    return status;
}

static void show(const struct on_device *o, const struct quickest *q, const char *what, int *missed)
{
    for (size_t k = 0; k < o->n_stage; k++) {
        const struct stage *s = &o->stage[k];
        if (!q[k].pairs)
            continue;
        const double ratio = q[k].device / q[k].native;
        *missed += !(ratio <= BAR);
        printf("%-15s %-20s %7.3f %7.3f  %5.2f  %s\n", what,
               o->plan.pass[s->pass[s->n_head]].step, 1e9 * q[k].native / (double)q[k].pairs,
               1e9 * q[k].device / (double)q[k].pairs, ratio, ratio <= BAR ? "OK" : "MISS");
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
    int status = on_device_open(&o, number, text, precision, 1, true, e);
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
        status =
            measure(number, k / 4, 2 + k % 2, precision[k / 2 % 2], n, rounds, &missed, &e);
    if (status)
        fprintf(stderr, "%s\n", e.text);
    else
        printf("%d of them cost more than %g times the native pass\n", missed, BAR);
    return status ? 1 : 0;
}
