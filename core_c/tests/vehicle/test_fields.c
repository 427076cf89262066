/* Tests of fields.c: names, paths and traits of the vehicle's fields. */
#include "check.h"

#define NUMBER(of, number, ...) (laconic_field) number,
static const laconic_field every_field[] = {LACONIC_ALL_FIELDS(NUMBER) LACONIC_SENSOR_FIELDS(NUMBER)};
#define FIELDS (sizeof every_field / sizeof every_field[0])

static void every_field_has_a_name_a_path_and_traits_of_its_own(void) {
    for (size_t a = 0; a < FIELDS; a++) {
        const char *name = laconic_field_name(every_field[a]), *path = laconic_field_path(every_field[a]);
        TEST_ASSERT_TRUE(every_field[a] > LACONIC_FIELD_NONE && (int)every_field[a] < LACONIC_SENSOR_FIELD_COUNT);
        TEST_ASSERT_TRUE(*name != '\0' && *path != '\0' && laconic_field_traits_of(every_field[a]) != NULL);
        for (size_t b = 0; b < a; b++) {
            TEST_ASSERT_TRUE(strcmp(name, laconic_field_name(every_field[b])) != 0);
            TEST_ASSERT_TRUE(strcmp(path, laconic_field_path(every_field[b])) != 0);
        }
    }
}

/* Both end in the same key. */
static void a_path_ends_in_the_key_that_the_name_ends_in(void) {
    for (size_t k = 0; k < FIELDS; k++) {
        const char *name = laconic_field_name(every_field[k]), *path = laconic_field_path(every_field[k]);
        const char *dot = strrchr(path, '.'), *key = dot != NULL ? dot + 1 : path;
        const size_t length = strcspn(key, "[");
        if (every_field[k] == LACONIC_FIELD_WHEEL_COUNT || every_field[k] == LACONIC_FIELD_SUPPORT_COUNT)
            continue; /* tables */
        TEST_ASSERT_TRUE_MESSAGE(strlen(name) >= length, path);
        TEST_ASSERT_EQUAL_STRING_LEN(name + strlen(name) - length, key, length);
    }
}

static void fields_are_called_as_fmus_call_them(void) {
    TEST_ASSERT_EQUAL_STRING("mass_kg", laconic_field_name(LACONIC_FIELD_MASS));
    TEST_ASSERT_EQUAL_STRING("payload_yaw_inertia_kgm2", laconic_field_name(LACONIC_FIELD_PAYLOAD_YAW_INERTIA));
    TEST_ASSERT_EQUAL_STRING("roller_rad", laconic_field_name(LACONIC_FIELD_ROLLER));
    TEST_ASSERT_EQUAL_STRING("own_motor_damping_Nms", laconic_field_name(LACONIC_FIELD_OWN_MOTOR_DAMPING));
    TEST_ASSERT_EQUAL_STRING("wheel_undriven", laconic_field_name(LACONIC_FIELD_DRIVEN));
    TEST_ASSERT_EQUAL_STRING("support_y_m", laconic_field_name(LACONIC_FIELD_SUPPORT_Y));
    TEST_ASSERT_EQUAL_STRING("start_heading_rad", laconic_field_name(LACONIC_FIELD_START_HEADING));
    TEST_ASSERT_EQUAL_STRING("step_s", laconic_field_name(LACONIC_FIELD_STEP));
    TEST_ASSERT_EQUAL_STRING("world_force_point_m", laconic_field_name(LACONIC_FIELD_WORLD_FORCE_POINT));
    TEST_ASSERT_EQUAL_STRING("resistance_ohm", laconic_field_name(LACONIC_FIELD_RESISTANCE));
    TEST_ASSERT_EQUAL_STRING("rotor_inertia_kgm2", laconic_field_name(LACONIC_FIELD_ROTOR_INERTIA));
}

static void fields_are_found_where_scenes_have_them(void) {
    TEST_ASSERT_EQUAL_STRING("vehicle.payload.x_m", laconic_field_path(LACONIC_FIELD_PAYLOAD_X));
    TEST_ASSERT_EQUAL_STRING("vehicle.wheel", laconic_field_path(LACONIC_FIELD_WHEEL_COUNT));
    TEST_ASSERT_EQUAL_STRING("vehicle.wheel[#].roller_rad", laconic_field_path(LACONIC_FIELD_ROLLER));
    TEST_ASSERT_EQUAL_STRING("vehicle.wheel[#].radius_m", laconic_field_path(LACONIC_FIELD_OWN_RADIUS));
    TEST_ASSERT_EQUAL_STRING("vehicle.support", laconic_field_path(LACONIC_FIELD_SUPPORT_COUNT));
    TEST_ASSERT_EQUAL_STRING("initial.heading_rad", laconic_field_path(LACONIC_FIELD_START_HEADING));
    TEST_ASSERT_EQUAL_STRING("initial.nu_rad_per_s[#]", laconic_field_path(LACONIC_FIELD_START_NU));
    TEST_ASSERT_EQUAL_STRING("voltage_V[#]", laconic_field_path(LACONIC_FIELD_VOLTAGE));
    TEST_ASSERT_EQUAL_STRING("body_moment_Nm", laconic_field_path(LACONIC_FIELD_BODY_MOMENT));
    TEST_ASSERT_EQUAL_STRING("run.step_s", laconic_field_path(LACONIC_FIELD_STEP));
    TEST_ASSERT_EQUAL_STRING("vehicle.motor.rotor_inertia_kgm2", laconic_field_path(LACONIC_FIELD_ROTOR_INERTIA));
    TEST_ASSERT_EQUAL_STRING("sensors.imu.x_m", laconic_field_path((laconic_field)LACONIC_SENSOR_FIELD_IMU_X));
    TEST_ASSERT_EQUAL_STRING("sensors.encoder.counts_per_turn[#]",
                             laconic_field_path((laconic_field)LACONIC_SENSOR_FIELD_WHEEL_ENCODER_COUNTS));
}

static void traits_are_kind_rule_need_and_items(void) {
    const laconic_field_traits *mass = laconic_field_traits_of(LACONIC_FIELD_MASS);
    const laconic_field_traits *locked = laconic_field_traits_of(LACONIC_FIELD_WHEEL_LOCKED);
    TEST_ASSERT_EQUAL_INT(LACONIC_KIND_REAL, mass->kind);
    TEST_ASSERT_EQUAL_INT(LACONIC_RULE_POSITIVE, mass->rule);
    TEST_ASSERT_EQUAL_INT(LACONIC_NEED_ALWAYS, mass->need);
    TEST_ASSERT_EQUAL_INT(0, mass->items);
    TEST_ASSERT_EQUAL_INT(LACONIC_KIND_FLAG, locked->kind);
    TEST_ASSERT_EQUAL_INT(LACONIC_MAX_WHEELS, locked->items);
    TEST_ASSERT_EQUAL_INT(3, laconic_field_traits_of(LACONIC_FIELD_START_NU)->items);
    TEST_ASSERT_EQUAL_INT(2, laconic_field_traits_of(LACONIC_FIELD_BODY_FORCE)->items);
    TEST_ASSERT_EQUAL_INT(LACONIC_MAX_WHEELS, laconic_field_traits_of(LACONIC_FIELD_VOLTAGE)->items);
    TEST_ASSERT_EQUAL_INT(2, laconic_field_traits_of((laconic_field)LACONIC_SENSOR_FIELD_IMU_ACCELERATION_BIAS)->items);
    TEST_ASSERT_EQUAL_INT(LACONIC_MAX_SUPPORTS, laconic_field_traits_of(LACONIC_FIELD_SUPPORT_Y)->items);
}

/* Value tables, logs and users' tools contain them. */
static void numbers_of_fields_never_change(void) {
    TEST_ASSERT_EQUAL_INT(5, LACONIC_FIELD_COM_Z);
    TEST_ASSERT_EQUAL_INT(6, LACONIC_FIELD_WHEEL_RADIUS);
    TEST_ASSERT_EQUAL_INT(21, LACONIC_FIELD_WHEEL_LOCKED);
    TEST_ASSERT_EQUAL_INT(34, LACONIC_FIELD_BODY_MOMENT);
    TEST_ASSERT_EQUAL_INT(42, LACONIC_FIELD_ROTOR_INERTIA);
    TEST_ASSERT_EQUAL_INT(43, LACONIC_FIELD_OWN_RADIUS);
    TEST_ASSERT_EQUAL_INT(47, LACONIC_FIELD_DRIVEN);
}

static void a_number_of_no_field_gives_no_text_and_no_traits(void) {
    const int none[] = {LACONIC_FIELD_NONE, LACONIC_FIELD_COUNT, LACONIC_SENSOR_FIELD_COUNT, 1000};
    for (int k = 0; k < 4; k++) {
        TEST_ASSERT_EQUAL_STRING("", laconic_field_name((laconic_field)none[k]));
        TEST_ASSERT_EQUAL_STRING("", laconic_field_path((laconic_field)none[k]));
        TEST_ASSERT_NULL(laconic_field_traits_of((laconic_field)none[k]));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_field_has_a_name_a_path_and_traits_of_its_own);
    RUN_TEST(a_path_ends_in_the_key_that_the_name_ends_in);
    RUN_TEST(fields_are_called_as_fmus_call_them);
    RUN_TEST(fields_are_found_where_scenes_have_them);
    RUN_TEST(traits_are_kind_rule_need_and_items);
    RUN_TEST(numbers_of_fields_never_change);
    RUN_TEST(a_number_of_no_field_gives_no_text_and_no_traits);
    return UNITY_END();
}
