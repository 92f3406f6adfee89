/* Vectors of LANES floats or integers, one value in each lane. LANES is 4, 8 or 16, as the including unit is compiled
 * (Makefile: LANES, and LANE_SET, the end of its functions' names). For C11 and C++17. The types are GCC's vectors:
 * the operators + - * / and & | ^ << >> work lane by lane, also with a scalar operand. Comparisons give a vmask; &
 * and | combine masks, and v_not() inverts one. Operations that generic operators do not express use the set's
 * intrinsics, behind the same names. */
#ifndef SHEEN_RENDER_NATIVE_LANES_H
#define SHEEN_RENDER_NATIVE_LANES_H

#include <stdint.h>
#include <string.h>

#if LANES != 4 && LANES != 8 && LANES != 16
#error "LANES is 4, 8 or 16"
#endif

#define LANE_JOIN_(name, set) name##_##set
#define LANE_JOIN(name, set) LANE_JOIN_(name, set)
/* The name of a function that exists once for each instruction set. */
#define LANE_NAME(name) LANE_JOIN(name, LANE_SET)
#define LANE_INLINE static inline __attribute__((always_inline))

typedef float vfloat __attribute__((vector_size(4 * LANES)));
typedef int32_t vint __attribute__((vector_size(4 * LANES)));
typedef uint32_t vuint __attribute__((vector_size(4 * LANES)));
/* Vectors in memory, at any multiple of four bytes. */
typedef float vfloat_memory __attribute__((vector_size(4 * LANES), aligned(4), may_alias));
typedef int32_t vint_memory __attribute__((vector_size(4 * LANES), aligned(4), may_alias));

LANE_INLINE vfloat v_load(const float *p)
{
    return *(const vfloat_memory *)p;
}

LANE_INLINE void v_store(float *p, vfloat a)
{
    *(vfloat_memory *)p = a;
}

LANE_INLINE vint v_load_int(const int32_t *p)
{
    return *(const vint_memory *)p;
}

LANE_INLINE void v_store_int(int32_t *p, vint a)
{
    *(vint_memory *)p = a;
}

LANE_INLINE vfloat v_float(float a)
{
    return a - (vfloat){0};
}

LANE_INLINE vint v_int(int32_t a)
{
    return a - (vint){0};
}

/* A logical shift. */
LANE_INLINE vint v_shift_right(vint a, int bits)
{
    return (vint)((vuint)a >> bits);
}

LANE_INLINE vfloat v_abs(vfloat a)
{
    return (vfloat)((vint)a & 0x7fffffff);
}

/* 0, 1, 2, ... */
LANE_INLINE vint v_count(void)
{
#if LANES == 4
    return (vint){0, 1, 2, 3};
#elif LANES == 8
    return (vint){0, 1, 2, 3, 4, 5, 6, 7};
#else
    return (vint){0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
#endif
}

LANE_INLINE vfloat v_to_float(vint a)
{
    return __builtin_convertvector(a, vfloat);
}

/* Rounds towards zero numbers that fit in an int. */
LANE_INLINE vint v_truncate(vfloat a)
{
    return __builtin_convertvector(a, vint);
}

/* v_less, v_at_most: comparisons, false if either side is NaN. v_min, v_max: b if either is NaN. v_select: a where
 * the mask is set, else b. v_bits: bit k for lane k. v_mask: the reverse. v_round: to the nearest integer, halves to
 * even. v_load_u16: 16-bit numbers from memory. */
#if defined __x86_64__ && LANES == 16
#include <immintrin.h>
typedef __mmask16 vmask;
/* Intrinsics with a mask define the other lanes; without a mask they leave them undefined, of which some C++
 * compilers warn. */
#define V_ALL ((__mmask16)0xffff)

LANE_INLINE vmask v_less(vfloat a, vfloat b)
{
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
}

LANE_INLINE vmask v_at_most(vfloat a, vfloat b)
{
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LE_OQ);
}

LANE_INLINE vmask v_equal_int(vint a, vint b)
{
    return _mm512_cmpeq_epi32_mask((__m512i)a, (__m512i)b);
}

LANE_INLINE vfloat v_select(vmask m, vfloat a, vfloat b)
{
    return (vfloat)_mm512_mask_blend_ps(m, (__m512)b, (__m512)a);
}

LANE_INLINE vint v_select_int(vmask m, vint a, vint b)
{
    return (vint)_mm512_mask_blend_epi32(m, (__m512i)b, (__m512i)a);
}

LANE_INLINE vmask v_not(vmask a)
{
    return (vmask)~a;
}

LANE_INLINE unsigned v_bits(vmask m)
{
    return m;
}

LANE_INLINE vmask v_mask(unsigned bits)
{
    return (vmask)bits;
}

LANE_INLINE vfloat v_min(vfloat a, vfloat b)
{
    return (vfloat)_mm512_mask_min_ps((__m512)a, V_ALL, (__m512)a, (__m512)b);
}

LANE_INLINE vfloat v_max(vfloat a, vfloat b)
{
    return (vfloat)_mm512_mask_max_ps((__m512)a, V_ALL, (__m512)a, (__m512)b);
}

LANE_INLINE vfloat v_sqrt(vfloat a)
{
    return (vfloat)_mm512_mask_sqrt_ps((__m512)a, V_ALL, (__m512)a);
}

LANE_INLINE vint v_round(vfloat a)
{
    return (vint)_mm512_mask_cvtps_epi32((__m512i)a, V_ALL, (__m512)a);
}

LANE_INLINE vfloat v_gather(const float *p, vint at)
{
    return (vfloat)_mm512_mask_i32gather_ps((__m512)at, V_ALL, (__m512i)at, p, 4);
}

LANE_INLINE vint v_load_u16(const uint16_t *p)
{
    return (vint)_mm512_maskz_cvtepu16_epi32(V_ALL,
                                             _mm256_loadu_si256((const __m256i *)(const void *)p));
}

#else /* the mask is an integer vector, all bits of a lane alike */
typedef vint vmask;

LANE_INLINE vmask v_less(vfloat a, vfloat b)
{
    return a < b;
}

LANE_INLINE vmask v_at_most(vfloat a, vfloat b)
{
    return a <= b;
}

LANE_INLINE vmask v_equal_int(vint a, vint b)
{
    return a == b;
}

LANE_INLINE vmask v_not(vmask a)
{
    return ~a;
}

#if defined __x86_64__ && LANES == 8
#include <immintrin.h>

LANE_INLINE vfloat v_select(vmask m, vfloat a, vfloat b)
{
    return (vfloat)_mm256_blendv_ps((__m256)b, (__m256)a, (__m256)m);
}

LANE_INLINE unsigned v_bits(vmask m)
{
    return (unsigned)_mm256_movemask_ps((__m256)m);
}

LANE_INLINE vfloat v_min(vfloat a, vfloat b)
{
    return (vfloat)_mm256_min_ps((__m256)a, (__m256)b);
}

LANE_INLINE vfloat v_max(vfloat a, vfloat b)
{
    return (vfloat)_mm256_max_ps((__m256)a, (__m256)b);
}

LANE_INLINE vfloat v_sqrt(vfloat a)
{
    return (vfloat)_mm256_sqrt_ps((__m256)a);
}

LANE_INLINE vint v_round(vfloat a)
{
    return (vint)_mm256_cvtps_epi32((__m256)a);
}

LANE_INLINE vfloat v_gather(const float *p, vint at)
{
    return (vfloat)_mm256_i32gather_ps(p, (__m256i)at, 4);
}

LANE_INLINE vint v_load_u16(const uint16_t *p)
{
    return (vint)_mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)(const void *)p));
}

#elif defined __x86_64__
#include <smmintrin.h>

LANE_INLINE vfloat v_select(vmask m, vfloat a, vfloat b)
{
    return (vfloat)_mm_blendv_ps((__m128)b, (__m128)a, (__m128)m);
}

LANE_INLINE unsigned v_bits(vmask m)
{
    return (unsigned)_mm_movemask_ps((__m128)m);
}

LANE_INLINE vfloat v_min(vfloat a, vfloat b)
{
    return (vfloat)_mm_min_ps((__m128)a, (__m128)b);
}

LANE_INLINE vfloat v_max(vfloat a, vfloat b)
{
    return (vfloat)_mm_max_ps((__m128)a, (__m128)b);
}

LANE_INLINE vfloat v_sqrt(vfloat a)
{
    return (vfloat)_mm_sqrt_ps((__m128)a);
}

LANE_INLINE vint v_round(vfloat a)
{
    return (vint)_mm_cvtps_epi32((__m128)a);
}

LANE_INLINE vfloat v_gather(const float *p, vint at)
{
    return (vfloat){p[at[0]], p[at[1]], p[at[2]], p[at[3]]};
}

LANE_INLINE vint v_load_u16(const uint16_t *p)
{
    return (vint)_mm_cvtepu16_epi32(_mm_loadl_epi64((const __m128i *)(const void *)p));
}

#else /* any processor */
#include <math.h>

LANE_INLINE vfloat v_select(vmask m, vfloat a, vfloat b)
{
    return (vfloat)((m & (vint)a) | (~m & (vint)b));
}

LANE_INLINE unsigned v_bits(vmask m)
{
    unsigned bits = 0;
    for (int k = 0; k < LANES; k++)
        bits |= m[k] ? 1u << k : 0;
    return bits;
}

LANE_INLINE vfloat v_min(vfloat a, vfloat b)
{
    return v_select(a < b, a, b);
}

LANE_INLINE vfloat v_max(vfloat a, vfloat b)
{
    return v_select(a > b, a, b);
}

LANE_INLINE vfloat v_sqrt(vfloat a)
{
    for (int k = 0; k < LANES; k++)
        a[k] = sqrtf(a[k]);
    return a;
}

LANE_INLINE vint v_round(vfloat a)
{
    vint whole = {0};
    for (int k = 0; k < LANES; k++)
        whole[k] = (int32_t)lrintf(a[k]);
    return whole;
}

LANE_INLINE vfloat v_gather(const float *p, vint at)
{
    vfloat a = {0};
    for (int k = 0; k < LANES; k++)
        a[k] = p[at[k]];
    return a;
}

LANE_INLINE vint v_load_u16(const uint16_t *p)
{
    vint a = {0};
    for (int k = 0; k < LANES; k++)
        a[k] = p[k];
    return a;
}
#endif

LANE_INLINE vint v_select_int(vmask m, vint a, vint b)
{
    return (m & a) | (~m & b);
}

LANE_INLINE vmask v_mask(unsigned bits)
{
    return ((v_int((int32_t)bits) >> v_count()) & 1) != 0;
}
#endif

/* Of integers of 32 bits. */
LANE_INLINE vint v_gather_int(const void *p, vint at)
{
#if defined __x86_64__ && LANES >= 8
    return (vint)v_gather((const float *)p, at);
#else
    typedef int32_t number __attribute__((may_alias));
    vint a = {0};
    for (int k = 0; k < LANES; k++)
        a[k] = ((const number *)p)[at[k]];
    return a;
#endif
}

/* A block of pixels: lanes fill BLOCK_WIDTH pixels of a row, then continue in the next row. */
#define BLOCK_WIDTH (LANES < 8 ? LANES : 8)
#define BLOCK_HEIGHT (LANES / BLOCK_WIDTH)

/* Loads a block from rows `pitch` elements apart. */
LANE_INLINE vfloat v_load_block(const float *p, int pitch)
{
#if LANES == 16
    __m512 first = _mm512_castps256_ps512(_mm256_loadu_ps(p));
    return (vfloat)_mm512_insertf32x8(first, _mm256_loadu_ps(p + pitch), 1);
#else
    (void)pitch;
    return v_load(p);
#endif
}

/* Stores a block where the mask is set. */
LANE_INLINE void v_store_block(float *p, int pitch, vmask m, vfloat a)
{
#if LANES == 16
    _mm256_mask_storeu_ps(p, (__mmask8)m, _mm512_castps512_ps256((__m512)a));
    _mm256_mask_storeu_ps(p + pitch, (__mmask8)(m >> 8), _mm512_extractf32x8_ps((__m512)a, 1));
#else
    (void)pitch;
    v_store(p, v_select(m, a, v_load(p)));
#endif
}

LANE_INLINE void v_store_int_block(int32_t *p, int pitch, vmask m, vint a)
{
#if LANES == 16
    _mm256_mask_storeu_epi32(p, (__mmask8)m, _mm512_castsi512_si256((__m512i)a));
    _mm256_mask_storeu_epi32(p + pitch, (__mmask8)(m >> 8),
                             _mm512_extracti32x8_epi32((__m512i)a, 1));
#else
    (void)pitch;
    v_store_int(p, v_select_int(m, a, v_load_int(p)));
#endif
}

/* Changes only the lanes of the mask; the memory of the others must belong to this thread. */
LANE_INLINE void v_store_masked(float *p, vmask m, vfloat a)
{
#if LANES == 16
    _mm512_mask_storeu_ps(p, m, (__m512)a);
#else
    v_store(p, v_select(m, a, v_load(p)));
#endif
}

LANE_INLINE void v_store_int_masked(int32_t *p, vmask m, vint a)
{
#if LANES == 16
    _mm512_mask_storeu_epi32(p, m, (__m512i)a);
#else
    v_store_int(p, v_select_int(m, a, v_load_int(p)));
#endif
}

/* A mask of the lanes before n; n may exceed LANES. */
LANE_INLINE unsigned v_first(uint32_t n)
{
    return n >= LANES ? (LANES == 16 ? 0xffffu : (1u << LANES) - 1) : (1u << n) - 1;
}

LANE_INLINE vfloat v_clamp(vfloat a, float low, float high)
{
    return v_min(v_max(a, v_float(low)), v_float(high));
}

/* The smallest and the largest of all lanes, which must not be NaN. */
LANE_INLINE float v_least(vfloat a)
{
    float least = a[0];
    for (int k = 1; k < LANES; k++)
        least = a[k] < least ? a[k] : least;
    return least;
}

LANE_INLINE float v_largest(vfloat a)
{
    float largest = a[0];
    for (int k = 1; k < LANES; k++)
        largest = a[k] > largest ? a[k] : largest;
    return largest;
}

#endif
