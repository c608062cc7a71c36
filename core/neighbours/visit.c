/* neighbours/visit.c -- see visit.h: sorted by image, then, stably, by id. */
#include "neighbours/visit.h"

#include "neighbours/keys.h"

#include <stdlib.h>
#include <string.h>

static int reserve(struct visits *v, size_t n, struct error *e)
{
    if (n > v->capacity) {
        const size_t capacity = n + n / 8 + 1;
        free(v->place);
        v->place = malloc(2 * capacity * sizeof *v->place);
        v->capacity = v->place ? capacity : 0;
        if (!v->place)
            return error_memory(e, "the order of sums", 2 * capacity * sizeof *v->place);
        v->source = v->place + capacity;
    }
    v->n = n;
    return 0;
}

static int bits_of(uint64_t most)
{
    return most ? 64 - __builtin_clzll(most) : 1;
}

static int sort(struct visits *v, struct keys *keys, const int64_t *id, const uint8_t *image,
                size_t n, int threads, struct error *e)
{
    uint64_t most = 0;
    for (size_t i = 0; i < v->n; i++)
        keys->key[i] = i < n ? 0 : image[i - n];
    if (v->n > n && keys_sort(keys, 8, threads, e))
        return -1;
    for (size_t k = 0; k < v->n; k++) {
        keys->key[k] = (uint64_t)id[keys->index[k]];
        most |= keys->key[k];
    }
    if (keys_sort(keys, bits_of(most), threads, e))
        return -1;
    for (size_t k = 0; k < v->n; k++) {
        v->source[k] = keys->index[k];
        v->place[keys->index[k]] = (uint32_t)k;
    }
    return 0;
}

int visits_make(struct visits *v, const int64_t *id, const uint8_t *image, size_t n, size_t n_ghost,
                int threads, struct error *e)
{
    struct keys keys;
    if (reserve(v, n + n_ghost, e) || keys_init(&keys, n + n_ghost, e))
        return -1;
    const int status = sort(v, &keys, id, image, n, threads, e);
    keys_fini(&keys);
    return status;
}

void visits_fini(struct visits *v)
{
    free(v->place);
    memset(v, 0, sizeof *v);
}
