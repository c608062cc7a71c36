/* neighbours/keys.c -- a radix sort of keys, from the lowest digit on. Touches its own memory only.
 * Each thread counts and moves the keys of a stretch of its own; what comes out is the same for any
 * number of threads. */
#include "neighbours/keys.h"

#include <stdlib.h>
#include <string.h>

#define DIGIT 11
#define DIGITS (1u << DIGIT)
#define THREADS_MOST 64

int keys_init(struct keys *k, size_t n, struct error *e)
{
    memset(k, 0, sizeof *k);
    k->n = n;
    k->key = malloc((n + 1) * sizeof *k->key);
    k->index = malloc((n + 1) * sizeof *k->index);
    if (!k->key || !k->index) {
        keys_fini(k);
        return error_memory(e, "the keys of the neighbour search",
                            n * (sizeof *k->key + sizeof *k->index));
    }
    for (size_t i = 0; i < n; i++) {
        k->index[i] = (uint32_t)i;
    }
    return 0;
}

void keys_fini(struct keys *k)
{
    free(k->key);
    free(k->index);
    k->key = NULL;
    k->index = NULL;
}

/* Counts of the digits of each thread's keys become the places of the first of them. True if all
 * keys have the same digit. */
static bool places(uint32_t (*count)[DIGITS], size_t threads, size_t n)
{
    uint32_t sum = 0;

    for (size_t d = 0; d < DIGITS; d++) {
        uint32_t before = sum;

        for (size_t t = 0; t < threads; t++) {
            uint32_t c = count[t][d];

            count[t][d] = sum;
            sum += c;
        }
        if (sum - before == n) {
            return true;
        }
    }
    return false;
}

/* Sorts by one digit into `to`; false if there was nothing to sort. */
static bool sort_digit(const struct keys *from, struct keys *to, int shift,
                       uint32_t (*count)[DIGITS], size_t threads)
{
    size_t n = from->n, share = (n + threads - 1) / threads;

#pragma omp parallel for schedule(static, 1) num_threads((int)threads) if (threads > 1)
    for (size_t t = 0; t < threads; t++) {
        size_t end = (t + 1) * share < n ? (t + 1) * share : n;

        memset(count[t], 0, sizeof count[t]);
        for (size_t i = t * share; i < end; i++) {
            count[t][from->key[i] >> shift & (DIGITS - 1)]++;
        }
    }
    if (places(count, threads, n)) {
        return false;
    }
#pragma omp parallel for schedule(static, 1) num_threads((int)threads) if (threads > 1)
    for (size_t t = 0; t < threads; t++) {
        size_t end = (t + 1) * share < n ? (t + 1) * share : n;

        for (size_t i = t * share; i < end; i++) {
            uint32_t at = count[t][from->key[i] >> shift & (DIGITS - 1)]++;

            to->key[at] = from->key[i];
            to->index[at] = from->index[i];
        }
    }
    return true;
}

int keys_sort(struct keys *k, int bits, int threads, struct error *e)
{
    size_t team = (size_t)(threads < THREADS_MOST ? threads : THREADS_MOST);
    uint32_t(*count)[DIGITS];
    struct keys other;

    team = k->n < 4096 ? 1 : team;
    count = malloc(team * sizeof *count);
    if (!count || keys_init(&other, k->n, e) != 0) {
        free(count);
        return error_memory(e, "sorting keys", team * sizeof *count);
    }
    k->bytes = 2 * k->n * (sizeof *k->key + sizeof *k->index) + team * sizeof *count;
    for (int shift = 0; shift < bits; shift += DIGIT) {
        if (sort_digit(k, &other, shift, count, team)) {
            uint64_t *key = k->key;
            uint32_t *index = k->index;

            k->key = other.key;
            k->index = other.index;
            other.key = key;
            other.index = index;
        }
    }
    keys_fini(&other);
    free(count);
    return 0;
}
