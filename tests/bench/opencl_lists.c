/* tests/bench/opencl_lists.c -- what neighbour lists and order cost on an OpenCL device beside the
 * host, in one run: for each of them the least of several times, host and device in turns; wall
 * clock, and processor time of all threads, which others on the machine change less. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "../unit/device_clouds.h"

#include <omp.h>
#include <stdio.h>
#include <time.h>

#define ROUNDS 7
#define SKIN 0.1

static struct device *device;
static struct error e;

/* Wall clock, processor time. */
struct times {
    double wall, cpu;
};

static struct times now(void)
{
    struct timespec t;

    timespec_get(&t, TIME_UTC);
    return (struct times){(double)t.tv_sec + 1e-9 * (double)t.tv_nsec,
                          (double)clock() / CLOCKS_PER_SEC};
}

static void take_least(struct times *least, struct times begin)
{
    const struct times end = now();

    least->wall = fmin(least->wall, end.wall - begin.wall);
    least->cpu = fmin(least->cpu, end.cpu - begin.cpu);
}

static void must(int status)
{
    if (status) {
        printf("%s\n", e.text);
        exit(1);
    }
}

#define HEAD "wall: host    device     ratio   processor: host    device     ratio"

static void show(const struct times *host, const struct times *dev, size_t n)
{
    const double per = 1e9 / (double)n;

    printf("%10.1f %9.1f %9.2f %17.1f %9.1f %9.2f", per * host->wall, per * dev->wall,
           dev->wall / host->wall, per * host->cpu, per * dev->cpu, dev->cpu / host->cpu);
}

static void lists(const char *name, struct owned *o, bool symmetric)
{
    const struct neighbour_manager *m;
    struct there t = cloud_there(device, &o->c, NULL, 0);

    t.c.wide = &t.wide;
    printf("%s, %s: %zu particles, ns each\n", name, symmetric ? "symmetric" : "gather", o->c.n);
    printf("  manager   " HEAD "   entries/group\n");
    for (size_t k = 0; (m = neighbour_manager_at(k)) != NULL; k++) {
        struct group_list l = {0};
        struct device_list there = {.n_group = 0};
        struct device_search *s;
        struct times host = {1e9, 1e9}, dev = host;

        must(device_search_open(&s, device, o->c.dim, m, &e));
        for (int round = 0; round < ROUNDS; round++) {
            struct times begin = now();

            must(group_list_make(&l, &o->c, &o->c, symmetric, SKIN, m, omp_get_max_threads(), &e));
            take_least(&host, begin);
            begin = now();
            must(device_list_make(s, &there, &t.c, &t.c, symmetric, SKIN, false, 0, &e));
            must(device_finish(device, &e));
            take_least(&dev, begin);
        }
        printf("  %-9s", m->name);
        show(&host, &dev, o->c.n);
        printf("   %.1f %.1f\n", (double)l.n_entry / (double)l.n_group,
               (double)there.n_entry / (double)there.n_group);
        group_list_fini(&l);
        device_list_release(device, &there);
        device_search_close(s);
    }
    device_release(device, &t.wide);
}

static void order(const char *name, struct owned *o)
{
    uint32_t *to = malloc(o->c.n * sizeof *to);
    int64_t *id = malloc(o->c.n * sizeof *id);
    struct device_buffer there = {0};
    struct device_search *s;
    struct times host = {1e9, 1e9}, dev = host;
    struct there t;

    for (size_t i = 0; i < o->c.n; i++) {
        id[i] = (int64_t)i;
    }
    t = cloud_there(device, &o->c, id, 0);
    t.c.wide = &t.wide;
    must(device_search_open(&s, device, o->c.dim, NULL, &e));
    for (int round = 0; round < ROUNDS; round++) {
        struct times begin = now();

        must(cell_order(&o->c, id, cell_best(&o->c), omp_get_max_threads(), to, &e));
        take_least(&host, begin);
        begin = now();
        must(device_order(s, &t.c, 0, &there, &e));
        must(device_finish(device, &e));
        take_least(&dev, begin);
    }
    printf("%s: order, %zu particles, ns each\n            " HEAD "\n  %-9s", name, o->c.n, "");
    show(&host, &dev, o->c.n);
    printf("\n");
    device_search_close(s);
    device_release(device, &there);
    device_release(device, &t.wide);
    free(to);
    free(id);
}

static void cloud(const char *name, struct owned o)
{
    cloud_shuffle(&o, 5);
    order(name, &o);
    cloud_sort(&o, cell_best(&o.c));
    order(name, &o);
    lists(name, &o, true);
    lists(name, &o, false);
    cloud_free(&o);
}

int main(void)
{
    device = any_device();
    if (!device) {
        printf("no OpenCL device with double precision\n");
        return 77;
    }
    printf("%s, %d threads of the host\n", device_facts(device)->name, omp_get_max_threads());
    cloud("2D lattice", cloud_lattice(2, 600, 1));
    cloud("3D lattice", cloud_lattice(3, 63, 1));
    cloud("3D clump", cloud_clump(3, 58, 1));
    printf("programs: %.1f s to build\n", device_build_seconds(device, NULL, NULL));
    device_close(device);
    return 0;
}
