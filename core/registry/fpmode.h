/* registry/fpmode.h -- the floating point mode of this thread: rounding, flush to zero, traps,
 * and the precision of the x87 unit (which long double uses). Loading a library that was linked
 * with -ffast-math or -mpc64 changes it for the whole program. */
#ifndef REGISTRY_FPMODE_H
#define REGISTRY_FPMODE_H

#include <fenv.h>
#include <stdint.h>

#if defined(__SSE2__)
#include <xmmintrin.h>

/* The x87 control word above that of SSE, without the latter's six sticky flags, which arithmetic
 * sets. */
static inline uint64_t fpmode_get(void)
{
    uint16_t control;

    __asm__ volatile("fnstcw %0" : "=m"(control));
    return (uint64_t)control << 32 | (_mm_getcsr() & 0xffc0u);
}

static inline void fpmode_set(uint64_t mode)
{
    const uint16_t control = (uint16_t)(mode >> 32);

    __asm__ volatile("fldcw %0" : : "m"(control));
    _mm_setcsr((_mm_getcsr() & 0x3fu) | (unsigned)(mode & 0xffc0u));
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
