/* Tests of loader.c: its beginning, the numbers of its fields, and what its checksum is of. */
#include "laconic_node/crc.h"
#include "laconic_node/loader.h"
#include "laconic_wire.h"
#include "unity.h"

#include <string.h>

static laconic_loader loader;

void setUp(void) { laconic_loader_begin(&loader); }
void tearDown(void) {}

/* CRC-32 of the upper half's bit and the six bytes behind it, of each frame: not of its protection. */
static void the_checksum_is_that_of_what_a_frame_tells(void) {
    static const uint8_t told[7] = {0x10, 1, 0, 0x11, 0x22, 0x33, 0x44};
    uint8_t data[9] = {0xAA, 0x1B, 1, 0, 0x11, 0x22, 0x33, 0x44, 0xBB};
    laconic_loader_take(&loader, data);
    TEST_ASSERT_EQUAL_HEX32(laconic_crc32(LACONIC_CRC32_START, told, 7), loader.checksum);
    TEST_ASSERT_EQUAL_UINT16(1, loader.frame_count);
}

static void a_loader_begins_with_the_usual_plan_of_drives(void) {
    laconic_drive_plan usual;
    memset(&usual, 0, sizeof usual);
    laconic_drive_plan_begin(&usual);
    TEST_ASSERT_EQUAL_MEMORY(&usual, &loader.parameters.drives, sizeof usual);
}

/* laconic.dbc and the rows of vehicle.h, settings.h and sensors.h each have the number. */
static void the_wire_numbers_each_field_as_its_row_does(void) {
#define COMPARED(of, number, IDENTIFIER, ...) \
    TEST_ASSERT_EQUAL_MESSAGE(LACONIC_WIRE_FIELD_##IDENTIFIER, number, #IDENTIFIER);
    LACONIC_LOADER_EVERY(COMPARED)
#undef COMPARED
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_wire_numbers_each_field_as_its_row_does);
    RUN_TEST(the_checksum_is_that_of_what_a_frame_tells);
    RUN_TEST(a_loader_begins_with_the_usual_plan_of_drives);
    return UNITY_END();
}
