/* Binary angles: the range of an unsigned integer is one turn, so an angle wraps by itself, exactly. The heading is
 * such an angle with a count of turns: no loss of resolution after any number of them. */
#ifndef LACONIC_HEADING_H
#define LACONIC_HEADING_H

#include "elementary.h"
#include "polynomials.h"

#ifdef LACONIC_SINGLE
typedef int32_t signed_binary_angle;
#define BINARY_ANGLE_BITS 32
#define BINARY_ANGLE_UNIT_RAD R(1.4629180792671596811e-9) /* 2π/2³² */
#define HALF_TURN R(2147483648.0)                         /* 2³¹ units */
#else
typedef int64_t signed_binary_angle;
#define BINARY_ANGLE_BITS 64
#define BINARY_ANGLE_UNIT_RAD R(3.4061215800865545893e-19) /* 2π/2⁶⁴ */
#define HALF_TURN R(9223372036854775808.0)                 /* 2⁶³ units */
#endif

/* (cos, sin) of x + quarters · π/2 for |x| <= π/4. */
static inline direction direction_near(real x, unsigned quarters) {
    const real z = x * x, cosine = poly_cos(z), sine = poly_sin(x, z);
    direction d = {cosine, sine};
    if (quarters & 1U) d = direction_with(-sine, cosine);
    if (quarters & 2U) d = direction_with(-d.cosine, -d.sine);
    return d;
}

static inline direction direction_of_binary_angle(laconic_binary_angle angle) {
    const laconic_binary_angle eighth = (laconic_binary_angle)1 << (BINARY_ANGLE_BITS - 3);
    const unsigned quarters = (unsigned)((laconic_binary_angle)(angle + eighth) >> (BINARY_ANGLE_BITS - 2));
    const laconic_binary_angle remainder =
        (laconic_binary_angle)(angle - ((laconic_binary_angle)quarters << (BINARY_ANGLE_BITS - 2)));
    return direction_near((real)(signed_binary_angle)remainder * BINARY_ANGLE_UNIT_RAD, quarters);
}

#define HALF_TURN_BIT ((laconic_binary_angle)1 << (BINARY_ANGLE_BITS - 1))

/* The largest yaw of one step: its whole turns must fit signed_binary_angle. */
#define LARGEST_YAW_CHANGE_RAD (HALF_TURN * R(2))

/* A step begins only within 2⁶² turns and adds less than 2⁶², so the count does not overflow. */
static inline bool heading_has_room(const laconic_heading *heading) {
    return !LACONIC_WITH_POSE || (uint64_t)heading->turns + ((uint64_t)1 << 62) < (uint64_t)1 << 63;
}

/* Adds an angle below LARGEST_YAW_CHANGE_RAD; returns the heading at half of it, in whose axes a step's displacement
 * is. */
INLINE laconic_binary_angle heading_advance(laconic_heading *heading, real angle_rad) {
    const real turns = angle_rad * R(0.1591549430918953358); /* 1/2π */
    const signed_binary_angle whole = (signed_binary_angle)turns;
    const real wanted = (turns - (real)whole) * HALF_TURN + heading->rest;
    const signed_binary_angle half = (signed_binary_angle)wanted; /* half of the part of a turn, in units */
    const laconic_binary_angle old = heading->fraction;
    const laconic_binary_angle odd = (laconic_binary_angle)whole << (BINARY_ANGLE_BITS - 1);
    heading->rest = wanted - (real)half;
    heading->fraction = (laconic_binary_angle)(old + 2U * (laconic_binary_angle)half);
    heading->turns += whole - (half < 0) + (heading->fraction < old); /* the carry of old + half, signed */
    return (laconic_binary_angle)(old + (laconic_binary_angle)half + odd);
}

/* The part beyond whole turns, in (−π, π]. */
static inline real heading_wrapped(const laconic_heading *heading) {
    const signed_binary_angle part = (signed_binary_angle)heading->fraction;
    if (heading->fraction == HALF_TURN_BIT) return R(3.14159265358979323846);
    return (real)part * (R(3.14159265358979323846) / HALF_TURN);
}

static inline real heading_unwrapped(const laconic_heading *heading) {
    const int64_t turns = heading->turns + (heading->fraction > HALF_TURN_BIT);
    return (real)turns * R(6.28318530717958647693) + heading_wrapped(heading);
}

#endif
