/* Helpers and functions that the node's files share. */
#ifndef LACONIC_NODE_INTERNAL_H
#define LACONIC_NODE_INTERNAL_H

#include "laconic_node/node.h"
#include "laconic_node/protection.h"
#include "laconic_wire.h"

#define BIT_OF(offset) ((uint32_t)1 << (offset))

/* Numbers in a frame, little-endian. */
static inline uint16_t word16(const uint8_t *data) { return (uint16_t)(data[0] | data[1] << 8); }

static inline uint32_t word32(const uint8_t *data) { return word16(data) | (uint32_t)word16(data + 2) << 16; }

static inline void put16(uint8_t *to, uint32_t value) {
    to[0] = (uint8_t)(value & 255U);
    to[1] = (uint8_t)(value >> 8 & 255U);
}

static inline void put32(uint8_t *to, uint32_t value) {
    put16(to, value);
    put16(to + 2, value >> 16);
}

static inline void count(uint16_t *counter) { *counter = (uint16_t)(*counter + (*counter < UINT16_MAX)); }

static inline bool plays_drives(const laconic_node *node) {
    return LACONIC_NODE_WITH_DRIVES && node->state == LACONIC_WIRE_STATE_DRIVES;
}

static inline bool is_running(const laconic_node *node) {
    if (LACONIC_NODE_DRIVES_ONLY) return plays_drives(node);
    return node->state == LACONIC_WIRE_STATE_LOCKSTEP || node->state == LACONIC_WIRE_STATE_FREE_RUN ||
           node->state == LACONIC_WIRE_STATE_TIMEOUT || plays_drives(node);
}

/* Whether there is a vehicle whose model may be read. A wrong one may have counts beyond its arrays. */
static inline bool has_model(const laconic_node *node) {
    return node->state != LACONIC_WIRE_STATE_EMPTY && !node->model_is_wrong;
}

static inline bool may_start(const laconic_node *node) {
    return node->state == LACONIC_WIRE_STATE_READY && !node->model_is_wrong;
}

/* Bits of SELECT that ask for sensors, and those that this build leaves out: of `send`, and of the raw output. */
#define SENDS_OF_SENSORS (LACONIC_NODE_SEND_WHEEL_ANGLE | LACONIC_NODE_SEND_IMU | LACONIC_NODE_SEND_ENCODER)
#define RAW_OF_SENSORS (LACONIC_RAW_IMU | LACONIC_RAW_ENCODER)
#define SENDS_LEFT_OUT \
    ((LACONIC_NODE_WITH_SENSORS ? 0U : SENDS_OF_SENSORS) | (LACONIC_WITH_POSE ? 0U : LACONIC_NODE_SEND_POSE) | \
     (LACONIC_WITH_WHEEL_ANGLES ? 0U : LACONIC_NODE_SEND_WHEEL_ANGLE))
#define RAW_LEFT_OUT \
    ((LACONIC_NODE_WITH_SENSORS ? 0U : RAW_OF_SENSORS) | (LACONIC_NODE_WITH_DRIVES ? 0U : LACONIC_RAW_HELD_TORQUE) | \
     (LACONIC_NODE_DRIVES_ONLY ? LACONIC_RAW_NU | LACONIC_RAW_ENERGY : 0U) | \
     (LACONIC_WITH_POSE ? 0U : LACONIC_RAW_POSE) | (LACONIC_WITH_WHEEL_ANGLES ? 0U : LACONIC_RAW_WHEEL_ANGLE))

#define SELECTS_ESTIMATE 0x20U /* of the byte with the take_ bits */

#if LACONIC_NODE_WITH_HINGES
/* Frames and numbers that vehicles with hinges do not have. */
#define SENDS_NOT_OF_HINGES \
    (LACONIC_NODE_SEND_NU | LACONIC_NODE_SEND_STATE_FD | LACONIC_NODE_SEND_IMU | LACONIC_NODE_SEND_ENCODER)
#define RAW_NOT_OF_HINGES (LACONIC_RAW_NU | RAW_OF_SENSORS)
#define PENDING_OF_HINGES \
    (BIT_OF(LACONIC_WIRE_VELOCITY) | BIT_OF(LACONIC_WIRE_HINGE_ANGLE) | BIT_OF(LACONIC_WIRE_HINGE_RATE))
#define PENDING_NOT_OF_HINGES \
    (BIT_OF(LACONIC_WIRE_NU) | BIT_OF(LACONIC_WIRE_STATE_FD) | BIT_OF(LACONIC_WIRE_IMU) | \
     BIT_OF(LACONIC_WIRE_ENCODER) | BIT_OF(LACONIC_WIRE_ERROR_ESTIMATE))
#endif

/* Inputs that this build's core does not read, so that a rig does not believe that they act. */
#define TAKES_LEFT_OUT \
    ((LACONIC_WITH_VOLTAGE ? 0U : LACONIC_RAW_VOLTAGE) | (LACONIC_WITH_AXLE_TORQUE ? 0U : LACONIC_RAW_AXLE_TORQUE) | \
     (LACONIC_WITH_BODY_WRENCH ? 0U : LACONIC_RAW_BODY_WRENCH) | \
     (LACONIC_WITH_WORLD_FORCE ? 0U : LACONIC_RAW_WORLD_FORCE) | \
     (LACONIC_WITH_SAMPLED_INPUT ? 0U : LACONIC_RAW_SAMPLED))

/* Whether frames of CAN FD may be sent. */
static inline bool speaks_fd(const laconic_node *node) { return LACONIC_NODE_CAN_FD && node->config.can_fd; }

static inline bool estimates(const laconic_node *node) {
#if LACONIC_NODE_WITH_ESTIMATE
    return node->estimates;
#else
    (void)node;
    return false;
#endif
}

static inline bool has_hinges(const laconic_node *node) {
#if LACONIC_NODE_WITH_HINGES
    return node->hinges.here;
#else
    (void)node;
    return false;
#endif
}

/* Whether the vehicle has hinges, on ground with friction. */
static inline bool slips(const laconic_node *node) {
#if LACONIC_NODE_WITH_SLIP
    return node->hinges.here && node->hinges.slips;
#else
    (void)node;
    return false;
#endif
}

static inline bool listens_to_voltages(const laconic_node *node) {
    if (LACONIC_NODE_DRIVES_ONLY) return false;
    return node->state == LACONIC_WIRE_STATE_LOCKSTEP || node->state == LACONIC_WIRE_STATE_FREE_RUN;
}

/* node_session.c: the handshake, and whether a frame is executed. */
void laconic_node_hello(laconic_node *node, const uint8_t *data, uint32_t now_us);
void laconic_node_open(laconic_node *node, const uint8_t *data, uint32_t now_us);
bool laconic_node_takes_command(laconic_node *node, uint8_t offset, const uint8_t *data);
bool laconic_node_takes_motion(laconic_node *node, uint8_t offset, const uint8_t *data);
/* Motion frames are keyed by the last accepted START from now on. */
void laconic_node_begin_run(laconic_node *node);

/* node_control.c: CONTROL, PARAMETER, COMMIT and SELECT. Each gives its answer but for the request. */
laconic_node_result laconic_node_control(laconic_node *node, const uint8_t *data, uint32_t now_us);
laconic_node_result laconic_node_parameter(laconic_node *node, const uint8_t *data);
laconic_node_result laconic_node_commit(laconic_node *node, const uint8_t *data);
laconic_node_result laconic_node_select(laconic_node *node, const uint8_t *data);
/* For a new session: stops the run and clears the loader, the selection and the frames to be sent. */
void laconic_node_make_idle(laconic_node *node);
/* The RESULT to a frame of this offset, whose request is set already. */
void laconic_node_answer(laconic_node *node, uint8_t offset, laconic_node_result answer);
void laconic_node_answer_again(laconic_node *node, uint8_t offset);

/* node_motion.c: frames that move the vehicle. False iff the frame was refused. */
bool laconic_node_voltage(laconic_node *node, const uint8_t *data, uint32_t now_us);
bool laconic_node_voltage_fd(laconic_node *node, const uint8_t *data, uint32_t now_us);
bool laconic_node_raw(laconic_node *node, const uint8_t *bytes, uint8_t segment, uint8_t mask, uint8_t size);
/* `input_frames`: how many RAW_INPUT frames the rig has sent for it. */
void laconic_node_sync(laconic_node *node, uint32_t steps, uint16_t input_frames, uint8_t request);

#if LACONIC_NODE_WITH_HINGES
bool laconic_node_steering(laconic_node *node, const uint8_t *data);
#endif

/* node_run.c */
void laconic_node_run_lockstep(laconic_node *node);
void laconic_node_run_free(laconic_node *node, uint32_t now_us);
/* Periods of `steps_per_period` steps, the first of them one period from now. */
void laconic_node_begin_periods(laconic_node *node, uint32_t rate_Hz, uint32_t steps_per_period, uint32_t now_us);
/* True iff a period begins at this time or began before it; counts its lateness. */
bool laconic_node_period_is_due(laconic_node *node, uint32_t now_us);
void laconic_node_end_period(laconic_node *node);
/* A step that the core refuses ends the run; the state stays as it was before that step. */
void laconic_node_fail(laconic_node *node, const laconic_refusal *why, uint8_t request);
void laconic_node_clear_inputs(laconic_node *node);
void laconic_node_publish(laconic_node *node);

/* node_drives.c: motor drives between the bus and the wheels. Statuses as RESULT has them. */
#if LACONIC_NODE_WITH_DRIVES
uint8_t laconic_node_check_drives(const laconic_node *node, const laconic_drive_plan *plan, int32_t wheel_count,
                                  uint8_t *field, uint8_t *item);
uint8_t laconic_node_start_drives(laconic_node *node, uint32_t now_us, uint8_t *field);
void laconic_node_run_drives(laconic_node *node, uint32_t now_us);
/* PARAMETER with DRIVE_FAULTS: the faults by order of one wheel's drive. */
uint8_t laconic_node_order_drive(laconic_node *node, const uint8_t *data);
#endif

/* node_sensors.c: IMU and encoders beside the plant. */
#if LACONIC_NODE_WITH_SENSORS
/* Whether any of these settings has been sent. */
bool laconic_node_sensors_are_set(const laconic_sensor_settings *settings);
/* Whether sensors must see the next steps. */
bool laconic_node_watches(const laconic_node *node);
/* As after power-up, beside the plant, with these settings. */
void laconic_node_start_sensors(laconic_node *node, const laconic_sensor_settings *settings);
/* Makes their chosen frames due, and reads what RAW_OUTPUT is to show of them. */
void laconic_node_publish_sensors(laconic_node *node, laconic_sensor_outputs *sensed);
/* The next wheel from `wheel` on that has an encoder; LACONIC_MAX_WHEELS: there is none. */
uint8_t laconic_node_encoder_from(const laconic_node *node, int32_t wheel);
#endif

#if LACONIC_NODE_WITH_ESTIMATE
/* node_estimate.c: the error estimate beside the plant; a refusal ends it. */
laconic_status laconic_node_start_estimate(laconic_node *node, laconic_refusal *why);
/* `begin` before steps that the caller takes: how many to take at most; `end` after they were taken. */
uint64_t laconic_node_begin_watched(laconic_node *node, int32_t samples, uint64_t steps);
void laconic_node_end_watched(laconic_node *node, uint64_t steps);
/* The same after one step with the input held, from the state before it: drives know their torques in it alone. */
void laconic_node_watch_taken(laconic_node *node, const laconic_state *before);
void laconic_node_publish_estimate(laconic_node *node);
#endif

/* node_hinges.c: vehicles with hinges. */
#if LACONIC_NODE_WITH_HINGES
/* The loaded vehicle with hinges, or nothing changes; a vehicle without. */
uint8_t laconic_node_adopt_hinges(laconic_node *node, uint8_t *field, uint8_t *item);
void laconic_node_drop_hinges(laconic_node *node);
laconic_status laconic_node_restart_hinges(laconic_node *node, laconic_refusal *why);
/* SELECT: whether the present vehicle has all that it chooses; the bits of hinges. */
bool laconic_node_may_select_hinges(const laconic_node *node, const uint8_t *data);
void laconic_node_select_hinges(laconic_node *node, const uint8_t *data);
void laconic_node_deselect_hinges(laconic_node *node);
void laconic_node_publish_hinges(laconic_node *node);
void laconic_node_clear_hinge_inputs(laconic_node *node);
/* Three numbers of STEERING; false iff they are not for this vehicle. */
bool laconic_node_take_steering(laconic_node *node, uint8_t page, const int16_t raw[3]);
laconic_status laconic_node_step_hinges(laconic_node *node, uint64_t steps, laconic_refusal *why);
laconic_status laconic_node_step_hinges_sampled(laconic_node *node, laconic_refusal *why);
void laconic_node_motion_of(laconic_articulated_motion *motion, const laconic_node *node);
/* Reads the chosen outputs. */
void laconic_node_collect_hinges(laconic_raw_output *raw, const laconic_node *node);
/* node_pack.c: of every vehicle. */
void laconic_node_pose_of(laconic_pose *pose, const laconic_node *node);
void laconic_node_wheel_speeds(laconic_real speed_rad_per_s[], const laconic_node *node);
void laconic_node_wheel_angles(laconic_real angle_rad[], const laconic_node *node);
#else
static inline void laconic_node_pose_of(laconic_pose *pose, const laconic_node *node) {
    laconic_pose_of(pose, &node->plant.model, &node->plant.state);
}
static inline void laconic_node_wheel_speeds(laconic_real speed_rad_per_s[], const laconic_node *node) {
    laconic_plant_wheel_speeds(&node->plant, speed_rad_per_s);
}
static inline void laconic_node_wheel_angles(laconic_real angle_rad[], const laconic_node *node) {
    laconic_plant_wheel_angles(&node->plant, angle_rad);
}
#endif

#if LACONIC_NODE_WITH_XCP
/* Errors of XCP; DONE: none. */
enum {
    XCP_SYNCH = 0x00,
    XCP_DAQ_ACTIVE = 0x11,
    XCP_COMMAND_UNKNOWN = 0x20,
    XCP_SYNTAX = 0x21,
    XCP_OUT_OF_RANGE = 0x22,
    XCP_WRITE_PROTECTED = 0x23,
    XCP_ACCESS_DENIED = 0x24,
    XCP_PAGE_NOT_VALID = 0x26,
    XCP_MODE_NOT_VALID = 0x27,
    XCP_SEGMENT_NOT_VALID = 0x28,
    XCP_SEQUENCE = 0x29,
    XCP_DAQ_CONFIG = 0x2A,
    XCP_MEMORY_OVERFLOW = 0x30,
    XCP_NOT_NOW = 0x33,
    XCP_DONE = 0xFF
};

/* node_xcp.c: a master's session and commands. */
void laconic_xcp_on_frame(laconic_node *node, const laconic_frame *frame);
bool laconic_xcp_next_frame(laconic_node *node, laconic_frame *frame);

/* node_xcp_memory.c: the numbers that a master sees, and the pages of its calibration. Each returns an error of XCP;
 * commands are those of the protocol, whose answers begin with their code. */
extern const char laconic_xcp_texts[1U + LACONIC_XCP_EVENTS][LACONIC_XCP_TEXT_BYTES];
/* After COMMIT: both pages are this vehicle. */
void laconic_xcp_adopt(laconic_node *node, const laconic_vehicle *vehicle);
uint8_t laconic_xcp_read(laconic_node *node, uint32_t address, uint8_t *to, uint32_t count);
/* At the master's address, all bytes or none. */
uint8_t laconic_xcp_write(laconic_node *node, const uint8_t *from, uint8_t count);
uint8_t laconic_xcp_set_page(laconic_node *node, const uint8_t *command);
uint8_t laconic_xcp_get_page(laconic_xcp *xcp, const uint8_t *command);
uint8_t laconic_xcp_copy_page(laconic_node *node, const uint8_t *command);

/* Commands of measurement. */
enum {
    LACONIC_DAQ_SET_POINTER = 0xE2,
    LACONIC_DAQ_WRITE = 0xE1,
    LACONIC_DAQ_SET_MODE = 0xE0,
    LACONIC_DAQ_START_LIST = 0xDE,
    LACONIC_DAQ_START_SELECTED = 0xDD,
    LACONIC_DAQ_CLOCK = 0xDC,
    LACONIC_DAQ_PROCESSOR = 0xDA,
    LACONIC_DAQ_RESOLUTION = 0xD9,
    LACONIC_DAQ_EVENT_INFO = 0xD7,
    LACONIC_DAQ_FREE = 0xD6,
    LACONIC_DAQ_ALLOC = 0xD5,
    LACONIC_DAQ_ALLOC_ODT = 0xD4,
    LACONIC_DAQ_ALLOC_ENTRY = 0xD3
};

/* node_daq.c: lists of measurements. A command's answer begins with its code; returns an error of XCP. */
uint8_t laconic_daq_command(laconic_node *node, const uint8_t *command);
void laconic_daq_clear(laconic_xcp *xcp);
bool laconic_daq_runs(const laconic_xcp *xcp);
/* How many of these steps may be taken before the next event; 0: what was measured must be sent first. */
uint32_t laconic_daq_steps(const laconic_node *node, uint32_t steps);
/* After a step: samples what is due. */
void laconic_daq_event(laconic_node *node);
#endif

/* node_pack.c: writes the payload of one frame; its protection follows. */
void laconic_node_pack(laconic_node *node, uint8_t offset, uint8_t *data);

#endif
