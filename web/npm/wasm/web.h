/* The core as JavaScript sees it: one struct a robot, numbers set by the core's own list of fields. With
 * LACONIC_WEB_HINGES these files make the module of vehicles with hinges (hinged.c), without it that of all others
 * (robot.c, wanted.c, hash.c).
 *
 * JavaScript has no structs. It names a number of the robot by its field (vehicle.h) and item, as frames on the wire
 * do, and reads outputs by the offsets that laconic_web_output() tells. Every pointer is an offset in the module's
 * memory, which only this module's functions change. */
#ifndef LACONIC_WEB_H
#define LACONIC_WEB_H

#ifdef LACONIC_WEB_HINGES
#include "laconic/articulated_friction.h"
#else
#include "laconic/laconic.h"
#endif

#define LACONIC_WEB_TEXT 512
#define WEB_EXPORT(name) __attribute__((export_name(#name), used))

#ifdef LACONIC_WEB_HINGES
#define LACONIC_WEB_FIELD_COUNT LACONIC_TREE_FIELD_COUNT

/* Where JavaScript finds the outputs: all but the motion, and the reactions, where wheels may slip alone. */
typedef struct laconic_web_hinged_outputs {
    laconic_articulated_motion motion;
    laconic_articulated_reactions reactions;
    laconic_tree_outputs tree;
    laconic_real contact_state[LACONIC_MAX_WHEELS], drive_limit[LACONIC_TREE_AXES];
} laconic_web_hinged_outputs;
#else
#define LACONIC_WEB_FIELD_COUNT LACONIC_FIELD_COUNT
#endif

/* A robot: what was given, and what moves. */
typedef struct laconic_web_robot {
    laconic_vehicle vehicle; /* as given: without the rotors that laconic_motor_fit() adds */
    laconic_motor motor;     /* of no effect while its resistance is 0, as no motor has    */
    bool has_motor;
    uint32_t own_zero[LACONIC_MAX_WHEELS]; /* a bit for each own value that was given as 0: own_zeros.c */
    laconic_start start;                   /* with hinges: place and heading alone */
    laconic_input input;                   /* of wheels and carriage               */
#ifdef LACONIC_WEB_HINGES
    laconic_tree_vehicle tree; /* bodies, and the bodies of wheels; its base is made of the vehicle */
    laconic_tree_start tree_start;
    laconic_tree_input tree_input;          /* of hinges; its base is made of the input       */
    bool slips;                             /* on ground with friction: the members "tree" act */
    laconic_real twist[3], twist_before[3]; /* at the end of the last step, and before the last run */
    laconic_articulated_model model;
    laconic_articulated_integrator integrator;
    laconic_articulated_state state, before; /* now, and before the last run */
    laconic_tree_model tree_model;
    laconic_tree_state tree_state;
    double step_s;
    laconic_real changed_m_per_s; /* by which the start was moved to a motion that is allowed */
    double steps, steps_before;
    laconic_web_hinged_outputs outputs;
#else
    laconic_plant plant;
    laconic_contact contact;
    laconic_model rolling; /* the robot on ideal ground, for wanted velocities */
    bool rolls;            /* false: fixed wheels keep it from yawing there     */
    laconic_outputs outputs;
    laconic_real wanted[LACONIC_MAX_WHEELS]; /* voltages or torques that wanted.c finds */
#endif
    laconic_refusal why;
    char text[LACONIC_WEB_TEXT];
} laconic_web_robot;

/* Where JavaScript finds an output, and how many numbers it has. */
typedef struct laconic_web_output {
    const char *name;
    uint32_t offset, count;
} laconic_web_output;

/* Keeps the text of a refusal; returns its status. */
laconic_status laconic_web_refuse(laconic_web_robot *robot);

/* The vehicle as the core takes it, its motor fitted and each wheel's own zeros in force. */
laconic_status laconic_web_vehicle(laconic_vehicle *vehicle, const laconic_web_robot *robot, laconic_refusal *why);

/* Lets wheels' own zeros hold in a vehicle, where 0 means the vehicle's value: of inertias (to be called before the
 * motor is fitted), or of everything else (after). */
void laconic_web_own_zeros(laconic_vehicle *vehicle, const laconic_web_robot *robot, bool inertias);

#endif
