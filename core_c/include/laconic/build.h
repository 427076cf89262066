/* Definitions on which a program and the library must agree, because they change structs. Part of laconic.h.
 *
 * Each of these definitions is in the name of an empty function of the library. The functions with which a program
 * begins are called behind them (the macros at the end), so a program with another definition does not link, and the
 * linker names it:
 *
 *     undefined reference to `laconic_built_with_LACONIC_MAX_WHEELS_4'
 *
 * Compile program and library with the same definitions then. Nothing is checked in a step, and a linker that optimises
 * removes the calls. The numbers must be written as plain literals, such as 4. */
#ifndef LACONIC_BUILD_H
#define LACONIC_BUILD_H

#include "laconic/real.h"

#define LACONIC_JOINED_NOW(name, number) name##number
#define LACONIC_JOINED(name, number) LACONIC_JOINED_NOW(name, number)

#ifdef LACONIC_SINGLE
#define LACONIC_BUILT_REAL laconic_built_with_LACONIC_SINGLE
#else
#define LACONIC_BUILT_REAL laconic_built_without_LACONIC_SINGLE
#endif
#define LACONIC_BUILT_WHEELS LACONIC_JOINED(laconic_built_with_LACONIC_MAX_WHEELS_, LACONIC_MAX_WHEELS)
#define LACONIC_BUILT_SUPPORTS LACONIC_JOINED(laconic_built_with_LACONIC_MAX_SUPPORTS_, LACONIC_MAX_SUPPORTS)
#if LACONIC_WITH_OWN_WHEELS
#define LACONIC_BUILT_OWN_WHEELS laconic_built_with_LACONIC_WITH_OWN_WHEELS_1
#else
#define LACONIC_BUILT_OWN_WHEELS laconic_built_with_LACONIC_WITH_OWN_WHEELS_0
#endif
#if LACONIC_WITH_SLOPE
#define LACONIC_BUILT_SLOPE laconic_built_with_LACONIC_WITH_SLOPE_1
#else
#define LACONIC_BUILT_SLOPE laconic_built_with_LACONIC_WITH_SLOPE_0
#endif
#if LACONIC_WITH_FRICTION
#define LACONIC_BUILT_FRICTION laconic_built_with_LACONIC_WITH_FRICTION_1
#else
#define LACONIC_BUILT_FRICTION laconic_built_with_LACONIC_WITH_FRICTION_0
#endif
#if LACONIC_WITH_EXPONENTIAL_GAUSS
#define LACONIC_BUILT_GAUSS laconic_built_with_LACONIC_WITH_EXPONENTIAL_GAUSS_1
#else
#define LACONIC_BUILT_GAUSS laconic_built_with_LACONIC_WITH_EXPONENTIAL_GAUSS_0
#endif

/* All of them. */
#define LACONIC_BUILT(X) \
    X(LACONIC_BUILT_REAL) \
    X(LACONIC_BUILT_WHEELS) \
    X(LACONIC_BUILT_SUPPORTS) \
    X(LACONIC_BUILT_OWN_WHEELS) \
    X(LACONIC_BUILT_SLOPE) \
    X(LACONIC_BUILT_FRICTION) \
    X(LACONIC_BUILT_GAUSS)

#ifdef __cplusplus
extern "C" {
#endif
#define LACONIC_DECLARE_BUILT(name) void name(void);
LACONIC_BUILT(LACONIC_DECLARE_BUILT)
#ifdef __cplusplus
}
#endif

#ifndef LACONIC_IN_CORE /* the core's own files, which define the functions */
#define LACONIC_CALL_BUILT(name) name();
static inline void laconic_check_build(void){LACONIC_BUILT(LACONIC_CALL_BUILT)}

#define laconic_vehicle_check(...) (laconic_check_build(), laconic_vehicle_check(__VA_ARGS__))
#define laconic_motor_fit(...) (laconic_check_build(), laconic_motor_fit(__VA_ARGS__))
#define laconic_prepare(...) (laconic_check_build(), laconic_prepare(__VA_ARGS__))
#define laconic_matrices_of(...) (laconic_check_build(), laconic_matrices_of(__VA_ARGS__))
#define laconic_state_set(...) (laconic_check_build(), laconic_state_set(__VA_ARGS__))
#define laconic_state_project(...) (laconic_check_build(), laconic_state_project(__VA_ARGS__))
#define laconic_integrator_prepare(...) (laconic_check_build(), laconic_integrator_prepare(__VA_ARGS__))
#define laconic_contact_prepare(...) (laconic_check_build(), laconic_contact_prepare(__VA_ARGS__))
#define laconic_friction_of(...) (laconic_check_build(), laconic_friction_of(__VA_ARGS__))
#define laconic_plant_start(...) (laconic_check_build(), laconic_plant_start(__VA_ARGS__))
#define laconic_sensor_settings_check(...) (laconic_check_build(), laconic_sensor_settings_check(__VA_ARGS__))
#define laconic_sensors_start(...) (laconic_check_build(), laconic_sensors_start(__VA_ARGS__))
#endif

#endif
