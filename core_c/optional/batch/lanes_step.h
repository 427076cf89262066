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
#define laconic_exponential_gauss_8 LANES_NAME(laconic_lanes_exponential_gauss_8)
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

#include "wrench.h" /* laconic_state */

/* A state whose step has begun, and what is yet to be added to it. */
typedef struct lanes_step {
    laconic_state state;
    vector delta, path;
    real along_m, across_m, yaw_change_rad;
} lanes_step;

/* `state` is that of a lanes_step. */
#define lanes_put_off(state, its_delta, its_path, moved) \
    (((lanes_step *)(void *)(state))->delta = (its_delta), ((lanes_step *)(void *)(state))->path = (its_path), \
     ((lanes_step *)(void *)(state))->along_m = (moved).along_m, \
     ((lanes_step *)(void *)(state))->across_m = (moved).across_m, \
     ((lanes_step *)(void *)(state))->yaw_change_rad = (moved).yaw_change_rad)

#include "step_internals.c"

#include "exact_flow.c"
#include "exponential_kahan.c"
#include "rk4.c"
#undef LARGEST_DAMPING
#undef LARGEST_ROTATION
#include "exponential_gauss_8.c"
#include "taylor_8.c"

#include "lanes_width.h"

/* ------------------------------------------------------------------------ constants -- */

static const laconic_number *spread(real *member, size_t bytes, int32_t lane, const laconic_number *from) {
    for (size_t i = 0; i < bytes / sizeof(real); i++) member[i][lane] = *from++;
    return from;
}

#define SPREAD_TO_MODEL(member) from = spread((real *)&model->member, sizeof model->member, lane, from);
#define SPREAD_TO_INTEGRATOR(member) from = spread((real *)&integrator->member, sizeof integrator->member, lane, from);

static void place(const laconic_batch_block *block, int32_t lane, lanes_kind kind, const laconic_number *from) {
    laconic_model *model = (laconic_model *)block->model;
    laconic_integrator *integrator = (laconic_integrator *)block->integrator;
    model->wheel_count = kind.wheel_count;
    model->sloped = kind.sloped;
    integrator->stiff = kind.stiff;
    LANES_MODEL_MEMBERS(SPREAD_TO_MODEL)
    LANES_INTEGRATOR_MEMBERS(SPREAD_TO_INTEGRATOR)
#if LACONIC_WITH_EXPONENTIAL_GAUSS
    if (kind.method < LANES_EXPONENTIAL_GAUSS_8) return;
    integrator->stretches = kind.stretches;
    integrator->has_rest = kind.has_rest;
    integrator->halved = false; /* which only estimates have */
    LANES_COLLOCATION_MEMBERS(SPREAD_TO_INTEGRATOR)
#endif
}

/* ---------------------------------------------------------------------------- state -- */

static inline void *state_at(const laconic_batch_block *block, int32_t number) {
    return __builtin_assume_aligned(block->state + (size_t)number * LANES_BYTES, LANES_BYTES);
}

static inline real kept(const laconic_batch_block *block, int32_t number) {
    real out;
    __builtin_memcpy(&out, state_at(block, number), sizeof out);
    return out;
}

static inline laconic_sum kept_sum(const laconic_batch_block *block, int32_t value, int32_t rest) {
    const laconic_sum sum = {kept(block, value), kept(block, rest)};
    return sum;
}

static inline void read_state(laconic_state *s, const laconic_batch_block *block) {
    s->zeta[0] = kept_sum(block, STATE_ZETA, STATE_ZETA_REST);
    s->zeta[1] = kept_sum(block, STATE_ZETA + 1, STATE_ZETA_REST + 1);
    s->zeta[2] = kept_sum(block, STATE_ZETA + 2, STATE_ZETA_REST + 2);
    s->travel[0] = kept_sum(block, STATE_TRAVEL, STATE_TRAVEL_REST);
    s->travel[1] = kept_sum(block, STATE_TRAVEL + 1, STATE_TRAVEL_REST + 1);
    s->travel[2] = kept_sum(block, STATE_TRAVEL + 2, STATE_TRAVEL_REST + 2);
    s->x_m = kept_sum(block, STATE_X, STATE_X_REST);
    s->y_m = kept_sum(block, STATE_Y, STATE_Y_REST);
    s->heading.fraction = (laconic_binary_angle)kept(block, STATE_FRACTION);
    s->heading.rest = kept(block, STATE_HEADING_REST);
    __builtin_memcpy(&s->heading.turns, state_at(block, STATE_TURNS), sizeof s->heading.turns);
}

static inline void keep(const laconic_batch_block *block, int32_t number, real value) {
    __builtin_memcpy(state_at(block, number), &value, sizeof value);
}

static inline void keep_sum(const laconic_batch_block *block, int32_t value, int32_t rest, laconic_sum sum) {
    keep(block, value, sum.value);
    keep(block, rest, sum.rest);
}

static inline void write_state(const laconic_batch_block *block, const laconic_state *s) {
    keep_sum(block, STATE_ZETA, STATE_ZETA_REST, s->zeta[0]);
    keep_sum(block, STATE_ZETA + 1, STATE_ZETA_REST + 1, s->zeta[1]);
    keep_sum(block, STATE_ZETA + 2, STATE_ZETA_REST + 2, s->zeta[2]);
    keep_sum(block, STATE_TRAVEL, STATE_TRAVEL_REST, s->travel[0]);
    keep_sum(block, STATE_TRAVEL + 1, STATE_TRAVEL_REST + 1, s->travel[1]);
    keep_sum(block, STATE_TRAVEL + 2, STATE_TRAVEL_REST + 2, s->travel[2]);
    keep_sum(block, STATE_X, STATE_X_REST, s->x_m);
    keep_sum(block, STATE_Y, STATE_Y_REST, s->y_m);
    keep(block, STATE_FRACTION, (real)s->heading.fraction);
    keep(block, STATE_HEADING_REST, s->heading.rest);
    __builtin_memcpy(state_at(block, STATE_TURNS), &s->heading.turns, sizeof s->heading.turns);
}

static inline void put_sum_where(laconic_sum *sum, mask which, const laconic_sum *now) {
    sum->value = lanes_chosen(which, now->value, sum->value);
    sum->rest = lanes_chosen(which, now->rest, sum->rest);
}

/* A state becomes another in the lanes of `which`. */
RARE void put_where(laconic_state *state, mask which, const laconic_state *now) {
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

/* ----------------------------------------------------------------------------- rows -- */

static inline laconic_number *row(const laconic_batch_block *block, int32_t number) {
    return (laconic_number *)(void *)(block->rows + (size_t)number * block->row_bytes);
}

/* One number of a row for each lane. */
static inline real gathered(const laconic_number *of, const int32_t *lane) {
#if LACONIC_LANES == 2
#define LANE_PAIRS(i) of[lane[i]], of[lane[i + 1]]
    return (real){LANE_PAIRS(0)};
#elif LACONIC_LANES == 4
#define LANE_PAIRS(i) of[lane[i]], of[lane[i + 1]], of[lane[i + 2]], of[lane[i + 3]]
    return (real){LANE_PAIRS(0)};
#else
#define LANE_PAIRS(i) of[lane[i]], of[lane[i + 1]], of[lane[i + 2]], of[lane[i + 3]]
#if LACONIC_LANES == 8
    return (real){LANE_PAIRS(0), LANE_PAIRS(4)};
#else
    return (real){LANE_PAIRS(0), LANE_PAIRS(4), LANE_PAIRS(8), LANE_PAIRS(12)};
#endif
#endif
}
#undef LANE_PAIRS

INLINE real read(const laconic_batch_block *block, int32_t number, bool in_a_row) {
    real out;
    if (!in_a_row) return gathered(row(block, number), block->lanes);
    __builtin_memcpy(&out, row(block, number) + block->lanes[0], sizeof out);
    return out;
}

INLINE void read_input(laconic_input *in, const laconic_batch_block *block, int32_t wheel_count, bool in_a_row) {
    for (int32_t i = 0; i < wheel_count; i++) {
        in->voltage_V[i] = read(block, ROW_VOLTAGE(i), in_a_row);
        in->axle_torque_Nm[i] = read(block, ROW_AXLE_TORQUE(i), in_a_row);
    }
    in->body_force_N[0] = read(block, ROW_BODY_FORCE, in_a_row);
    in->body_force_N[1] = read(block, ROW_BODY_FORCE + 1, in_a_row);
    in->body_moment_Nm = read(block, ROW_BODY_MOMENT, in_a_row);
    in->world_force_N[0] = read(block, ROW_WORLD_FORCE, in_a_row);
    in->world_force_N[1] = read(block, ROW_WORLD_FORCE + 1, in_a_row);
    in->world_force_point_m[0] = read(block, ROW_WORLD_FORCE_POINT, in_a_row);
    in->world_force_point_m[1] = read(block, ROW_WORLD_FORCE_POINT + 1, in_a_row);
}

static inline void show(const laconic_batch_block *block, int32_t number, int32_t of_state) {
    const real value = kept(block, of_state);
    laconic_number *const to = row(block, number);
    if (block->in_a_row)
        __builtin_memcpy(to + block->lanes[0], &value, sizeof value);
    else
        for (int32_t k = 0; k < block->count; k++) to[block->lanes[k]] = value[k];
}

/* ---------------------------------------------------------------------------- steps -- */

#ifndef LANES_TOGETHER
#define LANES_TOGETHER 4
#endif

typedef laconic_status (*lanes_stepper)(const laconic_model *, const laconic_integrator *, laconic_state *,
                                        const laconic_forcing_samples *);

/* What stays over a run of a block. */
typedef struct lanes_run {
    laconic_batch_block *block;
    laconic_forcing forcing;
    mask rotates, refused; /* refused: a step of these would be                                     */
    bool some_rotate;      /* their b rotates with the heading: a stepper of its own is for them    */
    uint64_t after;        /* steps that come after the one that has begun                          */
    vector delta, path;    /* what that adds                                                        */
    pose_change moved;
} lanes_run;

/* A step of a lane adds less than a turn; one near the end of the count goes alone, and laconic_step() counts. */
static inline mask far_from_last_turn(laconic_turns turns) {
    typedef LACONIC_LANES_OF(uint64_t) count;
    const count last = (count){0} + ((uint64_t)1 << 62);
    return __builtin_convertvector((count)turns + ((uint64_t)1 << 61) < last, mask);
}

INLINE void begin_run(lanes_run *run, laconic_batch_block *block) {
    const laconic_model *model = (const laconic_model *)block->model;
    const mask none_of_them = {0};
    laconic_input input;
    laconic_turns turns;
    run->block = block;
    if (block->in_a_row)
        read_input(&input, block, model->wheel_count, true);
    else
        read_input(&input, block, model->wheel_count, false);
    forcing_of(&run->forcing, model, &input);
    run->some_rotate = run->forcing.rotates;
    run->rotates = acts(input.world_force_N[0], input.world_force_N[1], R(0));
    if (sloped(model)) run->rotates = ~none_of_them;
    run->refused = NOT(zero_if_finite(world_force_point(&input)) == R(0));
    if (!block->near_last_turn) return;
    __builtin_memcpy(&turns, state_at(block, STATE_TURNS), sizeof turns);
    run->refused |= NOT(far_from_last_turn(turns));
}

static uint32_t bits_of(mask which) {
    uint32_t bits = 0;
    for (int lane = 0; lane < LACONIC_LANES; lane++) bits |= (which[lane] ? 1U : 0U) << lane;
    return bits;
}

static mask lanes_of_bits(uint32_t bits) {
    mask which = {0};
    for (int lane = 0; lane < LACONIC_LANES; lane++) which[lane] = bits >> lane & 1U ? -1 : 0;
    return which;
}

/* The end of a step that some lanes could not take, or that some have stopped before. */
RARE void end_apart(laconic_batch_block *block, const laconic_state *now, mask out, const lanes_alone *alone,
                    uint64_t after) {
    const uint32_t apart = bits_of(out) & ~block->stopped & (uint32_t)((UINT64_C(1) << block->count) - 1);
    laconic_state state;
    read_state(&state, block);
    put_where(&state, ~(out | lanes_of_bits(block->stopped)), now);
    write_state(block, &state);
    if (apart != 0) block->stopped |= alone->step(alone->context, block, apart, after);
}

INLINE void put_off(lanes_run *run, const lanes_step *step) {
    run->delta = step->delta;
    run->path = step->path;
    run->moved.along_m = step->along_m;
    run->moved.across_m = step->across_m;
    run->moved.yaw_change_rad = step->yaw_change_rad;
}

RARE void begin_rotating_step(lanes_run *run, lanes_stepper steady, lanes_stepper rotating) {
    const laconic_model *model = (const laconic_model *)run->block->model;
    const laconic_integrator *integrator = (const laconic_integrator *)run->block->integrator;
    laconic_forcing_samples samples = {&run->forcing, &run->forcing, &run->forcing, false};
    lanes_step straight, rotated;
    read_state(&straight.state, run->block);
    rotated = straight;
    run->forcing.rotates = true;
    rotating(model, integrator, &rotated.state, &samples);
    if (!ALL(run->rotates)) {
        samples.is_constant = true;
        run->forcing.rotates = false;
        steady(model, integrator, &straight.state, &samples);
        rotated.delta = lanes_where(run->rotates, rotated.delta, straight.delta);
        rotated.path = lanes_where(run->rotates, rotated.path, straight.path);
        rotated.along_m = lanes_chosen(run->rotates, rotated.along_m, straight.along_m);
        rotated.across_m = lanes_chosen(run->rotates, rotated.across_m, straight.across_m);
        rotated.yaw_change_rad = lanes_chosen(run->rotates, rotated.yaw_change_rad, straight.yaw_change_rad);
    }
    put_off(run, &rotated);
}

INLINE void begin_step(lanes_run *run, lanes_stepper steady, lanes_stepper rotating, lanes_stepper steady_apart) {
    const laconic_batch_block *block = run->block;
    const laconic_forcing_samples samples = {&run->forcing, &run->forcing, &run->forcing, true};
    lanes_step step;
    if (run->some_rotate) {
        begin_rotating_step(run, steady_apart, rotating);
        return;
    }
    read_state(&step.state, block);
    steady((const laconic_model *)block->model, (const laconic_integrator *)block->integrator, &step.state, &samples);
    put_off(run, &step);
}

/* Lanes that could not take the step have NaN as their place. A copy goes to the rare case: what has an address is kept
 * in memory. */
INLINE void end_step(lanes_run *run, const lanes_alone *alone) {
    laconic_state state;
    read_state(&state, run->block);
    accept_step(&state, run->delta, run->path, run->moved);
    const mask out = run->refused | NOT(state.x_m.value == state.x_m.value);
    if (ANY(out) || run->block->stopped != 0) {
        const laconic_state now = state;
        end_apart(run->block, &now, out, alone, run->after);
    } else {
        write_state(run->block, &state);
    }
}

/* A step is a long chain of operations, each of which waits for the one before: while one block ends its step, the next
 * begins its own, and a processor finds twice as much to do at a time. */
INLINE void run_together(laconic_batch_block *blocks, int32_t count, uint64_t steps, const lanes_alone *alone,
                         lanes_stepper steady, lanes_stepper rotating, lanes_stepper steady_apart) {
    lanes_run runs[LANES_TOGETHER], *before = NULL, *now = runs;
    for (int32_t i = 0; i < count; i++) begin_run(&runs[i], &blocks[i]);
    for (uint64_t after = steps; after > 0 || before != NULL;) {
        lanes_run *ending = before;
        before = NULL;
        if (after > 0) {
            begin_step(now, steady, rotating, steady_apart);
            before = now;
            if (count == 1) {
                ending = now;
                before = NULL;
            }
            now->after = after - 1;
            if (++now == runs + count) {
                now = runs;
                after--;
            }
        }
        if (ending != NULL) end_step(ending, alone);
    }
    for (int32_t i = 0; i < count; i++) {
        show(&blocks[i], ROW_X, STATE_X);
        show(&blocks[i], ROW_Y, STATE_Y);
    }
}

INLINE void run_all(laconic_batch_block *blocks, int32_t count, uint64_t steps, const lanes_alone *alone,
                    lanes_stepper steady, lanes_stepper rotating, lanes_stepper steady_apart) {
    for (int32_t i = 0; i < count; i += LANES_TOGETHER)
        run_together(blocks + i, count - i < LANES_TOGETHER ? count - i : LANES_TOGETHER, steps, alone, steady,
                     rotating, steady_apart);
}

/* Inlined whole but for what is rare, which calls the steppers. */
#define RUN_OF(name, steady_step, rotating_step) \
    __attribute__((flatten)) static void name(laconic_batch_block *blocks, int32_t count, uint64_t steps, \
                                              const lanes_alone *alone) { \
        const lanes_stepper steady = steady_step, rotating = rotating_step; \
        run_all(blocks, count, steps, alone, steady_step, rotating, steady); \
    }

RUN_OF(run_rk4, rk4_step, rk4_step)
RUN_OF(run_exponential_kahan, exponential_kahan_step, exponential_kahan_step)
RUN_OF(run_exponential_kahan_4, exponential_kahan_4_step, exponential_kahan_4_step)
RUN_OF(run_exact_flow, exact_flow_step, exact_flow_step)
RUN_OF(run_exact_flow_4, exact_flow_4_step, exact_flow_4_step)
RUN_OF(run_taylor_8, taylor_8_step, taylor_8_step)
#if LACONIC_WITH_EXPONENTIAL_GAUSS
RUN_OF(run_exponential_gauss_8, exponential_gauss_8_step, exponential_gauss_8_step)
#else
#define run_exponential_gauss_8 NULL
#endif

const lanes_width LANES_NAME(laconic_lanes_of) = {
    LACONIC_LANES,
    sizeof(laconic_model),
    sizeof(laconic_integrator),
    place,
    {run_rk4, run_exponential_kahan, run_exponential_kahan_4, run_exact_flow, run_exact_flow_4, run_taylor_8,
     run_exponential_gauss_8, run_exponential_gauss_8, run_exponential_gauss_8}};

#endif
