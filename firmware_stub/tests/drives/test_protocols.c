/* Tests of protocols.c: what a node may rely on of every protocol of drives. */
#include "laconic_node/node.h"
#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static void every_listed_protocol_is_whole_and_fits_the_node(void) {
    int found = 0;
    for (int32_t number = -3; number < 20; number++) {
        const laconic_drive_protocol *protocol = laconic_drive_protocol_by_number(number);
        if (protocol == NULL) continue;
        found++;
        TEST_ASSERT_TRUE(number > 0 && protocol->name != NULL && protocol->axis_bytes <= LACONIC_NODE_AXIS_BYTES);
        TEST_ASSERT_TRUE(protocol->axis_bytes % sizeof(uint32_t) == 0 && protocol->axis_bytes > 0);
        TEST_ASSERT_TRUE(protocol->first_id >= 0 && protocol->last_id > protocol->first_id);
        TEST_ASSERT_TRUE(protocol->start && protocol->on_frame && protocol->on_step && protocol->next_frame);
    }
    TEST_ASSERT_TRUE(found >= 2);
}

static void the_numbers_are_those_of_the_wire(void) {
    TEST_ASSERT_EQUAL_PTR(&laconic_canopen, laconic_drive_protocol_by_number(1));
    TEST_ASSERT_EQUAL_PTR(&laconic_odrive, laconic_drive_protocol_by_number(2));
    TEST_ASSERT_EQUAL_PTR(&laconic_moteus, laconic_drive_protocol_by_number(4));
    TEST_ASSERT_EQUAL_PTR(&laconic_robomaster, laconic_drive_protocol_by_number(3));
    TEST_ASSERT_EQUAL_PTR(&laconic_robomaster_c610, laconic_drive_protocol_by_number(5));
    TEST_ASSERT_NULL(laconic_drive_protocol_by_number(0));
    TEST_ASSERT_NULL(laconic_drive_protocol_by_number(6));
}

static void the_ids_of_drives_are_those_of_their_buses(void) {
    static const int16_t ids[6][2] = {{0, 0}, {1, 127}, {0, 62}, {1, 8}, {1, 126}, {1, 8}};
    for (int32_t number = 1; number <= 5; number++) {
        const laconic_drive_protocol *protocol = laconic_drive_protocol_by_number(number);
        TEST_ASSERT_EQUAL_INT16(ids[number][0], protocol->first_id);
        TEST_ASSERT_EQUAL_INT16(ids[number][1], protocol->last_id);
    }
}

/* Whatever it is called for: what belongs to a drive beyond the last is not its own. */
static void a_protocol_touches_its_own_drives_alone(void) {
    static const laconic_drive_settings settings = {
        .node_id = 1, .encoder_counts = 4096, .gear_ratio = 1, .torque_constant_Nm_per_A = 1, .current_limit_A = 1};
    static uint64_t axes[3 * LACONIC_NODE_AXIS_BYTES / sizeof(uint64_t)];
    static laconic_drives drives;
    for (int32_t number = 1; number <= 5; number++) {
        const laconic_drive_protocol *protocol = laconic_drive_protocol_by_number(number);
        laconic_frame frame = {.length = 8, .data = {1, 0}};
        uint8_t *axis = (uint8_t *)axes;
        memset(&drives, 0, sizeof drives);
        memset(axes, 0, sizeof axes);
        memset(axis + 2 * protocol->axis_bytes, 0xA5, protocol->axis_bytes);
        drives.protocol = protocol;
        drives.axes = axes;
        drives.count = 2;
        drives.step_s = (laconic_real)0.001;
        for (int k = 0; k < 3; k++) {
            laconic_drive_start(&drives.drive[k], &settings);
            drives.drive[k].settings.node_id += k;
        }
        memset(&drives.drive[2], 0xA5, sizeof drives.drive[2]);
        protocol->start(&drives, 0);
        for (frame.id = 0; frame.id < 0x800; frame.id++) protocol->on_frame(&drives, &frame, 1000);
        for (uint32_t k = 1; k <= 200; k++) {
            protocol->on_step(&drives, 1000 * k);
            while (protocol->next_frame(&drives, &frame)) continue;
        }
        TEST_ASSERT_EACH_EQUAL_HEX8(0xA5, axis + 2 * protocol->axis_bytes, protocol->axis_bytes);
        TEST_ASSERT_EACH_EQUAL_HEX8(0xA5, &drives.drive[2], sizeof drives.drive[2]);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_listed_protocol_is_whole_and_fits_the_node);
    RUN_TEST(the_numbers_are_those_of_the_wire);
    RUN_TEST(the_ids_of_drives_are_those_of_their_buses);
    RUN_TEST(a_protocol_touches_its_own_drives_alone);
    return UNITY_END();
}
