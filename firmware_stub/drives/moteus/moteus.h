/* A moteus controller behind its register protocol over CAN FD, register map version 5.
 *
 * Frames and registers: docs/protocol/can.md and docs/protocol/registers.md of github.com/mjbots/moteus. What a
 * register does: fw/moteus_controller.cc, fw/bldc_servo_control.h and fw/bldc_servo_position.h there. What a server
 * answers: mjlib/multiplex/micro_server.cc of github.com/mjbots/mjlib.
 *
 * Positions, speeds and torques are those of the output, which is the wheel: rotor_to_output_ratio is 1 / gear_ratio.
 * Turns, turns a second and N·m on the bus and in this folder. */
#ifndef LACONIC_DRIVES_MOTEUS_H
#define LACONIC_DRIVES_MOTEUS_H

#include "../place.h"
#include "laconic_drives/protocol.h"

#define MOTEUS_PI ((laconic_real)3.14159265358979323846)
#define MOTEUS_EVERY_ID 0x7F

typedef enum moteus_mode {
    MOTEUS_STOPPED = 0,
    MOTEUS_FAULT = 1,
    MOTEUS_CURRENT = 9,
    MOTEUS_POSITION = 10,
    MOTEUS_TIMEOUT = 11,
    MOTEUS_ZERO_VELOCITY = 12,
    MOTEUS_STAY_WITHIN = 13,
    MOTEUS_BRAKE = 15
} moteus_mode;

/* Fault codes of register 0x00f; those from 96 on say what limits the torque, without a fault. */
typedef enum moteus_fault {
    MOTEUS_DRIVER_FAULT = 33,
    MOTEUS_ENCODER_FAULT = 35,
    MOTEUS_OVER_TEMPERATURE = 38,
    MOTEUS_UNDER_VOLTAGE = 40,
    MOTEUS_STOP_POSITION_DEPRECATED = 45,
    MOTEUS_POSITION_CONTROL_ERROR = 49,
    MOTEUS_VELOCITY_CONTROL_ERROR = 50,
    MOTEUS_LIMIT_VELOCITY = 96,
    MOTEUS_LIMIT_VOLTAGE = 98,
    MOTEUS_LIMIT_CURRENT = 99,
    MOTEUS_LIMIT_TORQUE = 102
} moteus_fault;

/* What a controller writes. NaN where it means "not set". */
typedef struct moteus_command {
    laconic_real mode;
    laconic_real position, velocity, feedforward_torque, kp_scale, kd_scale, maximum_torque, stop_position, timeout_s,
        velocity_limit, acceleration_limit, integral_limit_scale, ignore_bounds;
    laconic_real fixed_voltage, fixed_current; /* never but NaN: not modelled */
    laconic_real lower_bound, upper_bound;
    laconic_real q_current_A, d_current_A;
} moteus_command;

/* What a controller reads, brought up to date before it does. */
typedef struct moteus_status {
    laconic_real mode, position, velocity, torque, q_current_A, power_W, trajectory_complete, home_state, voltage_V,
        temperature_C, fault;
    laconic_real torque_of_kp, torque_of_kd, command_torque, control_position, control_velocity, position_error,
        velocity_error, torque_error;
    laconic_real encoder_position, encoder_velocity, encoder_validity;
    laconic_real zero; /* of what this drive has not: direct current, absolute encoder, thermistor, pins */
} moteus_status;

typedef struct moteus_axis {
    moteus_command given;  /* as written                                     */
    moteus_command acting; /* with defaults, since the last mode was written */
    moteus_status status;
    drive_place zero;    /* place whose position is 0              */
    drive_place target;  /* of the acting command; see has_target  */
    drive_place control; /* where it should be; see has_control    */
    laconic_real control_velocity, timeout_left_s;
    uint32_t milliseconds, elapsed_us, last_us;
    uint8_t node_id, mode, fault, home_state;
    bool has_target, has_control, trajectory_complete;
    bool commanded; /* the frame has written a mode */
    bool discarded; /* the frame is for another UUID */
    bool answers;   /* the frame gets a reply           */
    bool waits;     /* a reply that is to be sent       */
    bool reply_fd, reply_bit_rate_switch;
    uint8_t reply_to, reply_length;
    uint8_t reply[LACONIC_FRAME_BYTES];
} moteus_axis;

static inline moteus_axis *moteus_axis_of(laconic_drives *drives, int32_t i) { return (moteus_axis *)drives->axes + i; }

/* Counts of the encoder for one turn of the output; < 0: it turns the other way. */
static inline laconic_real moteus_counts(const laconic_wheel_drive *drive) {
    return drive->settings.gear_ratio * (laconic_real)drive->settings.encoder_counts;
}

static inline drive_place moteus_seen(const laconic_wheel_drive *drive) {
    const drive_place place = {drive->encoder.count, 0};
    return place;
}

static inline laconic_real moteus_velocity(const laconic_wheel_drive *drive) {
    return drive->speed_rad_per_s / (2 * MOTEUS_PI * drive->settings.gear_ratio);
}

/* N·m at the output for 1 A. */
static inline laconic_real moteus_torque_constant(const laconic_wheel_drive *drive) {
    return drive->settings.torque_constant_Nm_per_A * drive->settings.gear_ratio;
}

/* Whether a completed command has limits: then of the speed, too. */
static inline bool moteus_is_limited(const moteus_command *command) {
    return command->velocity_limit - command->velocity_limit == 0;
}

/* moteus_command.c: a command begins, is completed with defaults, acts. */
moteus_command moteus_blank(void);
void moteus_set_mode(moteus_axis *axis, laconic_real mode);
void moteus_command_drive(const laconic_drives *drives, moteus_axis *axis, laconic_wheel_drive *drive);
void moteus_set_output(moteus_axis *axis, const laconic_wheel_drive *drive, laconic_real position, bool exact);
void moteus_forget_control(moteus_axis *axis);

/* moteus_control.c: once a step. */
void moteus_control(moteus_axis *axis, laconic_wheel_drive *drive, laconic_real step_s);

/* moteus_registers.c: by number; what is returned is 0 or the number of an error. A value is a real number, NaN where
 * an integer is the most negative one. */
enum { MOTEUS_INT8 = 0, MOTEUS_INT16 = 1, MOTEUS_INT32 = 2, MOTEUS_FLOAT = 3 };
enum { MOTEUS_UNKNOWN_REGISTER = 1, MOTEUS_NOT_WRITEABLE = 2 };
static inline uint32_t moteus_extent(uint32_t type) { return type == MOTEUS_INT8 ? 1 : type == MOTEUS_INT16 ? 2 : 4; }
uint32_t moteus_write(laconic_drives *drives, int32_t i, uint32_t number, uint32_t type, const uint8_t *from);
uint32_t moteus_read(laconic_drives *drives, int32_t i, uint32_t number, uint32_t type, uint8_t *to);

/* moteus_frames.c: the subframes of a frame, and the reply. */
void moteus_take(laconic_drives *drives, int32_t i, const laconic_frame *frame);
void moteus_reply(moteus_axis *axis, laconic_frame *frame);

/* moteus_status.c */
void moteus_update_status(const laconic_drives *drives, int32_t i);

#endif
