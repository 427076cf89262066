/* Tests of node_pack.c: wheel angles, in groups of three from the first wheel on. */
#include "bench.h"
#include "unity.h"

static uint8_t data[LACONIC_FRAME_BYTES];

void setUp(void) { bench_begin(); }

void tearDown(void) {}

static void wheel_angles_are_wrapped_and_grouped(void) {
    struct laconic_dbc_wheel_angle_t frame;
    laconic_real angle[LACONIC_MAX_WHEELS];
    bench_load(4);
    bench_select(LACONIC_NODE_SEND_WHEEL_ANGLE, 0, 0);
    bench_start_lockstep();
    bench_voltage(1, 5 * VOLT, 0);
    bench_step(2000);
    laconic_plant_wheel_angles(&node.plant, angle);
    TEST_ASSERT_TRUE(angle[0] > 4);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
    laconic_dbc_wheel_angle_unpack(&frame, data, 8);
    TEST_ASSERT_EQUAL_INT(0, frame.group);
    TEST_ASSERT_EQUAL_INT(rounded(laconic_angle_wrapped(angle[0]) * 10000), frame.wheel_angle_1);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
    laconic_dbc_wheel_angle_unpack(&frame, data, 8);
    TEST_ASSERT_EQUAL_INT(1, frame.group);
    TEST_ASSERT_EQUAL_INT(rounded(laconic_angle_wrapped(angle[3]) * 10000), frame.wheel_angle_1);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
}

static void frames_of_wheels_begin_anew_with_each_step(void) {
    bench_load(4);
    bench_select(LACONIC_NODE_SEND_WHEEL_ANGLE, 0, 0);
    bench_start_lockstep();
    for (int k = 0; k < 2; k++) {
        laconic_frame frame;
        bench_step(1);
        TEST_ASSERT_TRUE(laconic_node_next_frame(&node, &frame)); /* one of two is fetched */
        TEST_ASSERT_EQUAL_UINT8(0, frame.data[1] >> 5);
    }
}

static void every_wheel_of_a_group_shows_its_own_angle(void) {
    struct laconic_dbc_wheel_angle_t frame;
    laconic_real angle[LACONIC_MAX_WHEELS];
    bench_load(3);
    bench_select(LACONIC_NODE_SEND_WHEEL_ANGLE, 0, 0);
    bench_start_lockstep();
    bench_step(500);
    laconic_plant_wheel_angles(&node.plant, angle);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
    laconic_dbc_wheel_angle_unpack(&frame, data, 8);
    TEST_ASSERT_EQUAL_INT(rounded(laconic_angle_wrapped(angle[1]) * 10000), frame.wheel_angle_2);
    TEST_ASSERT_EQUAL_INT(rounded(laconic_angle_wrapped(angle[2]) * 10000), frame.wheel_angle_3);
    TEST_ASSERT_TRUE(frame.wheel_angle_2 != 0);
}

static void angles_of_all_wheels_come_in_as_many_groups_as_they_need(void) {
    bench_load(LACONIC_MAX_WHEELS);
    bench_select(LACONIC_NODE_SEND_WHEEL_ANGLE, 0, 0);
    bench_start_lockstep();
    bench_step(1);
    for (int k = 0; k < (LACONIC_MAX_WHEELS + 2) / 3; k++) {
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
        TEST_ASSERT_EQUAL_INT(k, data[1] >> 5);
    }
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(wheel_angles_are_wrapped_and_grouped);
    RUN_TEST(frames_of_wheels_begin_anew_with_each_step);
    RUN_TEST(every_wheel_of_a_group_shows_its_own_angle);
    RUN_TEST(angles_of_all_wheels_come_in_as_many_groups_as_they_need);
    return UNITY_END();
}
