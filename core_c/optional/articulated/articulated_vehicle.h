/* Parts of preparing an articulated vehicle: checks of its numbers, wheels and rows of one body. */
#ifndef LACONIC_ARTICULATED_VEHICLE_H
#define LACONIC_ARTICULATED_VEHICLE_H

#include "articulated_equations.h"
#include "geometry.h"

#if LACONIC_MAX_BODIES > 0

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

/* Postures at which a prepared model is examined: refuses MASSLESS_HINGE and STEERED_TOO_OFTEN, finds
 * fastest_decay_per_s. */
laconic_status laconic_articulated_examine(laconic_articulated_model *m, laconic_refusal *why);

#endif
#endif
