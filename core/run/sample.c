/* run/sample.c -- values at points by the kernel: see sample.h. Reads particles, touches nothing. */
#include "run/sample.h"
#include "plan/measured.h"
#include "registry/kernel_form.h"
#include "run/sums.h"
#include <stdlib.h>
#include <string.h>

#define BLOCK 128
/* Exact sums are large: those of so many values at a time. */
#define VALUES_EXACT 20000
/* Whether a particle that just touches a point counts is decided by its own distance alone, whatever block it
 * stands in. */
#define NEARLY (1.0 + 1e-12)

/* Where the particles of a block, or of an array, are, and how far they reach. */
struct bounds {
    double min[3], max[3], reach;
};

/* One array as points see it. */
struct cloud_of {
    const struct plan_array *array;
    int rho;
    struct measured *of; /* [n_of] */
    struct bounds all, *block;
    size_t n_block;
};

/* A point as the particles' images see it: the point moved to where they are. */
struct image {
    double x[3];
    double shift[3];   /* periodic: of particles, to see them from the point */
    double turn[3];    /* mirrored axes: x_image = turn - x */
    unsigned mirrored; /* a bit an axis */
};

static void bounds_add(struct bounds *b, const double x[3], double reach)
{
    for (int c = 0; c < 3; c++) {
        b->min[c] = fmin(b->min[c], x[c]);
        b->max[c] = fmax(b->max[c], x[c]);
    }
    b->reach = fmax(b->reach, reach);
}

static const struct bounds nowhere = {
    {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 0.0};

static bool within_reach(const struct bounds *b, const double x[3])
{
    double d2 = 0.0;
    for (int c = 0; c < 3; c++) {
        const double d = x[c] < b->min[c]   ? b->min[c] - x[c]
                         : x[c] > b->max[c] ? x[c] - b->max[c]
                                            : 0.0;
        d2 += d * d;
    }
    return d2 < b->reach * b->reach;
}

static void cloud_fini(struct cloud_of *c)
{
    free(c->of);
    free(c->block);
}

static int cloud_init(struct cloud_of *c, const struct run *r, const struct scene_sample *s,
                      const char *name, struct error *e)
{
    const struct plan *plan = r->plan;
    bool missing;
    for (size_t a = 0; a < plan->n_array; a++)
        if (strcmp(plan->array[a].p.name, name) == 0)
            c->array = &plan->array[a];
    const struct particles *p = &c->array->p;
    c->rho = particles_find(p, "rho");
    c->n_block = (p->n + BLOCK - 1) / BLOCK;
    c->of = calloc(s->n_of + 1, sizeof *c->of);
    c->block = malloc((c->n_block + 1) * sizeof *c->block);
    if (!c->of || !c->block)
        return error_memory(e, "values at points", (c->n_block + 1) * sizeof *c->block);
    for (size_t k = 0; k < s->n_of; k++)
        measured_find(p, s->of[k], &c->of[k], &missing);
#pragma omp parallel for schedule(static) num_threads(r->threads) if (c->n_block > 64)
    for (size_t b = 0; b < c->n_block; b++) {
        c->block[b] = nowhere;
        for (size_t i = b * BLOCK; i < (b + 1) * BLOCK && i < p->n; i++) {
            double x[3];
            measured_place(p, c->array->position, i, x);
            bounds_add(&c->block[b], x,
                       plan->kernel.support * column_get(&p->column[c->array->smoothing], 0, i) *
                           (plan->strict ? NEARLY : 1.0));
        }
    }
    c->all = nowhere;
    for (size_t b = 0; b < c->n_block; b++) {
        bounds_add(&c->all, c->block[b].min, c->block[b].reach);
        bounds_add(&c->all, c->block[b].max, c->block[b].reach);
    }
    return 0;
}

/* Of the 3^dim combinations the k-th, a digit an axis: as it is, across the low side, across the high one.
 * false: one of these sides makes no images. */
static bool image_make(const struct box *box, int dim, const double *point, int k,
                       struct image *out)
{
    *out = (struct image){.mirrored = 0};
    for (int c = 0; c < dim; c++, k /= 3) {
        const int digit = k % 3;
        out->x[c] = point[c];
        if (digit == 0)
            continue;
        if (!box->bounded || box->side[c][digit - 1] == SIDE_OPEN)
            return false;
        if (box->side[c][digit - 1] == SIDE_PERIODIC) {
            out->shift[c] = (digit == 1 ? -1.0 : 1.0) * (box->max[c] - box->min[c]);
            out->x[c] = point[c] - out->shift[c];
        } else {
            out->turn[c] = 2.0 * (digit == 1 ? box->min[c] : box->max[c]);
            out->x[c] = out->turn[c] - point[c];
            out->mirrored |= 1u << c;
        }
    }
    return true;
}

/* Adds what particles [first, end) give to the sums at a point: V W f of each property, then V W; from sum `at` on. */
static void add_block(const struct run *r, const struct cloud_of *c, const struct scene_sample *s,
                      const struct image *image, size_t first, size_t end, struct sums *sum,
                      size_t at)
{
    const struct particles *p = &c->array->p;
    const sph_kernel_form *kernel = &r->plan->kernel;
    for (size_t i = first; i < end; i++) {
        double x[3], d2 = 0.0;
        measured_place(p, c->array->position, i, x);
        for (int k = 0; k < p->dim; k++)
            d2 += (image->x[k] - x[k]) * (image->x[k] - x[k]);
        const double h = column_get(&p->column[c->array->smoothing], 0, i);
        const double rho = column_get(&p->column[c->rho], 0, i), q = sqrt(d2) / h;
        if (!(q < kernel->support) || !(rho > 0.0))
            continue;
        const double hd = p->dim == 1 ? h : p->dim == 2 ? h * h : h * h * h;
        const double w =
            column_get(&p->column[c->array->mass], 0, i) / rho * (kernel_form_w(kernel, q) / hd);
        for (int k = 0; k < p->dim; k++)
            x[k] = image->mirrored >> k & 1u ? image->turn[k] - x[k] : x[k] + image->shift[k];
        for (size_t k = 0; k < s->n_of; k++)
            sums_add(sum, at + k,
                     w * measured_value(p, &c->of[k], &s->about, i, x, image->mirrored));
        sums_add(sum, at + s->n_of, w);
    }
}

static void take_point(const struct run *r, const struct cloud_of *cloud,
                       const struct scene_sample *s, const double *point, struct sums *sum,
                       size_t at)
{
    const int dim = r->plan->dim, images = dim == 1 ? 3 : dim == 2 ? 9 : 27;
    for (size_t a = 0; a < s->n_array; a++) {
        const struct cloud_of *c = &cloud[a];
        for (int k = 0; k < images; k++) {
            struct image image;
            if (!image_make(&r->plan->scene->box, dim, point, k, &image) ||
                !within_reach(&c->all, image.x))
                continue;
            for (size_t b = 0; b < c->n_block; b++) {
                const size_t end =
                    (b + 1) * BLOCK < c->array->p.n ? (b + 1) * BLOCK : c->array->p.n;
                if (within_reach(&c->block[b], image.x))
                    add_block(r, c, s, &image, b * BLOCK, end, sum, at);
            }
        }
    }
}

/* Of points [first, end). */
static int take_points(const struct run *r, const struct cloud_of *cloud,
                       const struct scene_sample *s, size_t first, size_t end, double *value,
                       struct error *e)
{
    const size_t width = s->n_of + 1;
    struct sums sum;
    int status = sums_open(&sum, r, (end - first) * width, e);
    if (!status) {
#pragma omp parallel for schedule(dynamic, 1) num_threads(r->threads) if (end - first > 1)
        for (size_t i = first; i < end; i++)
            take_point(r, cloud, s, s->point + 3 * i, &sum, (i - first) * width);
        status = sums_share(&sum, r, e);
    }
    for (size_t i = first; !status && i < end; i++) {
        const double *of = sum.value + (i - first) * width, all = of[s->n_of];
        for (size_t k = 0; k < s->n_of; k++)
            value[i * width + k] = s->plain ? of[k] : all < SAMPLE_LEAST ? NAN : of[k] / all;
        value[i * width + s->n_of] = all;
    }
    sums_close(&sum);
    return status;
}

int sample_take(const struct run *r, const struct scene_sample *s, double *value, struct error *e)
{
    struct cloud_of *cloud = calloc(s->n_array + 1, sizeof *cloud);
    int status = cloud ? 0 : error_memory(e, "values at points", s->n_array * sizeof *cloud);
    for (size_t a = 0; a < s->n_array && !status; a++)
        status = cloud_init(&cloud[a], r, s, s->array[a], e);
    const size_t most = r->plan->strict ? VALUES_EXACT / (s->n_of + 1) + 1 : s->n_point;
    for (size_t first = 0; first < s->n_point && !status; first += most)
        status = take_points(r, cloud, s, first,
                             s->n_point - first < most ? s->n_point : first + most, value, e);
    for (size_t a = 0; cloud && a < s->n_array; a++)
        cloud_fini(&cloud[a]);
    free(cloud);
    return status;
}
