/* test_opencl_sides.c -- on a device, particles that leave the domain and ghosts against
 * domain/sides.c. Skips itself where there is no device. */
#include "config.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "device_columns.h"
#include "domain/sides.h"

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
            for (size_t k = 0; make_box(&box, dim, k); k += sizes[s] > 1000 ? 17
                                                            : dim == 3      ? 4
                                                                            : 1) {
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
                OK(ops_wrap(ops[dim], &a, &box, &moved, &why));
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
    OK(device_read(device, &g->parent, 0, parent, n * sizeof *parent, &why));
    OK(device_read(device, &g->image, 0, image, n, &why));
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
        OK(ops_ghosts_refresh(ops[q->dim], a, g, box, c, &why));
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
            for (size_t k = 0; make_box(&box, dim, k); k += sizes[s] > 1000 ? 19
                                                            : dim == 3      ? 4
                                                                            : 1) {
                const double margin = k % 3 ? 0.3 : sizes[s] > 1000 ? 0.1 : 1.1;
                struct particles p, q;
                struct ghosts want = {0};
                struct arena a;
                make(&p, dim, sizes[s]);
                sides_wrap(&box, &p);
                copy(&q, &p);
                open_arena(&a, &p);
                OK(ops_ghosts_make(ops[dim], &a, &g[dim], &box, margin, &why));
                OK(ghosts_make(&want, &box, &q, margin, &why));
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
    assert_int_equal(ops_ghosts_make(ops[2], &a, &g, &box, 1.5, &why), -1);
    assert_int_equal(ghosts_make(&want, &box, &p, 1.5, &other), -1);
    assert_string_equal(why.text, other.text);
    assert_int_equal(why.exit_code, other.exit_code);
    ops_ghosts_release(ops[2], &g);
    ghosts_fini(&want);
    arena_fini(&a);
    particles_fini(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_wrap),
        cmocka_unit_test(test_ghosts),
        cmocka_unit_test(test_too_narrow),
    };
    RUN_BOTH(tests);
}
