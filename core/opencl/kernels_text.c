/* opencl/kernels_text.c -- a stage as kernels of OpenCL C (see kernels_private.h): what destinations do alone, around
 * the sweeps of kernels_sweep.c. Text alone; needs no device. */
#include "config.h"

#include "opencl/kernels_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SUMS (SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)

/* -- What passes have for devices -------- */

const sph_device_body *pass_body(const struct pass *p)
{
    return p->function && p->shape == SPH_PAIR ? p->function->device : NULL;
}

const sph_device_point *pass_before(const struct pass *p)
{
    return p->function && p->before ? p->function->device_before : NULL;
}

const sph_device_point *pass_after(const struct pass *p)
{
    return p->function && p->after ? p->function->device_after : NULL;
}

const sph_device_point *pass_point(const struct pass *p)
{
    if (p->assignment)
        return assignment_device(p->assignment);
    if (p->shape == SPH_PAIR)
        return NULL;
    return p->function ? p->function->device_run : entry_eos(p->use.entry)->device;
}

/* -- Numbers -------- */

static uint32_t states_of(const sph_device_point *d)
{
    uint32_t n = 0;

    for (uint32_t i = 0; d && i < d->state.count; i++) {
        const sph_device_value *v = list_at(&d->state, i);
        n = v->index + 1 > n ? v->index + 1 : n;
    }
    return n;
}

struct pass_numbers *pass_numbers_make(const struct plan *plan, size_t *total)
{
    struct pass_numbers *numbers = calloc(plan->n_pass + 1, sizeof(*numbers));

    *total = 0;
    for (size_t i = 0; numbers && i < plan->n_pass; i++) {
        const struct pass *p = &plan->pass[i];
        const sph_device_point *const d[3] = {pass_before(p), pass_after(p), pass_point(p)};
        numbers[i].n_param = p->use.item->params.count;
        for (int k = 0; k < 3; k++)
            numbers[i].n_state =
                states_of(d[k]) > numbers[i].n_state ? states_of(d[k]) : numbers[i].n_state;
        numbers[i].param = *total;
        numbers[i].state = *total + numbers[i].n_param;
        *total += numbers[i].n_param + numbers[i].n_state;
    }
    return numbers;
}

/* -- The shape of a stage -------- */

/* Whether a body looks at the smoothing lengths of sources. */
static bool looks_at_h(const sph_device_body *d)
{
    return !d || d->reach == SPH_SYMMETRIC || strstr(d->text, "h_j") || strstr(d->text, "hinv_j") ||
           (d->prelude && (strstr(d->prelude, "h_j") || strstr(d->prelude, "hinv_j")));
}

/* A phased stage whose pass writes nothing of others that its body really reads needs no phases: a smoothing
 * length counts as read for all there is. */
static bool is_phased(const struct plan *plan, const struct stage *stage)
{
    for (size_t k = 0; stage->phased && k < stage->n; k++) {
        const struct pass *p = &plan->pass[stage->pass[k]];
        for (size_t s = 0; s < p->n_src; s++) {
            const struct plan_array *a = &plan->array[p->src[s].array];
            if (pass_writes(p, p->src[s].array, a->position) ||
                (looks_at_h(pass_body(p)) && pass_writes(p, p->src[s].array, a->smoothing)))
                return true;
            for (uint32_t i = 0; i < p->use.item->props.count; i++)
                if (p->src[s].column[i] >= 0 &&
                    pass_writes(p, p->src[s].array, p->src[s].column[i]))
                    return true;
        }
    }
    return false;
}

static void add_source(struct stage_shape *shape, size_t array, size_t list)
{
    size_t k = 0;

    while (k < shape->n_source && shape->source[k].list != list)
        k++;
    if (k == shape->n_source)
        shape->source[shape->n_source++] = (struct sweep_source){array, list};
    for (k = 0; k < shape->n_array && shape->array[k] != array;)
        k++;
    if (k == shape->n_array)
        shape->array[shape->n_array++] = array;
}

int stage_shape_make(struct stage_shape *shape, const struct plan *plan, const struct stage *stage,
                     size_t number, struct error *e)
{
    *shape = (struct stage_shape){.stage = stage, .number = number};
    shape->array = calloc(plan->n_array + 1, sizeof(*shape->array));
    shape->source = calloc(plan->n_list + 1, sizeof(*shape->source));
    if (!shape->array || !shape->source)
        return error_memory(e, "a stage", plan->n_list * sizeof(*shape->source));
    shape->array[shape->n_array++] = stage->array;
    for (size_t k = 0; k < stage->n; k++) {
        const struct pass *p = &plan->pass[stage->pass[k]];
        for (size_t s = 0; p->shape == SPH_PAIR && s < p->n_src; s++)
            add_source(shape, p->src[s].array, p->list[s]);
    }
    shape->phased = is_phased(plan, stage);
    return 0;
}

void stage_shape_free(struct stage_shape *shape)
{
    free(shape->array);
    free(shape->source);
}

void stage_kernel_name(char *out, size_t size, const struct stage_shape *shape,
                       enum kernel_part part)
{
    static const char *const word[PART_COUNT] = {"", "_before", "_sweep", "_after"};

    snprintf(out, size, "stage_%zu%s", shape->number, word[part]);
}

static bool has_pairs(const struct kernel_text *t)
{
    return t->shape->stage->n_head < t->shape->stage->n;
}

/* -- Parameters -------- */

/* A number, once for all destinations. What is chosen out of a few words stands in the text itself, so that the
 * compiler sees which branches are taken. */
static void put_parameter(struct kernel_text *t, const struct pass *p, const sph_device_value *v,
                          const char *type)
{
    const struct pass_numbers *numbers = &t->numbers[p - t->plan->pass];
    const sph_param *param = list_at(&p->use.item->params, v->index);

    if (param->choices)
        fprintf(t->out, "(%s)%a;\n", type, p->use.config.value[v->index]);
    else
        fprintf(t->out, "(%s)sph_numbers_of[%zu];\n", type, numbers->param + v->index);
}

/* role: "param" of a sweep; else that of a point. */
static void put_point_numbers(struct kernel_text *t, size_t k, const sph_device_point *d,
                              const char *role)
{
    const struct pass *p = text_pass(t, k);

    for (uint32_t i = 0; d && i < d->param.count; i++) {
        fprintf(t->out, "    const double sph_%s%zu_%u = ", role, k, i);
        put_parameter(t, p, list_at(&d->param, i), "double");
    }
    for (uint32_t i = 0; d && i < d->state.count; i++) {
        const sph_device_value *v = list_at(&d->state, i);
        fprintf(t->out, "    const double sph_%s%zu_s%u = sph_numbers_of[%zu];\n", role, k, i,
                t->numbers[p - t->plan->pass].state + v->index);
    }
}

static void put_numbers(struct kernel_text *t)
{
    for (size_t k = 0; k < t->shape->stage->n; k++) {
        const struct pass *p = text_pass(t, k);
        const sph_device_body *d = pass_body(p);
        for (uint32_t i = 0; d && i < d->param.count; i++) {
            fprintf(t->out, "    const T sph_param%zu_%u = ", k, i);
            put_parameter(t, p, list_at(&d->param, i), "T");
        }
        put_point_numbers(t, k, pass_before(p), "before");
        put_point_numbers(t, k, pass_after(p), "after");
        put_point_numbers(t, k, pass_point(p), "point");
    }
}

/* -- What a destination does alone -------- */

/* "((__global int *)sph_n1)[7ul * sph_p1 + sph_o]" */
static void put_element(struct kernel_text *t, const struct pass *p, const sph_device_value *v,
                        uint32_t c)
{
    const size_t a = p->dst.array;
    const struct arena_place *place = &t->arena[a].place[p->dst.column[v->index]];

    if (v->type == SPH_INT32 || v->type == SPH_INT64)
        fprintf(t->out, "((__global %s *)sph_%c%zu)", v->type == SPH_INT32 ? "int" : "long",
                v->type == SPH_INT32 ? 'n' : 'w', a);
    else
        fprintf(t->out, "sph_%c%zu", place->size == 8 ? 'w' : 'n', a);
    fprintf(t->out, "[%uul * sph_p%zu + sph_o]", place->slot + c, a);
}

static uint32_t components_of(const struct kernel_text *t, const struct pass *p,
                              const sph_device_value *v)
{
    return t->plan->array[p->dst.array].p.column[p->dst.column[v->index]].ncomp;
}

static bool is_array(const sph_device_value *v)
{
    return v->type == SPH_VECTOR || v->type == SPH_MATRIX || v->type == SPH_SYM;
}

static void put_variables(struct kernel_text *t, const struct pass *p, const sph_list *list,
                          bool reads)
{
    for (uint32_t i = 0; i < list->count; i++) {
        const sph_device_value *v = list_at(list, i);
        const uint32_t n = components_of(t, p, v);
        fprintf(t->out, "    %s %s",
                v->type == SPH_INT32   ? "int"
                : v->type == SPH_INT64 ? "long"
                                       : "double",
                v->name);
        if (is_array(v))
            fprintf(t->out, "[%u]", n);
        fputs(reads ? is_array(v) ? " = {" : " = " : "", t->out);
        for (uint32_t c = 0; reads && c < n; c++) {
            fputs(c ? ", " : "", t->out);
            put_element(t, p, v, c);
        }
        fputs(reads && is_array(v) ? "};\n" : ";\n", t->out);
    }
}

static void put_back(struct kernel_text *t, const struct pass *p, const sph_list *list)
{
    for (uint32_t i = 0; i < list->count; i++) {
        const sph_device_value *v = list_at(list, i);
        for (uint32_t c = 0; c < components_of(t, p, v); c++) {
            fputs("    ", t->out);
            put_element(t, p, v, c);
            fprintf(t->out, is_array(v) ? " = %s[%u];\n" : " = %s;\n", v->name, c);
        }
    }
}

/* What `before` has written, for sweeps in floats that read it of others. */
static void put_mirrors(struct kernel_text *t, const struct pass *p, const sph_list *list)
{
    const size_t a = p->dst.array;

    for (uint32_t i = 0; i < list->count; i++) {
        const sph_device_value *v = list_at(list, i);
        const int column = p->dst.column[v->index];
        const int32_t mirror = t->arena[a].place[column].mirror;
        if (mirror < 0 || column == t->plan->array[a].position)
            continue;
        for (uint32_t c = 0; c < components_of(t, p, v); c++)
            fprintf(t->out,
                    is_array(v) ? "    sph_n%zu[%uul * sph_p%zu + sph_o] = (float)%s[%u];\n"
                                : "    sph_n%zu[%uul * sph_p%zu + sph_o] = (float)%s;\n",
                    a, (uint32_t)mirror + c, a, v->name, c);
    }
}

/* The body of one particle, number sph_o. */
static void put_point(struct kernel_text *t, size_t k, const sph_device_point *d, const char *role)
{
    const size_t first = failures_before(*role == 'b' ? 0 : *role == 'a' ? 1 : 2);
    const struct pass *p = text_pass(t, k);
    const struct plan_array *a = &t->plan->array[p->dst.array];

    if (!d)
        return;
    fprintf(t->out,
            "    {\n    #define sph_fail(k) "
            "atomic_cmpxchg(sph_failure, 0, %zu + (int)(k))\n",
            1 + FAILURES * t->shape->stage->pass[k] + first);
    if (d->h)
        fprintf(t->out, "    const double h = sph_w%zu[%uul * sph_p%zu + sph_o];\n", p->dst.array,
                t->arena[p->dst.array].place[a->smoothing].slot, p->dst.array);
    for (uint32_t i = 0; i < d->param.count; i++)
        fprintf(t->out, "    const double %s = sph_%s%zu_%u;\n",
                ((const sph_device_value *)list_at(&d->param, i))->name, role, k, i);
    for (uint32_t i = 0; i < d->state.count; i++)
        fprintf(t->out, "    const double %s = sph_%s%zu_s%u;\n",
                ((const sph_device_value *)list_at(&d->state, i))->name, role, k, i);
    put_variables(t, p, &d->in, true);
    put_variables(t, p, &d->inout, true);
    put_variables(t, p, &d->out, false);
    put_prelude(t->out, d->prelude, d->prelude_file, false);
    put_body(t->out, d->text, d->file, false);
    put_prelude_end(t->out, d->prelude);
    put_back(t, p, &d->inout);
    put_back(t, p, &d->out);
    if (*role == 'b' && t->shape->phased && t->shape->stage->real == SPH_F32) {
        put_mirrors(t, p, &d->inout);
        put_mirrors(t, p, &d->out);
    }
    fputs("    #undef sph_fail\n    }\n", t->out);
}

static void put_form(struct kernel_text *t)
{
    if (t->plan->has_kernel)
        fprintf(t->out,
                "    const SPH_FORM sph_form = {(T)%a, sph_table};\n"
                "    const SPH_FORM *const K = &sph_form;\n",
                t->plan->kernel.support);
}

/* From here on words mean one double. */
static void put_alone(struct kernel_text *t, bool begins)
{
    if (begins) {
        fputs("    {\n#undef SPH_ISA\n#define SPH_ISA f64x1\n", t->out);
        if (t->vectors)
            fputs(
                "#pragma clang loop vectorize(assume_safety) vectorize_width(8) interleave_count(1)\n",
                t->out);
        fputs("    for (uint sph_l = 0; sph_l < sph_lanes; sph_l++) {\n"
              "    const ulong sph_o = sph_i + sph_l;\n",
              t->out);
        put_form(t);
    } else {
        fputs("    }\n#undef SPH_ISA\n#define SPH_ISA SPH_SWEEP_ISA\n    }\n", t->out);
    }
}

static void put_one_alone(struct kernel_text *t, size_t k, const sph_device_point *d,
                          const char *role)
{
    if (!d)
        return;
    put_alone(t, true);
    put_point(t, k, d, role);
    put_alone(t, false);
}

/* Accumulators to their start. */
static void put_reset(struct kernel_text *t, size_t k)
{
    const struct pass *p = text_pass(t, k);
    const size_t a = p->dst.array;

    for (uint32_t i = 0; i < p->use.item->props.count; i++) {
        const sph_prop *prop = list_at(&p->use.item->props, i);
        if (!(prop->access & SUMS) || p->continues[i])
            continue;
        const int column = p->dst.column[i];
        const struct arena_place *place = &t->arena[a].place[column];
        for (uint32_t c = 0; c < t->plan->array[a].p.column[column].ncomp; c++) {
            fprintf(t->out,
                    "    for (uint sph_l = 0; sph_l < sph_lanes; sph_l++)\n"
                    "        sph_%c%zu[%uul * sph_p%zu + sph_i + sph_l] = ",
                    place->size == 8 ? 'w' : 'n', a, place->slot + c, a);
            if (isinf(prop->start))
                fprintf(t->out, "%sINFINITY;\n", prop->start < 0 ? "-" : "");
            else
                fprintf(t->out, place->size == 8 ? "%a;\n" : "(float)%a;\n", prop->start);
        }
    }
}

/* -- Kernels -------- */

static void put_head(struct kernel_text *t, enum kernel_part part)
{
    char name[64];
    const struct stage_shape *shape = t->shape;

    stage_kernel_name(name, sizeof(name), shape, part);
    fprintf(t->out,
            "\n__attribute__((reqd_work_group_size(%u, 1, 1)))\n__kernel void %s(const uint sph_n, "
            "const double sph_time, const double sph_dt,\n    const double sph_unit, const ulong "
            "sph_step, const uint sph_again,\n    __global const double *sph_numbers_of, __global "
            "const double *sph_table,\n    volatile __global int *sph_failure",
            t->vectors ? 1u : KERNELS_ITEMS, name);
    for (size_t k = 0; k < shape->n_array; k++)
        fprintf(t->out,
                ",\n    __global double *sph_w%zu, __global float *sph_n%zu, const ulong sph_p%zu",
                shape->array[k], shape->array[k], shape->array[k]);
    for (size_t k = 0; k < shape->n_source; k++)
        fprintf(t->out,
                ",\n    __global const uint *sph_begin%zu, __global const uint *sph_common%zu, "
                "__global const uint *sph_step%zu",
                shape->source[k].list, shape->source[k].list, shape->source[k].list);
    fputs(")\n{\n"
          "    const sph_moment sph_moment_now = {sph_time, sph_dt, sph_step, DIM};\n"
          "    const sph_moment *const b = &sph_moment_now;\n"
          "    const T sph_quantum = (T)sph_unit;\n",
          t->out);
    put_numbers(t);
}

/* From one destination, or the lanes of a group, on. */
static void put_range(struct kernel_text *t)
{
    const struct stage *s = t->shape->stage;

    if (!t->vectors) {
        fputs("    const ulong sph_i = get_global_id(0);\n    if (sph_i >= sph_n)\n"
              "        return;\n    const uint sph_lanes = 1, sph_g = (uint)(sph_i / SPH_LANES);\n"
              "    const uint sph_half = sph_i % SPH_LANES >= SPH_LANES / 2u;\n    {\n",
              t->out);
    } else if (!has_pairs(t)) {
        fprintf(t->out,
                "    const ulong sph_i = (ulong)get_global_id(0) * %uu;\n"
                "    if (sph_i >= sph_n)\n        return;\n"
                "    const uint sph_lanes = (uint)min((ulong)%uu, sph_n - sph_i);\n    {\n",
                KERNELS_POINTS, KERNELS_POINTS);
    } else {
        fprintf(t->out,
                "    const uint sph_groups = (sph_n + SPH_LANES - 1u) / SPH_LANES;\n"
                "    const uint sph_first = (uint)get_global_id(0) * %uu;\n"
                "    const uint sph_end = min(sph_first + %uu, sph_groups);\n"
                "    for (uint sph_g = sph_first; sph_g < sph_end; sph_g++) {\n"
                "    const ulong sph_i = (ulong)sph_g * SPH_LANES;\n"
                "    const uint sph_lanes = (uint)min((ulong)SPH_LANES, sph_n - sph_i);\n",
                KERNELS_GROUPS, KERNELS_GROUPS);
    }
    if (!s->iterates)
        return;
    const struct pass *p = text_pass(t, s->n_head);
    fprintf(
        t->out,
        "    if (sph_again > 0u) {\n        int sph_any = 0;\n"
        "        for (uint sph_l = 0; sph_l < sph_lanes; sph_l++)\n"
        "            sph_any |= ((__global const int *)sph_n%zu)[%uul * sph_p%zu + sph_i + sph_l];\n"
        "        if (!sph_any)\n            %s;\n    }\n",
        s->array, t->arena[s->array].place[p->unfinished].slot, s->array,
        t->vectors ? "continue" : "return");
}

static void put_kernel(struct kernel_text *t, enum kernel_part part)
{
    const struct stage *s = t->shape->stage;

    fprintf(t->out,
            "#undef SPH_SWEEP_ISA\n#undef SPH_ISA\n#define SPH_SWEEP_ISA f%dx%d\n"
            "#define SPH_ISA SPH_SWEEP_ISA\n",
            has_pairs(t) && s->real == SPH_F32 ? 32 : 64, has_pairs(t) && t->vectors ? 8 : 1);
    put_head(t, part);
    put_range(t);
    if (part == PART_ALL || part == PART_BEFORE) {
        for (size_t k = 0; k < s->n_head; k++)
            put_reset(t, k);
        if (s->n_head) {
            put_alone(t, true);
            for (size_t k = 0; k < s->n_head; k++)
                put_point(t, k, pass_point(text_pass(t, k)), "point");
            put_alone(t, false);
        }
        for (size_t k = s->n_head; k < s->n; k++) {
            if (text_pass(t, k)->shape != SPH_PAIR)
                continue;
            put_reset(t, k);
            put_one_alone(t, k, pass_before(text_pass(t, k)), "before");
        }
    }
    if (has_pairs(t) && (part == PART_ALL || part == PART_SWEEP)) {
        put_form(t);
        put_accumulators(t);
        put_sweeps(t);
    }
    for (size_t k = s->n_head; k < s->n; k++) {
        if (part == PART_ALL || part == PART_SWEEP)
            put_sums(t, k);
        if (part == PART_ALL || part == PART_AFTER) {
            put_one_alone(t, k, pass_after(text_pass(t, k)), "after");
            if (pass_point(text_pass(t, k)))
                put_reset(t, k);
            put_one_alone(t, k, pass_point(text_pass(t, k)), "point");
        }
    }
    fputs("    }\n}\n", t->out);
}

static void put_program(struct kernel_text *t, const struct stage_shape *shape, size_t n)
{
    bool in_floats = false;

    for (size_t k = 0; k < n; k++)
        in_floats = in_floats || (shape[k].n_source && shape[k].stage->real == SPH_F32);
    fprintf(t->out,
            "#define DIM %d\n#define SPH_LANES %uu\n#ifndef SPH_UNIFORM\n"
            "#define SPH_UNIFORM 0\n#endif\n",
            t->plan->dim, SPH_LANES);
    put_words(t, "f64x1", 1, false);
    if (t->vectors)
        put_words(t, "f64x8", 8, false);
    if (in_floats)
        put_words(t, t->vectors ? "f32x8" : "f32x1", t->vectors ? 8 : 1, true);
    fputs("#if SPH_UNIFORM\n#define SPH_BOTH2 sph_own2\n#else\n#define SPH_BOTH2 "
          "sph_max(sph_own2, (K->support * h_j) * (K->support * h_j))\n#endif\n"
          "#ifndef SPH_ROOTS\n#define SPH_ROOTS sph_r = sph_sqrt(sph_r2); sph_rinv = "
          "sph_rsqrt(sph_r2);\n#endif\n",
          t->out);
    for (size_t k = 0; k < n; k++) {
        t->shape = &shape[k];
        for (int part = 0; part < PART_COUNT; part++)
            if (shape[k].phased == (part != PART_ALL))
                put_kernel(t, (enum kernel_part)part);
    }
}

char *kernels_text(const struct plan *plan, const struct arena *arena,
                   const struct stage_shape *shape, size_t n, const struct pass_numbers *numbers,
                   bool vectors, struct error *e)
{
    char *text = NULL;
    size_t size = 0;
    struct kernel_text t = {.plan = plan, .arena = arena, .numbers = numbers, .vectors = vectors};

    t.out = open_memstream(&text, &size);
    if (!t.out) {
        error_memory(e, "the source of the kernels", 0);
        return NULL;
    }
    put_program(&t, shape, n);
    const bool bad = ferror(t.out) != 0;
    if (fclose(t.out) == 0 && !bad)
        return text;
    free(text);
    error_memory(e, "the source of the kernels", size);
    return NULL;
}
