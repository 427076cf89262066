/* Tests of start_file.c: the start values that an FMU of a scene carries in resources/start.bin. */
#include "fmi_bench.h"
#include "stream.h"

#include <sys/stat.h>
#include <unistd.h>

#define TOKEN "{of-a-scene}"

static char folder[256], file[300];
static uint8_t bytes[65536 + 8];

void setUp(void) {
    log_clear();
    snprintf(folder, sizeof folder, "/tmp/laconic start %ld", (long)getpid());
    mkdir(folder, 0700);
    snprintf(file, sizeof file, "%s/start.bin", folder);
}
void tearDown(void) {
    remove(file);
    rmdir(folder);
}

/* A file of these pairs; its size. */
static size_t make(uint64_t version, uint64_t scalar, const char *token, const fmu_start_value *pairs, uint64_t count,
                   uint64_t stated) {
    fmu_stream to = {.to = bytes, .size = sizeof bytes, .at = 8};
    uint64_t hash = fmu_token_hash(token);
    memcpy(bytes, "LACSTART", 8);
    fmu_stream_u64(&to, &version);
    fmu_stream_u64(&to, &scalar);
    fmu_stream_u64(&to, &hash);
    fmu_stream_u64(&to, &stated);
    for (uint64_t k = 0; k < count; k++) {
        uint64_t reference = pairs[k].reference;
        double value = pairs[k].value;
        fmu_stream_u64(&to, &reference);
        fmu_stream_reals(&to, &value, 1);
    }
    uint64_t checksum = fmu_checksum(bytes, to.at);
    fmu_stream_u64(&to, &checksum);
    return to.at;
}

static fmi2Component with(size_t size, const char *resources) {
    static const fmi2CallbackFunctions callbacks = {log_2, calloc, free, NULL, NULL};
    FILE *out = fopen(file, "wb");
    TEST_ASSERT_NOT_NULL(out);
    fwrite(bytes, 1, size, out);
    fclose(out);
    return fmi2Instantiate("one", fmi2CoSimulation, TOKEN, resources, &callbacks, fmi2False, fmi2True);
}

static double mass_of(fmi2Component c) {
    const fmi2ValueReference mass = ref("mass_kg", 0);
    double value = NOT_A_NUMBER;
    OK(fmi2EnterInitializationMode(c));
    OK(fmi2GetReal(c, &mass, 1, &value));
    return value;
}

static void values_come_from_the_file_by_a_path_or_a_uri(void) {
    const fmu_start_value pairs[2] = {{ref("wheel_count", 0), 3}, {ref("mass_kg", 0), 12.5}};
    const size_t size = make(2, 1, TOKEN, pairs, 2, 2);
    char uri[6][400];
    snprintf(uri[0], 400, "%s", folder);
    snprintf(uri[1], 400, "file:///tmp/laconic%%20start%%20%ld/", (long)getpid());
    snprintf(uri[2], 400, "file://localhost/tmp/laconic%%20start%%20%ld", (long)getpid());
    snprintf(uri[3], 400, "file:/tmp/laconic%%20start%%20%ld//", (long)getpid());
    snprintf(uri[4], 400, "FILE:///tmp/laconic%%20start%%20%ld", (long)getpid());
    snprintf(uri[5], 400, "FiLe:/tmp/laconic%%20start%%20%ld", (long)getpid());
    for (int k = 0; k < 6; k++) {
        fmi2Component c = with(size, uri[k]);
        TEST_ASSERT_NOT_NULL_MESSAGE(c, uri[k]);
        TEST_ASSERT_TRUE(mass_of(c) == 12.5);
        TEST_ASSERT_EQUAL_INT(3, ((const fmu_instance *)c)->model.vehicle.wheel_count);
        fmi2FreeInstance(c);
    }
}

static fmi2Component at(const char *resources) {
    static const fmi2CallbackFunctions callbacks = {log_2, calloc, free, NULL, NULL};
    return fmi2Instantiate("one", fmi2CoSimulation, TOKEN, resources, &callbacks, fmi2False, fmi2True);
}

/* What the bytes say of themselves. */
static void seal(size_t size) {
    const uint32_t checksum = fmu_checksum(bytes, size - 8);
    memset(bytes + size - 8, 0, 8);
    for (size_t k = 0; k < 4; k++) bytes[size - 8 + k] = (uint8_t)(checksum >> (8 * k));
}

/* The log names the file that was looked for. */
static void uris_are_decoded_and_paths_are_not(void) {
    static const char *const cases[][2] = {{"file:///no%2fwhere%4A%4a", "/no/whereJJ/start.bin"},
                                           {"file:///no%", "/no%/start.bin"},
                                           {"file:///no%4", "/no%4/start.bin"},
                                           {"file:///no%4g%G1%:1%/1%@1%`1", "/no%4g%G1%:1%/1%@1%`1/start.bin"},
                                           {"file:///no%c3%9F", "/no\xC3\x9F/start.bin"},
                                           {"file:///C:/no", "C:/no/start.bin"},
                                           {"file:C:/no", "C:/no/start.bin"},
                                           {"file:///no%09where", "/no\twhere/start.bin"},
                                           {"files/nowhere", "files/nowhere/start.bin"},
                                           {"FILE/nowhere", "FILE/nowhere/start.bin"},
                                           {"&),%:/nowhere", "&),%:/nowhere/start.bin"},
                                           {"file:/", "/start.bin"},
                                           {"/no%20where", "/no%20where/start.bin"},
                                           {"/nowhere\\", "/nowhere/start.bin"},
                                           {"/nowhere//", "/nowhere/start.bin"},
                                           {"/C:/no", "/C:/no/start.bin"},
                                           {"/", "/start.bin"}};
    char expected[128];
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        log_clear();
        char *exactly = malloc(strlen(cases[k][0]) + 1); /* so that sanitizers see what is read behind it */
        strcpy(exactly, cases[k][0]);
        TEST_ASSERT_NULL(at(exactly));
        free(exactly);
        snprintf(expected, sizeof expected, ", and %s holds no start values", cases[k][1]);
        for (char *c = logged; (c = strstr(c, "%%")) != NULL; c++)
            memmove(c, c + 1, strlen(c)); /* doubled for printf */
        ASSERT_LOGGED(expected);
    }
}

static void a_path_that_is_too_long_is_refused(void) {
    static char path[5000];
    memset(path, 'a', sizeof path - 1);
    for (size_t length = 4080; length < 4100; length++) {
        path[length] = 0;
        log_clear();
        TEST_ASSERT_NULL(at(path));
        ASSERT_LOGGED("holds no start values for it");
        path[length] = 'a';
    }
}

/* It is told as it was given, not as far as it was decoded. */
static void a_uri_that_is_too_long_is_told_as_it_is(void) {
    static char uri[5000];
    memset(uri, 'a', sizeof uri - 1);
    memcpy(uri, "file:///%41", strlen("file:///%41"));
    TEST_ASSERT_NULL(at(uri));
    ASSERT_LOGGED(", and file:///%%41aaa");
}

/* The longest path that systems open. */
static void a_path_of_4095_letters_is_opened(void) {
    static char path[4096];
    const fmu_start_value pairs[1] = {{ref("mass_kg", 0), 12.5}};
    const size_t size = make(2, 1, TOKEN, pairs, 1, 1), length = 4095 - strlen("/start.bin");
    memset(path, '/', length);
    memcpy(path + length - strlen(folder), folder, strlen(folder));
    fmi2Component c = with(size, path);
    TEST_ASSERT_NOT_NULL(c);
    TEST_ASSERT_TRUE(mass_of(c) == 12.5);
    fmi2FreeInstance(c);
}

/* A puck without wheels has no structural parameter, also in FMI 3. */
static void a_vehicle_without_wheels_is_a_vehicle(void) {
    const fmu_start_value pairs[] = {{ref("wheel_count", 0), 0},      {ref("mass_kg", 0), 2},
                                     {ref("yaw_inertia_kgm2", 0), 1}, {ref("wheel_radius_m", 0), 0.1},
                                     {ref("step_s", 0), 0.01},        {ref("ground_friction_coefficient", 0), 0.5}};
    for (uint64_t scalar = 0; scalar < 2; scalar++) {
        fmi2Component c = with(make(2, scalar, TOKEN, pairs, 6, 6), folder);
        TEST_ASSERT_NULL(c == NULL ? "refused" : NULL);
        TEST_ASSERT_TRUE(((const fmu_instance *)c)->scalar);
        TEST_ASSERT_TRUE(mass_of(c) == 2);
        OK(fmi2ExitInitializationMode(c));
        OK(fmi2DoStep(c, 0, 0.1, fmi2True));
        fmi2FreeInstance(c);
        fmi3Instance i =
            fmi3InstantiateCoSimulation("one", TOKEN, folder, false, true, false, false, NULL, 0, NULL, log_3, NULL);
        TEST_ASSERT_NOT_NULL(i);
        ASSERT_REFUSED(fmi3EnterConfigurationMode(i), "this FMU has no structural parameters");
        fmi3FreeInstance(i);
    }
}

/* An FMU of a scene is scalar where its file says so; bytes of a state cannot make it otherwise. */
static void the_file_says_whether_the_number_of_wheels_is_fixed(void) {
    static fmi3Byte state[65536];
    const fmu_start_value pairs[1] = {{ref("wheel_count", 0), 3}};
    const fmi3ValueReference wheels = ref("wheel_count", 0);
    const fmi3UInt64 five = 5;
    fmi3FMUState kept = NULL;
    size_t size = 0;
    for (uint64_t scalar = 0; scalar < 2; scalar++) {
        fmi2FreeInstance(with(make(2, scalar, TOKEN, pairs, 1, 1), folder));
        fmi3Instance i =
            fmi3InstantiateCoSimulation("one", TOKEN, folder, false, true, false, false, NULL, 0, NULL, log_3, NULL);
        TEST_ASSERT_NOT_NULL(i);
        OK(fmi3GetFMUState(i, &kept));
        OK(fmi3SerializedFMUStateSize(i, kept, &size));
        OK(fmi3SerializeFMUState(i, kept, state, size));
        state[8 + 24 + 8] = FMU_CONFIGURATION;
        const uint32_t checksum = fmu_checksum(state, size - 8);
        for (size_t k = 0; k < 4; k++) state[size - 8 + k] = (fmi3Byte)(checksum >> (8 * k));
        OK(fmi3DeserializeFMUState(i, state, size, &kept));
        OK(fmi3SetFMUState(i, kept));
        OK(fmi3FreeFMUState(i, &kept));
        if (scalar)
            ASSERT_REFUSED(fmi3SetUInt64(i, &wheels, 1, &five, 1), "wheel_count cannot be set in configuration");
        if (!scalar) OK(fmi3SetUInt64(i, &wheels, 1, &five, 1));
        fmi3FreeInstance(i);
    }
}

static void a_file_that_does_not_fit_is_refused(void) {
    const fmu_start_value good[1] = {{ref("mass_kg", 0), 2}};
    const fmu_start_value bad[7] = {{0x7FFFFFFF, 1},          {ref("mass_kg", 0), -1},
                                    {ref("x_m", 0), 1},       {ref("wheel_count", 0), 17},
                                    {ref("voltage_V", 0), 1}, {ref("support_count", 0), -1},
                                    {0x80000000U, 1}};                   /* the private ones are a scene's on a bus */
    TEST_ASSERT_NULL(with(make(1, 0, TOKEN, good, 1, 1), folder));       /* another version */
    TEST_ASSERT_NULL(with(make(2, 0, "{another}", good, 1, 1), folder)); /* of another FMU */
    TEST_ASSERT_NULL(with(make(2, 0, TOKEN, good, 1, 2), folder));       /* a value is missing */
    TEST_ASSERT_NULL(with(make(2, 0, TOKEN, good, 1, 1) - 1, folder));   /* cut off */
    TEST_ASSERT_NULL(with(8, folder));
    for (int k = 0; k < 7; k++) TEST_ASSERT_NULL(with(make(2, 0, TOKEN, &bad[k], 1, 1), folder));
    const size_t size = make(2, 0, TOKEN, good, 1, 1);
    bytes[40] ^= 1;
    TEST_ASSERT_NULL(with(size, folder));
    ASSERT_LOGGED("holds no start values for it: import the FMU anew");
    make(2, 0, TOKEN, good, 1, 1);
    bytes[0] = 'l';
    const uint32_t checksum = fmu_checksum(bytes, size - 8);
    for (size_t k = 0; k < 4; k++) bytes[size - 8 + k] = (uint8_t)(checksum >> (8 * k));
    TEST_ASSERT_NULL(with(size, folder));
    TEST_ASSERT_NULL(with(make(2, 0, TOKEN, good, 1, 1), "file://host"));
}

/* 48 bytes are a file without a value, 65,536 one of 4,093; both are read, and none that is longer. */
static void a_file_has_48_bytes_to_64_KiB(void) {
    static fmu_start_value many[4093];
    fmi2Component c = with(make(2, 0, TOKEN, NULL, 0, 0), folder);
    TEST_ASSERT_NOT_NULL(c);
    TEST_ASSERT_TRUE(mass_of(c) == 0); /* of the build's values it has none */
    fmi2FreeInstance(c);
    for (int k = 0; k < 4093; k++) many[k] = (fmu_start_value){ref("mass_kg", 0), k};
    const size_t size = make(2, 0, TOKEN, many, 4093, 4093);
    TEST_ASSERT_EQUAL_size_t(65536, size);
    c = with(size, folder);
    TEST_ASSERT_NOT_NULL(c);
    TEST_ASSERT_TRUE(mass_of(c) == 4092);
    fmi2FreeInstance(c);
    seal(size + 1);
    TEST_ASSERT_NULL(with(size + 1, folder));
}

/* Where the checksum begins within the count, its first byte is the count's last; the flag makes it fit. */
static void a_count_that_is_cut_off_counts_nothing(void) {
    const uint64_t most = 0x0FFFFFFFFFFFFFFFU;
    for (uint64_t flag = 1; flag < 10000; flag++) {
        make(2, flag, TOKEN, NULL, 0, most);
        seal(47);
        if (bytes[39] == most >> 56) break;
    }
    TEST_ASSERT_EQUAL_HEX8(most >> 56, bytes[39]);
    TEST_ASSERT_NULL(with(47, folder));
}

/* Where the checksum begins in place of its last byte, and is that byte. */
static void a_value_that_is_cut_off_is_none(void) {
    for (int k = 0; k < 10000; k++) {
        const fmu_start_value mass[1] = {{ref("mass_kg", 0), 2 + k / 16384.0}};
        make(2, 0, TOKEN, mass, 1, 1);
        seal(63);
        if (bytes[55] == 0x40) break;
    }
    TEST_ASSERT_EQUAL_HEX8(0x40, bytes[55]); /* of a number from 2 on */
    TEST_ASSERT_NULL(with(63, folder));
}

/* Of up to 15 bytes too many none is taken for a part of a pair. */
static void a_file_with_bytes_behind_its_pairs_is_refused(void) {
    const fmu_start_value mass[1] = {{ref("mass_kg", 0), 2}};
    for (size_t more = 0; more <= 17; more++) {
        const size_t size = make(2, 0, TOKEN, mass, 1, 1);
        memset(bytes + size - 8, 0, more);
        seal(size + more);
        fmi2Component c = with(size + more, folder);
        TEST_ASSERT_TRUE((c != NULL) == (more == 0));
        fmi2FreeInstance(c);
    }
}

static void a_reference_of_more_than_32_bits_is_refused(void) {
    const fmu_start_value mass[1] = {{ref("mass_kg", 0), 2}};
    const size_t size = make(2, 0, TOKEN, mass, 1, 1);
    bytes[8 + 32 + 4] = 1;
    seal(size);
    TEST_ASSERT_NULL(with(size, folder));
}

static void a_uri_with_a_zero_is_refused(void) {
    const fmu_start_value mass[1] = {{ref("mass_kg", 0), 2}};
    char uri[400];
    snprintf(uri, sizeof uri, "file:///tmp/laconic%%20start%%20%ld%%00", (long)getpid());
    TEST_ASSERT_NULL(with(make(2, 0, TOKEN, mass, 1, 1), uri));
    ASSERT_LOGGED("%%00");
}

static void a_hash_is_that_of_fnv_1a(void) {
    TEST_ASSERT_TRUE(fmu_token_hash("") == 0xCBF29CE484222325U);
    TEST_ASSERT_TRUE(fmu_token_hash("a") == 0xAF63DC4C8601EC8CU);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(values_come_from_the_file_by_a_path_or_a_uri);
    RUN_TEST(uris_are_decoded_and_paths_are_not);
    RUN_TEST(a_path_that_is_too_long_is_refused);
    RUN_TEST(a_uri_that_is_too_long_is_told_as_it_is);
    RUN_TEST(a_path_of_4095_letters_is_opened);
    RUN_TEST(a_vehicle_without_wheels_is_a_vehicle);
    RUN_TEST(the_file_says_whether_the_number_of_wheels_is_fixed);
    RUN_TEST(a_file_that_does_not_fit_is_refused);
    RUN_TEST(a_file_has_48_bytes_to_64_KiB);
    RUN_TEST(a_count_that_is_cut_off_counts_nothing);
    RUN_TEST(a_value_that_is_cut_off_is_none);
    RUN_TEST(a_file_with_bytes_behind_its_pairs_is_refused);
    RUN_TEST(a_reference_of_more_than_32_bits_is_refused);
    RUN_TEST(a_uri_with_a_zero_is_refused);
    RUN_TEST(a_hash_is_that_of_fnv_1a);
    return UNITY_END();
}
