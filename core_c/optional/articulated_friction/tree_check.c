/* Checks that every number of a vehicle with hinges on ground with friction is usable. */
#include "articulated_vehicle.h"
#include "geometry.h"
#include "tree_posture.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

#define FLAG_TREE_NUMBER(...)
#define REAL_TREE_NUMBER(type, number, member, RULE) {offsetof(type, member), number, LACONIC_RULE_##RULE},
#define TREE_HINGE_NUMBER(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    KIND##_TREE_NUMBER(laconic_tree_hinge, number, member, RULE)
#define TREE_WHEEL_NUMBER(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    KIND##_TREE_NUMBER(laconic_tree_wheel, number, member, RULE)

static const articulated_number tree_hinge_numbers[] = {LACONIC_TREE_HINGE_FIELDS(TREE_HINGE_NUMBER, )};
static const articulated_number tree_wheel_numbers[] = {LACONIC_TREE_WHEEL_FIELDS(TREE_WHEEL_NUMBER, )};

static laconic_status tree_no_effect(const real *value, laconic_field field, int32_t b, laconic_refusal *why) {
    return *value != R(0) ? refuse(why, LACONIC_NO_EFFECT_ON_HINGE, field, b, *value, R(0)) : LACONIC_OK;
}

/* A number that acts on other kinds of hinges alone would be dropped in silence. */
static laconic_status tree_check_kind(const laconic_body *hung, const laconic_tree_hinge *h, int32_t b,
                                      laconic_refusal *why) {
    const bool motor = hung->hinge == LACONIC_HINGE_MOTOR, prescribed = hung->hinge == LACONIC_HINGE_PRESCRIBED;
    laconic_status status = LACONIC_OK;
    if (hung->hinge == LACONIC_HINGE_COORDINATED)
        return refuse(why, LACONIC_COORDINATED_SLIPS, OF(BODY_HINGE), b, (real)hung->hinge, R(0));
    if (motor || prescribed) {
        status = tree_no_effect(&h->servo_gain_Nm_per_rad, OF(SERVO_GAIN), b, why);
        if (status == LACONIC_OK) status = tree_no_effect(&h->servo_damping_Nms, OF(SERVO_DAMPING), b, why);
    }
    if (status == LACONIC_OK && !motor) {
        status = tree_no_effect(&h->loop_V_per_rad, OF(LOOP_ANGLE_GAIN), b, why);
        if (status == LACONIC_OK) status = tree_no_effect(&h->loop_Vs_per_rad, OF(LOOP_RATE_GAIN), b, why);
        if (status == LACONIC_OK) status = tree_no_effect(&h->current_limit_A, OF(HINGE_CURRENT_LIMIT), b, why);
    }
    if (status == LACONIC_OK && prescribed) {
        status = tree_no_effect(&h->stop_low_rad, OF(HINGE_STOP_LOW), b, why);
        if (status == LACONIC_OK) status = tree_no_effect(&h->stop_high_rad, OF(HINGE_STOP_HIGH), b, why);
    }
    return status;
}

/* A limit without what it limits would be dropped in silence, too. */
static laconic_status tree_check_limits(const laconic_tree_hinge *h, int32_t b, laconic_refusal *why) {
    if (h->stop_low_rad > h->stop_high_rad)
        return refuse(why, LACONIC_ABOVE_LIMIT, OF(HINGE_STOP_LOW), b, h->stop_low_rad, h->stop_high_rad);
    if (h->servo_limit_Nm > R(0) && !tree_has_servo(h))
        return refuse(why, LACONIC_NOT_POSITIVE, OF(SERVO_GAIN), b, R(0), R(0));
    if (h->current_limit_A > R(0) && !(h->winding_resistance_ohm > R(0)))
        return refuse(why, LACONIC_NOT_POSITIVE, OF(HINGE_RESISTANCE), b, R(0), R(0));
    if (h->control_period_s > R(0) && !tree_has_servo(h) && !tree_has_loop(h))
        return refuse(why, LACONIC_NO_EFFECT_ON_HINGE, OF(CONTROL_PERIOD), b, h->control_period_s, R(0));
    return LACONIC_OK;
}

static laconic_status tree_check_wheels(const laconic_tree_vehicle *v, laconic_refusal *why) {
    const size_t count = sizeof tree_wheel_numbers / sizeof tree_wheel_numbers[0];
    bool some = false;
    for (int32_t i = 0; i < v->hinged.base.wheel_count; i++) {
        const laconic_tree_wheel *w = &v->wheel[i];
        const laconic_status status = laconic_articulated_check_numbers(w, tree_wheel_numbers, count, i + 1, why);
        if (status != LACONIC_OK) return status;
        if (w->scrub_fade_m > R(0) && !(w->scrub_radius_m > R(0)))
            return refuse(why, LACONIC_NOT_POSITIVE, OF(SCRUB_RADIUS), i + 1, R(0), R(0));
        some = some || w->load_N > R(0);
    }
    for (int32_t i = 0; some && i < v->hinged.base.wheel_count; i++)
        if (!(v->wheel[i].load_N > R(0)))
            return refuse(why, LACONIC_NOT_POSITIVE, OF(WHEEL_LOAD), i + 1, v->wheel[i].load_N, R(0));
    return LACONIC_OK;
}

laconic_status laconic_tree_check(const laconic_tree_vehicle *vehicle, laconic_refusal *why) {
    const size_t count = sizeof tree_hinge_numbers / sizeof tree_hinge_numbers[0];
    const real friction = vehicle->hinged.base.ground.friction_coefficient;
    laconic_status status = laconic_vehicle_check(&vehicle->hinged.base, why);
    if (status == LACONIC_OK) status = laconic_articulated_check_bodies(&vehicle->hinged, why);
    if (status != LACONIC_OK) return status;
    if (!(friction > R(0)))
        return refuse(why, LACONIC_NOT_POSITIVE, LACONIC_FIELD_GROUND_FRICTION_COEFFICIENT, 0, friction, R(0));
    for (int32_t b = 1; b <= vehicle->hinged.body_count; b++) {
        const laconic_tree_hinge *hinge = &vehicle->hinge[b - 1];
        status = laconic_articulated_check_numbers(hinge, tree_hinge_numbers, count, b, why);
        if (status == LACONIC_OK) status = tree_check_kind(&vehicle->hinged.body[b - 1], hinge, b, why);
        if (status == LACONIC_OK) status = tree_check_limits(hinge, b, why);
        if (status != LACONIC_OK) return status;
    }
    return tree_check_wheels(vehicle, why);
}

#endif
