#include "laconic/laconic.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void every_field_has_a_name(void)
{
    TEST_ASSERT_EQUAL_INT(43, LACONIC_FIELD_COUNT);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_field_has_a_name);
    return UNITY_END();
}
