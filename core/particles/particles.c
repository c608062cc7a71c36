/* particles/particles.c -- the columns of a particle array: their memory, growth and reordering.
 * Touches only its own array; maps pages of its own where the audit asks for them. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* MAP_ANONYMOUS under -std=c11 */
#endif
#include "particles/particles.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define ALIGN 64u

uint32_t property_ncomp(uint32_t type, int dim)
{
    uint32_t d = (uint32_t)dim;

    switch (type) {
    case SPH_SCALAR:
    case SPH_INT32:
    case SPH_INT64:
        return 1;
    case SPH_VECTOR:
        return d;
    case SPH_SYM:
        return d * (d + 1) / 2;
    case SPH_MATRIX:
        return d * d;
    default:
        return 0;
    }
}

size_t property_size(uint32_t type)
{
    return type == SPH_INT32 ? 4 : 8;
}

/* -- Memory of a column ------------------------------------------------------------------------ */

static size_t round_up(size_t n, size_t unit)
{
    return (n + unit - 1) / unit * unit;
}

static size_t page_size(void)
{
    long n = sysconf(_SC_PAGESIZE);

    return n > 0 ? (size_t)n : 4096;
}

/* Elements from one component to the next, for a capacity: each begins on a cache line. */
static size_t plane_for(size_t capacity)
{
    return round_up(capacity + PARTICLES_PAD, ALIGN / 4);
}

/* Bytes that a column of this plane holds. */
static size_t column_bytes(const struct particles *p, const struct column *c, size_t plane)
{
    size_t bytes = round_up((size_t)c->ncomp * plane * c->size, ALIGN);

    return p->guarded ? round_up(bytes, page_size()) : bytes;
}

/* Zeroed memory. Guarded: whole pages, and one behind them that nobody may touch. */
static void *column_alloc(const struct particles *p, size_t bytes)
{
    void *data;

    if (!p->guarded) {
        data = aligned_alloc(ALIGN, bytes);
        if (data) {
            memset(data, 0, bytes);
        }
        return data;
    }
    data = mmap(NULL, bytes + page_size(), PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (data == MAP_FAILED) {
        return NULL;
    }
    if (mprotect(data, bytes, PROT_READ | PROT_WRITE) != 0) {
        munmap(data, bytes + page_size());
        return NULL;
    }
    return data;
}

static size_t mirror_bytes(const struct particles *p, const struct column *c, size_t plane)
{
    struct column half = *c;

    half.size = 4;
    return column_bytes(p, &half, plane);
}

static void release(struct particles *p, void *data, size_t bytes)
{
    if (!data) {
        return;
    }
    if (p->guarded) {
        munmap(data, bytes + page_size());
    } else {
        free(data);
    }
    p->arena_bytes -= bytes;
}

static void column_release(struct particles *p, struct column *c)
{
    release(p, c->data, column_bytes(p, c, c->plane));
    release(p, c->low, mirror_bytes(p, c, c->plane));
    release(p, c->mirror, mirror_bytes(p, c, c->plane));
    c->data = c->mirror = NULL;
    c->low = NULL;
}

/* Zeroed memory that the array owns, or NULL. */
static void *acquire(struct particles *p, const struct column *c, size_t bytes, struct error *e)
{
    void *data = column_alloc(p, bytes);

    if (!data) {
        error_memory(e, c->name, bytes);
        error_prefix(e, "%s", p->name);
        return NULL;
    }
    p->arena_bytes += bytes;
    return data;
}

static int mirror_alloc(struct particles *p, struct column *c, struct error *e)
{
    c->mirror = acquire(p, c, mirror_bytes(p, c, c->plane), e);
    return c->mirror ? 0 : -1;
}

/* Copies the first `keep` elements of each component. */
static void move_planes(const struct column *c, const void *from, void *to, size_t plane,
                        size_t keep, size_t size)
{
    for (uint32_t k = 0; from && k < c->ncomp; k++) {
        memcpy((char *)to + k * plane * size, (const char *)from + k * c->plane * size,
               keep * size);
    }
}

/* Gives the column room for `capacity`, the first `keep` elements of each component kept; those of
 * a mirror are not. `rest`: with a second float. */
static int column_grow(struct particles *p, struct column *c, size_t capacity, size_t keep,
                       bool rest, struct error *e)
{
    size_t plane = plane_for(capacity), bytes;
    bool mirrored = c->mirror != NULL;
    void *data, *low = NULL;

    if (plane < capacity || plane > SIZE_MAX / 128 / (c->ncomp * c->size)) {
        return error_set(e, EXIT_RUN, "%s.%s: %zu particles are too many", p->name, c->name,
                         capacity);
    }
    bytes = column_bytes(p, c, plane);
    data = acquire(p, c, bytes, e);
    if (!data) {
        return -1;
    }
    if (rest) {
        low = acquire(p, c, bytes, e); /* as many floats */
        if (!low) {
            release(p, data, bytes);
            return -1;
        }
    }
    move_planes(c, c->data, data, plane, keep, c->size);
    move_planes(c, c->low, low, plane, keep, sizeof(float));
    column_release(p, c);
    c->data = data;
    c->low = low;
    c->plane = plane;
    return mirrored ? mirror_alloc(p, c, e) : 0;
}

/* Sets elements [first, last) of every component to zero. */
static void column_clear(struct column *c, size_t first, size_t last)
{
    for (uint32_t k = 0; k < c->ncomp; k++) {
        memset((char *)c->data + (k * c->plane + first) * c->size, 0, (last - first) * c->size);
        if (c->low) {
            memset(c->low + k * c->plane + first, 0, (last - first) * sizeof(float));
        }
    }
}

/* -- The array --------------------------------------------------------------------------------- */

int particles_init(struct particles *p, const char *name, int dim, struct error *e)
{
    memset(p, 0, sizeof *p);
    if (dim < 1 || dim > 3) {
        return error_set(e, EXIT_USAGE, "%s: %d dimensions; 1, 2 or 3 are possible", name, dim);
    }
    p->name = strdup(name);
    if (!p->name) {
        return error_memory(e, name, strlen(name) + 1);
    }
    p->dim = dim;
    return 0;
}

static void column_fini(struct particles *p, struct column *c)
{
    column_release(p, c);
    free(c->name);
    free(c->unit);
    free(c->doc);
}

void particles_fini(struct particles *p)
{
    for (size_t k = 0; k < p->n_column; k++) {
        column_fini(p, &p->column[k]);
    }
    free(p->column);
    free(p->name);
    memset(p, 0, sizeof *p);
}

bool particles_is_valid(const struct particles *p)
{
    size_t bytes = 0;

    if (!p->name || p->dim < 1 || p->dim > 3 || p->n_ghost > p->capacity ||
        p->n > p->capacity - p->n_ghost) {
        return false;
    }
    for (size_t k = 0; k < p->n_column; k++) {
        const struct column *c = &p->column[k];

        if (!c->name || !c->data || c->ncomp != property_ncomp(c->type, p->dim) ||
            (c->size != property_size(c->type) && !(column_is_real(c) && c->size == 4)) ||
            c->plane < p->capacity + PARTICLES_PAD || c->plane * c->size % ALIGN != 0 ||
            (uintptr_t)c->data % ALIGN != 0 || (c->low && c->size != 4) ||
            particles_find(p, c->name) != (int)k) {
            return false;
        }
        bytes += column_bytes(p, c, c->plane);
        bytes += (size_t)(!!c->mirror + !!c->low) * mirror_bytes(p, c, c->plane);
    }
    return bytes == p->arena_bytes;
}

int particles_find(const struct particles *p, const char *name)
{
    for (size_t k = 0; k < p->n_column; k++) {
        if (strcmp(p->column[k].name, name) == 0) {
            return (int)k;
        }
    }
    return -1;
}

static const char *type_name(uint32_t type)
{
    static const char *const name[] = {"nothing",  "a scalar", "a vector", "a symmetric tensor",
                                       "a matrix", "an int32", "an int64"};

    return type < sizeof name / sizeof name[0] ? name[type] : "of an unknown type";
}

/* Fills a fresh column; on failure what it holds is freed by column_fini. */
static int column_init(struct particles *p, struct column *c, const char *name, const char *unit,
                       const char *doc, uint32_t type, struct error *e)
{
    memset(c, 0, sizeof *c);
    c->type = type;
    c->ncomp = property_ncomp(type, p->dim);
    c->size = property_size(type);
    c->name = strdup(name);
    c->unit = strdup(unit ? unit : "");
    c->doc = strdup(doc ? doc : "");
    if (!c->name || !c->unit || !c->doc) {
        return error_memory(e, name, strlen(name) + 1);
    }
    return column_grow(p, c, p->capacity, 0, false, e);
}

int particles_add(struct particles *p, const char *name, const char *unit, const char *doc,
                  uint32_t type, struct error *e)
{
    int k = particles_find(p, name);
    struct column *grown, fresh;

    if (k >= 0) {
        if (p->column[k].type != type) {
            return error_set(e, EXIT_USAGE, "%s.%s is %s in one place and %s in another", p->name,
                             name, type_name(p->column[k].type), type_name(type));
        }
        return k;
    }
    if (property_ncomp(type, p->dim) == 0) {
        return error_set(e, EXIT_USAGE, "%s.%s: type %u is unknown", p->name, name, type);
    }
    grown = realloc(p->column, (p->n_column + 1) * sizeof *grown);
    if (!grown) {
        return error_memory(e, name, sizeof *grown);
    }
    p->column = grown;
    if (column_init(p, &fresh, name, unit, doc, type, e) != 0) {
        column_fini(p, &fresh);
        return -1;
    }
    p->column[p->n_column] = fresh;
    return (int)p->n_column++;
}

double *particles_real(const struct particles *p, const char *name, uint32_t c)
{
    int k = particles_find(p, name);

    if (k < 0 || !column_is_real(&p->column[k]) || p->column[k].size != sizeof(double) ||
        c >= p->column[k].ncomp) {
        return NULL;
    }
    return (double *)p->column[k].data + c * p->column[k].plane;
}

/* The column takes the form that `c` has but for its memory; its values go over. */
static int change_form(struct particles *p, struct column *c, const struct column *form, bool rest,
                       struct error *e)
{
    enum { PIECE = 256 };
    struct column old = *c;
    double value[PIECE];

    *c = *form;
    c->data = c->mirror = NULL;
    c->low = NULL;
    if (column_grow(p, c, p->capacity, 0, rest, e) != 0) {
        *c = old;
        return -1;
    }
    for (uint32_t k = 0; k < c->ncomp; k++) {
        for (size_t i = 0, n = p->n + p->n_ghost; i < n; i += PIECE) {
            size_t some = n - i < PIECE ? n - i : PIECE;

            column_load(&old, k, i, some, value);
            column_store(c, k, i, some, value);
        }
    }
    column_release(p, &old);
    return 0;
}

int particles_hold(struct particles *p, int column, size_t size, bool rest, struct error *e)
{
    struct column *c = &p->column[column], form = *c;

    if (c->size == size && rest == (c->low != NULL)) {
        return 0;
    }
    form.size = size;
    form.quantum = 0;
    return change_form(p, c, &form, rest, e);
}

int particles_hold_quanta(struct particles *p, int column, const double *centre, double quantum,
                          struct error *e)
{
    struct column *c = &p->column[column], form = *c;

    form.size = 4;
    form.quantum = quantum;
    memcpy(form.centre, centre, sizeof form.centre);
    return change_form(p, c, &form, true, e);
}

int particles_mirror(struct particles *p, int column, struct error *e)
{
    struct column *c = &p->column[column];

    return c->mirror || c->size != 8 ? 0 : mirror_alloc(p, c, e);
}

/* Leaves every column open to the core, whatever the audit had closed. */
static int unlock(struct particles *p, struct error *e)
{
    for (size_t k = 0; p->guarded && k < p->n_column; k++) {
        if (particles_guard(p, (int)k, 2) != 0) {
            return error_set(e, EXIT_RUN, "%s.%s: its pages cannot be unlocked", p->name,
                             p->column[k].name);
        }
    }
    return 0;
}

int particles_resize(struct particles *p, size_t n, size_t n_ghost, struct error *e)
{
    /* Ghosts stand behind the particles: if their number changes, ghosts are forgotten. */
    size_t keep =
        n == p->n ? p->n + (n_ghost < p->n_ghost ? n_ghost : p->n_ghost) : (n < p->n ? n : p->n);
    size_t need = n + n_ghost;

    if (need < n || need > UINT32_MAX) {
        return error_set(e, EXIT_RUN, "%s: more than %u particles and ghosts", p->name, UINT32_MAX);
    }
    if (unlock(p, e) != 0) {
        return -1;
    }
    if (need > p->capacity) {
        /* A little to spare from the second time on, or each new ghost would move all columns. */
        size_t capacity = p->capacity > 0 ? need + need / 8 : need;

        for (size_t k = 0; k < p->n_column; k++) {
            /* A failure leaves columns of different planes, all of which hold the old capacity. */
            if (column_grow(p, &p->column[k], capacity, keep, p->column[k].low != NULL, e) != 0) {
                return -1;
            }
        }
        p->capacity = capacity;
    } else {
        for (size_t k = 0; k < p->n_column && need > keep; k++) {
            column_clear(&p->column[k], keep, need);
        }
    }
    p->n = n;
    p->n_ghost = n_ghost;
    return 0;
}

/* -- Order ------------------------------------------------------------------------------------- */

/* By bytes, for a column may hold integers or reals; `size` is a constant where it is called. */
static inline void permute(char *x, char *scratch, const uint32_t *order, size_t n, size_t size)
{
    for (size_t i = 0; i < n; i++) {
        memcpy(scratch + i * size, x + order[i] * size, size);
    }
    memcpy(x, scratch, n * size);
}

int particles_permute(struct particles *p, const uint32_t *order, struct error *e)
{
    char *scratch;

    if (p->n == 0 || unlock(p, e) != 0) {
        return p->n == 0 ? 0 : -1;
    }
    for (size_t i = 0; i < p->n; i++) {
        if (order[i] >= p->n) {
            return error_set(e, EXIT_RUN, "%s: place %zu of the new order names particle %u of %zu",
                             p->name, i, order[i], p->n);
        }
    }
    scratch = malloc(p->n * 8);
    if (!scratch) {
        return error_memory(e, "sorting particles", p->n * 8);
    }
    for (size_t k = 0; k < p->n_column; k++) {
        struct column *c = &p->column[k];

        for (uint32_t q = 0; c->state && q < c->ncomp; q++) {
            char *x = (char *)c->data + q * c->plane * c->size;

            if (c->size == 8) {
                permute(x, scratch, order, p->n, 8);
            } else {
                permute(x, scratch, order, p->n, 4);
            }
            if (c->low) {
                permute((char *)(c->low + q * c->plane), scratch, order, p->n, 4);
            }
        }
    }
    free(scratch);
    return 0;
}

/* x[i] = x[index[i]] of n elements out of `old`. */
static void gather(char *x, char *scratch, const uint32_t *index, size_t n, size_t old, size_t size)
{
    memcpy(scratch, x, old * size);
    for (size_t i = 0; i < n; i++) {
        memcpy(x + i * size, scratch + index[i] * size, size);
    }
}

int particles_gather(struct particles *p, const uint32_t *index, size_t n, struct error *e)
{
    const size_t old = p->n;
    char *scratch;

    for (size_t i = 0; i < n; i++) {
        if (index[i] >= old) {
            return error_set(e, EXIT_RUN, "%s: new particle %zu is made of particle %u of %zu",
                             p->name, i, index[i], old);
        }
    }
    if (particles_resize(p, old > n ? old : n, 0, e) != 0) {
        return -1;
    }
    scratch = malloc(old * 8 + 8);
    if (!scratch) {
        return error_memory(e, "gathering particles", old * 8);
    }
    for (size_t k = 0; k < p->n_column; k++) {
        struct column *c = &p->column[k];

        for (uint32_t q = 0; q < c->ncomp; q++) {
            gather((char *)c->data + q * c->plane * c->size, scratch, index, n, old, c->size);
            if (c->low) {
                gather((char *)(c->low + q * c->plane), scratch, index, n, old, sizeof(float));
            }
        }
    }
    free(scratch);
    return particles_resize(p, n, 0, e);
}

/* -- Views ------------------------------------------------------------------------------------- */

sph_column particles_column(const struct particles *p, int column)
{
    const struct column *c = &p->column[column];
    sph_column view = {.data = c->data, .plane = c->plane, .type = c->type, .ncomp = c->ncomp};

    return view;
}

sph_column particles_column4(const struct particles *p, int column)
{
    sph_column view = particles_column(p, column);

    if (p->column[column].mirror) {
        view.data = p->column[column].mirror;
    }
    return view;
}

size_t particles_bytes(const struct particles *p)
{
    size_t bytes = 0;

    for (size_t k = 0; k < p->n_column; k++) {
        const struct column *c = &p->column[k];

        bytes += c->ncomp * (c->size + (c->mirror ? 4 : 0) + (c->low ? 4 : 0));
    }
    return bytes;
}

int particles_guard(struct particles *p, int column, int access)
{
    struct column *c = &p->column[column];
    int protection = access <= 0 ? PROT_NONE : access == 1 ? PROT_READ : PROT_READ | PROT_WRITE;

    if (!p->guarded) {
        return -1;
    }
    /* What stands in `low` is the core's own: no plugin is ever given it. */
    if (c->mirror && mprotect(c->mirror, mirror_bytes(p, c, c->plane), protection) != 0) {
        return -1;
    }
    return mprotect(c->data, column_bytes(p, c, c->plane), protection) == 0 ? 0 : -1;
}

int particles_at_address(const struct particles *p, const void *address)
{
    uintptr_t a = (uintptr_t)address;

    for (size_t k = 0; k < p->n_column; k++) {
        const struct column *c = &p->column[k];
        size_t bytes = column_bytes(p, c, c->plane) + (p->guarded ? page_size() : 0);

        if (a >= (uintptr_t)c->data && a - (uintptr_t)c->data < bytes) {
            return (int)k;
        }
        bytes = mirror_bytes(p, c, c->plane) + (p->guarded ? page_size() : 0);
        if (c->mirror && a >= (uintptr_t)c->mirror && a - (uintptr_t)c->mirror < bytes) {
            return (int)k;
        }
    }
    return -1;
}
