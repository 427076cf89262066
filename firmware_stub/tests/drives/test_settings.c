/* Tests of settings.c: numbers of drives that cannot be played are refused by field and wheel. */
#include "drive_scene.h"
#include "unity.h"

static laconic_drive_plan plan;
static laconic_refusal why;

void setUp(void) {
    plan = scene_plan(3);
    memset(&why, 0, sizeof why);
}
void tearDown(void) {}

static laconic_status check(void) { return laconic_drive_plan_check(&plan, &laconic_robomaster, 4, &why); }

static void expect(laconic_status status, int32_t field, int32_t item) {
    TEST_ASSERT_EQUAL_INT(status, check());
    TEST_ASSERT_EQUAL_INT(status, why.status);
    TEST_ASSERT_EQUAL_INT(field, (int32_t)why.field);
    TEST_ASSERT_EQUAL_INT(item, why.item);
}

static void a_right_plan_passes(void) { TEST_ASSERT_EQUAL_INT(LACONIC_OK, check()); }

static void a_plan_begins_without_a_drive(void) {
    laconic_drive_plan_begin(&plan);
    TEST_ASSERT_TRUE(plan.protocol == 0 && plan.drive[0].node_id < 0 && plan.drive[LACONIC_MAX_WHEELS - 1].node_id < 0);
    TEST_ASSERT_EQUAL_INT(LACONIC_OK, check());
}

static void a_wheel_without_a_drive_needs_no_numbers(void) {
    memset(&plan.drive[3], 0, sizeof plan.drive[3]);
    plan.drive[3].node_id = -1;
    TEST_ASSERT_EQUAL_INT(LACONIC_OK, check());
}

#define REFUSED(member, value, status, FIELD) \
    setUp(); \
    plan.drive[2].member = (value); \
    expect(status, LACONIC_DRIVES_FIELD_##FIELD, 3)

static void each_number_has_its_rule(void) {
    const laconic_real none = 0;
    REFUSED(encoder_counts, 0, LACONIC_NOT_POSITIVE, ENCODER_COUNTS);
    REFUSED(encoder_counts, -5, LACONIC_NOT_POSITIVE, ENCODER_COUNTS);
    REFUSED(gear_ratio, 0, LACONIC_NOT_POSITIVE, DRIVE_GEAR_RATIO);
    REFUSED(gear_ratio, none / none, LACONIC_NOT_FINITE, DRIVE_GEAR_RATIO);
    REFUSED(torque_constant_Nm_per_A, 0, LACONIC_NOT_POSITIVE, DRIVE_TORQUE_CONSTANT);
    REFUSED(current_limit_A, -1, LACONIC_NOT_POSITIVE, DRIVE_CURRENT_LIMIT);
    REFUSED(speed_limit_rad_per_s, -1, LACONIC_NEGATIVE, DRIVE_SPEED_LIMIT);
    REFUSED(supply_V, -1, LACONIC_NEGATIVE, DRIVE_SUPPLY);
    REFUSED(winding_resistance_ohm, 1 / none, LACONIC_NOT_FINITE, DRIVE_WINDING_RESISTANCE);
    REFUSED(current_bandwidth_rad_per_s, -1, LACONIC_NEGATIVE, DRIVE_CURRENT_BANDWIDTH);
    REFUSED(position_gain_per_s, -1, LACONIC_NEGATIVE, DRIVE_POSITION_GAIN);
    REFUSED(speed_gain_As, -1, LACONIC_NEGATIVE, DRIVE_SPEED_GAIN);
    REFUSED(speed_integral_gain_A, -1, LACONIC_NEGATIVE, DRIVE_SPEED_INTEGRAL_GAIN);
    REFUSED(stall_time_s, -1, LACONIC_NEGATIVE, DRIVE_STALL_TIME);
    REFUSED(back_emf_Vs_per_rad, -1, LACONIC_NEGATIVE, DRIVE_BACK_EMF);
    setUp();
    plan.drive[2].gear_ratio = -20; /* reversed */
    TEST_ASSERT_EQUAL_INT(LACONIC_OK, check());
}

static void node_ids_are_those_of_the_protocol_and_differ(void) {
    REFUSED(node_id, 9, LACONIC_ABOVE_LIMIT, DRIVE_NODE_ID);
    REFUSED(node_id, 0, LACONIC_ABOVE_LIMIT, DRIVE_NODE_ID);
    REFUSED(node_id, 1, LACONIC_ABOVE_LIMIT, DRIVE_NODE_ID);
}

static void a_refusal_tells_the_number_and_its_limit(void) {
    plan.drive[1].node_id = 9;
    expect(LACONIC_ABOVE_LIMIT, LACONIC_DRIVES_FIELD_DRIVE_NODE_ID, 2);
    TEST_ASSERT_TRUE(why.value == 9 && why.limit == 8);
    plan.drive[1].node_id = 2;
    plan.drive[1].current_limit_A = -3;
    expect(LACONIC_NOT_POSITIVE, LACONIC_DRIVES_FIELD_DRIVE_CURRENT_LIMIT, 2);
    TEST_ASSERT_TRUE(why.value == -3 && why.limit == 0);
    plan.watchdog_s = 1001;
    expect(LACONIC_ABOVE_LIMIT, LACONIC_DRIVES_FIELD_DRIVE_WATCHDOG, 0);
    TEST_ASSERT_TRUE(why.value == 1001 && why.limit == 1000);
}

static void a_drive_of_a_wheel_that_does_not_exist_is_refused(void) {
    plan.drive[4] = plan.drive[0];
    plan.drive[4].node_id = 8;
    expect(LACONIC_ABOVE_LIMIT, LACONIC_DRIVES_FIELD_DRIVE_NODE_ID, 5);
}

static void the_watchdog_is_a_time(void) {
    plan.watchdog_s = -1;
    expect(LACONIC_NEGATIVE, LACONIC_DRIVES_FIELD_DRIVE_WATCHDOG, 0);
    plan.watchdog_s = 1001; /* microseconds are counted in 32 bits */
    expect(LACONIC_ABOVE_LIMIT, LACONIC_DRIVES_FIELD_DRIVE_WATCHDOG, 0);
    plan.watchdog_s = REAL(0.1);
    TEST_ASSERT_EQUAL_INT(LACONIC_OK, laconic_drive_plan_check(&plan, &laconic_robomaster, 4, NULL));
}

static void a_refusal_needs_no_place_for_its_reason(void) {
    TEST_ASSERT_EQUAL_INT(LACONIC_OK, laconic_drive_plan_check(&plan, &laconic_robomaster, 4, NULL));
    plan.drive[1].current_limit_A = 0;
    TEST_ASSERT_EQUAL_INT(LACONIC_NOT_POSITIVE, laconic_drive_plan_check(&plan, &laconic_robomaster, 4, NULL));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_right_plan_passes);
    RUN_TEST(a_plan_begins_without_a_drive);
    RUN_TEST(a_wheel_without_a_drive_needs_no_numbers);
    RUN_TEST(each_number_has_its_rule);
    RUN_TEST(node_ids_are_those_of_the_protocol_and_differ);
    RUN_TEST(a_refusal_tells_the_number_and_its_limit);
    RUN_TEST(a_drive_of_a_wheel_that_does_not_exist_is_refused);
    RUN_TEST(the_watchdog_is_a_time);
    RUN_TEST(a_refusal_needs_no_place_for_its_reason);
    return UNITY_END();
}
