/* From a vehicle's geometry: the body with its payload, rows of Ξ, constraint rows. */
#ifndef LACONIC_GEOMETRY_H
#define LACONIC_GEOMETRY_H

#include "elementary.h"

/* The body with its payload, in the paper's dimensionless numbers. */
typedef struct body {
    real mass_kg;            /* M                 */
    real com_x_m, com_y_m;   /* S, body frame     */
    real yaw_scale;          /* Λ = √(I_S/M)/R    */
    real radius_m;           /* R                 */
    real wheel_scale_square; /* λ² = J/(M R²)     */
} body;

/* Fills `body` from a checked vehicle. */
void laconic_body_of(body *b, const laconic_vehicle *vehicle);

/* Row i of Ξ: χ_i' = row · ν (4.3–4.4). */
void laconic_wheel_row(real row[3], const body *b, const laconic_wheel *wheel);

/* The constraints row · ν = 0 of one wheel: the centre of a fixed one does not move along its axle (velocity over R);
 * then a locked one does not rotate (its row of Ξ). Returns how many there are, 0 to 2. */
int32_t laconic_constraint_rows(real rows[2][3], const body *b, const laconic_wheel *wheel);

/* Direction in which a wheel's ground reaction acts, body axes: its roller's axis; of a fixed wheel its
 * rolling direction. Returns sin γ. */
real laconic_pull_direction(direction *pull, const laconic_wheel *wheel);

#endif
