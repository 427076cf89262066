/* Tests of describe.c: what tools are told of the object dictionary is what a drive answers. */
#include "canopen/describe.h"
#include "canopen_bench.h"

#include <stdio.h>

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

/* The dictionary as CiA 301 and CiA 402 have its objects, and this drive its choice of them and its defaults. */
enum { R = CANOPEN_R, RW = R | CANOPEN_W, R_TX = R | CANOPEN_TX, RW_RX = RW | CANOPEN_RX, RX = CANOPEN_RX };
#define NONE INT64_MIN
static const struct {
    uint16_t index;
    uint8_t sub, last, type, access;
    int64_t value; /* after power-up; NONE: it has none, or it is another of each PDO */
} dictionary[] = {
    {0x0002, 0, 0, CANOPEN_I8, RX, 0},
    {0x0003, 0, 0, CANOPEN_I16, RX, 0},
    {0x0004, 0, 0, CANOPEN_I32, RX, 0},
    {0x0005, 0, 0, CANOPEN_U8, RX, 0},
    {0x0006, 0, 0, CANOPEN_U16, RX, 0},
    {0x0007, 0, 0, CANOPEN_U32, RX, 0},
    {0x1000, 0, 0, CANOPEN_U32, R, 0x20192},
    {0x1001, 0, 0, CANOPEN_U8, R_TX, 0},
    {0x1003, 0, 0, CANOPEN_U8, RW, 0},
    {0x1003, 1, 4, CANOPEN_U32, R, NONE},
    {0x1005, 0, 0, CANOPEN_U32, RW, 0x80},
    {0x1008, 0, 0, CANOPEN_STRING, R, NONE},
    {0x1009, 0, 0, CANOPEN_STRING, R, NONE},
    {0x100A, 0, 0, CANOPEN_STRING, R, NONE},
    {0x1014, 0, 0, CANOPEN_U32, RW, 0x80 + ID},
    {0x1016, 0, 0, CANOPEN_U8, R, 1},
    {0x1016, 1, 1, CANOPEN_U32, RW, 0},
    {0x1017, 0, 0, CANOPEN_U16, RW, 0},
    {0x1018, 0, 0, CANOPEN_U8, R, 4},
    {0x1018, 1, 1, CANOPEN_U32, R, 0},
    {0x1018, 2, 2, CANOPEN_U32, R, 402},
    {0x1018, 3, 3, CANOPEN_U32, R, 1},
    {0x1018, 4, 4, CANOPEN_U32, R, ID},
    {0x1029, 0, 0, CANOPEN_U8, R, 1},
    {0x1029, 1, 1, CANOPEN_U8, RW, 0},
    {0x1200, 0, 0, CANOPEN_U8, R, 2},
    {0x1200, 1, 1, CANOPEN_U32, R, 0x600 + ID},
    {0x1200, 2, 2, CANOPEN_U32, R, 0x580 + ID},
    {0x1400, 0, 0, CANOPEN_U8, R, 5},
    {0x1400, 1, 1, CANOPEN_U32, RW, NONE},
    {0x1400, 2, 2, CANOPEN_U8, RW, NONE},
    {0x1400, 5, 5, CANOPEN_U16, RW, NONE},
    {0x1600, 0, 0, CANOPEN_U8, RW, NONE},
    {0x1600, 1, 4, CANOPEN_U32, RW, NONE},
    {0x1800, 0, 0, CANOPEN_U8, R, 5},
    {0x1800, 1, 1, CANOPEN_U32, RW, NONE},
    {0x1800, 2, 2, CANOPEN_U8, RW, NONE},
    {0x1800, 3, 3, CANOPEN_U16, RW, NONE},
    {0x1800, 5, 5, CANOPEN_U16, RW, NONE},
    {0x1A00, 0, 0, CANOPEN_U8, RW, NONE},
    {0x1A00, 1, 4, CANOPEN_U32, RW, NONE},
    {0x6007, 0, 0, CANOPEN_I16, RW, 1},
    {0x603F, 0, 0, CANOPEN_U16, R_TX, 0},
    {0x6040, 0, 0, CANOPEN_U16, RW_RX, 0},
    {0x6041, 0, 0, CANOPEN_U16, R_TX, 0x250},
    {0x605A, 0, 0, CANOPEN_I16, RW, 2},
    {0x605B, 0, 0, CANOPEN_I16, RW, 0},
    {0x605C, 0, 0, CANOPEN_I16, RW, 1},
    {0x605D, 0, 0, CANOPEN_I16, RW, 1},
    {0x605E, 0, 0, CANOPEN_I16, RW, 2},
    {0x6060, 0, 0, CANOPEN_I8, RW_RX, 0},
    {0x6061, 0, 0, CANOPEN_I8, R_TX, 0},
    {0x6062, 0, 0, CANOPEN_I32, R_TX, 0},
    {0x6064, 0, 0, CANOPEN_I32, R_TX, 0},
    {0x6065, 0, 0, CANOPEN_U32, RW, 0xFFFFFFFF},
    {0x6066, 0, 0, CANOPEN_U16, RW, 10},
    {0x6067, 0, 0, CANOPEN_U32, RW, 100},
    {0x606B, 0, 0, CANOPEN_I32, R_TX, 0},
    {0x606C, 0, 0, CANOPEN_I32, R_TX, 0},
    {0x606D, 0, 0, CANOPEN_U16, RW, 500},
    {0x606F, 0, 0, CANOPEN_U16, RW, 5},
    {0x6071, 0, 0, CANOPEN_I16, RW_RX, 0},
    {0x6072, 0, 0, CANOPEN_U16, RW_RX, 1000},
    {0x6075, 0, 0, CANOPEN_U32, RW, 10000},
    {0x6076, 0, 0, CANOPEN_U32, RW, 1000},
    {0x6077, 0, 0, CANOPEN_I16, R_TX, 0},
    {0x6078, 0, 0, CANOPEN_I16, R_TX, 0},
    {0x6079, 0, 0, CANOPEN_U32, R_TX, 24000},
    {0x607A, 0, 0, CANOPEN_I32, RW_RX, 0},
    {0x607F, 0, 0, CANOPEN_U32, RW_RX, 0x7FFFFFFF},
    {0x6081, 0, 0, CANOPEN_U32, RW_RX, 10000},
    {0x6083, 0, 0, CANOPEN_U32, RW_RX, 100000},
    {0x6084, 0, 0, CANOPEN_U32, RW_RX, 100000},
    {0x6085, 0, 0, CANOPEN_U32, RW_RX, 1000000},
    {0x6086, 0, 0, CANOPEN_I16, RW, 0},
    {0x608F, 0, 0, CANOPEN_U8, R, 2},
    {0x608F, 1, 1, CANOPEN_U32, RW, COUNTS},
    {0x608F, 2, 2, CANOPEN_U32, RW, 1},
    {0x6091, 0, 0, CANOPEN_U8, R, 2},
    {0x6091, 1, 1, CANOPEN_U32, RW, 1},
    {0x6091, 2, 2, CANOPEN_U32, RW, 1},
    {0x6092, 0, 0, CANOPEN_U8, R, 2},
    {0x6092, 1, 1, CANOPEN_U32, RW, COUNTS},
    {0x6092, 2, 2, CANOPEN_U32, RW, 1},
    {0x60A8, 0, 0, CANOPEN_U32, RW, 0x00B50000},
    {0x60A9, 0, 0, CANOPEN_U32, RW, 0x00B50300},
    {0x60AA, 0, 0, CANOPEN_U32, RW, 0x00B55700},
    {0x60B1, 0, 0, CANOPEN_I32, RW_RX, 0},
    {0x60B2, 0, 0, CANOPEN_I16, RW_RX, 0},
    {0x60C2, 0, 0, CANOPEN_U8, R, 2},
    {0x60C2, 1, 1, CANOPEN_U8, RW, 1},
    {0x60C2, 2, 2, CANOPEN_I8, RW, -3},
    {0x60F4, 0, 0, CANOPEN_I32, R_TX, 0},
    {0x60FF, 0, 0, CANOPEN_I32, RW_RX, 0},
    {0x6502, 0, 0, CANOPEN_U32, R, 0x385},
};

static void every_object_has_the_type_access_and_value_of_its_standard(void) {
    uint32_t number = 0;
    for (size_t k = 0; k < sizeof dictionary / sizeof dictionary[0]; k++) {
        const uint16_t first = dictionary[k].index, indices = first >= 0x1400 && first < 0x1C00 ? 4 : 1;
        for (uint16_t index = first; index < first + indices; index++)
            for (uint8_t sub = dictionary[k].sub; sub <= dictionary[k].last; sub++, number++) {
                TEST_ASSERT_TRUE(laconic_canopen_describe(number, &drive, &object));
                TEST_ASSERT_EQUAL_HEX16(index, object.index);
                TEST_ASSERT_EQUAL_UINT8(sub, object.sub);
                TEST_ASSERT_EQUAL_UINT8(dictionary[k].type, object.type);
                TEST_ASSERT_EQUAL_HEX8(dictionary[k].access, object.access);
                if (dictionary[k].value != NONE) TEST_ASSERT_EQUAL_INT64(dictionary[k].value, object.value);
            }
    }
    TEST_ASSERT_FALSE(laconic_canopen_describe(number, &drive, &object));
}

static void dummies_are_named_by_their_size(void) {
    for (uint16_t index = 2; index <= 7; index++) {
        char name[32];
        snprintf(name, sizeof name, "Dummy %s%d bit", index >= 5 ? "unsigned " : "", 8 << (index - 2) % 3);
        TEST_ASSERT_EQUAL_STRING(name, described(index, 0)->name);
    }
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

static void ranges_narrower_than_the_type_are_told_and_no_others(void) {
    static const struct {
        uint16_t index;
        uint8_t sub;
        int64_t low, high;
    } limits[] = {{0x1029, 1, 0, 2},
                  {0x6007, 0, 0, 3},
                  {0x605A, 0, 0, 6},
                  {0x605B, 0, 0, 1},
                  {0x605C, 0, 0, 1},
                  {0x605D, 0, 1, 2},
                  {0x605E, 0, 0, 2},
                  {0x6072, 0, 0, 1000},
                  {0x6083, 0, 1, 0xFFFFFFFFLL},
                  {0x6084, 0, 1, 0xFFFFFFFFLL},
                  {0x6085, 0, 1, 0xFFFFFFFFLL},
                  {0x60C2, 1, 1, 255},
                  {0x60C2, 2, -6, 0}};
    enum { LIMITS = sizeof limits / sizeof limits[0] };
    int found = 0;
    for (uint32_t k = 0; laconic_canopen_describe(k, &drive, &object); k++) {
        if (!object.has_limits) continue;
        TEST_ASSERT_LESS_THAN(LIMITS, found);
        TEST_ASSERT_EQUAL_HEX16(limits[found].index, object.index);
        TEST_ASSERT_EQUAL_UINT8(limits[found].sub, object.sub);
        TEST_ASSERT_EQUAL_INT64(limits[found].low, object.low);
        TEST_ASSERT_EQUAL_INT64(limits[found++].high, object.high);
    }
    TEST_ASSERT_EQUAL(LIMITS, found);
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
    RUN_TEST(every_object_has_the_type_access_and_value_of_its_standard);
    RUN_TEST(dummies_are_named_by_their_size);
    RUN_TEST(values_and_types_are_those_that_a_drive_answers_after_power_up);
    RUN_TEST(texts_and_an_empty_history_have_no_value);
    RUN_TEST(ranges_narrower_than_the_type_are_told_and_no_others);
    RUN_TEST(arrays_and_records_have_their_names_and_rows_tell_how_many_they_are);
    return UNITY_END();
}
