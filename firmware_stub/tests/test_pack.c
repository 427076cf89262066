/* Tests of node_pack.c: the content of the node's frames, and when they set overrange. */
#include "bench.h"
#include "unity.h"

void setUp(void) {
    bench_begin();
    bench_load(4);
}
void tearDown(void) {}

/* One step at these pseudo-velocities, with everything selected. */
static void publish(laconic_real nu_2, laconic_real x_m, laconic_real heading_rad) {
    const laconic_start start = {{0, nu_2, 0}, x_m, 0, heading_rad, {0}};
    bench_select(LACONIC_NODE_SEND_NU | LACONIC_NODE_SEND_POSE | LACONIC_NODE_SEND_WHEEL_SPEED |
                     LACONIC_NODE_SEND_STATE_FD | LACONIC_NODE_SEND_COUNTERS,
                 0, 0);
    bench_start_lockstep();
    laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL);
    bench_sync(1);
    laconic_node_on_tick(&node, now_us);
}

static void values_are_rounded_to_the_nearest(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_nu_t nu;
    publish((laconic_real)-0.0126, 0, 0);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_NU, data));
    laconic_dbc_nu_unpack(&nu, data, 8);
    TEST_ASSERT_EQUAL_INT16(-3, nu.nu_2);
    TEST_ASSERT_EQUAL_UINT8(0, nu.overrange);
}

static void values_out_of_range_saturate_and_set_the_flag(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_nu_t nu;
    struct laconic_dbc_pose_t pose;
    publish(1000, -40, 0);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_NU, data));
    laconic_dbc_nu_unpack(&nu, data, 8);
    TEST_ASSERT_EQUAL_INT16(32767, nu.nu_2);
    TEST_ASSERT_EQUAL_UINT8(1, nu.overrange);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_POSE, data));
    laconic_dbc_pose_unpack(&pose, data, 8);
    TEST_ASSERT_EQUAL_INT16(-32767, pose.x);
    TEST_ASSERT_EQUAL_UINT8(1, pose.overrange);
}

static void wheels_come_in_groups_of_three(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_wheel_speed_t speed;
    publish(2, 0, 0);
    for (uint8_t group = 0; group < 2; group++) {
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_SPEED, data));
        laconic_dbc_wheel_speed_unpack(&speed, data, 8);
        TEST_ASSERT_EQUAL_UINT8(group, speed.group);
        TEST_ASSERT_INT_WITHIN(2, 400, speed.wheel_speed_1);
        TEST_ASSERT_INT_WITHIN(2, group == 0 ? 400 : 0, speed.wheel_speed_2);
    }
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_WHEEL_SPEED, data));
}

static void the_fd_frame_packed_by_hand_reads_by_the_contract(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_state_fd_t state;
    publish((laconic_real)2.5, (laconic_real)1.25, (laconic_real)-0.5);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_STATE_FD, data));
    TEST_ASSERT_TRUE(laconic_plain_is_right(LACONIC_WIRE_STATE_FD, data));
    laconic_dbc_state_fd_unpack(&state, data, 64);
    TEST_ASSERT_EQUAL_UINT32(1, state.steps);
    TEST_ASSERT_INT_WITHIN(3, 2500000, state.nu_2);
    TEST_ASSERT_INT_WITHIN(2000, 1250000, state.x);
    TEST_ASSERT_INT_WITHIN(30, -50000000, state.heading);
    TEST_ASSERT_INT_WITHIN(2, 500, state.wheel_speed_4);
    TEST_ASSERT_EQUAL_INT16(0, state.wheel_speed_5);
}

static void counters_come_in_three_pages(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_counters_t counters;
    publish(0, 0, 0);
    const laconic_node_counters all = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    node.counters = all;
    now_us += LACONIC_NODE_HEARTBEAT_US;
    laconic_node_on_tick(&node, now_us);
    for (uint8_t page = 0; page < 3; page++) {
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_COUNTERS, data));
        laconic_dbc_counters_unpack(&counters, data, 8);
        TEST_ASSERT_EQUAL_UINT8(page, counters.page);
        const uint16_t found[9] = {counters.crc_errors, counters.sequence_errors, counters.repeated,
                                   counters.lost,       counters.malformed,       counters.late_periods,
                                   counters.accepted,   counters.refused,         counters.overrange};
        for (uint8_t k = 0; k < 3; k++) TEST_ASSERT_EQUAL_UINT16(3 * page + k + 1, found[3 * page + k]);
    }
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_COUNTERS, data));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(values_are_rounded_to_the_nearest);
    RUN_TEST(values_out_of_range_saturate_and_set_the_flag);
    RUN_TEST(wheels_come_in_groups_of_three);
    RUN_TEST(the_fd_frame_packed_by_hand_reads_by_the_contract);
    RUN_TEST(counters_come_in_three_pages);
    return UNITY_END();
}
