/* Tests of moteus_registers.c and moteus_status.c: what 1 is worth in each type, and what the registers show. */
#include "moteus_bench.h"

#define TURN_RAD ((laconic_real)6.28318530717958647693)

void setUp(void) { bench_begin(&laconic_moteus, NODE, GEAR); }
void tearDown(void) {}

enum { INT8, INT16, INT32 };

static void write_integer(uint32_t number, int type, int32_t value) {
    const uint8_t head[] = {(uint8_t)(1 | type << 2), (uint8_t)number};
    put(head, 2);
    put(&value, (size_t)1 << type); /* low octets first, as this processor has them */
    send();
}

static int32_t read_integer(uint32_t number, int type) {
    const uint8_t request[] = {(uint8_t)(0x11 | type << 2), (uint8_t)number};
    int32_t value = 0;
    bench_drop_frames();
    bench_send(TO_NODE, request, 2);
    TEST_ASSERT_EQUAL_HEX8(0x21 | type << 2, reply()[0]);
    memcpy(&value, frame.data + 2, (size_t)1 << type);
    return type == INT8 ? (int8_t)value : type == INT16 ? (int16_t)value : value;
}

/* By "Mappings" of the register page, one register of each. */
static const struct {
    uint8_t number;
    double worth[3];
} scales[] = {{0x20, {0.01, 0.0001, 0.00001}},                    /* position, turns */
              {0x21, {0.1, 0.00025, 0.00001}},                    /* velocity */
              {0x29, {0.05, 0.001, 0.00001}},                     /* acceleration */
              {0x22, {0.5, 0.01, 0.001}},                         /* torque */
              {0x1C, {1, 0.1, 0.001}},                            /* current */
              {0x23, {1.0 / 127, 1.0 / 32767, 1.0 / 2147483647}}, /* PWM, scales */
              {0x27, {0.01, 0.001, 0.000001}}};                   /* time */

static void integers_are_worth_what_their_mapping_says(void) {
    for (size_t k = 0; k < sizeof scales / sizeof scales[0]; k++)
        for (int type = INT8; type <= INT32; type++) {
            const double value = 100 * scales[k].worth[type];
            write_integer(scales[k].number, type, 100);
            near(value, read_float(scales[k].number), value * 1e-6);
            write_integer(scales[k].number, type, -100);
            near(-value, read_float(scales[k].number), value * 1e-6);
        }
}

static void values_are_told_in_the_integer_that_is_asked_for(void) {
    for (size_t k = 0; k < sizeof scales / sizeof scales[0]; k++)
        for (int type = INT8; type <= INT32; type++) {
            put_float(scales[k].number, (laconic_real)(100.5 * scales[k].worth[type]));
            send();
            TEST_ASSERT_EQUAL_INT32(100, read_integer(scales[k].number, type)); /* shares are cut off */
            put_float(scales[k].number, (laconic_real)(-100.5 * scales[k].worth[type]));
            send();
            TEST_ASSERT_EQUAL_INT32(-100, read_integer(scales[k].number, type));
        }
}

static void the_ends_of_the_integers_are_one_short_of_not_set(void) {
    static const int32_t largest[3] = {INT8_MAX, INT16_MAX, INT32_MAX};
    for (int type = INT8; type <= INT32; type++) {
        put_float(0x20, 1000000);
        send();
        TEST_ASSERT_EQUAL_INT32(largest[type], read_integer(0x20, type));
        put_float(0x20, -1000000);
        send();
        TEST_ASSERT_EQUAL_INT32(-largest[type], read_integer(0x20, type));
        put_float(0x20, none);
        send();
        TEST_ASSERT_EQUAL_INT32(-largest[type] - 1, read_integer(0x20, type));
        write_integer(0x20, type, -largest[type] - 1);
        TEST_ASSERT_TRUE(read_float(0x20) != read_float(0x20));
    }
}

static void voltage_and_power_are_those_of_the_supply_and_the_motor(void) {
    laconic_wheel_drive *drive = &drives.drive[0];
    drive->current_A = 20;
    drive->speed_rad_per_s = 100;
    TEST_ASSERT_EQUAL_INT32(48, read_integer(0x0D, INT8));
    TEST_ASSERT_EQUAL_INT32(240, read_integer(0x0D, INT16));
    near(24, read_float(0x0D), 1e-6);
    near((0.05 * 100 + 0.1 * 20) * 20, read_float(0x07), 1e-4); /* at the shaft and in the winding */
    TEST_ASSERT_EQUAL_INT32(14, read_integer(0x07, INT8));
    TEST_ASSERT_EQUAL_INT32(2800, read_integer(0x07, INT16));
    near(20, read_float(0x04), 1e-6);
    near(20 * 0.05 * GEAR, read_float(0x03), 1e-5);
    near(100 / (double)TURN_RAD / GEAR, read_float(0x02), 1e-5);
    near(100 / (double)TURN_RAD, read_float(0x51), 1e-5);
    near(25, read_float(0x0E), 0);
    near(3, read_float(0x58), 0);
}

static void places_are_those_of_the_output_and_of_the_encoder(void) {
    drives.drive[0].encoder.count = 3 * BENCH_COUNTS;
    near(3.0 / GEAR, read_float(0x01), 1e-6);
    near(3, read_float(0x50), 1e-6);
}

/* What a controller writes has a second number, for the mode that stays within bounds. */
static void registers_of_stay_within_are_those_of_position(void) {
    static const uint8_t pairs[][2] = {{0x42, 0x22}, {0x43, 0x23}, {0x44, 0x24}, {0x45, 0x25},
                                       {0x46, 0x27}, {0x47, 0x2B}, {0x48, 0x2D}, {0x42, 0x33}};
    for (size_t k = 0; k < sizeof pairs / sizeof pairs[0]; k++) {
        put_float(pairs[k][0], (laconic_real)(k + 3));
        send();
        near(k + 3, read_float(pairs[k][1]), 0);
        near(k + 3, read_float(pairs[k][0]), 0);
    }
}

static void what_a_frame_does_not_write_is_as_the_page_says(void) {
    static const uint8_t not_set[] = {0x25, 0x26, 0x28, 0x29, 0x2A, 0x2C}, one[] = {0x23, 0x24, 0x2B};
    for (size_t k = 0; k < sizeof not_set; k++) TEST_ASSERT_TRUE(read_float(not_set[k]) != read_float(not_set[k]));
    for (size_t k = 0; k < sizeof one; k++) near(1, read_float(one[k]), 0);
    near(0, read_float(0x20), 0);
    near(0, read_float(0x27), 0);
}

static void the_terms_of_the_law_are_shown(void) {
    const laconic_drive_settings *has = &drives.drive[0].settings;
    const double kd = (double)(has->speed_gain_As * has->torque_constant_Nm_per_A * TURN_RAD) * GEAR * GEAR;
    const double kp = kd * (double)has->position_gain_per_s;
    put_mode(POSITION);
    put_float(0x20, 0);
    put_float(0x22, (laconic_real)0.25);
    put_float(0x23, (laconic_real)0.5);
    put_float(0x24, (laconic_real)0.25);
    put_float(0x28, -1);
    put_float(0x29, -1);
    send();
    drives.drive[0].encoder.count = GEAR; /* 1/4096 of the output's turn beyond the place */
    drives.drive[0].speed_rad_per_s = (laconic_real)0.01 * GEAR * TURN_RAD;
    drives.protocol->on_step(&drives, now_us += 1000);
    const double off = 1.0 / (int)BENCH_COUNTS, slip = 0.01;
    near(off, read_float(0x3B), 1e-8);
    near(slip, read_float(0x3C), 1e-7);
    near(kp / 2 * off, read_float(0x30), 1e-5);
    near(kd / 4 * slip, read_float(0x32), 1e-5);
    const double torque = 0.25 - kp / 2 * off - kd / 4 * slip;
    near(torque, read_float(0x34), 1e-5);
    near(torque, read_float(0x3A), 1e-5);
    near(-torque, read_float(0x3D), 1e-5); /* the drive has not acted yet */
    near(torque / 0.05 / GEAR, drives.drive[0].target.current_A, 1e-4);
    near(0, read_float(0x0F), 0);
}

static void what_is_done_by_writing_is_no_error(void) {
    ANSWERS("\x0D\xB0\x02\x00\x00\x80\x3F\x11\x0D", "\x21\x0D\x30");          /* output nearest */
    ANSWERS("\x0D\xB1\x02\x00\x00\x80\x3F\x11\x0D", "\x21\x0D\x30");          /* exact */
    ANSWERS("\x01\xB2\x02\x01\x11\x0D", "\x21\x0D\x30");                      /* index */
    ANSWERS("\x01\xB3\x02\x01\x11\x0D", "\x21\x0D\x30");                      /* recapture */
    ANSWERS("\x08\x04\xD4\x02laconic wheel\0\0\x01\x11\x0D", "\x21\x0D\x30"); /* its own UUID */
}

static void milliseconds_lose_no_part_of_one(void) {
    for (int k = 0; k < 1000; k++) drives.protocol->on_step(&drives, now_us += 333);
    TEST_ASSERT_EQUAL_INT32(333, read_integer(0x70, INT32));
    drives.protocol->on_step(&drives, now_us += 999);
    TEST_ASSERT_EQUAL_INT32(333, read_integer(0x70, INT32));
    drives.protocol->on_step(&drives, now_us += 1);
    TEST_ASSERT_EQUAL_INT32(334, read_integer(0x70, INT32));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(integers_are_worth_what_their_mapping_says);
    RUN_TEST(values_are_told_in_the_integer_that_is_asked_for);
    RUN_TEST(the_ends_of_the_integers_are_one_short_of_not_set);
    RUN_TEST(voltage_and_power_are_those_of_the_supply_and_the_motor);
    RUN_TEST(places_are_those_of_the_output_and_of_the_encoder);
    RUN_TEST(registers_of_stay_within_are_those_of_position);
    RUN_TEST(what_a_frame_does_not_write_is_as_the_page_says);
    RUN_TEST(the_terms_of_the_law_are_shown);
    RUN_TEST(what_is_done_by_writing_is_no_error);
    RUN_TEST(milliseconds_lose_no_part_of_one);
    return UNITY_END();
}
