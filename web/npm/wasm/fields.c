/* A number of a robot by its field and item: the table follows from the lists of vehicle.h, articulated.h
 * and articulated_friction.h. */
#include "web.h"

typedef struct place {
    bool is_field;
    uint32_t offset, stride; /* stride: to the same number of the next item */
    int32_t items;           /* 0: there is only one                        */
    laconic_field_kind kind;
} place;

#define IN_ROBOT(member) offsetof(laconic_web_robot, member)

#define PLACE_VEHICLE(member) IN_ROBOT(vehicle.member), 0, 0
#define PLACE_PAYLOAD(member) IN_ROBOT(vehicle.payload.member), 0, 0
#define PLACE_GROUND(member) IN_ROBOT(vehicle.ground.member), 0, 0
#define PLACE_DRIVE(member) IN_ROBOT(vehicle.drive.member), 0, 0
#define PLACE_COUNT(member) IN_ROBOT(vehicle.member##_count), 0, 0
#define PLACE_WHEEL(member) IN_ROBOT(vehicle.wheel[0].member), sizeof(laconic_wheel), LACONIC_MAX_WHEELS
#define PLACE_OWN(member) PLACE_WHEEL(own_##member)
#define PLACE_SUPPORT(member) IN_ROBOT(vehicle.support[0].member), sizeof(laconic_support), LACONIC_MAX_SUPPORTS
#define REALS_IN(member) sizeof(laconic_real), sizeof(((laconic_web_robot *)NULL)->member) / sizeof(laconic_real)
#define PLACE_START_ARRAY(member) IN_ROBOT(start.member), REALS_IN(start.member)
#define PLACE_START(member) IN_ROBOT(start.member), 0, 0
#define PLACE_INPUT_ARRAY(member) IN_ROBOT(input.member), REALS_IN(input.member)
#define PLACE_INPUT(member) IN_ROBOT(input.member), 0, 0
#define PLACE_MOTOR(member) IN_ROBOT(motor.member), 0, 0
#ifdef LACONIC_WEB_HINGES
#define PLACE_BODY(member) IN_ROBOT(tree.hinged.body[0].member), sizeof(laconic_body), LACONIC_MAX_BODIES
#define PLACE_WHEEL_OF_BODY(member) IN_ROBOT(tree.hinged.wheel_##member[0]), sizeof(int32_t), LACONIC_MAX_WHEELS
#define PLACE_BODY_COUNT(member) IN_ROBOT(tree.hinged.member##_count), 0, 0
#define PLACE_HINGE(member) IN_ROBOT(tree_input.hinged.member), REALS_IN(tree_input.hinged.member)
#define PLACE_HINGE_START(member) IN_ROBOT(tree_start.hinged.member), REALS_IN(tree_start.hinged.member)
#define PLACE_TREE_HINGE(member) IN_ROBOT(tree.hinge[0].member), sizeof(laconic_tree_hinge), LACONIC_MAX_BODIES
#define PLACE_TREE_WHEEL(member) IN_ROBOT(tree.wheel[0].member), sizeof(laconic_tree_wheel), LACONIC_MAX_WHEELS
#define PLACE_TREE_INPUT(member) IN_ROBOT(tree_input.member), REALS_IN(tree_input.member)
#define OF_HINGES(X) \
    LACONIC_BODY_FIELDS(X, BODY) \
    LACONIC_WHEEL_BODY_FIELD(X, WHEEL_OF_BODY) \
    LACONIC_BODY_COUNT_FIELD(X, BODY_COUNT) \
    LACONIC_HINGE_INPUT_FIELDS(X, HINGE) LACONIC_HINGE_START_FIELDS(X, HINGE_START) LACONIC_TREE_FIELDS(X)
#else
#define OF_HINGES(X)
#endif
#define PLACE(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    [number] = {true, PLACE_##of(member), LACONIC_KIND_##KIND},

static const place places[LACONIC_WEB_FIELD_COUNT] = {
    LACONIC_VEHICLE_FIELDS(PLACE, VEHICLE) LACONIC_PAYLOAD_FIELDS(PLACE, PAYLOAD) LACONIC_GROUND_FIELDS(PLACE, GROUND)
        LACONIC_DRIVE_FIELDS(PLACE, DRIVE) LACONIC_WHEEL_COUNT_FIELD(PLACE, COUNT) LACONIC_WHEEL_FIELDS(PLACE, WHEEL)
            LACONIC_OWN_WHEEL_FIELDS(PLACE, OWN) LACONIC_SUPPORT_COUNT_FIELD(PLACE, COUNT)
                LACONIC_SUPPORT_FIELDS(PLACE, SUPPORT) LACONIC_START_ARRAY_FIELDS(PLACE, START_ARRAY)
                    LACONIC_START_FIELDS(PLACE, START) LACONIC_INPUT_ARRAY_FIELDS(PLACE, INPUT_ARRAY)
                        LACONIC_INPUT_FIELDS(PLACE, INPUT) LACONIC_MOTOR_FIELDS(PLACE, MOTOR) OF_HINGES(PLACE)};

static unsigned char *byte_of(laconic_web_robot *robot, const place *of, int32_t item) {
    const bool is_there = of->items == 0 ? item == 0 : item >= 1 && item <= of->items;
    const uint32_t skipped = of->items == 0 ? 0 : (uint32_t)(item - 1) * of->stride;
    return is_there ? (unsigned char *)robot + of->offset + skipped : NULL;
}

/* A double as the integer that it is; one beyond them becomes the nearest, which the core refuses. */
static int32_t whole(double value) {
    if (!(value > -2147483648.0)) return INT32_MIN;
    return value < 2147483647.0 ? (int32_t)value : INT32_MAX;
}

static void note_own_zero(laconic_web_robot *robot, int32_t field, int32_t item, double value) {
    const uint32_t bit = field >= 32 && field < 64 ? (uint32_t)1 << (field - 32) : 0;
    if (bit == 0 || places[field].stride != sizeof(laconic_wheel)) return;
    if (value == 0)
        robot->own_zero[item - 1] |= bit;
    else
        robot->own_zero[item - 1] &= ~bit;
}

/* item: from 1, or 0 for a field without items. Returns whether the robot has such a number. Flags: 0 or 1; of
 * what is told by its absence 1 means that it is absent. */
WEB_EXPORT(laconic_web_set) bool laconic_web_set(laconic_web_robot *robot, int32_t field, int32_t item, double value) {
    const bool is_field = field > 0 && field < LACONIC_WEB_FIELD_COUNT && places[field].is_field;
    unsigned char *target = is_field ? byte_of(robot, &places[field], item) : NULL;
    if (target == NULL) return false;
    switch (places[field].kind) {
    case LACONIC_KIND_REAL: *(laconic_real *)(void *)target = value; break;
    case LACONIC_KIND_INTEGER: *(int32_t *)(void *)target = whole(value); break;
    case LACONIC_KIND_WHEEL_KIND: *(laconic_wheel_kind *)(void *)target = (laconic_wheel_kind)whole(value); break;
    case LACONIC_KIND_FLAG:
    case LACONIC_KIND_ABSENCE: *(bool *)(void *)target = value != 0; break;
    }
    note_own_zero(robot, field, item, value);
    return true;
}

/* The robot has a motor, whose numbers are those of vehicle.motor. */
WEB_EXPORT(laconic_web_set_motor) void laconic_web_set_motor(laconic_web_robot *robot, bool has_motor) {
    robot->has_motor = has_motor;
}
