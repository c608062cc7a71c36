/* tests/bench/opencl_lists.c -- what neighbour lists and order cost on an OpenCL device beside the host, in one run:
 * for each of them the least of several times, host and device in turns, wall clock on all threads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "../unit/on_device.h"

#include <omp.h>
#include <stdio.h>
#include <time.h>

#define ROUNDS 7
#define SKIN 0.1

static struct device *device;
static struct error e;

static double now(void)
{
    struct timespec t;

    timespec_get(&t, TIME_UTC);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void must(int status)
{
    if (status) {
        printf("%s\n", e.text);
        exit(1);
    }
}

static double least(double a, double b)
{
    return a < b ? a : b;
}

static void kernels(void)
{
    static double before[256];
    size_t n;
    const struct device_time *t = device_times(device, &n);

    for (size_t k = 0; k < n && getenv("KERNELS"); k++) {
        printf("      %-20s %8.3f ms, %llu launches\n", t[k].name, 1e3 * (t[k].seconds - before[k]),
               (unsigned long long)t[k].launches);
        before[k] = t[k].seconds;
    }
}

static void lists(const char *name, struct owned *o, bool symmetric)
{
    const struct neighbour_manager *m;
    struct there t = cloud_there(device, &o->c, NULL, 0);
    const double per = 1e9 / (double)o->c.n;

    t.c.wide = &t.wide;
    printf("%s, %s: %zu particles, ns each\n", name, symmetric ? "symmetric" : "gather", o->c.n);
    printf("  manager       host    device     ratio   entries/group: host   device\n");
    for (size_t k = 0; (m = neighbour_manager_at(k)) != NULL && (!k || !getenv("ONE")); k++) {
        struct group_list l = {0};
        struct device_list there = {.n_group = 0};
        struct device_search *s;
        double host = 1e9, dev = 1e9;

        must(device_search_open(&s, device, o->c.dim, m, &e));
        for (int round = 0; round < ROUNDS; round++) {
            double begin = now();

            must(group_list_make(&l, &o->c, &o->c, symmetric, SKIN, m, omp_get_max_threads(), &e));
            host = least(host, now() - begin);
            begin = now();
            must(device_list_make(s, &there, &t.c, &t.c, symmetric, SKIN, false, 0, &e));
            must(device_finish(device, &e));
            dev = least(dev, now() - begin);
        }
        printf("  %-8s %9.1f %9.1f %9.2f   %19.1f %8.1f\n", m->name, per * host, per * dev,
               dev / host, (double)l.n_entry / (double)l.n_group,
               (double)there.n_entry / (double)there.n_group);
        kernels();
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
    const double per = 1e9 / (double)o->c.n;
    struct device_buffer there = {0};
    struct device_search *s;
    double host = 1e9, dev = 1e9;
    struct there t;

    for (size_t i = 0; i < o->c.n; i++) {
        id[i] = (int64_t)i;
    }
    t = cloud_there(device, &o->c, id, 0);
    t.c.wide = &t.wide;
    must(device_search_open(&s, device, o->c.dim, NULL, &e));
    for (int round = 0; round < ROUNDS; round++) {
        double begin = now();

        must(cell_order(&o->c, id, cell_best(&o->c), omp_get_max_threads(), to, &e));
        host = least(host, now() - begin);
        begin = now();
        must(device_order(s, &t.c, 0, &there, &e));
        must(device_finish(device, &e));
        dev = least(dev, now() - begin);
    }
    printf("%-22s order %9.1f %9.1f %9.2f\n", name, per * host, per * dev, dev / host);
    kernels();
    device_search_close(s);
    device_release(device, &there);
    device_release(device, &t.wide);
    free(to);
    free(id);
}

static void cloud(const char *name, struct owned o)
{
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
    if (getenv("ONE")) {
        struct owned o = cloud_lattice(3, 63, 1);
        cloud_sort(&o, cell_best(&o.c));
        for (int q = 0; q < 3; q++)
            lists("3D", &o, true);
        return 0;
    }
    cloud("2D lattice", cloud_lattice(2, 600, 1));
    cloud("3D lattice", cloud_lattice(3, 63, 1));
    cloud("3D clump", cloud_clump(3, 58, 1));
    device_close(device);
    return 0;
}
