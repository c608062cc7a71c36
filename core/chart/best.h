/* chart/best.h -- the cheapest run that is good enough, and its scene. */
#ifndef CHART_BEST_H
#define CHART_BEST_H

#include "chart/results.h"
#include <stdio.h>

/* Prints the finished runs with an error of at most `tolerance`, the cheapest in core-seconds first,
 * and the command that runs the first; *best is its index. Where there is none the error names the
 * nearest (exit code 1). */
int best_print(const struct chart *c, const struct results *s, double tolerance,
               const char *scene_path, FILE *out, size_t *best, struct error *e);

/* The scene of a run, whole: all settings in it but the options, its files by absolute paths. Fresh;
 * NULL when out of memory. */
char *best_scene(const struct chart *c, const struct chart_run *r, struct error *e);

#endif
