/* run/device.h -- a run on an OpenCL device: particles, ghosts, lists and passes live there, and what passes.c,
 * advance.c and lists.c do on the processor is done there. The host's columns are copies that are brought up to
 * date when somebody looks at them (run_look). All of run.h's rules hold; only r->device is known elsewhere. */
#ifndef RUN_DEVICE_H
#define RUN_DEVICE_H

#include "opencl/kernels.h"
#include "opencl/look.h"
#include "opencl/ops.h"
#include "opencl/stage_cost.h"
#include "run/run.h"

/* What the device's time is counted to (device_span): the rest (reductions, looks, output); lists, ghosts, order;
 * the integrator; of each stage its kernels and, one further, what they had to have made first. */
enum { SPAN_REST, SPAN_LISTS, SPAN_INTEGRATE, SPAN_STAGES };

/* A stage's, so far. */
struct device_work {
    struct stage_cost cost;
    uint64_t pairs; /* as cost.pairs: once for each pass */
    uint64_t sweeps;
    double flops, bytes;
};

struct run_device {
    struct device *d;
    struct ops *ops;
    struct look *look;
    struct device_search *search;
    struct kernels *kernels;
    struct stage *stage; /* of all moments, one behind the other */
    size_t first[MOMENT_COUNT + 1];
    struct arena *arena;       /* [array] */
    struct ops_ghosts *ghosts; /* [array] */
    struct ops_skin *skin;     /* [frame * n_array + array] */
    struct device_list *list;  /* [plan->n_list] */
    double *share;             /* [plan->n_list]: true pairs per entry, when last counted */
    uint32_t *slot; /* [reduction]: where its result will be; NO_SLOT: nothing is on its way */
    uint32_t n_slot;
    struct device_work *work; /* [stage] */
    double *told;             /* [span]: seconds that are in the run's costs already */
    size_t number;            /* of the device */
    /* On several ranks; device_domain.c. */
    int *taken;             /* [rank]: the number of its device */
    struct ops_sends *send; /* [array] */
    struct ops_skin *met;   /* as skin: when ghosts were found, of frames but 0 */
    struct device_buffer out, in;
    char *packed; /* on the host: what goes, then what comes */
    size_t packed_bytes;
};
#define NO_SLOT UINT32_MAX

int run_device_open(struct run *r, struct error *e);
void run_device_close(struct run *r);

/* run_passes, advance (run.h, advance.c). */
int run_device_passes(struct run *r, enum moment moment, struct error *e);
int run_device_advance(struct run *r, size_t from, size_t to, struct error *e);
/* run_lists, run_frame, run_refresh; device_lists.c. */
int run_device_lists(struct run *r, bool within, struct error *e);
int run_device_frame(struct run *r, size_t frame, struct error *e);
int run_device_refresh(struct run *r, size_t array, int column, struct error *e);

/* run_totals; device_totals.c. */
int run_device_totals(struct run *r, struct totals *t, struct error *e);
/* device_store.c: lists and ghosts into a checkpoint or out of it; of reading, after the host's particles. */
int run_device_store(struct run *r, struct store *s, struct error *e);
/* One column on the host is right; all are. */
int run_device_get(struct run *r, size_t array, int column, struct error *e);
int run_device_fetch(struct run *r, struct error *e);
/* The host's columns were written, or particles came and went: all goes to the device again. */
int run_device_put(struct run *r, struct error *e);
/* A column was written on the device: what copies it is old. */
static inline void run_device_changed(struct run *r, size_t array, int column)
{
    arena_written_here(&r->device->arena[array], column);
    r->stale[array][column] = r->domain || r->device->ghosts[array].n > 0;
    r->mirror_old[array][column] = MIRROR_OLD;
}
/* device_check.c. Which device this rank takes: that of the number given, else one of those like the first, which
 * the ranks of a machine share in turn. */
int run_device_choose(struct run *r, struct error *e);
/* device_domain.c: on several ranks; on one they do nothing. */
int run_device_domain_open(struct run *r, struct error *e);
void run_device_domain_close(struct run *r);
/* Particles go to where their places belong: by the host, which has them all for a while. */
int run_device_move(struct run *r, struct error *e);
/* Ghosts as the host finds them: who they are, places and smoothing lengths. */
int run_device_halo(struct run *r, struct error *e);
/* What was asked for (run_domain_ask) comes from the other ranks. */
int run_device_trade(struct run *r, struct error *e);
/* Adds to a particle's weight its pairs of a list, so many times. */
void run_device_weigh(struct run *r, size_t list, double times, float *weight);
/* device_cost.c. Of each stage; `part` of its destinations took part in a sweep. */
int run_device_cost_open(struct run *r, struct error *e);
void run_device_cost_close(struct run *r);
void run_device_count(struct run *r, size_t stage, double part);
/* The pass that has a stage's time: the first that sweeps, or else the first. What each takes by itself nobody can
 * tell. */
struct pass *run_device_timed(const struct run *r, const struct stage *s);
/* Brings the run's costs and its passes' seconds up to date; waits. */
void run_device_costs(struct run *r);
struct run_memory run_device_memory(const struct run *r);
/* device_report.c: "device" of summary.json; "pass_in": passes and those that have their time. NULL: no memory. */
cJSON *run_device_report(struct run *r);
cJSON *run_device_shared(const struct run *r);
/* What reductions that are on their way came to, and what kernels have found wrong. Waits for the device. */
int run_device_collect(struct run *r, struct error *e);

#endif
