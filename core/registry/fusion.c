/* registry/fusion.c -- the extension "sph.fusion/0": functions of a plugin that one other does in one
 * sweep. What the parts declare, the whole must declare, or the plan would be blind to it. */
#include "registry/extension.h"

#include "registry/check.h"
#include "registry/copy.h"

#include <string.h>

static int check_part_props(const sph_item *whole, const sph_item *part, struct error *e)
{
    const sph_prop *p = part->props.data;

    for (uint32_t i = 0; i < part->props.count; i++) {
        const sph_prop *own = check_find_prop(&whole->props, p[i].name);
        /* That a part starts from what another leaves behind is the whole's own business. */
        const uint32_t needed = p[i].access & ~(SPH_WORK | SPH_DST_SWEEP);
        if (!own || own->type != p[i].type || (own->access & needed) != needed)
            return error_set(e, EXIT_REFUSED,
                             "\"%s\" does not declare the property \"%s\" as its part \"%s\" "
                             "does",
                             whole->name, p[i].name, part->name);
    }
    return 0;
}

static int check_part_params(const sph_item *whole, const sph_item *part, struct error *e)
{
    const sph_param *p = part->params.data, *own = whole->params.data;

    for (uint32_t i = 0; i < part->params.count; i++) {
        uint32_t k = 0;
        while (k < whole->params.count && strcmp(own[k].name, p[i].name) != 0)
            k++;
        if (k == whole->params.count)
            return error_set(e, EXIT_REFUSED,
                             "\"%s\" does not declare the parameter \"%s\" of its part \"%s\"",
                             whole->name, p[i].name, part->name);
        if (own[k].type != p[i].type || own[k].def < p[i].def || own[k].def > p[i].def)
            return error_set(e, EXIT_REFUSED,
                             "the parameter \"%s\" of \"%s\" has another type or default than that "
                             "of its part \"%s\"",
                             p[i].name, whole->name, part->name);
    }
    return 0;
}

/* What the host does with the columns: advances them, reduces them. */
static int check_part_duties(const sph_function *whole, const sph_function *part, struct error *e)
{
    const sph_rate *rate = part->rates.data, *own_rate = whole->rates.data;
    const sph_reduction *sum = part->reductions.data, *own_sum = whole->reductions.data;

    if (part->item->dims & ~whole->item->dims)
        return error_set(e, EXIT_REFUSED, "\"%s\" is for fewer dimensions than its part \"%s\"",
                         whole->item->name, part->item->name);
    for (uint32_t i = 0; i < part->rates.count; i++) {
        uint32_t k = 0;
        while (k < whole->rates.count && (strcmp(own_rate[k].property, rate[i].property) != 0 ||
                                          strcmp(own_rate[k].rate, rate[i].rate) != 0))
            k++;
        if (k == whole->rates.count)
            return error_set(e, EXIT_REFUSED,
                             "\"%s\" does not declare \"%s\" as the rate of \"%s\", as its part "
                             "\"%s\" does",
                             whole->item->name, rate[i].rate, rate[i].property, part->item->name);
    }
    for (uint32_t i = 0; i < part->reductions.count; i++) {
        uint32_t k = 0;
        while (k < whole->reductions.count &&
               (strcmp(own_sum[k].name, sum[i].name) != 0 ||
                strcmp(own_sum[k].property, sum[i].property) != 0 || own_sum[k].op != sum[i].op ||
                own_sum[k].use != sum[i].use))
            k++;
        if (k == whole->reductions.count)
            return error_set(e, EXIT_REFUSED,
                             "\"%s\" does not declare the reduction \"%s\" as its part \"%s\" does",
                             whole->item->name, sum[i].name, part->item->name);
    }
    return 0;
}

static bool same_over(const char *a, const char *b)
{
    return (!a && !b) || (a && b && strcmp(a, b) == 0);
}

static int check_part(const sph_function *whole, const sph_function *part, struct error *e)
{
    if (part->shape != SPH_PAIR || part->max_sweeps || part->prepare || part->life ||
        whole->reach != part->reach || whole->reach_scale < part->reach_scale ||
        whole->reach_scale > part->reach_scale || whole->frozen != part->frozen ||
        !same_over(whole->over, part->over))
        return error_set(e, EXIT_REFUSED,
                         "\"%s\" is no pair function of the same reach in one sweep and without "
                         "prepare and life, so it cannot be a part of \"%s\"",
                         part->item->name, whole->item->name);
    return check_part_props(whole->item, part->item, e) ||
                   check_part_params(whole->item, part->item, e) ||
                   check_part_duties(whole, part, e)
               ? -1
               : 0;
}

int fusion_declare(struct registry *r, const sph_fusion *in, struct error *e)
{
    struct entry *x;
    const sph_fusion *f;

    if (!in)
        return error_set(e, EXIT_REFUSED, "fusion: the descriptor is NULL");
    x = extension_own(r, KIND_FUNCTION, in->size >= sizeof(*in) ? in->function : NULL, e);
    if (!x)
        return error_prefix(e, "fusion");
    f = copy_fusion(&x->memory, in, e);
    if (!f)
        return error_prefix(e, "fusion \"%s\"", x->item->name);
    if (f->parts.count < 2 || entry_function(x)->shape != SPH_PAIR) {
        error_set(e, EXIT_REFUSED, "it is no pair function with at least two parts");
        return error_prefix(e, "fusion \"%s\"", x->item->name);
    }
    for (uint32_t i = 0; i < f->parts.count; i++) {
        const char *name = ((const char *const *)f->parts.data)[i];
        const struct entry *part = extension_own(r, KIND_FUNCTION, name, e);
        if (!part || check_part(entry_function(x), entry_function(part), e))
            return error_prefix(e, "fusion \"%s\"", x->item->name);
    }
    x->part = f->parts.data;
    x->n_part = f->parts.count;
    return 0;
}
