/* Random trees, random inputs, every method: nothing is ever NaN, a refusal changes nothing, and every call ends.
 * test_articulated_random_double STEPS takes as many steps in all (20,000 without an argument). */
#include <stdlib.h>

#include "hinged_vehicles.h"

static uint64_t seed = 12345;
static long wanted_steps = 20000;

static double uniform(double low, double high) {
    seed = seed * 6364136223846793005U + 1442695040888963407U;
    return low + (high - low) * (double)(seed >> 11) / 9007199254740992.0;
}

static int choice(int count) { return (int)uniform(0, count) % count; }

/* Mostly ordinary numbers, sometimes many decades away, sometimes 0. */
static double scale_of(double usual) {
    const int kind = choice(12);
    if (kind == 0) return 0;
    if (kind == 1) return usual * pow(10, uniform(EITHER(-8, -3), EITHER(8, 3)));
    return usual * uniform(0.3, 3);
}

static void random_wheel(laconic_articulated_vehicle *v, int body) {
    static const double axles[] = {ALONG, PI / 2, 0, 0.3};
    if (v->base.wheel_count == LACONIC_MAX_WHEELS) return;
    laconic_wheel *w = hang_wheel(v, body, choice(3) == 0 ? 0 : uniform(-0.5, 0.1),
                                  choice(3) == 0 ? 0 : uniform(-0.3, 0.3), scale_of(0.01));
    w->axle_rad = REAL(axles[choice(6) < 4 ? 0 : choice(4)]);
    w->own_motor_gain_Nm_per_V = REAL(choice(2) == 0 ? scale_of(1) : 0);
    w->own_motor_damping_Nms = REAL(choice(2) == 0 ? scale_of(0.5) : 0);
    if (choice(3) == 0) {
        w->kind = LACONIC_WHEEL_ROLLER;
        w->roller_rad = REAL(PI / 4);
    }
    w->locked = choice(40) == 0;
}

static laconic_articulated_vehicle random_vehicle(void) {
    laconic_articulated_vehicle v = carriage(20, 0.8, uniform(-0.1, 0.1), uniform(-0.1, 0.1));
    const int bodies = choice(LACONIC_MAX_BODIES + 1), own_wheels = choice(3);
    v.base.mass_kg = REAL(scale_of(20) + 1e-3);
    for (int k = 0; k < own_wheels; k++) random_wheel(&v, 0);
    for (int b = 1; b <= bodies; b++) {
        const laconic_hinge_kind kind = (laconic_hinge_kind)(1 + choice(choice(2) == 0 ? 4 : 1));
        const int parent = kind == LACONIC_HINGE_COORDINATED ? 0 : choice(b);
        laconic_body *body = hang_body(&v, parent, kind, uniform(-0.6, 0.6), uniform(-0.4, 0.4), scale_of(3),
                                       scale_of(0.1), uniform(-0.3, 0.3), uniform(-0.1, 0.1));
        body->damping_Nms = REAL(choice(2) == 0 ? scale_of(0.1) : 0);
        body->stiffness_Nm = REAL(choice(4) == 0 ? scale_of(2) : 0);
        body->gain_Nm_per_V = REAL(scale_of(0.5));
        if (kind == LACONIC_HINGE_COORDINATED)
            hang_wheel(&v, b, 0, uniform(-0.1, 0.1), scale_of(0.01));
        else if (choice(4) != 0)
            random_wheel(&v, b);
    }
    return v;
}

static laconic_articulated_input random_input(void) {
    laconic_articulated_input in = nothing();
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) in.base.voltage_V[i] = REAL(scale_of(5));
    in.base.world_force_N[0] = REAL(choice(3) == 0 ? scale_of(10) : 0);
    for (int b = 0; b < LACONIC_MAX_BODIES; b++) {
        in.hinge_voltage_V[b] = REAL(uniform(-2, 2));
        in.hinge_rate_rad_per_s[b] = REAL(choice(2) == 0 ? uniform(-1, 1) : 0);
    }
    in.twist[0] = 1;
    in.twist[1] = REAL(choice(2) == 0 ? uniform(-1, 1) : 0);
    in.twist[2] = REAL(uniform(-1, 1));
    return in;
}

static void assert_finite(const laconic_articulated_model *m, const laconic_articulated_state *s) {
    const laconic_articulated_motion now = motion_of(m, s);
    double sum = (double)(now.velocity_m_per_s[0] - now.velocity_m_per_s[0]) + (double)(now.x_m - now.x_m) +
                 (double)(now.y_m - now.y_m) + (double)(now.heading_rad - now.heading_rad) +
                 (double)(now.energy_J - now.energy_J);
    for (int b = 0; b < m->body_count; b++) sum += (double)(now.hinge_angle_rad[b] - now.hinge_angle_rad[b]);
    TEST_ASSERT_TRUE_MESSAGE(sum >= 0 && sum <= 0, "not finite");
}

/* Some steps of one vehicle; returns how many were taken. */
static long steps_of_one(void) {
    static const double sizes[] = {0.001, 0.01, 0.1};
    const laconic_articulated_vehicle v = random_vehicle();
    const laconic_articulated_input in = random_input();
    laconic_articulated_model m;
    laconic_articulated_state s;
    laconic_articulated_integrator i;
    laconic_articulated_reactions forces;
    laconic_articulated_start start = start_at(uniform(-2, 2), uniform(-1, 1), uniform(-2, 2));
    long taken = 0;
    memset(&s, 0, sizeof s);
    memset(&i, 0, sizeof i);
    for (int b = 0; b < LACONIC_MAX_BODIES; b++) start.hinge_angle_rad[b] = REAL(uniform(-3, 3));
    if (laconic_articulated_prepare(&m, &v, &refusal) != LACONIC_OK) return 0;
    if (laconic_articulated_state_set(&s, NULL, &m, &start, &in, &refusal) != LACONIC_OK) return 0;
    assert_finite(&m, &s);
    const int method = choice(LACONIC_ARTICULATED_METHOD_COUNT);
    if (laconic_articulated_integrator_prepare(&i, method, &m, REAL(sizes[choice(3)]), &refusal) != LACONIC_OK)
        return 0;
    for (int k = 0; k < 20; k++) {
        const laconic_articulated_state before = s;
        if (laconic_articulated_step(&m, &i, &s, &in, &in, &refusal) != LACONIC_OK) {
            TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
            break;
        }
        assert_finite(&m, &s);
        taken++;
    }
    /* Two axle lines that nearly coincide hold a coordinated carriage by forces beyond all measure, so others are
     * judged. */
    if (laconic_articulated_reactions_of(&forces, &m, &s, &in, NULL, &refusal) == LACONIC_OK && !m.coordinated)
        TEST_ASSERT_TRUE_MESSAGE(forces.balance <= REAL(EITHER(1e-2, 1)), "body 0 is not in balance");
    return taken;
}

static void random_trees_never_become_nan(void) {
    long taken = 0, vehicles = 0;
    while (taken < LONG_RUN(wanted_steps)) {
        taken += steps_of_one();
        TEST_ASSERT_TRUE_MESSAGE(++vehicles < 100 + wanted_steps, "hardly any vehicle can be stepped");
    }
}

int main(int count, char **words) {
    if (count > 1) wanted_steps = atol(words[1]);
    UNITY_BEGIN();
    RUN_TEST(random_trees_never_become_nan);
    return UNITY_END();
}
