/* Tests of faults by order, laconic_drive_order(), as the controllers of every protocol meet them. */
#include "drive_bench.h"

enum { FIRST_ID = 1, SECOND_ID = 2 };

/* What belongs to a protocol: commands for both drives, and what they send by themselves or are asked for. */
typedef struct told {
    const laconic_drive_protocol *protocol;
    void (*command)(void); /* both drives push forward, and answer where the protocol has no cyclic frames */
    bool (*is_of_second)(const laconic_frame *frame);
    bool (*is_sign_of_life)(const laconic_frame *frame);
} told;

void setUp(void) {}
void tearDown(void) {}

/* ------------------------------------------------------------------------------- protocols -- */

static void sdo(uint32_t node_id, uint8_t head, uint16_t index, uint32_t value) {
    const uint8_t data[8] = {head,
                             (uint8_t)(index & 255U),
                             (uint8_t)(index >> 8),
                             0,
                             (uint8_t)(value & 255U),
                             (uint8_t)(value >> 8 & 255U),
                             (uint8_t)(value >> 16 & 255U),
                             0};
    bench_send(0x600 + node_id, data, 8);
}

static void canopen(void) {
    static const uint8_t words[] = {6, 7, 15};
    for (uint32_t id = FIRST_ID; id <= SECOND_ID; id++) {
        sdo(id, 0x2B, 0x1017, 20);
        sdo(id, 0x2F, 0x6060, 3);
        for (int k = 0; k < 3; k++) sdo(id, 0x2B, 0x6040, words[k]);
        sdo(id, 0x23, 0x60FF, 100000);
    }
}
static bool canopen_second(const laconic_frame *frame) { return (frame->id & 127U) == SECOND_ID; }
static bool canopen_alive(const laconic_frame *frame) { return frame->id == 0x700 + SECOND_ID; }

static void robomaster(void) {
    const uint8_t data[8] = {0x10, 0, 0x10, 0};
    bench_send(0x200, data, 8);
}
static bool robomaster_second(const laconic_frame *frame) { return frame->id == 0x200 + SECOND_ID; }

static void odrive(void) {
    static const uint8_t state[4] = {8}, modes[8] = {1, 0, 0, 0, 1}, torque[4] = {0, 0, 0, 0x3F};
    for (uint32_t id = FIRST_ID; id <= SECOND_ID; id++) {
        bench_send(id << 5 | 0x0B, modes, 8);
        bench_send(id << 5 | 0x07, state, 4);
        bench_send(id << 5 | 0x0E, torque, 4);
    }
}
static bool odrive_second(const laconic_frame *frame) { return frame->id >> 5 == SECOND_ID; }
static bool odrive_alive(const laconic_frame *frame) { return frame->id == (SECOND_ID << 5 | 1); }

/* Mode 10, velocity 1 turn/s, no timeout; then asks for mode. */
static void moteus(void) {
    static const uint8_t data[] = {0x01, 0x00, 10,   0x0D, 0x20, 0, 0, 0xC0, 0x7F, 0x0D, 0x21, 0,
                                   0,    0x80, 0x3F, 0x0D, 0x27, 0, 0, 0xC0, 0x7F, 0x11, 0x00, 0x50};
    bench_send(0x8000 | FIRST_ID, data, sizeof data);
    bench_send(0x8000 | SECOND_ID, data, sizeof data);
}
static bool moteus_second(const laconic_frame *frame) { return frame->id >> 8 == SECOND_ID; }

static const told all[] = {{&laconic_canopen, canopen, canopen_second, canopen_alive},
                           {&laconic_odrive, odrive, odrive_second, odrive_alive},
                           {&laconic_robomaster, robomaster, robomaster_second, robomaster_second},
                           {&laconic_robomaster_c610, robomaster, robomaster_second, robomaster_second},
                           {&laconic_moteus, moteus, moteus_second, NULL}};
enum { PROTOCOLS = sizeof all / sizeof all[0] };

/* ----------------------------------------------------------------------------------- bench -- */

typedef struct heard {
    int first, second, alive; /* frames of each drive; signs of life of the second */
} heard;

static heard listen(const told *of, int steps) {
    heard now = {0, 0, 0};
    laconic_frame frame;
    for (int k = 0; k < steps; k++) {
        bench_step();
        while (drives.protocol->next_frame(&drives, &frame)) {
            ++*(of->is_of_second(&frame) ? &now.second : &now.first);
            now.alive += of->is_sign_of_life != NULL && of->is_sign_of_life(&frame);
        }
    }
    return now;
}

static void begin(const told *of) {
    bench_begin(of->protocol, FIRST_ID, 1);
    bench_steps(2);
}

/* ----------------------------------------------------------------------------------- tests -- */

static void a_drive_off_the_bus_neither_hears_nor_is_heard_and_comes_back(void) {
    for (int n = 0; n < PROTOCOLS; n++) {
        begin(&all[n]);
        laconic_drive_order(&drives.drive[1], LACONIC_DRIVE_ORDER_OFF_BUS);
        all[n].command();
        heard now = listen(&all[n], 200);
        TEST_ASSERT_TRUE_MESSAGE(now.first > 0 && now.second == 0, all[n].protocol->name);
        TEST_ASSERT_TRUE_MESSAGE(bench_speed[0] > 0 && !(bench_speed[1] > 0), all[n].protocol->name);
        laconic_drive_order(&drives.drive[1], 0);
        all[n].command();
        now = listen(&all[n], 200);
        TEST_ASSERT_TRUE_MESSAGE(now.second > 0 && bench_speed[1] > 0, all[n].protocol->name);
    }
}

static void a_silent_drive_goes_on_but_gives_no_sign_of_life(void) {
    for (int n = 0; n < PROTOCOLS; n++) {
        if (all[n].is_sign_of_life == NULL) continue;
        begin(&all[n]);
        all[n].command();
        TEST_ASSERT_TRUE_MESSAGE(listen(&all[n], 200).alive > 0, all[n].protocol->name);
        laconic_drive_order(&drives.drive[1], LACONIC_DRIVE_ORDER_SILENT);
        const laconic_real before = bench_speed[1];
        all[n].command();
        TEST_ASSERT_TRUE_MESSAGE(listen(&all[n], 200).alive == 0, all[n].protocol->name);
        TEST_ASSERT_TRUE_MESSAGE(bench_speed[1] >= before, all[n].protocol->name);
        laconic_drive_order(&drives.drive[1], 0);
        TEST_ASSERT_TRUE_MESSAGE(listen(&all[n], 200).alive > 0, all[n].protocol->name);
    }
}

static void an_order_replaces_the_one_before_it(void) {
    begin(&all[2]);
    laconic_drive_order(&drives.drive[0], LACONIC_DRIVE_FAULT_ENCODER | LACONIC_DRIVE_ORDER_HELD);
    TEST_ASSERT_TRUE(drives.drive[0].brake_Nm > 0);
    laconic_drive_order(&drives.drive[0], LACONIC_DRIVE_FAULT_SUPPLY);
    TEST_ASSERT_TRUE(drives.drive[0].brake_Nm == 0);
    laconic_drive_clear(&drives.drive[0]);
    TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_FAULT_SUPPLY, drives.drive[0].faults);
    laconic_drive_order(&drives.drive[0], 0);
    laconic_drive_clear(&drives.drive[0]);
    TEST_ASSERT_EQUAL_UINT32(0, drives.drive[0].faults);
}

static void an_order_that_is_repeated_changes_nothing(void) {
    begin(&all[2]);
    robomaster();
    bench_steps(20);
    const laconic_wheel_drive before = drives.drive[0];
    laconic_drive_order(&drives.drive[0], 0);
    TEST_ASSERT_EQUAL_MEMORY(&before, &drives.drive[0], sizeof before);
}

static void a_drive_that_goes_off_the_bus_takes_back_what_was_due(void) {
    for (int n = 0; n < PROTOCOLS; n++) {
        begin(&all[n]);
        all[n].command();
        listen(&all[n], 200);
        all[n].command();
        laconic_drive_order(&drives.drive[1], LACONIC_DRIVE_ORDER_OFF_BUS);
        const heard now = listen(&all[n], 200);
        TEST_ASSERT_TRUE_MESSAGE(now.first > 0 && now.second == 0, all[n].protocol->name);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_drive_off_the_bus_neither_hears_nor_is_heard_and_comes_back);
    RUN_TEST(a_silent_drive_goes_on_but_gives_no_sign_of_life);
    RUN_TEST(an_order_replaces_the_one_before_it);
    RUN_TEST(an_order_that_is_repeated_changes_nothing);
    RUN_TEST(a_drive_that_goes_off_the_bus_takes_back_what_was_due);
    return UNITY_END();
}
