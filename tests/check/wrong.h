/* wrong.h -- what the deliberately wrong modules share. The checker must find each fault; whatever
 * else it looks at is right. */
#ifndef WRONG_H
#define WRONG_H

#include <sph/plugin.h>

#define SIZE(type) ((uint32_t)sizeof(type))
#define EACH(i, b) for (uint64_t i = (b)->first; i < (b)->first + (b)->count; i++)

static inline double *plane(const sph_column *column)
{
    return (double *)column->data;
}

#define ITEM(variable, name_, props_)                                                              \
    static const sph_item variable = {.size = SIZE(sph_item),                                      \
                                      .dims = SPH_ALL_DIMS,                                        \
                                      .name = name_,                                               \
                                      .doc = "does something wrong",                               \
                                      .source = "nobody",                                          \
                                      .props = SPH_LIST(props_)}

#endif
