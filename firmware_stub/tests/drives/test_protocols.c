/* Tests of protocols.c: what a node may rely on of every protocol of drives. */
#include "octets.h"

#include "drive_scene.h"
#include "laconic_node/node.h"
#include "unity.h"

#include <string.h>

static void every_listed_protocol_is_whole_and_fits_the_node(void) {
    int found = 0;
    for (int32_t number = -3; number < 20; number++) {
        const laconic_drive_protocol *protocol = laconic_drive_protocol_by_number(number);
        if (protocol == NULL) continue;
        found++;
        TEST_ASSERT_TRUE(number > 0 && protocol->name != NULL && protocol->axis_bytes <= LACONIC_NODE_AXIS_BYTES);
        TEST_ASSERT_TRUE(protocol->axis_bytes % sizeof(uint32_t) == 0 && protocol->axis_bytes > 0);
        TEST_ASSERT_TRUE(protocol->first_id >= 0 && protocol->last_id > protocol->first_id);
        TEST_ASSERT_TRUE(protocol->start && protocol->on_frame && protocol->on_step && protocol->next_frame);
    }
    TEST_ASSERT_TRUE(found >= 2);
}

static void the_numbers_are_those_of_the_wire(void) {
    TEST_ASSERT_EQUAL_PTR(&laconic_canopen, laconic_drive_protocol_by_number(1));
    TEST_ASSERT_EQUAL_PTR(&laconic_odrive, laconic_drive_protocol_by_number(2));
    TEST_ASSERT_EQUAL_PTR(&laconic_moteus, laconic_drive_protocol_by_number(4));
    TEST_ASSERT_EQUAL_PTR(&laconic_robomaster, laconic_drive_protocol_by_number(3));
    TEST_ASSERT_EQUAL_PTR(&laconic_robomaster_c610, laconic_drive_protocol_by_number(5));
    TEST_ASSERT_NULL(laconic_drive_protocol_by_number(0));
    TEST_ASSERT_NULL(laconic_drive_protocol_by_number(6));
}

static void the_ids_of_drives_are_those_of_their_buses(void) {
    static const int16_t ids[6][2] = {{0, 0}, {1, 127}, {0, 62}, {1, 8}, {1, 126}, {1, 8}};
    for (int32_t number = 1; number <= 5; number++) {
        const laconic_drive_protocol *protocol = laconic_drive_protocol_by_number(number);
        TEST_ASSERT_EQUAL_INT16(ids[number][0], protocol->first_id);
        TEST_ASSERT_EQUAL_INT16(ids[number][1], protocol->last_id);
    }
}

/* Whatever it is called for: what belongs to a drive beyond the last is not its own. */
static void a_protocol_touches_its_own_drives_alone(void) {
    static const laconic_drive_settings settings = {
        .node_id = 1, .encoder_counts = 4096, .gear_ratio = 1, .torque_constant_Nm_per_A = 1, .current_limit_A = 1};
    static uint64_t axes[3 * LACONIC_NODE_AXIS_BYTES / sizeof(uint64_t)];
    static laconic_drives drives;
    for (int32_t number = 1; number <= 5; number++) {
        const laconic_drive_protocol *protocol = laconic_drive_protocol_by_number(number);
        laconic_frame frame = {.length = 8, .data = {1, 0}};
        uint8_t *axis = (uint8_t *)axes;
        memset(&drives, 0, sizeof drives);
        memset(axes, 0, sizeof axes);
        memset(axis + 2 * protocol->axis_bytes, 0xA5, protocol->axis_bytes);
        drives.protocol = protocol;
        drives.axes = axes;
        drives.count = 2;
        drives.step_s = (laconic_real)0.001;
        for (int k = 0; k < 3; k++) {
            laconic_drive_start(&drives.drive[k], &settings);
            drives.drive[k].settings.node_id += k;
        }
        memset(&drives.drive[2], 0xA5, sizeof drives.drive[2]);
        protocol->start(&drives, 0);
        for (frame.id = 0; frame.id < 0x800; frame.id++) protocol->on_frame(&drives, &frame, 1000);
        for (uint32_t k = 1; k <= 200; k++) {
            protocol->on_step(&drives, 1000 * k);
            while (protocol->next_frame(&drives, &frame)) continue;
        }
        TEST_ASSERT_EACH_EQUAL_HEX8(0xA5, axis + 2 * protocol->axis_bytes, protocol->axis_bytes);
        TEST_ASSERT_EACH_EQUAL_HEX8(0xA5, &drives.drive[2], sizeof drives.drive[2]);
    }
}

/* Tests of octets.h: values in the payloads of drives. */

static uint32_t bits_of(laconic_real value) {
    uint8_t octets[4];
    octets_put_real(octets, value);
    return octets_u32(octets);
}

static void integers_have_their_lowest_octet_first(void) {
    const uint8_t expected[4] = {0x78, 0x56, 0x34, 0x12};
    uint8_t octets[4];
    octets_put_u32(octets, 0x12345678U);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, octets, 4);
    TEST_ASSERT_EQUAL_HEX32(0x12345678U, octets_u32(octets));
    TEST_ASSERT_EQUAL_HEX32(0x3456U, octets_u16(octets + 1));
}

static void real_numbers_are_binary32(void) {
    TEST_ASSERT_EQUAL_HEX32(0x3F800000U, bits_of(1));
    TEST_ASSERT_EQUAL_HEX32(0xC0200000U, bits_of((laconic_real)-2.5));
    const uint8_t half[4] = {0, 0, 0, 0x3F};
    TEST_ASSERT_TRUE(octets_real(half) == (laconic_real)0.5);
}

static void numbers_beyond_binary32_become_its_largest(void) {
    const laconic_real beyond = LACONIC_REAL_MAX * 2;
    TEST_ASSERT_EQUAL_HEX32(0x7F7FFFFFU, bits_of(beyond));
    TEST_ASSERT_EQUAL_HEX32(0xFF7FFFFFU, bits_of(-beyond));
}

static void what_is_no_number_stays_none(void) {
    const laconic_real none = real_not_a_number(), beyond = LACONIC_REAL_MAX * 2;
    TEST_ASSERT_EQUAL_HEX32(0x7FC00000U, bits_of(none) & 0x7FFFFFFFU);
    TEST_ASSERT_FALSE(is_finite(none));
    TEST_ASSERT_FALSE(is_finite(beyond) || is_finite(-beyond));
    TEST_ASSERT_TRUE(is_finite(LACONIC_REAL_MAX) && is_finite(0));
}

static void a_value_is_kept_within_its_bounds(void) {
    TEST_ASSERT_TRUE(real_within(5, -1, 2) == 2);
    TEST_ASSERT_TRUE(real_within(-5, -1, 2) == -1);
    TEST_ASSERT_TRUE(real_within((laconic_real)0.5, -1, 2) == (laconic_real)0.5);
    TEST_ASSERT_TRUE(real_magnitude(-3) == 3 && real_magnitude(3) == 3);
}

/* Tests of settings.c: numbers of drives that cannot be played are refused by field and wheel. */

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
    RUN_TEST(every_listed_protocol_is_whole_and_fits_the_node);
    RUN_TEST(the_numbers_are_those_of_the_wire);
    RUN_TEST(the_ids_of_drives_are_those_of_their_buses);
    RUN_TEST(a_protocol_touches_its_own_drives_alone);
    RUN_TEST(integers_have_their_lowest_octet_first);
    RUN_TEST(real_numbers_are_binary32);
    RUN_TEST(numbers_beyond_binary32_become_its_largest);
    RUN_TEST(what_is_no_number_stays_none);
    RUN_TEST(a_value_is_kept_within_its_bounds);
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
