/* Checks that every number of an articulated vehicle is usable by itself. */
#include "articulated_vehicle.h"

#if LACONIC_MAX_BODIES > 0

#define INTEGER_BODY_NUMBER(...)
#define REAL_BODY_NUMBER(number, member, RULE) {offsetof(laconic_body, member), number, LACONIC_RULE_##RULE},
#define BODY_NUMBER(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) KIND##_BODY_NUMBER(number, member, RULE)

static const articulated_number of_hung_body[] = {LACONIC_BODY_FIELDS(BODY_NUMBER, )};

static laconic_status check_body_number(real value, const articulated_number *number, int32_t item,
                                        laconic_refusal *why) {
    const laconic_field field = (laconic_field)number->field;
    if (!fits_squared(value))
        return refuse(why, is_finite(value) ? LACONIC_OVERFLOW : LACONIC_NOT_FINITE, field, item, value, R(0));
    if (number->rule == LACONIC_RULE_NOT_NEGATIVE && value < R(0))
        return refuse(why, LACONIC_NEGATIVE, field, item, value, R(0));
    if (number->rule == LACONIC_RULE_ANGLE && magnitude(value) > LARGEST_ANGLE)
        return refuse(why, LACONIC_OVERFLOW, field, item, value, LARGEST_ANGLE);
    return LACONIC_OK;
}

laconic_status laconic_articulated_check_numbers(const void *of, const articulated_number *numbers, size_t count,
                                                 int32_t item, laconic_refusal *why) {
    laconic_status status = LACONIC_OK;
    for (size_t k = 0; status == LACONIC_OK && k < count; k++)
        status = check_body_number(*number_at(of, numbers[k].offset), &numbers[k], item, why);
    return status;
}

static laconic_status check_hinge(const laconic_body *hung, int32_t b, laconic_refusal *why) {
    const int32_t kind = (int32_t)hung->hinge;
    if (kind == LACONIC_HINGE_UNSET) return refuse(why, LACONIC_HINGE_NOT_SET, OF(BODY_HINGE), b, R(0), R(0));
    if (kind < LACONIC_HINGE_FREE || kind > LACONIC_HINGE_COORDINATED)
        return refuse(why, LACONIC_HINGE_KIND_UNKNOWN, OF(BODY_HINGE), b, (real)kind, R(0));
    if (hung->parent < 0 || hung->parent >= b)
        return refuse(why, LACONIC_BODY_UNKNOWN, OF(BODY_PARENT), b, (real)hung->parent, (real)(b - 1));
    if (kind == LACONIC_HINGE_COORDINATED && hung->parent != 0)
        return refuse(why, LACONIC_COORDINATED_ON_BODY, OF(BODY_PARENT), b, (real)hung->parent, R(0));
    return LACONIC_OK;
}

static laconic_status check_hung_body(const laconic_body *hung, int32_t b, laconic_refusal *why) {
    const size_t count = sizeof of_hung_body / sizeof of_hung_body[0];
    const laconic_status status = check_hinge(hung, b, why);
    return status == LACONIC_OK ? laconic_articulated_check_numbers(hung, of_hung_body, count, b, why) : status;
}

static laconic_status check_ground(const laconic_vehicle *base, laconic_refusal *why) {
#if LACONIC_WITH_FRICTION
    const real axle = base->ground.friction_coefficient;
    if (axle > R(0))
        return refuse(why, LACONIC_FRICTION_WITH_HINGES, LACONIC_FIELD_GROUND_FRICTION_COEFFICIENT, 0, axle, R(0));
    if (base->drive.supply_V > R(0))
        return refuse(why, LACONIC_FRICTION_WITH_HINGES, LACONIC_FIELD_SUPPLY_VOLTAGE, 0, base->drive.supply_V, R(0));
    if (base->drive.current_limit_A > R(0))
        return refuse(why, LACONIC_FRICTION_WITH_HINGES, LACONIC_FIELD_CURRENT_LIMIT, 0, base->drive.current_limit_A,
                      R(0));
    for (int32_t i = 0; i < base->wheel_count; i++)
        if (base->wheel[i].motor_circuit != LACONIC_MOTOR_DRIVEN)
            return refuse(why, LACONIC_FRICTION_WITH_HINGES, LACONIC_FIELD_MOTOR_CIRCUIT, i + 1,
                          (real)base->wheel[i].motor_circuit, R(0));
#else
    (void)base;
    (void)why;
#endif
    return LACONIC_OK;
}

laconic_status laconic_articulated_check_bodies(const laconic_articulated_vehicle *vehicle, laconic_refusal *why) {
    if (vehicle->body_count < 0 || vehicle->body_count > LACONIC_MAX_BODIES)
        return refuse(why, LACONIC_TOO_MANY_BODIES, OF(BODY_COUNT), 0, (real)vehicle->body_count,
                      R(LACONIC_MAX_BODIES));
    for (int32_t i = 0; i < vehicle->base.wheel_count; i++)
        if (vehicle->wheel_body[i] < 0 || vehicle->wheel_body[i] > vehicle->body_count)
            return refuse(why, LACONIC_BODY_UNKNOWN, OF(WHEEL_BODY), i + 1, (real)vehicle->wheel_body[i],
                          (real)vehicle->body_count);
    for (int32_t b = 1; b <= vehicle->body_count; b++) {
        const laconic_status status = check_hung_body(&vehicle->body[b - 1], b, why);
        if (status != LACONIC_OK) return status;
    }
    return LACONIC_OK;
}

laconic_status laconic_articulated_check(const laconic_articulated_vehicle *vehicle, laconic_refusal *why) {
    laconic_status status = laconic_vehicle_check(&vehicle->base, why);
    if (status == LACONIC_OK) status = check_ground(&vehicle->base, why);
    return status == LACONIC_OK ? laconic_articulated_check_bodies(vehicle, why) : status;
}

#endif
