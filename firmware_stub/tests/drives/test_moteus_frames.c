/* Tests of firmware_stub/drives/moteus: subframes that end early, replies that run out of room, registers by number. */
#include "moteus_bench.h"

void setUp(void) { bench_begin(&laconic_moteus, NODE, GEAR); }
void tearDown(void) {}

/* Reads that fill a reply with exactly this many octets, 62 to 64: 14 registers of 4 (59) and int8 ones. */
static void fill(uint8_t octets) {
    static const struct {
        const char *reads;
        uint8_t length;
    } rest[] = {{"\x11\x20", 2}, {"\x15\x20", 2}, {"\x13\x20", 2}}; /* 3, 4 and 5 octets */
    put("\x18\x0E\x20", 3);
    put(rest[octets - 62].reads, rest[octets - 62].length);
}

/* The reply to what was put has so many octets, and what did not fit left nothing of itself. */
static void fills(uint8_t octets) {
    send();
    reply();
    TEST_ASSERT_EQUAL_UINT8(64, frame.length);
    TEST_ASSERT_TRUE(octets == 64 || frame.data[octets - 1] != 0x50);
    for (uint8_t k = octets; k < 64; k++) TEST_ASSERT_EQUAL_HEX8(0x50, frame.data[k]);
}

/* A position of -1.01 turns, so that no reply that is filled with it ends like padding. */
static void write_position(void) { put("\x01\x00\x0A\x0D\x20\xAE\x47\x81\xBF", 9); }

static void a_reply_without_room_for_another_register_ends_there(void) {
    for (uint8_t octets = 62; octets <= 64; octets++) {
        write_position();
        fill(octets);
        put("\x11\x20", 2);
        fills(octets);
        write_position();
        fill(octets);
        put("\x10\x01\x20", 3); /* the count by itself */
        fills(octets);
    }
}

static void an_error_without_room_is_left_out_whole(void) {
    for (uint8_t octets = 62; octets <= 64; octets++) {
        write_position();
        fill(octets);
        put("\x01\x7F\x05", 3); /* register 0x7F is unknown */
        fills(octets);
        write_position();
        fill(octets);
        put("\x11\x7F", 2);
        fills(octets);
    }
}

static void a_stream_without_room_for_its_answer_is_left_out_whole(void) {
    for (uint8_t octets = 62; octets <= 64; octets++) {
        write_position();
        fill(octets);
        put("\x42\x01\x30", 3);
        fills(octets);
    }
}

static void a_frame_that_asks_for_no_reply_gets_no_error_and_no_stream(void) {
    bench_send(NODE, "\x01\x7F\x05\x42\x01\x30", 6);
    TEST_ASSERT_FALSE(drives.protocol->next_frame(&drives, &frame));
    bench_send(NODE, "\x11\x7F\x01\x00\x0A", 5); /* reads are passed over without one, what follows acts */
    near(POSITION, read_float(0x00), 0.1);
}

static void streams_that_end_early_or_of_other_channels_end_the_frame(void) {
    static const char *const frames[] = {"\x42", "\x42\x01", "\x42\x02\x30\x11\x0D"};
    for (size_t k = 0; k < sizeof frames / sizeof frames[0]; k++) {
        bench_send(TO_NODE, frames[k], (uint8_t)strlen(frames[k]));
        reply();
        TEST_ASSERT_EQUAL_UINT8(0, frame.length);
    }
}

static void a_number_that_the_frame_cuts_off_ends_it(void) {
    static const char *const frames[] = {"\xFF", "\x11\x80", "\x10\x80", "\xD0\x80\x80\x80\x80\x80"};
    static const char *const longer[] = {"\x80\x80\x80\x80\x80\x11\x0D", "\x01\x80\x80\x80\x80\x80\x11\x0D",
                                         "\x11\x80\x80\x80\x80\x80\x11\x0D", "\x42\x80\x80\x80\x80\x80\x11\x0D"};
    for (size_t k = 0; k < 4; k++) { /* of more than five octets: the rest of the frame is left */
        bench_send(TO_NODE, longer[k], (uint8_t)strlen(longer[k]));
        reply();
        TEST_ASSERT_EQUAL_UINT8(0, frame.length);
    }
    for (size_t k = 0; k < sizeof frames / sizeof frames[0]; k++) {
        bench_send(TO_NODE, frames[k], (uint8_t)strlen(frames[k]));
        reply();
        TEST_ASSERT_EQUAL_UINT8(0, frame.length);
    }
}

static void an_error_names_a_register_of_any_number(void) {
    ANSWERS("\x11\x80\x80\x01", "\x31\x80\x80\x01\x01");                             /* 0x4000 */
    ANSWERS("\x11\x80\x80\x80\x01", "\x31\x80\x80\x80\x01\x01");                     /* 0x200000 */
    ANSWERS("\x11\x80\x80\x80\x80\x01", "\x31\x80\x80\x80\x80\x01\x01");             /* 0x10000000 */
    ANSWERS("\x11\xFF\xFF\xFF\xFF\x0F", "\x31\xFF\xFF\xFF\xFF\x0F\x01");             /* the largest */
    ANSWERS("\x02\xFF\x01\x05\x05", "\x30\xFF\x01\x01\x30\x80\x02\x02");             /* 0x0FF, then 0x100 */
    ANSWERS("\x11\x80\x02\x11\x00", "\x31\x80\x02\x01");                             /* a model is no int8 */
    ANSWERS("\x00\x80\x80\x80\x80\x10\x80\x80\x80\x80\x10\x11\x0D", "\x21\x0D\x30"); /* no more than 32 bits */
}

static void frames_that_are_remote_are_passed_over(void) {
    const laconic_frame query = {.id = TO_NODE, .length = 2, .data = {0x11, 0x0D}, .remote = true};
    drives.protocol->on_frame(&drives, &query, now_us);
    TEST_ASSERT_FALSE(drives.protocol->next_frame(&drives, &frame));
}

static void the_reply_of_the_lowest_id_goes_first(void) {
    drives.drive[0].settings.node_id = 5;
    drives.drive[1].settings.node_id = 2;
    drives.protocol->start(&drives, now_us);
    bench_send(ASK | 0x7F, "\x11\x0D", 2);
    TEST_ASSERT_TRUE(drives.protocol->next_frame(&drives, &frame));
    TEST_ASSERT_EQUAL_HEX32(0x200, frame.id);
    TEST_ASSERT_TRUE(drives.protocol->next_frame(&drives, &frame));
    TEST_ASSERT_EQUAL_HEX32(0x500, frame.id);
}

/* --- registers --------------------------------------------------------------------------------------------------- */

static void words_of_the_device_stand_in_their_ranges_alone(void) {
    static const struct {
        uint16_t first, last;
    } ranges[] = {{0x100, 0x102}, {0x120, 0x122}, {0x150, 0x153}, {0x158, 0x158}};
    for (uint32_t number = 0xF0; number < 0x170; number++) {
        bool there = number == 0x140 || number == 0x141;
        for (size_t k = 0; k < sizeof ranges / sizeof ranges[0]; k++)
            there = there || (number >= ranges[k].first && number <= ranges[k].last);
        const uint8_t request[] = {0x19, (uint8_t)(number | 0x80U), (uint8_t)(number >> 7)};
        bench_send(TO_NODE, request, 3);
        TEST_ASSERT_EQUAL_HEX8(there ? 0x29 : 0x31, reply()[0]);
    }
}

static void every_drive_has_its_serial_number_and_takes_uuid_masks(void) {
    ANSWERS("\x1B\xA0\x02", "\x2B\xA0\x02\x01\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00");
    ANSWERS("\x19\xD8\x02", "\x29\xD8\x02\x01\x00\x00\x00");
    bench_send(ASK | (NODE + 1), "\x19\xA0\x02", 3);
    TEST_ASSERT_TRUE(bench_receive(REPLY + 0x100, &frame));
    TEST_ASSERT_EQUAL_UINT8(2, frame.data[3]);
}

static void a_uuid_mask_that_is_no_int32_selects_no_drive(void) {
    bench_send(TO_NODE, "\x01\xD4\x02\x6C\x11\x00", 6); /* its first octet alone, which is right */
    TEST_ASSERT_FALSE(drives.protocol->next_frame(&drives, &frame));
}

static void milliseconds_as_a_float_wrap_where_it_is_exact(void) {
    bench_steps(300);
    near(300, read_float(0x70), 0);
    now_us += 1;
    for (uint32_t k = 0; k < 8; k++) /* to 2^23 ms and 5 more, in whole seconds and a rest */
        drives.protocol->on_step(&drives, now_us += 1048575000U + (k == 7 ? 8U * 1000U - 295000U : 0));
    near(5, read_float(0x70), 0);
    ANSWERS("\x19\x70", "\x29\x70\x05\x00\x80\x00");
}

static void a_mode_with_a_share_is_its_whole_part(void) {
    ANSWERS("\x0D\x00\x00\x00\x20\xC1", "\x30\x00\x01"); /* -10 */
    ANSWERS("\x0D\x00\x00\x00\x80\x41", "\x30\x00\x01"); /* 16 */
    ANSWERS("\x0D\x00\x00\x00\xC0\x7F", "\x30\x00\x01"); /* none */
    put_float(0x00, (laconic_real)10.75);
    send();
    near(POSITION, read_float(0x00), 0);
}

static void every_register_of_the_page_is_there_and_no_other(void) {
    static const uint16_t ranges[][2] = {{0x000, 0x007}, {0x00A, 0x00F}, {0x01C, 0x01D}, {0x020, 0x02D}, {0x030, 0x034},
                                         {0x038, 0x03D}, {0x040, 0x048}, {0x050, 0x055}, {0x058, 0x058}, {0x05C, 0x05F},
                                         {0x070, 0x071}, {0x140, 0x141}, {0x158, 0x158}};
    for (uint32_t number = 0; number < 0x200; number++) {
        bool there = false;
        for (size_t k = 0; k < sizeof ranges / sizeof ranges[0]; k++)
            there = there || (number >= ranges[k][0] && number <= ranges[k][1]);
        const uint8_t request[] = {0x1D, (uint8_t)(number | 0x80U), (uint8_t)(number >> 7)};
        bench_send(TO_NODE, request, 3);
        TEST_ASSERT_EQUAL_HEX8(there ? 0x2D : 0x31, reply()[0]);
    }
}

static void a_reply_has_the_next_length_of_can_fd(void) {
    static const uint8_t lengths[65] = {[12] = 12, [16] = 16, [20] = 20, [24] = 24, [32] = 32, [48] = 48, [64] = 64};
    for (uint8_t count = 1; count <= 20; count++) {
        uint8_t expected = (uint8_t)(3 * count); /* an int8 register takes three octets */
        while (expected > 8 && lengths[expected] == 0) expected++;
        for (uint8_t k = 0; k < count; k++) put("\x11\x0D", 2);
        send();
        reply();
        TEST_ASSERT_EQUAL_UINT8(expected, frame.length);
        TEST_ASSERT_EQUAL(expected > 8, frame.fd);
        for (uint8_t k = (uint8_t)(3 * count); k < expected; k++) TEST_ASSERT_EQUAL_HEX8(0x50, frame.data[k]);
    }
}

static void a_reply_of_eight_octets_to_a_classic_frame_is_one(void) {
    ANSWERS("\x15\x0D\x15\x0D", "\x25\x0D\xF0\x00\x25\x0D\xF0\x00");
    TEST_ASSERT_FALSE(frame.fd);
    TEST_ASSERT_EQUAL_UINT8(8, frame.length);
    laconic_frame query = {.id = TO_NODE, .length = 2, .fd = true, .data = {0x11, 0x0D}};
    drives.protocol->on_frame(&drives, &query, now_us);
    reply();
    TEST_ASSERT_TRUE(frame.fd && !frame.bit_rate_switch); /* as the query was */
}

/* Tests of moteus_registers.c and moteus_status.c: what 1 is worth in each type, and what the registers show. */

#define TURN_RAD ((laconic_real)6.28318530717958647693)

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
    RUN_TEST(a_reply_without_room_for_another_register_ends_there);
    RUN_TEST(an_error_without_room_is_left_out_whole);
    RUN_TEST(a_stream_without_room_for_its_answer_is_left_out_whole);
    RUN_TEST(a_frame_that_asks_for_no_reply_gets_no_error_and_no_stream);
    RUN_TEST(streams_that_end_early_or_of_other_channels_end_the_frame);
    RUN_TEST(a_number_that_the_frame_cuts_off_ends_it);
    RUN_TEST(an_error_names_a_register_of_any_number);
    RUN_TEST(frames_that_are_remote_are_passed_over);
    RUN_TEST(the_reply_of_the_lowest_id_goes_first);
    RUN_TEST(words_of_the_device_stand_in_their_ranges_alone);
    RUN_TEST(every_drive_has_its_serial_number_and_takes_uuid_masks);
    RUN_TEST(a_uuid_mask_that_is_no_int32_selects_no_drive);
    RUN_TEST(milliseconds_as_a_float_wrap_where_it_is_exact);
    RUN_TEST(a_mode_with_a_share_is_its_whole_part);
    RUN_TEST(every_register_of_the_page_is_there_and_no_other);
    RUN_TEST(a_reply_has_the_next_length_of_can_fd);
    RUN_TEST(a_reply_of_eight_octets_to_a_classic_frame_is_one);
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
