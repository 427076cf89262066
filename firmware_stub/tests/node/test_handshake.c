/* Tests of node_session.c and protection.c: what passes before a session is open, and the keys of its runs. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#include "bench.h"
#include "unity.h"

static uint8_t data[LACONIC_FRAME_BYTES];

void setUp(void) {
    bench_begin();
    memset(data, 0, sizeof data);
}
void tearDown(void) {}

/* A node that has answered one HELLO since it was powered up. */
static uint32_t greeted(void) {
    const laconic_node_config config = node.config;
    laconic_node_init(&node, &config, now_us);
    return bench_hello();
}

static void a_later_hello_leaves_the_nonce_of_a_handshake_that_goes_on(void) {
    const uint32_t nonce = greeted();
    now_us += 1000;
    TEST_ASSERT_EQUAL_HEX32(nonce, bench_hello());
    const laconic_frame open = bench_open_frame(9, nonce);
    laconic_node_on_frame(&node, &open, now_us);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
}

static void each_challenge_names_the_hello_that_it_answers(void) {
    greeted();
    for (uint8_t count = 1; count < 16; count += 7) {
        laconic_frame hello = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HELLO, .length = 8};
        struct laconic_dbc_challenge_t challenge = {0};
        laconic_protect_plain(LACONIC_WIRE_HELLO, hello.data, count);
        laconic_node_on_frame(&node, &hello, now_us);
        TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_CHALLENGE, data));
        laconic_dbc_challenge_unpack(&challenge, data, 8);
        TEST_ASSERT_EQUAL(count, challenge.request);
    }
}

/* The keys of a node whose session was never opened are zero, and so is the number of its session. */
static void a_nonce_opens_nothing_by_itself(void) {
    greeted();
    bench_key = 0;
    sent[LACONIC_WIRE_CONTROL] = 0;
    TEST_ASSERT_EQUAL_UINT8(255, bench_control(LACONIC_WIRE_COMMAND_BEGIN, 0, 0));
    const laconic_frame nothing = bench_open_frame(0, 0);
    laconic_node_on_frame(&node, &nothing, now_us);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_RESULT, data));
}

/* The numbers are those of mix(key, count + 32) in reference_client.py. */
static void a_run_has_a_key_of_its_session_and_its_start(void) {
    TEST_ASSERT_EQUAL_HEX32(0x511477A0U, laconic_run_key(0x12345678U, 1));
    TEST_ASSERT_EQUAL_HEX32(0x689BB163U, laconic_run_key(0x9ABCDEF0U, 7));
}

static void a_motion_frame_that_is_spoilt_is_counted_as_that(void) {
    bench_load(2);
    bench_start_lockstep();
    const uint16_t gaps = node.counters.sequence_errors, spoilt = node.counters.crc_errors;
    const struct laconic_dbc_sync_t sync = {.step_count = 1};
    laconic_dbc_sync_pack(data, &sync, 8);
    bench_run_key ^= 1U;
    bench_send_count(LACONIC_WIRE_SYNC, data, 1);
    TEST_ASSERT_TRUE(node.counters.sequence_errors == gaps && node.counters.crc_errors == spoilt + 1);
    bench_run_key ^= 1U;
    bench_send_count(LACONIC_WIRE_SYNC, data, 3);
    TEST_ASSERT_TRUE(node.counters.sequence_errors == gaps + 1 && node.counters.crc_errors == spoilt + 1);
}

static void a_new_session_has_open_ears(void) {
    node.session.deaf = BIT_OF(LACONIC_WIRE_SYNC);
    bench_open(12);
    TEST_ASSERT_EQUAL_HEX32(0, node.session.deaf);
}

/* One that is not right, before any HELLO. */
static void an_open_that_nobody_asked_for_opens_nothing(void) {
    const laconic_node_config config = node.config;
    laconic_node_init(&node, &config, now_us);
    const laconic_frame open = bench_open_frame(9, 0x12345678U);
    laconic_node_on_frame(&node, &open, now_us);
    TEST_ASSERT_FALSE(node.session.open);
    TEST_ASSERT_TRUE(node.counters.crc_errors == 1 && node.counters.accepted == 0);
}

static void a_command_with_a_wrong_key_is_not_executed_before_a_session_either(void) {
    const laconic_node_config config = node.config;
    laconic_node_init(&node, &config, now_us);
    bench_send_count(LACONIC_WIRE_CONTROL, data, 1);
    TEST_ASSERT_TRUE(node.counters.crc_errors == 1 && node.counters.accepted == 0);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(each_challenge_names_the_hello_that_it_answers);
    RUN_TEST(a_later_hello_leaves_the_nonce_of_a_handshake_that_goes_on);
    RUN_TEST(a_nonce_opens_nothing_by_itself);
    RUN_TEST(a_run_has_a_key_of_its_session_and_its_start);
    RUN_TEST(a_motion_frame_that_is_spoilt_is_counted_as_that);
    RUN_TEST(a_new_session_has_open_ears);
    RUN_TEST(an_open_that_nobody_asked_for_opens_nothing);
    RUN_TEST(a_command_with_a_wrong_key_is_not_executed_before_a_session_either);
    return UNITY_END();
}
