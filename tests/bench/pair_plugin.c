/* pair_plugin.c -- see pair_plugin.h. */
#include "pair_plugin.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void find(struct pair_plugin *p, int dim)
{
    void *pair = dlsym(p->module, dim == 3 ? "pair_3" : "pair_2");
    void *kernel = dlsym(p->module, dim == 3 ? "kernel_3" : "kernel_2");

    /* ISO C has no cast from an object's pointer to a function's. */
    memcpy(&p->pair[dim], &pair, sizeof(pair));
    memcpy(&p->kernel[dim], &kernel, sizeof(kernel));
}

void pair_plugin_open(struct pair_plugin *p, const char *file)
{
    const char *build = getenv("top_builddir");
    char path[4096];

    snprintf(path, sizeof(path), "%s/tests/bench/.libs/call_per_pair_plugin.so",
             build ? build : ".");
    file = file ? file : path;
    memset(p, 0, sizeof(*p));
    p->module = dlopen(file, RTLD_NOW | RTLD_LOCAL);
    for (int dim = 2; p->module && dim <= 3; dim++)
        find(p, dim);
    if (!p->pair[2] || !p->kernel[2] || !p->pair[3] || !p->kernel[3]) {
        fprintf(stderr, "%s is not that plugin: %s\n", file, dlerror());
        exit(1);
    }
}

void pair_plugin_close(struct pair_plugin *p)
{
    dlclose(p->module);
}
