/* The location of each variable of the controller (see location_macros.h). */
#ifndef LACONIC_FMU_CONTROLLER_VARIABLE_LOCATIONS_H
#define LACONIC_FMU_CONTROLLER_VARIABLE_LOCATIONS_H

#include "location_macros.h"
#include "model.h"

/* clang-format off */
enum fmu_locations {
    FMU_LOCATION(time, FMU_PLAIN(time_s))
    FMU_LOCATION(wheel_count, FMU_PLAIN(wheel_count))
    FMU_LOCATION(proportional_gain_Vs_per_rad, FMU_PLAIN(proportional_Vs_per_rad))
    FMU_LOCATION(integral_gain_V_per_rad, FMU_PLAIN(integral_V_per_rad))
    FMU_LOCATION(voltage_limit_V, FMU_PLAIN(limit_V))
    FMU_LOCATION(setpoint_rad_per_s, FMU_MOVING(setpoint_rad_per_s, 0))
    FMU_LOCATION(wheel_speed_rad_per_s, FMU_MOVING(speed_rad_per_s, 0))
    FMU_LOCATION(angle_error_rad, FMU_MOVING(error_rad, FMU_GROUP_STATE_READ))
    FMU_LOCATION(voltage_V, FMU_MOVING(voltage_V, FMU_GROUP_VOLTAGE))
    FMU_LOCATION(der_angle_error_rad, FMU_MOVING(error_rate_rad_per_s, FMU_GROUP_RATES))
};
/* clang-format on */

#endif
