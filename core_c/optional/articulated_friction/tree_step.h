/* What the files of a step share: the part of a step that is being computed. */
#ifndef LACONIC_TREE_STEP_H
#define LACONIC_TREE_STEP_H

#include "friction_vehicle.h"
#include "tree_solver.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

/* The largest number of a start, and sum of speeds after a step. */
#ifdef LACONIC_SINGLE
#define TREE_LARGEST R(1e8)
#else
#define TREE_LARGEST R(1e30)
#endif

typedef laconic_tree_state tree_state;

/* Where a wheel's contact is, and its direction u: axes of body 0, from S_0. */
typedef struct tree_place_of_wheel {
    real x, y;
    direction pull;
} tree_place_of_wheel;

typedef struct tree_loads {
    real carried_N[LACONIC_TREE_POINTS]; /* 0 where lifted                         */
    real statics_N[LACONIC_TREE_POINTS]; /* below 0 where lifted, else what is carried */
} tree_loads;

/* The elements of a hinge (NULL: none; stop: the high one, the low one follows), and a drive without limit, whose
 * torque is torque − slope ψ'. */
typedef struct tree_hinge_part {
    const tree_element *drive, *dry, *stop;
    real torque_Nm, slope_Nms;
} tree_hinge_part;

typedef struct tree_part {
    const tree_model *m;
    const laconic_tree_input *in;
    real h;
    tree_posture at;
    direction end;               /* heading of body 0 at the end; a local would cost 120 instructions more */
    vector carried[TREE_BODIES]; /* the bodies' velocities, in the axes at the end               */
    int32_t pulled;              /* the last body that is pulled                                 */
    vector pull[TREE_BODIES];    /* forces and moments from outside, axes at the end             */
    real ahead[TREE_HINGES];     /* ψ^ of the hinges with springs, stops or servos               */
    tree_place_of_wheel place[TREE_WHEELS];
    tree_loads loads;
    real terminal_V;
    tree_factor factor;
    tree_problem problem;
    tree_hinge_part hinge[TREE_HINGES];
    const tree_element *scrub[TREE_WHEELS]; /* NULL: none                                        */
    real z[LACONIC_TREE_SPEEDS];
    int32_t passes;
} tree_part;

/* ------------------------------------------------------------------------------------- drives -- */

/* In Nm. `terminal_V` as for within_supply(). */
static inline motor_state tree_motor_at(const laconic_tree_motor *a, real command_V, real speed, real terminal_V) {
    return motor_state_of(a->circuit, a->gain_Nm_per_V, a->back_emf_Nms, a->torque_limit_Nm, a->ampere_per_Nm,
                          command_V, speed, terminal_V);
}

/* What a loop has set is added to the voltage of a hinge. */
static inline real tree_hinge_command(const tree_model *m, const laconic_tree_input *in, const tree_state *s,
                                      int32_t b) {
    const real volts = in->hinged.hinge_voltage_V[b - 1];
    return m->body[b].sampled ? volts + s->control_command[b - 1] : volts;
}

/* Voltage of the supply under the motors' currents at the speeds of the state; −1 without a supply. */
real laconic_tree_terminal_voltage(const tree_model *m, const laconic_tree_input *in, const tree_state *state);

/* Lets loops and sampled servos look where it is time. Refuses STEP_DOES_NOT_FIT. */
laconic_status laconic_tree_control(const tree_model *m, real step_s, tree_state *state, const laconic_tree_input *in,
                                    laconic_refusal *why);

static inline real tree_axis_speed(const tree_model *m, const tree_state *state, int32_t axis) {
    return axis < m->wheel_count ? state->wheel_speed_rad_per_s[axis] : state->z[3 + axis - m->wheel_count];
}

static inline bool tree_has_motor(const tree_model *m, int32_t b) { return m->body[b].hinge == LACONIC_HINGE_MOTOR; }

/* -------------------------------------------------------------------------------- loads, results -- */

void laconic_tree_loads(tree_loads *loads, const tree_model *m, const tree_posture *at,
                        const tree_place_of_wheel place[], const tree_state *state);

/* Pose, angles, energies and forces of the part into the state. Refuses OVERFLOW, with the state as it was. */
laconic_status laconic_tree_accept(const tree_part *p, tree_state *state);

static inline void tree_place_wheel(tree_place_of_wheel *w, const tree_posture *at, const laconic_tree_rim *rim) {
    const direction d = at->axes[rim->body];
    if (rim->body == 0) { /* its axes are these */
        w->x = rim->x_m;
        w->y = rim->y_m;
        w->pull = direction_with(rim->pull[0], rim->pull[1]);
        return;
    }
    w->x = at->hinge_x[rim->body] + (d.cosine * rim->x_m - d.sine * rim->y_m);
    w->y = at->hinge_y[rim->body] + (d.sine * rim->x_m + d.cosine * rim->y_m);
    w->pull = direction_with(d.cosine * rim->pull[0] - d.sine * rim->pull[1],
                             d.sine * rim->pull[0] + d.cosine * rim->pull[1]);
}

static inline real tree_energy_twice(const tree_model *m, const tree_state *s) {
    real sum = R(0);
    for (int32_t b = 0; b <= m->body_count; b++) {
        const vector v = s->body[b];
        sum += m->body[b].mass_kg * (v.x * v.x + v.y * v.y) + m->body[b].yaw_inertia_kgm2 * v.z * v.z;
    }
    for (int32_t i = 0; i < m->wheel_count; i++)
        sum += m->wheel[i].inertia_kgm2 * s->wheel_speed_rad_per_s[i] * s->wheel_speed_rad_per_s[i];
    return sum;
}

#endif
#endif
