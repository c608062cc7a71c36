/* run/foremost.c -- see run/foremost.h. */
#include "run/foremost.h"
#include "run/domain.h"
#include <stdlib.h>
#include <string.h>

static bool is_before(const struct foremost *a, const struct foremost *b)
{
    if (isnan(a->key) || isnan(b->key))
        return !isnan(a->key);
    return a->key > b->key || (!(a->key < b->key) && a->id < b->id);
}

int foremost_find(const struct run *r, struct foremost *f, void *with, size_t bytes,
                  struct error *e)
{
    f->any = f->mine = !isnan(f->key);
    if (!r->domain)
        return 0;
    const size_t ranks = (size_t)wire_size(r->domain->wire),
                 me = (size_t)wire_rank(r->domain->wire), each = sizeof *f + bytes;
    char *all = malloc((ranks + 1) * each), *own = all ? all + ranks * each : NULL;
    if (!all)
        return error_memory(e, "what ranks share", ranks * each);
    memcpy(own, f, sizeof *f);
    if (bytes)
        memcpy(own + sizeof *f, with, bytes);
    if (wire_gather(r->domain->wire, own, each, all, e)) {
        free(all);
        return -1;
    }
    size_t best = 0;
    for (size_t k = 0; k < ranks; k++) {
        struct foremost here;
        memcpy(&here, all + k * each, sizeof here);
        if (k == 0 || is_before(&here, f)) {
            *f = here;
            best = k;
        }
    }
    f->mine = f->any && best == me;
    if (bytes)
        memcpy(with, all + best * each + sizeof *f, bytes);
    free(all);
    return 0;
}
