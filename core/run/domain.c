/* run/domain.c -- see run/domain.h; who holds which particles is domain_cuts.c's. */
#include "run/domain.h"
#include "domain/migrate.h"
#include "domain/ranks.h"
#include "neighbours/far.h"
#include "run/device.h"
#include "run/frames.h"
#include <stdlib.h>
#include <string.h>

static int shared(struct run_domain **out, const struct plan *plan, struct error *e)
{
    struct run_domain *d = *out = calloc(1, sizeof *d);
    const size_t n = plan->n_array;
    if (!d)
        return error_memory(e, "the domain", sizeof *d);
    d->want = calloc(plan->n_list + 1, sizeof *d->want);
    d->cloud = calloc(plan->n_frame * n + 1, sizeof *d->cloud);
    d->far = calloc(plan->n_list + 1, sizeof *d->far);
    d->far_capacity = calloc(plan->n_list + 1, sizeof *d->far_capacity);
    d->met = calloc(plan->n_frame * n + 1, sizeof *d->met);
    if (!d->want || !d->cloud || !d->met || !d->far || !d->far_capacity)
        return error_memory(e, "the domain", n * plan->n_frame * sizeof *d->cloud);
    for (size_t k = 0; k < plan->n_list; k++) {
        const struct plan_list *l = &plan->list[k];
        d->want[d->n_want++] =
            (struct halo_want){l->dst, l->src, l->frame, l->reach == SPH_SYMMETRIC};
    }
    return 0;
}

int run_domain_open(struct run *r, struct error *e)
{
    struct wire *wire;
    if (wire_open(&wire, e) || wire_size(wire) == 1) {
        const int status = wire && wire_size(wire) == 1 ? 0 : -1;
        wire_close(wire);
        return status;
    }
    const int status = ranks_agree(shared(&r->domain, r->plan, e), e);
    if (status) {
        run_domain_close(r);
        wire_close(wire);
        return -1;
    }
    r->domain->wire = wire;
    r->domain->pace = 1.0;
    /* What cuts the domain does not hear an alarm. */
    const enum partitioner kind = (enum partitioner)r->plan->scene->ranks.partition;
    if (ranks_agree(halo_open(&r->domain->halo, wire, r->plan->n_array, e), e) ||
        ranks_agree(partition_open(&r->domain->partition, kind, r->plan->dim, e), e))
        return -1;
    return run_domain_cut(r, e);
}

void run_domain_close(struct run *r)
{
    struct run_domain *d = r->domain;
    if (!d)
        return;
    partition_close(d->partition);
    halo_close(&d->halo);
    wire_close(d->wire);
    free(d->want);
    free(d->cloud);
    for (size_t k = 0; d->met && k < r->plan->n_frame * r->plan->n_array; k++)
        skin_fini(&d->met[k]);
    free(d->met);
    for (size_t k = 0; d->far && k < r->plan->n_list; k++)
        free(d->far[k]);
    free(d->far);
    free(d->far_capacity);
    free(d->column);
    free(d->owner);
    free(d->weight);
    free(d->place);
    free(d);
    r->domain = NULL;
}

/* -- Ghosts -------- */

int run_domain_meet(struct run *r, struct error *e)
{
    struct run_domain *d = r->domain;
    const struct plan *plan = r->plan;
    const size_t n = plan->n_array;
    for (size_t f = 0; f < plan->n_frame; f++)
        for (size_t a = 0; a < n; a++)
            d->cloud[f * n + a] =
                frame_has(r, f, a) ? run_cloud(r, a, f) : (struct cloud){.dim = plan->dim};
    const struct halo_job job = {.box = &plan->scene->box,
                                 .n_array = n,
                                 .n_frame = plan->n_frame,
                                 .cloud = d->cloud,
                                 .want = d->want,
                                 .n_want = d->n_want,
                                 /* Lists of other frames are made later: there is room to move. */
                                 .factor = 1.0 + (plan->n_frame > 1 ? 2.0 : 1.0) * r->skin};
    const struct wire_count before = wire_count(d->wire);
    d->halos++;
    const int status = halo_make(&d->halo, &job, r->ghosts, e);
    halo_count(d->wire, &d->for_ghosts, &before);
    return status;
}

/* Parents of images whose particles have gone to other places: of each image in order, as halo_make has them. */
static void parents_follow(struct ghosts *own, const uint32_t *place, const bool *sent,
                           uint32_t *scratch)
{
    for (size_t first = 0, end; first < own->n; first = end) {
        size_t n = 0;
        for (end = first; end < own->n && own->image[end] == own->image[first];)
            end++;
        for (int late = 0; late < 2; late++)
            for (size_t i = first; i < end; i++)
                if (sent[own->parent[i]] == late)
                    scratch[n++] = place[own->parent[i]];
        memcpy(own->parent + first, scratch, n * sizeof *scratch);
    }
}

/* Particles that peers need go behind those that nobody does: most groups without the former need no ghosts of others
 * either, and stand together (run/passes.c). */
static int part_sent(struct run *r, size_t array, struct error *e)
{
    struct particles *p = &r->plan->array[array].p;
    const struct halo *h = &r->domain->halo;
    struct ghosts *own = &r->ghosts[array];
    if (halo_sent(h, array) == 0)
        return 0;
    uint32_t *order = malloc(2 * p->n * sizeof *order), *place = order + p->n;
    uint32_t *scratch = malloc((own->n + 1) * sizeof *scratch);
    bool *sent = calloc(p->n, sizeof *sent);
    int status = order && sent && scratch ? 0 : error_memory(e, "the order of particles", p->n);
    size_t n = 0;
    for (size_t k = 0; !status && k < h->n_peer; k++)
        for (size_t i = 0; i < h->peer[k].part[array].n_send; i++)
            sent[h->peer[k].part[array].send[i]] = true;
    for (int late = 0; !status && late < 2; late++)
        for (size_t i = 0; i < p->n; i++)
            if (sent[i] == late) {
                place[i] = (uint32_t)n;
                order[n++] = (uint32_t)i;
            }
    if (!status)
        status = particles_permute(p, order, e);
    for (size_t k = 0; !status && k < h->n_peer; k++)
        for (size_t i = 0; i < h->peer[k].part[array].n_send; i++)
            h->peer[k].part[array].send[i] = place[h->peer[k].part[array].send[i]];
    if (!status)
        parents_follow(own, place, sent, scratch);
    free(order);
    free(scratch);
    free(sent);
    return status;
}

int run_domain_ghosts(struct run *r, bool sorts, struct error *e)
{
    struct run_domain *d = r->domain;
    const struct plan *plan = r->plan;
    const size_t n = plan->n_array;
    if (run_domain_meet(r, e))
        return -1;
    for (size_t a = 0; sorts && a < n; a++)
        if (part_sent(r, a, e))
            return -1;
    const struct wire_count before = wire_count(d->wire);
    for (size_t a = 0; a < n; a++) {
        struct plan_array *pa = &plan->array[a];
        if (particles_resize(&pa->p, pa->p.n, d->halo.n_ghost[a], e))
            return -1;
        if (run_domain_ask(r, a, pa->position, e) || run_domain_ask(r, a, pa->smoothing, e))
            return -1;
    }
    if (run_domain_begin(r, e) || run_domain_finish(r, e))
        return -1;
    halo_count(d->wire, &d->for_ghosts, &before);
    return 0;
}

int run_domain_keep(struct run *r, struct error *e)
{
    struct run_domain *d = r->domain;
    for (size_t f = 1; d && f < r->plan->n_frame; f++) {
        struct skin *met = d->met + f * r->plan->n_array;
        for (size_t a = 0; a < r->plan->n_array; a++) {
            if (!frame_has(r, f, a))
                continue;
            const struct cloud here = run_cloud(r, a, f);
            met->form = SKIN_EXACT;
            if (skin_keep(met++, &here, r->threads, e))
                return -1;
        }
    }
    return 0;
}

int run_domain_ask(struct run *r, size_t array, int column, struct error *e)
{
    struct run_domain *d = r->domain;
    if (!d)
        return 0;
    struct halo_column *more = realloc(d->column, (d->n_column + 1) * sizeof *more);
    if (!more)
        return error_memory(e, "the domain", d->n_column * sizeof *more);
    d->column = more;
    d->column[d->n_column++] = (struct halo_column){&r->plan->array[array].p, array, column};
    return 0;
}

int run_domain_begin(struct run *r, struct error *e)
{
    struct run_domain *d = r->domain;
    if (!d || !d->n_column)
        return 0;
    d->waits = true;
    if (halo_begin(&d->halo, &r->plan->scene->box, d->column, d->n_column, e))
        return -1;
    for (size_t k = 0; k < d->n_column; k++) {
        const struct halo_column *c = &d->column[k];
        ghosts_refresh(&r->ghosts[c->array], &r->plan->scene->box, c->p, c->column);
        run_domain_poke(r);
    }
    return 0;
}

int run_domain_finish(struct run *r, struct error *e)
{
    struct run_domain *d = r->domain;
    if (!d || !d->n_column)
        return 0;
    const int status = halo_finish(&d->halo, d->column, d->n_column, e);
    for (size_t k = 0; k < d->n_column; k++) {
        uint8_t *old = &r->mirror_old[d->column[k].array][d->column[k].column];
        *old = *old == MIRROR_FRESH ? MIRROR_GHOSTS_OLD : *old;
    }
    d->n_column = 0;
    d->waits = false;
    return status;
}

bool run_domain_waits(const struct run *r)
{
    return r->domain && r->domain->waits;
}

void run_domain_poke(const struct run *r)
{
    wire_poke(r->domain->wire);
}

int run_domain_list(struct run *r, size_t list, struct error *e)
{
    struct run_domain *d = r->domain;
    const struct group_list *l = &r->list[list];
    if (!d)
        return 0;
    const size_t array = r->plan->list[list].src;
    if (l->n_group > d->far_capacity[list]) {
        free(d->far[list]);
        d->far_capacity[list] = l->n_group + l->n_group / 8;
        d->far[list] = malloc(d->far_capacity[list] * sizeof *d->far[list]);
        if (!d->far[list]) {
            d->far_capacity[list] = 0;
            return error_memory(e, "the domain", l->n_group);
        }
    }
    group_list_far(l, r->plan->array[array].p.n + r->ghosts[array].n, d->far[list], r->threads);
    return 0;
}

bool run_domain_far(const struct run *r, const struct pass *p, size_t group)
{
    for (size_t s = 0; s < p->n_src; s++)
        if (group < r->list[p->list[s]].n_group && r->domain->far[p->list[s]][group])
            return true;
    return false;
}

size_t run_domain_bytes(const struct run *r, size_t *lists, size_t *places)
{
    const struct run_domain *d = r->domain;
    const size_t n = r->plan->n_array;
    size_t bytes = 0;
    for (size_t k = 0; d && k < r->plan->n_list; k++)
        *lists += d->far_capacity[k] * sizeof **d->far;
    for (size_t k = 0; d && k < r->plan->n_frame * n; k++)
        *places += skin_bytes(&d->met[k]);
    for (size_t k = 0; d && k < d->halo.n_peer; k++) {
        bytes += d->halo.peer[k].out_capacity + d->halo.peer[k].in_capacity;
        for (size_t a = 0; a < n; a++)
            bytes += d->halo.peer[k].part[a].send_capacity * (sizeof(uint32_t) + sizeof(uint8_t));
    }
    for (size_t a = 0; d && a < n; a++)
        bytes += d->halo.image_capacity[a];
    return bytes;
}

/* -- Together -------- */

/* As it is held, but for what is not a real particle's. */
static int copy_of(struct particles *to, const struct particles *p, struct error *e)
{
    if (particles_init(to, p->name, p->dim, e))
        return -1;
    for (size_t k = 0; k < p->n_column; k++) {
        const struct column *c = &p->column[k];
        if (particles_add(to, c->name, c->unit, c->doc, c->type, e) < 0)
            return -1;
        to->column[k].output = c->output;
        to->column[k].state = true; /* all of it goes along */
    }
    if (particles_resize(to, p->n, 0, e))
        return -1;
    for (size_t k = 0; k < p->n_column; k++) {
        const struct column *c = &p->column[k];
        for (uint32_t q = 0; q < c->ncomp; q++) {
            char *at = (char *)to->column[k].data + q * to->column[k].plane * to->column[k].size;
            if (column_is_real(c))
                column_load(c, q, 0, p->n, (double *)(void *)at);
            else
                memcpy(at, (const char *)c->data + q * c->plane * c->size, p->n * c->size);
        }
    }
    return 0;
}

int run_domain_collect(struct run *r, struct particles *all, struct error *e)
{
    size_t most = 1, sent;
    for (size_t a = 0; a < r->plan->n_array; a++) {
        const struct particles *p = &r->plan->array[a].p;
        all[a] = (struct particles){0};
        most = p->n > most ? p->n : most;
    }
    int *owner = calloc(most, sizeof *owner);
    int status = owner ? 0 : error_memory(e, "all particles", most * sizeof *owner);
    for (size_t a = 0; !status && a < r->plan->n_array; a++)
        status = copy_of(&all[a], &r->plan->array[a].p, e) ||
                         migrate(r->domain->wire, &all[a], owner, &sent, e)
                     ? -1
                     : 0;
    free(owner);
    return status;
}

void run_domain_scatter(const struct run *r, struct particles *all)
{
    for (size_t a = 0; a < r->plan->n_array; a++)
        particles_fini(&all[a]);
}

bool run_speaks(const struct run *r)
{
    return !r->domain || wire_rank(r->domain->wire) == 0;
}

int run_domain_agree(struct run *r, int status, struct error *e)
{
    if (status && e->text[0] && r->domain)
        wire_alarm(r->domain->wire);
    if (!ranks_agree(status, e))
        return 0;
    if (r->domain)
        wire_renew(r->domain->wire);
    return -1;
}

/* -- Of all ranks -------- */

int run_share_numbers(const struct run *r, double *value, const uint32_t *op, size_t n,
                      struct error *e)
{
    return r->domain ? wire_reduce(r->domain->wire, value, op, n, e) : 0;
}

int run_share_change(const struct run *r, struct skin_change *c, struct error *e)
{
    static const uint32_t op[2] = {SPH_REDUCE_MAX, SPH_REDUCE_MIN};
    double value[2] = {c->moved, c->room};
    if (run_share_numbers(r, value, op, 2, e))
        return -1;
    *c = (struct skin_change){value[0], value[1]};
    return 0;
}

int run_share_count(const struct run *r, uint64_t *n, struct error *e)
{
    return r->domain ? wire_sum(r->domain->wire, n, 1, e) : 0;
}

int run_share_exact(const struct run *r, struct exact_sum *sum, size_t n, struct error *e)
{
    return r->domain ? wire_exact(r->domain->wire, sum, n, e) : 0;
}
