/* Vehicles with friction for the tests of the friction step. */
#ifndef LACONIC_TEST_SLIPPING_H
#define LACONIC_TEST_SLIPPING_H

#include "vehicles.h"

static laconic_refusal why;

/* Three omni wheels of a Robotino, 0.13 m from its centre, at 60°, 180° and 300°. */
static inline laconic_vehicle robotino(double mu, double k, double t) {
    laconic_vehicle v = {0};
    v.mass_kg = 20;
    v.yaw_inertia_kgm2 = REAL(0.7);
    v.wheel_radius_m = REAL(0.04);
    v.wheel_inertia_kgm2 = REAL(0.003);
    v.com_z_m = REAL(0.1);
    for (int i = 0; i < 3; i++) {
        const double bearing = (60 + 120 * i) * PI / 180;
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.13 * cos(bearing), 0.13 * sin(bearing), bearing, PI / 2);
    }
    v.ground.friction_coefficient = REAL(mu);
    v.ground.roller_drag = REAL(k);
    v.ground.axle_friction_Nm = REAL(t);
    return v;
}

/* c1 = 0.5, c2 = 0.26, of which 0.01 is viscous friction; R_a = 2 Ω: 1 N·m per ampere. */
static inline laconic_vehicle with_drive(laconic_vehicle v) {
    v.motor_gain_Nm_per_V = REAL(0.5);
    v.motor_damping_Nms = REAL(0.26);
    v.drive.winding_resistance_ohm = 2;
    v.drive.viscous_friction_Nms = REAL(0.01);
    return v;
}

/* Four fixed wheels, all rolling along ξ: what only slip lets yaw. */
static inline laconic_vehicle skid(double mu) {
    laconic_vehicle v = robotino(mu, 0, 0);
    v.wheel_count = 0;
    for (int i = 0; i < 4; i++)
        add_wheel(&v, LACONIC_WHEEL_FIXED, i < 2 ? 0.15 : -0.15, i % 2 == 0 ? 0.2 : -0.2, -PI / 2, 0);
    return v;
}

static inline laconic_plant started(laconic_vehicle v, double step_s, double nu1, double nu2, double nu3) {
    const laconic_start start = start_with(nu1, nu2, nu3);
    laconic_plant plant;
    memset(&plant, 0, sizeof plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(step_s), &start, &why));
    return plant;
}

static inline void run(laconic_plant *plant, const laconic_input *input, uint64_t steps) {
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(plant, input, steps, &why));
}

static inline double kinetic_J(const laconic_plant *plant) {
    return (double)laconic_friction_energy_J(&plant->friction, &plant->state, &plant->slip);
}

/* Of its place on the slope. */
static inline double potential_J(const laconic_plant *p) {
    const laconic_ground *g = &p->vehicle.ground;
    const double up = (double)p->state.x_m.value * cos((double)g->slope_heading_rad) +
                      (double)p->state.y_m.value * sin((double)g->slope_heading_rad);
    return (double)p->model.mass_kg * LACONIC_GRAVITY_M_PER_S2 * sin((double)g->slope_rad) * up;
}

static inline laconic_outputs outputs_with(const laconic_plant *plant, const laconic_input *input) {
    laconic_outputs out;
    memset(&out, 0, sizeof out);
    laconic_outputs_of(&out, plant, input);
    laconic_plant_reactions(&out.reactions, plant, NULL, input);
    return out;
}

#endif
