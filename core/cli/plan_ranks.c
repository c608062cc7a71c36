/* cli/plan_ranks.c -- see plan_ranks.h. Prints forecasts (run/forecast.h). */
#include "cli/plan_ranks.h"
#include "domain/ranks.h"
#include <inttypes.h>
#include <string.h>

#define WIDTH 80

/* -- Making -------- */

/* Of particles made anew: those of a forecast are of no use afterwards. */
static int try_one(struct forecast *f, const struct scene_options *o, size_t which, struct error *e)
{
    struct loaded l;
    int status = loaded_make(&l, o, false, e);
    if (!status) {
        l.scene.ranks.partition = which;
        status = ranks_agree(plan_fill(&l.plan, e), e);
    }
    if (!status)
        status = forecast_make(f, &l.plan, e);
    loaded_free(&l);
    return status;
}

int plan_ranks_make(struct plan_ranks *r, const struct scene_options *o, size_t chosen,
                    struct error *e)
{
    struct scene_options here = *o;
    *r = (struct plan_ranks){.chosen = chosen};
    here.device_opencl = here.device_only = false; /* it cuts no other way */
    for (size_t k = 0; k < PARTITIONERS; k++)
        if (try_one(&r->by[k], &here, k, e))
            return -1;
    return 0;
}

void plan_ranks_free(struct plan_ranks *r)
{
    for (size_t k = 0; k < PARTITIONERS; k++)
        forecast_free(&r->by[k]);
}

/* -- Words -------- */

static double share(double part, double all)
{
    return all > 0.0 ? part / all : 0.0;
}

static void print_shares(const struct forecast *f, FILE *out)
{
    const double mean = forecast_sum(f).cost / f->ranks;
    fprintf(out, "  rank  particles     ghosts  sends to  cost/mean  messages  bytes (a step)\n");
    for (int k = 0; k < f->ranks; k++)
        fprintf(out,
                "  %4d %10" PRIu64 " %10" PRIu64 " %9" PRIu64 " %10.3f %9" PRIu64 " %10" PRIu64
                "\n",
                k, f->of[k].particles, f->of[k].ghosts, f->of[k].peers, share(f->of[k].cost, mean),
                f->by[k].messages, f->by[k].bytes);
}

/* A column's name, with its array's where there are several; cut off if it is long. */
static void name_column(const struct plan *plan, const struct exchange_column *c, char *to,
                        size_t size)
{
    const struct particles *p = &plan->array[c->array].p;
    if (plan->n_array > 1)
        snprintf(to, size, "%s.%s", p->name, p->column[c->column].name);
    else
        snprintf(to, size, "%s", p->column[c->column].name);
}

static void print_exchange(const struct forecast *f, size_t i, const struct plan *plan, FILE *out)
{
    const struct exchange *x = &f->exchanges.at[i];
    char word[128];
    int column = fprintf(out, "  %-26.26s %10" PRIu64 " %6" PRIu64 " ", plan->pass[x->pass].name,
                         f->sent[i].bytes, f->sent[i].messages);
    if (x->again)
        column += fprintf(out, " (each further sweep)");
    for (size_t k = x->first; k < x->first + x->n; k++) {
        name_column(plan, &f->exchanges.column[k], word, sizeof word);
        if (column + 1 + (int)strlen(word) > WIDTH - 1)
            column = fprintf(out, "\n%46s", "") - 1;
        column += fprintf(out, " %s", word);
    }
    fprintf(out, "\n");
}

static void print_exchanges(const struct forecast *f, const struct plan *plan, FILE *out)
{
    fprintf(out, "  sent between two makings of lists, by all ranks\n"
                 "  before                          bytes messages, of columns\n");
    for (size_t i = 0; i < f->exchanges.n; i++) {
        const struct exchange *x = &f->exchanges.at[i];
        if (i && x->evaluation != f->exchanges.at[i - 1].evaluation)
            fprintf(out, "  evaluation %zu of the step:\n", x->evaluation + 1);
        print_exchange(f, i, plan, out);
    }
    const struct halo_sent one = forecast_sent(f, 0), all = forecast_sent(f, SIZE_MAX);
    fprintf(out, "  %-26s %10" PRIu64 " %6" PRIu64 "\n", "an evaluation", one.bytes, one.messages);
    fprintf(out, "  %-26s %10" PRIu64 " %6" PRIu64 "\n", "a step", all.bytes, all.messages);
}

static void print_ways(const struct plan_ranks *r, FILE *out)
{
    fprintf(out, "  cut by     largest   ghosts a   pairs across   messages   bytes\n"
                 "          cost/mean   particle     other ranks     a step   a step\n");
    for (size_t k = 0; k < PARTITIONERS; k++) {
        const struct forecast_rank s = forecast_sum(&r->by[k]);
        const struct halo_sent sent = forecast_sent(&r->by[k], SIZE_MAX);
        fprintf(out, "  %-6s %c %9.3f %10.3f %13.2f %% %10" PRIu64 " %8" PRIu64 "\n",
                partitioner_name[k], k == r->chosen ? '*' : ' ', forecast_balance(&r->by[k]),
                share((double)s.ghosts, (double)s.particles),
                100.0 * share((double)s.across, s.pairs), sent.messages, sent.bytes);
    }
}

void plan_ranks_print(const struct plan_ranks *r, const struct plan *plan, FILE *out)
{
    const struct forecast *f = &r->by[r->chosen];
    fprintf(out, "ranks: %d, cut by %s\n", f->ranks, partitioner_name[r->chosen]);
    print_shares(f, out);
    print_exchanges(f, plan, out);
    print_ways(r, out);
}

/* -- JSON -------- */

static void put_sent(cJSON *to, const char *name, const struct halo_sent *s)
{
    cJSON *one = cJSON_AddObjectToObject(to, name);
    cJSON_AddNumberToObject(one, "messages", (double)s->messages);
    cJSON_AddNumberToObject(one, "bytes", (double)s->bytes);
}

static void put_each(const struct forecast *f, cJSON *to)
{
    static const char *const name[] = {"particles", "ghosts", "peers",    "pairs",
                                       "across",    "cost",   "messages", "bytes"};
    for (size_t k = 0; k < sizeof name / sizeof *name; k++) {
        cJSON *list = cJSON_AddArrayToObject(to, name[k]);
        for (int i = 0; list && i < f->ranks; i++) {
            const struct forecast_rank *q = &f->of[i];
            const double value[] = {(double)q->particles,      (double)q->ghosts,
                                    (double)q->peers,          q->pairs,
                                    (double)q->across,         q->cost,
                                    (double)f->by[i].messages, (double)f->by[i].bytes};
            cJSON_AddItemToArray(list, cJSON_CreateNumber(value[k]));
        }
    }
}

static void put_way(const struct forecast *f, cJSON *to)
{
    const struct forecast_rank s = forecast_sum(f);
    const struct halo_sent one = forecast_sent(f, 0), all = forecast_sent(f, SIZE_MAX);
    cJSON_AddNumberToObject(to, "imbalance", forecast_balance(f));
    cJSON_AddNumberToObject(to, "ghosts", share((double)s.ghosts, (double)s.particles));
    cJSON_AddNumberToObject(to, "across", share((double)s.across, s.pairs));
    put_sent(to, "evaluation", &one);
    put_sent(to, "step", &all);
    put_each(f, cJSON_AddObjectToObject(to, "each"));
}

static void put_exchanges(const struct forecast *f, const struct plan *plan, cJSON *to)
{
    for (size_t i = 0; to && i < f->exchanges.n; i++) {
        const struct exchange *x = &f->exchanges.at[i];
        char word[128];
        cJSON *one = cJSON_CreateObject();
        cJSON_AddStringToObject(one, "pass", plan->pass[x->pass].name);
        cJSON_AddNumberToObject(one, "evaluation", (double)x->evaluation);
        cJSON_AddBoolToObject(one, "again", x->again);
        cJSON_AddNumberToObject(one, "messages", (double)f->sent[i].messages);
        cJSON_AddNumberToObject(one, "bytes", (double)f->sent[i].bytes);
        cJSON *columns = cJSON_AddArrayToObject(one, "columns");
        for (size_t k = x->first; columns && k < x->first + x->n; k++) {
            name_column(plan, &f->exchanges.column[k], word, sizeof word);
            cJSON_AddItemToArray(columns, cJSON_CreateString(word));
        }
        cJSON_AddItemToArray(to, one);
    }
}

cJSON *plan_ranks_json(const struct plan_ranks *r, const struct plan *plan)
{
    const struct forecast *f = &r->by[r->chosen];
    cJSON *root = cJSON_CreateObject();
    cJSON_AddNumberToObject(root, "number", f->ranks);
    cJSON_AddStringToObject(root, "partition", partitioner_name[r->chosen]);
    put_exchanges(f, plan, cJSON_AddArrayToObject(root, "exchanges"));
    cJSON *ways = cJSON_AddObjectToObject(root, "partitions");
    for (size_t k = 0; ways && k < PARTITIONERS; k++)
        put_way(&r->by[k], cJSON_AddObjectToObject(ways, partitioner_name[k]));
    return root;
}
