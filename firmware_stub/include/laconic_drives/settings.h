/* The numbers of drives as a client of a node sends them: the one list of these parameters.
 *
 * A new number changes four files, as one of vehicle.h does: here its member and its row; laconic.dbc, its number in
 * the value tables of PARAMETER.field and RESULT.field; packaging/laconic_build/wire/wire_parameters.py, its unit; and
 * docs/wire.md, made from these. */
#ifndef LACONIC_DRIVES_SETTINGS_H
#define LACONIC_DRIVES_SETTINGS_H

#include "laconic_drives/protocol.h"

#ifndef LACONIC_NODE_WITH_DRIVES
#define LACONIC_NODE_WITH_DRIVES 1 /* 0 leaves drives out of the node: small images need the bytes */
#endif
#if LACONIC_NODE_WITH_DRIVES && (!LACONIC_WITH_AXLE_TORQUE || !LACONIC_WITH_WHEEL_ANGLES)
#error "laconic: drives need LACONIC_WITH_AXLE_TORQUE and LACONIC_WITH_WHEEL_ANGLES, or set LACONIC_NODE_WITH_DRIVES=0"
#endif
/* 1: vehicles with hinges also on ground with friction; links the core's articulated_friction. It is nothing in a build
 * without hinges or without friction. */
#if !defined LACONIC_NODE_WITH_SLIP || !LACONIC_NODE_WITH_HINGES || !LACONIC_WITH_FRICTION
#undef LACONIC_NODE_WITH_SLIP
#define LACONIC_NODE_WITH_SLIP 0
#endif
#ifndef LACONIC_NODE_DRIVES_ONLY
#define LACONIC_NODE_DRIVES_ONLY 0 /* 1 leaves out lockstep, free run and the frames that move the vehicle in them */
#endif
#if LACONIC_NODE_DRIVES_ONLY && !LACONIC_NODE_WITH_DRIVES
#error "laconic: LACONIC_NODE_DRIVES_ONLY leaves nothing to do without LACONIC_NODE_WITH_DRIVES"
#endif

/* All drives of a vehicle. */
typedef struct laconic_drive_plan {
    int32_t protocol; /* 0: no drives */
    laconic_real watchdog_s;
    laconic_drive_settings drive[LACONIC_DRIVE_AXES]; /* of each wheel and steering axis; node_id < 0: it has none */
} laconic_drive_plan;

/* Rows as in vehicle.h: X(of, number, IDENTIFIER, member, name, KIND, RULE, NEED). */
/* clang-format off */
#define LACONIC_DRIVES_GROUP_ROWS(X, of) \
    X(of, 64, DRIVE_PROTOCOL, protocol,   drive_protocol,   INTEGER, UNCHECKED,    NEVER) \
    X(of, 77, DRIVE_WATCHDOG, watchdog_s, drive_watchdog_s, REAL,    NOT_NEGATIVE, NEVER)

/* Of each wheel that has a drive: the wheels for which DRIVE_NODE_ID is sent. */
#define LACONIC_DRIVES_WHEEL_ROWS(X, of) \
    X(of, 65, DRIVE_NODE_ID, node_id, drive_node_id, INTEGER, UNCHECKED, NEVER) \
    X(of, 66, ENCODER_COUNTS, encoder_counts, encoder_counts, INTEGER, POSITIVE, NEVER) \
    X(of, 67, DRIVE_GEAR_RATIO, gear_ratio, drive_gear_ratio, REAL, NOT_ZERO, NEVER) \
    X(of, 68, DRIVE_TORQUE_CONSTANT, torque_constant_Nm_per_A, drive_torque_constant_Nm_per_A, REAL, POSITIVE, NEVER) \
    X(of, 69, DRIVE_CURRENT_LIMIT, current_limit_A, drive_current_limit_A, REAL, POSITIVE, NEVER) \
    X(of, 70, DRIVE_SPEED_LIMIT, speed_limit_rad_per_s, drive_speed_limit_rad_per_s, REAL, NOT_NEGATIVE, NEVER) \
    X(of, 71, DRIVE_SUPPLY, supply_V, drive_supply_V, REAL, NOT_NEGATIVE, NEVER) \
    X(of, 72, DRIVE_WINDING_RESISTANCE, winding_resistance_ohm, drive_winding_resistance_ohm, REAL, \
      NOT_NEGATIVE, NEVER) \
    X(of, 73, DRIVE_CURRENT_BANDWIDTH, current_bandwidth_rad_per_s, drive_current_bandwidth_rad_per_s, REAL, \
      NOT_NEGATIVE, NEVER) \
    X(of, 74, DRIVE_POSITION_GAIN, position_gain_per_s, drive_position_gain_per_s, REAL, NOT_NEGATIVE, NEVER) \
    X(of, 75, DRIVE_SPEED_GAIN, speed_gain_As, drive_speed_gain_As, REAL, NOT_NEGATIVE, NEVER) \
    X(of, 76, DRIVE_SPEED_INTEGRAL_GAIN, speed_integral_gain_A, drive_speed_integral_gain_A, REAL, \
      NOT_NEGATIVE, NEVER) \
    X(of, 78, DRIVE_STALL_TIME, stall_time_s, drive_stall_time_s, REAL, NOT_NEGATIVE, NEVER) \
    X(of, 79, DRIVE_BACK_EMF, back_emf_Vs_per_rad, drive_back_emf_Vs_per_rad, REAL, NOT_NEGATIVE, NEVER)
/* clang-format on */

#define LACONIC_DRIVES_FIELD_NUMBER(of, number, IDENTIFIER, ...) LACONIC_DRIVES_FIELD_##IDENTIFIER = number,
enum {
    LACONIC_DRIVES_GROUP_ROWS(LACONIC_DRIVES_FIELD_NUMBER, ) LACONIC_DRIVES_WHEEL_ROWS(LACONIC_DRIVES_FIELD_NUMBER, )
        LACONIC_DRIVES_FIELD_LAST = 79
};

/* All zero, and no wheel has a drive. */
void laconic_drive_plan_begin(laconic_drive_plan *plan);

/* OK iff the plan fits the protocol (not NULL) and a vehicle of so many wheels and steering axes. Refuses as a
 * vehicle's numbers are, by the rules of the rows above, and with ABOVE_LIMIT a node id that the protocol does not
 * have, that two drives have, or of an axis that does not exist. */
laconic_status laconic_drive_plan_check(const laconic_drive_plan *plan, const laconic_drive_protocol *protocol,
                                        int32_t wheel_count, laconic_refusal *why);

#endif
