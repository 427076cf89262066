/* Angles as integers: a turn is the whole range of laconic_turn, so it wraps by itself, exactly. */
#ifndef LACONIC_TURN_H
#define LACONIC_TURN_H

#include "elementary.h"
#include "polynomials.h"

#ifdef LACONIC_SINGLE
typedef int32_t signed_turn;
#define TURN_BITS 32
#define TURN_UNIT R(1.4629180792671596811e-9) /* 2π/2³² */
#define HALF_TURN R(2147483648.0)             /* 2³¹ units */
#else
typedef int64_t signed_turn;
#define TURN_BITS 64
#define TURN_UNIT R(3.4061215800865545893e-19) /* 2π/2⁶⁴ */
#define HALF_TURN R(9223372036854775808.0)     /* 2⁶³ units */
#endif

/* (cos, sin) of x + quarters · π/2 for |x| <= π/4. */
static inline direction direction_near(real x, unsigned quarters) {
    const real z = x * x, cosine = poly_cos(z), sine = poly_sin(x, z);
    direction d = {cosine, sine};
    if (quarters & 1U) d = (direction){-sine, cosine};
    if (quarters & 2U) d = (direction){-d.cosine, -d.sine};
    return d;
}

static inline direction direction_of_turn(laconic_turn turn) {
    const laconic_turn eighth = (laconic_turn)1 << (TURN_BITS - 3);
    const unsigned quarters = (unsigned)((laconic_turn)(turn + eighth) >> (TURN_BITS - 2));
    const laconic_turn near = (laconic_turn)(turn - ((laconic_turn)quarters << (TURN_BITS - 2)));
    return direction_near((real)(signed_turn)near * TURN_UNIT, quarters);
}

#endif
