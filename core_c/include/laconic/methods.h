/* The methods of integration, one row each. Declarations, the table of methods.c, texts, and the names in scenes,
 * commands, reports, pictures, FMUs and packages follow from the row. Part of laconic.h.
 *
 * A new method changes these files; everything else follows from them, and tests name one that is missing:
 *   here                      its row
 *   core_c/src/methods        its source, which ends in the constant laconic_identifier
 *   core_c/tests/methods      its test: the order, and what it conserves
 *   docs/integrators.md       its derivation and its row of the table
 *   modelDescription.xml      its item of the enumeration Method
 *   docs/wire.md              made from these by python -m laconic_build.wire.document_wire */
#ifndef LACONIC_METHODS_H
#define LACONIC_METHODS_H

#include "laconic/real.h"

/* One row for each method, in the order of the numbers:
 *     X(number, identifier, "name", order, TAKES, KEEPS, NEEDS, "title")
 * number       of laconic_method_by_number(), in FMUs and on the wire; the first is 0, none is left out or changed
 * identifier   the constant is laconic_identifier
 * name         in scenes, on the command line and in FMUs: the identifier with - for _
 * order        by which power of the step the error falls
 * TAKES        SLOW_DAMPING: steps up to a damping limit and a gyroscopic limit, as explicit methods do
 *              ANY_DAMPING:  steps with any damping; it may refuse one in which the vehicle yaws far
 *              EVERY_STEP
 * KEEPS        the energy in free motion: NOTHING, NEARLY or EXACTLY (to rounding)
 * NEEDS        NOTHING, or EXPONENTIAL_GAUSS: a build with LACONIC_WITH_EXPONENTIAL_GAUSS
 * title        the description in FMUs and in the reference of scenes */
/* clang-format off */
#define LACONIC_METHODS(X) \
    X(0, auto, "auto", 8, EVERY_STEP, NEARLY, EXPONENTIAL_GAUSS, \
      "exponential-gauss-8, and another for the steps that it refuses: takes every step") \
    X(1, rk4, "rk4", 4, SLOW_DAMPING, NOTHING, NOTHING, \
      "Classical Runge-Kutta, fourth order; refuses steps beyond its stability limit") \
    X(2, exponential_kahan, "exponential-kahan", 2, ANY_DAMPING, NEARLY, NOTHING, \
      "Second order, any damping") \
    X(3, exponential_kahan_4, "exponential-kahan-4", 4, ANY_DAMPING, NEARLY, NOTHING, \
      "Fourth order, any damping") \
    X(4, exact_flow, "exact-flow", 2, EVERY_STEP, EXACTLY, NOTHING, \
      "Second order, exact for free motion, stable for every step") \
    X(5, exact_flow_4, "exact-flow-4", 4, ANY_DAMPING, EXACTLY, NOTHING, \
      "Fourth order, exact for free motion") \
    X(6, taylor_8, "taylor-8", 8, SLOW_DAMPING, NOTHING, NOTHING, \
      "Eighth order, for slow damping and large steps; refuses steps beyond its stability limit") \
    X(7, exponential_gauss_8, "exponential-gauss-8", 8, ANY_DAMPING, NEARLY, EXPONENTIAL_GAUSS, \
      "Eighth order, any damping; refuses steps in which it yaws too far")
/* clang-format on */

/* LACONIC_METHOD_WITH_NEEDS(what): that, or nothing where the build leaves out what the method needs. */
#define LACONIC_METHOD_WITH_NOTHING(...) __VA_ARGS__
#if LACONIC_WITH_EXPONENTIAL_GAUSS
#define LACONIC_METHOD_WITH_EXPONENTIAL_GAUSS(...) __VA_ARGS__
#else
#define LACONIC_METHOD_WITH_EXPONENTIAL_GAUSS(...)
#endif

#define LACONIC_METHOD_NUMBER(number, identifier, name, order, TAKES, KEEPS, NEEDS, title) \
    LACONIC_METHOD_WITH_##NEEDS(LACONIC_METHOD_NUMBER_##identifier = number, )

/* The numbers of the methods that this build has. */
typedef enum laconic_method_number {
    LACONIC_METHODS(LACONIC_METHOD_NUMBER) LACONIC_METHOD_COUNT /* one more than the largest */
} laconic_method_number;

#endif
