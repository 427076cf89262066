/* The location of each variable of the bus (see location_macros.h). */
#ifndef LACONIC_FMU_NETWORK_BUS_VARIABLE_LOCATIONS_H
#define LACONIC_FMU_NETWORK_BUS_VARIABLE_LOCATIONS_H

#include "location_macros.h"
#include "model.h"

#define FMU_COUNTED(member) FMU_AT(member), sizeof(int32_t), FMU_GROUP_COUNTS, FMU_NO_TANGENT

/* clang-format off */
enum fmu_locations {
    FMU_LOCATION(time, FMU_PLAIN(time_s))
    FMU_LOCATION(bit_rate_bit_per_s, FMU_PLAIN(bit_rate_bit_per_s))
    FMU_LOCATION(error_every, FMU_PLAIN(error_every))
    FMU_LOCATION(Node1_Rx_Clock, FMU_PLAIN(port[0].rx_clock))
    FMU_LOCATION(Node1_Rx_Data, FMU_PLAIN(port[0].rx.size))
    FMU_LOCATION(Node1_Tx_Clock, FMU_PLAIN(port[0].tx_clock))
    FMU_LOCATION(Node1_Tx_Data, FMU_PLAIN(port[0].tx.size))
    FMU_LOCATION(Node1_BusNotifications, FMU_PLAIN(notifies))
    FMU_LOCATION(Node2_Rx_Clock, FMU_PLAIN(port[1].rx_clock))
    FMU_LOCATION(Node2_Rx_Data, FMU_PLAIN(port[1].rx.size))
    FMU_LOCATION(Node2_Tx_Clock, FMU_PLAIN(port[1].tx_clock))
    FMU_LOCATION(Node2_Tx_Data, FMU_PLAIN(port[1].tx.size))
    FMU_LOCATION(Node2_BusNotifications, FMU_PLAIN(notifies))
    FMU_LOCATION(frames_carried, FMU_COUNTED(carried))
    FMU_LOCATION(lost_arbitrations, FMU_COUNTED(contended))
    FMU_LOCATION(frames_failed, FMU_COUNTED(failed))
    FMU_LOCATION(frames_dropped, FMU_COUNTED(dropped))
    FMU_LOCATION(busy_s, FMU_AT(busy_s), sizeof(double), FMU_GROUP_COUNTS, FMU_NO_TANGENT)
};
/* clang-format on */

#endif
