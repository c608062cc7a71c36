/* registry/kernel_form.c -- compiles kernels (see kernel_form.h). Arithmetic, no more. */
#include "registry/kernel_form.h"

#include <math.h>
#include <sph/kernel-value.h>
#include <stdlib.h>
#include <string.h>

/* The piece of a knot, made in its place (knots fall) if it is new; NULL if there is no room. */
static sph_kernel_piece *piece_at(sph_kernel_form *f, double knot)
{
    uint32_t i = 0;

    while (i < f->n_pieces && f->piece[i].knot > knot)
        i++;
    if (i < f->n_pieces && f->piece[i].knot == knot)
        return &f->piece[i];
    if (f->n_pieces == SPH_KERNEL_KNOTS)
        return NULL;
    memmove(&f->piece[i + 1], &f->piece[i], (f->n_pieces - i) * sizeof(f->piece[0]));
    f->n_pieces++;
    f->piece[i] = (sph_kernel_piece){.knot = knot};
    return &f->piece[i];
}

/* Adds coef t^power to P; its least power is known. */
static int add_term(sph_kernel_piece *p, const sph_kernel_term *t, struct error *e)
{
    const uint32_t i = t->power - p->power;

    if (i >= SPH_KERNEL_COEFS)
        return error_set(e, EXIT_REFUSED,
                         "terms with knot %g span the powers %u to %u, but at most %u in a row are "
                         "held",
                         t->knot, p->power, t->power, SPH_KERNEL_COEFS);
    p->c[i] += t->coef;
    if (p->n_coef < i + 1)
        p->n_coef = i + 1;
    return 0;
}

/* dP/dq = -dP/dt, since t = knot - q. */
static void derive(sph_kernel_piece *p)
{
    p->dpower = p->power - 1;
    p->dn_coef = p->n_coef;
    for (uint32_t i = 0; i < p->n_coef; i++)
        p->d[i] = -(double)(p->power + i) * p->c[i];
}

/* Value and slope (per cell) at the ends of each cell; both are 0 at the support. */
static int tabulate(sph_kernel_form *f, const sph_kernel *k, struct error *e)
{
    const size_t n = 2 * ((size_t)KERNEL_FORM_CELLS + 1);
    double *table = calloc(n, sizeof(*table));

    if (!table)
        return error_memory(e, "a kernel's table", n * sizeof(*table));
    f->table = table;
    f->n_table = KERNEL_FORM_CELLS;
    f->cells = KERNEL_FORM_CELLS / k->support;
    for (uint32_t i = 0; i < KERNEL_FORM_CELLS; i++) {
        table[2 * i] = k->value((double)i / f->cells, f->dim);
        table[2 * i + 1] = k->slope((double)i / f->cells, f->dim) / f->cells;
    }
    /* The limit from inside: a kernel that ends with a jump keeps it. */
    table[2 * KERNEL_FORM_CELLS] = k->value(k->support, f->dim);
    table[2 * KERNEL_FORM_CELLS + 1] = k->slope(k->support, f->dim) / f->cells;
    return 0;
}

void kernel_form_fini(sph_kernel_form *f)
{
    free((void *)(uintptr_t)f->table);
    f->table = NULL;
    f->n_table = 0;
}

int kernel_form_make(sph_kernel_form *out, const sph_kernel *k, int dim, struct error *e)
{
    const sph_kernel_term *t;
    const sph_list *terms;

    memset(out, 0, sizeof(*out));
    if (dim < 1 || dim > 3 || !(k->item->dims >> dim & 1u))
        return error_set(e, EXIT_USAGE, "kernel \"%s\" does not work in %d dimensions",
                         k->item->name, dim);
    terms = &k->terms[dim];
    t = terms->data;
    out->size = (uint32_t)sizeof(*out);
    out->dim = (uint32_t)dim;
    out->support = k->support;
    out->norm = k->norm[dim];
    if (k->value)
        return tabulate(out, k, e);
    for (uint32_t i = 0; i < terms->count; i++) {
        sph_kernel_piece *p = piece_at(out, t[i].knot);

        if (!p)
            return error_set(e, EXIT_REFUSED, "terms[%d]: more than %u different knots", dim,
                             SPH_KERNEL_KNOTS);
        if (t[i].power < 1)
            return error_set(e, EXIT_REFUSED, "power of terms[%d][%u] is 0", dim, i);
        if (p->power == 0 || t[i].power < p->power)
            p->power = t[i].power;
    }
    for (uint32_t i = 0; i < terms->count; i++)
        if (add_term(piece_at(out, t[i].knot), &t[i], e))
            return -1;
    for (uint32_t i = 0; i < out->n_pieces; i++)
        derive(&out->piece[i]);
    return 0;
}

double kernel_form_w(const sph_kernel_form *f, double q)
{
    return sph_kernel_w(f, q);
}

double kernel_form_dw(const sph_kernel_form *f, double q)
{
    return sph_kernel_dw(f, q);
}
