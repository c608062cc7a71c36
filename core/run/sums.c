/* run/sums.c -- see run/sums.h. Touches nothing but its sums. */
#include "run/sums.h"
#include "run/domain.h"
#include <stdlib.h>

int sums_open(struct sums *s, const struct run *r, size_t n, struct error *e)
{
    *s = (struct sums){.n = n, .value = calloc(n + 1, sizeof *s->value)};
    if (r->plan->strict)
        s->exact = calloc(n + 1, sizeof *s->exact);
    return s->value && (s->exact || !r->plan->strict)
               ? 0
               : error_memory(e, "sums", n * sizeof *s->exact);
}

void sums_close(struct sums *s)
{
    free(s->value);
    free(s->exact);
    *s = (struct sums){0};
}

int sums_share(struct sums *s, const struct run *r, struct error *e)
{
    if (s->exact) {
        if (run_share_exact(r, s->exact, s->n, e))
            return -1;
        for (size_t k = 0; k < s->n; k++)
            s->value[k] = exact_value(&s->exact[k]);
        return 0;
    }
    uint32_t *op = malloc((s->n + 1) * sizeof *op);
    if (!op)
        return error_memory(e, "sums", s->n * sizeof *op);
    for (size_t k = 0; k < s->n; k++)
        op[k] = SPH_REDUCE_SUM;
    const int status = run_share_numbers(r, s->value, op, s->n, e);
    free(op);
    return status;
}
