/* Tests of vehicle.c: every number that is not usable is refused with its field. */
#include "elementary.h"

#include "check.h"
#include "vehicles.h"

static laconic_refusal why;

static void good_vehicles_are_accepted(void) {
    laconic_vehicle v = three_wheels();
    ASSERT_STATUS(LACONIC_OK, laconic_vehicle_check(&v, &why));
    v = differential_drive();
    ASSERT_STATUS(LACONIC_OK, laconic_vehicle_check(&v, NULL));
    v = bare_body();
    ASSERT_STATUS(LACONIC_OK, laconic_vehicle_check(&v, &why));
}

static void zero_inertia_of_wheels_and_negative_gain_are_accepted(void) {
    laconic_vehicle v = three_wheels();
    v.wheel_inertia_kgm2 = 0;
    v.motor_gain_Nm_per_V = REAL(-1);
    ASSERT_STATUS(LACONIC_OK, laconic_vehicle_check(&v, &why));
}

/* One number of a vehicle. */
typedef laconic_real *(*number_of)(laconic_vehicle *v);

static laconic_real *mass(laconic_vehicle *v) { return &v->mass_kg; }
static laconic_real *yaw_inertia(laconic_vehicle *v) { return &v->yaw_inertia_kgm2; }
static laconic_real *radius(laconic_vehicle *v) { return &v->wheel_radius_m; }
static laconic_real *wheel_inertia(laconic_vehicle *v) { return &v->wheel_inertia_kgm2; }
static laconic_real *damping(laconic_vehicle *v) { return &v->motor_damping_Nms; }
static laconic_real *friction(laconic_vehicle *v) { return &v->friction_coefficient; }
static laconic_real *payload_mass(laconic_vehicle *v) { return &v->payload.mass_kg; }
static laconic_real *payload_inertia(laconic_vehicle *v) { return &v->payload.yaw_inertia_kgm2; }
static laconic_real *com_x(laconic_vehicle *v) { return &v->com_x_m; }
static laconic_real *com_y(laconic_vehicle *v) { return &v->com_y_m; }
static laconic_real *com_z(laconic_vehicle *v) { return &v->com_z_m; }
static laconic_real *gain(laconic_vehicle *v) { return &v->motor_gain_Nm_per_V; }
static laconic_real *payload_x(laconic_vehicle *v) { return &v->payload.x_m; }
static laconic_real *payload_y(laconic_vehicle *v) { return &v->payload.y_m; }
static laconic_real *second_wheel_x(laconic_vehicle *v) { return &v->wheel[1].x_m; }
static laconic_real *second_wheel_y(laconic_vehicle *v) { return &v->wheel[1].y_m; }
static laconic_real *second_axle(laconic_vehicle *v) { return &v->wheel[1].axle_rad; }
static laconic_real *second_roller(laconic_vehicle *v) { return &v->wheel[1].roller_rad; }
static laconic_real *second_support_x(laconic_vehicle *v) { return &v->support[1].x_m; }
static laconic_real *second_support_y(laconic_vehicle *v) { return &v->support[1].y_m; }

typedef struct number {
    number_of where;
    laconic_field field;
    int item;
} number;

static const number must_be_positive[] = {
    {mass, LACONIC_FIELD_MASS, 0},
    {yaw_inertia, LACONIC_FIELD_YAW_INERTIA, 0},
    {radius, LACONIC_FIELD_WHEEL_RADIUS, 0},
};
static const number must_not_be_negative[] = {
    {wheel_inertia, LACONIC_FIELD_WHEEL_INERTIA, 0},
    {damping, LACONIC_FIELD_MOTOR_DAMPING, 0},
    {com_z, LACONIC_FIELD_COM_Z, 0},
    {friction, LACONIC_FIELD_FRICTION_COEFFICIENT, 0},
    {payload_mass, LACONIC_FIELD_PAYLOAD_MASS, 0},
    {payload_inertia, LACONIC_FIELD_PAYLOAD_YAW_INERTIA, 0},
};
static const number any_number[] = {
    {com_x, LACONIC_FIELD_COM_X, 0},
    {com_y, LACONIC_FIELD_COM_Y, 0},
    {gain, LACONIC_FIELD_MOTOR_GAIN, 0},
    {payload_x, LACONIC_FIELD_PAYLOAD_X, 0},
    {payload_y, LACONIC_FIELD_PAYLOAD_Y, 0},
    {second_wheel_x, LACONIC_FIELD_WHEEL_X, 2},
    {second_wheel_y, LACONIC_FIELD_WHEEL_Y, 2},
    {second_axle, LACONIC_FIELD_AXLE, 2},
    {second_roller, LACONIC_FIELD_ROLLER, 2},
    {second_support_x, LACONIC_FIELD_SUPPORT_X, 2},
    {second_support_y, LACONIC_FIELD_SUPPORT_Y, 2},
};
#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static void refuses(const number *numbers, size_t count, laconic_real value, laconic_status status) {
    for (size_t i = 0; i < count; i++) {
        laconic_vehicle v = three_wheels();
        v.support_count = 2;
        *numbers[i].where(&v) = value;
        ASSERT_REFUSED(status, numbers[i].field, numbers[i].item, laconic_vehicle_check(&v, &why), why);
        ASSERT_STATUS(status, laconic_vehicle_check(&v, NULL));
    }
}

static void every_number_that_is_not_finite_is_named(void) {
    const laconic_real values[] = {NOT_A_NUMBER, INFINITE, -INFINITE};
    for (size_t i = 0; i < 3; i++) {
        refuses(must_be_positive, COUNT(must_be_positive), values[i], LACONIC_NOT_FINITE);
        refuses(must_not_be_negative, COUNT(must_not_be_negative), values[i], LACONIC_NOT_FINITE);
        refuses(any_number, COUNT(any_number), values[i], LACONIC_NOT_FINITE);
    }
}

/* The largest number whose square is finite passes this check; whether the numbers make a model is for prepare. */
static void a_number_whose_square_leaves_the_range_is_named(void) {
    const double root = EITHER(1.34e154, 1.84e19);
    refuses(must_be_positive, COUNT(must_be_positive), REAL(1.01 * root), LACONIC_OVERFLOW);
    refuses(must_not_be_negative, COUNT(must_not_be_negative), REAL(1.01 * root), LACONIC_OVERFLOW);
    refuses(any_number, COUNT(any_number), REAL(-1.01 * root), LACONIC_OVERFLOW);
    for (size_t i = 0; i < COUNT(must_be_positive); i++) {
        laconic_vehicle v = three_wheels();
        *must_be_positive[i].where(&v) = REAL(root);
        ASSERT_STATUS(LACONIC_OK, laconic_vehicle_check(&v, &why));
    }
}

static void mass_radius_and_yaw_inertia_must_be_positive(void) {
    refuses(must_be_positive, COUNT(must_be_positive), REAL(0), LACONIC_NOT_POSITIVE);
    refuses(must_be_positive, COUNT(must_be_positive), REAL(-2), LACONIC_NOT_POSITIVE);
    TEST_ASSERT_EQUAL_DOUBLE(-2.0, (double)why.value);
}

static void inertias_damping_friction_and_height_must_not_be_negative(void) {
    refuses(must_not_be_negative, COUNT(must_not_be_negative), REAL(-0.5), LACONIC_NEGATIVE);
    TEST_ASSERT_EQUAL_DOUBLE(-0.5, (double)why.value);
}

static void a_number_exactly_at_its_limit_is_taken(void) {
    for (size_t i = 0; i < COUNT(must_be_positive); i++) {
        laconic_vehicle v = three_wheels();
        *must_be_positive[i].where(&v) = LACONIC_REAL_MIN;
        ASSERT_STATUS(LACONIC_OK, laconic_vehicle_check(&v, &why));
    }
    laconic_vehicle v = three_wheels();
    v.ground.friction_coefficient = REAL(0.5);
    v.ground.roller_drag = 1;
    v.ground.slope_rad = REAL(1.5); /* 86° */
    ASSERT_STATUS(LACONIC_OK, laconic_vehicle_check(&v, &why));
    v.ground.slope_rad *= 1 + LACONIC_EPSILON;
    ASSERT_REFUSED(LACONIC_ABOVE_LIMIT, LACONIC_FIELD_SLOPE, 0, laconic_vehicle_check(&v, &why), why);
    v.ground.slope_rad = 0;
    v.ground.roller_drag += LACONIC_EPSILON;
    ASSERT_REFUSED(LACONIC_ABOVE_LIMIT, LACONIC_FIELD_GROUND_ROLLER_DRAG, 0, laconic_vehicle_check(&v, &why), why);
}

static void as_many_wheels_as_there_is_room_for_may_slip(void) {
    laconic_vehicle v = bare_body();
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) {
        v.ground.friction_coefficient = 0;
        add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.1, 0.0, 0.3 * i, PI / 2);
        TEST_ASSERT_FALSE(laconic_vehicle_has_friction(&v));
        v.ground.friction_coefficient = REAL(0.5);
        TEST_ASSERT_TRUE(laconic_vehicle_has_friction(&v));
    }
}

static void a_roller_along_the_axle_is_refused_just_below_the_limit(void) {
    const double limit = EITHER(1e-6, 1e-3);
    laconic_vehicle v = three_wheels();
    v.wheel[2].roller_rad = REAL(limit * 0.99);
    ASSERT_REFUSED(LACONIC_ROLLER_ALONG_AXLE, LACONIC_FIELD_ROLLER, 3, laconic_vehicle_check(&v, &why), why);
    v.wheel[2].roller_rad = REAL(PI - limit * 0.99);
    ASSERT_REFUSED(LACONIC_ROLLER_ALONG_AXLE, LACONIC_FIELD_ROLLER, 3, laconic_vehicle_check(&v, &why), why);
    v.wheel[2].roller_rad = REAL(-limit * 1.01);
    ASSERT_STATUS(LACONIC_OK, laconic_vehicle_check(&v, &why));
}

/* Small angles that are neighbours have sines that are, so one of them has the limit itself: sin x = x − x³/6. */
static void a_roller_exactly_at_the_limit_is_taken(void) {
    const laconic_real limit = LACONIC_SMALLEST_ROLLER_SINE, unit = limit * LACONIC_EPSILON / 2;
    const laconic_real angle = limit + limit * limit * limit / 6;
    laconic_vehicle v = three_wheels();
    int taken = 0;
    for (int k = -40; k <= 40; k++) {
        v.wheel[2].roller_rad = angle + REAL(k) * unit;
        const laconic_real sine = laconic_direction_of_angle(v.wheel[2].roller_rad).sine;
        TEST_ASSERT_EQUAL_INT(sine < limit ? LACONIC_ROLLER_ALONG_AXLE : LACONIC_OK, laconic_vehicle_check(&v, NULL));
        taken += sine >= limit && sine <= limit;
    }
    TEST_ASSERT_TRUE(taken > 0);
}

static void an_angle_too_large_to_have_a_direction_is_refused_for_axle_and_roller_alike(void) {
    const double largest = (double)LACONIC_SMALLEST_ROLLER_SINE / (double)LACONIC_EPSILON;
    const number_of angle[] = {second_axle, second_roller};
    laconic_vehicle at_the_limit = three_wheels();
    at_the_limit.wheel[1].axle_rad = LACONIC_SMALLEST_ROLLER_SINE / LACONIC_EPSILON;
    ASSERT_STATUS(LACONIC_OK, laconic_vehicle_check(&at_the_limit, &why));
    const laconic_field field[] = {LACONIC_FIELD_AXLE, LACONIC_FIELD_ROLLER};
    for (int k = 0; k < 2; k++) {
        laconic_vehicle v = three_wheels();
        *angle[k](&v) = REAL(1.001 * largest);
        ASSERT_REFUSED(LACONIC_OVERFLOW, field[k], 2, laconic_vehicle_check(&v, &why), why);
        *angle[k](&v) = -LACONIC_REAL_MAX;
        ASSERT_REFUSED(LACONIC_OVERFLOW, field[k], 2, laconic_vehicle_check(&v, &why), why);
        *angle[k](&v) = REAL(PI / 2 + 200 * PI);
        ASSERT_STATUS(LACONIC_OK, laconic_vehicle_check(&v, &why));
    }
}

static void the_roller_of_a_fixed_wheel_is_not_read(void) {
    laconic_vehicle v = differential_drive();
    v.wheel[0].roller_rad = NOT_A_NUMBER;
    ASSERT_STATUS(LACONIC_OK, laconic_vehicle_check(&v, &why));
}

static void what_ground_and_drive_need_is_asked_of_each_wheel(void) {
    for (int i = 0; i < 3; i++) {
        laconic_vehicle v = three_wheels();
        v.wheel[i].own_friction_coefficient = REAL(0.5);
        ASSERT_REFUSED(LACONIC_FRICTION_MISSING, LACONIC_FIELD_WHEEL_FRICTION_COEFFICIENT, i + 1,
                       laconic_vehicle_check(&v, &why), why);
        v = three_wheels();
        v.ground.friction_coefficient = REAL(0.5);
        v.wheel_inertia_kgm2 = 0;
        for (int k = 0; k < 3; k++) v.wheel[k].own_inertia_kgm2 = k == i ? 0 : REAL(0.01);
        ASSERT_REFUSED(LACONIC_NOT_POSITIVE, LACONIC_FIELD_WHEEL_INERTIA, 0, laconic_vehicle_check(&v, &why), why);
    }
}

static void a_forgotten_wheel_is_refused(void) {
    laconic_vehicle v = three_wheels();
    v.wheel_count = 4;
    ASSERT_REFUSED(LACONIC_WHEEL_NOT_SET, LACONIC_FIELD_WHEEL_KIND, 4, laconic_vehicle_check(&v, &why), why);
}

static void an_unknown_kind_is_named_with_its_number(void) {
    laconic_vehicle v = three_wheels();
    v.wheel[1].kind = (laconic_wheel_kind)3;
    ASSERT_REFUSED(LACONIC_WHEEL_KIND_UNKNOWN, LACONIC_FIELD_WHEEL_KIND, 2, laconic_vehicle_check(&v, &why), why);
    TEST_ASSERT_EQUAL_DOUBLE(3.0, (double)why.value);
}

static void the_wheel_count_stays_within_its_bounds(void) {
    laconic_vehicle v = bare_body();
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) add_wheel(&v, LACONIC_WHEEL_ROLLER, 0.1, 0.0, 0.3 * i, PI / 2);
    ASSERT_STATUS(LACONIC_OK, laconic_vehicle_check(&v, &why));
    v.wheel_count = LACONIC_MAX_WHEELS + 1;
    ASSERT_REFUSED(LACONIC_TOO_MANY_WHEELS, LACONIC_FIELD_WHEEL_COUNT, 0, laconic_vehicle_check(&v, &why), why);
    TEST_ASSERT_EQUAL_DOUBLE(LACONIC_MAX_WHEELS, (double)why.limit);
    v.wheel_count = -1;
    ASSERT_REFUSED(LACONIC_TOO_MANY_WHEELS, LACONIC_FIELD_WHEEL_COUNT, 0, laconic_vehicle_check(&v, &why), why);
}

static void the_support_count_stays_within_its_bounds(void) {
    laconic_vehicle v = three_wheels();
    v.support_count = LACONIC_MAX_SUPPORTS;
    ASSERT_STATUS(LACONIC_OK, laconic_vehicle_check(&v, &why));
    v.support_count++;
    ASSERT_REFUSED(LACONIC_TOO_MANY_SUPPORTS, LACONIC_FIELD_SUPPORT_COUNT, 0, laconic_vehicle_check(&v, &why), why);
    TEST_ASSERT_EQUAL_DOUBLE(LACONIC_MAX_SUPPORTS, (double)why.limit);
    v.support_count = -1;
    ASSERT_REFUSED(LACONIC_TOO_MANY_SUPPORTS, LACONIC_FIELD_SUPPORT_COUNT, 0, laconic_vehicle_check(&v, &why), why);
}

static void a_mass_without_all_its_digits_is_refused_even_where_a_payload_outweighs_it(void) {
    laconic_vehicle v = three_wheels();
    v.mass_kg = LACONIC_REAL_MIN / 4;
    v.payload.mass_kg = 1;
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_MASS, 0, laconic_vehicle_check(&v, &why), why);
    TEST_ASSERT_TRUE(why.value == v.mass_kg && why.limit == LACONIC_REAL_MIN);
}

/* It is asked before the check, which refuses such numbers. */
static void what_is_not_above_zero_gives_a_vehicle_no_friction(void) {
    const laconic_real nothing[] = {0, -1, NOT_A_NUMBER};
    for (int k = 0; k < 3; k++) {
        laconic_vehicle v = with_motors(three_wheels());
        v.ground.friction_coefficient = v.drive.supply_V = v.drive.current_limit_A = nothing[k];
        TEST_ASSERT_FALSE(laconic_vehicle_has_friction(&v));
    }
}

/* Tests of fields.c: names, paths and traits of the vehicle's fields. */

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
    RUN_TEST(good_vehicles_are_accepted);
    RUN_TEST(zero_inertia_of_wheels_and_negative_gain_are_accepted);
    RUN_TEST(every_number_that_is_not_finite_is_named);
    RUN_TEST(a_number_whose_square_leaves_the_range_is_named);
    RUN_TEST(mass_radius_and_yaw_inertia_must_be_positive);
    RUN_TEST(inertias_damping_friction_and_height_must_not_be_negative);
    RUN_TEST(a_number_exactly_at_its_limit_is_taken);
    RUN_TEST(as_many_wheels_as_there_is_room_for_may_slip);
    RUN_TEST(a_roller_along_the_axle_is_refused_just_below_the_limit);
    RUN_TEST(a_roller_exactly_at_the_limit_is_taken);
    RUN_TEST(an_angle_too_large_to_have_a_direction_is_refused_for_axle_and_roller_alike);
    RUN_TEST(the_roller_of_a_fixed_wheel_is_not_read);
    RUN_TEST(what_ground_and_drive_need_is_asked_of_each_wheel);
    RUN_TEST(a_forgotten_wheel_is_refused);
    RUN_TEST(an_unknown_kind_is_named_with_its_number);
    RUN_TEST(the_wheel_count_stays_within_its_bounds);
    RUN_TEST(the_support_count_stays_within_its_bounds);
    RUN_TEST(a_mass_without_all_its_digits_is_refused_even_where_a_payload_outweighs_it);
    RUN_TEST(what_is_not_above_zero_gives_a_vehicle_no_friction);
    RUN_TEST(every_field_has_a_name_a_path_and_traits_of_its_own);
    RUN_TEST(a_path_ends_in_the_key_that_the_name_ends_in);
    RUN_TEST(fields_are_called_as_fmus_call_them);
    RUN_TEST(fields_are_found_where_scenes_have_them);
    RUN_TEST(traits_are_kind_rule_need_and_items);
    RUN_TEST(numbers_of_fields_never_change);
    RUN_TEST(a_number_of_no_field_gives_no_text_and_no_traits);
    return UNITY_END();
}
