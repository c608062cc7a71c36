/* sph/item.h -- what every registered thing says of itself: names, source, parameters, and the
 * particle properties it touches. From these declarations alone the host allocates columns, orders
 * passes, derives ghost exchanges and prints `sph info`. */
#ifndef SPH_ITEM_H
#define SPH_ITEM_H

#include <sph/abi.h>

SPH_BEGIN_DECLS

/* Types of a property. A real is double or float, the host's choice (see sph_batch.real). */
#define SPH_SCALAR 1u /* one real */
#define SPH_VECTOR 2u /* dim reals; a mirror side flips the component along its normal */
#define SPH_SYM                                                                                    \
    3u /* symmetric tensor, dim (dim + 1) / 2 reals: xx, xy, xz, yy, yz, zz as present */
#define SPH_MATRIX 4u /* dim * dim reals, row by row: component [a][b] is plane a * dim + b */
#define SPH_INT32 5u  /* one int32_t */
#define SPH_INT64 6u  /* one int64_t */

/* Access to a property. A pass reaches only what it declares; a debug run traps the rest. */
#define SPH_DST_READ 0x01u  /* reads the destination's value */
#define SPH_SRC_READ 0x02u  /* reads the sources' values: the host refreshes their ghosts first */
#define SPH_DST_WRITE 0x04u /* sets the destination's value, every destination, each time */
/* Adds to it: the host sets it to `start` before the first source, for each pass anew. But what is
 * the rate of something in this run (sph_rate) adds up over an evaluation: it starts only where no
 * earlier function has set it or added to it, so that a force works alone and beside others. */
#define SPH_DST_SUM 0x08u
#define SPH_DST_MAX 0x10u /* takes the maximum; starts as above */
#define SPH_DST_MIN 0x20u /* takes the minimum; starts as above */
#define SPH_WORK 0x40u    /* with one of the above: working storage, of no interest in a snapshot */
/* With SPH_DST_READ, of a pair function: its `run` alone reads the value. In `before` and `after`
 * dst[k].data is NULL then, which spares the host to lay it out in doubles for them. */
#define SPH_DST_SWEEP 0x80u
#define SPH_DST_UPDATE (SPH_DST_READ | SPH_DST_WRITE)

/* A property that an item touches. Items that declare the same name mean the same column, so its
 * type must be the same everywhere. */
typedef struct sph_prop {
    const char *name; /* "rho"; [A-Za-z][A-Za-z0-9_]* */
    const char *unit; /* "kg/m^d", in SI terms; "" or NULL for a pure number */
    const char *doc;  /* a few words; may be NULL */
    uint32_t type;    /* SPH_SCALAR ... */
    uint32_t access;  /* SPH_DST_READ | ... */
    double start; /* of an accumulated property; else the initial value of one that is carried from
                      * step to step where a scene gives none (NaN: it must). Default 0 */
} sph_prop;

/* A user's parameter. The host parses, range-checks, documents and prints it. */
typedef struct sph_param {
    const char *name;    /* unique within the item; [A-Za-z][A-Za-z0-9_-]* */
    const char *unit;    /* as of a property; def, min and max are in it */
    const char *doc;     /* a few words */
    double def;          /* default; NaN: mandatory. For a choice: the index of the default */
    double min, max;     /* inclusive; min > max: unbounded */
    const char *choices; /* "exact|hllc": the value is a word, handed on as its index; else NULL */
    uint32_t type;       /* SPH_PARAM_NUMBER (default), or SPH_PARAM_TABLE: see tables.h */
    uint32_t reserved;   /* 0 */
} sph_param;

#define SPH_PARAM_NUMBER 0u /* a number, a truth value (1, 0) or one of the choices */
#define SPH_PARAM_TABLE                                                                            \
    1u /* named columns of numbers, from a file or from the scene; its number is 1 where the scene \
        * gives one, else 0. def: NaN: mandatory, else 0 */

/* Static, as the descriptor that points to it. */
typedef struct sph_item {
    uint32_t size;
    uint32_t dims;      /* bit d set: works in d dimensions */
    const char *name;   /* what a scene writes: "gsph-rates"; [a-z0-9-], unique within its kind */
    const char *doc;    /* one sentence */
    const char *source; /* paper, equation; or "" */
    sph_list params;    /* of sph_param */
    sph_list props;     /* of sph_prop, in the order in which a batch hands the columns over */
} sph_item;

#define SPH_DIM1 0x2u
#define SPH_DIM2 0x4u
#define SPH_DIM3 0x8u
#define SPH_ALL_DIMS (SPH_DIM1 | SPH_DIM2 | SPH_DIM3)

/* Elements of static lists. Written with these, a plugin's source stays whole when a later version
 * appends members: static const sph_prop props[] = {SPH_PROP("rho", "kg/m^d", ...), ...}; */
#define SPH_PROP(name, unit, doc, type, access, start)                                             \
    {                                                                                              \
        (name), (unit), (doc), (type), (access), (start)                                           \
    }
#define SPH_PARAM(name, unit, doc, def, min, max)                                                  \
    {                                                                                              \
        (name), (unit), (doc), (def), (min), (max), NULL, SPH_PARAM_NUMBER, 0u                     \
    }
/* choices: "exact|hllc"; def: the index of the default */
#define SPH_PARAM_CHOICE(name, doc, def, choices)                                                  \
    {                                                                                              \
        (name), "", (doc), (def), 1.0, 0.0, (choices), SPH_PARAM_NUMBER, 0u                        \
    }
/* def: 0, or NaN where a scene must give one */
#define SPH_PARAM_OF_TABLE(name, doc, def)                                                         \
    {                                                                                              \
        (name), "", (doc), (def), 1.0, 0.0, NULL, SPH_PARAM_TABLE, 0u                              \
    }

SPH_END_DECLS
#endif
