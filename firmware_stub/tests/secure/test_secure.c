/* Codes of messages: vectors of RFC 4493, SP 800-38B and FIPS 197; what SecOC's receiver refuses, by name; and a gate
 * before a node, through which only the key's holder commands. */
#include "laconic_secure/gate.h"

#include "laconic_wire.h"
#include "unity.h"

#include <string.h>

static const uint8_t key_bytes[16] = {0x2b, 0x7e, 0x15, 0x16, 0x28, 0xae, 0xd2, 0xa6,
                                      0xab, 0xf7, 0x15, 0x88, 0x09, 0xcf, 0x4f, 0x3c};
static const uint8_t other_bytes[16] = {1};
static laconic_cmac_key key;

void setUp(void) { laconic_cmac_key_of(&key, key_bytes); }
void tearDown(void) {}

static void aes_of_FIPS_197(void) {
    static const uint8_t wanted[16] = {0x39, 0x25, 0x84, 0x1d, 0x02, 0xdc, 0x09, 0xfb,
                                       0xdc, 0x11, 0x85, 0x97, 0x19, 0x6a, 0x0b, 0x32};
    uint8_t block[16] = {0x32, 0x43, 0xf6, 0xa8, 0x88, 0x5a, 0x30, 0x8d,
                         0x31, 0x31, 0x98, 0xa2, 0xe0, 0x37, 0x07, 0x34};
    laconic_aes_encrypt(&key.aes, block);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(wanted, block, 16);
}

/* RFC 4493, section 4, which are the examples of SP 800-38B for AES-128. */
static void cmac_of_RFC_4493(void) {
    static const uint8_t message[64] = {0x6b, 0xc1, 0xbe, 0xe2, 0x2e, 0x40, 0x9f, 0x96, 0xe9, 0x3d, 0x7e, 0x11, 0x73,
                                        0x93, 0x17, 0x2a, 0xae, 0x2d, 0x8a, 0x57, 0x1e, 0x03, 0xac, 0x9c, 0x9e, 0xb7,
                                        0x6f, 0xac, 0x45, 0xaf, 0x8e, 0x51, 0x30, 0xc8, 0x1c, 0x46, 0xa3, 0x5c, 0xe4,
                                        0x11, 0xe5, 0xfb, 0xc1, 0x19, 0x1a, 0x0a, 0x52, 0xef, 0xf6, 0x9f, 0x24, 0x45,
                                        0xdf, 0x4f, 0x9b, 0x17, 0xad, 0x2b, 0x41, 0x7b, 0xe6, 0x6c, 0x37, 0x10};
    static const size_t length[4] = {0, 16, 40, 64};
    static const uint8_t wanted[4][16] = {
        {0xbb, 0x1d, 0x69, 0x29, 0xe9, 0x59, 0x37, 0x28, 0x7f, 0xa3, 0x7d, 0x12, 0x9b, 0x75, 0x67, 0x46},
        {0x07, 0x0a, 0x16, 0xb4, 0x6b, 0x4d, 0x41, 0x44, 0xf7, 0x9b, 0xdd, 0x9d, 0xd0, 0x4a, 0x28, 0x7c},
        {0xdf, 0xa6, 0x67, 0x47, 0xde, 0x9a, 0xe6, 0x30, 0x30, 0xca, 0x32, 0x61, 0x14, 0x97, 0xc8, 0x27},
        {0x51, 0xf0, 0xbe, 0xbf, 0x7e, 0x3b, 0x9d, 0x92, 0xfc, 0x49, 0x74, 0x17, 0x79, 0x36, 0x3c, 0xfe}};
    for (int k = 0; k < 4; k++) {
        uint8_t mac[16];
        laconic_cmac(&key, message, length[k], mac);
        TEST_ASSERT_EQUAL_HEX8_ARRAY(wanted[k], mac, 16);
    }
}

static void bytes_are_the_same_or_not(void) {
    uint8_t a[4] = {1, 2, 3, 4}, b[4] = {1, 2, 3, 4};
    TEST_ASSERT_TRUE(laconic_same_bytes(a, b, 4));
    for (int k = 0; k < 4; k++) {
        b[k] ^= 0x80;
        TEST_ASSERT_FALSE(laconic_same_bytes(a, b, 4));
        TEST_ASSERT_TRUE(laconic_same_bytes(a, b, (size_t)k));
        b[k] ^= 0x80;
    }
}

/* ----------------------------------------------------------------------------------------- SecOC -- */

enum { NUMBER = 0x123, LENGTH = 4 };
static const uint8_t payload[LENGTH] = {9, 8, 7, 6};

static laconic_secoc_status opened(uint64_t *last, uint64_t freshness, const uint8_t *bytes) {
    uint8_t trailer[1 + LACONIC_SECOC_CLASSIC];
    laconic_secoc_seal(&key, NUMBER, freshness, payload, LENGTH, trailer, LACONIC_SECOC_CLASSIC);
    TEST_ASSERT_EQUAL_HEX8((uint8_t)freshness, trailer[0]);
    return laconic_secoc_open(&key, NUMBER, last, bytes, LENGTH, trailer, LACONIC_SECOC_CLASSIC);
}

static void the_next_message_is_accepted_over_every_carry(void) {
    uint64_t last = 0xFFFFFF00U;
    for (uint64_t freshness = last + 1; freshness < 0x100000200U; freshness += 1 + freshness % 255) {
        TEST_ASSERT_EQUAL(LACONIC_SECOC_OK, opened(&last, freshness, payload));
        TEST_ASSERT_EQUAL_UINT64(freshness, last);
    }
}

static void refusals_have_names_and_change_nothing(void) {
    static const uint8_t changed[LENGTH] = {9, 8, 7, 7};
    uint64_t last = 1000;
    TEST_ASSERT_EQUAL(LACONIC_SECOC_REPLAYED, opened(&last, 1000, payload));
    TEST_ASSERT_EQUAL(LACONIC_SECOC_OLD, opened(&last, 999, payload));
    TEST_ASSERT_EQUAL(LACONIC_SECOC_OLD, opened(&last, 745, payload));
    TEST_ASSERT_EQUAL(LACONIC_SECOC_WRONG_CODE, opened(&last, 744, payload));
    TEST_ASSERT_EQUAL(LACONIC_SECOC_OK, opened(&last, 1256, payload)); /* 255 messages are missing */
    last = 1000;
    TEST_ASSERT_EQUAL(LACONIC_SECOC_WRONG_CODE, opened(&last, 1257, payload));
    TEST_ASSERT_EQUAL(LACONIC_SECOC_WRONG_CODE, opened(&last, 1001, changed));
    TEST_ASSERT_EQUAL_UINT64(1000, last);
    laconic_cmac_key_of(&key, other_bytes);
    uint8_t trailer[1 + LACONIC_SECOC_CLASSIC];
    laconic_secoc_seal(&key, NUMBER, 1001, payload, LENGTH, trailer, LACONIC_SECOC_CLASSIC);
    laconic_cmac_key_of(&key, key_bytes);
    TEST_ASSERT_EQUAL(LACONIC_SECOC_WRONG_CODE,
                      laconic_secoc_open(&key, NUMBER, &last, payload, LENGTH, trailer, LACONIC_SECOC_CLASSIC));
    TEST_ASSERT_EQUAL_STRING("replayed message", laconic_secoc_text(LACONIC_SECOC_REPLAYED));
    TEST_ASSERT_EQUAL_STRING("unknown", laconic_secoc_text(LACONIC_SECOC_STATUSES));
}

/* AUTOSAR SecOC: the code is of the number, the payload and the whole freshness, each with its highest byte first. */
static void the_code_is_of_every_byte(void) {
    static const uint8_t message[] = {0x01, 0x23, 9, 8, 7, 6, 0x01, 0x23, 0x45, 0x67, 0x89, 0xAB, 0xCD, 0xEF};
    uint8_t mac[LACONIC_AES_BYTES], trailer[1 + LACONIC_SECOC_FD];
    laconic_cmac(&key, message, sizeof message, mac);
    laconic_secoc_seal(&key, NUMBER, 0x0123456789ABCDEFU, payload, LENGTH, trailer, LACONIC_SECOC_FD);
    TEST_ASSERT_EQUAL_HEX8(0xEF, trailer[0]);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(mac, trailer + 1, LACONIC_SECOC_FD);
}

static void the_first_message_of_all_is_number_1(void) {
    uint64_t last = 0;
    TEST_ASSERT_EQUAL(LACONIC_SECOC_REPLAYED, opened(&last, 0, payload));
    TEST_ASSERT_EQUAL(LACONIC_SECOC_OK, opened(&last, 1, payload));
    last = UINT64_MAX; /* freshness is used up */
    TEST_ASSERT_EQUAL(LACONIC_SECOC_WRONG_CODE, opened(&last, 0, payload));
    TEST_ASSERT_EQUAL_UINT64(UINT64_MAX, last);
}

static void the_longest_payload_of_FD(void) {
    uint8_t bytes[LACONIC_SECOC_LONGEST] = {0}, trailer[1 + LACONIC_SECOC_FD];
    uint64_t last = 4;
    laconic_secoc_seal(&key, NUMBER, 5, bytes, sizeof bytes, trailer, LACONIC_SECOC_FD);
    bytes[63] = 1;
    TEST_ASSERT_EQUAL(LACONIC_SECOC_WRONG_CODE,
                      laconic_secoc_open(&key, NUMBER, &last, bytes, sizeof bytes, trailer, LACONIC_SECOC_FD));
    bytes[63] = 0;
    TEST_ASSERT_EQUAL(LACONIC_SECOC_OK,
                      laconic_secoc_open(&key, NUMBER, &last, bytes, sizeof bytes, trailer, LACONIC_SECOC_FD));
}

/* ------------------------------------------------------------------------------------------ gate -- */

static laconic_gate gate, rig;
static laconic_frame out;

static laconic_frame frame_of(uint8_t offset, uint8_t first) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + (uint32_t)offset, .length = 8};
    frame.data[2] = first;
    return frame;
}

/* Both ends, after a CHALLENGE with this nonce. */
static void begin(uint8_t nonce) {
    const laconic_frame challenge = frame_of(LACONIC_WIRE_CHALLENGE, nonce);
    laconic_gate_init(&gate, LACONIC_WIRE_ID_BASE, key_bytes);
    laconic_gate_init(&rig, LACONIC_WIRE_ID_BASE, key_bytes);
    laconic_gate_sent(&gate, &challenge);
    laconic_gate_sent(&rig, &challenge);
}

static bool passes(const laconic_frame *frame, const laconic_frame *code) {
    TEST_ASSERT_FALSE(laconic_gate_take(&gate, frame, &out));
    return laconic_gate_take(&gate, code, &out);
}

static void frames_pass_with_their_code(void) {
    laconic_frame code;
    begin(7);
    for (int k = 0; k < 600; k++) {
        const laconic_frame control = frame_of(LACONIC_WIRE_CONTROL, (uint8_t)k);
        TEST_ASSERT_TRUE(laconic_gate_seal(&rig, &control, &code));
        TEST_ASSERT_TRUE(passes(&control, &code));
        TEST_ASSERT_EQUAL_MEMORY(&control, &out, sizeof out);
    }
    TEST_ASSERT_EQUAL(600, gate.refused[LACONIC_SECOC_OK]);
}

static void what_commands_nothing_needs_no_code(void) {
    const laconic_frame hello = frame_of(LACONIC_WIRE_HELLO, 1);
    laconic_frame code, drive = hello, extended = frame_of(LACONIC_WIRE_CONTROL, 0);
    begin(7);
    drive.id = 5;
    extended.extended = true;
    TEST_ASSERT_FALSE(laconic_gate_seal(&rig, &hello, &code));
    TEST_ASSERT_TRUE(laconic_gate_take(&gate, &hello, &out));
    TEST_ASSERT_TRUE(laconic_gate_take(&gate, &drive, &out));
    TEST_ASSERT_TRUE(laconic_gate_take(&gate, &extended, &out));
}

static void what_is_wrong_is_counted_by_name(void) {
    const laconic_frame control = frame_of(LACONIC_WIRE_CONTROL, 1), sync = frame_of(LACONIC_WIRE_SYNC, 1);
    laconic_frame first, second, code;
    begin(7);
    laconic_gate_seal(&rig, &control, &first);
    laconic_gate_seal(&rig, &control, &second);
    TEST_ASSERT_TRUE(passes(&control, &second));
    TEST_ASSERT_FALSE(passes(&control, &second));
    TEST_ASSERT_EQUAL(1, gate.refused[LACONIC_SECOC_REPLAYED]);
    TEST_ASSERT_FALSE(passes(&control, &first));
    TEST_ASSERT_EQUAL(1, gate.refused[LACONIC_SECOC_OLD]);
    laconic_cmac_key_of(&rig.key, other_bytes);
    laconic_gate_seal(&rig, &control, &code);
    TEST_ASSERT_FALSE(passes(&control, &code));
    TEST_ASSERT_EQUAL(1, gate.refused[LACONIC_SECOC_WRONG_CODE]);
    TEST_ASSERT_FALSE(laconic_gate_take(&gate, &code, &out)); /* nothing waits */
    TEST_ASSERT_FALSE(laconic_gate_take(&gate, &control, &out));
    TEST_ASSERT_FALSE(laconic_gate_take(&gate, &sync, &out)); /* the one before it came without a code */
    TEST_ASSERT_FALSE(laconic_gate_take(&gate, &code, &out)); /* that of another frame */
    TEST_ASSERT_EQUAL(3, gate.bare);
}

static void a_recording_of_an_earlier_power_up_does_not_pass(void) {
    const laconic_frame control = frame_of(LACONIC_WIRE_CONTROL, 1);
    laconic_frame code;
    begin(7);
    laconic_gate_seal(&rig, &control, &code);
    TEST_ASSERT_TRUE(passes(&control, &code));
    begin(8);
    TEST_ASSERT_FALSE(passes(&control, &code));
    TEST_ASSERT_EQUAL(1, gate.refused[LACONIC_SECOC_WRONG_CODE]);
}

/* The node ignores remote frames; a frame of the node itself, heard by the gate, is none of the rig's. */
static void frames_of_the_node_and_requests_for_data_need_no_code(void) {
    laconic_frame code, answer = frame_of(LACONIC_WIRE_RIG_OFFSETS, 0), request = frame_of(LACONIC_WIRE_CONTROL, 0);
    begin(7);
    request.remote = true;
    TEST_ASSERT_TRUE(laconic_gate_take(&gate, &answer, &out));
    TEST_ASSERT_EQUAL_MEMORY(&answer, &out, sizeof out);
    TEST_ASSERT_TRUE(laconic_gate_take(&gate, &request, &out));
    TEST_ASSERT_FALSE(laconic_gate_seal(&rig, &answer, &code));
    TEST_ASSERT_FALSE(laconic_gate_seal(&rig, &request, &code));
    TEST_ASSERT_EQUAL_UINT64((uint64_t)7 << 32, rig.freshness);
}

/* Its identifier lies among the node's, yet it moves the vehicle. */
static void a_steering_frame_waits_for_its_code(void) {
    const laconic_frame steering = frame_of(LACONIC_WIRE_STEERING, 1);
    laconic_frame code;
    begin(7);
    TEST_ASSERT_FALSE(laconic_gate_take(&gate, &steering, &out));
    begin(7);
    TEST_ASSERT_TRUE(laconic_gate_seal(&rig, &steering, &code));
    TEST_ASSERT_TRUE(passes(&steering, &code));
}

static void frames_of_others_get_no_code(void) {
    laconic_frame code, drive = frame_of(LACONIC_WIRE_CONTROL, 0), extended = drive;
    begin(7);
    drive.id = 5;
    extended.extended = true;
    TEST_ASSERT_FALSE(laconic_gate_seal(&rig, &drive, &code));
    TEST_ASSERT_FALSE(laconic_gate_seal(&rig, &extended, &code));
    TEST_ASSERT_EQUAL_UINT64((uint64_t)7 << 32, rig.freshness);
}

static void a_code_of_another_length_ends_the_wait(void) {
    const laconic_frame control = frame_of(LACONIC_WIRE_CONTROL, 1);
    laconic_frame code, cut;
    begin(7);
    laconic_gate_seal(&rig, &control, &code);
    cut = code;
    cut.length = 7;
    TEST_ASSERT_FALSE(passes(&control, &cut));
    TEST_ASSERT_FALSE(laconic_gate_take(&gate, &code, &out));
    TEST_ASSERT_EQUAL(2, gate.bare);
}

/* A CHALLENGE begins a new freshness only by a new nonce: else whoever makes the node repeat it could replay. */
static void only_a_new_challenge_begins_a_new_freshness(void) {
    const laconic_frame control = frame_of(LACONIC_WIRE_CONTROL, 1);
    laconic_frame code, sent = frame_of(LACONIC_WIRE_CHALLENGE, 7);
    begin(7);
    laconic_gate_seal(&rig, &control, &code);
    TEST_ASSERT_TRUE(passes(&control, &code));
    laconic_gate_sent(&gate, &sent);
    TEST_ASSERT_FALSE(passes(&control, &code));
    TEST_ASSERT_EQUAL(1, gate.refused[LACONIC_SECOC_REPLAYED]);
    sent = frame_of(LACONIC_WIRE_CHALLENGE, 8);
    sent.extended = true;
    laconic_gate_sent(&gate, &sent);
    sent = frame_of(LACONIC_WIRE_CHALLENGE, 8);
    sent.length = 7;
    laconic_gate_sent(&gate, &sent);
    sent = frame_of(LACONIC_WIRE_CHALLENGE - 1, 8);
    laconic_gate_sent(&gate, &sent);
    TEST_ASSERT_EQUAL_UINT64(((uint64_t)7 << 32) + 1, gate.freshness);
    sent = frame_of(LACONIC_WIRE_CHALLENGE, 8);
    laconic_gate_sent(&gate, &sent);
    TEST_ASSERT_EQUAL_UINT64((uint64_t)8 << 32, gate.freshness);
}

static void the_freshness_begins_with_all_four_bytes_of_the_nonce(void) {
    laconic_frame sent = frame_of(LACONIC_WIRE_CHALLENGE, 0x78);
    sent.data[3] = 0x56;
    sent.data[4] = 0x34;
    sent.data[5] = 0x12;
    laconic_gate_init(&gate, LACONIC_WIRE_ID_BASE, key_bytes);
    laconic_gate_sent(&gate, &sent);
    TEST_ASSERT_EQUAL_UINT64((uint64_t)0x12345678U << 32, gate.freshness);
}

/* Both ends stand before the last count of their nonce; further, the count would become another nonce. */
static void at_the_end_of_the_count_nothing_is_sealed_and_nothing_passes(void) {
    const laconic_frame control = frame_of(LACONIC_WIRE_CONTROL, 1), sent = frame_of(LACONIC_WIRE_CHALLENGE, 7);
    laconic_frame recorded, code;
    begin(7);
    laconic_gate_seal(&rig, &control, &recorded);
    TEST_ASSERT_TRUE(passes(&control, &recorded));
    gate.freshness = rig.freshness = ((uint64_t)7 << 32) + 0xFFFFFFFEU;
    TEST_ASSERT_FALSE(laconic_gate_is_spent(&rig, &control));
    TEST_ASSERT_TRUE(laconic_gate_seal(&rig, &control, &code));
    TEST_ASSERT_TRUE(passes(&control, &code));
    TEST_ASSERT_FALSE(laconic_gate_seal(&rig, &control, &code));
    TEST_ASSERT_TRUE(laconic_gate_is_spent(&rig, &control));
    rig.freshness = (uint64_t)8 << 32; /* of a rig that counts on */
    laconic_gate_seal(&rig, &control, &code);
    TEST_ASSERT_FALSE(passes(&control, &code));
    TEST_ASSERT_EQUAL(1, gate.refused[LACONIC_SECOC_SPENT]);
    TEST_ASSERT_EQUAL_STRING("freshness used up", laconic_secoc_text(LACONIC_SECOC_SPENT));
    laconic_gate_sent(&gate, &sent); /* the same nonce again */
    TEST_ASSERT_FALSE(passes(&control, &recorded));
    TEST_ASSERT_EQUAL_UINT64(((uint64_t)7 << 32) + 0xFFFFFFFFU, gate.freshness);
}

static void a_new_challenge_gives_new_codes(void) {
    const laconic_frame control = frame_of(LACONIC_WIRE_CONTROL, 1), sent = frame_of(LACONIC_WIRE_CHALLENGE, 8);
    laconic_frame code;
    begin(7);
    gate.freshness = rig.freshness = ((uint64_t)7 << 32) + 0xFFFFFFFFU;
    laconic_gate_sent(&gate, &sent);
    laconic_gate_sent(&rig, &sent);
    TEST_ASSERT_TRUE(laconic_gate_seal(&rig, &control, &code));
    TEST_ASSERT_TRUE(passes(&control, &code));
}

static void frames_that_need_no_code_are_not_spent(void) {
    const laconic_frame hello = frame_of(LACONIC_WIRE_HELLO, 1), answer = frame_of(LACONIC_WIRE_RESULT, 1);
    laconic_frame drive = frame_of(LACONIC_WIRE_CONTROL, 0);
    drive.id = 5;
    begin(7);
    rig.freshness = ((uint64_t)7 << 32) + 0xFFFFFFFFU;
    TEST_ASSERT_FALSE(laconic_gate_is_spent(&rig, &hello));
    TEST_ASSERT_FALSE(laconic_gate_is_spent(&rig, &answer));
    TEST_ASSERT_FALSE(laconic_gate_is_spent(&rig, &drive));
}

static void only_frames_of_a_possible_length_are_sealed(void) {
    laconic_frame code;
    begin(7);
    for (unsigned length = 0; length < 256; length++) {
        laconic_frame frame = frame_of(LACONIC_WIRE_CONTROL, 0);
        frame.length = (uint8_t)length;
        TEST_ASSERT_EQUAL(length <= 8, laconic_gate_seal(&rig, &frame, &code));
        TEST_ASSERT_FALSE(laconic_gate_take(&gate, &frame, &out));
        TEST_ASSERT_EQUAL(length <= 8, gate.waits);
        frame.fd = true;
        TEST_ASSERT_EQUAL(length <= LACONIC_FRAME_BYTES, laconic_gate_seal(&rig, &frame, &code));
    }
}

static void payloads_and_codes_that_are_too_long_have_no_code(void) {
    static const uint8_t longer[LACONIC_SECOC_LONGEST + 1] = {0};
    uint8_t trailer[1 + LACONIC_AES_BYTES + 1];
    uint64_t last = 0;
    memset(trailer, 0xA5, sizeof trailer);
    TEST_ASSERT_FALSE(laconic_secoc_seal(&key, NUMBER, 1, longer, sizeof longer, trailer, LACONIC_SECOC_FD));
    TEST_ASSERT_FALSE(laconic_secoc_seal(&key, NUMBER, 1, longer, 8, trailer, LACONIC_AES_BYTES + 1));
    TEST_ASSERT_EACH_EQUAL_HEX8(0xA5, trailer, sizeof trailer);
    TEST_ASSERT_EQUAL(LACONIC_SECOC_WRONG_CODE,
                      laconic_secoc_open(&key, NUMBER, &last, longer, sizeof longer, trailer, LACONIC_SECOC_FD));
    TEST_ASSERT_EQUAL(LACONIC_SECOC_WRONG_CODE,
                      laconic_secoc_open(&key, NUMBER, &last, longer, 8, trailer, LACONIC_AES_BYTES + 1));
    TEST_ASSERT_TRUE(laconic_secoc_seal(&key, NUMBER, 1, longer, 64, trailer, LACONIC_AES_BYTES));
    TEST_ASSERT_EQUAL(LACONIC_SECOC_OK,
                      laconic_secoc_open(&key, NUMBER, &last, longer, 64, trailer, LACONIC_AES_BYTES));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(aes_of_FIPS_197);
    RUN_TEST(cmac_of_RFC_4493);
    RUN_TEST(bytes_are_the_same_or_not);
    RUN_TEST(the_next_message_is_accepted_over_every_carry);
    RUN_TEST(refusals_have_names_and_change_nothing);
    RUN_TEST(the_code_is_of_every_byte);
    RUN_TEST(the_first_message_of_all_is_number_1);
    RUN_TEST(the_longest_payload_of_FD);
    RUN_TEST(frames_pass_with_their_code);
    RUN_TEST(what_commands_nothing_needs_no_code);
    RUN_TEST(what_is_wrong_is_counted_by_name);
    RUN_TEST(a_recording_of_an_earlier_power_up_does_not_pass);
    RUN_TEST(frames_of_the_node_and_requests_for_data_need_no_code);
    RUN_TEST(a_steering_frame_waits_for_its_code);
    RUN_TEST(frames_of_others_get_no_code);
    RUN_TEST(a_code_of_another_length_ends_the_wait);
    RUN_TEST(only_a_new_challenge_begins_a_new_freshness);
    RUN_TEST(the_freshness_begins_with_all_four_bytes_of_the_nonce);
    RUN_TEST(at_the_end_of_the_count_nothing_is_sealed_and_nothing_passes);
    RUN_TEST(a_new_challenge_gives_new_codes);
    RUN_TEST(frames_that_need_no_code_are_not_spent);
    RUN_TEST(only_frames_of_a_possible_length_are_sealed);
    RUN_TEST(payloads_and_codes_that_are_too_long_have_no_code);
    return UNITY_END();
}
