#include "laconic_dbc.h"
#include "laconic_node/crc.h"
#include "laconic_node/loader.h"
#include "laconic_wire.h"
#include "unity.h"

#include <string.h>

static laconic_loader loader;

void setUp(void) { laconic_loader_begin(&loader); }
void tearDown(void) {}

static void send(uint8_t upper, int field, uint8_t item, uint32_t value) {
    const struct laconic_dbc_parameter_t frame = {
        .upper_half = upper, .field = (uint8_t)field, .item = item, .value = value};
    uint8_t data[8];
    laconic_dbc_parameter_pack(data, &frame, 8);
    laconic_loader_take(&loader, data);
}

static void send_real(int field, uint8_t item, laconic_real value) {
    uint32_t words[2] = {0, 0};
    memcpy(words, &value, sizeof value);
    send(0, field, item, words[0]);
    if (sizeof value == 8) send(1, field, item, words[1]);
}

static uint8_t check(void) {
    return laconic_loader_check(&loader, loader.frame_count, loader.checksum ^ LACONIC_CRC32_END);
}

static void numbers_arrive_bit_for_bit_where_they_belong(void) {
    send_real(LACONIC_FIELD_MASS, 0, (laconic_real)0.1);
    send_real(LACONIC_FIELD_WHEEL_X, LACONIC_MAX_WHEELS, (laconic_real)-3.7);
    send_real(LACONIC_FIELD_START_NU, 3, (laconic_real)1e-30);
    send_real(LACONIC_FIELD_SUPPORT_Y, 1, 2);
    send(0, LACONIC_FIELD_WHEEL_KIND, 2, LACONIC_WHEEL_FIXED);
    send(0, LACONIC_FIELD_WHEEL_LOCKED, 2, 1);
    send(0, LACONIC_FIELD_WHEEL_COUNT, 0, 3);
    TEST_ASSERT_EQUAL_UINT8(0, check());
    TEST_ASSERT_TRUE(loader.parameters.vehicle.mass_kg == (laconic_real)0.1);
    TEST_ASSERT_TRUE(loader.parameters.vehicle.wheel[LACONIC_MAX_WHEELS - 1].x_m == (laconic_real)-3.7);
    TEST_ASSERT_TRUE(loader.parameters.start.nu_rad_per_s[2] == (laconic_real)1e-30);
    TEST_ASSERT_TRUE(loader.parameters.vehicle.support[0].y_m == 2);
    TEST_ASSERT_EQUAL(LACONIC_WHEEL_FIXED, loader.parameters.vehicle.wheel[1].kind);
    TEST_ASSERT_TRUE(loader.parameters.vehicle.wheel[1].locked);
    TEST_ASSERT_EQUAL_INT32(3, loader.parameters.vehicle.wheel_count);
}

static void a_field_or_item_that_is_not_there_is_remembered(void) {
    send_real(LACONIC_FIELD_RESISTANCE, 0, 1);
    send_real(LACONIC_FIELD_WHEEL_X, 0, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, check());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_RESISTANCE, loader.field);
}

static void items_end_where_the_list_ends(void) {
    send_real(LACONIC_FIELD_START_NU, 4, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, check());
    TEST_ASSERT_EQUAL_UINT8(4, loader.item);
}

static void numbers_out_of_their_range_are_refused(void) {
    send(0, LACONIC_FIELD_WHEEL_LOCKED, 1, 2);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, check());
    laconic_loader_begin(&loader);
    send(0, LACONIC_FIELD_WHEEL_KIND, 1, 257); /* would be 1 in a byte */
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, check());
}

static void half_a_double_is_not_enough(void) {
    send(sizeof(laconic_real) == 8 ? 0 : 1, LACONIC_FIELD_MASS, 0, 1);
    TEST_ASSERT_NOT_EQUAL(0, check());
    laconic_loader_begin(&loader);
    send(1, LACONIC_FIELD_MASS, 0, 1);
    TEST_ASSERT_NOT_EQUAL(0, check());
}

static void checksum_and_count_must_both_be_right(void) {
    send_real(LACONIC_FIELD_MASS, 0, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_CHECKSUM_MISMATCH,
                            laconic_loader_check(&loader, loader.frame_count, loader.checksum));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_CHECKSUM_MISMATCH,
                            laconic_loader_check(&loader, 9, loader.checksum ^ LACONIC_CRC32_END));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(numbers_arrive_bit_for_bit_where_they_belong);
    RUN_TEST(a_field_or_item_that_is_not_there_is_remembered);
    RUN_TEST(items_end_where_the_list_ends);
    RUN_TEST(numbers_out_of_their_range_are_refused);
    RUN_TEST(half_a_double_is_not_enough);
    RUN_TEST(checksum_and_count_must_both_be_right);
    return UNITY_END();
}
