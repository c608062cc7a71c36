/* check/check_eos.c -- the check `eos`: over a spread of states the inverse leads back, and the
 * speed of sound is that of the pressure: cs^2 = (dp/drho)_u + p / rho^2 (dp/du)_rho, the
 * derivative at constant entropy (first law: du = p / rho^2 drho). Known by their usual names: rho,
 * u, p, cs. */
#include "check/checks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STEPS 9
#define SOUND_TOLERANCE 1e-6
#define INVERSE_TOLERANCE 1e-9

enum { RHO, U, P, CS, N_KNOWN };
static const char *const known[N_KNOWN] = {"rho", "u", "p", "cs"};

/* One of the two functions, on a bench of a single particle. */
struct evaluator {
    struct bench *bench; /* NULL: there is none */
    double *at[N_KNOWN];
    bool reads[N_KNOWN], writes[N_KNOWN];
};

struct trial {
    const struct subject *subject;
    struct evaluator run, inverse;
    bool from_pressure; /* states are made from p by the inverse */
    bool chosen;        /* the user chose the range */
    bool said_odd, failed;
    size_t states, odd, compared, inverted;
    double sound, back; /* largest errors */
};

static int evaluator_make(struct evaluator *v, const struct subject *s, struct pass_spec *spec,
                          struct error *e)
{
    static const struct bench_shape shape = {0, LAYOUT_CLUSTER, 1, false, 0};
    struct bench_shape here = shape;

    for (here.dim = 1; !subject_works_in(s, here.dim);)
        here.dim++;
    v->bench = calloc(1, sizeof(*v->bench));
    if (!v->bench)
        return error_memory(e, "a bench", sizeof(*v->bench));
    if (bench_make(v->bench, s, spec, &here, e))
        return -1;
    for (uint32_t k = 0; k < bench_count(v->bench); k++)
        for (int i = 0; i < N_KNOWN; i++) {
            const sph_prop *p = bench_prop(v->bench, k);
            if (strcmp(p->name, known[i]) != 0 || p->type != SPH_SCALAR)
                continue;
            v->at[i] = bench_column(v->bench, k)->data;
            v->reads[i] = p->access & SPH_DST_READ;
            v->writes[i] = p->access & SPH_DST_WRITE;
        }
    return 0;
}

/* Calls it on one state: what it reads is taken from `state`, what it writes put there. */
static bool evaluate(const struct trial *t, const struct evaluator *v, double state[N_KNOWN])
{
    sph_batch batch = bench_batch(v->bench);

    batch.count = 1;
    for (int i = 0; i < N_KNOWN; i++)
        if (v->at[i])
            *v->at[i] = v->reads[i] ? state[i] : NAN;
    stage(t->subject, "%s at rho = %g, u = %g, p = %g", v->bench->spec->label, state[RHO], state[U],
          state[P]);
    if (v->bench->spec->run(&batch) != SPH_OK)
        return false;
    for (int i = 0; i < N_KNOWN; i++)
        if (v->writes[i]) {
            state[i] = *v->at[i];
            if (!isfinite(state[i]))
                return false;
        }
    return true;
}

/* -- Speed of sound -------- */

static bool pressure(const struct trial *t, double rho, double u, double *p)
{
    double state[N_KNOWN] = {rho, u, 0, 0};

    if (!evaluate(t, &t->run, state))
        return false;
    *p = state[P];
    return true;
}

/* dp/drho or dp/du by central differences of two widths, the leading error taken out. False where p
 * is not smooth, or not there. */
static bool derivative(const struct trial *t, const double state[N_KNOWN], int by, double *out)
{
    const double step = 1e-3 * (fabs(state[by]) > 0 ? fabs(state[by]) : 1);
    double d[2];

    for (int i = 0; i < 2; i++) {
        const double h = i ? step / 2 : step;
        double low, high;
        if (!pressure(t, state[RHO] - (by == RHO ? h : 0), state[U] - (by == U ? h : 0), &low) ||
            !pressure(t, state[RHO] + (by == RHO ? h : 0), state[U] + (by == U ? h : 0), &high))
            return false;
        d[i] = (high - low) / (2 * h);
    }
    *out = (4 * d[1] - d[0]) / 3;
    return fabs(d[1] - d[0]) <= 1e-2 * (fabs(d[0]) + fabs(d[1])) + 1e-300;
}

static void compare_sound(struct trial *t, const double state[N_KNOWN])
{
    double by_rho, by_u = 0, found, error;
    const double given = state[CS] * state[CS];

    if (!derivative(t, state, RHO, &by_rho) || (t->run.reads[U] && !derivative(t, state, U, &by_u)))
        return;
    found = by_rho + state[P] / (state[RHO] * state[RHO]) * by_u;
    if (!(found > 0)) /* no sound: tension, a limit of the pressure */
        return;
    error = fabs(given - found) / found;
    t->compared++;
    t->sound = fmax(t->sound, error);
    if (error <= SOUND_TOLERANCE && state[CS] >= 0)
        return;
    t->failed = true;
    if (t->run.reads[U])
        say(t->subject, VERDICT_FAIL,
            "cs^2 differs from dp/drho + p/rho^2 dp/du at rho = %g, u = %g: %.9g against %.9g",
            state[RHO], state[U], given, found);
    else
        say(t->subject, VERDICT_FAIL, "cs^2 differs from dp/drho at rho = %g: %.9g against %.9g",
            state[RHO], given, found);
}

/* -- Inverse -------- */

static void compare_inverse(struct trial *t, const double state[N_KNOWN])
{
    double back[N_KNOWN];

    memcpy(back, state, sizeof(back));
    if (!evaluate(t, &t->inverse, back)) {
        say(t->subject, VERDICT_FAIL, "inverse fails on what run gives at rho = %g, u = %g: p = %g",
            state[RHO], state[U], state[P]);
        t->failed = true;
        return;
    }
    t->inverted++;
    for (int i = 0; i < N_KNOWN; i++) {
        const double error = fabs(back[i] - state[i]) / fmax(fabs(state[i]), 1e-300);
        if (!t->inverse.writes[i] || !t->run.reads[i])
            continue;
        t->back = fmax(t->back, error);
        if (error <= INVERSE_TOLERANCE)
            continue;
        say(t->subject, VERDICT_FAIL,
            "inverse gives %s = %.9g instead of %.9g, at rho = %g, p = %g", known[i], back[i],
            state[i], state[RHO], state[P]);
        t->failed = true;
        return;
    }
}

/* -- States -------- */

/* The user's range; for rho, around a parameter in its name (rho0); else around 1. */
static void range_of(struct trial *t, int i, double out[2])
{
    const struct setting *s = subject_setting(t->subject, known[i]);
    const struct sph_config *c = &t->run.bench->use.config;
    const sph_param *p = c->item->params.data;

    out[0] = 1e-3;
    out[1] = 1e3;
    for (uint32_t k = 0; i == RHO && k < c->item->params.count; k++)
        if (strncmp(p[k].name, "rho", 3) == 0 && c->value[k] > 0) {
            out[0] = 0.5 * c->value[k];
            out[1] = 2 * c->value[k];
        }
    if (s && !isnan(s->low)) {
        out[0] = s->low;
        out[1] = s->high;
        t->chosen = true;
    }
}

/* Evenly in the logarithm; evenly where the range is not above 0. */
static double spread(const double range[2], int i)
{
    const double share = (double)i / (STEPS - 1);

    return range[0] > 0 ? range[0] * pow(range[1] / range[0], share)
                        : range[0] + share * (range[1] - range[0]);
}

static void try_state(struct trial *t, double rho, double other)
{
    double state[N_KNOWN] = {rho, other, other, 0};
    const bool physical = t->from_pressure || t->chosen;

    t->states++;
    if (t->from_pressure && !evaluate(t, &t->inverse, state)) {
        say(t->subject, VERDICT_FAIL, "inverse gives no number at rho = %g, p = %g", rho, other);
        t->failed = true;
        return;
    }
    if (!evaluate(t, &t->run, state)) {
        t->odd++;
        if (physical) {
            say(t->subject, VERDICT_FAIL, "run gives no number at rho = %g, u = %g", state[RHO],
                state[U]);
            t->failed = true;
        } else if (!t->said_odd) {
            say(t->subject, VERDICT_NOTE,
                "run gives no number at some states, as rho = %g, u = %g (--set %s.rho=LOW:HIGH "
                "chooses them)",
                state[RHO], state[U], t->subject->entry->item->name);
            t->said_odd = true;
        }
        return;
    }
    if (t->inverse.bench)
        compare_inverse(t, state);
    if (!t->failed && t->run.writes[P] && t->run.writes[CS])
        compare_sound(t, state);
}

static void say_result(const struct trial *t)
{
    const struct subject *s = t->subject;

    if (t->odd == t->states)
        say(s, VERDICT_FAIL, "run gives no number at any of %zu states", t->states);
    else if (t->compared)
        say(s, VERDICT_OK,
            t->run.reads[U] ? "cs^2 = dp/drho + p/rho^2 dp/du at %zu states (error %.1g)"
                            : "cs^2 = dp/drho at %zu states (error %.1g)",
            t->compared, t->sound);
    else
        say(s, VERDICT_NOTE, "speed of sound is not compared: %s",
            t->run.writes[P] && t->run.writes[CS] ? "p is not smooth, or does not rise with rho"
                                                  : "run does not write both p and cs");
    if (t->inverted)
        say(s, VERDICT_OK, "inverse leads back at %zu states (error %.1g)", t->inverted, t->back);
}

static int make_both(struct trial *t, struct pass_spec spec[2], struct error *e)
{
    const size_t n = passes_of(t->subject->entry, spec);

    return evaluator_make(&t->run, t->subject, &spec[0], e) ||
                   (n > 1 && evaluator_make(&t->inverse, t->subject, &spec[1], e))
               ? -1
               : 0;
}

void check_eos(const struct subject *s)
{
    struct trial t = {.subject = s};
    struct pass_spec spec[2];
    struct use use;
    struct error e = {0};
    double rho[2], other[2];

    if (subject_configure(s, &use, &e)) /* `life` has said why */
        return;
    use_fini(&use, s->registry);
    if (make_both(&t, spec, &e)) {
        say(s, VERDICT_FAIL, "%s", e.text);
        return;
    }
    if (!t.run.reads[RHO]) {
        say(s, VERDICT_NOTE, "does not read rho: its states are not known here");
        return;
    }
    t.from_pressure = t.inverse.writes[U] && t.inverse.reads[P] && t.run.reads[U] &&
                      !subject_setting(s, known[U]);
    range_of(&t, RHO, rho);
    range_of(&t, t.from_pressure ? P : U, other);
    for (int i = 0; i < STEPS && !t.failed; i++)
        for (int k = 0; k < (t.run.reads[U] ? STEPS : 1) && !t.failed; k++)
            try_state(&t, spread(rho, i), spread(other, k));
    if (!t.failed)
        say_result(&t);
}
