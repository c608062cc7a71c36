/* exact.h -- the exact solutions of this plugin, and what they share: properties, a loop over the
 * places, roots of functions. */
#ifndef EXACT_H
#define EXACT_H

#include <sph/exact.h>

#include <math.h>
#include <stddef.h>

#define EXACT_PI 3.14159265358979323846

extern const sph_exact acoustic_wave;
extern const sph_exact couette;
extern const sph_exact elliptical_drop;
extern const sph_exact gresho;
extern const sph_exact hydrostatics;
extern const sph_exact noh;
extern const sph_exact planar_impact;
extern const sph_exact plate;
extern const sph_exact poiseuille;
extern const sph_exact riemann;
extern const sph_exact rotating_patch;
extern const sph_exact sedov;
extern const sph_exact standing_wave;
extern const sph_exact taylor_green;

/* The properties that the solutions know. */
#define EXACT_X SPH_PROP("x", "m", "position", SPH_VECTOR, SPH_DST_READ, NAN)
#define EXACT_RHO SPH_PROP("rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_WRITE, 0)
#define EXACT_P SPH_PROP("p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_WRITE, 0)
#define EXACT_V SPH_PROP("v", "m/s", "velocity", SPH_VECTOR, SPH_DST_WRITE, 0)
#define EXACT_U SPH_PROP("u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_WRITE, 0)
#define EXACT_D SPH_PROP("d", "m", "displacement", SPH_VECTOR, SPH_DST_WRITE, 0)

/* A place, and the fields there; components beyond the run's dimensions are 0. */
struct exact_point {
    double x[3];
    double rho, p, u;
    double v[3], d[3];
};

/* Sets what the item declares; all is 0 before. `of` is the solution's own. */
typedef void (*exact_at)(const void *of, struct exact_point *q);

/* Calls `at` for each place of the batch, and lays the fields down where the host asks for them. */
sph_status exact_each(const sph_batch *b, const sph_item *item, exact_at at, const void *of);

/* host->fail with a sentence as by printf; the host says which solution it is of. */
__attribute__((format(printf, 3, 4))) sph_status exact_fail(const sph_host *host, sph_status status,
                                                            const char *format, ...);

/* sph_life.destroy of a state that is one block of malloc. */
void exact_free(const sph_host *host, void *state);

/* f and its derivative at x; 0: unknown. */
typedef double (*exact_function)(const void *of, double x, double *derivative);

/* The root of f between low, where f < 0, and high, where f > 0: Newton's iteration, halving where
 * that would leave the bracket or closes in too slowly. */
double exact_root(exact_function f, const void *of, double low, double high);

#endif
