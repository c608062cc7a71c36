/* tests/bench/neighbours.c -- what neighbour lists cost: time, memory and work of each manager, for
 * even particles and for a clump with smoothing lengths that range over a factor of 100. Lists are
 * made again, as in a run; of five times the median is shown. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "clouds.h"

#include <stdio.h>
#include <time.h>

#define ROUNDS 5
#define SKIN 0.1

static double now(void)
{
    struct timespec t;

    timespec_get(&t, TIME_UTC);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int compare(const void *a, const void *b)
{
    const double *x = a, *y = b;

    return (*x > *y) - (*x < *y);
}

static double median(double *t)
{
    qsort(t, ROUNDS, sizeof *t, compare);
    return t[ROUNDS / 2];
}

static void check(int status, const struct error *e)
{
    if (status) {
        printf("%s\n", e->text);
        exit(1);
    }
}

static double build(struct group_list *l, const struct cloud *c, bool symmetric,
                    const struct neighbour_manager *m, int threads)
{
    double t[ROUNDS];
    struct error e;

    for (int k = -1; k < ROUNDS; k++) { /* the first one is not counted: it asks for memory */
        double begin = now();

        check(group_list_make(l, c, c, symmetric, SKIN, m, threads, &e), &e);
        t[k < 0 ? 0 : k] = 1e9 * (now() - begin) / (double)c->n;
    }
    return median(t);
}

static void managers(const struct cloud *c, bool symmetric)
{
    const struct neighbour_manager *m;
    double n = (double)c->n;

    printf(
        "  manager   ns/particle   2 threads   visited/true   distances/true   list B   search B\n");
    for (size_t k = 0; (m = neighbour_manager_at(k)) != NULL; k++) {
        struct group_list l = {0};
        double one = build(&l, c, symmetric, m, 1), two = build(&l, c, symmetric, m, 2);
        double pairs = (double)group_list_count(&l, c, c, 1);

        printf("  %-7s %13.1f %11.1f %14.1f %16.1f %8.1f %10.1f\n", m->name, one, two,
               (double)l.visited / pairs, (double)l.candidates / pairs,
               (double)group_list_bytes(&l) / n, (double)l.search_bytes / n);
        group_list_fini(&l);
    }
}

static double sort(struct owned *o, double cell, int threads)
{
    uint32_t *order = malloc(o->c.n * sizeof *order);
    double t[ROUNDS];
    struct error e;

    for (int k = 0; k < ROUNDS; k++) {
        double begin = now();

        check(cell_order(&o->c, NULL, cell, threads, order, &e), &e);
        t[k] = 1e9 * (now() - begin) / (double)o->c.n;
    }
    free(order);
    return median(t);
}

static void count(const struct cloud *c, bool symmetric)
{
    struct group_list l = {0};
    struct error e;
    double t[ROUNDS], two[ROUNDS];
    uint64_t pairs = 0;

    check(group_list_make(&l, c, c, symmetric, SKIN, NULL, 1, &e), &e);
    for (int k = 0; k < ROUNDS; k++) {
        double begin = now(), middle;

        pairs = group_list_count(&l, c, c, 1);
        middle = now();
        pairs = group_list_count(&l, c, c, 2);
        t[k] = 1e9 * (middle - begin) / (double)c->n;
        two[k] = 1e9 * (now() - middle) / (double)c->n;
    }
    printf("  %.1f true neighbours, %.1f entries a particle; counting %.1f ns/particle, 2 threads "
           "%.1f\n",
           (double)pairs / (double)c->n, (double)l.n_entry / (double)c->n, median(t), median(two));
    group_list_fini(&l);
}

static void run(const char *title, struct owned *o, double cell, bool symmetric)
{
    double shuffled[2], sorted[2];

    cloud_shuffle(o, 5);
    for (int k = 0; k < 2; k++) {
        shuffled[k] = sort(o, cell, k + 1);
    }
    cloud_sort(o, cell);
    for (int k = 0; k < 2; k++) {
        sorted[k] = sort(o, cell, k + 1);
    }
    printf("%s: %zu particles, %s\n", title, o->c.n, symmetric ? "symmetric" : "gather");
    printf("  order of shuffled particles %.1f ns/particle, 2 threads %.1f; of sorted ones %.1f, "
           "%.1f\n",
           shuffled[0], shuffled[1], sorted[0], sorted[1]);
    count(&o->c, symmetric);
    managers(&o->c, symmetric);
}

static double mean_reach(const struct owned *o)
{
    double sum = 0;

    for (size_t i = 0; i < o->c.n; i++) {
        sum += o->h[i];
    }
    return o->c.scale * sum / (double)o->c.n;
}

int main(void)
{
    struct owned o = cloud_lattice(3, 63, 1);

    run("3D", &o, 2.6, true);
    cloud_free(&o);
    o = cloud_lattice(2, 500, 1);
    run("2D", &o, 1.3 * 2.6, true);
    cloud_free(&o);
    for (int symmetric = 0; symmetric < 2; symmetric++) {
        o = cloud_clump(3, 58, 1);
        run("3D, h ranges over a factor of 100", &o, mean_reach(&o), symmetric);
        cloud_free(&o);
    }
    return 0;
}
