/* Tests of protocols.c: what a node may rely on of every protocol of drives. */
#include "laconic_node/node.h"
#include "unity.h"

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
    TEST_ASSERT_EQUAL_PTR(&laconic_robomaster, laconic_drive_protocol_by_number(3));
    TEST_ASSERT_EQUAL_PTR(&laconic_robomaster_c610, laconic_drive_protocol_by_number(5));
    TEST_ASSERT_NULL(laconic_drive_protocol_by_number(0));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_listed_protocol_is_whole_and_fits_the_node);
    RUN_TEST(the_numbers_are_those_of_the_wire);
    return UNITY_END();
}
