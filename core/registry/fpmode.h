/* registry/fpmode.h -- the floating point mode of this thread: rounding, flush to zero, traps.
 * Loading a library that was linked with -ffast-math changes it for the whole program. */
#ifndef REGISTRY_FPMODE_H
#define REGISTRY_FPMODE_H

#include <fenv.h>
#include <stdint.h>

#if defined(__SSE2__)
#include <xmmintrin.h>

/* Without the six sticky flags, which arithmetic sets. */
static inline uint64_t fpmode_get(void)
{
    return _mm_getcsr() & 0xffc0u;
}

static inline void fpmode_set(uint64_t mode)
{
    _mm_setcsr((_mm_getcsr() & 0x3fu) | (unsigned)mode);
}

#elif defined(__aarch64__)

static inline uint64_t fpmode_get(void)
{
    uint64_t mode;
    __asm__ volatile("mrs %0, fpcr" : "=r"(mode));
    return mode;
}

static inline void fpmode_set(uint64_t mode)
{
    __asm__ volatile("msr fpcr, %0" : : "r"(mode));
}

#else

static inline uint64_t fpmode_get(void)
{
    return (uint64_t)fegetround();
}

static inline void fpmode_set(uint64_t mode)
{
    fesetround((int)mode);
}

#endif
#endif
