/* Tests of loader.c as small images build it, without what this program's macros set to 0: a field that laconic.dbc has
 * and the build has not is told from one that nobody knows. */
#include "laconic_dbc.h"
#include "laconic_node/loader.h"
#include "laconic_wire.h"
#include "unity.h"

static laconic_loader loader;

void setUp(void) { laconic_loader_begin(&loader); }
void tearDown(void) {}

static uint8_t status_of(int field, uint8_t item) {
    const struct laconic_dbc_parameter_t frame = {.field = (uint8_t)field, .item = item};
    uint8_t data[8];
    laconic_loader_begin(&loader);
    laconic_dbc_parameter_pack(data, &frame, 8);
    laconic_loader_take(&loader, data);
    return loader.status;
}

/* Of laconic.dbc's table: motors, wheels' own values, friction and currents, a slope, drives, sensors, hinges whose
 * wheels slip. */
static const uint8_t first_and_last[][2] = {
    {37, 42}, {43, 47}, {48, 53}, {56, 62}, {64, 79}, {80, 95}, {121, 137}, {139, 139},
#if !LACONIC_WITH_SLOPE
    {54, 55},
#endif
};

static bool is_left_out(int field) {
    bool within = false;
    for (size_t k = 0; k < sizeof first_and_last / sizeof first_and_last[0]; k++)
        within = within || (field >= first_and_last[k][0] && field <= first_and_last[k][1]);
    return within;
}

/* Item 200 is none of any field. */
static void every_field_that_is_left_out_is_refused_by_name_and_no_other(void) {
    for (int field = 0; field < 256; field++) {
        TEST_ASSERT_EQUAL_UINT8(is_left_out(field) ? LACONIC_WIRE_STATUS_NOT_SUPPORTED
                                                   : LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN,
                                status_of(field, 200));
        TEST_ASSERT_TRUE(loader.field == field && loader.item == 200);
    }
}

static void what_is_left_has_its_items(void) {
    TEST_ASSERT_EQUAL_UINT8(0, status_of(LACONIC_FIELD_MASS, 0));
    TEST_ASSERT_EQUAL_UINT8(0, status_of(LACONIC_FIELD_WHEEL_KIND, LACONIC_MAX_WHEELS));
    TEST_ASSERT_EQUAL_UINT8(0, status_of(LACONIC_FIELD_START_NU, 3));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WITH_SLOPE ? 0 : LACONIC_WIRE_STATUS_NOT_SUPPORTED,
                            status_of(LACONIC_FIELD_SLOPE, 0));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_field_that_is_left_out_is_refused_by_name_and_no_other);
    RUN_TEST(what_is_left_has_its_items);
    return UNITY_END();
}
