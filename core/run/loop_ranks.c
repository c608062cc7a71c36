/* run/loop_ranks.c -- see loop_ranks.h. Takes numbers from the run and its domain, changes nothing there. */
#include "run/loop_ranks.h"
#include "io/summary.h"
#include "run/device.h"
#include <stdlib.h>
#include <sys/resource.h>

#define FILE_NAME "ranks.csv"

/* -- Opened and closed -------- */

int loop_ranks_open(struct loop_ranks *l, struct run *r, const struct output *out, bool resumed,
                    struct error *e)
{
    *l = (struct loop_ranks){.first = NAN, .last = NAN, .most = NAN, .halos = UINT64_MAX};
    if (!run_shared(r))
        return 0;
    l->run = r;
    l->sweeps = calloc(r->plan->n_pass + 1, sizeof *l->sweeps);
    l->n = calloc(r->plan->n_array + 1, sizeof *l->n);
    if (!l->sweeps || !l->n)
        return error_memory(e, "the passes' sweeps", r->plan->n_pass * sizeof *l->sweeps);
    if (exchanges_make(&l->plan, r->plan, e))
        return -1;
    l->pairs = r->cost.pairs;
    if (!run_speaks(r))
        return 0;
    char *path = output_path(out, FILE_NAME);
    int status = path ? 0 : error_memory(e, "a path", 1);
    if (!status && resumed)
        status = csv_cut_from(path, r->step, e);
    if (!status)
        status = csv_open(&l->csv, path, resumed ? CSV_GO_ON : CSV_OVER, e);
    if (!status)
        status = csv_head(&l->csv,
                          "step,time,imbalance,imbalance_particles,ghosts,cuts,moved,"
                          "bytes_columns,bytes,wait_s\n",
                          e);
    free(path);
    return status;
}

void loop_ranks_free(struct loop_ranks *l)
{
    struct error ignored = {0};
    csv_close(&l->csv, &ignored);
    exchanges_free(&l->plan);
    free(l->sweeps);
    free(l->n);
    free(l->of);
    free(l->array_n);
    free(l->pass_s);
    free(l->pass_pairs);
    *l = (struct loop_ranks){0};
}

int loop_ranks_sync(struct loop_ranks *l, struct error *e)
{
    return csv_sync(&l->csv, e);
}

int loop_ranks_close(struct loop_ranks *l, struct error *e)
{
    return csv_close(&l->csv, e);
}

/* -- Steps -------- */

void loop_ranks_step_begins(struct loop_ranks *l)
{
    const struct run *r = l->run;
    if (!r)
        return;
    l->halos_before = l->halos;
    l->halos = r->domain->halos;
    l->sent = r->domain->halo.sent;
    for (size_t i = 0; i < r->plan->n_pass; i++)
        l->sweeps[i] = r->plan->pass[i].sweeps;
}

/* How often an exchange of the plan has been made in this step. */
static uint64_t times(const struct loop_ranks *l, const struct exchange *x)
{
    const struct plan *plan = l->run->plan;
    const struct pass *p = &plan->pass[x->pass];
    const uint64_t sweeps = p->sweeps - l->sweeps[x->pass];
    const uint64_t first =
        p->moment == MOMENT_EVALUATE ? (uint64_t)plan->integrator->evaluations : 1;
    return !x->again ? 1 : sweeps > first ? sweeps - first : 0;
}

/* What the plan says that this rank sends in this step, to those whose ghosts it has now. */
static void say_planned(const struct loop_ranks *l, struct halo_sent *to)
{
    const struct run *r = l->run;
    const struct halo *h = &r->domain->halo;
    for (size_t k = 0; k < h->n_peer; k++) {
        for (size_t a = 0; a < r->plan->n_array; a++)
            l->n[a] = h->peer[k].part[a].n_send;
        for (size_t i = 0; i < l->plan.n; i++) {
            const uint64_t bytes = exchange_bytes(&l->plan, &l->plan.at[i], r->plan, l->n);
            to->bytes += bytes * times(l, &l->plan.at[i]);
            to->messages += (bytes > 0) * times(l, &l->plan.at[i]);
        }
    }
}

/* A step counts if ghosts were made neither in it nor in the one before: after that all columns are old once. */
void loop_ranks_step_ends(struct loop_ranks *l)
{
    const struct run *r = l->run;
    if (!r || r->domain->halos != l->halos || l->halos != l->halos_before)
        return;
    say_planned(l, &l->planned);
    l->steady_steps++;
    l->steady.messages += r->domain->halo.sent.messages - l->sent.messages;
    l->steady.bytes += r->domain->halo.sent.bytes - l->sent.bytes;
}

/* -- Rows -------- */

enum { PAIRS_MOST, PAIRS, PARTICLES_MOST, PARTICLES, GHOSTS, MOVED, COLUMNS, BYTES, WAIT, CELLS };

static double over_mean(double most, double sum, double ranks)
{
    return sum > 0.0 ? most * ranks / sum : 1.0;
}

static void count_particles(const struct run *r, uint64_t *n, uint64_t *ghosts)
{
    *n = *ghosts = 0;
    for (size_t a = 0; a < r->plan->n_array; a++) {
        *n += r->plan->array[a].p.n;
        *ghosts += r->domain->halo.n_ghost[a] - r->ghosts[a].n; /* its own images are nobody's */
    }
}

int loop_ranks_row(struct loop_ranks *l, struct error *e)
{
    static const uint32_t op[CELLS] = {SPH_REDUCE_MAX, SPH_REDUCE_SUM, SPH_REDUCE_MAX,
                                       SPH_REDUCE_SUM, SPH_REDUCE_SUM, SPH_REDUCE_SUM,
                                       SPH_REDUCE_SUM, SPH_REDUCE_SUM, SPH_REDUCE_SUM};
    struct run *r = l->run;
    uint64_t n, ghosts;
    if (!r)
        return 0;
    const struct wire_count count = wire_count(r->domain->wire);
    const double ranks = (double)wire_size(r->domain->wire);
    count_particles(r, &n, &ghosts);
    double v[CELLS] = {[GHOSTS] = (double)ghosts,
                       [MOVED] = (double)r->domain->moved,
                       [COLUMNS] = (double)r->domain->halo.sent.bytes,
                       [BYTES] = (double)count.bytes,
                       [WAIT] = count.seconds};
    v[PAIRS] = v[PAIRS_MOST] = (double)(r->cost.pairs - l->pairs);
    v[PARTICLES] = v[PARTICLES_MOST] = (double)n;
    l->pairs = r->cost.pairs;
    if (run_share_numbers(r, v, op, CELLS, e))
        return -1;
    if (v[PAIRS] > 0.0) {
        l->last = over_mean(v[PAIRS_MOST], v[PAIRS], ranks);
        l->first = l->rows == 0 ? l->last : l->first;
        l->most = l->rows == 0 ? l->last : fmax(l->most, l->last);
        l->rows++;
    }
    if (!run_speaks(r))
        return 0;
    csv_count(&l->csv, r->step);
    csv_number(&l->csv, r->time);
    csv_number(&l->csv, v[PAIRS] > 0.0 ? l->last : NAN);
    csv_number(&l->csv, over_mean(v[PARTICLES_MOST], v[PARTICLES], ranks));
    csv_number(&l->csv, v[PARTICLES] > 0.0 ? v[GHOSTS] / v[PARTICLES] : 0.0);
    csv_count(&l->csv, r->domain->cuts);
    csv_count(&l->csv, (uint64_t)v[MOVED]);
    csv_count(&l->csv, (uint64_t)v[COLUMNS]);
    csv_count(&l->csv, (uint64_t)v[BYTES]);
    csv_fixed(&l->csv, v[WAIT] / ranks, 3);
    csv_end_row(&l->csv);
    return csv_commit(&l->csv, e);
}

/* -- At the end -------- */

static struct rank_figures figures(const struct loop_ranks *l, const struct summary_memory *held)
{
    const struct run *r = l->run;
    const struct wire_count count = wire_count(r->domain->wire);
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    struct rank_figures f = {.pairs = r->cost.pairs,
                             .updates = r->cost.particle_updates,
                             .created = r->cost.created,
                             .unfinished = r->cost.unfinished,
                             .rss = (uint64_t)usage.ru_maxrss * 1024u,
                             .moved = r->domain->moved,
                             .all = {count.messages, count.bytes},
                             .columns = r->domain->halo.sent,
                             .ghosts_made = r->domain->for_ghosts,
                             .moves = r->domain->for_moves,
                             .collectives = count.collectives,
                             .collective_bytes = count.collective_bytes,
                             .steady = l->steady,
                             .planned = l->planned,
                             .wait_s = count.seconds,
                             .loop_s = r->cost.loop,
                             .neighbour_s = r->cost.neighbour,
                             .integrate_s = r->cost.integrate,
                             .io_s = r->cost.io,
                             .columns_held = held->columns,
                             .mirrors_held = held->mirrors,
                             .lists_held = held->lists,
                             .places_held = held->places,
                             .ghosts_held = held->ghosts,
                             .search_held = held->search};
    count_particles(r, &f.particles, &f.ghosts);
    for (size_t i = 0; i < r->plan->n_pass; i++)
        f.pass_s += r->plan->pass[i].seconds;
    return f;
}

static int sum_up(const struct loop_ranks *l, double *value, size_t n, struct error *e)
{
    uint32_t *op = malloc((n + 1) * sizeof *op);
    if (!op)
        return error_memory(e, "the summary", n * sizeof *op);
    for (size_t k = 0; k < n; k++)
        op[k] = SPH_REDUCE_SUM;
    const int status = run_share_numbers(l->run, value, op, n, e);
    free(op);
    return status;
}

int loop_ranks_gather(struct loop_ranks *l, const struct summary_memory *held, struct error *e)
{
    if (!l->run)
        return 0;
    const struct plan *plan = l->run->plan;
    struct wire *wire = l->run->domain->wire;
    if (l->run->device)
        run_device_costs(l->run);
    const struct rank_figures mine = figures(l, held);
    struct rank_figures *of = calloc((size_t)wire_size(wire), sizeof *of);
    free(l->array_n);
    free(l->pass_s);
    free(l->pass_pairs);
    l->array_n = calloc(plan->n_array + 1, sizeof *l->array_n);
    l->pass_s = calloc(plan->n_pass + 1, sizeof *l->pass_s);
    l->pass_pairs = calloc(plan->n_pass + 1, sizeof *l->pass_pairs);
    int status = of && l->array_n && l->pass_s && l->pass_pairs
                     ? 0
                     : error_memory(e, "the summary", plan->n_pass * sizeof *l->pass_s);
    for (size_t a = 0; !status && a < plan->n_array; a++)
        l->array_n[a] = (double)plan->array[a].p.n;
    for (size_t i = 0; !status && i < plan->n_pass; i++) {
        l->pass_s[i] = plan->pass[i].seconds;
        l->pass_pairs[i] = (double)plan->pass[i].pairs;
    }
    if (!status)
        status = wire_gather(wire, &mine, sizeof mine, of, e) ||
                         sum_up(l, l->array_n, plan->n_array, e) ||
                         sum_up(l, l->pass_s, plan->n_pass, e) ||
                         sum_up(l, l->pass_pairs, plan->n_pass, e)
                     ? -1
                     : 0;
    free(l->of);
    l->of = status ? NULL : of;
    if (status)
        free(of);
    return status;
}

static void add_sent(struct halo_sent *to, const struct halo_sent *more)
{
    to->messages += more->messages;
    to->bytes += more->bytes;
}

struct rank_figures loop_ranks_sum(const struct loop_ranks *l)
{
    struct rank_figures s = {0};
    for (int k = 0; l->of && k < wire_size(l->run->domain->wire); k++) {
        const struct rank_figures *f = &l->of[k];
        s.particles += f->particles;
        s.ghosts += f->ghosts;
        s.pairs += f->pairs;
        s.updates += f->updates;
        s.created += f->created;
        s.unfinished += f->unfinished;
        s.rss += f->rss;
        s.moved += f->moved;
        add_sent(&s.all, &f->all);
        add_sent(&s.columns, &f->columns);
        add_sent(&s.ghosts_made, &f->ghosts_made);
        add_sent(&s.moves, &f->moves);
        add_sent(&s.steady, &f->steady);
        add_sent(&s.planned, &f->planned);
        s.collectives += f->collectives;
        s.collective_bytes += f->collective_bytes;
        s.pass_s += f->pass_s;
        s.wait_s += f->wait_s;
        s.loop_s += f->loop_s;
        s.neighbour_s += f->neighbour_s;
        s.integrate_s += f->integrate_s;
        s.io_s += f->io_s;
        s.columns_held += f->columns_held;
        s.mirrors_held += f->mirrors_held;
        s.lists_held += f->lists_held;
        s.places_held += f->places_held;
        s.ghosts_held += f->ghosts_held;
        s.search_held += f->search_held;
    }
    return s;
}

/* -- JSON -------- */

static void put_number(cJSON *to, const char *name, double value)
{
    if (isfinite(value))
        cJSON_AddNumberToObject(to, name, value);
    else
        cJSON_AddNullToObject(to, name);
}

static void put_count(cJSON *to, const char *name, uint64_t value)
{
    put_number(to, name, (double)value);
}

static void put_sent(cJSON *to, const char *name, const struct halo_sent *s)
{
    cJSON *one = cJSON_AddObjectToObject(to, name);
    put_count(one, "messages", s->messages);
    put_count(one, "bytes", s->bytes);
}

static void put_each(const struct loop_ranks *l, cJSON *to)
{
    static const char *const name[] = {"particles", "ghosts", "pairs", "pass_s", "wait_s"};
    for (size_t k = 0; k < sizeof name / sizeof *name; k++) {
        cJSON *list = cJSON_AddArrayToObject(to, name[k]);
        for (int i = 0; list && i < wire_size(l->run->domain->wire); i++) {
            const struct rank_figures *f = &l->of[i];
            const double value[] = {(double)f->particles, (double)f->ghosts, (double)f->pairs,
                                    f->pass_s, f->wait_s};
            cJSON_AddItemToArray(list, cJSON_CreateNumber(value[k]));
        }
    }
}

/* In steps between the making of lists: what was sent, and what the plan says. */
static void put_steady(const struct loop_ranks *l, const struct rank_figures *s, cJSON *to)
{
    const double steps = (double)l->steady_steps;
    put_count(to, "steps", l->steady_steps);
    put_count(to, "messages", s->steady.messages);
    put_count(to, "bytes", s->steady.bytes);
    if (!l->run->device) { /* there passes that share a kernel share a message */
        put_count(to, "planned_messages", s->planned.messages);
        put_count(to, "planned_bytes", s->planned.bytes);
    }
    put_number(to, "messages_per_step", (double)s->steady.messages / steps);
    put_number(to, "bytes_per_step", (double)s->steady.bytes / steps);
}

cJSON *loop_ranks_json(const struct loop_ranks *l)
{
    if (!l->of)
        return cJSON_CreateNull();
    const struct run_domain *d = l->run->domain;
    const struct rank_figures s = loop_ranks_sum(l);
    cJSON *root = cJSON_CreateObject();
    put_count(root, "number", (uint64_t)wire_size(d->wire));
    put_count(root, "threads", (uint64_t)l->run->threads);
    cJSON_AddStringToObject(root, "partition",
                            partitioner_name[l->run->plan->scene->ranks.partition]);
    cJSON *imbalance = cJSON_AddObjectToObject(root, "imbalance");
    put_number(imbalance, "first", l->first);
    put_number(imbalance, "last", l->last);
    put_number(imbalance, "most", l->most);
    put_count(root, "cuts", d->cuts);
    put_count(root, "moved", s.moved);
    put_number(root, "ghosts", s.particles ? (double)s.ghosts / (double)s.particles : 0.0);
    put_steady(l, &s, cJSON_AddObjectToObject(root, "exchange"));
    cJSON *sent = cJSON_AddObjectToObject(root, "sent");
    put_sent(sent, "all", &s.all);
    put_sent(sent, "columns", &s.columns);
    put_sent(sent, "ghosts", &s.ghosts_made);
    put_sent(sent, "moves", &s.moves);
    put_sent(sent, "collectives", &(struct halo_sent){s.collectives, s.collective_bytes});
    put_each(l, cJSON_AddObjectToObject(root, "each"));
    return root;
}
