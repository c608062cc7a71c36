/* sph/population.h -- extension: functions that remove particles and create new ones: inlets,
 * outlets, splitting, merging.
 *
 * A function says so in properties of its destinations, as it says everything: it writes an int32
 * per particle, and the host does the rest at the end of the step, after all steps at SPH_AT_FINISH
 * have run, in the same way on any number of threads and ranks and on a device. */
#ifndef SPH_POPULATION_H
#define SPH_POPULATION_H

#include <sph/batch.h>
#include <sph/item.h>

SPH_BEGIN_DECLS

#define SPH_EXT_POPULATION "sph.population/0"

typedef struct sph_population {
    uint32_t size, reserved;
    /* SPH_INT32 properties that the function writes (SPH_DST_WRITE), or NULL: */
    const char *remove; /* not 0: this particle is taken away */
    const char *create; /* k > 0: k new particles, made as copies of this one in every property but
                         * `id`. They are made before any is taken away, so that a particle may be
                         * replaced by its copies. Several functions act in the order of the recipe:
                         * copies carry what later ones have written for their parent. */
    /* Works on the new particles, in the columns born_props. There `create` holds 1 ... k, the
     * number of the copy among its siblings, and is 0 again afterwards. batch->first is any number
     * here, not a multiple of the lanes. NULL: they stay as copied. [worker] */
    sph_range_fn born;
    sph_list
        born_props; /* of sph_prop, in the order of born's columns; read as the parent's values */
} sph_population;

typedef struct sph_population_ext {
    uint32_t size, reserved;
    /* Says that the registered function `function` of this plugin does this; the struct is
     * static, as a descriptor is. Its steps must stand at SPH_AT_FINISH. SPH_E_INVALID with a
     * message naming the field if the two contradict each other. [main], in init only, after
     * register_item */
    sph_status (*declare)(const sph_host *, const char *function, const sph_population *);
} sph_population_ext;

SPH_END_DECLS
#endif
