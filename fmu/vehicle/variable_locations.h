/* For each variable of modelDescription.xml its offset in fmu_model, the group that must be computed before it is
 * read, and the offset of its derivative in fmu_tangent. Parameters and inputs follow from the core's list of
 * fields. */
#ifndef LACONIC_FMU_VEHICLE_VARIABLE_LOCATIONS_H
#define LACONIC_FMU_VEHICLE_VARIABLE_LOCATIONS_H

#include "location_macros.h"
#include "model.h"

#define IN_VEHICLE(member) FMU_PLAIN(vehicle.member)
#define IN_PAYLOAD(member) FMU_PLAIN(vehicle.payload.member)
#define IN_COUNT(member) FMU_PLAIN(vehicle.member##_count)
#define IN_WHEEL(member) FMU_AT(vehicle.wheel[0].member), sizeof(laconic_wheel), 0, FMU_NO_TANGENT
#define IN_OWN(member) IN_WHEEL(own_##member)
#define IN_GROUND(member) FMU_PLAIN(vehicle.ground.member)
#define IN_DRIVE(member) FMU_PLAIN(vehicle.drive.member)
#define IN_SUPPORT(member) FMU_AT(vehicle.support[0].member), sizeof(laconic_support), 0, FMU_NO_TANGENT
#define IN_START_ARRAY(member) FMU_AT(start.member), sizeof(double), 0, START_ALONG_##member
#define START_ALONG_nu_rad_per_s FMU_ALONG(nu)
#define START_ALONG_wheel_speed_rad_per_s FMU_NO_TANGENT
#define IN_START(member) FMU_AT(start.member), sizeof(double), 0, FMU_ALONG(member)
#define IN_RUN(member) FMU_PLAIN(member)
#define IN_INPUT_ARRAY(member) FMU_MOVING(input.member, 0)
#define IN_INPUT(member) FMU_MOVING(input.member, 0)
#define IN_IMU(member) FMU_PLAIN(sensor_settings.imu.member)
#define IN_IMU_ARRAY(member) FMU_AT(sensor_settings.imu.member), sizeof(double), 0, FMU_NO_TANGENT
#define IN_ENCODER(member) FMU_PLAIN(sensor_settings.encoder_##member)
#define IN_WHEEL_ENCODER(member) \
    FMU_AT(sensor_settings.encoder[0].member), sizeof(laconic_encoder_settings), 0, FMU_NO_TANGENT
#define FIELD(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) FMU_LOCATION(name, IN_##of(member))
#define OUTPUT(name, member, group) FMU_LOCATION(name, FMU_MOVING(member, group))
#define FMU_FRICTION(member, group) FMU_AT(member), sizeof(double), group, FMU_NO_TANGENT
#define OF_FRICTION(name) FMU_LOCATION(name, FMU_FRICTION(friction.name, FMU_GROUP_FRICTION))

#define OF_ESTIMATE(which, member) \
    OUTPUT(estimated_error_##which##nu_rad_per_s, estimated.member.nu_rad_per_s, FMU_GROUP_ESTIMATE) \
    OUTPUT(estimated_error_##which##place_m, estimated.member.place_m, FMU_GROUP_ESTIMATE) \
    OUTPUT(estimated_error_##which##heading_rad, estimated.member.heading_rad, FMU_GROUP_ESTIMATE) \
    OUTPUT(estimated_error_##which##wheel_angle_rad, estimated.member.wheel_angle_rad, FMU_GROUP_ESTIMATE)

/* clang-format off */
enum fmu_locations {
    FMU_LOCATION(time, FMU_PLAIN(time_s))
    LACONIC_PARAMETER_FIELDS(FIELD)
    LACONIC_INPUT_ARRAY_FIELDS(FIELD, INPUT_ARRAY)
    LACONIC_INPUT_FIELDS(FIELD, INPUT)

    OUTPUT(nu_rad_per_s, nu, FMU_GROUP_MOTION)
    OUTPUT(x_m, x_m, FMU_GROUP_MOTION)
    OUTPUT(y_m, y_m, FMU_GROUP_MOTION)
    OUTPUT(heading_rad, heading_rad, FMU_GROUP_MOTION)
    OUTPUT(wheel_angle_rad, wheel_angle_rad, FMU_GROUP_ANGLES)
    OUTPUT(heading_wrapped_rad, pose.heading_wrapped_rad, FMU_GROUP_POSE)
    OUTPUT(origin_x_m, pose.origin_x_m, FMU_GROUP_POSE)
    OUTPUT(origin_y_m, pose.origin_y_m, FMU_GROUP_POSE)
    OUTPUT(velocity_body_m_per_s, velocity_m_per_s, FMU_GROUP_VELOCITY)
    OUTPUT(yaw_rate_rad_per_s, yaw_rate_rad_per_s, FMU_GROUP_VELOCITY)
    OUTPUT(wheel_speed_rad_per_s, wheel_speed_rad_per_s, FMU_GROUP_SPEEDS)
    OUTPUT(wheel_torque_Nm, wheel_torque_Nm, FMU_GROUP_TORQUES)
    OUTPUT(wheel_reaction_N, ground.along_N, FMU_GROUP_GROUND)
    OUTPUT(wheel_lateral_N, ground.lateral_N, FMU_GROUP_GROUND)
    OUTPUT(no_slip_margin_N, ground.no_slip_margin_N, FMU_GROUP_GROUND)
    OUTPUT(energy_J, energy_J, FMU_GROUP_ENERGY)
    OUTPUT(der_nu_rad_per_s, rates.nu_rad_per_s2, FMU_GROUP_RATES)
    OUTPUT(der_x_m, rates.x_m_per_s, FMU_GROUP_RATES)
    OUTPUT(der_y_m, rates.y_m_per_s, FMU_GROUP_RATES)
    OUTPUT(der_heading_rad, rates.yaw_rate_rad_per_s, FMU_GROUP_RATES)
    OUTPUT(der_wheel_angle_rad, rates.wheel_speed_rad_per_s, FMU_GROUP_RATES)

    FMU_LOCATION(der_wheel_speed_rad_per_s, FMU_FRICTION(wheel_rate_rad_per_s2, FMU_GROUP_RATES))
    OF_FRICTION(slip_along_m_per_s)
    OF_FRICTION(slip_across_m_per_s)
    OF_FRICTION(contact_state)
    OF_FRICTION(drive_limit)
    OF_FRICTION(motor_current_A)
    OF_FRICTION(supply_current_A)
    OF_FRICTION(supply_voltage_V)
    OF_FRICTION(supply_energy_J)
    OF_FRICTION(outer_work_J)
    OF_FRICTION(slip_loss_J)
    OF_FRICTION(axle_loss_J)
    OF_FRICTION(motor_loss_J)
    OF_FRICTION(supply_loss_J)
    OF_FRICTION(numerical_loss_J)

    OUTPUT(acceleration_body_m_per_s2, sensed.acceleration_body_m_per_s2, FMU_GROUP_ACCELERATION)
    OUTPUT(imu_acceleration_m_per_s2, sensed.imu_acceleration_m_per_s2, FMU_GROUP_SENSORS)
    OUTPUT(imu_yaw_rate_rad_per_s, sensed.imu_yaw_rate_rad_per_s, FMU_GROUP_SENSORS)
    OUTPUT(encoder_count, sensed.encoder_count, FMU_GROUP_SENSORS)
    FMU_LOCATION(has_imu, FMU_PLAIN(has_imu))
    LACONIC_SENSOR_FIELDS(FIELD)

    OUTPUT(wheel_load_N, ground.normal_N, FMU_GROUP_GROUND)
    OUTPUT(support_load_N, support_load_N, FMU_GROUP_GROUND)

#if FMU_MODEL_ESTIMATES
    FMU_LOCATION(estimate_error, FMU_PLAIN(estimate_error))
    FMU_LOCATION(estimate_window_steps, FMU_PLAIN(estimate_window_steps))
    OF_ESTIMATE(, now)
    OF_ESTIMATE(largest_, largest)
    OF_ESTIMATE(rounding_, rounding)
    OUTPUT(estimated_error_unknown_windows, estimated_unknown, FMU_GROUP_ESTIMATE)
#endif
};
/* clang-format on */

#endif
