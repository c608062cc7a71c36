/* plan/measured.c -- names of numbers to columns and components, and their values. Reads particles only. */
#include "plan/measured.h"
#include "domain/sides.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static int component(const struct column *c, int dim, const char *name, struct measured *out)
{
    char *end;
    *out = (struct measured){.column = out->column, .kind = MEASURED_COMPONENT};
    if (c->ncomp == 1 && c->type != SPH_VECTOR)
        return -1;
    if (isdigit((unsigned char)name[0]) && c->type != SPH_VECTOR) {
        out->k = (uint32_t)strtoul(name, &end, 10);
        return !*end && out->k < c->ncomp ? 0 : -1;
    }
    if (c->type != SPH_VECTOR)
        return -1;
    if (strchr("xyz", name[0]) && name[0] && !name[1]) {
        out->k = (uint32_t)(name[0] - 'x');
        return out->k < c->ncomp ? 0 : -1;
    }
    out->kind = strcmp(name, "r") == 0 ? MEASURED_RADIAL : MEASURED_AZIMUTHAL;
    return strcmp(name, "r") == 0 || (strcmp(name, "phi") == 0 && dim > 1) ? 0 : -1;
}

int measured_find(const struct particles *p, const char *of, struct measured *out, bool *missing)
{
    char plain[128];
    *missing = false;
    out->column = particles_find(p, of);
    out->k = 0;
    if (out->column >= 0) {
        const struct column *c = &p->column[out->column];
        out->kind = c->ncomp > 1 ? MEASURED_LENGTH : MEASURED_COMPONENT;
        return 0;
    }
    const char *dot = strrchr(of, '.');
    const size_t n = dot ? (size_t)(dot - of) : 0;
    if (!dot || n >= sizeof plain)
        return -1;
    memcpy(plain, of, n);
    plain[n] = '\0';
    out->column = particles_find(p, plain);
    if (out->column < 0)
        return -1;
    *missing = true;
    return component(&p->column[out->column], p->dim, dot + 1, out);
}

/* Component k of particle i, or of its image. */
static double part(const struct column *c, int dim, uint32_t k, size_t i, const double x[3],
                   unsigned mirrored)
{
    if (c->type == SPH_INT64)
        return (double)((const int64_t *)c->data)[i];
    if (c->type == SPH_INT32)
        return (double)((const int32_t *)c->data)[i];
    if (strcmp(c->name, "x") == 0)
        return x[k];
    double value = column_get(c, k, i);
    for (int axis = 0; mirrored && axis < dim; axis++)
        if ((mirrored >> axis & 1u) && sides_turn(c->type, dim, k, axis))
            value = -value;
    return value;
}

/* About the point, or about the axis where there is one; phi always about an axis, z if none is named. */
static double about_center(const double v[3], const double x[3], int dim,
                           const struct scene_about *about, bool azimuthal)
{
    double d[3] = {0.0, 0.0, 0.0};
    const int axis = azimuthal && about->axis < 0 ? 2 : about->axis;
    for (int c = 0; c < dim; c++)
        d[c] = c == axis ? 0.0 : x[c] - about->center[c];
    const double r = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    if (!(r > 0.0))
        return 0.0;
    if (!azimuthal)
        return (v[0] * d[0] + v[1] * d[1] + v[2] * d[2]) / r;
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    return (v[b] * d[a] - v[a] * d[b]) / r;
}

double measured_value(const struct particles *p, const struct measured *m,
                      const struct scene_about *about, size_t i, const double x[3],
                      unsigned mirrored)
{
    const struct column *c = &p->column[m->column];
    if (m->kind == MEASURED_COMPONENT)
        return part(c, p->dim, m->k, i, x, mirrored);
    if (m->kind == MEASURED_LENGTH) {
        double s = 0.0;
        for (uint32_t k = 0; k < c->ncomp; k++)
            s += column_get(c, k, i) * column_get(c, k, i);
        return sqrt(s);
    }
    double v[3] = {0.0, 0.0, 0.0};
    for (uint32_t k = 0; k < c->ncomp; k++)
        v[k] = part(c, p->dim, k, i, x, mirrored);
    return about_center(v, x, p->dim, about, m->kind == MEASURED_AZIMUTHAL);
}
