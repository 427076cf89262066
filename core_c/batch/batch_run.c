/* Lanes to and from the structs of one vehicle, and the run of a block: a lane that cannot go with the others takes its
 * step alone. */
#include "batch_block.h"

#include "../src/heading.h"

/* ------------------------------------------------------------ rows and one lane of them -- */

/* Rows of a whole batch, or the copy of a block's. */
typedef struct rows {
    unsigned char *first;
    size_t row_bytes;
    int32_t wheel_count; /* of the vehicle in the lane */
} rows;

static real *number_of(const rows *r, int32_t row, int32_t lane) {
    return (real *)(void *)(r->first + (size_t)row * r->row_bytes) + lane;
}

/* Fractions of a turn are integers of a number's size. */
static laconic_angle_number *fraction_of(const rows *r, int32_t lane) {
    return (laconic_angle_number *)(void *)number_of(r, ROW_FRACTION, lane);
}

static int64_t *turns_of(const rows *r, int32_t lane) { return (int64_t *)(void *)number_of(r, ROW_TURNS, 0) + lane; }

static laconic_sum sum_in(const rows *r, int32_t value, int32_t rest, int32_t lane) {
    const laconic_sum sum = {*number_of(r, value, lane), *number_of(r, rest, lane)};
    return sum;
}

static void put_sum(const rows *r, int32_t value, int32_t rest, int32_t lane, laconic_sum sum) {
    *number_of(r, value, lane) = sum.value;
    *number_of(r, rest, lane) = sum.rest;
}

static void state_in(laconic_state *s, const rows *r, int32_t lane) {
    for (int32_t k = 0; k < 3; k++) {
        s->zeta[k] = sum_in(r, ROW_ZETA + k, ROW_ZETA_REST + k, lane);
        s->travel[k] = sum_in(r, ROW_TRAVEL + k, ROW_TRAVEL_REST + k, lane);
    }
    s->x_m = sum_in(r, ROW_X, ROW_X_REST, lane);
    s->y_m = sum_in(r, ROW_Y, ROW_Y_REST, lane);
    s->heading.turns = *turns_of(r, lane);
    s->heading.fraction = *fraction_of(r, lane);
    s->heading.rest = *number_of(r, ROW_HEADING_REST, lane);
}

static void put_state(const rows *r, int32_t lane, const laconic_state *s) {
    for (int32_t k = 0; k < 3; k++) {
        put_sum(r, ROW_ZETA + k, ROW_ZETA_REST + k, lane, s->zeta[k]);
        put_sum(r, ROW_TRAVEL + k, ROW_TRAVEL_REST + k, lane, s->travel[k]);
    }
    put_sum(r, ROW_X, ROW_X_REST, lane, s->x_m);
    put_sum(r, ROW_Y, ROW_Y_REST, lane, s->y_m);
    *turns_of(r, lane) = s->heading.turns;
    *fraction_of(r, lane) = s->heading.fraction;
    *number_of(r, ROW_HEADING_REST, lane) = s->heading.rest;
}

static void input_in(laconic_input *in, const rows *r, int32_t lane) {
    for (int32_t i = 0; i < r->wheel_count; i++) {
        in->voltage_V[i] = *number_of(r, ROW_VOLTAGE(i), lane);
        in->axle_torque_Nm[i] = *number_of(r, ROW_AXLE_TORQUE(i), lane);
    }
    for (int32_t k = 0; k < 2; k++) {
        in->body_force_N[k] = *number_of(r, ROW_BODY_FORCE + k, lane);
        in->world_force_N[k] = *number_of(r, ROW_WORLD_FORCE + k, lane);
        in->world_force_point_m[k] = *number_of(r, ROW_WORLD_FORCE_POINT + k, lane);
    }
    in->body_moment_Nm = *number_of(r, ROW_BODY_MOMENT, lane);
}

static void put_input(const rows *r, int32_t lane, const laconic_input *in) {
    for (int32_t i = 0; i < r->wheel_count; i++) {
        *number_of(r, ROW_VOLTAGE(i), lane) = in->voltage_V[i];
        *number_of(r, ROW_AXLE_TORQUE(i), lane) = in->axle_torque_Nm[i];
    }
    for (int32_t k = 0; k < 2; k++) {
        *number_of(r, ROW_BODY_FORCE + k, lane) = in->body_force_N[k];
        *number_of(r, ROW_WORLD_FORCE + k, lane) = in->world_force_N[k];
        *number_of(r, ROW_WORLD_FORCE_POINT + k, lane) = in->world_force_point_m[k];
    }
    *number_of(r, ROW_BODY_MOMENT, lane) = in->body_moment_Nm;
}

static rows rows_of(const laconic_batch *b, int32_t lane) {
    const rows r = {b->rows, b->row_bytes, LACONIC_WHEELS(&b->kinds[b->kind_of[lane]].model)};
    return r;
}

void laconic_batch_load(laconic_batch *batch, int32_t lane, const laconic_state *state) {
    const rows r = rows_of(batch, lane);
    put_state(&r, lane, state);
    for (int32_t i = 0; i < r.wheel_count; i++)
        *number_of(&r, ROW_WHEEL_ANGLE_SET(i), lane) = state->wheel_angle_set_rad[i];
    batch->status[lane] = LACONIC_OK;
    batch->missed[lane] = 0;
}

void laconic_batch_store(const laconic_batch *batch, int32_t lane, laconic_state *state) {
    const rows r = rows_of(batch, lane);
    state_in(state, &r, lane);
    for (int32_t i = 0; i < r.wheel_count; i++)
        state->wheel_angle_set_rad[i] = *number_of(&r, ROW_WHEEL_ANGLE_SET(i), lane);
}

void laconic_batch_set_input(laconic_batch *batch, int32_t lane, const laconic_input *input) {
    const rows r = rows_of(batch, lane);
    put_input(&r, lane, input);
}

void laconic_batch_input(const laconic_batch *batch, int32_t lane, laconic_input *input) {
    const rows r = rows_of(batch, lane);
    input_in(input, &r, lane);
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
    const rows r = {batch->rows, batch->row_bytes, 0};
    const int32_t outputs = ROW_OUTPUTS(batch->shape.wheel_count);
    if (row > LACONIC_BATCH_NU_3) return NULL;
    if (row >= LACONIC_BATCH_HEADING) return number_of(&r, outputs + (int32_t)(row - LACONIC_BATCH_HEADING), 0);
    if (row > LACONIC_BATCH_AXLE_TORQUE) return number_of(&r, of[row], 0);
    if (wheel < 0 || wheel >= batch->shape.wheel_count) return NULL;
    return number_of(&r, row == LACONIC_BATCH_VOLTAGE ? ROW_VOLTAGE(wheel) : ROW_AXLE_TORQUE(wheel), 0);
}

/* ---------------------------------------------------------------- blocks whose lanes lie apart -- */

static void copy_lane(const rows *to, int32_t to_lane, const rows *from, int32_t from_lane, int32_t end) {
    for (int32_t row = 0; row < end; row++)
        if (row < ROW_FRACTION || row == ROW_HEADING_REST || row >= ROW_BODY_FORCE)
            *number_of(to, row, to_lane) = *number_of(from, row, from_lane);
    *fraction_of(to, to_lane) = *fraction_of(from, from_lane);
    *turns_of(to, to_lane) = *turns_of(from, from_lane);
}

/* ------------------------------------------------------------------------------------ run -- */

/* A block while it steps. */
typedef struct walk {
    laconic_batch *batch;
    laconic_batch_block *block;
    rows at;          /* its numbers          */
    int32_t first;    /* lane of them         */
    uint32_t stopped; /* a bit for each lane  */
    int32_t refused;  /* how many             */
} walk;

/* Steps of one lane by itself; it stops where one is refused. `after`: the steps of this run that come after them. */
static void step_alone(walk *w, int32_t k, uint64_t steps, uint64_t after) {
    const int32_t lane = w->batch->order[w->block->first + k];
    const laconic_batch_kind *kind = &w->batch->kinds[w->batch->kind_of[lane]];
    laconic_state state;
    laconic_input input;
    laconic_status status;
    state_in(&state, &w->at, w->first + k);
    input_in(&input, &w->at, w->first + k);
    const uint64_t taken = laconic_run(&kind->model, &kind->integrator, &state, &input, steps, &status);
    put_state(&w->at, w->first + k, &state);
    if (status == LACONIC_OK) return;
    w->batch->status[lane] = (int32_t)status;
    w->batch->missed[lane] += steps - taken + after;
    w->stopped |= 1U << k;
    w->refused++;
}

static void step_together(walk *w, const lanes_block *lanes, uint64_t steps) {
    const uint32_t all = (uint32_t)((UINT64_C(1) << w->block->count) - 1);
    uint64_t taken = 0;
    while (taken < steps && (w->stopped & all) != all) {
        uint32_t apart;
        taken += w->batch->width->run[w->block->method](lanes, steps - taken, w->stopped, &apart);
        for (int32_t k = 0; k < w->block->count && apart >> k != 0; k++)
            if (apart >> k & 1U) step_alone(w, k, 1, steps - taken);
    }
}

static void step_block(walk *w, uint64_t steps) {
    const int32_t *lane = &w->batch->order[w->block->first];
    for (int32_t k = 0; w->block->has_refused && k < w->block->count; k++) w->batch->status[lane[k]] = LACONIC_OK;
    if (w->batch->width == NULL) {
        step_alone(w, 0, steps, 0);
    } else {
        lanes_block lanes = w->block->lanes;
        lanes.rows = w->at.first;
        lanes.row_bytes = w->at.row_bytes;
        lanes.first = w->first;
        w->stopped = ~(uint32_t)((UINT64_C(1) << w->block->count) - 1); /* lanes that the block lacks */
        step_together(w, &lanes, steps);
    }
    w->block->has_refused = w->refused > 0;
}

/* The numbers of lanes that lie apart are copied side by side, and back. */
static void step_gathered(walk *w, uint64_t steps) {
    enum { ROWS = ROW_OUTPUTS(LACONIC_MAX_WHEELS), LARGEST_WIDTH = 64 };
    uint64_t memory[ROWS * LARGEST_WIDTH / sizeof(uint64_t)];
    const rows all = w->at;
    const rows copy = {(unsigned char *)memory, LARGEST_WIDTH, all.wheel_count};
    const int32_t *lane = &w->batch->order[w->block->first], lanes = lanes_of_width(w->batch->width);
    for (int32_t k = 0; k < lanes; k++)
        copy_lane(&copy, k, &all, lane[k < w->block->count ? k : 0], ROW_OUTPUTS(all.wheel_count));
    w->at = copy;
    w->first = 0;
    step_block(w, steps);
    for (int32_t k = 0; k < w->block->count; k++) copy_lane(&all, lane[k], &copy, k, ROW_BODY_FORCE);
}

int32_t laconic_batch_run(laconic_batch *batch, int32_t first_block, int32_t blocks, uint64_t steps) {
    int32_t refused = 0;
    for (int32_t i = first_block; i < first_block + blocks; i++) {
        laconic_batch_block *block = &batch->blocks[i];
        const rows all = {batch->rows, batch->row_bytes, block->wheel_count};
        walk w = {batch, block, all, batch->order[block->first], 0, 0};
        if (block->in_a_row)
            step_block(&w, steps);
        else
            step_gathered(&w, steps);
        refused += w.refused;
    }
    return refused;
}

/* -------------------------------------------------------------------------------- outputs -- */

void laconic_batch_observe(laconic_batch *batch, int32_t first_block, int32_t blocks) {
    const int32_t outputs = ROW_OUTPUTS(batch->shape.wheel_count);
    for (int32_t i = first_block; i < first_block + blocks; i++)
        for (int32_t k = 0; k < batch->blocks[i].count; k++) {
            const int32_t lane = batch->order[batch->blocks[i].first + k];
            const rows r = rows_of(batch, lane);
            laconic_state state;
            real nu[3];
            state_in(&state, &r, lane);
            laconic_nu(&batch->kinds[batch->kind_of[lane]].model, &state, nu);
            *number_of(&r, outputs, lane) = heading_unwrapped(&state.heading);
            for (int32_t c = 0; c < 3; c++) *number_of(&r, outputs + 1 + c, lane) = nu[c];
        }
}
