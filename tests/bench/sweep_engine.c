/* sweep_engine.c -- see sweep_engine.h. */
#include "sweep_engine.h"
#include "bench.h"
#include "registry/kernel_form.h"
#include "registry/loader.h"

#include <math.h>
#include <omp.h>
#include <string.h>
#include <time.h>

const double engine_skin[ENGINE_SKINS] = {0.0, 0.1};

#define SUMS (SPH_DST_SUM | SPH_DST_MAX | SPH_DST_MIN)

static void must(int status, const struct error *e)
{
    if (status < 0) {
        fprintf(stderr, "%s\n", e->text);
        exit(1);
    }
}

void engine_load(struct registry *r, const char *plugin)
{
    const char *build = getenv("top_builddir");
    char path[4096];
    struct error e;

    snprintf(path, sizeof(path), "%s/plugins/.libs/%s.so", build ? build : ".", plugin);
    must(loader_load(r, path, &e), &e);
}

static const struct entry *find(const struct registry *r, enum kind kind, const char *name)
{
    const struct entry *x = registry_find(r, kind, name);

    if (!x) {
        fprintf(stderr, "no %s \"%s\"\n", kind_label[kind], name);
        exit(1);
    }
    return x;
}

/* -- Particles ---------------------------------------------------------------------------------- */

static double *plane(const struct engine *g, int column, uint32_t c)
{
    return (double *)g->p.column[column].data + c * g->p.column[column].plane;
}

static int add(struct engine *g, const char *name, uint32_t type)
{
    struct error e;
    const int column = particles_add(&g->p, name, "", "", type, &e);

    must(column, &e);
    if (column_is_real(&g->p.column[column]) && !g->p.column[column].mirror)
        must(particles_mirror(&g->p, column, &e), &e);
    return column;
}

static void add_scalar(struct engine *g, const char *name, const double *from, double constant)
{
    double *to = plane(g, add(g, name, SPH_SCALAR), 0);

    for (size_t i = 0; i < g->p.n; i++)
        to[i] = from ? from[g->was[i]] : constant;
}

/* Columns may have moved. */
static void look_at(struct engine *g)
{
    for (int c = 0; c < g->p.dim; c++)
        g->cloud.x[c] = plane(g, g->x, (uint32_t)c);
    g->cloud.h = plane(g, g->h, 0);
}

void engine_make(struct engine *g, struct registry *r, const struct pair_case *fluid,
                 const char *kernel)
{
    struct error e;

    memset(g, 0, sizeof(*g));
    g->registry = r;
    must(kernel_form_make(&g->kernel, entry_kernel(find(r, KIND_KERNEL, kernel)), fluid->dim, &e),
         &e);
    g->cloud = (struct cloud){.dim = fluid->dim,
                              .n = fluid->n,
                              .x = {fluid->x[0], fluid->x[1], fluid->x[2]},
                              .h = fluid->h,
                              .scale = g->kernel.support};
    g->was = bench_need(malloc(fluid->n * sizeof(*g->was)));
    must(cell_order(&g->cloud, NULL, cell_best(&g->cloud), 1, g->was, &e), &e);
    must(particles_init(&g->p, "fluid", fluid->dim, &e), &e);
    must(particles_resize(&g->p, fluid->n, 0, &e), &e);
    g->x = add(g, "x", SPH_VECTOR);
    const int v = add(g, "v", SPH_VECTOR);
    for (uint32_t c = 0; c < (uint32_t)fluid->dim; c++) {
        g->place[c] = bench_need(malloc(fluid->n * sizeof(double)));
        for (size_t i = 0; i < fluid->n; i++) {
            g->place[c][i] = fluid->x[c][g->was[i]];
            plane(g, v, c)[i] = fluid->v[c][g->was[i]];
        }
    }
    add_scalar(g, "h", fluid->h, 0.0);
    g->h = particles_find(&g->p, "h");
    add_scalar(g, "m", fluid->m, 0.0);
    add_scalar(g, "rho", fluid->rho, 0.0);
    add_scalar(g, "p", fluid->p, 0.0);
    add_scalar(g, "p_rho2", NULL, 0.0);
    for (size_t i = 0; i < g->p.n; i++) /* as wcsph-pressure has it */
        plane(g, particles_find(&g->p, "p_rho2"), 0)[i] =
            fluid->p[g->was[i]] / (fluid->rho[g->was[i]] * fluid->rho[g->was[i]]);
    add_scalar(g, "cs", NULL, fluid->cs);
    engine_place(g, 0.0);
}

void engine_free(struct engine *g)
{
    for (int k = 0; k < 2 * ENGINE_SKINS; k++)
        group_list_fini(&g->list[k / ENGINE_SKINS][k % ENGINE_SKINS]);
    for (int c = 0; c < 3; c++)
        free(g->place[c]);
    free(g->was);
    kernel_form_fini(&g->kernel);
    particles_fini(&g->p);
}

void engine_use_make(struct engine_use *u, struct engine *g, const char *function)
{
    const sph_function *f = entry_function(find(g->registry, KIND_FUNCTION, function));
    struct error e = {.text = "too many properties"};

    u->function = f;
    must(f->item->props.count <= ENGINE_PROPS ? 0 : -1, &e);
    must(config_init(&u->config, f->item, &e), &e);
    must(config_check(&u->config, &e), &e);
    for (uint32_t k = 0; k < f->item->props.count; k++) {
        const sph_prop *p = list_at(&f->item->props, k);
        u->column[k] = add(g, p->name, p->type);
    }
    look_at(g);
}

void engine_use_free(struct engine_use *u)
{
    config_fini(&u->config);
}

/* -- Places, mirrors ---------------------------------------------------------------------------- */

void engine_place(struct engine *g, double offset)
{
    struct error e;

    look_at(g);
    for (int c = 0; c < g->p.dim; c++) {
        for (size_t i = 0; i < g->p.n; i++)
            plane(g, g->x, (uint32_t)c)[i] = g->place[c][i] + offset;
    }
    for (int k = 0; k < 2 * ENGINE_SKINS; k++) {
        const int symmetric = k / ENGINE_SKINS, skin = k % ENGINE_SKINS;
        must(group_list_make(&g->list[symmetric][skin], &g->cloud, &g->cloud, symmetric == 1,
                             engine_skin[skin], NULL, 1, &e),
             &e);
    }
    /* It counts each particle as its own neighbour, too. */
    const uint64_t count = group_list_count(&g->list[1][0], &g->cloud, &g->cloud, 1);
    g->pairs = (double)(count - g->p.n);
    engine_mirror(g);
}

/* As core/run/mirrors.c does it: whole numbers of a quantum about the centre, with room for what moves
 * and for ghosts. */
static void mirror_places(struct engine *g)
{
    double longest = 0.0, centre[3] = {0};

    for (int c = 0; c < g->p.dim; c++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < g->p.n; i++) {
            low = fmin(low, g->cloud.x[c][i]);
            high = fmax(high, g->cloud.x[c][i]);
        }
        centre[c] = low + 0.5 * (high - low);
        longest = fmax(longest, high - low);
    }
    g->quantum = (1.05 * longest + 4.0 * g->cloud.scale * g->cloud.h[0]) / 2147483648.0;
    const struct column *x = &g->p.column[g->x];
    for (int c = 0; c < g->p.dim; c++) {
        int32_t *to = (int32_t *)x->mirror + (size_t)c * x->plane;
        for (size_t i = 0; i < g->p.n; i++)
            to[i] = (int32_t)lrint((g->cloud.x[c][i] - centre[c]) / g->quantum);
    }
}

void engine_mirror(struct engine *g)
{
    for (size_t k = 0; k < g->p.n_column; k++) {
        const struct column *c = &g->p.column[k];
        for (uint32_t q = 0; c->mirror && q < c->ncomp; q++) {
            float *to = (float *)c->mirror + q * c->plane;
            for (size_t i = 0; i < g->p.n; i++)
                to[i] = (float)column_get(c, q, i);
        }
    }
    look_at(g);
    mirror_places(g);
}

/* -- Sweeps ------------------------------------------------------------------------------------- */

static sph_column column_for(const struct engine *g, uint32_t real, int column)
{
    return real == SPH_F32 ? particles_column4(&g->p, column) : particles_column(&g->p, column);
}

/* A batch over all, and its columns. */
struct work {
    sph_batch b;
    const sph_function *function;
    sph_column dst[ENGINE_PROPS], src[ENGINE_PROPS];
};

static void work_make(struct work *w, const struct engine *g, const struct engine_use *u,
                      const struct engine_sweep *s)
{
    const sph_function *f = u->function;
    const struct group_list *list = &g->list[f->reach == SPH_SYMMETRIC][s->skin];

    w->function = f;
    for (uint32_t k = 0; k < f->item->props.count; k++) {
        const sph_prop *p = list_at(&f->item->props, k);
        w->dst[k] = column_for(g, s->real, u->column[k]);
        w->src[k] = p->access & SPH_SRC_READ ? w->dst[k] : (sph_column){0};
    }
    w->b = (sph_batch){.size = (uint32_t)sizeof(sph_batch),
                       .dim = (uint32_t)g->p.dim,
                       .real = s->real,
                       .lanes = SPH_LANES,
                       .count = g->p.n,
                       .n_dst = g->p.n,
                       .n_src = g->p.n,
                       .begin = list->begin,
                       .span = list->span,
                       .list = list->step,
                       .same = 1,
                       .path = s->path,
                       .quantum = s->real == SPH_F32 ? g->quantum : 0.0,
                       .uniform_h = s->uniform_h,
                       .x_dst = column_for(g, s->real, g->x),
                       .x_src = column_for(g, s->real, g->x),
                       .h_dst = column_for(g, s->real, g->h),
                       .h_src = column_for(g, s->real, g->h),
                       .dst = w->dst,
                       .src = w->src,
                       .n_columns = f->item->props.count,
                       .n_params = f->item->params.count,
                       .param = u->config.value,
                       .kernel = &g->kernel,
                       .host = &g->registry->host};
}

static void reset(const struct work *w, uint64_t first, uint64_t count)
{
    for (uint32_t k = 0; k < w->b.n_columns; k++) {
        const sph_prop *p = list_at(&w->function->item->props, k);
        const sph_column *c = &w->dst[k];
        for (uint32_t q = 0; (p->access & SUMS) && q < c->ncomp; q++) {
            const uint64_t at = q * c->plane + first;
            for (uint64_t i = at; i < at + count; i++) {
                if (w->b.real == SPH_F32)
                    ((float *)c->data)[i] = (float)p->start;
                else
                    ((double *)c->data)[i] = p->start;
            }
        }
    }
}

static sph_status sweep(const struct work *w, uint64_t chunk, int threads)
{
    const long n = (long)((w->b.n_dst + chunk - 1) / chunk);
    sph_status worst = SPH_OK;

#pragma omp parallel for schedule(dynamic) num_threads(threads) reduction(min : worst)
    for (long k = 0; k < n; k++) {
        sph_batch b = w->b;
        b.first = (uint64_t)k * chunk;
        b.count = b.n_dst - b.first < chunk ? b.n_dst - b.first : chunk;
        reset(w, b.first, b.count);
        const sph_status status = w->function->run(&b);
        worst = status < worst ? status : worst;
    }
    return worst;
}

/* The thread's own time: that of the process holds what other threads wait, too. */
static double cpu(void)
{
    struct timespec t;

    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

struct engine_time engine_run(const struct engine *g, const struct engine_sweep *s)
{
    struct work work[2];
    sph_status status = SPH_OK;
    struct error e = {.text = "a sweep failed"};
    int n = 0;

    for (; n < 2 && s->use[n]; n++)
        work_make(&work[n], g, s->use[n], s);
    const double begin = omp_get_wtime(), begin_cpu = cpu();
    for (int k = 0; k < n && status == SPH_OK; k++)
        status = sweep(&work[k], s->chunk ? s->chunk : g->p.n, s->threads);
    const struct engine_time t = {cpu() - begin_cpu, omp_get_wtime() - begin};
    must(status, &e);
    return t;
}

void engine_finish(const struct engine *g, const struct engine_use *u)
{
    const struct engine_sweep s = {.use = {u}, .real = SPH_F64};
    struct error e = {.text = "a function failed after its sweep"};
    struct work w;

    work_make(&w, g, u, &s);
    must(u->function->after ? u->function->after(&w.b) : 0, &e);
}

double engine_value(const struct engine *g, int column, uint32_t real, uint32_t c, size_t i)
{
    const struct column *from = &g->p.column[column];

    return real == SPH_F32 ? (double)((const float *)from->mirror)[c * from->plane + i]
                           : column_get(from, c, i);
}

double engine_bytes(const struct engine *g, const struct engine_sweep *s)
{
    const double size = s->real == SPH_F32 ? sizeof(float) : sizeof(double);
    double bytes = 0.0;

    for (int n = 0; n < 2 && s->use[n]; n++) {
        const sph_function *f = s->use[n]->function;
        const struct group_list *list = &g->list[f->reach == SPH_SYMMETRIC][s->skin];
        bytes += size * (g->p.dim + 1) + (double)group_list_bytes(list) / (double)g->p.n;
        for (uint32_t k = 0; k < f->item->props.count; k++) {
            const sph_prop *p = list_at(&f->item->props, k);
            const int times = p->access & SUMS ? 2 : p->access & SPH_SRC_READ ? 1 : 0;
            bytes += times * size * property_ncomp(p->type, g->p.dim);
        }
    }
    return bytes;
}
