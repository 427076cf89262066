/* Heading as an integer: exact wrapping, no loss of resolution after any number of turns. */
#ifndef LACONIC_HEADING_H
#define LACONIC_HEADING_H

#include "turn.h"

#define HALF_TURN_BIT ((laconic_turn)1 << (TURN_BITS - 1))

/* The largest angle one step may turn: whole turns must fit signed_turn. */
#define LARGEST_TURN_RAD (HALF_TURN * R(2))

/* A step begins only within 2⁶² turns: what it adds, below 2⁶² turns as well, then fits the count. */
static inline bool heading_has_room(const laconic_heading *heading) {
    return !LACONIC_WITH_POSE || (uint64_t)heading->turns + ((uint64_t)1 << 62) < (uint64_t)1 << 63;
}

/* Turns on by an angle and returns the heading half-way, as a turn: where the mid-step pose looks. */
static inline laconic_turn heading_advance(laconic_heading *heading, real angle_rad) {
    const real turns = angle_rad * R(0.1591549430918953358); /* 1/2π */
    const signed_turn whole = (signed_turn)turns;
    const real wanted = (turns - (real)whole) * HALF_TURN + heading->rest;
    const signed_turn half = (signed_turn)wanted; /* half of the part of a turn, in units */
    const laconic_turn old = heading->fraction;
    const laconic_turn odd = (laconic_turn)whole << (TURN_BITS - 1);
    heading->rest = wanted - (real)half;
    heading->fraction = (laconic_turn)(old + 2U * (laconic_turn)half);
    heading->turns += whole - (half < 0) + (heading->fraction < old); /* the carry of old + half, signed */
    return (laconic_turn)(old + (laconic_turn)half + odd);
}

/* The part beyond whole turns, in (−π, π]. */
static inline real heading_wrapped(const laconic_heading *heading) {
    const signed_turn part = (signed_turn)heading->fraction;
    if (heading->fraction == HALF_TURN_BIT) return R(3.14159265358979323846);
    return (real)part * (R(3.14159265358979323846) / HALF_TURN);
}

static inline real heading_unwrapped(const laconic_heading *heading) {
    const int64_t turns = heading->turns + (heading->fraction > HALF_TURN_BIT);
    return (real)turns * R(6.28318530717958647693) + heading_wrapped(heading);
}

#endif
