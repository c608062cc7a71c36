/* tests/bench/neighbours.c -- what neighbour lists cost: time, memory and work of each manager,
 * for even particles and for a clump with smoothing lengths that range over a factor of 100. Lists
 * are made again, as in a run; of five times the median is shown, processor time of one thread,
 * wall clock time of two. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "../unit/clouds.h"
#include "neighbours/skin.h"

#include <stdio.h>
#include <time.h>

#define ROUNDS 5
#define SKIN 0.1

/* Of one thread the processor time, which others on the machine change little. */
static double now(int threads)
{
    struct timespec t;

    if (threads == 1) {
        return (double)clock() / CLOCKS_PER_SEC;
    }
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
        double begin = now(threads);

        check(group_list_make(l, c, c, symmetric, SKIN, m, threads, &e), &e);
        t[k < 0 ? 0 : k] = 1e9 * (now(threads) - begin) / (double)c->n;
    }
    return median(t);
}

static void managers(const struct cloud *c, bool symmetric)
{
    const struct neighbour_manager *m;
    double n = (double)c->n;

    printf("  manager   ns/particle   2 threads   visited/true   distances/true   list B   "
           "search B\n");
    for (size_t k = 0; (m = neighbour_manager_at(k)) != NULL; k++) {
        struct group_list l = {0};
        double one = build(&l, c, symmetric, m, 1), two = build(&l, c, symmetric, m, 2);
        double pairs = (double)group_list_count(&l, c, c, 2);

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
        double begin = now(threads);

        check(cell_order(&o->c, NULL, cell, threads, order, &e), &e);
        t[k] = 1e9 * (now(threads) - begin) / (double)o->c.n;
    }
    free(order);
    return median(t);
}

static void count(const struct cloud *c, bool symmetric)
{
    struct group_list l = {0};
    struct error e;
    double t[2][ROUNDS];
    uint64_t pairs = 0;

    check(group_list_make(&l, c, c, symmetric, SKIN, NULL, 1, &e), &e);
    for (int k = 0; k < ROUNDS; k++) {
        for (int threads = 1; threads <= 2; threads++) {
            double begin = now(threads);

            pairs = group_list_count(&l, c, c, threads);
            t[threads - 1][k] = 1e9 * (now(threads) - begin) / (double)c->n;
        }
    }
    printf("  %.1f true neighbours, %.1f entries a particle; counting %.1f ns/particle, 2 threads "
           "%.1f\n",
           (double)pairs / (double)c->n, (double)l.n_entry / (double)c->n, median(t[0]),
           median(t[1]));
    group_list_fini(&l);
}

static void skin(const struct cloud *c)
{
    double keep[2][ROUNDS], look[2][ROUNDS];
    struct skin s = {0};
    struct error e;
    bool holds = true;

    for (int k = 0; k < ROUNDS; k++) {
        for (int threads = 1; threads <= 2; threads++) {
            double begin = now(threads), middle;

            check(skin_keep(&s, c, threads, &e), &e);
            middle = now(threads);
            holds = skin_holds(skin_change(&s, c, SKIN, threads)) && holds;
            keep[threads - 1][k] = 1e9 * (middle - begin) / (double)c->n;
            look[threads - 1][k] = 1e9 * (now(threads) - middle) / (double)c->n;
        }
    }
    printf("  places kept in %.1f B/particle: %.1f ns/particle, 2 threads %.1f; looked at again "
           "%.1f, %.1f%s\n",
           (double)skin_bytes(&s) / (double)c->n, median(keep[0]), median(keep[1]), median(look[0]),
           median(look[1]), holds ? "" : " MISS");
    skin_fini(&s);
}

static void run(const char *title, struct owned *o, bool symmetric)
{
    double shuffled[2], sorted[2], cell = cell_best(&o->c);

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
    skin(&o->c);
    managers(&o->c, symmetric);
}

int main(void)
{
    struct owned o = cloud_lattice(3, 63, 1);

    run("3D", &o, true);
    cloud_free(&o);
    o = cloud_lattice(2, 500, 1);
    run("2D", &o, true);
    cloud_free(&o);
    for (int symmetric = 0; symmetric < 2; symmetric++) {
        o = cloud_clump(3, 58, 1);
        run("3D, h ranges over a factor of 100", &o, symmetric);
        cloud_free(&o);
    }
    return 0;
}
