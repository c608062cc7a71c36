/* check/check_recipe.c -- the check `recipe`: everything that a scheme or a boundary condition
 * names is there, in this plugin, one that was loaded beside it, or one in the plugin folders. */
#include "check/checks.h"

#include "integrators/integrator.h"
#include "registry/loader.h"

#include <stdlib.h>
#include <string.h>

/* The registry with all of the folders' plugins, once it turns out that they are needed. */
struct shelf {
    const struct subject *subject;
    bool loaded;
};

static const struct entry *find(struct shelf *shelf, enum kind kind, const char *name)
{
    struct registry *r = shelf->subject->registry;
    const struct entry *x = registry_find(r, kind, name);
    const size_t own = (size_t)(shelf->subject->entry - r->entry);

    if (x || shelf->loaded)
        return x;
    shelf->loaded = true;
    stage(shelf->subject, "loading the other plugins, for %s \"%s\"", kind_label[kind], name);
    shelf->subject->stage->foreign = 1;
    loader_load_all(r, NULL, NULL, NULL);
    shelf->subject->stage->foreign = 0;
    ((struct subject *)shelf->subject)->entry = &r->entry[own]; /* the list may have moved */
    return registry_find(r, kind, name);
}

/* Verdicts on what is missing; how many. */
static int check_steps(struct shelf *shelf, const sph_list *steps, uint32_t dims)
{
    int missing = 0;

    for (uint32_t i = 0; i < steps->count; i++) {
        const sph_step *step = list_at(steps, i);
        const struct entry *x;
        if (strcmp(step->kind, SPH_KIND_FUNCTION) != 0)
            continue;
        x = find(shelf, KIND_FUNCTION, step->name);
        if (!x) {
            missing++;
            say(shelf->subject, VERDICT_FAIL,
                "steps[%u] names function \"%s\", which neither this plugin nor another has (--load adds one)",
                i, step->name);
        } else if (dims & ~x->item->dims) {
            missing++;
            say(shelf->subject, VERDICT_FAIL,
                "steps[%u], \"%s\", does not work in all dimensions that this one claims", i,
                step->name);
        }
    }
    return missing;
}

static bool is_integrator(const char *name)
{
    return integrator_find(name) != NULL;
}

void check_recipe(const struct subject *s)
{
    struct subject copy = *s; /* its entry may move */
    struct shelf shelf = {&copy, false};
    const sph_list *steps;
    const uint32_t dims = s->entry->item->dims;
    int missing = 0;

    if (s->entry->kind == KIND_BOUNDARY) {
        steps = &entry_boundary(s->entry)->steps;
        missing = check_steps(&shelf, steps, dims);
    } else {
        const sph_scheme *scheme = entry_scheme(s->entry);
        steps = &scheme->steps;
        missing = check_steps(&shelf, steps, dims);
        if (scheme->kernel && !find(&shelf, KIND_KERNEL, scheme->kernel) && ++missing)
            say(s, VERDICT_FAIL,
                "kernel is \"%s\", which neither this plugin nor another has (--load adds one)",
                scheme->kernel);
        if (!is_integrator(scheme->integrator) && ++missing)
            say(s, VERDICT_FAIL, "integrator is \"%s\", which this sph does not have",
                scheme->integrator);
    }
    if (!missing)
        say(s, VERDICT_OK, "%u step%s, and all that %s there", steps->count,
            steps->count == 1 ? "" : "s", steps->count == 1 ? "it names is" : "they name is");
}
