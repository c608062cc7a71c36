/* mock.h -- a plugin that is no file: a faultless set of descriptors, one of each kind and all called
 * "thing", which a test spoils in one place. */
#ifndef TEST_MOCK_H
#define TEST_MOCK_H

#include "registry/registry.h"

#define MOCK_FILE "/mock/mock.so"

extern struct mock {
    sph_prop prop[3], inverse_prop[2];
    sph_param param[3];
    sph_rate rate[1];
    sph_reduction reduction[1];
    sph_step step[2];
    sph_kernel_term term[2];
    sph_item item, plain_item;
    sph_life life;
    sph_device_value value[6]; /* i, j, sum, min, max, param */
    sph_device_body device;    /* of the function, where `function.device` is set to it */
    sph_device_value at[5];    /* in, out, inout, param, state */
    const char *fail[1];
    sph_device_point point; /* of the function or the equation of state, where it is set */
    sph_function function;
    sph_eos eos;
    sph_boundary boundary;
    sph_kernel kernel;
    sph_scheme scheme;
    sph_exact exact;
    sph_plugin plugin;
    enum kind kind;      /* registered by init; KIND_COUNT: all of them */
    const char *kind_id; /* instead of that of the kind */
    int twice, finished;
} mock;

#define LIST_OF(array)                                                                             \
    (sph_list)                                                                                     \
    {                                                                                              \
        (array), sizeof(array) / sizeof((array)[0]), sizeof((array)[0])                            \
    }

/* Faultless again; `kind` will be registered, with KIND_COUNT all of them. */
void mock_reset(enum kind kind);
/* For registry_add. */
const sph_plugin *mock_entry(void);
/* Loads the mock as it stands into a registry of its own. The sentence that refuses it, or NULL. */
const char *mock_refusal(void);

#endif
