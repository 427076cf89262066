/* The node as a shared library for tests and the in-process rig: the declarations that Python reads. */
#ifndef LACONIC_NODE_SHARED_LIBRARY_H
#define LACONIC_NODE_SHARED_LIBRARY_H

#include "laconic_node/frame.h"

struct laconic_node;
/* The functions of node.h again, with an incomplete type: cffi needs only the name of the struct. */
void laconic_node_on_frame(struct laconic_node *node, const laconic_frame *frame, uint32_t now_us);
void laconic_node_on_tick(struct laconic_node *node, uint32_t now_us);
bool laconic_node_next_frame(struct laconic_node *node, laconic_frame *frame);
bool laconic_node_is_busy(const struct laconic_node *node);
uint32_t laconic_node_idle_us(const struct laconic_node *node, uint32_t now_us);

#include "canopen/describe.h"
#include "laconic_node/counters.h"
#include "laconic_node/crc.h"
#include "laconic_node/e2e.h"
#include "laconic_node/protection.h"
#include "laconic_node/slcan.h"
#include "laconic_secure/gate.h"
#include "library_drives.h"

/* Bytes of a node, and its start with all methods in memory that the caller provides, aligned to 8 bytes. */
uint32_t laconic_library_node_size(void);
bool laconic_library_node_init(struct laconic_node *node, uint16_t id_base, bool can_fd, uint32_t nonce_seed,
                               uint32_t now_us);

/* The part of the node's state that tests check. */
typedef struct laconic_library_view {
    uint8_t state;
    bool deaf;
    uint64_t steps;
    double voltage_V[3]; /* of the first wheels, as the next step will use them */
    laconic_node_counters counters;
} laconic_library_view;

void laconic_library_inspect(const struct laconic_node *node, laconic_library_view *view);

/* Where the vehicle's centre of mass is, and how fast it moves. */
typedef struct laconic_library_motion {
    double x_m, y_m, heading_rad;
    double velocity_m_per_s[2], yaw_rate_rad_per_s; /* in body axes */
} laconic_library_motion;

void laconic_library_motion_of(const struct laconic_node *node, laconic_library_motion *motion);

/* One drive at the end of the last step. */
typedef struct laconic_library_drive {
    int32_t wheel; /* from 0 */
    int32_t node_id;
    int32_t mode; /* laconic_drive_mode of the target */
    int64_t target_count;
    double target_rest, target_speed_rad_per_s, target_current_A;
    uint32_t faults, limits;
    bool unheard;  /* a watchdog of it has fired since START_DRIVES */
    int64_t count; /* of the encoder */
    double rest, speed_rad_per_s, current_A, integral_A;
    double torque_Nm;                              /* of the motor, at the wheel's axle        */
    double axle_torque_Nm;                         /* which the plant got; on rigid vehicles with a brake's */
    double wheel_speed_rad_per_s, wheel_angle_rad; /* of the plant                             */
} laconic_library_drive;

/* How many drives the node has: 0 before the first START_DRIVES of a vehicle with drives. Drives are in the order of
 * their wheels. */
int32_t laconic_library_drive_count(const struct laconic_node *node);
/* False iff there is no such drive. */
bool laconic_library_drive_view(const struct laconic_node *node, int32_t drive, laconic_library_drive *view);

/* Faults by order, of a drive that exists: bits of laconic_wheel_drive.faults. laconic_drive_fail sets faults that the
 * protocol may clear; _break faults that remain until _mend; a brake holds the wheel by up to this torque, 0: none;
 * _order: as laconic_drive_order. */
void laconic_library_drive_fail(struct laconic_node *node, int32_t drive, uint32_t faults);
void laconic_library_drive_break(struct laconic_node *node, int32_t drive, uint32_t faults);
void laconic_library_drive_mend(struct laconic_node *node, int32_t drive, uint32_t faults);
void laconic_library_drive_brake(struct laconic_node *node, int32_t drive, double torque_Nm);
void laconic_library_drive_order(struct laconic_node *node, int32_t drive, uint32_t orders);

/* Counts of all errors of one, two and three bits in an 8-byte frame of profile 22 by their outcome: 0 found by the
 * CRC, 1 found by the counter, 2 accepted. The receiver has just accepted the frame before. */
typedef struct laconic_error_census {
    uint64_t counter_kept[3]; /* errors outside the counter */
    uint64_t counter_changed[3];
} laconic_error_census;

void laconic_library_census(laconic_error_census *census, const uint8_t frame[8], const uint8_t data_ids[16],
                            uint8_t max_delta);

#endif
