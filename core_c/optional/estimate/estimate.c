/* Error estimate: windows of steps, in each the error of the first step by two half steps; and the twin of a plant with
 * friction. linear_motion.c carries the error from window to window. */
#include "estimate_parts.h"
#include "exponential_gauss_8.h"

/* ----------------------------------------------------------------------------------- starting -- */

const laconic_method *laconic_finer_method(const laconic_plant *plant) {
#if LACONIC_WITH_EXPONENTIAL_GAUSS
    if (plant->integrator.stiff) return &laconic_exponential_gauss_8;
#endif
    return plant->integrator.method;
}

laconic_status laconic_estimate_start(laconic_estimate *estimate, const laconic_plant *plant, int32_t most_steps,
                                      const laconic_method *finer, laconic_refusal *why) {
    laconic_estimate fresh = ALL_ZERO;
    const real h = plant->integrator.step_s;
    if (most_steps < 1) return refuse(why, LACONIC_NOT_POSITIVE, LACONIC_FIELD_NONE, 0, (real)most_steps, R(0));
    if (most_steps > LACONIC_ESTIMATE_MOST)
        return refuse(why, LACONIC_ABOVE_LIMIT, LACONIC_FIELD_NONE, 0, (real)most_steps, R(LACONIC_ESTIMATE_MOST));
    laconic_status status =
        laconic_integrator_prepare(&fresh.halves, plant->integrator.method, &plant->model, R(0.5) * h, why);
    if (status == LACONIC_OK)
        status = laconic_integrator_prepare(&fresh.finer, finer != NULL ? finer : plant->integrator.method,
                                            &plant->model, R(0.5) * h, why);
    if (status != LACONIC_OK) return status;
#if LACONIC_WITH_EXPONENTIAL_GAUSS
    laconic_halve_panels(&fresh.halves, &plant->model);
    laconic_halve_panels(&fresh.finer, &plant->model);
#endif
    fresh.most_steps = most_steps;
    laconic_carry_prepare(&fresh, &plant->model, h);
    fresh.start = fresh.twin = plant->state;
    fresh.origin_m[0] = plant->state.x_m.value;
    fresh.origin_m[1] = plant->state.y_m.value;
#if LACONIC_WITH_FRICTION
    if (has_friction(plant)) fresh.twin_slip = plant->slip;
#endif
    *estimate = fresh;
    return LACONIC_OK;
}

/* ------------------------------------------------------------------------------ the half steps -- */

/* Numbers of an input, all of which are of the scalar type. */
#define INPUT_NUMBERS ((uint32_t)(sizeof(laconic_input) / sizeof(real)))

static const real *numbers_of(const laconic_input *input) { return number_at(input, 0); }

static bool same_input(const laconic_input *a, const laconic_input *b) {
    for (uint32_t k = 0; k < INPUT_NUMBERS; k++)
        if (numbers_of(a)[k] != numbers_of(b)[k]) return false;
    return true;
}

/* The parabola through three samples at `share` of the step. */
static void sample_at(laconic_input *at, const laconic_input samples[3], real share) {
    const real first = R(2) * (share - R(0.5)) * (share - R(1)), middle = R(4) * share * (R(1) - share),
               last = R(2) * share * (share - R(0.5));
    real *out = (real *)(void *)at;
    for (uint32_t k = 0; k < INPUT_NUMBERS; k++)
        out[k] = first * numbers_of(&samples[0])[k] + middle * numbers_of(&samples[1])[k] +
                 last * numbers_of(&samples[2])[k];
}

/* One step of the plant in equal parts. */
static laconic_status take_parts(laconic_state *twin, const laconic_model *model, const laconic_integrator *part,
                                 const laconic_input *inputs, int32_t count, int32_t parts) {
    laconic_input at[3];
    laconic_status status = LACONIC_OK;
    if (count == 1) {
        laconic_run(model, part, twin, &inputs[0], (uint64_t)parts, &status);
        return status;
    }
    for (int32_t j = 0; j < parts && status == LACONIC_OK; j++) {
        for (int32_t k = 0; k < 3; k++) sample_at(&at[k], inputs, (real)(2 * j + k) / (real)(2 * parts));
        status = laconic_step_sampled(model, part, twin, &at[0], &at[1], &at[2]);
    }
    return status;
}

#define MOST_PARTS 64

/* By the finer method in so many more parts that it takes them: it refuses those that yaw too far. */
static bool take_shorter_parts(laconic_estimate *estimate, const laconic_plant *plant, const laconic_input *inputs,
                               int32_t count) {
    laconic_integrator part;
    for (int32_t parts = 4; parts <= MOST_PARTS; parts *= 2) {
        if (laconic_integrator_prepare(&part, estimate->finer.method, &plant->model,
                                       plant->integrator.step_s / (real)parts, NULL) != LACONIC_OK)
            return false;
        estimate->twin = plant->state;
        if (take_parts(&estimate->twin, &plant->model, &part, inputs, count, parts) == LACONIC_OK) return true;
    }
    return false;
}

static bool take_two(laconic_estimate *estimate, const laconic_plant *plant, const laconic_integrator *half,
                     const laconic_input *inputs, int32_t count) {
    estimate->twin = plant->state;
    return take_parts(&estimate->twin, &plant->model, half, inputs, count, 2) == LACONIC_OK;
}

/* By the finer method; where that refuses all parts, two by the plant's own; where that does, too, there are none. */
static bool take_half_steps(laconic_estimate *estimate, const laconic_plant *plant, const laconic_input *inputs,
                            int32_t count) {
    if (take_two(estimate, plant, &estimate->finer, inputs, count)) return true;
    if (estimate->finer.method != plant->integrator.method && take_shorter_parts(estimate, plant, inputs, count))
        return true;
    if (take_two(estimate, plant, &estimate->halves, inputs, count)) return true;
    estimate->twin = plant->state;
    return false;
}

/* A plant with friction: with three samples a step holds the middle one. */
static laconic_status twin_steps(laconic_estimate *estimate, const laconic_plant *plant, const laconic_input *held) {
#if LACONIC_WITH_FRICTION
    laconic_state state = estimate->twin;
    laconic_slip slip = estimate->twin_slip;
    laconic_status status = LACONIC_OK;
    for (int k = 0; k < 2 && status == LACONIC_OK; k++)
        status = laconic_friction_step(&plant->friction, &plant->model, estimate->halves.step_s, &state, &slip, held);
    if (status != LACONIC_OK) return status;
    estimate->twin = state;
    estimate->twin_slip = slip;
#else
    (void)estimate, (void)plant, (void)held;
#endif
    return LACONIC_OK;
}

/* ------------------------------------------------------------------------- errors of the state -- */

static real difference(laconic_sum a, laconic_sum b) { return (a.value - b.value) + (a.rest - b.rest); }

static vector differences(const laconic_sum a[3], const laconic_sum b[3]) {
    return vector_of(difference(a[0], b[0]), difference(a[1], b[1]), difference(a[2], b[2]));
}

/* The error of the window's first step: what plant and half steps differ by. Where there were none, all that the step
 * has changed. */
static void measure_step(laconic_estimate *estimate, const laconic_plant *plant) {
    const laconic_state *now = &plant->state, *fine = &estimate->twin, *start = &estimate->start;
    estimate->first_path_m[0] = difference(now->x_m, start->x_m);
    estimate->first_path_m[1] = difference(now->y_m, start->y_m);
    const real before = size(vec(estimate->local)), here = size(differences(now->zeta, fine->zeta));
    estimate->fading = here < before ? here / before : R(1);
    store(&estimate->local[0], differences(now->zeta, fine->zeta));
    store(&estimate->local[3], differences(now->travel, fine->travel));
    estimate->local[6] = difference(now->x_m, fine->x_m);
    estimate->local[7] = difference(now->y_m, fine->y_m);
}

static state_error error_at_start(const laconic_estimate *estimate) {
    state_error error;
    error.zeta = vec(estimate->zeta);
    error.travel = vec(estimate->travel);
    for (int k = 0; k < 2; k++) error.place_m[k] = estimate->place_m[k];
    error.floor_zeta = estimate->floor_zeta;
    error.floor_travel = estimate->floor_travel;
    error.floor_path_m = estimate->floor_path_m;
    error.doubt_zeta = vec(estimate->doubt_zeta);
    error.doubt_travel = vec(estimate->doubt_travel);
    error.doubt_place_m = estimate->doubt_place_m;
    return error;
}

void laconic_estimate_keep_error(laconic_estimate *estimate, const state_error *error) {
    store(estimate->zeta, error->zeta);
    store(estimate->travel, error->travel);
    for (int k = 0; k < 2; k++) estimate->place_m[k] = error->place_m[k];
    estimate->floor_zeta = error->floor_zeta;
    estimate->floor_travel = error->floor_travel;
    estimate->floor_path_m = error->floor_path_m;
    store(estimate->doubt_zeta, error->doubt_zeta);
    store(estimate->doubt_travel, error->doubt_travel);
    estimate->doubt_place_m = error->doubt_place_m;
}

/* The error at the moment of the plant, as far as the window has come. */
state_error laconic_estimate_error_now(const laconic_estimate *estimate, const laconic_plant *plant) {
    state_error error = error_at_start(estimate);
    const laconic_state *now = &plant->state, *start = &estimate->start;
    window_motion motion;
    if (estimate->taken == 0) return error;
    motion.steps = estimate->taken;
    motion.step_s = plant->integrator.step_s;
    motion.zeta[0] = zeta_of(start);
    motion.zeta[1] = zeta_of(now);
    motion.way = differences(now->travel, start->travel);
    motion.path_m[0] = difference(now->x_m, start->x_m);
    motion.path_m[1] = difference(now->y_m, start->y_m);
    const real half_yaw = R(0.5) * dot(vec(plant->model.yaw_rate_of_zeta), motion.way);
    motion.heading = laconic_direction_of_binary_angle(
        (laconic_binary_angle)(start->heading.fraction + laconic_binary_angle_of(half_yaw)));
    laconic_carry_error(&error, estimate, &plant->model, &motion);
    return error;
}

/* ------------------------------------------------------------------------------------- windows -- */

#define WINDOW_ANGLE R(0.5) /* rad: how far a window may rotate, by its gyroscopic term or yaw */

static real larger_of(real a, real b) { return a > b ? a : b; }

/* Length of a next window: one step after a change of the input and again one, then doubled, within K and the angle. */
static int32_t next_length(const laconic_estimate *estimate, const laconic_plant *plant, bool changed) {
    const real speed = laconic_root(square(zeta_of(&plant->state)));
    const real turn = larger_of(estimate->angle_per_zeta[0], estimate->angle_per_zeta[1]) * speed;
    const real angle = turn * plant->integrator.step_s;
    int32_t length = changed || estimate->last_length == 0 ? 1 : 2 * estimate->length;
    if (length > estimate->most_steps) length = estimate->most_steps;
    while (length > 1 && (real)length * angle > WINDOW_ANGLE) length /= 2;
    return length;
}

static void keep_largest(laconic_error *largest, const laconic_error *now) {
    largest->nu_rad_per_s = larger_of(largest->nu_rad_per_s, now->nu_rad_per_s);
    largest->place_m = larger_of(largest->place_m, now->place_m);
    largest->heading_rad = larger_of(largest->heading_rad, now->heading_rad);
    largest->wheel_angle_rad = larger_of(largest->wheel_angle_rad, now->wheel_angle_rad);
}

/* The numbers themselves are rounded when they are set and read: pose and angles far from 0. */
static void add_resolution(laconic_error *floor, const laconic_plant *plant) {
    real angle[LACONIC_MAX_WHEELS], farthest = R(0), heading, x, y;
    laconic_plant_wheel_angles(plant, angle);
    for (int32_t i = 0; i < LACONIC_WHEELS(&plant->model); i++) farthest = larger_of(farthest, magnitude(angle[i]));
    laconic_position(&plant->state, &x, &y, &heading);
    floor->heading_rad += LACONIC_EPSILON * magnitude(heading);
    floor->wheel_angle_rad += LACONIC_EPSILON * farthest;
    floor->place_m += LACONIC_EPSILON * (magnitude(x) + magnitude(y));
}

static void add_floor(laconic_error *sizes, const laconic_error *floor) {
    sizes->nu_rad_per_s += floor->nu_rad_per_s;
    sizes->place_m += floor->place_m;
    sizes->heading_rad += floor->heading_rad;
    sizes->wheel_angle_rad += floor->wheel_angle_rad;
}

/* A size that left the scalar type's range on its way may be NaN, as infinity less infinity is. */
static real or_infinite(real size) {
    const real most = LACONIC_REAL_MAX;
    return size >= R(0) ? size : most + most;
}

static void make_sizes(laconic_error *sizes) {
    sizes->nu_rad_per_s = or_infinite(sizes->nu_rad_per_s);
    sizes->place_m = or_infinite(sizes->place_m);
    sizes->heading_rad = or_infinite(sizes->heading_rad);
    sizes->wheel_angle_rad = or_infinite(sizes->wheel_angle_rad);
}

/* NaN is larger than any size, so that it is not passed over. */
static real larger_size(real a, real b) { return a > or_infinite(b) ? a : or_infinite(b); }

/* Of a row and a vector of sizes. */
static real sizes_dot(vector row, vector sizes) {
    return magnitude(row.x) * sizes.x + magnitude(row.y) * sizes.y + magnitude(row.z) * sizes.z;
}

static void sizes_by_wheel(laconic_error *sizes, laconic_error *floor, const state_error *error,
                           const laconic_model *m) {
    for (int32_t i = 0; i < LACONIC_WHEELS(m); i++) {
        const vector row = vec(m->wheel_of_zeta[i]);
        const real off = magnitude(dot(row, error->travel)) + sizes_dot(row, error->doubt_travel);
        sizes->wheel_angle_rad = larger_size(sizes->wheel_angle_rad, off);
        floor->wheel_angle_rad = larger_of(floor->wheel_angle_rad, size(row) * error->floor_travel);
    }
}

/* How far the plant has been from where the estimate began: a growing error ε of the heading turns the path, and
 * |∫ε i dp| = |ε p − ∫p dε| is at most twice the last ε times that. */
real laconic_estimate_extent(const laconic_estimate *estimate, const laconic_state *now) {
    const real dx = now->x_m.value - estimate->origin_m[0], dy = now->y_m.value - estimate->origin_m[1];
    return larger_of(estimate->extent_m, magnitude(dx) + magnitude(dy));
}

/* Sizes of an error, with the floor, which is given by itself, too. */
static void sizes_of(laconic_error *sizes, laconic_error *floor, const state_error *error,
                     const laconic_estimate *estimate, const laconic_plant *plant) {
    const laconic_error nothing = ALL_ZERO;
    const laconic_model *m = &plant->model;
    const vector yaw = vec(m->yaw_rate_of_zeta);
    const real *place = error->place_m;
    *sizes = *floor = nothing;
    for (int k = 0; k < 3; k++) {
        const vector row = vec(m->nu_of_zeta[k]);
        const real off = magnitude(dot(row, error->zeta)) + sizes_dot(row, error->doubt_zeta);
        sizes->nu_rad_per_s = larger_size(sizes->nu_rad_per_s, off);
        floor->nu_rad_per_s = larger_of(floor->nu_rad_per_s, size(row) * error->floor_zeta);
    }
    sizes_by_wheel(sizes, floor, error, m);
    sizes->heading_rad = magnitude(dot(yaw, error->travel)) + sizes_dot(yaw, error->doubt_travel);
    floor->heading_rad = size(yaw) * error->floor_travel;
    sizes->place_m = laconic_root(place[0] * place[0] + place[1] * place[1]) + error->doubt_place_m;
    floor->place_m = error->floor_path_m + R(2) * floor->heading_rad * laconic_estimate_extent(estimate, &plant->state);
    add_resolution(floor, plant);
    add_floor(sizes, floor);
    make_sizes(sizes);
    make_sizes(floor);
}

/* Carries the error to the plant's moment, at which the window ends. */
static void end_window(laconic_estimate *estimate, const laconic_plant *plant) {
    laconic_error sizes, floor;
    const state_error error = laconic_estimate_error_now(estimate, plant);
    if (estimate->taken == 0) return;
    laconic_estimate_keep_error(estimate, &error);
    sizes_of(&sizes, &floor, &error, estimate, plant);
    estimate->extent_m = laconic_estimate_extent(estimate, &plant->state);
    keep_largest(&estimate->largest, &sizes);
}

static void begin_window(laconic_estimate *estimate, const laconic_plant *plant, const laconic_input *inputs,
                         int32_t count, bool changed) {
    estimate->length = next_length(estimate, plant, changed);
    estimate->last_length = changed ? 0 : estimate->taken;
    estimate->taken = 0;
    estimate->start = plant->state;
    laconic_forcing_of(&estimate->forcing, &plant->model, &inputs[count / 2]);
    estimate->unknown += !take_half_steps(estimate, plant, inputs, count);
}

uint64_t laconic_estimate_before(laconic_estimate *estimate, const laconic_plant *plant, const laconic_input *inputs,
                                 int32_t count, uint64_t steps) {
    const bool changed = !estimate->begun || !same_input(&estimate->input, &inputs[0]);
    estimate->begun = true;
    estimate->input = inputs[count - 1];
    if (has_friction(plant)) {
        estimate->unknown += twin_steps(estimate, plant, &inputs[count / 2]) != LACONIC_OK;
        return 1;
    }
    if (changed || estimate->taken >= estimate->length) {
        end_window(estimate, plant);
        begin_window(estimate, plant, inputs, count, changed);
    }
    const uint64_t left = estimate->taken == 0 ? 1 : (uint64_t)(estimate->length - estimate->taken);
    return left < steps ? left : steps;
}

void laconic_estimate_after(laconic_estimate *estimate, const laconic_plant *plant, uint64_t steps) {
    laconic_errors now;
    if (has_friction(plant)) {
        laconic_estimate_read(&now, estimate, plant);
        keep_largest(&estimate->largest, &now.now);
        return;
    }
    if (estimate->taken == 0) measure_step(estimate, plant);
    estimate->taken += (int32_t)steps;
}

/* ------------------------------------------------------------------------------------- reading -- */

/* Twice what plant and twin differ by: the friction step is of first order. Of its rounding the resolution of the
 * numbers is told. */
static void read_friction(laconic_errors *errors, const laconic_estimate *estimate, const laconic_plant *plant) {
#if LACONIC_WITH_FRICTION
    const laconic_state *now = &plant->state, *twin = &estimate->twin;
    const vector zeta = differences(now->zeta, twin->zeta);
    const real dx = difference(now->x_m, twin->x_m), dy = difference(now->y_m, twin->y_m);
    const real yaw = (real)(signed_binary_angle)(now->heading.fraction - twin->heading.fraction);
    laconic_error *sizes = &errors->now, *floor = &errors->rounding;
    for (int k = 0; k < 3; k++)
        sizes->nu_rad_per_s =
            larger_size(sizes->nu_rad_per_s, R(2) * magnitude(dot(vec(plant->model.nu_of_zeta[k]), zeta)));
    for (int32_t i = 0; i < plant->friction.wheel_count; i++)
        sizes->wheel_angle_rad = larger_size(
            sizes->wheel_angle_rad,
            R(2) * magnitude(difference(plant->slip.wheel_angle_rad[i], estimate->twin_slip.wheel_angle_rad[i])));
    sizes->place_m = R(2) * laconic_root(dx * dx + dy * dy);
    sizes->heading_rad = R(2) * magnitude(yaw) * BINARY_ANGLE_UNIT_RAD;
    floor->nu_rad_per_s = LACONIC_EPSILON * size(zeta_of(now));
    add_resolution(floor, plant);
    add_floor(sizes, floor);
    make_sizes(sizes);
    make_sizes(floor);
#else
    (void)errors, (void)estimate, (void)plant;
#endif
}

void laconic_estimate_read(laconic_errors *errors, const laconic_estimate *estimate, const laconic_plant *plant) {
    const laconic_errors nothing = ALL_ZERO;
    *errors = nothing;
    if (has_friction(plant)) {
        read_friction(errors, estimate, plant);
    } else {
        const state_error error = laconic_estimate_error_now(estimate, plant);
        sizes_of(&errors->now, &errors->rounding, &error, estimate, plant);
    }
    errors->largest = estimate->largest;
    keep_largest(&errors->largest, &errors->now);
    errors->unknown = estimate->unknown;
}

/* ------------------------------------------------------------------------------------ stepping -- */

laconic_status laconic_estimate_run(laconic_estimate *estimate, laconic_plant *plant, const laconic_input *held,
                                    uint64_t steps, laconic_refusal *why) {
    laconic_status status = LACONIC_OK;
    while (steps > 0 && status == LACONIC_OK) {
        const uint64_t now = laconic_estimate_before(estimate, plant, held, 1, steps), before = plant->steps;
        status = laconic_plant_run(plant, held, now, why);
        if (plant->steps > before) laconic_estimate_after(estimate, plant, plant->steps - before);
        steps -= now;
    }
    return status;
}

laconic_status laconic_estimate_run_sampled(laconic_estimate *estimate, laconic_plant *plant,
                                            const laconic_input samples[3], laconic_refusal *why) {
    laconic_estimate_before(estimate, plant, samples, 3, 1);
    const laconic_status status = laconic_plant_run_sampled(plant, samples, why);
    if (status == LACONIC_OK) laconic_estimate_after(estimate, plant, 1);
    return status;
}

/* Takes the row of this moment, where one is due; how many of `left` steps may pass before the next. */
static uint64_t take_row(laconic_error_rows *rows, const laconic_estimate *estimate, const laconic_plant *plant,
                         uint64_t left) {
    laconic_errors errors;
    if (rows == NULL || rows->every == 0) return left;
    if (plant->steps % rows->every == 0) {
        if (rows->row_count >= rows->row_room) return 0;
        laconic_estimate_read(&errors, estimate, plant);
        rows->row[rows->row_count++] = errors.now;
    }
    const uint64_t until_row = rows->every - plant->steps % rows->every;
    return until_row < left ? until_row : left;
}

laconic_status laconic_estimate_follow(laconic_estimate *estimate, laconic_plant *plant,
                                       const laconic_schedule *schedule, uint64_t until_step,
                                       laconic_recorder *recorder, laconic_error_rows *rows, laconic_refusal *why) {
    laconic_input inputs[3];
    laconic_status status = LACONIC_OK;
    uint64_t end = 0;
    int32_t count = 0;
    while (plant->steps < until_step && status == LACONIC_OK) {
        if (plant->steps >= end) count = laconic_schedule_at(inputs, &end, schedule, plant->steps);
        if (count == 0) break;
        uint64_t steps = take_row(rows, estimate, plant, (end < until_step ? end : until_step) - plant->steps);
        if (steps == 0) break;
        steps = laconic_estimate_before(estimate, plant, inputs, count, steps);
        const uint64_t before = plant->steps;
        status = laconic_plant_follow(plant, schedule, before + steps, recorder, why);
        if (plant->steps > before) laconic_estimate_after(estimate, plant, plant->steps - before);
        if (status == LACONIC_OK && plant->steps < before + steps) break; /* the recorder has no room */
    }
    return status;
}
