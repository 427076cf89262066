/* The vehicle as its user knows it, and the one list that describes each of its fields. Part of laconic.h.
 *
 * A new number of a vehicle changes four files; everything else follows from them, and tests name one that is missing:
 *   here                   its member of a struct, and its row in the list of that struct
 *   modelDescription.xml   the variable with its description and unit
 *   laconic.dbc            its number in the value tables of PARAMETER.field and RESULT.field
 *   docs/wire.md           made from these by python -m laconic_build.wire.document_wire */
#ifndef LACONIC_VEHICLE_H
#define LACONIC_VEHICLE_H

#include "laconic/real.h"

typedef enum laconic_wheel_kind {
    LACONIC_WHEEL_UNSET = 0,  /* refused, so that a forgotten wheel is noticed                    */
    LACONIC_WHEEL_ROLLER = 1, /* omni or mecanum: slides freely along the direction in which its rollers roll */
    LACONIC_WHEEL_FIXED = 2   /* ordinary, not steered: does not move along its axle               */
} laconic_wheel_kind;

/* The connection of a wheel's motor. */
typedef enum laconic_motor_circuit {
    LACONIC_MOTOR_DRIVEN = 0, /* to its controller, which sets voltage_V                            */
    LACONIC_MOTOR_OPEN = 1,   /* to nothing: only its viscous friction is left                      */
    LACONIC_MOTOR_SHORTED = 2 /* its terminals to each other: brakes by its back-EMF, without current limit */
} laconic_motor_circuit;

typedef struct laconic_wheel {
    laconic_wheel_kind kind;
    bool locked;             /* held by a brake: χ' = 0                                           */
    laconic_real x_m, y_m;   /* wheel centre P_i in the body frame                                */
    laconic_real axle_rad;   /* β_i, direction of the axle in the body frame. Angles so large
                                that neighbouring numbers differ by more than 1e-6 rad (float:
                                1e-3) are refused                                                */
    laconic_real roller_rad; /* γ_i, from axle to roller axis (the roller that touches the ground):
                                π/2 omni, ±π/4 mecanum; not read for fixed wheels                 */
#if LACONIC_WITH_OWN_WHEELS
    /* The wheel's own values where they differ from the vehicle's; 0: the vehicle's value. A wheel whose own value is 0
     * while the vehicle's is not: set the vehicle's to 0 and give it to all other wheels as theirs. */
    laconic_real own_radius_m;            /* R_i                                                 */
    laconic_real own_inertia_kgm2;        /* J_i                                                 */
    laconic_real own_motor_gain_Nm_per_V; /* c1_i                                                */
    laconic_real own_motor_damping_Nms;   /* c2_i                                                */
    bool undriven; /* no motor: c1_i = c2_i = 0, whatever the values above and the vehicle's; J_i is without a rotor */
#endif
#if LACONIC_WITH_FRICTION
    /* The wheel's own values where they differ from the ground's; 0: the ground's value. */
    laconic_real own_friction_coefficient; /* μ_i                                                 */
    laconic_real own_roller_drag;          /* k_i, 0 … 1; not read for fixed wheels, whose k is 1 */
    laconic_real own_axle_friction_Nm;     /* T_i                                                 */
    int32_t motor_circuit;                 /* laconic_motor_circuit                               */
#endif
} laconic_wheel;

/* A mass fastened to the body. All zero: no payload. */
typedef struct laconic_payload {
    laconic_real mass_kg;
    laconic_real x_m, y_m;         /* its centre of mass in the body frame                        */
    laconic_real yaw_inertia_kgm2; /* about the vertical through its centre of mass               */
} laconic_payload;

typedef struct laconic_support { /* a ball caster: carries a normal load, nothing else */
    laconic_real x_m, y_m;
} laconic_support;

/* The ground under the wheels. All zero: level, and it holds every wheel (the ideal model (4.7)). With a friction
 * coefficient above 0 wheels slip and rollers drag: docs/friction.md. */
typedef struct laconic_ground {
    laconic_real friction_coefficient; /* μ: of each wheel without an own one; 0: ideal ground      */
    laconic_real roller_drag;          /* k: 0, rollers turn freely, … 1, they do not turn         */
    laconic_real axle_friction_Nm;     /* T: dry friction of each axle                             */
    laconic_real slope_rad;            /* 0 … below π/2                                            */
    laconic_real slope_heading_rad;    /* direction of steepest ascent, world axes                 */
} laconic_ground;

/* Limits of motors and their supply. All zero: none. Winding resistance and viscous friction are those that
 * laconic_motor_fit() takes from the motor: with a limit the resistance must be above 0. */
typedef struct laconic_drive {
    laconic_real supply_V;               /* voltages are cut to it; 0: no limit                      */
    laconic_real supply_resistance_ohm;  /* by which the supply sags under the motors' currents      */
    laconic_real current_limit_A;        /* of each motor; 0: no limit                               */
    laconic_real winding_resistance_ohm; /* R_a: a motor's torque on its wheel is c1 R_a per ampere */
    laconic_real viscous_friction_Nms; /* n² d, at the wheel: the part of c2 without back-EMF; all of c2 where that is
                                            less */
} laconic_drive;

/* The user's description of the robot. Start from all zero and set what applies. M and I_S include the wheels. */
typedef struct laconic_vehicle {
    laconic_real mass_kg;              /* M, without payload                                     */
    laconic_real yaw_inertia_kgm2;     /* I_S, about the vertical through the centre of mass     */
    laconic_real com_x_m, com_y_m;     /* centre of mass S in the body frame, without payload    */
    laconic_real com_z_m;              /* height of S above the ground, >= 0; for normal loads only */
    laconic_real wheel_radius_m;       /* R: of wheels without an own one; the unit in which ν is measured */
    laconic_real wheel_inertia_kgm2;   /* J, one wheel with its gear and rotor about the axle    */
    laconic_real motor_gain_Nm_per_V;  /* c1: torque on a wheel is c1 U − c2 χ' + axle torque    */
    laconic_real motor_damping_Nms;    /* c2                                                     */
    laconic_real friction_coefficient; /* μ, for the no-slip margin only                         */
    laconic_payload payload;
#if LACONIC_WITH_FRICTION || LACONIC_WITH_SLOPE
    laconic_ground ground;
#endif
#if LACONIC_WITH_FRICTION
    laconic_drive drive;
#endif
    int32_t wheel_count; /* N, 0 … LACONIC_MAX_WHEELS; 0 is a sliding puck         */
    laconic_wheel wheel[LACONIC_MAX_WHEELS];
    int32_t support_count; /* 0 … LACONIC_MAX_SUPPORTS, for normal loads only        */
    laconic_support support[LACONIC_MAX_SUPPORTS];
} laconic_vehicle;

/* A brushed DC motor behind a gear, at the motor's shaft. */
typedef struct laconic_motor {
    laconic_real resistance_ohm;           /* R_a > 0                                             */
    laconic_real torque_constant_Nm_per_A; /* k_t                                                 */
    laconic_real back_emf_Vs_per_rad;      /* k_e                                                 */
    laconic_real gear_ratio;               /* n: turns of the shaft per turn of the wheel, not 0;
                                              below 0: the shaft turns against the wheel          */
    laconic_real viscous_friction_Nms;     /* d: torque per speed of the shaft                    */
    laconic_real rotor_inertia_kgm2;
} laconic_motor;

/* Everything that acts on the vehicle. All zero: only its motors' damping acts. */
typedef struct laconic_input {
    laconic_real voltage_V[LACONIC_MAX_WHEELS];      /* U_i                                      */
    laconic_real axle_torque_Nm[LACONIC_MAX_WHEELS]; /* any other torque on the axle             */
    laconic_real body_force_N[2];                    /* body axes, acting at S                   */
    laconic_real body_moment_Nm;                     /* about S                                  */
    laconic_real world_force_N[2];                   /* world axes                               */
    laconic_real world_force_point_m[2];             /* where it acts: body axes, from S         */
} laconic_input;

typedef struct laconic_start {
    laconic_real nu_rad_per_s[3];
    laconic_real x_m, y_m; /* of the centre of mass */
    laconic_real heading_rad;
#if LACONIC_WITH_FRICTION
    laconic_real wheel_speed_rad_per_s[LACONIC_MAX_WHEELS]; /* read where the ground has friction; all 0: as the wheels
                                                               roll at this ν                       */
#endif
} laconic_start;

/* ---------------------------------------------------------------------------- traits of a field -- */

typedef enum laconic_field_kind {
    LACONIC_KIND_REAL,
    LACONIC_KIND_INTEGER,    /* int32_t            */
    LACONIC_KIND_WHEEL_KIND, /* laconic_wheel_kind */
    LACONIC_KIND_FLAG,       /* bool               */
    LACONIC_KIND_ABSENCE     /* bool, true where something is absent that wheels usually have: so all zero is the usual
                                wheel. On the wire, and as the key of a scene, 1 and true mean that it is there     */
} laconic_field_kind;

/* The rule for a number. All but UNCHECKED must be finite, and a vehicle's have finite squares.
 * laconic_vehicle_check() goes through a vehicle's own numbers and its payload's rule by rule in this order. */
typedef enum laconic_field_rule {
    LACONIC_RULE_UNCHECKED, /* has a check of its own, or every value is valid */
    LACONIC_RULE_POSITIVE,
    LACONIC_RULE_NOT_NEGATIVE,
    LACONIC_RULE_SHARE,   /* 0 … 1                                              */
    LACONIC_RULE_INCLINE, /* 0 … 1.5 rad                                        */
    LACONIC_RULE_FINITE,
    LACONIC_RULE_NOT_ZERO,
    LACONIC_RULE_ANGLE,  /* small enough that its direction is known             */
    LACONIC_RULE_ROLLER, /* an angle not along the axle; roller wheels only      */
    LACONIC_RULE_COUNT
} laconic_field_rule;

/* When a scene, or a client of a node, must give a number: neither has default values of a robot. */
typedef enum laconic_field_need {
    LACONIC_NEED_NEVER,         /* left out, it is 0                                     */
    LACONIC_NEED_ALWAYS,        /* of a motor: where a motor is given                    */
    LACONIC_NEED_WITH_WHEELS,   /* where there are wheels                                */
    LACONIC_NEED_WITH_MOTOR,    /* where another number of the motors is given           */
    LACONIC_NEED_WITH_PAYLOAD,  /* where another number of the payload is given          */
    LACONIC_NEED_WITH_SUPPORTS, /* where a support is given                              */
    LACONIC_NEED_EACH_WHEEL,    /* for each wheel                                        */
    LACONIC_NEED_EACH_ROLLER,   /* for each wheel with rollers                           */
    LACONIC_NEED_EACH_SUPPORT   /* for each support                                      */
} laconic_field_need;

/* ----------------------------------------------------------------------------------- the lists -- */

/* One row for each field, in the order in which numbers are checked:
 *     X(of, number, IDENTIFIER, member, name, KIND, RULE, NEED)
 * of           the argument of the list, passed through: the name of a table, or what else X needs
 * number       on the wire, never changed
 * IDENTIFIER   LACONIC_FIELD_IDENTIFIER; also the text in the value tables of laconic.dbc
 * member       in the struct that the list is for, and the key in a scene; in the list of a wheel's own values the
 *              struct's member has own_ before it
 * name         of the variable in modelDescription.xml, and of laconic_field_name()
 * KIND …       LACONIC_KIND_…, LACONIC_RULE_…, LACONIC_NEED_… */
/* clang-format off */
#define LACONIC_VEHICLE_FIELDS(X, of) \
    X(of,  1, MASS,                 mass_kg,              mass_kg,              REAL, POSITIVE,     ALWAYS) \
    X(of,  2, YAW_INERTIA,          yaw_inertia_kgm2,     yaw_inertia_kgm2,     REAL, POSITIVE,     ALWAYS) \
    X(of,  3, COM_X,                com_x_m,              com_x_m,              REAL, FINITE,       NEVER) \
    X(of,  4, COM_Y,                com_y_m,              com_y_m,              REAL, FINITE,       NEVER) \
    X(of,  6, WHEEL_RADIUS,         wheel_radius_m,       wheel_radius_m,       REAL, POSITIVE,     ALWAYS) \
    X(of,  7, WHEEL_INERTIA,        wheel_inertia_kgm2,   wheel_inertia_kgm2,   REAL, NOT_NEGATIVE, WITH_WHEELS) \
    X(of,  8, MOTOR_GAIN,           motor_gain_Nm_per_V,  motor_gain_Nm_per_V,  REAL, FINITE,       WITH_MOTOR) \
    X(of,  9, MOTOR_DAMPING,        motor_damping_Nms,    motor_damping_Nms,    REAL, NOT_NEGATIVE, WITH_MOTOR) \
    X(of,  5, COM_Z,                com_z_m,              com_z_m,              REAL, NOT_NEGATIVE, NEVER) \
    X(of, 10, FRICTION_COEFFICIENT, friction_coefficient, friction_coefficient, REAL, NOT_NEGATIVE, NEVER)

#define LACONIC_PAYLOAD_FIELDS(X, of) \
    X(of, 11, PAYLOAD_MASS,        mass_kg,          payload_mass_kg,          REAL, NOT_NEGATIVE, WITH_PAYLOAD) \
    X(of, 12, PAYLOAD_X,           x_m,              payload_x_m,              REAL, FINITE,       WITH_PAYLOAD) \
    X(of, 13, PAYLOAD_Y,           y_m,              payload_y_m,              REAL, FINITE,       WITH_PAYLOAD) \
    X(of, 14, PAYLOAD_YAW_INERTIA, yaw_inertia_kgm2, payload_yaw_inertia_kgm2, REAL, NOT_NEGATIVE, WITH_PAYLOAD)

#define LACONIC_GROUND_FIELDS(X, of) \
    X(of, 51, GROUND_FRICTION_COEFFICIENT, friction_coefficient, ground_friction_coefficient, REAL, NOT_NEGATIVE, \
      NEVER) \
    X(of, 52, GROUND_ROLLER_DRAG,   roller_drag,       ground_roller_drag,      REAL, SHARE,        NEVER) \
    X(of, 53, GROUND_AXLE_FRICTION, axle_friction_Nm,  ground_axle_friction_Nm, REAL, NOT_NEGATIVE, NEVER) \
    X(of, 54, SLOPE,                slope_rad,         slope_rad,               REAL, INCLINE,      NEVER) \
    X(of, 55, SLOPE_HEADING,        slope_heading_rad, slope_heading_rad,       REAL, ANGLE,        NEVER)

#define LACONIC_DRIVE_FIELDS(X, of) \
    X(of, 56, SUPPLY_VOLTAGE,         supply_V,               supply_V,                   REAL, NOT_NEGATIVE, NEVER) \
    X(of, 57, SUPPLY_RESISTANCE,      supply_resistance_ohm,  supply_resistance_ohm,      REAL, NOT_NEGATIVE, NEVER) \
    X(of, 58, CURRENT_LIMIT,          current_limit_A,        current_limit_A,            REAL, NOT_NEGATIVE, NEVER) \
    X(of, 60, WINDING_RESISTANCE,     winding_resistance_ohm, winding_resistance_ohm,     REAL, NOT_NEGATIVE, NEVER) \
    X(of, 61, DRIVE_VISCOUS_FRICTION, viscous_friction_Nms,   drive_viscous_friction_Nms, REAL, NOT_NEGATIVE, NEVER)

/* How many wheels or supports are given; member: their array. */
#define LACONIC_WHEEL_COUNT_FIELD(X, of) \
    X(of, 15, WHEEL_COUNT, wheel, wheel_count, INTEGER, UNCHECKED, ALWAYS)

#define LACONIC_WHEEL_FIELDS(X, of) \
    X(of, 16, WHEEL_KIND,   kind,       wheel_kind,   WHEEL_KIND, UNCHECKED, EACH_WHEEL) \
    X(of, 17, WHEEL_X,      x_m,        wheel_x_m,    REAL,       FINITE,    EACH_WHEEL) \
    X(of, 18, WHEEL_Y,      y_m,        wheel_y_m,    REAL,       FINITE,    EACH_WHEEL) \
    X(of, 19, AXLE,         axle_rad,   axle_rad,     REAL,       ANGLE,     EACH_WHEEL) \
    X(of, 20, ROLLER,       roller_rad, roller_rad,   REAL,       ROLLER,    EACH_ROLLER) \
    X(of, 21, WHEEL_LOCKED, locked,     wheel_locked, FLAG,       UNCHECKED, NEVER) \
    X(of, 47, DRIVEN,       undriven,   wheel_undriven, ABSENCE,  UNCHECKED, NEVER) \
    X(of, 62, MOTOR_CIRCUIT, motor_circuit, motor_circuit, INTEGER, UNCHECKED, NEVER)

/* A wheel's own values; 0: the vehicle's, or the ground's. */
#define LACONIC_OWN_WHEEL_FIELDS(X, of) \
    X(of, 43, OWN_RADIUS,                 radius_m,             own_radius_m,             REAL, NOT_NEGATIVE, NEVER) \
    X(of, 44, OWN_INERTIA,                inertia_kgm2,         own_inertia_kgm2,         REAL, NOT_NEGATIVE, NEVER) \
    X(of, 45, OWN_MOTOR_GAIN,             motor_gain_Nm_per_V,  own_motor_gain_Nm_per_V,  REAL, FINITE,       NEVER) \
    X(of, 46, OWN_MOTOR_DAMPING,          motor_damping_Nms,    own_motor_damping_Nms,    REAL, NOT_NEGATIVE, NEVER) \
    X(of, 48, WHEEL_FRICTION_COEFFICIENT, friction_coefficient, own_friction_coefficient, REAL, NOT_NEGATIVE, NEVER) \
    X(of, 49, WHEEL_ROLLER_DRAG,          roller_drag,          own_roller_drag,          REAL, SHARE,        NEVER) \
    X(of, 50, WHEEL_AXLE_FRICTION,        axle_friction_Nm,     own_axle_friction_Nm,     REAL, NOT_NEGATIVE, NEVER)

#define LACONIC_SUPPORT_COUNT_FIELD(X, of) \
    X(of, 22, SUPPORT_COUNT, support, support_count, INTEGER, UNCHECKED, WITH_SUPPORTS)

#define LACONIC_SUPPORT_FIELDS(X, of) \
    X(of, 23, SUPPORT_X, x_m, support_x_m, REAL, FINITE, EACH_SUPPORT) \
    X(of, 24, SUPPORT_Y, y_m, support_y_m, REAL, FINITE, EACH_SUPPORT)

/* Arrays of laconic_start, then its single numbers. laconic_state_set() checks them. */
#define LACONIC_START_ARRAY_FIELDS(X, of) \
    X(of, 25, START_NU,          nu_rad_per_s,          start_nu_rad_per_s,          REAL, FINITE, NEVER) \
    X(of, 59, START_WHEEL_SPEED, wheel_speed_rad_per_s, start_wheel_speed_rad_per_s, REAL, FINITE, NEVER)
#define LACONIC_START_FIELDS(X, of) \
    X(of, 26, START_X,       x_m,         start_x_m,         REAL, FINITE, NEVER) \
    X(of, 27, START_Y,       y_m,         start_y_m,         REAL, FINITE, NEVER) \
    X(of, 28, START_HEADING, heading_rad, start_heading_rad, REAL, FINITE, NEVER)

/* Members of no struct of the core; laconic_integrator_prepare() checks them. */
#define LACONIC_RUN_FIELDS(X, of) \
    X(of, 29, METHOD, method, method, INTEGER, UNCHECKED, NEVER) \
    X(of, 30, STEP,   step_s, step_s, REAL,    POSITIVE,  ALWAYS)

/* Arrays of laconic_input, and its single number. laconic_input_check() checks them. */
#define LACONIC_INPUT_ARRAY_FIELDS(X, of) \
    X(of, 31, VOLTAGE,           voltage_V,           voltage_V,           REAL, FINITE, NEVER) \
    X(of, 32, AXLE_TORQUE,       axle_torque_Nm,      axle_torque_Nm,      REAL, FINITE, NEVER) \
    X(of, 33, BODY_FORCE,        body_force_N,        body_force_N,        REAL, FINITE, NEVER) \
    X(of, 35, WORLD_FORCE,       world_force_N,       world_force_N,       REAL, FINITE, NEVER) \
    X(of, 36, WORLD_FORCE_POINT, world_force_point_m, world_force_point_m, REAL, FINITE, NEVER)
#define LACONIC_INPUT_FIELDS(X, of) \
    X(of, 34, BODY_MOMENT, body_moment_Nm, body_moment_Nm, REAL, FINITE, NEVER)

/* laconic_motor_fit() checks them. */
#define LACONIC_MOTOR_FIELDS(X, of) \
    X(of, 37, RESISTANCE,       resistance_ohm,           resistance_ohm,           REAL, POSITIVE,     ALWAYS) \
    X(of, 38, TORQUE_CONSTANT,  torque_constant_Nm_per_A, torque_constant_Nm_per_A, REAL, FINITE,       ALWAYS) \
    X(of, 39, BACK_EMF,         back_emf_Vs_per_rad,      back_emf_Vs_per_rad,      REAL, FINITE,       ALWAYS) \
    X(of, 40, GEAR_RATIO,       gear_ratio,               gear_ratio,               REAL, NOT_ZERO,     ALWAYS) \
    X(of, 41, VISCOUS_FRICTION, viscous_friction_Nms,     viscous_friction_Nms,     REAL, NOT_NEGATIVE, NEVER) \
    X(of, 42, ROTOR_INERTIA,    rotor_inertia_kgm2,       rotor_inertia_kgm2,       REAL, NOT_NEGATIVE, NEVER)

/* The start of a plant: vehicle, start, method and step. */
#define LACONIC_PARAMETER_FIELDS(X) \
    LACONIC_VEHICLE_FIELDS(X, VEHICLE) LACONIC_PAYLOAD_FIELDS(X, PAYLOAD) \
    LACONIC_GROUND_FIELDS(X, GROUND) LACONIC_DRIVE_FIELDS(X, DRIVE) \
    LACONIC_WHEEL_COUNT_FIELD(X, COUNT) LACONIC_WHEEL_FIELDS(X, WHEEL) LACONIC_OWN_WHEEL_FIELDS(X, OWN) \
    LACONIC_SUPPORT_COUNT_FIELD(X, COUNT) LACONIC_SUPPORT_FIELDS(X, SUPPORT) \
    LACONIC_START_ARRAY_FIELDS(X, START_ARRAY) LACONIC_START_FIELDS(X, START) LACONIC_RUN_FIELDS(X, RUN)

#define LACONIC_ALL_FIELDS(X) \
    LACONIC_PARAMETER_FIELDS(X) \
    LACONIC_INPUT_ARRAY_FIELDS(X, INPUT_ARRAY) LACONIC_INPUT_FIELDS(X, INPUT_NUMBER) LACONIC_MOTOR_FIELDS(X, MOTOR)

/* clang-format on */

/* ------------------------------------------------------------------------ what a build leaves out -- */

/* LACONIC_ROW_OF(number)(row) is the row of a table, or nothing where the build leaves out what the field is for: small
 * images need the bytes. The field's names stay, for refusals. */
#define LACONIC_A_ROW(...) __VA_ARGS__
#define LACONIC_NO_ROW(...)
#define LACONIC_SECOND_OF(...) LACONIC_THE_SECOND(__VA_ARGS__)
#define LACONIC_THE_SECOND(first, second, ...) second
#define LACONIC_ROW_OF(number) LACONIC_SECOND_OF(LACONIC_LEFT_OUT_##number, LACONIC_A_ROW, ~)
#if !LACONIC_WITH_OWN_WHEELS
#define LACONIC_LEFT_OUT_43 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_44 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_45 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_46 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_47 ~, LACONIC_NO_ROW
#endif
#if !LACONIC_WITH_FRICTION
#define LACONIC_LEFT_OUT_48 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_49 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_50 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_51 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_52 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_53 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_56 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_57 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_58 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_59 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_60 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_61 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_62 ~, LACONIC_NO_ROW
#endif
#if !LACONIC_WITH_SLOPE
#define LACONIC_LEFT_OUT_54 ~, LACONIC_NO_ROW
#define LACONIC_LEFT_OUT_55 ~, LACONIC_NO_ROW
#endif

#define LACONIC_FIELD_NUMBER(of, number, IDENTIFIER, ...) LACONIC_FIELD_##IDENTIFIER = number,

/* The fields a refusal can name: LACONIC_FIELD_MASS = 1 …, and those of laconic_sensor_field. */
typedef enum laconic_field {
    LACONIC_FIELD_NONE = 0,
    LACONIC_ALL_FIELDS(LACONIC_FIELD_NUMBER) LACONIC_FIELD_COUNT = 63, /* one more than the largest number above */
    LACONIC_FIELD_LAST = 255 /* no field: in C++ an enumeration holds no number that has more bits than its largest */
} laconic_field;

#endif
