/* Tests of node.c and node_motion.c: frames, steps and answers of a node in lockstep. */
#include "bench.h"
#include "laconic_node/crc.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

void setUp(void) { bench_begin(); }
void tearDown(void) {}

static void id_bases_are_multiples_of_32(void) {
    laconic_node_config config = {0x210, true, laconic_method_by_number, 0, NULL};
    TEST_ASSERT_FALSE(laconic_node_init(&node, &config, 0));
    config.id_base = 0x800;
    TEST_ASSERT_FALSE(laconic_node_init(&node, &config, 0));
    config.id_base = 0x801; /* for two reasons */
    TEST_ASSERT_FALSE(laconic_node_init(&node, &config, 0));
    config.id_base = 0x7E0;
    TEST_ASSERT_TRUE(laconic_node_init(&node, &config, 0));
}

static void a_node_has_methods(void) {
    laconic_node_config config = {.id_base = LACONIC_WIRE_ID_BASE, .method = NULL};
    TEST_ASSERT_FALSE(laconic_node_init(&node, &config, 0));
    config.method = laconic_method_by_number;
    TEST_ASSERT_TRUE(laconic_node_init(&node, &config, 0));
}

static void the_node_identifies_itself(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_identity_t identity;
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HELLO, .length = 8};
    laconic_protect_plain(LACONIC_WIRE_HELLO, frame.data, 0);
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_IDENTITY, data));
    laconic_dbc_identity_unpack(&identity, data, 8);
    TEST_ASSERT_EQUAL_UINT8(sizeof(laconic_real), identity.scalar_bytes);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_MAX_WHEELS, identity.max_wheels);
    TEST_ASSERT_EQUAL_HEX8((1 << LACONIC_METHOD_COUNT) - 1, identity.methods);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_VERSION, identity.protocol);
    TEST_ASSERT_EQUAL_UINT8(1, identity.can_fd);
    char version[16];
    snprintf(version, sizeof version, "%u.%u.%u", identity.version_major, identity.version_minor,
             identity.version_patch);
    TEST_ASSERT_EQUAL_STRING(LACONIC_VERSION, version);
}

static void nothing_starts_without_a_vehicle(void) {
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, bench_start_lockstep());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_start_lockstep());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, bench_start_lockstep());
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_UNKNOWN_COMMAND, bench_control(99, 0, 0));
}

static void a_sync_steps_and_is_answered_with_what_was_selected(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    bench_load(2);
    bench_select(LACONIC_NODE_SEND_NU, 0, 0);
    bench_start_lockstep();
    bench_voltage(0, 500, 1);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_TRUE(node.plant.steps == 1 && node.input[0].voltage_V[1] == 1);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_NU, data));
    TEST_ASSERT_FALSE(laconic_node_next_frame(&node, &(laconic_frame){0}));
    bench_sync(100);
    TEST_ASSERT_TRUE(laconic_node_is_busy(&node) && laconic_node_idle_us(&node, now_us) == 0);
    bench_sync(1); /* while it is busy */
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_BUSY, data[3]);
    while (laconic_node_is_busy(&node)) laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(101, node.plant.steps);
}

static void a_sync_of_no_steps_or_too_many_or_without_its_inputs_is_refused(void) {
    uint8_t data[LACONIC_FRAME_BYTES] = {0};
    bench_load(2);
    bench_select(0, LACONIC_RAW_NU, LACONIC_RAW_VOLTAGE);
    bench_start_lockstep();
    const uint32_t wrong[] = {0, 1000001, UINT32_MAX};
    for (int k = 0; k < 3; k++) {
        bench_sync(wrong[k]);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, data[3]);
    }
    memset(data, 0, sizeof data);
    bench_send(LACONIC_WIRE_RAW_INPUT, data);
    bench_sync(1);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_INPUT_INCOMPLETE, data[3]);
    TEST_ASSERT_EQUAL_UINT64(0, node.plant.steps);
}

static void frames_of_the_wrong_shape_change_nothing_but_a_counter(void) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE, .length = 7};
    laconic_node_on_frame(&node, &frame, now_us);
    frame.length = 8;
    frame.remote = true;
    laconic_node_on_frame(&node, &frame, now_us);
    frame.remote = false;
    frame.id += LACONIC_WIRE_NU; /* one of our own, from a second node */
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_EQUAL_UINT16(3, node.counters.malformed);
    frame.extended = true;
    laconic_node_on_frame(&node, &frame, now_us);
    frame.extended = false;
    frame.id = LACONIC_WIRE_ID_BASE - 1;
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_EQUAL_UINT16(3, node.counters.malformed);
    frame.id = LACONIC_WIRE_ID_BASE;
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.crc_errors);
    TEST_ASSERT_FALSE(laconic_node_next_frame(&node, &frame));
}

static void a_vehicle_can_only_be_changed_while_it_stands(void) {
    uint8_t data[LACONIC_FRAME_BYTES] = {0};
    bench_load(2);
    bench_start_lockstep();
    bench_send(LACONIC_WIRE_COMMIT, data);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, data[3]);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, bench_select(0, 0, 0));
}

static void a_step_that_the_core_refuses_ends_in_fault_and_reset_mends_it(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    bench_load(2);
    node.start.nu_rad_per_s[2] = 1;
    bench_start_lockstep();
    node.input[0].voltage_V[0] = LACONIC_REAL_MAX;
    bench_sync(5);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data) && data[3] != 0);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, bench_start_lockstep());
    node.start.nu_rad_per_s[2] = 0;
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(0, bench_start_lockstep());
}

static void the_fault_names_the_wheel_whichever_sample_of_the_step_is_to_blame(void) {
    for (int32_t k = 0; k < 3; k++) {
        uint8_t data[LACONIC_FRAME_BYTES];
        struct laconic_dbc_result_t result;
        bench_begin();
        bench_load(3);
        bench_select(0, 0, LACONIC_RAW_SAMPLED);
        bench_start_lockstep();
        node.input[k].voltage_V[k] = (laconic_real)NAN;
        bench_sync(1);
        laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
        laconic_dbc_result_unpack(&result, data, 8);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_NOT_FINITE, result.status);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_VOLTAGE, result.field);
        TEST_ASSERT_EQUAL_UINT8(k + 1, result.item);
    }
}

static void can_fd_is_refused_where_there_is_none(void) {
    bench_load(2);
    node.config.can_fd = false;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, bench_select(LACONIC_NODE_SEND_STATE_FD, 0, 0));
    node.config.can_fd = true;
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(LACONIC_NODE_SEND_STATE_FD, 0, 0));
}

static void a_node_begins_with_an_empty_loader_whatever_its_memory_held(void) {
    const laconic_node_config config = node.config;
    memset(&node, 0xA5, sizeof node);
    TEST_ASSERT_TRUE(laconic_node_init(&node, &config, 7));
    TEST_ASSERT_EQUAL_HEX32(LACONIC_CRC32_START, node.loader.checksum);
    TEST_ASSERT_TRUE(node.heartbeat_us == 7 && node.state == LACONIC_WIRE_STATE_EMPTY && node.pending == 0);
}

static void a_fetched_frame_says_of_which_kind_it_is(void) {
    laconic_frame frame;
    bench_load(2);
    bench_select(LACONIC_NODE_SEND_NU | LACONIC_NODE_SEND_STATE_FD, 0, 0);
    bench_start_lockstep();
    bench_sync(1);
    laconic_node_on_tick(&node, now_us);
    for (int k = 0; k < 2; k++) {
        memset(&frame, 0xFF, sizeof frame);
        TEST_ASSERT_TRUE(laconic_node_next_frame(&node, &frame));
        TEST_ASSERT_TRUE(!frame.extended && !frame.remote && frame.fd == (k == 1) && frame.bit_rate_switch == (k == 1));
        TEST_ASSERT_EQUAL_UINT8(k == 0 ? 8 : 64, frame.length);
        TEST_ASSERT_EQUAL_UINT32((uint32_t)(LACONIC_WIRE_ID_BASE + (k == 0 ? LACONIC_WIRE_NU : LACONIC_WIRE_STATE_FD)),
                                 frame.id);
        if (k == 1)
            for (int byte = 36; byte < 64; byte++) TEST_ASSERT_EQUAL_HEX8(0, frame.data[byte]);
    }
    TEST_ASSERT_FALSE(laconic_node_next_frame(&node, &frame));
}

static uint16_t refused_of(uint8_t offset) {
    const uint8_t none[LACONIC_FRAME_BYTES] = {0};
    const uint16_t before = node.counters.refused;
    bench_send(offset, none);
    return (uint16_t)(node.counters.refused - before);
}

static void raw_inputs_are_for_lockstep_between_its_steps(void) {
    bench_load(2);
    bench_select(0, 0, LACONIC_RAW_VOLTAGE);
    bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 0, 0);
    TEST_ASSERT_EQUAL_UINT16(1, refused_of(LACONIC_WIRE_RAW_INPUT));
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    bench_start_lockstep();
    TEST_ASSERT_EQUAL_UINT16(0, refused_of(LACONIC_WIRE_RAW_INPUT));
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    bench_start_lockstep();
    node.lockstep.steps_due = 1;
    bench_send(LACONIC_WIRE_RAW_INPUT, (const uint8_t[LACONIC_FRAME_BYTES]){0});
    TEST_ASSERT_EQUAL_UINT16(0, node.raw_input.frames);
}

static void a_sync_while_one_step_is_due_is_told_that_the_node_is_busy(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    bench_load(2);
    bench_start_lockstep();
    bench_sync(1);
    bench_sync(1);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_BUSY, data[3]);
    TEST_ASSERT_EQUAL_UINT8(sent[LACONIC_WIRE_SYNC] & 15U, data[1] >> 4);
}

static void a_million_steps_are_the_most_of_one_sync(void) {
    bench_load(2);
    bench_start_lockstep();
    bench_sync(1000000);
    TEST_ASSERT_EQUAL_UINT32(1000000, node.lockstep.steps_due);
}

static void voltages_go_to_the_wheels_of_their_group_and_to_no_others(void) {
    bench_load(4);
    bench_start_lockstep();
    bench_voltage(1, 500, 0);
    for (int k = 0; k < LACONIC_MAX_WHEELS; k++) TEST_ASSERT_TRUE(node.input[0].voltage_V[k] == (k == 3));
    bench_voltage(0, 1000, 0);
    for (int k = 0; k < LACONIC_MAX_WHEELS; k++)
        TEST_ASSERT_TRUE(node.input[0].voltage_V[k] == (k < 3 ? 2 : (laconic_real)(k == 3)));
    const uint16_t before = node.counters.refused;
    bench_voltage(2, 500, 0); /* there are four wheels */
    TEST_ASSERT_EQUAL_UINT16(before + 1, node.counters.refused);
    TEST_ASSERT_EQUAL_UINT16(0, node.counters.overrange);
    const struct laconic_dbc_voltage_t over = {.overrange = 1};
    uint8_t data[LACONIC_FRAME_BYTES];
    laconic_dbc_voltage_pack(data, &over, 8);
    bench_send(LACONIC_WIRE_VOLTAGE, data);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.overrange);
}

static void a_single_wheel_has_a_group_of_its_own_behind_the_first(void) {
    bench_load(1);
    bench_start_lockstep();
    const uint16_t before = node.counters.refused;
    bench_voltage(1, 500, 0);
    TEST_ASSERT_EQUAL_UINT16(before + 1, node.counters.refused);
}

static void a_selected_wheel_of_one_is_sent(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    bench_load(1);
    bench_select(LACONIC_NODE_SEND_WHEEL_SPEED | LACONIC_NODE_SEND_WHEEL_ANGLE, 0, 0);
    bench_start_lockstep();
    bench_sync(1);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_SPEED, data));
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
    TEST_ASSERT_EQUAL_UINT32(0, node.pending);
}

static void three_wheels_fill_one_frame_of_speeds_and_one_of_angles(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    bench_load(3);
    bench_select(LACONIC_NODE_SEND_WHEEL_SPEED | LACONIC_NODE_SEND_WHEEL_ANGLE, 0, 0);
    bench_start_lockstep();
    const laconic_start start = {{0, 2, 0}, 0, 0, 0, {0}};
    laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL);
    for (int again = 0; again < 2; again++) {
        struct laconic_dbc_wheel_speed_t speed;
        bench_sync(1);
        laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_SPEED, data));
        laconic_dbc_wheel_speed_unpack(&speed, data, 8);
        TEST_ASSERT_TRUE(speed.group == 0 && speed.wheel_speed_1 == 400 && speed.wheel_speed_3 == 400);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_WHEEL_ANGLE, data));
        TEST_ASSERT_EQUAL_UINT8(0, data[1] >> 5);
        TEST_ASSERT_EQUAL_UINT32(0, node.pending);
    }
}

static void a_fault_in_lockstep_answers_the_sync_and_forgets_the_steps_left(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    bench_load(2);
    bench_start_lockstep();
    node.input[0].voltage_V[0] = (laconic_real)NAN;
    bench_sync(200);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    TEST_ASSERT_FALSE(laconic_node_is_busy(&node));
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(sent[LACONIC_WIRE_SYNC] & 15U, data[1] >> 4);
}

/* How many frames of each kind wait. */
static void fetch_all(int count[LACONIC_WIRE_OFFSETS]) {
    laconic_frame frame;
    memset(count, 0, LACONIC_WIRE_OFFSETS * sizeof count[0]);
    while (laconic_node_next_frame(&node, &frame)) count[frame.id - LACONIC_WIRE_ID_BASE]++;
}

static void there_are_as_many_frames_of_wheels_as_groups(void) {
    for (int32_t wheels = 0; wheels <= 7; wheels++) {
        int count[LACONIC_WIRE_OFFSETS];
        bench_begin();
        bench_load(wheels);
        bench_select(LACONIC_NODE_SEND_WHEEL_SPEED | LACONIC_NODE_SEND_WHEEL_ANGLE, 0, 0);
        bench_start_lockstep();
        bench_sync(1);
        laconic_node_on_tick(&node, now_us);
        fetch_all(count);
        TEST_ASSERT_EQUAL_INT((wheels + 2) / 3, count[LACONIC_WIRE_WHEEL_SPEED]);
        TEST_ASSERT_EQUAL_INT((wheels + 2) / 3, count[LACONIC_WIRE_WHEEL_ANGLE]);
        TEST_ASSERT_EQUAL_UINT16(0, node.counters.refused);
    }
}

static void the_identifier_behind_the_nodes_last_is_anothers(void) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_NODE_ID_STRIDE, .length = 8};
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_EQUAL_UINT16(0, node.counters.malformed);
    frame.id -= 2; /* the last one is that of XCP, where it is built in */
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.malformed);
}

static void a_repeated_sync_takes_no_further_step(void) {
    bench_load(2);
    bench_start_lockstep();
    bench_sync(1);
    laconic_node_on_tick(&node, now_us);
    const struct laconic_dbc_sync_t frame = {.step_count = 1};
    uint8_t data[LACONIC_FRAME_BYTES];
    laconic_dbc_sync_pack(data, &frame, 8);
    bench_send_count(LACONIC_WIRE_SYNC, data, sent[LACONIC_WIRE_SYNC]);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(1, node.plant.steps);
}

static void a_group_that_begins_where_the_wheels_end_is_refused_and_a_puck_takes_the_first(void) {
    bench_load(3);
    bench_start_lockstep();
    bench_voltage(1, 500, 0);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.refused);
    bench_begin();
    bench_load(0);
    bench_start_lockstep();
    bench_voltage(0, 500, 0);
    TEST_ASSERT_EQUAL_UINT16(0, node.counters.refused);
}

static void reset_ends_a_run(void) {
    bench_load(2);
    bench_start_lockstep();
    bench_voltage(0, 500, 0);
    bench_sync(1000);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
    TEST_ASSERT_FALSE(laconic_node_is_busy(&node));
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0);
}

static void the_first_nonce_is_mixed_of_seed_and_time(void) {
    const laconic_node_config config = node.config;
    laconic_node_init(&node, &config, now_us);
    TEST_ASSERT_EQUAL_HEX32(laconic_mix(config.nonce_seed, now_us), bench_hello());
    const laconic_frame wrong = bench_open_frame(3, 12345);
    const uint16_t before = node.counters.crc_errors;
    laconic_node_on_frame(&node, &wrong, now_us);
    TEST_ASSERT_EQUAL_UINT16(before + 1, node.counters.crc_errors);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(id_bases_are_multiples_of_32);
    RUN_TEST(a_node_has_methods);
    RUN_TEST(the_node_identifies_itself);
    RUN_TEST(nothing_starts_without_a_vehicle);
    RUN_TEST(a_sync_steps_and_is_answered_with_what_was_selected);
    RUN_TEST(a_sync_of_no_steps_or_too_many_or_without_its_inputs_is_refused);
    RUN_TEST(frames_of_the_wrong_shape_change_nothing_but_a_counter);
    RUN_TEST(a_vehicle_can_only_be_changed_while_it_stands);
    RUN_TEST(a_step_that_the_core_refuses_ends_in_fault_and_reset_mends_it);
    RUN_TEST(the_fault_names_the_wheel_whichever_sample_of_the_step_is_to_blame);
    RUN_TEST(can_fd_is_refused_where_there_is_none);
    RUN_TEST(a_node_begins_with_an_empty_loader_whatever_its_memory_held);
    RUN_TEST(a_fetched_frame_says_of_which_kind_it_is);
    RUN_TEST(raw_inputs_are_for_lockstep_between_its_steps);
    RUN_TEST(a_sync_while_one_step_is_due_is_told_that_the_node_is_busy);
    RUN_TEST(a_million_steps_are_the_most_of_one_sync);
    RUN_TEST(voltages_go_to_the_wheels_of_their_group_and_to_no_others);
    RUN_TEST(a_single_wheel_has_a_group_of_its_own_behind_the_first);
    RUN_TEST(a_selected_wheel_of_one_is_sent);
    RUN_TEST(three_wheels_fill_one_frame_of_speeds_and_one_of_angles);
    RUN_TEST(a_fault_in_lockstep_answers_the_sync_and_forgets_the_steps_left);
    RUN_TEST(there_are_as_many_frames_of_wheels_as_groups);
    RUN_TEST(the_identifier_behind_the_nodes_last_is_anothers);
    RUN_TEST(a_repeated_sync_takes_no_further_step);
    RUN_TEST(a_group_that_begins_where_the_wheels_end_is_refused_and_a_puck_takes_the_first);
    RUN_TEST(reset_ends_a_run);
    RUN_TEST(the_first_nonce_is_mixed_of_seed_and_time);
    return UNITY_END();
}
