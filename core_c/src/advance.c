/* Pose and wheel angles are quadratures of ζ. Mean and first moment of ζ over the step, which every method
 * delivers at its own order, fix them to fourth order with a single sine and cosine (PHYSICS §10). */
#include "advance.h"

#include "heading.h"
#include "polynomials.h"

/* Beyond this a square would leave the range within a few steps: no vehicle moves like that. */
#ifdef LACONIC_SINGLE
#define LARGEST_SPEED R(4e9)
#else
#define LARGEST_SPEED R(1e77)
#endif

typedef struct motion { /* over one step */
    real along_m, across_m; /* displacement in axes at the mid-step heading */
    real turn_rad;
} motion;

/* sinc α and ½ j₁(α), α half the turn of the step. */
static void chord_factors(real *sinc, real *half_j1, real alpha) {
    const real z = alpha * alpha;
    if (magnitude(alpha) <= HALF_TURN_SMALL) {
        *sinc = poly_sinc(z);
        *half_j1 = R(0.5) * alpha * poly_j1(z);
    } else {
        const direction d = laconic_direction_of_angle(alpha);
        *sinc = d.sine / alpha;
        *half_j1 = R(0.5) * (*sinc - d.cosine) / alpha;
    }
}

/* ∫ e^{iθ} v dt = e^{iθ_mid} { sinc α · h v̄ + i [½ j₁(α) h Δv − (h Δω/12) h v̄] }, v complex. */
static motion displacement(const laconic_model *m, const real path[3], const real bend[3]) {
    const real turn = dot(m->yaw_rate_of_zeta, path);
    const real yaw_change = dot(m->yaw_rate_of_zeta, bend) * (R(1) / R(12));
    motion moved;
    real sinc, half_j1, aside[3];
    int k;
    chord_factors(&sinc, &half_j1, R(0.5) * turn);
    for (k = 0; k < 3; k++) aside[k] = half_j1 * bend[k] - yaw_change * path[k];
    moved.along_m = sinc * dot(m->velocity_of_zeta[0], path) - dot(m->velocity_of_zeta[1], aside);
    moved.across_m = sinc * dot(m->velocity_of_zeta[1], path) + dot(m->velocity_of_zeta[0], aside);
    moved.turn_rad = turn;
    return moved;
}

static void advance_pose(laconic_state *s, motion moved) {
    const direction middle = laconic_direction_of_turn(heading_advance(&s->heading, moved.turn_rad));
    sum_add(&s->x_m, middle.cosine * moved.along_m - middle.sine * moved.across_m);
    sum_add(&s->y_m, middle.sine * moved.along_m + middle.cosine * moved.across_m);
}

laconic_status laconic_advance(laconic_state *state, const laconic_model *model, real step_s,
                               const laconic_increment *increment) {
    real path[3], bend[3]; /* h ζ̄ and h times ζ's slope */
    motion moved = {R(0), R(0), R(0)};
    int32_t i;
    for (i = 0; i < 3; i++) {
        path[i] = step_s * increment->mean[i];
        bend[i] = step_s * increment->slope[i];
    }
    if (!(size(increment->delta) + size(increment->mean) + size(path) + size(bend) <= LARGEST_SPEED))
        return LACONIC_OVERFLOW;
    if (LACONIC_WITH_POSE) {
        moved = displacement(model, path, bend);
        if (!(magnitude(moved.turn_rad) < LARGEST_TURN_RAD)) return LACONIC_OVERFLOW;
        advance_pose(state, moved);
    }
    for (i = 0; i < 3; i++) sum_add(&state->zeta[i], increment->delta[i]);
    if (LACONIC_WITH_WHEEL_ANGLES)
        for (i = 0; i < LACONIC_WHEELS(model); i++)
            sum_add(&state->wheel_angle_rad[i], dot(model->wheel_of_zeta[i], path));
    return LACONIC_OK;
}
