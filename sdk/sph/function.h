/* sph/function.h -- an SPH function: assignment, summation or integration of properties. */
#ifndef SPH_FUNCTION_H
#define SPH_FUNCTION_H

#include <sph/batch.h>
#include <sph/device.h>
#include <sph/item.h>

SPH_BEGIN_DECLS

#define SPH_KIND_FUNCTION "sph.function/0"

#define SPH_POINT 1u /* acts on each destination alone */
#define SPH_PAIR 2u  /* sums over neighbours */

/* Which pairs a pair function needs: r < support h_i, or r < support max(h_i, h_j). */
#define SPH_GATHER 1u
#define SPH_SYMMETRIC 2u

/* `rate` is the time derivative of `property`; a function declares it as written. Integrators act on
 * this table alone.
 * SPH_DRIFT: a position, advanced with its rate (a velocity, itself advanced by SPH_KICK).
 * SPH_KICK: anything else. */
#define SPH_KICK 1u
#define SPH_DRIFT 2u
typedef struct sph_rate {
    const char *property; /* what is advanced */
    const char *rate;     /* a property of the same type, in its unit per time */
    uint32_t kind;        /* SPH_KICK or SPH_DRIFT */
    uint32_t reserved;
} sph_rate;

#define SPH_RATE(property, rate, kind)                                                             \
    {                                                                                              \
        (property), (rate), (kind), 0u                                                             \
    }

/* The global minimum, maximum or sum of a property over the particles (no ghosts) after the
 * pass. */
#define SPH_REDUCE_MIN 1u
#define SPH_REDUCE_MAX 2u
#define SPH_REDUCE_SUM 3u
/* What the host does with it besides showing it. */
#define SPH_USE_NONE 0u
#define SPH_USE_TIME_STEP 1u /* a bound on the time step, before the scene's `cfl` */
#define SPH_USE_INTERNAL 2u  /* a SUM of m times the property: the internal energy of the monitor */
#define SPH_USE_POTENTIAL 3u /* likewise: the potential energy */
typedef struct sph_reduction {
    const char *name;     /* in the log; unique within the function */
    const char *property; /* a declared SPH_SCALAR; the result has its unit */
    uint32_t op;          /* SPH_REDUCE_... */
    uint32_t use;         /* SPH_USE_... */
} sph_reduction;

#define SPH_REDUCTION(name, property, op, use)                                                     \
    {                                                                                              \
        (name), (property), (op), (use)                                                            \
    }

/* What register_item takes for SPH_KIND_FUNCTION. */
typedef struct sph_function {
    uint32_t size;
    uint32_t shape; /* SPH_POINT or SPH_PAIR */
    const sph_item *item;
    const sph_life *life;   /* or NULL */
    sph_range_fn before;    /* per destination, before the sweeps; or NULL */
    sph_range_fn run;       /* the point function, or the sweep over one source array */
    sph_range_fn after;     /* per destination, after all sweeps; or NULL */
    uint32_t reach;         /* pair: SPH_GATHER or SPH_SYMMETRIC */
    uint32_t max_sweeps;    /* > 0: the pass iterates, at most so often; see `unfinished` */
    const char *unfinished; /* a written SPH_INT32 property: 1 asks for another sweep of its group.
                             * The pass must leave finished destinations as they are. */
    double reach_scale;     /* times the kernel's support; 1 */
    sph_list rates;         /* of sph_rate */
    sph_list reductions;    /* of sph_reduction */
    const sph_device_body *device; /* pair: the body of `run` for a device (device.h); NULL: none.
                                    * The host runs one or the other: both give the same numbers */
    /* Once for each pass over an array, before all else: the only call that may change the state of
     * this use. It sees time, dt, step, parameters and reductions but no particles: count is 0, the
     * columns are NULL. Every rank calls it and must come to the same state. Or NULL. [main] */
    sph_range_fn prepare;
    /* Pair: what reals `run` takes, SPH_F64 | SPH_F32; 0: SPH_F64. `prepare`, `before`, `after` and
     * point functions get doubles in any case. */
    uint32_t reals;
    uint32_t
        frozen; /* pair, with `over`: 1: the neighbours are found once and stay, whatever moves,
                      * until particles are made or removed */
    /* Pair: a declared vector property, read of destinations and sources, that stands in place of the
     * position: neighbours, dx and r are in it, such as in a solid's reference configuration. In
     * domains without periodic and mirror sides, in doubles. NULL: the position. */
    const char *over;
    /* The same for a device (device.h), or NULL: of a point function's `run`; of a pair function's
     * `before` and `after`, as far as it has them. A function of which one lacks runs natively alone. */
    const sph_device_point *device_run, *device_before, *device_after;
} sph_function;

SPH_END_DECLS
#endif
