/* scene/expression.h -- expressions of x, y, z, r (and t, and the parameters given) by muparser. */
#ifndef SCENE_EXPRESSION_H
#define SCENE_EXPRESSION_H

#include "base/error.h"
#include <stddef.h>

struct expression;

/* Compiles `text` with variables named names[0..n). "&", "|" are and, or; "?:" works. On error the
 * sentence quotes the text and the column in it. */
int expression_new(struct expression **out, const char *text, const char *const *names, size_t n, struct error *e);
void expression_free(struct expression *x);
/* Value at the given variables. [one thread per expression] */
double expression_at(struct expression *x, const double *values);

#endif
