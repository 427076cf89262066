/* Is every number of a vehicle usable? Tests are written so that NaN fails them. */
#include "elementary.h"

static laconic_status check_number(real value, laconic_field field, int32_t item, laconic_refusal *why) {
    return is_finite(value) ? LACONIC_OK : refuse(why, LACONIC_NOT_FINITE, field, item, value, R(0));
}

static laconic_status check_positive(real value, laconic_field field, laconic_refusal *why) {
    const laconic_status status = check_number(value, field, 0, why);
    if (status != LACONIC_OK || value >= LACONIC_REAL_MIN) return status;
    if (value > R(0)) return refuse(why, LACONIC_OVERFLOW, field, 0, value, LACONIC_REAL_MIN);
    return refuse(why, LACONIC_NOT_POSITIVE, field, 0, value, R(0));
}

static laconic_status check_not_negative(real value, laconic_field field, laconic_refusal *why) {
    const laconic_status status = check_number(value, field, 0, why);
    if (status != LACONIC_OK || value >= R(0)) return status;
    return refuse(why, LACONIC_NEGATIVE, field, 0, value, R(0));
}

typedef struct number {
    real value;
    laconic_field field;
} number;

typedef laconic_status (*number_check)(real value, laconic_field field, laconic_refusal *why);

static laconic_status check_plain(real value, laconic_field field, laconic_refusal *why) {
    return check_number(value, field, 0, why);
}

static laconic_status check_each(const number *numbers, size_t count, number_check check, laconic_refusal *why) {
    size_t i;
    for (i = 0; i < count; i++) {
        const laconic_status status = check(numbers[i].value, numbers[i].field, why);
        if (status != LACONIC_OK) return status;
    }
    return LACONIC_OK;
}

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static laconic_status check_body(const laconic_vehicle *v, laconic_refusal *why) {
    const number positive[] = {
        {v->mass_kg, LACONIC_FIELD_MASS},
        {v->yaw_inertia_kgm2, LACONIC_FIELD_YAW_INERTIA},
        {v->wheel_radius_m, LACONIC_FIELD_WHEEL_RADIUS},
    };
    const number not_negative[] = {
        {v->wheel_inertia_kgm2, LACONIC_FIELD_WHEEL_INERTIA},
        {v->motor_damping_Nms, LACONIC_FIELD_MOTOR_DAMPING},
        {v->com_z_m, LACONIC_FIELD_COM_Z},
        {v->friction_coefficient, LACONIC_FIELD_FRICTION_COEFFICIENT},
        {v->payload.mass_kg, LACONIC_FIELD_PAYLOAD_MASS},
        {v->payload.yaw_inertia_kgm2, LACONIC_FIELD_PAYLOAD_YAW_INERTIA},
    };
    const number any[] = {
        {v->com_x_m, LACONIC_FIELD_COM_X},
        {v->com_y_m, LACONIC_FIELD_COM_Y},
        {v->motor_gain_Nm_per_V, LACONIC_FIELD_MOTOR_GAIN},
        {v->payload.x_m, LACONIC_FIELD_PAYLOAD_X},
        {v->payload.y_m, LACONIC_FIELD_PAYLOAD_Y},
    };
    laconic_status status = check_each(positive, COUNT(positive), check_positive, why);
    if (status == LACONIC_OK) status = check_each(not_negative, COUNT(not_negative), check_not_negative, why);
    if (status == LACONIC_OK) status = check_each(any, COUNT(any), check_plain, why);
    return status;
}

/* Where neighbouring numbers are further apart than the smallest angle that counts, there is no direction any more. */
static laconic_status check_angle(real value, laconic_field field, int32_t item, laconic_refusal *why) {
    const real largest = LACONIC_SMALLEST_ROLLER_SINE / LACONIC_EPSILON;
    const laconic_status status = check_number(value, field, item, why);
    if (status != LACONIC_OK || magnitude(value) <= largest) return status;
    return refuse(why, LACONIC_OVERFLOW, field, item, value, largest);
}

static laconic_status check_roller(const laconic_wheel *w, int32_t item, laconic_refusal *why) {
    const laconic_status status = check_angle(w->roller_rad, LACONIC_FIELD_ROLLER, item, why);
    if (status != LACONIC_OK) return status;
    if (magnitude(laconic_direction_of_angle(w->roller_rad).sine) < LACONIC_SMALLEST_ROLLER_SINE)
        return refuse(why, LACONIC_ROLLER_ALONG_AXLE, LACONIC_FIELD_ROLLER, item, w->roller_rad, R(0));
    return LACONIC_OK;
}

static laconic_status check_wheel(const laconic_wheel *w, int32_t item, laconic_refusal *why) {
    laconic_status status;
    if (w->kind == LACONIC_WHEEL_UNSET)
        return refuse(why, LACONIC_WHEEL_NOT_SET, LACONIC_FIELD_WHEEL_KIND, item, R(0), R(0));
    if (w->kind != LACONIC_WHEEL_ROLLER && w->kind != LACONIC_WHEEL_FIXED)
        return refuse(why, LACONIC_WHEEL_KIND_UNKNOWN, LACONIC_FIELD_WHEEL_KIND, item, (real)w->kind, R(0));
    status = check_number(w->x_m, LACONIC_FIELD_WHEEL_X, item, why);
    if (status == LACONIC_OK) status = check_number(w->y_m, LACONIC_FIELD_WHEEL_Y, item, why);
    if (status == LACONIC_OK) status = check_angle(w->axle_rad, LACONIC_FIELD_AXLE, item, why);
    if (status == LACONIC_OK && w->kind == LACONIC_WHEEL_ROLLER) status = check_roller(w, item, why);
    return status;
}

static laconic_status check_supports(const laconic_vehicle *v, laconic_refusal *why) {
    int32_t i;
    if (v->support_count < 0 || v->support_count > LACONIC_MAX_SUPPORTS)
        return refuse(why, LACONIC_TOO_MANY_SUPPORTS, LACONIC_FIELD_SUPPORT_COUNT, 0, (real)v->support_count,
                      R(LACONIC_MAX_SUPPORTS));
    for (i = 0; i < v->support_count; i++) {
        laconic_status status = check_number(v->support[i].x_m, LACONIC_FIELD_SUPPORT_X, i + 1, why);
        if (status == LACONIC_OK) status = check_number(v->support[i].y_m, LACONIC_FIELD_SUPPORT_Y, i + 1, why);
        if (status != LACONIC_OK) return status;
    }
    return LACONIC_OK;
}

laconic_status laconic_vehicle_check(const laconic_vehicle *vehicle, laconic_refusal *why) {
    int32_t i;
    laconic_status status = check_body(vehicle, why);
    if (status != LACONIC_OK) return status;
    if (vehicle->wheel_count < 0 || vehicle->wheel_count > LACONIC_MAX_WHEELS)
        return refuse(why, LACONIC_TOO_MANY_WHEELS, LACONIC_FIELD_WHEEL_COUNT, 0, (real)vehicle->wheel_count,
                      R(LACONIC_MAX_WHEELS));
    for (i = 0; i < vehicle->wheel_count; i++) {
        status = check_wheel(&vehicle->wheel[i], i + 1, why);
        if (status != LACONIC_OK) return status;
    }
    return check_supports(vehicle, why);
}
