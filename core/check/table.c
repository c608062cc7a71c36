/* check/table.c -- the checks in the order in which they are made, and what of an item they call.
 */
#include "check/checks.h"

#include <string.h>

/* A device's compiler may take its time over each body, the first time. */
#define DEVICE_PATIENCE 10
/* One source at a time is slow. */
#define PATHS_PATIENCE 4

const struct check check_table[] = {
    {"declared", "what the descriptors say, and leave unsaid", CHECK_ALL, check_declared, false, 1},
    {"integral", "kernels: integral, slope, ends, moments", CHECK_KIND(KIND_KERNEL), check_integral,
     false, 1},
    {"life", "create and destroy, twice, without a leak", CHECK_RUNS, check_life, false, 1},
    {"state", "save, restore and save give the same bytes", CHECK_RUNS, check_state, false, 1},
    {"eos", "inverse and speed of sound of equations of state", CHECK_KIND(KIND_EOS), check_eos,
     false, 1},
    {"calls", "only what is declared is touched; pieces, threads and repeats give the same bits",
     CHECK_RUNS, check_calls, false, 1},
    {"kept", "no pointer is kept from an earlier call or another item", CHECK_RUNS, check_kept,
     true, 1},
    {"conservation", "momentum, and a shift of all positions", CHECK_KIND(KIND_FUNCTION),
     check_conservation, true, 1},
    {"recipe", "the steps' functions, the kernel and the integrator are there",
     CHECK_KIND(KIND_SCHEME) | CHECK_KIND(KIND_BOUNDARY), check_recipe, false, 1},
    {"paths", "the plain loop, vectors of every instruction set, and floats give the same",
     CHECK_KIND(KIND_FUNCTION), check_paths, true, PATHS_PATIENCE},
    {"device", "native and device bodies", CHECK_KIND(KIND_FUNCTION) | CHECK_KIND(KIND_EOS),
     check_device, true, DEVICE_PATIENCE},
};
const size_t n_check = sizeof(check_table) / sizeof(check_table[0]);

size_t passes_of(const struct entry *x, struct pass_spec out[2])
{
    memset(out, 0, 2 * sizeof(*out));
    out[0].label = "run";
    out[0].props = &x->item->props;
    out[0].shape = SPH_POINT;
    if (x->kind == KIND_FUNCTION) {
        const sph_function *f = entry_function(x);
        out[0].shape = f->shape;
        out[0].reach = f->reach;
        out[0].reach_scale = f->reach_scale;
        out[0].max_sweeps = f->max_sweeps;
        out[0].unfinished = f->max_sweeps ? f->unfinished : NULL;
        out[0].prepare = f->prepare;
        out[0].before = f->before;
        out[0].run = f->run;
        out[0].after = f->after;
        if (!x->population || !x->population->born)
            return 1;
        out[1].label = "born";
        out[1].props = &x->population->born_props;
        out[1].shape = SPH_POINT;
        out[1].ones = x->population->create;
        out[1].run = x->population->born;
        return 2;
    }
    if (x->kind == KIND_EXACT) {
        out[0].run = entry_exact(x)->run;
        return 1;
    }
    if (x->kind != KIND_EOS)
        return 0;
    out[0].run = entry_eos(x)->run;
    if (!entry_eos(x)->inverse)
        return 1;
    out[1] = out[0];
    out[1].label = "inverse";
    out[1].props = &entry_eos(x)->inverse_props;
    out[1].run = entry_eos(x)->inverse;
    return 2;
}
