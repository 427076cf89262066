/* The linearised motion, by which an error E of the state is carried over a window of n steps. With e that of ζ:
 *
 *     e' = M e − diag(r) e + c + s,    M e = (g·ζ)(e × w) + (g·e)(ζ × w),    ∫e dt: the error of travel,
 *
 * c: how b follows the error of the heading; s: a constant source that over one step makes the error of that step. M is
 * taken in the middle of the window, the damping exactly: with f = M ē + c + s and ē the mean of e over the window,
 *
 *     e⁺ = e^−rT e + T φ1 f,    T ē = T φ1 e + T² φ2 f,
 *
 * which is linear in f. Where nothing is damped e⁺ is a Cayley rotation of e, for any angle.
 *
 * What M makes of a step's own error within that step is in it already, since it was measured. So from ē is taken what
 * the source makes within each step, h² φ2 s of one: on an axis whose damping is fast that is nearly all of ē. */
#include "estimate_parts.h"

/* e^−a, T φ1, T² φ2 of each axis over some time T. */
typedef struct decay_factors {
    vector stays, mean, second;
    real time_s;
} decay_factors;

static decay_factors of_one_step(const laconic_estimate *estimate, real step_s) {
    const decay_factors one = {vec(estimate->decay[0]), vec(estimate->decay[1]), vec(estimate->decay[2]), step_s};
    return one;
}

/* Over one time, then another: T φ1 = ∫₀ᵀ e^−rt dt, T² φ2 = ∫₀ᵀ ∫₀ᵗ e^−rs ds dt. */
static decay_factors after(const decay_factors *a, const decay_factors *b) {
    decay_factors both;
    both.stays = times(a->stays, b->stays);
    both.mean = plus(a->mean, times(a->stays, b->mean));
    both.second = plus(a->second, plus(scaled(b->time_s, a->mean), times(a->stays, b->second)));
    both.time_s = a->time_s + b->time_s;
    return both;
}

/* n steps, by squaring: no exponential, and no cancellation. */
static decay_factors over_steps(decay_factors power, int32_t steps) {
    decay_factors all = {{R(1), R(1), R(1)}, none, none, R(0)};
    for (; steps > 0; steps >>= 1) {
        if (steps & 1) all = after(&all, &power);
        power = after(&power, &power);
    }
    return all;
}

void laconic_carry_prepare(laconic_estimate *estimate, const laconic_model *model, real step_s) {
    laconic_decay one;
    laconic_decay_of(&one, model, step_s);
    for (int k = 0; k < 3; k++) {
        estimate->decay[0][k] = laconic_decaying_exponential(step_s * model->decay_per_s[k]);
        estimate->decay[1][k] = one.gain[k];
        estimate->decay[2][k] = step_s * one.gain[k] * one.mean[k];
    }
    const real g = laconic_root(square(vec(model->nu_of_zeta[2]))), w = laconic_root(square(vec(model->gyro)));
    estimate->angle_per_zeta[0] = g * w;
    estimate->angle_per_zeta[1] = laconic_root(square(vec(model->yaw_rate_of_zeta)));
}

static vector quotient(vector a, vector b) { return vector_of(a.x / b.x, a.y / b.y, a.z / b.z); }

/* M e at a velocity ζ. */
static vector gyroscopic_change(const laconic_model *m, vector zeta, vector e) {
    const vector g = vec(m->nu_of_zeta[2]), w = vec(m->gyro);
    return plus(scaled(dot(g, zeta), cross(e, w)), scaled(dot(g, e), cross(zeta, w)));
}

/* f of f − M diag(d) f = right, by Cramer's rule; `right` where that has no usable solution. */
static vector solve(const laconic_model *m, vector zeta, vector d, vector right) {
    const vector x = minus(vector_of(R(1), R(0), R(0)), gyroscopic_change(m, zeta, vector_of(d.x, R(0), R(0))));
    const vector y = minus(vector_of(R(0), R(1), R(0)), gyroscopic_change(m, zeta, vector_of(R(0), d.y, R(0))));
    const vector z = minus(vector_of(R(0), R(0), R(1)), gyroscopic_change(m, zeta, vector_of(R(0), R(0), d.z)));
    const vector across = cross(y, z);
    const real determinant = dot(x, across);
    if (!(magnitude(determinant) > R(0.05))) return right;
    return scaled(R(1) / determinant, vector_of(dot(right, across), dot(x, cross(right, z)), dot(x, cross(y, right))));
}

/* How b changes with the heading, times the error of it in the middle of the window. */
static vector turned_forcing(const laconic_estimate *estimate, const laconic_model *m, const state_error *error,
                             const decay_factors *over, const direction *heading) {
    const laconic_forcing *b = &estimate->forcing;
    if (!b->rotates) return none;
    const real yaw = dot(vec(m->yaw_rate_of_zeta), plus(error->travel, scaled(R(0.5), times(over->mean, error->zeta))));
    return scaled(yaw, minus(scaled(heading->cosine, vec(b->sine)), scaled(heading->sine, vec(b->cosine))));
}

/* Displacement in the world of a change of travel. */
static void in_world(real way_m[2], const laconic_model *m, const direction *heading, vector travel) {
    const real along = dot(vec(m->velocity_of_zeta[0]), travel), across = dot(vec(m->velocity_of_zeta[1]), travel);
    way_m[0] = heading->cosine * along - heading->sine * across;
    way_m[1] = heading->sine * along + heading->cosine * across;
}

/* A path that is turned by the error of the heading, less what the error of travel shifts and the step's own error. */
static void carry_place(state_error *error, const laconic_estimate *estimate, const laconic_model *m,
                        const window_motion *motion, real share, vector travel_after) {
    const vector yaw_rate = vec(m->yaw_rate_of_zeta), local = vec(&estimate->local[3]);
    const real yaw = R(0.5) * dot(yaw_rate, plus(error->travel, travel_after)), n = share * (real)motion->steps;
    const real own_yaw = R(0.5) * dot(yaw_rate, local);
    real shifted[2], own[2];
    in_world(shifted, m, &motion->heading, minus(travel_after, error->travel));
    in_world(own, m, &motion->heading, local);
    own[0] -= own_yaw * estimate->first_path_m[1];
    own[1] += own_yaw * estimate->first_path_m[0];
    error->place_m[0] += shifted[0] - yaw * motion->path_m[1] + n * (estimate->local[6] - own[0]);
    error->place_m[1] += shifted[1] + yaw * motion->path_m[0] + n * (estimate->local[7] - own[1]);
}

/* Rounding: ε of the velocity, which damping makes forget, and which constants that are rounded turn out of phase; ε of
 * the way and of the path. */
static void carry_floor(state_error *error, const laconic_estimate *estimate, const laconic_model *m,
                        const window_motion *motion, const decay_factors *over) {
    const real speed = R(0.5) * (size(motion->zeta[0]) + size(motion->zeta[1]));
    const real least = R(2) * LACONIC_EPSILON * speed;
    const real angle = estimate->angle_per_zeta[0] * speed * over->time_s;
    const real stays = over->stays.x > over->stays.y ? over->stays.x : over->stays.y;
    const real slowest = stays > over->stays.z ? stays : over->stays.z;
    const real velocity = size(vec(m->velocity_of_zeta[0])) + size(vec(m->velocity_of_zeta[1]));
    error->floor_zeta = slowest * error->floor_zeta + least * ((R(1) - slowest) + R(0.5) * angle);
    if (error->floor_zeta < least) error->floor_zeta = least;
    error->floor_travel += least * over->time_s + LACONIC_EPSILON * size(motion->way);
    error->floor_path_m += LACONIC_EPSILON * (magnitude(motion->path_m[0]) + magnitude(motion->path_m[1])) +
                           velocity * least * over->time_s;
}

/* E is known to some parts of a thousand of what it has changed: where it passes 0, the truth does so elsewhere. */
#define DOUBT R(0.002)

static vector share_of(vector change) {
    return scaled(DOUBT, vector_of(magnitude(change.x), magnitude(change.y), magnitude(change.z)));
}

static void carry_doubt(state_error *error, const state_error *before, vector stays) {
    const vector added_error = minus(error->zeta, times(stays, before->zeta)); /* damping alone leaves no doubt */
    const real dx = error->place_m[0] - before->place_m[0], dy = error->place_m[1] - before->place_m[1];
    error->doubt_zeta = plus(times(stays, error->doubt_zeta), share_of(added_error));
    error->doubt_travel = plus(error->doubt_travel, share_of(minus(error->travel, before->travel)));
    error->doubt_place_m += DOUBT * (magnitude(dx) + magnitude(dy));
}

/* A part of a window, in which each step makes a share of the error of the first. */
static void carry_part(state_error *error, const laconic_estimate *estimate, const laconic_model *m,
                       const window_motion *motion, real share) {
    const state_error start = *error;
    const decay_factors one = of_one_step(estimate, motion->step_s), over = over_steps(one, motion->steps);
    const vector zeta = scaled(R(0.5), plus(motion->zeta[0], motion->zeta[1])), before = error->zeta;
    const vector source = quotient(scaled(share, vec(&estimate->local[0])), one.mean); /* s */
    const real steps = (real)motion->steps, per_time = R(1) / over.time_s;
    /* T ē without what f makes of it */
    const vector carried = minus(times(over.mean, before), scaled(steps, times(one.second, source)));
    const vector right = plus(plus(source, turned_forcing(estimate, m, error, &over, &motion->heading)),
                              scaled(per_time, gyroscopic_change(m, zeta, carried)));
    const vector f = solve(m, zeta, scaled(per_time, over.second), right);
    const vector way = plus(carried, times(over.second, f));
    const vector travel_after = plus(error->travel, plus(way, scaled(steps * share, vec(&estimate->local[3]))));
    carry_place(error, estimate, m, motion, share, travel_after);
    carry_floor(error, estimate, m, motion, &over);
    error->zeta = plus(times(over.stays, before), times(over.mean, f));
    error->travel = travel_after;
    carry_doubt(error, &start, over.stays);
}

#define FADES R(0.7) /* less is left after as many steps as the last window had */

/* Where errors of steps fade, as after a change of the input, the window is carried in parts of half of the last one's
 * length, in each of which they fade by the root of what they did from there to here. */
void laconic_carry_error(state_error *error, const laconic_estimate *estimate, const laconic_model *m,
                         const window_motion *motion) {
    window_motion part = *motion;
    int32_t left = motion->steps;
    const bool fades = estimate->fading < FADES && left > 1 && estimate->last_length > 0;
    const int32_t length = !fades ? left : (estimate->last_length > 1 ? estimate->last_length / 2 : 1);
    const real by =
        fades ? laconic_root(estimate->last_length > 1 ? estimate->fading : estimate->fading * estimate->fading) : R(1);
    for (real share = R(1); left > 0; left -= part.steps, share *= by) {
        part.steps = left < length ? left : length;
        const real of_all = (real)part.steps / (real)motion->steps;
        part.path_m[0] = of_all * motion->path_m[0];
        part.path_m[1] = of_all * motion->path_m[1];
        part.way = scaled(of_all, motion->way);
        carry_part(error, estimate, m, &part, share);
    }
}
