/* sph/batch.h -- what a plugin's loop is handed: a range of destinations, their source lists, the
 * declared columns. One call covers thousands of pairs; never one pair. */
#ifndef SPH_BATCH_H
#define SPH_BATCH_H

#include <sph/abi.h>
#include <sph/host.h>

SPH_BEGIN_DECLS

/* What a real is (sph_batch.real). */
#define SPH_F64 1u /* double */
/* float; positions are whole numbers of a quantum (int32_t, see sph_batch.quantum) */
#define SPH_F32 2u
/* How a pair function's loop runs (sph_batch.path). The loops of pair-loop.h know them all; any
 * other `run` takes what it does not know for SPH_PATH_BEST. */
#define SPH_PATH_BEST 0u      /* as is fastest here */
#define SPH_PATH_REFERENCE 1u /* the plain loop, a pair at a time, in double */
#define SPH_PATH_EXTENDED 2u  /* likewise in long double; columns stay doubles */
#define SPH_PATH_BASE 3u      /* with what every processor of the architecture has */
#define SPH_PATH_AVX2 4u      /* on x86-64, if the processor has it */
#define SPH_PATH_AVX512 5u
/* Added to one of them: with the loops for any kernel, not those for single ones. */
#define SPH_PATH_ANY_KERNEL 16u
#define SPH_LANES 8u /* destinations in a group */

/* A column of a property, structure of arrays: component c of particle i is element
 * c * plane + i. 64-byte aligned; at least 2 * SPH_LANES elements past the last particle may be
 * read. What a pass writes past its last destination is lost. The memory is the host's; its place
 * may change from one call to the next. */
typedef struct sph_column {
    void *data;     /* double or float (sph_batch.real), int32_t, int64_t; NULL: not present */
    uint64_t plane; /* elements from one component to the next */
    uint32_t type;  /* SPH_SCALAR ... */
    uint32_t ncomp; /* components in this run's dimension */
} sph_column;

/* A kernel compiled for one run: W(r, h) = h^-dim norm sum_k P_k(t_k), t_k = max(0, knot_k - q),
 * q = r / h, P_k(t) = t^power (c[0] + c[1] t + ...); dW/dr = h^-(dim+1) norm sum_k D_k(t_k).
 * The host's, and the same for the whole run; kernel-value.h and sph_w, sph_dw evaluate it. */
#define SPH_KERNEL_KNOTS 4u
#define SPH_KERNEL_COEFS 6u
typedef struct sph_kernel_piece {
    double knot;                /* where it ends, in units of h */
    uint32_t power, n_coef;     /* of P */
    uint32_t dpower, dn_coef;   /* of D */
    double c[SPH_KERNEL_COEFS]; /* of P: n_coef of them */
    double d[SPH_KERNEL_COEFS]; /* of D: dn_coef of them */
} sph_kernel_piece;
typedef struct sph_kernel_form {
    uint32_t size, dim;
    uint32_t n_pieces, reserved;
    double support; /* in units of h: W = 0 for r >= support h */
    double norm;    /* a pure number: W integrates to 1 in dim dimensions */
    sph_kernel_piece piece[SPH_KERNEL_KNOTS]; /* the first n_pieces */
    /* Of a kernel given as a function: its values w and slopes d (per cell) at the ends of n_table
     * cells of equal width in q, w0 d0 w1 d1 ..., between which a cubic is laid; n_pieces is 0
     * then. The host's, for as long as the batch. */
    const double *table;
    double cells; /* n_table / support: cells in one h */
    uint32_t n_table, reserved2;
} sph_kernel_form;

/* Some sources of a group, in no promised order: base + list[first + k], 0 <= k < count. Only the
 * first `common` are for all lanes; the destinations themselves are among them. The others, an even
 * number, take turns: at common, common + 2, ... those that none but the lower half of the lanes can
 * be near, after each one that none but the upper half can be near; two of them are one step of a
 * vector (pair-group.h). Who does not care goes through all alike. */
typedef struct sph_span {
    uint64_t first; /* into the batch's list */
    uint32_t base;  /* a source's index */
    uint16_t count; /* at least 1 */
    uint16_t common;
} sph_span;

typedef struct sph_run sph_run; /* opaque: the run that a batch is part of */

/* All that a call works on. The host's, for the call; what it points to but `state` and the
 * columns of declared writes is read only. */
typedef struct sph_batch {
    uint32_t size;
    uint32_t dim;          /* dimensions of the run: 1, 2 or 3 */
    uint32_t real;         /* of the columns of this call: SPH_F64 or SPH_F32 */
    uint32_t lanes;        /* SPH_LANES */
    uint64_t first, count; /* destinations [first, first + count); first is a multiple of lanes */
    uint64_t n_dst, n_src; /* sizes of the two arrays, the source's ghosts included */
    /* Pair functions: group g = i / lanes has the sources of span[begin[g]] ... span[begin[g+1] - 1].
     * They are every source within reach of any lane, and some beyond: test r yourself. The
     * destination itself is among them where the two arrays are one (see `same`). For `run` of a
     * pair function alone. */
    const uint64_t *begin;
    const sph_span *span;
    const uint16_t *list;
    uint32_t same; /* 1: destination and source are the same array, so i == j is the self pair */
    uint32_t path; /* SPH_PATH_... */
    /* With SPH_F32: the unit of positions; x_i - x_j is quantum times the difference of two whole
     * numbers, which is exact. 0 otherwise. */
    double quantum;
    uint32_t uniform_h; /* pair functions: 1: every h of both arrays is the same number */
    uint32_t reserved;
    /* Position and smoothing length [the scene's unit of length], over which the list was made: in
     * the sweep; h_dst in `before` and `after` too. Otherwise the data are NULL: who wants positions
     * there declares the property "x". */
    sph_column x_dst, x_src, h_dst, h_src;
    /* The declared properties, in declared order. src[k].data is NULL unless SPH_SRC_READ; src is
     * for `run` of a pair function alone. */
    const sph_column *dst, *src;
    uint32_t n_columns, n_params;
    const double *param; /* the declared parameters, in declared order; a choice is its index */
    void *state;         /* of this use, from sph_life.create; only `prepare` may change it */
    const sph_kernel_form *kernel; /* NULL if the scene has none */
    double time;                   /* of this evaluation [the scene's unit of time] */
    double dt;                     /* the step being taken, as time; 0 before the first */
    uint64_t step;                 /* its number, from 0 */
    const sph_host *host;          /* for log, fail and extensions */
    /* What the extensions of a run ask for (reductions.h, time_step.h); NULL where no run goes on:
     * initial states, exact solutions. */
    const sph_run *run;
} sph_batch;

/* Works on a batch. Writes only the declared properties of its own destinations. Anything but
 * SPH_OK ends the run, with the sentence given to host->fail. [worker], where nothing else is
 * said */
typedef sph_status (*sph_range_fn)(const sph_batch *);

SPH_END_DECLS
#endif
