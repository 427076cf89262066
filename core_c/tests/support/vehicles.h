/* Vehicles with round numbers in the paper's terms: M = 10 kg, R = 0.05 m, Λ = 3, λ = 0.6, Δ = 0.4. So M R² is
 * 0.025 kg m², I_S = Λ² M R² = 0.225 kg m², J = λ² M R² = 0.009 kg m², and c = c2/(M R²) = 0.8 1/s. */
#ifndef LACONIC_TEST_VEHICLES_H
#define LACONIC_TEST_VEHICLES_H

#include "check.h"

#define MASS 10.0
#define RADIUS 0.05
#define UNIT_INERTIA 0.025 /* M R² */
#define BIG_LAMBDA 3.0     /* Λ */
#define SMALL_LAMBDA 0.6   /* λ */
#define DELTA 0.4          /* Δ */
#define GAIN 0.5           /* c1 */
#define DAMPING 0.02       /* c2 */

static inline laconic_vehicle bare_body(void) {
    laconic_vehicle v;
    memset(&v, 0, sizeof v);
    v.mass_kg = REAL(MASS);
    v.yaw_inertia_kgm2 = REAL(0.225);
    v.wheel_radius_m = REAL(RADIUS);
    v.wheel_inertia_kgm2 = REAL(0.009);
    return v;
}

static inline void add_wheel(laconic_vehicle *v, laconic_wheel_kind kind, double x, double y, double axle,
                             double roller) {
    laconic_wheel *w = &v->wheel[v->wheel_count++];
    w->kind = kind;
    w->x_m = REAL(x);
    w->y_m = REAL(y);
    w->axle_rad = REAL(axle);
    w->roller_rad = REAL(roller);
}

/* §5: α = β = (0, π, π/2), γ = π/2, δ = (1, 1, 1.2): σ = 1/3, ρ = (1.2 − 0.4)/3. No motors. */
#define SIGMA (1.0 / 3.0)
#define RHO (0.8 / 3.0)
static inline laconic_vehicle three_wheels(void) {
    laconic_vehicle v = bare_body();
    v.com_y_m = REAL(DELTA * RADIUS);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.05, 0.0, 0.0, PI / 2);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, -0.05, 0.0, PI, PI / 2);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.0, 0.06, PI / 2, PI / 2);
    return v;
}

static inline laconic_vehicle with_motors(laconic_vehicle v) {
    v.motor_gain_Nm_per_V = REAL(GAIN);
    v.motor_damping_Nms = REAL(DAMPING);
    return v;
}

/* §6: two fixed wheels on the axle line through Q along ξ, δ = 1.5, so σ = 0.5 there. */
#define DRIVE_SIGMA 0.5
static inline laconic_vehicle differential_drive(void) {
    laconic_vehicle v = bare_body();
    v.com_y_m = REAL(DELTA * RADIUS);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.075, 0.0, 0.0, 0.0);
    add_wheel(&v, LACONIC_WHEEL_FIXED, -0.075, 0.0, PI, 0.0);
    return v;
}

/* §3: one fixed wheel under S that rolls along ξ. */
static inline laconic_vehicle caster(void) {
    laconic_vehicle v = bare_body();
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.0, 0.0, -PI / 2, 0.0);
    return v;
}

/* Four mecanum wheels at (±0.2, ±0.15) that roll along ξ: χ' R = v_ξ ∓ v_η ± (0.2 + 0.15) θ'. */
static inline laconic_vehicle mecanum(void) {
    laconic_vehicle v = bare_body();
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.2, 0.15, -PI / 2, PI / 4);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.2, -0.15, -PI / 2, -PI / 4);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, -0.2, 0.15, -PI / 2, -PI / 4);
    add_wheel(&v, LACONIC_WHEEL_ROLLER, -0.2, -0.15, -PI / 2, PI / 4);
    return v;
}

/* Every wheel unlike the others: another radius, inertia, gain and damping; the second has no motor. */
static inline laconic_vehicle with_own_wheels(laconic_vehicle v) {
    v.wheel[0].own_radius_m = REAL(0.04);
    v.wheel[0].own_inertia_kgm2 = REAL(0.004);
    v.wheel[0].own_motor_damping_Nms = REAL(0.05);
    v.wheel[1].own_radius_m = REAL(0.065);
    v.wheel[1].own_inertia_kgm2 = REAL(0.012);
    v.wheel[1].undriven = true;
    if (v.wheel_count > 2) v.wheel[2].own_motor_gain_Nm_per_V = REAL(-0.3);
    return v;
}

static inline laconic_model model_of(laconic_vehicle v) {
    laconic_model model;
    laconic_refusal why;
    ASSERT_STATUS(LACONIC_OK, laconic_prepare(&model, &v, &why));
    return model;
}

static inline laconic_start start_with(double nu1, double nu2, double nu3) {
    laconic_start start = {{0}, 0, 0, 0, {0}};
    start.nu_rad_per_s[0] = REAL(nu1);
    start.nu_rad_per_s[1] = REAL(nu2);
    start.nu_rad_per_s[2] = REAL(nu3);
    return start;
}

static inline laconic_state state_of(const laconic_model *model, laconic_start start) {
    laconic_state state;
    laconic_refusal why;
    ASSERT_STATUS(LACONIC_OK, laconic_state_set(&state, model, &start, &why));
    return state;
}

static inline laconic_state moving(const laconic_model *model, double nu1, double nu2, double nu3) {
    return state_of(model, start_with(nu1, nu2, nu3));
}

static inline laconic_input no_input(void) {
    laconic_input input;
    memset(&input, 0, sizeof input);
    return input;
}

/* Every input: voltages, torques, a wrench in body axes and a world force. */
static inline laconic_input every_input(void) {
    laconic_input input = no_input();
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) {
        input.voltage_V[i] = REAL(1.5 - 0.7 * i);
        input.axle_torque_Nm[i] = REAL(0.02 * i - 0.03);
    }
    input.body_force_N[0] = REAL(0.8);
    input.body_force_N[1] = REAL(-0.5);
    input.body_moment_Nm = REAL(0.04);
    input.world_force_N[0] = REAL(-1.1);
    input.world_force_N[1] = REAL(0.6);
    input.world_force_point_m[0] = REAL(0.03);
    input.world_force_point_m[1] = REAL(-0.07);
    return input;
}

#endif
