/* shared.c -- see exact.h: the loop over places, messages, roots. */
#include "exact.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Where a field lies in a point. */
static const struct {
    const char *name;
    size_t offset;
} fields[] = {
    {"x", offsetof(struct exact_point, x)}, {"rho", offsetof(struct exact_point, rho)},
    {"p", offsetof(struct exact_point, p)}, {"u", offsetof(struct exact_point, u)},
    {"v", offsetof(struct exact_point, v)}, {"d", offsetof(struct exact_point, d)},
};
enum { N_FIELDS = sizeof(fields) / sizeof(fields[0]) };

/* A plane of the batch, and its number in a point. */
struct plane {
    double *data;
    size_t offset;
    int read;
};

/* Those that the host wants, at most three a property. */
static size_t planes_of(const sph_batch *b, const sph_item *item, struct plane *out)
{
    const sph_prop *prop = item->props.data;
    size_t n = 0;

    for (uint32_t k = 0; k < item->props.count; k++) {
        const uint32_t count = prop[k].type == SPH_VECTOR ? b->dim : 1;
        size_t f = 0;
        while (strcmp(fields[f].name, prop[k].name) != 0)
            f++;
        for (uint32_t c = 0; c < count && b->dst[k].data; c++)
            out[n++] = (struct plane){(double *)b->dst[k].data + c * b->dst[k].plane,
                                      fields[f].offset + c * sizeof(double),
                                      !(prop[k].access & SPH_DST_WRITE)};
    }
    return n;
}

sph_status exact_each(const sph_batch *b, const sph_item *item, exact_at at, const void *of)
{
    struct plane plane[3 * N_FIELDS];

    if (b->real != SPH_F64)
        return exact_fail(b->host, SPH_E_UNKNOWN, "wants columns of doubles");

    const size_t n = planes_of(b, item, plane);

    for (uint64_t i = b->first; i < b->first + b->count; i++) {
        struct exact_point q = {.rho = 0};
        for (size_t k = 0; k < n; k++)
            if (plane[k].read)
                memcpy((char *)&q + plane[k].offset, plane[k].data + i, sizeof(double));
        at(of, &q);
        for (size_t k = 0; k < n; k++)
            if (!plane[k].read)
                memcpy(plane[k].data + i, (char *)&q + plane[k].offset, sizeof(double));
    }
    return SPH_OK;
}

sph_status exact_fail(const sph_host *host, sph_status status, const char *format, ...)
{
    char text[400];
    va_list list;

    va_start(list, format);
    vsnprintf(text, sizeof(text), format, list);
    va_end(list);
    return host->fail(host, status, text);
}

void exact_free(const sph_host *host, void *state)
{
    (void)host;
    free(state);
}

double exact_root(exact_function f, const void *of, double low, double high)
{
    const double width = high - low;
    double x = low + width / 2;
    double last = width; /* the step before */

    for (int i = 0; i < 300; i++) {
        double slope = 0;
        const double value = f(of, x, &slope);
        double next = x - value / slope;

        if (value < 0)
            low = x;
        else
            high = x;
        if (!(next >= low && next <= high) || fabs(next - x) > last / 2)
            next = low + (high - low) / 2;
        last = fabs(next - x);
        x = next;
        if (last <= 1e-15 * fabs(x) || last <= 1e-17 * width)
            break;
    }
    return x;
}
