/* From a vehicle's geometry: the body with its payload, rows of Ξ, constraint rows. */
#ifndef LACONIC_GEOMETRY_H
#define LACONIC_GEOMETRY_H

#include "elementary.h"

/* One wheel's values: its own, else the vehicle's. */
typedef struct wheel_values {
    real radius_m;            /* R_i  */
    real inertia_kgm2;        /* J_i  */
    real motor_gain_Nm_per_V; /* c1_i */
    real motor_damping_Nms;   /* c2_i */
} wheel_values;

#if LACONIC_WITH_FRICTION
static inline real own_or_common(real own, real common) { return own > R(0) ? own : common; }
#endif

wheel_values laconic_wheel_values(const laconic_vehicle *vehicle, int32_t wheel);

/* The body with its payload, in the paper's dimensionless numbers. */
typedef struct body {
    real mass_kg;            /* M                 */
    real com_x_m, com_y_m;   /* S, body frame     */
    real yaw_scale;          /* Λ = √(I_S/M)/R    */
    real radius_m;           /* R                 */
    real wheel_scale_square; /* λ² = J/(M R²), with the largest J of all wheels */
} body;

/* Fills `body` from a checked vehicle. */
void laconic_body_of(body *b, const laconic_vehicle *vehicle);

/* Row i of Ξ: χ_i' = row · ν (4.3–4.4), with R/R_i for a wheel of another radius. */
void laconic_wheel_row(real row[3], const body *b, const laconic_wheel *wheel);

/* J_i over the largest J: exactly 1 for wheels that are alike, also where J = 0.
 * With it A = E + λ² Σ share_i Ξ_iᵀ Ξ_i. */
void laconic_inertia_shares(real share[], const laconic_vehicle *vehicle);

/* The constraints row · ν = 0 of one wheel: the centre of a fixed one does not move along its axle (velocity over R);
 * then a locked one does not rotate (its row of Ξ). Returns how many there are, 0 to 2. */
int32_t laconic_constraint_rows(real rows[2][3], const body *b, const laconic_wheel *wheel);

/* Direction in which a wheel's ground reaction acts, body axes: its roller's axis; of a fixed wheel its
 * rolling direction. Returns sin γ. */
real laconic_pull_direction(direction *pull, const laconic_wheel *wheel);

#endif
