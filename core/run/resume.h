/* run/resume.h -- a checkpoint to go on from: found, opened, held against the scene that it is to go on with.
 * What of a run is in it: run_store.c and loop_checkpoint.c. */
#ifndef RUN_RESUME_H
#define RUN_RESUME_H

#include "io/checkpoint.h"
#include "plan/plan.h"

/* What a checkpoint tells of where it comes from. */
struct origin {
    char *version;    /* of sph */
    char *scene;      /* its text, as it stood in the file */
    char *scene_path; /* where that was */
    char **set;       /* [n_set] --set, in their order */
    size_t n_set;
    char *plugins;          /* a line each: name, tab, version */
    char *precision;        /* as the plan had it */
    char *processor;        /* what of its instructions changes last bits */
    char *device;           /* "cpu" or "opencl" */
    uint64_t path;          /* how pair loops ran: SPH_PATH_... */
    uint64_t ranks, strict; /* so many wrote it; the order of sums was strict */
};

struct resume {
    struct checkpoint file; /* open */
    char *path;
    struct origin origin;
};

/* What the state of a failed run tells of the failure. */
struct resume_failure {
    char *cause; /* a key of "watch"; NULL: another failure */
    char *reason;
    uint64_t step;
    double time;
};

/* Into a checkpoint or out of it: only a failed one has it. */
bool resume_has_failed(struct store *s);
int resume_failure_store(struct resume_failure *f, struct store *s, struct error *e);
void resume_failure_free(struct resume_failure *f);

/* Into a checkpoint or out of it. */
int origin_store(struct origin *o, struct store *s, struct error *e);
int origin_make(struct origin *o, const struct plan *plan, uint32_t path, uint64_t ranks,
                const char *scene_path, struct error *e);
void origin_free(struct origin *o);

/* `what`: a file; or "latest": the newest good one in `dir`, broken ones before it told on stderr. */
int resume_open(struct resume *r, const char *what, const char *dir, struct error *e);
/* The same, and all ranks call it: the first looks, and all open what it has found. */
int resume_open_together(struct resume *r, const char *what, const char *dir, struct error *e);
/* Nothing on zeros. */
void resume_close(struct resume *r);
/* The scene, precision, plugins are such that the run goes on with the same bits. */
int resume_check(const struct resume *r, const struct plan *plan, uint32_t path, struct error *e);
/* Whether the checkpoint stands in this folder: then its results go on; else they begin anew. */
bool resume_is_in(const struct resume *r, const char *dir);
/* The folder that a file stands in, in fresh memory. */
char *resume_folder(const char *file);

#endif
