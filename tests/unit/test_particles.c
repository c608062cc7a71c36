/* tests/unit/test_particles.c -- columns: types, growth, order, alignment, guards. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "particles/particles.h"

#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static struct particles make(int dim)
{
    struct particles p;
    struct error e;

    assert_int_equal(particles_init(&p, "fluid", dim, &e), 0);
    return p;
}

static void knows_types(void **state)
{
    (void)state;
    assert_int_equal(property_ncomp(SPH_SCALAR, 3), 1);
    assert_int_equal(property_ncomp(SPH_VECTOR, 2), 2);
    assert_int_equal(property_ncomp(SPH_SYM, 1), 1);
    assert_int_equal(property_ncomp(SPH_SYM, 2), 3);
    assert_int_equal(property_ncomp(SPH_SYM, 3), 6);
    assert_int_equal(property_ncomp(SPH_MATRIX, 3), 9);
    assert_int_equal(property_ncomp(SPH_INT64, 3), 1);
    assert_int_equal(property_ncomp(99, 3), 0);
    assert_int_equal(property_size(SPH_INT32), 4);
    assert_int_equal(property_size(SPH_INT64), 8);
    assert_int_equal(property_size(SPH_VECTOR), 8);
}

static void refuses(void **state)
{
    struct particles p;
    struct error e;

    (void)state;
    assert_int_equal(particles_init(&p, "fluid", 4, &e), -1);
    assert_non_null(strstr(e.text, "4 dimensions"));
    p = make(2);
    assert_int_equal(particles_add(&p, "rho", "kg/m^d", "density", SPH_SCALAR, &e), 0);
    assert_int_equal(particles_add(&p, "rho", "", "", SPH_VECTOR, &e), -1);
    assert_non_null(strstr(e.text, "fluid.rho"));
    assert_int_equal(particles_add(&p, "odd", "", "", 77, &e), -1);
    assert_int_equal(particles_resize(&p, (size_t)1 << 33, 0, &e), -1);
    assert_int_equal(particles_resize(&p, SIZE_MAX, 2, &e), -1);
    assert_int_equal(p.n, 0);
    assert_true(particles_is_valid(&p));
    particles_fini(&p);
}

static void adds_once(void **state)
{
    struct particles p = make(3);
    struct error e;

    (void)state;
    assert_int_equal(particles_resize(&p, 10, 3, &e), 0);
    assert_int_equal(particles_add(&p, "x", "m", "position", SPH_VECTOR, &e), 0);
    assert_int_equal(particles_add(&p, "n", NULL, NULL, SPH_INT32, &e), 1);
    assert_int_equal(particles_add(&p, "x", "m", "position", SPH_VECTOR, &e), 0);
    assert_int_equal(p.n_column, 2);
    assert_int_equal(particles_find(&p, "n"), 1);
    assert_int_equal(particles_find(&p, "nn"), -1);
    assert_ptr_equal(particles_real(&p, "x", 2),
                     (double *)p.column[0].data + 2 * p.column[0].plane);
    assert_null(particles_real(&p, "x", 3));
    assert_null(particles_real(&p, "n", 0));
    assert_null(particles_real(&p, "y", 0));
    assert_int_equal(particles_bytes(&p), 28);
    for (size_t i = 0; i < 3 * p.column[0].plane; i++) {
        assert_true(((double *)p.column[0].data)[i] == 0);
    }
    assert_true(particles_is_valid(&p));
    particles_fini(&p);
}

static void views(void **state)
{
    struct particles p = make(2);
    struct error e;
    sph_column c;

    (void)state;
    particles_add(&p, "s", "", "", SPH_SYM, &e);
    particles_resize(&p, 100, 0, &e);
    c = particles_column(&p, 0);
    assert_ptr_equal(c.data, p.column[0].data);
    assert_int_equal(c.ncomp, 3);
    assert_int_equal(c.type, SPH_SYM);
    assert_true(c.plane >= 100 + PARTICLES_PAD);
    assert_int_equal((uintptr_t)c.data % 64, 0);
    assert_int_equal(c.plane * 8 % 64, 0);
    assert_int_equal(particles_at_address(&p, c.data), 0);
    assert_int_equal(particles_at_address(&p, (double *)c.data + 3 * c.plane - 1), 0);
    assert_int_equal(particles_at_address(&p, &p), -1);
    particles_fini(&p);
}

/* Values of a column of two components that no float holds. */
static double some_value(size_t k, size_t i)
{
    return (double)(k + 1) / 3 + (double)i * 1e-9;
}

static void assert_values(const struct particles *p, const uint32_t *order, double within)
{
    double laid[3];

    for (uint32_t k = 0; k < 2; k++) {
        column_load(&p->column[0], k, 1, 3, laid);
        for (size_t i = 0; i < p->n; i++) {
            double right = some_value(k, order ? order[i] : i);

            assert_true(fabs(column_get(&p->column[0], k, i) - right) <= within);
            assert_true(i < 1 || i > 3 || laid[i - 1] == column_get(&p->column[0], k, i));
        }
    }
    assert_true(particles_is_valid(p));
}

/* Two floats, and quanta: nearly doubles, through all that moves particles about. */
static void holds(void **state)
{
    static const uint32_t order[] = {3, 1, 4, 0, 2, 5, 9, 8, 7, 6};
    static const double centre[] = {0.25, 0.75, 0}, far[] = {NAN, 1e30, 0.5};

    (void)state;
    for (int quanta = 0; quanta < 2; quanta++) {
        struct particles p = make(2);
        const struct column *c;
        struct error e;

        particles_add(&p, "x", "m", "position", SPH_VECTOR, &e);
        particles_resize(&p, 10, 0, &e);
        c = &p.column[0];
        p.column[0].state = true;
        for (uint32_t k = 0; k < 2; k++) {
            for (size_t i = 0; i < 10; i++) {
                column_set(c, k, i, some_value(k, i));
            }
        }
        assert_int_equal(quanta ? particles_hold_quanta(&p, 0, centre, 0x1p-31, &e)
                                : particles_hold(&p, 0, 4, true, &e),
                         0);
        assert_int_equal(particles_bytes(&p), 16);
        assert_ptr_equal(particles_column4(&p, 0).data, c->data);
        assert_values(&p, NULL, 0x1p-49);
        for (size_t i = 0; quanta && i < 10; i++) {
            assert_true(fabs(((int32_t *)c->data)[i] * 0x1p-31 + 0.25 - some_value(0, i)) <=
                        0x1p-32);
        }
        assert_int_equal(particles_resize(&p, 10, 1000, &e), 0);
        assert_int_equal(particles_permute(&p, order, &e), 0);
        assert_values(&p, order, 0x1p-49);
        assert_int_equal(particles_gather(&p, order, 10, &e), 0);
        assert_int_equal(particles_hold(&p, 0, 8, false, &e), 0);
        assert_null(p.column[0].low);
        assert_true(fabs(particles_real(&p, "x", 0)[0] - some_value(0, order[order[0]])) <=
                    0x1p-49);
        assert_int_equal(quanta ? particles_hold_quanta(&p, 0, centre, 0x1p-31, &e)
                                : particles_hold(&p, 0, 4, true, &e),
                         0);
        /* What is no number stays so, what is far away far away; one way and the other. */
        column_store(c, 0, 0, 3, far);
        for (size_t i = 0; i < 3; i++) {
            column_set(c, 1, i, far[i]);
        }
        for (uint32_t k = 0; k < 2; k++) {
            assert_true(isnan(column_get(c, k, 0)));
            assert_true(column_get(c, k, 1) > 0.99e30);
            assert_true(column_get(c, k, 2) == 0.5);
        }
        particles_fini(&p);
    }
}

static void trades(void **state)
{
    struct particles p = make(1);
    struct error e;

    (void)state;
    particles_add(&p, "a", "", "", SPH_SCALAR, &e);
    particles_add(&p, "b", "", "", SPH_SCALAR, &e);
    particles_resize(&p, 7, 0, &e);
    particles_real(&p, "a", 0)[6] = 1;
    particles_real(&p, "b", 0)[6] = 2;
    assert_int_equal(particles_mirror(&p, 0, &e), 0);
    particles_swap(&p, 0, 1);
    assert_true(particles_real(&p, "a", 0)[6] == 2);
    assert_true(particles_real(&p, "b", 0)[6] == 1);
    assert_string_equal(p.column[0].name, "a");
    /* Whoever reads a column in floats goes on to do so. */
    assert_true(p.column[0].mirror != NULL && p.column[1].mirror == NULL);
    assert_true(particles_is_valid(&p));
    particles_fini(&p);
}

/* Planes of INT32 columns are aligned as well; the pad may be read (the sanitizers look on). */
static void pads(void **state)
{
    struct particles p = make(3);
    struct error e;
    double sum = 0;

    (void)state;
    for (size_t n = 1; n < 300; n += 37) {
        particles_resize(&p, n, 0, &e);
        particles_add(&p, "a", "", "", SPH_MATRIX, &e);
        particles_add(&p, "b", "", "", SPH_INT32, &e);
        for (uint32_t k = 0; k < 9; k++) {
            for (size_t i = 0; i < p.capacity + PARTICLES_PAD; i++) {
                sum += particles_real(&p, "a", k)[i];
            }
            assert_int_equal((uintptr_t)particles_real(&p, "a", k) % 64, 0);
        }
        for (size_t i = 0; i < p.capacity + PARTICLES_PAD; i++) {
            sum += ((int32_t *)p.column[1].data)[i];
        }
        assert_true(particles_is_valid(&p));
    }
    assert_true(sum == 0);
    particles_fini(&p);
}

static void grows(bool guarded)
{
    struct particles p = make(2);
    struct error e;
    double *v;
    int64_t *id;
    size_t capacity;

    p.guarded = guarded;
    particles_add(&p, "v", "", "", SPH_VECTOR, &e);
    particles_add(&p, "id", "", "", SPH_INT64, &e);
    assert_int_equal(particles_resize(&p, 5, 2, &e), 0);
    v = particles_real(&p, "v", 1);
    id = p.column[1].data;
    for (size_t i = 0; i < 7; i++) {
        v[i] = 10.0 + (double)i;
        id[i] = (int64_t)i - 3;
    }
    /* More ghosts: those there stay. */
    assert_int_equal(particles_resize(&p, 5, 1000, &e), 0);
    v = particles_real(&p, "v", 1);
    id = p.column[1].data;
    for (size_t i = 0; i < 1005; i++) {
        assert_true(v[i] == (i < 7 ? 10.0 + (double)i : 0));
        assert_int_equal(id[i], i < 7 ? (int64_t)i - 3 : 0);
    }
    for (size_t i = 0; i < 1005; i++) {
        v[i] = 1;
    }
    /* More particles: the ghosts are forgotten, within the capacity and beyond it. */
    capacity = p.capacity;
    assert_int_equal(particles_resize(&p, 50, 10, &e), 0);
    assert_int_equal(p.capacity, capacity);
    v = particles_real(&p, "v", 1);
    for (size_t i = 0; i < 60; i++) {
        assert_true(v[i] == (i < 5 ? 1 : 0));
        v[i] = 2;
    }
    assert_int_equal(particles_resize(&p, 5000, 0, &e), 0);
    v = particles_real(&p, "v", 1);
    for (size_t i = 0; i < 5000; i++) {
        assert_true(v[i] == (i < 50 ? 2 : 0));
    }
    assert_int_equal(particles_resize(&p, 3, 0, &e), 0);
    assert_true(particles_real(&p, "v", 1)[2] == 2);
    assert_true(particles_is_valid(&p));
    assert_true(p.arena_bytes >= 24 * 5000);
    particles_fini(&p);
    assert_int_equal(p.arena_bytes, 0);
}

static void grows_and_keeps(void **state)
{
    (void)state;
    grows(false);
    grows(true);
}

static void permutes(void **state)
{
    static const uint32_t order[5] = {3, 1, 4, 0, 2}, wrong[5] = {3, 1, 5, 0, 2};
    struct particles p = make(2);
    struct error e;
    double *v;
    int32_t *tag;

    (void)state;
    particles_add(&p, "v", "", "", SPH_VECTOR, &e);
    particles_add(&p, "tag", "", "", SPH_INT32, &e);
    particles_add(&p, "rate", "", "", SPH_SCALAR, &e);
    p.column[0].state = p.column[1].state = true;
    assert_int_equal(particles_permute(&p, order, &e), 0); /* nothing there */
    particles_resize(&p, 5, 0, &e);
    v = particles_real(&p, "v", 0);
    tag = p.column[1].data;
    for (int i = 0; i < 5; i++) {
        v[i] = i;
        v[p.column[0].plane + (size_t)i] = 10 + i;
        tag[i] = 20 + i;
        particles_real(&p, "rate", 0)[i] = 30 + i;
    }
    assert_int_equal(particles_permute(&p, wrong, &e), -1);
    assert_non_null(strstr(e.text, "fluid"));
    assert_int_equal(particles_permute(&p, order, &e), 0);
    for (int i = 0; i < 5; i++) {
        assert_true(v[i] == order[i]);
        assert_true(v[p.column[0].plane + (size_t)i] == 10 + order[i]);
        assert_int_equal(tag[i], 20 + order[i]);
        assert_true(particles_real(&p, "rate", 0)[i] == 30 + i);
    }
    particles_fini(&p);
}

/* Does what a pass would do in a child; true if it was killed for it. */
static bool killed(volatile double *at, bool write)
{
    pid_t child = fork();
    int status = 0;

    if (child == 0) {
        signal(SIGSEGV, SIG_DFL);
        if (write) {
            *at = 1;
        } else {
            (void)*at;
        }
        _exit(0);
    }
    waitpid(child, &status, 0);
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGSEGV;
}

static void guards(void **state)
{
    struct particles p = make(1);
    struct error e;
    volatile double *u, *w;

    (void)state;
    p.guarded = true;
    particles_resize(&p, 10, 0, &e);
    particles_add(&p, "u", "", "", SPH_SCALAR, &e);
    particles_add(&p, "w", "", "", SPH_SCALAR, &e);
    u = particles_real(&p, "u", 0);
    w = particles_real(&p, "w", 0);
    assert_false(killed(u, true));
    assert_int_equal(particles_guard(&p, 0, 1), 0);
    assert_false(killed(u, false));
    assert_true(killed(u, true));
    assert_false(killed(w, true)); /* the neighbour is left alone */
    assert_int_equal(particles_guard(&p, 0, 0), 0);
    assert_true(killed(u, false));
    assert_int_equal(particles_guard(&p, 0, 2), 0);
    assert_false(killed(u, true));
    /* The page behind the column is nobody's, and still the column's. */
    assert_true(killed(u + (size_t)sysconf(_SC_PAGESIZE) / 8, false));
    assert_int_equal(
        particles_at_address(&p, (const void *)(uintptr_t)(u + (size_t)sysconf(_SC_PAGESIZE) / 8)),
        0);
    assert_int_equal(particles_at_address(&p, (const void *)(uintptr_t)w), 1);
    /* The core may grow what the audit has closed. */
    assert_int_equal(particles_guard(&p, 0, 0), 0);
    assert_int_equal(particles_resize(&p, 10000, 0, &e), 0);
    assert_false(killed(particles_real(&p, "u", 0) + 9999, true));
    particles_fini(&p);
    p = make(1);
    particles_add(&p, "u", "", "", SPH_SCALAR, &e);
    assert_int_equal(particles_guard(&p, 0, 0), -1); /* not guarded */
    particles_fini(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(knows_types), cmocka_unit_test(refuses),
        cmocka_unit_test(adds_once),   cmocka_unit_test(views),
        cmocka_unit_test(holds),       cmocka_unit_test(trades),
        cmocka_unit_test(pads),        cmocka_unit_test(grows_and_keeps),
        cmocka_unit_test(permutes),    cmocka_unit_test(guards),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
