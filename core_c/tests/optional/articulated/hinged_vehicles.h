/* Vehicles with hinges in round numbers, and runs of them. */
#ifndef LACONIC_TEST_HINGED_VEHICLES_H
#define LACONIC_TEST_HINGED_VEHICLES_H

#include "check.h"
#include "laconic/articulated.h"

#define ALONG (-PI / 2) /* axle of a wheel that rolls along +ξ */

static inline laconic_articulated_vehicle carriage(double mass, double inertia, double com_x, double com_y) {
    laconic_articulated_vehicle v;
    memset(&v, 0, sizeof v);
    v.base.mass_kg = REAL(mass);
    v.base.yaw_inertia_kgm2 = REAL(inertia);
    v.base.com_x_m = REAL(com_x);
    v.base.com_y_m = REAL(com_y);
    v.base.wheel_radius_m = REAL(0.1);
    return v;
}

static inline laconic_wheel *hang_wheel(laconic_articulated_vehicle *v, int body, double x, double y, double inertia) {
    laconic_wheel *w = &v->base.wheel[v->base.wheel_count];
    v->wheel_body[v->base.wheel_count++] = body;
    w->kind = LACONIC_WHEEL_FIXED;
    w->x_m = REAL(x);
    w->y_m = REAL(y);
    w->axle_rad = REAL(ALONG);
    w->own_inertia_kgm2 = REAL(inertia);
    return w;
}

static inline laconic_wheel *drive_wheel(laconic_wheel *w, double gain, double damping) {
    w->own_motor_gain_Nm_per_V = REAL(gain);
    w->own_motor_damping_Nms = REAL(damping);
    return w;
}

static inline laconic_body *hang_body(laconic_articulated_vehicle *v, int parent, laconic_hinge_kind kind, double x,
                                      double y, double mass, double inertia, double com_x, double com_y) {
    laconic_body *b = &v->body[v->body_count++];
    b->parent = parent;
    b->hinge = kind;
    b->hinge_x_m = REAL(x);
    b->hinge_y_m = REAL(y);
    b->mass_kg = REAL(mass);
    b->yaw_inertia_kgm2 = REAL(inertia);
    b->com_x_m = REAL(com_x);
    b->com_y_m = REAL(com_y);
    return b;
}

/* A differential drive, origin on its axle. */
static inline laconic_articulated_vehicle two_wheeler(void) {
    laconic_articulated_vehicle v = carriage(20, 0.8, 0.05, 0.01);
    drive_wheel(hang_wheel(&v, 0, 0, 0.2, 0.02), 0.5, 0.3);
    drive_wheel(hang_wheel(&v, 0, 0, -0.2, 0.02), 0.5, 0.3);
    return v;
}

static inline void hang_caster(laconic_articulated_vehicle *v, double x, double y, double trail) {
    const int b = v->body_count + 1;
    hang_body(v, 0, LACONIC_HINGE_FREE, x, y, 0.6, 0.002, -0.02, 0.004)->damping_Nms = REAL(0.003);
    hang_wheel(v, b, -trail, 0.003, 0.0004)->own_motor_damping_Nms = REAL(0.0005);
    v->base.wheel[v->base.wheel_count - 1].own_radius_m = REAL(0.04);
}

static inline laconic_articulated_vehicle with_two_casters(void) {
    laconic_articulated_vehicle v = two_wheeler();
    hang_caster(&v, 0.22, 0.15, 0.04);
    hang_caster(&v, 0.22, -0.15, 0.05);
    return v;
}

/* Rear axle at the origin, one steered wheel in front. */
static inline laconic_articulated_vehicle tricycle(laconic_hinge_kind kind) {
    laconic_articulated_vehicle v = carriage(180, 22, 0.5, 0.02);
    laconic_body *fork = hang_body(&v, 0, kind, 1.2, 0, 15, 0.25, 0.01, 0.02);
    if (kind == LACONIC_HINGE_MOTOR) {
        fork->gain_Nm_per_V = REAL(0.8);
        fork->damping_Nms = REAL(0.9);
    }
    hang_wheel(&v, 0, 0, 0.35, 0.03);
    hang_wheel(&v, 0, 0, -0.35, 0.03);
    drive_wheel(hang_wheel(&v, 1, 0, 0, 0.06), 2, 1.5);
    return v;
}

/* A car whose front wheels the twist (1, 0, κ) coordinates, with a trailer behind an overhang. */
static inline laconic_articulated_vehicle car_with_trailer(void) {
    laconic_articulated_vehicle v = carriage(900, 1100, 1.2, 0);
    hang_body(&v, 0, LACONIC_HINGE_COORDINATED, 2.5, 0.7, 8, 0.3, 0, 0.05);
    hang_body(&v, 0, LACONIC_HINGE_COORDINATED, 2.5, -0.7, 8, 0.3, 0, -0.05);
    hang_body(&v, 0, LACONIC_HINGE_FREE, -0.6, 0, 400, 300, -1.8, 0.03)->damping_Nms = 2;
    drive_wheel(hang_wheel(&v, 0, 0, 0.7, 0.8), 20, 5);
    drive_wheel(hang_wheel(&v, 0, 0, -0.7, 0.8), 20, 5);
    hang_wheel(&v, 1, 0, 0.08, 0.8);
    hang_wheel(&v, 2, 0, -0.08, 0.8);
    hang_wheel(&v, 3, -2.2, 0.6, 0.4);
    hang_wheel(&v, 3, -2.2, -0.6, 0.4);
    return v;
}

static inline laconic_articulated_vehicle swerve(laconic_hinge_kind kind, int modules) {
    static const double at[4][2] = {{0.3, 0.25}, {-0.3, 0.25}, {-0.3, -0.25}, {0.3, -0.25}};
    laconic_articulated_vehicle v = carriage(60, 4, 0.02, -0.01);
    for (int k = 0; k < modules; k++) {
        hang_body(&v, 0, kind, at[k][0], at[k][1], 2, 0.01, 0.01, 0);
        drive_wheel(hang_wheel(&v, k + 1, 0, 0, 0.01), 1, 0.4);
    }
    return v;
}

static inline laconic_articulated_vehicle loader(void) {
    laconic_articulated_vehicle v = carriage(3000, 2500, -0.3, 0);
    laconic_body *front = hang_body(&v, 0, LACONIC_HINGE_MOTOR, 1, 0, 2500, 1800, 1.3, 0.05);
    front->gain_Nm_per_V = 300;
    front->damping_Nms = 2000;
    for (int k = 0; k < 4; k++) {
        laconic_wheel *w = hang_wheel(&v, k / 2, k < 2 ? 0 : 1, k % 2 == 0 ? 0.8 : -0.8, 20);
        drive_wheel(w, 50, 60)->own_radius_m = REAL(0.6);
    }
    return v;
}

/* A mecanum carriage without motors. */
static inline laconic_articulated_vehicle free_carriage(void) {
    static const double at[4][2] = {{0.2, 0.2}, {-0.2, 0.2}, {-0.2, -0.2}, {0.2, -0.2}};
    laconic_articulated_vehicle v = carriage(25, 0.9, 0.01, 0.02);
    for (int k = 0; k < 4; k++) {
        laconic_wheel *w = hang_wheel(&v, 0, at[k][0], at[k][1], 0.01);
        w->kind = LACONIC_WHEEL_ROLLER;
        w->roller_rad = REAL(k % 2 == 0 ? PI / 4 : -PI / 4);
    }
    return v;
}

static inline laconic_articulated_vehicle with_trailer(laconic_articulated_vehicle v) {
    const int b = v.body_count + 1;
    hang_body(&v, 0, LACONIC_HINGE_FREE, -0.25, 0.03, 10, 0.4, -0.3, 0.02);
    hang_wheel(&v, b, -0.4, 0.15, 0.004);
    hang_wheel(&v, b, -0.4, -0.15, 0.004);
    return v;
}

/* A branching tree without fixed wheels: every hinge has a rate of its own. */
static inline laconic_articulated_vehicle free_tree(void) {
    laconic_articulated_vehicle v = free_carriage();
    hang_body(&v, 0, LACONIC_HINGE_FREE, -0.25, 0.03, 10, 0.4, -0.3, 0.02);
    hang_body(&v, 1, LACONIC_HINGE_FREE, -0.5, 0.05, 4, 0.1, -0.2, 0.03);
    hang_body(&v, 1, LACONIC_HINGE_MOTOR, -0.2, 0.3, 3, 0.05, 0.1, 0.1);
    hang_body(&v, 2, LACONIC_HINGE_FREE, -0.3, 0, 2, 0.02, -0.1, 0);
    return v;
}

/* ------------------------------------------------------------------------------------- runs -- */

static laconic_refusal refusal;

/* Names what was refused where it should not have been. */
#define ASSERT_TAKEN(call) \
    do { \
        char refused_text[500] = "ok"; \
        memset(&refusal, 0, sizeof refusal); \
        if ((call) != LACONIC_OK) laconic_message(&refusal, refused_text, sizeof refused_text); \
        TEST_ASSERT_EQUAL_STRING("ok", refused_text); \
    } while (0)

static inline laconic_articulated_model hinged_model(laconic_articulated_vehicle v) {
    laconic_articulated_model m;
    memset(&m, 0, sizeof m);
    ASSERT_TAKEN(laconic_articulated_prepare(&m, &v, &refusal));
    return m;
}

static inline laconic_articulated_input nothing(void) {
    laconic_articulated_input in;
    memset(&in, 0, sizeof in);
    return in;
}

static inline laconic_articulated_start start_at(double vx, double vy, double yaw_rate) {
    laconic_articulated_start s;
    memset(&s, 0, sizeof s);
    s.velocity_m_per_s[0] = REAL(vx);
    s.velocity_m_per_s[1] = REAL(vy);
    s.yaw_rate_rad_per_s = REAL(yaw_rate);
    return s;
}

static inline laconic_articulated_state hinged_state(const laconic_articulated_model *m,
                                                     const laconic_articulated_start *start,
                                                     const laconic_articulated_input *in) {
    laconic_articulated_state s;
    memset(&s, 0, sizeof s);
    ASSERT_TAKEN(laconic_articulated_state_set(&s, NULL, m, start, in, &refusal));
    return s;
}

static inline laconic_articulated_integrator hinged_integrator(const laconic_articulated_model *m, int method,
                                                               double step) {
    laconic_articulated_integrator i;
    memset(&i, 0, sizeof i);
    ASSERT_TAKEN(laconic_articulated_integrator_prepare(&i, method, m, REAL(step), &refusal));
    return i;
}

static inline void run_held(const laconic_articulated_model *m, laconic_articulated_state *s, int method, double step,
                            int steps, const laconic_articulated_input *in) {
    const laconic_articulated_integrator i = hinged_integrator(m, method, step);
    for (int k = 0; k < steps; k++) ASSERT_TAKEN(laconic_articulated_step(m, &i, s, in, in, &refusal));
}

static inline laconic_articulated_motion motion_of(const laconic_articulated_model *m,
                                                   const laconic_articulated_state *s) {
    laconic_articulated_motion out;
    memset(&out, 0, sizeof out);
    laconic_articulated_motion_of(&out, m, s);
    return out;
}

/* Largest difference of two motions of one model: velocities and pose. */
static inline double difference(const laconic_articulated_model *m, const laconic_articulated_motion *a,
                                const laconic_articulated_motion *b) {
    double worst = fmax(fabs((double)(a->velocity_m_per_s[0] - b->velocity_m_per_s[0])),
                        fabs((double)(a->velocity_m_per_s[1] - b->velocity_m_per_s[1])));
    worst = fmax(worst, fabs((double)(a->yaw_rate_rad_per_s - b->yaw_rate_rad_per_s)));
    worst = fmax(worst, fabs((double)(a->x_m - b->x_m)));
    worst = fmax(worst, fabs((double)(a->y_m - b->y_m)));
    worst = fmax(worst, fabs((double)(a->heading_rad - b->heading_rad)));
    for (int k = 0; k < m->body_count; k++) {
        worst = fmax(worst, fabs((double)(a->hinge_angle_rad[k] - b->hinge_angle_rad[k])));
        worst = fmax(worst, fabs((double)(a->hinge_rate_rad_per_s[k] - b->hinge_rate_rad_per_s[k])));
    }
    return worst;
}

#endif
