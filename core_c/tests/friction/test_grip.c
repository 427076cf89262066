/* Tests of grip.c: the first and the worst instant of slipping and of lifting. */
#include "stack.h"
#include "vehicles.h"

#define GRAVITY 9.80665

static laconic_refusal why;

typedef struct scene {
    laconic_vehicle vehicle;
    laconic_model model;
    laconic_contact contact;
    laconic_grip grip;
} scene;

static scene scene_of(laconic_vehicle v, double friction, double height) {
    scene s;
    memset(&s, 0, sizeof s);
    v.friction_coefficient = REAL(friction);
    v.com_z_m = REAL(height);
    s.vehicle = v;
    s.model = model_of(v);
    ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&s.contact, &v, &why));
    return s;
}

static laconic_reactions look_at(scene *s, laconic_input input, uint64_t steps) {
    const laconic_state state = moving(&s->model, 0, 0, 0);
    laconic_reactions found;
    laconic_reactions_of(&found, &s->contact, &s->model, &state, &input);
    fill_stack(ALL_NAN);
    laconic_grip_watch(&s->grip, &s->contact, &s->model, &found, steps);
    return found;
}

/* All wheels pull forward with the same voltage, the first with a little more. */
static laconic_input forward(double volts) {
    laconic_input input = no_input();
    for (int i = 0; i < 4; i++) input.voltage_V[i] = REAL(volts);
    input.voltage_V[0] = REAL(1.5 * volts);
    return input;
}

static void a_gentle_run_counts_instants_and_nothing_else(void) {
    scene s = scene_of(with_motors(mecanum()), 0.8, 0.05);
    look_at(&s, forward(0.1), 0);
    look_at(&s, forward(0.2), 1);
    TEST_ASSERT_EQUAL_UINT64(2, s.grip.instants);
    TEST_ASSERT_EQUAL_UINT64(0, s.grip.slipping);
    TEST_ASSERT_EQUAL_UINT64(0, s.grip.lifting);
    TEST_ASSERT_EQUAL_INT(0, s.grip.first_slip.point);
}

static void of_instants_that_are_equally_bad_the_first_is_the_worst(void) {
    scene slips = scene_of(with_motors(mecanum()), 0.8, 0.0), lifts = scene_of(with_motors(mecanum()), 100, 2);
    for (uint64_t step = 3; step < 6; step++) {
        look_at(&slips, forward(6), step);
        look_at(&lifts, forward(20), step);
    }
    TEST_ASSERT_EQUAL_UINT64(3, slips.grip.slipping);
    TEST_ASSERT_EQUAL_UINT64(3, slips.grip.worst_slip.steps);
    TEST_ASSERT_EQUAL_UINT64(3, lifts.grip.lifting);
    TEST_ASSERT_EQUAL_UINT64(3, lifts.grip.worst_lift.steps);
}

static void every_wheel_that_slips_at_some_instant_is_noted(void) {
    scene s = scene_of(with_motors(mecanum()), 0.8, 0.0);
    laconic_input input = no_input();
    look_at(&s, forward(0.1), 0);
    for (int i = 0; i < 4; i++) TEST_ASSERT_FALSE(s.grip.wheel_slips[i]);
    laconic_reactions found = look_at(&s, forward(6), 1);
    for (int i = 0; i < 4; i++) {
        const double needed_N = hypot((double)found.along_N[i], (double)found.lateral_N[i]);
        TEST_ASSERT_EQUAL(needed_N > 0.8 * (double)found.normal_N[i], s.grip.wheel_slips[i]);
    }
    TEST_ASSERT_TRUE(s.grip.wheel_slips[0]);
    input.voltage_V[3] = REAL(60);
    look_at(&s, input, 2);
    TEST_ASSERT_TRUE(s.grip.wheel_slips[3] && s.grip.wheel_slips[0]); /* they stay noted */
}

static void the_first_and_the_worst_slip_are_kept_with_what_was_needed(void) {
    scene s = scene_of(with_motors(mecanum()), 0.8, 0.0);
    laconic_reactions first, worst;
    look_at(&s, forward(0.1), 4);
    first = look_at(&s, forward(6), 5);
    worst = look_at(&s, forward(9), 6);
    look_at(&s, forward(7), 7);
    TEST_ASSERT_EQUAL_UINT64(3, s.grip.slipping);
    TEST_ASSERT_EQUAL_UINT64(5, s.grip.first_slip.steps);
    TEST_ASSERT_EQUAL_UINT64(6, s.grip.worst_slip.steps);
    TEST_ASSERT_EQUAL_INT(1, s.grip.first_slip.point);
    ASSERT_NEAR(1e-5, 0.25 * MASS * GRAVITY, s.grip.first_slip.normal_N);
    ASSERT_NEAR(1e-4, fabs((double)first.along_N[0]), s.grip.first_slip.needed_N);
    ASSERT_NEAR(1e-4, (double)first.no_slip_margin_N, s.grip.first_slip.margin_N);
    ASSERT_NEAR(1e-4, (double)worst.no_slip_margin_N, s.grip.worst_slip.margin_N);
}

static void half_a_newton_that_is_missing_is_a_slip(void) {
    scene s = scene_of(with_motors(mecanum()), 0.8, 0.05);
    laconic_reactions found = look_at(&s, no_input(), 0);
    found.along_N[2] = REAL(0.8) * found.normal_N[2] + REAL(0.5);
    found.lateral_N[2] = 0;
    found.no_slip_margin_N = REAL(-0.5);
    laconic_grip_watch(&s.grip, &s.contact, &s.model, &found, 1);
    TEST_ASSERT_TRUE(s.grip.slipping == 1 && s.grip.first_slip.point == 3);
    ASSERT_NEAR(1e-4, -0.5, s.grip.first_slip.margin_N);
}

static void without_friction_nothing_slips(void) {
    scene s = scene_of(with_motors(mecanum()), 0.0, 0.0);
    look_at(&s, forward(9), 0);
    TEST_ASSERT_EQUAL_UINT64(0, s.grip.slipping);
}

static void a_wheel_that_would_lift_is_kept_with_its_normal_load(void) {
    scene s = scene_of(with_motors(mecanum()), 0.0, 1.0);
    const laconic_reactions found = look_at(&s, forward(6), 3);
    TEST_ASSERT_EQUAL_UINT64(1, s.grip.lifting);
    TEST_ASSERT_EQUAL_UINT64(3, s.grip.first_lift.steps);
    TEST_ASSERT_TRUE(s.grip.first_lift.point == 1 || s.grip.first_lift.point == 2); /* in front */
    TEST_ASSERT_TRUE(s.grip.first_lift.normal_N < REAL(0));
    TEST_ASSERT_TRUE(s.grip.first_lift.normal_N == found.normal_N[s.grip.first_lift.point - 1]);
}

static void a_support_that_would_lift_has_a_number_after_the_wheels(void) {
    laconic_vehicle v = with_motors(differential_drive());
    scene s;
    v.support_count = 1; /* beyond the centre of mass, seen from the axle: its normal load is below zero */
    v.support[0].y_m = REAL(-0.1);
    s = scene_of(v, 0.0, 0.0);
    look_at(&s, no_input(), 0);
    TEST_ASSERT_EQUAL_INT(3, s.grip.first_lift.point);
    TEST_ASSERT_TRUE(s.grip.first_lift.needed_N == REAL(0));
}

static void what_is_within_rounding_of_zero_neither_lifts_nor_slips(void) {
    scene s = scene_of(with_motors(mecanum()), 0.8, 0.05);
    laconic_reactions found = look_at(&s, no_input(), 0);
    found.normal_N[2] = REAL(-1e-3) * LACONIC_RANK_TOLERANCE * REAL(MASS * GRAVITY);
    found.no_slip_margin_N = REAL(0.8) * found.normal_N[2];
    laconic_grip_watch(&s.grip, &s.contact, &s.model, &found, 1);
    TEST_ASSERT_EQUAL_UINT64(0, s.grip.slipping);
    TEST_ASSERT_EQUAL_UINT64(0, s.grip.lifting);
    found.normal_N[2] = REAL(-1e3) * LACONIC_RANK_TOLERANCE * REAL(MASS * GRAVITY);
    found.along_N[2] = -found.normal_N[2];
    found.no_slip_margin_N = REAL(1.8) * found.normal_N[2];
    laconic_grip_watch(&s.grip, &s.contact, &s.model, &found, 1);
    TEST_ASSERT_EQUAL_UINT64(1, s.grip.slipping);
    TEST_ASSERT_EQUAL_UINT64(1, s.grip.lifting);
}

static void a_wheel_that_lifts_without_a_reaction_does_not_slip(void) {
    laconic_vehicle v = with_motors(mecanum());
    scene s;
    v.com_x_m = REAL(0.3); /* beyond the wheels */
    s = scene_of(v, 0.8, 0.05);
    look_at(&s, no_input(), 0);
    TEST_ASSERT_EQUAL_UINT64(1, s.grip.lifting);
    TEST_ASSERT_EQUAL_UINT64(0, s.grip.slipping);
    look_at(&s, forward(6), 1);
    TEST_ASSERT_EQUAL_UINT64(1, s.grip.slipping);
    TEST_ASSERT_TRUE(s.grip.first_slip.needed_N > REAL(0));
}

static void nan_counts_as_slip_and_as_lift(void) {
    scene s = scene_of(with_motors(mecanum()), 0.8, 0.05);
    laconic_reactions found = look_at(&s, forward(0.1), 0);
    found.along_N[2] = NOT_A_NUMBER;
    found.no_slip_margin_N = NOT_A_NUMBER;
    found.normal_N[1] = NOT_A_NUMBER;
    laconic_grip_watch(&s.grip, &s.contact, &s.model, &found, 1);
    TEST_ASSERT_EQUAL_UINT64(1, s.grip.slipping);
    TEST_ASSERT_EQUAL_UINT64(1, s.grip.lifting);
    TEST_ASSERT_EQUAL_INT(2, s.grip.first_lift.point);
    TEST_ASSERT_TRUE(s.grip.worst_slip.point == s.grip.first_slip.point && s.grip.worst_lift.point == 2);
    TEST_ASSERT_TRUE(s.grip.worst_slip.steps == 1 && s.grip.worst_lift.steps == 1);
}

/* A margin or a load below 0 by half the tolerance is rounding, by twice the tolerance it is not. */
static void the_tolerance_is_a_part_of_the_weight(void) {
    const double parts[2] = {0.5, 2};
    for (int k = 0; k < 2; k++) {
        scene s = scene_of(with_motors(mecanum()), 0.8, 0.05);
        laconic_reactions found = look_at(&s, no_input(), 0);
        found.normal_N[0] = REAL(-parts[k] * (double)LACONIC_RANK_TOLERANCE * MASS * GRAVITY);
        laconic_grip_watch(&s.grip, &s.contact, &s.model, &found, 1);
        TEST_ASSERT_EQUAL_UINT64(k, s.grip.lifting);
        TEST_ASSERT_EQUAL_INT(k, s.grip.first_lift.point);
    }
}

/* What is rounding is so to the last bit of the tolerance: a load, a reaction, and what is missing of one. */
static void a_load_or_a_reaction_of_just_the_tolerance_is_rounding(void) {
    scene s = scene_of(with_motors(mecanum()), 0.5, 0.05);
    const laconic_reactions rest = look_at(&s, no_input(), 0);
    const laconic_real rounding = LACONIC_RANK_TOLERANCE * (s.model.mass_kg * REAL(GRAVITY));
    laconic_reactions found = rest;
    found.normal_N[1] = -rounding;
    laconic_grip_watch(&s.grip, &s.contact, &s.model, &found, 1);
    TEST_ASSERT_EQUAL_UINT64(0, s.grip.lifting);
    found.normal_N[1] = -rounding * (1 + LACONIC_EPSILON);
    laconic_grip_watch(&s.grip, &s.contact, &s.model, &found, 2);
    TEST_ASSERT_EQUAL_UINT64(1, s.grip.lifting);
    found = rest;
    found.normal_N[1] = -4 * rounding;
    found.along_N[1] = rounding; /* of a wheel in the air */
    found.no_slip_margin_N = -3 * rounding;
    laconic_grip_watch(&s.grip, &s.contact, &s.model, &found, 3);
    TEST_ASSERT_EQUAL_UINT64(0, s.grip.slipping);
    found.along_N[1] = rounding * (1 + 4 * LACONIC_EPSILON);
    laconic_grip_watch(&s.grip, &s.contact, &s.model, &found, 4);
    TEST_ASSERT_EQUAL_UINT64(1, s.grip.slipping);
    found = rest;
    found.normal_N[1] = 2 * rounding;
    found.along_N[1] = 2 * rounding;
    found.no_slip_margin_N = -rounding;
    laconic_grip_watch(&s.grip, &s.contact, &s.model, &found, 5);
    TEST_ASSERT_EQUAL_UINT64(1, s.grip.slipping);
}

/* The wheel in the air has no reaction that could slip, and the one beside it has all the friction that it needs. */
static void a_wheel_at_its_limit_does_not_slip_since_another_one_lifts(void) {
    scene s = scene_of(with_motors(mecanum()), 0.5, 0.05);
    laconic_reactions found = look_at(&s, no_input(), 0);
    found.normal_N[0] = -10;
    found.along_N[0] = 0;
    found.normal_N[1] = 10;
    found.along_N[1] = 5;
    found.no_slip_margin_N = -5;
    laconic_grip_watch(&s.grip, &s.contact, &s.model, &found, 1);
    TEST_ASSERT_EQUAL_UINT64(1, s.grip.lifting);
    TEST_ASSERT_EQUAL_UINT64(0, s.grip.slipping);
}

static void of_points_that_are_equally_bad_the_first_is_named(void) {
    scene s = scene_of(with_motors(mecanum()), 0.5, 0.05);
    laconic_reactions found = look_at(&s, no_input(), 0);
    for (int i = 1; i < 4; i++) {
        found.normal_N[i] = -10;
        found.along_N[i] = 5;
    }
    found.no_slip_margin_N = -10;
    laconic_grip_watch(&s.grip, &s.contact, &s.model, &found, 1);
    TEST_ASSERT_EQUAL_INT(2, s.grip.first_lift.point);
    TEST_ASSERT_EQUAL_INT(2, s.grip.first_slip.point);
}

/* However little worse it is. Of a support nothing is needed, whatever stands where a wheel's reaction would. */
static void of_points_the_worse_is_named_by_its_number(void) {
    laconic_vehicle v = with_motors(differential_drive());
    v.support_count = 2;
    v.support[0].y_m = REAL(0.1);
    v.support[1].y_m = REAL(-0.1);
    scene s = scene_of(v, 0.8, 0.0);
    laconic_reactions found = look_at(&s, no_input(), 0);
    memset(&s.grip, 0, sizeof s.grip);
    found.normal_N[2] = REAL(-0.5);
    found.normal_N[3] = REAL(-0.25);
    found.along_N[2] = found.lateral_N[3] = 7;
    laconic_grip_watch(&s.grip, &s.contact, &s.model, &found, 1);
    TEST_ASSERT_EQUAL_INT(3, s.grip.first_lift.point);
    TEST_ASSERT_TRUE(s.grip.first_lift.needed_N == 0 && s.grip.first_lift.normal_N == REAL(-0.5));
    found.normal_N[3] = REAL(-0.75);
    laconic_grip_watch(&s.grip, &s.contact, &s.model, &found, 2);
    TEST_ASSERT_EQUAL_INT(4, s.grip.worst_lift.point);
    TEST_ASSERT_TRUE(s.grip.worst_lift.needed_N == 0 && s.grip.worst_lift.normal_N == REAL(-0.75));
    TEST_ASSERT_EQUAL_INT(3, s.grip.first_lift.point);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_gentle_run_counts_instants_and_nothing_else);
    RUN_TEST(of_instants_that_are_equally_bad_the_first_is_the_worst);
    RUN_TEST(every_wheel_that_slips_at_some_instant_is_noted);
    RUN_TEST(the_first_and_the_worst_slip_are_kept_with_what_was_needed);
    RUN_TEST(half_a_newton_that_is_missing_is_a_slip);
    RUN_TEST(without_friction_nothing_slips);
    RUN_TEST(a_wheel_that_would_lift_is_kept_with_its_normal_load);
    RUN_TEST(a_support_that_would_lift_has_a_number_after_the_wheels);
    RUN_TEST(what_is_within_rounding_of_zero_neither_lifts_nor_slips);
    RUN_TEST(a_wheel_that_lifts_without_a_reaction_does_not_slip);
    RUN_TEST(nan_counts_as_slip_and_as_lift);
    RUN_TEST(the_tolerance_is_a_part_of_the_weight);
    RUN_TEST(a_load_or_a_reaction_of_just_the_tolerance_is_rounding);
    RUN_TEST(a_wheel_at_its_limit_does_not_slip_since_another_one_lifts);
    RUN_TEST(of_points_that_are_equally_bad_the_first_is_named);
    RUN_TEST(of_points_the_worse_is_named_by_its_number);
    return UNITY_END();
}
