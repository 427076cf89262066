/* Tests of the derivatives of a step: against differences of the step itself, adjoint against tangent, and which
 * branch they are of. host_tests/tests/derivatives compares with differences in 50 digits. */
#include "laconic/derivatives.h"
#include "stiff.h"

#define SMALL EITHER(1e-6, 4e-3)
#define CLOSE EITHER(2e-7, 3e-2)
#define TRANSPOSED EITHER(1e-14, 2e-5)
#define ROWS (6 + LACONIC_MAX_WHEELS)

static const laconic_method *const every_method[] = {&laconic_rk4,
                                                     &laconic_taylor_8,
                                                     &laconic_exponential_kahan,
                                                     &laconic_exponential_kahan_4,
                                                     &laconic_exact_flow,
                                                     &laconic_exact_flow_4,
                                                     &laconic_auto,
                                                     &laconic_exponential_gauss_8};
#define METHODS ((int)(sizeof every_method / sizeof every_method[0]))

/* A step: vehicle, method, size, motion and input. */
typedef struct step_case {
    laconic_vehicle vehicle;
    const laconic_method *method;
    double step_s;
    laconic_start start;
    laconic_input held;
} step_case;

typedef struct direction_case {
    laconic_state_change state;
    laconic_input input;
    laconic_vehicle vehicle;
} direction_case;

static step_case case_of(laconic_vehicle v, const laconic_method *method, double step_s) {
    step_case c = {v, method, step_s, start_with(0.8, -0.5, 2.4), every_input()};
    c.start.heading_rad = REAL(0.9);
    return c;
}

static laconic_plant plant_of(const step_case *c) {
    laconic_plant plant;
    laconic_start still = c->start;
    memset(still.nu_rad_per_s, 0, sizeof still.nu_rad_per_s);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &c->vehicle, c->method, REAL(c->step_s), &still, NULL));
    ASSERT_STATUS(LACONIC_OK, laconic_state_project(&plant.state, &plant.model, &c->start, NULL));
    return plant;
}

/* ν, x, y, θ, χ after the step. */
typedef struct rows {
    double n[ROWS];
} rows;

static rows rows_of(const laconic_state_change *c) {
    rows out;
    for (int i = 0; i < 3; i++) out.n[i] = (double)c->nu_rad_per_s[i];
    out.n[3] = (double)c->x_m;
    out.n[4] = (double)c->y_m;
    out.n[5] = (double)c->heading_rad;
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) out.n[6 + i] = (double)c->wheel_angle_rad[i];
    return out;
}

static rows after_step(const step_case *c) {
    laconic_plant plant = plant_of(c);
    laconic_state_change end;
    laconic_pose pose;
    memset(&end, 0, sizeof end);
    ASSERT_STATUS(LACONIC_OK, laconic_step(&plant.model, &plant.integrator, &plant.state, &c->held));
    laconic_nu(&plant.model, &plant.state, end.nu_rad_per_s);
    laconic_pose_of(&pose, &plant.model, &plant.state);
    end.x_m = pose.x_m;
    end.y_m = pose.y_m;
    end.heading_rad = pose.heading_rad;
    laconic_wheel_angles(&plant.model, &plant.state, end.wheel_angle_rad);
    return rows_of(&end);
}

static direction_case still(void) {
    direction_case d;
    memset(&d, 0, sizeof d);
    return d;
}

static void vary_motion(direction_case *d, int n) {
    for (int i = 0; i < 3; i++) d->state.nu_rad_per_s[i] = REAL(0.3 * n - 0.5 * i + 0.2);
    d->state.heading_rad = REAL(0.7 - 0.4 * n);
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) {
        d->input.voltage_V[i] = REAL(0.6 - 0.3 * i + 0.1 * n);
        d->input.axle_torque_Nm[i] = REAL(0.02 * i - 0.01 * n);
    }
    d->input.body_force_N[0] = REAL(0.5 - 0.2 * n);
    d->input.body_force_N[1] = REAL(0.1 * n);
    d->input.body_moment_Nm = REAL(0.05 - 0.03 * n);
    d->input.world_force_N[0] = REAL(0.4);
    d->input.world_force_N[1] = REAL(-0.3 * n);
    d->input.world_force_point_m[0] = REAL(0.06 * n);
    d->input.world_force_point_m[1] = REAL(-0.04);
}

/* Where one acts auto takes another method than where none does. */
static void keep_world_force_zero(direction_case *d) { d->input.world_force_N[0] = d->input.world_force_N[1] = 0; }

/* A change of every number of a vehicle; wheels on one axle line stay on it. */
static void vary_vehicle(direction_case *d, const laconic_vehicle *v) {
    laconic_vehicle *by = &d->vehicle;
    by->mass_kg = REAL(1);
    by->yaw_inertia_kgm2 = REAL(0.02);
    by->com_x_m = REAL(0.01);
    by->com_y_m = REAL(-0.02);
    by->wheel_radius_m = REAL(0.004);
    by->wheel_inertia_kgm2 = REAL(0.001);
    by->motor_gain_Nm_per_V = REAL(0.05);
    by->motor_damping_Nms = v->motor_damping_Nms > 0 ? REAL(0.002) : 0;
    by->payload.mass_kg = v->payload.mass_kg > 0 ? REAL(0.5) : 0;
    by->payload.x_m = REAL(0.03);
    by->payload.y_m = REAL(0.01);
    by->payload.yaw_inertia_kgm2 = 0;
    by->ground.slope_rad = v->ground.slope_rad > 0 ? REAL(0.05) : 0;
    by->ground.slope_heading_rad = REAL(0.3);
    for (int i = 0; i < v->wheel_count; i++) {
        const bool shared = v->wheel[0].kind == LACONIC_WHEEL_FIXED;
        by->wheel[i].x_m = REAL(0.01 + 0.004 * i);
        by->wheel[i].y_m = REAL(shared ? 0.003 : 0.01 - 0.005 * i);
        by->wheel[i].axle_rad = REAL(shared && v->wheel_count > 1 ? 0 : 0.1 * i - 0.05);
        by->wheel[i].roller_rad = REAL(0.04 * i + 0.02);
        by->wheel[i].own_radius_m = v->wheel[i].own_radius_m > 0 ? REAL(0.002) : 0;
        by->wheel[i].own_inertia_kgm2 = v->wheel[i].own_inertia_kgm2 > 0 ? REAL(0.001) : 0;
        by->wheel[i].own_motor_damping_Nms = v->wheel[i].own_motor_damping_Nms > 0 ? REAL(0.003) : 0;
        by->wheel[i].own_motor_gain_Nm_per_V = v->wheel[i].own_motor_gain_Nm_per_V < 0 ? REAL(0.02) : 0;
    }
}

static void move(laconic_real *to, double by, const laconic_real *along, size_t bytes) {
    for (size_t i = 0; i < bytes / sizeof *to; i++) to[i] += REAL(by) * along[i];
}

#define MOVE(member) move((laconic_real *)&m.member, by, (const laconic_real *)&d->member, sizeof m.member)

static step_case moved(const step_case *c, const direction_case *d, double by) {
    step_case m = *c;
    move(m.start.nu_rad_per_s, by, d->state.nu_rad_per_s, sizeof m.start.nu_rad_per_s);
    m.start.heading_rad += REAL(by) * d->state.heading_rad;
    move((laconic_real *)&m.held, by, (const laconic_real *)&d->input, sizeof m.held);
    move(&m.vehicle.mass_kg, by, &d->vehicle.mass_kg, offsetof(laconic_vehicle, payload));
    MOVE(vehicle.payload);
    MOVE(vehicle.ground);
    for (int i = 0; i < c->vehicle.wheel_count; i++) {
        MOVE(vehicle.wheel[i].x_m);
        MOVE(vehicle.wheel[i].y_m);
        MOVE(vehicle.wheel[i].axle_rad);
        MOVE(vehicle.wheel[i].roller_rad);
        MOVE(vehicle.wheel[i].own_radius_m);
        MOVE(vehicle.wheel[i].own_inertia_kgm2);
        MOVE(vehicle.wheel[i].own_motor_gain_Nm_per_V);
        MOVE(vehicle.wheel[i].own_motor_damping_Nms);
    }
    return m;
}

static laconic_state_change tangent_of(const step_case *c, const direction_case *d) {
    const laconic_plant plant = plant_of(c);
    laconic_model_change by_model;
    laconic_state_change after;
    memset(&after, 0, sizeof after);
    ASSERT_STATUS(LACONIC_OK, laconic_model_tangent(&by_model, &plant.model, &c->vehicle, &d->vehicle));
    ASSERT_STATUS(LACONIC_OK, laconic_step_tangent(&after, &plant.model, &plant.integrator, &plant.state, &c->held,
                                                   &d->state, &d->input, &by_model));
    return after;
}

static void changes_as_differences_say(const step_case *c, const direction_case *d) {
    const step_case high_case = moved(c, d, SMALL), low_case = moved(c, d, -SMALL);
    const laconic_state_change after = tangent_of(c, d);
    const rows high = after_step(&high_case), low = after_step(&low_case), found = rows_of(&after);
    double size = 0;
    for (int i = 0; i < 6 + c->vehicle.wheel_count; i++) size = fmax(size, fabs(found.n[i]));
    for (int i = 0; i < 6 + c->vehicle.wheel_count; i++)
        ASSERT_NEAR(CLOSE * (1 + size), (high.n[i] - low.n[i]) / (2 * SMALL), found.n[i]);
}

static laconic_vehicle sloped(laconic_vehicle v) {
    v.ground.slope_rad = REAL(0.2);
    v.ground.slope_heading_rad = REAL(0.7);
    v.payload.mass_kg = REAL(2);
    v.payload.x_m = REAL(0.1);
    return v;
}

static laconic_vehicle damped_fast(laconic_vehicle v) {
    v.motor_damping_Nms *= 100;
    return v;
}

static laconic_vehicle locked(void) {
    laconic_vehicle v = with_motors(three_wheels());
    v.wheel[2].locked = true;
    return v;
}

#define VEHICLES 8
static laconic_vehicle vehicle_number(int n) {
    switch (n) {
    case 0: return with_motors(three_wheels());
    case 1: return sloped(with_motors(mecanum()));
    case 2: return with_motors(differential_drive());
    case 3: return caster();
    case 4: return with_own_wheels(with_motors(mecanum()));
    case 5: return bare_body();
    case 6: return locked();
    default: return damped_fast(with_motors(three_wheels()));
    }
}

static bool too_stiff(const step_case *c) {
    laconic_plant plant;
    return laconic_plant_start(&plant, &c->vehicle, c->method, REAL(c->step_s), &(laconic_start){{0}, 0, 0, 0, {0}},
                               NULL) != LACONIC_OK;
}

/* A motion that the constraints allow, so that its projection is no part of the step. */
static void obey_constraints(step_case *c) {
    const laconic_plant plant = plant_of(c);
    laconic_nu(&plant.model, &plant.state, c->start.nu_rad_per_s);
}

/* For every vehicle and method, with and without a force fixed in the world. */
static void for_every_case(void (*promise)(const step_case *c)) {
    for (int n = 0; n < VEHICLES; n++)
        for (int k = 0; k < METHODS; k++)
            for (int world = 0; world < 2; world++) {
                step_case c = case_of(vehicle_number(n), every_method[k], 0.05);
                if (world == 0) c.held.world_force_N[0] = c.held.world_force_N[1] = 0;
                if (too_stiff(&c)) continue;
                obey_constraints(&c);
                promise(&c);
            }
}

static void follows_motion_and_input(const step_case *c) {
    for (int n = 0; n < 3; n++) {
        direction_case d = still();
        vary_motion(&d, n);
        if (c->held.world_force_N[0] == 0) keep_world_force_zero(&d);
        changes_as_differences_say(c, &d);
    }
}

static void the_tangent_is_the_change_that_differences_of_the_step_show(void) {
    for_every_case(follows_motion_and_input);
}

static void follows_the_vehicle(const step_case *c) {
    direction_case d = still();
    vary_vehicle(&d, &c->vehicle);
    changes_as_differences_say(c, &d);
}

static void it_is_so_for_every_number_of_the_vehicle(void) { for_every_case(follows_the_vehicle); }

/* The last start tends to straight motion: in the closed form of the free motion tan becomes tanh. */
static void fast_turns_and_large_steps_are_linearised(void) {
    const double start[3][3] = {{0.1, -1, 6}, {0.1, 1, 0.4}, {0.1, 40, 0.4}};
    for (int k = 2; k < METHODS; k++)
        for (int n = 0; n < 3; n++) {
            step_case c = case_of(three_wheels(), every_method[k], 0.4);
            direction_case d = still();
            vary_motion(&d, 1);
            c.start = start_with(start[n][0], start[n][1], start[n][2]);
            changes_as_differences_say(&c, &d);
        }
}

/* The last of its panels are long beside what damping leaves of the start. */
static void a_step_of_many_panels_is_linearised(void) {
    step_case c = case_of(damped_fast(with_motors(three_wheels())), &laconic_exponential_gauss_8, 0.4);
    obey_constraints(&c);
    follows_motion_and_input(&c);
    follows_the_vehicle(&c);
}

/* ------------------------------------------------------------------------------- agreement -- */

static double paired(const rows *a, const rows *b, int count, double *size) {
    double sum = 0;
    for (int i = 0; i < count; i++) {
        sum += a->n[i] * b->n[i];
        *size += fabs(a->n[i] * b->n[i]);
    }
    return sum;
}

static double paired_numbers(const void *a, const void *b, size_t bytes, double *size) {
    const laconic_real *x = a, *y = b;
    double sum = 0;
    for (size_t i = 0; i < bytes / sizeof *x; i++) {
        sum += (double)x[i] * (double)y[i];
        *size += fabs((double)x[i] * (double)y[i]);
    }
    return sum;
}

static void is_transposed(const step_case *c) {
    const laconic_plant plant = plant_of(c);
    const laconic_model *m = &plant.model;
    direction_case d = still(), covector = still();
    laconic_state_change before;
    laconic_input input;
    laconic_model_change by_model, model_change;
    double size = 0;
    vary_motion(&d, 1);
    vary_vehicle(&d, &c->vehicle);
    vary_motion(&covector, 2);
    covector.state.x_m = REAL(0.3);
    covector.state.wheel_angle_rad[0] = d.state.wheel_angle_rad[1] = REAL(-0.4);
    d.state.y_m = REAL(0.2);
    memset(&input, 0, sizeof input);
    memset(&before, 0, sizeof before);
    ASSERT_STATUS(LACONIC_OK, laconic_model_tangent(&model_change, m, &c->vehicle, &d.vehicle));
    const laconic_state_change after = tangent_of(c, &d);
    ASSERT_STATUS(LACONIC_OK, laconic_step_adjoint(&before, &input, &by_model, m, &plant.integrator, &plant.state,
                                                   &c->held, &covector.state));
    const rows a = rows_of(&after), b = rows_of(&covector.state), p = rows_of(&before), q = rows_of(&d.state);
    const double forwards = paired(&a, &b, 6 + m->wheel_count, &size);
    const double backwards = paired(&p, &q, 6 + m->wheel_count, &size) +
                             paired_numbers(&input, &d.input, sizeof input, &size) +
                             paired_numbers(&by_model, &model_change, sizeof by_model, &size);
    ASSERT_NEAR(TRANSPOSED * size, forwards, backwards);
}

static void the_adjoint_is_the_tangent_transposed(void) { for_every_case(is_transposed); }

static void add_columns(rows *sum, const laconic_real *matrix, int count, const laconic_real *weight, int columns) {
    for (int i = 0; i < count; i++)
        for (int k = 0; k < columns; k++) sum->n[i] += (double)matrix[i * columns + k] * (double)weight[k];
}

static void has_the_tangents_as_columns(const step_case *c) {
    const laconic_plant plant = plant_of(c);
    const int wheels = c->vehicle.wheel_count, count = 6 + wheels;
    laconic_real by_state[ROWS * ROWS], by_input[ROWS * LACONIC_INPUT_NUMBERS(LACONIC_MAX_WHEELS)];
    laconic_real state[ROWS], input[LACONIC_INPUT_NUMBERS(LACONIC_MAX_WHEELS)];
    static laconic_step_jacobian jacobian;
    direction_case d = still();
    rows sum = {{0}};
    vary_motion(&d, 2);
    d.state.x_m = REAL(0.3);
    const laconic_state_change after = tangent_of(c, &d);
    const rows expected = rows_of(&after), from = rows_of(&d.state);
    for (int i = 0; i < count; i++) state[i] = REAL(from.n[i]);
    memcpy(input, d.input.voltage_V, (size_t)wheels * sizeof *input);
    memcpy(input + wheels, d.input.axle_torque_Nm, (size_t)wheels * sizeof *input);
    memcpy(input + 2 * wheels, d.input.body_force_N, 7 * sizeof *input);
    ASSERT_STATUS(LACONIC_OK,
                  laconic_step_jacobian_of(&jacobian, &plant.model, &plant.integrator, &plant.state, &c->held, true));
    laconic_jacobian_by_state(by_state, &jacobian, &plant.model);
    laconic_jacobian_by_input(by_input, &jacobian, &plant.model);
    add_columns(&sum, by_state, count, state, count);
    add_columns(&sum, by_input, count, input, LACONIC_INPUT_NUMBERS(wheels));
    for (int i = 0; i < count; i++) ASSERT_NEAR(10 * TRANSPOSED * (1 + fabs(sum.n[i])), expected.n[i], sum.n[i]);
}

static void the_jacobian_has_the_tangents_as_columns(void) { for_every_case(has_the_tangents_as_columns); }

static void without_a_world_force_its_columns_are_zero(void) {
    step_case c = case_of(with_motors(mecanum()), &laconic_auto, 0.05);
    static laconic_step_jacobian jacobian;
    laconic_real by_input[10 * LACONIC_INPUT_NUMBERS(4)];
    c.held.world_force_N[0] = c.held.world_force_N[1] = 0;
    const laconic_plant plant = plant_of(&c);
    ASSERT_STATUS(LACONIC_OK,
                  laconic_step_jacobian_of(&jacobian, &plant.model, &plant.integrator, &plant.state, &c.held, false));
    TEST_ASSERT_FALSE(jacobian.has_world_force);
    laconic_jacobian_by_input(by_input, &jacobian, &plant.model);
    for (int i = 0; i < 10; i++) TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)by_input[i * LACONIC_INPUT_NUMBERS(4) + 11]);
}

/* -------------------------------------------------------------------------------- branches -- */

static laconic_status jacobian_status(laconic_plant *plant, const laconic_input *held) {
    static laconic_step_jacobian jacobian;
    return laconic_step_jacobian_of(&jacobian, &plant->model, &plant->integrator, &plant->state, held, false);
}

static void a_refused_step_has_no_derivative(void) {
    const step_case c = case_of(with_motors(three_wheels()), &laconic_rk4, 0.05);
    laconic_plant plant = plant_of(&c);
    laconic_state_change change;
    laconic_input held = c.held;
    memset(&change, 0, sizeof change);
    held.world_force_point_m[0] = REAL(NAN);
    ASSERT_STATUS(LACONIC_OVERFLOW, jacobian_status(&plant, &held));
    plant.state.zeta[2].value = REAL(1e6);
    ASSERT_STATUS(LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, jacobian_status(&plant, &c.held));
    ASSERT_STATUS(
        LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT,
        laconic_step_tangent(&change, &plant.model, &plant.integrator, &plant.state, &c.held, &change, NULL, NULL));
    ASSERT_STATUS(
        LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT,
        laconic_step_adjoint(&change, NULL, NULL, &plant.model, &plant.integrator, &plant.state, &c.held, &change));
    plant.integrator.chosen = &laconic_auto;
    ASSERT_STATUS(LACONIC_METHOD_UNKNOWN, jacobian_status(&plant, &c.held));
    plant.state.heading.turns = (int64_t)1 << 62;
    ASSERT_STATUS(LACONIC_OVERFLOW, jacobian_status(&plant, &c.held));
}

static void ground_with_friction_is_refused(void) {
    laconic_vehicle v = with_motors(three_wheels()), by = bare_body();
    const laconic_model m = model_of(v);
    laconic_model_change change;
    v.ground.friction_coefficient = REAL(0.5);
    ASSERT_STATUS(LACONIC_METHOD_WITHOUT_FRICTION, laconic_model_tangent(&change, &m, &v, &by));
}

/* auto's derivative in this state is that of `taker`. */
static void auto_takes(const laconic_method *taker, step_case c) {
    direction_case d = still();
    vary_motion(&d, 1);
    if (c.held.world_force_N[0] == 0) keep_world_force_zero(&d);
    c.method = &laconic_auto;
    const laconic_state_change by_auto = tangent_of(&c, &d);
    c.method = taker;
    const laconic_state_change by_taker = tangent_of(&c, &d);
    TEST_ASSERT_EQUAL_DOUBLE_MESSAGE((double)by_taker.x_m, (double)by_auto.x_m, taker->name);
    TEST_ASSERT_EQUAL_DOUBLE_MESSAGE((double)by_taker.nu_rad_per_s[0], (double)by_auto.nu_rad_per_s[0], taker->name);
}

static void the_derivative_of_auto_is_that_of_the_method_that_steps(void) {
    step_case c = case_of(with_motors(three_wheels()), &laconic_auto, 0.05);
    auto_takes(&laconic_exponential_gauss_8, c);
    c.held.world_force_N[0] = c.held.world_force_N[1] = 0;
    auto_takes(&laconic_exponential_gauss_8, c);
    c.start.nu_rad_per_s[2] = REAL(3000); /* beyond the gyroscopic limit */
    auto_takes(&laconic_exact_flow_4, c);
    c.vehicle = damped_fast(c.vehicle);
    auto_takes(&laconic_exponential_kahan_4, c);
    c = case_of(bare_body(), &laconic_auto, 1.0);
    c.start = start_that_gains_energy(&laconic_exact_flow_4, c.vehicle, c.held, 1.0, 1e3);
    auto_takes(&laconic_exact_flow, c);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_tangent_is_the_change_that_differences_of_the_step_show);
    RUN_TEST(it_is_so_for_every_number_of_the_vehicle);
    RUN_TEST(fast_turns_and_large_steps_are_linearised);
    RUN_TEST(a_step_of_many_panels_is_linearised);
    RUN_TEST(the_adjoint_is_the_tangent_transposed);
    RUN_TEST(the_jacobian_has_the_tangents_as_columns);
    RUN_TEST(without_a_world_force_its_columns_are_zero);
    RUN_TEST(a_refused_step_has_no_derivative);
    RUN_TEST(ground_with_friction_is_refused);
    RUN_TEST(the_derivative_of_auto_is_that_of_the_method_that_steps);
    return UNITY_END();
}
