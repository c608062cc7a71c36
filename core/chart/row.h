/* chart/row.h -- the result of one run: a row of results.csv. */
#ifndef CHART_ROW_H
#define CHART_ROW_H

#include "chart/chart.h"

enum row_number {
    ROW_PARTICLES,
    ROW_STEPS,
    ROW_TIME,
    ROW_CORE_SECONDS,
    ROW_WALL,
    ROW_UPDATES,
    ROW_PAIRS,
    ROW_BYTES_PER_PARTICLE,
    ROW_PEAK_RSS,
    ROW_NS_PER_PAIR,
    ROW_ENERGY_DRIFT,
    ROW_NUMBERS
};
extern const char *const row_number_name[ROW_NUMBERS];

struct row_extra {
    char *name; /* "fluid.rho.l1", "probe.NAME" */
    double value;
};

/* How a run ended, in one word, which pictures show as it is. "done": it has an error to show. */
enum row_status {
    ROW_DONE,
    ROW_UNSTABLE, /* it ended, with an error or a drift beyond the chart's bounds */
    ROW_NAN,
    ROW_DT,      /* its time step collapsed */
    ROW_RHO,     /* a density fell to 0 or below ... */
    ROW_U,       /* ... an internal energy below */
    ROW_ESCAPED, /* a particle left for good */
    ROW_ENERGY,  /* the energy ran away */
    ROW_CROWD,   /* a particle had too many neighbours */
    ROW_TIMEOUT,
    ROW_CRASH,
    ROW_REFUSED, /* scene, command line or plugin */
    ROW_FAILED,
    ROW_STATUSES
};
extern const char *const row_status_name[ROW_STATUSES];

struct row {
    bool there;
    bool ended; /* the run came to its end: its status follows from its numbers */
    enum row_status status;
    char *reason; /* of what is not done; or NULL */
    double error; /* NaN: none */
    double number[ROW_NUMBERS];
    struct row_extra *extra;
    size_t n_extra;
};

void row_clear(struct row *r);
/* NaN if the row has no such number. */
double row_extra(const struct row *r, const char *name);
int row_set_extra(struct row *r, const char *name, double value, struct error *e);
int row_set_reason(struct row *r, const char *reason, struct error *e);
/* A measure that pictures know: the numbers above, and "bytes" (of all particles). */
double row_measure(const struct row *r, const char *name);
bool row_is_measure(const char *name);
/* The names of all measures; returns how many. */
size_t row_measures(const char *out[ROW_NUMBERS + 1]);

/* The norms of a comparison, as summary.json calls them. */
enum { ROW_NORMS = 5 };
extern const char *const row_norm_name[ROW_NORMS];

/* From a run's summary.json: its numbers, norms and probes, and the chart's error. */
int row_from_summary(const struct chart *c, struct row *r, const cJSON *summary, struct error *e);
/* The chart's error of a row that ended, and from it the status. Fails where the row has no such
 * column. */
int row_assess(const struct chart *c, struct row *r, struct error *e);
/* Whether a run with this status and reason came to its end: read back from results. */
bool row_has_ended(enum row_status status, const char *reason);
/* Whether the row has the column that the chart's error is in, or needs none. */
bool row_is_complete(const struct chart *c, const struct row *r);

#endif
