/* host.c -- a host for growth.py: the core's registry, built with the headers of one version of
 * the ABI (see plugin.c). Loads the plugin that it is given, prints what it sees of it, runs its
 * function. */
#include "registry/copy.h"
#include "registry/registry.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

#if defined SPH_GROWN
#define ADDED(p) ((p)->added)
#define SET_ADDED(p, number) ((p)->added = (number))
#else
#define ADDED(p) ((p) ? 0.0 : 0.0)
#define SET_ADDED(p, number) ((void)(p))
#endif

#define LIST(type, name, list)                                                                     \
    for (uint32_t i_ = 0; i_ < (list).count; i_++)                                                 \
    printf(" " name "%u=%g", i_, ADDED((const type *)list_at(&(list), i_)))

static void show_item(const struct entry *x)
{
    printf("%s \"%s\": item=%g", kind_label[x->kind], x->item->name, ADDED(x->item));
    LIST(sph_param, "param", x->item->params);
    LIST(sph_prop, "prop", x->item->props);
}

static void show_function(const struct entry *x)
{
    const sph_function *f = entry_function(x);

    printf(" added=%g life=%g", ADDED(f), ADDED(f->life));
    if (x->population)
        printf(" population=%g state=%g", ADDED(x->population), ADDED(x->state));
    if (f->device) {
        printf(" device=%g", ADDED(f->device));
        LIST(sph_device_value, "i", f->device->i);
        LIST(sph_device_value, "sum", f->device->sum);
    }
    LIST(sph_rate, "rate", f->rates);
    LIST(sph_reduction, "reduction", f->reductions);
    printf(" reach_scale=%g", f->reach_scale); /* left out: its default */
}

static void show(const struct entry *x)
{
    show_item(x);
    if (x->kind == KIND_FUNCTION)
        show_function(x);
    if (x->kind == KIND_EOS) {
        printf(" added=%g", ADDED(entry_eos(x)));
        LIST(sph_prop, "inverse", entry_eos(x)->inverse_props);
    }
    if (x->kind == KIND_EXACT)
        printf(" added=%g", ADDED(entry_exact(x)));
    if (x->kind == KIND_BOUNDARY) {
        printf(" added=%g", ADDED(entry_boundary(x)));
        LIST(sph_step, "step", entry_boundary(x)->steps);
    }
    if (x->kind == KIND_SCHEME) {
        printf(" added=%g", ADDED(entry_scheme(x)));
        LIST(sph_step, "step", entry_scheme(x)->steps);
        LIST(sph_rate, "rate", entry_scheme(x)->rates);
    }
    if (x->kind == KIND_KERNEL) {
        printf(" added=%g", ADDED(entry_kernel(x)));
        LIST(sph_kernel_term, "term", entry_kernel(x)->terms[1]);
    }
    printf("\n");
}

/* The function's numbers, from structs of exactly this host's size. */
static int run(const struct registry *r, const sph_function *f)
{
    static double x[16] = {1, 2, 3}, y[16];
    static int32_t flag[16];
    sph_column *dst = calloc(3, sizeof(*dst));
    sph_kernel_form *form = calloc(1, sizeof(*form));
    sph_batch *b = calloc(1, sizeof(*b));
    double param[] = {1, 2};

    if (!dst || !form || !b)
        return 1;
    dst[0] = (sph_column){x, 16, SPH_SCALAR, 1};
    dst[1] = (sph_column){y, 16, SPH_SCALAR, 1};
    dst[2] = (sph_column){flag, 16, SPH_INT32, 1};
    form->size = (uint32_t)sizeof(*form);
    SET_ADDED(form, 0.5);
    *b = (sph_batch){.size = (uint32_t)sizeof(*b),
                     .dim = 1,
                     .real = SPH_F64,
                     .lanes = SPH_LANES,
                     .count = 3,
                     .n_dst = 3,
                     .dst = dst,
                     .n_columns = 3,
                     .n_params = 2,
                     .param = param,
                     .kernel = form,
                     .host = &r->host};
    SET_ADDED(b, 100);
    if (f->run(b))
        return 1;
    printf("y = %g %g %g\n", y[0], y[1], y[2]);
    free(b);
    free(form);
    free(dst);
    return 0;
}

int main(int argc, char **argv)
{
    struct registry r;
    struct error e = {0};
    void *handle = argc == 2 ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    sph_plugin_entry_fn entry;
    int status;

    if (!handle || registry_init(&r, &e)) {
        printf("%s\n", handle ? e.text : "usage: host FILE");
        return 1;
    }
    SET_ADDED(&r.host, 1000);
    *(void **)&entry = dlsym(handle, "sph_plugin_entry");
    if (!entry || registry_add(&r, "FILE", entry, NULL, NULL, &e)) {
        printf("%s\n", e.text);
        status = e.exit_code;
    } else {
        printf("plugin %u.%u: added=%g\n", r.plugin[0].abi_major, r.plugin[0].abi_minor,
               ADDED(r.plugin[0].descriptor));
        for (size_t i = 0; i < r.n_entry; i++)
            show(&r.entry[i]);
        status = run(&r, entry_function(registry_find(&r, KIND_FUNCTION, "twice")));
    }
    registry_fini(&r);
    dlclose(handle);
    return status;
}
