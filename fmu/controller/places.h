/* Where each variable of the controller lives (see place.h). */
#ifndef LACONIC_FMU_CONTROLLER_PLACES_H
#define LACONIC_FMU_CONTROLLER_PLACES_H

#include "place.h"
#include "plant.h"

/* clang-format off */
enum fmu_places {
    FMU_PLACE(time, FMU_PLAIN(time_s))
    FMU_PLACE(wheel_count, FMU_PLAIN(wheel_count))
    FMU_PLACE(proportional_gain_Vs_per_rad, FMU_PLAIN(proportional_Vs_per_rad))
    FMU_PLACE(integral_gain_V_per_rad, FMU_PLAIN(integral_V_per_rad))
    FMU_PLACE(voltage_limit_V, FMU_PLAIN(limit_V))
    FMU_PLACE(setpoint_rad_per_s, FMU_MOVING(setpoint_rad_per_s, 0))
    FMU_PLACE(wheel_speed_rad_per_s, FMU_MOVING(speed_rad_per_s, 0))
    FMU_PLACE(angle_error_rad, FMU_MOVING(error_rad, FMU_GROUP_STATE_READ))
    FMU_PLACE(voltage_V, FMU_MOVING(voltage_V, FMU_GROUP_VOLTAGE))
    FMU_PLACE(der_angle_error_rad, FMU_MOVING(error_rate_rad_per_s, FMU_GROUP_RATES))
};
/* clang-format on */

#endif
