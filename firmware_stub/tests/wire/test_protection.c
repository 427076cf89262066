/* Tests of protection.c: a frame is right only with its key and its count. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#include "bench.h"
#include "laconic_node/crc.h"
#include "laconic_node/protection.h"
#include "laconic_wire.h"
#include "unity.h"

#include <stdbool.h>
#include <string.h>

/* The vectors come from an independent implementation in Python. */
static void the_mixing_function_gives_its_test_vectors(void) {
    TEST_ASSERT_EQUAL_HEX32(0x42F6FD56U, laconic_mix(0, 0));
    TEST_ASSERT_EQUAL_HEX32(0x21E3D16FU, laconic_mix(1, 2));
    TEST_ASSERT_EQUAL_HEX32(0xA7F1CA87U, laconic_mix(0xDEADBEEFU, 0xCAFEF00DU));
}

static void every_bit_of_both_sides_flips_about_half_of_the_result(void) {
    uint32_t flipped[64] = {0};
    for (uint32_t k = 0; k < 4096; k++) {
        const uint32_t a = k * 0x9E3779B9U;
        const uint32_t b = ~k * 0x85EBCA6BU;
        for (int bit = 0; bit < 64; bit++) {
            const uint32_t other = bit < 32 ? laconic_mix(a ^ 1U << bit, b) : laconic_mix(a, b ^ 1U << (bit - 32));
            flipped[bit] += (uint32_t)__builtin_popcount(laconic_mix(a, b) ^ other);
        }
    }
    for (int bit = 0; bit < 64; bit++) TEST_ASSERT_UINT32_WITHIN(4096 / 4, 4096 * 16, flipped[bit]);
}

/* Frames whose counts differ by a multiple of 16 (FD: 256) have the same counter. */
static void a_frame_passes_with_its_own_key_and_count_only(void) {
    uint8_t data[LACONIC_WIRE_OFFSETS * 2] = {1, 2, 3, 4, 5, 6, 7, 8};
    uint32_t classic = 0, fd = 0;
    laconic_protect_keyed(LACONIC_WIRE_VOLTAGE, data, 77, 1000);
    TEST_ASSERT_EQUAL_UINT8(1000 & 15, laconic_counter_of(LACONIC_WIRE_VOLTAGE, data));
    TEST_ASSERT_TRUE(laconic_keyed_is_right(LACONIC_WIRE_VOLTAGE, data, 77, 1000));
    for (uint32_t k = 1; k <= 65536; k++) {
        classic += laconic_keyed_is_right(LACONIC_WIRE_VOLTAGE, data, 77 + k, 1000);
        classic += laconic_keyed_is_right(LACONIC_WIRE_VOLTAGE, data, 77, 1000 + 16 * k);
    }
    TEST_ASSERT_UINT32_WITHIN(4 * 23, 2 * 65536 / 256, classic); /* four standard deviations */
    uint8_t long_data[64] = {0};
    laconic_protect_keyed(LACONIC_WIRE_RAW_INPUT_FD, long_data, 77, 1000);
    TEST_ASSERT_TRUE(laconic_keyed_is_right(LACONIC_WIRE_RAW_INPUT_FD, long_data, 77, 1000));
    for (uint32_t k = 1; k <= 1U << 18; k++)
        fd += laconic_keyed_is_right(LACONIC_WIRE_RAW_INPUT_FD, long_data, 77 + k, 1000);
    TEST_ASSERT_UINT32_WITHIN(8, 4, fd);
}

static void a_plain_frame_is_that_of_the_profile(void) {
    uint8_t data[8] = {0};
    laconic_protect_plain(LACONIC_WIRE_HELLO, data, 5);
    TEST_ASSERT_EQUAL_UINT8(5, data[1]);
    TEST_ASSERT_TRUE(laconic_plain_is_right(LACONIC_WIRE_HELLO, data));
    data[7] ^= 1;
    TEST_ASSERT_FALSE(laconic_plain_is_right(LACONIC_WIRE_HELLO, data));
}

/* A node counts what it sends in eight bits. */
static void of_the_count_of_a_classic_plain_frame_four_bits_matter(void) {
    static const uint8_t offsets[] = {LACONIC_WIRE_HELLO, LACONIC_WIRE_RESULT, LACONIC_WIRE_NU};
    for (size_t k = 0; k < sizeof offsets; k++)
        for (uint32_t counter = 16; counter <= 255; counter++) {
            uint8_t first[8] = {0, 0x30, 2, 3, 4, 5, 6, 7}, data[8] = {0, 0x30, 2, 3, 4, 5, 6, 7};
            laconic_protect_plain(offsets[k], first, (uint8_t)(counter & 15U));
            laconic_protect_plain(offsets[k], data, (uint8_t)counter);
            TEST_ASSERT_EQUAL_HEX8_ARRAY(first, data, 8);
            TEST_ASSERT_TRUE(laconic_plain_is_right(offsets[k], data));
        }
}

/* The first bytes come from firmware_stub/reference_client.py, an independent implementation. */
static void keyed_frames_are_those_of_the_reference_client(void) {
    static const uint8_t crc[3] = {0xDB, 0x2E, 0x01};
    static const uint32_t counts[3] = {1000, 1001, 7};
    for (int k = 0; k < 3; k++) {
        uint8_t data[8] = {0, 0x30, 2, 3, 4, 5, 6, 7};
        laconic_protect_keyed(LACONIC_WIRE_VOLTAGE, data, 77, counts[k]);
        TEST_ASSERT_EQUAL_HEX8(crc[k], data[0]);
        TEST_ASSERT_EQUAL_HEX8(0x30U | (counts[k] & 15U), data[1]);
    }
    uint8_t control[8] = {0, 0, 2, 3, 4, 5, 6, 7};
    laconic_protect_keyed(LACONIC_WIRE_CONTROL, control, 0xDEADBEEFU, 5);
    TEST_ASSERT_EQUAL_HEX8(0x1B, control[0]);
}

static void frames_of_can_fd_are_those_of_the_reference_client(void) {
    uint8_t raw[64], state[64];
    for (uint8_t k = 0; k < 64; k++) raw[k] = state[k] = k;
    laconic_protect_keyed(LACONIC_WIRE_RAW_INPUT_FD, raw, 77, 1000);
    TEST_ASSERT_TRUE(raw[0] == 0xC2 && raw[1] == 0x4C && raw[2] == 0xE8);
    laconic_protect_plain(LACONIC_WIRE_STATE_FD, state, 200);
    TEST_ASSERT_TRUE(state[0] == 0x94 && state[1] == 0xC9 && state[2] == 200);
    TEST_ASSERT_EQUAL_UINT8(200, laconic_counter_of(LACONIC_WIRE_STATE_FD, state));
    uint8_t voltage[48];
    for (uint8_t k = 0; k < 48; k++) voltage[k] = k;
    laconic_protect_keyed(LACONIC_WIRE_VOLTAGE_FD, voltage, 0xDEADBEEFU, 513);
    TEST_ASSERT_TRUE(voltage[0] == 0xDC && voltage[1] == 0x94 && voltage[2] == 1);
}

static void a_plain_frame_is_that_of_the_reference_client(void) {
    uint8_t data[8] = {0, 0, 2, 3, 4, 5, 6, 7};
    laconic_protect_plain(LACONIC_WIRE_HELLO, data, 9);
    TEST_ASSERT_TRUE(data[0] == 0xBE && data[1] == 9);
}

static void the_key_of_a_run_is_mixed_with_the_count_of_its_start(void) {
    TEST_ASSERT_EQUAL_HEX32(0xF6B1738DU, laconic_run_key(5, 5));
}

/* Of the node's own frames, too, each with the list of its own kind. */
static void plain_frames_of_the_node_are_those_of_the_reference_client(void) {
    uint8_t result[8] = {0, 0x30, 2, 3, 4, 5, 6, 7}, nu[8] = {0, 0x30, 2, 3, 4, 5, 6, 7};
    laconic_protect_plain(LACONIC_WIRE_RESULT, result, 6);
    TEST_ASSERT_TRUE(result[0] == 0xEC && result[1] == 0x36);
    laconic_protect_plain(LACONIC_WIRE_NU, nu, 15);
    TEST_ASSERT_TRUE(nu[0] == 0x43 && nu[1] == 0x3F);
}

/* A build without CAN FD reads the list of every offset that it is given. */
static void the_list_of_every_offset_exists(void) {
    for (int offset = 0; offset < LACONIC_WIRE_OFFSETS; offset++)
        TEST_ASSERT_TRUE(laconic_wire[offset].list < LACONIC_WIRE_CLASSIC);
}

/* Tests of crc.c against the published check values. */

static const uint8_t digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};

static uint8_t crc8_of(const uint8_t *bytes, size_t count) {
    return (uint8_t)(laconic_crc8(LACONIC_CRC8_START, bytes, count) ^ LACONIC_CRC8_END);
}

static void published_values_of_crc8h2f(void) {
    const uint8_t zeros[4] = {0, 0, 0, 0};
    const uint8_t three[3] = {0xF2, 0x01, 0x83};
    const uint8_t four[4] = {0x0F, 0xAA, 0x00, 0x55};
    TEST_ASSERT_EQUAL_HEX8(0x12, crc8_of(zeros, 4));
    TEST_ASSERT_EQUAL_HEX8(0xC2, crc8_of(three, 3));
    TEST_ASSERT_EQUAL_HEX8(0xC6, crc8_of(four, 4));
    TEST_ASSERT_EQUAL_HEX8(0xDF, crc8_of(digits, 9));
}

static void check_values_of_crc16_and_crc32(void) {
    TEST_ASSERT_EQUAL_HEX16(0x29B1, laconic_crc16(LACONIC_CRC16_START, digits, 9) ^ LACONIC_CRC16_END);
    TEST_ASSERT_EQUAL_HEX32(0xCBF43926U, laconic_crc32(LACONIC_CRC32_START, digits, 9) ^ LACONIC_CRC32_END);
}

static void a_checksum_may_be_taken_in_parts(void) {
    const uint32_t whole = laconic_crc32(LACONIC_CRC32_START, digits, 9);
    TEST_ASSERT_EQUAL_HEX32(whole, laconic_crc32(laconic_crc32(LACONIC_CRC32_START, digits, 4), digits + 4, 5));
}

/* Bit by bit, as the polynomials define it, highest bit first. */
static uint32_t divided(uint32_t crc, uint8_t byte, uint32_t polynomial, int bits) {
    crc ^= (uint32_t)byte << (bits - 8);
    for (int k = 0; k < 8; k++) {
        const bool carry = (crc >> (bits - 1) & 1U) != 0;
        crc = crc << 1 ^ (carry ? polynomial : 0U);
    }
    return bits == 8 ? crc & 0xFFU : crc & 0xFFFFU;
}

/* CRC-32 has its lowest bit first. */
static uint32_t divided32(uint32_t crc, uint8_t byte) {
    crc ^= byte;
    for (int k = 0; k < 8; k++) crc = crc >> 1 ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
    return crc;
}

static void every_byte_gives_the_remainder_of_the_polynomials(void) {
    for (uint32_t k = 0; k < 256; k++) {
        const uint8_t byte = (uint8_t)k;
        TEST_ASSERT_EQUAL_HEX8(divided(0x5A, byte, 0x2F, 8), laconic_crc8(0x5A, &byte, 1));
        TEST_ASSERT_EQUAL_HEX16(divided(0x5AC3, byte, 0x1021, 16), laconic_crc16(0x5AC3, &byte, 1));
        TEST_ASSERT_EQUAL_HEX32(divided32(0x5AC3961EU, byte), laconic_crc32(0x5AC3961EU, &byte, 1));
    }
}

/* Tests of node_pack.c: which bytes are written and who is asked, also where a count has changed in memory. */

void setUp(void) {
    bench_begin();
    bench_load(4);
}
void tearDown(void) {}

/* Whoever fetches a classic frame finds the rest of his 64 bytes as it was. */
static void nothing_is_written_behind_the_eighth_byte_of_a_classic_frame(void) {
    const laconic_start start = {{0, 2, 0}, 3, 4, 5, {0}};
    const laconic_sensor_settings with = {.encoder[0] = {256, 3}};
    uint8_t data[LACONIC_FRAME_BYTES];
    int frames = 0;
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_sensors_start(&node.sensors, &with, &node.plant, NULL));
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, SELECTS_ESTIMATE));
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL));
    for (uint8_t offset = LACONIC_WIRE_NODE_FIRST; offset < LACONIC_WIRE_OFFSETS; offset++) {
        if (laconic_wire[offset].length != 8) continue;
        node.answers_due = BIT_OF(LACONIC_WIRE_CONTROL);
        memset(data, 0x5A, sizeof data);
        laconic_node_pack(&node, offset, data);
        for (size_t k = 8; k < sizeof data; k++) TEST_ASSERT_EQUAL_HEX8(0x5A, data[k]);
        frames++;
    }
    TEST_ASSERT_TRUE(frames > 8);
}

static int32_t lowest_asked, highest_asked;

static const laconic_method *notes_who_is_asked_for(int32_t number) {
    lowest_asked = number < lowest_asked ? number : lowest_asked;
    highest_asked = number > highest_asked ? number : highest_asked;
    return &laconic_rk4;
}

/* A port may have but one method and give it for any number. */
static void an_identity_asks_for_methods_alone(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    lowest_asked = highest_asked = 1;
    node.config.method = notes_who_is_asked_for;
    laconic_node_pack(&node, LACONIC_WIRE_IDENTITY, data);
    TEST_ASSERT_EQUAL_INT32(0, lowest_asked);
    TEST_ASSERT_EQUAL_INT32((LACONIC_METHOD_COUNT < 8 ? LACONIC_METHOD_COUNT : 8) - 1, highest_asked); /* of 8 bits */
}

/* As a bit of the count that changes would make it; the frame before had the speeds of all wheels. */
static void a_count_of_wheels_below_none_has_no_speeds(void) {
    const laconic_start start = {{0, 2, 0}, 0, 0, 0, {0}};
    uint8_t data[LACONIC_FRAME_BYTES];
    bench_load(LACONIC_MAX_WHEELS);
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL));
    laconic_node_pack(&node, LACONIC_WIRE_STATE_FD, data);
    TEST_ASSERT_TRUE(word16(data + 32) != 0);
    node.plant.model.wheel_count = INT32_MIN + LACONIC_MAX_WHEELS;
    laconic_node_pack(&node, LACONIC_WIRE_STATE_FD, data);
    for (size_t k = 32; k < 64; k++) TEST_ASSERT_EQUAL_HEX8(0, data[k]);
}

/* It has changed in memory, and a node that does not move tells its heartbeat all the same. */
static void a_count_of_drives_beyond_the_largest_reads_nothing_behind_them(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    memset(node.axes, 1, sizeof node.axes); /* behind the drives */
    node.drives.count = LACONIC_MAX_WHEELS + 1000000;
    laconic_node_pack(&node, LACONIC_WIRE_HEARTBEAT, data);
    TEST_ASSERT_EQUAL_HEX8(0, data[7] & 0x80U);
    node.drives.drive[LACONIC_MAX_WHEELS - 1].unheard = true;
    laconic_node_pack(&node, LACONIC_WIRE_HEARTBEAT, data);
    TEST_ASSERT_EQUAL_HEX8(0x80, data[7] & 0x80U);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_mixing_function_gives_its_test_vectors);
    RUN_TEST(every_bit_of_both_sides_flips_about_half_of_the_result);
    RUN_TEST(a_frame_passes_with_its_own_key_and_count_only);
    RUN_TEST(a_plain_frame_is_that_of_the_profile);
    RUN_TEST(of_the_count_of_a_classic_plain_frame_four_bits_matter);
    RUN_TEST(keyed_frames_are_those_of_the_reference_client);
    RUN_TEST(frames_of_can_fd_are_those_of_the_reference_client);
    RUN_TEST(a_plain_frame_is_that_of_the_reference_client);
    RUN_TEST(the_key_of_a_run_is_mixed_with_the_count_of_its_start);
    RUN_TEST(plain_frames_of_the_node_are_those_of_the_reference_client);
    RUN_TEST(the_list_of_every_offset_exists);
    RUN_TEST(published_values_of_crc8h2f);
    RUN_TEST(check_values_of_crc16_and_crc32);
    RUN_TEST(a_checksum_may_be_taken_in_parts);
    RUN_TEST(every_byte_gives_the_remainder_of_the_polynomials);
    RUN_TEST(nothing_is_written_behind_the_eighth_byte_of_a_classic_frame);
    RUN_TEST(an_identity_asks_for_methods_alone);
    RUN_TEST(a_count_of_wheels_below_none_has_no_speeds);
    RUN_TEST(a_count_of_drives_beyond_the_largest_reads_nothing_behind_them);
    return UNITY_END();
}
