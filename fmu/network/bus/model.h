/* A CAN bus between two nodes as a bus simulation FMU: frames take their time, the lower identifier goes first, and
 * each n-th frame can meet an error. */
#ifndef LACONIC_FMU_NETWORK_BUS_MODEL_H
#define LACONIC_FMU_NETWORK_BUS_MODEL_H

#include "network_port.h"

#define FMU_MODEL_LARGEST_ARRAY 1
#define FMU_MODEL_MOST_STATES 1
#define FMU_MODEL_PORTS 2
#define FMU_MODEL_TAKES_SLOPES false
#define FMU_MODEL_HAS_OPTIONAL_STATES(model) ((void)(model), false)
#define FMU_MODEL_ARRAY_SIZE(model) ((void)(model), 1U)

#define FMU_GROUP_COUNTS 1U /* nothing to compute, but not readable before initialization */
#define FMU_GROUPS_ALL 0U

/* What the bus knows of a node. */
typedef struct bus_node {
    bool discards;
    int32_t status;
    uint32_t bit_rate_bit_per_s, fd_bit_rate_bit_per_s; /* 0: it has not said */
    ls_bus_buffer queue;                                /* transmit operations that wait for the bus */
} bus_node;

typedef struct fmu_model {
    bool start_needed, change_needed, states_changed;
    double time_s;
    uint32_t stale;
    int32_t bit_rate_bit_per_s, error_every; /* where no node says one; each such frame fails, 0: none */
    bool notifies;                           /* always true: a constant of the description */
    network_port port[FMU_MODEL_PORTS];

    bus_node node[FMU_MODEL_PORTS];
    bool is_busy;
    bool rates_differ; /* the log has told it: nothing is carried */
    uint32_t sender;
    laconic_frame frame; /* on the bus */
    bool error_passive;  /* its sender is, as it has said in the frame */
    double free_s;       /* when it ends */
    double busy_s;       /* sum of all frames' times */
    int32_t carried, contended, failed, dropped;
} fmu_model;

#endif
