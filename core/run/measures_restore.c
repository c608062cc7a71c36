/* run/measures_restore.c -- a run that goes on from an earlier state has its comparisons with tables for one time
 * behind it: what came of them stands in errors.csv. Reads that file. */
#include "base/text.h"
#include "io/cells.h"
#include "run/measures.h"
#include "run/report.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The columns of errors.csv (measures.c: errors_head). */
enum { TIME = 1, COMPARE, ARRAY, FIELD, REFERENCE, L1, L1_REL, L2, L2_REL, LINF, N, OUTSIDE, AT };

static int add(struct measured_errors *to, const struct scene_compare *c, char *const *cell,
               int dim, struct error *e)
{
    struct summary_error *bigger = realloc(to->error, (to->n + 1) * sizeof *bigger);
    if (!bigger)
        return error_memory(e, "errors", (to->n + 1) * sizeof *bigger);
    to->error = bigger;
    bigger[to->n] = (struct summary_error){.field = text_format("%s.%s", c->array, cell[FIELD]),
                                           .reference = plan_table_source(c->table),
                                           .array = c->array,
                                           .l1 = strtod(cell[L1], NULL),
                                           .l1_rel = strtod(cell[L1_REL], NULL),
                                           .l2 = strtod(cell[L2], NULL),
                                           .l2_rel = strtod(cell[L2_REL], NULL),
                                           .linf = strtod(cell[LINF], NULL),
                                           .linf_at = {NAN, NAN, NAN},
                                           .time = strtod(cell[TIME], NULL),
                                           .n = strtoull(cell[N], NULL, 10),
                                           .outside = strtoull(cell[OUTSIDE], NULL, 10)};
    for (int k = 0; k < dim; k++)
        bigger[to->n].linf_at[k] = strtod(cell[AT + k], NULL);
    if (!bigger[to->n].field)
        return error_memory(e, "errors", 1);
    to->n++;
    to->taken = true;
    return 0;
}

int measures_restore(struct measures *m, struct error *e)
{
    const struct scene *s = m->run->plan->scene;
    const size_t dim = (size_t)m->run->plan->dim;
    struct cells t;
    int status = 0;
    if (!m->errors.path)
        return 0;
    if (cells_read(&t, m->errors.path, e))
        return -1;
    for (size_t row = 0; !status && t.n_column == AT + dim && row < t.n_row; row++) {
        char *const *cell = t.cell + row * t.n_column;
        char *end;
        const size_t i = strtoul(cell[COMPARE], &end, 10);
        const struct scene_compare *c = i < s->n_compare && !*end ? &s->compare[i] : NULL;
        /* Of this scene, and behind the run: else it is compared when its time comes. */
        if (c && !isnan(c->time) && m->compare[i].next_at > 0 &&
            strcmp(cell[ARRAY], c->array) == 0 &&
            strcmp(cell[REFERENCE], plan_table_source(c->table)) == 0)
            status = add(&m->errors_of[i], c, cell, (int)dim, e);
    }
    cells_free(&t);
    return status;
}
