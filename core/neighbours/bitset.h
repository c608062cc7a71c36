/* neighbours/bitset.h -- numbers put in in any order, taken out ascending and without repeats. */
#ifndef NEIGHBOURS_BITSET_H
#define NEIGHBOURS_BITSET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

/* A bit a number, and a bit a word of those, so that few numbers are found fast among many. */
struct bitset {
    uint64_t *bits, *summary;
    size_t first, last; /* words of the summary in use: none if first > last */
    size_t n;
};

/* For numbers below n. False if there is no memory. */
static inline bool bitset_init(struct bitset *b, size_t n)
{
    size_t words = n / 64 + 1;

    *b = (struct bitset){.first = SIZE_MAX, .n = n};
    b->bits = calloc(words + words / 64 + 1, sizeof *b->bits);
    b->summary = b->bits ? b->bits + words : NULL;
    return b->bits != NULL;
}

static inline void bitset_fini(struct bitset *b)
{
    free(b->bits);
}

static inline size_t bitset_bytes(const struct bitset *b)
{
    return b->bits ? (b->n / 64 + b->n / 4096 + 2) * sizeof *b->bits : 0;
}

/* Puts in some of the 64 numbers from 64 * word on. */
static inline void bitset_put(struct bitset *b, size_t word, uint64_t mask)
{
    size_t block = word / 64;

    b->bits[word] |= mask;
    b->summary[block] |= 1ull << word % 64;
    b->first = block < b->first ? block : b->first;
    b->last = block > b->last ? block : b->last;
}

static inline void bitset_add(struct bitset *b, size_t k)
{
    bitset_put(b, k / 64, 1ull << k % 64);
}

/* Writes all numbers and leaves the set empty; their count. */
static inline size_t bitset_take(struct bitset *b, uint32_t *out)
{
    size_t n = 0;

    for (size_t block = b->first; b->first <= b->last && block <= b->last; block++) {
        for (uint64_t words = b->summary[block]; words; words &= words - 1) {
            size_t word = block * 64 + (size_t)__builtin_ctzll(words);

            for (uint64_t bits = b->bits[word]; bits; bits &= bits - 1) {
                out[n++] = (uint32_t)(word * 64) + (uint32_t)__builtin_ctzll(bits);
            }
            b->bits[word] = 0;
        }
        b->summary[block] = 0;
    }
    b->first = SIZE_MAX;
    b->last = 0;
    return n;
}

#endif
