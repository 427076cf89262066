/* The scalar type, the array bounds, and what a build leaves out.
 *
 * Everything that differs between builds of the core is decided here and nowhere else:
 *   LACONIC_SINGLE         float instead of double
 *   LACONIC_LANES          core_c/optional/batch alone, which has its own numbers and words: for many vehicles at once
 *   LACONIC_SCENE_HEADER   a generated header that fixes the constants below for one scene
 * Plain `if` tests the constants, so compilers check also the code that they then drop. */
#ifndef LACONIC_REAL_H
#define LACONIC_REAL_H

#include <float.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef LACONIC_SINGLE
typedef float laconic_number;
typedef uint32_t laconic_angle_number; /* angle in units of 2^-32 turn */
#define LACONIC_REAL_NAME "single"
#define LACONIC_EPSILON FLT_EPSILON
#define LACONIC_REAL_MAX FLT_MAX
#define LACONIC_REAL_MIN FLT_MIN
#define LACONIC_RANK_TOLERANCE 1e-5F       /* constraints that differ by less count as one */
#define LACONIC_SMALLEST_ROLLER_SINE 1e-3F /* |sin γ| below it is refused */
#else
typedef double laconic_number;
typedef uint64_t laconic_angle_number; /* angle in units of 2^-64 turn */
#define LACONIC_REAL_NAME "double"
#define LACONIC_EPSILON DBL_EPSILON
#define LACONIC_REAL_MAX DBL_MAX
#define LACONIC_REAL_MIN DBL_MIN
#define LACONIC_RANK_TOLERANCE 1e-9
#define LACONIC_SMALLEST_ROLLER_SINE 1e-6
#ifndef LACONIC_CDEF /* 1.5707963267949 of a program would be off by 4e-8, and a tolerance of 1e-300 would be 0 */
typedef char
    laconic_in_double_needs_compiling_without_fsingle_precision_constant[sizeof(1.0) == sizeof(double) ? 1 : -1];
#endif
#endif

#ifndef LACONIC_LANES /* then each number of a struct is one for each of many vehicles */
typedef laconic_number laconic_real;
typedef laconic_angle_number laconic_binary_angle;
typedef int64_t laconic_turns;
#endif

#ifdef LACONIC_SCENE_HEADER
#include LACONIC_SCENE_HEADER
#endif

#ifndef LACONIC_MAX_WHEELS
#define LACONIC_MAX_WHEELS 16
#endif
#if LACONIC_MAX_WHEELS < 1 || LACONIC_MAX_WHEELS > 64
#error "laconic: LACONIC_MAX_WHEELS must be from 1 to 64"
#endif
#ifndef LACONIC_MAX_SUPPORTS
#define LACONIC_MAX_SUPPORTS 4
#endif
#if LACONIC_MAX_SUPPORTS < 1 || LACONIC_MAX_SUPPORTS > 16
#error "laconic: LACONIC_MAX_SUPPORTS must be from 1 to 16"
#endif

#ifndef LACONIC_MAX_BODIES /* bodies on hinges in addition to the carriage (articulated.h); 0 leaves them all out */
#define LACONIC_MAX_BODIES 8
#endif
#if LACONIC_MAX_BODIES < 0 || LACONIC_MAX_BODIES > 10
#error "laconic: LACONIC_MAX_BODIES must be from 0 to 10"
#endif

/* How many wheels a loop runs over: a field of the model, or the scene's own number. */
#ifndef LACONIC_WHEELS
#define LACONIC_WHEELS(model) ((model)->wheel_count)
#endif

/* Inputs and outputs of the build. A scene's header sets to 0 what the scene does not use: what is left out is not read
 * or not computed. Definitions that change structs are checked when a program is linked (build.h). */
#ifndef LACONIC_WITH_OWN_WHEELS /* 0: all wheels have the vehicle's values; own ones are not read */
#define LACONIC_WITH_OWN_WHEELS 1
#endif
#if LACONIC_WITH_OWN_WHEELS /* how many items an array of a model has that holds a value for each wheel */
#define LACONIC_OWN_WHEELS LACONIC_MAX_WHEELS
#else
#define LACONIC_OWN_WHEELS 1
#endif
#ifndef LACONIC_WITH_VOLTAGE
#define LACONIC_WITH_VOLTAGE 1
#endif
#ifndef LACONIC_WITH_AXLE_TORQUE
#define LACONIC_WITH_AXLE_TORQUE 1
#endif
#ifndef LACONIC_WITH_BODY_WRENCH
#define LACONIC_WITH_BODY_WRENCH 1
#endif
#ifndef LACONIC_WITH_WORLD_FORCE
#define LACONIC_WITH_WORLD_FORCE 1
#endif
#ifndef LACONIC_WITH_DAMPING
#define LACONIC_WITH_DAMPING 1
#endif
#ifndef LACONIC_WITH_SLOPE
#define LACONIC_WITH_SLOPE 1
#endif
#ifndef LACONIC_WITH_FRICTION /* 0: ideal ground and motors without limits alone */
#define LACONIC_WITH_FRICTION 1
#endif
#ifndef LACONIC_WITH_EXPONENTIAL_GAUSS /* 0: integrators have no space for weights, and no method that needs them */
#define LACONIC_WITH_EXPONENTIAL_GAUSS 1
#endif
#ifndef LACONIC_WITH_PREPARE /* 0: model and integrator are constants made by the host */
#define LACONIC_WITH_PREPARE 1
#endif
#ifndef LACONIC_WITH_SAMPLED_INPUT
#define LACONIC_WITH_SAMPLED_INPUT 1
#endif
#ifndef LACONIC_WITH_POSE
#define LACONIC_WITH_POSE 1
#endif
#ifndef LACONIC_WITH_WHEEL_ANGLES
#define LACONIC_WITH_WHEEL_ANGLES 1
#endif

#endif
