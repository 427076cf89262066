/* A motor drive as a controller sees it over the bus, without its protocol: cascaded loops for position, speed and
 * current with their limits, and an encoder at the motor's shaft.
 *
 *     target (of a protocol) --position loop--> speed --speed loop--> current --limits--> torque of the wheel's axle
 *                                                                                             |
 *     measured position, speed and current  <------ encoder <---- wheel <---- laconic_plant --+
 *
 * A drive replaces the motor of the vehicle: the plant is prepared without motor gain, and with no motor damping but
 * viscous friction; the drive's torque is the plant's axle torque, held for one step of the core. All values of a drive
 * are at the motor's shaft: a wheel that turns by 1 turns the shaft by gear_ratio. */
#ifndef LACONIC_DRIVES_DRIVE_H
#define LACONIC_DRIVES_DRIVE_H

#include "laconic/laconic.h"

#ifndef LACONIC_NODE_WITH_DRIVE_FAULTS
#define LACONIC_NODE_WITH_DRIVE_FAULTS 1 /* 0 leaves faults by order out of the node: small images need the bytes */
#endif

/* Constants of one drive. */
typedef struct laconic_drive_settings {
    int32_t node_id;                          /* of this drive on the bus; its meaning is the protocol's        */
    int32_t encoder_counts;                   /* of one turn of the shaft, > 0                                  */
    laconic_real gear_ratio;                  /* turns of the shaft for one of the wheel, not 0; < 0: reversed  */
    laconic_real torque_constant_Nm_per_A;    /* > 0                                                            */
    laconic_real back_emf_Vs_per_rad;         /* 0: as the torque constant                                      */
    laconic_real current_limit_A;             /* > 0                                                            */
    laconic_real speed_limit_rad_per_s;       /* of position and speed control; 0: none                         */
    laconic_real supply_V;                    /* the current is limited to what this voltage drives through     */
    laconic_real winding_resistance_ohm;      /* ... this resistance against the back-EMF; either 0: no limit   */
    laconic_real current_bandwidth_rad_per_s; /* first-order lag of the current; 0: follows at once          */
    laconic_real position_gain_per_s;         /* speed for an error of the position                          */
    laconic_real speed_gain_As;               /* current for an error of the speed [A/(rad/s)]               */
    laconic_real speed_integral_gain_A;       /* current for the integral of that error [A/rad]              */
    laconic_real stall_time_s;                /* so long at a limit of the current without motion is a stall; 0: none */
} laconic_drive_settings;

typedef enum laconic_drive_mode {
    LACONIC_DRIVE_OFF = 0, /* no current: the wheel coasts */
    LACONIC_DRIVE_CURRENT,
    LACONIC_DRIVE_SPEED,
    LACONIC_DRIVE_POSITION
} laconic_drive_mode;

/* What a protocol asks of a drive; it stays until it is changed. Its numbers must be finite. */
typedef struct laconic_drive_target {
    int64_t position_count; /* POSITION: counts of the encoder, and a share of a count, 0 to 1          */
    laconic_real position_rest;
    laconic_real speed_rad_per_s; /* SPEED; POSITION: feed-forward                                            */
    laconic_real current_A;       /* CURRENT; SPEED, POSITION: feed-forward                                   */
    laconic_drive_mode mode;
} laconic_drive_target;

/* What goes wrong in a drive, whoever caused it: bits of laconic_wheel_drive.faults. A drive with a fault is off until
 * the protocol clears it with laconic_drive_clear(). The drive itself finds ENCODER, STALL and TARGET. */
#define LACONIC_DRIVE_FAULT_ENCODER 1U     /* the encoder is lost                    */
#define LACONIC_DRIVE_FAULT_STALL 2U       /* no motion at the limit of the current  */
#define LACONIC_DRIVE_FAULT_TEMPERATURE 4U /* only by order: drives have no thermal model */
#define LACONIC_DRIVE_FAULT_OVERSPEED 8U
#define LACONIC_DRIVE_FAULT_SUPPLY 16U
#define LACONIC_DRIVE_FAULT_WATCHDOG 32U  /* the controller is silent; set by the protocol */
#define LACONIC_DRIVE_FAULT_FOLLOWING 64U /* position error too large; set by the protocol */
#define LACONIC_DRIVE_FAULT_TARGET 128U   /* the target or a gain asks for a current that is no number */

/* Faults by order, laconic_drive_order(): those above that the drive does not find by itself, and these around it. */
#define LACONIC_DRIVE_ORDER_OFF_BUS 256U /* it neither hears nor is heard                                   */
#define LACONIC_DRIVE_ORDER_SILENT 512U  /* its sign of life ceases: heartbeat, cyclic feedback             */
#define LACONIC_DRIVE_ORDER_HELD 1024U   /* a brake holds the wheel, whatever the drive does: it stalls     */
#define LACONIC_DRIVE_ORDER_FAULTS \
    (LACONIC_DRIVE_FAULT_ENCODER | LACONIC_DRIVE_FAULT_TEMPERATURE | LACONIC_DRIVE_FAULT_OVERSPEED | \
     LACONIC_DRIVE_FAULT_SUPPLY)
#define LACONIC_DRIVE_ORDERS \
    (LACONIC_DRIVE_ORDER_FAULTS | LACONIC_DRIVE_ORDER_OFF_BUS | LACONIC_DRIVE_ORDER_SILENT | LACONIC_DRIVE_ORDER_HELD)
#define LACONIC_DRIVE_HOLDS_NM 1e4 /* a brake by order holds any wheel */

/* Limits that the last step met: bits of laconic_wheel_drive.limits. */
#define LACONIC_DRIVE_AT_CURRENT 1U
#define LACONIC_DRIVE_AT_SPEED 2U
#define LACONIC_DRIVE_AT_SUPPLY 4U

typedef struct laconic_wheel_drive {
    laconic_drive_settings settings; /* protocols may change gains and limits */
    laconic_drive_target target;
    uint32_t faults;
    uint8_t limits;
    bool unheard;            /* a watchdog has fired since the start, whatever was cleared since              */
    bool off_bus, mute;      /* by order: frames do not pass; there is no sign of life. Protocols obey these  */
    uint32_t causes;         /* faults by order that clearing does not end: laconic_drive_break()             */
    laconic_real brake_Nm;   /* by order: up to this torque holds the wheel, so that the drive stalls; 0: none */
    laconic_real integral_A; /* of the speed loop                                                             */
    laconic_real stalled_s;  /* how long the current has been at its limit without motion                     */
    int64_t stalled_count;   /* the count when that began                                                     */
    /* measured at the end of the last step */
    laconic_encoder encoder; /* the core's: an encoder has one meaning, of a drive or a wheel */
    laconic_real speed_rad_per_s;
    laconic_real current_A;
    laconic_real torque_Nm; /* of the motor at the wheel's axle, without the brake by order */
} laconic_wheel_drive;

/* All zero but the settings: off, at count 0. */
void laconic_drive_start(laconic_wheel_drive *drive, const laconic_drive_settings *settings);

/* The torque at the wheel's axle for the next step_s, from target and measured values. Sets the faults STALL and
 * TARGET. Off, the current is 0 at once. */
laconic_real laconic_drive_act(laconic_wheel_drive *drive, laconic_real step_s);

/* In place of laconic_drive_act for a steering axis whose angle follows a command, whatever torque that takes: the rate
 * of the axis, which is the set speed of speed and position control within the limit; 0 in every other mode, and while
 * a brake holds it. Sets the fault TARGET. */
laconic_real laconic_drive_follow(laconic_wheel_drive *drive);

/* Takes the wheel's motion in the step just done: how far it turned, and its speed at the end. A lost encoder shows
 * neither. A step of 2^31 counts and more sets the fault ENCODER. */
void laconic_drive_measure(laconic_wheel_drive *drive, laconic_real turned_rad, laconic_real wheel_speed_rad_per_s);

/* The place within one turn of the shaft: count modulo encoder_counts, 0 to encoder_counts − 1. The encoder's index is
 * at 0. */
int32_t laconic_drive_shaft_count(const laconic_wheel_drive *drive);

/* Off, without a fault. */
void laconic_drive_off(laconic_wheel_drive *drive);

/* Whether an order keeps frames, or the sign of life, from the bus. */
static inline bool laconic_drive_is_off_bus(const laconic_wheel_drive *drive) {
    return LACONIC_NODE_WITH_DRIVE_FAULTS && drive->off_bus;
}
static inline bool laconic_drive_is_mute(const laconic_wheel_drive *drive) {
    return LACONIC_NODE_WITH_DRIVE_FAULTS && drive->mute;
}

/* Sets faults: the drive is off until they are cleared. */
void laconic_drive_fail(laconic_wheel_drive *drive, uint32_t faults);
/* Clears all faults but those whose cause remains; the drive stays off until the protocol gives a target. */
void laconic_drive_clear(laconic_wheel_drive *drive);

/* For tests and scripts of faults: sets faults that remain, whatever the protocol clears, until they are mended (and
 * then cleared). While ENCODER is there the count stands still and the speed is 0. */
void laconic_drive_break(laconic_wheel_drive *drive, uint32_t faults);
void laconic_drive_mend(laconic_wheel_drive *drive, uint32_t faults);

/* All faults by order at once, bits of LACONIC_DRIVE_ORDERS: those that are not among them are mended. */
void laconic_drive_order(laconic_wheel_drive *drive, uint32_t orders);

#endif
