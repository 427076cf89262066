/* The location of each variable of the node (see location_macros.h). */
#ifndef LACONIC_FMU_NETWORK_NODE_VARIABLE_LOCATIONS_H
#define LACONIC_FMU_NETWORK_NODE_VARIABLE_LOCATIONS_H

#include "location_macros.h"
#include "model.h"

#define FMU_SHOWN(member) FMU_AT(member), sizeof(double), FMU_GROUP_VEHICLE, FMU_NO_TANGENT
#define FMU_COUNTED(member) FMU_AT(member), sizeof(int32_t), FMU_GROUP_VEHICLE, FMU_NO_TANGENT
#define FMU_INPUT_AT(member) FMU_AT(member), sizeof(double), 0, FMU_NO_TANGENT

/* clang-format off */
enum fmu_locations {
    FMU_LOCATION(time, FMU_PLAIN(time_s))
    FMU_LOCATION(wheel_count, FMU_PLAIN(wheel_count))
    FMU_LOCATION(id_base, FMU_PLAIN(id_base))
    FMU_LOCATION(org_fmi_standard_fmi_ls_bus_Can_BusNotifications, FMU_PLAIN(can.notified))
    FMU_LOCATION(bit_rate_bit_per_s, FMU_PLAIN(can.bit_rate_bit_per_s))
    FMU_LOCATION(fd_bit_rate_bit_per_s, FMU_PLAIN(can.fd_bit_rate_bit_per_s))
    FMU_LOCATION(discard_on_lost_arbitration, FMU_PLAIN(can.discards))
    FMU_LOCATION(drop_lost_frames, FMU_PLAIN(can.drops_lost))
    FMU_LOCATION(CAN_Rx_Clock, FMU_PLAIN(port[0].rx_clock))
    FMU_LOCATION(CAN_Rx_Data, FMU_PLAIN(port[0].rx.size))
    FMU_LOCATION(CAN_Tx_Clock, FMU_PLAIN(port[0].tx_clock))
    FMU_LOCATION(CAN_Tx_Data, FMU_PLAIN(port[0].tx.size))
    FMU_LOCATION(body_force_N, FMU_INPUT_AT(body_force_N))
    FMU_LOCATION(body_moment_Nm, FMU_INPUT_AT(body_moment_Nm))
    FMU_LOCATION(x_m, FMU_SHOWN(x_m))
    FMU_LOCATION(y_m, FMU_SHOWN(y_m))
    FMU_LOCATION(heading_rad, FMU_SHOWN(heading_rad))
    FMU_LOCATION(velocity_body_m_per_s, FMU_SHOWN(velocity_m_per_s))
    FMU_LOCATION(yaw_rate_rad_per_s, FMU_SHOWN(yaw_rate_rad_per_s))
    FMU_LOCATION(nu_rad_per_s, FMU_SHOWN(nu))
    FMU_LOCATION(wheel_speed_rad_per_s, FMU_SHOWN(wheel_speed_rad_per_s))
    FMU_LOCATION(wheel_angle_rad, FMU_SHOWN(wheel_angle_rad))
    FMU_LOCATION(axle_torque_Nm, FMU_SHOWN(axle_torque_Nm))
    FMU_LOCATION(node_state, FMU_COUNTED(node_state))
    FMU_LOCATION(frames_sent, FMU_COUNTED(can.sent))
    FMU_LOCATION(frames_heard, FMU_COUNTED(can.heard))
    FMU_LOCATION(frames_lost, FMU_COUNTED(can.lost))
    FMU_LOCATION(wrong_operations, FMU_COUNTED(can.wrong))
    FMU_LOCATION(transmit_errors, FMU_COUNTED(can.transmit_errors))
    FMU_LOCATION(receive_errors, FMU_COUNTED(can.receive_errors))
    FMU_LOCATION(bus_status, FMU_COUNTED(can.status))
};
/* clang-format on */

#endif
