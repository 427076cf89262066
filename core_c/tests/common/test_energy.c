/* Tests that no method gains energy over a run: made-up vehicles coast without input on ideal ground, with damping and
 * without. docs/integrators.md states the bounds; host_tests/assurance/energy.py runs many more vehicles for longer. */
#include "methods.h"

#define VEHICLES 40
#define STEPS LONG_RUN(2000)
#define KEPT EITHER(1e-9, 1e-4)
#define ROUNDED EITHER(1e-15, 3e-8) /* of a step, for methods that nothing corrects */

/* ------------------------------------------------------------------------------ made-up runs -- */

static uint64_t random_bits;

static double around_zero(void) { /* from −1 to 1 */
    random_bits ^= random_bits << 13;
    random_bits ^= random_bits >> 7;
    random_bits ^= random_bits << 17;
    return (double)(int64_t)random_bits / 9223372036854775808.0;
}

static double between(double small, double large) { /* evenly in its logarithm */
    return small * pow(large / small, 0.5 + 0.5 * around_zero());
}

static void add_made_up_wheel(laconic_vehicle *v, int kind, int i, int count, double size) {
    const double bearing = 2 * PI * i / count + 0.1 * around_zero();
    const double x = size * cos(bearing), y = size * sin(bearing), axle = 3 * around_zero();
    if (kind == 3 || (kind == 4 && i == 0))
        add_wheel(v, LACONIC_WHEEL_FIXED, kind == 3 ? 0 : x, y, kind == 3 ? PI / 2 : axle, 0);
    else if (kind == 1)
        add_wheel(v, LACONIC_WHEEL_ROLLER, x, y, PI / 2, i % 2 == 0 ? PI / 4 : -PI / 4);
    else
        add_wheel(v, LACONIC_WHEEL_ROLLER, x, y, kind == 2 ? axle : bearing, kind == 2 ? 0.9 : PI / 2);
}

/* Omni, mecanum, any rollers, a cart, a fixed wheel among omni wheels; from a toy to a lorry. */
static laconic_vehicle made_up(int number) {
    const double size = between(0.05, 3), mass = between(0.1, 1000), radius = size * between(0.01, 0.5);
    const int count = 2 + number % 7;
    laconic_vehicle v = bare_body();
    v.mass_kg = REAL(mass);
    v.yaw_inertia_kgm2 = REAL(mass * size * size * between(0.01, 3));
    v.wheel_radius_m = REAL(radius);
    v.wheel_inertia_kgm2 = REAL(mass * radius * radius * between(1e-3, 3));
    if (number % 2 == 0) v.com_x_m = REAL(0.3 * size * around_zero());
    if (number % 2 == 0) v.com_y_m = REAL(0.3 * size * around_zero());
    for (int i = 0; i < count; i++) add_made_up_wheel(&v, number % 5, i, count, size);
    return v;
}

typedef struct coasting {
    laconic_model model;
    laconic_state state;
    double step_s, gyro, most_turn; /* |w|; most_turn: h·|w||g||ζ|, beyond which no step turns ζ */
} coasting;

static double length(const laconic_real v[3]) {
    return sqrt((double)v[0] * (double)v[0] + (double)v[1] * (double)v[1] + (double)v[2] * (double)v[2]);
}

static double fastest_decay(const laconic_model *m) {
    return larger((double)m->decay_per_s[0], larger((double)m->decay_per_s[1], (double)m->decay_per_s[2]));
}

/* A step of at most `turn` along a random motion. */
static coasting start_of(laconic_vehicle v, double step_s, double turn) {
    coasting c;
    laconic_start start = start_with(0, 0, 0);
    double zeta[3], size = 0;
    c.model = model_of(v);
    c.step_s = step_s;
    c.gyro = length(c.model.gyro);
    for (int k = 0; k < 3; k++) zeta[k] = k < c.model.dof ? around_zero() : 0;
    for (int k = 0; k < 3; k++) size += zeta[k] * zeta[k];
    const double per_turn = step_s * c.gyro * length(c.model.nu_of_zeta[2]) * sqrt(size);
    const bool turns = c.gyro * (double)c.model.yaw_scale > 1e-4; /* else w is 0 but for rounding */
    const double scale = turns ? turn / per_turn : 1;
    c.most_turn = turns ? turn : 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) start.nu_rad_per_s[i] += REAL(scale * zeta[k] * (double)c.model.nu_of_zeta[i][k]);
    ASSERT_STATUS(LACONIC_OK, laconic_state_project(&c.state, &c.model, &start, NULL));
    return c;
}

static coasting made_up_run(int number, double most_decay) {
    laconic_vehicle v;
    coasting c;
    random_bits = 88172645463325252U + (uint64_t)number * 7919U;
    for (int k = 0; k < 20; k++) (void)around_zero();
    v = made_up(number);
    const double step_s = between(1e-4, 1), turn = between(0.01, 30), decay = between(1e-9, most_decay);
    const uint64_t before = random_bits;
    c = start_of(v, step_s, turn);
    if (most_decay <= 0) return c;
    v.motor_damping_Nms = v.mass_kg * v.wheel_radius_m * v.wheel_radius_m; /* then r is about 1 */
    const laconic_model damped = model_of(v);
    const double fastest = fastest_decay(&damped);
    v.motor_damping_Nms *= REAL(fastest > 0 ? decay / (fastest * step_s) : 0);
    random_bits = before;
    return start_of(v, step_s, turn);
}

static double energy_of(const laconic_state *s) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += pow((double)s->zeta[k].value + (double)s->zeta[k].rest, 2);
    return sum;
}

/* h·|w||g·ζ| */
static double turn_of(const coasting *c) {
    double yaw = 0;
    for (int k = 0; k < 3; k++) yaw += (double)c->model.nu_of_zeta[2][k] * (double)c->state.zeta[k].value;
    return c->step_s * c->gyro * fabs(yaw);
}

typedef double (*gain_bound)(const coasting *c, int steps);

/* No step ends with more energy than the start, with damping than the least so far, but for the bound. Returns the last
 * status. */
static laconic_status assert_coasts(coasting c, const laconic_method *method, int steps, gain_bound bound) {
    const laconic_integrator in = integrator_of(method, &c.model, c.step_s);
    const laconic_input none_acts = no_input();
    double least = energy_of(&c.state);
    for (int step = 1; step <= steps; step++) {
        const laconic_status status = laconic_step(&c.model, &in, &c.state, &none_acts);
        const double energy = energy_of(&c.state);
        if (status != LACONIC_OK) return status;
        TEST_ASSERT_TRUE_MESSAGE(energy <= least * (1 + bound(&c, step)), method->name);
        if (fastest_decay(&c.model) > 0) least = fmin(least, energy);
    }
    return LACONIC_OK;
}

/* ------------------------------------------------------------------------------------- bounds -- */

static double what_rounding_adds(const coasting *c, int steps) {
    (void)c, (void)steps;
    return KEPT;
}

static double oscillation_of_kahan(const coasting *c, int steps) {
    return 0.25 * turn_of(c) * turn_of(c) + steps * ROUNDED;
}

static double truncation_of_rk4(const coasting *c, int steps) {
    return fmin(pow(c->most_turn, 4) / 150, 1.0 / 128) + steps * ROUNDED;
}

static double truncation_of_taylor_8(const coasting *c, int steps) {
    return fmin(pow(c->most_turn, 8) / 40, 1.0 / 128) + steps * ROUNDED;
}

static void assert_all_coast(const laconic_method *method, double most_decay, gain_bound bound) {
    for (int number = 0; number < VEHICLES; number++)
        (void)assert_coasts(made_up_run(number, most_decay), method, STEPS, bound);
}

/* 0: without damping; else the largest h·r. */
static void free_motion_and_slowing_down_by(const laconic_method *method, gain_bound bound) {
    assert_all_coast(method, 0, bound);
    assert_all_coast(method, 1, bound);
}

static void auto_gains_nothing_and_takes_every_step(void) {
    for (int number = 0; number < 2 * VEHICLES; number++) {
        const coasting c = made_up_run(number / 2, number % 2);
        ASSERT_STATUS(LACONIC_OK, assert_coasts(c, &laconic_auto, STEPS, what_rounding_adds));
    }
}

static void exact_flow_gains_nothing(void) { free_motion_and_slowing_down_by(&laconic_exact_flow, what_rounding_adds); }

static void exact_flow_4_gains_nothing(void) {
    free_motion_and_slowing_down_by(&laconic_exact_flow_4, what_rounding_adds);
}

static void exponential_gauss_8_gains_nothing(void) {
    free_motion_and_slowing_down_by(&laconic_exponential_gauss_8, what_rounding_adds);
}

static void exponential_kahan_4_gains_nothing(void) {
    free_motion_and_slowing_down_by(&laconic_exponential_kahan_4, what_rounding_adds);
}

static void exponential_kahan_oscillates_by_a_quarter_of_the_square_of_its_turn(void) {
    free_motion_and_slowing_down_by(&laconic_exponential_kahan, oscillation_of_kahan);
}

static void rk4_gains_what_its_order_says(void) { free_motion_and_slowing_down_by(&laconic_rk4, truncation_of_rk4); }

static void taylor_8_gains_what_its_order_says(void) {
    free_motion_and_slowing_down_by(&laconic_taylor_8, truncation_of_taylor_8);
}

/* ------------------------------------------------------------------------------ one such cart -- */

/* Seven fixed wheels on one axle line, the centre of mass beside it: voltages spin it up, then nothing acts. Its steps
 * turn ζ by radians, at which the rounds of exponential-gauss-8 converge late or not at all. */
static void a_cart_that_was_spun_up_keeps_its_energy(void) {
    const double y[7] = {-0.0397, 0.0018, -0.2922, -0.1425, -0.4584, 0.1840, 0.0723};
    const double volts[7] = {20.6, 38.7, 22.6, -15.6, 48.1, -20.5, -63.6};
    const laconic_input none_acts = no_input();
    laconic_input held = no_input();
    laconic_vehicle v = bare_body();
    v.mass_kg = REAL(0.2546);
    v.yaw_inertia_kgm2 = REAL(1.76e-10);
    v.wheel_radius_m = REAL(1.693e-5);
    v.wheel_inertia_kgm2 = REAL(2.242e-15);
    v.motor_gain_Nm_per_V = REAL(6.297e-7);
    v.com_x_m = REAL(-0.101);
    v.com_y_m = REAL(-0.2306);
    for (int i = 0; i < 7; i++) add_wheel(&v, LACONIC_WHEEL_FIXED, 0, y[i], PI / 2, 0);
    for (int i = 0; i < 7; i++) held.voltage_V[i] = REAL(volts[i]);
    const laconic_model m = model_of(v);
    laconic_state state = moving(&m, 0, 0, 0);
    take_steps(&laconic_auto, &m, &state, &held, 0.0109, 1000);
    const double energy = energy_of(&state);
    for (int k = 0; k < 10; k++) {
        take_steps(&laconic_auto, &m, &state, &none_acts, 0.0109, 1000);
        TEST_ASSERT_TRUE(fabs(energy_of(&state) / energy - 1) < KEPT);
    }
}

/* A steady turn of about a radian a step: its roundings would lean one way. */
static void assert_turns_steadily(const laconic_method *method) {
    const laconic_model m = model_of(three_wheels());
    const laconic_input none_acts = no_input();
    laconic_state state = moving(&m, 20, 10, 30);
    const double energy = energy_of(&state), step_s = 1.15 / (30 * length(m.gyro));
    for (int k = 0; k < 10; k++) {
        take_steps(method, &m, &state, &none_acts, step_s, LONG_RUN(2000));
        TEST_ASSERT_TRUE_MESSAGE(fabs(energy_of(&state) / energy - 1) < EITHER(1e-11, 1e-8), method->name);
    }
}

static void a_steady_turn_keeps_its_energy_to_less_than_a_rounding_a_step(void) {
    assert_turns_steadily(&laconic_auto);
    assert_turns_steadily(&laconic_exact_flow);
    assert_turns_steadily(&laconic_exact_flow_4);
    assert_turns_steadily(&laconic_exponential_gauss_8);
}

/* The same where samples of no input are given: nothing acts, either. */
static void sampled_inputs_that_do_not_act_change_nothing_of_it(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_input none_acts = no_input();
    laconic_state state = moving(&m, 20, 10, 30);
    const double energy = energy_of(&state), step_s = 1.15 / (30 * length(m.gyro));
    const laconic_integrator in = integrator_of(&laconic_exponential_gauss_8, &m, step_s);
    for (int k = 0; k < LONG_RUN(20000); k++)
        ASSERT_STATUS(LACONIC_OK, laconic_step_sampled(&m, &in, &state, &none_acts, &none_acts, &none_acts));
    TEST_ASSERT_TRUE(fabs(energy_of(&state) / energy - 1) < EITHER(1e-11, 1e-8));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(auto_gains_nothing_and_takes_every_step);
    RUN_TEST(exact_flow_gains_nothing);
    RUN_TEST(exact_flow_4_gains_nothing);
    RUN_TEST(exponential_gauss_8_gains_nothing);
    RUN_TEST(exponential_kahan_4_gains_nothing);
    RUN_TEST(exponential_kahan_oscillates_by_a_quarter_of_the_square_of_its_turn);
    RUN_TEST(rk4_gains_what_its_order_says);
    RUN_TEST(taylor_8_gains_what_its_order_says);
    RUN_TEST(a_cart_that_was_spun_up_keeps_its_energy);
    RUN_TEST(a_steady_turn_keeps_its_energy_to_less_than_a_rounding_a_step);
    RUN_TEST(sampled_inputs_that_do_not_act_change_nothing_of_it);
    return UNITY_END();
}
