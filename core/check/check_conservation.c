/* check/check_conservation.c -- the check `conservation`: of a pair function in an endless box, is
 * the sum of mass times rate of the velocity nothing, and do its results stay when all positions
 * are shifted? Figures, not judgements: not every scheme means to conserve momentum. */
#include "check/checks.h"
#include "check/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct style whole = {"in one piece", 0, false, 1, false, 0, 0};

struct result {
    struct bench *bench;
    struct sweep sweep;
};

static int run(struct result *r, const struct subject *s, const struct pass_spec *spec, int dim,
               double shift, struct error *e)
{
    const struct bench_shape shape = {dim, LAYOUT_REGULAR, 1000, false, shift};

    r->bench = calloc(1, sizeof(*r->bench));
    if (!r->bench)
        return error_memory(e, "a bench", sizeof(*r->bench));
    if (bench_make(r->bench, s, spec, &shape, e) || sweep_begin(&r->sweep, r->bench, e) ||
        sweep_run(&r->sweep, r->bench, &whole, e))
        return -1;
    return r->sweep.status == SPH_OK ? 0 : error_set(e, EXIT_RUN, "%s", r->sweep.reason);
}

static const double *plane(const struct bench *b, const char *name, uint32_t c)
{
    return particles_real(&b->own, name, c);
}

/* The rate of v, as the function declares it. */
static void say_momentum(const struct result *r, const sph_function *f)
{
    const struct bench *b = r->bench;
    const double *m = plane(b, "m", 0);

    for (uint32_t i = 0; m && i < f->rates.count; i++) {
        const sph_rate *rate = list_at(&f->rates, i);
        double scale = 0, most = 0;
        if (rate->kind != SPH_KICK || strcmp(rate->property, "v") != 0)
            continue;
        for (int c = 0; c < b->shape.dim; c++) {
            const double *a = plane(b, rate->rate, (uint32_t)c);
            double sum = 0;
            for (size_t k = 0; a && k < b->own.n; k++) {
                sum += m[k] * a[k];
                scale += fabs(m[k] * a[k]);
            }
            most = fmax(most, fabs(sum));
        }
        if (scale > 0)
            say(b->subject, VERDICT_NOTE,
                "momentum: |sum m %s| is %.1g of sum m |%s| in a closed "
                "box, without walls",
                rate->rate, most / scale, rate->rate);
    }
}

static void say_shift(const struct result *here, const struct result *there)
{
    const struct bench *b = here->bench;
    const char *name = "";
    double worst = 0;

    for (uint32_t k = 0; k < bench_count(b); k++) {
        const struct column *c = bench_column(b, k), *d = bench_column(there->bench, k);
        double largest = 0, change = 0;
        if (!(bench_prop(b, k)->access & BENCH_WRITES) || c->type >= SPH_INT32)
            continue;
        for (size_t e = 0; e < c->ncomp * b->own.n; e++) {
            const size_t at = e / b->own.n * c->plane + e % b->own.n;
            largest = fmax(largest, fabs(((double *)c->data)[at]));
            change = fmax(change, fabs(((double *)c->data)[at] - ((double *)d->data)[at]));
        }
        if (largest > 0 && change / largest > worst) {
            worst = change / largest;
            name = c->name;
        }
    }
    if (worst > 0)
        say(b->subject, VERDICT_NOTE,
            "shifted by 16 boxes, its results change by %.1g of their largest value (\"%s\")",
            worst, name);
}

void check_conservation(const struct subject *s)
{
    const sph_function *f = entry_function(s->entry);
    struct result here = {NULL, {{NULL}, 0, "", NULL, 0, false}}, there = here;
    struct pass_spec spec[2];
    struct use use;
    struct error e = {0};
    int dim = 3;

    while (!subject_works_in(s, dim))
        dim--;
    if (f->shape != SPH_PAIR || subject_configure(s, &use, &e))
        return;
    use_fini(&use, s->registry);
    passes_of(s->entry, spec);
    if (run(&here, s, spec, dim, 0, &e) || run(&there, s, spec, dim, 16, &e))
        return; /* `calls` has said why */
    say_momentum(&here, f);
    say_shift(&here, &there);
}
