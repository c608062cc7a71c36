/* run/population.c -- particles that functions remove and create, done once at the end of a step: what
 * they wrote in int32 properties is carried out array by array, new particles in the order of their
 * parents' ids, so that a run repeats itself. On several ranks that order is over all of them: each makes the copies
 * of its own particles, under the ids that they would have on one rank. */
#include "run/device.h"
#include "run/domain.h"
#include <stdlib.h>
#include <string.h>

struct change {
    uint32_t *index; /* [n]: which old particle each new one is or copies */
    size_t n_kept, n;
};

static const int32_t *column_of(const struct particles *p, const char *name)
{
    return name ? p->column[particles_find(p, name)].data : NULL;
}

struct parent {
    int64_t id;
    uint32_t index;
};

static int by_id(const void *a, const void *b)
{
    const int64_t p = ((const struct parent *)a)->id, q = ((const struct parent *)b)->id;
    return (p > q) - (p < q);
}

/* The copies in the order of their parents' ids, so that who gets which id does not depend on how particles
 * stand. */
static int order_copies(struct change *c, const int64_t *id, struct error *e)
{
    const size_t n = c->n - c->n_kept;
    struct parent *parent = malloc((n + 1) * sizeof *parent);
    if (!parent)
        return error_memory(e, "new particles", n * sizeof *parent);
    for (size_t k = 0; k < n; k++) {
        const uint32_t i = c->index[c->n_kept + k];
        parent[k] = (struct parent){id[i], i};
    }
    qsort(parent, n, sizeof *parent, by_id);
    for (size_t k = 0; k < n; k++)
        c->index[c->n_kept + k] = parent[k].index;
    free(parent);
    return 0;
}

/* -- New ids over all ranks -------- */

#define PIECE 4096 /* parents that ranks tell each other of at a time */

/* A parent's copies of one rank; n 0: none. */
struct brood {
    int64_t id;
    uint64_t n;
};

/* This rank's parents by id; before[k]: copies of others' parents between the one before and k. */
struct broods {
    struct brood *brood;
    uint64_t *before;
    size_t n;
};

static void broods_free(struct broods *b)
{
    free(b->brood);
    free(b->before);
}

static int broods_make(struct broods *b, const struct change *c, const int64_t *id, struct error *e)
{
    const size_t n = c->n - c->n_kept;
    *b = (struct broods){.brood = calloc(n + PIECE, sizeof *b->brood),
                         .before = calloc(n + 1, sizeof *b->before)};
    if (!b->brood || !b->before)
        return error_memory(e, "new particles", n * sizeof *b->brood);
    for (size_t k = 0; k < n; k++) {
        const uint32_t i = c->index[c->n_kept + k];
        if (k == 0 || i != c->index[c->n_kept + k - 1])
            b->brood[b->n++].id = id[i];
        b->brood[b->n - 1].n++;
    }
    return 0;
}

/* Others' copies stand before those of all parents with larger ids. */
static void stand_before(struct broods *b, const struct brood *other)
{
    size_t low = 0, high = b->n;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (b->brood[middle].id < other->id)
            low = middle + 1;
        else
            high = middle;
    }
    b->before[low] += other->n;
}

/* All ranks' parents, a piece of each rank's at a time. */
static int hear_others(const struct run *r, struct broods *b, struct error *e)
{
    const size_t ranks = (size_t)wire_size(r->domain->wire),
                 me = (size_t)wire_rank(r->domain->wire);
    static const uint32_t op = SPH_REDUCE_MAX;
    double most = (double)b->n;
    if (run_share_numbers(r, &most, &op, 1, e))
        return -1;
    struct brood *all = malloc(ranks * PIECE * sizeof *all), *own = calloc(PIECE, sizeof *own);
    int status = all && own ? 0 : error_memory(e, "new particles", ranks * PIECE * sizeof *all);
    for (size_t first = 0; !status && (double)first < most; first += PIECE) {
        for (size_t k = 0; k < PIECE; k++)
            own[k] = first + k < b->n ? b->brood[first + k] : (struct brood){0};
        status = wire_gather(r->domain->wire, own, PIECE * sizeof *own, all, e);
        for (size_t k = 0; !status && k < ranks * PIECE; k++)
            if (k / PIECE != me && all[k].n)
                stand_before(b, &all[k]);
    }
    free(all);
    free(own);
    return status;
}

/* The id of each of this rank's copies, in their order, and the next that is free. */
static int number(struct run *r, const struct change *c, const int64_t *id, int64_t *born,
                  struct error *e)
{
    struct broods b;
    int status = broods_make(&b, c, id, e);
    if (!status && r->domain)
        status = hear_others(r, &b, e);
    for (size_t k = 0; !status && k < b.n; k++) {
        r->plan->next_id += (int64_t)b.before[k];
        for (uint64_t q = 0; q < b.brood[k].n; q++)
            *born++ = r->plan->next_id++;
    }
    if (!status)
        r->plan->next_id += (int64_t)b.before[b.n];
    broods_free(&b);
    return status;
}

/* The survivors, then the copies, `create` wanted. */
static int survey(struct change *c, const struct particles *p, const sph_population *d,
                  struct error *e)
{
    const int32_t *remove = column_of(p, d->remove), *create = column_of(p, d->create);
    uint64_t total = 0;
    for (size_t i = 0; i < p->n; i++) {
        if (create && create[i] < 0)
            return error_set(e, EXIT_RUN, "%s of a particle is %d, less than none", d->create,
                             create[i]);
        total += !(remove && remove[i]) + (create ? (uint64_t)create[i] : 0u);
    }
    if (total > UINT32_MAX / 2)
        return error_set(e, EXIT_RUN, "%llu particles are more than an array holds",
                         (unsigned long long)total);
    *c = (struct change){.index = malloc((total + 1) * sizeof *c->index)};
    if (!c->index)
        return error_memory(e, "the order of particles", total * sizeof *c->index);
    for (uint32_t i = 0; i < p->n; i++)
        if (!(remove && remove[i]))
            c->index[c->n++] = i;
    c->n_kept = c->n;
    for (uint32_t i = 0; create && i < p->n; i++)
        for (int32_t k = 0; k < create[i]; k++)
            c->index[c->n++] = i;
    return 0;
}

/* Ids for life, and 1, 2, ... among the siblings in `create`. */
static void name_copies(struct plan_array *a, const struct change *c, const int64_t *born,
                        const sph_population *d)
{
    int64_t *id = a->p.column[a->id].data;
    int32_t *sibling = a->p.column[particles_find(&a->p, d->create)].data;
    for (size_t i = c->n_kept; i < c->n; i++) {
        id[i] = born[i - c->n_kept];
        sibling[i] = i > c->n_kept && c->index[i] == c->index[i - 1] ? sibling[i - 1] + 1 : 1;
    }
}

static int call_born(struct run *r, const struct pass *p, const struct change *c,
                     const sph_population *d, struct error *e)
{
    struct particles *particles = &r->plan->array[p->dst.array].p;
    const uint32_t n = d->born_props.count;
    sph_column *column = calloc(n + 1, sizeof *column);
    if (!column)
        return error_memory(e, "columns", n * sizeof *column);
    for (uint32_t k = 0; k < n; k++) {
        const sph_prop *prop = list_at(&d->born_props, k);
        column[k] = particles_column(particles, particles_find(particles, prop->name));
    }
    sph_batch b = run_batch(r, &p->use, column, n, particles->n);
    b.first = c->n_kept;
    b.count = c->n - c->n_kept;
    const sph_status status = d->born(&b);
    free(column);
    if (status == SPH_OK)
        return 0;
    char why[512];
    registry_reason(r->plan->registry, status, why, sizeof why);
    return error_set(e, EXIT_RUN, "new particles of %s at step %llu, t = %g: %s", p->name,
                     (unsigned long long)r->step, r->time, why);
}

static void reset(struct particles *p, const char *name)
{
    if (name)
        memset(p->column[particles_find(p, name)].data, 0, p->n * sizeof(int32_t));
}

static int carry_out(struct run *r, const struct pass *p, const struct change *c,
                     const sph_population *d, struct error *e)
{
    struct plan_array *a = &r->plan->array[p->dst.array];
    const size_t n = c->n - c->n_kept;
    int64_t *born = malloc((n + 1) * sizeof *born);
    int status = born ? 0 : error_memory(e, "new particles", n * sizeof *born);
    if (!status && d->create)
        status = number(r, c, a->p.column[a->id].data, born, e);
    if (!status)
        status = particles_gather(&a->p, c->index, c->n, e);
    if (!status && n > 0) {
        name_copies(a, c, born, d);
        status = d->born ? call_born(r, p, c, d, e) : 0;
    }
    free(born);
    r->cost.created += n;
    r->lists_made = false;
    r->lists_suspect = r->suspect = true;
    memset(r->frozen, false, r->plan->n_frame);
    if (!status) {
        reset(&a->p, d->remove);
        reset(&a->p, d->create);
    }
    return status;
}

static int apply(struct run *r, const struct pass *p, const sph_population *d, struct error *e)
{
    struct plan_array *a = &r->plan->array[p->dst.array];
    struct change c = {0};
    if (survey(&c, &a->p, d, e) || order_copies(&c, a->p.column[a->id].data, e)) {
        free(c.index);
        return error_prefix(e, "%s at step %llu", p->name, (unsigned long long)r->step);
    }
    uint64_t changes = c.n != a->p.n || c.n_kept != c.n;
    int status = run_share_count(r, &changes, e);
    if (!status && changes)
        status = carry_out(r, p, &c, d, e);
    free(c.index);
    return status;
}

static bool is_wanted(const struct pass *p)
{
    return p->moment == MOMENT_FINISH && p->use.entry && p->use.entry->population;
}

/* Of a run on a device the host does this as well. A particle is made or removed now and then: until then
 * what functions wrote is all that it needs. */
static int find_wanted(struct run *r, bool *any, struct error *e)
{
    *any = false;
    for (size_t i = 0; i < r->plan->n_pass; i++) {
        const struct pass *p = &r->plan->pass[i];
        const size_t array = p->dst.array;
        const struct particles *particles = &r->plan->array[array].p;
        if (!is_wanted(p))
            continue;
        const char *const name[2] = {p->use.entry->population->remove,
                                     p->use.entry->population->create};
        for (int k = 0; k < 2; k++) {
            if (!name[k])
                continue;
            if (r->device && run_device_get(r, array, particles_find(particles, name[k]), e))
                return -1;
            const int32_t *flag = column_of(particles, name[k]);
            for (size_t q = 0; !*any && q < particles->n; q++)
                *any = flag[q] != 0;
        }
    }
    return 0;
}

int run_population(struct run *r, struct error *e)
{
    const bool made = r->lists_made;
    bool any, ever = false;
    for (size_t i = 0; i < r->plan->n_pass; i++)
        ever = ever || is_wanted(&r->plan->pass[i]);
    if (!ever)
        return 0;
    if (find_wanted(r, &any, e))
        return -1;
    uint64_t all = any;
    if (run_share_count(r, &all, e))
        return -1;
    if (!all)
        return 0;
    if (r->device && run_fetch(r, e))
        return -1;
    r->lists_made = true;
    for (size_t i = 0; i < r->plan->n_pass; i++) {
        const struct pass *p = &r->plan->pass[i];
        if (is_wanted(p) && apply(r, p, p->use.entry->population, e))
            return -1;
    }
    const bool changed = !r->lists_made;
    r->lists_made = r->lists_made && made;
    return r->device && changed ? run_device_put(r, e) : 0;
}
