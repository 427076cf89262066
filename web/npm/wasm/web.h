/* The core as JavaScript sees it: one struct a robot, numbers set by the core's own list of fields.
 *
 * JavaScript has no structs. It names a number of the robot by its field (vehicle.h) and item, as frames on the wire
 * do, and reads outputs by the offsets that laconic_web_output() tells. Every pointer is an offset in the module's
 * memory, which only this module's functions change. */
#ifndef LACONIC_WEB_H
#define LACONIC_WEB_H

#include "laconic/laconic.h"

#define LACONIC_WEB_TEXT 512
#define WEB_EXPORT(name) __attribute__((export_name(#name), used))

/* A robot: what was given, and the plant made of it. */
typedef struct laconic_web_robot {
    laconic_vehicle vehicle; /* as given: without the rotors that laconic_motor_fit() adds */
    laconic_motor motor;     /* of no effect while its resistance is 0, as no motor has    */
    bool has_motor;
    uint32_t own_zero[LACONIC_MAX_WHEELS]; /* a bit for each own value that was given as 0: own_zeros.c */
    laconic_start start;
    laconic_input input;
    laconic_plant plant;
    laconic_contact contact;
    laconic_model rolling; /* the robot on ideal ground, for wanted velocities */
    bool rolls;            /* false: fixed wheels keep it from yawing there     */
    laconic_outputs outputs;
    laconic_real wanted[LACONIC_MAX_WHEELS]; /* voltages or torques that wanted.c finds */
    laconic_refusal why;
    char text[LACONIC_WEB_TEXT];
} laconic_web_robot;

/* The vehicle as the core takes it, its motor fitted and each wheel's own zeros in force. */
laconic_status laconic_web_vehicle(laconic_vehicle *vehicle, const laconic_web_robot *robot, laconic_refusal *why);

/* Lets wheels' own zeros hold in a vehicle, where 0 means the vehicle's value: of inertias (to be called before the
 * motor is fitted), or of everything else (after). */
void laconic_web_own_zeros(laconic_vehicle *vehicle, const laconic_web_robot *robot, bool inertias);

#endif
