/* plan/explain.c -- the plan told: for people as a database tells a query plan, for machines as JSON. */
#include "domain/ranks.h"
#include "plan/device_memory.h"
#include "scene/fill.h"
#include <math.h>
#include <string.h>

static const char *type_name(uint32_t type)
{
    switch (type) {
    case SPH_SCALAR:
        return "scalar";
    case SPH_VECTOR:
        return "vector";
    case SPH_SYM:
        return "sym. tensor";
    case SPH_MATRIX:
        return "matrix";
    case SPH_INT32:
        return "int32";
    default:
        return "int64";
    }
}

double plan_neighbours(const struct plan *plan, size_t array)
{
    const struct plan_array *a = &plan->array[array];
    static const double ball[4] = {1.0, 2.0, 3.14159265358979324, 4.18879020478639098};
    return ball[plan->dim] *
           pow(plan->kernel.support * plan->reach_scale * a->scene->h_factor, plan->dim);
}

uint64_t plan_count(const struct plan *plan, size_t array)
{
    const struct plan_array *a = &plan->array[array];
    uint64_t n = 0;
    struct error ignored = {0};
    if (a->p.n > 0)
        return a->p.n;
    return fill_count(plan->scene, array, &n, &ignored) ? 0 : n;
}

/* A comma list that breaks before column 80. */
struct line {
    FILE *out;
    int column, indent;
    bool any;
};

static void item(struct line *l, const char *word)
{
    int length = (int)strlen(word);
    if (l->any)
        l->column += fprintf(l->out, ",");
    if (l->column + length + 1 > 78)
        l->column = fprintf(l->out, "\n%*s", l->indent, "") - 1;
    l->column += fprintf(l->out, " %s", word);
    l->any = true;
}

/* Words from column DOC_COLUMN on, in as many lines as they take. */
#define DOC_COLUMN 51
static void print_doc(const char *text, FILE *out)
{
    int column = DOC_COLUMN;
    while (*text) {
        int n = (int)strcspn(text, " ");
        if (column > DOC_COLUMN && column + 1 + n > 79)
            column = fprintf(out, "\n%*s", DOC_COLUMN, "") - 1;
        column += fprintf(out, "%s%.*s", column > DOC_COLUMN ? " " : "", n, text);
        text += n + (text[n] == ' ');
    }
    fprintf(out, "\n");
}

static void print_access(const struct plan *plan, const struct pass *p, const char *title,
                         uint32_t access, bool source, FILE *out)
{
    struct line l = {.out = out, .indent = 17};
    for (uint32_t k = 0; k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        if (!(prop->access & access))
            continue;
        if (!l.any)
            l.column = fprintf(out, "      %-11s", title);
        item(&l, prop->name);
    }
    if (source && l.any) {
        fprintf(out, "  of");
        for (size_t s = 0; s < p->n_src; s++)
            fprintf(out, " %s", plan->array[p->src[s].array].p.name);
    }
    if (l.any)
        fprintf(out, "\n");
}

static void print_pass(const struct plan *plan, const struct pass *p, size_t number, FILE *out)
{
    const char *shape = p->shape == SPH_POINT    ? "point"
                        : p->reach == SPH_GATHER ? "pair, r < support h_i"
                                                 : "pair, r < support max(h_i, h_j)";
    fprintf(out, "  %2zu  %-28s %-9s %s%s\n", number, p->name, moment_name[p->moment], shape,
            p->max_sweeps ? ", repeated" : "");
    if (p->real == SPH_F32)
        fprintf(out, "      %-11s floats\n", "sums in");
    if (p->use.entry && p->use.entry->n_part) {
        struct line l = {.out = out, .indent = 17};
        l.column = fprintf(out, "      %-11s", "in one");
        for (size_t k = 0; k < p->use.entry->n_part; k++)
            item(&l, p->use.entry->part[k]);
        fprintf(out, "\n");
    }
    if (p->frame)
        fprintf(out, "      %-11s %s%s\n", "neighbours", plan->frame[p->frame].name,
                plan->frame[p->frame].frozen ? ", found once" : "");
    print_access(plan, p, "reads", SPH_DST_READ, false, out);
    print_access(plan, p, "from pairs", SPH_SRC_READ, true, out);
    print_access(plan, p, "writes", SPH_DST_WRITE, false, out);
    print_access(plan, p, "sums", SPH_DST_SUM, false, out);
    print_access(plan, p, "takes min", SPH_DST_MIN, false, out);
    print_access(plan, p, "takes max", SPH_DST_MAX, false, out);
}

/* Bytes of an element, and of its mirror; or of its two parts. */
static const char *held(const struct plan_array *a, size_t c)
{
    const struct column *column = &a->p.column[c];
    if (a->in_two[c] || (a->in_quanta && (int)c == a->position))
        return "4 + 4";
    return a->in_floats[c] || column->size == 4 ? "4" : a->mirrored[c] ? "8 + 4" : "8";
}

static void print_array(const struct plan *plan, size_t index, FILE *out)
{
    const struct plan_array *a = &plan->array[index];
    fprintf(out, "  %s: %llu particles, %zu columns, %zu bytes a particle (lists: %.0f more)\n",
            a->p.name, (unsigned long long)plan_count(plan, index), a->p.n_column,
            plan_bytes(plan, index),
            plan->has_kernel ? 2.0 * (plan_neighbours(plan, index) * 2.6) / SPH_LANES : 0.0);
    for (size_t c = 0; c < a->p.n_column; c++) {
        const struct column *column = &a->p.column[c];
        fprintf(out, "    %-8s %-11s %-6s %-5s %-12s ", column->name, type_name(column->type),
                held(a, c), column->state ? "state" : "", column->unit ? column->unit : "");
        print_doc(column->doc ? column->doc : "", out);
    }
    for (size_t k = 0; k < a->n_rate; k++)
        fprintf(out, "    %s advances with %s (%s)\n", a->p.column[a->rate[k].property].name,
                a->p.column[a->rate[k].rate].name, a->rate[k].kind == SPH_DRIFT ? "drift" : "kick");
}

/* The last pass before `index` in an evaluation that has set a column whose value nobody has read; NULL: none. */
static const struct pass *set_in_vain(const struct plan *plan, size_t index, size_t array,
                                      int column)
{
    for (size_t i = index; i-- > 0;) {
        const struct pass *p = &plan->pass[i];
        if (p->moment != MOMENT_EVALUATE)
            continue;
        if (pass_reads_source(p, array, column))
            return NULL;
        for (uint32_t k = 0; p->dst.array == array && k < p->use.item->props.count; k++)
            if (p->dst.column[k] == column)
                return pass_writes(p, array, column) ? p : NULL;
    }
    return NULL;
}

/* Rates that one function sets and a later one sets anew, where it should have added: a slip that
 * takes, say, all pressure out of a flow. */
static void print_lost(const struct plan *plan, FILE *out)
{
    for (size_t i = 0; i < plan->n_pass; i++) {
        const struct pass *p = &plan->pass[i];
        const struct plan_array *a = &plan->array[p->dst.array];
        for (uint32_t k = 0; p->moment == MOMENT_EVALUATE && k < p->use.item->props.count; k++) {
            const sph_prop *prop = list_at(&p->use.item->props, k);
            bool rate = false;
            for (size_t r = 0; r < a->n_rate; r++)
                rate = rate || a->rate[r].rate == p->dst.column[k];
            if (!rate || (prop->access & SPH_DST_READ) || p->continues[k] ||
                !pass_writes(p, p->dst.array, p->dst.column[k]))
                continue;
            const struct pass *before = set_in_vain(plan, i, p->dst.array, p->dst.column[k]);
            if (before)
                fprintf(out, "note: %s sets \"%s\" anew;\n      what %s has put into it is lost\n",
                        p->name, prop->name, before->name);
        }
    }
}

static bool told_before(const struct plan *plan, size_t reduction)
{
    for (size_t i = 0; i < reduction; i++)
        if (plan->reduction[i].declared == plan->reduction[reduction].declared)
            return true;
    return false;
}

/* Which columns the ghosts need anew, and after which pass. */
static void print_exchanges(const struct plan *plan, FILE *out)
{
    int rank, ranks;
    ranks_count(&rank, &ranks);
    bool sides = ranks > 1;
    for (int c = 0; c < plan->dim; c++)
        for (int k = 0; k < 2; k++)
            sides = sides || (plan->scene->box.bounded && plan->scene->box.side[c][k] != SIDE_OPEN);
    if (!sides) {
        fprintf(out, "exchanges\n  none: all sides are open, there are no ghosts\n");
        return;
    }
    fprintf(out, "exchanges: columns that ghosts get anew before a pass\n");
    for (size_t i = 0; i < plan->n_pass; i++) {
        const struct pass *p = &plan->pass[i];
        struct line l = {.out = out, .indent = 33};
        for (size_t a = 0; a < plan->n_array; a++)
            for (size_t c = 0; c < plan->array[a].p.n_column; c++) {
                if (!pass_reads_source(p, a, (int)c))
                    continue;
                if (!l.any)
                    l.column = fprintf(out, "  %-30s", p->name);
                item(&l, plan->array[a].p.column[c].name);
            }
        if (l.any)
            fprintf(out, "\n");
    }
}

static double expected_pairs(const struct plan *plan)
{
    double pairs = 0.0;
    for (size_t i = 0; i < plan->n_pass; i++) {
        const struct pass *p = &plan->pass[i];
        if (p->shape == SPH_PAIR && p->moment == MOMENT_EVALUATE)
            pairs += (double)plan_count(plan, p->dst.array) * plan_neighbours(plan, p->dst.array) *
                     (p->max_sweeps ? 2.0 : 1.0);
    }
    return pairs * plan->integrator->evaluations;
}

void plan_print(const struct plan *plan, FILE *out)
{
    const char *title = plan->scene->title;
    fprintf(out, "%s\n", title && title[0] ? title : plan->scene->doc->path);
    fprintf(out, "  scheme %s, kernel %s, integrator %s, %d dimension%s, cfl %g, %s\n",
            plan->scheme_name ? plan->scheme_name : "none",
            plan->kernel_name ? plan->kernel_name : "none", plan->integrator->name, plan->dim,
            plan->dim == 1 ? "" : "s", plan->cfl, precision_name[plan->precision]);
    fprintf(out, "  neighbour lists with a skin of %g of the support\n", plan->skin);
    fprintf(out, "arrays\n");
    for (size_t a = 0; a < plan->n_array; a++)
        print_array(plan, a, out);
    fprintf(out, "passes\n");
    for (size_t i = 0; i < plan->n_pass; i++)
        print_pass(plan, &plan->pass[i], i + 1, out);
    print_lost(plan, out);
    print_exchanges(plan, out);
    fprintf(out, "reductions\n");
    for (size_t i = 0; i < plan->n_reduction; i++) {
        const sph_reduction *d = plan->reduction[i].declared;
        if (told_before(plan, i))
            continue;
        static const char *const op[] = {"", "minimum", "maximum", "sum"};
        static const char *const use[] = {"shown in the log", "bounds the time step",
                                          "internal energy", "potential energy"};
        fprintf(out, "  %-12s %s of %s: %s\n", d->name, op[d->op & 3u], d->property,
                use[d->use & 3u]);
    }
    double pairs = expected_pairs(plan);
    fprintf(out, "expected\n  pairs a step     %.3g\n", pairs);
    if (isfinite(pairs) && pairs > 0.0)
        fprintf(out, "  seconds a step   %.2g (at 6 ns a pair, one thread)\n", 6e-9 * pairs);
    if (plan->on_device)
        plan_print_device_memory(plan, out);
}

static void add_names(cJSON *to, const char *key, const struct pass *p, uint32_t access)
{
    cJSON *list = cJSON_AddArrayToObject(to, key);
    for (uint32_t k = 0; list && k < p->use.item->props.count; k++) {
        const sph_prop *prop = list_at(&p->use.item->props, k);
        if (prop->access & access)
            cJSON_AddItemToArray(list, cJSON_CreateString(prop->name));
    }
}

cJSON *plan_json(const struct plan *plan)
{
    cJSON *root = cJSON_CreateObject();
    cJSON *arrays = cJSON_AddObjectToObject(root, "arrays");
    for (size_t a = 0; arrays && a < plan->n_array; a++) {
        const struct particles *p = &plan->array[a].p;
        cJSON *one = cJSON_AddObjectToObject(arrays, p->name);
        cJSON_AddNumberToObject(one, "bytes_per_particle", (double)plan_bytes(plan, a));
        cJSON *columns = cJSON_AddArrayToObject(one, "columns");
        for (size_t c = 0; columns && c < p->n_column; c++)
            cJSON_AddItemToArray(columns, cJSON_CreateString(p->column[c].name));
    }
    cJSON *passes = cJSON_AddArrayToObject(root, "passes");
    for (size_t i = 0; passes && i < plan->n_pass; i++) {
        const struct pass *p = &plan->pass[i];
        cJSON *one = cJSON_CreateObject();
        cJSON_AddStringToObject(one, "name", p->name);
        cJSON_AddStringToObject(one, "at", moment_name[p->moment]);
        cJSON_AddStringToObject(one, "shape", p->shape == SPH_POINT ? "point" : "pair");
        if (p->shape == SPH_PAIR)
            cJSON_AddStringToObject(one, "sums_in", p->real == SPH_F32 ? "floats" : "doubles");
        cJSON *parts =
            p->use.entry && p->use.entry->n_part ? cJSON_AddArrayToObject(one, "parts") : NULL;
        for (size_t k = 0; parts && k < p->use.entry->n_part; k++)
            cJSON_AddItemToArray(parts, cJSON_CreateString(p->use.entry->part[k]));
        add_names(one, "reads", p, SPH_DST_READ);
        add_names(one, "reads_sources", p, SPH_SRC_READ);
        add_names(one, "writes", p, SPH_DST_WRITE | SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN);
        cJSON_AddItemToArray(passes, one);
    }
    cJSON_AddStringToObject(root, "integrator", plan->integrator->name);
    cJSON_AddStringToObject(root, "kernel", plan->kernel_name ? plan->kernel_name : "");
    cJSON_AddNumberToObject(root, "cfl", plan->cfl);
    cJSON_AddNumberToObject(root, "skin", plan->skin);
    cJSON_AddStringToObject(root, "precision", precision_name[plan->precision]);
    cJSON_AddNumberToObject(root, "expected_pairs_per_step", expected_pairs(plan));
    return root;
}
