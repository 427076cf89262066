/* Tests of state.c: start values, and a motion carried over to a changed vehicle. */
#include "stack.h"
#include "vehicles.h"

/* ------------------------------------------------------------------------------------- start -- */

static laconic_refusal why;

static void what_is_set_is_what_is_read(void) {
    const laconic_model m = model_of(mecanum());
    laconic_start start = start_with(0.7, -0.4, 1.9);
    laconic_state state;
    laconic_real nu[3], angle[4];
    laconic_pose pose;
    start.x_m = REAL(-3.5);
    start.y_m = REAL(12.25);
    start.heading_rad = REAL(-20);
    memset(&state, 9, sizeof state);
    ASSERT_STATUS(LACONIC_OK, laconic_state_set(&state, &m, &start, NULL));
    laconic_nu(&m, &state, nu);
    ASSERT_NEAR_ALL(4 * ROUNDING, start.nu_rad_per_s, nu, 3);
    laconic_pose_of(&pose, &m, &state);
    TEST_ASSERT_EQUAL_DOUBLE(-3.5, (double)pose.x_m);
    TEST_ASSERT_EQUAL_DOUBLE(12.25, (double)pose.y_m);
    ASSERT_NEAR(EITHER(1e-14, 1e-5), -20, pose.heading_rad);
    laconic_wheel_angles(&m, &state, angle);
    for (int i = 0; i < 4; i++) TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)angle[i]);
}

static void refuses(laconic_start start, laconic_status status, laconic_field field, int item) {
    const laconic_model m = model_of(three_wheels());
    laconic_state state, before;
    memset(&state, 3, sizeof state);
    before = state;
    ASSERT_REFUSED(status, field, item, laconic_state_set(&state, &m, &start, &why), why);
    TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
}

static void every_number_that_is_not_finite_is_named(void) {
    laconic_start start;
    refuses(start_with((double)NAN, 0, 0), LACONIC_NOT_FINITE, LACONIC_FIELD_START_NU, 1);
    refuses(start_with(0, 0, -HUGE_VAL), LACONIC_NOT_FINITE, LACONIC_FIELD_START_NU, 3);
    start = start_with(0, 0, 0);
    start.x_m = INFINITE;
    refuses(start, LACONIC_NOT_FINITE, LACONIC_FIELD_START_X, 0);
    start = start_with(0, 0, 0);
    start.y_m = NOT_A_NUMBER;
    refuses(start, LACONIC_NOT_FINITE, LACONIC_FIELD_START_Y, 0);
    start = start_with(0, 0, 0);
    start.heading_rad = NOT_A_NUMBER;
    refuses(start, LACONIC_NOT_FINITE, LACONIC_FIELD_START_HEADING, 0);
}

static void a_heading_or_velocity_beyond_the_range_is_refused(void) {
    laconic_start start = start_with(0, 0, 0);
    start.heading_rad = REAL(1e30);
    refuses(start, LACONIC_OVERFLOW, LACONIC_FIELD_START_HEADING, 0);
    refuses(start_with((double)LACONIC_REAL_MAX, 0, (double)LACONIC_REAL_MAX), LACONIC_OVERFLOW, LACONIC_FIELD_START_NU,
            0);
}

/* The largest numbers are taken, and their neighbours refused: a heading below 2^64 rad, or 2^32 in single precision,
 * and a size of ζ, which is ν for a body alone, up to 1e77 or 1e9. */
static void headings_and_velocities_are_taken_up_to_their_limits(void) {
    const laconic_model m = model_of(bare_body());
    const laconic_real turn = REAL(ldexp(1, EITHER(64, 32))), fastest = REAL(EITHER(1e77, 1e9));
    laconic_state state;
    laconic_start start = start_with(0, 0, 0);
    start.heading_rad = turn;
    refuses(start, LACONIC_OVERFLOW, LACONIC_FIELD_START_HEADING, 0);
    start.heading_rad = -turn * (1 - LACONIC_EPSILON / 2);
    ASSERT_STATUS(LACONIC_OK, laconic_state_set(&state, &m, &start, &why));
    for (int k = 0; k < 3; k++) {
        start = start_with(0, 0, 0);
        start.nu_rad_per_s[k] = fastest;
        ASSERT_STATUS(LACONIC_OK, laconic_state_set(&state, &m, &start, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_state_project(&state, &m, &start, &why));
        start.nu_rad_per_s[k] *= 1 + 2 * LACONIC_EPSILON;
        ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_START_NU, 0, laconic_state_set(&state, &m, &start, &why), why);
        ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_START_NU, 0, laconic_state_project(&state, &m, &start, &why),
                       why);
        TEST_ASSERT_TRUE(why.limit == 0);
    }
}

static void a_velocity_of_any_size_is_refused_before_it_becomes_nan(void) {
    const laconic_model m = model_of(differential_drive());
    laconic_start start = start_with((double)LACONIC_REAL_MAX, (double)LACONIC_REAL_MAX, (double)LACONIC_REAL_MAX);
    laconic_state state;
    TEST_ASSERT_NOT_EQUAL(LACONIC_OK, laconic_state_set(&state, &m, &start, &why));
}

static void a_start_that_slides_a_fixed_wheel_is_refused_with_the_nearest_that_does_not(void) {
    const laconic_model m = model_of(caster());
    laconic_start start = start_with(1, 0.25, 2);
    laconic_state state;
    ASSERT_REFUSED(LACONIC_START_AGAINST_CONSTRAINTS, LACONIC_FIELD_START_NU, 2,
                   laconic_state_set(&state, &m, &start, &why), why);
    ASSERT_NEAR(ROUNDING, 0.25, why.value);
    ASSERT_NEAR(ROUNDING, 0, why.limit);
    start = start_with(1, 0, 2);
    ASSERT_STATUS(LACONIC_OK, laconic_state_set(&state, &m, &start, &why));
}

/* A locked wheel below S: only a rotation is left, so both others are wrong by the same. */
static void of_two_that_are_equally_wrong_the_first_is_named(void) {
    laconic_vehicle v = bare_body();
    laconic_start start = start_with(-2, 2, 1);
    laconic_state state;
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0, 0, 0, 0);
    v.wheel[0].locked = true;
    const laconic_model m = model_of(v);
    ASSERT_REFUSED(LACONIC_START_AGAINST_CONSTRAINTS, LACONIC_FIELD_START_NU, 1,
                   laconic_state_set(&state, &m, &start, &why), why);
    start = start_with(2, 2.5, 1);
    ASSERT_REFUSED(LACONIC_START_AGAINST_CONSTRAINTS, LACONIC_FIELD_START_NU, 2,
                   laconic_state_set(&state, &m, &start, &why), why);
}

/* A wheel that is far ahead and may not move aside forbids the yaw more than anything else. */
static void a_start_that_yaws_against_a_far_wheel_names_the_yaw(void) {
    laconic_vehicle v = bare_body();
    laconic_start start = start_with(0, 0, 1);
    laconic_state state;
    add_wheel(&v, LACONIC_WHEEL_FIXED, 5, 0, PI / 2, 0);
    const laconic_model m = model_of(v);
    ASSERT_REFUSED(LACONIC_START_AGAINST_CONSTRAINTS, LACONIC_FIELD_START_NU, 3,
                   laconic_state_set(&state, &m, &start, &why), why);
    TEST_ASSERT_TRUE(why.value == 1 && why.limit > 0 && why.limit < REAL(0.1));
}

/* Along its axle a wheel may not move at all: of that 0 is told, not what rounding leaves of it. */
static void of_a_motion_that_is_forbidden_altogether_zero_is_told(void) {
    for (int k = 1; k < 45; k++) {
        const double angle = PI / 180 * (2 * k); /* never 45° */
        laconic_vehicle v = bare_body();
        laconic_start start = start_with(cos(angle), sin(angle), 0);
        laconic_state state;
        add_wheel(&v, LACONIC_WHEEL_FIXED, 0, 0, angle, 0);
        const laconic_model m = model_of(v);
        ASSERT_REFUSED(LACONIC_START_AGAINST_CONSTRAINTS, LACONIC_FIELD_START_NU, 2 * k < 45 ? 1 : 2,
                       laconic_state_set(&state, &m, &start, &why), why);
        TEST_ASSERT_TRUE(why.limit == 0);
    }
}

static void a_start_that_rotates_a_locked_wheel_is_refused(void) {
    laconic_vehicle v = three_wheels();
    laconic_start start = start_with(1, 0, 0);
    laconic_state state;
    laconic_model m;
    v.wheel[2].locked = true; /* χ3' = −ν1 + ρ ν3 */
    m = model_of(v);
    ASSERT_STATUS(LACONIC_START_AGAINST_CONSTRAINTS, laconic_state_set(&state, &m, &start, NULL));
    start = start_with(RHO * 1.5, -2, 1.5);
    ASSERT_STATUS(LACONIC_OK, laconic_state_set(&state, &m, &start, &why));
}

/* So slow that rounding is as large as the velocities, or a share of them that counts. */
static void without_constraints_a_start_of_any_slowness_is_allowed(void) {
    const laconic_model m = model_of(with_own_wheels(mecanum()));
    const double slow = (double)LACONIC_REAL_MIN * (double)LACONIC_EPSILON;
    for (int k = 1; k < 20; k++) {
        const laconic_start start = start_with(slow * k, slow / k, slow * (7 - k));
        laconic_state state;
        ASSERT_STATUS(LACONIC_OK, laconic_state_set(&state, &m, &start, &why));
    }
}

static void rest_is_always_allowed(void) {
    const laconic_model m = model_of(differential_drive());
    const laconic_start start = start_with(0, 0, 0);
    laconic_state state;
    ASSERT_STATUS(LACONIC_OK, laconic_state_set(&state, &m, &start, &why));
}

/* A payload set down at (0.3, −0.1): S moves by (0.1, −0.04). The motion of the body must not change. */
static void a_changed_vehicle_moves_on_where_the_old_one_was(void) {
    laconic_vehicle v = three_wheels();
    const laconic_model from = model_of(v);
    laconic_model to;
    laconic_start start = start_with(0.7, -0.4, 1.9);
    laconic_state state;
    laconic_pose before, after;
    laconic_real old_speed[3], new_speed[3], velocity[2], old_origin[2], yaw, old_yaw;
    const laconic_real angle[3] = {REAL(1), REAL(5), REAL(-2)};
    laconic_real after_angle[3];
    start.x_m = REAL(1);
    start.heading_rad = REAL(0.6);
    state = state_of(&from, start);
    laconic_wheel_angles_set(&from, &state, angle);
    laconic_wheel_speeds(&from, &state, old_speed);
    laconic_pose_of(&before, &from, &state);
    old_yaw = laconic_body_velocity(&from, &state, velocity);
    old_origin[0] = velocity[0] + old_yaw * from.com_y_m;
    old_origin[1] = velocity[1] - old_yaw * from.com_x_m;
    v.payload.mass_kg = REAL(5);
    v.payload.x_m = REAL(0.3);
    v.payload.y_m = REAL(-0.1);
    to = model_of(v);
    laconic_state_carry(&state, &from, &to);
    laconic_pose_of(&after, &to, &state);
    yaw = laconic_body_velocity(&to, &state, velocity);
    ASSERT_NEAR(4 * ROUNDING, old_yaw, yaw);
    ASSERT_NEAR(4 * ROUNDING, old_origin[0], velocity[0] + yaw * to.com_y_m);
    ASSERT_NEAR(4 * ROUNDING, old_origin[1], velocity[1] - yaw * to.com_x_m);
    ASSERT_NEAR(2 * ROUNDING, before.origin_x_m, after.origin_x_m);
    ASSERT_NEAR(2 * ROUNDING, before.origin_y_m, after.origin_y_m);
    ASSERT_NEAR(2 * ROUNDING, before.x_m + REAL(0.1 * cos(0.6) + 0.04 * sin(0.6)), after.x_m);
    TEST_ASSERT_EQUAL_DOUBLE((double)before.heading_rad, (double)after.heading_rad);
    laconic_wheel_angles(&to, &state, after_angle);
    ASSERT_NEAR_ALL(ROUNDING, angle, after_angle, 3);
    laconic_wheel_speeds(&to, &state, new_speed);
    ASSERT_NEAR_ALL(10 * ROUNDING, old_speed, new_speed, 3);
}

static void an_angle_of_any_wheel_that_left_the_range_is_not_carried_on(void) {
    const laconic_model m = model_of(three_wheels());
    for (int i = 0; i < 3; i++) {
        laconic_state state = moving(&m, 1, 2, 3), before;
        state.wheel_angle_set_rad[i] = INFINITE;
        before = state;
        ASSERT_STATUS(LACONIC_OVERFLOW, laconic_state_carry(&state, &m, &m));
        TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
    }
}

/* Numbers that happen to lie where the angles of wheels would, which there are not. */
static void what_the_stack_held_refuses_nothing(void) {
    const laconic_model m = model_of(three_wheels());
    laconic_state state = moving(&m, 1, 2, 3);
    fill_stack(ALL_NAN);
    ASSERT_STATUS(LACONIC_OK, laconic_state_carry(&state, &m, &m));
}

/* -------------------------------------------------------- the numbers of an outer integrator -- */

static void what_the_constraints_forbid_is_projected_away_and_the_rest_stays(void) {
    const laconic_model m = model_of(caster());
    laconic_start motion = start_with(0.5, 1e-3, 2);
    laconic_state state;
    laconic_pose pose;
    laconic_real nu[3];
    motion.x_m = REAL(4);
    motion.heading_rad = REAL(1);
    ASSERT_STATUS(LACONIC_OK, laconic_state_project(&state, &m, &motion, &why));
    laconic_nu(&m, &state, nu);
    laconic_pose_of(&pose, &m, &state);
    ASSERT_NEAR(ROUNDING, 0.5, nu[0]);
    ASSERT_NEAR(ROUNDING, 0, nu[1]);
    ASSERT_NEAR(2 * ROUNDING, 2, nu[2]);
    TEST_ASSERT_EQUAL_DOUBLE(4.0, (double)pose.x_m);
    ASSERT_NEAR(ROUNDING, 1, pose.heading_rad);
}

static void allowed_motions_are_set_as_they_are(void) {
    const laconic_model m = model_of(mecanum());
    const laconic_start motion = start_with(0.5, -1, 2);
    laconic_state placed;
    const laconic_state set = state_of(&m, motion);
    memset(&placed, 0, sizeof placed);
    ASSERT_STATUS(LACONIC_OK, laconic_state_project(&placed, &m, &motion, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&set.zeta, &placed.zeta, sizeof set.zeta);
}

static void refuses_placed(laconic_start motion, laconic_status status, laconic_field field, int item) {
    const laconic_model m = model_of(caster());
    laconic_state state, before;
    memset(&state, 3, sizeof state);
    before = state;
    ASSERT_REFUSED(status, field, item, laconic_state_project(&state, &m, &motion, &why), why);
    TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
}

static void numbers_that_are_not_finite_are_refused(void) {
    laconic_start motion = start_with(0, 0, 0);
    refuses_placed(start_with(0, (double)NAN, 0), LACONIC_NOT_FINITE, LACONIC_FIELD_START_NU, 2);
    refuses_placed(start_with((double)LACONIC_REAL_MAX, 0, (double)LACONIC_REAL_MAX), LACONIC_OVERFLOW,
                   LACONIC_FIELD_START_NU, 0);
    motion.nu_rad_per_s[0] = REAL(0.5 * sqrt((double)LACONIC_REAL_MAX));
    refuses_placed(motion, LACONIC_OVERFLOW, LACONIC_FIELD_START_NU, 0);
    TEST_ASSERT_TRUE(why.value == motion.nu_rad_per_s[0]);
    motion.nu_rad_per_s[0] = 0;
    for (int k = 0; k < 3; k++) {
        const laconic_real told = k == 1 ? -INFINITE : INFINITE;
        motion.nu_rad_per_s[k] = told;
        refuses_placed(motion, LACONIC_NOT_FINITE, LACONIC_FIELD_START_NU, k + 1);
        TEST_ASSERT_TRUE(why.value == told);
        motion.nu_rad_per_s[k] = 0;
    }
    motion.y_m = INFINITE;
    refuses_placed(motion, LACONIC_NOT_FINITE, LACONIC_FIELD_START_Y, 0);
}

/* What is compared is the size of the motion that was given, with its forbidden part. */
static void a_start_may_leave_the_constraints_by_a_tolerance_of_its_own_size(void) {
    const double tolerance = (double)LACONIC_RANK_TOLERANCE;
    laconic_start start = start_with(tolerance * (1 + 0.5 * tolerance), 1, 0);
    laconic_vehicle v = caster();
    laconic_state state;
    v.wheel[0].axle_rad = 0; /* so that its cosine is not rounded */
    const laconic_model m = model_of(v);
    ASSERT_STATUS(LACONIC_OK, laconic_state_set(&state, &m, &start, NULL));
    start.nu_rad_per_s[0] = REAL(tolerance * (1 + 2 * tolerance));
    ASSERT_STATUS(LACONIC_START_AGAINST_CONSTRAINTS, laconic_state_set(&state, &m, &start, NULL));
}

/* A state is plain data: whatever of a place a caller has spoilt is refused, as is what has left the range. */
static void a_place_that_is_no_number_is_not_carried_on(void) {
    const laconic_model m = model_of(mecanum());
    for (int n = 0; n < 4; n++) {
        laconic_state state = moving(&m, 1, 0, 0), before;
        laconic_real *const part[4] = {&state.x_m.value, &state.x_m.rest, &state.y_m.value, &state.y_m.rest};
        *part[n] = NOT_A_NUMBER;
        before = state;
        ASSERT_STATUS(LACONIC_OVERFLOW, laconic_state_carry(&state, &m, &m));
        TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
    }
}

static laconic_state projected_state(const laconic_model *m, laconic_start motion) {
    laconic_state state;
    ASSERT_STATUS(LACONIC_OK, laconic_state_project(&state, m, &motion, NULL));
    return state;
}

/* Its nearest lateral motion is a fifth of that given. What of it is no more than the tolerance is told as none. */
static void a_limit_of_just_the_tolerance_is_told_as_none(void) {
    const laconic_real tolerance = LACONIC_RANK_TOLERANCE;
    laconic_vehicle v = bare_body();
    int at_edge = 0;
    v.mass_kg = v.yaw_inertia_kgm2 = v.wheel_radius_m = 1;
    v.wheel_inertia_kgm2 = 0;
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0, 0.5, 0, 0); /* ν1 = ν3/2 */
    const laconic_model m = model_of(v);
    for (int n = 0; n < 4000; n++) {
        const laconic_real forth = 1 + REAL(0.04) * REAL(n / 200);
        const laconic_real given =
            tolerance * forth / (REAL(0.2) - tolerance) * (1 + REAL(n % 200 - 100) * LACONIC_EPSILON);
        const laconic_start start = {{given, forth, 0}, 0, 0, 0, {0}};
        const laconic_state nearest = projected_state(&m, start);
        const laconic_real edge = tolerance * (given + forth);
        laconic_real nu[3];
        laconic_state state;
        laconic_nu(&m, &nearest, nu);
        ASSERT_REFUSED(LACONIC_START_AGAINST_CONSTRAINTS, LACONIC_FIELD_START_NU, 1,
                       laconic_state_set(&state, &m, &start, &why), why);
        TEST_ASSERT_TRUE(why.limit == (nu[0] <= edge ? 0 : nu[0]));
        at_edge += nu[0] <= edge && nu[0] >= edge;
    }
    TEST_ASSERT_GREATER_THAN(0, at_edge);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(what_is_set_is_what_is_read);
    RUN_TEST(every_number_that_is_not_finite_is_named);
    RUN_TEST(a_heading_or_velocity_beyond_the_range_is_refused);
    RUN_TEST(headings_and_velocities_are_taken_up_to_their_limits);
    RUN_TEST(a_velocity_of_any_size_is_refused_before_it_becomes_nan);
    RUN_TEST(a_start_that_slides_a_fixed_wheel_is_refused_with_the_nearest_that_does_not);
    RUN_TEST(of_two_that_are_equally_wrong_the_first_is_named);
    RUN_TEST(a_start_that_yaws_against_a_far_wheel_names_the_yaw);
    RUN_TEST(of_a_motion_that_is_forbidden_altogether_zero_is_told);
    RUN_TEST(a_start_that_rotates_a_locked_wheel_is_refused);
    RUN_TEST(without_constraints_a_start_of_any_slowness_is_allowed);
    RUN_TEST(rest_is_always_allowed);
    RUN_TEST(a_changed_vehicle_moves_on_where_the_old_one_was);
    RUN_TEST(an_angle_of_any_wheel_that_left_the_range_is_not_carried_on);
    RUN_TEST(what_the_stack_held_refuses_nothing);
    RUN_TEST(what_the_constraints_forbid_is_projected_away_and_the_rest_stays);
    RUN_TEST(allowed_motions_are_set_as_they_are);
    RUN_TEST(numbers_that_are_not_finite_are_refused);
    RUN_TEST(a_start_may_leave_the_constraints_by_a_tolerance_of_its_own_size);
    RUN_TEST(a_place_that_is_no_number_is_not_carried_on);
    RUN_TEST(a_limit_of_just_the_tolerance_is_told_as_none);
    return UNITY_END();
}
