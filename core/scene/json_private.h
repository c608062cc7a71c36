/* scene/json_private.h -- what the files json*.c share. */
#ifndef SCENE_JSON_PRIVATE_H
#define SCENE_JSON_PRIVATE_H

#include "scene/json.h"

struct place {
    const cJSON *node;
    const cJSON *original; /* of a reference: the node that it stands for; else NULL */
    size_t value, key;     /* offsets in the text */
    size_t set;            /* index of the --set that it came from, or SIZE_MAX */
};

/* Notes where a node stands; -1 when out of memory. */
int place_add(struct document *d, const cJSON *node, size_t value, size_t key, size_t set);

#endif
