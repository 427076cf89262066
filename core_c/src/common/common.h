/* What the files of the core share: names, inlining, checks of numbers, compensated sums, refusals. Not for users. */
#ifndef LACONIC_COMMON_H
#define LACONIC_COMMON_H

#ifndef LACONIC_IN_CORE
#define LACONIC_IN_CORE /* build.h */
#endif

#include "laconic/laconic.h"

/* Options that compilers reveal by macros, gcc by all of these and clang by the first two; laconic_self_test() finds
 * the other options when it runs. Only the core's own files are bound to them: a program that uses it may have any. */
#if defined(__FAST_MATH__)
#error "laconic: -ffast-math breaks the compensated sums and the tests for NaN; compile without it"
#elif defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ > 0
#error "laconic: -ffinite-math-only disables every test for NaN; compile without it"
#elif defined(__ASSOCIATIVE_MATH__)
#error "laconic: -fassociative-math (-funsafe-math-optimizations) breaks the compensated sums; compile without it"
#elif defined(__RECIPROCAL_MATH__)
#error "laconic: -freciprocal-math rounds divisions twice, so the bits differ; compile without it"
#endif
#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 16
#error "laconic: this target keeps excess precision (x87); compile with -msse2 -mfpmath=sse"
#endif
#if !defined(LACONIC_SINGLE) && DBL_MANT_DIG != 53
#error "laconic: this target's double has not 64 bits; compile with -DLACONIC_SINGLE, or take laconic_single.c"
#endif

typedef laconic_real real;

/* The methods are compiled for one vehicle, and in core_c/optional/batch for many, one in each lane of a register. They
 * therefore write conditions with these names, as SIMD libraries do. For one vehicle each is the plain operation. */
#ifndef LACONIC_LANES
typedef bool mask;       /* the result of a comparison                                    */
#define R(x) ((real)(x)) /* a literal in the scalar type, converted by the compiler       */
#define ZERO R(0)        /* of a table                                                    */
#define NOT(a) (!(a))
#define AND(a, b) ((a) && (b))
#define ALL(a) (a)                    /* in every lane                                             */
#define ANY(a) (a)                    /* in some lane                                              */
#define SELECT(which, a, b) (a)       /* a where it holds, else b; ANY(which) was tested before    */
#define MASK_OF(value, which) (value) /* the value that ALL(which) had                             */
#define OR(before, now) (now)         /* either holds; ALL(before) was tested before               */
/* Steps seldom take this branch, and lanes never do: the number of such a lane becomes NaN, and the lane takes the step
 * alone. The displacement of the step must depend on the number. */
#define UNLIKELY(condition, number) (condition)
#define LIKELY(condition, number) (condition)
/* Keeps the NaN of a lane where only `by` continues and an angle would lose it. */
#define KEEP_NAN(number, by) ((void)0)
#define ALONE true           /* one vehicle: rounds may differ in number from those of another */
#define END_STEP accept_step /* the last part of a step; lanes put it off until others have begun theirs */
#endif

/* The core is also C++, in which one file of all (packaging/c) may be compiled: C++ spells these two otherwise. */
#ifdef __cplusplus
#define restrict __restrict
#define ALL_ZERO \
    { \
    }
#else
#define ALL_ZERO {0}
#endif

/* For the parts of a step, which compilers would not inline by themselves: vectors passed through memory cost time. */
#if defined(__GNUC__) && !defined(LACONIC_PLAIN_INLINE) /* coverage counts each function once; images may be smaller */
#define INLINE static inline __attribute__((always_inline))
#else
#define INLINE static inline
#endif

/* For code that steps seldom run: inlined, it would take registers from the usual case. */
#if defined(__GNUC__) && !defined(LACONIC_PLAIN_INLINE)
#define RARE static __attribute__((noinline))
#else
#define RARE static
#endif

/* The same, and gcc optimises neither it nor its callers by knowledge of the other, as if they were in different files:
 * faster where the usual case is short of registers. */
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 8
#define RARE_AND_OPAQUE static __attribute__((noipa))
#else
#define RARE_AND_OPAQUE RARE
#endif

#ifndef LACONIC_LANES
/* |x| in one instruction, which compilers do not make of x < 0 ? -x : x, since that keeps the sign of zero. */
static inline real magnitude(real x) {
#if defined(__GNUC__) && defined(LACONIC_SINGLE)
    return __builtin_fabsf(x);
#elif defined(__GNUC__)
    return __builtin_fabs(x);
#else
    return x < R(0) ? -x : x;
#endif
}

static inline real cut(real x, real limit) { return x > limit ? limit : (x < -limit ? -limit : x); }
#endif

static inline mask is_finite(real x) { return magnitude(x) <= LACONIC_REAL_MAX; /* false for NaN too */ }

/* Beyond it neighbouring angles differ by more than the smallest angle that counts, so the direction is not known. */
#define LARGEST_ANGLE (LACONIC_SMALLEST_ROLLER_SINE / LACONIC_EPSILON)

/* 0, or NaN where x is not finite: a sum of these checks many numbers with one comparison. */
static inline real zero_if_finite(real x) { return x - x; }

/* Compensated sum: what is too small for `value` to take up is kept in `rest` and added with the next addend. */
static inline void sum_add(laconic_sum *sum, real addend) {
    const real wanted = addend + sum->rest;
    const real value = sum->value + wanted;
    sum->rest = wanted - (value - sum->value);
    sum->value = value;
}

static inline laconic_sum sum_of(real value) {
    const laconic_sum sum = {value, R(0)};
    return sum;
}

/* Fills `why`, which may be NULL, and returns the status: a refusal is one line in its caller. */
static inline laconic_status refuse(laconic_refusal *why, laconic_status status, laconic_field field, int32_t item,
                                    real value, real limit) {
    if (why != NULL) {
        why->status = status;
        why->field = field;
        why->item = item;
        why->value = value;
        why->limit = limit;
    }
    return status;
}

/* Where an array of the model has the value of a wheel: all have one place where all wheels are alike. */
static inline int32_t own(int32_t wheel) { return LACONIC_WITH_OWN_WHEELS ? wheel : 0; }

/* Some wheel can slip; motors have limits or another circuit. Either makes a vehicle one of the friction step. */
bool laconic_vehicle_slips(const laconic_vehicle *vehicle);
bool laconic_vehicle_has_drive(const laconic_vehicle *vehicle);

static inline bool has_friction(const laconic_plant *plant) {
#if LACONIC_WITH_FRICTION
    return plant->friction.acts;
#else
    return (void)plant, false;
#endif
}

/* Of a plant with friction. */
void laconic_friction_outputs_of(laconic_outputs *outputs, const laconic_plant *plant, const laconic_input *input);
void laconic_friction_watch(laconic_grip *grip, const laconic_plant *plant);
void laconic_friction_reactions_of(laconic_reactions *reactions, const laconic_plant *plant,
                                   const laconic_input *input);

/* Wheels with these speeds and angles, at a moment at which nothing is known of their forces. */
void laconic_slip_take_over(laconic_slip *slip, const laconic_friction *friction, const laconic_real speed[],
                            const laconic_real angle_rad[]);

/* The model as on ideal ground, whatever the vehicle's: laconic_prepare() makes that of the body alone where the
 * vehicle has friction. */
laconic_status laconic_prepare_ideal(laconic_model *model, const laconic_vehicle *vehicle, laconic_refusal *why);

/* The number at an offset in bytes of a struct. */
static inline const real *number_at(const void *of, uint32_t offset) {
    return (const real *)(const void *)((const unsigned char *)of + offset);
}

#endif
