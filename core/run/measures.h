/* run/measures.h -- when a run is measured, and where that is written: errors.csv, probe_NAME.csv,
 * profile_NAME.csv, summary.json.
 *
 * Each measure is taken at the start, at the end, and on the way at the first step at or after each of its
 * moments; no step is cut for it, and the row has the step's own time. (Comparisons: not at the start, unless a
 * moment says so.) What is measured is what a snapshot would hold then: places and what else is integrated are
 * of that time; what functions derive is from the step's last evaluation, which some integrators make in
 * mid-step. At the end all is of the end. Nothing of the run is changed. Of several ranks all take what is due, and
 * have the values; the first alone has files and the summary. */
#ifndef RUN_MEASURES_H
#define RUN_MEASURES_H

#include "io/csv.h"
#include "io/output.h"
#include "io/summary.h"
#include "run/run.h"

/* One measure's moments and file. */
struct series {
    const struct scene_moments *when;
    uint64_t last;  /* the step of its last rows; UINT64_MAX: none */
    uint64_t next;  /* begin + next * every is the next */
    size_t next_at; /* of those listed */
    bool on_file;
    char *file; /* its name */
    struct csv csv;
};

/* Errors of one comparison. */
struct measured_errors {
    struct summary_error *error;
    size_t n;
    bool taken;
};

struct measures {
    struct run *run;
    const struct output *out;
    double begin, end;
    bool any;
    struct series *compare, *probe, *profile;
    struct csv errors;
    struct measured_errors *errors_of; /* [compare] */
    double **value;                    /* [probe]: as they were last; see sample_take */
    const char ***name;                /* [probe]: of the values at points, "sum" among them */
    /* What the summary points to, after the end. */
    struct summary_error *error;
    struct summary_probe *probe_end;
    struct summary_profile *profile_end;
    size_t n_error;
};

enum measures_moment { MEASURES_START, MEASURES_ON_THE_WAY, MEASURES_END };

/* Opens the files. resumed: the run stands at a step of which nothing was written yet: rows of that step and
 * later ones are cut off from files that are there, and the step's own are due again. */
int measures_open(struct measures *m, struct run *r, const struct output *out, bool resumed,
                  struct error *e);
/* measures_restore.c: for a run that goes on, what errors.csv holds of tables whose time has passed. */
int measures_restore(struct measures *m, struct error *e);
/* Whether there is anything to take of the step that has just been made; if so, settle the run and take it. */
bool measures_due(const struct measures *m);
int measures_take(struct measures *m, enum measures_moment moment, struct error *e);
/* After the end was taken: into the summary, which points into the measures. */
void measures_summary(const struct measures *m, struct summary *s);
/* What was written is on disk. */
int measures_sync(struct measures *m, struct error *e);
int measures_close(struct measures *m, struct error *e);
void measures_free(struct measures *m);

#endif
