/* What Jacobian, tangent and adjoint share: the step that is taken, and the small dense Jacobian by ζ and forcing to
 * which states, inputs and constants of the model are chained. */
#ifndef LACONIC_STEP_CHAIN_H
#define LACONIC_STEP_CHAIN_H

#include "step_change.h"

/* A step and what was found out about it. */
typedef struct taken_step {
    step_point at;
    responder responds;
    step_result result;
    vector end;       /* ζ after it, with all that the step did          */
    direction middle; /* heading half-way, in whose axes the displacement is */
    real x_m, y_m;    /* the displacement in world axes                      */
} taken_step;

/* b of a force fixed in the world, in world axes: b = cos θ · cosine + sin θ · sine. */
typedef struct world_part {
    vector cosine, sine;
} world_part;

/* In axes at the heading at the step's start. */
static inline world_part turned(world_part b, direction heading) {
    const world_part out = {plus(scaled(heading.cosine, b.cosine), scaled(heading.sine, b.sine)),
                            minus(scaled(heading.cosine, b.sine), scaled(heading.sine, b.cosine))};
    return out;
}

static inline world_part both(world_part a, world_part b) {
    const world_part out = {plus(a.cosine, b.cosine), plus(a.sine, b.sine)};
    return out;
}

/* ν at the step's start, as the model has it. */
static inline vector nu_before(const taken_step *s) { return mapped_rows(s->at.model->nu_of_zeta, s->at.zeta); }

/* Three directions of ζ and three of the constant part of b, and where the columns along them go: these six, then
 * three by each rotating part, along unit vectors, which are set only where b rotates. */
#define CORE_COLUMNS 12

typedef struct core_columns {
    vector zeta[3], constant[3];
    laconic_state_change *column[CORE_COLUMNS];
} core_columns;

typedef laconic_state_change *const *three_columns;

static inline three_columns by_zeta(const core_columns *c) { return &c->column[0]; }

static inline three_columns by_constant(const core_columns *c) { return &c->column[3]; }

static inline three_columns by_cosine(const core_columns *c) { return &c->column[6]; }

static inline three_columns by_sine(const core_columns *c) { return &c->column[9]; }

/* Takes the step on a copy of the state and finds the method that took it. A refused step gives its status, and so does
 * a method that the derivation is not of. */
laconic_status laconic_take_step(taken_step *s, const laconic_derivation *derivation, const laconic_model *model,
                                 const laconic_integrator *integrator, const laconic_state *state,
                                 const laconic_input *held, bool with_world_force);

/* Answers directions, and what follows from the step itself. */
void laconic_respond(taken_step *s, const laconic_state *state, step_response out[], const step_direction in[],
                     int32_t count);

/* The responses of a step whose gain of energy was cut, from those of its method. */
void laconic_cut_responses(taken_step *s, step_response out[], const step_direction in[], int32_t count);

/* The changes of the state after the step along the directions of the first lanes; x, y and wheel angles before it
 * stay. */
void laconic_finish_step(laconic_state_change after[], int count, const taken_step *s, const step_direction *in,
                         const step_response *by, real heading_rad);

/* The directions by which a Jacobian begins: those of ν, and of a force and a moment on the body. */
void laconic_jacobian_directions(core_columns *c, const laconic_model *m);

/* Fills the columns. */
void laconic_core_columns(const core_columns *c, taken_step *s, const laconic_state *state);

/* The rest of the Jacobian from those along the directions by which it begins: by the heading, by motors and axles, by
 * a world force where b rotates. */
void laconic_heading_column(laconic_state_change *out, const taken_step *s, const core_columns *c);
void laconic_torque_columns(laconic_step_jacobian *j, const taken_step *s, const core_columns *c);
void laconic_world_columns(laconic_step_jacobian *j, const taken_step *s, const core_columns *c,
                           const laconic_input *held);

/* b of a force F (already times torque_scale) at the body point r. */
world_part laconic_world_b(const laconic_model *m, real fx, real fy, const real r[2]);

/* Its change with the input. */
world_part laconic_world_b_by_input(const laconic_model *m, const laconic_input *by, const laconic_input *in);

#endif
