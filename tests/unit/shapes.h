/* shapes.h -- what the structs of the ABI are made of, for tests that change descriptors member
 * by member. */
#ifndef TEST_SHAPES_H
#define TEST_SHAPES_H

#include <stddef.h>

/* SIZE: the struct's own; CODE: a function; LINK and LIST: to another struct. */
enum type { END, SIZE, WORD, REAL, TEXT, CODE, LINK, LIST };

struct shape;
struct member {
    enum type type;
    size_t at;
    const struct shape *to; /* of a link or a list */
};
struct shape {
    size_t size;
    struct member member[24]; /* ended by END */
};

extern const struct shape shape_param, shape_prop, shape_rate, shape_reduction, shape_step,
    shape_term, shape_item, shape_life, shape_value, shape_device, shape_point, shape_function,
    shape_eos, shape_boundary, shape_kernel, shape_scheme, shape_exact, shape_plugin,
    shape_population, shape_state;

#endif
