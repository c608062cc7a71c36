/* scene/expression.h -- expressions of x, y, z, r (and t, and the parameters given) by muparser. */
#ifndef SCENE_EXPRESSION_H
#define SCENE_EXPRESSION_H

#include "base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define EXPRESSION_BYTES 4000
#define EXPRESSION_NAMES 64 /* most that expression_c knows */

struct expression;

/* Compiles `text` with variables named names[0..n). Beside muparser's own operators and functions:
 * "&" and "|" are and, or; "!" is not; "?:" works; "pi" is known; "=" is refused. On error the
 * sentence quotes the text and the column in it. */
int expression_new(struct expression **out, const char *text, const char *const *names, size_t n,
                   struct error *e);
void expression_free(struct expression *x);
/* Value at the given variables; NaN if it has none. [one thread per expression] */
double expression_at(struct expression *x, const double *values);
/* Whether the expression names variable i. */
bool expression_uses(const struct expression *x, size_t i);

/* The same in OpenCL C: an expression in doubles, every name behind `prefix`. names: those
 * that x was made with. In fresh memory; NULL: it is one that cannot be told so, by anything that this here does not
 * understand just as the parser does. */
char *expression_c(struct expression *x, const char *text, const char *const *names, size_t n,
                   const char *prefix);

#endif
