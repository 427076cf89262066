/* Tests of a node whose core reads no inputs and has neither pose nor wheel angles: SELECT refuses what would do
 * nothing or show nothing, so that no rig believes in it. */
#include "bench.h"
#include "unity.h"

void setUp(void) {
    bench_begin();
    bench_load(2);
}
void tearDown(void) {}

static void inputs_that_the_core_does_not_read_are_refused(void) {
    for (unsigned bit = 0; bit < 8; bit++) {
        const uint8_t take = (uint8_t)(1U << bit);
        if ((take & LACONIC_RAW_TAKES) == 0) continue;
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, bench_select(0, 0, take));
        TEST_ASSERT_EQUAL_UINT8(0, node.raw_input.take);
    }
}

static void outputs_that_the_core_does_not_compute_are_refused(void) {
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, bench_select(LACONIC_NODE_SEND_POSE, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, bench_select(LACONIC_NODE_SEND_WHEEL_ANGLE, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, bench_select(0, LACONIC_RAW_POSE, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_NOT_SUPPORTED, bench_select(0, LACONIC_RAW_WHEEL_ANGLE, 0));
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(LACONIC_NODE_SEND_NU, LACONIC_RAW_NU | LACONIC_RAW_WHEEL_SPEED, 0));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(inputs_that_the_core_does_not_read_are_refused);
    RUN_TEST(outputs_that_the_core_does_not_compute_are_refused);
    return UNITY_END();
}
