/* run/run.h -- a plan in motion: neighbour lists and ghosts kept right, passes executed, columns
 * advanced. Data flows one way: the loop (loop.c) calls advance.c, which calls passes.c, which
 * calls lists.c. */
#ifndef RUN_RUN_H
#define RUN_RUN_H

#include "domain/sides.h"
#include "neighbours/skin.h"
#include "neighbours/visit.h"
#include "plan/plan.h"
#include "registry/extension.h"
#include <math.h>

struct audit;
struct watch;
struct run_device;
struct run_domain;

/* Sums over all real particles. */
struct totals {
    double mass, kinetic, internal, potential;
    double momentum[3], angular[3]; /* scales: sums of absolute values, for relative drifts */
    double momentum_scale, angular_scale;
    bool has_energy;
};

struct run_cost {
    double loop, neighbour, integrate, io;
    uint64_t particle_updates, pairs, list_builds, sorts, unfinished, created;
};

enum { MIRROR_FRESH, MIRROR_OLD, MIRROR_GHOSTS_OLD };

struct run {
    struct plan *plan;
    int threads;
    uint32_t path; /* how pair loops run: SPH_PATH_... */
    double skin;
    double time, dt, dt_bound; /* dt_bound: what the reductions allow, before cfl */
    uint64_t step;
    /* lists.c */
    struct ghosts *ghosts;   /* [array] */
    struct group_list *list; /* [plan->n_list] */
    struct visits *visits;   /* [array]: the order of sums, if it is strict */
    struct skin *kept; /* [frame * n_array + k]: of the frame's k-th array, when lists were made */
    struct cloud *cloud;        /* [array]: room for clouds */
    struct skin_change *change; /* [array]: of places since then, if has_change: seen in passing */
    bool *has_change;
    bool *frame_made; /* [frame]: the lists of frames but 0 are made when a pass asks for them */
    bool *frozen;     /* [frame]: the copies of a frozen one are made */
    bool **stale;     /* [array][column]: ghosts hold old values */
    uint8_t **mirror_old;      /* [array][column]: the mirror does: MIRROR_... */
    double centre[3], quantum; /* of positions' mirrors: x = centre + quantum * a whole number */
    bool h_fixed;              /* no pass and no rate changes any h */
    double **wide_h;           /* [array]: of h held in floats, in doubles while lists are made */
    double *h_low, *h_high;    /* [array]: range of h when the lists were made, ghosts included */
    bool lists_made,
        lists_suspect; /* suspect: something moved or grew since they were last checked */
    uint64_t builds_since_sort;
    double *reduced;      /* [reduction]: last value; NaN before the first */
    struct sph_run hooks; /* what a batch's `run` points to */
    double proposed;      /* bound on the next dt, cfl not applied; INFINITY: none */
    struct run_cost cost;
    struct run_device *device; /* device.h; NULL: on the processor */
    struct run_domain *domain; /* domain.h; NULL: on one rank */
    struct audit *audit;       /* NULL: off */
    struct watch *watch;       /* watch.h */
    bool look;                 /* all that passes write in this step is looked at: finite.c */
    bool suspect;              /* a rate may be no number */
    /* advance.c */
    double correct; /* while a correction follows the evaluation: its factor; else 0 */
    bool defer;     /* the next step may do what is left of this one: run_settle */
    size_t left;    /* operations left, from the table's end; dt: left_dt */
    double left_dt;
    const struct op *op; /* the step's table: the integrator's, or what is adapted to this step */
    struct op adapted[OPS_MAX];
    double
        dt_last; /* of the step before; 0: there was none. Part of the state, where a table is adapted */
};

int run_init(struct run *r, struct plan *plan, int threads, uint32_t path, bool audit,
             struct error *e);
void run_free(struct run *r);
/* Before it, and before any file is written: the device can take the run, if it is to be on one. */
int run_check(const struct plan *plan, uint32_t path, bool audit, struct error *e);
/* Whether the run's device has failed; *lost: nothing comes back from it. */
bool run_device_failed(const struct run *r, bool *lost);
/* run_store.c: all that the next step builds on goes into a checkpoint or comes out of it, as it is. Reading:
 * into a run that has just been initialised. */
int run_store(struct run *r, struct store *s, struct error *e);
/* Writing: what there is to look at of a run that failed, in the midst of anything: particles and numbers; no
 * lists, which may be half made, and no plugins' states. */
int run_store_failed(struct run *r, struct store *s, struct error *e);

/* lists.c. At the start of an evaluation: sorts, makes ghosts and lists if they are no longer
 * right. In its midst (`within`): only ghosts and lists, since other columns hold results
 * already. */
int run_lists(struct run *r, bool within, struct error *e);
/* The lists of another frame than that of positions are there, and right. */
int run_frame(struct run *r, size_t frame, struct error *e);
/* What has changed of n particles from `first` on, a multiple of SKIN_PIECE, since the lists of positions were
 * made; they stand at x[component] now. */
struct skin_change run_change(const struct run *r, size_t array, size_t first, size_t n,
                              const double *const *x);
/* Ghosts of this column get their parents' values, if they hold old ones. */
int run_refresh(struct run *r, size_t array, int column, struct error *e);
/* The same, on several ranks with the next run_domain_begin: together with others that are asked for. */
int run_refresh_ask(struct run *r, size_t array, int column, struct error *e);
/* The places of an array's real particles in a frame. */
struct cloud run_cloud(const struct run *r, size_t array, size_t frame);
/* A column was written: what copies it is old. */
static inline void run_changed(struct run *r, size_t array, int column)
{
    r->stale[array][column] = r->domain || r->plan->array[array].p.n_ghost > 0;
    r->mirror_old[array][column] = MIRROR_OLD;
    if (column == r->plan->array[array].position || column == r->plan->array[array].smoothing)
        r->has_change[array] = false;
}

/* Bytes held beside the particles' columns. */
struct run_memory {
    size_t lists, places, ghosts,
        search; /* places: when they were made; search: while they are made */
};
struct run_memory run_memory(const struct run *r);

/* mirrors.c: a column's copy in 4 bytes is brought up to date, ghosts included; of a column that has
 * none, nothing is done. Refresh ghosts first. */
int run_mirror(struct run *r, size_t array, int column, struct error *e);
/* mirrors.c: the frame of positions' mirrors, for the places that all arrays have now; fails where
 * floats would not tell particles apart. */
int run_mirror_frame(struct run *r, double margin, struct error *e);

/* The same for places between low and high, of real particles and ghosts. */
int run_mirror_frame_of(struct run *r, const double *low, const double *high, struct error *e);

/* mirrors.c: of n positions' component k from `first` on; false: some have no place in the frame. */
bool mirror_places(const struct run *r, const struct column *c, uint32_t k, size_t first, size_t n);

/* reduce.c: a reduction of its column as it is now, over all ranks. */
bool reduced_exactly(const struct plan *plan, const struct reduction *d);
int run_reduce(const struct run *r, const struct reduction *d, double *out, struct error *e);
/* reduce.c: over particles [first, end); mass NULL: not weighted. */
double reduce_range(const struct column *value, const struct column *mass, uint32_t op,
                    size_t first, size_t end);

/* Two values of one reduction, over different particles. A NaN comes through. */
static inline double reduction_merge(uint32_t op, double a, double b)
{
    if (op == SPH_REDUCE_SUM || isnan(a) || isnan(b))
        return a + b;
    return op == SPH_REDUCE_MIN ? fmin(a, b) : fmax(a, b);
}

/* passes.c. All passes of a moment, in order. */
int run_passes(struct run *r, enum moment moment, struct error *e);

/* passes.c. dt_bound of what reductions have come to. */
void run_bound_dt(struct run *r);

/* passes.c. A batch of all particles of an array (use_batch) in this moment of the run. */
sph_batch run_batch(const struct run *r, const struct use *u, const sph_column *dst,
                    uint32_t n_columns, uint64_t n);

/* population.c. Removes and creates what functions have asked for at the end of a step. */
int run_population(struct run *r, struct error *e);

/* advance.c. One step of the integrator with dt = r->dt. With r->defer, and if no pass follows, what comes
 * after its last evaluation is left for the next step to do, which has the particles in its hands anyway. */
int run_advance(struct run *r, struct error *e);
/* advance.c. Does what was left, if anything: before anybody looks at the state. */
int run_settle(struct run *r, struct error *e);
/* run.c. The host's columns are what the run's are, wherever that is; run_look: settled besides. */
int run_fetch(struct run *r, struct error *e);
int run_look(struct run *r, struct error *e);

/* finite.c: each fails (EXIT_RUN) naming pass, property, particle and place. What a pass has
 * just written (working storage aside, which may hold anything) is a number. */
int finite_pass(const struct run *r, const struct pass *p, struct error *e);
/* ... after all passes of its moment. */
int finite_pass_late(const struct run *r, const struct pass *p, struct error *e);
/* After an evaluation, by all ranks: all rates are finite. */
int finite_rates(struct run *r, struct error *e);
/* When something else is no number, by all ranks: the first pass of which something is. 0: there is none. */
int finite_trace(const struct run *r, struct error *e);

/* finite.c: the last pass of an evaluation that writes a column. */
const char *finite_writer(const struct run *r, size_t array, int column);

/* finite.c: no later pass of the moment writes the column as well: what stands there stays;
 * with `sums` one may add to it. */
bool finite_finished(const struct run *r, const struct pass *p, size_t array, int column,
                     bool sums);

/* finite.c: is one of n numbers not finite? */
bool any_not_finite(const double *value, size_t n);
bool any_not_finite4(const float *value, size_t n);

/* totals.c */
int run_totals(struct run *r, struct totals *t, struct error *e);
/* Where a reduction of this use is summed up; NULL: nowhere. */
static inline double *totals_of(struct totals *t, uint32_t use)
{
    return use == SPH_USE_INTERNAL ? &t->internal : use == SPH_USE_POTENTIAL ? &t->potential : NULL;
}

/* audit.c: proves that passes touch only what they declare. */
int audit_open(struct run *r, struct error *e);
void audit_close(struct run *r);
void audit_begin(struct run *r, const struct pass *p);
int audit_end(struct run *r, const struct pass *p, struct error *e);

#endif
