/* Lanes to and from the structs of one vehicle, and the run of blocks: a lane that cannot go with the others takes its
 * step alone. */
#include "batch_block.h"

#include "heading.h"

/* --------------------------------------------------------------- the state of one lane -- */

/* A lane's place in the registers of its block. */
typedef struct place {
    unsigned char *first;
    size_t stride; /* from register to register */
    int32_t lane;
} place;

static place place_of(const laconic_batch_block *block, const laconic_batch *batch, int32_t k) {
    const place p = {block->state, state_stride(batch->width), k};
    return p;
}

static place place_of_lane(const laconic_batch *batch, int32_t lane) {
    const int32_t lanes = lanes_of_width(batch->width), slot = batch->slot_of[lane];
    return place_of(&batch->blocks[slot / lanes], batch, slot % lanes);
}

static real *kept(const place *p, int32_t number) {
    return (real *)(void *)(p->first + (size_t)number * p->stride) + p->lane;
}

/* Fractions of a turn are integers of a number's size. */
static laconic_angle_number *kept_fraction(const place *p) {
    return (laconic_angle_number *)(void *)kept(p, STATE_FRACTION);
}

static int64_t *kept_turns(const place *p) { return (int64_t *)(void *)(p->first + STATE_TURNS * p->stride) + p->lane; }

static laconic_sum sum_in(const place *p, int32_t value, int32_t rest) {
    const laconic_sum sum = {*kept(p, value), *kept(p, rest)};
    return sum;
}

static void put_sum(const place *p, int32_t value, int32_t rest, laconic_sum sum) {
    *kept(p, value) = sum.value;
    *kept(p, rest) = sum.rest;
}

static void state_in(laconic_state *s, const place *p) {
    for (int32_t k = 0; k < 3; k++) {
        s->zeta[k] = sum_in(p, STATE_ZETA + k, STATE_ZETA_REST + k);
        s->travel[k] = sum_in(p, STATE_TRAVEL + k, STATE_TRAVEL_REST + k);
    }
    s->x_m = sum_in(p, STATE_X, STATE_X_REST);
    s->y_m = sum_in(p, STATE_Y, STATE_Y_REST);
    s->heading.turns = *kept_turns(p);
    s->heading.fraction = *kept_fraction(p);
    s->heading.rest = *kept(p, STATE_HEADING_REST);
}

static void put_state(const place *p, const laconic_state *s) {
    for (int32_t k = 0; k < 3; k++) {
        put_sum(p, STATE_ZETA + k, STATE_ZETA_REST + k, s->zeta[k]);
        put_sum(p, STATE_TRAVEL + k, STATE_TRAVEL_REST + k, s->travel[k]);
    }
    put_sum(p, STATE_X, STATE_X_REST, s->x_m);
    put_sum(p, STATE_Y, STATE_Y_REST, s->y_m);
    *kept_turns(p) = s->heading.turns;
    *kept_fraction(p) = s->heading.fraction;
    *kept(p, STATE_HEADING_REST) = s->heading.rest;
}

/* A block far from the end of the count stays so by the steps that lanes take together: no machine runs for the 2⁵⁸
 * that it would take at least. */
static void mark_far(laconic_batch_block *block, const laconic_state *s) {
    if ((uint64_t)s->heading.turns + ((uint64_t)1 << 60) >= (uint64_t)1 << 61) block->near_last_turn = true;
}

/* ---------------------------------------------------------------- rows, and one lane of them -- */

static real *number_of(const laconic_batch *batch, int32_t row, int32_t lane) {
    return (real *)(void *)(batch->rows + (size_t)row * batch->row_bytes) + lane;
}

static int32_t wheels_of(const laconic_batch *batch, int32_t lane) {
    return LACONIC_WHEELS(&batch->kinds[batch->kind_of[lane]].model);
}

void laconic_batch_input(const laconic_batch *batch, int32_t lane, laconic_input *input) {
    for (int32_t i = 0; i < wheels_of(batch, lane); i++) {
        input->voltage_V[i] = *number_of(batch, ROW_VOLTAGE(i), lane);
        input->axle_torque_Nm[i] = *number_of(batch, ROW_AXLE_TORQUE(i), lane);
    }
    for (int32_t k = 0; k < 2; k++) {
        input->body_force_N[k] = *number_of(batch, ROW_BODY_FORCE + k, lane);
        input->world_force_N[k] = *number_of(batch, ROW_WORLD_FORCE + k, lane);
        input->world_force_point_m[k] = *number_of(batch, ROW_WORLD_FORCE_POINT + k, lane);
    }
    input->body_moment_Nm = *number_of(batch, ROW_BODY_MOMENT, lane);
}

void laconic_batch_set_input(laconic_batch *batch, int32_t lane, const laconic_input *input) {
    for (int32_t i = 0; i < wheels_of(batch, lane); i++) {
        *number_of(batch, ROW_VOLTAGE(i), lane) = input->voltage_V[i];
        *number_of(batch, ROW_AXLE_TORQUE(i), lane) = input->axle_torque_Nm[i];
    }
    for (int32_t k = 0; k < 2; k++) {
        *number_of(batch, ROW_BODY_FORCE + k, lane) = input->body_force_N[k];
        *number_of(batch, ROW_WORLD_FORCE + k, lane) = input->world_force_N[k];
        *number_of(batch, ROW_WORLD_FORCE_POINT + k, lane) = input->world_force_point_m[k];
    }
    *number_of(batch, ROW_BODY_MOMENT, lane) = input->body_moment_Nm;
}

void laconic_batch_load(laconic_batch *batch, int32_t lane, const laconic_state *state) {
    const place p = place_of_lane(batch, lane);
    put_state(&p, state);
    mark_far(&batch->blocks[batch->slot_of[lane] / lanes_of_width(batch->width)], state);
    *number_of(batch, ROW_X, lane) = state->x_m.value;
    *number_of(batch, ROW_Y, lane) = state->y_m.value;
    for (int32_t i = 0; i < wheels_of(batch, lane); i++)
        *number_of(batch, ROW_WHEEL_ANGLE_SET(i), lane) = state->wheel_angle_set_rad[i];
    batch->status[lane] = LACONIC_OK;
    batch->missed[lane] = 0;
}

void laconic_batch_store(const laconic_batch *batch, int32_t lane, laconic_state *state) {
    const place p = place_of_lane(batch, lane);
    state_in(state, &p);
    for (int32_t i = 0; i < wheels_of(batch, lane); i++)
        state->wheel_angle_set_rad[i] = *number_of(batch, ROW_WHEEL_ANGLE_SET(i), lane);
}

laconic_real *laconic_batch_row_of(const laconic_batch *batch, laconic_batch_row row, int32_t wheel) {
    static const int32_t of[] = {0,
                                 0,
                                 ROW_BODY_FORCE,
                                 ROW_BODY_FORCE + 1,
                                 ROW_BODY_MOMENT,
                                 ROW_WORLD_FORCE,
                                 ROW_WORLD_FORCE + 1,
                                 ROW_WORLD_FORCE_POINT,
                                 ROW_WORLD_FORCE_POINT + 1,
                                 ROW_X,
                                 ROW_Y};
    const int32_t outputs = ROW_OUTPUTS(batch->shape.wheel_count);
    if (row > LACONIC_BATCH_NU_3) return NULL;
    if (row >= LACONIC_BATCH_HEADING) return number_of(batch, outputs + (int32_t)(row - LACONIC_BATCH_HEADING), 0);
    if (row > LACONIC_BATCH_AXLE_TORQUE) return number_of(batch, of[row], 0);
    if (wheel < 0 || wheel >= batch->shape.wheel_count) return NULL;
    return number_of(batch, row == LACONIC_BATCH_VOLTAGE ? ROW_VOLTAGE(wheel) : ROW_AXLE_TORQUE(wheel), 0);
}

/* ------------------------------------------------------------------------------------ run -- */

typedef struct walk {
    laconic_batch *batch;
    int32_t refused; /* how many lanes                                   */
    uint64_t later;  /* steps that come after those that are under way   */
} walk;

/* Steps of one lane by itself; it stops where one is refused, which is returned. `after`: the steps of this run that
 * come after them. */
static bool refuses_alone(walk *w, laconic_batch_block *block, int32_t k, uint64_t steps, uint64_t after) {
    const int32_t lane = block->lanes[k];
    const laconic_batch_kind *kind = &w->batch->kinds[w->batch->kind_of[lane]];
    const place p = place_of(block, w->batch, k);
    laconic_state state;
    laconic_input input;
    laconic_status status;
    state_in(&state, &p);
    laconic_batch_input(w->batch, lane, &input);
    const uint64_t taken = laconic_run(&kind->model, &kind->integrator, &state, &input, steps, &status);
    put_state(&p, &state);
    mark_far(block, &state);
    if (status == LACONIC_OK) return false;
    w->batch->status[lane] = (int32_t)status;
    w->batch->missed[lane] += steps - taken + after + w->later;
    w->refused++;
    return true;
}

static uint32_t step_alone(void *context, laconic_batch_block *block, uint32_t which, uint64_t after) {
    uint32_t refused = 0;
    for (int32_t k = 0; k < block->count; k++)
        if (which >> k & 1U && refuses_alone((walk *)context, block, k, 1, after)) refused |= 1U << k;
    return refused;
}

static void run_one(walk *w, laconic_batch_block *block, int32_t k, uint64_t steps) {
    const place p = place_of(block, w->batch, k);
    if (block->stopped >> k & 1U) return;
    if (refuses_alone(w, block, k, steps, 0)) block->stopped |= 1U << k;
    *number_of(w->batch, ROW_X, block->lanes[k]) = *kept(&p, STATE_X);
    *number_of(w->batch, ROW_Y, block->lanes[k]) = *kept(&p, STATE_Y);
}

/* Lanes of a batch without registers, or by a method that registers do not know. */
static void run_one_by_one(walk *w, laconic_batch_block *blocks, int32_t count, uint64_t steps) {
    for (int32_t i = 0; i < count; i++)
        for (int32_t k = 0; k < blocks[i].count; k++) run_one(w, &blocks[i], k, steps);
}

/* How many blocks, from the first on, step by one method. */
static int32_t of_one_method(const laconic_batch_block *blocks, int32_t count) {
    int32_t same = 1;
    while (same < count && blocks[same].method == blocks[0].method) same++;
    return same;
}

static void run_blocks(walk *w, laconic_batch_block *blocks, int32_t count, uint64_t steps) {
    const lanes_alone alone = {step_alone, w};
    if (w->batch->width == NULL) {
        run_one_by_one(w, blocks, count, steps);
        return;
    }
    for (int32_t first = 0, same = 0; first < count; first += same) {
        same = of_one_method(&blocks[first], count - first);
        if (blocks[first].method == LANES_NO_METHOD)
            run_one_by_one(w, &blocks[first], same, steps);
        else
            w->batch->width->run[blocks[first].method](&blocks[first], same, steps, &alone);
    }
}

/* A block forgets what was refused in its last run. */
static void begin(laconic_batch *batch, laconic_batch_block *block) {
    block->stopped = 0;
    if (!block->has_refused) return;
    for (int32_t k = 0; k < block->count; k++) batch->status[block->lanes[k]] = LACONIC_OK;
    block->has_refused = false;
}

static int32_t end(const walk *w, laconic_batch_block *blocks, int32_t count) {
    for (int32_t i = 0; i < count; i++) blocks[i].has_refused = blocks[i].stopped != 0;
    return w->refused;
}

int32_t laconic_batch_run(laconic_batch *batch, int32_t first_block, int32_t blocks, uint64_t steps) {
    walk w = {batch, 0, 0};
    laconic_batch_block *const first = &batch->blocks[first_block];
    for (int32_t i = 0; i < blocks; i++) begin(batch, &first[i]);
    run_blocks(&w, first, blocks, steps);
    return end(&w, first, blocks);
}

static void copy(real *restrict to, const real *restrict from, int32_t count) {
    for (int32_t i = 0; i < count; i++) to[i] = from[i];
}

/* A lane that stopped keeps the voltages with which it was refused. */
static void put_lanes(const laconic_batch_block *block, real *row, const real *from) {
    for (int32_t k = 0; k < block->count; k++)
        if (!(block->stopped >> k & 1U)) row[block->lanes[k]] = from[block->lanes[k]];
}

/* How many lanes some blocks have that follow each other and have not stopped; 0 where there are others. */
static int32_t lanes_in_a_row(const laconic_batch_block *blocks, int32_t count) {
    int32_t next = blocks[0].lanes[0];
    for (int32_t i = 0; i < count; next += blocks[i++].count)
        if (!blocks[i].in_a_row || blocks[i].stopped != 0 || blocks[i].lanes[0] != next ||
            blocks[i].wheel_count != blocks[0].wheel_count)
            return 0;
    return next - blocks[0].lanes[0];
}

static void put_voltages(laconic_batch *batch, const laconic_batch_block *blocks, int32_t count, const real *sample) {
    const int32_t in_a_row = lanes_in_a_row(blocks, count), first = blocks[0].lanes[0];
    for (int32_t wheel = 0; wheel < batch->shape.wheel_count; wheel++) {
        real *const row = number_of(batch, ROW_VOLTAGE(wheel), 0);
        const real *const from = sample + (size_t)wheel * (size_t)batch->shape.lane_count;
        if (in_a_row > 0 && wheel < blocks[0].wheel_count) copy(row + first, from + first, in_a_row);
        for (int32_t i = 0; in_a_row == 0 && i < count; i++)
            if (wheel < blocks[i].wheel_count) put_lanes(&blocks[i], row, from);
    }
}

/* So few blocks take all their steps before the next that what they need stays in the nearest cache. */
#define BLOCKS_AT_A_TIME 8

int32_t laconic_batch_run_sampled(laconic_batch *batch, int32_t first_block, int32_t blocks, uint64_t samples,
                                  uint64_t steps_each, const laconic_real *voltage_V) {
    walk w = {batch, 0, 0};
    const size_t sample_size = (size_t)batch->shape.wheel_count * (size_t)batch->shape.lane_count;
    laconic_batch_block *const first = &batch->blocks[first_block];
    for (int32_t i = 0; i < blocks; i++) begin(batch, &first[i]);
    for (int32_t i = 0; i < blocks; i += BLOCKS_AT_A_TIME) {
        const int32_t count = blocks - i < BLOCKS_AT_A_TIME ? blocks - i : BLOCKS_AT_A_TIME;
        for (uint64_t s = 0; s < samples; s++) {
            put_voltages(batch, &first[i], count, voltage_V + s * sample_size);
            w.later = (samples - 1 - s) * steps_each;
            run_blocks(&w, &first[i], count, steps_each);
        }
    }
    return end(&w, first, blocks);
}

/* -------------------------------------------------------------------------------- outputs -- */

static void observe(laconic_batch *batch, int32_t lane, const place *p) {
    const int32_t outputs = ROW_OUTPUTS(batch->shape.wheel_count);
    laconic_state state;
    real nu[3];
    state_in(&state, p);
    laconic_nu(&batch->kinds[batch->kind_of[lane]].model, &state, nu);
    *number_of(batch, outputs, lane) = heading_unwrapped(&state.heading);
    for (int32_t c = 0; c < 3; c++) *number_of(batch, outputs + 1 + c, lane) = nu[c];
}

void laconic_batch_observe(laconic_batch *batch, int32_t first_block, int32_t blocks) {
    for (int32_t i = first_block; i < first_block + blocks; i++)
        for (int32_t k = 0; k < batch->blocks[i].count; k++) {
            const place p = place_of(&batch->blocks[i], batch, k);
            observe(batch, batch->blocks[i].lanes[k], &p);
        }
}
