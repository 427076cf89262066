/* A controller of four wheel speeds that commands RoboMaster C620 motor controllers over CAN, for the demo of network
 * FMUs: one loop per motor,
 *
 *     i = K_p e + K_i I, limited to ±limit;   I' = e, or 0 while i is limited and e would drive it further beyond
 *
 * with e the speed error of the motor by the last feedback 0x201 … 0x204, sent in 0x200 each period. */
#ifndef LACONIC_FMU_NETWORK_ROBOMASTER_MODEL_H
#define LACONIC_FMU_NETWORK_ROBOMASTER_MODEL_H

#include "can_controller.h"
#include "network_port.h"

#define FMU_MODEL_LARGEST_ARRAY 4
#define FMU_MODEL_MOST_STATES 1
#define FMU_MODEL_PORTS 1
#define FMU_MODEL_TAKES_SLOPES false
#define FMU_MODEL_HAS_OPTIONAL_STATES(model) ((void)(model), false)
#define FMU_MODEL_ARRAY_SIZE(model) ((void)(model), 4U)

#define FMU_GROUP_LAST 1U /* nothing to compute, but not readable before initialization */
#define FMU_GROUPS_ALL 0U

#define MOTORS 4

typedef struct fmu_model {
    bool start_needed, change_needed, states_changed;
    double time_s;
    uint32_t stale;
    double period_s, gear_ratio, proportional_As_per_rad, integral_A_per_rad, limit_A;
    double setpoint_rad_per_s[MOTORS];
    can_controller can;
    network_port port[FMU_MODEL_PORTS];

    double measured_rad_per_s[MOTORS], error_rad[MOTORS], current_A[MOTORS];
    double start_s;
    uint64_t periods; /* passed */
    bool is_due;      /* a command waits for the bus */
} fmu_model;

#endif
