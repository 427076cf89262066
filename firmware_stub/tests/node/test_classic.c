/* Tests of a node that was built without CAN FD (LACONIC_NODE_CAN_FD=0), whose frames have room for eight bytes. */
#include "bench.h"
#include "laconic_node/slcan.h"
#include "unity.h"

void setUp(void) { bench_begin(); }
void tearDown(void) {}

/* Whatever a frame of CAN FD says of itself: its numbers would not fit. */
static void frames_of_can_fd_are_malformed_and_change_nothing(void) {
    uint16_t frames = 0;
    for (uint32_t offset = 0; offset < LACONIC_WIRE_RIG_OFFSETS; offset++) {
        if (laconic_wire[offset].fd == 0) continue;
        for (int kind = 0; kind < 4; kind++) {
            const laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + offset,
                                         .length = kind & 1 ? laconic_wire[offset].length : 8,
                                         .fd = kind >= 2};
            laconic_node_on_frame(&node, &frame, now_us);
            TEST_ASSERT_EQUAL_UINT16(++frames, node.counters.malformed);
            TEST_ASSERT_TRUE(node.counters.crc_errors == 0 && node.counters.refused == 0);
        }
    }
    TEST_ASSERT_TRUE(frames > 0);
}

static void it_is_loaded_and_steps_by_classic_frames(void) {
    bench_load(2);
    TEST_ASSERT_EQUAL_UINT8(0, bench_start_lockstep());
    bench_voltage(0, 1000, 0);
    bench_sync(1);
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(1, node.plant.steps);
    TEST_ASSERT_EQUAL_UINT16(0, node.counters.malformed);
}

static void no_frame_of_can_fd_can_be_asked_for(void) {
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(LACONIC_NODE_SEND_POSE, 0, 0));
    TEST_ASSERT_TRUE(bench_select(LACONIC_NODE_SEND_STATE_FD, 0, 0) != 0);
    TEST_ASSERT_TRUE(node.send == LACONIC_NODE_SEND_POSE);
}

static void it_does_not_begin_on_a_bus_of_can_fd(void) {
    laconic_node_config config = node.config;
    config.can_fd = true;
    TEST_ASSERT_FALSE(laconic_node_init(&node, &config, now_us));
    config.can_fd = false;
    TEST_ASSERT_TRUE(laconic_node_init(&node, &config, now_us));
}

/* A port that goes on with a configuration that was refused, or whose memory changed. */
static void no_frame_is_longer_than_its_room_whatever_the_configuration_says(void) {
    struct {
        laconic_frame frame;
        uint8_t behind[64];
    } read;
    struct laconic_dbc_identity_t identity = {0};
    bench_load(2);
    node.config.can_fd = true;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, bench_select(LACONIC_NODE_SEND_STATE_FD, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, bench_select(0, 0x80 | LACONIC_RAW_POSE, 0));
    TEST_ASSERT_EQUAL_UINT8(0, bench_start_lockstep());
    node.pending |= 1U << LACONIC_WIRE_IDENTITY;
    memset(&read, 0xA5, sizeof read);
    while (laconic_node_next_frame(&node, &read.frame)) {
        TEST_ASSERT_EQUAL_UINT8(8, read.frame.length);
        TEST_ASSERT_EACH_EQUAL_HEX8(0xA5, read.behind, sizeof read.behind);
        if (read.frame.id != LACONIC_WIRE_ID_BASE + LACONIC_WIRE_IDENTITY) continue;
        laconic_dbc_identity_unpack(&identity, read.frame.data, 8);
    }
    TEST_ASSERT_EQUAL(LACONIC_WIRE_VERSION, identity.protocol);
    TEST_ASSERT_EQUAL(0, identity.can_fd);
}

static int taken;

static void take(laconic_drives *drives, const laconic_frame *frame, uint32_t time_us) {
    (void)drives;
    (void)frame;
    (void)time_us;
    taken++;
}

static void drives_get_no_frame_that_is_longer_than_its_room(void) {
    static const laconic_drive_protocol counting = {.name = "counting", .on_frame = take};
    node.drives.protocol = &counting;
    node.state = LACONIC_WIRE_STATE_DRIVES;
    for (unsigned length = 0; length < 256; length++) {
        const laconic_frame frame = {.id = 1, .length = (uint8_t)length, .fd = length > 8, .extended = true};
        laconic_node_on_frame(&node, &frame, now_us);
    }
    TEST_ASSERT_EQUAL_INT(9, taken);
}

static void slcan_writes_no_frame_that_is_longer_than_its_room(void) {
    struct {
        char line[LACONIC_SLCAN_LINE];
        char behind[160];
    } text;
    laconic_slcan slcan;
    laconic_slcan_init(&slcan, 0);
    slcan.open = true;
    memset(&text, '#', sizeof text);
    for (unsigned length = 0; length < 256; length++) {
        const laconic_frame frame = {.id = 0x5A5, .length = (uint8_t)length, .fd = (length & 1U) != 0};
        const size_t written = laconic_slcan_write(&slcan, &frame, text.line);
        TEST_ASSERT_EQUAL_size_t(length <= 8 ? 6 + 2 * length : 0, written);
        TEST_ASSERT_EACH_EQUAL_CHAR('#', text.behind, sizeof text.behind);
    }
}

static void slcan_refuses_lines_of_can_fd(void) {
    const char *const lines[] = {"t2009112233445566778899\r",
                                 "d20081122334455667788\r",
                                 "b20081122334455667788\r",
                                 "d20090011223344556677889900AABB\r",
                                 "O\r",
                                 "t20081122334455667788\r"};
    const laconic_slcan_event wanted[] = {LACONIC_SLCAN_REPLY, LACONIC_SLCAN_REPLY, LACONIC_SLCAN_REPLY,
                                          LACONIC_SLCAN_REPLY, LACONIC_SLCAN_REPLY, LACONIC_SLCAN_FRAME};
    laconic_slcan slcan;
    laconic_slcan_init(&slcan, 0);
    for (int round = 0; round < 2; round++)
        for (size_t k = 0; k < sizeof lines / sizeof lines[0]; k++) {
            laconic_slcan_event event = LACONIC_SLCAN_NOTHING;
            laconic_frame frame = {0};
            for (const char *c = lines[k]; *c != 0; c++) event = laconic_slcan_feed(&slcan, *c, &frame);
            TEST_ASSERT_EQUAL(wanted[k], event);
            if (wanted[k] == LACONIC_SLCAN_FRAME) TEST_ASSERT_TRUE(frame.length == 8 && !frame.fd);
            if (k < 4) TEST_ASSERT_EQUAL_STRING("\a", slcan.reply);
        }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(frames_of_can_fd_are_malformed_and_change_nothing);
    RUN_TEST(it_is_loaded_and_steps_by_classic_frames);
    RUN_TEST(no_frame_of_can_fd_can_be_asked_for);
    RUN_TEST(it_does_not_begin_on_a_bus_of_can_fd);
    RUN_TEST(no_frame_is_longer_than_its_room_whatever_the_configuration_says);
    RUN_TEST(drives_get_no_frame_that_is_longer_than_its_room);
    RUN_TEST(slcan_writes_no_frame_that_is_longer_than_its_room);
    RUN_TEST(slcan_refuses_lines_of_can_fd);
    return UNITY_END();
}
