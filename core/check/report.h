/* check/report.h -- verdicts: kept in order, printed as lines or as a JSON array, counted. */
#ifndef CHECK_REPORT_H
#define CHECK_REPORT_H

#include "base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum verdict { VERDICT_OK, VERDICT_FAIL, VERDICT_NOTE, VERDICT_COUNT };

/* One line. All strings are copies. */
struct line {
    enum verdict verdict;
    char *kind, *item, *check, *text;
};

struct report {
    struct line *line;
    size_t n, count[VERDICT_COUNT];
    bool print, quiet; /* print each line as it comes; only failures of them */
};

/* Adds a line, and prints it if the report does so. kind: "kernel", "plugin", ...; check: the name
 * of the check that says so. */
int report_add(struct report *r, enum verdict v, const char *kind, const char *item,
               const char *check, const char *text, struct error *e);
void report_free(struct report *r);

/* "12 verdicts: 10 ok, 1 failed, 1 note" */
void report_count(const struct report *r, FILE *out);
int report_json(const struct report *r, FILE *out, struct error *e);

#endif
