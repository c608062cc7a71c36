/* opencl/kernels_sweep.c -- the sweeps of a stage as OpenCL C: what pair-group.h and pair-steps.h are natively,
 * with the bodies of all its passes in one loop (see kernels_private.h). Of each pair the root is begun while
 * the pair before it is worked on. */
#include "config.h"

#include "opencl/kernels_private.h"

/* How the steps of a list go: a source for all lanes, two that share the lanes, or, of a single destination, the
 * one of its half. */
enum steps { STEPS_COMMON, STEPS_TURNS, STEPS_SINGLE };

/* What a loop is written for. */
struct sweep {
    struct kernel_text *t;
    const struct sweep_source *from;
    enum steps steps;
};

static bool floats(const struct kernel_text *t)
{
    return t->shape->stage->real == SPH_F32;
}

static const sph_device_value *value_at(const sph_list *list, uint32_t k)
{
    return list_at(list, k);
}

static uint32_t components(const struct kernel_text *t, const sph_device_value *v)
{
    const uint32_t dim = (uint32_t)t->plan->dim;

    return v->type == SPH_SCALAR ? 1 : v->type == SPH_VECTOR ? dim : dim * dim;
}

/* The k-th pass's binding to these sources; NULL: it does not sweep over them. */
static const struct binding *binding_of(const struct kernel_text *t, size_t k,
                                        const struct sweep_source *from)
{
    const struct pass *p = text_pass(t, k);

    for (size_t s = 0; p->shape == SPH_PAIR && s < p->n_src; s++)
        if (p->src[s].array == from->array && p->list[s] == from->list)
            return &p->src[s];
    return NULL;
}

static int place_of(const struct kernel_text *t, size_t array)
{
    const struct plan_array *a = &t->plan->array[array];
    const size_t frame = t->shape->stage->frame;

    return frame ? particles_find(&a->p, t->plan->frame[frame].name) : a->position;
}

/* -- Destinations -------- */

static const char *const sign[3] = {"sum", "min", "max"};

static const sph_list *accumulated(const sph_device_body *d, int kind)
{
    return kind == 0 ? &d->sum : kind == 1 ? &d->min : &d->max;
}

void put_accumulators(struct kernel_text *t)
{
    static const char *const start[3] = {"0.0", "INFINITY", "-INFINITY"};

    for (size_t k = 0; k < t->shape->stage->n; k++) {
        const sph_device_body *d = pass_body(text_pass(t, k));
        for (int kind = 0; d && kind < 3; kind++)
            for (uint32_t i = 0; i < accumulated(d, kind)->count; i++) {
                const uint32_t n = components(t, value_at(accumulated(d, kind), i));
                fprintf(t->out, "    R sph_%s%zu_%u[%u];\n", sign[kind], k, i, n);
                for (uint32_t c = 0; c < n; c++)
                    fprintf(t->out, "    sph_%s%zu_%u[%u] = sph_num(%s);\n", sign[kind], k, i, c,
                            start[kind]);
            }
    }
}

void put_sums(struct kernel_text *t, size_t k)
{
    static const char *const word[3] = {"sum", "least", "most"};
    const struct pass *p = text_pass(t, k);
    const sph_device_body *d = pass_body(p);
    const size_t a = p->dst.array;

    for (int kind = 0; d && kind < 3; kind++)
        for (uint32_t i = 0; i < accumulated(d, kind)->count; i++) {
            const sph_device_value *v = value_at(accumulated(d, kind), i);
            const uint32_t slot = t->arena[a].place[p->dst.column[v->index]].slot;
            for (uint32_t c = 0; c < components(t, v); c++)
                fprintf(t->out,
                        "    sph_%s(sph_w%zu + %uul * sph_p%zu + sph_i, sph_%s%zu_%u[%u], "
                        "sph_lanes);\n",
                        word[kind], a, slot + c, a, sign[kind], k, i, c);
        }
}

/* Whether an earlier value of the stage's bodies has the column: of destinations, or of these sources. */
static bool seen(const struct kernel_text *t, const struct sweep_source *from, size_t pass,
                 uint32_t value, int column)
{
    for (size_t k = 0; k <= pass; k++) {
        const struct pass *p = text_pass(t, k);
        const sph_device_body *d = pass_body(p);
        const struct binding *b = !from ? &p->dst : binding_of(t, k, from);
        const sph_list *list = d ? (from ? &d->j : &d->i) : NULL;
        for (uint32_t i = 0; b && list && i < (k == pass ? value : list->count); i++)
            if (b->column[value_at(list, i)->index] == column)
                return true;
    }
    return false;
}

typedef void put_column(const struct sweep *s, int column, uint32_t n);

/* Of every column that the bodies read of destinations (from NULL) or of sources: each once. */
static void each_column(const struct sweep *s, const struct sweep_source *from, put_column *put)
{
    const struct kernel_text *t = s->t;

    for (size_t k = 0; k < t->shape->stage->n; k++) {
        const struct pass *p = text_pass(t, k);
        const sph_device_body *d = pass_body(p);
        const struct binding *b = !d ? NULL : !from ? &p->dst : binding_of(t, k, from);
        const sph_list *list = d ? (from ? &d->j : &d->i) : NULL;
        for (uint32_t i = 0; b && i < list->count; i++) {
            const sph_device_value *v = value_at(list, i);
            if (!seen(t, from, k, i, b->column[v->index]))
                put(s, b->column[v->index], components(t, v));
        }
    }
}

static void put_own(const struct sweep *s, int column, uint32_t n)
{
    const struct kernel_text *t = s->t;
    const size_t a = t->shape->stage->array;

    fprintf(t->out, "    R sph_i%d[%u];\n", column, n);
    for (uint32_t c = 0; c < n; c++)
        fprintf(t->out, "    sph_i%d[%u] = sph_load(sph_w%zu + %uul * sph_p%zu + sph_i);\n", column,
                c, a, t->arena[a].place[column].slot + c, a);
}

static void put_destinations(const struct sweep *s)
{
    const struct kernel_text *t = s->t;
    const size_t a = t->shape->stage->array;
    const struct arena_place *place = t->arena[a].place;
    const int x = place_of(t, a);

    fprintf(t->out, "    %s x_i[DIM];\n", floats(t) ? "SPH_OF_ISA(sph_places)" : "R");
    for (uint32_t c = 0; c < (uint32_t)t->plan->dim; c++)
        if (floats(t))
            fprintf(t->out,
                    "    x_i[%u] = sph_places((__global const int *)sph_n%zu + %uul * sph_p%zu + "
                    "sph_i);\n",
                    c, a, (uint32_t)place[x].mirror + c, a);
        else
            fprintf(t->out, "    x_i[%u] = sph_load(sph_w%zu + %uul * sph_p%zu + sph_i);\n", c, a,
                    place[x].slot + c, a);
    fprintf(t->out,
            "    const R h_i = sph_load(sph_w%zu + %uul * sph_p%zu + sph_i);\n"
            "    const R hinv_i = sph_num(1.0) / h_i;\n"
            "    const R sph_own2 = (K->support * h_i) * (K->support * h_i);\n"
            "    const B sph_number = sph_numbers((uint)sph_i);\n",
            a, place[t->plan->array[a].smoothing].slot, a);
    each_column(s, NULL, put_own);
}

/* -- Sources -------- */

static void put_pointer(const struct sweep *s, int column, uint32_t c, const char *type,
                        const char *name)
{
    const struct kernel_text *t = s->t;
    const size_t a = s->from->array;
    const struct arena_place *place = &t->arena[a].place[column];
    const bool narrow = floats(t) && place->mirror >= 0;

    fprintf(t->out, "    __global const %s *const %s_%u = ",
            type     ? type
            : narrow ? "float"
                     : "double",
            name, c);
    if (type)
        fprintf(t->out, "(__global const %s *)", type);
    fprintf(t->out, "sph_%c%zu + %uul * sph_p%zu;\n", narrow ? 'n' : 'w', a,
            (narrow ? (uint32_t)place->mirror : place->slot) + c, a);
}

static void put_pointers(const struct sweep *s, int column, uint32_t n)
{
    char name[32];

    snprintf(name, sizeof(name), "sph_s%d", column);
    for (uint32_t c = 0; c < n; c++)
        put_pointer(s, column, c, NULL, name);
}

/* What a source, or two of them, have in a column. */
static void put_load(const struct sweep *s, const char *name, uint32_t c, const char *at)
{
    if (s->steps == STEPS_TURNS)
        fprintf(s->t->out, "sph_halves(%s_%u[%s], %s_%u[%s2])", name, c, at, name, c, at);
    else
        fprintf(s->t->out, "sph_num(%s_%u[%s])", name, c, at);
}

static void put_others(const struct sweep *s, int column, uint32_t n)
{
    char name[32];

    snprintf(name, sizeof(name), "sph_s%d", column);
    fprintf(s->t->out, "        R sph_j%d[%u];\n", column, n);
    for (uint32_t c = 0; c < n; c++) {
        fprintf(s->t->out, "        sph_j%d[%u] = ", column, c);
        put_load(s, name, c, "sph_at");
        fputs(";\n", s->t->out);
    }
}

/* Step k is begun: who it is, how far away, the root of that. */
static void put_begin(const struct sweep *s, const char *k)
{
    FILE *out = s->t->out;

    if (s->steps == STEPS_COMMON)
        fprintf(out, "        sph_next = sph_steps[%s];\n", k);
    else if (s->steps == STEPS_TURNS)
        fprintf(out,
                "        sph_next = sph_steps[2u * %s];\n        sph_next2 = sph_steps[2u * %s + "
                "1u];\n",
                k, k);
    else
        fprintf(out,
                "        sph_next = sph_steps[%s < sph_shared ? %s : 2u * %s - sph_shared + "
                "sph_half];\n",
                k, k, k);
    for (uint32_t c = 0; c < (uint32_t)s->t->plan->dim; c++) {
        fprintf(out, "        sph_dx[%u] = ", c);
        if (!floats(s->t)) {
            fprintf(out, "x_i[%u] - ", c);
            put_load(s, "sph_x", c, "sph_next");
        } else if (s->steps == STEPS_TURNS) {
            fprintf(out,
                    "sph_apart(x_i[%u], sph_whole_halves(sph_x_%u[sph_next], "
                    "sph_x_%u[sph_next2]), sph_quantum)",
                    c, c, c);
        } else {
            fprintf(out, "sph_apart(x_i[%u], sph_x_%u[sph_next], sph_quantum)", c, c);
        }
        fputs(";\n", out);
    }
    fputs("        sph_r2 = sph_dx[0] * sph_dx[0];\n", out);
    for (uint32_t c = 1; c < (uint32_t)s->t->plan->dim; c++)
        fprintf(out, "        sph_r2 += sph_dx[%u] * sph_dx[%u];\n", c, c);
    fputs("        SPH_ROOTS\n", out);
}

static void put_smoothing(const struct sweep *s)
{
    FILE *out = s->t->out;

    fputs("#if SPH_UNIFORM\n        const R h_j = h_i, hinv_j = hinv_i;\n#else\n"
          "        const R h_j = ",
          out);
    put_load(s, "sph_h", 0, "sph_at");
    if (s->steps == STEPS_TURNS)
        fputs(";\n        const R hinv_j = sph_halves((T)1.0 / (T)sph_h_0[sph_at], (T)1.0 / "
              "(T)sph_h_0[sph_at2]);\n",
              out);
    else
        fputs(";\n        const R hinv_j = sph_num((T)1.0 / (T)sph_h_0[sph_at]);\n", out);
    fputs("#endif\n", out);
}

/* Which lanes take part: one mask for each kind of body that there is. */
static void put_masks(const struct sweep *s)
{
    const struct kernel_text *t = s->t;
    const bool same = s->from->array == t->shape->stage->array && s->steps != STEPS_TURNS;
    bool made[2][2] = {{false}};

    for (size_t k = 0; k < t->shape->stage->n; k++) {
        const sph_device_body *d = pass_body(text_pass(t, k));
        if (!d || !binding_of(t, k, s->from))
            continue;
        const bool both = d->reach == SPH_SYMMETRIC, self = d->self != 0;
        if (made[both][self])
            continue;
        made[both][self] = true;
        fprintf(t->out, "        const B sph_in_%d%d = sph_near(r2, %s)%s;\n", both, self,
                both ? "SPH_BOTH2" : "sph_own2",
                same && !self ? " & sph_others(sph_number, sph_at)" : "");
    }
}

/* -- Bodies -------- */

static void put_given(const struct kernel_text *t, const sph_list *list, const struct binding *b,
                      char side)
{
    for (uint32_t i = 0; i < list->count; i++) {
        const sph_device_value *v = value_at(list, i);
        const int column = b->column[v->index];
        if (v->type == SPH_SCALAR)
            fprintf(t->out, "        const R %s_%c = sph_%c%d[0];\n", v->name, side, side, column);
        else
            fprintf(t->out, "        const R *const %s_%c = sph_%c%d;\n", v->name, side, side,
                    column);
    }
}

/* Accumulators under the body's names; with `back` what it made of those that are no arrays. */
static void put_accumulated(const struct kernel_text *t, const sph_device_body *d, size_t k,
                            bool back)
{
    for (int kind = 0; kind < 3; kind++)
        for (uint32_t i = 0; i < accumulated(d, kind)->count; i++) {
            const sph_device_value *v = value_at(accumulated(d, kind), i);
            if (back && v->type == SPH_SCALAR)
                fprintf(t->out, "        sph_%s%zu_%u[0] = %s;\n", sign[kind], k, i, v->name);
            else if (!back)
                fprintf(t->out, "        R %s%s = sph_%s%zu_%u%s;\n",
                        v->type == SPH_SCALAR ? "" : "*const ", v->name, sign[kind], k, i,
                        v->type == SPH_SCALAR ? "[0]" : "");
        }
}

static void put_bodies(const struct sweep *s)
{
    struct kernel_text *t = s->t;

    for (size_t k = 0; k < t->shape->stage->n; k++) {
        const struct pass *p = text_pass(t, k);
        const sph_device_body *d = pass_body(p);
        const struct binding *b = d ? binding_of(t, k, s->from) : NULL;
        if (!b)
            continue;
        fprintf(t->out, "        {\n        const B in = sph_in_%d%d;\n", d->reach == SPH_SYMMETRIC,
                d->self != 0);
        for (uint32_t i = 0; i < d->param.count; i++)
            fprintf(t->out, "        const T %s = sph_param%zu_%u;\n", value_at(&d->param, i)->name,
                    k, i);
        put_given(t, &d->i, &p->dst, 'i');
        put_given(t, &d->j, b, 'j');
        put_accumulated(t, d, k, false);
        put_prelude(t->out, d->prelude, d->prelude_file, floats(t));
        put_body(t->out, d->text, d->file, floats(t));
        put_prelude_end(t->out, d->prelude);
        put_accumulated(t, d, k, true);
        fputs("        }\n", t->out);
    }
}

/* -- Loops -------- */

static void put_steps(const struct sweep *s)
{
    FILE *out = s->t->out;

    fprintf(out,
            "    if (sph_count > 0u) {\n        uint sph_next%s;\n"
            "        R sph_dx[DIM], sph_r2, sph_r, sph_rinv;\n",
            s->steps == STEPS_TURNS ? ", sph_next2" : "");
    put_begin(s, "0u");
    fprintf(out,
            "        for (uint sph_k = 0; sph_k < sph_count; sph_k++) {\n"
            "        const uint sph_at = sph_next%s;\n"
            "        const R r2 = sph_r2, r = sph_r, rinv = sph_rinv;\n"
            "        R dx[DIM];\n        SPH_UNROLLED for (int sph_c = 0; sph_c < DIM; sph_c++)\n"
            "            dx[sph_c] = sph_dx[sph_c];\n"
            "        const uint sph_after = sph_k + 1u < sph_count ? sph_k + 1u : sph_k;\n",
            s->steps == STEPS_TURNS ? ", sph_at2 = sph_next2" : "");
    put_begin(s, "sph_after");
    put_smoothing(s);
    put_masks(s);
    each_column(s, s->from, put_others);
    put_bodies(s);
    fputs("        }\n    }\n", out);
}

static void put_source(struct kernel_text *t, const struct sweep_source *from)
{
    struct sweep s = {t, from, STEPS_SINGLE};
    const int x = place_of(t, from->array);

    fprintf(
        t->out,
        "    {\n    const uint sph_shared = sph_common%zu[sph_g];\n"
        "    const uint sph_turns = (sph_begin%zu[sph_g + 1u] - sph_begin%zu[sph_g] - sph_shared) / 2u;\n",
        from->list, from->list, from->list);
    for (uint32_t c = 0; c < (uint32_t)t->plan->dim; c++)
        put_pointer(&s, x, c, floats(t) ? "int" : NULL, "sph_x");
    put_pointer(&s, t->plan->array[from->array].smoothing, 0, NULL, "sph_h");
    each_column(&s, from, put_pointers);
    fprintf(t->out,
            "    {\n    __global const uint *const sph_steps = sph_step%zu + "
            "sph_begin%zu[sph_g];\n    const uint sph_count = sph_shared%s;\n",
            from->list, from->list, t->vectors ? "" : " + sph_turns");
    s.steps = t->vectors ? STEPS_COMMON : STEPS_SINGLE;
    put_steps(&s);
    fputs("    }\n", t->out);
    if (t->vectors) {
        fprintf(t->out,
                "    {\n    __global const uint *const sph_steps = sph_step%zu + "
                "sph_begin%zu[sph_g] + sph_shared;\n    const uint sph_count = sph_turns;\n",
                from->list, from->list);
        s.steps = STEPS_TURNS;
        put_steps(&s);
        fputs("    }\n", t->out);
    }
    fputs("    }\n", t->out);
}

void put_sweeps(struct kernel_text *t)
{
    const struct sweep s = {t, NULL, STEPS_SINGLE};

    put_destinations(&s);
    for (size_t k = 0; k < t->shape->n_source; k++)
        put_source(t, &t->shape->source[k]);
}
