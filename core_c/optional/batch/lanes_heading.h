/* heading.h for lanes, bit by bit the same: processors without AVX-512 have no conversions between 64-bit integers and
 * doubles for many lanes, so here they are made of additions. */
#ifndef LACONIC_LANES_HEADING_H
#define LACONIC_LANES_HEADING_H
#define LACONIC_HEADING_H /* stands in for it */

#include "elementary.h"
#include "polynomials.h"
#include "vector.h"

#ifdef LACONIC_SINGLE
typedef int32_t signed_angle;
#define BINARY_ANGLE_BITS 32
#define BINARY_ANGLE_UNIT_RAD R(1.4629180792671596811e-9) /* 2π/2³² */
#define HALF_TURN R(2147483648.0)                         /* 2³¹ units */
#else
typedef int64_t signed_angle;
#define BINARY_ANGLE_BITS 64
#define BINARY_ANGLE_UNIT_RAD R(3.4061215800865545893e-19) /* 2π/2⁶⁴ */
#define HALF_TURN R(9223372036854775808.0)                 /* 2⁶³ units */
#endif

/* Below a turn: a lane that yaws further in one step leaves the usual way. */
#define LARGEST_YAW_CHANGE_RAD R(6)

static inline vector lanes_where(mask which, vector a, vector b) {
    return vector_of(lanes_chosen(which, a.x, b.x), lanes_chosen(which, a.y, b.y), lanes_chosen(which, a.z, b.z));
}

/* ------------------------------------------------- numbers as integers, and back -- */

typedef struct lanes_integer { /* a number cut to its whole part: as an integer, and as a number, 0 without a sign */
    mask integer;
    real whole;
} lanes_integer;

#if defined(LACONIC_SINGLE) || defined(LANES_WITH_CONVERSIONS)

static inline real lanes_number(mask integer) { return __builtin_convertvector(integer, real); }

/* |x| < half the range of the integers; other numbers, and NaN, of lanes that are refused count as 0, since C does not
 * define their conversion. */
static inline lanes_integer lanes_cut(real x) {
    const mask fits = magnitude(x) < HALF_TURN;
    lanes_integer cut;
    cut.integer = __builtin_convertvector((real)((mask)x & fits), mask);
    cut.whole = lanes_number(cut.integer);
    return cut;
}

#else

#define MAGIC_INTEGER R(6755399441055744.0) /* 1.5·2⁵²: a number below 2⁵¹ added to it stands in the last bits */

#ifdef LANES_WITH_AVX

#define MAGIC_MULTIPLE R(442721857769029238784.0) /* 1.5·2⁶⁸: as MAGIC_INTEGER, for multiples of 2¹⁶ */

/* |x| < 2⁶³: of the whole part the multiple of 2¹⁶ that is nearest, and what is left. */
static inline lanes_integer lanes_cut(real x) {
    const real whole = __builtin_ia32_roundpd256(x, 3) + R(0); /* 3: towards 0 */
    const real high = whole + MAGIC_MULTIPLE;
    const real low = (whole - (high - MAGIC_MULTIPLE)) + MAGIC_INTEGER;
    const laconic_binary_angle magic =
        ((laconic_binary_angle)MAGIC_MULTIPLE << 16) + (laconic_binary_angle)MAGIC_INTEGER;
    const laconic_binary_angle sum = ((laconic_binary_angle)high << 16) + (laconic_binary_angle)low; /* may wrap */
    const lanes_integer out = {(mask)(sum - magic), whole};
    return out;
}

#else

/* |x| < 2⁶³: of |x| the part above 2³² rounded, what is left (which may be below 0) cut down. */
static inline lanes_integer lanes_cut(real x) {
    const real size = magnitude(x);
    const mask sign = x < R(0);
    const real high = size * R(2.3283064365386962890625e-10) + MAGIC_INTEGER;
    const real left = size - (high - MAGIC_INTEGER) * R(4294967296.0);
    const real low = left + MAGIC_INTEGER;
    const mask above = low - MAGIC_INTEGER > left;
    const mask cut = (((mask)high - (mask)MAGIC_INTEGER) << 32) + ((mask)low - (mask)MAGIC_INTEGER) + above;
    const real whole = (high - MAGIC_INTEGER) * R(4294967296.0) + ((low - MAGIC_INTEGER) - (real)(above & (mask)R(1)));
    const lanes_integer out = {(cut ^ sign) - sign, (real)((mask)whole ^ ((mask)R(-0.0) & sign))};
    return out;
}

#endif
#endif

/* ------------------------------------------------------------------- binary angles -- */

#define HIGHEST_BIT ((mask)R(-0.0))

/* a where the highest bit of `which` is set, else b. */
static inline real lanes_chosen_by_bit(mask which, real a, real b) {
#if defined(LANES_WITH_AVX) && !defined(LANES_WITH_CONVERSIONS) && !defined(LACONIC_SINGLE)
    return __builtin_ia32_blendvpd256(b, a, (real)which);
#elif defined(LANES_WITH_AVX) && !defined(LANES_WITH_CONVERSIONS)
    return __builtin_ia32_blendvps256(b, a, (real)which);
#else
    return lanes_chosen((mask)(which < 0), a, b);
#endif
}

/* Of an angle an eighth of a turn further on the first two bits count quarters; the others are the way from the nearest
 * quarter, and an eighth of a turn more. That way as a number: */
static inline real lanes_near(laconic_binary_angle eighth_on) {
    const mask left = (mask)(eighth_on << 2 >> 2);
#if defined(LACONIC_SINGLE) || defined(LANES_WITH_CONVERSIONS)
    return lanes_number(left - ((mask){0} + ((signed_angle)1 << (BINARY_ANGLE_BITS - 3))));
#else
    /* Both halves as numbers, 2⁵² and 2⁸⁴ more; the upper one is exact, so that their sum is rounded once. */
    const mask low = (left & 0xffffffff) | (mask)R(4503599627370496.0);
    const mask high = (mask)((laconic_binary_angle)left >> 32) | (mask)R(19342813113834066795298816.0);
    return ((real)high - R(19342813113834066795298816.0 + 2310346608841064448.0)) + (real)low;
#endif
}

static inline direction direction_of_binary_angle(laconic_binary_angle angle) {
    const laconic_binary_angle eighth_on = angle + ((laconic_angle_number)1 << (BINARY_ANGLE_BITS - 3));
    const real x = lanes_near(eighth_on) * BINARY_ANGLE_UNIT_RAD;
    const real z = x * x, cosine = poly_cos(z), sine = poly_sin(x, z);
    const mask odd = (mask)(eighth_on << 1), sign = (mask)eighth_on & HIGHEST_BIT;
    const real minus_sine = (real)((mask)sine ^ HIGHEST_BIT);
    const direction d = {(real)((mask)lanes_chosen_by_bit(odd, minus_sine, cosine) ^ sign),
                         (real)((mask)lanes_chosen_by_bit(odd, cosine, sine) ^ sign)};
    return d;
}

static inline laconic_binary_angle lanes_binary_angle_of(real angle_rad) {
    const real turns = angle_rad * R(0.1591549430918953358);
    const mask known = magnitude(turns) < HALF_TURN;
    const real part = turns - lanes_cut(turns).whole;
    return (laconic_binary_angle)(known & (lanes_cut(part * HALF_TURN).integer << 1));
}

#define laconic_direction_of_binary_angle(angle) direction_of_binary_angle(angle)
#define laconic_binary_angle_of(angle_rad) lanes_binary_angle_of(angle_rad)

/* Adds an angle below LARGEST_YAW_CHANGE_RAD; returns the heading at half of it. */
INLINE laconic_binary_angle heading_advance(laconic_heading *heading, real angle_rad) {
    const real wanted = angle_rad * R(0.1591549430918953358) * HALF_TURN + heading->rest;
    const lanes_integer half = lanes_cut(wanted);
    const laconic_binary_angle old = heading->fraction, units = (laconic_binary_angle)half.integer;
    heading->rest = wanted - half.whole;
    heading->fraction = old + 2U * units;
    heading->turns +=
        __builtin_convertvector((mask)(half.integer < 0) - (mask)(heading->fraction < old), laconic_turns);
    return old + units;
}

#endif
