/* Batches of random vehicles, states and inputs, many of which refuse, and their comparison with one vehicle at a time.
 * The same numbers on every machine. */
#ifndef LACONIC_TEST_POPULATION_H
#define LACONIC_TEST_POPULATION_H

#include "laconic/batch.h"
#include "vehicles.h"

#define LANES 100
#define KINDS 24
#define MEMORY (1 << 21)

typedef struct population {
    uint64_t random;
    bool is_uniform; /* all lanes of one kind */
    laconic_batch_kind kinds[KINDS];
    int32_t kind_of[LANES];
    laconic_state states[LANES];
    laconic_input inputs[LANES];
    uint64_t missed[LANES];
    laconic_batch batch;
    uint64_t steps, refused; /* counted over all comparisons */
    uint64_t memory[MEMORY / 8 + 8];
} population;

static inline uint64_t next_random(population *p) {
    p->random ^= p->random << 13;
    p->random ^= p->random >> 7;
    p->random ^= p->random << 17;
    return p->random;
}

/* From −1 to 1. */
static inline double around_zero(population *p) { return (double)(int64_t)next_random(p) / 9223372036854775808.0; }

static inline int one_of(population *p, int count) { return (int)(next_random(p) >> 33) % count; }

static inline bool seldom(population *p) { return one_of(p, 40) == 0; }

/* From small^1 to large^1, evenly in its logarithm. */
static inline double between(population *p, double small, double large) {
    return small * pow(large / small, 0.5 + 0.5 * around_zero(p));
}

static inline laconic_vehicle random_vehicle(population *p) {
    laconic_vehicle v = one_of(p, 2)   ? three_wheels()
                        : one_of(p, 2) ? mecanum()
                        : one_of(p, 2) ? differential_drive()
                                       : bare_body();
    if (one_of(p, 4)) v = with_motors(v);
    v.mass_kg = REAL(between(p, 1, 30));
    v.motor_damping_Nms = REAL((double)v.motor_damping_Nms * between(p, 0.1, 30));
    if (one_of(p, 4) == 0) v.ground.slope_rad = REAL(0.1);
    if (v.wheel_count > 2 && one_of(p, 4) == 0) v.wheel[1].own_motor_gain_Nm_per_V = REAL(0.3);
    return v;
}

static inline void random_kind(population *p, laconic_batch_kind *kind) {
    laconic_refusal why;
    laconic_status status;
    do { /* explicit methods refuse large steps of damped vehicles */
        const laconic_vehicle v = random_vehicle(p);
        const laconic_method *method = laconic_method_by_number(one_of(p, LACONIC_METHOD_COUNT));
        status = laconic_batch_kind_of(kind, &v, method, REAL(between(p, 1e-3, 0.3)), &why);
    } while (status != LACONIC_OK);
}

static inline void random_state(population *p, const laconic_model *model, laconic_state *state) {
    laconic_start start;
    laconic_refusal why;
    const double speed = between(p, 0.1, seldom(p) ? 1e4 : 30);
    memset(&start, 0, sizeof start);
    for (int k = 0; k < 3; k++) start.nu_rad_per_s[k] = REAL(speed * around_zero(p));
    start.x_m = REAL(10 * around_zero(p));
    start.heading_rad = REAL(100 * around_zero(p));
    ASSERT_STATUS(LACONIC_OK, laconic_state_project(state, model, &start, &why));
    if (seldom(p)) state->heading.turns = ((int64_t)1 << 62) - one_of(p, 2);
    state->wheel_angle_set_rad[0] = REAL(around_zero(p));
}

static inline void random_input(population *p, laconic_input *in) {
    memset(in, 0, sizeof *in);
    for (int i = 0; i < 4; i++) in->voltage_V[i] = REAL(12 * around_zero(p));
    if (one_of(p, 3) == 0) in->axle_torque_Nm[one_of(p, 3)] = REAL(around_zero(p));
    if (one_of(p, 3) == 0) in->body_force_N[one_of(p, 2)] = REAL(20 * around_zero(p));
    if (one_of(p, 3) == 0) in->body_moment_Nm = REAL(5 * around_zero(p));
    if (one_of(p, 3) == 0) in->world_force_N[one_of(p, 2)] = REAL(20 * around_zero(p));
    in->world_force_point_m[0] = REAL(0.1 * around_zero(p));
    if (seldom(p)) in->world_force_point_m[1] = seldom(p) ? INFINITE : NOT_A_NUMBER;
    if (seldom(p)) in->voltage_V[0] = NOT_A_NUMBER;
}

static inline void place(population *p, int32_t width_bytes) {
    const laconic_batch_shape shape = {LANES, p->is_uniform ? 1 : KINDS, 4, width_bytes};
    void *memory = (void *)(((uintptr_t)p->memory + 63) / 64 * 64);
    TEST_ASSERT_TRUE(laconic_batch_size(&shape) <= MEMORY);
    TEST_ASSERT_TRUE(laconic_batch_place(&p->batch, memory, &shape, p->kinds, p->kind_of));
}

static inline void fill(population *p, int32_t width_bytes) {
    for (int k = 0; k < KINDS; k++) random_kind(p, &p->kinds[k]);
    for (int i = 0; i < LANES; i++) p->kind_of[i] = p->is_uniform ? 0 : one_of(p, KINDS);
    place(p, width_bytes);
    for (int i = 0; i < LANES; i++) {
        random_state(p, &p->kinds[p->kind_of[i]].model, &p->states[i]);
        laconic_batch_load(&p->batch, i, &p->states[i]);
        p->missed[i] = 0;
    }
}

/* The lane has what laconic_run() leaves of the state, and refuses as it does. */
static inline void compare_lane(population *p, int32_t lane, uint64_t steps) {
    const laconic_batch_kind *kind = &p->kinds[p->kind_of[lane]];
    laconic_status status;
    laconic_state stored = p->states[lane];
    const uint64_t taken =
        laconic_run(&kind->model, &kind->integrator, &p->states[lane], &p->inputs[lane], steps, &status);
    laconic_batch_store(&p->batch, lane, &stored);
    TEST_ASSERT_EQUAL_INT(status, p->batch.status[lane]);
    TEST_ASSERT_EQUAL_MEMORY(&p->states[lane], &stored, sizeof stored);
    p->missed[lane] += steps - taken;
    TEST_ASSERT_TRUE(p->missed[lane] == p->batch.missed[lane]);
    p->steps += taken;
    p->refused += status != LACONIC_OK;
}

/* New inputs of all lanes, a few steps, the comparison. */
static inline void step_and_compare(population *p) {
    const uint64_t steps = (uint64_t)(1 + one_of(p, 4)), before = p->refused;
    for (int i = 0; i < LANES; i++) random_input(p, &p->inputs[i]);
    for (int i = 0; i < LANES; i++) laconic_batch_set_input(&p->batch, i, &p->inputs[i]);
    const int32_t refused = laconic_batch_run(&p->batch, 0, p->batch.block_count, steps);
    for (int i = 0; i < LANES; i++) compare_lane(p, i, steps);
    TEST_ASSERT_EQUAL_UINT64(p->refused - before, (uint64_t)refused);
}

/* At least so many steps of populations in turn mixed and uniform. */
static inline void compare_steps(population *p, int32_t width_bytes, uint64_t steps) {
    while (p->steps < steps) {
        fill(p, width_bytes);
        for (int i = 0; i < 12; i++) step_and_compare(p);
        p->is_uniform = !p->is_uniform;
    }
}

#endif
