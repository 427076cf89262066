/* Tests of batch_run.c: every lane has the bits and the refusals of laconic_run(). The number of steps may be given. */
#include <stdio.h>
#include <stdlib.h>

#include "population.h"

static population all;
static uint64_t steps = 12000;

/* No test depends on those before it, of which a processor with fewer registers leaves some out. */
static void begin(uint64_t random) {
    all.random = random;
    all.is_uniform = false;
    all.steps = all.refused = 0;
}

static void compare(int32_t width_bytes) {
    if (laconic_batch_width(width_bytes) == 0) TEST_IGNORE_MESSAGE("this processor or build has no such registers");
    begin(4);
    compare_steps(&all, width_bytes, steps);
    TEST_ASSERT_TRUE(all.refused * 40 > all.steps / 40);
    printf("%llu steps, %llu refused\n", (unsigned long long)all.steps, (unsigned long long)all.refused);
}

static void lanes_have_the_bits_of_one_vehicle_one_by_one(void) { compare(1); }

static void lanes_have_the_bits_of_one_vehicle_in_16_bytes(void) { compare(16); }

static void lanes_have_the_bits_of_one_vehicle_in_32_bytes(void) { compare(32); }

static void lanes_have_the_bits_of_one_vehicle_in_64_bytes(void) { compare(64); }

/* Neighbours with equally many panels, of which one is long beside the damping of an axis in some lanes alone. */
static void panels_of_neighbours_have_the_bits_of_one_vehicle(void) {
    static const int32_t widths[3] = {16, 32, 64};
    for (int w = 0; w < 3; w++) {
        if (laconic_batch_width(widths[w]) == 0) continue;
        begin(5);
        for (int k = 0; k < KINDS; k++) {
            laconic_refusal why;
            laconic_vehicle v = with_motors(three_wheels());
            v.motor_damping_Nms = REAL(0.2 + 0.15 * k);
            ASSERT_STATUS(LACONIC_OK,
                          laconic_batch_kind_of(&all.kinds[k], &v, &laconic_exponential_gauss_8, REAL(0.1), &why));
        }
        for (int i = 0; i < LANES; i++) all.kind_of[i] = i % KINDS;
        place(&all, widths[w]);
        for (int i = 0; i < LANES; i++) {
            all.states[i] = moving(&all.kinds[all.kind_of[i]].model, 3, -2, 0.05 * i);
            laconic_batch_load(&all.batch, i, &all.states[i]);
            all.missed[i] = 0;
        }
        for (int i = 0; i < 6; i++) step_and_compare(&all);
        TEST_ASSERT_TRUE(all.steps > 3 * LANES);
    }
}

/* Beside lanes of methods that registers know; a user may write such a method, too. */
static void lanes_of_a_method_that_registers_do_not_know_have_the_bits_of_one_vehicle(void) {
    static const int32_t widths[4] = {1, 16, 32, 64};
    const laconic_method own = laconic_rk4;
    for (int w = 0; w < 4; w++) {
        if (laconic_batch_width(widths[w]) == 0) continue;
        begin(6);
        for (int k = 0; k < KINDS; k++) {
            laconic_refusal why;
            const laconic_vehicle v = with_motors(three_wheels());
            const laconic_method *const methods[3] = {&own, &laconic_auto, &laconic_rk4};
            ASSERT_STATUS(LACONIC_OK, laconic_batch_kind_of(&all.kinds[k], &v, methods[k % 3], REAL(0.01), &why));
        }
        for (int i = 0; i < LANES; i++) all.kind_of[i] = i % KINDS;
        place(&all, widths[w]);
        for (int i = 0; i < LANES; i++) {
            all.states[i] = moving(&all.kinds[all.kind_of[i]].model, 3, -2, 0.05 * i);
            laconic_batch_load(&all.batch, i, &all.states[i]);
            all.missed[i] = 0;
        }
        for (int i = 0; i < 6; i++) step_and_compare(&all);
        TEST_ASSERT_TRUE(all.steps > 3 * LANES && all.refused > 0);
        for (int i = 0; i < LANES; i++) {
            const laconic_state *state = &all.states[i];
            TEST_ASSERT_TRUE(state->x_m.value == laconic_batch_row_of(&all.batch, LACONIC_BATCH_X, 0)[i]);
            TEST_ASSERT_TRUE(state->y_m.value == laconic_batch_row_of(&all.batch, LACONIC_BATCH_Y, 0)[i]);
        }
    }
}

static void heading_and_nu_are_those_of_the_state(void) {
    begin(7);
    fill(&all, 0);
    laconic_batch_observe(&all.batch, 0, all.batch.block_count);
    for (int i = 0; i < LANES; i++) {
        laconic_real x, y, heading, nu[3];
        laconic_position(&all.states[i], &x, &y, &heading);
        laconic_nu(&all.kinds[all.kind_of[i]].model, &all.states[i], nu);
        TEST_ASSERT_TRUE(x == laconic_batch_row_of(&all.batch, LACONIC_BATCH_X, 0)[i]);
        TEST_ASSERT_TRUE(y == laconic_batch_row_of(&all.batch, LACONIC_BATCH_Y, 0)[i]);
        TEST_ASSERT_TRUE(heading == laconic_batch_row_of(&all.batch, LACONIC_BATCH_HEADING, 0)[i]);
        for (int k = 0; k < 3; k++)
            TEST_ASSERT_TRUE(nu[k] ==
                             laconic_batch_row_of(&all.batch, (laconic_batch_row)(LACONIC_BATCH_NU_1 + k), 0)[i]);
    }
}

static void rows_are_the_inputs_of_lanes(void) {
    laconic_input in;
    begin(8);
    fill(&all, 0);
    for (int row = 0; row < LACONIC_BATCH_X; row++)
        laconic_batch_row_of(&all.batch, (laconic_batch_row)row, 1)[7] = REAL(row + 1);
    memset(&in, 0, sizeof in);
    all.kind_of[7] = 0;
    laconic_batch_input(&all.batch, 7, &in);
    const laconic_real found[] = {in.body_force_N[0],       in.body_force_N[1],  in.body_moment_Nm,
                                  in.world_force_N[0],      in.world_force_N[1], in.world_force_point_m[0],
                                  in.world_force_point_m[1]};
    for (int k = 0; k < 7; k++) TEST_ASSERT_TRUE(found[k] == REAL(k + 3));
    TEST_ASSERT_NULL(laconic_batch_row_of(&all.batch, LACONIC_BATCH_VOLTAGE, 4));
    TEST_ASSERT_NULL(laconic_batch_row_of(&all.batch, LACONIC_BATCH_AXLE_TORQUE, -1));
    TEST_ASSERT_NULL(laconic_batch_row_of(&all.batch, LACONIC_BATCH_ROW_COUNT, 0));
}

#define SAMPLES 5

/* Steps of one lane alone under all its samples; returns how many it took, and the sample at which it ended. */
static uint64_t run_alone(int lane, uint64_t steps_each, const laconic_real *voltage, laconic_status *status, int *at) {
    const laconic_batch_kind *kind = &all.kinds[all.kind_of[lane]];
    uint64_t taken = 0;
    for (*at = 0; *at < SAMPLES; (*at)++) {
        for (int w = 0; w < 4; w++) all.inputs[lane].voltage_V[w] = voltage[(*at * 4 + w) * LANES + lane];
        taken += laconic_run(&kind->model, &kind->integrator, &all.states[lane], &all.inputs[lane], steps_each, status);
        if (*status != LACONIC_OK) return taken;
    }
    *at = SAMPLES - 1;
    return taken;
}

static void compare_sampled(uint64_t steps_each, const laconic_real *voltage) {
    for (int i = 0; i < LANES; i++) {
        laconic_state stored = all.states[i];
        laconic_status status;
        int at;
        const uint64_t taken = run_alone(i, steps_each, voltage, &status, &at);
        laconic_batch_store(&all.batch, i, &stored);
        TEST_ASSERT_EQUAL_INT(status, all.batch.status[i]);
        TEST_ASSERT_EQUAL_MEMORY(&all.states[i], &stored, sizeof stored);
        TEST_ASSERT_TRUE(all.batch.missed[i] == SAMPLES * steps_each - taken);
        all.refused += status != LACONIC_OK;
        if (all.kinds[all.kind_of[i]].model.wheel_count > 0)
            TEST_ASSERT_EQUAL_MEMORY(&voltage[at * 4 * LANES + i],
                                     &laconic_batch_row_of(&all.batch, LACONIC_BATCH_VOLTAGE, 0)[i],
                                     sizeof(laconic_real));
    }
}

static void sampled_voltages_are_those_of_a_run_for_each_sample(void) {
    static const int32_t widths[] = {1, 16, 32, 64};
    static laconic_real voltage[SAMPLES * 4 * LANES];
    begin(9);
    for (int w = 0; w < 8; w++) {
        if (laconic_batch_width(widths[w / 2]) == 0) continue;
        all.is_uniform = w % 2;
        fill(&all, widths[w / 2]);
        for (int i = 0; i < LANES; i++) random_input(&all, &all.inputs[i]);
        for (int i = 0; i < LANES; i++) laconic_batch_set_input(&all.batch, i, &all.inputs[i]);
        for (int i = 0; i < SAMPLES * 4 * LANES; i++)
            voltage[i] = one_of(&all, 400) == 0 ? NOT_A_NUMBER : REAL(12 * around_zero(&all));
        all.refused = 0;
        const int32_t refused =
            laconic_batch_run_sampled(&all.batch, 0, all.batch.block_count, SAMPLES, (uint64_t)(1 + w), voltage);
        compare_sampled((uint64_t)(1 + w), voltage);
        TEST_ASSERT_EQUAL_UINT64(all.refused, (uint64_t)refused);
        TEST_ASSERT_TRUE(refused > 0);
    }
}

int main(int argc, char **argv) {
    if (argc > 1) steps = strtoull(argv[1], NULL, 10);
    UNITY_BEGIN();
    RUN_TEST(lanes_have_the_bits_of_one_vehicle_one_by_one);
    RUN_TEST(lanes_have_the_bits_of_one_vehicle_in_16_bytes);
    RUN_TEST(lanes_have_the_bits_of_one_vehicle_in_32_bytes);
    RUN_TEST(lanes_have_the_bits_of_one_vehicle_in_64_bytes);
    RUN_TEST(panels_of_neighbours_have_the_bits_of_one_vehicle);
    RUN_TEST(lanes_of_a_method_that_registers_do_not_know_have_the_bits_of_one_vehicle);
    RUN_TEST(heading_and_nu_are_those_of_the_state);
    RUN_TEST(rows_are_the_inputs_of_lanes);
    RUN_TEST(sampled_voltages_are_those_of_a_run_for_each_sample);
    return UNITY_END();
}
