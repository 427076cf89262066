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

/* Columns by ζ, by the constant part of b and by the two rotating parts, three each. */
#define CORE_COLUMNS 12

typedef struct core_columns {
    laconic_state_change column[CORE_COLUMNS];
} core_columns;

static inline const laconic_state_change *by_zeta(const core_columns *c) { return &c->column[0]; }

static inline const laconic_state_change *by_constant(const core_columns *c) { return &c->column[3]; }

static inline const laconic_state_change *by_cosine(const core_columns *c) { return &c->column[6]; }

static inline const laconic_state_change *by_sine(const core_columns *c) { return &c->column[9]; }

/* Takes the step on a copy of the state and finds the method that took it. A refused step gives its status. */
laconic_status laconic_take_step(taken_step *s, const laconic_model *model, const laconic_integrator *integrator,
                                 const laconic_state *state, const laconic_input *held, bool with_world_force);

/* Answers directions, and what follows from the step itself. */
void laconic_respond(taken_step *s, const laconic_state *state, step_response out[], const step_direction in[],
                     int32_t count);

/* The change of the state after the step along the direction of each lane; x, y and wheel angles before it stay. */
void laconic_finish_step(laconic_state_change after[], int count, const taken_step *s, const step_direction *in,
                         const step_response *by, real heading_rad);

/* Those of the rotating part only where b rotates. */
void laconic_core_columns(core_columns *c, taken_step *s, const laconic_state *state);

/* The column by the heading. */
void laconic_heading_column(laconic_state_change *out, const taken_step *s, const core_columns *c);

/* b of a force F (already times torque_scale) at the body point r. */
world_part laconic_world_b(const laconic_model *m, real fx, real fy, const real r[2]);

/* Its change with the input. */
world_part laconic_world_b_by_input(const laconic_model *m, const laconic_input *by, const laconic_input *in);

#endif
