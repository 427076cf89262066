/* Checks that every number of a vehicle is usable. */
#include "geometry.h"
#include "vector.h"

typedef struct checked_number {
    uint16_t offset; /* in the struct that the table is for */
    uint8_t field, rule;
} checked_number;

#define IN_VEHICLE(prefix, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    LACONIC_ROW_OF(number)({offsetof(laconic_vehicle, prefix member), number, LACONIC_RULE_##RULE}, )
#define IN_WHEEL(prefix, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    LACONIC_ROW_OF(number)({offsetof(laconic_wheel, member), number, LACONIC_RULE_##RULE}, )
#define IN_OWN(prefix, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    LACONIC_ROW_OF(number)({offsetof(laconic_wheel, own_##member), number, LACONIC_RULE_##RULE}, )
#define IN_SUPPORT(prefix, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    LACONIC_ROW_OF(number)({offsetof(laconic_support, member), number, LACONIC_RULE_##RULE}, )

static const checked_number of_body[] = {LACONIC_VEHICLE_FIELDS(IN_VEHICLE, ) LACONIC_PAYLOAD_FIELDS(
    IN_VEHICLE, payload.) LACONIC_GROUND_FIELDS(IN_VEHICLE, ground.) LACONIC_DRIVE_FIELDS(IN_VEHICLE, drive.)};
static const checked_number of_wheel[] = {LACONIC_WHEEL_FIELDS(IN_WHEEL, ) LACONIC_OWN_WHEEL_FIELDS(IN_OWN, )};
static const checked_number of_support[] = {LACONIC_SUPPORT_FIELDS(IN_SUPPORT, )};

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

/* 86°: beyond it nothing stands, and the normal load, cos α, is all rounding soon. */
#define LARGEST_INCLINE R(1.5)

static laconic_status check_number(real value, const checked_number *number, int32_t item, laconic_refusal *why) {
    const laconic_field field = (laconic_field)number->field;
    const uint8_t rule = number->rule;
    if (!fits_squared(value)) /* here it has a name; where several leave the range together, it is prepare's */
        return refuse(why, is_finite(value) ? LACONIC_OVERFLOW : LACONIC_NOT_FINITE, field, item, value, R(0));
    if (rule == LACONIC_RULE_POSITIVE && value <= R(0))
        return refuse(why, LACONIC_NOT_POSITIVE, field, item, value, R(0));
    if (rule == LACONIC_RULE_POSITIVE && value < LACONIC_REAL_MIN)
        return refuse(why, LACONIC_OVERFLOW, field, item, value, LACONIC_REAL_MIN);
    if (rule >= LACONIC_RULE_NOT_NEGATIVE && rule <= LACONIC_RULE_INCLINE && value < R(0))
        return refuse(why, LACONIC_NEGATIVE, field, item, value, R(0));
    if (LACONIC_WITH_FRICTION && rule == LACONIC_RULE_SHARE && value > R(1))
        return refuse(why, LACONIC_ABOVE_LIMIT, field, item, value, R(1));
    if (LACONIC_WITH_SLOPE && rule == LACONIC_RULE_INCLINE && value > LARGEST_INCLINE)
        return refuse(why, LACONIC_ABOVE_LIMIT, field, item, value, LARGEST_INCLINE);
    if (rule >= LACONIC_RULE_ANGLE && magnitude(value) > LARGEST_ANGLE)
        return refuse(why, LACONIC_OVERFLOW, field, item, value, LARGEST_ANGLE);
    if (rule == LACONIC_RULE_ROLLER && magnitude(laconic_direction_of_angle(value).sine) < LACONIC_SMALLEST_ROLLER_SINE)
        return refuse(why, LACONIC_ROLLER_ALONG_AXLE, field, item, value, R(0));
    return LACONIC_OK;
}

/* The numbers with rules from `first` to `last` of a struct. */
static laconic_status check_numbers(const void *of, const checked_number *numbers, size_t count, uint8_t first,
                                    uint8_t last, int32_t item, laconic_refusal *why) {
    for (size_t k = 0; k < count; k++) {
        if (numbers[k].rule < first || numbers[k].rule > last) continue;
        const laconic_status status = check_number(*number_at(of, numbers[k].offset), &numbers[k], item, why);
        if (status != LACONIC_OK) return status;
    }
    return LACONIC_OK;
}

static laconic_status check_body(const laconic_vehicle *v, laconic_refusal *why) {
    for (uint8_t rule = LACONIC_RULE_POSITIVE; rule < (uint8_t)LACONIC_RULE_COUNT; rule++) {
        const laconic_status status = check_numbers(v, of_body, COUNT(of_body), rule, rule, 0, why);
        if (status != LACONIC_OK) return status;
    }
    return LACONIC_OK;
}

static laconic_status check_wheel(const laconic_wheel *w, int32_t item, laconic_refusal *why) {
    const uint8_t last = w->kind == LACONIC_WHEEL_ROLLER ? LACONIC_RULE_ROLLER : LACONIC_RULE_ANGLE;
    if (w->kind == LACONIC_WHEEL_UNSET)
        return refuse(why, LACONIC_WHEEL_NOT_SET, LACONIC_FIELD_WHEEL_KIND, item, R(0), R(0));
    if (w->kind != LACONIC_WHEEL_ROLLER && w->kind != LACONIC_WHEEL_FIXED)
        return refuse(why, LACONIC_WHEEL_KIND_UNKNOWN, LACONIC_FIELD_WHEEL_KIND, item, (real)w->kind, R(0));
#if LACONIC_WITH_FRICTION
    if (w->motor_circuit < LACONIC_MOTOR_DRIVEN || w->motor_circuit > LACONIC_MOTOR_SHORTED)
        return refuse(why, LACONIC_MOTOR_CIRCUIT_UNKNOWN, LACONIC_FIELD_MOTOR_CIRCUIT, item, (real)w->motor_circuit,
                      R(0));
#endif
    return check_numbers(w, of_wheel, COUNT(of_wheel), LACONIC_RULE_POSITIVE, last, item, why);
}

static laconic_status check_supports(const laconic_vehicle *v, laconic_refusal *why) {
    if (v->support_count < 0 || v->support_count > LACONIC_MAX_SUPPORTS)
        return refuse(why, LACONIC_TOO_MANY_SUPPORTS, LACONIC_FIELD_SUPPORT_COUNT, 0, (real)v->support_count,
                      R(LACONIC_MAX_SUPPORTS));
    for (int32_t i = 0; i < v->support_count; i++) {
        const laconic_status status = check_numbers(&v->support[i], of_support, COUNT(of_support),
                                                    LACONIC_RULE_POSITIVE, LACONIC_RULE_ROLLER, i + 1, why);
        if (status != LACONIC_OK) return status;
    }
    return LACONIC_OK;
}

/* ------------------------------------------------------- what ground and drive need of each other -- */

#if LACONIC_WITH_FRICTION
/* Ground and drive are asked for before the vehicle is checked, so a count beyond the array must not be followed. */
static bool has_wheels(const laconic_vehicle *v) { return v->wheel_count > 0 && v->wheel_count <= LACONIC_MAX_WHEELS; }

bool laconic_vehicle_slips(const laconic_vehicle *vehicle) {
    return vehicle->ground.friction_coefficient > R(0) && has_wheels(vehicle);
}

bool laconic_vehicle_has_drive(const laconic_vehicle *vehicle) {
    bool has = vehicle->drive.supply_V > R(0) || vehicle->drive.current_limit_A > R(0);
    if (!has_wheels(vehicle)) return false;
    for (int32_t i = 0; i < vehicle->wheel_count; i++)
        has = has || vehicle->wheel[i].motor_circuit != LACONIC_MOTOR_DRIVEN;
    return has;
}

bool laconic_vehicle_has_friction(const laconic_vehicle *vehicle) {
    return LACONIC_WITH_FRICTION && (laconic_vehicle_slips(vehicle) || laconic_vehicle_has_drive(vehicle));
}

/* On ideal ground drag and axle friction would do nothing; and a wheel's own coefficient alone would leave all others
 * without friction. */
static laconic_status check_ideal_ground(const laconic_vehicle *v, laconic_refusal *why) {
    const laconic_status without = LACONIC_FRICTION_MISSING;
    if (v->ground.roller_drag > R(0))
        return refuse(why, without, LACONIC_FIELD_GROUND_ROLLER_DRAG, 0, v->ground.roller_drag, R(0));
    if (v->ground.axle_friction_Nm > R(0))
        return refuse(why, without, LACONIC_FIELD_GROUND_AXLE_FRICTION, 0, v->ground.axle_friction_Nm, R(0));
    for (int32_t i = 0; i < v->wheel_count; i++) {
        const laconic_wheel *w = &v->wheel[i];
        if (w->own_friction_coefficient > R(0))
            return refuse(why, without, LACONIC_FIELD_WHEEL_FRICTION_COEFFICIENT, i + 1, w->own_friction_coefficient,
                          R(0));
        if (w->own_roller_drag > R(0))
            return refuse(why, without, LACONIC_FIELD_WHEEL_ROLLER_DRAG, i + 1, w->own_roller_drag, R(0));
        if (w->own_axle_friction_Nm > R(0))
            return refuse(why, without, LACONIC_FIELD_WHEEL_AXLE_FRICTION, i + 1, w->own_axle_friction_Nm, R(0));
    }
    return LACONIC_OK;
}

/* Limits are of currents, which follow from torques by the winding's resistance. */
static laconic_status check_drive(const laconic_vehicle *v, laconic_refusal *why) {
    const laconic_drive *d = &v->drive;
    if ((d->supply_V > R(0) || d->current_limit_A > R(0)) && !(d->winding_resistance_ohm > R(0)))
        return refuse(why, LACONIC_NOT_POSITIVE, LACONIC_FIELD_WINDING_RESISTANCE, 0, d->winding_resistance_ohm, R(0));
    if (d->supply_resistance_ohm > R(0) && !(d->supply_V > R(0)))
        return refuse(why, LACONIC_NOT_POSITIVE, LACONIC_FIELD_SUPPLY_VOLTAGE, 0, d->supply_V, R(0));
    return LACONIC_OK;
}

/* The wheels' speeds are states, so each has an inertia of its own. */
static laconic_status check_inertias(const laconic_vehicle *v, laconic_refusal *why) {
    for (int32_t i = 0; i < v->wheel_count; i++) {
        const real inertia = laconic_wheel_values(v, i).inertia_kgm2;
        if (!(inertia > R(0))) return refuse(why, LACONIC_NOT_POSITIVE, LACONIC_FIELD_WHEEL_INERTIA, 0, inertia, R(0));
    }
    return LACONIC_OK;
}

static laconic_status check_friction(const laconic_vehicle *v, laconic_refusal *why) {
    const bool slips = laconic_vehicle_slips(v);
    laconic_status status = LACONIC_OK;
    if (slips && v->friction_coefficient > R(0))
        return refuse(why, LACONIC_FRICTION_TWICE, LACONIC_FIELD_FRICTION_COEFFICIENT, 0, v->friction_coefficient,
                      R(0));
    if (!slips) status = check_ideal_ground(v, why);
    if (status == LACONIC_OK) status = check_drive(v, why);
    if (status == LACONIC_OK && laconic_vehicle_has_friction(v)) status = check_inertias(v, why);
    return status;
}
#else
bool laconic_vehicle_has_friction(const laconic_vehicle *vehicle) { return (void)vehicle, false; }

static laconic_status check_friction(const laconic_vehicle *v, laconic_refusal *why) {
    return (void)v, (void)why, LACONIC_OK;
}
#endif

laconic_status laconic_vehicle_check(const laconic_vehicle *vehicle, laconic_refusal *why) {
    laconic_status status = check_body(vehicle, why);
    if (status != LACONIC_OK) return status;
    if (vehicle->wheel_count < 0 || vehicle->wheel_count > LACONIC_MAX_WHEELS)
        return refuse(why, LACONIC_TOO_MANY_WHEELS, LACONIC_FIELD_WHEEL_COUNT, 0, (real)vehicle->wheel_count,
                      R(LACONIC_MAX_WHEELS));
    for (int32_t i = 0; i < vehicle->wheel_count; i++) {
        status = check_wheel(&vehicle->wheel[i], i + 1, why);
        if (status != LACONIC_OK) return status;
    }
    status = check_supports(vehicle, why);
    return status == LACONIC_OK ? check_friction(vehicle, why) : status;
}
