/* Checks that the tests of several methods share: order, drift, steady motions, and which steps are differentiated. */
#ifndef LACONIC_TEST_METHODS_H
#define LACONIC_TEST_METHODS_H

#include "laconic/derivatives.h"
#include "reference.h"

static inline laconic_integrator integrator_of(const laconic_method *method, const laconic_model *model, double step) {
    laconic_integrator integrator;
    laconic_refusal why;
    ASSERT_STATUS(LACONIC_OK, laconic_integrator_prepare(&integrator, method, model, REAL(step), &why));
    return integrator;
}

static inline void take_steps(const laconic_method *method, const laconic_model *model, laconic_state *state,
                              const laconic_input *input, double step, int count) {
    const laconic_integrator integrator = integrator_of(method, model, step);
    for (int i = 0; i < count; i++) ASSERT_STATUS(LACONIC_OK, laconic_step(model, &integrator, state, input));
}

typedef struct errors {
    double nu, pose, wheels;
} errors;

static inline double larger(double a, double b) { return a > b ? a : b; }

/* Largest difference to the reference after `time`, in `steps` steps. */
static inline errors errors_of(const laconic_method *method, const laconic_vehicle *vehicle, laconic_start start,
                               const laconic_input *input, double time, int steps) {
    const laconic_model model = model_of(*vehicle);
    const reference p = reference_of(vehicle);
    laconic_state state = state_of(&model, start);
    laconic_pose pose;
    laconic_real nu[3];
    laconic_real angle[LACONIC_MAX_WHEELS];
    double y[6 + LACONIC_MAX_WHEELS] = {0};
    errors e = {0, 0, 0};
    for (int i = 0; i < 3; i++) y[i] = (double)start.nu_rad_per_s[i];
    y[3] = (double)start.x_m;
    y[4] = (double)start.y_m;
    y[5] = (double)start.heading_rad;
    reference_run(&p, y, input, time, 4000);
    take_steps(method, &model, &state, input, time / steps, steps);
    laconic_nu(&model, &state, nu);
    laconic_pose_of(&pose, &model, &state);
    laconic_wheel_angles(&model, &state, angle);
    for (int i = 0; i < 3; i++) e.nu = larger(e.nu, fabs((double)nu[i] - y[i]));
    e.pose = larger(e.pose, fabs((double)pose.x_m - y[3]));
    e.pose = larger(e.pose, fabs((double)pose.y_m - y[4]));
    e.pose = larger(e.pose, fabs((double)pose.heading_rad - y[5]));
    laconic_wheel_angles(&model, &state, angle);
    for (int i = 0; i < p.wheels; i++) e.wheels = larger(e.wheels, fabs((double)angle[i] - y[6 + i]));
    return e;
}

/* Halving the step divides every error by 2^order. */
static inline void assert_order(const laconic_method *method, const laconic_vehicle *vehicle, laconic_start start,
                                const laconic_input *input, double time, int steps, double order) {
    const errors coarse = errors_of(method, vehicle, start, input, time, steps);
    const errors fine = errors_of(method, vehicle, start, input, time, 2 * steps);
    TEST_ASSERT_TRUE_MESSAGE(log2(coarse.nu / fine.nu) > order - 0.4, "nu falls too slowly");
    TEST_ASSERT_TRUE_MESSAGE(log2(coarse.pose / fine.pose) > order - 0.4, "pose falls too slowly");
    TEST_ASSERT_TRUE_MESSAGE(log2(coarse.wheels / fine.wheels) > order - 0.4, "wheel angles fall too slowly");
}

/* Largest relative drift of energy and of K over a free run. */
typedef struct drift {
    double energy, yaw_integral;
} drift;

static inline drift free_drift(const laconic_method *method, const laconic_vehicle *vehicle, double step, int steps) {
    const laconic_model model = model_of(*vehicle);
    const laconic_integrator integrator = integrator_of(method, &model, step);
    const laconic_input input = no_input();
    laconic_state state = moving(&model, 2.0, 1.0, 4.0);
    const double energy = (double)laconic_energy_J(&model, &state);
    const double integral = (double)laconic_yaw_integral(&model, &state);
    drift d = {0, 0};
    for (int i = 0; i < steps; i++) {
        ASSERT_STATUS(LACONIC_OK, laconic_step(&model, &integrator, &state, &input));
        d.energy = larger(d.energy, fabs((double)laconic_energy_J(&model, &state) / energy - 1.0));
        d.yaw_integral = larger(d.yaw_integral, fabs((double)laconic_yaw_integral(&model, &state) / integral - 1.0));
    }
    return d;
}

/* Voltages U = (c2/c1) Ξ ν⁰ with ν⁰ = (0.4, −0.3, 0) make ν⁰ a steady motion. */
static inline void assert_steady_motion_stays(const laconic_method *method, double step) {
    const laconic_model model = model_of(with_motors(three_wheels()));
    laconic_state state = moving(&model, 0.4, -0.3, 0.0);
    laconic_input input = no_input();
    laconic_real nu[3];
    input.voltage_V[0] = REAL(DAMPING / GAIN * -0.3);
    input.voltage_V[1] = REAL(DAMPING / GAIN * 0.3);
    input.voltage_V[2] = REAL(DAMPING / GAIN * -0.4);
    take_steps(method, &model, &state, &input, step, 200);
    laconic_nu(&model, &state, nu);
    ASSERT_NEAR(EITHER(1e-13, 1e-5), 0.4, nu[0]);
    ASSERT_NEAR(EITHER(1e-13, 1e-5), -0.3, nu[1]);
    ASSERT_NEAR(EITHER(1e-13, 1e-5), 0.0, nu[2]);
}

/* ---- The methods whose steps are differentiated. */

/* A method that has no derivation yet is in no list of those that derivations.c has. */
static inline bool is_derived(const laconic_method *method) {
    const laconic_model model = model_of(with_motors(three_wheels()));
    const laconic_integrator integrator = integrator_of(method, &model, 0.01);
    const laconic_state state = moving(&model, 0, 0, 0);
    const laconic_input input = no_input();
    laconic_step_jacobian jacobian;
    return laconic_step_jacobian_of(&jacobian, &model, &integrator, &state, &input, false) != LACONIC_METHOD_UNKNOWN;
}

/* The next from this number on; LACONIC_METHOD_COUNT: there is none. */
static inline int32_t derived_from(int32_t number) {
    while (number < LACONIC_METHOD_COUNT && !is_derived(laconic_method_by_number(number))) number++;
    return number;
}

#define FOR_EACH_DERIVED(number) \
    for (int32_t number = derived_from(0); number < LACONIC_METHOD_COUNT; number = derived_from(number + 1))

#endif
