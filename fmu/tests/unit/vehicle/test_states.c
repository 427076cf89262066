/* Tests of saved_states.c: a state is kept, written as bytes, read again; damaged and foreign ones are refused. */
#include "fmi_bench.h"
#include "stream.h"

static fmi2Component c;

void setUp(void) {
    log_clear();
    c = make_2(fmi2CoSimulation, fmu_token_2);
    TEST_ASSERT_NOT_NULL(c);
}
void tearDown(void) { fmi2FreeInstance(c); }

static double x_m(void) {
    const fmi2ValueReference reference = ref("x_m", 0);
    double value = NOT_A_NUMBER;
    OK(fmi2GetReal(c, &reference, 1, &value));
    return value;
}

static void run(int steps, int first) {
    for (int k = first; k < first + steps; k++) OK(fmi2DoStep(c, k * 0.01, 0.01, fmi2True));
}

static void begin(void) {
    const fmi2ValueReference voltage[2] = {ref("voltage_V", 1), ref("voltage_V", 2)};
    const double volts[2] = {3, 2};
    OK(fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2True, 5));
    OK(fmi2EnterInitializationMode(c));
    OK(fmi2ExitInitializationMode(c));
    OK(fmi2SetReal(c, voltage, 2, volts));
}

static void a_kept_state_is_taken_up_again_bit_for_bit(void) {
    fmi2FMUstate kept = NULL;
    begin();
    run(10, 0);
    OK(fmi2GetFMUstate(c, &kept));
    run(10, 10);
    const double there = x_m();
    OK(fmi2SetFMUstate(c, kept));
    TEST_ASSERT_TRUE(x_m() != there);
    run(10, 10);
    TEST_ASSERT_TRUE(x_m() == there);
    OK(fmi2GetFMUstate(c, &kept)); /* the same memory */
    OK(fmi2FreeFMUstate(c, &kept));
    TEST_ASSERT_NULL(kept);
    OK(fmi2FreeFMUstate(c, &kept));
    ASSERT_REFUSED(fmi2SetFMUstate(c, NULL), "the saved state is missing");
    ASSERT_REFUSED(fmi2GetFMUstate(c, NULL), "the pointer to the state is missing");
}

static fmi2Byte bytes[65536];

static size_t write(void) {
    fmi2FMUstate kept = NULL;
    size_t size = 0;
    OK(fmi2GetFMUstate(c, &kept));
    OK(fmi2SerializedFMUstateSize(c, kept, &size));
    TEST_ASSERT_TRUE(size > 100 && size < sizeof bytes);
    char told[100];
    snprintf(told, sizeof told, "SerializeFMUState: %zu bytes given for a state of %zu", size - 1, size);
    ASSERT_REFUSED(fmi2SerializeFMUstate(c, kept, bytes, size - 1), told);
    ASSERT_REFUSED(fmi2SerializeFMUstate(c, kept, NULL, size), "the memory for the bytes is missing");
    ASSERT_REFUSED(fmi2SerializedFMUstateSize(c, kept, NULL), "the pointer to the size is missing");
    OK(fmi2SerializeFMUstate(c, kept, bytes, size));
    fmi2FreeFMUstate(c, &kept);
    return size;
}

static void bytes_are_read_by_another_instance(void) {
    fmi2FMUstate read = NULL;
    begin();
    run(20, 0);
    const size_t size = write();
    run(10, 20);
    const double there = x_m();
    fmi2FreeInstance(c);
    c = make_2(fmi2CoSimulation, fmu_token_2);
    OK(fmi2DeSerializeFMUstate(c, bytes, size, &read));
    OK(fmi2SetFMUstate(c, read));
    run(10, 20);
    TEST_ASSERT_TRUE(x_m() == there);
    OK(fmi2DeSerializeFMUstate(c, bytes, size, &read)); /* the same memory */
    fmi2FreeFMUstate(c, &read);
}

/* As the bytes of a new instance, without what the run before had set. */
static void after_a_reset_the_state_is_that_of_a_new_instance(void) {
    static fmi2Byte fresh[sizeof bytes];
    const size_t size = write();
    memcpy(fresh, bytes, size);
    begin();
    run(20, 0);
    OK(fmi2Reset(c));
    TEST_ASSERT_EQUAL_size_t(size, write());
    TEST_ASSERT_EQUAL_MEMORY(fresh, bytes, size);
}

static void damaged_bytes_are_refused_whichever_they_are(void) {
    fmi2FMUstate read = NULL;
    begin();
    const size_t size = write();
    for (size_t at = 0; at < size; at += at < 64 ? 1 : 37) {
        bytes[at] ^= 0x10;
        TEST_ASSERT_EQUAL_INT(fmi2Error, fmi2DeSerializeFMUstate(c, bytes, size, &read));
        bytes[at] ^= 0x10;
    }
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, size - 8, &read), "are damaged or cut off");
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, 20, &read), "these 20 bytes are no state of Laconic");
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, 39, &read), "these 39 bytes are no state of Laconic");
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, 40, &read), "the 40 bytes are damaged or cut off");
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, NULL, size, &read), "are missing (NULL)");
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, size, NULL), "are missing (NULL)");
    bytes[8]++; /* the version */
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, size, &read), "has format version 9, this FMU reads 8");
    TEST_ASSERT_NULL(read);
}

/* Bytes with a right checksum and a wrong mode, as nobody but an attacker writes them. */
static void an_impossible_state_is_refused_though_its_checksum_is_right(void) {
    fmi2FMUstate read = NULL;
    begin();
    const size_t size = write();
    const size_t mode_at = 8 + 24 + 8;
    for (int mode = 0; mode < 12; mode++) {
        bytes[mode_at] = (fmi2Byte)mode;
        const uint32_t checksum = fmu_checksum((const uint8_t *)bytes, size - 8);
        for (int k = 0; k < 4; k++) bytes[size - 8 + (size_t)k] = (fmi2Byte)(checksum >> (8 * k));
        const bool fits = mode == FMU_INSTANTIATED || mode == FMU_CONFIGURATION || mode == FMU_INITIALIZATION ||
                          mode == FMU_STEP || mode == FMU_TERMINATED;
        TEST_ASSERT_EQUAL_INT(fits ? fmi2OK : fmi2Error, fmi2DeSerializeFMUstate(c, bytes, size, &read));
    }
    fmi2FreeFMUstate(c, &read);
}

/* What a heading has not taken up is less than a unit; with more, a step would leave the range of its integer. */
static void a_heading_whose_rest_is_no_rest_is_refused(void) {
    const double rests[] = {1.5, -1.5, 1e101, NOT_A_NUMBER};
    begin();
    for (size_t k = 0; k < sizeof rests / sizeof rests[0]; k++) {
        fmi2FMUstate read = NULL;
        ((fmu_instance *)c)->model.plant.state.heading.rest = rests[k];
        ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, write(), &read), "no possible state");
        TEST_ASSERT_NULL(read);
    }
}

/* Found by fuzzing: the plant follows from continuous states, which a Co-Simulation has none of. */
static void a_co_simulation_that_follows_continuous_states_is_refused(void) {
    fmi2FMUstate read = NULL;
    begin();
    ((fmu_instance *)c)->model.stale |= FMU_GROUP_STATE;
    const size_t size = write();
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, size, &read), "no possible state");
    TEST_ASSERT_NULL(read);
}

/* Found by fuzzing: what was not prepared again lost its step. */
static void a_state_that_is_to_be_started_again_is_written_as_it_was_read(void) {
    static fmi2Byte first[sizeof bytes];
    fmi2FMUstate read = NULL;
    begin();
    run(3, 0);
    ((fmu_instance *)c)->model.start_needed = true;
    const size_t size = write();
    memcpy(first, bytes, size);
    OK(fmi2DeSerializeFMUstate(c, first, size, &read));
    OK(fmi2SetFMUstate(c, read));
    TEST_ASSERT_EQUAL_size_t(size, write());
    TEST_ASSERT_EQUAL_MEMORY(first, bytes, size);
    fmi2FreeFMUstate(c, &read);
}

static void seal(size_t size) {
    const uint32_t checksum = fmu_checksum((const uint8_t *)bytes, size - 8);
    for (size_t k = 0; k < 4; k++) bytes[size - 8 + k] = (fmi2Byte)(checksum >> (8 * k));
}

/* The size stands in the bytes, and is that of what is read. */
static void a_state_is_neither_longer_nor_of_another_size(void) {
    fmi2FMUstate read = NULL;
    begin();
    const size_t size = write();
    bytes[8 + 16]++;
    seal(size);
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, size, &read), "are no possible state");
    bytes[8 + 16] = (fmi2Byte)((size + 8) & 255U);
    bytes[8 + 17] = (fmi2Byte)((size + 8) >> 8 & 255U);
    memset(bytes + size, 0, 8);
    seal(size + 8);
    ASSERT_REFUSED(fmi2DeSerializeFMUstate(c, bytes, size + 8, &read), "are no possible state");
    ASSERT_REFUSED(fmi2SerializeFMUstate(c, NULL, bytes, size), "the saved state is missing (NULL)");
    ASSERT_REFUSED(fmi2SerializedFMUstateSize(c, NULL, NULL), "the saved state is missing (NULL)");
}

static void modes_of_model_exchange_are_its_own(void) {
    fmi2FMUstate read = NULL;
    fmi2FreeInstance(c);
    c = make_2(fmi2ModelExchange, fmu_token_2);
    const size_t size = write();
    for (int mode = 0; mode < 9; mode++) {
        bytes[8 + 24 + 8] = (fmi2Byte)mode;
        seal(size);
        const bool fits = mode != FMU_STEP && mode != FMU_INTERMEDIATE && mode < FMU_MODE_COUNT;
        TEST_ASSERT_EQUAL_INT(fits ? fmi2OK : fmi2Error, fmi2DeSerializeFMUstate(c, bytes, size, &read));
    }
    OK(fmi2FreeFMUstate(c, &read));
}

static void event_mode_is_for_who_uses_it(void) {
    static fmi3Byte of_events[65536];
    fmi3FMUState kept = NULL;
    size_t size = 0;
    fmi3Instance with = make_3(true), without = make_3(false);
    OK(fmi3EnterInitializationMode(with, false, 0, 0, false, 0));
    OK(fmi3ExitInitializationMode(with));
    OK(fmi3GetFMUState(with, &kept));
    ASSERT_REFUSED(fmi3SetFMUState(without, kept), "Co-Simulation, with or without event mode");
    OK(fmi3SerializedFMUStateSize(with, kept, &size));
    OK(fmi3SerializeFMUState(with, kept, of_events, size));
    OK(fmi3DeserializeFMUState(with, of_events, size, &kept));
    OK(fmi3SetFMUState(with, kept));
    OK(fmi3EnterStepMode(with));
    OK(fmi3FreeFMUState(with, &kept));
    fmi3FreeInstance(with);
    fmi3FreeInstance(without);
}

static void a_state_of_the_other_kind_is_refused(void) {
    fmi2FMUstate kept = NULL;
    fmi2Component other = make_2(fmi2ModelExchange, fmu_token_2);
    OK(fmi2GetFMUstate(other, &kept));
    ASSERT_REFUSED(fmi2SetFMUstate(c, kept), "belongs to an instance of the other kind");
    fmi2FreeFMUstate(other, &kept);
    fmi2FreeInstance(other);
    fmi3FMUState of_3 = NULL;
    fmi3Instance third = make_3(false);
    OK(fmi3GetFMUState(third, &of_3));
    ASSERT_REFUSED(fmi2SetFMUstate(c, of_3), "the saved state belongs to another FMU");
    OK(fmi3FreeFMUState(third, &of_3));
    fmi3FreeInstance(third);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_kept_state_is_taken_up_again_bit_for_bit);
    RUN_TEST(bytes_are_read_by_another_instance);
    RUN_TEST(after_a_reset_the_state_is_that_of_a_new_instance);
    RUN_TEST(damaged_bytes_are_refused_whichever_they_are);
    RUN_TEST(an_impossible_state_is_refused_though_its_checksum_is_right);
    RUN_TEST(a_heading_whose_rest_is_no_rest_is_refused);
    RUN_TEST(a_co_simulation_that_follows_continuous_states_is_refused);
    RUN_TEST(a_state_that_is_to_be_started_again_is_written_as_it_was_read);
    RUN_TEST(a_state_is_neither_longer_nor_of_another_size);
    RUN_TEST(modes_of_model_exchange_are_its_own);
    RUN_TEST(event_mode_is_for_who_uses_it);
    RUN_TEST(a_state_of_the_other_kind_is_refused);
    return UNITY_END();
}
