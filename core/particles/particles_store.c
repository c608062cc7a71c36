/* particles/particles_store.c -- an array goes into a checkpoint as it is held, ghosts included, and comes back:
 * every bit of every column. Mirrors are copies, and are made again. */
#include "particles/particles.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static enum store_type type_of(const struct column *c)
{
    if (!column_is_real(c))
        return c->size == 8 ? STORE_I64 : STORE_I32;
    return c->quantum > 0.0 ? STORE_I32 : c->size == 8 ? STORE_F64 : STORE_F32;
}

/* The form of a column: type, components, size, second floats, quantum. The array takes the form read. */
static int form_store(struct particles *p, int column, struct store *s, struct error *e)
{
    struct column *c = &p->column[column];
    uint32_t form[4] = {c->type, c->ncomp, (uint32_t)c->size, c->low != NULL};
    double quanta[4] = {c->quantum, c->centre[0], c->centre[1], c->centre[2]};
    if (store_block(s, "form", STORE_U32, form, 4, e) ||
        store_block(s, "quanta", STORE_F64, quanta, 4, e))
        return -1;
    if (!s->reading)
        return 0;
    const bool real = column_is_real(c);
    if (form[0] != c->type || form[1] != c->ncomp ||
        (real ? form[2] != 4 && form[2] != 8 : form[2] != c->size || form[3]))
        return store_broken(s, e, "%s.%s is of another type", p->name, c->name);
    if (!real)
        return 0;
    return quanta[0] > 0.0 ? particles_hold_quanta(p, column, quanta + 1, quanta[0], e)
                           : particles_hold(p, column, form[2], form[3] != 0, e);
}

static int column_store_all(struct particles *p, int column, struct store *s, struct error *e)
{
    if (form_store(p, column, s, e))
        return -1;
    const struct column *c = &p->column[column];
    const size_t n = p->n + p->n_ghost;
    for (uint32_t k = 0; k < c->ncomp; k++) {
        char name[32];
        snprintf(name, sizeof name, "data%u", k);
        if (store_block(s, name, type_of(c), (char *)c->data + k * c->plane * c->size, n, e))
            return -1;
        snprintf(name, sizeof name, "low%u", k);
        if (c->low && store_block(s, name, STORE_F32, c->low + k * c->plane, n, e))
            return -1;
    }
    return 0;
}

/* The names of all columns, each with a line's end. */
static char *names_of(const struct particles *p)
{
    size_t bytes = 1;
    for (size_t k = 0; k < p->n_column; k++)
        bytes += strlen(p->column[k].name) + 1;
    char *names = malloc(bytes), *at = names;
    for (size_t k = 0; names && k < p->n_column; k++)
        at += snprintf(at, bytes - (size_t)(at - names), "%s\n", p->column[k].name);
    if (names)
        *at = '\0';
    return names;
}

/* That the file's columns are the array's. */
static int names_check(const struct particles *p, struct store *s, struct error *e)
{
    char *names = names_of(p), *found = NULL;
    int status = names ? store_text(s, "columns", &found, e) : error_memory(e, "names", 1);
    if (!status && (!found || strcmp(names, found) != 0))
        status = store_broken(s, e, "array \"%s\" has other properties there", p->name);
    free(names);
    free(found);
    return status;
}

/* A column that is not held as the one there can take nothing of it. */
static int form_check(const struct particles *p, int column, struct store *s, struct error *e)
{
    const struct column *c = &p->column[column];
    const uint32_t is[4] = {c->type, c->ncomp, (uint32_t)c->size, c->low != NULL};
    const double held[4] = {c->quantum, c->centre[0], c->centre[1], c->centre[2]};
    uint32_t form[4];
    double quanta[4];
    if (store_block(s, "form", STORE_U32, form, 4, e) ||
        store_block(s, "quanta", STORE_F64, quanta, 4, e))
        return -1;
    return memcmp(form, is, sizeof is) == 0 &&
                   (form[3] == 0 || c->quantum <= 0.0 || memcmp(quanta, held, sizeof held) == 0) &&
                   (quanta[0] > 0.0) == (c->quantum > 0.0)
               ? 0
               : store_broken(s, e, "%s.%s is held in more than one way", p->name, c->name);
}

static int column_restore(struct particles *p, int column, struct store *s, size_t at, size_t first,
                          size_t n, struct error *e)
{
    if (at == 0 ? form_store(p, column, s, e) : form_check(p, column, s, e))
        return -1;
    const struct column *c = &p->column[column];
    for (uint32_t k = 0; k < c->ncomp; k++) {
        char name[32];
        const size_t to = k * c->plane + at;
        snprintf(name, sizeof name, "data%u", k);
        if (store_piece(s, name, type_of(c), (char *)c->data + to * c->size, first, n, e))
            return -1;
        snprintf(name, sizeof name, "low%u", k);
        if (c->low && store_piece(s, name, STORE_F32, c->low + to, first, n, e))
            return -1;
    }
    return 0;
}

int particles_restore(struct particles *p, struct store *s, size_t at, size_t first, size_t n,
                      struct error *e)
{
    int status = names_check(p, s, e);
    for (size_t k = 0; !status && k < p->n_column; k++) {
        store_enter(s, "column", k);
        status = column_restore(p, (int)k, s, at, first, n, e);
        store_leave(s);
    }
    return status;
}

int particles_store(struct particles *p, struct store *s, struct error *e)
{
    size_t n = p->n, n_ghost = p->n_ghost;
    char *names = names_of(p), *found = s->reading ? NULL : names;
    int status = names ? 0 : error_memory(e, "names", 1);
    if (!status && (store_count(s, "n", &n, e) || store_count(s, "n_ghost", &n_ghost, e) ||
                    store_text(s, "columns", &found, e)))
        status = -1;
    if (!status && s->reading && (!found || strcmp(names, found) != 0))
        status = store_broken(s, e, "array \"%s\" has other properties there", p->name);
    if (!status && s->reading)
        status = particles_resize(p, n, n_ghost, e);
    for (size_t k = 0; !status && k < p->n_column; k++) {
        store_enter(s, "column", k);
        status = column_store_all(p, (int)k, s, e);
        store_leave(s);
    }
    free(names);
    if (s->reading)
        free(found);
    return status;
}
