/* The texts and traits that the lists of vehicle.h, sensors.h, articulated.h and articulated_friction.h give each
 * field: its name in FMUs, its key in a scene, its traits. */
#include "common.h"
#include "laconic/articulated_friction.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION
#define EVERY_FIELD(X) \
    LACONIC_ALL_FIELDS(X) LACONIC_SENSOR_FIELDS(X) LACONIC_ARTICULATED_FIELDS(X) LACONIC_TREE_FIELDS(X)
#define TABLE_LENGTH LACONIC_TREE_FIELD_COUNT
#elif LACONIC_MAX_BODIES > 0
#define EVERY_FIELD(X) LACONIC_ALL_FIELDS(X) LACONIC_SENSOR_FIELDS(X) LACONIC_ARTICULATED_FIELDS(X)
#define TABLE_LENGTH LACONIC_ARTICULATED_FIELD_COUNT
#else
#define EVERY_FIELD(X) LACONIC_ALL_FIELDS(X) LACONIC_SENSOR_FIELDS(X)
#define TABLE_LENGTH LACONIC_SENSOR_FIELD_COUNT
#endif

/* RETURN_ROW(type, number, rows) ends a function that returns the row of a number, all zero where there is none. In C
 * the rows are a table; C++ cannot name a row by its number, so there each is a case. */
#ifdef __cplusplus
#define ROW(type, number, ...) \
    case number: { \
        static const type row = __VA_ARGS__; \
        return &row; \
    }
#define RETURN_ROW(type, number, rows) \
    static const type zero = ALL_ZERO; \
    switch ((int)(number)) { rows default : return &zero; }
#else
#define ROW(type, number, ...) [number] = __VA_ARGS__,
#define RETURN_ROW(type, number, rows) \
    static const type table[TABLE_LENGTH] = {rows}; \
    return &table[(unsigned)(number) < TABLE_LENGTH ? (number) : 0]; /* no field has the number 0 */
#endif

typedef const char *row_text;

static const char *text_or_empty(const row_text *row) { return *row != NULL ? *row : ""; }

#define NAME(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) ROW(row_text, number, #name)

static const row_text *name_row(laconic_field field) { RETURN_ROW(row_text, field, EVERY_FIELD(NAME)) }

const char *laconic_field_name(laconic_field field) { return text_or_empty(name_row(field)); }

/* The key of a scene file. `#` stands for the number of the wheel, support or component. */
#define PATH_VEHICLE(member) "vehicle." #member
#define PATH_PAYLOAD(member) "vehicle.payload." #member
#define PATH_COUNT(member) "vehicle." #member
#define PATH_GROUND(member) "ground." #member
#define PATH_DRIVE(member) "vehicle.drive." #member
#define PATH_WHEEL(member) "vehicle.wheel[#]." #member
#define PATH_OWN(member) PATH_WHEEL(member)
#define PATH_SUPPORT(member) "vehicle.support[#]." #member
#define PATH_START_ARRAY(member) "initial." #member "[#]"
#define PATH_START(member) "initial." #member
#define PATH_RUN(member) "run." #member
#define PATH_INPUT_ARRAY(member) #member "[#]"
#define PATH_INPUT_NUMBER(member) #member
#define PATH_MOTOR(member) "vehicle.motor." #member
#define PATH_IMU(member) "sensors.imu." #member
#define PATH_IMU_ARRAY(member) PATH_IMU(member) "[#]"
#define PATH_ENCODER(member) "sensors.encoder." #member
#define PATH_WHEEL_ENCODER(member) PATH_ENCODER(member) "[#]"
#define PATH_BODY(member) "vehicle.body[#]." #member
#define PATH_HINGE(member) #member "[#]"
#define PATH_HINGE_START(member) "initial." #member "[#]"
#define PATH_TREE_HINGE(member) PATH_BODY(member)
#define PATH_TREE_WHEEL(member) PATH_WHEEL(member)
#define PATH_TREE_INPUT(member) PATH_HINGE(member)
#define PATH(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) ROW(row_text, number, PATH_##of(member))

static const row_text *path_row(laconic_field field) { RETURN_ROW(row_text, field, EVERY_FIELD(PATH)) }

const char *laconic_field_path(laconic_field field) { return text_or_empty(path_row(field)); }

#define ITEMS_VEHICLE(member) 0
#define ITEMS_PAYLOAD(member) 0
#define ITEMS_COUNT(member) 0
#define ITEMS_GROUND(member) 0
#define ITEMS_DRIVE(member) 0
#define ITEMS_WHEEL(member) LACONIC_MAX_WHEELS
#define ITEMS_OWN(member) LACONIC_MAX_WHEELS
#define ITEMS_SUPPORT(member) LACONIC_MAX_SUPPORTS
#define ITEMS_START_ARRAY(member) sizeof(((laconic_start *)NULL)->member) / sizeof(real)
#define ITEMS_START(member) 0
#define ITEMS_RUN(member) 0
#define ITEMS_INPUT_ARRAY(member) sizeof(((laconic_input *)NULL)->member) / sizeof(real)
#define ITEMS_INPUT_NUMBER(member) 0
#define ITEMS_MOTOR(member) 0
#define ITEMS_IMU(member) 0
#define ITEMS_IMU_ARRAY(member) sizeof(((laconic_imu_settings *)NULL)->member) / sizeof(real)
#define ITEMS_ENCODER(member) 0
#define ITEMS_WHEEL_ENCODER(member) LACONIC_MAX_WHEELS
#define ITEMS_BODY(member) LACONIC_MAX_BODIES
#define ITEMS_HINGE(member) sizeof(((laconic_articulated_input *)NULL)->member) / sizeof(real)
#define ITEMS_HINGE_START(member) sizeof(((laconic_articulated_start *)NULL)->member) / sizeof(real)
#define ITEMS_TREE_HINGE(member) LACONIC_MAX_BODIES
#define ITEMS_TREE_WHEEL(member) LACONIC_MAX_WHEELS
#define ITEMS_TREE_INPUT(member) sizeof(((laconic_tree_input *)NULL)->member) / sizeof(real)
#define TRAITS(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    LACONIC_ROW_OF(number)(ROW(laconic_field_traits, number, \
                               {LACONIC_KIND_##KIND, LACONIC_RULE_##RULE, LACONIC_NEED_##NEED, ITEMS_##of(member)}))

static const laconic_field_traits *traits_row(laconic_field field) {
    RETURN_ROW(laconic_field_traits, field, EVERY_FIELD(TRAITS))
}

const laconic_field_traits *laconic_field_traits_of(laconic_field field) {
    return *laconic_field_name(field) != '\0' ? traits_row(field) : NULL;
}
