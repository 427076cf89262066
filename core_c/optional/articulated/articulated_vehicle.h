/* Parts of preparing an articulated vehicle: checks of its numbers, wheels and rows of one body. */
#ifndef LACONIC_ARTICULATED_VEHICLE_H
#define LACONIC_ARTICULATED_VEHICLE_H

#include "articulated_equations.h"
#include "geometry.h"

#if LACONIC_MAX_BODIES > 0

#define OF(IDENTIFIER) ((laconic_field)LACONIC_FIELD_OF_##IDENTIFIER)

/* Where a number is in its struct, its field, and the rule for it. */
typedef struct articulated_number {
    uint16_t offset;
    uint8_t field, rule;
} articulated_number;

/* Refuses the first number that leaves the range, is negative where it must not, or is too large an angle. */
laconic_status laconic_articulated_check_numbers(const void *of, const articulated_number *numbers, size_t count,
                                                 int32_t item, laconic_refusal *why);

/* Every number of bodies and wheels by itself. */
laconic_status laconic_articulated_check(const laconic_articulated_vehicle *vehicle, laconic_refusal *why);

/* The part that does not depend on the ground: numbers, parents and hinges of bodies, bodies of wheels. */
laconic_status laconic_articulated_check_bodies(const laconic_articulated_vehicle *vehicle, laconic_refusal *why);

/* Fills the model's wheels in the frames of their bodies; `com`: of body 0 with its payload. */
void laconic_articulated_wheels(laconic_articulated_model *m, const laconic_articulated_vehicle *vehicle);

/* Adds J ρρᵀ and c2 ρρᵀ of a wheel to a body's inertia and drag. */
void laconic_articulated_add_wheel(laconic_form *inertia, laconic_form *drag, const laconic_articulated_wheel *wheel);

/* Fills link, rows left over and columns of all bodies. */
laconic_status laconic_articulated_links(laconic_articulated_model *m, const laconic_articulated_vehicle *vehicle,
                                         laconic_refusal *why);

/* Numbers of a start: at most `largest`, and below what a heading can count. The second: those of body 0; the third:
 * those of hinge b. */
laconic_status laconic_articulated_check_start_number(real value, laconic_field field, int32_t item, real largest,
                                                      laconic_refusal *why);
laconic_status laconic_articulated_check_start(const laconic_articulated_start *start, real largest,
                                               laconic_refusal *why);
laconic_status laconic_articulated_check_hinge_start(const laconic_articulated_start *start, int32_t b, real largest,
                                                     laconic_refusal *why);

/* Postures at which a prepared model is examined: refuses MASSLESS_HINGE and STEERED_TOO_OFTEN, finds
 * fastest_decay_per_s. */
laconic_status laconic_articulated_examine(laconic_articulated_model *m, laconic_refusal *why);

#endif
#endif
