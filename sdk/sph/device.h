/* sph/device.h -- a pair body as a device needs it: the text that the native loop was compiled
 * from, and which names in it stand for which declared properties and parameters. pair-loop.h
 * makes one from the lists of its loop (SPH_LOOP_DEVICE), so that both backends run the same
 * text; the host puts OpenCL C around it. All of it is the plugin's, static, and only read. */
#ifndef SPH_DEVICE_H
#define SPH_DEVICE_H

#include <sph/abi.h>

SPH_BEGIN_DECLS

/* A name of the body. A value of the destinations is name_i there, one of the sources name_j, an
 * accumulator or a parameter `name`: identifiers of C that begin with neither sph_ nor SPH_, each
 * once in its list. */
typedef struct sph_device_value {
    const char *name;
    uint32_t index; /* of the declared property, or of the declared parameter (a number) */
    uint32_t type;  /* of the property: SPH_SCALAR, SPH_VECTOR or SPH_MATRIX; 0 for a parameter */
} sph_device_value;

/* The body in the subset that C and OpenCL C share: the words of lanes.h, arithmetic, loops over
 * components, branches on parameters; no includes, and no names that OpenCL C keeps for itself
 * (half, kernel, global, local, constant, private, uint, ...). Its units are those of the
 * properties. The host refuses the function, with a sentence, if the lists contradict what its
 * item declares; a text that a device's compiler does not take is reported where it is built,
 * with `file` and line. */
typedef struct sph_device_body {
    uint32_t size;
    uint32_t reach; /* SPH_GATHER or SPH_SYMMETRIC; no more than the function's */
    uint32_t self;  /* 1: the body also gets the self pair (r = 0); else 0 */
    uint32_t reserved;
    const char *text; /* of one pair, ended by NUL; several bodies are joined by "}", "{" */
    /* Whose text it is, for messages: "density.body.h". Of several the first; their lines count on
     * from its last. */
    const char *file;
    /* Text that stands before the loop: macros of the body, which the native build has from an
     * #include of the same file. NULL: none. */
    const char *prelude;
    const char *prelude_file; /* its file, for messages; NULL where there is none */
    sph_list i; /* of sph_device_value, like the rest: values of the destinations (SPH_DST_READ) */
    sph_list j; /* values of the sources (SPH_SRC_READ) */
    sph_list sum;   /* accumulators: begin at 0, and are added to the written property */
    sph_list min;   /* scalars: begin at infinity; the written property takes the minimum */
    sph_list max;   /* scalars: begin at -infinity; likewise the maximum */
    sph_list param; /* parameters, as doubles; a choice is its index */
} sph_device_body;

/* What a destination does alone, for a device: a point function, `before` or `after` of a pair function,
 * an equation of state. point-loop.h makes one from the lists of its loop, so that both backends run
 * the same text, and says what that may hold. R and T are double (float on a device without doubles).
 * A scalar is a variable of its name, vectors, matrices and symmetric tensors are arrays of their
 * components, an int32 is an int. A property stands in one of the lists at most, once; every name is
 * there once. */
typedef struct sph_device_point {
    uint32_t size;
    uint32_t h; /* 1: `h` is the smoothing length (pair functions); 0: a name like any other */
    const char *text, *file;            /* as of sph_device_body */
    const char *prelude, *prelude_file; /* likewise */
    sph_list in;  /* of sph_device_value, like the rest: declared properties that it reads alone */
    sph_list out; /* that it sets, whatever they were */
    sph_list inout; /* that it reads and sets; what the body does not touch stays as it is */
    sph_list param; /* parameters, as doubles; a choice is its index */
    /* Numbers of the use's state: the index-th double of those at its beginning. `prepare` and `create`
     * may set them; the host hands them on before each pass. type: 0. */
    sph_list state;
    sph_list fail; /* of const char *: what sph_fail(k) says, with SPH_E_NUMERIC; the run ends */
} sph_device_point;

SPH_END_DECLS
#endif
