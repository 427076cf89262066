/* heading.h for lanes, bit by bit the same: processors without AVX-512 have no conversions between 64-bit integers and
 * doubles for many lanes, so here they are made of additions. */
#ifndef LACONIC_LANES_HEADING_H
#define LACONIC_LANES_HEADING_H
#define LACONIC_HEADING_H /* stands in for it */

#include "../src/elementary.h"
#include "../src/polynomials.h"
#include "../src/vector.h"

#ifdef LACONIC_SINGLE
#define BINARY_ANGLE_BITS 32
#define BINARY_ANGLE_UNIT_RAD R(1.4629180792671596811e-9) /* 2π/2³² */
#define HALF_TURN R(2147483648.0)                         /* 2³¹ units */
#else
#define BINARY_ANGLE_BITS 64
#define BINARY_ANGLE_UNIT_RAD R(3.4061215800865545893e-19) /* 2π/2⁶⁴ */
#define HALF_TURN R(9223372036854775808.0)                 /* 2⁶³ units */
#endif

/* Below a turn: a lane that yaws further in one step leaves the usual way. */
#define LARGEST_YAW_CHANGE_RAD R(6)

static inline vector lanes_where(verdict which, vector a, vector b) {
    return vector_of(lanes_chosen(which, a.x, b.x), lanes_chosen(which, a.y, b.y), lanes_chosen(which, a.z, b.z));
}

/* ------------------------------------------------- numbers as integers, and back -- */

typedef struct lanes_integer { /* a number cut to its whole part: as an integer, and as a number, 0 without a sign */
    verdict integer;
    real whole;
} lanes_integer;

#if defined(LACONIC_SINGLE) || defined(LANES_WITH_CONVERSIONS)

static inline real lanes_number(verdict integer) { return __builtin_convertvector(integer, real); }

/* |x| < half the range of the integers. */
static inline lanes_integer lanes_cut(real x) {
    lanes_integer cut;
    cut.integer = __builtin_convertvector(x, verdict);
    cut.whole = lanes_number(cut.integer);
    return cut;
}

#else

#define MAGIC_INTEGER R(6755399441055744.0) /* 1.5·2⁵²: a number below 2⁵¹ added to it stands in the last bits */

/* Both halves as numbers, the upper one exact; one rounding when they are added. */
static inline real lanes_number(verdict integer) {
    const verdict low = (integer & 0xffffffff) | (verdict)R(4503599627370496.0);        /* + 2⁵²      */
    const verdict high = (verdict)((laconic_binary_angle)(integer ^ INT64_MIN) >> 32) | /* + 2⁶³ …    */
                         (verdict)R(19342813113834066795298816.0);                      /* … + 2⁸⁴    */
    return ((real)high - R(19342822341709703277445120.0)) + (real)low;                  /* 2⁸⁴ + 2⁶³ + 2⁵² */
}

/* |x| < 2⁶³: of |x| the part above 2³² rounded, what is left (which may be below 0) cut down. */
static inline lanes_integer lanes_cut(real x) {
    const real size = magnitude(x);
    const verdict sign = x < R(0);
    const real high = size * R(2.3283064365386962890625e-10) + MAGIC_INTEGER;
    const real left = size - (high - MAGIC_INTEGER) * R(4294967296.0);
    const real low = left + MAGIC_INTEGER;
    const verdict above = low - MAGIC_INTEGER > left;
    const verdict cut =
        (((verdict)high - (verdict)MAGIC_INTEGER) << 32) + ((verdict)low - (verdict)MAGIC_INTEGER) + above;
    const real whole =
        (high - MAGIC_INTEGER) * R(4294967296.0) + ((low - MAGIC_INTEGER) - (real)(above & (verdict)R(1)));
    const lanes_integer out = {(cut ^ sign) - sign, (real)((verdict)whole ^ ((verdict)R(-0.0) & sign))};
    return out;
}

#endif

/* ------------------------------------------------------------------- binary angles -- */

/* (cos, sin) of x + quarters · π/2 for |x| <= π/4; of `quarters` the last two bits count. */
static inline direction direction_near(real x, verdict quarters) {
    const real z = x * x, cosine = poly_cos(z), sine = poly_sin(x, z);
    const verdict odd = -(quarters & 1), sign = (quarters & 2) << (BINARY_ANGLE_BITS - 2);
    const verdict minus_sine = (verdict)sine ^ (verdict)R(-0.0);
    const direction d = {(real)((verdict)lanes_chosen(odd, (real)minus_sine, cosine) ^ sign),
                         (real)((verdict)lanes_chosen(odd, cosine, sine) ^ sign)};
    return d;
}

static inline direction direction_of_binary_angle(laconic_binary_angle angle) {
    const laconic_binary_angle eighth = angle + ((laconic_angle_number)1 << (BINARY_ANGLE_BITS - 3));
    const laconic_binary_angle quarters = eighth >> (BINARY_ANGLE_BITS - 2);
    const laconic_binary_angle near = angle - (quarters << (BINARY_ANGLE_BITS - 2));
    return direction_near(lanes_number((verdict)near) * BINARY_ANGLE_UNIT_RAD, (verdict)quarters);
}

static inline laconic_binary_angle lanes_binary_angle_of(real angle_rad) {
    const real turns = angle_rad * R(0.1591549430918953358);
    const verdict known = magnitude(turns) < HALF_TURN;
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
        __builtin_convertvector((verdict)(half.integer < 0) - (verdict)(heading->fraction < old), laconic_turns);
    return old + units;
}

#endif
