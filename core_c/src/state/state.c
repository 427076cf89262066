/* Start values, or the numbers of an outer integrator → state; a motion carried over to a changed vehicle. */
#include "step_internals.h"

/* The definitions that every program with a state must share (build.h). */
#define DEFINE_BUILT(name) \
    void name(void) {}
LACONIC_BUILT(DEFINE_BUILT)

static laconic_status check_start(const laconic_start *start, laconic_refusal *why) {
    for (int32_t k = 0; k < 3; k++)
        if (!is_finite(start->nu_rad_per_s[k]))
            return refuse(why, LACONIC_NOT_FINITE, LACONIC_FIELD_START_NU, k + 1, start->nu_rad_per_s[k], R(0));
    if (!is_finite(start->x_m)) return refuse(why, LACONIC_NOT_FINITE, LACONIC_FIELD_START_X, 0, start->x_m, R(0));
    if (!is_finite(start->y_m)) return refuse(why, LACONIC_NOT_FINITE, LACONIC_FIELD_START_Y, 0, start->y_m, R(0));
    if (!is_finite(start->heading_rad))
        return refuse(why, LACONIC_NOT_FINITE, LACONIC_FIELD_START_HEADING, 0, start->heading_rad, R(0));
    if (!(magnitude(start->heading_rad) < LARGEST_YAW_CHANGE_RAD))
        return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_START_HEADING, 0, start->heading_rad,
                      LARGEST_YAW_CHANGE_RAD);
    return LACONIC_OK;
}

static bool moves_in_range(const laconic_state *state) {
    return square(zeta_of(state)) <= LARGEST_SPEED * LARGEST_SPEED;
}

static laconic_status check_allowed(const laconic_model *m, const laconic_state *state, const real nu[3],
                                    laconic_refusal *why) {
    real nearest[3], worst = R(0);
    int32_t item = 0;
    laconic_nu(m, state, nearest);
    for (int32_t k = 0; k < 3; k++)
        if (magnitude(nu[k] - nearest[k]) > worst) {
            worst = magnitude(nu[k] - nearest[k]);
            item = k;
        }
    /* with three degrees of freedom the difference is rounding */
    if (m->dof == 3 || worst <= LACONIC_RANK_TOLERANCE * size(vec(nu))) return LACONIC_OK;
    if (magnitude(nearest[item]) <= LACONIC_RANK_TOLERANCE * size(vec(nu))) nearest[item] = R(0);
    return refuse(why, LACONIC_START_AGAINST_CONSTRAINTS, LACONIC_FIELD_START_NU, item + 1, nu[item], nearest[item]);
}

/* The state of a start; what a refusal leaves in `fresh` is not used. */
static laconic_status find_state(laconic_state *fresh, const laconic_model *model, const laconic_start *start,
                                 laconic_refusal *why) {
    const laconic_state still = ALL_ZERO;
    *fresh = still;
    laconic_status status = check_start(start, why);
    if (status != LACONIC_OK) return status;
    set_zeta(fresh, zeta_of_nu(model, start->nu_rad_per_s));
    if (!moves_in_range(fresh))
        return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_START_NU, 0, size(vec(start->nu_rad_per_s)), R(0));
    status = check_allowed(model, fresh, start->nu_rad_per_s, why);
    if (status != LACONIC_OK) return status;
    fresh->x_m = sum_of(start->x_m);
    fresh->y_m = sum_of(start->y_m);
    heading_advance(&fresh->heading, start->heading_rad);
    return LACONIC_OK;
}

laconic_status laconic_state_set(laconic_state *state, const laconic_model *model, const laconic_start *start,
                                 laconic_refusal *why) {
    laconic_state fresh;
    const laconic_status status = find_state(&fresh, model, start, why);
    if (status != LACONIC_OK) return status;
    *state = fresh;
    return LACONIC_OK;
}

/* zeta_of_nu projects ν onto the allowed motions. */
laconic_status laconic_state_project(laconic_state *state, const laconic_model *model, const laconic_start *motion,
                                     laconic_refusal *why) {
    laconic_start at_rest = *motion;
    const vector zeta = zeta_of_nu(model, motion->nu_rad_per_s);
    for (int k = 0; k < 3; k++) {
        if (!is_finite(motion->nu_rad_per_s[k]))
            return refuse(why, LACONIC_NOT_FINITE, LACONIC_FIELD_START_NU, k + 1, motion->nu_rad_per_s[k], R(0));
        at_rest.nu_rad_per_s[k] = R(0);
    }
    if (!(square(zeta) <= LARGEST_SPEED * LARGEST_SPEED))
        return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_START_NU, 0, size(vec(motion->nu_rad_per_s)), R(0));
    const laconic_status status = laconic_state_set(state, model, &at_rest, why);
    if (status == LACONIC_OK) set_zeta(state, zeta);
    return status;
}

/* Between two prepared models numbers may still leave the range: by a centre of mass far from the old one, a larger
 * Λ. */
static bool carried_in_range(const laconic_state *state, const real *angle, int32_t wheel_count) {
    real zero = zero_if_finite(state->x_m.value) + zero_if_finite(state->x_m.rest) + zero_if_finite(state->y_m.value) +
                zero_if_finite(state->y_m.rest);
    for (int32_t i = 0; i < wheel_count; i++) zero += zero_if_finite(angle[i]);
    return zero == R(0) && moves_in_range(state);
}

/* The body's origin Q keeps its position and velocity, v_Q = v_S − θ' e_z × s with s from Q to S; x_S = x_Q + Rot(θ)
 * s. */
laconic_status laconic_state_carry(laconic_state *state, const laconic_model *from, const laconic_model *to) {
    const direction heading = laconic_direction_of_binary_angle(state->heading.fraction);
    const real dx = to->com_x_m - from->com_x_m, dy = to->com_y_m - from->com_y_m;
    real velocity[2], nu[3], angle[LACONIC_MAX_WHEELS];
    const real yaw_rate = laconic_body_velocity(from, state, velocity);
    laconic_state carried = *state;
    nu[0] = (velocity[0] - yaw_rate * dy) / to->wheel_radius_m;
    nu[1] = (velocity[1] + yaw_rate * dx) / to->wheel_radius_m;
    nu[2] = to->yaw_scale * yaw_rate;
    laconic_wheel_angles(from, state, angle);
    laconic_wheel_angles_set(to, &carried, angle);
    set_zeta(&carried, zeta_of_nu(to, nu));
    sum_add(&carried.x_m, heading.cosine * dx - heading.sine * dy);
    sum_add(&carried.y_m, heading.sine * dx + heading.cosine * dy);
    if (!carried_in_range(&carried, angle, LACONIC_WHEELS(from))) return LACONIC_OVERFLOW;
    *state = carried;
    return LACONIC_OK;
}
