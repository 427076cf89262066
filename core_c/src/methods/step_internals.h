/* What the methods share, in the order in which a step uses it: ζ and its rate, the forcing b, the increment and the
 * energy that it may gain, the next state; then base steps and their extrapolation, and preparation. All of it is
 * inlined into each method, so that vectors stay in registers. */
#ifndef LACONIC_STEP_INTERNALS_H
#define LACONIC_STEP_INTERNALS_H

#include "heading.h"
#include "polynomials.h"
#include "wrench.h"

/* ------------------------------------------------------------- ζ, and equation (4.7) in it -- */

/* Of |ζ|: beyond it squares would leave the range within a few steps. No vehicle is as fast. */
#ifdef LACONIC_SINGLE
#define LARGEST_SPEED R(1e9)
#else
#define LARGEST_SPEED R(1e77)
#endif

static inline vector zeta_of(const laconic_state *state) {
    const vector zeta = {state->zeta[0].value, state->zeta[1].value, state->zeta[2].value};
    return zeta;
}

/* Whether the axes of the model came from two rotations, and then row k of G⁺ = (GᵀG)⁻¹Gᵀ. */
static inline bool rotated_twice(const laconic_model *m) {
#if LACONIC_WITH_OWN_WHEELS
    return m->rotated_twice;
#else
    return (void)m, false;
#endif
}

static inline const real *inverse_row(const laconic_model *m, int k) {
#if LACONIC_WITH_OWN_WHEELS
    return m->zeta_of_nu[k];
#else
    return m->nu_of_zeta[k]; /* not reached */
#endif
}

/* ν → ζ = G⁺ν, the projection onto the allowed motions. Where G diagonalises A, G⁺ = diag(inertia) Gᵀ, as GᵀAG = E. */
static inline vector zeta_of_nu(const laconic_model *m, const real nu[3]) {
    if (rotated_twice(m))
        return vector_of(dot(vec(inverse_row(m, 0)), vec(nu)), dot(vec(inverse_row(m, 1)), vec(nu)),
                         dot(vec(inverse_row(m, 2)), vec(nu)));
    const vector first = scaled(nu[0], vec(m->nu_of_zeta[0])), second = scaled(nu[1], vec(m->nu_of_zeta[1]));
    return times(vec(m->inertia), plus(plus(first, second), scaled(nu[2], vec(m->nu_of_zeta[2]))));
}

static inline void set_zeta(laconic_state *state, vector zeta) {
    state->zeta[0] = sum_of(zeta.x);
    state->zeta[1] = sum_of(zeta.y);
    state->zeta[2] = sum_of(zeta.z);
}

/* diag(r)ζ, by which the motors' damping lessens ζ'. */
static inline vector damping(const laconic_model *m, vector z) {
    return LACONIC_WITH_DAMPING ? times(vec(m->decay_per_s), z) : none;
}

/* ζ' = (g·ζ)(ζ×w) − diag(r)ζ + b: equation (4.7) in the coordinates of laconic_model. */
INLINE vector zeta_rate(const laconic_model *m, vector z, vector b) {
    const vector gyroscopic = scaled(dot(vec(m->nu_of_zeta[2]), z), cross(z, vec(m->gyro)));
    return plus(minus(gyroscopic, damping(m, z)), b);
}

/* |g·ζ| is beyond the gyroscopic limit of an explicit method. */
static inline mask beyond_rotation(const laconic_model *m, const laconic_integrator *integrator, vector zeta) {
    return magnitude(dot(vec(m->nu_of_zeta[2]), zeta)) > integrator->gyro_limit;
}

/* ----------------------------------------------------------------- forcing: input → b -- */

/* 0 in a build without any input: b = 0. */
#define LACONIC_WITH_FORCING \
    (LACONIC_WITH_VOLTAGE || LACONIC_WITH_AXLE_TORQUE || LACONIC_WITH_BODY_WRENCH || LACONIC_WITH_WORLD_FORCE)

/* GᵀΞᵀ(c1_i U_i + T_i)/(M R²), since the power of a wheel's torque is torque · χ'. */
static inline vector b_of_torques(const laconic_model *m, const laconic_input *in) {
    vector b = none;
    for (int32_t i = 0; i < LACONIC_WHEELS(m); i++) {
        const real motor = LACONIC_WITH_VOLTAGE ? m->voltage_scale[own(i)] * in->voltage_V[i] : R(0);
        const real torque = LACONIC_WITH_AXLE_TORQUE ? motor + m->torque_scale * in->axle_torque_Nm[i] : motor;
        b = plus(b, scaled(torque, vec(m->wheel_of_zeta[i])));
    }
    return b;
}

/* A world force F at the body point r: F_ξ = c F_X + s F_Y, F_η = −s F_X + c F_Y, τ = r_ξ F_η − r_η F_ξ. */
static inline void add_world_force(laconic_forcing *forcing, const laconic_model *m, const laconic_input *in) {
    const real fx = m->torque_scale * in->world_force_N[0], fy = m->torque_scale * in->world_force_N[1];
    const real *r = in->world_force_point_m;
    const vector yaw = vec(m->yaw_rate_of_zeta);
    const vector along = minus(vec(m->velocity_of_zeta[0]), scaled(r[1], yaw));
    const vector across = plus(vec(m->velocity_of_zeta[1]), scaled(r[0], yaw));
    store(forcing->cosine, plus(scaled(fx, along), scaled(fy, across)));
    store(forcing->sine, minus(scaled(fy, along), scaled(fx, across)));
}

static inline bool sloped(const laconic_model *m) {
#if LACONIC_WITH_SLOPE
    return m->sloped;
#else
    return (void)m, false;
#endif
}

/* The slope's pull at S, as a world force. */
static inline void add_slope(laconic_forcing *forcing, const laconic_model *m) {
    const real fx = m->torque_scale * slope_force(m)[0], fy = m->torque_scale * slope_force(m)[1];
    const vector along = vec(m->velocity_of_zeta[0]), across = vec(m->velocity_of_zeta[1]);
    store(forcing->cosine, plus(vec(forcing->cosine), plus(scaled(fx, along), scaled(fy, across))));
    store(forcing->sine, plus(vec(forcing->sine), minus(scaled(fy, along), scaled(fx, across))));
}

/* An input of 0 costs no operations. NaN counts as acting, so that the step is refused. */
static inline mask acts(real a, real b, real c) { return NOT(AND(AND(a == R(0), b == R(0)), c == R(0))); }

/* A step does not use the point of a force of 0, but that must be finite, too. NaN or infinity where it is not. */
static inline real world_force_point(const laconic_input *input) {
    return LACONIC_WITH_WORLD_FORCE ? input->world_force_point_m[0] + input->world_force_point_m[1] : R(0);
}

static inline void forcing_of(laconic_forcing *forcing, const laconic_model *model, const laconic_input *input) {
    vector b = none;
    if (LACONIC_WITH_VOLTAGE || LACONIC_WITH_AXLE_TORQUE) b = b_of_torques(model, input);
    if (LACONIC_WITH_BODY_WRENCH && ANY(acts(input->body_force_N[0], input->body_force_N[1], input->body_moment_Nm)))
        b = SELECT(acts(input->body_force_N[0], input->body_force_N[1], input->body_moment_Nm),
                   plus(b, b_of_wrench(model, wrench_with(input->body_force_N[0], input->body_force_N[1],
                                                          input->body_moment_Nm))),
                   b);
    store(forcing->constant, b);
    forcing->rotates = LACONIC_WITH_WORLD_FORCE &&
                       (ANY(acts(input->world_force_N[0], input->world_force_N[1], R(0))) || sloped(model));
    if (LACONIC_WITH_WORLD_FORCE && forcing->rotates) add_world_force(forcing, model, input);
    if (LACONIC_WITH_WORLD_FORCE && sloped(model)) add_slope(forcing, model);
}

/* b of a forcing that rotates with the heading. */
static inline vector forcing_at(const laconic_forcing *forcing, direction heading) {
    return plus(vec(forcing->constant),
                plus(scaled(heading.cosine, vec(forcing->cosine)), scaled(heading.sine, vec(forcing->sine))));
}

/* The same at the heading of a state after a further yaw. */
vector laconic_forcing_after_yaw(const laconic_forcing *forcing, const laconic_heading *heading, real yaw_change_rad);

/* b of any forcing; the heading is used only where the forcing rotates. */
INLINE vector forcing_after_yaw(const laconic_forcing *forcing, const laconic_heading *heading, real yaw_change_rad) {
    if (LACONIC_WITH_WORLD_FORCE && forcing->rotates)
        return laconic_forcing_after_yaw(forcing, heading, yaw_change_rad);
    return vec(forcing->constant);
}

/* A build in which b never varies keeps only base steps of the code below. */
#define ONLY_CONSTANT (!LACONIC_WITH_WORLD_FORCE && !LACONIC_WITH_SAMPLED_INPUT)

static inline bool constant_over(const laconic_forcing_samples *samples) {
    return ONLY_CONSTANT || samples->is_constant;
}

/* ---------------------------------------------------- what a method finds out about a step -- */

/* The result of a method for one step. */
typedef struct increment {
    vector delta; /* ζ(t+h) − ζ(t)                                                            */
    vector mean;  /* mean of ζ over the step                                                  */
    vector slope; /* 12/h² times the first moment of ζ about the middle of the step: delta
                     where ζ changes linearly, 0 where it jumps at the start                  */
} increment;

/* 2⁻¹⁰, relative to |ζ|² + |ζ⁺|². Of 850 free steps of the two Kahan methods none with an error below 1e-3 of |ζ|
 * gained as much, while those whose error exceeds |ζ| nearly all did: steps that are refused are inaccurate. */
#define ENERGY_TOLERANCE R(0.0009765625)

/* Decides as `passive`, with b as it varies over the step. */
mask laconic_growth_is_forced(const laconic_model *model, const laconic_state *state, real step_s,
                              const laconic_forcing_samples *samples, const increment *by);

/* Does a step gain no more energy than the forcing supplies? Exactly, |ζ⁺|² − |ζ|² = 2∫(b·ζ − ζ·diag(r)ζ)dt <= 2∫ b·ζ
 * dt. Tested first with b at the start. False for NaN, and in free motion for infinity. */
INLINE mask passive(const laconic_model *model, const laconic_state *state, real step_s,
                    const laconic_forcing_samples *samples, vector zeta, increment by) {
    const real before = square(zeta), after = square(plus(zeta, by.delta));
    const real excess = (R(1) - ENERGY_TOLERANCE) * after - (R(1) + ENERGY_TOLERANCE) * before;
    const mask calm = excess <= R(0);
    if (ALL(calm)) return MASK_OF(true, calm);
    const mask driven = OR(calm, excess <= R(2) * step_s * dot(vec(samples->start->constant), by.mean));
    if (ALL(driven)) return MASK_OF(true, driven);
    if (constant_over(samples)) return MASK_OF(false, driven);
    const increment copy = by; /* by itself has no address and stays in registers */
    return OR(driven, laconic_growth_is_forced(model, state, step_s, samples, &copy));
}

/* Of |ζ|²: as much as roundings add in a step at most. In double 10⁵ steps of it are 4e-10. */
#define ENERGY_ROUNDING (R(16) * LACONIC_EPSILON)

/* Decides as `keeps_energy`, with b as it varies over the step, and cuts the increment where that is needed. */
bool laconic_energy_kept(const laconic_model *model, const laconic_state *state, real step_s,
                         const laconic_forcing_samples *samples, increment *by);

INLINE bool energy_kept(const laconic_model *model, const laconic_state *state, real step_s,
                        const laconic_forcing_samples *samples, increment *by) {
    increment copy = *by; /* by itself has no address and stays in registers */
    const bool kept = laconic_energy_kept(model, state, step_s, samples, &copy);
    by->delta = copy.delta;
    return kept;
}

/* Decides as `passive`, for methods whose steps must not add up to a gain over a run: what a step gains beyond rounding
 * and beyond what the forcing can supply is cut from the increment. */
INLINE mask keeps_energy(const laconic_model *model, const laconic_state *state, real step_s,
                         const laconic_forcing_samples *samples, vector zeta, increment *by) {
    const real before = square(zeta), after = square(plus(zeta, by->delta));
    const mask calm = after <= (R(1) + ENERGY_ROUNDING) * before;
    if (ALL(calm)) return MASK_OF(true, calm);
    const real power = dot(vec(samples->start->constant), by->mean);
    const mask driven = OR(calm, after - before <= R(2) * (R(1) + ENERGY_TOLERANCE) * step_s * power);
    const bool kept = ALL(driven) || !ALONE || energy_kept(model, state, step_s, samples, by);
    return kept ? MASK_OF(true, driven) : MASK_OF(false, driven);
}

/* The status of a step that is not passive. */
static inline laconic_status not_passive(increment by) {
    return ALL(is_finite(size(by.delta))) ? LACONIC_STEP_GAINS_ENERGY : LACONIC_STEP_SINGULAR;
}

/* ---------------------------------------------------------------------- the next state -- */

typedef struct pose_change { /* over one step */
    real along_m, across_m;  /* displacement along and across the heading half-way between start and end */
    real yaw_change_rad;
} pose_change;

/* sinc α and ½ j₁(α), with α half the yaw of the step. */
INLINE void chord_factors(real *sinc, real *half_j1, real alpha) {
    real z = alpha * alpha;
    if (LIKELY(z <= CHORD_SMALL, &z)) {
        *sinc = poly_sinc(z);
        *half_j1 = R(0.5) * alpha * poly_j1(z);
    } else {
        const direction d = direction_of_binary_angle(laconic_binary_angle_of(alpha));
        *sinc = d.sine / alpha;
        *half_j1 = R(0.5) * (*sinc - d.cosine) / alpha;
    }
}

/* Pose is a quadrature of ζ. Mean and first moment of ζ over the step, which every method delivers at its own
 * order, fix it to fourth order with a single sine and cosine, as complex numbers in body axes:
 * ∫ e^{iθ} v dt = e^{iθ_mid} { sinc α · h v̄ + i [½ j₁(α) h Δv − (h Δω/12) h v̄] }
 * Both products of a row stand together, so that its numbers need registers once. */
INLINE pose_change displacement(const laconic_model *m, vector path, vector bend) {
    const vector along = vec(m->velocity_of_zeta[0]), across = vec(m->velocity_of_zeta[1]);
    const vector yaw_rate = vec(m->yaw_rate_of_zeta);
    const real yaw_change = dot(yaw_rate, path), yaw_bend = dot(yaw_rate, bend) * (R(1) / R(12));
    const real forth = dot(along, path), forth_bend = dot(along, bend);
    const real left = dot(across, path), left_bend = dot(across, bend);
    real sinc, half_j1;
    chord_factors(&sinc, &half_j1, R(0.5) * yaw_change);
    const real aside_forth = half_j1 * forth_bend - yaw_bend * forth;
    const real aside_left = half_j1 * left_bend - yaw_bend * left;
    const pose_change moved = {sinc * forth - aside_left, sinc * left + aside_forth, yaw_change};
    return moved;
}

INLINE void advance_pose(laconic_state *s, pose_change moved) {
    const direction middle = direction_of_binary_angle(heading_advance(&s->heading, moved.yaw_change_rad));
    sum_add(&s->x_m, middle.cosine * moved.along_m - middle.sine * moved.across_m);
    sum_add(&s->y_m, middle.sine * moved.along_m + middle.cosine * moved.across_m);
}

INLINE void add_to_sums(laconic_sum sums[3], vector v) {
    sum_add(&sums[0], v.x);
    sum_add(&sums[1], v.y);
    sum_add(&sums[2], v.z);
}

/* A component of ζ far below AT_REST becomes 0 when AT_REST is added and subtracted. Otherwise a decaying motion would
 * end in subnormal numbers, with which many processors are slow; the square of AT_REST is still a normal number.
 * The three sums come by a bare pointer: of an array of three gcc would warn under sanitizers (-Wstringop-overflow), by
 * which it forgets that the address of a member is also that of the array. */
#ifdef LACONIC_SINGLE
#define AT_REST R(1e-18)
#else
#define AT_REST R(1e-150)
#endif

static inline void flush_decayed(laconic_sum *sums) {
    sums[0].value = (sums[0].value + AT_REST) - AT_REST;
    sums[1].value = (sums[1].value + AT_REST) - AT_REST;
    sums[2].value = (sums[2].value + AT_REST) - AT_REST;
}

/* Precondition of all that follows in a step: as model and step are bounded, it is then finite. */
static inline mask in_range(vector zeta, vector delta) {
    return square(zeta) + square(plus(zeta, delta)) <= LARGEST_SPEED * LARGEST_SPEED;
}

/* Takes the step, or refuses and leaves the state as it was. */
INLINE laconic_status accept_step(laconic_state *state, vector delta, vector path, pose_change moved) {
    if (!LIKELY(magnitude(moved.yaw_change_rad) + magnitude(moved.along_m) + magnitude(moved.across_m) <
                    LARGEST_YAW_CHANGE_RAD,
                &moved.along_m))
        return LACONIC_OVERFLOW;
    add_to_sums(state->zeta, delta);
    flush_decayed(state->zeta);
    if (LACONIC_WITH_WHEEL_ANGLES) add_to_sums(state->travel, path);
    if (LACONIC_WITH_POSE) advance_pose(state, moved);
    return LACONIC_OK;
}

INLINE laconic_status advance(laconic_state *state, const laconic_model *model, real step_s, vector zeta,
                              increment by) {
    vector path = scaled(step_s, by.mean);
    pose_change moved = {R(0), R(0), R(0)};
    if (!LIKELY(in_range(zeta, by.delta), &path.x)) return LACONIC_OVERFLOW;
    if (LACONIC_WITH_POSE) moved = displacement(model, path, scaled(step_s, by.slope));
    return END_STEP(state, by.delta, path, moved);
}

/* For methods whose increment may gain energy or not be finite: such a step is refused. */
INLINE laconic_status advance_if_passive(laconic_state *state, const laconic_model *model, real step_s,
                                         const laconic_forcing_samples *samples, vector zeta, increment by) {
    if (!LIKELY(passive(model, state, step_s, samples, zeta, by), &by.mean.x)) return not_passive(by);
    return advance(state, model, step_s, zeta, by);
}

/* Roundings lean one way while a motion turns steadily. In single precision they would add up to 4e-3 of its energy in
 * 10⁵ steps, so that a step without forcing ends with the energy that it has to have, to a part of a rounding. Steps
 * that yaw by less than this lean too little for that: ζ turns by no more than the body. */
#ifdef LACONIC_SINGLE
#define LEVELS_ENERGY true
#else
#define LEVELS_ENERGY false
#endif
#define LEVELLED_FROM_RAD R(0.0625)

static inline mask acts_not(const laconic_forcing *forcing) {
    return NOT(acts(forcing->constant[0], forcing->constant[1], forcing->constant[2]));
}

static inline mask unforced(const laconic_forcing_samples *samples) {
    const laconic_forcing *middle = samples->middle, *end = samples->end;
    if (constant_over(samples)) return acts_not(samples->start);
    if (samples->start->rotates || middle->rotates || end->rotates) return NOT(R(0) == R(0));
    return AND(acts_not(samples->start), AND(acts_not(middle), acts_not(end)));
}

/* Takes the step as accept_step does and levels its energy if no forcing acts. */
laconic_status laconic_accept_levelled(laconic_state *state, const laconic_model *model, real step_s,
                                       const laconic_forcing_samples *samples, const increment *by,
                                       const pose_change *moved);

INLINE laconic_status end_levelled(laconic_state *state, const laconic_model *model, real step_s,
                                   const laconic_forcing_samples *samples, increment by, pose_change moved) {
    const vector path = scaled(step_s, by.mean);
    const real yaw_rad = LACONIC_WITH_POSE ? moved.yaw_change_rad : dot(vec(model->yaw_rate_of_zeta), path);
    const mask turns = magnitude(yaw_rad) > LEVELLED_FROM_RAD;
    if (LEVELS_ENERGY && ANY(turns) && (ALONE || UNLIKELY(AND(turns, unforced(samples)), &moved.along_m))) {
        const increment copy = by;
        const pose_change by_pose = moved;
        return laconic_accept_levelled(state, model, step_s, samples, &copy, &by_pose);
    }
    return END_STEP(state, by.delta, path, moved);
}

/* `advance` for methods whose steps must not add up to a gain over a run. */
INLINE laconic_status advance_levelled(laconic_state *state, const laconic_model *model, real step_s,
                                       const laconic_forcing_samples *samples, vector zeta, increment by) {
    const vector path = scaled(step_s, by.mean);
    pose_change moved = {R(0), R(0), R(0)};
    if (!LIKELY(in_range(zeta, by.delta), &by.mean.x)) return LACONIC_OVERFLOW;
    if (LACONIC_WITH_POSE) moved = displacement(model, path, scaled(step_s, by.slope));
    return end_levelled(state, model, step_s, samples, by, moved);
}

INLINE laconic_status advance_with_energy(laconic_state *state, const laconic_model *model, real step_s,
                                          const laconic_forcing_samples *samples, vector zeta, increment by) {
    if (!LIKELY(keeps_energy(model, state, step_s, samples, zeta, &by), &by.mean.x)) return not_passive(by);
    return advance_levelled(state, model, step_s, samples, zeta, by);
}

/* -------------------------------------------- symmetric base steps and their extrapolation -- */

/* b over one base step: start + change·s + curve·s(s − 1), s from 0 to 1. */
typedef struct parabola {
    vector start, change, curve;
    bool varies; /* false: change and curve are 0 and not set */
} parabola;

/* A second-order symmetric step of size step_s/2^level from ζ under b. */
typedef increment (*base_step)(const laconic_model *model, const laconic_integrator *integrator, int level, vector zeta,
                               const parabola *b);

/* What change and curve of b add, with the factors `ramp` and `bend` of laconic_decay. */
static inline vector response(const real ramp[3], const real bend[3], const parabola *b) {
    return plus(times(vec(ramp), b->change), times(vec(bend), b->curve));
}

/* The constant b that leads to the same ζ at the end. */
INLINE vector equivalent_constant(const parabola *b, const laconic_decay *d) {
    return b->varies ? plus(b->start, response(d->mean, d->bend, b)) : b->start;
}

/* Mean and first moment of ζ over the step from its increment: exact for damping and forcing alone, and symmetric, so
 * that the mean gains two orders by extrapolation as the increment does. */
INLINE increment increment_of(const laconic_decay *d, vector zeta, vector delta, const parabola *b) {
    increment by;
    by.delta = delta;
    by.mean = plus(zeta, times(vec(d->mean), delta));
    by.slope = times(vec(d->slope), delta);
    if (b->varies) {
        by.mean = plus(by.mean, response(d->mean_ramp, d->mean_bend, b));
        by.slope = plus(by.slope, response(d->slope_ramp, d->slope_bend, b));
    }
    return by;
}

/* (4 · two half steps − one full step)/3: the base's error has only even powers of h, so this is of fourth order. The
 * slope is not extrapolated, the pose needs it at second order alone; that of two halves together is 3/2 of the
 * difference of their means, plus a quarter of the slope of each. */
INLINE increment combine(increment whole, increment first, increment second) {
    const real third = R(1) / R(3);
    const vector delta = plus(first.delta, second.delta);
    const vector mean = scaled(R(0.5), plus(first.mean, second.mean));
    increment by;
    by.delta = plus(delta, scaled(third, minus(delta, whole.delta)));
    by.mean = plus(mean, scaled(third, minus(mean, whole.mean)));
    by.slope = plus(scaled(R(1.5), minus(second.mean, first.mean)), scaled(R(0.25), plus(first.slope, second.slope)));
    return by;
}

/* ------------------------------------------------------------------------- b held ------- */

static inline parabola held(const laconic_forcing_samples *samples) {
    const parabola b = {vec(samples->start->constant), none, none, false};
    return b;
}

/* The base step itself as a method. */
INLINE increment base_alone(base_step base, const laconic_model *m, const laconic_integrator *integrator, vector zeta,
                            const laconic_forcing_samples *samples) {
    const parabola b = held(samples);
    return base(m, integrator, 0, zeta, &b);
}

/* Written out, so that compilers compute common parts of the whole step and its first half once. */
INLINE increment extrapolated(base_step base, const laconic_model *m, const laconic_integrator *integrator, vector zeta,
                              const laconic_forcing_samples *samples) {
    const parabola b = held(samples);
    const increment whole = base(m, integrator, 0, zeta, &b), first = base(m, integrator, 1, zeta, &b);
    return combine(whole, first, base(m, integrator, 1, plus(zeta, first.delta), &b));
}

/* ------------------------------------------------------------------------- b varies ----- */

/* A base step within a step: its size, its start and its forcing. */
typedef struct substep {
    int level;
    vector zeta;
    real yaw_change_rad; /* since the step's start, for forces fixed in the world */
    const laconic_forcing *start, *end;
} substep;

/* 2 (b₀ + b₁ − 2 b½): the parabola through three samples; the curve of its half is a quarter. Without forces
 * fixed in the world: their b is computed from the heading. */
INLINE vector curve_of(const laconic_forcing_samples *samples, int level) {
    const vector ends = plus(vec(samples->start->constant), vec(samples->end->constant));
    return scaled(level == 0 ? R(2) : R(0.5), minus(ends, scaled(R(2), vec(samples->middle->constant))));
}

/* b over a substep, as far as it does not depend on the heading at the end. */
INLINE parabola parabola_of(const laconic_heading *heading, const laconic_forcing_samples *samples, const substep *p) {
    parabola b;
    b.varies = true;
    b.start = forcing_after_yaw(p->start, heading, p->yaw_change_rad);
    b.change = minus(vec(p->end->constant), b.start);
    b.curve = curve_of(samples, p->level);
    return b;
}

/* One base step; zeta and yaw_change_rad move on to its end. A force fixed in the world makes b depend on the heading
 * there, which is a result of the step: hence the iteration. Three rounds leave an error of h⁷, so the step is
 * symmetric as far as extrapolation needs it. */
INLINE increment take_substep(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                              const laconic_heading *heading, const laconic_forcing_samples *samples, substep *p) {
    const bool rotates = LACONIC_WITH_WORLD_FORCE && (p->start->rotates || p->end->rotates);
    const real h = integrator->step_s * (p->level == 0 ? R(1) : R(0.5)), before = p->yaw_change_rad;
    parabola b = parabola_of(heading, samples, p);
    increment by;
    int rounds = rotates ? 3 : 1;
    p->yaw_change_rad = before + h * dot(vec(m->yaw_rate_of_zeta), p->zeta);
    do {
        if (rotates) b.change = minus(forcing_after_yaw(p->end, heading, p->yaw_change_rad), b.start);
        by = base(m, integrator, p->level, p->zeta, &b);
        p->yaw_change_rad = before + h * dot(vec(m->yaw_rate_of_zeta), by.mean);
    } while (--rounds > 0);
    p->zeta = plus(p->zeta, by.delta);
    return by;
}

/* The base step itself as a method. */
INLINE increment base_alone_varying(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                                    const laconic_state *state, const laconic_forcing_samples *samples) {
    substep whole = {0, zeta_of(state), R(0), samples->start, samples->end};
    return take_substep(base, m, integrator, &state->heading, samples, &whole);
}

/* A loop, so that the base step is inlined once: the whole step, then the two halves, from the same start. */
INLINE increment extrapolated_varying(base_step base, const laconic_model *m, const laconic_integrator *integrator,
                                      const laconic_state *state, const laconic_forcing_samples *samples) {
    increment parts[3];
    substep p = {0, zeta_of(state), R(0), samples->start, samples->end};
    for (int i = 0; i < 3; i++) {
        parts[i] = take_substep(base, m, integrator, &state->heading, samples, &p);
        if (i == 0) {
            const substep half = {1, zeta_of(state), R(0), samples->start, samples->middle};
            p = half;
        } else {
            p.start = samples->middle;
            p.end = samples->end;
        }
    }
    return combine(parts[0], parts[1], parts[2]);
}

/* ------------------------------------------------------- when a method is prepared -- */

/* A build whose integrator is a prepared constant leaves preparation out. */
#define PREPARE(function) (LACONIC_WITH_PREPARE ? (function) : NULL)

#define SMALLEST_STEP_S (R(8) * LACONIC_REAL_MIN) /* 1/(a quarter of it) is finite */
#define LARGEST_STEP_S R(1e9)                     /* beyond it products with speeds would leave the range */

/* max r_k */
real laconic_fastest_decay(const laconic_model *model);

/* Sets the gyroscopic limit of an explicit method, and refuses a step beyond its damping limit. `largest_damping` and
 * `largest_rotation`: the ends of its stability interval on the real and on the imaginary axis. */
laconic_status laconic_explicit_limits(laconic_integrator *integrator, const laconic_model *model, real largest_damping,
                                       real largest_rotation, laconic_refusal *why);

/* Factors of an exponential step of size h: decay[level] for h = step_s / 2^level. */
void laconic_decay_of(laconic_decay *decay, const laconic_model *model, real h);

/* Fills decay[0] … decay[levels − 1] of an integrator. */
void laconic_decay_levels(laconic_integrator *integrator, const laconic_model *model, int levels);

#endif
