/* Makes the calling thread treat denormal numbers as 0 while lanes work: they cost some processors hundreds of cycles
 * each, and have no meaning here. */
#ifndef SHEEN_RENDER_NATIVE_DENORMALS_H
#define SHEEN_RENDER_NATIVE_DENORMALS_H

#include <stdint.h>

#if defined __x86_64__
#include <xmmintrin.h>

typedef unsigned denormals;

/* Returns the old state, for denormals_restore(). */
static inline denormals denormals_flush(void)
{
    enum { FLUSH_RESULTS = 0x8000, FLUSH_OPERANDS = 0x40 };
    unsigned before = _mm_getcsr();
    _mm_setcsr(before | FLUSH_RESULTS | FLUSH_OPERANDS);
    return before;
}

static inline void denormals_restore(denormals before)
{
    _mm_setcsr(before);
}

#elif defined __aarch64__

typedef uint64_t denormals;

static inline denormals denormals_flush(void)
{
    const uint64_t FLUSH = 1u << 24;
    uint64_t before;
    __asm__ volatile("mrs %0, fpcr" : "=r"(before));
    __asm__ volatile("msr fpcr, %0" : : "r"(before | FLUSH));
    return before;
}

static inline void denormals_restore(denormals before)
{
    __asm__ volatile("msr fpcr, %0" : : "r"(before));
}

#else

typedef int denormals;

static inline denormals denormals_flush(void)
{
    return 0;
}

static inline void denormals_restore(denormals before)
{
    (void)before;
}

#endif
#endif
