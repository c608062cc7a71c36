/* run/measures.c -- the moments of measures, their files and rows: see measures.h. */
#include "run/measures.h"
#include "base/text.h"
#include "run/domain.h"
#include "run/norms.h"
#include "run/report.h"
#include "run/sample.h"
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* -- Moments ----------------------------------------------------------------------------------- */

/* Times are sums of steps: a rounding below a moment is at it. */
#define NEARLY 1e-9

static double tick(const struct measures *m, const struct series *s)
{
    return m->begin + ((double)s->next - NEARLY) * s->when->every;
}

/* The next of the times that are listed has come. */
static bool listed(const struct measures *m, const struct series *s, double time)
{
    return s->next_at < s->when->n_at &&
           time >= s->when->at[s->next_at] - NEARLY * (m->end - m->begin);
}

static bool is_due(const struct measures *m, const struct series *s)
{
    const uint64_t steps = s->when->steps;
    return (isfinite(s->when->every) && m->run->time >= tick(m, s)) ||
           (steps && m->run->step % steps == 0) || listed(m, s, m->run->time);
}

/* The moments that have come until then are behind. */
static void passed(const struct measures *m, struct series *s, double time)
{
    while (isfinite(s->when->every) && time >= tick(m, s))
        s->next++;
    while (listed(m, s, time))
        s->next_at++;
}

static size_t n_series(const struct measures *m, struct series **list, int kind)
{
    const struct scene *s = m->run->plan->scene;
    *list = kind == 0 ? m->compare : kind == 1 ? m->probe : m->profile;
    return kind == 0 ? s->n_compare : kind == 1 ? s->n_probe : s->n_profile;
}

bool measures_due(const struct measures *m)
{
    for (int kind = 0; m->any && kind < 3; kind++) {
        struct series *list;
        const size_t n = n_series(m, &list, kind);
        for (size_t i = 0; i < n; i++)
            if (is_due(m, &list[i]))
                return true;
    }
    return false;
}

/* -- Files ------------------------------------------------------------------------------------- */

static void put_names(struct csv *csv, const char *const *name, size_t n)
{
    for (size_t i = 0; i < n; i++)
        csv_name(csv, name[i]);
}

static const char *const coordinate[] = {"x", "y", "z", "r"};

/* measures_restore.c reads these columns. */
static void errors_head(const struct measures *m, size_t i, struct csv *to)
{
    static const char *const names[] = {"compare", "array",  "field",  "reference",
                                        "l1",      "l1_rel", "l2",     "l2_rel",
                                        "linf",    "n",      "outside"};
    static const char *const at[] = {"linf_x", "linf_y", "linf_z"};
    (void)i;
    put_names(to, names, sizeof names / sizeof *names);
    put_names(to, at, (size_t)m->run->plan->dim);
}

static void probe_head(const struct measures *m, size_t i, struct csv *to)
{
    const struct scene_probe *p = &m->run->plan->scene->probe[i];
    const bool points = p->kind == PROBE_POINTS;
    if (points)
        csv_name(to, "point");
    put_names(to, coordinate, points ? (size_t)m->run->plan->dim : 0);
    put_names(to, m->name[i], points ? p->sample.n_of + 1 : 1);
}

static void profile_head(const struct measures *m, size_t i, struct csv *to)
{
    const struct scene_profile *p = &m->run->plan->scene->profile[i];
    char deviation[256], reference[256];
    size_t unused;
    csv_name(to, p->bins ? coordinate[p->along] : "s");
    put_names(to, coordinate, p->bins ? 0 : (size_t)m->run->plan->dim);
    for (size_t k = 0; k < p->sample.n_of; k++) {
        snprintf(deviation, sizeof deviation, "%s.std", p->sample.of[k]);
        csv_name(to, p->sample.of[k]);
        if (p->bins)
            csv_name(to, deviation);
    }
    csv_name(to, p->bins ? "n" : "sum");
    for (size_t k = 0; k < p->sample.n_of; k++)
        if (plan_profile_gives(m->run->plan, i, k, &unused)) {
            snprintf(reference, sizeof reference, "%s.ref", p->sample.of[k]);
            csv_name(to, reference);
        }
}

typedef void put_head(const struct measures *m, size_t i, struct csv *to);

static int open_file(struct measures *m, struct csv *csv, const char *name, bool resumed,
                     put_head *put, size_t i, struct error *e)
{
    size_t length = 0;
    if (!run_speaks(m->run))
        return 0;
    char *path = output_path(m->out, name), *line = NULL;
    struct csv head = {.file = open_memstream(&line, &length)};
    int status = path && head.file ? 0 : error_memory(e, "a path", strlen(name));
    if (!status && resumed)
        status = csv_cut_from(path, m->run->step, e);
    if (!status)
        status = csv_open(csv, path, resumed ? CSV_GO_ON : CSV_NEW, e);
    if (!status) {
        csv_name(&head, "step");
        csv_name(&head, "time");
        put(m, i, &head);
        csv_end_row(&head);
    }
    if (head.file && fclose(head.file) && !status)
        status = error_memory(e, name, 0);
    if (!status)
        status = csv_head(csv, line, e);
    free(line);
    free(path);
    return status;
}

static int open_series(struct measures *m, struct series *s, const char *prefix, const char *name,
                       bool resumed, put_head *put, size_t i, struct error *e)
{
    char *part = scene_file_part(name);
    s->file = part ? text_format("%s_%s.csv", prefix, part) : NULL;
    free(part);
    s->on_file = s->file != NULL;
    return s->file ? open_file(m, &s->csv, s->file, resumed, put, i, e)
                   : error_memory(e, "a file's name", strlen(name));
}

static int open_errors(struct measures *m, bool resumed, struct error *e)
{
    const struct scene *s = m->run->plan->scene;
    bool wanted = false;
    for (size_t i = 0; i < s->n_compare; i++)
        wanted = wanted || moments_any(&s->compare[i].when);
    return wanted ? open_file(m, &m->errors, "errors.csv", resumed, errors_head, 0, e) : 0;
}

static int open_probe(struct measures *m, size_t i, bool resumed, struct error *e)
{
    const struct scene_probe *p = &m->run->plan->scene->probe[i];
    const bool points = p->kind == PROBE_POINTS;
    const size_t width = points ? p->sample.n_of + 1 : 1;
    m->value[i] = calloc(width * (points ? p->sample.n_point : 1), sizeof *m->value[i]);
    m->name[i] = calloc(width + 1, sizeof *m->name[i]);
    if (!m->value[i] || !m->name[i])
        return error_memory(e, "a probe", width * sizeof *m->value[i]);
    for (size_t k = 0; k + 1 < width; k++)
        m->name[i][k] = p->sample.of[k];
    m->name[i][width - 1] = points ? "sum" : "value";
    return points || moments_any(&p->when)
               ? open_series(m, &m->probe[i], "probe", p->name, resumed, probe_head, i, e)
               : 0;
}

static int open_profile(struct measures *m, size_t i, bool resumed, struct error *e)
{
    return open_series(m, &m->profile[i], "profile", m->run->plan->scene->profile[i].name, resumed,
                       profile_head, i, e);
}

/* Which comparisons are behind is read from a file by one rank. */
static int share_taken(struct measures *m, struct error *e)
{
    for (size_t i = 0; i < m->run->plan->scene->n_compare; i++) {
        uint64_t taken = m->errors_of[i].taken;
        if (run_share_count(m->run, &taken, e))
            return -1;
        m->errors_of[i].taken = taken > 0;
    }
    return 0;
}

int measures_open(struct measures *m, struct run *r, const struct output *out, bool resumed,
                  struct error *e)
{
    const struct scene *s = r->plan->scene;
    *m = (struct measures){.run = r,
                           .out = out,
                           .begin = s->time.begin,
                           .end = s->time.end,
                           .any = s->n_compare || s->n_probe || s->n_profile};
    m->compare = calloc(s->n_compare + 1, sizeof *m->compare);
    m->errors_of = calloc(s->n_compare + 1, sizeof *m->errors_of);
    m->probe = calloc(s->n_probe + 1, sizeof *m->probe);
    m->value = calloc(s->n_probe + 1, sizeof *m->value);
    m->name = calloc(s->n_probe + 1, sizeof *m->name);
    m->profile = calloc(s->n_profile + 1, sizeof *m->profile);
    m->probe_end = calloc(s->n_probe + 1, sizeof *m->probe_end);
    m->profile_end = calloc(s->n_profile + 1, sizeof *m->profile_end);
    if (!m->compare || !m->errors_of || !m->probe || !m->value || !m->name || !m->profile ||
        !m->probe_end || !m->profile_end)
        return error_memory(e, "measures", s->n_probe * sizeof *m->probe);
    int status = open_errors(m, resumed, e);
    for (size_t i = 0; i < s->n_compare; i++)
        m->compare[i] = (struct series){.when = &s->compare[i].when, .last = UINT64_MAX, .next = 1};
    for (size_t i = 0; i < s->n_probe && !status; i++) {
        m->probe[i] = (struct series){.when = &s->probe[i].when, .last = UINT64_MAX, .next = 1};
        status = open_probe(m, i, resumed, e);
    }
    for (size_t i = 0; i < s->n_profile && !status; i++) {
        m->profile[i] = (struct series){.when = &s->profile[i].when, .last = UINT64_MAX, .next = 1};
        status = open_profile(m, i, resumed, e);
    }
    for (int kind = 0; kind < 3 && resumed && !status; kind++) {
        struct series *list;
        const size_t n = n_series(m, &list, kind);
        for (size_t i = 0; i < n; i++)
            passed(m, &list[i], r->time - r->dt);
    }
    return status || (resumed && (measures_restore(m, e) || share_taken(m, e))) ? -1 : 0;
}

/* -- Rows -------------------------------------------------------------------------------------- */

/* The end may come at a step whose rows are there: of no steps at all, or when a signal ends the run. */
static bool is_written(const struct measures *m, const struct series *s)
{
    return s->last == m->run->step;
}

static void begin_row(const struct measures *m, struct csv *csv)
{
    csv_count(csv, m->run->step);
    csv_number(csv, m->run->time);
}

static void put_numbers(struct csv *csv, const double *value, size_t n)
{
    for (size_t i = 0; i < n; i++)
        csv_number(csv, value[i]);
}

static int put_errors(struct measures *m, size_t compare, struct error *e)
{
    const struct measured_errors *all = &m->errors_of[compare];
    for (size_t i = 0; i < all->n; i++) {
        const struct summary_error *q = &all->error[i];
        const double norm[] = {q->l1, q->l1_rel, q->l2, q->l2_rel, q->linf};
        begin_row(m, &m->errors);
        csv_count(&m->errors, compare);
        csv_name(&m->errors, q->array);
        csv_name(&m->errors, q->field + strlen(q->array) + 1);
        csv_name(&m->errors, q->reference);
        put_numbers(&m->errors, norm, sizeof norm / sizeof *norm);
        csv_count(&m->errors, q->n);
        csv_count(&m->errors, q->outside);
        put_numbers(&m->errors, q->linf_at, (size_t)m->run->plan->dim);
        csv_end_row(&m->errors);
    }
    return csv_commit(&m->errors, e);
}

/* A table for one time is compared then, once; what else is wanted on the way, and again at the end. */
static int take_compare(struct measures *m, size_t i, bool end, struct error *e)
{
    const struct scene_compare *c = &m->run->plan->scene->compare[i];
    struct measured_errors *q = &m->errors_of[i];
    const bool timed = !isnan(c->time);
    if (timed && (q->taken || (end && !is_due(m, &m->compare[i]))))
        return 0;
    compare_free(q->error, q->n);
    *q = (struct measured_errors){.taken = true};
    if (compare_take(m->run, i, &q->error, &q->n, e))
        return -1;
    for (size_t k = 0; timed && k < q->n; k++)
        q->error[k].time = m->run->time;
    const bool wanted = moments_any(&c->when) && !is_written(m, &m->compare[i]);
    return wanted && run_speaks(m->run) ? put_errors(m, i, e) : 0;
}

static int take_probe(struct measures *m, size_t i, struct error *e)
{
    const struct scene_probe *p = &m->run->plan->scene->probe[i];
    struct csv *csv = &m->probe[i].csv;
    const bool points = p->kind == PROBE_POINTS;
    const size_t width = p->sample.n_of + 1;
    if (points ? sample_take(m->run, &p->sample, m->value[i], e)
               : probe_take(m->run, i, m->value[i], e))
        return -1;
    if (!m->probe[i].on_file || is_written(m, &m->probe[i]) || !run_speaks(m->run))
        return 0;
    for (size_t k = 0; k < (points ? p->sample.n_point : 1); k++) {
        begin_row(m, csv);
        if (points) {
            csv_count(csv, k);
            put_numbers(csv, p->sample.point + 3 * k, (size_t)m->run->plan->dim);
        }
        put_numbers(csv, m->value[i] + k * width, points ? width : 1);
        csv_end_row(csv);
    }
    return csv_commit(csv, e);
}

static double distance(const double *a, const double *b)
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

/* value[n][width], reference[n][n_of]: of n bins or points. */
static int put_profile(struct measures *m, size_t i, const double *value, size_t width,
                       const double *reference, size_t n, struct error *e)
{
    const struct scene_profile *p = &m->run->plan->scene->profile[i];
    struct csv *csv = &m->profile[i].csv;
    size_t unused;
    for (size_t k = 0; k < n; k++) {
        const double *point = p->sample.point + 3 * k;
        begin_row(m, csv);
        if (p->bins) {
            csv_number(csv, profile_middle(p, k));
        } else {
            csv_number(csv, distance(point, p->sample.point));
            put_numbers(csv, point, (size_t)m->run->plan->dim);
        }
        put_numbers(csv, value + k * width, width);
        for (size_t q = 0; q < p->sample.n_of; q++)
            if (plan_profile_gives(m->run->plan, i, q, &unused))
                csv_number(csv, reference[k * p->sample.n_of + q]);
        csv_end_row(csv);
    }
    return csv_commit(csv, e);
}

static int take_profile(struct measures *m, size_t i, struct error *e)
{
    const struct scene_profile *p = &m->run->plan->scene->profile[i];
    const size_t n_of = p->sample.n_of, n = p->bins ? p->bins : p->sample.n_point;
    const size_t width = p->bins ? 2 * n_of + 1 : n_of + 1;
    if (is_written(m, &m->profile[i]))
        return 0;
    double *value = malloc(n * (width + n_of) * sizeof *value);
    if (!value)
        return error_memory(e, "a profile", n * width * sizeof *value);
    double *reference = value + n * width;
    int status =
        p->bins ? profile_bins(m->run, p, value, e) : sample_take(m->run, &p->sample, value, e);
    if (!status && p->reference.node)
        status = profile_reference(m->run, i, n, reference, e);
    if (!status && run_speaks(m->run))
        status = put_profile(m, i, value, width, reference, n, e);
    free(value);
    return status;
}

/* -- The end ----------------------------------------------------------------------------------- */

static int compare_course(const struct measures *m, size_t i, struct summary_course *out,
                          struct error *e)
{
    const struct scene_probe *p = &m->run->plan->scene->probe[i];
    const struct scene_reference *q = &p->reference;
    const struct table *t = &m->run->plan->probe_table[i];
    const char *const names[2] = {"time", p->kind != PROBE_POINTS ? "value"
                                          : q->of                 ? q->of
                                                                  : p->sample.of[0]};
    const size_t time = q->time ? (size_t)table_find(t, q->time) : 0;
    const size_t column = q->value ? (size_t)table_find(t, q->value) : time ? 0 : 1;
    const struct course reference = {.time = t->column[time].value,
                                     .value = t->column[column].value,
                                     .n = t->n,
                                     .scale_time = q->scale_time,
                                     .scale = q->scale};
    double *value[2];
    size_t n;
    struct course_norms norms;
    if (csv_read_two(m->probe[i].csv.path, names, value, &n, e))
        return -1;
    const struct course f = {
        .time = value[0], .value = value[1], .n = n, .scale_time = 1.0, .scale = 1.0};
    const int status = course_compare(&f, &reference, &norms, e);
    free(value[0]);
    free(value[1]);
    *out = (struct summary_course){plan_table_source(q->table),
                                   norms.begin,
                                   norms.end,
                                   norms.l1,
                                   norms.l1_rel,
                                   norms.l2,
                                   norms.l2_rel,
                                   norms.linf};
    return status;
}

static int finish_probe(struct measures *m, size_t i, struct error *e)
{
    const struct scene_probe *p = &m->run->plan->scene->probe[i];
    const struct series *s = &m->probe[i];
    const bool points = p->kind == PROBE_POINTS;
    m->probe_end[i] = (struct summary_probe){.name = p->name,
                                             .value = m->value[i][0],
                                             .expected = p->expected,
                                             .file = s->file,
                                             .rows = s->on_file ? s->csv.rows - 1 : 0};
    if (points) {
        m->probe_end[i].of = m->name[i];
        m->probe_end[i].n_of = p->sample.n_of + 1;
        m->probe_end[i].n_point = p->sample.n_point;
        m->probe_end[i].values = m->value[i];
    }
    return p->reference.table ? compare_course(m, i, &m->probe_end[i].course, e) : 0;
}

static int finish(struct measures *m, struct error *e)
{
    const struct scene *s = m->run->plan->scene;
    size_t n = 0;
    if (!run_speaks(m->run))
        return 0;
    for (size_t i = 0; i < s->n_compare; i++)
        n += m->errors_of[i].n;
    free(m->error);
    m->n_error = 0;
    m->error = calloc(n + 1, sizeof *m->error);
    if (!m->error)
        return error_memory(e, "errors", n * sizeof *m->error);
    for (size_t i = 0; i < s->n_compare; i++)
        for (size_t k = 0; k < m->errors_of[i].n; k++)
            m->error[m->n_error++] = m->errors_of[i].error[k];
    for (size_t i = 0; i < s->n_probe; i++)
        if (finish_probe(m, i, e))
            return -1;
    for (size_t i = 0; i < s->n_profile; i++)
        m->profile_end[i] = (struct summary_profile){s->profile[i].name, m->profile[i].file,
                                                     m->profile[i].csv.rows - 1};
    return 0;
}

void measures_summary(const struct measures *m, struct summary *s)
{
    const struct scene *scene = m->run->plan->scene;
    s->error = m->error;
    s->n_error = m->n_error;
    s->probe = m->probe_end;
    s->n_probe = scene->n_probe;
    s->profile = m->profile_end;
    s->n_profile = scene->n_profile;
}

/* -- All --------------------------------------------------------------------------------------- */

static int take_one(struct measures *m, int kind, size_t i, bool end, struct error *e)
{
    return kind == 0   ? take_compare(m, i, end, e)
           : kind == 1 ? take_probe(m, i, e)
                       : take_profile(m, i, e);
}

int measures_take(struct measures *m, enum measures_moment moment, struct error *e)
{
    const double started = omp_get_wtime();
    const bool end = moment == MEASURES_END;
    int status = 0;
    for (int kind = 0; m->any && kind < 3; kind++) {
        struct series *list;
        const size_t n = n_series(m, &list, kind);
        for (size_t i = 0; i < n && !status; i++) {
            const bool always = end || (moment == MEASURES_START && kind > 0 && list[i].on_file);
            if (!always && !(moment == MEASURES_START ? listed(m, &list[i], m->run->time)
                                                      : is_due(m, &list[i])))
                continue;
            status = take_one(m, kind, i, end, e);
            passed(m, &list[i], m->run->time);
            list[i].last = m->run->step;
        }
    }
    if (!status && end)
        status = finish(m, e);
    m->run->cost.io += omp_get_wtime() - started;
    return status;
}

int measures_sync(struct measures *m, struct error *e)
{
    int status = csv_sync(&m->errors, e);
    for (int kind = 0; m->any && kind < 3; kind++) {
        struct series *list;
        const size_t n = n_series(m, &list, kind);
        for (size_t i = 0; i < n && !status; i++)
            status = csv_sync(&list[i].csv, e);
    }
    return status;
}

int measures_close(struct measures *m, struct error *e)
{
    int status = csv_close(&m->errors, e);
    for (int kind = 0; m->run && m->profile && kind < 3; kind++) {
        struct series *list;
        const size_t n = n_series(m, &list, kind);
        for (size_t i = 0; list && i < n; i++)
            if (csv_close(&list[i].csv, status ? NULL : e))
                status = -1;
    }
    return status;
}

void measures_free(struct measures *m)
{
    const struct scene *s = m->run ? m->run->plan->scene : NULL;
    for (size_t i = 0; s && m->errors_of && i < s->n_compare; i++)
        compare_free(m->errors_of[i].error, m->errors_of[i].n);
    for (size_t i = 0; s && i < s->n_probe; i++) {
        if (m->value)
            free(m->value[i]);
        if (m->name)
            free(m->name[i]);
        if (m->probe)
            free(m->probe[i].file);
    }
    for (size_t i = 0; s && m->profile && i < s->n_profile; i++)
        free(m->profile[i].file);
    free(m->compare);
    free(m->errors_of);
    free(m->probe);
    free(m->value);
    free(m->name);
    free(m->profile);
    free(m->error);
    free(m->probe_end);
    free(m->profile_end);
    *m = (struct measures){0};
}
