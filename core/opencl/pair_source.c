/* opencl/pair_source.c -- writes the OpenCL C of a sweep (see pair_source.h). A work item is a
 * destination, R is one double: the words of sph/lanes.h and the loop of sph/pair-group.h, in
 * the same order of operations, so that the numbers differ by rounding alone. Keep it in step
 * with those two. */
#include "config.h"

#include "opencl/pair_source.h"

#include "opencl/math_text.h"
#include <sph/function.h>
#include <sph/kernel-value.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -- Words -------- */

/* Those of words.cl for one double; of the kernel W, whose form is known only when the sweep runs, others in their
 * place. */
static const char *const set[] = {
    "#define SPH_ISA f64x1",
    "#define SPH_WIDTH 1",
    "#define SPH_F32_WORDS 0",
};

static const char *const other_words[] = {
    "#undef SPH_FORM",
    "#undef SPH_ADDED",
    "#undef SPH_TAKEN",
    "#undef sph_w",
    "#undef sph_dw",
    "#undef sph_dw_q",
    "#undef sph_grad",
    "typedef struct { ulong first; uint base; ushort count, common; } sph_span;",
};

static const char *const kernel_words[] = {
    "typedef struct {",
    "    double knot;",
    "    uint power, n_coef, dpower, dn_coef;",
    "    double c[6], d[6], e[6];",
    "} sph_kernel_piece;",
    "typedef struct {",
    "    double support, norm, cells;",
    "    uint n_table, n_pieces, en_coef, reserved;",
    "    sph_kernel_piece piece[4];",
    "} sph_kernel_form;",
    "#define SPH_FORM __constant sph_kernel_form",
    "static R sph_sum_of_powers(R t, uint power, uint n, __constant double *c)",
    "{",
    "    R sum = c[n - 1];",
    "    for (uint k = n - 1; k-- > 0;)",
    "        sum = sum * t + c[k];",
    "    return sum * sph_ipow(t, power);",
    "}",
    "static R sph_cubic(SPH_FORM *form, __global const double *table, R q, int slope)",
    "{",
    "    if (!(q >= 0.0 && q < form->support))",
    "        return 0.0;",
    "    const double cell = q * form->cells;",
    "    const uint k = cell < form->n_table - 1 ? (uint)cell : form->n_table - 1;",
    "    __global const double *p = table + 2 * (ulong)k;",
    "    const double t = cell - k;",
    "    const double c2 = 3.0 * (p[2] - p[0]) - 2.0 * p[1] - p[3];",
    "    const double c3 = p[1] + p[3] - 2.0 * (p[2] - p[0]);",
    "    return form->norm * (slope ? form->cells * (p[1] + t * (2.0 * c2 + 3.0 * c3 * t))",
    "                               : p[0] + t * (p[1] + t * (c2 + c3 * t)));",
    "}",
    "static R sph_value(SPH_FORM *form, __global const double *table, R q)",
    "{",
    "    R sum = 0.0;",
    "    if (form->n_table)",
    "        return sph_cubic(form, table, q, 0);",
    "    for (uint k = 0; k < form->n_pieces; k++) {",
    "        __constant sph_kernel_piece *p = &form->piece[k];",
    "        sum += sph_sum_of_powers(sph_max(p->knot - q, 0.0), p->power, p->n_coef, p->c);",
    "    }",
    "    return sum;",
    "}",
    "static R sph_slope(SPH_FORM *form, __global const double *table, R q)",
    "{",
    "    R sum = 0.0;",
    "    if (form->n_table)",
    "        return sph_cubic(form, table, q, 1);",
    "    for (uint k = 0; k < form->n_pieces; k++) {",
    "        __constant sph_kernel_piece *p = &form->piece[k];",
    "        const R t = sph_max(p->knot - q, 0.0);",
    "        const R d = sph_sum_of_powers(t, p->dpower, p->dn_coef, p->d);",
    "        sum += t > 0.0 ? d : 0.0;",
    "    }",
    "    return sum;",
    "}",
    "static R sph_slope_over_q(SPH_FORM *form, __global const double *table, R q)",
    "{",
    "    __constant sph_kernel_piece *p = &form->piece[0];",
    "    if (form->en_coef)",
    "        return sph_sum_of_powers(sph_max(p->knot - q, 0.0), p->dpower, form->en_coef, p->e);",
    "    return q > 0.0 ? sph_slope(form, table, q) / q : 0.0;",
    "}",
    "#define sph_w(form, q) sph_value((form), sph_table, (q))",
    "#define sph_dw(form, q) sph_slope((form), sph_table, (q))",
    "#define sph_dw_q(form, q) sph_slope_over_q((form), sph_table, (q))",
    "#define sph_grad(form, weight, r, hinv) \\",
    "    ((weight) * sph_ipow((hinv), DIM + 2) * sph_dw_q((form), (r) * (hinv)))",
    "",
};

/* Between the values of the destination and those of a source. */
static const char *const pair_words[] = {
    "    for (ulong sph_s = sph_begin[sph_g] - sph_base; sph_s < sph_begin[sph_g + 1] - sph_base;",
    "         sph_s++)",
    "    for (uint sph_k = 0; 2 * sph_k < sph_spans[sph_s].count + sph_spans[sph_s].common; sph_k++) {",
    "        const sph_span sph_some = sph_spans[sph_s];",
    "        const uint sph_at = sph_k < sph_some.common ? sph_k",
    "                                                    : 2 * sph_k - sph_some.common + sph_half;",
    "        const ulong sph_j =",
    "            (ulong)sph_some.base + sph_list[sph_some.first - sph_least + sph_at];",
    "        R dx[DIM];",
    "        R r2 = 0.0;",
    "        for (int sph_c = 0; sph_c < DIM; sph_c++) {",
    "            dx[sph_c] = sph_x_i[sph_c] - sph_xs[sph_c * sph_n_src + sph_j];",
    "            r2 += dx[sph_c] * dx[sph_c];",
    "        }",
    "        const R h_j = sph_hs[sph_j];",
    "        const R sph_reach = K->support * SPH_REACH;",
    "        B in = r2 < sph_reach * sph_reach;",
    "        if (!SPH_SELF)",
    "            in &= !(sph_same && sph_first + sph_i == sph_j);",
    "        const R r = sph_sqrt(r2);",
    "        const R rinv = sph_rsqrt(r2);",
    "        const R hinv_j = 1.0 / h_j;",
};

static void put(FILE *out, const char *const *line, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fprintf(out, "%s\n", line[i]);
}
#define PUT(out, lines) put((out), (lines), sizeof(lines) / sizeof((lines)[0]))

/* -- Columns -------- */

static const sph_device_value *value_at(const sph_list *list, uint32_t k)
{
    return (const sph_device_value *)(const void *)((const char *)list->data +
                                                    (size_t)k * list->stride);
}

static void add_columns(struct pair_column *column, size_t *n, const sph_list *list, bool source,
                        bool written)
{
    for (uint32_t k = 0; k < list->count; k++) {
        const sph_device_value *v = value_at(list, k);
        size_t i = 0;
        while (i < *n && !(column[i].index == v->index && column[i].source == source))
            i++;
        if (i == *n)
            column[(*n)++] = (struct pair_column){v->index, v->type, source, false};
        column[i].written |= written;
    }
}

int pair_columns(struct pair_column **out, size_t *n, const sph_device_body *d, struct error *e)
{
    const size_t most =
        (size_t)d->i.count + d->j.count + d->sum.count + d->min.count + d->max.count;

    *n = 0;
    *out = calloc(most + 1, sizeof(**out));
    if (!*out)
        return error_memory(e, "a list of columns", most * sizeof(**out));
    add_columns(*out, n, &d->i, false, false);
    add_columns(*out, n, &d->sum, false, true);
    add_columns(*out, n, &d->min, false, true);
    add_columns(*out, n, &d->max, false, true);
    add_columns(*out, n, &d->j, true, false);
    return 0;
}

/* -- The form of W -------- */

void pair_form(struct pair_form *out, const sph_kernel_form *form)
{
    *out = (struct pair_form){.support = form->support,
                              .norm = form->norm,
                              .cells = form->cells,
                              .n_table = form->n_table,
                              .n_pieces = form->n_pieces};
    for (uint32_t k = 0; k < form->n_pieces; k++) {
        const sph_kernel_piece *p = &form->piece[k];
        out->piece[k].knot = p->knot;
        out->piece[k].power = p->power;
        out->piece[k].n_coef = p->n_coef;
        out->piece[k].dpower = p->dpower;
        out->piece[k].dn_coef = p->dn_coef;
        for (uint32_t n = 0; n < SPH_KERNEL_COEFS; n++) {
            out->piece[k].c[n] = p->c[n] * form->norm;
            out->piece[k].d[n] = p->d[n] * form->norm;
        }
    }
    if (form->n_pieces == 1 && !form->n_table) {
        double e[SPH_KERNEL_COEFS];
        out->en_coef = sph_kernel_over_q(&form->piece[0], e);
        for (uint32_t n = 0; n < out->en_coef; n++)
            out->piece[0].e[n] = e[n] * form->norm;
    }
}

/* -- The kernel -------- */

/* "", "[DIM]", "[DIM * DIM]", and the number of components. */
static const char *extent(uint32_t type)
{
    return type == SPH_VECTOR ? "[DIM]" : type == SPH_MATRIX ? "[DIM * DIM]" : "";
}

static const char *components(uint32_t type)
{
    return type == SPH_VECTOR ? "DIM" : type == SPH_MATRIX ? "DIM * DIM" : "1";
}

static void put_arguments(FILE *out, const struct pair_column *column, size_t n)
{
    fputs("__kernel void " PAIR_KERNEL "(\n"
          "    const ulong sph_count, const ulong sph_n_src, const ulong sph_first,\n"
          "    const ulong sph_base, const ulong sph_least, const uint sph_same,\n"
          "    const uint sph_absolute,\n"
          "    const double sph_time, const double sph_dt, const ulong sph_step,\n"
          "    __global const ulong *sph_begin, __global const sph_span *sph_spans,\n"
          "    __global const ushort *sph_list, SPH_FORM *K,\n"
          "    __global const double *sph_table, __global const double *sph_param,\n"
          "    __global const double *sph_xd, __global const double *sph_hd,\n"
          "    __global const double *sph_xs, __global const double *sph_hs",
          out);
    for (size_t k = 0; k < n; k++)
        fprintf(out, ",\n    __global %sdouble *sph_%c%u", column[k].written ? "" : "const ",
                column[k].source ? 's' : 'd', column[k].index);
    fputs(")\n{\n", out);
}

/* name_i or name_j out of their columns. */
static void put_values(FILE *out, const sph_list *list, bool source)
{
    const char side = source ? 's' : 'd', name = source ? 'j' : 'i';
    const char *const plane = source ? "sph_n_src" : "sph_count";

    for (uint32_t k = 0; k < list->count; k++) {
        const sph_device_value *v = value_at(list, k);
        if (v->type == SPH_SCALAR)
            fprintf(out, "    const R %s_%c = sph_%c%u[sph_%c];\n", v->name, name, side, v->index,
                    name);
        else
            fprintf(out,
                    "    R %s_%c%s;\n    for (int sph_c = 0; sph_c < %s; sph_c++)\n"
                    "        %s_%c[sph_c] = sph_%c%u[sph_c * %s + sph_%c];\n",
                    v->name, name, extent(v->type), components(v->type), v->name, name, side,
                    v->index, plane, name);
    }
}

static void put_accumulators(FILE *out, const sph_list *list, const char *start)
{
    for (uint32_t k = 0; k < list->count; k++) {
        const sph_device_value *v = value_at(list, k);
        if (v->type == SPH_SCALAR)
            fprintf(out, "    R %s = %s;\n", v->name, start);
        else
            fprintf(out,
                    "    R %s%s;\n    for (int sph_c = 0; sph_c < %s; sph_c++)\n"
                    "        %s[sph_c] = %s;\n",
                    v->name, extent(v->type), components(v->type), v->name, start);
    }
}

static void put_sums(FILE *out, const sph_list *list)
{
    for (uint32_t k = 0; k < list->count; k++) {
        const sph_device_value *v = value_at(list, k);
        fprintf(out,
                "    for (int sph_c = 0; sph_c < %s; sph_c++)\n"
                "        sph_d%u[sph_c * sph_count + sph_i] += %s%s;\n",
                components(v->type), v->index, v->name, v->type == SPH_SCALAR ? "" : "[sph_c]");
    }
}

static void put_extremes(FILE *out, const sph_list *list, const char *function)
{
    for (uint32_t k = 0; k < list->count; k++) {
        const sph_device_value *v = value_at(list, k);
        fprintf(out, "    sph_d%u[sph_i] = %s(sph_d%u[sph_i], %s);\n", v->index, function, v->index,
                v->name);
    }
}

void pair_source_text(FILE *out, const char *text, const char *file)
{
    fputs("#line 1 \"", out);
    for (const char *s = file; *s; s++)
        fprintf(out, *s == '"' || *s == '\\' ? "\\%c" : "%c", *s);
    fprintf(out, "\"\n%s\n#line 1 \"what sph wrote behind it\"\n", text);
}

static void put_kernel(FILE *out, const sph_device_body *d, const struct pair_column *column,
                       size_t n)
{
    put_arguments(out, column, n);
    fputs("    const ulong sph_i = get_global_id(0);\n"
          "    if (sph_i >= sph_count)\n"
          "        return;\n"
          "    const ulong sph_g = sph_i / SPH_LANES;\n"
          "    const uint sph_half = sph_i % SPH_LANES >= SPH_LANES / 2;\n"
          "    const sph_moment sph_now = {sph_time, sph_dt, sph_step, DIM};\n"
          "    const sph_moment *const b = &sph_now;\n"
          "    R sph_x_i[DIM];\n"
          "    for (int sph_c = 0; sph_c < DIM; sph_c++)\n"
          "        sph_x_i[sph_c] = sph_xd[sph_c * sph_count + sph_i];\n"
          "    const R h_i = sph_hd[sph_i];\n"
          "    const R hinv_i = 1.0 / h_i;\n",
          out);
    for (uint32_t k = 0; k < d->param.count; k++)
        fprintf(out, "    const T %s = sph_param[%u];\n", value_at(&d->param, k)->name,
                value_at(&d->param, k)->index);
    put_values(out, &d->i, false);
    put_accumulators(out, &d->sum, "0.0");
    put_accumulators(out, &d->min, "INFINITY");
    put_accumulators(out, &d->max, "-INFINITY");
    PUT(out, pair_words);
    put_values(out, &d->j, true);
    fputs("    {\n", out);
    pair_source_text(out, d->text, d->file);
    fputs("    }\n    }\n", out);
    put_sums(out, &d->sum);
    put_extremes(out, &d->min, "fmin");
    put_extremes(out, &d->max, "fmax");
    fputs("}\n", out);
}

void pair_source_words(FILE *out)
{
    PUT(out, set);
    pair_source_text(out, words_text, "opencl/words.cl");
    pair_source_text(out, math_text, "sph/lanes-math.h");
    pair_source_text(out, words_end_text, "opencl/words_end.cl");
    PUT(out, other_words);
    PUT(out, kernel_words);
}

char *pair_source(const sph_device_body *d, int dim, bool measured, struct error *e)
{
    struct pair_column *column;
    char *text = NULL;
    size_t n, size;
    FILE *out;
    bool bad;

    if (pair_columns(&column, &n, d, e))
        return NULL;
    out = open_memstream(&text, &size);
    if (!out) {
        free(column);
        error_memory(e, "the source of a sweep", 0);
        return NULL;
    }
    pair_source_words(out);
    fprintf(out, "#define DIM %d\n#define SPH_LANES %u\n#define SPH_SELF %u\n", dim, SPH_LANES,
            d->self);
    fprintf(out, "#define SPH_REACH %s\n", d->reach == SPH_GATHER ? "h_i" : "sph_max(h_i, h_j)");
    /* Where absolute terms are summed, those that are taken off add up with the others. */
    fprintf(out, "#define SPH_ADDED(value) %s\n#define SPH_TAKEN(value) %s\n",
            measured ? "(sph_absolute ? fabs(value) : (value))" : "(value)",
            measured ? "(sph_absolute ? -fabs(value) : (value))" : "(value)");
    if (d->prelude)
        pair_source_text(out, d->prelude, d->prelude_file);
    put_kernel(out, d, column, n);
    bad = ferror(out);
    bad = fclose(out) != 0 || bad;
    free(column);
    if (!bad)
        return text;
    free(text);
    error_memory(e, "the source of a sweep", size);
    return NULL;
}
