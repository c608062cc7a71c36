/* run/watch.h -- signs that a run has gone wrong ("watch" of the scene): looked for, and told with the
 * particle and the pass that they come from, or counted. Reads columns and totals; what it finds is kept
 * in the run's struct watch, for summary.json. On several ranks what is counted is counted over all of them, and
 * each has the counts; a run is stopped by the rank whose particle it is. */
#ifndef RUN_WATCH_H
#define RUN_WATCH_H

#include "run/run.h"

/* What stopped the run, for machines; the sentence is in the error. */
struct failure {
    bool happened;
    enum watch_cause cause;
    const struct plan_array *array; /* NULL: no particle is to blame */
    int64_t particle;
    double x[3];
    char pass[128]; /* the pass that made it, or "integrator", "scene"; "": nobody in particular */
    uint64_t step;
    double time;
};

/* What was counted: particles a step, or events. */
struct watch_count {
    uint64_t n;
    struct failure first; /* happened: there was one */
};

/* A column that is looked at: what a cause says of it. */
struct watched {
    size_t array;
    int column;
    enum watch_cause cause;
    double least;    /* what is below is wrong */
    bool integrated; /* it has a rate */
    bool may_be;     /* it was wrong at the start already, so that it is meant */
};

struct watch {
    const struct scene_watch *scene;
    struct watched *column;
    size_t n_column;
    double low[3], high[3]; /* where a particle has escaped */
    bool bounded;           /* bounds are set */
    bool begun, evaluated;  /* it was looked at; an evaluation was finished */
    bool sorted; /* particles were, in this evaluation: what is derived is not theirs ... */
    size_t done; /* ... unless one of so many passes has made it anew */
    double longest, energy; /* step so far; scale of the energy, 0: not known */
    uint64_t *here; /* [cause * arrays + array]: most particles found at a time in this step */
    struct watch_count count[WATCH_CAUSES];
    struct failure failure;
};

int watch_open(struct run *r, struct error *e);
void watch_close(struct run *r);
/* watch_store.c: into a checkpoint or out of it; of a watch that is open. */
int watch_store(struct run *r, struct store *s, struct error *e);

/* Before an evaluation, while places are as the integrator left them. */
int watch_state(struct run *r, struct error *e);
/* Places: with `all` of arrays that stand in lists, before those are made anew, and particles wrapped; as long as
 * they hold nobody has gone anywhere. Without, of other arrays. What is counted, and a region, is looked
 * at each time. */
int watch_places(struct run *r, bool all, struct error *e);
/* What a pass has just written. */
int watch_pass(struct run *r, const struct pass *p, struct error *e);
/* After list k was made, or was not for its crowd. */
int watch_crowd(struct run *r, size_t k, struct error *e);
/* Lists, ghosts could not be made; if a smoothing length is to blame, that is said in place of what e
 * says. Both return -1. */
int watch_no_lists(struct run *r, struct error *e);
int watch_no_ghosts(struct run *r, struct error *e);
/* Likewise of ghosts that no rank can make, said by the one that has the largest. */
int watch_too_wide(struct run *r, struct error *e);
/* Before ghosts are made for a margin: where they would be many, that nobody has too many neighbours
 * without them. */
int watch_reach(struct run *r, double margin, struct error *e);
/* The step that is to follow, before it is cut to end on time; span: of the whole run. */
int watch_time_step(struct run *r, double dt, double span, struct error *e);
/* Where totals are written. */
int watch_energy(struct run *r, const struct totals *first, const struct totals *now,
                 struct error *e);
/* watch_ranks.c: after a run has failed, all ranks: each knows of the failure, and what is kept of it is sound. */
int watch_share_failure(struct run *r, struct error *e);
/* At the end of a step: what was found in it counts. */
void watch_step(struct run *r);

/* A sign that was found, to be told. */
struct sign {
    enum watch_cause cause;
    const struct plan_array *array; /* NULL: there is no particle to name */
    size_t particle;
    size_t others;      /* of which the same may be said */
    const char *by;     /* as failure.pass */
    const char *column; /* named in the sentence already, or NULL */
    double
        weight; /* of those that ranks have found the largest is told of, of equals that of the smallest id */
};

/* watch_tell.c. Keeps the failure and says "WHAT at x = (..), step .., t = ..; rho = .., ...; likely ..."
 * (EXIT_RUN). Returns -1. */
int watch_fail(const struct run *r, const struct sign *s, struct error *e, const char *what, ...)
    __attribute__((format(printf, 4, 5)));
/* What a failure says of itself but for the sentence. */
struct failure watch_record(const struct run *r, const struct sign *s);
/* A sort carries along what is state; the rest would have been made anew by passes that now never run: if there was
 * one, it becomes NaN. */
void watch_forget(const struct run *r);
/* "pass density(fluid)", "the integrator": the text of failure.pass in a sentence. */
#define WATCH_INTEGRATOR "integrator"
#define WATCH_SCENE "scene"

/* watch_ranks.c. Whether a cause is counted, and the run goes on; together: by several ranks, so that those call
 * watch_count that have found nothing as well. */
bool watch_counts(const struct run *r, enum watch_cause cause);
bool watch_counts_together(const struct run *r, enum watch_cause cause);
/* Of a cause that is counted: n particles of this rank. */
int watch_count(struct run *r, const struct sign *s, uint64_t n, struct error *e);
/* Whose particle the sign is of, which each rank may have found one for. */
enum watch_blame { WATCH_NOBODY, WATCH_OURS, WATCH_THEIRS };
int watch_blame(const struct run *r, const struct sign *s, enum watch_blame *out, struct error *e);
/* One event, that all ranks have seen. */
int watch_count_event(struct run *r, const struct sign *s, enum watch_blame blame, struct error *e);

/* watch.c, for the files watch*.c. */
/* Who made it, in a sentence; of a column, with what the integrator made it of. Both return text. */
const char *watch_made_by(char *text, size_t size, const char *by);
const char *watch_column_made_by(char *text, size_t size, const struct run *r, size_t array,
                                 int column, const char *by);
long long watch_id(const struct plan_array *a, size_t i);
bool watch_has_rate(const struct plan_array *a, int column);

#endif
