/* plan/assignment.c -- an assignment that the scene writes as an expression of the particle's own scalars: made
 * into a point function of the core's own, with declared reads and writes like any other. */
#include "plan/inside.h"
#include "scene/expression.h"
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_VARIABLES 32

/* Variables that every expression may use besides the array's columns. */
static const char *const always[] = {"x", "y", "z", "r", "t"};
#define N_ALWAYS (sizeof always / sizeof always[0])

struct assignment {
    sph_item item;
    sph_prop prop[MOST_VARIABLES];
    struct expression *expression;
    uint32_t n_read; /* props: n_read scalars, then x, then the one that is written */
    char *device_text, *device_name[MOST_VARIABLES];
    sph_device_value device_in[MOST_VARIABLES], device_out;
    sph_device_point device; /* text NULL: there is none */
};

#define PREFIX "sph_of_" /* of the expression's names on a device, which keeps some for itself */

static sph_status assign(const sph_batch *b)
{
    const struct assignment *a = b->state;
    const sph_column *x = &b->dst[a->n_read], *out = &b->dst[a->n_read + 1];
    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        double value[N_ALWAYS + MOST_VARIABLES] = {0.0};
        double r2 = 0.0;
        for (uint32_t c = 0; c < b->dim; c++) {
            value[c] = ((const double *)x->data)[c * x->plane + i];
            r2 += value[c] * value[c];
        }
        value[3] = sqrt(r2);
        value[4] = b->time;
        for (uint32_t k = 0; k < a->n_read; k++)
            value[N_ALWAYS + k] = ((const double *)b->dst[k].data)[i];
        double result = expression_at(a->expression, value);
        if (out->type == SPH_INT32)
            ((int32_t *)out->data)[i] = (int32_t)lrint(result);
        else
            ((double *)out->data)[i] = result;
    }
    return SPH_OK;
}

static bool mentions(const char *text, const char *name)
{
    size_t length = strlen(name);
    for (const char *at = strstr(text, name); at; at = strstr(at + 1, name)) {
        bool before = at > text && (isalnum((unsigned char)at[-1]) || at[-1] == '_');
        bool after = isalnum((unsigned char)at[length]) || at[length] == '_';
        if (!before && !after)
            return true;
    }
    return false;
}

/* The array's scalars that the text mentions become reads. */
static void find_reads(struct assignment *a, const struct particles *p, const char *text)
{
    for (size_t c = 0; c < p->n_column && a->n_read < MOST_VARIABLES - 2; c++) {
        const struct column *column = &p->column[c];
        bool reserved = false;
        for (size_t k = 0; k < N_ALWAYS; k++)
            reserved = reserved || strcmp(column->name, always[k]) == 0;
        if (column->type == SPH_SCALAR && !reserved && mentions(text, column->name))
            a->prop[a->n_read++] =
                (sph_prop){column->name, column->unit, column->doc, SPH_SCALAR, SPH_DST_READ, 0.0};
    }
}

/* The same for a device, where the expression can be told in its language. */
static int make_device(struct assignment *a, const struct plan *plan, const struct step *s,
                       const char *const *name, struct error *e)
{
    static const char *const axis[] = {"x", "y", "z"};
    const uint32_t n = a->n_read;
    const sph_prop *target = &a->prop[n + 1];
    char *c = expression_c(a->expression, s->expression, name, N_ALWAYS + n, PREFIX), *text = NULL;
    size_t size = 0;
    FILE *out = c ? open_memstream(&text, &size) : NULL;

    if (!out) {
        free(c);
        return 0; /* it is computed on the processor */
    }
    for (int k = 0; k < 3; k++)
        if (k < plan->dim)
            fprintf(out, "const double " PREFIX "%s = sph_place[%d];\n", axis[k], k);
        else
            fprintf(out, "const double " PREFIX "%s = 0.0;\n", axis[k]);
    fprintf(out,
            "const double " PREFIX "r = sqrt(" PREFIX "x * " PREFIX "x + " PREFIX "y * " PREFIX
            "y + " PREFIX "z * " PREFIX "z), " PREFIX "t = b->time;\nsph_assigned = %s%s%s;\n",
            target->type == SPH_INT32 ? "(int)rint(" : "", c, target->type == SPH_INT32 ? ")" : "");
    free(c);
    if (fclose(out) != 0)
        return error_memory(e, "an assignment", size);
    a->device_text = text;
    for (uint32_t k = 0; k < n; k++) {
        if (plan_name(&a->device_name[k], e, PREFIX "%s", a->prop[k].name))
            return -1;
        a->device_in[k] = (sph_device_value){a->device_name[k], k, SPH_SCALAR};
    }
    a->device_in[n] = (sph_device_value){"sph_place", n, SPH_VECTOR};
    a->device_out = (sph_device_value){"sph_assigned", n + 1, target->type};
    a->device = (sph_device_point){.size = sizeof a->device,
                                   .text = a->device_text,
                                   .file = "an expression of the scene",
                                   .in = {a->device_in, n + 1, sizeof a->device_in[0]},
                                   .out = {&a->device_out, 1, sizeof a->device_out}};
    return 0;
}

const sph_device_point *assignment_device(const struct assignment *a)
{
    return a->device.text ? &a->device : NULL;
}

static int make(struct assignment *a, const struct plan *plan, const struct step *s, size_t array,
                struct error *e)
{
    const struct particles *p = &plan->array[array].p;
    const struct document *d = plan->scene->doc;
    int target = particles_find(p, s->of);
    if (target < 0)
        return document_fail(d, s->node, e, "array \"%s\" has no property \"%s\" to assign to",
                             p->name, s->of);
    const struct column *column = &p->column[target];
    if (column->type != SPH_SCALAR && column->type != SPH_INT32)
        return document_fail(d, s->node, e,
                             "\"%s\" is no scalar: an expression cannot be assigned to it", s->of);
    find_reads(a, p, s->expression);
    uint32_t n = a->n_read;
    a->prop[n] = (sph_prop){"x", "m", "position", SPH_VECTOR, SPH_DST_READ, 0.0};
    uint32_t access = mentions(s->expression, s->of) ? SPH_DST_UPDATE : SPH_DST_WRITE;
    a->prop[n + 1] = (sph_prop){column->name, column->unit, column->doc, column->type, access, 0.0};
    a->item = (sph_item){.size = sizeof a->item,
                         .dims = SPH_ALL_DIMS,
                         .name = s->name,
                         .doc = s->expression,
                         .source = "the scene",
                         .props = {a->prop, n + 2, sizeof a->prop[0]}};
    const char *name[N_ALWAYS + MOST_VARIABLES];
    for (size_t k = 0; k < N_ALWAYS; k++)
        name[k] = always[k];
    for (uint32_t k = 0; k < n; k++)
        name[N_ALWAYS + k] = a->prop[k].name;
    struct error why = {0};
    if (expression_new(&a->expression, s->expression, name, N_ALWAYS + n, &why))
        return document_fail(d, s->node, e, "%s", why.text);
    return make_device(a, plan, s, name, e);
}

int assignment_bind(struct plan *plan, struct pass *pass, const struct step *s, size_t array,
                    struct error *e)
{
    struct assignment *a = calloc(1, sizeof *a);
    if (!a)
        return error_memory(e, "an assignment", sizeof *a);
    pass->assignment = a;
    pass->shape = SPH_POINT;
    pass->run = assign;
    pass->serial = true; /* an expression serves one thread */
    if (make(a, plan, s, array, e))
        return -1;
    if (use_init(&pass->use, NULL, &a->item, NULL, e))
        return -1;
    pass->use.state = a;
    return 0;
}

void assignment_free(struct assignment *a)
{
    if (!a)
        return;
    expression_free(a->expression);
    free(a->device_text);
    for (size_t k = 0; k < MOST_VARIABLES; k++)
        free(a->device_name[k]);
    free(a);
}
