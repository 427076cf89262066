/* From what a method finds out about ζ to the next state: the one place where pose and wheel angles advance.
 * Inlined into each method, so that a step is one function and nothing travels through memory. */
#ifndef LACONIC_ADVANCE_H
#define LACONIC_ADVANCE_H

#include "heading.h"
#include "passivity.h"
#include "zeta.h"

typedef struct motion {     /* over one step */
    real along_m, across_m; /* displacement in axes at the mid-step heading */
    real turn_rad;
} motion;

/* sinc α and ½ j₁(α), α half the turn of the step. */
static inline void chord_factors(real *sinc, real *half_j1, real alpha) {
    const real z = alpha * alpha;
    if (z <= CHORD_SMALL) {
        *sinc = poly_sinc(z);
        *half_j1 = R(0.5) * alpha * poly_j1(z);
    } else {
        const direction d = direction_of_turn(laconic_turn_of_angle(alpha));
        *sinc = d.sine / alpha;
        *half_j1 = R(0.5) * (*sinc - d.cosine) / alpha;
    }
}

/* Pose is a quadrature of ζ. Mean and first moment of ζ over the step, which every method delivers at its own
 * order, fix it to fourth order with a single sine and cosine, as complex numbers in body axes:
 * ∫ e^{iθ} v dt = e^{iθ_mid} { sinc α · h v̄ + i [½ j₁(α) h Δv − (h Δω/12) h v̄] } */
INLINE motion displacement(const laconic_model *m, vector path, vector bend) {
    const vector along = vec(m->velocity_of_zeta[0]), across = vec(m->velocity_of_zeta[1]);
    const vector yaw_rate = vec(m->yaw_rate_of_zeta);
    const real turn = dot(yaw_rate, path), yaw_change = dot(yaw_rate, bend) * (R(1) / R(12));
    const real forth = dot(along, path), left = dot(across, path);
    real sinc, half_j1, aside_forth, aside_left;
    chord_factors(&sinc, &half_j1, R(0.5) * turn);
    aside_forth = half_j1 * dot(along, bend) - yaw_change * forth;
    aside_left = half_j1 * dot(across, bend) - yaw_change * left;
    return (motion){sinc * forth - aside_left, sinc * left + aside_forth, turn};
}

INLINE void advance_pose(laconic_state *s, motion moved) {
    const direction middle = direction_of_turn(heading_advance(&s->heading, moved.turn_rad));
    sum_add(&s->x_m, middle.cosine * moved.along_m - middle.sine * moved.across_m);
    sum_add(&s->y_m, middle.sine * moved.along_m + middle.cosine * moved.across_m);
}

static inline void add(laconic_sum sums[3], vector v) {
    sum_add(&sums[0], v.x);
    sum_add(&sums[1], v.y);
    sum_add(&sums[2], v.z);
}

/* Far below what has decayed for good, but so that its square is still a normal number: processors are many times
 * slower with subnormal ones. Added and taken away again, it leaves nothing of what is smaller. */
#ifdef LACONIC_SINGLE
#define AT_REST R(1e-18)
#else
#define AT_REST R(1e-150)
#endif

static inline void settle(laconic_sum sums[3]) {
    sums[0].value = (sums[0].value + AT_REST) - AT_REST;
    sums[1].value = (sums[1].value + AT_REST) - AT_REST;
    sums[2].value = (sums[2].value + AT_REST) - AT_REST;
}

/* Looked at first: model and step are bounded when they are prepared, so with ζ in range all that follows is finite. */
static inline bool in_range(vector zeta, vector delta) {
    return square(zeta) + square(plus(zeta, delta)) <= LARGEST_SPEED * LARGEST_SPEED;
}

/* Takes the step, or refuses and leaves the state as it was. */
INLINE laconic_status take(laconic_state *state, vector delta, vector path, motion moved) {
    if (!(magnitude(moved.turn_rad) + magnitude(moved.along_m) + magnitude(moved.across_m) < LARGEST_TURN_RAD))
        return LACONIC_OVERFLOW;
    add(state->zeta, delta);
    settle(state->zeta);
    if (LACONIC_WITH_WHEEL_ANGLES) add(state->travel, path);
    if (LACONIC_WITH_POSE) advance_pose(state, moved);
    return LACONIC_OK;
}

INLINE laconic_status advance(laconic_state *state, const laconic_model *model, real step_s, vector zeta,
                              increment by) {
    const vector path = scaled(step_s, by.mean);
    motion moved = {R(0), R(0), R(0)};
    if (!in_range(zeta, by.delta)) return LACONIC_OVERFLOW;
    if (LACONIC_WITH_POSE) moved = displacement(model, path, scaled(step_s, by.slope));
    return take(state, by.delta, path, moved);
}

/* For methods that can go wrong: no energy out of nothing, and no increment that is none. */
INLINE laconic_status advance_if_passive(laconic_state *state, const laconic_model *model, real step_s,
                                         const laconic_loads *loads, vector zeta, increment by) {
    if (!passive(model, state, step_s, loads, zeta, by)) return not_passive(by);
    return advance(state, model, step_s, zeta, by);
}

#endif
