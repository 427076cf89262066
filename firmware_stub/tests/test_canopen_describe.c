/* Tests of describe.c: what tools are told of the object dictionary is what a drive answers. */
#include "canopen/describe.h"
#include "canopen_bench.h"

static const laconic_canopen_drive drive = {
    .node_id = ID,
    .encoder_counts = COUNTS,
    .torque_constant_Nm_per_A = 0.1,
    .current_limit_A = 10,
    .supply_V = 24,
};
static laconic_canopen_object object;

void setUp(void) { power_up(); }
void tearDown(void) {}

/* The described object with this index and sub-index. */
static const laconic_canopen_object *described(uint16_t index, uint8_t sub) {
    for (uint32_t k = 0; laconic_canopen_describe(k, &drive, &object); k++)
        if (object.index == index && object.sub == sub) return &object;
    TEST_FAIL_MESSAGE("the object is not described");
    return NULL;
}

static void the_list_has_each_object_of_the_dictionary_once(void) {
    static const uint16_t ranges[][2] = {{0, 0x20}, {0x1000, 0x1C04}, {0x6000, 0x6600}};
    uint32_t there = 0, listed = 0, abort;
    for (size_t k = 0; k < sizeof ranges / sizeof ranges[0]; k++)
        for (uint32_t index = ranges[k][0]; index < ranges[k][1]; index++)
            for (uint8_t sub = 0; sub < 10; sub++)
                there += canopen_find((uint16_t)index, sub, &abort) != CANOPEN_NO_ROW;
    uint32_t before = 0;
    for (; laconic_canopen_describe(listed, &drive, &object); listed++) {
        TEST_ASSERT_TRUE(canopen_find(object.index, object.sub, &abort) != CANOPEN_NO_ROW);
        const uint32_t place = (uint32_t)object.index << 8 | object.sub;
        TEST_ASSERT_TRUE(place != before || listed == 0);
        before = place;
    }
    TEST_ASSERT_EQUAL_UINT32(there, listed);
    TEST_ASSERT_FALSE(laconic_canopen_describe(UINT32_MAX, &drive, &object));
}

static void values_and_types_are_those_that_a_drive_answers_after_power_up(void) {
    uint32_t compared = 0;
    for (uint32_t k = 0; laconic_canopen_describe(k, &drive, &object); k++) {
        if (!object.has_value || (object.access & CANOPEN_R) == 0) continue;
        uint32_t value;
        uint8_t size = 0;
        TEST_ASSERT_EQUAL_HEX32(0, read_as(object.index, object.sub, &value, &size));
        TEST_ASSERT_EQUAL_UINT8(size_of(object.index, object.sub), size);
        const bool is_signed = object.type <= CANOPEN_I32;
        const int64_t answered = is_signed ? get(object.index, object.sub) : (int64_t)value;
        TEST_ASSERT_EQUAL_INT64(answered, object.value);
        compared++;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(100, compared);
    TEST_ASSERT_EQUAL_INT64(-3, described(0x60C2, 2)->value);
    TEST_ASSERT_EQUAL_INT64(0xFFFFFFFFLL, described(0x6065, 0)->value);
    TEST_ASSERT_EQUAL_INT64(24000, described(0x6079, 0)->value);
}

static void texts_and_an_empty_history_have_no_value(void) {
    TEST_ASSERT_FALSE(described(0x1008, 0)->has_value);
    TEST_ASSERT_EQUAL_UINT8(CANOPEN_STRING, object.type);
    TEST_ASSERT_FALSE(described(0x1003, 1)->has_value);
    TEST_ASSERT_TRUE(described(0x1003, 0)->has_value);
}

static void ranges_narrower_than_the_type_are_told(void) {
    TEST_ASSERT_TRUE(described(0x6072, 0)->has_limits);
    TEST_ASSERT_TRUE(object.low == 0 && object.high == 1000);
    TEST_ASSERT_TRUE(described(0x60C2, 2)->has_limits);
    TEST_ASSERT_TRUE(object.low == -6 && object.high == 0);
    TEST_ASSERT_FALSE(described(0x6040, 0)->has_limits);
    TEST_ASSERT_FALSE(described(0x60C2, 0)->has_limits);
    TEST_ASSERT_TRUE(described(0x6083, 0)->has_limits && object.low == 1 && object.high == 0xFFFFFFFFLL);
}

static void arrays_and_records_have_their_names_and_rows_tell_how_many_they_are(void) {
    TEST_ASSERT_EQUAL_UINT8(CANOPEN_RECORD, described(0x1018, 2)->group);
    TEST_ASSERT_EQUAL_STRING("Identity object", object.group_name);
    TEST_ASSERT_EQUAL_STRING("Product code", object.name);
    TEST_ASSERT_FALSE(object.is_one_of_many);
    TEST_ASSERT_EQUAL_UINT8(CANOPEN_ARRAY, described(0x1003, 2)->group);
    TEST_ASSERT_TRUE(object.is_one_of_many);
    TEST_ASSERT_EQUAL_UINT8(0, described(0x6040, 0)->group);
    TEST_ASSERT_EQUAL_HEX8(CANOPEN_R | CANOPEN_W | CANOPEN_RX, object.access);
    TEST_ASSERT_EQUAL_STRING("Mapped object", described(0x1A03, 4)->name); /* of the fourth PDO, too */
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_list_has_each_object_of_the_dictionary_once);
    RUN_TEST(values_and_types_are_those_that_a_drive_answers_after_power_up);
    RUN_TEST(texts_and_an_empty_history_have_no_value);
    RUN_TEST(ranges_narrower_than_the_type_are_told);
    RUN_TEST(arrays_and_records_have_their_names_and_rows_tell_how_many_they_are);
    return UNITY_END();
}
