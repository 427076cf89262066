/* Vehicles with hinges on ground with friction, in round numbers, and runs of them. */
#ifndef LACONIC_TEST_SLIPPING_TREES_H
#define LACONIC_TEST_SLIPPING_TREES_H

#include "hinged_vehicles.h"
#include "laconic/articulated_friction.h"

static inline laconic_tree_vehicle tree_carriage(double mass, double inertia, double mu) {
    laconic_tree_vehicle v;
    memset(&v, 0, sizeof v);
    v.hinged = carriage(mass, inertia, 0, 0);
    v.hinged.base.wheel_radius_m = REAL(0.08);
    v.hinged.base.ground.friction_coefficient = REAL(mu);
    return v;
}

static inline laconic_wheel *tree_wheel(laconic_tree_vehicle *v, int body, double x, double y, double radius,
                                        double inertia, double dry) {
    laconic_wheel *w = hang_wheel(&v->hinged, body, x, y, inertia);
    w->own_radius_m = REAL(radius);
    w->own_axle_friction_Nm = REAL(dry);
    return w;
}

/* Returns its number, from 1. */
static inline int tree_body(laconic_tree_vehicle *v, int parent, double x, double y, double mass, double inertia,
                            double com_x, double com_y) {
    hang_body(&v->hinged, parent, LACONIC_HINGE_FREE, x, y, mass, inertia, com_x, com_y);
    return v->hinged.body_count;
}

static inline void tree_servo(laconic_tree_vehicle *v, int body, double gain, double damping, double limit) {
    laconic_tree_hinge *h = &v->hinge[body - 1];
    h->servo_gain_Nm_per_rad = REAL(gain);
    h->servo_damping_Nms = REAL(damping);
    h->servo_limit_Nm = REAL(limit);
}

/* Differential drive on two casters. */
static inline laconic_tree_vehicle tree_casters(void) {
    laconic_tree_vehicle v = tree_carriage(20, 0.6, 0.6);
    for (int s = 1; s >= -1; s -= 2) drive_wheel(tree_wheel(&v, 0, 0.03, 0.2 * s, 0.08, 0.02, 0.05), 0.4, 0.3);
    for (int s = 1; s >= -1; s -= 2) {
        const int b = tree_body(&v, 0, -0.25, 0.12 * s, 0.3, 2e-4, -0.015, 0);
        v.hinged.body[b - 1].damping_Nms = REAL(1e-3);
        v.hinge[b - 1].dry_friction_Nm = REAL(0.01);
        tree_wheel(&v, b, -0.03, 0, 0.03, 5e-5, 0.002);
    }
    return v;
}

static inline laconic_tree_vehicle tree_swerve(void) {
    laconic_tree_vehicle v = tree_carriage(30, 1.8, 0.8);
    for (int k = 0; k < 4; k++) {
        const int b = tree_body(&v, 0, k == 0 || k == 3 ? 0.25 : -0.25, k < 2 ? 0.25 : -0.25, 1.5, 0.003, 0.01, 0);
        v.hinged.body[b - 1].damping_Nms = REAL(0.01);
        v.hinge[b - 1].dry_friction_Nm = REAL(0.05);
        tree_servo(&v, b, 60, 1.5, 3);
        drive_wheel(tree_wheel(&v, b, 0, 0, 0.05, 0.004, 0.05), 0.35, 0.25);
    }
    return v;
}

static inline laconic_tree_vehicle tree_ackermann(void) {
    laconic_tree_vehicle v = tree_carriage(50, 4, 0.7);
    for (int s = 1; s >= -1; s -= 2) {
        const int b = tree_body(&v, 0, 0.35, 0.22 * s, 1, 0.01, 0, 0.02 * s);
        v.hinged.body[b - 1].damping_Nms = REAL(0.05);
        v.hinge[b - 1].dry_friction_Nm = REAL(0.1);
        tree_servo(&v, b, 200, 4, 8);
        tree_wheel(&v, b, -0.005, 0.03 * s, 0.1, 0.008, 0.02);
    }
    for (int s = 1; s >= -1; s -= 2) drive_wheel(tree_wheel(&v, 0, -0.35, 0.22 * s, 0.1, 0.02, 0.05), 1, 0.5);
    return v;
}

static inline laconic_tree_vehicle tree_loader(void) {
    laconic_tree_vehicle v = tree_carriage(900, 350, 0.7);
    const int b = tree_body(&v, 0, -1, 0, 1100, 450, -0.8, 0);
    laconic_tree_hinge *h = &v.hinge[b - 1];
    v.hinged.body[b - 1].damping_Nms = 50;
    h->dry_friction_Nm = 100;
    h->stop_low_rad = REAL(-0.7);
    h->stop_high_rad = REAL(0.7);
    tree_servo(&v, b, 4e4, 6e3, 2500);
    for (int k = 0; k < 4; k++)
        drive_wheel(tree_wheel(&v, k / 2 == 0 ? 0 : b, k < 2 ? 0 : -1, k % 2 == 0 ? 0.6 : -0.6, 0.4, 4, 10), 20, 120);
    return v;
}

/* A car of 1,400 kg with a trailer of 1,000 kg on a hitch. */
static inline laconic_tree_vehicle tree_trailer(double mu) {
    laconic_tree_vehicle v = tree_carriage(1400, 2200, mu);
    const int b = tree_body(&v, 0, -2.4, 0, 1000, 1500, -3, 0);
    v.hinge[b - 1].hitch = true;
    v.hinge[b - 1].dry_friction_Nm = 5;
    v.hinge[b - 1].com_z_m = REAL(0.8);
    v.hinged.base.com_z_m = REAL(0.5);
    for (int k = 0; k < 4; k++) tree_wheel(&v, 0, k < 2 ? 1.3 : -1.4, k % 2 == 0 ? 0.75 : -0.75, 0.3, 1.2, 2);
    for (int s = 1; s >= -1; s -= 2) tree_wheel(&v, b, -3.2, 0.75 * s, 0.3, 1.2, 2);
    return v;
}

/* The same wheels and motors as of the swerve, on one body. */
static inline laconic_tree_vehicle tree_rigid(void) {
    laconic_tree_vehicle v = tree_carriage(36, 2.2, 0.8);
    for (int k = 0; k < 4; k++)
        drive_wheel(tree_wheel(&v, 0, k == 0 || k == 3 ? 0.25 : -0.25, k < 2 ? 0.25 : -0.25, 0.05, 0.004, 0.05), 0.35,
                    0.25);
    return v;
}

static inline laconic_tree_model tree_model(laconic_tree_vehicle v) {
    laconic_tree_model m;
    memset(&m, 0, sizeof m);
    ASSERT_TAKEN(laconic_tree_prepare(&m, &v, &refusal));
    return m;
}

static inline laconic_tree_input tree_nothing(void) {
    laconic_tree_input in;
    memset(&in, 0, sizeof in);
    return in;
}

static inline laconic_tree_start tree_start_at(double vx, double vy, double yaw_rate) {
    laconic_tree_start s;
    memset(&s, 0, sizeof s);
    s.hinged = start_at(vx, vy, yaw_rate);
    return s;
}

static inline laconic_tree_state tree_state(const laconic_tree_model *m, const laconic_tree_start *start) {
    laconic_tree_state s;
    memset(&s, 0, sizeof s);
    ASSERT_TAKEN(laconic_tree_state_set(&s, m, start, &refusal));
    return s;
}

static inline void tree_run(const laconic_tree_model *m, laconic_tree_state *s, const laconic_tree_input *in,
                            double step, int steps) {
    for (int k = 0; k < steps; k++) ASSERT_TAKEN(laconic_tree_step(m, REAL(step), s, in, &refusal));
}

static inline laconic_tree_outputs tree_outputs(const laconic_tree_model *m, const laconic_tree_state *s) {
    laconic_tree_outputs out;
    memset(&out, 0, sizeof out);
    laconic_tree_outputs_of(&out, m, s);
    return out;
}

/* By how much the books of energy do not close. */
static inline double tree_books_off(const laconic_tree_outputs *o, double start) {
    const double in = (double)(o->supply_energy_J + o->outer_work_J + o->servo_work_J);
    const double out = (double)(o->slip_loss_J + o->scrub_loss_J + o->axle_loss_J + o->hinge_loss_J + o->stop_loss_J +
                                o->motor_loss_J + o->supply_loss_J + o->numerical_loss_J);
    return (double)(o->motion.energy_J + o->spring_energy_J) - start - (in - out);
}

/* Numbers that look random: from −1 to 1. */
static inline double tree_random(unsigned long long *seed) {
    *seed = *seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(*seed >> 11) / 4503599627370496.0 - 1;
}

/* Nearly normal. */
static inline double tree_gust(unsigned long long *seed) {
    double sum = 0;
    for (int k = 0; k < 12; k++) sum += tree_random(seed) / 2;
    return sum;
}

#endif
