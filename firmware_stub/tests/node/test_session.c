/* Tests of node_session.c: handshakes, repetitions and stale frames. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#include "bench.h"
#include "unity.h"

void setUp(void) { bench_begin(); }
void tearDown(void) {}

static uint32_t source = 1;
static uint32_t next_random(void) { return source = laconic_mix(source, 0xBADU); }

static laconic_frame recorded(uint8_t offset, const uint8_t *payload, uint32_t key, uint32_t count) {
    const laconic_wire_row *row = &laconic_wire[offset];
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + (uint32_t)offset, .length = row->length, .fd = row->fd != 0};
    memcpy(frame.data, payload, row->length);
    laconic_protect_keyed(offset, frame.data, key, count);
    return frame;
}

static void hello_is_answered_at_any_time_and_changes_nothing(void) {
    const uint32_t nonce = bench_hello();
    TEST_ASSERT_EQUAL_HEX32(nonce, bench_hello());
    bench_load(2);
    bench_start_lockstep();
    TEST_ASSERT_EQUAL_HEX32(nonce, bench_hello());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_LOCKSTEP, node.state);
    bench_voltage(0, 500, 1);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(1, node.plant.steps);
}

static void hello_drops_no_frame_that_waits(void) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HELLO, .length = 8};
    uint32_t seen = 0;
    now_us += LACONIC_NODE_HEARTBEAT_US;
    laconic_node_on_tick(&node, now_us);
    laconic_protect_plain(LACONIC_WIRE_HELLO, frame.data, 0);
    laconic_node_on_frame(&node, &frame, now_us);
    while (laconic_node_next_frame(&node, &frame)) seen |= BIT_OF(frame.id - LACONIC_WIRE_ID_BASE);
    TEST_ASSERT_EQUAL_HEX32(
        BIT_OF(LACONIC_WIRE_HEARTBEAT) | BIT_OF(LACONIC_WIRE_IDENTITY) | BIT_OF(LACONIC_WIRE_CHALLENGE), seen);
}

static void the_nonce_depends_on_seed_and_instant(void) {
    laconic_node_config config = node.config;
    laconic_node_init(&node, &config, now_us);
    const uint32_t first = bench_hello();
    laconic_node_init(&node, &config, now_us);
    now_us++;
    const uint32_t later = bench_hello();
    config.nonce_seed++;
    laconic_node_init(&node, &config, now_us);
    TEST_ASSERT_TRUE(first != later && later != bench_hello());
}

static void without_a_session_nothing_is_accepted(void) {
    uint8_t data[LACONIC_FRAME_BYTES] = {0};
    const laconic_node_config config = node.config;
    laconic_node_init(&node, &config, now_us);
    bench_key = 0;
    sent[LACONIC_WIRE_CONTROL] = 0;
    TEST_ASSERT_EQUAL_UINT8(255, bench_control(LACONIC_WIRE_COMMAND_BEGIN, 0, 0));
    const laconic_frame early = bench_open_frame(1, 0); /* an OPEN before any HELLO */
    laconic_node_on_frame(&node, &early, now_us);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_RESULT, data));
}

static void a_new_session_finds_a_running_node_at_rest_with_its_vehicle(void) {
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 0, 0));
    bench_voltage(0, 500, 0);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 1);
    TEST_ASSERT_EQUAL_UINT8(0, bench_open(7));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_READY, node.state);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0 && node.plant.model.wheel_count == 2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_start_lockstep());
}

static void a_repeated_open_is_answered_again_but_not_carried_out_again(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    const laconic_frame frame = bench_open_frame(99, bench_hello());
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    bench_load(2);
    node.state = LACONIC_WIRE_STATE_LOCKSTEP;
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_COMMAND_OPEN, data[2]);
    TEST_ASSERT_EQUAL_UINT8(3, data[1] >> 4);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_LOCKSTEP, node.state);
    bench_open(100);
    laconic_node_on_frame(&node, &frame, now_us); /* of the session before */
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_RESULT, data));
}

static void a_command_that_comes_twice_acts_once_and_is_answered_twice(void) {
    const struct laconic_dbc_parameter_t mass = {.field = LACONIC_FIELD_MASS, .value = 5};
    uint8_t data[LACONIC_FRAME_BYTES], first[8];
    laconic_dbc_parameter_pack(data, &mass, 8);
    bench_send(LACONIC_WIRE_PARAMETER, data);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, first));
    bench_send_count(LACONIC_WIRE_PARAMETER, data, sent[LACONIC_WIRE_PARAMETER]);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_MEMORY(first + 2, data + 2, 6);
    TEST_ASSERT_EQUAL_UINT8(first[1] >> 4, data[1] >> 4);
    TEST_ASSERT_EQUAL_UINT16(1, node.loader.frame_count);
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.repeated);
}

/* Each kind of command keeps its own last answer. */
static void answers_do_not_overwrite_one_another(void) {
    uint8_t data[LACONIC_FRAME_BYTES] = {0};
    bench_load(2);
    bench_start_lockstep();
    bench_send(LACONIC_WIRE_COMMIT, data); /* refused: it runs */
    bench_sync(0);                         /* refused: no steps */
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data) && data[2] == LACONIC_WIRE_COMMAND_SYNC);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, data[3]);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data) && data[2] == LACONIC_WIRE_COMMAND_COMMIT);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, data[3]);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_RESULT, data));
}

static void the_first_motion_frame_after_start_and_after_a_wrong_one_is_for_reference_only(void) {
    const struct laconic_dbc_voltage_t volt = {.voltage_1 = 500};
    uint8_t data[LACONIC_FRAME_BYTES];
    laconic_dbc_voltage_pack(data, &volt, 8);
    bench_load(2);
    bench_start_lockstep();
    bench_send_count(LACONIC_WIRE_VOLTAGE, data, 1);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0);
    bench_send_count(LACONIC_WIRE_VOLTAGE, data, 2);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 1);
    laconic_frame spoilt = recorded(LACONIC_WIRE_VOLTAGE, data, bench_run_key, 3);
    spoilt.data[0] ^= 1;
    laconic_node_on_frame(&node, &spoilt, now_us);
    TEST_ASSERT_TRUE(node.session.deaf != 0);
    data[2] = 0;
    bench_send_count(LACONIC_WIRE_VOLTAGE, data, 3);
    TEST_ASSERT_TRUE(node.session.deaf == 0 && node.input[0].voltage_V[0] == 1);
    bench_send_count(LACONIC_WIRE_VOLTAGE, data, 4);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] != 1);
}

/* Two kinds of frames were wrong: one that is right again says nothing of the other. */
static void a_node_is_deaf_until_it_has_heard_all_that_it_had_not(void) {
    static const uint8_t offsets[] = {LACONIC_WIRE_VOLTAGE, LACONIC_WIRE_SYNC};
    uint8_t data[LACONIC_FRAME_BYTES] = {0};
    bench_load(2);
    bench_start_lockstep();
    for (size_t k = 0; k < 2; k++) {
        laconic_frame spoilt = recorded(offsets[k], data, bench_run_key, 1);
        spoilt.data[0] ^= 1;
        laconic_node_on_frame(&node, &spoilt, now_us);
    }
    bench_send_count(LACONIC_WIRE_SYNC, data, 1);
    TEST_ASSERT_TRUE(node.session.deaf != 0);
    bench_send_count(LACONIC_WIRE_VOLTAGE, data, 1);
    TEST_ASSERT_TRUE(node.session.deaf == 0);
}

static void nothing_but_start_brings_a_lost_count_back(void) {
    uint8_t data[LACONIC_FRAME_BYTES] = {0, 0, 100};
    bench_load(2);
    bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 0, 0);
    bench_voltage(0, 0, 0);
    for (uint32_t k = 0; k < 200; k++) bench_send_count(LACONIC_WIRE_VOLTAGE, data, 6 + k); /* three are missing */
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0 && node.session.deaf != 0);
    now_us += LACONIC_NODE_HEARTBEAT_US;
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_HEARTBEAT, data));
    TEST_ASSERT_EQUAL_HEX8(0x80, data[7] & 0x80U);
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 0, 0);
    bench_voltage(0, 500, 0);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 1 && node.session.deaf == 0);
}

static void in_free_run_two_lost_frames_are_forgiven_in_lockstep_none(void) {
    uint8_t data[LACONIC_FRAME_BYTES] = {0, 0, 100};
    bench_load(2);
    bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 0, 0);
    bench_voltage(0, 0, 0);
    bench_send_count(LACONIC_WIRE_VOLTAGE, data, 5); /* for reference */
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0 && node.counters.lost == 2);
    bench_send_count(LACONIC_WIRE_VOLTAGE, data, 6);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] != 0);
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    bench_start_lockstep();
    bench_voltage(0, 0, 0);
    bench_send_count(LACONIC_WIRE_VOLTAGE, data, 4);
    bench_send_count(LACONIC_WIRE_VOLTAGE, data, 5);
    TEST_ASSERT_TRUE(node.input[0].voltage_V[0] == 0);
}

/* CONTROL frames of another session, with any count: of 65,536 about one in 256 passes the CRC-8 by chance. */
static void stale_commands_pass_at_the_rate_of_their_crc(void) {
    const struct laconic_dbc_control_t begin = {.command = LACONIC_WIRE_COMMAND_BEGIN};
    uint8_t data[LACONIC_FRAME_BYTES];
    uint32_t passed = 0;
    laconic_dbc_control_pack(data, &begin, 8);
    for (uint32_t k = 0; k < 65536; k++) {
        laconic_node_config config = node.config;
        laconic_frame frame;
        if (k % 64 == 0) {
            laconic_node_init(&node, &config, next_random());
            bench_open(next_random());
        }
        const uint32_t counter = node.session.count[LACONIC_WIRE_CONTROL] + 1U; /* the one that is due */
        frame = recorded(LACONIC_WIRE_CONTROL, data, next_random(), counter + 16U * (next_random() & 255U));
        laconic_node_on_frame(&node, &frame, now_us);
        passed += bench_receive(LACONIC_WIRE_RESULT, data);
    }
    TEST_ASSERT_UINT32_WITHIN(4 * 16, 256, passed);
}

static void a_session_counts_from_the_beginning(void) {
    bench_load(2);
    for (int k = 0; k < 5; k++) TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0));
    node.session.armed = node.session.deaf = BIT_OF(LACONIC_WIRE_SYNC);
    TEST_ASSERT_EQUAL_UINT8(0, bench_open(8));
    TEST_ASSERT_TRUE(node.session.armed == 0 && node.session.deaf == 0);
    TEST_ASSERT_EQUAL_HEX32(laconic_run_key(node.session.key, 0), node.session.run_key);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0));
    TEST_ASSERT_EQUAL_UINT32(1, node.session.count[LACONIC_WIRE_CONTROL]);
}

static void the_next_nonce_is_mixed_of_the_last_the_session_and_the_time(void) {
    const uint32_t nonce = bench_hello();
    bench_open(99);
    TEST_ASSERT_EQUAL_HEX32(laconic_mix(99, nonce), node.session.key);
    TEST_ASSERT_EQUAL_HEX32(laconic_mix(laconic_mix(nonce, 99), now_us), bench_hello());
}

static void every_frame_is_counted_as_what_it_is(void) {
    uint8_t data[LACONIC_FRAME_BYTES] = {0};
    bench_load(2);
    bench_start_lockstep();
    laconic_node_counters before = node.counters;
    bench_voltage(0, 1, 0);
    TEST_ASSERT_EQUAL_UINT16(before.accepted + 2, node.counters.accepted);
    bench_send_count(LACONIC_WIRE_VOLTAGE, data, sent[LACONIC_WIRE_VOLTAGE]);
    TEST_ASSERT_EQUAL_UINT16(before.repeated + 1, node.counters.repeated);
    bench_send_count(LACONIC_WIRE_VOLTAGE, data, sent[LACONIC_WIRE_VOLTAGE] + 5);
    TEST_ASSERT_EQUAL_UINT16(before.sequence_errors + 1, node.counters.sequence_errors);
    TEST_ASSERT_EQUAL_UINT16(before.crc_errors, node.counters.crc_errors);
    bench_send_count(LACONIC_WIRE_SELECT, data, 0); /* the count before the first */
    TEST_ASSERT_EQUAL_UINT16(before.sequence_errors + 2, node.counters.sequence_errors);
    laconic_frame frame = recorded(LACONIC_WIRE_CONTROL, data, bench_key + 1U, sent[LACONIC_WIRE_CONTROL] + 1U);
    frame.data[0] ^= 1;
    laconic_node_on_frame(&node, &frame, now_us);
    before = node.counters;
    const laconic_frame open = bench_open_frame(77, bench_hello());
    laconic_node_on_frame(&node, &open, now_us);
    laconic_node_on_frame(&node, &open, now_us);
    TEST_ASSERT_EQUAL_UINT16(before.repeated + 1, node.counters.repeated);
    TEST_ASSERT_EQUAL_UINT16(before.accepted + 2, node.counters.accepted); /* HELLO and OPEN */
}

static void an_answer_repeats_all_four_bits_of_its_request(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    for (uint8_t k = 1; k <= 15; k++) {
        const struct laconic_dbc_control_t begin = {.command = LACONIC_WIRE_COMMAND_BEGIN};
        laconic_dbc_control_pack(data, &begin, 8);
        bench_send(LACONIC_WIRE_CONTROL, data);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
        TEST_ASSERT_EQUAL_UINT8(k, data[1] >> 4);
    }
}

/* Neither the right echo nor a right protection is enough by itself. */
static void an_open_needs_the_echo_and_its_protection(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    const uint32_t before = node.session.number, nonce = bench_hello();
    laconic_frame frame = bench_open_frame(0x77, nonce);
    frame.data[5] ^= 1U;
    laconic_node_on_frame(&node, &frame, now_us);
    const struct laconic_dbc_open_t other = {.nonce_echo = (uint16_t)(nonce + 1U), .session = 0x77};
    laconic_dbc_open_pack(frame.data, &other, 8);
    laconic_protect_keyed(LACONIC_WIRE_OPEN, frame.data, nonce, 3);
    laconic_node_on_frame(&node, &frame, now_us);
    frame = bench_open_frame(before, node.session.last_nonce + 1U); /* as if it were repeated */
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_HEX32(before, node.session.number);
    TEST_ASSERT_EQUAL_UINT16(3, node.counters.crc_errors);
}

static void a_run_begins_with_open_ears(void) {
    bench_load(2);
    node.session.deaf = BIT_OF(LACONIC_WIRE_SYNC);
    bench_start_lockstep();
    TEST_ASSERT_EQUAL_UINT32(0, node.session.deaf);
}

static void a_frame_of_the_nodes_own_is_malformed(void) {
    uint8_t payload[LACONIC_FRAME_BYTES] = {0};
    const laconic_frame frame = recorded(LACONIC_WIRE_RIG_OFFSETS, payload, bench_key, 1);
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_TRUE(node.counters.malformed == 1 && node.counters.refused == 0);
}

/* The session before, named otherwise: it has the nonce before, but is none that was opened. */
static void an_open_is_repeated_only_with_the_number_of_its_session(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    const uint32_t nonce = bench_hello();
    const laconic_frame open = bench_open_frame(99, nonce);
    laconic_node_on_frame(&node, &open, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    for (uint32_t number = 98; number <= 100; number += 2) {
        const uint16_t before = node.counters.crc_errors;
        const laconic_frame other = bench_open_frame(number, nonce);
        laconic_node_on_frame(&node, &other, now_us);
        TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_RESULT, data));
        TEST_ASSERT_EQUAL_UINT16(before + 1, node.counters.crc_errors);
    }
}

static void before_any_session_none_is_repeated(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    const laconic_node_config config = node.config;
    const laconic_frame nothing = bench_open_frame(0, 0);
    laconic_node_init(&node, &config, now_us);
    laconic_node_on_frame(&node, &nothing, now_us);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT16(1, node.counters.crc_errors);
}

static void an_echo_below_the_nonce_opens_nothing(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    const uint32_t nonce = bench_hello();
    const struct laconic_dbc_open_t below = {.nonce_echo = (uint16_t)((nonce & 0xFFFFU) / 2U), .session = 0x77};
    laconic_frame frame = bench_open_frame(0x77, nonce);
    laconic_dbc_open_pack(frame.data, &below, 8);
    laconic_protect_keyed(LACONIC_WIRE_OPEN, frame.data, nonce, 3);
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_RESULT, data));
}

/* A command behind a gap, or with a wrong checksum, is neither executed nor answered; the next in order is. */
static void commands_out_of_order_or_spoilt_are_counted_and_do_nothing(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    const struct laconic_dbc_control_t begin = {.command = LACONIC_WIRE_COMMAND_BEGIN};
    laconic_dbc_control_pack(data, &begin, 8);
    bench_send_count(LACONIC_WIRE_CONTROL, data, sent[LACONIC_WIRE_CONTROL] + 2U);
    bench_send_count(LACONIC_WIRE_CONTROL, data, sent[LACONIC_WIRE_CONTROL] + 15U);
    TEST_ASSERT_TRUE(node.counters.sequence_errors == 2 && node.counters.crc_errors == 0);
    laconic_frame spoilt = recorded(LACONIC_WIRE_CONTROL, data, bench_key, sent[LACONIC_WIRE_CONTROL] + 1U);
    spoilt.data[0] ^= 1;
    laconic_node_on_frame(&node, &spoilt, now_us);
    TEST_ASSERT_TRUE(node.counters.sequence_errors == 2 && node.counters.crc_errors == 1);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_BEGIN, 0, 0));
}

static void a_run_that_has_timed_out_forgives_no_gap(void) {
    const uint8_t data[LACONIC_FRAME_BYTES] = {0};
    bench_load(2);
    bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 0, 0);
    bench_voltage(0, 0, 0);
    node.state = LACONIC_WIRE_STATE_TIMEOUT;
    bench_send_count(LACONIC_WIRE_VOLTAGE, data, sent[LACONIC_WIRE_VOLTAGE] + 2U);
    TEST_ASSERT_TRUE(node.counters.sequence_errors == 1 && node.counters.lost == 0);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(hello_is_answered_at_any_time_and_changes_nothing);
    RUN_TEST(hello_drops_no_frame_that_waits);
    RUN_TEST(the_nonce_depends_on_seed_and_instant);
    RUN_TEST(without_a_session_nothing_is_accepted);
    RUN_TEST(a_new_session_finds_a_running_node_at_rest_with_its_vehicle);
    RUN_TEST(a_repeated_open_is_answered_again_but_not_carried_out_again);
    RUN_TEST(a_command_that_comes_twice_acts_once_and_is_answered_twice);
    RUN_TEST(answers_do_not_overwrite_one_another);
    RUN_TEST(the_first_motion_frame_after_start_and_after_a_wrong_one_is_for_reference_only);
    RUN_TEST(a_node_is_deaf_until_it_has_heard_all_that_it_had_not);
    RUN_TEST(nothing_but_start_brings_a_lost_count_back);
    RUN_TEST(in_free_run_two_lost_frames_are_forgiven_in_lockstep_none);
    RUN_TEST(stale_commands_pass_at_the_rate_of_their_crc);
    RUN_TEST(a_session_counts_from_the_beginning);
    RUN_TEST(the_next_nonce_is_mixed_of_the_last_the_session_and_the_time);
    RUN_TEST(every_frame_is_counted_as_what_it_is);
    RUN_TEST(an_answer_repeats_all_four_bits_of_its_request);
    RUN_TEST(an_open_needs_the_echo_and_its_protection);
    RUN_TEST(a_run_begins_with_open_ears);
    RUN_TEST(a_frame_of_the_nodes_own_is_malformed);
    RUN_TEST(an_open_is_repeated_only_with_the_number_of_its_session);
    RUN_TEST(before_any_session_none_is_repeated);
    RUN_TEST(an_echo_below_the_nonce_opens_nothing);
    RUN_TEST(commands_out_of_order_or_spoilt_are_counted_and_do_nothing);
    RUN_TEST(a_run_that_has_timed_out_forgives_no_gap);
    return UNITY_END();
}
