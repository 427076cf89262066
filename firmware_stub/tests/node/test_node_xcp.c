/* Tests of node_xcp.c and node_daq.c: an XCP master's calibration and measurement, and its wrong requests. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#define BENCH_WITH_MASTER
#include "bench.h"
#include "laconic_node/crc.h"

#include <stdlib.h>

enum { POSE = 25, IMU = 29, VELOCITY = 43 }; /* bits of SELECT */

/* Two wheels with damped motors, loaded as COMMIT does, and a master that is connected. */
void setUp(void) {
    bench_begin();
    bench_load(2);
    laconic_vehicle vehicle = node.plant.vehicle;
    vehicle.motor_damping_Nms = (laconic_real)0.5;
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_change(&node.plant, &vehicle, NULL));
    laconic_xcp_adopt(&node, &vehicle);
    DONE_BY(0xFF, 0);
}
void tearDown(void) {}

/* ------------------------------------------------------------------------------------- session -- */

static void a_slave_without_a_master_is_silent(void) {
    DONE_BY(0xFE);
    TEST_ASSERT_EQUAL(1, ASK(0xFD));
    DONE_BY(0xFF, 0);
    const uint8_t told[8] = {0xFF, 0x05, 0x80, 8, 8, 0, 1, 1};
    TEST_ASSERT_EQUAL_MEMORY(told, answer, 8);
}

static void frames_that_no_master_sends_count_as_malformed(void) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_XCP_COMMAND, .length = 1, .data = {0xFD}};
    frame.remote = true;
    laconic_node_on_frame(&node, &frame, now_us);
    frame.remote = false;
    frame.length = 0;
    laconic_node_on_frame(&node, &frame, now_us);
    frame.fd = true;
    frame.length = 12;
    laconic_node_on_frame(&node, &frame, now_us);
    frame.fd = false;
    frame.length = 9;
    laconic_node_on_frame(&node, &frame, now_us);
    TEST_ASSERT_EQUAL_UINT16(4, node.counters.malformed);
    TEST_ASSERT_FALSE(hear());
}

static void the_slave_names_itself_and_its_modes(void) {
    char name[16] = {0};
    DONE_BY(0xFA, 1);
    const uint8_t length = answer[4];
    DONE_BY(0xF5, 7);
    memcpy(name, answer + 1, 7);
    DONE_BY(0xF5, (uint8_t)(length - 7));
    memcpy(name + 7, answer + 1, (size_t)(length - 7));
    TEST_ASSERT_EQUAL_STRING("laconic_2", name);
    DONE_BY(0xFA, 4);
    TEST_ASSERT_EQUAL_UINT32(0, word32(answer + 4));
    DONE_BY(0xFB);
    TEST_ASSERT_TRUE(answer_length == 8 && answer[2] == 0);
    DONE_BY(0xFD);
    TEST_ASSERT_TRUE(answer_length == 6 && answer[1] == 0);
}

/* -------------------------------------------------------------------------------- calibration -- */

static void a_number_of_the_working_page_acts_from_the_next_step_on(void) {
    TEST_ASSERT_EQUAL_FLOAT(1, real_at(PARAMETER(LACONIC_FIELD_MASS, 0)));
    TEST_ASSERT_EQUAL_HEX8(DONE, write_real(PARAMETER(LACONIC_FIELD_MASS, 0), 2));
    TEST_ASSERT_TRUE(node.plant.vehicle.mass_kg == 2);
    laconic_plant twin;
    laconic_vehicle vehicle = node.plant.vehicle;
    TEST_ASSERT_EQUAL(LACONIC_OK,
                      laconic_plant_start(&twin, &vehicle, &laconic_rk4, (laconic_real)0.001, &node.start, NULL));
    bench_start_lockstep();
    bench_step(20);
    const laconic_input input = {.voltage_V = {5, 5}};
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_plant_run(&twin, &input, 20, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&twin.state, &node.plant.state, sizeof twin.state);
}

static void a_refused_number_is_named_and_changes_nothing(void) {
    uint8_t data[8];
    const laconic_plant before = node.plant;
    TEST_ASSERT_EQUAL_HEX8(XCP_OUT_OF_RANGE, write_real(PARAMETER(LACONIC_FIELD_MASS, 0), -1));
    TEST_ASSERT_TRUE(answer[2] == LACONIC_NOT_POSITIVE && answer[3] == LACONIC_FIELD_MASS && answer_length == 5);
    TEST_ASSERT_EQUAL_MEMORY(&before, &node.plant, sizeof before);
    TEST_ASSERT_EQUAL_FLOAT(1, real_at(PARAMETER(LACONIC_FIELD_MASS, 0)));
    tell((const uint8_t[]){0xF6, 0, 0, 0, BYTES(PARAMETER(LACONIC_FIELD_OWN_RADIUS, 1))}, 8);
    tell((const uint8_t[]){0xF0, 4, 0, 0, 0xC0, 0x7F}, 6); /* NaN */
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_RESULT, data));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_COMMAND_CALIBRATE, data[2]);
    TEST_ASSERT_TRUE(data[3] == LACONIC_NOT_FINITE && data[4] == LACONIC_FIELD_OWN_RADIUS && data[5] == 2);
}

static void a_number_that_is_there_keeps_its_hidden_digits(void) {
    node.xcp.page[0].mass_kg = (laconic_real)0.883;
    TEST_ASSERT_EQUAL_HEX8(DONE, write_real(PARAMETER(LACONIC_FIELD_MASS, 0), 0.883F));
    TEST_ASSERT_TRUE(node.plant.vehicle.mass_kg == (laconic_real)0.883);
}

static void the_node_runs_on_the_page_that_the_master_sets(void) {
    DONE_BY(0xEB, 1, 0, 1); /* the node on its reference */
    TEST_ASSERT_EQUAL_HEX8(DONE, write_real(PARAMETER(LACONIC_FIELD_MASS, 0), 3));
    TEST_ASSERT_EQUAL_HEX8(DONE, write_real(PARAMETER(LACONIC_FIELD_YAW_INERTIA, 0), 4));
    TEST_ASSERT_TRUE(node.plant.vehicle.mass_kg == 1);
    DONE_BY(0xEB, 1, 0, 0);
    TEST_ASSERT_TRUE(node.plant.vehicle.mass_kg == 3 && node.plant.vehicle.yaw_inertia_kgm2 == 4);
    DONE_BY(0xEB, 0x83, 7, 1); /* all segments, node and master */
    TEST_ASSERT_EQUAL_FLOAT(1, real_at(PARAMETER(LACONIC_FIELD_MASS, 0)));
    DONE_BY(0xEA, 1, 0);
    TEST_ASSERT_EQUAL_UINT8(1, answer[3]);
    DONE_BY(0xEA, 2, 0);
    TEST_ASSERT_EQUAL_UINT8(1, answer[3]);
    DONE_BY(0xEB, 3, 0, 0);
    DONE_BY(0xE4, 0, 1, 0, 0); /* the reference again */
    TEST_ASSERT_TRUE(node.plant.vehicle.mass_kg == 1);
}

static void an_impossible_page_is_refused_by_name_and_the_node_stays_on_its_own(void) {
    DONE_BY(0xEB, 1, 0, 1);
    TEST_ASSERT_EQUAL_HEX8(DONE, write_real(PARAMETER(LACONIC_FIELD_YAW_INERTIA, 0), 0));
    REFUSED(XCP_PAGE_NOT_VALID, 0xEB, 3, 0, 0);
    TEST_ASSERT_TRUE(answer[2] == LACONIC_NOT_POSITIVE && answer[3] == LACONIC_FIELD_YAW_INERTIA);
    DONE_BY(0xEA, 1, 0);
    TEST_ASSERT_EQUAL_UINT8(1, answer[3]);
    DONE_BY(0xE4, 0, 0, 0, 0); /* a page onto itself */
    DONE_BY(0xE4, 0, 1, 0, 0);
    DONE_BY(0xEB, 3, 0, 0);
    node.xcp.page[1].mass_kg = 0; /* no COMMIT makes such a page */
    REFUSED(XCP_PAGE_NOT_VALID, 0xE4, 0, 1, 0, 0);
    TEST_ASSERT_TRUE(node.xcp.page[0].mass_kg == 1);
}

static void a_number_in_parts_acts_when_its_last_byte_has_come(void) {
    DONE_BY(0xF6, 0, 0, 0, BYTES(PARAMETER(LACONIC_FIELD_OWN_INERTIA, 0)));
    DONE_BY(0xF0, 6, 0, 0, 0x80, 0x40, 0, 0); /* 4, and half of the next */
    TEST_ASSERT_TRUE(node.plant.vehicle.wheel[0].own_inertia_kgm2 == 4 &&
                     node.plant.vehicle.wheel[1].own_inertia_kgm2 == 0);
    DONE_BY(0xF0, 2, 0xA0, 0x40);
    TEST_ASSERT_TRUE(node.plant.vehicle.wheel[1].own_inertia_kgm2 == 5);
}

static void integers_flags_and_kinds_are_numbers_of_the_page(void) {
    TEST_ASSERT_EQUAL_UINT32(2, word_at(PARAMETER(LACONIC_FIELD_WHEEL_COUNT, 0)));
    TEST_ASSERT_EQUAL_UINT32(LACONIC_WHEEL_FIXED, word_at(PARAMETER(LACONIC_FIELD_WHEEL_KIND, 1)));
    TEST_ASSERT_EQUAL_UINT32(0, word_at(PARAMETER(LACONIC_FIELD_WHEEL_LOCKED, 0)));
    TEST_ASSERT_EQUAL_UINT32(1, word_at(PARAMETER(LACONIC_FIELD_DRIVEN, 0)));
    TEST_ASSERT_EQUAL_HEX8(DONE, write_word(PARAMETER(LACONIC_FIELD_DRIVEN, 1), 0));
    TEST_ASSERT_TRUE(node.plant.vehicle.wheel[1].undriven);
    TEST_ASSERT_EQUAL_HEX8(XCP_OUT_OF_RANGE, write_word(PARAMETER(LACONIC_FIELD_DRIVEN, 1), 2));
    TEST_ASSERT_TRUE(answer[2] == LACONIC_WIRE_STATUS_OUT_OF_RANGE && answer[3] == LACONIC_FIELD_DRIVEN &&
                     answer[4] == 2);
    DONE_BY(0xEB, 1, 0, 1);
    TEST_ASSERT_EQUAL_HEX8(DONE, write_word(PARAMETER(LACONIC_FIELD_MOTOR_CIRCUIT, 0), 3));
    REFUSED(XCP_PAGE_NOT_VALID, 0xEB, 1, 0, 0);
    TEST_ASSERT_TRUE(answer[2] == LACONIC_MOTOR_CIRCUIT_UNKNOWN && answer[3] == LACONIC_FIELD_MOTOR_CIRCUIT);
}

/* A segment is read and summed as a whole: where there is no number, 0. */
static void the_checksum_is_that_of_the_bytes_that_a_master_reads(void) {
    uint8_t bytes[260];
    uint32_t sum = LACONIC_CRC32_START;
    for (uint32_t k = 0; k < sizeof bytes; k += 4) put32(bytes + k, word_at(PARAMETER(0, 0) + k));
    sum = laconic_crc32(sum, bytes, sizeof bytes - 1) ^ LACONIC_CRC32_END;
    DONE_BY(0xF6, 0, 0, 0, BYTES(PARAMETER(0, 0)));
    DONE_BY(0xF3, 0, 0, 0, BYTES((uint32_t)sizeof bytes - 1U));
    TEST_ASSERT_TRUE(answer[1] == 9 && word32(answer + 4) == sum);
    DONE_BY(0xF6, 0, 0, 0, BYTES(PARAMETER(0, 0)));
    DONE_BY(0xF3, 0, 0, 0, BYTES(LACONIC_XCP_SEGMENT));
}

/* ------------------------------------------------------------------------------- wrong requests -- */

/* A request in hexadecimal digits, and the code of its answer; FF: it is carried out. */
typedef struct request {
    const char *text;
    uint8_t code;
} request;

static uint8_t code_of(const char *text) {
    uint8_t command[8], length = 0;
    for (; *text != 0 && length < 8; length++) command[length] = (uint8_t)strtoul(text, (char **)&text, 16);
    return ask(command, length);
}

static void expect(const request *requests, size_t count) {
    for (size_t k = 0; k < count; k++)
        TEST_ASSERT_EQUAL_HEX8_MESSAGE(requests[k].code, code_of(requests[k].text), requests[k].text);
}

#define EXPECT(requests) expect(requests, sizeof(requests) / sizeof(requests)[0])

/* Commands, lengths, addresses; then, by F6 and F0, numbers that nobody writes; then pages; then checksums. */
static void wrong_requests_have_their_codes(void) {
    /* clang-format off */
    static const request requests[] = {
        {"FC", XCP_SYNCH}, {"F9 0 0", XCP_COMMAND_UNKNOWN}, {"ED 1 0 0 80 0 1 0", XCP_COMMAND_UNKNOWN},
        {"C0", XCP_COMMAND_UNKNOWN}, {"0", XCP_COMMAND_UNKNOWN}, {"FF", XCP_SYNTAX}, {"FA", XCP_SYNTAX},
        {"F6 0 0 0 80 0 1", XCP_SYNTAX}, {"F5", XCP_SYNTAX}, {"F4 4 0 0", XCP_SYNTAX}, {"F0 4 1 2 3", XCP_SYNTAX},
        {"F0 7 0 0 0 0 0 0", XCP_SYNTAX}, {"EB 3 0", XCP_SYNTAX}, {"E1 FF 4 0", XCP_SYNTAX},
        {"E0 10 0 0 0 0 1", XCP_SYNTAX}, {"FF 2", XCP_OUT_OF_RANGE}, {"F6 0 0 1 80 0 1 0", XCP_OUT_OF_RANGE},
        {"F4 4 0 1 80 0 1 0", XCP_OUT_OF_RANGE}, {"F5 0", XCP_OUT_OF_RANGE}, {"F5 8", XCP_OUT_OF_RANGE},
        {"F0 0 0", XCP_OUT_OF_RANGE}, {"F4 4 0 0 0 0 0 0", XCP_ACCESS_DENIED},
        {"F4 1 0 0 0 0 0 20", XCP_ACCESS_DENIED}, {"F4 1 0 0 0 20 1 0", XCP_ACCESS_DENIED},
        {"F4 4 0 0 40 0 3 0", XCP_ACCESS_DENIED}, {"F4 4 0 0 8 0 2 0", XCP_ACCESS_DENIED},
        {"F4 4 0 0 80 0 2 0", XCP_ACCESS_DENIED}, {"F4 4 0 0 80 F 2 0", XCP_ACCESS_DENIED},
        {"F4 4 0 0 8C C 2 0", XCP_ACCESS_DENIED}, {"F4 4 0 0 8 10 2 0", XCP_ACCESS_DENIED},
        {"F4 4 0 0 80 15 2 0", XCP_ACCESS_DENIED}, {"F6 0 0 0 80 C 2 0", DONE},
        {"F0 4 0 0 80 3F", XCP_WRITE_PROTECTED}, {"F6 0 0 0 0 0 3 0", DONE}, {"F0 1 0", XCP_WRITE_PROTECTED},
        {"F6 0 0 0 80 7 1 0", DONE}, {"F0 4 1 0 0 0", XCP_WRITE_PROTECTED}, {"F6 0 0 0 0 B 1 0", DONE},
        {"F0 4 1 0 0 0", XCP_WRITE_PROTECTED}, {"F6 0 0 0 84 8 1 0", DONE}, {"F0 4 0 0 80 3F", XCP_WRITE_PROTECTED},
        {"F6 0 0 0 0 0 4 0", DONE}, {"F0 1 0", XCP_ACCESS_DENIED},
        {"F6 0 0 0 0 20 1 0", DONE}, {"F0 1 0", XCP_ACCESS_DENIED}, {"F6 0 0 0 88 8 1 0", DONE},
        {"F0 1 0", XCP_ACCESS_DENIED}, {"F6 0 0 0 80 B 1 0", DONE}, {"F0 1 0", XCP_ACCESS_DENIED},
        {"F6 0 0 0 0 F 1 0", DONE}, {"F0 1 0", XCP_ACCESS_DENIED}, {"F6 0 0 0 84 0 1 0", DONE},
        {"F0 1 0", XCP_ACCESS_DENIED}, {"EB 0 0 0", XCP_MODE_NOT_VALID}, {"EB 4 0 0", XCP_MODE_NOT_VALID},
        {"EB 3 1 0", XCP_SEGMENT_NOT_VALID}, {"EB 3 0 2", XCP_PAGE_NOT_VALID}, {"EA 3 0", XCP_MODE_NOT_VALID},
        {"EA 1 1", XCP_SEGMENT_NOT_VALID}, {"E4 1 1 0 0", XCP_SEGMENT_NOT_VALID},
        {"E4 0 1 1 0", XCP_SEGMENT_NOT_VALID}, {"E4 0 2 0 0", XCP_PAGE_NOT_VALID}, {"E4 0 0 0 2", XCP_PAGE_NOT_VALID},
        {"E4 0 0 0 1", XCP_WRITE_PROTECTED}, {"EB 2 0 1", DONE}, {"F6 0 0 0 80 0 1 0", DONE},
        {"F0 4 0 0 80 3F", XCP_WRITE_PROTECTED}, {"F3 0 0 0 0 0 0 0", XCP_OUT_OF_RANGE},
        {"F3 0 0 0 0 20 0 0", XCP_ACCESS_DENIED}, {"F3 0 0 0 1 20 0 0", XCP_OUT_OF_RANGE}};
    /* clang-format on */
    EXPECT(requests);
    TEST_ASSERT_EQUAL_UINT32(LACONIC_XCP_SEGMENT, word32(answer + 4)); /* the largest block of a checksum */
}

/* In the order of a master that allocates, describes and starts; numbers of x and y are 80 C 2 0 and 84 C 2 0. */
static void wrong_requests_of_measurement_have_their_codes(void) {
    /* clang-format off */
    static const request requests[] = {
        {"D5 0 1 0", XCP_SEQUENCE}, {"E1 FF 4 0 80 C 2 0", XCP_SEQUENCE}, {"D6", DONE}, {"D4 0 0 0 1", XCP_SEQUENCE},
        {"D5 0 9 0", XCP_MEMORY_OVERFLOW}, {"D5 0 2 0", DONE}, {"D5 0 1 0", XCP_SEQUENCE},
        {"D3 0 0 0 0 1", XCP_SEQUENCE}, {"D4 0 2 0 1", XCP_OUT_OF_RANGE}, {"D4 0 0 1 1", XCP_OUT_OF_RANGE},
        {"D4 0 0 0 31", XCP_MEMORY_OVERFLOW}, {"D4 0 0 0 2", DONE}, {"D4 0 0 0 1", XCP_SEQUENCE},
        {"D3 0 0 0 2 1", XCP_OUT_OF_RANGE}, {"D3 0 3 0 0 1", XCP_OUT_OF_RANGE},
        {"D3 0 0 0 0 61", XCP_MEMORY_OVERFLOW}, {"D3 0 0 0 0 1", DONE}, {"D3 0 0 0 0 1", XCP_SEQUENCE},
        {"D4 0 1 0 1", XCP_SEQUENCE}, {"E2 0 2 0 0 0", XCP_OUT_OF_RANGE}, {"E2 0 0 0 0 1", XCP_OUT_OF_RANGE},
        {"E2 0 0 0 1 0", XCP_OUT_OF_RANGE}, {"E2 0 0 0 0 0", DONE}, {"E1 0 4 0 80 C 2 0", XCP_OUT_OF_RANGE},
        {"E1 FF 0 0 80 C 2 0", XCP_OUT_OF_RANGE}, {"E1 FF 8 0 80 C 2 0", XCP_OUT_OF_RANGE},
        {"E1 FF 4 1 80 C 2 0", XCP_OUT_OF_RANGE}, {"E1 FF 4 0 8C C 2 0", XCP_ACCESS_DENIED},
        {"DE 1 0 0", XCP_DAQ_CONFIG}, {"E1 FF 4 0 80 C 2 0", DONE}, {"E1 FF 4 0 84 C 2 0", XCP_SEQUENCE},
        {"DE 1 0 0", XCP_DAQ_CONFIG}, {"E0 0 2 0 0 0 1 0", XCP_OUT_OF_RANGE}, {"E0 0 0 0 3 0 1 0", XCP_OUT_OF_RANGE},
        {"E0 0 0 0 0 0 0 0", XCP_OUT_OF_RANGE}, {"E0 0 0 0 0 0 1 1", XCP_OUT_OF_RANGE},
        {"E0 2 0 0 0 0 1 0", XCP_MODE_NOT_VALID}, {"E0 10 0 0 0 0 1 0", DONE}, {"DE 1 0 0", XCP_DAQ_CONFIG},
        {"E0 0 0 0 0 0 1 0", DONE}, {"E0 0 1 0 0 0 1 0", DONE}, {"DE 1 1 0", XCP_DAQ_CONFIG},
        {"DE 3 0 0", XCP_MODE_NOT_VALID}, {"DE 1 2 0", XCP_OUT_OF_RANGE}, {"DD 3", XCP_MODE_NOT_VALID},
        {"D7 0 3 0", XCP_OUT_OF_RANGE}, {"DE 1 0 0", DONE}, {"E2 0 0 0 0 0", DONE},
        {"E1 FF 4 0 80 C 2 0", XCP_DAQ_ACTIVE}, {"E0 0 0 0 0 0 1 0", XCP_DAQ_ACTIVE}};
    /* clang-format on */
    EXPECT(requests);
}

static void without_a_sound_vehicle_there_is_nothing_to_read_or_write(void) {
    node.model_is_wrong = true;
    REFUSED(XCP_NOT_NOW, 0xF4, 4, 0, 0, BYTES(PARAMETER(1, 0)));
    REFUSED(XCP_NOT_NOW, 0xF4, 4, 0, 0, BYTES(OUTPUT(25, 0)));
    REFUSED(XCP_NOT_NOW, 0xEB, 3, 0, 1);
    REFUSED(XCP_NOT_NOW, 0xE4, 0, 1, 0, 0);
    TEST_ASSERT_EQUAL_HEX8(XCP_NOT_NOW, write_real(PARAMETER(1, 0), 2));
    TEST_ASSERT_EQUAL_UINT32(LACONIC_WIRE_STATE_READY, word_at(OUTPUT(0, 1)));
}

static void vehicles_with_hinges_are_read_but_not_calibrated(void) {
    node.hinges.here = true;
    TEST_ASSERT_EQUAL_FLOAT(1, real_at(PARAMETER(LACONIC_FIELD_MASS, 0)));
    TEST_ASSERT_EQUAL_HEX8(XCP_WRITE_PROTECTED, write_real(PARAMETER(LACONIC_FIELD_MASS, 0), 2));
    DONE_BY(0xEB, 3, 0, 1);
    REFUSED(XCP_ACCESS_DENIED, 0xF4, 4, 0, 0, BYTES(OUTPUT(24, 0)));
    TEST_ASSERT_EQUAL_FLOAT(0, real_at(OUTPUT(VELOCITY, 2)));
}

/* ------------------------------------------------------------------------------- measurement -- */

/* One list of one frame of x (25, 0), on an event; with a stamp the number is in the second frame. */
static void measure(uint8_t event, uint8_t prescaler, bool stamped) {
    DONE_BY(0xD6);
    DONE_BY(0xD5, 0, 1, 0);
    DONE_BY(0xD4, 0, 0, 0, stamped ? 2 : 1);
    DONE_BY(0xD3, 0, 0, 0, stamped ? 1 : 0, 1);
    DONE_BY(0xE2, 0, 0, 0, stamped ? 1 : 0, 0);
    DONE_BY(0xE1, 0xFF, 4, 0, BYTES(OUTPUT(POSE, 1)));
    DONE_BY(0xE0, stamped ? 0x10 : 0, 0, 0, event, 0, prescaler, 0);
    DONE_BY(0xDE, 2, 0, 0);
    DONE_BY(0xDD, 1);
    DONE_BY(0xFD);
    TEST_ASSERT_EQUAL_HEX8(0x40, answer[1]);
}

static void samples_have_the_time_of_their_step_and_none_is_lost(void) {
    bench_start_lockstep();
    measure(1, 1, true);
    bench_voltage(0, 5 * VOLT, 0);
    bench_sync(1000);
    uint32_t samples = 0;
    while (node.lockstep.steps_due > 0) {
        while (laconic_node_is_busy(&node)) laconic_node_on_tick(&node, now_us);
        TEST_ASSERT_TRUE(node.lockstep.steps_due == 0 || node.xcp.waiting > LACONIC_XCP_QUEUE - 2);
        for (bool more = hear(); more; more = hear()) {
            float y_m;
            TEST_ASSERT_TRUE(answer[0] == 0 && answer_length == 5);
            samples++;
            TEST_ASSERT_EQUAL_UINT32(10000U * samples, word32(answer + 1));
            TEST_ASSERT_TRUE(hear() && answer[0] == 1 && answer_length == 5);
            memcpy(&y_m, answer + 1, sizeof y_m);
            TEST_ASSERT_TRUE(y_m == y_m);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(100, samples);
    DONE_BY(0xDC);
    TEST_ASSERT_EQUAL_UINT32(1000000U, word32(answer + 4));
}

static uint32_t frames_heard(void) {
    uint32_t frames = 0;
    while (hear()) frames++;
    return frames;
}

static void a_prescaler_takes_each_so_many_events_until_the_list_stops(void) {
    bench_start_lockstep();
    measure(0, 10, false);
    bench_step(100);
    TEST_ASSERT_EQUAL_UINT32(10, frames_heard());
    DONE_BY(0xDE, 0, 0, 0);
    bench_step(100);
    TEST_ASSERT_EQUAL_UINT32(0, frames_heard());
    DONE_BY(0xDE, 2, 0, 0);
    DONE_BY(0xDD, 1);
    bench_step(20);
    DONE_BY(0xDE, 2, 0, 0);
    TEST_ASSERT_EQUAL_UINT32(2, frames_heard());
    DONE_BY(0xDD, 2);
    bench_step(20);
    TEST_ASSERT_EQUAL_UINT32(0, frames_heard());
    DONE_BY(0xDE, 1, 0, 0);
    DONE_BY(0xDD, 0);
    TEST_ASSERT_FALSE(laconic_daq_runs(&node.xcp));
}

static void measured_steps_are_the_same_to_the_last_bit(void) {
    bench_start_lockstep();
    bench_step(50);
    const laconic_state unmeasured = node.plant.state;
    bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0);
    bench_start_lockstep();
    measure(0, 1, false);
    bench_step(50);
    TEST_ASSERT_EQUAL_MEMORY(&unmeasured, &node.plant.state, sizeof unmeasured);
}

static void a_free_run_drops_samples_without_room_and_tells_so(void) {
    measure(0, 1, false);
    bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 500, 0);
    bench_pass_ms(20);
    TEST_ASSERT_EQUAL_UINT32(20, frames_heard());
    bench_pass_ms(LACONIC_XCP_QUEUE + 10);
    TEST_ASSERT_TRUE(hear());
    TEST_ASSERT_TRUE(answer[0] == 0xFD && answer[1] == 6 && answer_length == 2);
    TEST_ASSERT_EQUAL_UINT32(LACONIC_XCP_QUEUE, frames_heard());
    DONE_BY(0xDD, 0);
    bench_pass_ms(4);
    TEST_ASSERT_EQUAL_UINT32(0, frames_heard());
    measure(0, 1, false);
    node.plant.state.zeta[0].value = LACONIC_EPSILON / (laconic_real)0; /* the core refuses the step */
    bench_pass_ms(2);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
}

static void a_vehicle_without_what_is_measured_ends_the_session(void) {
    measure(0, 1, false);
    node.xcp.entry[0] = OUTPUT(32, 1) | (uint32_t)4 << 24; /* the voltage of the second wheel */
    bench_load(1);
    laconic_xcp_adopt(&node, &node.plant.vehicle);
    bench_start_lockstep();
    bench_step(2);
    TEST_ASSERT_TRUE(hear() && answer[0] == 0xFD && answer[1] == 7);
    TEST_ASSERT_EQUAL(1, ASK(0xFD));
}

static void sensors_watch_while_a_master_reads_them(void) {
    bench_start_lockstep();
    TEST_ASSERT_FALSE(laconic_node_watches(&node));
    (void)real_at(OUTPUT(IMU, 4));
    TEST_ASSERT_TRUE(laconic_node_watches(&node));
    bench_step(3);
    TEST_ASSERT_TRUE(node.sensors.newest == 3);
    DONE_BY(0xFE);
    TEST_ASSERT_FALSE(laconic_node_watches(&node));
}

static void events_and_resolutions_are_described(void) {
    DONE_BY(0xD7, 0, 0, 0);
    TEST_ASSERT_TRUE(answer[1] == 4 && answer[3] == 4 && answer[4] == 100 && answer[5] == 4); /* 100 times 10 us */
    DONE_BY(0xF5, 4);
    TEST_ASSERT_EQUAL_MEMORY("step", answer + 1, 4);
    DONE_BY(0xD7, 0, 1, 0);
    TEST_ASSERT_TRUE(answer[4] == 100 && answer[5] == 5);
    node.plant.integrator.step_s = (laconic_real)1 / 3000;
    DONE_BY(0xD7, 0, 0, 0);
    TEST_ASSERT_TRUE(answer[4] == 0 && answer[5] == 0);
    DONE_BY(0xD9);
    const uint8_t resolution[8] = {0xFF, 1, 7, 0, 0, 0x34, 1, 0};
    TEST_ASSERT_EQUAL_MEMORY(resolution, answer, 8);
    measure(0, 1, true);
    DONE_BY(0xDA);
    const uint8_t processor[8] = {0xFF, 0x93, 1, 0, LACONIC_XCP_EVENTS, 0, 0, 0};
    TEST_ASSERT_EQUAL_MEMORY(processor, answer, 8);
}

static void outputs_are_those_of_the_vehicle(void) {
    bench_start_lockstep();
    bench_step(30);
    laconic_real nu[3];
    laconic_nu(&node.plant.model, &node.plant.state, nu);
    for (uint32_t k = 0; k < 3; k++) TEST_ASSERT_EQUAL_FLOAT((float)nu[k], real_at(OUTPUT(24, k)));
    TEST_ASSERT_EQUAL_FLOAT(5, real_at(OUTPUT(32, 1)));
    TEST_ASSERT_EQUAL_FLOAT((float)laconic_plant_energy_J(&node.plant), real_at(OUTPUT(28, 0)));
    TEST_ASSERT_EQUAL_FLOAT(0, real_at(OUTPUT(36, 1)));
    TEST_ASSERT_EQUAL_UINT32(30, word_at(OUTPUT(0, 0)));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_slave_without_a_master_is_silent);
    RUN_TEST(frames_that_no_master_sends_count_as_malformed);
    RUN_TEST(the_slave_names_itself_and_its_modes);
    RUN_TEST(a_number_of_the_working_page_acts_from_the_next_step_on);
    RUN_TEST(a_refused_number_is_named_and_changes_nothing);
    RUN_TEST(a_number_that_is_there_keeps_its_hidden_digits);
    RUN_TEST(the_node_runs_on_the_page_that_the_master_sets);
    RUN_TEST(an_impossible_page_is_refused_by_name_and_the_node_stays_on_its_own);
    RUN_TEST(a_number_in_parts_acts_when_its_last_byte_has_come);
    RUN_TEST(integers_flags_and_kinds_are_numbers_of_the_page);
    RUN_TEST(the_checksum_is_that_of_the_bytes_that_a_master_reads);
    RUN_TEST(wrong_requests_have_their_codes);
    RUN_TEST(wrong_requests_of_measurement_have_their_codes);
    RUN_TEST(without_a_sound_vehicle_there_is_nothing_to_read_or_write);
    RUN_TEST(vehicles_with_hinges_are_read_but_not_calibrated);
    RUN_TEST(samples_have_the_time_of_their_step_and_none_is_lost);
    RUN_TEST(a_prescaler_takes_each_so_many_events_until_the_list_stops);
    RUN_TEST(measured_steps_are_the_same_to_the_last_bit);
    RUN_TEST(a_free_run_drops_samples_without_room_and_tells_so);
    RUN_TEST(a_vehicle_without_what_is_measured_ends_the_session);
    RUN_TEST(sensors_watch_while_a_master_reads_them);
    RUN_TEST(events_and_resolutions_are_described);
    RUN_TEST(outputs_are_those_of_the_vehicle);
    return UNITY_END();
}
