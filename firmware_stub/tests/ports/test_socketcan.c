/* Tests of ports/host/socketcan.c on a pair of sockets that keep the ends of frames, as those of the kernel do. */
#include "laconic_node/protection.h"
#include "socketcan.h"
#include "unity.h"

#include <errno.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static laconic_node node;
static socketcan_port port;
static int other; /* the controller's end */

void setUp(void) {
    int both[2];
    const laconic_node_config config = {LACONIC_WIRE_ID_BASE, true, laconic_method_by_number, 1,
                                        laconic_drive_protocol_by_number};
    TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, both));
    laconic_node_init(&node, &config, 0);
    memset(&port, 0, sizeof port);
    port.node = &node;
    port.socket = both[0];
    other = both[1];
}
void tearDown(void) {
    close(port.socket);
    if (other >= 0) close(other);
}

static void frames_keep_every_bit_on_the_way_through_the_kernels_structs(void) {
    static const uint8_t lengths[] = {0, 1, 7, 8, 12, 48, 64};
    for (unsigned bits = 0; bits < 16; bits++) {
        for (size_t k = 0; k < sizeof lengths; k++) {
            laconic_frame frame;
            laconic_frame back;
            struct canfd_frame raw;
            memset(&frame, 0, sizeof frame);
            frame.extended = (bits & 1U) != 0;
            frame.fd = (bits & 2U) != 0;
            frame.remote = !frame.fd && (bits & 4U) != 0;
            frame.bit_rate_switch = frame.fd && (bits & 8U) != 0;
            frame.id = frame.extended ? 0x1ABCDE12U : 0x5A3U;
            frame.length = lengths[k];
            if (!frame.fd && frame.length > 8) continue;
            for (uint8_t n = 0; n < frame.length && !frame.remote; n++) frame.data[n] = (uint8_t)(n * 7U + bits);
            const size_t size = socketcan_put(&raw, &frame);
            TEST_ASSERT_EQUAL_size_t(frame.fd ? CANFD_MTU : CAN_MTU, size);
            TEST_ASSERT_TRUE(socketcan_take(&back, &raw, size));
            TEST_ASSERT_EQUAL_MEMORY(&frame, &back, sizeof frame);
        }
    }
}

static void a_classic_frame_is_a_struct_can_frame(void) {
    const laconic_frame frame = {.id = 0x1FF, .length = 8, .data = {1, 2, 3, 4, 5, 6, 7, 8}};
    struct canfd_frame raw;
    struct can_frame classic;
    socketcan_put(&raw, &frame);
    memcpy(&classic, &raw, sizeof classic);
    TEST_ASSERT_EQUAL_HEX32(0x1FF, classic.can_id);
    TEST_ASSERT_EQUAL_UINT8(8, classic.len);
    TEST_ASSERT_EQUAL_MEMORY(frame.data, classic.data, 8);
}

static void what_is_no_frame_of_a_bus_is_passed_over(void) {
    laconic_frame frame;
    struct canfd_frame raw = {.can_id = 0x123, .len = 8};
    TEST_ASSERT_FALSE(socketcan_take(&frame, &raw, 5));
    TEST_ASSERT_FALSE(socketcan_take(&frame, &raw, 0));
    raw.can_id |= CAN_ERR_FLAG;
    TEST_ASSERT_FALSE(socketcan_take(&frame, &raw, CAN_MTU));
    raw.can_id = 0x123;
    raw.len = 9;
    TEST_ASSERT_FALSE(socketcan_take(&frame, &raw, CAN_MTU));
    raw.len = 65;
    TEST_ASSERT_FALSE(socketcan_take(&frame, &raw, CANFD_MTU));
}

static void give(const laconic_frame *frame) {
    struct canfd_frame raw;
    const size_t size = socketcan_put(&raw, frame);
    TEST_ASSERT_EQUAL_INT((int)size, (int)send(other, &raw, size, 0));
}

static bool fetch(laconic_frame *frame) {
    struct canfd_frame raw;
    const ssize_t size = recv(other, &raw, sizeof raw, MSG_DONTWAIT);
    return size > 0 && socketcan_take(frame, &raw, (size_t)size);
}

static void hello(void) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HELLO, .length = 8};
    laconic_protect_plain(LACONIC_WIRE_HELLO, frame.data, 3);
    give(&frame);
}

static void the_node_answers_on_its_socket(void) {
    laconic_frame frame;
    hello();
    TEST_ASSERT_TRUE(socketcan_round(&port, 1000));
    TEST_ASSERT_TRUE(fetch(&frame) && frame.id == LACONIC_WIRE_ID_BASE + LACONIC_WIRE_IDENTITY);
    TEST_ASSERT_TRUE(laconic_plain_is_right(LACONIC_WIRE_IDENTITY, frame.data));
    TEST_ASSERT_TRUE(fetch(&frame) && frame.id == LACONIC_WIRE_ID_BASE + LACONIC_WIRE_CHALLENGE);
    TEST_ASSERT_FALSE(fetch(&frame));
    TEST_ASSERT_TRUE(socketcan_round(&port, 100000));
    TEST_ASSERT_TRUE(fetch(&frame) && frame.id == LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HEARTBEAT);
}

static void a_frame_for_which_there_is_no_room_is_sent_later_and_none_is_lost(void) {
    laconic_frame frame;
    struct canfd_frame filling;
    memset(&filling, 0, sizeof filling);
    while (send(port.socket, &filling, CANFD_MTU, MSG_DONTWAIT) > 0) {
    }
    hello();
    TEST_ASSERT_TRUE(socketcan_round(&port, 1000));
    TEST_ASSERT_TRUE(port.waits);
    while (recv(other, &filling, sizeof filling, MSG_DONTWAIT) > 0) {
    }
    TEST_ASSERT_TRUE(socketcan_round(&port, 2000));
    TEST_ASSERT_FALSE(port.waits);
    TEST_ASSERT_TRUE(fetch(&frame) && frame.id == LACONIC_WIRE_ID_BASE + LACONIC_WIRE_IDENTITY);
    TEST_ASSERT_TRUE(fetch(&frame) && frame.id == LACONIC_WIRE_ID_BASE + LACONIC_WIRE_CHALLENGE);
}

static uint32_t stopped_clock(void) { return 500000; }

static void the_rounds_end_when_the_interface_has_gone(void) {
    close(other);
    other = -1;
    TEST_ASSERT_FALSE(socketcan_round(&port, 200000)); /* a HEARTBEAT cannot be sent */
    socketcan_serve(&port, stopped_clock);
}

static void an_interface_that_does_not_exist_is_refused(void) {
    TEST_ASSERT_EQUAL_INT(-1, socketcan_open("laconic-none"));
    TEST_ASSERT_EQUAL_INT(-1, socketcan_open("a name that is too long for an interface"));
    TEST_ASSERT_TRUE(errno != 0);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(frames_keep_every_bit_on_the_way_through_the_kernels_structs);
    RUN_TEST(a_classic_frame_is_a_struct_can_frame);
    RUN_TEST(what_is_no_frame_of_a_bus_is_passed_over);
    RUN_TEST(the_node_answers_on_its_socket);
    RUN_TEST(a_frame_for_which_there_is_no_room_is_sent_later_and_none_is_lost);
    RUN_TEST(the_rounds_end_when_the_interface_has_gone);
    RUN_TEST(an_interface_that_does_not_exist_is_refused);
    return UNITY_END();
}
