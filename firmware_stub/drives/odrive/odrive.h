/* An ODrive's axis behind CANSimple, as firmware 0.6.10 of the ODrive Pro, S1 and Micro speaks it.
 *
 * Identifiers, payloads and numbers of states and errors: the DBC that ODrive Robotics publishes for 0.6.10, and "CAN
 * Protocol" in their manual (docs.odriverobotics.com/v/latest/manual/can-protocol.html). That firmware is not public.
 * Where the manual leaves open what a drive does, the source of 0.5.6 decides
 * (github.com/odriverobotics/ODrive, Firmware/MotorControl and Firmware/communication/can). */
#ifndef LACONIC_DRIVES_ODRIVE_H
#define LACONIC_DRIVES_ODRIVE_H

#include "../place.h"
#include "laconic_drives/protocol.h"

/* 11-bit identifier = node id << 5 | command. */
#define ODRIVE_COMMAND_BITS 5
#define ODRIVE_EVERY_NODE 0x3F /* Address speaks to it; a node cannot have it */
#define ODRIVE_PI ((laconic_real)3.14159265358979323846)

typedef enum odrive_command {
    ODRIVE_GET_VERSION = 0x00,
    ODRIVE_HEARTBEAT = 0x01,
    ODRIVE_ESTOP = 0x02,
    ODRIVE_GET_ERROR = 0x03,
    ODRIVE_RX_SDO = 0x04,
    ODRIVE_TX_SDO = 0x05,
    ODRIVE_ADDRESS = 0x06,
    ODRIVE_SET_AXIS_STATE = 0x07,
    ODRIVE_GET_ENCODER_ESTIMATES = 0x09,
    ODRIVE_SET_CONTROLLER_MODE = 0x0B,
    ODRIVE_SET_INPUT_POS = 0x0C,
    ODRIVE_SET_INPUT_VEL = 0x0D,
    ODRIVE_SET_INPUT_TORQUE = 0x0E,
    ODRIVE_SET_LIMITS = 0x0F,
    ODRIVE_SET_TRAJ_VEL_LIMIT = 0x11,
    ODRIVE_SET_TRAJ_ACCEL_LIMITS = 0x12,
    ODRIVE_SET_TRAJ_INERTIA = 0x13,
    ODRIVE_GET_IQ = 0x14,
    ODRIVE_GET_TEMPERATURE = 0x15,
    ODRIVE_REBOOT = 0x16,
    ODRIVE_GET_BUS_VOLTAGE_CURRENT = 0x17,
    ODRIVE_CLEAR_ERRORS = 0x18,
    ODRIVE_SET_ABSOLUTE_POSITION = 0x19,
    ODRIVE_SET_POS_GAIN = 0x1A,
    ODRIVE_SET_VEL_GAINS = 0x1B,
    ODRIVE_GET_TORQUES = 0x1C,
    ODRIVE_GET_POWERS = 0x1D,
    ODRIVE_ENTER_DFU_MODE = 0x1F,
    ODRIVE_COMMANDS = 0x20
} odrive_command;

typedef enum odrive_state {
    ODRIVE_UNDEFINED = 0,
    ODRIVE_IDLE = 1,
    ODRIVE_STARTUP_SEQUENCE = 2,
    ODRIVE_CLOSED_LOOP_CONTROL = 8,
    ODRIVE_HOMING = 11
} odrive_state;

typedef enum odrive_result {
    ODRIVE_SUCCESS = 0,
    ODRIVE_BUSY = 1,
    ODRIVE_CANCELLED = 2,
    ODRIVE_DISARMED = 3,
    ODRIVE_HOMING_WITHOUT_ENDSTOP = 12,
    ODRIVE_INVALID_STATE = 13
} odrive_result;

#define ODRIVE_MISSING_ESTIMATE 0x8U
#define ODRIVE_BAD_CONFIG 0x10U
#define ODRIVE_DC_BUS_UNDER_VOLTAGE 0x200U
#define ODRIVE_INVERTER_OVER_TEMP 0x4000U
#define ODRIVE_VELOCITY_LIMIT_VIOLATION 0x8000U
#define ODRIVE_POSITION_LIMIT_VIOLATION 0x10000U
#define ODRIVE_WATCHDOG_TIMER_EXPIRED 0x1000000U
#define ODRIVE_ESTOP_REQUESTED 0x2000000U
#define ODRIVE_SPINOUT_DETECTED 0x4000000U

typedef enum odrive_control_mode { ODRIVE_TORQUE = 1, ODRIVE_VELOCITY = 2, ODRIVE_POSITION = 3 } odrive_control_mode;

typedef enum odrive_input_mode {
    ODRIVE_INACTIVE = 0,
    ODRIVE_PASSTHROUGH = 1,
    ODRIVE_VEL_RAMP = 2,
    ODRIVE_POS_FILTER = 3,
    ODRIVE_TRAP_TRAJ = 5,
    ODRIVE_TORQUE_RAMP = 6
} odrive_input_mode;

/* Speeds are in turns of the shaft a second, torques in N·m at the shaft. */
typedef struct odrive_axis {
    laconic_drive_settings saved; /* what a reboot brings back */
    laconic_real most_current_A;  /* of the scene: no message makes it more */
    drive_place zero;             /* place whose position on the bus is 0 */
    drive_place input_place, place;
    laconic_real input_speed, speed;
    laconic_real input_torque, torque;
    laconic_real speed_limit;                                            /* not finite: none */
    laconic_real travel_speed, travel_acceleration, travel_deceleration; /* of TRAP_TRAJ */
    laconic_real inertia;                                                /* torque for 1 turn/s² */
    uint32_t pending;                                                    /* bit c: message c waits to be sent */
    uint32_t errors, disarm_reason;
    uint32_t fed_us, state_us, heartbeat_us, encoder_us;
    uint32_t control_mode, input_mode; /* as they were sent */
    uint8_t node_id, state, result;
    bool travelling;
} odrive_axis;

static inline odrive_axis *odrive_axis_of(laconic_drives *drives, int32_t i) { return (odrive_axis *)drives->axes + i; }

/* odrive.c */
void odrive_restart(laconic_drives *drives, int32_t i, uint32_t now_us);

/* odrive_commands.c: what a message from the bus does. */
void odrive_take(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us);

/* odrive_state.c: states and errors of the axis. */
void odrive_request(laconic_drives *drives, int32_t i, uint32_t state, uint32_t now_us);
void odrive_set_mode(odrive_axis *axis, const laconic_wheel_drive *drive, uint32_t control_mode, uint32_t input_mode);
void odrive_disarm(odrive_axis *axis, laconic_wheel_drive *drive, uint32_t error);
void odrive_clear_errors(odrive_axis *axis, laconic_wheel_drive *drive);
void odrive_supervise(laconic_drives *drives, int32_t i, uint32_t now_us);

/* odrive_control.c: from inputs to the drive's target, once a step in closed loop. */
drive_place odrive_place(const odrive_axis *axis, const laconic_wheel_drive *drive); /* as the bus sees it */
void odrive_follow(odrive_axis *axis, laconic_wheel_drive *drive, laconic_real step_s);

/* odrive_messages.c: the messages that a drive sends, made from the newest values. */
bool odrive_sends(uint32_t command);
void odrive_message(const laconic_drives *drives, int32_t i, odrive_command command, laconic_frame *frame);
/* Of 48 bits: the high 16 are the same for all. */
#define ODRIVE_SERIAL_NUMBER_HIGH 0x4C61U
static inline uint32_t odrive_serial_number(int32_t i) { return 0x636F0000U + (uint32_t)i; }

#endif
