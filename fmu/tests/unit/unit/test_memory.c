/* Tests of short memory: what cannot be allocated is refused, and nothing is lost or changed. */
#include "fmi2_bench.h"
#include "short_memory.h"

void setUp(void) {
    log_clear();
    c = NULL;
    make(fmi2CoSimulation);
    initialise();
}
void tearDown(void) {
    short_memory_left = -1;
    fmi2FreeInstance(c);
    c = NULL;
}

static void an_instance_needs_memory_for_itself_and_its_name(void) {
    for (short_memory_left = 0; short_memory_left < 2;) {
        const int left = short_memory_left;
        TEST_ASSERT_NULL(make_2(fmi2CoSimulation, fmu_token_2));
        TEST_ASSERT_EQUAL_INT(0, short_memory_left);
        short_memory_left = left;
        TEST_ASSERT_NULL(make_3(false));
        short_memory_left = left + 1;
    }
    fmi2Component other = make_2(fmi2CoSimulation, fmu_token_2);
    TEST_ASSERT_NOT_NULL(other);
    fmi2FreeInstance(other);
}

static void start_values_from_a_file_need_memory(void) {
    static const fmi2CallbackFunctions callbacks = {log_2, calloc, free, NULL, NULL};
    short_memory_left = 2;
    TEST_ASSERT_NULL(fmi2Instantiate("one", fmi2CoSimulation, "{another}", "/nowhere", &callbacks, 0, 0));
    ASSERT_LOGGED("out of memory");
}

static void a_state_is_kept_and_written_as_far_as_there_is_memory(void) {
    static fmi2Byte bytes[65536];
    fmi2FMUstate kept = NULL, read = NULL;
    size_t size = 0;
    short_memory_left = 0;
    ASSERT_REFUSED(fmi2GetFMUstate(c, &kept), "GetFMUState: out of memory");
    TEST_ASSERT_NULL(kept);
    short_memory_left = -1;
    OK(fmi2GetFMUstate(c, &kept));
    short_memory_left = 0;
    OK(fmi2GetFMUstate(c, &kept)); /* into what is there */
    ASSERT_REFUSED(fmi2SerializedFMUstateSize(c, kept, &size), "SerializedFMUStateSize: out of memory");
    ASSERT_REFUSED(fmi2SerializeFMUstate(c, kept, bytes, 8), "SerializeFMUState: out of memory");
    short_memory_left = 1;
    OK(fmi2SerializedFMUstateSize(c, kept, &size));
    short_memory_left = 1;
    OK(fmi2SerializeFMUstate(c, kept, bytes, size));
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, size, &read), "DeserializeFMUState: out of memory");
    TEST_ASSERT_NULL(read);
    OK(fmi2FreeFMUstate(c, &kept));
    OK(fmi2FreeFMUstate(c, NULL));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_instance_needs_memory_for_itself_and_its_name);
    RUN_TEST(start_values_from_a_file_need_memory);
    RUN_TEST(a_state_is_kept_and_written_as_far_as_there_is_memory);
    return UNITY_END();
}
