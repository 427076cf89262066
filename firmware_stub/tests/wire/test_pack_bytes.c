/* Tests of node_pack.c: which bytes are written and who is asked, also where a count has changed in memory. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#include "bench.h"
#include "unity.h"

void setUp(void) {
    bench_begin();
    bench_load(4);
}
void tearDown(void) {}

/* Whoever fetches a classic frame finds the rest of his 64 bytes as it was. */
static void nothing_is_written_behind_the_eighth_byte_of_a_classic_frame(void) {
    const laconic_start start = {{0, 2, 0}, 3, 4, 5, {0}};
    const laconic_sensor_settings with = {.encoder[0] = {256, 3}};
    uint8_t data[LACONIC_FRAME_BYTES];
    int frames = 0;
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_sensors_start(&node.sensors, &with, &node.plant, NULL));
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, SELECTS_ESTIMATE));
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL));
    for (uint8_t offset = LACONIC_WIRE_NODE_FIRST; offset < LACONIC_WIRE_OFFSETS; offset++) {
        if (laconic_wire[offset].length != 8) continue;
        node.answers_due = BIT_OF(LACONIC_WIRE_CONTROL);
        memset(data, 0x5A, sizeof data);
        laconic_node_pack(&node, offset, data);
        for (size_t k = 8; k < sizeof data; k++) TEST_ASSERT_EQUAL_HEX8(0x5A, data[k]);
        frames++;
    }
    TEST_ASSERT_TRUE(frames > 8);
}

static int32_t lowest_asked, highest_asked;

static const laconic_method *notes_who_is_asked_for(int32_t number) {
    lowest_asked = number < lowest_asked ? number : lowest_asked;
    highest_asked = number > highest_asked ? number : highest_asked;
    return &laconic_rk4;
}

/* A port may have but one method and give it for any number. */
static void an_identity_asks_for_methods_alone(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    lowest_asked = highest_asked = 1;
    node.config.method = notes_who_is_asked_for;
    laconic_node_pack(&node, LACONIC_WIRE_IDENTITY, data);
    TEST_ASSERT_EQUAL_INT32(0, lowest_asked);
    TEST_ASSERT_EQUAL_INT32((LACONIC_METHOD_COUNT < 8 ? LACONIC_METHOD_COUNT : 8) - 1, highest_asked); /* of 8 bits */
}

/* As a bit of the count that changes would make it; the frame before had the speeds of all wheels. */
static void a_count_of_wheels_below_none_has_no_speeds(void) {
    const laconic_start start = {{0, 2, 0}, 0, 0, 0, {0}};
    uint8_t data[LACONIC_FRAME_BYTES];
    bench_load(LACONIC_MAX_WHEELS);
    TEST_ASSERT_EQUAL(LACONIC_OK, laconic_state_set(&node.plant.state, &node.plant.model, &start, NULL));
    laconic_node_pack(&node, LACONIC_WIRE_STATE_FD, data);
    TEST_ASSERT_TRUE(word16(data + 32) != 0);
    node.plant.model.wheel_count = INT32_MIN + LACONIC_MAX_WHEELS;
    laconic_node_pack(&node, LACONIC_WIRE_STATE_FD, data);
    for (size_t k = 32; k < 64; k++) TEST_ASSERT_EQUAL_HEX8(0, data[k]);
}

/* It has changed in memory, and a node that does not move tells its heartbeat all the same. */
static void a_count_of_drives_beyond_the_largest_reads_nothing_behind_them(void) {
    uint8_t data[LACONIC_FRAME_BYTES];
    memset(node.axes, 1, sizeof node.axes); /* behind the drives */
    node.drives.count = LACONIC_MAX_WHEELS + 1000000;
    laconic_node_pack(&node, LACONIC_WIRE_HEARTBEAT, data);
    TEST_ASSERT_EQUAL_HEX8(0, data[7] & 0x80U);
    node.drives.drive[LACONIC_MAX_WHEELS - 1].unheard = true;
    laconic_node_pack(&node, LACONIC_WIRE_HEARTBEAT, data);
    TEST_ASSERT_EQUAL_HEX8(0x80, data[7] & 0x80U);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(nothing_is_written_behind_the_eighth_byte_of_a_classic_frame);
    RUN_TEST(an_identity_asks_for_methods_alone);
    RUN_TEST(a_count_of_wheels_below_none_has_no_speeds);
    RUN_TEST(a_count_of_drives_beyond_the_largest_reads_nothing_behind_them);
    return UNITY_END();
}
