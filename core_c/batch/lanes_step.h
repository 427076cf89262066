/* Steps of LACONIC_LANES vehicles side by side: the methods' own text, compiled with numbers for many. Each file of a
 * width includes this one. */
#ifndef LACONIC_LANES_STEP_H
#define LACONIC_LANES_STEP_H

/* Names of this width. */
#define LANES_JOIN(name, width) name##_##width
#define LANES_EXPAND(name, width) LANES_JOIN(name, width)
#define LANES_NAME(name) LANES_EXPAND(name, LANES_BYTES)
#define laconic_rk4 LANES_NAME(laconic_lanes_rk4)
#define laconic_exponential_kahan LANES_NAME(laconic_lanes_exponential_kahan)
#define laconic_exponential_kahan_4 LANES_NAME(laconic_lanes_exponential_kahan_4)
#define laconic_exact_flow LANES_NAME(laconic_lanes_exact_flow)
#define laconic_exact_flow_4 LANES_NAME(laconic_lanes_exact_flow_4)
#define laconic_taylor_8 LANES_NAME(laconic_lanes_taylor_8)
#define laconic_forcing_of LANES_NAME(laconic_lanes_forcing_of)
#define laconic_forcing_after_yaw LANES_NAME(laconic_lanes_forcing_after_yaw)
#define laconic_growth_is_forced LANES_NAME(laconic_lanes_growth_is_forced)
#define LACONIC_WITH_PREPARE 0

#ifdef LACONIC_SINGLE
#define LACONIC_LANES (LANES_BYTES / 4)
#else
#define LACONIC_LANES (LANES_BYTES / 8)
#endif

#include "lanes.h"

#include "lanes_heading.h"

#include "../src/step_internals.c"

#include "../src/exact_flow.c"
#include "../src/exponential_kahan.c"
#include "../src/rk4.c"
#undef LARGEST_DAMPING
#undef LARGEST_ROTATION
#include "../src/taylor_8.c"

#include "lanes_width.h"

/* ------------------------------------------------------------------------ constants -- */

static const laconic_number *spread(real *member, size_t bytes, int32_t lane, const laconic_number *from) {
    for (size_t i = 0; i < bytes / sizeof(real); i++) member[i][lane] = *from++;
    return from;
}

#define SPREAD_TO_MODEL(member) from = spread((real *)&model->member, sizeof model->member, lane, from);
#define SPREAD_TO_INTEGRATOR(member) from = spread((real *)&integrator->member, sizeof integrator->member, lane, from);

static void place(const lanes_block *block, int32_t lane, lanes_kind kind, const laconic_number *from) {
    laconic_model *model = (laconic_model *)block->model;
    laconic_integrator *integrator = (laconic_integrator *)block->integrator;
    model->wheel_count = kind.wheel_count;
    model->sloped = kind.sloped;
    integrator->stiff = kind.stiff;
    LANES_MODEL_MEMBERS(SPREAD_TO_MODEL)
    LANES_INTEGRATOR_MEMBERS(SPREAD_TO_INTEGRATOR)
}

/* ----------------------------------------------------------------------------- rows -- */

static inline void *row(const lanes_block *block, int32_t number) {
    return block->rows + (size_t)number * block->row_bytes + (size_t)block->first * sizeof(laconic_number);
}

static inline void *turns_row(const lanes_block *block) {
    return block->rows + ROW_TURNS * block->row_bytes + (size_t)block->first * sizeof(int64_t);
}

static inline real read(const lanes_block *block, int32_t number) {
    real out;
    __builtin_memcpy(&out, row(block, number), sizeof out);
    return out;
}

static inline vector read_vector(const lanes_block *block, int32_t number) {
    return vector_of(read(block, number), read(block, number + 1), read(block, number + 2));
}

static inline void read_sums(laconic_sum sums[], const lanes_block *block, int32_t values, int32_t rests, int32_t step,
                             int count) {
    for (int k = 0; k < count; k++) {
        sums[k].value = read(block, values + step * k);
        sums[k].rest = read(block, rests + step * k);
    }
}

static inline void read_state(laconic_state *s, const lanes_block *block) {
    read_sums(s->zeta, block, ROW_ZETA, ROW_ZETA_REST, 1, 3);
    read_sums(s->travel, block, ROW_TRAVEL, ROW_TRAVEL_REST, 1, 3);
    read_sums(&s->x_m, block, ROW_X, ROW_X_REST, 2, 1);
    read_sums(&s->y_m, block, ROW_Y, ROW_Y_REST, 2, 1);
    s->heading.fraction = (laconic_binary_angle)read(block, ROW_FRACTION);
    s->heading.rest = read(block, ROW_HEADING_REST);
    __builtin_memcpy(&s->heading.turns, turns_row(block), sizeof s->heading.turns);
}

static inline void write(const lanes_block *block, int32_t number, real value) {
    __builtin_memcpy(row(block, number), &value, sizeof value);
}

static inline void write_sum(const lanes_block *block, int32_t value, int32_t rest, laconic_sum sum) {
    write(block, value, sum.value);
    write(block, rest, sum.rest);
}

static inline void write_state(const lanes_block *block, const laconic_state *s) {
    for (int k = 0; k < 3; k++) write_sum(block, ROW_ZETA + k, ROW_ZETA_REST + k, s->zeta[k]);
    for (int k = 0; k < 3; k++) write_sum(block, ROW_TRAVEL + k, ROW_TRAVEL_REST + k, s->travel[k]);
    write_sum(block, ROW_X, ROW_X_REST, s->x_m);
    write_sum(block, ROW_Y, ROW_Y_REST, s->y_m);
    write(block, ROW_FRACTION, (real)s->heading.fraction);
    write(block, ROW_HEADING_REST, s->heading.rest);
    __builtin_memcpy(turns_row(block), &s->heading.turns, sizeof s->heading.turns);
}

static inline void read_input(laconic_input *in, const lanes_block *block, int32_t wheel_count) {
    for (int32_t i = 0; i < wheel_count; i++) {
        in->voltage_V[i] = read(block, ROW_VOLTAGE(i));
        in->axle_torque_Nm[i] = read(block, ROW_AXLE_TORQUE(i));
    }
    for (int k = 0; k < 2; k++) {
        in->body_force_N[k] = read(block, ROW_BODY_FORCE + k);
        in->world_force_N[k] = read(block, ROW_WORLD_FORCE + k);
        in->world_force_point_m[k] = read(block, ROW_WORLD_FORCE_POINT + k);
    }
    in->body_moment_Nm = read(block, ROW_BODY_MOMENT);
}

/* ---------------------------------------------------------------------------- steps -- */

static inline void put_sum_where(laconic_sum *sum, verdict which, const laconic_sum *now) {
    sum->value = lanes_chosen(which, now->value, sum->value);
    sum->rest = lanes_chosen(which, now->rest, sum->rest);
}

/* A state becomes another in the lanes of `which`. */
RARE void put_where(laconic_state *state, verdict which, const laconic_state *now) {
    const laconic_turns turns = __builtin_convertvector(which, laconic_turns);
    laconic_heading *heading = &state->heading;
    for (int k = 0; k < 3; k++) put_sum_where(&state->zeta[k], which, &now->zeta[k]);
    for (int k = 0; k < 3; k++) put_sum_where(&state->travel[k], which, &now->travel[k]);
    put_sum_where(&state->x_m, which, &now->x_m);
    put_sum_where(&state->y_m, which, &now->y_m);
    heading->fraction = (laconic_binary_angle)lanes_chosen(which, (real)now->heading.fraction, (real)heading->fraction);
    heading->rest = lanes_chosen(which, now->heading.rest, heading->rest);
    heading->turns = (turns & now->heading.turns) | (~turns & heading->turns);
}

typedef laconic_status (*lanes_stepper)(const laconic_model *, const laconic_integrator *, laconic_state *,
                                        const laconic_forcing_samples *);

/* What stays over a run. */
typedef struct lanes_run {
    const lanes_block *block;
    const laconic_model *model;
    const laconic_integrator *integrator;
    lanes_stepper steady, rotating; /* of lanes whose b is constant, and of those whose b rotates with the heading */
    laconic_forcing forcing;
    verdict rotates, stopped, refused; /* refused: a step of these would be                     */
    bool some_rotate;
} lanes_run;

RARE void step_rotating(laconic_state *state, lanes_run *run) {
    laconic_forcing_samples samples = {&run->forcing, &run->forcing, &run->forcing, false};
    laconic_state rotated = *state;
    run->forcing.rotates = true;
    run->rotating(run->model, run->integrator, &rotated, &samples);
    if (!ALL(run->rotates)) {
        samples.is_constant = true;
        run->forcing.rotates = false;
        run->steady(run->model, run->integrator, state, &samples);
    }
    put_where(state, run->rotates, &rotated);
}

/* Steps all lanes; returns those that must take the step alone, whose numbers are then of no use. */
INLINE verdict step_lanes(laconic_state *state, lanes_run *run, lanes_stepper steady) {
    const laconic_forcing_samples samples = {&run->forcing, &run->forcing, &run->forcing, true};
    if (run->some_rotate)
        step_rotating(state, run);
    else
        steady(run->model, run->integrator, state, &samples);
    return (run->refused | NOT(state->x_m.value == state->x_m.value)) & ~run->stopped;
}

static uint32_t bits_of(verdict which) {
    uint32_t bits = 0;
    for (int lane = 0; lane < LACONIC_LANES; lane++) bits |= (which[lane] ? 1U : 0U) << lane;
    return bits;
}

/* Some lanes could not take the last of `taken` steps: from the rows, which have the state before the run, those are
 * taken again that all lanes took, and the last by the others. */
RARE uint32_t take_again(lanes_run *run, uint64_t taken) {
    laconic_state before, state;
    read_state(&before, run->block);
    state = before;
    for (uint64_t i = 1; i < taken; i++) step_lanes(&state, run, run->steady);
    laconic_state last = state;
    const verdict apart = step_lanes(&last, run, run->steady);
    put_where(&state, ~apart, &last);
    put_where(&state, run->stopped, &before);
    write_state(run->block, &state);
    return bits_of(apart);
}

INLINE uint64_t take_steps(lanes_run *run, lanes_stepper steady, uint64_t steps, uint32_t *apart) {
    laconic_state state;
    uint64_t taken = 0;
    verdict out = {0};
    read_state(&state, run->block);
    while (taken < steps) {
        out = step_lanes(&state, run, steady);
        taken++;
        if (ANY(out)) break;
    }
    *apart = 0;
    if (ANY(out | run->stopped))
        *apart = take_again(run, taken);
    else
        write_state(run->block, &state);
    return taken;
}

/* A step of a lane adds less than a turn; one near the end of the count goes alone, and laconic_step() counts. */
static inline verdict far_from_last_turn(laconic_turns turns) {
    typedef LACONIC_LANES_OF(uint64_t) count;
    const count last = (count){0} + ((uint64_t)1 << 62);
    return __builtin_convertvector((count)turns + ((uint64_t)1 << 61) < last, verdict);
}

INLINE void begin_run(lanes_run *run, const lanes_block *block, uint32_t stopped) {
    laconic_input input;
    laconic_turns turns;
    const verdict none_of_them = {0};
    run->block = block;
    run->model = (const laconic_model *)block->model;
    run->integrator = (const laconic_integrator *)block->integrator;
    read_input(&input, block, run->model->wheel_count);
    forcing_of(&run->forcing, run->model, &input);
    run->some_rotate = run->forcing.rotates;
    run->rotates = acts(input.world_force_N[0], input.world_force_N[1], R(0));
    if (sloped(run->model)) run->rotates = ~none_of_them;
    __builtin_memcpy(&turns, turns_row(block), sizeof turns);
    run->refused = NOT(zero_if_finite(world_force_point(&input)) == R(0)) | NOT(far_from_last_turn(turns));
    run->stopped = none_of_them;
    for (int lane = 0; stopped >> lane != 0 && lane < LACONIC_LANES; lane++)
        run->stopped[lane] = stopped >> lane & 1U ? -1 : 0;
}

/* Inlined whole, so that numbers need not pass through memory from step to step. */
#define RUN_OF(name, steady_step, rotating_step) \
    __attribute__((flatten)) static uint64_t name(const lanes_block *block, uint64_t steps, uint32_t stopped, \
                                                  uint32_t *apart) { \
        lanes_run run; \
        begin_run(&run, block, stopped); \
        run.steady = steady_step; \
        run.rotating = rotating_step; \
        return take_steps(&run, steady_step, steps, apart); \
    }

RUN_OF(run_rk4, rk4_step, rk4_step)
RUN_OF(run_exponential_kahan, exponential_kahan_step, exponential_kahan_step)
RUN_OF(run_exponential_kahan_4, exponential_kahan_4_step, exponential_kahan_4_step)
RUN_OF(run_exact_flow, exact_flow_step, exact_flow_step)
RUN_OF(run_exact_flow_4, exact_flow_4_step, exact_flow_4_step)
RUN_OF(run_taylor_8, taylor_8_step, taylor_8_step)
RUN_OF(run_auto_slow, exact_flow_4_step, taylor_8_step)

const lanes_width LANES_NAME(laconic_lanes_of) = {LACONIC_LANES,
                                                  sizeof(laconic_model),
                                                  sizeof(laconic_integrator),
                                                  place,
                                                  {run_rk4, run_exponential_kahan, run_exponential_kahan_4,
                                                   run_exact_flow, run_exact_flow_4, run_taylor_8, run_auto_slow,
                                                   run_exponential_kahan_4}};

#endif
