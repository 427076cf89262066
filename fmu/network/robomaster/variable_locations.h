/* The location of each variable of the controller (see location_macros.h). */
#ifndef LACONIC_FMU_NETWORK_ROBOMASTER_VARIABLE_LOCATIONS_H
#define LACONIC_FMU_NETWORK_ROBOMASTER_VARIABLE_LOCATIONS_H

#include "location_macros.h"
#include "model.h"

#define FMU_COUNTED(member) FMU_AT(member), sizeof(int32_t), FMU_GROUP_LAST, FMU_NO_TANGENT
#define FMU_SHOWN(member) FMU_AT(member), sizeof(double), FMU_GROUP_LAST, FMU_NO_TANGENT
#define FMU_INPUT_AT(member) FMU_AT(member), sizeof(double), 0, FMU_NO_TANGENT

/* clang-format off */
enum fmu_locations {
    FMU_LOCATION(time, FMU_PLAIN(time_s))
    FMU_LOCATION(org_fmi_standard_fmi_ls_bus_Can_BusNotifications, FMU_PLAIN(can.notified))
    FMU_LOCATION(bit_rate_bit_per_s, FMU_PLAIN(can.bit_rate_bit_per_s))
    FMU_LOCATION(period_s, FMU_PLAIN(period_s))
    FMU_LOCATION(gear_ratio, FMU_PLAIN(gear_ratio))
    FMU_LOCATION(proportional_gain_As_per_rad, FMU_PLAIN(proportional_As_per_rad))
    FMU_LOCATION(integral_gain_A_per_rad, FMU_PLAIN(integral_A_per_rad))
    FMU_LOCATION(current_limit_A, FMU_PLAIN(limit_A))
    FMU_LOCATION(CAN_Rx_Clock, FMU_PLAIN(port[0].rx_clock))
    FMU_LOCATION(CAN_Rx_Data, FMU_PLAIN(port[0].rx.size))
    FMU_LOCATION(CAN_Tx_Clock, FMU_PLAIN(port[0].tx_clock))
    FMU_LOCATION(CAN_Tx_Data, FMU_PLAIN(port[0].tx.size))
    FMU_LOCATION(setpoint_rad_per_s, FMU_INPUT_AT(setpoint_rad_per_s))
    FMU_LOCATION(measured_rad_per_s, FMU_SHOWN(measured_rad_per_s))
    FMU_LOCATION(current_A, FMU_SHOWN(current_A))
    FMU_LOCATION(frames_sent, FMU_COUNTED(can.sent))
    FMU_LOCATION(frames_heard, FMU_COUNTED(can.heard))
};
/* clang-format on */

#endif
