/* The numbers of real.h and the words of common.h where each number stands for many vehicles side by side, one in each
 * lane. The extension of gcc and clang by which numbers are vectors asks for no particular processor.
 *
 * A condition is one for each lane, so nothing branches by it but what all lanes share: a lane that leaves the usual
 * way of a step gets NaN as its displacement, and is found by it. */
#ifndef LACONIC_LANES_H
#define LACONIC_LANES_H

#include "laconic/real.h"

#define LACONIC_LANES_OF(type) __attribute__((vector_size(LACONIC_LANES * sizeof(type)))) type

typedef LACONIC_LANES_OF(laconic_number) laconic_real;
typedef LACONIC_LANES_OF(laconic_angle_number) laconic_binary_angle;
typedef LACONIC_LANES_OF(int64_t) laconic_turns;
#ifdef LACONIC_SINGLE
typedef LACONIC_LANES_OF(int32_t) mask; /* in each lane −1 or 0 */
#else
typedef LACONIC_LANES_OF(int64_t) mask;
#endif

static inline laconic_real lanes_of(laconic_number x) { return x - (laconic_real){0}; }

#define R(x) lanes_of((laconic_number)(x))
#define ZERO {0}
#define NOT(a) (~(a))
#define AND(a, b) ((a) & (b))
#define ALL(a) (!lanes_any(~(a)))
#define ANY(a) lanes_any(a)
#define SELECT(which, a, b) \
    __builtin_choose_expr(__builtin_types_compatible_p(__typeof__(a), laconic_real), lanes_chosen, lanes_where)(which, \
                                                                                                                a, b)
#define MASK_OF(value, which) (which)
#define OR(before, now) ((before) | (now))
#define UNLIKELY(condition, number) lanes_leave((condition), (number))
#define LIKELY(condition, number) (!lanes_leave(~(condition), (number)))
#define KEEP_NAN(number, by) ((void)lanes_leave(NOT((by) == (by)), (number)))
#define ALONE false
#define END_STEP(state, delta, path, moved) (lanes_put_off(state, delta, path, moved), LACONIC_OK)

/* In pieces of one register, of which the last is tested. */
static inline bool lanes_any(mask which) {
#ifdef LANES_WITH_AVX
    typedef long long piece __attribute__((vector_size(32)));
#else
    typedef uint64_t piece;
#endif
    piece part[sizeof(mask) / sizeof(piece)];
    __builtin_memcpy(part, &which, sizeof part);
    for (unsigned i = 1; i < sizeof part / sizeof part[0]; i++) part[0] |= part[i];
#ifdef LANES_WITH_AVX
    return !__builtin_ia32_ptestz256(part[0], part[0]);
#else
    return part[0] != 0;
#endif
}

/* Always false: the lanes that would answer yes become NaN. */
static inline bool lanes_leave(mask which, laconic_real *number) {
    *number = (laconic_real)((mask)*number | which);
    return false;
}

static inline laconic_real lanes_chosen(mask which, laconic_real a, laconic_real b) {
    return (laconic_real)((which & (mask)a) | (~which & (mask)b));
}

static inline laconic_real magnitude(laconic_real x) { return (laconic_real)((mask)x & ~(mask)R(-0.0)); }

#endif
