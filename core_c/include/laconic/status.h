/* Every status with its name and its explanation: the enumerations of laconic.h and all their texts follow from these
 * lists. Part of laconic.h. */
#ifndef LACONIC_STATUS_H
#define LACONIC_STATUS_H

#include "laconic/real.h"

/* clang-format off */

/* X(IDENTIFIER, name, explanation with the remedy; # is the refusal's value, @ its limit, $ the names of
 * the methods). The wire carries the numbers: a new one comes last, and into the value table of RESULT.status in
 * laconic.dbc. */
#define LACONIC_STATUSES(X) \
    X(OK, "ok", \
      "ok") \
    X(NOT_FINITE, "not finite", \
      "# is not a finite number; give a number") \
    X(NOT_POSITIVE, "not positive", \
      "# is not positive; give a value above 0") \
    X(NEGATIVE, "negative", \
      "# is negative; give 0 or a value above it") \
    X(ROLLER_ALONG_AXLE, "roller along axle", /* |sin γ| is too small */ \
      "with # rad the roller axis lies along the axle, and the wheel transmits no force; omni wheels have pi/2, " \
      "mecanum wheels pi/4 or -pi/4") \
    X(WHEEL_NOT_SET, "wheel not set", /* wheel_count counts a wheel whose kind was never given */ \
      "this wheel was never set; give its kind and position, or lower wheel_count") \
    X(WHEEL_KIND_UNKNOWN, "wheel kind unknown", \
      "# is no kind of wheel; use 1 (roller: omni or mecanum) or 2 (fixed)") \
    X(TOO_MANY_WHEELS, "too many wheels", /* or below 0 */ \
      "# wheels, but this build takes 0 to @; lower it or build with a larger LACONIC_MAX_WHEELS") \
    X(TOO_MANY_SUPPORTS, "too many supports", /* or below 0 */ \
      "# supports, but this build takes 0 to @; lower it or build with a larger LACONIC_MAX_SUPPORTS") \
    X(NOTHING_MOVES, "nothing moves", /* three independent constraints */ \
      "fixed and locked wheels prevent every motion: in the one that those before it allow, this wheel would slide " \
      "by # of its way; the axle lines of all fixed wheels must meet in one point or be one line, or with " \
      "ground.friction_coefficient the wheels slip; else release a locked wheel") \
    X(ILL_CONDITIONED, "ill-conditioned", /* ε √cond(A) >= 0.01 */ \
      "masses and lengths are too far apart for " LACONIC_REAL_NAME " precision: the condition number # leaves fewer " \
      "than two correct digits; check the units") \
    X(START_AGAINST_CONSTRAINTS, "start against constraints", \
      "# makes a fixed or locked wheel slide; the nearest value that the wheels allow is @") \
    X(METHOD_UNKNOWN, "method unknown", /* limit: how many there are for vehicles with hinges; 0 for all others */ \
      "there is no such method; use $") \
    X(STEP_DOES_NOT_FIT, "step does not fit", \
      "the interval is no whole number of steps of # s; use @ s") \
    X(STEP_BEYOND_DAMPING_LIMIT, "step beyond damping limit", /* explicit methods: h·r_max above their limit */ \
      "# s is unstable with this method because the motors damp too fast; use at most @ s, or auto") \
    X(STEP_BEYOND_GYROSCOPIC_LIMIT, "step beyond gyroscopic limit", /* explicit methods: h·|ν3| above their limit */ \
      "# s is unstable with this method at this yaw rate; use at most @ s, or exact-flow") \
    X(STEP_GAINS_ENERGY, "step gains energy", \
      "in this state a step of # s would add energy that no input supplies; use @ s or less, or auto, or exact-flow") \
    X(STEP_SINGULAR, "step singular", \
      "in this state a step of # s has no solution; use @ s or less, or auto, or exact-flow") \
    X(OVERFLOW, "overflow", \
      "a result leaves the range of " LACONIC_REAL_NAME " precision; check inputs and units") \
    X(ABOVE_LIMIT, "above limit", \
      "# is above @; give @ or less") \
    X(MOTOR_CIRCUIT_UNKNOWN, "motor circuit unknown", \
      "# is no motor circuit; use 0 (driven), 1 (open) or 2 (shorted)") \
    X(FRICTION_TWICE, "friction twice", /* in addition to the ground's coefficient */ \
      "# is given besides ground.friction_coefficient, by which wheels slip; take this one out") \
    X(FRICTION_MISSING, "friction missing", /* of a wheel, its rollers or an axle, on ideal ground */ \
      "# has no effect on ideal ground; give ground.friction_coefficient, too") \
    X(METHOD_WITHOUT_FRICTION, "method without friction", \
      "this method knows neither ground friction nor limits of a drive; use auto") \
    X(STEP_UNSOLVED, "step unsolved", /* friction: the contact forces of a step were not found */ \
      "no contact forces found for a step of # s; try another step or more roller_drag") \
    X(STRAIGHT_ONLY, "straight only", /* fixed wheels on parallel axle lines, on ideal ground */ \
      "fixed wheels on parallel axle lines only drive straight, whatever their motors do, and the line of this one " \
      "lies # m off the first one's; for skid steering give ground.friction_coefficient, so that wheels slip; else " \
      "place them on one axle line") \
    X(ZERO, "zero", \
      "# is zero; give a value above 0, or below 0 for a shaft that turns the other way") \
    X(TOO_MANY_BODIES, "too many bodies", /* or below 0 */ \
      "# bodies on hinges, but this build takes 0 to @; lower it or build with a larger LACONIC_MAX_BODIES") \
    X(BODY_UNKNOWN, "body unknown", /* a wheel's body, or a parent that does not come before its body */ \
      "# is not the number of a body that can be used here; give 0 (the carriage) to @, parents before their bodies") \
    X(HINGE_NOT_SET, "hinge not set", \
      "this hinge was never set; give its kind, or lower body_count") \
    X(HINGE_KIND_UNKNOWN, "hinge kind unknown", \
      "# is not a kind of hinge; use 1 (free), 2 (motor), 3 (prescribed) or 4 (coordinated)") \
    X(COORDINATED_ON_BODY, "coordinated on body", \
      "only hinges on the carriage are coordinated by the twist, but this one is on body #; use a prescribed hinge") \
    X(COORDINATED_WHEEL, "coordinated wheel", \
      "a fixed wheel on a coordinated hinge must roll along its body's first axis, with the hinge on its axle line; " \
      "give axle_rad = pi/2 or -pi/2 and x_m = 0") \
    X(COORDINATED_TOO_FEW, "coordinated too few", \
      "# axle lines hold the carriage to the twist, but @ are needed: those of its own fixed wheels and of " \
      "coordinated ones; use a prescribed or motor hinge") \
    X(MASSLESS_HINGE, "massless hinge", /* an own hinge without inertia; limit: none */ \
      "this hinge turns without inertia, and no wheel behind it sets its rate; give the body a yaw inertia, place " \
      "the wheel behind the hinge (a trail), or prescribe the rate") \
    X(STEERED_TOO_OFTEN, "steered too often", \
      "# axle lines that turn freely or stand still hold the carriage at nearly every angle; use coordinated hinges, " \
      "or give ground.friction_coefficient, so that wheels slip") \
    X(FRICTION_WITH_HINGES, "friction with hinges", \
      "# does not act on vehicles with hinges; take it out for a ground that holds every wheel") \
    X(TWIST_ZERO, "twist zero", /* value: |T| or |w| */ \
      "the twist gives this steered wheel no direction (its size there is #); keep the turning centre away from the " \
      "hinge, and scale the voltages, not the twist, to stop") \
    X(TWIST_JUMPS, "twist jumps", \
      "the twist turns this steered wheel by # rad within a step, at most @ rad are possible; change the " \
      "twist slowly, give its slope (steering_twist_rate) in an FMU or in C, and reverse by voltages") \
    X(TWIST_AGAINST_WHEELS, "twist against wheels", \
      "the twist makes fixed wheels of the carriage slide (by # of its size); give one whose turning centre is on " \
      "their axle line") \
    X(WHEELS_DISAGREE, "wheels disagree", /* value: number of another wheel */ \
      "this wheel and wheel # ask for different turning centres, so that nothing moves; use coordinated hinges, or " \
      "give ground.friction_coefficient, so that wheels slip") \
    X(STEP_BEYOND_TRAIL_LIMIT, "step beyond trail limit", /* of a body: h·v/a above what the method follows */ \
      "a step of # s is too long, as the wheels of this body follow too fast (speed over trail, their distance from " \
      "the hinge); use at most @ s, a longer trail, or another method (auto divides steps)") \
    X(BELOW_LIMIT, "below limit", \
      "# is below @; give @ or more") \
    X(COORDINATED_SLIPS, "coordinated slips", /* a coordinated hinge on ground with friction */ \
      "a twist coordinates hinges on ideal ground alone; on ground with friction use 1 (free) with a servo, " \
      "2 (motor) or 3 (prescribed)") \
    X(NO_EFFECT_ON_HINGE, "no effect on hinge", \
      "# has no effect on a hinge of this kind; take it out, or change the hinge: a servo needs 1 (free), a loop and " \
      "a current limit 2 (motor), stops either, a period a servo or loop")

/* X(IDENTIFIER, explanation with the remedy): what laconic_self_test() finds. */
#define LACONIC_ARITHMETICS(X) \
    X(SOUND, \
      "sound") \
    X(WITHOUT_NAN, \
      "checks for NaN and infinity do not work; compile without -ffinite-math-only") \
    X(ROUNDED_OTHERWISE, /* fesetround, FPSCR, MXCSR */ \
      "results are not rounded to nearest; set the rounding mode to nearest, ties to even") \
    X(REORDERED, \
      "sums are computed in another order; compile without -fassociative-math and -funsafe-math-optimizations") \
    X(EXCESS_PRECISION, \
      "intermediate results keep more digits than their type; compile for SSE2, not x87") \
    X(FUSED, \
      "multiply and add are fused; compile with -ffp-contract=off, and with gcc -fno-tree-slp-vectorize") \
    X(BY_RECIPROCALS, /* x/y as x·(1/y) */ \
      "divisions are computed by reciprocals; compile without -freciprocal-math and -funsafe-math-optimizations") \
    X(FLUSHED, /* FTZ, DAZ, FPSCR.FZ, or a library linked with -ffast-math, which sets them for the whole process */ \
      "subnormal numbers are flushed to zero; clear the flush-to-zero and denormals-are-zero modes") \
    X(SUBTRACTED_WRONGLY, /* libgcc on Arm processors without double precision */ \
      "the compiler's library rounds some differences wrongly; link soft_double.c (core_c/optional/soft_double)")

/* clang-format on */

#define LACONIC_STATUS_NUMBER(IDENTIFIER, ...) LACONIC_##IDENTIFIER,
#define LACONIC_ARITHMETIC_NUMBER(IDENTIFIER, ...) LACONIC_ARITHMETIC_##IDENTIFIER,

/* LACONIC_OK = 0, LACONIC_NOT_FINITE … */
typedef enum laconic_status { LACONIC_STATUSES(LACONIC_STATUS_NUMBER) LACONIC_STATUS_COUNT } laconic_status;

/* LACONIC_ARITHMETIC_SOUND = 0 … */
typedef enum laconic_arithmetic {
    LACONIC_ARITHMETICS(LACONIC_ARITHMETIC_NUMBER) LACONIC_ARITHMETIC_COUNT
} laconic_arithmetic;

#endif
