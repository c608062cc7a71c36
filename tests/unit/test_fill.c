/* tests/unit/test_fill.c -- lattices, sizes, fields, masses, overlaps; and what is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene/fill.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))
#define REST ", \"scheme\": \"s\", \"time\": {\"end\": 1}}"

struct made {
    struct document d;
    struct scene s;
    struct particles p[2];
    size_t n;
    bool given[2][16];
    uint64_t count[2];
};

static void open_scene(struct made *m, const char *text)
{
    struct error e = {0};
    memset(m, 0, sizeof *m);
    if (document_parse(&m->d, "s.json", text, strlen(text), &e) < 0 ||
        scene_compile(&m->s, &m->d, &e) < 0)
        fail_msg("%s", e.text);
}

static int fill_all(struct made *m, struct error *e)
{
    static const struct {
        const char *name;
        uint32_t type;
    } columns[] = {{"x", SPH_VECTOR},   {"v", SPH_VECTOR}, {"m", SPH_SCALAR}, {"h", SPH_SCALAR},
                   {"rho", SPH_SCALAR}, {"u", SPH_SCALAR}, {"p", SPH_SCALAR}, {"id", SPH_INT64}};
    int64_t id = 0;
    memset(e, 0, sizeof *e);
    for (size_t a = 0; a < m->s.n_array; a++) {
        particles_init(&m->p[a], m->s.array[a].name, m->s.dim, e);
        m->n++;
        for (size_t c = 0; c < COUNT(columns); c++)
            particles_add(&m->p[a], columns[c].name, "", "", columns[c].type, e);
        for (size_t c = 0; c < m->s.array[a].n_column; c++)
            particles_add(&m->p[a], m->s.array[a].column[c].name, "", "",
                          m->s.array[a].column[c].type, e);
        if (fill_count(&m->s, a, &m->count[a], e) < 0 ||
            fill_array(&m->p[a], &m->s, a, &id, m->given[a], e) < 0)
            return -1;
    }
    return fill_check_overlap(m->p, m->n, &m->s, e);
}

static void close_scene(struct made *m)
{
    for (size_t a = 0; a < m->n; a++)
        particles_fini(&m->p[a]);
    scene_free(&m->s);
    document_free(&m->d);
}

static void make(struct made *m, const char *text)
{
    struct error e;
    open_scene(m, text);
    if (fill_all(m, &e) < 0)
        fail_msg("%s", e.text);
    assert_int_equal(m->count[0], m->p[0].n);
}

static double sum(const struct particles *p, const char *name)
{
    double total = 0;
    for (size_t i = 0; i < p->n; i++)
        total += particles_real(p, name, 0)[i];
    return total;
}

#define SQUARE "\"dimensions\": 2, \"domain\": {\"min\": [-1, -1], \"max\": [1, 1]}"

static void test_square(void **state)
{
    struct made m;
    (void)state;
    make(&m,
         "{" SQUARE ", \"particles\": {\"fluid\": {\"fill\": {\"lattice\": \"square\", "
         "\"spacing\": 0.02}, \"fields\": {\"rho\": 2, \"u\": 1e-6, \"v\": [\"-x/r\", \"-y/r\"]}, "
         "\"columns\": {\"label\": {\"type\": \"int32\", \"value\": \"x > 0 ? 3 : -1\"}}}}" REST);
    const struct particles *p = &m.p[0];
    const double *x = particles_real(p, "x", 0), *y = particles_real(p, "x", 1);
    assert_int_equal(p->n, 10000);
    assert_true(fabs(x[0] + .99) < 1e-15 && fabs(y[0] + .99) < 1e-15);
    for (size_t i = 0; i < 10000; i++) { /* mirrored in the last bit */
        assert_true(x[i] == -x[9999 - i] && y[i] == -y[9999 - i]);
        assert_int_equal(((const int64_t *)p->column[particles_find(p, "id")].data)[i], (int64_t)i);
        assert_int_equal(((const int32_t *)p->column[particles_find(p, "label")].data)[i],
                         x[i] > 0 ? 3 : -1);
    }
    assert_true(fabs(sum(p, "m") - 8) < 1e-10);
    assert_true(fabs(particles_real(p, "h", 0)[5] - .026) < 1e-15);
    assert_true(fabs(particles_real(p, "v", 0)[0] - sqrt(.5)) < 1e-15);
    assert_true(m.given[0][particles_find(p, "rho")] && m.given[0][particles_find(p, "v")]);
    assert_false(m.given[0][particles_find(p, "p")]);
    assert_false(m.given[0][particles_find(p, "m")]);
    close_scene(&m);
}

/* At the origin r is not quite 0, so that a direction is 0 there, not NaN. */
static void test_origin(void **state)
{
    struct made m;
    (void)state;
    make(&m,
         "{\"dimensions\": 1, \"domain\": {\"min\": [-1], \"max\": [1]}, \"particles\": {\"a\": "
         "{\"fill\": {\"lattice\": \"square\", \"count\": 3}, \"fields\": {\"rho\": 1, \"v\": "
         "[\"-x/r\"]}}}" REST);
    const double *v = particles_real(&m.p[0], "v", 0);
    assert_true(v[0] == 1 && v[1] == 0 && v[2] == -1);
    close_scene(&m);
}

static void test_equal_mass(void **state)
{
    struct made m;
    (void)state;
    make(&m,
         "{\"dimensions\": 1, \"domain\": {\"min\": [0], \"max\": [1]}, \"particles\": {\"a\": "
         "{\"fill\": ["
         "{\"lattice\": \"square\", \"in\": {\"box\": {\"min\": [0], \"max\": [0.5]}}, \"mass\": "
         "0.00125, \"fields\": {\"rho\": 1, \"p\": 1}},"
         "{\"lattice\": \"square\", \"in\": {\"box\": {\"min\": [0.5], \"max\": [1]}}, \"mass\": "
         "0.00125, \"fields\": {\"rho\": 0.125, \"p\": 0.1}}]}}" REST);
    const struct particles *p = &m.p[0];
    assert_int_equal(p->n, 450);
    assert_true(fabs(particles_real(p, "x", 0)[399] - (.5 - .000625)) < 1e-15);
    assert_true(fabs(particles_real(p, "x", 0)[400] - .505) < 1e-15);
    assert_true(fabs(sum(p, "m") - .5625) < 1e-12);
    assert_true(particles_real(p, "p", 0)[400] == .1);
    close_scene(&m);
}

/* Boxes that no whole number of cells fits: the cells adapt, the mass is right. */
static void test_fit(void **state)
{
    struct made m;
    (void)state;
    make(&m,
         "{\"dimensions\": 2, \"domain\": {\"min\": [0, 0], \"max\": [1, 0.71]}, \"particles\": "
         "{\"a\": {\"fill\": {\"lattice\": \"hexagonal\", \"count\": 1000}, \"fields\": {\"rho\": "
         "3}}}" REST);
    assert_in_range(m.p[0].n, 950, 1050);
    assert_true(fabs(sum(&m.p[0], "m") - 3 * .71) < 1e-12);
    close_scene(&m);
}

/* Least distance of two points, in spacings. */
static double least_distance(const struct particles *p, double spacing)
{
    double least = INFINITY;
    for (size_t i = 0; i < p->n; i++)
        for (size_t j = 0; j < i; j++) {
            double r2 = 0;
            for (uint32_t c = 0; c < (uint32_t)p->dim; c++)
                r2 += pow(particles_real(p, "x", c)[i] - particles_real(p, "x", c)[j], 2);
            least = fmin(least, r2);
        }
    return sqrt(least) / spacing;
}

/* Each lattice has its own distance of nearest neighbours at the same volume per particle; in boxes
 * that whole cells fill. */
static void test_lattices(void **state)
{
    static const struct {
        const char *name;
        int dim;
        double box[3], distance;
    } cases[] = {{"square", 2, {3, 2, 1}, 1},
                 {"hexagonal", 2, {3.00879572, 2.97793800, 1}, 1.07456993},
                 {"cubic", 3, {1.2, 1, .7}, 1},
                 {"hexagonal", 3, {1.12246205, 1.16649685, 1.28308238}, 1.12246205},
                 {"bcc", 3, {1.25992105, 1.25992105, 1.00793684}, 1.09112364},
                 {"fcc", 3, {1.26992084, 1.26992084, 1.11118074}, 1.12246205}};
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct made m;
        char text[512], box[64];
        int dim = cases[i].dim;
        double volume = cases[i].box[0] * cases[i].box[1] * cases[i].box[2];
        snprintf(box, sizeof box, dim == 2 ? "[%.9g, %.9g]" : "[%.9g, %.9g, %.9g]", cases[i].box[0],
                 cases[i].box[1], cases[i].box[2]);
        snprintf(
            text, sizeof text,
            "{\"dimensions\": %d, \"domain\": {\"min\": %s, \"max\": %s}, \"particles\": {\"a\": "
            "{\"fill\": {\"lattice\": \"%s\", \"spacing\": 0.1}, \"fields\": {\"rho\": 1}}}" REST,
            dim, dim == 2 ? "[0, 0]" : "[0, 0, 0]", box, cases[i].name);
        make(&m, text);
        double spacing = pow(volume / (double)m.p[0].n, 1. / dim);
        assert_true(fabs(spacing - .1) < 1e-6);
        double distance = least_distance(&m.p[0], spacing);
        if (fabs(distance - cases[i].distance) > 1e-5)
            fail_msg("%s in %d: %g, not %g", cases[i].name, dim, distance, cases[i].distance);
        assert_true(fabs(sum(&m.p[0], "m") - volume) < 1e-8);
        close_scene(&m);
    }
}

static void test_shapes(void **state)
{
    struct made m;
    (void)state;
    make(&m, "{" SQUARE ", \"particles\": {\"a\": {\"fill\": {\"lattice\": \"square\", \"count\": "
             "5000, \"in\": {\"difference\": [{\"sphere\": {\"center\": [0, 0], \"radius\": 0.9}}, "
             "{\"half-space\": {\"point\": [0, 0], \"normal\": [1, 0]}}]}}, \"fields\": {\"m\": "
             "2}}}" REST);
    assert_in_range(m.p[0].n, 4800, 5200);
    for (size_t i = 0; i < m.p[0].n; i++)
        assert_true(particles_real(&m.p[0], "x", 0)[i] >= 0);
    assert_true(particles_real(&m.p[0], "m", 0)[7] == 2);
    close_scene(&m);
}

static void test_jitter(void **state)
{
    struct made m, other;
    static const char text[] =
        "{" SQUARE
        ", \"particles\": {\"a\": {\"fill\": {\"lattice\": \"square\", \"spacing\": 0.1, "
        "\"jitter\": 0.3}, \"fields\": {\"rho\": 1}}}" REST;
    (void)state;
    make(&m, text);
    make(&other, text);
    size_t moved = 0;
    for (size_t i = 0; i < m.p[0].n; i++) {
        double x = particles_real(&m.p[0], "x", 0)[i];
        double home = -.95 + .1 * (double)(i % 20);
        assert_true(x >= -1 && x < 1 && fabs(x - home) < .0300001);
        assert_true(x == particles_real(&other.p[0], "x", 0)[i]);
        moved += x != home;
    }
    assert_true(moved > 390);
    close_scene(&m);
    close_scene(&other);
}

static void test_glass(void **state)
{
    struct made m;
    (void)state;
    make(&m,
         "{" SQUARE ", \"particles\": {\"a\": {\"fill\": {\"glass\": {\"noise\": 0.02}, \"count\": "
         "1000}, \"fields\": {\"rho\": 1}}}" REST);
    assert_int_equal(m.p[0].n, 1000);
    assert_true(*m.s.array[0].fill[0].reached <= .02);
    close_scene(&m);
}

static void test_file(void **state)
{
    char path[] = "/tmp/sph-test-fill-XXXXXX", text[512];
    static const char csv[] = "x,y,v.x,rho,m,junk,tracer\n0,0,1,2,0.02,9,7\n0.1,0,3,2,0.02,9,8\n";
    struct made m;
    int fd = mkstemp(path);
    (void)state;
    assert_int_equal(write(fd, csv, sizeof csv - 1), (long)sizeof csv - 1);
    close(fd);
    snprintf(text, sizeof text,
             "{" SQUARE
             ", \"particles\": {\"a\": {\"fill\": {\"file\": \"%s\", \"rename\": {\"junk\": "
             "\"-\"}}, \"fields\": {\"u\": 4}, \"columns\": {\"tracer\": 1, \"other\": 2}}}" REST,
             path);
    make(&m, text);
    assert_int_equal(m.p[0].n, 2);
    assert_true(particles_real(&m.p[0], "v", 0)[1] == 3);
    assert_true(particles_real(&m.p[0], "u", 0)[1] == 4);
    assert_true(particles_real(&m.p[0], "tracer", 0)[1] == 8); /* restored */
    assert_true(particles_real(&m.p[0], "other", 0)[1] == 2);
    assert_true(fabs(particles_real(&m.p[0], "h", 0)[1] - .13) < 1e-15); /* of m / rho */
    assert_true(m.given[0][particles_find(&m.p[0], "m")]);
    close_scene(&m);
    unlink(path);
}

#define BOX(a, b) "\"in\": {\"box\": {\"min\": [" a "], \"max\": [" b "]}}"
#define LINE "{\"dimensions\": 1, \"domain\": {\"min\": [0], \"max\": [1]}, \"particles\": "
#define HALF(a, b) "{\"lattice\": \"square\", " BOX(a, b) ", \"spacing\": 0.1}"

static const struct {
    const char *text, *part;
} wrong[] = {
    {LINE "{\"a\": {\"fill\": [" HALF("0", "0.6") ", " HALF("0.5", "1") "], \"fields\": {\"rho\": "
                                                                        "1}}}" REST,
     "/particles/a/fill/1: this fill overlaps /particles/a/fill/0"},
    {LINE
     "{\"a\": {\"fill\": " HALF("0", "0.6") ", \"fields\": {\"rho\": 1}}, \"b\": {\"fill\": " HALF(
         "0.5", "1") ", \"fields\": {\"rho\": 1}}}" REST,
     "/particles/b: \"b\" overlaps \"a\""},
    {LINE "{\"a\": {\"fill\": {\"lattice\": \"square\", \"count\": 1000000000}, \"fields\": "
          "{\"rho\": 1}}}" REST,
     "/particles/a/fill/count: this would make 1e+09 particles, some 279 GiB; the limit is 2e+08"},
    {LINE
     "{\"a\": {\"fill\": {\"lattice\": \"square\", \"spacing\": 1e-300}, \"fields\": {\"rho\": "
     "1}}}" REST,
     "this would make"},
    {LINE "{\"a\": {\"fill\": {\"lattice\": \"square\", \"spacing\": 9}, \"fields\": {\"rho\": "
          "1}}}" REST,
     "too coarse"},
    {LINE "{\"a\": {\"fill\": {\"lattice\": \"square\", \"count\": 9}}}" REST,
     "the particles' mass is unknown"},
    {LINE "{\"a\": {\"fill\": {\"lattice\": \"square\", \"count\": 9}, \"fields\": {\"rho\": 1, "
          "\"uu\": 1}}}" REST,
     "/particles/a/fields/uu: unknown field \"uu\" (did you mean \"u\"?)"},
    {LINE "{\"a\": {\"fill\": {\"lattice\": \"square\", \"count\": 9}, \"fields\": {\"rho\": 1, "
          "\"u\": \"sqrt(x - 0.5)\"}}}" REST,
     "/particles/a/fields/u: \"sqrt(x - 0.5)\" gives u = NaN at x = 0.0555556"},
    {LINE "{\"a\": {\"fill\": {\"lattice\": \"square\", \"count\": 9}, \"fields\": {\"rho\": "
          "\"x - 0.5\"}}}" REST,
     "the density is -0.444444"},
    {LINE "{\"a\": {\"fill\": {\"lattice\": \"square\", \"count\": 9}, \"fields\": {\"rho\": 1, "
          "\"h\": 0}}}" REST,
     "a smoothing length is 0"},
    {LINE "{\"a\": {\"fill\": {\"lattice\": \"square\", \"count\": 9}, \"fields\": {\"rho\": 1, "
          "\"m\": -1}}}" REST,
     "a particle's mass is -1"},
    {LINE "{\"a\": {\"fill\": {\"lattice\": \"square\", \"count\": 9}, \"fields\": {\"rho\": 1, "
          "\"u\": [1, 2]}}}" REST,
     "2 components; \"u\" has 1 in 1 dimension"},
    {LINE "{\"a\": {\"fill\": {\"lattice\": \"square\", \"mass\": 0.1}}}" REST,
     "equal mass need the field \"rho\""},
    {LINE "{\"a\": {\"fill\": {\"lattice\": \"square\", \"mass\": 0.1}, \"fields\": {\"rho\": "
          "\"1 + x\"}}}" REST,
     "\"rho\" varies within this fill"},
    {LINE "{\"a\": {\"fill\": [" HALF("0", "0.5") ", {\"lattice\": \"square\", " BOX(
         "0.5",
         "1") ", \"spacing\": 0.1, \"fields\": {\"u\": 1}}], \"fields\": {\"rho\": 1}}}" REST,
     "\"u\" is given by this fill of this array, and not by an earlier one"},
    {LINE "{\"a\": {\"fill\": {\"lattice\": \"square\", \"count\": 9, \"in\": {\"intersection\": [{"
          "\"box\": {\"min\": [0], \"max\": [0.2]}}, {\"box\": {\"min\": [0.5], \"max\": "
          "[0.9]}}]}}, \"fields\": {\"rho\": 1}}}" REST,
     "there are no particles inside this shape"},
    {"{\"dimensions\": 1, \"domain\": {\"min\": [0], \"max\": [1], \"sides\": {\"x\": \"mirror\"}}, "
     "\"particles\": {\"a\": {\"fill\": " HALF("0", "1.5") ", \"fields\": {\"rho\": 1}}}" REST,
     "x = 1.05 lies outside the domain, beyond its mirror side"},
    {LINE "{\"a\": {\"fill\": {\"file\": \"/nowhere.csv\"}}}" REST,
     "/particles/a/fill/file: /nowhere.csv: cannot be read"},
};

static void test_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(wrong); i++) {
        struct made m;
        struct error e;
        open_scene(&m, wrong[i].text);
        if (fill_all(&m, &e) == 0)
            fail_msg("taken: %s", wrong[i].text);
        assert_int_equal(e.exit_code, EXIT_USAGE);
        if (!strstr(e.text, wrong[i].part))
            fail_msg("\"%s\" does not hold \"%s\"", e.text, wrong[i].part);
        close_scene(&m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_square),     cmocka_unit_test(test_origin),
        cmocka_unit_test(test_equal_mass), cmocka_unit_test(test_fit),
        cmocka_unit_test(test_lattices),   cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_jitter),     cmocka_unit_test(test_glass),
        cmocka_unit_test(test_file),       cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
