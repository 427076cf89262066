/* Tests of the filter that need no other implementation; host_tests/tests/control compares with a dense one. */
#include "laconic/filter.h"
#include "vehicles.h"

#define STEP_S REAL(0.01)
#define CLOSE EITHER(1e-12, 1e-4)

typedef struct robot {
    laconic_model model;
    laconic_integrator integrator;
    laconic_filter filter;
    laconic_input held;
} robot;

static laconic_filter_settings usual(void) {
    laconic_filter_settings s;
    memset(&s, 0, sizeof s);
    s.voltage_noise_V_per_sqrt_Hz = REAL(0.1);
    s.force_noise_N_per_sqrt_Hz = REAL(0.05);
    s.slip_noise_m_per_s_per_sqrt_Hz = REAL(0.001);
    s.yaw_slip_noise_rad_per_s_per_sqrt_Hz = REAL(0.002);
    s.bias_noise_rad_per_s2_per_sqrt_Hz = REAL(1e-4);
    for (int k = 0; k < 3; k++) s.nu_std_rad_per_s[k] = REAL(0.3);
    s.position_std_m = REAL(0.1);
    s.heading_std_rad = REAL(0.2);
    s.bias_std_rad_per_s = REAL(0.05);
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) s.encoder_std_rad[i] = REAL(0.002);
    s.yaw_rate_std_rad_per_s = REAL(0.01);
    return s;
}

static robot robot_with(laconic_vehicle v, laconic_filter_settings settings, laconic_start start) {
    robot r;
    r.model = model_of(v);
    ASSERT_STATUS(LACONIC_OK, laconic_integrator_prepare(&r.integrator, &laconic_auto, &r.model, STEP_S, NULL));
    const laconic_state state = state_of(&r.model, start);
    ASSERT_STATUS(LACONIC_OK, laconic_filter_start(&r.filter, &r.model, &settings, &state));
    r.held = no_input();
    for (int32_t i = 0; i < v.wheel_count; i++) r.held.voltage_V[i] = REAL(2.0 - 1.5 * i);
    return r;
}

static void predict(robot *r, int steps) {
    for (int k = 0; k < steps; k++)
        ASSERT_STATUS(LACONIC_OK, laconic_filter_predict(&r->filter, &r->model, &r->integrator, &r->held));
}

static double covariance(const robot *r, int i, int j) {
    laconic_real p[LACONIC_FILTER_OUTPUTS * LACONIC_FILTER_OUTPUTS];
    laconic_filter_covariance(p, &r->filter, &r->model);
    return (double)p[i * LACONIC_FILTER_OUTPUTS + j];
}

static void the_estimate_without_readings_is_the_core_s_own_run(void) {
    robot r = robot_with(with_motors(three_wheels()), usual(), start_with(0.5, -0.2, 1.0));
    laconic_state state = r.filter.state;
    laconic_status status;
    predict(&r, 50);
    laconic_run(&r.model, &r.integrator, &state, &r.held, 50, &status);
    TEST_ASSERT_EQUAL_MEMORY(&state, &r.filter.state, sizeof state);
}

static void the_start_is_as_uncertain_as_it_was_said_to_be(void) {
    const robot r = robot_with(with_motors(three_wheels()), usual(), start_with(0, 0, 0));
    const double std[] = {0.3, 0.3, 0.3, 0.1, 0.1, 0.2, 0.05};
    for (int i = 0; i < LACONIC_FILTER_OUTPUTS; i++)
        for (int j = 0; j < LACONIC_FILTER_OUTPUTS; j++)
            ASSERT_NEAR(EITHER(1e-14, 1e-7), i == j ? std[i] * std[i] : 0, covariance(&r, i, j));
}

/* ν2 of this robot is 0, whatever is said of it. */
static void what_constraints_forbid_is_certain(void) {
    robot r = robot_with(with_motors(differential_drive()), usual(), start_with(0, 0, 0));
    laconic_real nu[3];
    predict(&r, 30);
    ASSERT_STATUS(LACONIC_OK, laconic_filter_yaw_rate(&r.filter, &r.model, REAL(0.3), NULL));
    laconic_nu(&r.model, &r.filter.state, nu);
    const double forbidden = (double)nu[1] - (double)(r.model.nu_of_zeta[1][0] * r.filter.state.zeta[0].value +
                                                      r.model.nu_of_zeta[1][1] * r.filter.state.zeta[1].value);
    ASSERT_NEAR(CLOSE, 0, forbidden);
    TEST_ASSERT_EQUAL_INT(2, r.filter.dof);
}

/* P − P h hᵀ P/(hᵀPh + R), with h = (0, 0, 1/Λ, 0, 0, 0, 1) for the gyro. */
static void a_reading_shrinks_the_covariance_by_the_plain_formula(void) {
    robot r = robot_with(with_motors(three_wheels()), usual(), start_with(0.5, -0.2, 1.0));
    laconic_innovation found;
    double before[7][7], along[7], variance = 1e-4;
    predict(&r, 20);
    const double h2 = 1 / (double)r.model.yaw_scale;
    for (int i = 0; i < 7; i++) {
        for (int j = 0; j < 7; j++) before[i][j] = covariance(&r, i, j);
        along[i] = h2 * before[i][2] + before[i][6];
    }
    variance += h2 * along[2] + along[6];
    ASSERT_STATUS(LACONIC_OK, laconic_filter_yaw_rate(&r.filter, &r.model, REAL(0.7), &found));
    TEST_ASSERT_EQUAL_INT(1, found.count);
    for (int i = 0; i < 7; i++)
        for (int j = 0; j < 7; j++)
            ASSERT_NEAR(EITHER(1e-13, 1e-5), before[i][j] - along[i] * along[j] / variance, covariance(&r, i, j));
}

static void a_fix_without_error_places_the_robot(void) {
    robot r = robot_with(with_motors(three_wheels()), usual(), start_with(0, 0, 0));
    laconic_pose_fix fix;
    laconic_pose pose;
    memset(&fix, 0, sizeof fix);
    fix.x_m = REAL(0.05);
    fix.heading_rad = REAL(0.1 + 4 * PI);
    fix.std_m = fix.heading_std_rad = REAL(1e-6);
    ASSERT_STATUS(LACONIC_OK, laconic_filter_fix(&r.filter, &r.model, &fix, NULL));
    laconic_pose_of(&pose, &r.model, &r.filter.state);
    ASSERT_NEAR(1e-6, 0.1, pose.heading_rad);
    ASSERT_NEAR(1e-3, 0.05, pose.origin_x_m);
    ASSERT_NEAR(1e-3, 0, pose.origin_y_m);
}

static void counts_wrap_by_the_shorter_way(void) {
    laconic_sensor_settings s;
    memset(&s, 0, sizeof s);
    s.encoder_wrap = 1000;
    s.encoder[0].counts_per_turn = 100;
    s.encoder[1].counts_per_turn = 100;
    s.encoder[1].gear_ratio = REAL(-2);
    const int32_t before[3] = {990, 10, 5}, now[3] = {10, 990, 9};
    laconic_real turned[3];
    laconic_filter_turned(turned, &s, before, now, 3);
    ASSERT_NEAR(1e-6, 0.4 * PI, turned[0]);
    ASSERT_NEAR(1e-6, 0.2 * PI, turned[1]);
    ASSERT_NEAR(0, 0, turned[2]);
    s.encoder_wrap = 0;
    const int32_t end[3] = {2147483647, 0, 0}, beyond[3] = {-2147483647, 0, 0};
    laconic_filter_turned(turned, &s, end, beyond, 3);
    ASSERT_NEAR(1e-6, 0.04 * PI, turned[0]);
}

/* Of half a wrap nobody can tell the direction: it is the sign that the numbers have. A wheel without an encoder has
 * not turned, whatever stood there. */
static void half_a_wrap_keeps_its_sign_and_no_encoder_turns_nothing(void) {
    laconic_sensor_settings s;
    memset(&s, 0, sizeof s);
    s.encoder[0].counts_per_turn = s.encoder[1].counts_per_turn = 1000;
    s.encoder_wrap = 1000;
    const int32_t before[3] = {100, 600, 0}, now[3] = {600, 100, 500};
    laconic_real turned[3] = {NOT_A_NUMBER, NOT_A_NUMBER, NOT_A_NUMBER};
    laconic_filter_turned(turned, &s, before, now, 3);
    ASSERT_NEAR(1e-6, PI, turned[0]);
    ASSERT_NEAR(1e-6, -PI, turned[1]);
    TEST_ASSERT_TRUE(turned[2] == 0);
}

static void each_number_of_a_covariance_must_be_finite(void) {
    const robot r = robot_with(with_motors(three_wheels()), usual(), start_with(0.5, 0, 0));
    for (int row = 0; row < r.filter.errors; row++)
        for (int column = row; column < r.filter.errors; column++) {
            robot wrong = r;
            laconic_factors *of = &wrong.filter.covariance;
            *(row == column ? &of->diagonal[row] : &of->upper[row][column]) = NOT_A_NUMBER;
            const laconic_status status =
                laconic_filter_predict(&wrong.filter, &wrong.model, &wrong.integrator, &wrong.held);
            TEST_ASSERT_NOT_EQUAL(LACONIC_OK, status);
        }
}

static void a_world_force_turns_with_the_heading_error(void) {
    laconic_filter_settings s = usual();
    robot still = robot_with(with_motors(three_wheels()), s, start_with(0, 0, 0)), pushed = still;
    for (int i = 0; i < 3; i++) still.held.voltage_V[i] = pushed.held.voltage_V[i] = 0;
    pushed.held.world_force_N[0] = REAL(20);
    predict(&still, 20);
    predict(&pushed, 20);
    ASSERT_NEAR(CLOSE, 0, covariance(&still, 1, 5));
    TEST_ASSERT_TRUE(covariance(&pushed, 1, 5) < -1e-3); /* a heading to the left: the push comes from the left */
}

static void nothing_changes_where_a_call_is_refused(void) {
    robot r = robot_with(with_motors(three_wheels()), usual(), start_with(0.5, 0, 0));
    laconic_real turned[3] = {0, NOT_A_NUMBER, 0};
    laconic_pose_fix fix;
    predict(&r, 3);
    const laconic_filter before = r.filter;
    r.held.voltage_V[0] = INFINITE;
    TEST_ASSERT_TRUE(laconic_filter_predict(&r.filter, &r.model, &r.integrator, &r.held) != LACONIC_OK);
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_filter_encoders(&r.filter, &r.model, turned, NULL));
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_filter_yaw_rate(&r.filter, &r.model, NOT_A_NUMBER, NULL));
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_yaw_rate(&r.filter, &r.model, EITHER(1e200, REAL(1e30)), NULL));
    memset(&fix, 0, sizeof fix);
    ASSERT_STATUS(LACONIC_NOT_POSITIVE, laconic_filter_fix(&r.filter, &r.model, &fix, NULL));
    fix.std_m = REAL(-1);
    ASSERT_STATUS(LACONIC_NEGATIVE, laconic_filter_fix(&r.filter, &r.model, &fix, NULL));
    fix.x_m = INFINITE;
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_filter_fix(&r.filter, &r.model, &fix, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before.state, &r.filter.state, sizeof before.state);
    TEST_ASSERT_EQUAL_MEMORY(&before.covariance, &r.filter.covariance, sizeof before.covariance);
}

static void settings_out_of_range_are_refused(void) {
    const laconic_model model = model_of(with_motors(three_wheels()));
    const laconic_state state = moving(&model, 0, 0, 0);
    laconic_filter_settings s = usual();
    laconic_filter filter;
    s.encoder_std_rad[2] = REAL(-1);
    ASSERT_STATUS(LACONIC_NEGATIVE, laconic_filter_start(&filter, &model, &s, &state));
    s = usual();
    s.yaw_rate_std_rad_per_s = NOT_A_NUMBER;
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_filter_start(&filter, &model, &s, &state));
    s = usual();
    s.heading_std_rad = EITHER(1e200, REAL(1e30));
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_start(&filter, &model, &s, &state));
}

static void instruments_that_are_not_there_are_refused(void) {
    laconic_filter_settings none;
    laconic_real turned[3] = {0};
    memset(&none, 0, sizeof none);
    robot r = robot_with(with_motors(three_wheels()), none, start_with(0, 0, 0));
    ASSERT_STATUS(LACONIC_NOT_POSITIVE, laconic_filter_encoders(&r.filter, &r.model, turned, NULL));
    ASSERT_STATUS(LACONIC_NOT_POSITIVE, laconic_filter_yaw_rate(&r.filter, &r.model, 0, NULL));
    predict(&r, 10); /* certain of everything: nothing to divide by */
    ASSERT_NEAR(0, 0, covariance(&r, 3, 3));
    TEST_ASSERT_EQUAL_INT(6, r.filter.errors);
}

static void the_covariance_stays_positive_over_a_hundred_thousand_steps(void) {
    robot r = robot_with(with_motors(three_wheels()), usual(), start_with(0.5, -0.2, 1.0));
    laconic_real turned[3], angle[LACONIC_MAX_WHEELS];
    for (int k = 0; k < LONG_RUN(100000); k++) {
        if (laconic_filter_predict(&r.filter, &r.model, &r.integrator, &r.held) != LACONIC_OK) TEST_FAIL();
        if (k % 10 > 0) continue;
        laconic_wheel_angles(&r.model, &r.filter.state, angle);
        for (int i = 0; i < 3; i++) turned[i] = angle[i];
        if (laconic_filter_encoders(&r.filter, &r.model, turned, NULL) != LACONIC_OK) TEST_FAIL();
        for (int i = 0; i < r.filter.errors; i++) TEST_ASSERT_TRUE(r.filter.covariance.diagonal[i] >= 0);
    }
    for (int i = 0; i < LACONIC_FILTER_OUTPUTS; i++) {
        TEST_ASSERT_TRUE(covariance(&r, i, i) > 0);
        for (int j = 0; j < i; j++) {
            TEST_ASSERT_TRUE(covariance(&r, i, j) == covariance(&r, j, i));
            TEST_ASSERT_TRUE(fabs(covariance(&r, i, j)) <=
                             (1 + EITHER(1e-12, 1e-4)) * sqrt(covariance(&r, i, i) * covariance(&r, j, j)));
        }
    }
}

/* Its drift alone is enough for a bias to be estimated; without either there is none, and a reading leaves it 0. */
static void a_bias_is_estimated_where_it_may_be_or_become_one(void) {
    laconic_filter_settings s = usual();
    s.bias_std_rad_per_s = 0;
    robot r = robot_with(with_motors(three_wheels()), s, start_with(0, 0, 0));
    TEST_ASSERT_EQUAL_INT(1, r.filter.biases);
    predict(&r, 20);
    ASSERT_STATUS(LACONIC_OK, laconic_filter_yaw_rate(&r.filter, &r.model, REAL(0.3), NULL));
    TEST_ASSERT_TRUE(r.filter.bias_rad_per_s != 0);
    s.bias_noise_rad_per_s2_per_sqrt_Hz = 0;
    r = robot_with(with_motors(three_wheels()), s, start_with(0, 0, 0));
    TEST_ASSERT_EQUAL_INT(0, r.filter.biases);
    predict(&r, 20);
    ASSERT_STATUS(LACONIC_OK, laconic_filter_yaw_rate(&r.filter, &r.model, REAL(0.3), NULL));
    TEST_ASSERT_TRUE(r.filter.bias_rad_per_s == 0);
}

/* Its angle goes on from where it was; the others are measured from the reading. */
static void a_wheel_without_an_encoder_is_not_read(void) {
    laconic_filter_settings s = usual();
    laconic_real turned[LACONIC_MAX_WHEELS], after[LACONIC_MAX_WHEELS];
    laconic_innovation found;
    s.encoder_std_rad[1] = 0;
    robot r = robot_with(with_motors(three_wheels()), s, start_with(0.5, -0.2, 1.0));
    predict(&r, 10);
    laconic_wheel_angles(&r.model, &r.filter.state, turned);
    const laconic_real of_second = turned[1];
    turned[1] = NOT_A_NUMBER; /* nobody looks */
    ASSERT_STATUS(LACONIC_OK, laconic_filter_encoders(&r.filter, &r.model, turned, &found));
    TEST_ASSERT_EQUAL_INT(2, found.count);
    laconic_wheel_angles(&r.model, &r.filter.state, after);
    ASSERT_NEAR(CLOSE, 0, after[0]);
    ASSERT_NEAR(CLOSE, 0, after[2]);
    ASSERT_NEAR(CLOSE, of_second, after[1]);
    TEST_ASSERT_TRUE(of_second > REAL(0.01) || of_second < REAL(-0.01));
}

static void a_fix_may_be_of_the_place_or_of_the_heading_alone(void) {
    laconic_pose_fix fix;
    laconic_innovation found;
    memset(&fix, 0, sizeof fix);
    fix.x_m = REAL(0.07);
    fix.heading_rad = REAL(0.3);
    for (int of_heading = 0; of_heading < 2; of_heading++) {
        robot r = robot_with(with_motors(three_wheels()), usual(), start_with(0, 0, 0));
        fix.place_x_m = r.model.com_x_m;
        fix.place_y_m = r.model.com_y_m;
        fix.std_m = REAL(of_heading ? 0 : 1e-6);
        fix.heading_std_rad = REAL(of_heading ? 1e-6 : 0);
        ASSERT_STATUS(LACONIC_OK, laconic_filter_fix(&r.filter, &r.model, &fix, &found));
        TEST_ASSERT_EQUAL_INT(of_heading ? 1 : 2, found.count);
        laconic_pose pose;
        laconic_pose_of(&pose, &r.model, &r.filter.state);
        ASSERT_NEAR(EITHER(1e-9, 1e-5), of_heading ? 0.3 : 0, pose.heading_rad);
        ASSERT_NEAR(EITHER(1e-9, 1e-5), of_heading ? 0 : 0.07, pose.x_m);
    }
    robot r = robot_with(with_motors(three_wheels()), usual(), start_with(0, 0, 0));
    fix.std_m = fix.heading_std_rad = 0;
    ASSERT_STATUS(LACONIC_NOT_POSITIVE, laconic_filter_fix(&r.filter, &r.model, &fix, NULL));
    fix.std_m = 1;
    fix.heading_std_rad = -1;
    ASSERT_STATUS(LACONIC_NEGATIVE, laconic_filter_fix(&r.filter, &r.model, &fix, NULL));
    fix.std_m = -1;
    fix.heading_std_rad = 1;
    ASSERT_STATUS(LACONIC_NEGATIVE, laconic_filter_fix(&r.filter, &r.model, &fix, NULL));
}

/* A reading far from all that can be leaves the estimate as it was. */
static void readings_beyond_the_range_change_nothing(void) {
    robot r = robot_with(with_motors(three_wheels()), usual(), start_with(0, 0, 0));
    laconic_real turned[LACONIC_MAX_WHEELS] = {0};
    predict(&r, 10);
    laconic_filter before = r.filter;
    const laconic_real far[2] = {REAL(EITHER(1e85, 1e15)), REAL(EITHER(1e200, 1e30))};
    for (int k = 0; k < 2; k++) {
        turned[0] = far[k];
        ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_yaw_rate(&r.filter, &r.model, far[k], NULL));
        ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_encoders(&r.filter, &r.model, turned, NULL));
        TEST_ASSERT_EQUAL_MEMORY(&before, &r.filter, sizeof before);
    }
    r.filter.state.heading.turns = (int64_t)1 << 62;
    before = r.filter;
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_yaw_rate(&r.filter, &r.model, 0, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &r.filter, sizeof before);
}

static void noise_beyond_the_range_is_refused_at_the_start_or_when_it_gets_there(void) {
    laconic_filter_settings s = usual();
    robot r = robot_with(with_motors(three_wheels()), s, start_with(0, 0, 0));
    laconic_filter filter = r.filter;
    s.voltage_noise_V_per_sqrt_Hz = REAL(EITHER(1e200, 1e30));
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_start(&filter, &r.model, &s, &r.filter.state));
    s = usual();
    s.position_std_m = REAL(EITHER(1e200, 1e30));
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_start(&filter, &r.model, &s, &r.filter.state));
    s = usual();
    s.slip_noise_m_per_s_per_sqrt_Hz = REAL(EITHER(1e154, 1.5e19));
    ASSERT_STATUS(LACONIC_OK, laconic_filter_start(&filter, &r.model, &s, &r.filter.state));
    laconic_status status = LACONIC_OK;
    int steps = 0;
    for (; steps < 100000 && status == LACONIC_OK; steps++)
        status = laconic_filter_predict(&filter, &r.model, &r.integrator, &r.held);
    ASSERT_STATUS(LACONIC_OVERFLOW, status);
    const laconic_filter before = filter;
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_predict(&filter, &r.model, &r.integrator, &r.held));
    TEST_ASSERT_EQUAL_MEMORY(&before.covariance, &filter.covariance, sizeof before.covariance);
    TEST_ASSERT_EQUAL_MEMORY(&before.state, &filter.state, sizeof before.state);
}

/* The squares of settings fit, what the vehicle makes of them does not: noise of voltages by a strong motor, then ν of
 * the start by the wheels' inertia. */
static void what_the_vehicle_makes_of_the_settings_is_refused_beyond_the_range(void) {
    laconic_vehicle strong = with_motors(three_wheels()), heavy = three_wheels();
    laconic_filter_settings s = usual();
    laconic_filter filter;
    memset(&filter, 0, sizeof filter);
    const laconic_filter before = filter;
    strong.motor_gain_Nm_per_V = REAL(EITHER(1e100, 1e10));
    s.voltage_noise_V_per_sqrt_Hz = REAL(EITHER(1e100, 1e12));
    laconic_model model = model_of(strong);
    laconic_state state = moving(&model, 0, 0, 0);
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_start(&filter, &model, &s, &state));
    s = usual();
    heavy.wheel_inertia_kgm2 = REAL(1e4);
    s.nu_std_rad_per_s[0] = s.nu_std_rad_per_s[1] = REAL(EITHER(1e154, 1.5e19));
    model = model_of(heavy);
    state = moving(&model, 0, 0, 0);
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_start(&filter, &model, &s, &state));
    TEST_ASSERT_EQUAL_MEMORY(&before, &filter, sizeof before);
}

/* A place seen aside of the robot's path turns the robot; here by more than a heading can count. */
static void a_fix_that_would_turn_the_robot_beyond_all_counts_changes_nothing(void) {
    laconic_filter_settings s = usual();
    laconic_pose_fix fix;
    s.heading_std_rad = REAL(1e6);
    robot r = robot_with(with_motors(three_wheels()), s, start_with(0, 0, 0));
    const laconic_filter before = r.filter;
    memset(&fix, 0, sizeof fix);
    fix.place_x_m = REAL(1);
    fix.y_m = REAL(EITHER(1e25, 1e15));
    fix.std_m = REAL(0.1);
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_fix(&r.filter, &r.model, &fix, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &r.filter, sizeof before);
    fix.y_m = REAL(1e3);
    ASSERT_STATUS(LACONIC_OK, laconic_filter_fix(&r.filter, &r.model, &fix, NULL));
    TEST_ASSERT_TRUE(r.filter.state.heading.turns > 100);
}

/* The estimate is right about a place far away, and its heading is certain: nothing is to be corrected, and yet the
 * covariance would leave the range. */
static void a_fix_whose_covariance_leaves_the_range_changes_nothing(void) {
    laconic_filter_settings s = usual();
    laconic_pose_fix fix;
    s.heading_std_rad = 0;
    s.position_std_m = REAL(1e-10);
    robot r = robot_with(with_motors(three_wheels()), s, start_with(0, 0, 0));
    const laconic_filter before = r.filter;
    memset(&fix, 0, sizeof fix);
    fix.x_m = fix.place_x_m = REAL(EITHER(1e300, 1e30));
    fix.y_m = -r.model.com_y_m;
    fix.std_m = REAL(1e-10);
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_filter_fix(&r.filter, &r.model, &fix, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &r.filter, sizeof before);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_estimate_without_readings_is_the_core_s_own_run);
    RUN_TEST(the_start_is_as_uncertain_as_it_was_said_to_be);
    RUN_TEST(what_constraints_forbid_is_certain);
    RUN_TEST(a_reading_shrinks_the_covariance_by_the_plain_formula);
    RUN_TEST(a_fix_without_error_places_the_robot);
    RUN_TEST(counts_wrap_by_the_shorter_way);
    RUN_TEST(half_a_wrap_keeps_its_sign_and_no_encoder_turns_nothing);
    RUN_TEST(each_number_of_a_covariance_must_be_finite);
    RUN_TEST(a_world_force_turns_with_the_heading_error);
    RUN_TEST(nothing_changes_where_a_call_is_refused);
    RUN_TEST(settings_out_of_range_are_refused);
    RUN_TEST(instruments_that_are_not_there_are_refused);
    RUN_TEST(the_covariance_stays_positive_over_a_hundred_thousand_steps);
    RUN_TEST(a_bias_is_estimated_where_it_may_be_or_become_one);
    RUN_TEST(a_wheel_without_an_encoder_is_not_read);
    RUN_TEST(a_fix_may_be_of_the_place_or_of_the_heading_alone);
    RUN_TEST(readings_beyond_the_range_change_nothing);
    RUN_TEST(noise_beyond_the_range_is_refused_at_the_start_or_when_it_gets_there);
    RUN_TEST(what_the_vehicle_makes_of_the_settings_is_refused_beyond_the_range);
    RUN_TEST(a_fix_that_would_turn_the_robot_beyond_all_counts_changes_nothing);
    RUN_TEST(a_fix_whose_covariance_leaves_the_range_changes_nothing);
    return UNITY_END();
}
