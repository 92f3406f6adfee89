// GLSL's types and functions with one invocation in each lane of a vector, for the C++ that shaders/lanes
// writes of the project's shaders.
//
// LANES (4, 8 or 16) is the compiler's to say, with the instruction set that has such vectors: one unit for each.
// All of this is internal to a unit: it is in an unnamed namespace, so that units of different widths do not mix.
// A vbool's lanes are 0 or -1. Memory is never touched outside of what it holds: indices are brought inside.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

extern "C" {
#include "server/render/native/programs/program.h"
}

#if defined(__AVX2__) || defined(__AVX512F__)
#include <immintrin.h>
#endif

namespace
{

typedef float vfloat __attribute__((vector_size(4 * LANES)));
typedef int32_t vint __attribute__((vector_size(4 * LANES)));
typedef uint32_t vuint __attribute__((vector_size(4 * LANES)));
typedef int32_t vbool __attribute__((vector_size(4 * LANES)));
typedef double vdouble __attribute__((vector_size(8 * LANES)));

#define INLINE static inline __attribute__((always_inline))

// --- masks
INLINE bool some(vbool m)
{
#if LANES == 16 && defined(__AVX512F__)
    return _mm512_test_epi32_mask((__m512i)m, (__m512i)m) != 0;
#elif LANES == 8 && defined(__AVX2__)
    return _mm256_movemask_ps((__m256)m) != 0;
#else
    int32_t any = 0;
    for (int i = 0; i < LANES; i++)
        any |= m[i];
    return any != 0;
#endif
}

INLINE bool none(vbool m)
{
    return !some(m);
}

// --- the same value in every lane
INLINE vfloat lanes(float a)
{
    return a - vfloat{};
}
INLINE vint lanes(int32_t a)
{
    return a - vint{};
}
INLINE vuint lanes(uint32_t a)
{
    return a - vuint{};
}
INLINE vbool lanes(bool a)
{
    return (a ? -1 : 0) - vbool{};
}
INLINE vdouble lanes(double a)
{
    return a - vdouble{};
}

// --- division of whole numbers; by 0 as by 1
INLINE vint quotient(vint a, vint b)
{
    return a / (b == 0 ? b + 1 : b);
}
INLINE vuint quotient(vuint a, vuint b)
{
    return a / (b == 0 ? b + 1 : b);
}
INLINE vint remainder(vint a, vint b)
{
    return a % (b == 0 ? b + 1 : b);
}
INLINE vuint remainder(vuint a, vuint b)
{
    return a % (b == 0 ? b + 1 : b);
}

// --- choices
INLINE vfloat select(vbool m, vfloat a, vfloat b)
{
    return m ? a : b;
}
INLINE vint select(vbool m, vint a, vint b)
{
    return m ? a : b;
}
INLINE vuint select(vbool m, vuint a, vuint b)
{
    return m ? a : b;
}

// --- scalars' functions, for float and for vfloat
#if LANES == 16 && defined(__AVX512F__)
#define EACH_LANE(intrinsic512, intrinsic256, plain) return (vfloat)intrinsic512
#elif LANES == 8 && defined(__AVX2__)
#define EACH_LANE(intrinsic512, intrinsic256, plain) return (vfloat)intrinsic256
#else
#define EACH_LANE(intrinsic512, intrinsic256, plain)                                               \
    vfloat result;                                                                                 \
    for (int i = 0; i < LANES; i++)                                                                \
        result[i] = plain;                                                                         \
    return result
#endif

INLINE vfloat sqrt(vfloat a)
{
    EACH_LANE(_mm512_sqrt_ps((__m512)a), _mm256_sqrt_ps((__m256)a), sqrtf(a[i]));
}
INLINE vfloat floor(vfloat a)
{
    EACH_LANE(_mm512_roundscale_ps((__m512)a, 9), _mm256_floor_ps((__m256)a), floorf(a[i]));
}
INLINE vfloat round(vfloat a) // to even
{
    EACH_LANE(_mm512_roundscale_ps((__m512)a, 8), _mm256_round_ps((__m256)a, 8), nearbyintf(a[i]));
}
#undef EACH_LANE
INLINE float sqrt(float a)
{
    return sqrtf(a);
}
INLINE float floor(float a)
{
    return floorf(a);
}
INLINE float round(float a)
{
    return nearbyintf(a);
}

INLINE vfloat min(vfloat a, vfloat b)
{
    return b < a ? b : a;
}
INLINE vfloat max(vfloat a, vfloat b)
{
    return a < b ? b : a;
}
INLINE vint min(vint a, vint b)
{
    return b < a ? b : a;
}
INLINE vint max(vint a, vint b)
{
    return a < b ? b : a;
}
INLINE vuint min(vuint a, vuint b)
{
    return b < a ? b : a;
}
INLINE vuint max(vuint a, vuint b)
{
    return a < b ? b : a;
}
template <class T, class = std::enable_if_t<std::is_arithmetic_v<T>>> INLINE T min(T a, T b)
{
    return b < a ? b : a;
}
template <class T, class = std::enable_if_t<std::is_arithmetic_v<T>>> INLINE T max(T a, T b)
{
    return a < b ? b : a;
}
INLINE vfloat abs(vfloat a)
{
    return (vfloat)((vint)a & 0x7fffffff);
}
INLINE vint abs(vint a)
{
    return max(a, -a);
}
INLINE float abs(float a)
{
    return fabsf(a);
}
INLINE int32_t abs(int32_t a)
{
    return a < 0 ? -a : a;
}
INLINE vfloat sign(vfloat a)
{
    return select(a > 0.0f, lanes(1.0f), select(a < 0.0f, lanes(-1.0f), vfloat{}));
}
INLINE float sign(float a)
{
    return a > 0.0f ? 1.0f : a < 0.0f ? -1.0f : 0.0f;
}

// --- conversions between scalars
INLINE vfloat to_float(vint a)
{
    return __builtin_convertvector(a, vfloat);
}
INLINE vfloat to_float(vuint a)
{
    return __builtin_convertvector(a, vfloat);
}
INLINE vfloat to_float(vdouble a)
{
    return __builtin_convertvector(a, vfloat);
}
INLINE vint to_int(vfloat a)
{
    return __builtin_convertvector(a, vint);
}
INLINE vint to_int(vuint a)
{
    return (vint)a;
}
INLINE vuint to_uint(vint a)
{
    return (vuint)a;
}
INLINE vuint to_uint(vfloat a)
{
    return __builtin_convertvector(a, vuint);
}
INLINE vdouble to_double(vfloat a)
{
    return __builtin_convertvector(a, vdouble);
}
INLINE constexpr float to_float(int32_t a)
{
    return (float)a;
}
INLINE constexpr float to_float(uint32_t a)
{
    return (float)a;
}
INLINE constexpr int32_t to_int(uint32_t a)
{
    return (int32_t)a;
}
INLINE constexpr int32_t to_int(float a)
{
    return (int32_t)a;
}
INLINE constexpr uint32_t to_uint(int32_t a)
{
    return (uint32_t)a;
}
INLINE double to_double(float a)
{
    return a;
}
INLINE float to_float(double a)
{
    return (float)a;
}
INLINE bool to_bool(uint32_t a)
{
    return a != 0;
}
INLINE bool to_bool(int32_t a)
{
    return a != 0;
}

// --- vectors. T: a scalar, or its vector over lanes.
template <class T> struct vec2 {
    enum { SIZE = 2 };
    T x, y;
    vec2() = default;
    explicit vec2(T a) : x(a), y(a)
    {
    }
    vec2(T a, T b) : x(a), y(b)
    {
    }
    template <class V, class = decltype(V::y)> explicit vec2(const V &a) : x(a.x), y(a.y)
    {
    }
    T &operator[](int i)
    {
        return (&x)[i];
    }
    const T &operator[](int i) const
    {
        return (&x)[i];
    }
};
template <class T> struct vec3 {
    enum { SIZE = 3 };
    T x, y, z;
    vec3() = default;
    explicit vec3(T a) : x(a), y(a), z(a)
    {
    }
    vec3(T a, T b, T c) : x(a), y(b), z(c)
    {
    }
    vec3(const vec2<T> &a, T b) : x(a.x), y(a.y), z(b)
    {
    }
    vec3(T a, const vec2<T> &b) : x(a), y(b.x), z(b.y)
    {
    }
    template <class V, class = decltype(V::z)> explicit vec3(const V &a) : x(a.x), y(a.y), z(a.z)
    {
    }
    T &operator[](int i)
    {
        return (&x)[i];
    }
    const T &operator[](int i) const
    {
        return (&x)[i];
    }
};
// As std140 lays it out where it is uniform.
template <class T> struct alignas(4 * sizeof(T)) vec4 {
    enum { SIZE = 4 };
    T x, y, z, w;
    vec4() = default;
    explicit vec4(T a) : x(a), y(a), z(a), w(a)
    {
    }
    vec4(T a, T b, T c, T d) : x(a), y(b), z(c), w(d)
    {
    }
    vec4(const vec3<T> &a, T b) : x(a.x), y(a.y), z(a.z), w(b)
    {
    }
    vec4(T a, const vec3<T> &b) : x(a), y(b.x), z(b.y), w(b.z)
    {
    }
    vec4(const vec2<T> &a, T b, T c) : x(a.x), y(a.y), z(b), w(c)
    {
    }
    vec4(T a, const vec2<T> &b, T c) : x(a), y(b.x), z(b.y), w(c)
    {
    }
    vec4(const vec2<T> &a, const vec2<T> &b) : x(a.x), y(a.y), z(b.x), w(b.y)
    {
    }
    T &operator[](int i)
    {
        return (&x)[i];
    }
    const T &operator[](int i) const
    {
        return (&x)[i];
    }
};
template <class T> constexpr bool is_vector = false;
template <class T> constexpr bool is_vector<vec2<T>> = true;
template <class T> constexpr bool is_vector<vec3<T>> = true;
template <class T> constexpr bool is_vector<vec4<T>> = true;
#define VECTOR template <class> class V
#define IF_VECTOR(T) class = std::enable_if_t<is_vector<V<T>>>

// f of each component, or of each pair of components. Written out: a loop would keep vectors in memory.
template <class T, class F> INLINE auto map(const vec2<T> &a, F f)
{
    return vec2<decltype(f(a.x))>(f(a.x), f(a.y));
}
template <class T, class F> INLINE auto map(const vec3<T> &a, F f)
{
    return vec3<decltype(f(a.x))>(f(a.x), f(a.y), f(a.z));
}
template <class T, class F> INLINE auto map(const vec4<T> &a, F f)
{
    return vec4<decltype(f(a.x))>(f(a.x), f(a.y), f(a.z), f(a.w));
}
template <class T, class U, class F> INLINE auto map(const vec2<T> &a, const vec2<U> &b, F f)
{
    return vec2<decltype(f(a.x, b.x))>(f(a.x, b.x), f(a.y, b.y));
}
template <class T, class U, class F> INLINE auto map(const vec3<T> &a, const vec3<U> &b, F f)
{
    return vec3<decltype(f(a.x, b.x))>(f(a.x, b.x), f(a.y, b.y), f(a.z, b.z));
}
template <class T, class U, class F> INLINE auto map(const vec4<T> &a, const vec4<U> &b, F f)
{
    return vec4<decltype(f(a.x, b.x))>(f(a.x, b.x), f(a.y, b.y), f(a.z, b.z), f(a.w, b.w));
}
// All components, one after the other, by f of what came before and the next one.
template <class T, class F> INLINE auto fold(const vec2<T> &a, F f)
{
    return f(a.x, a.y);
}
template <class T, class F> INLINE auto fold(const vec3<T> &a, F f)
{
    return f(f(a.x, a.y), a.z);
}
template <class T, class F> INLINE auto fold(const vec4<T> &a, F f)
{
    return f(f(f(a.x, a.y), a.z), a.w);
}

#define OPERATOR(op)                                                                               \
    template <VECTOR, class T, IF_VECTOR(T)> INLINE V<T> operator op(const V<T> &a, const V<T> &b) \
    {                                                                                              \
        return map(a, b, [](T p, T q) { return p op q; });                                         \
    }                                                                                              \
    template <VECTOR, class T, IF_VECTOR(T)> INLINE V<T> operator op(const V<T> &a, T b)           \
    {                                                                                              \
        return map(a, [b](T p) { return p op b; });                                                \
    }                                                                                              \
    template <VECTOR, class T, IF_VECTOR(T)> INLINE V<T> operator op(T a, const V<T> &b)           \
    {                                                                                              \
        return map(b, [a](T p) { return a op p; });                                                \
    }
OPERATOR(+)
OPERATOR(-)
OPERATOR(*)
OPERATOR(/)
OPERATOR(%)
OPERATOR(&)
OPERATOR(|)
OPERATOR(<<)
OPERATOR(>>)
#undef OPERATOR
template <VECTOR, class T, IF_VECTOR(T)> INLINE V<T> operator-(const V<T> &a)
{
    return map(a, [](T p) { return -p; });
}
template <VECTOR, class T, IF_VECTOR(T)> INLINE V<T> operator~(const V<T> &a)
{
    return map(a, [](T p) { return ~p; });
}

// --- functions of scalars that are made of those above
INLINE vfloat ceil(vfloat a)
{
    return -floor(-a);
}
INLINE float ceil(float a)
{
    return ceilf(a);
}
INLINE vfloat fract(vfloat a)
{
    return a - floor(a);
}
INLINE float fract(float a)
{
    return a - floorf(a);
}
INLINE vfloat inversesqrt(vfloat a)
{
    return 1.0f / sqrt(a);
}
INLINE float inversesqrt(float a)
{
    return 1.0f / sqrtf(a);
}
INLINE vfloat step(vfloat edge, vfloat a)
{
    return select(a < edge, vfloat{}, lanes(1.0f));
}
INLINE float step(float edge, float a)
{
    return a < edge ? 0.0f : 1.0f;
}

// 2^a: 2^round(a) by the exponent's bits, the rest by a polynomial (Taylor's, on [-1/2, 1/2]: 2e-8).
INLINE vfloat exp2(vfloat a)
{
    a = min(max(a, lanes(-126.0f)), lanes(127.0f));
    vfloat whole = round(a), x = (a - whole) * 0.69314718f;
    vfloat p = 1.0f + x * (1.0f + x * (0.5f + x * (1.66666667e-1f +
                                                   x * (4.16666667e-2f +
                                                        x * (8.3333333e-3f + x * 1.3888889e-3f)))));
    return p * (vfloat)((to_int(whole) + 127) << 23);
}
INLINE float exp2(float a)
{
    return exp2f(a);
}
// log2 of what is above 0: the exponent's bits, and log of the rest in [sqrt(1/2), sqrt(2)] by the series of
// artanh, whose next term is below 1e-8.
INLINE vfloat log2(vfloat a)
{
    vint bits = (vint)a, exponent = ((bits - 0x3f3504f3) >> 23);
    vfloat m = (vfloat)(bits - (exponent << 23));
    vfloat t = (m - 1.0f) / (m + 1.0f), z = t * t;
    vfloat p =
        2.0f + z * (6.6666667e-1f +
                    z * (0.4f + z * (2.8571429e-1f + z * (2.2222222e-1f + z * 1.8181818e-1f))));
    return to_float(exponent) + t * p * 1.44269504f;
}
INLINE float log2(float a)
{
    return log2f(a);
}
INLINE vfloat pow(vfloat a, vfloat b)
{
    return exp2(b * log2(a));
}
INLINE float pow(float a, float b)
{
    return powf(a, b);
}

// a times 2^n, for results of normal size or 0; n beyond a normal number's exponent in two steps.
INLINE vfloat ldexp(vfloat a, vint n)
{
    vint half = n >> 1, rest = n - half;
    half = min(max(half, lanes(-126)), lanes(127));
    rest = min(max(rest, lanes(-126)), lanes(127));
    return a * (vfloat)((half + 127) << 23) * (vfloat)((rest + 127) << 23);
}
INLINE float ldexp(float a, int32_t n)
{
    return ldexpf(a, n);
}
// The significand in [1/2, 1) and the exponent; of 0 both are 0.
INLINE vfloat frexp(vfloat a, vint &exponent)
{
    vbool is_zero = a == 0.0f;
    vint bits = (vint)a;
    exponent = select(is_zero, vint{}, ((bits >> 23) & 0xff) - 126);
    return select(is_zero, a, (vfloat)((bits & (int32_t)0x807fffff) | 0x3f000000));
}

INLINE vint bitCount(vuint a)
{
    a = a - ((a >> 1) & 0x55555555u);
    a = (a & 0x33333333u) + ((a >> 2) & 0x33333333u);
    return (vint)((((a + (a >> 4)) & 0x0f0f0f0fu) * 0x01010101u) >> 24);
}
INLINE vint findLSB(vuint a) // -1 of 0
{
    return select(a == 0u, lanes(-1), bitCount((a & -a) - 1u));
}
INLINE vuint floatBitsToUint(vfloat a)
{
    return (vuint)a;
}
INLINE vfloat uintBitsToFloat(vuint a)
{
    return (vfloat)a;
}
INLINE float uintBitsToFloat(uint32_t a)
{
    float f;
    memcpy(&f, &a, sizeof f);
    return f;
}
INLINE vdouble packDouble2x32(const vec2<vuint> &a)
{
    typedef uint64_t words __attribute__((vector_size(8 * LANES)));
    return (vdouble)(__builtin_convertvector(a.x, words) | __builtin_convertvector(a.y, words)
                                                               << 32);
}

// A bool as a number: its lanes are 0 or -1.
INLINE vfloat bool_to_float(vbool a)
{
    return (vfloat)(a & 0x3f800000);
}
INLINE vint bool_to_int(vbool a)
{
    return a & 1;
}
INLINE vuint bool_to_uint(vbool a)
{
    return (vuint)(a & 1);
}
INLINE float bool_to_float(bool a)
{
    return a ? 1.0f : 0.0f;
}
INLINE int32_t bool_to_int(bool a)
{
    return a;
}
INLINE uint32_t bool_to_uint(bool a)
{
    return a;
}
INLINE vbool to_bool(vint a)
{
    return a != 0;
}

// --- clamp, mix and comparisons of scalars
#define FOR_SCALAR(T)                                                                              \
    INLINE T clamp(T a, T low, T high)                                                             \
    {                                                                                              \
        return min(max(a, low), high);                                                             \
    }
FOR_SCALAR(vfloat)
FOR_SCALAR(vint)
FOR_SCALAR(vuint)
FOR_SCALAR(float)
FOR_SCALAR(int32_t)
FOR_SCALAR(uint32_t)
#undef FOR_SCALAR
INLINE vfloat smoothstep(vfloat low, vfloat high, vfloat a)
{
    vfloat t = clamp((a - low) / (high - low), vfloat{}, lanes(1.0f));
    return t * t * (3.0f - 2.0f * t);
}
INLINE vfloat mix(vfloat a, vfloat b, vfloat t)
{
    return a + (b - a) * t;
}
INLINE float mix(float a, float b, float t)
{
    return a + (b - a) * t;
}
INLINE vfloat mix(vfloat a, vfloat b, vbool t)
{
    return select(t, b, a);
}
INLINE auto equal(vfloat a, vfloat b)
{
    return a == b;
}
INLINE auto equal(vint a, vint b)
{
    return a == b;
}
INLINE auto equal(vuint a, vuint b)
{
    return (vbool)(a == b);
}
template <class T, class = std::enable_if_t<std::is_arithmetic_v<T>>> INLINE bool equal(T a, T b)
{
    return a == b;
}

// --- by component
#define BY_ONE(name)                                                                               \
    template <VECTOR, class T, IF_VECTOR(T)> INLINE auto name(const V<T> &a)                       \
    {                                                                                              \
        return map(a, [](T p) { return name(p); });                                                \
    }
#define BY_TWO(name)                                                                               \
    template <VECTOR, class T, class U, IF_VECTOR(T)>                                              \
    INLINE auto name(const V<T> &a, const V<U> &b)                                                 \
    {                                                                                              \
        return map(a, b, [](T p, U q) { return name(p, q); });                                     \
    }                                                                                              \
    template <VECTOR, class T, IF_VECTOR(T)> INLINE auto name(const V<T> &a, T b)                  \
    {                                                                                              \
        return map(a, [b](T p) { return name(p, b); });                                            \
    }                                                                                              \
    template <VECTOR, class T, IF_VECTOR(T)> INLINE auto name(T a, const V<T> &b)                  \
    {                                                                                              \
        return map(b, [a](T p) { return name(a, p); });                                            \
    }
#define COMPARISON(name, op)                                                                       \
    template <VECTOR, class T, IF_VECTOR(T)> INLINE auto name(const V<T> &a, const V<T> &b)        \
    {                                                                                              \
        return map(a, b, [](T p, T q) { return p op q; });                                         \
    }
BY_ONE(abs)
BY_ONE(sign)
BY_ONE(floor)
BY_ONE(ceil)
BY_ONE(round)
BY_ONE(fract)
BY_ONE(sqrt)
BY_ONE(exp2)
BY_ONE(log2)
BY_ONE(lanes)
BY_ONE(to_float)
BY_ONE(to_int)
BY_ONE(to_uint)
BY_ONE(to_double)
BY_ONE(bool_to_float)
BY_ONE(bool_to_int)
BY_ONE(bool_to_uint)
BY_ONE(floatBitsToUint)
BY_TWO(min)
BY_TWO(max)
BY_TWO(step)
BY_TWO(pow)
BY_TWO(ldexp)
COMPARISON(lessThan, <)
COMPARISON(lessThanEqual, <=)
COMPARISON(greaterThan, >)
COMPARISON(greaterThanEqual, >=)
#undef BY_ONE
#undef BY_TWO
#undef COMPARISON

template <VECTOR, class T, IF_VECTOR(T)>
INLINE V<T> clamp(const V<T> &a, const V<T> &low, const V<T> &high)
{
    return min(max(a, low), high);
}
template <VECTOR, class T, IF_VECTOR(T)> INLINE V<T> clamp(const V<T> &a, T low, T high)
{
    return min(max(a, low), high);
}
template <VECTOR, class T, IF_VECTOR(T)> INLINE V<T> mix(const V<T> &a, const V<T> &b, T t)
{
    return map(a, b, [t](T p, T q) { return mix(p, q, t); });
}
template <VECTOR, class T, class U, IF_VECTOR(T)>
INLINE V<T> mix(const V<T> &a, const V<T> &b, const V<U> &t)
{
    V<T> result;
    for (int i = 0; i < V<T>::SIZE; i++)
        result[i] = mix(a[i], b[i], t[i]);
    return result;
}
template <VECTOR, class T, IF_VECTOR(T)> INLINE V<T> select(vbool m, const V<T> &a, const V<T> &b)
{
    return map(a, b, [m](T p, T q) { return select(m, p, q); });
}
template <VECTOR, class T, IF_VECTOR(T)> INLINE auto equal(const V<T> &a, const V<T> &b)
{
    return all(map(a, b, [](T p, T q) { return equal(p, q); }));
}
template <VECTOR, class T, IF_VECTOR(T)> INLINE T any(const V<T> &a)
{
    return fold(a, [](T p, T q) { return (T)(p | q); });
}
template <VECTOR, class T, IF_VECTOR(T)> INLINE T all(const V<T> &a)
{
    return fold(a, [](T p, T q) { return (T)(p & q); });
}

// --- geometry
template <VECTOR, class T, IF_VECTOR(T)> INLINE T dot(const V<T> &a, const V<T> &b)
{
    return fold(a * b, [](T p, T q) { return p + q; });
}
template <VECTOR, class T, IF_VECTOR(T)> INLINE T length(const V<T> &a)
{
    return sqrt(dot(a, a));
}
template <VECTOR, class T, IF_VECTOR(T)> INLINE T distance(const V<T> &a, const V<T> &b)
{
    return length(a - b);
}
template <VECTOR, class T, IF_VECTOR(T)> INLINE V<T> normalize(const V<T> &a)
{
    return a * inversesqrt(dot(a, a));
}
template <class T> INLINE vec3<T> cross(const vec3<T> &a, const vec3<T> &b)
{
    return vec3<T>(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

// --- square matrices, by columns
template <VECTOR, class T> struct matrix {
    V<T> column[V<T>::SIZE];
    matrix() = default;
    explicit matrix(T diagonal)
    {
        for (int i = 0; i < V<T>::SIZE; i++) {
            column[i] = V<T>(T{});
            column[i][i] = diagonal;
        }
    }
    template <class... More> matrix(const V<T> &first, const More &...more) : column{first, more...}
    {
    }
    matrix(T a, T b, T c, T d) : column{V<T>(a, b), V<T>(c, d)}
    {
    }
    matrix(T a, T b, T c, T d, T e, T f, T g, T h, T i)
        : column{V<T>(a, b, c), V<T>(d, e, f), V<T>(g, h, i)}
    {
    }
    V<T> &operator[](int i)
    {
        return column[i];
    }
    const V<T> &operator[](int i) const
    {
        return column[i];
    }
};
template <class T> using mat2 = matrix<vec2, T>;
template <class T> using mat3 = matrix<vec3, T>;
template <VECTOR, class T> INLINE V<T> operator*(const matrix<V, T> &a, const V<T> &b)
{
    V<T> sum = a[0] * b.x;
    for (int i = 1; i < V<T>::SIZE; i++)
        sum = sum + a[i] * b[i];
    return sum;
}
template <VECTOR, class T> INLINE V<T> operator*(const V<T> &a, const matrix<V, T> &b)
{
    V<T> result;
    for (int i = 0; i < V<T>::SIZE; i++)
        result[i] = dot(a, b[i]);
    return result;
}
template <VECTOR, class T>
INLINE matrix<V, T> operator*(const matrix<V, T> &a, const matrix<V, T> &b)
{
    matrix<V, T> result;
    for (int i = 0; i < V<T>::SIZE; i++)
        result[i] = a * b[i];
    return result;
}
template <VECTOR, class T> INLINE matrix<V, T> transpose(const matrix<V, T> &a)
{
    matrix<V, T> result;
    for (int i = 0; i < V<T>::SIZE; i++)
        for (int j = 0; j < V<T>::SIZE; j++)
            result[i][j] = a[j][i];
    return result;
}
template <VECTOR, class T> INLINE auto lanes(const matrix<V, T> &a)
{
    matrix<V, decltype(lanes(a[0].x))> result;
    for (int i = 0; i < V<T>::SIZE; i++)
        result[i] = lanes(a[i]);
    return result;
}
template <VECTOR, class T>
INLINE matrix<V, T> select(vbool m, const matrix<V, T> &a, const matrix<V, T> &b)
{
    matrix<V, T> result;
    for (int i = 0; i < V<T>::SIZE; i++)
        result[i] = select(m, a[i], b[i]);
    return result;
}

// --- components by number, and elements by a number that differs from lane to lane
template <int I, int J, class V> INLINE auto swizzle(const V &a)
{
    return vec2<std::decay_t<decltype(a.x)>>(a[I], a[J]);
}
template <int I, int J, int K, class V> INLINE auto swizzle(const V &a)
{
    return vec3<std::decay_t<decltype(a.x)>>(a[I], a[J], a[K]);
}
template <int I, int J, int K, int L, class V> INLINE auto swizzle(const V &a)
{
    return vec4<std::decay_t<decltype(a.x)>>(a[I], a[J], a[K], a[L]);
}

template <class T, int N> struct array {
    enum { SIZE = N };
    T at[N];
    T &operator[](int i)
    {
        return at[i];
    }
    const T &operator[](int i) const
    {
        return at[i];
    }
};
template <class T, int N>
INLINE array<T, N> select(vbool m, const array<T, N> &a, const array<T, N> &b)
{
    array<T, N> result;
    for (int i = 0; i < N; i++)
        result[i] = select(m, a[i], b[i]);
    return result;
}
template <class T, int N> INLINE auto lanes(const array<T, N> &a)
{
    array<decltype(lanes(a[0])), N> result;
    for (int i = 0; i < N; i++)
        result[i] = lanes(a[i]);
    return result;
}
// Of an array or a vector; an index beyond the last takes the last, one below the first the first.
template <class A, class I> INLINE auto pick(const A &a, I at)
{
    auto result = a[0];
    for (int i = 1; i < A::SIZE; i++)
        result = select((vbool)((vint)at >= i), a[i], result);
    return result;
}
template <class A, class I, class T> INLINE void put_at(A &a, I at, const T &value, vbool m)
{
    for (int i = 0; i < A::SIZE; i++)
        a[i] = select(m & (vbool)((vint)at == i), value, a[i]);
}

// --- memory. An index is brought inside; where there is nothing at all, everything reads as 0.
INLINE vint inside(vint at, uint32_t n)
{
    return min(max(at, vint{}), lanes((int32_t)n - 1));
}
// Of 32-bit words.
INLINE vint gather(const void *words, vint at)
{
#if LANES == 16 && defined(__AVX512F__)
    return (vint)_mm512_i32gather_epi32((__m512i)at, words, 4);
#elif LANES == 8 && defined(__AVX2__)
    return (vint)_mm256_i32gather_epi32((const int *)words, (__m256i)at, 4);
#else
    vint result;
    for (int i = 0; i < LANES; i++)
        result[i] = ((const int32_t *)words)[at[i]];
    return result;
#endif
}
INLINE void scatter(void *words, vint at, vint value, vbool m)
{
#if LANES == 16 && defined(__AVX512F__)
    _mm512_mask_i32scatter_epi32(words, _mm512_test_epi32_mask((__m512i)m, (__m512i)m), (__m512i)at,
                                 (__m512i)value, 4);
#else
    for (int i = 0; i < LANES; i++)
        if (m[i])
            ((int32_t *)words)[at[i]] = value[i];
#endif
}

// A buffer's open array, or what a workgroup shares: n elements, each as many words as T has scalars.
template <class T> struct memory {
    uint32_t *words;
    uint32_t n;
};
// visit(a, b, f): f of each pair of scalars; of structs it is written beside them.
template <class F> INLINE void visit(vfloat &a, F &&f)
{
    vint bits = (vint)a;
    f(bits);
    a = (vfloat)bits;
}
template <class F> INLINE void visit(vint &a, F &&f)
{
    f(a);
}
template <class F> INLINE void visit(vuint &a, F &&f)
{
    vint bits = (vint)a;
    f(bits);
    a = (vuint)bits;
}
template <VECTOR, class T, class F, IF_VECTOR(T)> INLINE void visit(V<T> &a, F &&f)
{
    for (int i = 0; i < V<T>::SIZE; i++)
        visit(a[i], f);
}
template <class T> INLINE int words_of()
{
    return (int)(sizeof(T) / (4 * LANES));
}
template <class T> INLINE T load_at(const memory<T> &from, vint at)
{
    T result = {};
    if (from.n == 0)
        return result;
    vint first = inside(at, from.n) * words_of<T>();
    visit(result, [&](vint &word) { word = gather(from.words, first), first += 1; });
    return result;
}
template <class T> INLINE void store_at(const memory<T> &to, vint at, T value, vbool m)
{
    m &= (at >= 0) & (at < (int32_t)to.n);
    vint first = at * words_of<T>();
    visit(value, [&](vint &word) { scatter(to.words, first, word, m), first += 1; });
}
// One after the other, in the order of the lanes; what was there before each.
INLINE vuint atomicAdd(uint32_t &sum, vuint more, vbool m)
{
    vuint before = {};
    for (int i = 0; i < LANES; i++) {
        before[i] = sum;
        sum += m[i] ? more[i] : 0;
    }
    return before;
}
INLINE vuint atomicMax(uint32_t &most, vuint other, vbool m)
{
    vuint before = {};
    for (int i = 0; i < LANES; i++) {
        before[i] = most;
        most = m[i] && other[i] > most ? other[i] : most;
    }
    return before;
}

// A constant array, by an index that differs from lane to lane.
template <class T, int N, class I> INLINE auto gather_at(const T (&of)[N], I at)
{
    auto result = lanes(of[0]);
    for (int i = 1; i < N; i++)
        result = select((vbool)((vint)at >= i), lanes(of[i]), result);
    return result;
}

typedef native_image image;
INLINE vint pixel_word(const image &of, const vec2<vint> &p)
{
    return inside(p.y, (uint32_t)of.height) * of.width + inside(p.x, (uint32_t)of.width);
}
// Four words that lie together, of each lane: whole loads and a transposition, which is faster than four gathers.
#if LANES == 16 && defined(__AVX512F__)
INLINE __m512i load_quads(const uint32_t *words, vint first, int lane)
{
    __m512i quads = _mm512_castsi128_si512(_mm_loadu_si128((const __m128i *)(words + first[lane])));
    quads =
        _mm512_inserti32x4(quads, _mm_loadu_si128((const __m128i *)(words + first[lane + 4])), 1);
    quads =
        _mm512_inserti32x4(quads, _mm_loadu_si128((const __m128i *)(words + first[lane + 8])), 2);
    return _mm512_inserti32x4(quads, _mm_loadu_si128((const __m128i *)(words + first[lane + 12])),
                              3);
}
template <class T> INLINE vec4<T> quad_of(const uint32_t *words, vint first)
{
    __m512i a = load_quads(words, first, 0), b = load_quads(words, first, 1);
    __m512i c = load_quads(words, first, 2), d = load_quads(words, first, 3);
    __m512i ab = _mm512_unpacklo_epi32(a, b), cd = _mm512_unpacklo_epi32(c, d);
    __m512i ab_high = _mm512_unpackhi_epi32(a, b), cd_high = _mm512_unpackhi_epi32(c, d);
    return vec4<T>((T)_mm512_unpacklo_epi64(ab, cd), (T)_mm512_unpackhi_epi64(ab, cd),
                   (T)_mm512_unpacklo_epi64(ab_high, cd_high),
                   (T)_mm512_unpackhi_epi64(ab_high, cd_high));
}
#elif LANES == 8 && defined(__AVX2__)
INLINE __m256i load_quads(const uint32_t *words, vint first, int lane)
{
    __m256i quads = _mm256_castsi128_si256(_mm_loadu_si128((const __m128i *)(words + first[lane])));
    return _mm256_inserti128_si256(quads,
                                   _mm_loadu_si128((const __m128i *)(words + first[lane + 4])), 1);
}
template <class T> INLINE vec4<T> quad_of(const uint32_t *words, vint first)
{
    __m256i a = load_quads(words, first, 0), b = load_quads(words, first, 1);
    __m256i c = load_quads(words, first, 2), d = load_quads(words, first, 3);
    __m256i ab = _mm256_unpacklo_epi32(a, b), cd = _mm256_unpacklo_epi32(c, d);
    __m256i ab_high = _mm256_unpackhi_epi32(a, b), cd_high = _mm256_unpackhi_epi32(c, d);
    return vec4<T>((T)_mm256_unpacklo_epi64(ab, cd), (T)_mm256_unpackhi_epi64(ab, cd),
                   (T)_mm256_unpacklo_epi64(ab_high, cd_high),
                   (T)_mm256_unpackhi_epi64(ab_high, cd_high));
}
#else
template <class T> INLINE vec4<T> quad_of(const uint32_t *words, vint first)
{
    return vec4<T>((T)gather(words, first), (T)gather(words, first + 1),
                   (T)gather(words, first + 2), (T)gather(words, first + 3));
}
#endif
// The words of lanes. Groups of pixels have four pixels of a row in four lanes (shaders/groups.glsl); where the words of
// all lanes lie together in this way, four at a time are loaded and stored, which is faster than gathers and scatters.
struct place {
    vint word;
    bool in_fours;
};
INLINE place place_of(vint word)
{
#if LANES == 16 && defined(__AVX512F__)
    __m512i fours = _mm512_add_epi32(_mm512_shuffle_epi32((__m512i)word, _MM_PERM_AAAA),
                                     _mm512_broadcast_i32x4(_mm_setr_epi32(0, 1, 2, 3)));
    return {word, _mm512_cmpeq_epi32_mask((__m512i)word, fours) == 0xffff};
#elif LANES == 8 && defined(__AVX2__)
    __m256i fours = _mm256_add_epi32(_mm256_shuffle_epi32((__m256i)word, 0),
                                     _mm256_setr_epi32(0, 1, 2, 3, 0, 1, 2, 3));
    return {word, _mm256_movemask_epi8(_mm256_cmpeq_epi32((__m256i)word, fours)) == -1};
#else
    return {word, false};
#endif
}
INLINE vint load_words(const uint32_t *words, const place &at)
{
#if (LANES == 16 && defined(__AVX512F__)) || (LANES == 8 && defined(__AVX2__))
    if (at.in_fours)
        return (vint)load_quads(words, at.word, 0);
#endif
    return gather(words, at.word);
}
INLINE void store_words(uint32_t *words, const place &at, vint value, vbool m)
{
#if (LANES == 16 && defined(__AVX512F__)) || (LANES == 8 && defined(__AVX2__))
    if (at.in_fours) {
        for (int k = 0; k < LANES; k += 4) {
            __m128i four, of_four;
            memcpy(&four, (const char *)&value + 4 * k, sizeof four);
            memcpy(&of_four, (const char *)&m + 4 * k, sizeof of_four);
            _mm_maskstore_epi32((int *)words + at.word[k], of_four, four);
        }
        return;
    }
#endif
    scatter(words, at.word, value, m);
}
template <class T> struct image2D : image {
};
template <class T> INLINE vec4<T> imageLoad(const image2D<T> &of, const vec2<vint> &p)
{
    place at = place_of(pixel_word(of, p));
    auto channel = [&](int i) {
        return i < of.channels ? (T)load_words(of.words + (size_t)i * of.channel_words, at) : T{};
    };
    return vec4<T>(channel(0), channel(1), channel(2), channel(3));
}
template <class T>
INLINE void imageStore(const image2D<T> &of, const vec2<vint> &p, const vec4<T> &value, vbool m)
{
    place at = place_of(pixel_word(of, p));
    for (int i = 0; i < of.channels; i++)
        store_words(of.words + (size_t)i * of.channel_words, at, (vint)value[i], m);
}
template <class T> INLINE vec4<T> texelFetch(const image2D<T> &of, const vec2<vint> &p)
{
    return imageLoad(of, p);
}
// Eight bits a channel, as a device stores them.
struct bytes2D : image {
};
INLINE void imageStore(const bytes2D &of, const vec2<vint> &p, const vec4<vfloat> &value, vbool m)
{
    vint word = {};
    for (int i = 0; i < 4; i++)
        word |= to_int(round(255.0f * clamp(value[i], lanes(0.0f), lanes(1.0f)))) << (8 * i);
    store_words(of.words, place_of(pixel_word(of, p)), word, m);
}
// An image by linear interpolation within a level, which is a whole number.
struct picture2D : native_picture {
};
INLINE vec2<int32_t> textureSize(const picture2D &of, int)
{
    return vec2<int32_t>(of.width, of.height);
}
// Texels before and after a place along a side of `size` texels, and how far it is between their middles.
INLINE void place_texels(vfloat at, vint size, bool repeats, vint &before, vint &after,
                         vfloat &share)
{
    vfloat x = at * to_float(size) - 0.5f, whole = floor(x);
    share = x - whole;
    if (repeats) {
        vfloat n = to_float(size);
        before = to_int(whole - floor(whole / n) * n);
        after = to_int(whole + 1.0f - floor((whole + 1.0f) / n) * n);
    } else {
        vfloat n = to_float(size - 1);
        before = to_int(clamp(whole, vfloat{}, n));
        after = to_int(clamp(whole + 1.0f, vfloat{}, n));
    }
    before = clamp(before, vint{}, size - 1);
    after = clamp(after, vint{}, size - 1);
}
INLINE vec4<vfloat> textureLod(const picture2D &of, const vec2<vfloat> &st, vfloat lod)
{
    vec4<vfloat> result(vfloat{});
    if (of.n_levels == 0)
        return result;
    vint level = inside(to_int(round(lod)), (uint32_t)of.n_levels), first = gather(of.first, level);
    vint width = max(of.width >> level, lanes(1)), height = max(of.height >> level, lanes(1));
    vint left, right, above, below;
    vfloat x, y;
    place_texels(st.x, width, of.repeats_s, left, right, x);
    place_texels(st.y, height, of.repeats_t, above, below, y);
    for (int i = 0; i < 4; i++) {
        vfloat a = (vfloat)gather(of.texels, (first + above * width + left) * 4 + i);
        vfloat b = (vfloat)gather(of.texels, (first + above * width + right) * 4 + i);
        vfloat c = (vfloat)gather(of.texels, (first + below * width + left) * 4 + i);
        vfloat d = (vfloat)gather(of.texels, (first + below * width + right) * 4 + i);
        result[i] = mix(mix(a, b, x), mix(c, d, x), y);
    }
    return result;
}

// A buffer texture, of four words a texel.
template <class T> struct buffer_texture {
    const uint32_t *words;
    uint32_t n; // texels
};
template <class T> INLINE vec4<T> texelFetch(const buffer_texture<T> &of, vint at)
{
    if (of.n == 0)
        return vec4<T>(T{});
    return quad_of<T>(of.words, inside(at, of.n) * 4);
}

// Points that are made where they are asked for, a place for each lane.
struct made_texture {
    native_made_texels from;
    uint32_t node[LANES], part[LANES];
    float texels[LANES][NATIVE_PATCH_TEXELS][4];
};
INLINE vec4<vfloat> texelFetch(const made_texture &of, vint at)
{
    return quad_of<vfloat>((const uint32_t *)of.texels,
                           inside(at, LANES * NATIVE_PATCH_TEXELS) * 4);
}
INLINE vuint makeTexels(made_texture &of, vuint node, vuint part, vbool m)
{
    vint at = {};
    for (int i = 0; i < LANES; i++) {
        at[i] = i * NATIVE_PATCH_TEXELS;
        if (!m[i] || (of.node[i] == (uint32_t)node[i] && of.part[i] == (uint32_t)part[i]))
            continue;
        of.node[i] = (uint32_t)node[i];
        of.part[i] = (uint32_t)part[i];
        of.from.make(of.from.owner, of.node[i], of.part[i], of.texels[i]);
    }
    return (vuint)at;
}

// --- what a host binds
INLINE void set(made_texture &to, const native_made_texels &from)
{
    to.from = from;
    for (int i = 0; i < LANES; i++)
        to.node[i] = to.part[i] = UINT32_MAX;
}
template <class T> INLINE void set(image2D<T> &to, const native_image &from)
{
    static_cast<image &>(to) = from;
}
INLINE void set(bytes2D &to, const native_image &from)
{
    static_cast<image &>(to) = from;
}
INLINE void set(picture2D &to, const native_picture &from)
{
    static_cast<native_picture &>(to) = from;
}
template <class T> INLINE void set(buffer_texture<T> &to, const native_texels &from)
{
    to = {from.words, from.n};
}
template <class T> INLINE void set(T &to, const T &from)
{
    to = from;
}
template <VECTOR, class T, int N> INLINE void set(V<T> &to, const T (&from)[N])
{
    for (int i = 0; i < N; i++)
        to[i] = from[i];
}
template <class T, int N> INLINE void share(memory<T> &to, uint32_t (&words)[N])
{
    to = {words, (uint32_t)(N / words_of<T>())};
}

// A program's name in the instruction set that this unit is compiled for.
#define JOINED(name, set) name##_##set
#define JOIN(name, set) JOINED(name, set)
#define SYMBOL(name) JOIN(native_##name, LANE_SET)

// Runs a program's workgroups, as many in a row as shaders/list.glsl says.
template <class P> void run(const native_bindings &bindings, uint32_t first, uint32_t end)
{
    const uint32_t row = 32768;
    P program;
    program.take(bindings);
    enum { VECTORS = (P::LOCAL_SIZE + LANES - 1) / LANES };
    vint iota;
    for (int i = 0; i < LANES; i++)
        iota[i] = i;
    for (uint32_t group = first; group < end; group++) {
        program.gl_WorkGroupID = vec3<uint32_t>(group % row, group / row, 0);
        for (int part = 0; part < P::N_PARTS; part++)
            for (int vector = 0; vector < VECTORS; vector++) {
                vint index = iota + vector * LANES;
                program.gl_LocalInvocationIndex = (vuint)index;
                program.invoke(part, vector, index < (int)P::LOCAL_SIZE);
            }
    }
}

#undef VECTOR
#undef IF_VECTOR

} // namespace
