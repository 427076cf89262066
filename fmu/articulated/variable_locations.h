/* For each variable of modelDescription.xml its offset in fmu_model, the group that must be computed before it is read,
 * and the offset of its slope. Parameters and inputs follow from the core's lists of fields. */
#ifndef LACONIC_FMU_ARTICULATED_VARIABLE_LOCATIONS_H
#define LACONIC_FMU_ARTICULATED_VARIABLE_LOCATIONS_H

#include "instance.h" /* and by it model.h, of this model or of slipping/ */
#include "location_macros.h"

/* IN_MODEL(vehicle): where the core's struct of a vehicle with hinges is, in the larger one of a vehicle that slips. */
#if FMU_MODEL_SLIPS
#define IN_MODEL(part) part.hinged
#else
#define IN_MODEL(part) part
#endif
#define IN_VEHICLE(member) FMU_PLAIN(IN_MODEL(vehicle).base.member)
#define IN_PAYLOAD(member) FMU_PLAIN(IN_MODEL(vehicle).base.payload.member)
#define IN_GROUND(member) FMU_PLAIN(IN_MODEL(vehicle).base.ground.member)
#define IN_WHEEL(member) FMU_AT(IN_MODEL(vehicle).base.wheel[0].member), sizeof(laconic_wheel), 0, FMU_NO_TANGENT
#define IN_OWN(member) IN_WHEEL(own_##member)
#define IN_SUPPORT(member) FMU_AT(IN_MODEL(vehicle).base.support[0].member), sizeof(laconic_support), 0, FMU_NO_TANGENT
#define IN_COUNT(member) IN_COUNT_##member
#define IN_COUNT_wheel FMU_PLAIN(IN_MODEL(vehicle).base.wheel_count)
#define IN_COUNT_support FMU_PLAIN(IN_MODEL(vehicle).base.support_count)
#define IN_BODY_COUNT(member) FMU_PLAIN(IN_MODEL(vehicle).body_count)
#define IN_WHEEL_BODY(member) FMU_AT(IN_MODEL(vehicle).wheel_body), sizeof(int32_t), 0, FMU_NO_TANGENT
#define IN_BODY(member) FMU_AT(IN_MODEL(vehicle).body[0].member), sizeof(laconic_body), 0, FMU_NO_TANGENT
#define IN_START(member) FMU_PLAIN(IN_MODEL(start).member)
#define IN_HINGE_START(member) FMU_AT(IN_MODEL(start).member), sizeof(double), 0, FMU_NO_TANGENT
#define IN_RUN(member) FMU_PLAIN(member)
#define IN_INPUT_ARRAY(member) FMU_MOVING(IN_MODEL(input).base.member, 0)
#define IN_INPUT(member) FMU_MOVING(IN_MODEL(input).base.member, 0)
#define IN_HINGE(member) FMU_MOVING(IN_MODEL(input).member, 0)
#define FIELD(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) FMU_LOCATION(name, IN_##of(member))
#define OUTPUT(name, member, group) FMU_LOCATION(name, FMU_AT(member), sizeof(double), group, FMU_NO_TANGENT)
#define STATE(name, member) \
    OUTPUT(name, at.member, FMU_GROUP_PLACE) \
    OUTPUT(der_##name, rate.member, FMU_GROUP_RATES)

/* clang-format off */
enum fmu_locations {
    FMU_LOCATION(time, FMU_PLAIN(time_s))
    LACONIC_VEHICLE_FIELDS(FIELD, VEHICLE)
    LACONIC_PAYLOAD_FIELDS(FIELD, PAYLOAD)
    LACONIC_GROUND_FIELDS(FIELD, GROUND)
    LACONIC_WHEEL_COUNT_FIELD(FIELD, COUNT)
    LACONIC_WHEEL_FIELDS(FIELD, WHEEL)
    LACONIC_OWN_WHEEL_FIELDS(FIELD, OWN)
    LACONIC_SUPPORT_COUNT_FIELD(FIELD, COUNT)
    LACONIC_SUPPORT_FIELDS(FIELD, SUPPORT)
    LACONIC_BODY_COUNT_FIELD(FIELD, BODY_COUNT)
    LACONIC_WHEEL_BODY_FIELD(FIELD, WHEEL_BODY)
    LACONIC_BODY_FIELDS(FIELD, BODY)
    LACONIC_START_FIELDS(FIELD, START)
    LACONIC_HINGE_START_FIELDS(FIELD, HINGE_START)
    LACONIC_INPUT_ARRAY_FIELDS(FIELD, INPUT_ARRAY)
    LACONIC_INPUT_FIELDS(FIELD, INPUT)
    LACONIC_HINGE_INPUT_FIELDS(FIELD, HINGE)
#if FMU_MODEL_SLIPS
    SLIPPING_LOCATIONS /* model.h */
#else
    LACONIC_RUN_FIELDS(FIELD, RUN)
    FMU_LOCATION(hinge_is_ball, FMU_AT(hinge_is_ball), sizeof(bool), 0, FMU_NO_TANGENT)
    STATE(x_m, x_m)
    STATE(y_m, y_m)
    STATE(heading_rad, heading_rad)
    STATE(hinge_rad, hinge_rad)
    STATE(wheel_angle_rad, wheel_angle_rad)
    STATE(carriage_zeta, zeta)
    STATE(own_yaw_rate_rad_per_s, own)

    OUTPUT(heading_wrapped_rad, heading_wrapped_rad, FMU_GROUP_MOTION)
    OUTPUT(origin_x_m, origin_m[0], FMU_GROUP_MOTION)
    OUTPUT(origin_y_m, origin_m[1], FMU_GROUP_MOTION)
    OUTPUT(velocity_body_m_per_s, motion.velocity_m_per_s, FMU_GROUP_MOTION)
    OUTPUT(yaw_rate_rad_per_s, motion.yaw_rate_rad_per_s, FMU_GROUP_MOTION)
    OUTPUT(hinge_rate_rad_per_s, motion.hinge_rate_rad_per_s, FMU_GROUP_MOTION)
    OUTPUT(body_x_m, motion.body_x_m, FMU_GROUP_MOTION)
    OUTPUT(body_y_m, motion.body_y_m, FMU_GROUP_MOTION)
    OUTPUT(body_heading_rad, motion.body_heading_rad, FMU_GROUP_MOTION)
    OUTPUT(wheel_speed_rad_per_s, motion.wheel_speed_rad_per_s, FMU_GROUP_MOTION)
    OUTPUT(energy_J, motion.energy_J, FMU_GROUP_MOTION)

    OUTPUT(wheel_torque_Nm, ground.wheel_torque_Nm, FMU_GROUP_GROUND)
    OUTPUT(wheel_reaction_N, ground.along_N, FMU_GROUP_GROUND)
    OUTPUT(wheel_lateral_N, ground.lateral_N, FMU_GROUP_GROUND)
    OUTPUT(hinge_reaction_Nm, ground.hinge_torque_Nm, FMU_GROUP_GROUND)
    OUTPUT(hinge_force_along_N, hinge_force_along_N, FMU_GROUP_GROUND)
    OUTPUT(hinge_force_across_N, hinge_force_across_N, FMU_GROUP_GROUND)
    OUTPUT(wheel_load_N, wheel_load_N, FMU_GROUP_GROUND)
    OUTPUT(support_load_N, support_load_N, FMU_GROUP_GROUND)
    OUTPUT(no_slip_margin_N, ground.no_slip_margin_N, FMU_GROUP_GROUND)
#endif
};
/* clang-format on */

#endif
