/* call_per_pair_sweep.c -- the loops that are measured, and the same particles without order. */
#include "call_per_pair_body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* What the pair's function is given, or 0 if the pair is none. */
static inline int gather(const struct pair_case *c, const double *push, uint32_t i, uint32_t j,
                         int dim, double *in)
{
    double r2 = 0.0;

    for (int k = 0; k < dim; k++) {
        in[PAIR_DX + k] = c->x[k][i] - c->x[k][j];
        r2 += in[PAIR_DX + k] * in[PAIR_DX + k];
    }
    const double h = 0.5 * (c->h[i] + c->h[j]);
    if (j == i || r2 >= 4.0 * h * h)
        return 0;
    for (int k = 0; k < dim; k++)
        in[PAIR_DV + k] = c->v[k][i] - c->v[k][j];
    in[PAIR_R] = sqrt(r2);
    in[PAIR_H] = h;
    in[PAIR_HINV] = 1.0 / h;
    in[PAIR_M] = c->m[j];
    in[PAIR_RHO_I] = c->rho[i];
    in[PAIR_RHO_J] = c->rho[j];
    in[PAIR_PUSH_I] = push[i];
    in[PAIR_PUSH_J] = push[j];
    in[PAIR_CS] = c->cs;
    in[PAIR_ALPHA] = c->alpha;
    in[PAIR_BETA] = c->beta;
    return 1;
}

static void push(const struct pair_case *c, double *out)
{
    for (uint32_t i = 0; i < c->n; i++)
        out[i] = c->p[i] / (c->rho[i] * c->rho[i]);
}

static inline void store(const struct pair_rates *r, uint32_t i, int dim, const double *out)
{
    for (int k = 0; k < dim; k++)
        r->a[k][i] = out[PAIR_A + k];
    r->drho[i] = out[PAIR_DRHO];
}

size_t pair_count(const struct pair_case *c)
{
    double in[PAIR_IN];
    size_t count = 0;

    for (uint32_t i = 0; i < c->n; i++) {
        for (size_t k = c->first[i]; k < c->first[i + 1]; k++)
            count += (size_t)gather(c, c->p, i, c->neighbour[k], c->dim, in);
    }
    return count;
}

double pair_sweep_called(const struct pair_case *c, const struct pair_rates *r, pair_fn pair,
                         pair_kernel_fn kernel)
{
    const double start = now();
    double in[PAIR_IN];

    push(c, r->work);
    for (uint32_t i = 0; i < c->n; i++) {
        double out[PAIR_OUT] = {0};
        for (size_t k = c->first[i]; k < c->first[i + 1]; k++) {
            if (gather(c, r->work, i, c->neighbour[k], c->dim, in))
                pair(in, out, kernel);
        }
        store(r, i, c->dim, out);
    }
    return now() - start;
}

/* Copies of what is told of the arrays: the results' stores cannot change them. */
static inline void inlined(const struct pair_case *told, const struct pair_rates *r, int dim)
{
    const struct pair_case copy = *told, *const c = &copy;

    for (uint32_t i = 0; i < c->n; i++) {
        double in[PAIR_IN], out[PAIR_OUT] = {0};
        for (size_t k = c->first[i]; k < c->first[i + 1]; k++) {
            if (gather(c, r->work, i, c->neighbour[k], dim, in))
                pair_body(in, out, pair_wendland(in[PAIR_R], in[PAIR_HINV], dim), dim);
        }
        store(r, i, dim, out);
    }
}

double pair_sweep_inlined(const struct pair_case *c, const struct pair_rates *r)
{
    const double start = now();

    push(c, r->work);
    if (c->dim == 2)
        inlined(c, r, 2);
    else
        inlined(c, r, 3);
    return now() - start;
}

/* A case and its arrays. */
struct shuffled {
    struct pair_case c;
    uint32_t *was, *place; /* particle k was was[k]; what was i is at place[i] */
    size_t *first;
    uint32_t *neighbour;
    double *columns;
};

void pair_shuffle_free(struct pair_case *c)
{
    struct shuffled *s = (struct shuffled *)c; /* its first member */

    if (!s)
        return;
    free(s->was);
    free(s->place);
    free(s->first);
    free(s->neighbour);
    free(s->columns);
    free(s);
}

static void permute(struct shuffled *s, uint64_t seed)
{
    for (uint32_t k = 0; k < s->c.n; k++)
        s->was[k] = k;
    for (uint32_t k = s->c.n; k > 1; k--) {
        seed = seed * 6364136223846793005ull + 1442695040888963407ull;
        const uint32_t other = (uint32_t)((seed >> 33) % k), held = s->was[k - 1];
        s->was[k - 1] = s->was[other];
        s->was[other] = held;
    }
    for (uint32_t k = 0; k < s->c.n; k++)
        s->place[s->was[k]] = k;
}

static void renumber(struct shuffled *s, const struct pair_case *c)
{
    size_t end = 0;

    for (uint32_t k = 0; k < c->n; k++) {
        const uint32_t i = s->was[k];
        s->first[k] = end;
        for (size_t l = c->first[i]; l < c->first[i + 1]; l++)
            s->neighbour[end++] = s->place[c->neighbour[l]];
    }
    s->first[c->n] = end;
}

struct pair_case *pair_shuffle(const struct pair_case *c, uint64_t seed, const uint32_t **was)
{
    const size_t n = c->n;
    struct shuffled *s = calloc(1, sizeof(*s));

    if (!s)
        return NULL;
    s->c = *c;
    s->was = malloc(n * sizeof(*s->was));
    s->place = malloc(n * sizeof(*s->place));
    s->first = malloc((n + 1) * sizeof(*s->first));
    s->neighbour = malloc(c->first[n] * sizeof(*s->neighbour));
    s->columns = malloc(10 * n * sizeof(*s->columns));
    if (!s->was || !s->place || !s->first || !s->neighbour || !s->columns) {
        pair_shuffle_free(&s->c);
        return NULL;
    }
    permute(s, seed);
    renumber(s, c);
    s->c.first = s->first;
    s->c.neighbour = s->neighbour;
    const double **column[10] = {&s->c.x[0], &s->c.x[1], &s->c.x[2], &s->c.v[0], &s->c.v[1],
                                 &s->c.v[2], &s->c.m,    &s->c.rho,  &s->c.p,    &s->c.h};
    for (size_t a = 0; a < 10; a++) {
        if (!*column[a])
            continue; /* the third component of two */
        for (size_t k = 0; k < n; k++)
            s->columns[a * n + k] = (*column[a])[s->was[k]];
        *column[a] = s->columns + a * n;
    }
    *was = s->was;
    return &s->c;
}
