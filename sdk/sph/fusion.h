/* sph/fusion.h -- extension: functions of a plugin that can share a sweep over the neighbours. Two
 * passes over the same pairs read the same columns and find the same distances twice; a sweep with
 * both bodies (SPH_LOOP_BODY_2 in pair-loop.h) does it once. The plugin registers that as a function
 * of its own and says here whom it stands for; the host's plan puts it in their place. */
#ifndef SPH_FUSION_H
#define SPH_FUSION_H

#include <sph/host.h>

SPH_BEGIN_DECLS

#define SPH_EXT_FUSION "sph.fusion/0"

typedef struct sph_fusion {
    uint32_t size, reserved;
    const char *function; /* a registered pair function of this plugin: the parts in one sweep. It
                           * declares what they do: each of their properties with all their
                           * accesses, each of their parameters, rates and reductions, the
                           * same reach */
    sph_list parts;       /* of const char *: the names of at least two functions, in the order in
                           * which a recipe has them, one behind the other */
} sph_fusion;

typedef struct sph_fusions {
    uint32_t size, reserved;
    /* Says so; the struct is static, as a descriptor is. SPH_E_INVALID with a message if the parts
     * declare what the whole does not. [main], in init only, after register_item */
    sph_status (*declare)(const sph_host *, const sph_fusion *);
} sph_fusions;

SPH_END_DECLS
#endif
