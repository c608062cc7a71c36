/* opencl/point_body.c -- writes the OpenCL C around a body of one particle, and runs it (see
 * point_body.h). A work item is a destination. Knows OpenCL by device.h alone. */
#include "config.h"

#include "opencl/point_body.h"

#include "opencl/pair_source.h"
#include "registry/registry.h"

#include <stdlib.h>
#include <string.h>

#define POINT_KERNEL "sph_point"
#define MOST_COLUMNS 64u
/* In front of the columns: see put_kernel. */
enum { COUNT, TIME, DT, STEP, FORM, TABLE, NUMBERS, H, FAILED, ARGUMENTS };

struct point_body {
    const sph_device_point *point;
    struct device *device;
    struct device_program *program;
    struct device_kernel *kernel;
    struct device_buffer form, table, numbers, h, failed, column[MOST_COLUMNS];
    uint32_t n_column;
};

/* -- Source -------- */

static bool is_array(uint32_t type)
{
    return type == SPH_VECTOR || type == SPH_MATRIX || type == SPH_SYM;
}

static const char *components(uint32_t type)
{
    return type == SPH_VECTOR   ? "DIM"
           : type == SPH_MATRIX ? "DIM * DIM"
           : type == SPH_SYM    ? "DIM * (DIM + 1) / 2"
                                : "1";
}

/* The columns are numbered as they come: in, inout, out. */
static void put_values(FILE *out, const sph_list *list, uint32_t number, bool reads, bool begins)
{
    for (uint32_t k = 0; k < list->count; k++, number++) {
        const sph_device_value *v = list_at(list, k);
        const char *at = is_array(v->type) ? "[sph_c]" : "";
        if (begins && is_array(v->type))
            fprintf(out, "    R %s[%s];\n", v->name, components(v->type));
        else if (begins)
            fprintf(out, "    %s %s;\n", v->type == SPH_INT32 ? "int" : "R", v->name);
        if (begins && !reads)
            continue;
        fprintf(out, "    for (int sph_c = 0; sph_c < %s; sph_c++)\n        ", components(v->type));
        if (begins)
            fprintf(out, "%s%s = sph_column%u[sph_c * sph_count + sph_i];\n", v->name, at, number);
        else
            fprintf(out, "sph_column%u[sph_c * sph_count + sph_i] = %s%s;\n", number, v->name, at);
    }
}

static void put_arguments(FILE *out, const sph_list *list, uint32_t number)
{
    for (uint32_t k = 0; k < list->count; k++)
        fprintf(out, ",\n    __global %s *sph_column%u",
                ((const sph_device_value *)list_at(list, k))->type == SPH_INT32 ? "int" : "double",
                number + k);
}

static void put_kernel(FILE *out, const sph_device_point *d)
{
    const uint32_t inout = d->in.count, set = inout + d->inout.count;

    fputs("#define sph_fail(k) (*sph_failed = (int)(k) + 1)\n"
          "__kernel void " POINT_KERNEL "(\n"
          "    const ulong sph_count, const double sph_time, const double sph_dt,\n"
          "    const ulong sph_step, SPH_FORM *K, __global const double *sph_table,\n"
          "    __global const double *sph_numbers, __global const double *sph_h,\n"
          "    __global int *sph_failed",
          out);
    put_arguments(out, &d->in, 0);
    put_arguments(out, &d->inout, inout);
    put_arguments(out, &d->out, set);
    fputs(")\n{\n"
          "    const ulong sph_i = get_global_id(0);\n"
          "    if (sph_i >= sph_count)\n"
          "        return;\n"
          "    const sph_moment sph_now = {sph_time, sph_dt, sph_step, DIM};\n"
          "    const sph_moment *const b = &sph_now;\n",
          out);
    if (d->h)
        fputs("    const R h = sph_h[sph_i];\n", out);
    for (uint32_t k = 0; k < d->param.count; k++)
        fprintf(out, "    const T %s = sph_numbers[%u];\n",
                ((const sph_device_value *)list_at(&d->param, k))->name, k);
    for (uint32_t k = 0; k < d->state.count; k++)
        fprintf(out, "    const T %s = sph_numbers[%u];\n",
                ((const sph_device_value *)list_at(&d->state, k))->name, d->param.count + k);
    put_values(out, &d->in, 0, true, true);
    put_values(out, &d->inout, inout, true, true);
    put_values(out, &d->out, set, false, true);
    fputs("    {\n", out);
    pair_source_text(out, d->text, d->file);
    fputs("    }\n", out);
    put_values(out, &d->inout, inout, true, false);
    put_values(out, &d->out, set, true, false);
    fputs("}\n", out);
}

static char *source_of(const sph_device_point *d, int dim, struct error *e)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    bool bad;

    if (!out) {
        error_memory(e, "the source of a body", 0);
        return NULL;
    }
    pair_source_words(out);
    fprintf(out, "#define DIM %d\n", dim);
    if (d->prelude)
        pair_source_text(out, d->prelude, d->prelude_file);
    put_kernel(out, d);
    bad = ferror(out);
    bad = fclose(out) != 0 || bad;
    if (!bad)
        return text;
    free(text);
    error_memory(e, "the source of a body", size);
    return NULL;
}

int point_body_build(struct point_body **out, struct device *d, const sph_device_point *point,
                     int dim, struct error *e)
{
    struct point_body *p = calloc(1, sizeof(*p));
    char *source = p ? source_of(point, dim, e) : NULL;
    int status = -1;

    *out = NULL;
    if (!p)
        return error_memory(e, "a body", sizeof(*p));
    *p = (struct point_body){.point = point, .device = d};
    p->n_column = point->in.count + point->inout.count + point->out.count;
    if (p->n_column > MOST_COLUMNS)
        error_set(e, EXIT_RUN, "the body \"%s\" has more than %u properties", point->file,
                  MOST_COLUMNS);
    else if (source)
        status = device_build(d, &p->program, source, "-cl-std=CL1.2", point->file, e) ||
                         device_kernel(d, p->program, POINT_KERNEL, NULL, &p->kernel, e)
                     ? -1
                     : 0;
    free(source);
    if (status) {
        point_body_free(p);
        return -1;
    }
    *out = p;
    return 0;
}

void point_body_free(struct point_body *p)
{
    if (!p)
        return;
    struct device_buffer *const own[] = {&p->form, &p->table, &p->numbers, &p->h, &p->failed};
    for (size_t k = 0; k < sizeof(own) / sizeof(own[0]); k++)
        device_release(p->device, own[k]);
    for (uint32_t k = 0; k < p->n_column && k < MOST_COLUMNS; k++)
        device_release(p->device, &p->column[k]);
    if (p->program)
        device_program_free(p->device, p->program);
    free(p);
}

/* -- Run -------- */

static int give(struct point_body *p, struct device_buffer *to, const void *data, size_t bytes,
                struct error *e)
{
    if (device_reserve(p->device, to, bytes ? bytes : sizeof(double), "a body's numbers", e))
        return -1;
    return bytes ? device_write(p->device, to, 0, data, bytes, e) : 0;
}

static int give_numbers(struct point_body *p, const sph_batch *b, struct error *e)
{
    const sph_device_point *d = p->point;
    const size_t n = (size_t)d->param.count + d->state.count;
    double *number = calloc(n + 1, sizeof(*number));
    int status;

    if (!number)
        return error_memory(e, "a body's numbers", n * sizeof(*number));
    for (uint32_t k = 0; k < d->param.count; k++)
        number[k] = b->param[((const sph_device_value *)list_at(&d->param, k))->index];
    for (uint32_t k = 0; k < d->state.count; k++)
        number[d->param.count + k] =
            ((const double *)b->state)[((const sph_device_value *)list_at(&d->state, k))->index];
    status = give(p, &p->numbers, number, (n + 1) * sizeof(*number), e);
    free(number);
    return status;
}

/* W = 0 where there is no kernel. */
static int give_form(struct point_body *p, const sph_batch *b, struct error *e)
{
    struct pair_form form = {0};

    if (b->kernel)
        pair_form(&form, b->kernel);
    return give(p, &p->form, &form, sizeof(form), e) ||
                   give(p, &p->table, b->kernel ? b->kernel->table : NULL,
                        form.n_table ? 2 * ((size_t)form.n_table + 1) * sizeof(double) : 0, e)
               ? -1
               : 0;
}

/* Elements of the batch's range, packed: there, or back. */
static int move_columns(struct point_body *p, const sph_batch *b, const sph_list *list,
                        uint32_t number, bool back, struct error *e)
{
    for (uint32_t k = 0; k < list->count; k++) {
        const sph_device_value *v = list_at(list, k);
        const sph_column *c = &b->dst[v->index];
        const size_t size = v->type == SPH_INT32 ? sizeof(int32_t) : sizeof(double);
        const size_t bytes = (size_t)b->count * size;
        struct device_buffer *buffer = &p->column[number + k];
        if (!c->data)
            return error_set(e, EXIT_RUN, "a column that the body needs is not in the batch");
        if (!back && device_reserve(p->device, buffer, bytes * c->ncomp, "a body's columns", e))
            return -1;
        for (uint32_t n = 0; n < c->ncomp; n++) {
            char *host = (char *)c->data + (n * c->plane + b->first) * size;
            if (back ? device_read(p->device, buffer, n * bytes, host, bytes, e)
                     : device_write(p->device, buffer, n * bytes, host, bytes, e))
                return -1;
        }
    }
    return 0;
}

static int launch(struct point_body *p, const sph_batch *b, struct error *e)
{
    struct device_arg arg[ARGUMENTS + MOST_COLUMNS];

    arg[COUNT] = DEVICE_VALUE(b->count);
    arg[TIME] = DEVICE_VALUE(b->time);
    arg[DT] = DEVICE_VALUE(b->dt);
    arg[STEP] = DEVICE_VALUE(b->step);
    arg[FORM] = DEVICE_BUFFER(&p->form);
    arg[TABLE] = DEVICE_BUFFER(&p->table);
    arg[NUMBERS] = DEVICE_BUFFER(&p->numbers);
    arg[H] = DEVICE_BUFFER(&p->h);
    arg[FAILED] = DEVICE_BUFFER(&p->failed);
    for (uint32_t k = 0; k < p->n_column; k++)
        arg[ARGUMENTS + k] = DEVICE_BUFFER(&p->column[k]);
    return device_launch(p->device, p->kernel, (size_t)b->count, arg, ARGUMENTS + p->n_column, e);
}

int point_body_run(struct point_body *p, const sph_batch *b, uint32_t *failed, struct error *e)
{
    const sph_device_point *d = p->point;
    const uint32_t inout = d->in.count, set = inout + d->inout.count;
    const double *h = d->h ? (const double *)b->h_dst.data + b->first : NULL;

    *failed = 0;
    if (b->real != SPH_F64 || (d->h && !b->h_dst.data))
        return error_set(e, EXIT_RUN, "the batch is not one of doubles%s",
                         d->h ? " with smoothing lengths" : "");
    if (b->count == 0)
        return 0;
    if (give_numbers(p, b, e) || give_form(p, b, e) ||
        give(p, &p->failed, failed, sizeof(*failed), e) ||
        give(p, &p->h, h, h ? (size_t)b->count * sizeof(double) : 0, e) ||
        move_columns(p, b, &d->in, 0, false, e) || move_columns(p, b, &d->inout, inout, false, e) ||
        move_columns(p, b, &d->out, set, false, e) || launch(p, b, e))
        return -1;
    return device_read(p->device, &p->failed, 0, failed, sizeof(*failed), e) ||
                   move_columns(p, b, &d->inout, inout, true, e) ||
                   move_columns(p, b, &d->out, set, true, e)
               ? -1
               : 0;
}
