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
    end_test();
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

/* An instance, a kept state and one that was read, and all that a refusal had begun. */
static void what_was_allocated_is_freed(void) {
    static fmi2Byte bytes[65536];
    static const fmi2CallbackFunctions callbacks = {log_2, calloc, free, NULL, NULL};
    const int before = short_memory_blocks;
    fmi2FMUstate kept = NULL, read = NULL;
    size_t size = 0;
    OK(fmi2GetFMUstate(c, &kept));
    TEST_ASSERT_EQUAL_INT(before + 1, short_memory_blocks);
    OK(fmi2SerializedFMUstateSize(c, kept, &size));
    OK(fmi2SerializeFMUstate(c, kept, bytes, size));
    TEST_ASSERT_EQUAL_INT(before + 1, short_memory_blocks);
    OK(fmi2DeSerializeFMUstate(c, bytes, size, &read));
    TEST_ASSERT_EQUAL_INT(before + 2, short_memory_blocks);
    OK(fmi2FreeFMUstate(c, &read));
    OK(fmi2FreeFMUstate(c, &kept));
    TEST_ASSERT_NULL(kept);
    TEST_ASSERT_EQUAL_INT(before, short_memory_blocks);
    bytes[30]++;
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, size, &read), "damaged");
    TEST_ASSERT_EQUAL_INT(before, short_memory_blocks);
    TEST_ASSERT_NULL(fmi2Instantiate("one", fmi2CoSimulation, "{another}", "/nowhere", &callbacks, 0, 0));
    TEST_ASSERT_NULL(make_2(fmi2CoSimulation, "{another}"));
    TEST_ASSERT_NULL(
        fmi3InstantiateCoSimulation("a", fmu_token_3, NULL, false, true, false, false, NULL, 1, NULL, log_3, NULL));
    TEST_ASSERT_EQUAL_INT(before, short_memory_blocks);
    fmi3Instance third = make_3(false);
    fmi3FMUState of_third = NULL;
    TEST_ASSERT_EQUAL_INT(before + 2, short_memory_blocks); /* itself and its name */
    OK(fmi3GetFMUState(third, &of_third));
    TEST_ASSERT_EQUAL_INT(before + 3, short_memory_blocks);
    OK(fmi3FreeFMUState(third, &of_third));
    TEST_ASSERT_NULL(of_third);
    TEST_ASSERT_EQUAL_INT(before + 2, short_memory_blocks);
    fmi3FreeInstance(third);
    fmi2FreeInstance(make_2(fmi2CoSimulation, fmu_token_2));
    TEST_ASSERT_EQUAL_INT(before, short_memory_blocks);
}

/* A board's importer counts on it: no call asks for more than what it keeps. */
static void an_instance_and_a_state_ask_for_their_own_size(void) {
    static fmi2Byte bytes[65536];
    fmi2FMUstate kept = NULL, read = NULL;
    size_t size = 0;
    fmi2FreeInstance(make_2(fmi2CoSimulation, fmu_token_2));
    TEST_ASSERT_EQUAL(sizeof(fmu_instance), short_memory_asked);
    OK(fmi2GetFMUstate(c, &kept));
    const size_t asked = short_memory_asked;
    TEST_ASSERT_TRUE(asked > sizeof(fmu_model) && asked < sizeof(fmu_model) + 256);
    OK(fmi2SerializedFMUstateSize(c, kept, &size));
    OK(fmi2SerializeFMUstate(c, kept, bytes, size));
    OK(fmi2DeSerializeFMUstate(c, bytes, size, &read));
    TEST_ASSERT_EQUAL(asked, short_memory_asked);
    OK(fmi2FreeFMUstate(c, &read));
    OK(fmi2FreeFMUstate(c, &kept));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(an_instance_needs_memory_for_itself_and_its_name);
    RUN_TEST(start_values_from_a_file_need_memory);
    RUN_TEST(a_state_is_kept_and_written_as_far_as_there_is_memory);
    RUN_TEST(what_was_allocated_is_freed);
    RUN_TEST(an_instance_and_a_state_ask_for_their_own_size);
    return UNITY_END();
}
