/* test_opencl_ops.c -- columns on a device against the same on the host: transfers, mirrors, order,
 * reductions, how far particles have moved. Skips itself where there is no device. */
#include "config.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "device_columns.h"
#include "neighbours/skin.h"
#include "opencl/look.h"
#include "run/run.h"

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
            OK(arena_resize(&a, p.n, 3 * p.n + 5, &why)); /* they move */
            fill(&p);
            get_all(&a);
            assert_same(&p, &before, true, 0);
            /* Fewer on the device: the host follows. */
            OK(arena_resize(&a, p.n / 2, 0, &why));
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
            OK(ops_mirror(ops[dim], &a, S, &why));
            OK(ops_mirror(ops[dim], &a, H, &why)); /* has none */
            OK(ops_mirror_places(ops[dim], &a, X, centre, quantum, &why));
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
            OK(ops_flags(ops[dim], &flags, &why));
            assert_int_equal(flags, 0);
            if (p.n) {
                column_set(&p.column[X], (uint32_t)dim - 1, p.n - 1, s % 2 ? NAN : 3.5);
                arena_written_there(&a, X);
                OK(arena_put(&a, X, &why));
                OK(ops_mirror_places(ops[dim], &a, X, centre, quantum, &why));
                OK(ops_flags(ops[dim], &flags, &why));
                assert_int_equal(flags, OPS_NOWHERE);
                OK(ops_flags(ops[dim], &flags, &why));
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
            OK(arena_init(&a, device, &p, &why)); /* what is not there is brought */
            OK(ops_copy(ops[dim], &a, V, X0, &why));
            memcpy(q.column[X0].data, q.column[V].data, (size_t)dim * q.column[V].plane * 8);
            assert_int_equal(ops_copy(ops[dim], &a, V, X1, &why), -1);
            OK(arena_resize(&a, n, 5, &why));
            OK(device_reserve(device, &order, n * sizeof *to, "test", &why));
            OK(device_write(device, &order, 0, to, n * sizeof *to, &why));
            OK(ops_permute(ops[dim], &a, &order, &why));
            OK(particles_permute(&q, to, &why));
            for (int c = 0; c < KINDS && n; c++)
                assert_true(a.here[c] == kind[c].state && !a.there[c]);
            assert_int_equal(a.n_ghost, 0);
            fill(&p);
            get_all(&a);
            if (n)
                assert_same(&p, &q, false, 0);
            if (n > 1) {
                to[0] = (uint32_t)n;
                OK(device_write(device, &order, 0, to, n * sizeof *to, &why));
                OK(ops_permute(ops[dim], &a, &order, &why));
                OK(ops_flags(ops[dim], &flags, &why));
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

/* A sum and the sum of its numbers' sizes, to more digits. */
static long double summed(const struct particles *p, int column, int mass, double *sizes_too)
{
    long double sum = 0, size = 0;
    for (size_t i = 0; i < p->n; i++) {
        const double m = mass < 0 ? 1 : column_get(&p->column[mass], 0, i);
        const long double value = (long double)m * column_get(&p->column[column], 0, i);
        sum += value;
        size += fabsl(value);
    }
    *sizes_too = (double)size;
    return sum;
}

static void assert_reduces(const struct arena *a, int column, int mass, bool nan)
{
    const int dim = a->p->dim;
    for (uint32_t op = SPH_REDUCE_MIN; op <= SPH_REDUCE_SUM; op++) {
        const int by = op == SPH_REDUCE_SUM ? mass : -1;
        const double want =
            reduce_range(&a->p->column[column], by < 0 ? NULL : &a->p->column[by], op, 0, a->p->n);
        double got[2], size;
        for (int k = 0; k < 2; k++)
            OK(ops_reduce(ops[dim], a, column, 0, by, op, &got[k], &why));
        assert_memory_equal(&got[0], &got[1], sizeof got[0]);
        if (nan && a->n)
            assert_true(isnan(got[0]) && isnan(want));
        else if (op == SPH_REDUCE_SUM) {
            const long double sum = summed(a->p, column, by, &size);
            assert_true(fabsl(got[0] - sum) <= 3e-15L * size); /* some 22 roundings at most */
        } else
            assert_true(got[0] == want);
    }
}

static void range_of_v(const struct arena *a, double *least, double *most)
{
    OK(ops_reduce(ops[2], a, V, 1, -1, SPH_REDUCE_MIN, least, &why));
    OK(ops_reduce(ops[2], a, V, 1, -1, SPH_REDUCE_MAX, most, &why));
}

static struct look *look;

static bool is_wrong(const struct arena *a, int column, bool finite, double least)
{
    const struct look_column c = {column, finite, least};
    bool wrong, still;
    OK(look_at_columns(look, a, &c, 1, &why));
    OK(look_wrong(look, &wrong, &why));
    OK(look_wrong(look, &still, &why));
    assert_false(still); /* it was asked for */
    return wrong;
}

static void test_reduce(void **state)
{
    (void)state;
    OK(look_open(&look, device, 2, &why));
    for (size_t s = 0; s < COUNT(sizes); s++) {
        struct particles p;
        struct arena a;
        double least, most, result[2];
        make(&p, 2, sizes[s]);
        open_arena(&a, &p);
        OK(arena_resize(&a, p.n, 9, &why)); /* ghosts do not count */
        assert_reduces(&a, H, -1, false);
        assert_reduces(&a, H, H, false);
        assert_reduces(&a, F, -1, false);
        assert_reduces(&a, X1, F, false);
        range_of_v(&a, &least, &most);
        double low = INFINITY, high = -INFINITY, sum = 0;
        for (size_t i = 0; i < p.n; i++) {
            low = fmin(low, column_get(&p.column[V], 1, i));
            high = fmax(high, column_get(&p.column[V], 1, i));
            sum += column_get(&p.column[S], 2, i);
        }
        assert_true(least == low && most == high);
        assert_int_equal(is_wrong(&a, V, true, -INFINITY), false);
        assert_int_equal(is_wrong(&a, H, true, 0.09), false);
        assert_int_equal(is_wrong(&a, H, true, 0.2), p.n > 0);
        for (size_t i = 0; i < p.n; i += 1 + p.n / 3) {
            column_set(&p.column[H], 0, i, i ? NAN : -1);
            column_set(&p.column[F], 1, i, NAN);
            column_set(&p.column[V], 0, i, INFINITY);
            column_set(&p.column[V], 1, p.n - 1 - i, -NAN);
        }
        const size_t bad = p.n ? (p.n - 1) / (1 + p.n / 3) + 1 : 0;
        put_all(&a);
        /* Several at once. */
        OK(ops_reduce_begin(ops[2], &a, S, 0, -1, SPH_REDUCE_MAX, 0, &why));
        OK(ops_reduce_begin(ops[2], &a, S, 2, -1, SPH_REDUCE_SUM, 1, &why));
        OK(ops_results(ops[2], result, 2, NULL, &why));
        assert_true(bad ? isfinite(result[0]) : result[0] == -INFINITY);
        assert_int_equal(is_wrong(&a, V, true, -INFINITY), bad > 0);
        assert_int_equal(is_wrong(&a, H, false, 0.0), bad > 0);
        assert_int_equal(is_wrong(&a, F, false, -INFINITY), bad > 0);
        assert_int_equal(is_wrong(&a, S, true, -INFINITY), false);
        assert_true(fabs(result[1] - sum) <= 1e-13 * (double)(p.n + 1));
        assert_reduces(&a, H, -1, bad > 1);
        range_of_v(&a, &least, &most);
        assert_true(bad ? isnan(least) && isnan(most) : least == INFINITY);
        arena_fini(&a);
        particles_fini(&p);
    }
    look_close(look);
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
            OK(ops_skin_keep(ops[dim], &kept, &a, X, H, &why));
            OK(skin_keep(&host, &cloud, 1, &why));
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
            OK(ops_skin_change(ops[dim], &kept, &a, X, H, scale, relative, &moved, &room, &why));
            const struct skin_change change = skin_change(&host, &cloud, relative, 1);
            assert_true(fabs(moved - most) <= 1e-15);
            assert_true(p.n ? fabs(room - least) <= 1e-15 : room == INFINITY);
            assert_true(!p.n || (moved <= change.moved + 1e-15 && moved >= change.moved - 5e-4));
            assert_true(!p.n || (room >= change.room - 1e-15 && room <= change.room + 1e-3));
            if (p.n) {
                column_set(&p.column[s % 2 ? X : H], 0, p.n / 2, NAN);
                put_all(&a);
                OK(ops_skin_begin(ops[dim], &kept, &a, X, H, scale, relative, 0, &why));
                OK(ops_results(ops[dim], result, 2, NULL, &why));
                assert_true(isnan(result[0]));
                assert_false(skin_holds((struct skin_change){result[0], result[1]}));
            }
            OK(arena_resize(&a, p.n + 1, 0, &why));
            OK(ops_skin_change(ops[dim], &kept, &a, X, H, scale, relative, &moved, &room, &why));
            assert_true(isnan(moved) && isnan(room));
            skin_fini(&host);
            ops_skin_release(ops[dim], &kept);
            arena_fini(&a);
            particles_fini(&p);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_arena),   cmocka_unit_test(test_mirror),
        cmocka_unit_test(test_permute), cmocka_unit_test(test_reduce),
        cmocka_unit_test(test_skin),
    };
    RUN_BOTH(tests);
}
