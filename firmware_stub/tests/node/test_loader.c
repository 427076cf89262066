/* Tests of loader.c: a vehicle arrives number by number, or the refusal names the field. */
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

static uint8_t field, item; /* of the last check */

static uint8_t check(void) {
    return laconic_loader_check(&loader, loader.frame_count, loader.checksum ^ LACONIC_CRC32_END, &field, &item);
}

/* A cart with two fixed wheels, all that a scene file must give, but for one number; 0, 0: nothing is left out. */
static void send_cart_without(uint8_t left_out, uint8_t of_item) {
    static const uint8_t plain[] = {LACONIC_FIELD_MASS,          LACONIC_FIELD_YAW_INERTIA, LACONIC_FIELD_WHEEL_RADIUS,
                                    LACONIC_FIELD_WHEEL_INERTIA, LACONIC_FIELD_MOTOR_GAIN,  LACONIC_FIELD_MOTOR_DAMPING,
                                    LACONIC_FIELD_STEP};
    static const uint8_t of_wheel[] = {LACONIC_FIELD_WHEEL_X, LACONIC_FIELD_WHEEL_Y, LACONIC_FIELD_AXLE,
                                       LACONIC_FIELD_ROLLER};
    laconic_loader_begin(&loader);
    for (size_t k = 0; k < sizeof plain; k++)
        if (plain[k] != left_out) send_real(plain[k], 0, 0);
    if (left_out != LACONIC_FIELD_WHEEL_COUNT) send(0, LACONIC_FIELD_WHEEL_COUNT, 0, 2);
    for (uint8_t wheel = 1; wheel <= 2; wheel++) {
        for (size_t k = 0; k < sizeof of_wheel; k++)
            if (of_wheel[k] != left_out || wheel != of_item) send_real(of_wheel[k], wheel, 0);
        if (left_out != LACONIC_FIELD_WHEEL_KIND || wheel != of_item)
            send(0, LACONIC_FIELD_WHEEL_KIND, wheel, LACONIC_WHEEL_ROLLER);
    }
}

static void what_a_scene_file_must_give_must_come_even_if_it_is_zero(void) {
    static const uint8_t needed[][2] = {
        {LACONIC_FIELD_MASS, 0},          {LACONIC_FIELD_YAW_INERTIA, 0}, {LACONIC_FIELD_WHEEL_RADIUS, 0},
        {LACONIC_FIELD_WHEEL_INERTIA, 0}, {LACONIC_FIELD_MOTOR_GAIN, 0},  {LACONIC_FIELD_MOTOR_DAMPING, 0},
        {LACONIC_FIELD_STEP, 0},          {LACONIC_FIELD_WHEEL_COUNT, 0}, {LACONIC_FIELD_WHEEL_KIND, 2},
        {LACONIC_FIELD_WHEEL_X, 1},       {LACONIC_FIELD_WHEEL_Y, 2},     {LACONIC_FIELD_AXLE, 1},
        {LACONIC_FIELD_ROLLER, 2}};
    send_cart_without(0, 0);
    TEST_ASSERT_EQUAL_UINT8(0, check());
    for (size_t k = 0; k < sizeof needed / sizeof needed[0]; k++) {
        send_cart_without(needed[k][0], needed[k][1]);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_MISSING, check());
        TEST_ASSERT_EQUAL_UINT8(needed[k][0], field);
        TEST_ASSERT_EQUAL_UINT8(needed[k][1], item);
    }
}

static void part_of_a_payload_or_support_is_not_enough(void) {
    send_cart_without(0, 0);
    send_real(LACONIC_FIELD_PAYLOAD_MASS, 0, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_MISSING, check());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_PAYLOAD_X, field);
    send_real(LACONIC_FIELD_PAYLOAD_X, 0, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_MISSING, check());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_PAYLOAD_Y, field);
    send_cart_without(0, 0);
    send_real(LACONIC_FIELD_SUPPORT_Y, 1, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_MISSING, check());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_SUPPORT_COUNT, field);
    send(0, LACONIC_FIELD_SUPPORT_COUNT, 0, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_MISSING, check());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_SUPPORT_X, field);
    TEST_ASSERT_EQUAL_UINT8(1, item);
}

static void numbers_that_the_core_has_no_use_for_yet_are_refused_by_name(void) {
    for (uint8_t k = LACONIC_WIRE_FIELD_RESISTANCE; k <= LACONIC_WIRE_FIELD_ROTOR_INERTIA; k++) {
        laconic_loader_begin(&loader);
        send(0, k, 1, 0);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, check());
        TEST_ASSERT_EQUAL_UINT8(k, field);
    }
}

static void numbers_arrive_bit_for_bit_where_they_belong(void) {
    send_cart_without(0, 0);
    send_real(LACONIC_FIELD_MASS, 0, (laconic_real)0.1);
    send_real(LACONIC_FIELD_WHEEL_X, LACONIC_MAX_WHEELS, (laconic_real)-3.7);
    send_real(LACONIC_FIELD_START_NU, 3, (laconic_real)1e-30);
    send_real(LACONIC_FIELD_SUPPORT_Y, 1, 2);
    send(0, LACONIC_FIELD_WHEEL_KIND, 2, LACONIC_WHEEL_FIXED);
    send(0, LACONIC_FIELD_WHEEL_LOCKED, 2, 1);
    send_real(LACONIC_FIELD_SUPPORT_X, 1, 0);
    send(0, LACONIC_FIELD_SUPPORT_COUNT, 0, 1);
    TEST_ASSERT_EQUAL_UINT8(0, check());
    TEST_ASSERT_TRUE(loader.parameters.vehicle.mass_kg == (laconic_real)0.1);
    TEST_ASSERT_TRUE(loader.parameters.vehicle.wheel[LACONIC_MAX_WHEELS - 1].x_m == (laconic_real)-3.7);
    TEST_ASSERT_TRUE(loader.parameters.start.nu_rad_per_s[2] == (laconic_real)1e-30);
    TEST_ASSERT_TRUE(loader.parameters.vehicle.support[0].y_m == 2);
    TEST_ASSERT_EQUAL(LACONIC_WHEEL_FIXED, loader.parameters.vehicle.wheel[1].kind);
    TEST_ASSERT_TRUE(loader.parameters.vehicle.wheel[1].locked);
    TEST_ASSERT_EQUAL_INT32(2, loader.parameters.vehicle.wheel_count);
}

static void a_wheels_own_values_arrive_and_driven_0_means_no_motor(void) {
    send_cart_without(0, 0);
    send_real(LACONIC_FIELD_OWN_RADIUS, 2, (laconic_real)0.07);
    send_real(LACONIC_FIELD_OWN_INERTIA, 2, (laconic_real)0.01);
    send_real(LACONIC_FIELD_OWN_MOTOR_GAIN, 1, (laconic_real)-0.3);
    send_real(LACONIC_FIELD_OWN_MOTOR_DAMPING, 1, (laconic_real)0.02);
    send(0, LACONIC_FIELD_DRIVEN, 1, 1);
    send(0, LACONIC_FIELD_DRIVEN, 2, 0);
    TEST_ASSERT_EQUAL_UINT8(0, check());
    TEST_ASSERT_TRUE(loader.parameters.vehicle.wheel[1].own_radius_m == (laconic_real)0.07);
    TEST_ASSERT_TRUE(loader.parameters.vehicle.wheel[1].own_inertia_kgm2 == (laconic_real)0.01);
    TEST_ASSERT_TRUE(loader.parameters.vehicle.wheel[0].own_motor_gain_Nm_per_V == (laconic_real)-0.3);
    TEST_ASSERT_TRUE(loader.parameters.vehicle.wheel[0].own_motor_damping_Nms == (laconic_real)0.02);
    TEST_ASSERT_FALSE(loader.parameters.vehicle.wheel[0].undriven);
    TEST_ASSERT_TRUE(loader.parameters.vehicle.wheel[1].undriven);
    send(0, LACONIC_FIELD_DRIVEN, 2, 2);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, check());
}

static void a_field_or_item_that_is_not_there_is_remembered(void) {
    send_real(LACONIC_FIELD_VOLTAGE, 0, 1);
    send_real(LACONIC_FIELD_WHEEL_X, 0, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, check());
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_VOLTAGE, loader.field);
}

/* The first refusal may name field 0; a later one does not take its place. */
static void the_first_refusal_stays(void) {
    send_real(0, 9, 1);
    send_real(LACONIC_FIELD_WHEEL_X, 0, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, check());
    TEST_ASSERT_TRUE(loader.field == 0 && loader.item == 9);
}

static void items_end_where_the_list_ends(void) {
    send_real(LACONIC_FIELD_START_NU, 4, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, check());
    TEST_ASSERT_EQUAL_UINT8(4, loader.item);
}

static void numbers_out_of_their_range_are_refused_and_not_stored(void) {
    send(0, LACONIC_FIELD_WHEEL_LOCKED, 1, 2);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, check());
    TEST_ASSERT_FALSE(loader.parameters.vehicle.wheel[0].locked);
    laconic_loader_begin(&loader);
    send(1, LACONIC_FIELD_WHEEL_LOCKED, 1, 2); /* for two reasons */
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
                            laconic_loader_check(&loader, loader.frame_count, loader.checksum, &field, &item));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_CHECKSUM_MISMATCH,
                            laconic_loader_check(&loader, 9, loader.checksum ^ LACONIC_CRC32_END, &field, &item));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_CHECKSUM_MISMATCH,
                            laconic_loader_check(&loader, 0, loader.checksum ^ LACONIC_CRC32_END, &field, &item));
}

/* Of a field that this build has, an item that is not there is unknown; only a field that it lacks is left out. */
static void a_wrong_item_of_any_field_is_unknown_and_not_left_out(void) {
    static const int fields[] = {LACONIC_FIELD_OWN_RADIUS,
                                 LACONIC_FIELD_DRIVEN,
                                 LACONIC_FIELD_SLOPE,
                                 LACONIC_FIELD_SLOPE_HEADING,
                                 LACONIC_FIELD_WHEEL_FRICTION_COEFFICIENT,
                                 LACONIC_DRIVES_FIELD_DRIVE_PROTOCOL,
                                 LACONIC_DRIVES_FIELD_LAST,
                                 LACONIC_SENSOR_FIELD_IMU_X,
                                 LACONIC_SENSOR_FIELD_COUNT - 1};
    for (size_t k = 0; k < sizeof fields / sizeof fields[0]; k++) {
        laconic_loader_begin(&loader);
        send(0, fields[k], 200, 0);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, check());
        TEST_ASSERT_EQUAL_UINT8(fields[k], loader.field);
        TEST_ASSERT_EQUAL_UINT8(200, loader.item);
    }
}

static void the_largest_kind_of_a_wheel_fits_a_byte_with_a_sign(void) {
    send(0, LACONIC_FIELD_WHEEL_KIND, 1, 127);
    TEST_ASSERT_EQUAL_UINT8(0, loader.status);
    send(0, LACONIC_FIELD_WHEEL_KIND, 1, 128);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, loader.status);
}

static void the_half_that_is_missing_is_named(void) {
    if (sizeof(laconic_real) == 4) return;
    send(0, LACONIC_FIELD_WHEEL_X, 2, 1);
    send(0, LACONIC_FIELD_MASS, 0, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_INPUT_INCOMPLETE, loader.status);
    TEST_ASSERT_TRUE(loader.field == LACONIC_FIELD_WHEEL_X && loader.item == 2);
    laconic_loader_begin(&loader);
    send(0, LACONIC_FIELD_WHEEL_X, 2, 1);
    send(1, LACONIC_FIELD_WHEEL_X, 1, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_INPUT_INCOMPLETE, loader.status);
    TEST_ASSERT_TRUE(loader.field == LACONIC_FIELD_WHEEL_X && loader.item == 1);
    laconic_loader_begin(&loader);
    send(0, LACONIC_FIELD_WHEEL_X, 2, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_INPUT_INCOMPLETE, check());
    TEST_ASSERT_TRUE(field == LACONIC_FIELD_WHEEL_X && item == 2);
}

/* Of another field or of another item, whether its number is larger or smaller. */
static void an_upper_half_of_another_number_is_refused(void) {
    static const uint8_t others[][2] = {
        {LACONIC_FIELD_WHEEL_X, 2}, {LACONIC_FIELD_AXLE, 2}, {LACONIC_FIELD_WHEEL_Y, 1}, {LACONIC_FIELD_WHEEL_Y, 3}};
    if (sizeof(laconic_real) == 4) return;
    for (size_t k = 0; k < sizeof others / sizeof others[0]; k++) {
        laconic_loader_begin(&loader);
        send(0, LACONIC_FIELD_WHEEL_Y, 2, 1);
        send(1, others[k][0], others[k][1], 1);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_INPUT_INCOMPLETE, loader.status);
        TEST_ASSERT_TRUE(loader.field == others[k][0] && loader.item == others[k][1]);
    }
}

static void rollers_need_their_angle_and_wheels_that_are_not_there_need_nothing(void) {
    send_cart_without(LACONIC_FIELD_ROLLER, 2);
    send(0, LACONIC_FIELD_WHEEL_KIND, 2, LACONIC_WHEEL_FIXED);
    send(0, LACONIC_FIELD_WHEEL_KIND, 3, LACONIC_WHEEL_ROLLER); /* beyond the two */
    TEST_ASSERT_EQUAL_UINT8(0, check());
}

static void the_first_of_several_items_is_needed_as_the_last_is(void) {
    send_cart_without(LACONIC_FIELD_ROLLER, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_MISSING, check());
    TEST_ASSERT_TRUE(field == LACONIC_FIELD_ROLLER && item == 1);
    send_cart_without(0, 0);
    send_real(LACONIC_FIELD_SUPPORT_X, 2, 1);
    send_real(LACONIC_FIELD_SUPPORT_Y, 2, 1);
    send(0, LACONIC_FIELD_SUPPORT_COUNT, 0, 2);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_MISSING, check());
    TEST_ASSERT_TRUE(field == LACONIC_FIELD_SUPPORT_X && item == 1);
}

/* Neither needs anything that would be missing first. */
static void a_kind_that_is_unset_and_a_count_below_0_are_for_the_core_to_refuse(void) {
    send_cart_without(LACONIC_FIELD_ROLLER, 2);
    send(0, LACONIC_FIELD_WHEEL_KIND, 2, LACONIC_WHEEL_UNSET);
    TEST_ASSERT_EQUAL_UINT8(0, check());
    send_cart_without(LACONIC_FIELD_WHEEL_INERTIA, 0);
    send(0, LACONIC_FIELD_WHEEL_COUNT, 0, UINT32_MAX);
    TEST_ASSERT_EQUAL_UINT8(0, check());
    TEST_ASSERT_EQUAL_INT32(-1, loader.parameters.vehicle.wheel_count);
}

static void single_numbers_have_no_item(void) {
    static const int reals[] = {LACONIC_FIELD_SLOPE, LACONIC_FIELD_START_X, LACONIC_FIELD_STEP,
                                LACONIC_SENSOR_FIELD_IMU_X};
    for (size_t k = 0; k < sizeof reals / sizeof reals[0]; k++) send_real(reals[k], 0, 0);
    send(0, LACONIC_DRIVES_FIELD_DRIVE_PROTOCOL, 0, 3);
    TEST_ASSERT_EQUAL_UINT8(0, loader.status);
    TEST_ASSERT_EQUAL_INT(3, loader.parameters.drives.protocol);
    send_real(LACONIC_FIELD_SLOPE, 1, 0);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, loader.status);
}

static void in_single_precision_an_upper_half_is_out_of_range(void) {
    if (sizeof(laconic_real) == 8) return;
    send(1, LACONIC_FIELD_WHEEL_X, 2, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, loader.status);
    TEST_ASSERT_TRUE(loader.field == LACONIC_FIELD_WHEEL_X && loader.item == 2);
}

static void an_integer_out_of_range_names_field_and_item(void) {
    send(1, LACONIC_FIELD_WHEEL_LOCKED, 2, 1);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_OUT_OF_RANGE, loader.status);
    TEST_ASSERT_TRUE(loader.field == LACONIC_FIELD_WHEEL_LOCKED && loader.item == 2);
}

/* One wheel needs what two need. */
static void a_single_wheel_needs_the_numbers_of_wheels(void) {
    static const uint8_t of_wheels[] = {LACONIC_FIELD_WHEEL_INERTIA, LACONIC_FIELD_MOTOR_GAIN,
                                        LACONIC_FIELD_MOTOR_DAMPING};
    for (size_t k = 0; k < sizeof of_wheels; k++) {
        send_cart_without(of_wheels[k], 0);
        send(0, LACONIC_FIELD_WHEEL_COUNT, 0, 1);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_MISSING, check());
        TEST_ASSERT_TRUE(field == of_wheels[k] && item == 0);
    }
}

/* Item 1 is the first of a list, and each item has a place of its own. */
static void every_wheel_has_its_own_drive_and_encoder(void) {
    for (uint8_t wheel = 1; wheel <= LACONIC_MAX_WHEELS; wheel++) {
        send(0, LACONIC_DRIVES_FIELD_DRIVE_NODE_ID, wheel, wheel + 100U);
        send_real(LACONIC_DRIVES_FIELD_DRIVE_GEAR_RATIO, wheel, (laconic_real)(-wheel));
        send(0, LACONIC_SENSOR_FIELD_WHEEL_ENCODER_COUNTS, wheel, wheel * 16U);
    }
    TEST_ASSERT_EQUAL_UINT8(0, loader.status);
    for (int k = 0; k < LACONIC_MAX_WHEELS; k++) {
        TEST_ASSERT_EQUAL_INT(k + 101, loader.parameters.drives.drive[k].node_id);
        TEST_ASSERT_TRUE(loader.parameters.drives.drive[k].gear_ratio == (laconic_real)(-k - 1));
        TEST_ASSERT_EQUAL_INT(16 * (k + 1), loader.parameters.sensors.encoder[k].counts_per_turn);
    }
}

static void no_axis_beyond_the_last_has_a_drive_and_no_wheel_an_encoder(void) {
    static const int fields[] = {LACONIC_DRIVES_FIELD_DRIVE_NODE_ID, LACONIC_SENSOR_FIELD_WHEEL_ENCODER_COUNTS};
    static const uint8_t last[] = {LACONIC_DRIVE_AXES, LACONIC_MAX_WHEELS};
    for (int k = 0; k < 2; k++) {
        laconic_loader_begin(&loader);
        send(0, fields[k], (uint8_t)(last[k] + 1U), 16);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, loader.status);
    }
}

/* A single number is item 0 and no other; items of a list count from 1 to its end. */
static void every_field_of_a_vehicle_takes_its_own_items_alone(void) {
    int count = 0;
    for (int number = 1; number < LACONIC_FIELD_COUNT; number++) {
        const laconic_field_traits *traits = laconic_field_traits_of((laconic_field)number);
        const bool of_motor = number >= LACONIC_WIRE_FIELD_RESISTANCE && number <= LACONIC_WIRE_FIELD_ROTOR_INERTIA;
        if (traits == NULL || traits->kind != LACONIC_KIND_REAL || of_motor) continue;
        if (strncmp(laconic_field_path((laconic_field)number), "vehicle.", 8) != 0) continue;
        const uint8_t first = traits->items > 0, last = (uint8_t)traits->items;
        laconic_loader_begin(&loader);
        send_real(number, first, 1);
        send_real(number, last, 1);
        TEST_ASSERT_EQUAL_UINT8(0, loader.status);
        send_real(number, first > 0 ? 0 : 1, 1);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, loader.status);
        laconic_loader_begin(&loader);
        send_real(number, (uint8_t)(last + 1), 1);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, loader.status);
        TEST_ASSERT_TRUE(loader.field == number && loader.item == last + 1);
        count++;
    }
    TEST_ASSERT_TRUE(count > 30);
}

static void half_a_double_leaves_the_number_before(void) {
    send_real(LACONIC_FIELD_MASS, 0, 5);
    send_real(LACONIC_FIELD_YAW_INERTIA, 0, 7);
    if (sizeof(laconic_real) == 8) send(0, LACONIC_FIELD_MASS, 0, 1);
    TEST_ASSERT_TRUE(loader.parameters.vehicle.mass_kg == 5);
    send_real(LACONIC_FIELD_YAW_INERTIA, 0, 7);
    send(1, LACONIC_FIELD_MASS, 0, 1);
    TEST_ASSERT_TRUE(loader.parameters.vehicle.mass_kg == 5);
}

static void a_check_that_passes_names_nothing(void) {
    send_cart_without(0, 0);
    field = item = 77;
    TEST_ASSERT_EQUAL_UINT8(0, check());
    TEST_ASSERT_TRUE(field == 0 && item == 0);
}

static void a_check_names_what_a_frame_was_refused_for(void) {
    send_real(LACONIC_FIELD_WHEEL_X, LACONIC_MAX_WHEELS + 1, 1);
    field = item = 77;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, check());
    TEST_ASSERT_TRUE(field == LACONIC_FIELD_WHEEL_X && item == LACONIC_MAX_WHEELS + 1);
}

static void a_number_that_no_field_has_is_unknown(void) {
    send(0, 250, 0, 0);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, check());
}

/* What is loaded is all that there can be: nothing is missing for the wheel or support that is one too many. */
static void a_count_beyond_the_largest_is_for_the_core_to_refuse(void) {
    send_cart_without(0, 0);
    for (uint8_t wheel = 3; wheel <= LACONIC_MAX_WHEELS; wheel++) {
        send(0, LACONIC_FIELD_WHEEL_KIND, wheel, LACONIC_WHEEL_FIXED);
        send_real(LACONIC_FIELD_WHEEL_X, wheel, wheel);
        send_real(LACONIC_FIELD_WHEEL_Y, wheel, 0);
        send_real(LACONIC_FIELD_AXLE, wheel, 0);
    }
    send(0, LACONIC_FIELD_WHEEL_COUNT, 0, LACONIC_MAX_WHEELS + 1);
    TEST_ASSERT_EQUAL_UINT8(0, check());
    for (uint8_t support = 1; support <= LACONIC_MAX_SUPPORTS; support++) {
        send_real(LACONIC_FIELD_SUPPORT_X, support, support);
        send_real(LACONIC_FIELD_SUPPORT_Y, support, 0);
    }
    send(0, LACONIC_FIELD_SUPPORT_COUNT, 0, LACONIC_MAX_SUPPORTS + 1);
    TEST_ASSERT_EQUAL_UINT8(0, check());
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(numbers_arrive_bit_for_bit_where_they_belong);
    RUN_TEST(a_wheels_own_values_arrive_and_driven_0_means_no_motor);
    RUN_TEST(a_field_or_item_that_is_not_there_is_remembered);
    RUN_TEST(the_first_refusal_stays);
    RUN_TEST(the_first_of_several_items_is_needed_as_the_last_is);
    RUN_TEST(items_end_where_the_list_ends);
    RUN_TEST(numbers_out_of_their_range_are_refused_and_not_stored);
    RUN_TEST(half_a_double_is_not_enough);
    RUN_TEST(what_a_scene_file_must_give_must_come_even_if_it_is_zero);
    RUN_TEST(part_of_a_payload_or_support_is_not_enough);
    RUN_TEST(numbers_that_the_core_has_no_use_for_yet_are_refused_by_name);
    RUN_TEST(checksum_and_count_must_both_be_right);
    RUN_TEST(a_wrong_item_of_any_field_is_unknown_and_not_left_out);
    RUN_TEST(the_largest_kind_of_a_wheel_fits_a_byte_with_a_sign);
    RUN_TEST(the_half_that_is_missing_is_named);
    RUN_TEST(an_upper_half_of_another_number_is_refused);
    RUN_TEST(a_kind_that_is_unset_and_a_count_below_0_are_for_the_core_to_refuse);
    RUN_TEST(rollers_need_their_angle_and_wheels_that_are_not_there_need_nothing);
    RUN_TEST(single_numbers_have_no_item);
    RUN_TEST(in_single_precision_an_upper_half_is_out_of_range);
    RUN_TEST(an_integer_out_of_range_names_field_and_item);
    RUN_TEST(a_single_wheel_needs_the_numbers_of_wheels);
    RUN_TEST(every_wheel_has_its_own_drive_and_encoder);
    RUN_TEST(no_axis_beyond_the_last_has_a_drive_and_no_wheel_an_encoder);
    RUN_TEST(every_field_of_a_vehicle_takes_its_own_items_alone);
    RUN_TEST(half_a_double_leaves_the_number_before);
    RUN_TEST(a_check_that_passes_names_nothing);
    RUN_TEST(a_check_names_what_a_frame_was_refused_for);
    RUN_TEST(a_number_that_no_field_has_is_unknown);
    RUN_TEST(a_count_beyond_the_largest_is_for_the_core_to_refuse);
    return UNITY_END();
}
