/* cli/from_source.c -- NAME.c of a plugin that is made of functions with texts alone (see from.h): what the
 * scene declares, in the macros of the SDK. Writes a stream, reads descriptors. */
#include "cli/from.h"
#include "base/text.h"
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Names of C that a function's are made of: "artificial_stress", "ARTIFICIAL_STRESS". */
struct names {
    char low[72], high[72];
};

static struct names names_of(const char *name)
{
    struct names n = {{0}, {0}};
    for (size_t i = 0; name[i] && i + 1 < sizeof n.low; i++) {
        n.low[i] = name[i] == '-' ? '_' : name[i];
        n.high[i] = (char)toupper((unsigned char)n.low[i]);
    }
    return n;
}

static const char *base_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static void put_string(FILE *out, const char *text)
{
    fputc('"', out);
    for (; *text; text++) {
        if (*text == '"' || *text == '\\')
            fputc('\\', out);
        fputc(*text, out);
    }
    fputc('"', out);
}

static void put_number(FILE *out, double x)
{
    char text[32];
    snprintf(text, sizeof text, "%.15g", x);
    if (strtod(text, NULL) < x || strtod(text, NULL) > x)
        snprintf(text, sizeof text, "%.17g", x);
    fputs(isnan(x) ? "NAN" : isinf(x) ? x > 0 ? "INFINITY" : "-INFINITY" : text, out);
}

/* A word of the text as it stands in a comment: none may end that. */
static void put_comment(FILE *out, const char *text)
{
    for (; *text; text++) {
        fputc(*text, out);
        if (*text == '*' && text[1] == '/')
            fputc(' ', out);
    }
}

/* -- Declarations ---------------------------------------------------------------------------- */

static const char *const type_constant[] = {"",           "SPH_SCALAR", "SPH_VECTOR", "SPH_SYM",
                                            "SPH_MATRIX", "SPH_INT32",  "SPH_INT64"};
static const char *const type_word[] = {"", "scalar", "vector", "sym", "matrix", "int32", ""};

static void put_access(FILE *out, uint32_t access)
{
    static const struct {
        uint32_t bit;
        const char *word;
    } words[] = {{SPH_DST_READ, "SPH_DST_READ"},   {SPH_SRC_READ, "SPH_SRC_READ"},
                 {SPH_DST_WRITE, "SPH_DST_WRITE"}, {SPH_DST_SUM, "SPH_DST_SUM"},
                 {SPH_DST_MAX, "SPH_DST_MAX"},     {SPH_DST_MIN, "SPH_DST_MIN"},
                 {SPH_WORK, "SPH_WORK"},           {SPH_DST_SWEEP, "SPH_DST_SWEEP"}};
    bool first = true;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (access & words[i].bit) {
            fprintf(out, "%s%s", first ? "" : " | ", words[i].word);
            first = false;
        }
}

/* The constant that stands for a property or a parameter; two that differ by case alone get numbers. */
static void put_constant(FILE *out, const struct names *n, const char *of, const char *name,
                         uint32_t index)
{
    bool low = false;
    fprintf(out, "%s_%s_", n->high, of);
    for (const char *s = name; *s; s++) {
        fputc(toupper((unsigned char)*s), out);
        low = low || isupper((unsigned char)*s);
    }
    if (low)
        fprintf(out, "_%u", index);
}

static void put_prop_constant(FILE *out, const struct names *n, const sph_item *item, uint32_t i)
{
    put_constant(out, n, "AT", ((const sph_prop *)list_at(&item->props, i))->name, i);
}

static void put_param_constant(FILE *out, const struct names *n, const sph_item *item, uint32_t i)
{
    put_constant(out, n, "SET", ((const sph_param *)list_at(&item->params, i))->name, i);
}

static void put_enum(FILE *out, const struct names *n, const sph_item *item, const sph_list *list,
                     void (*put)(FILE *, const struct names *, const sph_item *, uint32_t))
{
    fputs("enum {\n", out);
    for (uint32_t i = 0; i < list->count; i++) {
        fputs("    ", out);
        put(out, n, item, i);
        fputs(",\n", out);
    }
    fputs("};\n", out);
}

static void put_props(FILE *out, const struct names *n, const sph_item *item)
{
    if (item->props.count == 0)
        return;
    put_enum(out, n, item, &item->props, put_prop_constant);
    fprintf(out, "static const sph_prop %s_props[] = {\n", n->low);
    for (uint32_t i = 0; i < item->props.count; i++) {
        const sph_prop *p = list_at(&item->props, i);
        fputs("    SPH_PROP(", out);
        put_string(out, p->name);
        fputs(", ", out);
        put_string(out, p->unit);
        fputs(", ", out);
        put_string(out, p->doc);
        fprintf(out, ", %s,\n             ", type_constant[p->type]);
        put_access(out, p->access);
        fputs(", ", out);
        put_number(out, p->start);
        fputs("),\n", out);
    }
    fputs("};\n\n", out);
}

static void put_params(FILE *out, const struct names *n, const sph_item *item)
{
    if (item->params.count == 0)
        return;
    put_enum(out, n, item, &item->params, put_param_constant);
    fprintf(out, "static const sph_param %s_params[] = {\n", n->low);
    for (uint32_t i = 0; i < item->params.count; i++) {
        const sph_param *p = list_at(&item->params, i);
        const double number[] = {p->def, p->min, p->max};
        fputs("    SPH_PARAM(", out);
        put_string(out, p->name);
        fputs(", ", out);
        put_string(out, p->unit);
        fputs(", ", out);
        put_string(out, p->doc);
        for (int k = 0; k < 3; k++) {
            fputs(", ", out);
            put_number(out, number[k]);
        }
        fputs("),\n", out);
    }
    fputs("};\n\n", out);
}

/* -- Loops ----------------------------------------------------------------------------------- */

/* "#define SPH_LOOP_I(S_, V_, M_) S_(rho, DRAG_AT_RHO) ..."; `how` 3: words for all three types, 1: for scalars,
 * 0: types as words of point-loop.h. */
static void put_values(FILE *out, const struct names *n, const sph_item *item, const char *macro,
                       const sph_list *list, int how)
{
    if (list->count == 0)
        return;
    fprintf(out, "#define %s(%s)", macro, how == 3 ? "S_, V_, M_" : how == 1 ? "S_" : "P_");
    for (uint32_t i = 0; i < list->count; i++) {
        const sph_device_value *v = list_at(list, i);
        if (how == 0)
            fprintf(out, " \\\n    P_(%s, %s, ", type_word[v->type], v->name);
        else
            fprintf(out, " \\\n    %s(%s, ",
                    v->type == SPH_VECTOR   ? "V_"
                    : v->type == SPH_MATRIX ? "M_"
                                            : "S_",
                    v->name);
        put_prop_constant(out, n, item, v->index);
        fputc(')', out);
    }
    fputc('\n', out);
}

static void put_numbers(FILE *out, const struct names *n, const sph_item *item, const char *macro,
                        const sph_list *list)
{
    if (list->count == 0)
        return;
    fprintf(out, "#define %s(P_)", macro);
    for (uint32_t i = 0; i < list->count; i++) {
        const sph_device_value *v = list_at(list, i);
        fprintf(out, " \\\n    P_(%s, ", v->name);
        put_param_constant(out, n, item, v->index);
        fputc(')', out);
    }
    fputc('\n', out);
}

static void put_files(FILE *out, const char *macro, const char *file, const char *prelude)
{
    fprintf(out, "#define %s_BODY \"%s\"\n", macro, base_of(file));
    if (prelude)
        fprintf(out, "#define %s_PRELUDE \"%s\"\n#include \"%s\"\n", macro, base_of(prelude),
                base_of(prelude));
}

static void put_pair(FILE *out, const struct names *n, const sph_function *f)
{
    const sph_device_body *d = f->device;
    fprintf(out,
            "/* Of a pair: the loops over neighbours are made of the body. */\n"
            "#define SPH_LOOP %s_run\n",
            n->low);
    put_values(out, n, f->item, "SPH_LOOP_I", &d->i, 3);
    put_values(out, n, f->item, "SPH_LOOP_J", &d->j, 3);
    put_values(out, n, f->item, "SPH_LOOP_SUM", &d->sum, 3);
    put_values(out, n, f->item, "SPH_LOOP_MIN", &d->min, 1);
    put_values(out, n, f->item, "SPH_LOOP_MAX", &d->max, 1);
    put_numbers(out, n, f->item, "SPH_LOOP_PARAM", &d->param);
    fprintf(out, "#define SPH_LOOP_REACH %s\n#define SPH_LOOP_SELF %u\n",
            d->reach == SPH_GATHER ? "SPH_GATHER" : "SPH_SYMMETRIC", d->self);
    put_files(out, "SPH_LOOP", d->file, d->prelude_file);
    if (f->reals & SPH_F32)
        fputs("#define SPH_LOOP_F32\n", out);
    fprintf(out, "#define SPH_LOOP_DEVICE %s_on_device\n#include <sph/pair-loop.h>\n\n", n->low);
}

static void put_point(FILE *out, const struct names *n, const sph_function *f, const char *which,
                      const sph_device_point *d)
{
    if (!d)
        return;
    fprintf(out, "/* Of one particle. */\n#define SPH_POINT_LOOP %s_%s\n", n->low, which);
    put_values(out, n, f->item, "SPH_POINT_IN", &d->in, 0);
    put_values(out, n, f->item, "SPH_POINT_OUT", &d->out, 0);
    put_values(out, n, f->item, "SPH_POINT_INOUT", &d->inout, 0);
    put_numbers(out, n, f->item, "SPH_POINT_PARAM", &d->param);
    if (d->h)
        fputs("#define SPH_POINT_H\n", out);
    for (uint32_t i = 0; i < d->fail.count; i++) {
        fputs(i ? ", " : "#define SPH_POINT_FAIL ", out);
        put_string(out, *(const char *const *)list_at(&d->fail, i));
    }
    if (d->fail.count)
        fputc('\n', out);
    put_files(out, "SPH_POINT", d->file, d->prelude_file);
    fprintf(out, "#define SPH_POINT_DEVICE %s_%s_on_device\n#include <sph/point-loop.h>\n\n",
            n->low, which);
}

/* -- A function ------------------------------------------------------------------------------ */

static void put_rates(FILE *out, const struct names *n, const sph_function *f)
{
    if (f->rates.count == 0)
        return;
    fprintf(out, "static const sph_rate %s_rates[] = {\n", n->low);
    for (uint32_t i = 0; i < f->rates.count; i++) {
        const sph_rate *r = list_at(&f->rates, i);
        fprintf(out, "    SPH_RATE(\"%s\", \"%s\", %s),\n", r->property, r->rate,
                r->kind == SPH_DRIFT ? "SPH_DRIFT" : "SPH_KICK");
    }
    fputs("};\n", out);
}

static void put_reductions(FILE *out, const struct names *n, const sph_function *f)
{
    static const char *const ops[] = {"", "SPH_REDUCE_MIN", "SPH_REDUCE_MAX", "SPH_REDUCE_SUM"};
    static const char *const uses[] = {"SPH_USE_NONE", "SPH_USE_TIME_STEP", "SPH_USE_INTERNAL",
                                       "SPH_USE_POTENTIAL"};
    if (f->reductions.count == 0)
        return;
    fprintf(out, "static const sph_reduction %s_reductions[] = {\n", n->low);
    for (uint32_t i = 0; i < f->reductions.count; i++) {
        const sph_reduction *r = list_at(&f->reductions, i);
        fprintf(out, "    SPH_REDUCTION(\"%s\", \"%s\", %s, %s),\n", r->name, r->property,
                ops[r->op], uses[r->use]);
    }
    fputs("};\n", out);
}

static void put_item(FILE *out, const struct names *n, const sph_item *item)
{
    fprintf(out,
            "static const sph_item %s_item = {\n    .size = SIZE(sph_item),\n    .dims = ", n->low);
    for (int d = 1, first = 1; d <= 3; d++)
        if (item->dims & (1u << d)) {
            fprintf(out, "%sSPH_DIM%d", first ? "" : " | ", d);
            first = 0;
        }
    fprintf(out, ",\n    .name = \"%s\",\n    .doc = ", item->name);
    put_string(out, item->doc);
    fputs(",\n    .source = ", out);
    put_string(out, item->source);
    fputs(",\n", out);
    if (item->params.count)
        fprintf(out, "    .params = SPH_LIST(%s_params),\n", n->low);
    if (item->props.count)
        fprintf(out, "    .props = SPH_LIST(%s_props),\n", n->low);
    fputs("};\n", out);
}

static void put_descriptor(FILE *out, const struct names *n, const sph_function *f)
{
    const bool pair = f->shape == SPH_PAIR;
    fprintf(out,
            "static const sph_function %s_function = {\n    .size = SIZE(sph_function),\n"
            "    .shape = %s,\n    .item = &%s_item,\n    .run = %s_run,\n",
            n->low, pair ? "SPH_PAIR" : "SPH_POINT", n->low, n->low);
    if (f->before)
        fprintf(out, "    .before = %s_before,\n", n->low);
    if (f->after)
        fprintf(out, "    .after = %s_after,\n", n->low);
    if (pair)
        fprintf(out, "    .reach = %s,\n", f->reach == SPH_GATHER ? "SPH_GATHER" : "SPH_SYMMETRIC");
    fputs("    .reach_scale = ", out);
    put_number(out, f->reach_scale);
    fputs(",\n", out);
    if (f->rates.count)
        fprintf(out, "    .rates = SPH_LIST(%s_rates),\n", n->low);
    if (f->reductions.count)
        fprintf(out, "    .reductions = SPH_LIST(%s_reductions),\n", n->low);
    if (pair)
        fprintf(out, "    .device = &%s_on_device,\n", n->low);
    if (f->reals & SPH_F32)
        fputs("    .reals = SPH_F64 | SPH_F32,\n", out);
    if (f->device_run)
        fprintf(out, "    .device_run = &%s_run_on_device,\n", n->low);
    if (f->device_before)
        fprintf(out, "    .device_before = &%s_before_on_device,\n", n->low);
    if (f->device_after)
        fprintf(out, "    .device_after = &%s_after_on_device,\n", n->low);
    fputs("};\n\n", out);
}

static void put_function(FILE *out, const sph_function *f)
{
    const struct names n = names_of(f->item->name);
    fprintf(out, "/* -- %s -------- */\n\n", f->item->name);
    put_props(out, &n, f->item);
    put_params(out, &n, f->item);
    put_point(out, &n, f, "before", f->device_before);
    if (f->device)
        put_pair(out, &n, f);
    put_point(out, &n, f, "run", f->device_run);
    put_point(out, &n, f, "after", f->device_after);
    put_rates(out, &n, f);
    put_reductions(out, &n, f);
    put_item(out, &n, f->item);
    put_descriptor(out, &n, f);
}

int from_source(const struct from *f, const char *name, FILE *out)
{
    fprintf(out, "/* %s.c -- made of bodies that a scene brought (%s):\n", name, base_of(f->scene));
    for (size_t i = 0; i < f->n; i++) {
        fprintf(out, " *   \"%s\"  ", f->entry[i]->item->name);
        put_comment(out, f->entry[i]->item->doc);
        fputc('\n', out);
    }
    fputs(
        " * Each body is compiled into loops for this processor, and its text goes along for OpenCL\n"
        " * devices: both give the same numbers. What it may hold is told in sph/pair-loop.h and\n"
        " * sph/point-loop.h, what a function declares in sph/item.h and sph/function.h. */\n"
        "#include <math.h>\n#include <sph/plugin.h>\n\n"
        "#define SIZE(type) (uint32_t)sizeof(type)\n\n",
        out);
    for (size_t i = 0; i < f->n; i++)
        put_function(out, entry_function(f->entry[i]));
    fputs("/* -- The plugin -------- */\n\n"
          "static sph_status init(const sph_host *host)\n{\n"
          "    static const sph_function *const functions[] = {\n",
          out);
    for (size_t i = 0; i < f->n; i++)
        fprintf(out, "        &%s_function,\n", names_of(f->entry[i]->item->name).low);
    fputs("    };\n"
          "    for (size_t i = 0; i < sizeof(functions) / sizeof(functions[0]); i++) {\n"
          "        const sph_status status =\n"
          "            host->register_item(host, SPH_KIND_FUNCTION, functions[i]);\n"
          "        if (status != SPH_OK)\n            return status;\n    }\n"
          "    return SPH_OK;\n}\n\n",
          out);
    fprintf(out, "SPH_PLUGIN(\"%s\", \"0.1\", \"BSD-3-Clause\", ", name);
    put_string(out, f->n == 1 ? f->entry[0]->item->doc : "functions of a scene");
    fputs(", init, NULL)\n", out);
    return ferror(out) ? -1 : 0;
}
