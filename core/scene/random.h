/* scene/random.h -- reproducible random numbers: xoshiro256** seeded by splitmix64 (Blackman and
 * Vigna, doi:10.1145/3460772). The same on every machine. */
#ifndef SCENE_RANDOM_H
#define SCENE_RANDOM_H

#include <stdint.h>

struct random {
    uint64_t state[4];
};

static inline void random_init(struct random *r, uint64_t seed)
{
    for (int i = 0; i < 4; i++) {
        uint64_t z = (seed += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        r->state[i] = z ^ (z >> 31);
    }
}

static inline uint64_t random_bits(struct random *r)
{
    uint64_t *s = r->state, x = s[1] * 5, t = s[1] << 17;
    uint64_t result = ((x << 7) | (x >> 57)) * 9;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = (s[3] << 45) | (s[3] >> 19);
    return result;
}

/* Uniform in [0, 1). */
static inline double random_unit(struct random *r)
{
    return (double)(random_bits(r) >> 11) * 0x1p-53;
}

#endif
