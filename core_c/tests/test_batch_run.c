/* Tests of batch_run.c: every lane has the bits and the refusals of laconic_run(). The number of steps may be given. */
#include <stdio.h>
#include <stdlib.h>

#include "population.h"

static population all;
static uint64_t steps = 12000;

static void compare(int32_t width_bytes) {
    if (laconic_batch_width(width_bytes) == 0) TEST_IGNORE_MESSAGE("this processor or build has no such registers");
    all.random = 4;
    all.steps = all.refused = 0;
    compare_steps(&all, width_bytes, steps);
    TEST_ASSERT_TRUE(all.refused * 40 > all.steps / 40);
    printf("%llu steps, %llu refused\n", (unsigned long long)all.steps, (unsigned long long)all.refused);
}

static void lanes_have_the_bits_of_one_vehicle_one_by_one(void) { compare(1); }

static void lanes_have_the_bits_of_one_vehicle_in_16_bytes(void) { compare(16); }

static void lanes_have_the_bits_of_one_vehicle_in_32_bytes(void) { compare(32); }

static void lanes_have_the_bits_of_one_vehicle_in_64_bytes(void) { compare(64); }

static void heading_and_nu_are_those_of_the_state(void) {
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

int main(int argc, char **argv) {
    if (argc > 1) steps = strtoull(argv[1], NULL, 10);
    UNITY_BEGIN();
    RUN_TEST(lanes_have_the_bits_of_one_vehicle_one_by_one);
    RUN_TEST(lanes_have_the_bits_of_one_vehicle_in_16_bytes);
    RUN_TEST(lanes_have_the_bits_of_one_vehicle_in_32_bytes);
    RUN_TEST(lanes_have_the_bits_of_one_vehicle_in_64_bytes);
    RUN_TEST(heading_and_nu_are_those_of_the_state);
    RUN_TEST(rows_are_the_inputs_of_lanes);
    return UNITY_END();
}
