/* A wheel's own 0. In a laconic_wheel 0 means the vehicle's value, so a wheel whose own value is 0 needs the vehicle's
 * to be 0, and all other wheels need it as their own. */
#include "web.h"

typedef struct own_value {
    int32_t field; /* of the wheel */
    size_t in_wheel, in_vehicle;
    bool is_inertia;
} own_value;

#define OWN(IDENTIFIER, member, common) \
    {LACONIC_FIELD_##IDENTIFIER, offsetof(laconic_wheel, member), offsetof(laconic_vehicle, common), false}

/* A radius and a friction coefficient cannot be 0. */
static const own_value own_values[] = {
    {LACONIC_FIELD_OWN_INERTIA, offsetof(laconic_wheel, own_inertia_kgm2),
     offsetof(laconic_vehicle, wheel_inertia_kgm2), true},
    OWN(OWN_MOTOR_GAIN, own_motor_gain_Nm_per_V, motor_gain_Nm_per_V),
    OWN(OWN_MOTOR_DAMPING, own_motor_damping_Nms, motor_damping_Nms),
    OWN(WHEEL_ROLLER_DRAG, own_roller_drag, ground.roller_drag),
    OWN(WHEEL_AXLE_FRICTION, own_axle_friction_Nm, ground.axle_friction_Nm),
};

static laconic_real *real_at(void *structure, size_t offset) {
    return (laconic_real *)(void *)((unsigned char *)structure + offset);
}

static bool is_zero(const laconic_web_robot *robot, int32_t wheel, int32_t field) {
    return (robot->own_zero[wheel] >> (field - 32) & 1U) != 0;
}

static void let_hold(laconic_vehicle *vehicle, const laconic_web_robot *robot, const own_value *own, int32_t wheels) {
    laconic_real *common = real_at(vehicle, own->in_vehicle);
    bool any = false;
    for (int32_t i = 0; i < wheels; i++) any = any || is_zero(robot, i, own->field);
    if (!any || *common == 0) return;
    for (int32_t i = 0; i < wheels; i++) {
        laconic_real *value = real_at(&vehicle->wheel[i], own->in_wheel);
        if (*value == 0 && !is_zero(robot, i, own->field)) *value = *common;
    }
    *common = 0;
}

void laconic_web_own_zeros(laconic_vehicle *vehicle, const laconic_web_robot *robot, bool inertias) {
    const int32_t count = vehicle->wheel_count, wheels = count < LACONIC_MAX_WHEELS ? count : LACONIC_MAX_WHEELS;
    for (size_t k = 0; k < sizeof own_values / sizeof own_values[0]; k++)
        if (own_values[k].is_inertia == inertias) let_hold(vehicle, robot, &own_values[k], wheels);
}

laconic_status laconic_web_vehicle(laconic_vehicle *vehicle, const laconic_web_robot *robot, laconic_refusal *why) {
    *vehicle = robot->vehicle;
    laconic_web_own_zeros(vehicle, robot, true);
    if (robot->has_motor) {
        const laconic_status status = laconic_motor_fit(vehicle, &robot->motor, why);
        if (status != LACONIC_OK) return status;
    }
    laconic_web_own_zeros(vehicle, robot, false);
    return LACONIC_OK;
}
