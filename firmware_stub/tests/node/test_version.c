/* Tests of the version in IDENTITY, with that of other_version.h: that of today has 0 in two of its three parts. */
#include "laconic_dbc.h"
#include "node_internal.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void every_part_of_a_version_is_told_with_all_its_digits(void) {
    static laconic_node node;
    uint8_t data[LACONIC_FRAME_BYTES];
    struct laconic_dbc_identity_t identity;
    node.config.method = laconic_method_by_number;
    laconic_node_pack(&node, LACONIC_WIRE_IDENTITY, data);
    TEST_ASSERT_EQUAL_INT(0, laconic_dbc_identity_unpack(&identity, data, 8));
    TEST_ASSERT_EQUAL_UINT8(12, identity.version_major);
    TEST_ASSERT_EQUAL_UINT8(34, identity.version_minor);
    TEST_ASSERT_EQUAL_UINT8(56, identity.version_patch);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_part_of_a_version_is_told_with_all_its_digits);
    return UNITY_END();
}
