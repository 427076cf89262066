/* Tests of node_pack.c: the content of the node's frames, and when they set overrange. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

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

/* The same of a vehicle that moves freely. */
static void publish_all(laconic_real nu_1, laconic_real nu_2) {
    const laconic_start start = {{nu_1, nu_2, 0}, 0, 0, 0, {0}};
    bench_select(LACONIC_NODE_SEND_STATE_FD, 0, 0);
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
    const laconic_node_counters all = {0x101, 0x102, 0x103, 0x104, 0x105, 0x106, 0x107, 0x108, 0x109};
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
        for (uint8_t k = 0; k < 3; k++) TEST_ASSERT_EQUAL_UINT16(0x101 + 3 * page + k, found[3 * page + k]);
    }
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_COUNTERS, data));
}

/* A busy bus that takes one of them in each period of the heartbeat gets them all. */
static void pages_of_counters_go_on_where_they_were(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_counters_t counters;
    publish(0, 0, 0);
    for (uint8_t k = 0; k < 7; k++) {
        now_us += LACONIC_NODE_HEARTBEAT_US;
        laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_COUNTERS, data));
        laconic_dbc_counters_unpack(&counters, data, 8);
        TEST_ASSERT_EQUAL_UINT8(k % 3, counters.page);
    }
}

static void each_number_of_a_pose_has_its_place(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_pose_t pose;
    const laconic_start start = {{0, 0, 0}, (laconic_real)1.5, (laconic_real)-2.25, (laconic_real)0.75, {0}};
    bench_select(LACONIC_NODE_SEND_POSE, 0, 0);
    bench_start_lockstep();
    laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL);
    bench_sync(1);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_POSE, data));
    laconic_dbc_pose_unpack(&pose, data, 8);
    TEST_ASSERT_EQUAL_INT16(1500, pose.x);
    TEST_ASSERT_EQUAL_INT16(-2250, pose.y);
    TEST_ASSERT_EQUAL_INT16(7500, pose.heading);
    TEST_ASSERT_EQUAL_UINT8(0, pose.overrange);
}

static void each_number_of_nu_has_its_place(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_nu_t nu;
    laconic_real now[3];
    bench_load(0); /* without wheels all three numbers are free */
    const laconic_start start = {{(laconic_real)1.5, (laconic_real)-2.25, 0}, 0, 0, 0, {0}};
    bench_select(LACONIC_NODE_SEND_NU, 0, 0);
    bench_start_lockstep();
    laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL);
    bench_sync(1);
    laconic_node_on_tick(&node, now_us);
    laconic_nu(&node.plant.model, &node.plant.state, now);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_NU, data));
    laconic_dbc_nu_unpack(&nu, data, 8);
    TEST_ASSERT_EQUAL_INT16(300, nu.nu_1);
    TEST_ASSERT_EQUAL_INT16(-450, nu.nu_2);
    TEST_ASSERT_EQUAL_INT16(0, nu.nu_3);
}

static struct laconic_dbc_heartbeat_t heartbeat(void) {
    struct laconic_dbc_heartbeat_t beat = {0};
    uint8_t data[LACONIC_FRAME_BYTES];
    now_us += LACONIC_NODE_HEARTBEAT_US;
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_HEARTBEAT, data));
    laconic_dbc_heartbeat_unpack(&beat, data, 8);
    return beat;
}

static void a_heartbeat_tells_steps_state_and_lateness(void) {
    node.plant.steps = 0x1122334455667788U;
    node.free_run.worst_lateness_us = 32766;
    struct laconic_dbc_heartbeat_t beat = heartbeat();
    TEST_ASSERT_EQUAL_HEX32(0x55667788U, beat.steps);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_READY, beat.state);
    TEST_ASSERT_EQUAL_UINT16(32766, beat.worst_lateness);
    TEST_ASSERT_EQUAL_UINT8(0, beat.deaf);
    node.free_run.worst_lateness_us = 0;
    TEST_ASSERT_EQUAL_UINT16(0, heartbeat().worst_lateness);
    node.free_run.worst_lateness_us = 1000000;
    node.session.deaf = BIT_OF(LACONIC_WIRE_SYNC);
    beat = heartbeat();
    TEST_ASSERT_EQUAL_UINT16(32767, beat.worst_lateness);
    TEST_ASSERT_EQUAL_UINT8(1, beat.deaf);
}

/* While drives play, and after them; in lockstep nobody speaks to drives. */
static void a_heartbeat_tells_of_a_drive_that_heard_no_controller_in_time(void) {
    node.drives.count = 2;
    TEST_ASSERT_EQUAL_UINT8(0, heartbeat().deaf);
    node.drives.drive[0].unheard = true;
    TEST_ASSERT_EQUAL_UINT8(1, heartbeat().deaf);
    node.drives.drive[0].unheard = false;
    node.drives.drive[1].unheard = true;
    TEST_ASSERT_EQUAL_UINT8(1, heartbeat().deaf);
    bench_start_lockstep();
    TEST_ASSERT_EQUAL_UINT8(0, heartbeat().deaf);
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    node.drives.drive[1].unheard = false;
    node.drives.drive[2].unheard = true; /* beyond the last */
    TEST_ASSERT_EQUAL_UINT8(0, heartbeat().deaf);
}

static void a_result_repeats_the_request_and_names_field_and_item(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_result_t result;
    const laconic_node_result answer = {0, LACONIC_WIRE_COMMAND_COMMIT, 7, 31, 5};
    node.answer[LACONIC_WIRE_COMMIT].request = 11;
    laconic_node_answer(&node, LACONIC_WIRE_COMMIT, answer);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    laconic_dbc_result_unpack(&result, data, 8);
    TEST_ASSERT_EQUAL_UINT8(11, result.request);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_COMMAND_COMMIT, result.command);
    TEST_ASSERT_EQUAL_UINT8(7, result.status);
    TEST_ASSERT_EQUAL_UINT8(31, result.field);
    TEST_ASSERT_EQUAL_UINT8(5, result.item);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_READY, result.state);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.refused);
}

static void a_challenge_repeats_the_request_of_its_hello(void) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HELLO, .length = 8};
    struct laconic_dbc_challenge_t challenge;
    uint8_t data[LACONIC_FRAME_BYTES];
    laconic_protect_plain(LACONIC_WIRE_HELLO, frame.data, 13);
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_CHALLENGE, data));
    laconic_dbc_challenge_unpack(&challenge, data, 8);
    TEST_ASSERT_EQUAL_UINT8(13, challenge.request);
    TEST_ASSERT_EQUAL_HEX32(node.session.nonce, challenge.nonce);
}

/* The bytes that no signal has are 0, whatever the port's frame held before. */
static void what_a_frame_does_not_tell_is_zero(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    memset(data, 0xFF, sizeof data);
    node.answers_due = (uint16_t)BIT_OF(LACONIC_WIRE_CONTROL);
    laconic_node_pack(&node, LACONIC_WIRE_RESULT, data);
    TEST_ASSERT_TRUE(data[0] == 0 && data[7] == 0);
    memset(data, 0xFF, sizeof data);
    laconic_node_pack(&node, LACONIC_WIRE_CHALLENGE, data);
    TEST_ASSERT_TRUE(data[6] == 0 && data[7] == 0);
}

static void counters_stop_at_their_largest_number(void) {
    uint16_t counter = UINT16_MAX - 1U;
    count(&counter);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, counter);
    count(&counter);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, counter);
}

static void a_number_just_below_a_half_is_rounded_down(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_nu_t nu;
    publish((laconic_real)0.012485, 0, 0); /* 2.497 units */
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_NU, data));
    laconic_dbc_nu_unpack(&nu, data, 8);
    TEST_ASSERT_EQUAL_INT16(2, nu.nu_2);
}

static void a_deaf_node_that_was_never_late_says_so(void) {
    node.session.deaf = BIT_OF(LACONIC_WIRE_SYNC);
    const struct laconic_dbc_heartbeat_t beat = heartbeat();
    TEST_ASSERT_TRUE(beat.deaf == 1 && beat.worst_lateness == 0);
}

static void the_fd_frame_has_all_three_numbers_of_nu_and_sixteen_wheels(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    bench_load(0);
    publish_all((laconic_real)0.5, (laconic_real)-0.25);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_STATE_FD, data));
    TEST_ASSERT_EQUAL_INT32(500000, (int32_t)word32(data + 8));
    TEST_ASSERT_EQUAL_INT32(-250000, (int32_t)word32(data + 12));
    TEST_ASSERT_EQUAL_INT32(0, (int32_t)word32(data + 16));
    bench_begin();
    bench_load(16);
    publish(2, 0, 0);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_STATE_FD, data));
    for (int k = 0; k < 16; k++) TEST_ASSERT_INT_WITHIN(2, 400, (int16_t)word16(data + 32 + 2 * k));
}

static void either_frame_has_nu_3_of_a_vehicle_that_turns(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_nu_t nu;
    const laconic_start start = {{0, 0, (laconic_real)-0.75}, 0, 0, 0, {0}};
    bench_load(0);
    bench_select(LACONIC_NODE_SEND_NU | LACONIC_NODE_SEND_STATE_FD, 0, 0);
    bench_start_lockstep();
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL));
    bench_sync(1);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_NU, data));
    laconic_dbc_nu_unpack(&nu, data, 8);
    TEST_ASSERT_EQUAL_INT16(-150, nu.nu_3);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_STATE_FD, data));
    TEST_ASSERT_INT_WITHIN(1, -750000, (int32_t)word32(data + 16));
    TEST_ASSERT_EQUAL_UINT8(0, data[3]);
}

static void the_fd_frame_ends_with_its_last_byte(void) {
    uint8_t data[LACONIC_FRAME_BYTES + 1];
    memset(data, 0xA5, sizeof data);
    laconic_node_pack(&node, LACONIC_WIRE_STATE_FD, data);
    TEST_ASSERT_EQUAL_HEX8(0, data[LACONIC_FRAME_BYTES - 1]);
    TEST_ASSERT_EQUAL_HEX8(0xA5, data[LACONIC_FRAME_BYTES]);
}

static void a_value_at_the_bound_is_in_range(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_nu_t nu;
    const laconic_real bound = (laconic_real)(32767.0 / 200);
    if (sizeof bound == 4) return; /* there is no such number in single */
    TEST_ASSERT_TRUE(bound * 200 == 32767);
    for (int sign = -1; sign <= 1; sign += 2) {
        const laconic_start start = {{bound * (laconic_real)sign, 0, 0}, 0, 0, 0, {0}};
        bench_load(0);
        bench_select(LACONIC_NODE_SEND_NU, 0, 0);
        TEST_ASSERT_EQUAL(LACONIC_OK, laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL));
        laconic_node_pack(&node, LACONIC_WIRE_NU, data);
        laconic_dbc_nu_unpack(&nu, data, 8);
        TEST_ASSERT_EQUAL_INT16(32767 * sign, nu.nu_1);
        TEST_ASSERT_EQUAL_UINT8(0, nu.overrange);
    }
}

/* The second group of a cart that spins about its origin is beyond the range; the first is not, and says so. */
static void the_flag_of_a_group_is_of_its_own_wheels(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_wheel_speed_t speed;
    laconic_real found[LACONIC_MAX_WHEELS];
    const laconic_start start = {{0, -60, 60}, 0, 0, 0, {0}};
    laconic_vehicle vehicle = node.plant.vehicle;
    for (int i = 0; i < 4; i++) vehicle.wheel[i].kind = LACONIC_WHEEL_ROLLER;
    for (int i = 0; i < 4; i++) vehicle.wheel[i].roller_rad = (laconic_real)1.5;
    TEST_ASSERT_EQUAL(LACONIC_OK,
                      laconic_plant_start(&node.plant, &vehicle, &laconic_rk4, (laconic_real)0.001, &start, NULL));
    laconic_plant_wheel_speeds(&node.plant, found);
    const laconic_real most = 32767 / (laconic_real)200;
    for (int i = 0; i < 4; i++) TEST_ASSERT_TRUE((found[i] > most || found[i] < -most) == (i == 3));
    for (node.wheel_group = 0; node.wheel_group < 2; node.wheel_group++) {
        laconic_node_pack(&node, LACONIC_WIRE_WHEEL_SPEED, data);
        laconic_dbc_wheel_speed_unpack(&speed, data, 8);
        TEST_ASSERT_EQUAL_UINT8(node.wheel_group, speed.overrange);
    }
}

static void frames_of_a_kind_are_counted_upwards(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    uint8_t last = 0;
    bench_load(2);
    bench_select(LACONIC_NODE_SEND_NU, 0, 0);
    bench_start_lockstep();
    for (int k = 0; k < 4; k++) {
        bench_sync(1);
        laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_NU, data));
        const uint8_t counter = laconic_counter_of(LACONIC_WIRE_NU, data);
        if (k > 0) TEST_ASSERT_EQUAL_UINT8((last + 1) & 15, counter);
        last = counter;
    }
}

static void more_than_a_half_of_a_unit_is_one(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_nu_t nu;
    const laconic_start start = {{(laconic_real)(0.7 / 200), (laconic_real)(-0.7 / 200), 0}, 0, 0, 0, {0}};
    bench_load(0);
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL));
    laconic_node_pack(&node, LACONIC_WIRE_NU, data);
    laconic_dbc_nu_unpack(&nu, data, 8);
    TEST_ASSERT_EQUAL_INT16(1, nu.nu_1);
    TEST_ASSERT_EQUAL_INT16(-1, nu.nu_2);
}

/* Also where the frame before had more of them. */
static void wheels_that_are_not_there_have_no_speed(void) {
    static laconic_plant two;
    uint8_t data[LACONIC_FRAME_BYTES];
    const laconic_start start = {{0, 2, 0}, 0, 0, 0, {0}};
    bench_load(2);
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL));
    two = node.plant;
    bench_load(LACONIC_MAX_WHEELS);
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL));
    laconic_node_pack(&node, LACONIC_WIRE_STATE_FD, data);
    node.plant = two;
    laconic_node_pack(&node, LACONIC_WIRE_STATE_FD, data);
    TEST_ASSERT_INT_WITHIN(2, 400, (int16_t)word16(data + 34));
    for (size_t k = 36; k < 64; k++) TEST_ASSERT_EQUAL_HEX8(0, data[k]);
}

/* Its frames may wait from the vehicle before, which had wheels that moved. */
static void wheels_of_a_puck_stand_still(void) {
    static const uint8_t frames[] = {LACONIC_WIRE_WHEEL_SPEED, LACONIC_WIRE_WHEEL_ANGLE};
    uint8_t data[LACONIC_FRAME_BYTES];
    publish(2, 0, 0);
    node.pending |= BIT_OF(LACONIC_WIRE_WHEEL_ANGLE);
    bench_load(0);
    for (size_t k = 0; k < sizeof frames; k++) {
        TEST_ASSERT_TRUE(bench_receive(frames[k], data));
        for (size_t byte = 2; byte < 8; byte++) TEST_ASSERT_EQUAL_HEX8(0, data[byte]);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(values_are_rounded_to_the_nearest);
    RUN_TEST(values_out_of_range_saturate_and_set_the_flag);
    RUN_TEST(wheels_come_in_groups_of_three);
    RUN_TEST(the_fd_frame_packed_by_hand_reads_by_the_contract);
    RUN_TEST(counters_come_in_three_pages);
    RUN_TEST(pages_of_counters_go_on_where_they_were);
    RUN_TEST(each_number_of_a_pose_has_its_place);
    RUN_TEST(each_number_of_nu_has_its_place);
    RUN_TEST(a_heartbeat_tells_steps_state_and_lateness);
    RUN_TEST(a_heartbeat_tells_of_a_drive_that_heard_no_controller_in_time);
    RUN_TEST(a_result_repeats_the_request_and_names_field_and_item);
    RUN_TEST(a_challenge_repeats_the_request_of_its_hello);
    RUN_TEST(what_a_frame_does_not_tell_is_zero);
    RUN_TEST(counters_stop_at_their_largest_number);
    RUN_TEST(a_number_just_below_a_half_is_rounded_down);
    RUN_TEST(a_deaf_node_that_was_never_late_says_so);
    RUN_TEST(the_fd_frame_has_all_three_numbers_of_nu_and_sixteen_wheels);
    RUN_TEST(the_fd_frame_ends_with_its_last_byte);
    RUN_TEST(either_frame_has_nu_3_of_a_vehicle_that_turns);
    RUN_TEST(a_value_at_the_bound_is_in_range);
    RUN_TEST(the_flag_of_a_group_is_of_its_own_wheels);
    RUN_TEST(frames_of_a_kind_are_counted_upwards);
    RUN_TEST(more_than_a_half_of_a_unit_is_one);
    RUN_TEST(wheels_that_are_not_there_have_no_speed);
    RUN_TEST(wheels_of_a_puck_stand_still);
    return UNITY_END();
}
