/* A CAN node that simulates the vehicle (firmware_stub) as an FMU: the same C as on a board, with the FMU's time as its
 * clock and bus operations as its bus. */
#ifndef LACONIC_FMU_NETWORK_NODE_MODEL_H
#define LACONIC_FMU_NETWORK_NODE_MODEL_H

#include "can_controller.h"
#include "laconic_node/node.h"
#include "network_port.h"

#define FMU_MODEL_LARGEST_ARRAY LACONIC_MAX_WHEELS
#define FMU_MODEL_MOST_STATES 1
#define FMU_MODEL_PORTS 1
#define FMU_MODEL_TAKES_SLOPES false
#define FMU_MODEL_HAS_OPTIONAL_STATES(model) ((void)(model), false)
#define FMU_MODEL_ARRAY_SIZE(model) ((uint32_t)(model)->wheel_count)

#define FMU_GROUP_VEHICLE 1U
#define FMU_GROUPS_ALL 1U

/* A frame of a rig that loads the scene, as a start value of its own (resources/start.bin): its place in the node's
 * range of identifiers, and its eight bytes, the first one lowest. */
#define NETWORK_NODE_FRAMES 4096
typedef struct network_node_frame {
    uint8_t offset, data[8];
} network_node_frame;

typedef struct fmu_model {
    bool start_needed, change_needed, states_changed;
    double time_s;
    uint32_t stale;
    int32_t wheel_count, id_base;
    can_controller can;
    double body_force_N[2], body_moment_Nm; /* inputs, besides what a rig sends */
    double start_s;                         /* the node's clock is 0 there */
    uint64_t now_us;                        /* of the node's clock */
    bool is_full;                           /* the log has told that tx is full */
    network_port port[FMU_MODEL_PORTS];
    laconic_node node;

    double x_m, y_m, heading_rad, velocity_m_per_s[2], yaw_rate_rad_per_s, nu[3];
    double wheel_speed_rad_per_s[LACONIC_MAX_WHEELS], wheel_angle_rad[LACONIC_MAX_WHEELS];
    double axle_torque_Nm[LACONIC_MAX_WHEELS];
    int32_t node_state;

    uint64_t taken_bases; /* bit k: the drives use one of the 32 identifiers from 32 k on; of start.bin */
    uint32_t frame_count;
    network_node_frame frame[NETWORK_NODE_FRAMES];
} fmu_model;

#endif
