/* Where each variable of modelDescription.xml lives in fmu_plant, what must be fresh before it is read, and where its
 * direction lives in fmu_tangent. The generated table asks for FMU_PLACE_<name>; a name without a place does not
 * compile. Columns: offset, stride, group, tangent offset. */
#ifndef LACONIC_FMU_VEHICLE_PLACES_H
#define LACONIC_FMU_VEHICLE_PLACES_H

#include "plant.h"

#define AT(member) (uint32_t)offsetof(fmu_plant, member)
#define TANGENT(member) (uint32_t)offsetof(fmu_tangent, member)
#define NO_TANGENT UINT32_MAX
#define PLAIN(member) AT(member), sizeof(double), 0, NO_TANGENT
#define OF_WHEELS(member) AT(vehicle.wheel[0].member), sizeof(laconic_wheel), 0, NO_TANGENT
#define START(member, state) AT(start.member), sizeof(double), 0, TANGENT(state)
#define INPUT(member) AT(input.member), sizeof(double), 0, TANGENT(input.member)
#define OUTPUT(member, group) AT(member), sizeof(double), group, TANGENT(member)

#define FMU_PLACE_time PLAIN(time_s)
#define FMU_PLACE_wheel_count AT(vehicle.wheel_count), sizeof(int32_t), 0, NO_TANGENT
#define FMU_PLACE_mass_kg PLAIN(vehicle.mass_kg)
#define FMU_PLACE_yaw_inertia_kgm2 PLAIN(vehicle.yaw_inertia_kgm2)
#define FMU_PLACE_com_x_m PLAIN(vehicle.com_x_m)
#define FMU_PLACE_com_y_m PLAIN(vehicle.com_y_m)
#define FMU_PLACE_com_z_m PLAIN(vehicle.com_z_m)
#define FMU_PLACE_wheel_radius_m PLAIN(vehicle.wheel_radius_m)
#define FMU_PLACE_wheel_inertia_kgm2 PLAIN(vehicle.wheel_inertia_kgm2)
#define FMU_PLACE_motor_gain_Nm_per_V PLAIN(vehicle.motor_gain_Nm_per_V)
#define FMU_PLACE_motor_damping_Nms PLAIN(vehicle.motor_damping_Nms)
#define FMU_PLACE_friction_coefficient PLAIN(vehicle.friction_coefficient)
#define FMU_PLACE_payload_mass_kg PLAIN(vehicle.payload.mass_kg)
#define FMU_PLACE_payload_x_m PLAIN(vehicle.payload.x_m)
#define FMU_PLACE_payload_y_m PLAIN(vehicle.payload.y_m)
#define FMU_PLACE_payload_yaw_inertia_kgm2 PLAIN(vehicle.payload.yaw_inertia_kgm2)

#define FMU_PLACE_wheel_kind OF_WHEELS(kind)
#define FMU_PLACE_wheel_x_m OF_WHEELS(x_m)
#define FMU_PLACE_wheel_y_m OF_WHEELS(y_m)
#define FMU_PLACE_axle_rad OF_WHEELS(axle_rad)
#define FMU_PLACE_roller_rad OF_WHEELS(roller_rad)
#define FMU_PLACE_wheel_locked OF_WHEELS(locked)
#define FMU_PLACE_support_count AT(vehicle.support_count), sizeof(int32_t), 0, NO_TANGENT
#define FMU_PLACE_support_x_m AT(vehicle.support[0].x_m), sizeof(laconic_support), 0, NO_TANGENT
#define FMU_PLACE_support_y_m AT(vehicle.support[0].y_m), sizeof(laconic_support), 0, NO_TANGENT

#define FMU_PLACE_start_nu_rad_per_s START(nu_rad_per_s, nu)
#define FMU_PLACE_start_x_m START(x_m, x_m)
#define FMU_PLACE_start_y_m START(y_m, y_m)
#define FMU_PLACE_start_heading_rad START(heading_rad, heading_rad)
#define FMU_PLACE_method AT(method), sizeof(int32_t), 0, NO_TANGENT
#define FMU_PLACE_step_s PLAIN(step_s)

#define FMU_PLACE_voltage_V INPUT(voltage_V)
#define FMU_PLACE_axle_torque_Nm INPUT(axle_torque_Nm)
#define FMU_PLACE_body_force_N INPUT(body_force_N)
#define FMU_PLACE_body_moment_Nm INPUT(body_moment_Nm)
#define FMU_PLACE_world_force_N INPUT(world_force_N)
#define FMU_PLACE_world_force_point_m INPUT(world_force_point_m)

#define FMU_PLACE_nu_rad_per_s OUTPUT(nu, FMU_GROUP_MOTION)
#define FMU_PLACE_x_m OUTPUT(x_m, FMU_GROUP_MOTION)
#define FMU_PLACE_y_m OUTPUT(y_m, FMU_GROUP_MOTION)
#define FMU_PLACE_heading_rad OUTPUT(heading_rad, FMU_GROUP_MOTION)
#define FMU_PLACE_wheel_angle_rad OUTPUT(wheel_angle_rad, FMU_GROUP_ANGLES)
#define FMU_PLACE_heading_wrapped_rad OUTPUT(pose.heading_wrapped_rad, FMU_GROUP_POSE)
#define FMU_PLACE_origin_x_m OUTPUT(pose.origin_x_m, FMU_GROUP_POSE)
#define FMU_PLACE_origin_y_m OUTPUT(pose.origin_y_m, FMU_GROUP_POSE)
#define FMU_PLACE_velocity_body_m_per_s OUTPUT(velocity_m_per_s, FMU_GROUP_VELOCITY)
#define FMU_PLACE_yaw_rate_rad_per_s OUTPUT(yaw_rate_rad_per_s, FMU_GROUP_VELOCITY)
#define FMU_PLACE_wheel_speed_rad_per_s OUTPUT(wheel_speed_rad_per_s, FMU_GROUP_SPEEDS)
#define FMU_PLACE_wheel_torque_Nm OUTPUT(wheel_torque_Nm, FMU_GROUP_TORQUES)
#define FMU_PLACE_wheel_reaction_N OUTPUT(ground.along_N, FMU_GROUP_GROUND)
#define FMU_PLACE_wheel_lateral_N OUTPUT(ground.lateral_N, FMU_GROUP_GROUND)
#define FMU_PLACE_no_slip_margin_N OUTPUT(ground.no_slip_margin_N, FMU_GROUP_GROUND)
#define FMU_PLACE_energy_J OUTPUT(energy_J, FMU_GROUP_ENERGY)
#define FMU_PLACE_der_nu_rad_per_s OUTPUT(rates.nu_rad_per_s2, FMU_GROUP_RATES)
#define FMU_PLACE_der_x_m OUTPUT(rates.x_m_per_s, FMU_GROUP_RATES)
#define FMU_PLACE_der_y_m OUTPUT(rates.y_m_per_s, FMU_GROUP_RATES)
#define FMU_PLACE_der_heading_rad OUTPUT(rates.yaw_rate_rad_per_s, FMU_GROUP_RATES)
#define FMU_PLACE_der_wheel_angle_rad OUTPUT(rates.wheel_speed_rad_per_s, FMU_GROUP_RATES)

#endif
