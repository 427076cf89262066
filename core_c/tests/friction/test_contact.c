/* Tests of contact.c: reactions, brakes, normal loads and the no-slip margin. */
#include "vehicles.h"

#define GRAVITY 9.80665

static laconic_refusal why;

typedef struct scene {
    laconic_vehicle vehicle;
    laconic_model model;
    laconic_contact contact;
    laconic_state state;
    laconic_input input;
    laconic_reactions out;
} scene;

static void judge(scene *s, laconic_vehicle v, laconic_start start, laconic_input input) {
    s->vehicle = v;
    s->model = model_of(v);
    s->state = state_of(&s->model, start);
    s->input = input;
    memset(&s->out, 0, sizeof s->out);
    ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&s->contact, &v, &why));
    laconic_reactions_of(&s->out, &s->contact, &s->model, &s->state, &s->input);
}

static laconic_start turning_start(double nu1, double nu2, double nu3) {
    laconic_start start = start_with(nu1, nu2, nu3);
    start.heading_rad = REAL(0.7);
    return start;
}

/* M v_S' = Σ reactions + F and I_S θ'' = Σ r × reactions + τ, from rates that are computed without reactions. */
static void forces_balance(const scene *s) {
    laconic_rates rates;
    laconic_real nu[3];
    const double cosine = cos(0.7), sine = sin(0.7),
                 yaw_inertia = (double)s->model.yaw_scale * (double)s->model.yaw_scale * (double)s->model.mass_kg *
                               RADIUS * RADIUS;
    const double along = cosine * (double)s->input.world_force_N[0] + sine * (double)s->input.world_force_N[1];
    const double across = cosine * (double)s->input.world_force_N[1] - sine * (double)s->input.world_force_N[0];
    laconic_nu(&s->model, &s->state, nu);
    laconic_derivative(&rates, &s->model, nu, REAL(0.7), &s->input);
    const double ax = RADIUS * ((double)rates.nu_rad_per_s2[0] - (double)rates.yaw_rate_rad_per_s * (double)nu[1]);
    const double ay = RADIUS * ((double)rates.nu_rad_per_s2[1] + (double)rates.yaw_rate_rad_per_s * (double)nu[0]);
    double fx = (double)s->input.body_force_N[0] + along;
    double fy = (double)s->input.body_force_N[1] + across;
    double moment = (double)s->input.body_moment_Nm + (double)s->input.world_force_point_m[0] * across -
                    (double)s->input.world_force_point_m[1] * along;
    for (int i = 0; i < s->vehicle.wheel_count; i++) {
        const laconic_wheel *w = &s->vehicle.wheel[i];
        const double roller = w->kind == LACONIC_WHEEL_FIXED ? PI / 2 : (double)w->roller_rad;
        const double pull = (double)w->axle_rad + roller, axle = (double)w->axle_rad;
        const double px = cos(pull) * (double)s->out.along_N[i] + cos(axle) * (double)s->out.lateral_N[i];
        const double py = sin(pull) * (double)s->out.along_N[i] + sin(axle) * (double)s->out.lateral_N[i];
        fx += px;
        fy += py;
        moment += ((double)w->x_m - (double)s->model.com_x_m) * py - ((double)w->y_m - (double)s->model.com_y_m) * px;
    }
    ASSERT_NEAR(EITHER(1e-12, 2e-4), (double)s->model.mass_kg * ax, fx);
    ASSERT_NEAR(EITHER(1e-12, 2e-4), (double)s->model.mass_kg * ay, fy);
    ASSERT_NEAR(EITHER(1e-12, 2e-4), yaw_inertia * (double)rates.nu_rad_per_s2[2] / (double)s->model.yaw_scale, moment);
}

static void reactions_and_outer_forces_make_the_motion(void) {
    scene s;
    laconic_vehicle v;
    judge(&s, with_motors(three_wheels()), turning_start(0.7, -0.4, 1.9), every_input());
    forces_balance(&s);
    judge(&s, with_motors(mecanum()), turning_start(0.7, -0.4, 1.9), every_input());
    forces_balance(&s);
    judge(&s, with_motors(differential_drive()), turning_start(-DELTA / BIG_LAMBDA * 1.5, 0.8, 1.5), every_input());
    forces_balance(&s);
    judge(&s, caster(), turning_start(0.7, 0, 1.9), every_input());
    forces_balance(&s);
    judge(&s, bare_body(), turning_start(0.7, 0.3, 1.9), every_input());
    forces_balance(&s);
    v = with_motors(mecanum());
    v.payload.mass_kg = REAL(4);
    v.payload.x_m = REAL(0.1);
    v.payload.yaw_inertia_kgm2 = REAL(0.02);
    judge(&s, v, turning_start(0.7, -0.4, 1.9), every_input());
    forces_balance(&s);
    v = with_motors(three_wheels());
    v.wheel[2].locked = true;
    judge(&s, v, turning_start(RHO * 1.9, -0.4, 1.9), every_input());
    forces_balance(&s);
    v = with_motors(differential_drive());
    v.wheel[1].locked = true; /* χ2' = −ν2 + σ ν3 */
    judge(&s, v, turning_start(-DELTA / BIG_LAMBDA * 1.5, DRIVE_SIGMA * 1.5, 1.5), every_input());
    forces_balance(&s);
}

static void reactions_balance_with_the_radius_and_the_inertia_of_each_wheel(void) {
    scene s;
    laconic_vehicle v;
    judge(&s, with_own_wheels(with_motors(mecanum())), turning_start(0.7, -0.4, 1.9), every_input());
    forces_balance(&s);
    judge(&s, with_own_wheels(with_motors(differential_drive())), turning_start(-DELTA / BIG_LAMBDA * 1.5, 0.8, 1.5),
          every_input());
    forces_balance(&s);
    v = with_own_wheels(with_motors(three_wheels()));
    v.wheel[2].locked = true;
    judge(&s, v, turning_start(RHO * 1.9, -0.4, 1.9), every_input());
    forces_balance(&s);
    v = with_own_wheels(with_motors(differential_drive()));
    v.wheel[1].locked = true;
    judge(&s, v, turning_start(-DELTA / BIG_LAMBDA * 1.5, DRIVE_SIGMA * 1.5, 1.5), every_input());
    forces_balance(&s);
}

/* A push of 8 N against a braked wheel of 0.2 m, four times the vehicle's radius: the torque is R_i F. */
static void the_brake_of_a_wheel_holds_with_its_own_arm(void) {
    scene s;
    laconic_vehicle v = caster();
    laconic_input input = no_input();
    v.wheel[0].locked = true;
    v.wheel[0].own_radius_m = REAL(0.2);
    input.body_force_N[0] = REAL(8);
    judge(&s, v, start_with(0, 0, 0), input);
    ASSERT_NEAR(EITHER(1e-13, 1e-5), -8, s.out.along_N[0]);
    ASSERT_NEAR(EITHER(1e-13, 1e-5), 8 * -0.2, s.out.brake_Nm[0]);
}

/* f = (M_i − J χ'')/(R sin γ) */
static void a_roller_wheels_reaction_is_torque_less_its_own_inertia(void) {
    scene s;
    laconic_rates rates, later;
    laconic_real nu[3], torque[4], after[3];
    const double dt = EITHER(1e-4, 1e-2);
    judge(&s, with_motors(mecanum()), turning_start(0.7, -0.4, 1.9), every_input());
    laconic_nu(&s.model, &s.state, nu);
    laconic_derivative(&rates, &s.model, nu, REAL(0.7), &s.input);
    for (int k = 0; k < 3; k++) after[k] = nu[k] + REAL(dt) * rates.nu_rad_per_s2[k];
    laconic_derivative(&later, &s.model, after, REAL(0.7), &s.input); /* χ' is linear in ν: a difference is exact */
    laconic_wheel_torques(&s.model, &s.state, &s.input, torque);
    for (int i = 0; i < 4; i++) {
        const double acceleration =
            ((double)later.wheel_speed_rad_per_s[i] - (double)rates.wheel_speed_rad_per_s[i]) / dt;
        const double expected =
            ((double)torque[i] - 0.009 * acceleration) / (RADIUS * sin((double)s.vehicle.wheel[i].roller_rad));
        ASSERT_NEAR(EITHER(1e-8, 1e-2), expected, s.out.along_N[i]);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)s.out.lateral_N[i]);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)s.out.brake_Nm[i]);
    }
}

/* The wheel of a standing caster alone supplies the reaction to a sideways force F_η, along the axle (0, −1). */
static void a_fixed_wheel_takes_a_push_along_its_axle(void) {
    scene s;
    laconic_input input = no_input();
    input.body_force_N[1] = REAL(6);
    judge(&s, caster(), start_with(0, 0, 0), input);
    ASSERT_NEAR(EITHER(1e-13, 1e-5), 6, s.out.lateral_N[0]);
    ASSERT_NEAR(EITHER(1e-13, 1e-5), 0, s.out.along_N[0]);
}

static void wheels_on_one_axle_line_share_its_force_equally(void) {
    scene s;
    laconic_input input = no_input();
    input.body_force_N[0] = REAL(6); /* along the axle line ξ, at S: 0.02 m behind it, so the moment is free */
    judge(&s, differential_drive(), start_with(0, 0, 0), input);
    ASSERT_NEAR(EITHER(1e-12, 1e-5), (double)s.out.lateral_N[0], -(double)s.out.lateral_N[1]);
    TEST_ASSERT_TRUE(fabs((double)s.out.lateral_N[0]) > 0.5);
}

/* A braked wheel that is driven with 1 V: the brake holds exactly against the motor. */
static void a_brake_holds_what_the_motor_gives(void) {
    scene s;
    laconic_vehicle v = with_motors(caster());
    laconic_input input = no_input();
    v.wheel[0].locked = true;
    input.voltage_V[0] = REAL(1);
    judge(&s, v, start_with(0, 0, 2), input);
    ASSERT_NEAR(EITHER(1e-13, 1e-6), -GAIN, s.out.brake_Nm[0]);
    ASSERT_NEAR(EITHER(1e-12, 1e-5), 0, s.out.along_N[0]);
}

/* A push of 8 N along ξ against a braked wheel: the ground's reaction is 8 N, the brake's torque R F. */
static void a_brake_holds_a_push(void) {
    scene s;
    laconic_vehicle v = caster();
    laconic_input input = no_input();
    v.wheel[0].locked = true;
    input.body_force_N[0] = REAL(8);
    judge(&s, v, start_with(0, 0, 0), input);
    ASSERT_NEAR(EITHER(1e-12, 1e-5), -8, s.out.along_N[0]);
    ASSERT_NEAR(EITHER(1e-12, 1e-5), -8 * RADIUS, s.out.brake_Nm[0]);
}

static void standing_on_four_wheels_each_carries_a_quarter(void) {
    scene s;
    judge(&s, mecanum(), start_with(0, 0, 0), no_input());
    for (int i = 0; i < 4; i++) ASSERT_NEAR(EITHER(1e-12, 1e-4), MASS * GRAVITY / 4, s.out.normal_N[i]);
}

/* Two wheels at ξ = ±0.075 and a caster at η = 0.1, S at η = 0.02: the caster carries 0.02/0.1 of the weight. */
static void three_points_of_support_are_the_lever_law(void) {
    scene s;
    laconic_vehicle v = differential_drive();
    v.support_count = 1;
    v.support[0].y_m = REAL(0.1);
    judge(&s, v, start_with(0, 0, 0), no_input());
    ASSERT_NEAR(EITHER(1e-11, 2e-4), MASS * GRAVITY * 0.2, s.out.normal_N[2]);
    ASSERT_NEAR(EITHER(1e-11, 2e-4), MASS * GRAVITY * 0.4, s.out.normal_N[0]);
    ASSERT_NEAR(EITHER(1e-11, 2e-4), MASS * GRAVITY * 0.4, s.out.normal_N[1]);
}

/* Accelerating along ξ with a, S at height z: the front pair loses M a z/(2·2·0.2) each, the rear pair gains it. */
static void acceleration_shifts_normal_load_to_the_rear(void) {
    scene s;
    laconic_vehicle v = with_motors(mecanum());
    laconic_input input = no_input();
    laconic_rates rates;
    const laconic_real rest[3] = {0, 0, 0};
    v.com_z_m = REAL(0.12);
    for (int i = 0; i < 4; i++) input.voltage_V[i] = REAL(0.5);
    judge(&s, v, start_with(0, 0, 0), input);
    laconic_derivative(&rates, &s.model, rest, 0, &input);
    const double shift = MASS * RADIUS * (double)rates.nu_rad_per_s2[0] * 0.12 / (4 * 0.2);
    TEST_ASSERT_TRUE(shift > 0.1);
    ASSERT_NEAR(EITHER(1e-11, 2e-4), MASS * GRAVITY / 4 - shift, s.out.normal_N[0]);
    ASSERT_NEAR(EITHER(1e-11, 2e-4), MASS * GRAVITY / 4 + shift, s.out.normal_N[3]);
}

static void the_no_slip_margin_is_the_least_of_all_wheels(void) {
    scene s;
    laconic_vehicle v = with_motors(three_wheels());
    double least = HUGE_VAL;
    v.friction_coefficient = REAL(0.6);
    judge(&s, v, turning_start(0.7, -0.4, 1.9), every_input());
    for (int i = 0; i < 3; i++) {
        const double needed = hypot((double)s.out.along_N[i], (double)s.out.lateral_N[i]);
        const double margin = 0.6 * (double)s.out.normal_N[i] - needed;
        if (margin < least) least = margin;
    }
    ASSERT_NEAR(EITHER(1e-12, 1e-4), least, s.out.no_slip_margin_N);
}

static void without_wheels_the_margin_is_zero(void) {
    scene s;
    judge(&s, bare_body(), start_with(1, 2, 3), no_input());
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)s.out.no_slip_margin_N);
}

static void points_so_far_away_that_constants_leave_the_range_are_refused(void) {
    laconic_vehicle v = three_wheels();
    laconic_contact contact;
    v.support_count = 2;
    v.support[0].x_m = v.support[1].x_m = REAL(EITHER(1.3e154, 1.8e19));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_contact_prepare(&contact, &v, &why), why);
    v.support_count = 0;
    v.com_z_m = v.friction_coefficient = REAL(EITHER(1.3e154, 1.8e19));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_contact_prepare(&contact, &v, &why), why);
}

static void a_margin_that_is_nan_does_not_count_as_large(void) {
    scene s;
    laconic_input input = no_input();
    input.voltage_V[1] = LACONIC_REAL_MAX;
    input.voltage_V[2] = -LACONIC_REAL_MAX;
    judge(&s, with_motors(mecanum()), turning_start(0, 0, 0), input);
    TEST_ASSERT_TRUE(!(s.out.no_slip_margin_N >= -LACONIC_REAL_MAX));
}

/* Either coordinate by itself can be squared, their sum cannot. */
static void a_support_so_far_off_that_products_leave_the_range_is_refused(void) {
    const laconic_real far_m = REAL(0.6 * sqrt((double)LACONIC_REAL_MAX));
    laconic_vehicle v = three_wheels();
    laconic_contact contact;
    v.support_count = 1;
    v.support[0].x_m = far_m;
    ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&contact, &v, &why));
    v.support[0].y_m = far_m;
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_contact_prepare(&contact, &v, &why), why);
}

static void a_refused_vehicle_changes_nothing(void) {
    laconic_vehicle v = three_wheels();
    laconic_contact contact, before;
    memset(&contact, 4, sizeof contact);
    before = contact;
    v.yaw_inertia_kgm2 = 0;
    ASSERT_REFUSED(LACONIC_NOT_POSITIVE, LACONIC_FIELD_YAW_INERTIA, 0, laconic_contact_prepare(&contact, &v, &why),
                   why);
    TEST_ASSERT_EQUAL_MEMORY(&before, &contact, sizeof contact);
}

/* Of fixed wheels and of brakes, the dependent ones too. */
static void constraints_are_counted(void) {
    scene s;
    laconic_vehicle v = differential_drive();
    judge(&s, mecanum(), start_with(0, 0, 0), no_input());
    TEST_ASSERT_EQUAL_INT(0, s.contact.constraint_count);
    TEST_ASSERT_TRUE(s.contact.lateral_row[0] == -1 && s.contact.brake_row[0] == -1);
    judge(&s, v, start_with(0, 0, 0), no_input());
    TEST_ASSERT_EQUAL_INT(2, s.contact.constraint_count);
    v.wheel[1].locked = true;
    judge(&s, v, start_with(0, 0, 0), no_input());
    TEST_ASSERT_EQUAL_INT(3, s.contact.constraint_count);
}

static laconic_reactions change_of(const scene *s, const laconic_reactions *now, const laconic_variation *by) {
    const laconic_motion at = {{0, 0, 0}, 0};
    laconic_reactions change;
    memset(&change, 0xFF, sizeof change); /* no numbers */
    laconic_reactions_tangent(&change, &s->contact, &s->model, &at, &s->input, now, by);
    return change;
}

static void without_wheels_the_margin_does_not_change_either(void) {
    scene s;
    laconic_variation by;
    memset(&by, 0, sizeof by);
    by.input.body_force_N[0] = 1;
    judge(&s, bare_body(), start_with(1, 2, 3), no_input());
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)change_of(&s, &s.out, &by).no_slip_margin_N);
    memset(&s.out, 0xFF, sizeof s.out);
    laconic_reactions_of(&s.out, &s.contact, &s.model, &s.state, &s.input);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)s.out.no_slip_margin_N);
}

/* A fixed wheel holds 0.5 N along its axle, then 1 N more in each unit of the variation. */
static void a_reaction_of_less_than_a_newton_uses_up_the_margin_too(void) {
    scene s;
    laconic_variation by;
    laconic_vehicle v = caster();
    laconic_input input = no_input();
    memset(&by, 0, sizeof by);
    v.friction_coefficient = REAL(0.6);
    input.body_force_N[1] = REAL(0.5);
    by.input.body_force_N[1] = 1;
    judge(&s, v, start_with(0, 0, 0), input);
    ASSERT_NEAR(EITHER(1e-13, 1e-6), -1, change_of(&s, &s.out, &by).no_slip_margin_N);
}

/* Where several wheels have the least margin, the derivative is the first one's. */
static void of_equal_margins_the_first_wheels_changes(void) {
    scene s;
    laconic_variation by;
    laconic_vehicle v = with_motors(mecanum());
    v.com_z_m = REAL(0.12);
    v.friction_coefficient = REAL(0.6);
    judge(&s, v, start_with(0, 0, 0), no_input());
    memset(&by, 0, sizeof by);
    for (int i = 0; i < 4; i++) {
        by.input.voltage_V[i] = 1;
        s.out.normal_N[i] = 20;
        s.out.along_N[i] = 0;
    }
    const laconic_reactions change = change_of(&s, &s.out, &by);
    TEST_ASSERT_TRUE(change.normal_N[0] < REAL(-0.1) && change.normal_N[3] > REAL(0.1));
    TEST_ASSERT_TRUE(change.no_slip_margin_N == REAL(0.6) * change.normal_N[0]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(reactions_and_outer_forces_make_the_motion);
    RUN_TEST(reactions_balance_with_the_radius_and_the_inertia_of_each_wheel);
    RUN_TEST(the_brake_of_a_wheel_holds_with_its_own_arm);
    RUN_TEST(a_roller_wheels_reaction_is_torque_less_its_own_inertia);
    RUN_TEST(a_fixed_wheel_takes_a_push_along_its_axle);
    RUN_TEST(wheels_on_one_axle_line_share_its_force_equally);
    RUN_TEST(a_brake_holds_what_the_motor_gives);
    RUN_TEST(a_brake_holds_a_push);
    RUN_TEST(standing_on_four_wheels_each_carries_a_quarter);
    RUN_TEST(three_points_of_support_are_the_lever_law);
    RUN_TEST(acceleration_shifts_normal_load_to_the_rear);
    RUN_TEST(the_no_slip_margin_is_the_least_of_all_wheels);
    RUN_TEST(without_wheels_the_margin_is_zero);
    RUN_TEST(points_so_far_away_that_constants_leave_the_range_are_refused);
    RUN_TEST(a_margin_that_is_nan_does_not_count_as_large);
    RUN_TEST(a_support_so_far_off_that_products_leave_the_range_is_refused);
    RUN_TEST(a_refused_vehicle_changes_nothing);
    RUN_TEST(constraints_are_counted);
    RUN_TEST(without_wheels_the_margin_does_not_change_either);
    RUN_TEST(a_reaction_of_less_than_a_newton_uses_up_the_margin_too);
    RUN_TEST(of_equal_margins_the_first_wheels_changes);
    return UNITY_END();
}
