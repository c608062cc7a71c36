/* device_columns.h -- for tests of what the core does to columns on a device: a device and its kernels, an array
 * with columns of every kind, on the host and there. Include after cmocka.h. */
#ifndef TESTS_DEVICE_COLUMNS_H
#define TESTS_DEVICE_COLUMNS_H

#include "opencl/ops_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static struct device *device;
static struct ops *ops[4]; /* [dim] */
static struct error why;
static uint64_t seed = 1;

#define OK(call)                                                                                   \
    do {                                                                                           \
        if (call)                                                                                  \
            fail_msg("%s:%d: %s", __func__, __LINE__, why.text);                                   \
    } while (0)

static inline double unit(void)
{
    seed = seed * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(seed >> 11) / 9007199254740992.0;
}

static const size_t sizes[] = {0, 1, 7, 8, 9, 1000, 4097, 100000};

/* -- Particles of every kind of column -------- */

enum { X, V, H, S, M, I, L, F, G, X0, X1, KINDS };
static const struct {
    const char *name;
    uint32_t type;
    bool state, floats, mirror;
} kind[KINDS] = {
    [X] = {"x", SPH_VECTOR, true, false, true},    [V] = {"v", SPH_VECTOR, true, false, true},
    [H] = {"h", SPH_SCALAR, true, false, false},   [S] = {"s", SPH_SYM, true, false, true},
    [M] = {"m", SPH_MATRIX, true, false, false},   [I] = {"i", SPH_INT32, true, false, false},
    [L] = {"l", SPH_INT64, true, false, false},    [F] = {"f", SPH_VECTOR, true, true, false},
    [G] = {"g", SPH_SYM, false, true, false},      [X0] = {"x.0", SPH_VECTOR, true, false, false},
    [X1] = {"x.1", SPH_VECTOR, true, true, false},
};

/* From -1 to 1, but for h and integers. */
static inline void fill(struct particles *p)
{
    for (size_t c = 0; c < p->n_column; c++)
        for (uint32_t k = 0; k < p->column[c].ncomp; k++)
            for (size_t i = 0; i < p->n; i++) {
                const struct column *column = &p->column[c];
                const double value = c == H ? 0.1 + 0.05 * unit() : 2 * unit() - 1;
                if (column->type == SPH_INT32)
                    ((int32_t *)column->data)[i] = (int32_t)(1e9 * value);
                else if (column->type == SPH_INT64)
                    ((int64_t *)column->data)[i] = (int64_t)(9e18 * value);
                else
                    column_set(column, k, i, value);
            }
}

static inline void make(struct particles *p, int dim, size_t n)
{
    OK(particles_init(p, "fluid", dim, &why));
    for (int c = 0; c < KINDS; c++) {
        assert_int_equal(particles_add(p, kind[c].name, "", "", kind[c].type, &why), c);
        p->column[c].state = kind[c].state;
    }
    OK(particles_resize(p, n, 0, &why));
    for (int c = 0; c < KINDS; c++) {
        if (kind[c].floats)
            OK(particles_hold(p, c, 4, false, &why));
        if (kind[c].mirror)
            OK(particles_mirror(p, c, &why));
    }
    fill(p);
}

/* Another array with the same contents. */
static inline void copy(struct particles *to, const struct particles *from)
{
    make(to, from->dim, from->n);
    for (size_t c = 0; c < from->n_column; c++)
        for (uint32_t k = 0; k < from->column[c].ncomp; k++)
            memcpy((char *)to->column[c].data + k * to->column[c].plane * to->column[c].size,
                   (const char *)from->column[c].data +
                       k * from->column[c].plane * from->column[c].size,
                   from->n * from->column[c].size);
}

static inline void put_all(struct arena *a)
{
    for (size_t c = 0; c < a->p->n_column; c++) {
        arena_written_there(a, (int)c);
        OK(arena_put(a, (int)c, &why));
        assert_true(a->here[c] && a->there[c]);
    }
}

static inline void get_all(struct arena *a)
{
    for (size_t c = 0; c < a->p->n_column; c++) {
        arena_written_here(a, (int)c);
        OK(arena_get(a, (int)c, &why));
    }
}

static inline void open_arena(struct arena *a, struct particles *p)
{
    OK(arena_init(a, device, p, &why));
    put_all(a);
}

/* n elements of component k of a slot, from `first` on. */
static inline void peek(const struct arena *a, uint32_t slot, uint32_t size, size_t first, size_t n,
                        void *to)
{
    OK(device_read(device, size == 8 ? &a->wide : &a->narrow, (slot * a->plane + first) * size, to,
                   n * size, &why));
}

/* Every element of state columns, or of all, is the same; reals to `tolerance`. */
static inline void assert_same(const struct particles *a, const struct particles *b, bool all,
                               double tolerance)
{
    assert_int_equal(a->n, b->n);
    for (size_t c = 0; c < a->n_column; c++)
        for (uint32_t k = 0; (all || a->column[c].state) && k < a->column[c].ncomp; k++)
            for (size_t i = 0; i < a->n; i++) {
                const struct column *x = &a->column[c], *y = &b->column[c];
                const char *one = (const char *)x->data + (k * x->plane + i) * x->size;
                const char *other = (const char *)y->data + (k * y->plane + i) * y->size;
                if (memcmp(one, other, x->size) != 0 &&
                    !(tolerance > 0 && column_is_real(x) &&
                      fabs(column_get(x, k, i) - column_get(y, k, i)) <=
                          tolerance * (x->size == 4 ? 1e9 : 1)))
                    fail_msg("%s[%u] of %zu of %zu differs", x->name, k, i, a->n);
            }
}

/* Work items of `wide` particles. */
static inline int open_all(size_t wide)
{
    if (device_open(&device, 0, &why))
        return -1;
    for (int dim = 1; dim <= 3; dim++)
        if (ops_open_wide(&ops[dim], device, dim, wide, &why)) {
            print_error("%s\n", why.text);
            return -1;
        }
    return 0;
}

static inline int open_one(void **state)
{
    (void)state;
    return open_all(1);
}

static inline int open_eight(void **state)
{
    (void)state;
    return open_all(8);
}

static inline int close_all(void **state)
{
    size_t most;
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        ops_close(ops[dim]);
    const size_t left = device_bytes(device, &most);
    device_close(device);
    return left != 0; /* nothing is forgotten there */
}

/* The tests in both widths; 77 where there is no device. */
#define RUN_BOTH(tests)                                                                            \
    do {                                                                                           \
        if (device_open(&device, 0, &why) || device_need_fp64(device, &why)) {                     \
            print_message("skipped: %s\n", why.text);                                              \
            return 77;                                                                             \
        }                                                                                          \
        device_close(device);                                                                      \
        return cmocka_run_group_tests(tests, open_eight, close_all) +                              \
               cmocka_run_group_tests(tests, open_one, close_all);                                 \
    } while (0)

#endif
