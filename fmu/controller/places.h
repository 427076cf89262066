/* Where each variable of the controller lives: offset, stride, group, tangent offset (see vehicle/places.h). */
#ifndef LACONIC_FMU_CONTROLLER_PLACES_H
#define LACONIC_FMU_CONTROLLER_PLACES_H

#include "plant.h"

#define AT(member) (uint32_t)offsetof(fmu_plant, member)
#define TANGENT(member) (uint32_t)offsetof(fmu_tangent, member)
#define PLAIN(member) AT(member), sizeof(double), 0, UINT32_MAX
#define MOVING(member, group) AT(member), sizeof(double), group, TANGENT(member)

#define FMU_PLACE_time PLAIN(time_s)
#define FMU_PLACE_wheel_count AT(wheel_count), sizeof(int32_t), 0, UINT32_MAX
#define FMU_PLACE_proportional_gain_Vs_per_rad PLAIN(proportional_Vs_per_rad)
#define FMU_PLACE_integral_gain_V_per_rad PLAIN(integral_V_per_rad)
#define FMU_PLACE_voltage_limit_V PLAIN(limit_V)
#define FMU_PLACE_setpoint_rad_per_s MOVING(setpoint_rad_per_s, 0)
#define FMU_PLACE_wheel_speed_rad_per_s MOVING(speed_rad_per_s, 0)
#define FMU_PLACE_angle_error_rad MOVING(error_rad, FMU_GROUP_STATE_READ)
#define FMU_PLACE_voltage_V MOVING(voltage_V, FMU_GROUP_VOLTAGE)
#define FMU_PLACE_der_angle_error_rad MOVING(error_rate_rad_per_s, FMU_GROUP_RATES)

#endif
