/* test_opencl_ops.c -- what the core does to columns on a device against its counterparts on the host: transfers,
 * mirrors, order, reductions, sides, ghosts, skins, integrators. Skips itself where there is no device. */
#include "config.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "integrators/families.h"
#include "moving.h"
#include "neighbours/skin.h"
#include "opencl/ops.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static struct device *device;
static struct ops *ops[4]; /* [dim] */
static struct error e;
static uint64_t seed = 1;

#define OK(call)                                                                                   \
    do {                                                                                           \
        if (call)                                                                                  \
            fail_msg("%s:%d: %s", __func__, __LINE__, e.text);                                     \
    } while (0)

static double unit(void)
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
static void fill(struct particles *p)
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

static void make(struct particles *p, int dim, size_t n)
{
    OK(particles_init(p, "fluid", dim, &e));
    for (int c = 0; c < KINDS; c++) {
        assert_int_equal(particles_add(p, kind[c].name, "", "", kind[c].type, &e), c);
        p->column[c].state = kind[c].state;
    }
    OK(particles_resize(p, n, 0, &e));
    for (int c = 0; c < KINDS; c++) {
        if (kind[c].floats)
            OK(particles_hold(p, c, 4, false, &e));
        if (kind[c].mirror)
            OK(particles_mirror(p, c, &e));
    }
    fill(p);
}

/* Another array with the same contents. */
static void copy(struct particles *to, const struct particles *from)
{
    make(to, from->dim, from->n);
    for (size_t c = 0; c < from->n_column; c++)
        for (uint32_t k = 0; k < from->column[c].ncomp; k++)
            memcpy((char *)to->column[c].data + k * to->column[c].plane * to->column[c].size,
                   (const char *)from->column[c].data +
                       k * from->column[c].plane * from->column[c].size,
                   from->n * from->column[c].size);
}

static void put_all(struct arena *a)
{
    for (size_t c = 0; c < a->p->n_column; c++) {
        OK(arena_put(a, (int)c, &e));
        assert_true(a->here[c] && a->there[c]);
    }
}

static void get_all(struct arena *a)
{
    for (size_t c = 0; c < a->p->n_column; c++)
        OK(arena_get(a, (int)c, &e));
}

static void open_arena(struct arena *a, struct particles *p)
{
    OK(arena_init(a, device, p, &e));
    put_all(a);
}

/* n elements of component k of a slot, from `first` on. */
static void peek(const struct arena *a, uint32_t slot, uint32_t size, size_t first, size_t n,
                 void *to)
{
    OK(device_read(device, size == 8 ? &a->wide : &a->narrow, (slot * a->plane + first) * size, to,
                   n * size, &e));
}

/* Every element of state columns, or of all, is the same; reals to `tolerance`. */
static void assert_same(const struct particles *a, const struct particles *b, bool all,
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

/* -- Columns -------- */

static void test_arena(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (size_t s = 0; s < COUNT(sizes); s++) {
            struct particles p, before;
            struct arena a;
            size_t most;
            make(&p, dim, sizes[s]);
            copy(&before, &p);
            open_arena(&a, &p);
            assert_true(a.plane >= p.n + PARTICLES_PAD && a.plane % 16 == 0 && a.plane % 512);
            assert_true(device_bytes(device, &most) >= arena_bytes(&a, p.n));
            OK(arena_resize(&a, p.n, 3 * p.n + 5, &e)); /* they move */
            fill(&p);
            get_all(&a);
            assert_same(&p, &before, true, 0);
            /* Fewer on the device: the host follows. */
            OK(arena_resize(&a, p.n / 2, 0, &e));
            get_all(&a);
            assert_int_equal(p.n, a.n);
            for (size_t i = 0; i < p.n; i++)
                assert_true(column_get(&p.column[S], 0, i) == column_get(&before.column[S], 0, i));
            arena_fini(&a);
            particles_fini(&p);
            particles_fini(&before);
        }
}

static void test_mirror(void **state)
{
    static const double centre[3] = {0.25, -0.5, 0.1}, quantum = 2e-9;
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (size_t s = 0; s < COUNT(sizes); s++) {
            struct particles p;
            struct arena a;
            uint32_t flags;
            make(&p, dim, sizes[s]);
            open_arena(&a, &p);
            float *f = malloc((p.n + 1) * sizeof *f);
            int32_t *q = malloc((p.n + 1) * sizeof *q);
            OK(ops_mirror(ops[dim], &a, S, &e));
            OK(ops_mirror(ops[dim], &a, H, &e)); /* has none */
            OK(ops_mirror_places(ops[dim], &a, X, centre, quantum, &e));
            for (uint32_t k = 0; k < p.column[S].ncomp; k++) {
                peek(&a, (uint32_t)a.place[S].mirror + k, 4, 0, p.n, f);
                for (size_t i = 0; i < p.n; i++)
                    assert_true(f[i] == (float)column_get(&p.column[S], k, i));
            }
            for (uint32_t k = 0; k < p.column[X].ncomp; k++) {
                peek(&a, (uint32_t)a.place[X].mirror + k, 4, 0, p.n, q);
                for (size_t i = 0; i < p.n; i++)
                    assert_true(fabs(centre[k] + quantum * q[i] - column_get(&p.column[X], k, i)) <=
                                0.500001 * quantum);
            }
            OK(ops_flags(ops[dim], &flags, &e));
            assert_int_equal(flags, 0);
            if (p.n) {
                column_set(&p.column[X], (uint32_t)dim - 1, p.n - 1, s % 2 ? NAN : 3.5);
                OK(arena_put(&a, X, &e));
                OK(ops_mirror_places(ops[dim], &a, X, centre, quantum, &e));
                OK(ops_flags(ops[dim], &flags, &e));
                assert_int_equal(flags, OPS_NOWHERE);
                OK(ops_flags(ops[dim], &flags, &e));
                assert_int_equal(flags, 0);
            }
            free(f);
            free(q);
            arena_fini(&a);
            particles_fini(&p);
        }
}

static void test_permute(void **state)
{
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (size_t s = 0; s < COUNT(sizes); s++) {
            const size_t n = sizes[s];
            struct particles p, q;
            struct arena a;
            struct device_buffer order = {0};
            uint32_t *to = malloc((n + 1) * sizeof *to), flags;
            for (size_t i = 0; i < n; i++)
                to[i] = (uint32_t)i;
            for (size_t i = n; i-- > 1;) {
                const size_t j = (size_t)(unit() * (double)(i + 1));
                const uint32_t other = to[i];
                to[i] = to[j];
                to[j] = other;
            }
            make(&p, dim, n);
            copy(&q, &p);
            OK(arena_init(&a, device, &p, &e)); /* what is not there is brought */
            OK(arena_resize(&a, n, 5, &e));
            OK(device_reserve(device, &order, n * sizeof *to, "test", &e));
            OK(device_write(device, &order, 0, to, n * sizeof *to, &e));
            OK(ops_permute(ops[dim], &a, &order, &e));
            OK(particles_permute(&q, to, &e));
            for (int c = 0; c < KINDS && n; c++)
                assert_true(a.here[c] == kind[c].state && !a.there[c]);
            assert_int_equal(a.n_ghost, 0);
            fill(&p);
            get_all(&a);
            if (n)
                assert_same(&p, &q, false, 0);
            if (n > 1) {
                to[0] = (uint32_t)n;
                OK(device_write(device, &order, 0, to, n * sizeof *to, &e));
                OK(ops_permute(ops[dim], &a, &order, &e));
                OK(ops_flags(ops[dim], &flags, &e));
                assert_int_equal(flags, OPS_BAD_ORDER);
            }
            free(to);
            device_release(device, &order);
            arena_fini(&a);
            particles_fini(&p);
            particles_fini(&q);
        }
}

/* -- Reductions -------- */

static double reduced(const struct particles *p, int column, int mass, uint32_t op)
{
    return reduce_range(&p->column[column], mass < 0 ? NULL : &p->column[mass], op, 0, p->n);
}

static void assert_reduces(const struct arena *a, int column, int mass, bool nan)
{
    const int dim = a->p->dim;
    for (uint32_t op = SPH_REDUCE_MIN; op <= SPH_REDUCE_SUM; op++) {
        const double want = reduced(a->p, column, op == SPH_REDUCE_SUM ? mass : -1, op);
        double got[2];
        for (int k = 0; k < 2; k++)
            OK(ops_reduce(ops[dim], a, column, 0, op == SPH_REDUCE_SUM ? mass : -1, op, &got[k],
                          &e));
        assert_true(memcmp(&got[0], &got[1], sizeof got[0]) == 0);
        if (nan && a->n)
            assert_true(isnan(got[0]) && isnan(want));
        else if (op == SPH_REDUCE_SUM)
            assert_true(fabs(got[0] - want) <= 1e-15 * (double)(a->n + 1));
        else
            assert_true(got[0] == want);
    }
}

static void test_reduce(void **state)
{
    (void)state;
    for (size_t s = 0; s < COUNT(sizes); s++) {
        struct particles p;
        struct arena a;
        double least, most, result[4];
        uint64_t wrong;
        make(&p, 2, sizes[s]);
        open_arena(&a, &p);
        OK(arena_resize(&a, p.n, 9, &e)); /* ghosts do not count */
        assert_reduces(&a, H, -1, false);
        assert_reduces(&a, H, H, false);
        assert_reduces(&a, F, -1, false);
        assert_reduces(&a, X1, F, false);
        OK(ops_range(ops[2], &a, V, 1, &least, &most, &e));
        double low = INFINITY, high = -INFINITY, sum = 0;
        for (size_t i = 0; i < p.n; i++) {
            low = fmin(low, column_get(&p.column[V], 1, i));
            high = fmax(high, column_get(&p.column[V], 1, i));
            sum += column_get(&p.column[S], 2, i);
        }
        assert_true(least == low && most == high);
        OK(ops_wrong(ops[2], &a, V, -INFINITY, &wrong, &e));
        assert_int_equal(wrong, 0);
        OK(ops_wrong(ops[2], &a, H, 0.09, &wrong, &e));
        assert_int_equal(wrong, 0);
        OK(ops_wrong(ops[2], &a, H, 0.2, &wrong, &e));
        assert_int_equal(wrong, p.n);
        for (size_t i = 0; i < p.n; i += 1 + p.n / 3) {
            column_set(&p.column[H], 0, i, i ? NAN : -1);
            column_set(&p.column[F], 1, i, NAN);
            column_set(&p.column[V], 0, i, INFINITY);
            column_set(&p.column[V], 1, p.n - 1 - i, -NAN);
        }
        const size_t bad = p.n ? (p.n - 1) / (1 + p.n / 3) + 1 : 0;
        put_all(&a);
        /* Several at once. */
        OK(ops_wrong_begin(ops[2], &a, V, -INFINITY, 0, &e));
        OK(ops_wrong_begin(ops[2], &a, H, 0.0, 1, &e));
        OK(ops_wrong_begin(ops[2], &a, F, -INFINITY, 2, &e));
        OK(ops_reduce_begin(ops[2], &a, S, 2, -1, SPH_REDUCE_SUM, 3, &e));
        OK(ops_results(ops[2], result, 4, NULL, &e));
        assert_true(result[0] == (double)(2 * bad) && result[1] == (double)bad);
        assert_true(result[2] == (double)bad);
        assert_true(fabs(result[3] - sum) <= 1e-15 * (double)(p.n + 1));
        assert_reduces(&a, H, -1, bad > 1);
        OK(ops_range(ops[2], &a, V, 1, &least, &most, &e));
        assert_true(bad ? isnan(least) && isnan(most) : least == INFINITY);
        arena_fini(&a);
        particles_fini(&p);
    }
}

/* -- Skins -------- */

static struct cloud cloud_of(const struct particles *p, double scale)
{
    struct cloud c = {.dim = p->dim, .n = p->n, .scale = scale, .h = p->column[H].data};
    for (int a = 0; a < p->dim; a++)
        c.x[a] = particles_real(p, "x", (uint32_t)a);
    return c;
}

static void test_skin(void **state)
{
    const double scale = 2.5, relative = 0.1;
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (size_t s = 0; s < COUNT(sizes); s++) {
            struct particles p;
            struct arena a;
            struct ops_skin kept = {0};
            struct skin host = {0};
            double moved, room, most = 0, least = INFINITY, result[2];
            make(&p, dim, sizes[s]);
            open_arena(&a, &p);
            struct cloud cloud = cloud_of(&p, scale);
            OK(ops_skin_keep(ops[dim], &kept, &a, X, H, &e));
            OK(skin_keep(&host, &cloud, 1, &e));
            for (size_t i = 0; i < p.n; i++) {
                double r2 = 0;
                const double h = column_get(&p.column[H], 0, i), now = h * (1 + 0.02 * unit());
                for (uint32_t k = 0; k < (uint32_t)dim; k++) {
                    const double x = column_get(&p.column[X], k, i), d = 0.01 * unit();
                    column_set(&p.column[X], k, i, x + d);
                    r2 += (x + d - x) * (x + d - x);
                }
                column_set(&p.column[H], 0, i, now);
                most = fmax(most, sqrt(r2));
                least = fmin(least, scale * ((1 + relative) * h - now));
            }
            put_all(&a);
            OK(ops_skin_change(ops[dim], &kept, &a, X, H, scale, relative, &moved, &room, &e));
            const struct skin_change change = skin_change(&host, &cloud, relative, 1);
            assert_true(fabs(moved - most) <= 1e-15);
            assert_true(p.n ? fabs(room - least) <= 1e-15 : room == INFINITY);
            assert_true(!p.n || (moved <= change.moved + 1e-15 && moved >= change.moved - 5e-4));
            assert_true(!p.n || (room >= change.room - 1e-15 && room <= change.room + 1e-3));
            if (p.n) {
                column_set(&p.column[s % 2 ? X : H], 0, p.n / 2, NAN);
                put_all(&a);
                OK(ops_skin_begin(ops[dim], &kept, &a, X, H, scale, relative, 0, &e));
                OK(ops_results(ops[dim], result, 2, NULL, &e));
                assert_true(isnan(result[0]));
                assert_false(skin_holds((struct skin_change){result[0], result[1]}));
            }
            OK(arena_resize(&a, p.n + 1, 0, &e));
            OK(ops_skin_change(ops[dim], &kept, &a, X, H, scale, relative, &moved, &room, &e));
            assert_true(isnan(moved) && isnan(room));
            skin_fini(&host);
            ops_skin_release(ops[dim], &kept);
            arena_fini(&a);
            particles_fini(&p);
        }
}

/* -- Sides -------- */

static const enum side pairs[][2] = {
    {SIDE_OPEN, SIDE_OPEN},   {SIDE_PERIODIC, SIDE_PERIODIC}, {SIDE_MIRROR, SIDE_MIRROR},
    {SIDE_MIRROR, SIDE_OPEN}, {SIDE_OPEN, SIDE_MIRROR},
};

/* Number `k` of boxes with all pairs of sides along each axis. */
static bool make_box(struct box *box, int dim, size_t k)
{
    *box = (struct box){.dim = dim, .bounded = k > 0};
    for (int axis = 0; axis < dim; axis++, k /= COUNT(pairs)) {
        box->min[axis] = -0.6 - 0.1 * axis;
        box->max[axis] = 0.7;
        memcpy(box->side[axis], pairs[k % COUNT(pairs)], sizeof box->side[axis]);
    }
    return k == 0;
}

static void test_wrap(void **state)
{
    struct box box;
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (size_t s = 0; s < COUNT(sizes); s++)
            for (size_t k = 0; make_box(&box, dim, k); k += sizes[s] > 1000 ? 7 : 1) {
                struct particles p, q;
                struct arena a;
                size_t moved;
                make(&p, dim, sizes[s]);
                /* Some have gone far, one nowhere. */
                for (size_t i = 0; i < p.n; i += 5)
                    column_set(&p.column[X], (uint32_t)(i % (size_t)dim), i, 20 * unit() - 10);
                if (p.n > 1)
                    column_set(&p.column[X], 0, 1, NAN);
                copy(&q, &p);
                open_arena(&a, &p);
                OK(ops_wrap(ops[dim], &a, &box, &moved, &e));
                const size_t want = sides_wrap(&box, &q);
                fill(&p);
                get_all(&a);
                /* Where rounding leaves one just inside or outside, another may be counted. */
                assert_true(moved <= want + 2 && want <= moved + 2);
                assert_same(&p, &q, true, 1e-14);
                arena_fini(&a);
                particles_fini(&p);
                particles_fini(&q);
            }
}

struct made {
    uint32_t parent, image, at;
};

static int by_parent(const void *a, const void *b)
{
    const struct made *x = a, *y = b;
    return x->parent != y->parent ? (x->parent < y->parent ? -1 : 1)
           : x->image != y->image ? (x->image < y->image ? -1 : 1)
                                  : 0;
}

/* Ghosts of column c, which stand in another order. */
static void assert_ghosts(const struct arena *a, const struct particles *q, int c,
                          const struct made *here, const struct made *there)
{
    const size_t n = q->n_ghost, size = q->column[c].size;
    char *data = malloc(n * size + 8);
    float *mirror = malloc((n + 1) * sizeof *mirror);
    for (uint32_t k = 0; k < q->column[c].ncomp; k++) {
        peek(a, a->place[c].slot + k, (uint32_t)size, a->n, n, data);
        if (kind[c].mirror && c != X)
            peek(a, (uint32_t)a->place[c].mirror + k, 4, a->n, n, mirror);
        for (size_t i = 0; i < n; i++) {
            const char *want = (const char *)q->column[c].data +
                               (k * q->column[c].plane + q->n + there[i].at) * size;
            if (memcmp(data + here[i].at * size, want, size) != 0)
                fail_msg("%s[%u] of ghost %zu of %zu", kind[c].name, k, i, n);
            if (kind[c].mirror && c != X)
                assert_true(mirror[here[i].at] ==
                            (float)column_get(&q->column[c], k, q->n + there[i].at));
        }
    }
    free(data);
    free(mirror);
}

static void compare_ghosts(struct arena *a, const struct ops_ghosts *g, struct particles *q,
                           const struct ghosts *want, const struct box *box)
{
    const size_t n = want->n;
    struct made *here = malloc((n + 1) * sizeof *here), *there = malloc((n + 1) * sizeof *there);
    uint32_t *parent = malloc((n + 1) * sizeof *parent);
    uint8_t *image = malloc(n + 1);
    OK(device_read(device, &g->parent, 0, parent, n * sizeof *parent, &e));
    OK(device_read(device, &g->image, 0, image, n, &e));
    for (size_t i = 0; i < n; i++) {
        here[i] = (struct made){parent[i], image[i], (uint32_t)i};
        there[i] = (struct made){want->parent[i], want->image[i], (uint32_t)i};
        /* In the order of parents, image by image. */
        assert_true(i == 0 || image[i] != image[i - 1] || parent[i] > parent[i - 1]);
    }
    qsort(here, n, sizeof *here, by_parent);
    qsort(there, n, sizeof *there, by_parent);
    for (size_t i = 0; i < n; i++)
        if (by_parent(&here[i], &there[i]) != 0)
            fail_msg("ghost %zu of %zu is another", i, n);
    assert_ghosts(a, q, X, here, there);
    assert_ghosts(a, q, H, here, there);
    for (int c = 0; c < KINDS; c++) {
        OK(ops_ghosts_refresh(ops[q->dim], a, g, box, c, &e));
        ghosts_refresh(want, box, q, c);
        assert_ghosts(a, q, c, here, there);
    }
    free(here);
    free(there);
    free(parent);
    free(image);
}

static void test_ghosts(void **state)
{
    struct ops_ghosts g[4] = {{{0}, {0}, 0}};
    struct box box;
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (size_t s = 0; s < COUNT(sizes); s++)
            for (size_t k = 0; make_box(&box, dim, k); k += sizes[s] > 1000 ? 11 : 1) {
                const double margin = k % 3 ? 0.3 : sizes[s] > 1000 ? 0.1 : 1.1;
                struct particles p, q;
                struct ghosts want = {0};
                struct arena a;
                make(&p, dim, sizes[s]);
                sides_wrap(&box, &p);
                copy(&q, &p);
                open_arena(&a, &p);
                OK(ops_ghosts_make(ops[dim], &a, &g[dim], &box, margin, &e));
                OK(ghosts_make(&want, &box, &q, margin, &e));
                assert_int_equal(g[dim].n, want.n);
                assert_int_equal(a.n_ghost, want.n);
                compare_ghosts(&a, &g[dim], &q, &want, &box);
                fill(&p);
                get_all(&a); /* none of it has suffered */
                assert_same(&p, &q, true, 0);
                ghosts_fini(&want);
                arena_fini(&a);
                particles_fini(&p);
                particles_fini(&q);
            }
    for (int dim = 1; dim <= 3; dim++)
        ops_ghosts_release(ops[dim], &g[dim]);
}

static void test_too_narrow(void **state)
{
    struct ops_ghosts g = {{0}, {0}, 0};
    struct ghosts want = {0};
    struct particles p;
    struct arena a;
    struct error other;
    struct box box;
    (void)state;
    make_box(&box, 2, 6);
    make(&p, 2, 10);
    open_arena(&a, &p);
    assert_int_equal(ops_ghosts_make(ops[2], &a, &g, &box, 1.5, &e), -1);
    assert_int_equal(ghosts_make(&want, &box, &p, 1.5, &other), -1);
    assert_string_equal(e.text, other.text);
    assert_int_equal(e.exit_code, other.exit_code);
    ops_ghosts_release(ops[2], &g);
    ghosts_fini(&want);
    arena_fini(&a);
    particles_fini(&p);
}

/* -- Integrators -------- */

/* The table's operations but for evaluations on columns of their own, by their definition. */
static void by_hand(struct particles *p, const struct rate *rate, const struct op *op, double dt)
{
    const struct column *c = p->column;
    if (!(op->on & rate->kind))
        return;
    for (uint32_t k = 0; k < c[rate->property].ncomp; k++)
        for (size_t i = 0; i < p->n; i++) {
            const double r = column_get(&c[rate->rate], k, i);
            const double y = column_get(&c[rate->property], k, i);
            double value = 0;
            switch (op->kind) {
            case OP_COMBINE:
                for (int s = 0; s < SLOT_COUNT; s++)
                    if (op->weight[s] != 0.0)
                        value += op->weight[s] * column_get(&c[rate->kept[s]], k, i);
                value += op->a * dt * r;
                if (op->a2 != 0.0 && rate->rate == V)
                    value += op->a2 * dt * dt * column_get(&c[F], k, i);
                column_set(&c[rate->kept[op->to]], k, i, value);
                break;
            case OP_SWAP:
                column_set(&c[rate->property], k, i, column_get(&c[rate->kept[SLOT_0]], k, i));
                column_set(&c[rate->kept[SLOT_0]], k, i, y);
                break;
            case OP_SAVE_RATES:
                column_set(&c[rate->saved], k, i, r);
                break;
            case OP_CORRECT:
                value = column_get(&c[rate->saved], k, i);
                column_set(&c[rate->property], k, i, y + op->a * dt * (r - value));
                break;
            default:
                break;
            }
        }
}

/* x drifts with v, v is kicked by f (floats), s by g (floats). */
static void rates_of(struct particles *p, struct rate rate[3])
{
    static const struct {
        int property, rate;
        uint32_t kind;
    } each[3] = {{X, V, SPH_DRIFT}, {V, F, SPH_KICK}, {S, G, SPH_KICK}};
    for (int q = 0; q < 3; q++) {
        const struct column *c = &p->column[each[q].property];
        char name[16];
        rate[q] = (struct rate){.property = each[q].property,
                                .rate = each[q].rate,
                                .kind = each[q].kind,
                                .kept = {each[q].property, 0, 0},
                                .closed = NO_PASS,
                                .anew = true};
        for (int s = 0; s < 3; s++) {
            static const char *const end[3] = {"-", ".0", ".1"};
            snprintf(name, sizeof name, "%s%s", p->column[each[q].property].name, end[s]);
            const int k = particles_add(p, name, "", "", c->type, &e);
            c = &p->column[each[q].property];
            assert_true(k >= 0);
            if (s == 0)
                rate[q].saved = k;
            else
                rate[q].kept[s] = k;
        }
    }
    fill(p);
}

static void test_operations(void **state)
{
    size_t count;
    const char *const *name = integrator_names(&count);
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (size_t s = 0; s < COUNT(sizes); s++)
            for (size_t t = 0; t < count; t++) {
                const struct integrator *table = integrator_find(name[t]);
                struct particles p, q;
                struct rate rate[3];
                struct plan_array pa = {.rate = rate, .n_rate = 3};
                struct arena a;
                bool bad;
                if (sizes[s] > 10000 && t % 4)
                    continue;
                make(&p, dim, sizes[s]);
                rates_of(&p, rate);
                make(&q, dim, sizes[s]);
                rates_of(&q, rate);
                open_arena(&a, &p);
                for (size_t c = 0; c < p.n_column; c++)
                    for (uint32_t k = 0; column_is_real(&p.column[c]) && k < p.column[c].ncomp; k++)
                        for (size_t i = 0; i < p.n; i++)
                            column_set(&q.column[c], k, i, column_get(&p.column[c], k, i));
                for (int step = 1; step <= 2; step++) {
                    OK(ops_advance(ops[dim], &a, &pa, table->op, 0, table->n_op, 0.125 * step, &bad,
                                   &e));
                    assert_false(bad);
                    for (size_t o = 0; o < table->n_op; o++)
                        for (int r = 0; r < 3; r++)
                            by_hand(&q, &rate[r], &table->op[o], 0.125 * step);
                }
                for (size_t c = 0; c < p.n_column; c++)
                    if (!a.there[c])
                        OK(arena_get(&a, (int)c, &e));
                memcpy(q.column[I].data, p.column[I].data, p.n * 4);
                memcpy(q.column[L].data, p.column[L].data, p.n * 8);
                for (size_t c = 0; c < p.n_column; c++)
                    for (uint32_t k = 0; column_is_real(&p.column[c]) && k < p.column[c].ncomp; k++)
                        for (size_t i = 0; i < p.n; i++) {
                            const double x = column_get(&p.column[c], k, i);
                            const double y = column_get(&q.column[c], k, i);
                            if (!(fabs(x - y) <= (p.column[c].size == 4 ? 3e-7 : 2e-15)))
                                fail_msg("%s, %s[%u] of %zu: off by %g", name[t], p.column[c].name,
                                         k, i, x - y);
                        }
                for (size_t i = 0; i < p.n && i < 20; i += 3) {
                    const double old = column_get(&p.column[F], 0, p.n - 1 - i);
                    column_set(&p.column[F], 0, p.n - 1 - i, NAN);
                    OK(arena_put(&a, F, &e));
                    OK(ops_advance(ops[dim], &a, &pa, &(struct op)KICK(0.5), 0, 1, 0.1, &bad, &e));
                    assert_true(bad);
                    column_set(&p.column[F], 0, p.n - 1 - i, old);
                }
                arena_fini(&a);
                particles_fini(&p);
                particles_fini(&q);
            }
}

/* Evaluations on the host, all else of the step on the device: as run_advance. */
static void step_on_device(struct motion *m, struct arena *a, double dt)
{
    struct plan_array *pa = &m->rig.plan.array[0];
    const struct integrator *table = m->rig.plan.integrator;
    struct op op[OPS_MAX];
    const double begin = m->run.time;
    memcpy(op, table->op, table->n_op * sizeof *op);
    if (table->adapt)
        table->adapt(op, m->run.step, m->run.dt_last > 0.0 ? dt / m->run.dt_last : NAN);
    m->run.dt_last = m->run.dt = dt;
    for (size_t k = 0, end; k < table->n_op; k = end + 1) {
        for (end = k; end < table->n_op && op[end].kind != OP_EVALUATE;)
            end++;
        bool bad;
        OK(ops_advance(ops[2], a, pa, op, k, end, dt, &bad, &e));
        assert_false(bad);
        if (end == table->n_op)
            break;
        m->run.time = begin + op[end].a * dt;
        for (size_t c = 0; c < pa->p.n_column; c++)
            if (!a->there[c])
                OK(arena_get(a, (int)c, &e));
        passes(m, MOMENT_EVALUATE);
        put_all(a);
    }
    get_all(a);
    m->run.time = begin + dt;
    m->run.step++;
}

static void test_integrators(void **state)
{
    size_t count;
    const char *const *name = integrator_names(&count);
    (void)state;
    for (size_t t = 0; t < count; t++) {
        struct motion host, here;
        struct motion *both[2] = {&host, &here};
        struct arena a;
        for (int k = 0; k < 2; k++) {
            rig_open(&both[k]->rig, &motion_items,
                     "{'dimensions':2,'domain':{'min':[0,0],'max':[1,1]},'particles':{'mass':{"
                     "'fill':{'lattice':'square','count':9},'fields':{'rho':1,'v':['y','x*y']}}},"
                     "'scheme':{'name':'swing','damping':0.3},'time':{'end':1,'integrator':'%s'},"
                     "'watch':false}",
                     name[t]);
            begin(both[k], 1);
            passes(both[k], MOMENT_EVALUATE);
        }
        struct particles *p = &here.rig.plan.array[0].p, *q = &host.rig.plan.array[0].p;
        open_arena(&a, p);
        for (int n = 0; n < 45; n++) { /* some do something else at the 40th */
            const double dt = n < 42 ? 0.05 : 0.04;
            steps(&host, dt, 1);
            step_on_device(&here, &a, dt);
        }
        for (size_t c = 0; c < p->n_column; c++)
            for (uint32_t k = 0; column_is_real(&p->column[c]) && k < p->column[c].ncomp; k++)
                for (size_t i = 0; i < p->n; i++)
                    if (!strstr(p->column[c].name, ".") &&
                        !(fabs(column_get(&p->column[c], k, i) - column_get(&q->column[c], k, i)) <
                          1e-13))
                        fail_msg("%s: %s is off by %g", name[t], p->column[c].name,
                                 column_get(&p->column[c], k, i) - column_get(&q->column[c], k, i));
        arena_fini(&a);
        end(&host);
        end(&here);
    }
}

static int open_all(void **state)
{
    (void)state;
    if (device_open(&device, 0, &e))
        return -1;
    for (int dim = 1; dim <= 3; dim++)
        if (ops_open(&ops[dim], device, dim, &e)) {
            print_error("%s\n", e.text);
            return -1;
        }
    return 0;
}

static int close_all(void **state)
{
    size_t most;
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        ops_close(ops[dim]);
    const size_t left = device_bytes(device, &most);
    device_close(device);
    return left != 0; /* nothing is forgotten there */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_arena),      cmocka_unit_test(test_mirror),
        cmocka_unit_test(test_permute),    cmocka_unit_test(test_reduce),
        cmocka_unit_test(test_skin),       cmocka_unit_test(test_wrap),
        cmocka_unit_test(test_ghosts),     cmocka_unit_test(test_too_narrow),
        cmocka_unit_test(test_operations), cmocka_unit_test(test_integrators),
    };
    struct device *d;
    if (device_open(&d, 0, &e) || !device_facts(d)->fp64) {
        print_message("skipped: %s\n", e.text);
        return 77;
    }
    device_close(d);
    return cmocka_run_group_tests(tests, open_all, close_all);
}
