/* chart/results.h -- the results of a chart's runs in one file, OUT/results.csv. */
#ifndef CHART_RESULTS_H
#define CHART_RESULTS_H

#include "chart/row.h"
#include "io/output.h"

#define RESULTS_NAME "results.csv"
#define RESULTS_RUNS "runs" /* folder of the runs' folders, each by its id */

struct results {
    struct row *row; /* [n_run], of the chart's runs in their order */
    size_t n;
};

/* Reads what there is in `dir`; rows of runs that the chart no longer has are left out. A file that is
 * not of a chart is an error. On failure nothing is to be freed. */
int results_read(struct results *s, const struct chart *c, const char *dir, struct error *e);
void results_free(struct results *s);
/* Writes the rows that are there, in the chart's order, whole. */
int results_write(const struct results *s, const struct chart *c, const struct output *o,
                  struct error *e);

/* The summary.json of a run's folder, or NULL if there is none that can be read. */
cJSON *results_summary(const char *dir, const char *id);

/* Whether a summary (or NULL) is of a run that came to its end. */
bool results_is_done(const cJSON *summary);

/* A number as short as it can be read back; "" for none. Returns out. */
const char *results_number(char out[32], double value);

#endif
