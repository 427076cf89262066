/* Tests of integrity.c: how long what was found stays so, and what heals it. */
#include "integrity_bench.h"
#include "laconic_dbc.h"
#include "laconic_node/protection.h"

void setUp(void) {}
void tearDown(void) {}

static void wait_two_rounds(void) {
    for (uint32_t k = 0; k < 2 * LACONIC_INTEGRITY_ROUND_US / TICK_US + 2; k++) {
        on.time_us += TICK_US;
        bench_tick(&on);
    }
}

/* A node whose model is found to be wrong. */
static void with_a_wrong_model(uint8_t checks) {
    bench_power_up(&on, 7, 0, checks);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    on.node.plant.vehicle.mass_kg *= 2;
    wait_two_rounds();
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MODEL, on.integrity.broken);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
}

/* The next COMMIT of the session, with a checksum of nothing that was loaded; its status. */
static uint8_t commit_what_was_not_loaded(void) {
    const struct laconic_dbc_commit_t commit = {.checksum = 12345};
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_COMMIT, .length = 8};
    laconic_dbc_commit_pack(frame.data, &commit, 8);
    laconic_protect_keyed(LACONIC_WIRE_COMMIT, frame.data, on.node.session.key,
                          on.node.session.count[LACONIC_WIRE_COMMIT] + 1U);
    bench_frame(&on, &frame);
    return on.node.answer[LACONIC_WIRE_COMMIT].status;
}

static void test_a_commit_that_is_refused_makes_no_vehicle(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_open(&on));
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATUS_CHECKSUM_MISMATCH, commit_what_was_not_loaded());
    TEST_ASSERT_FALSE(on.integrity.has_vehicle);
    wait_two_rounds();
    TEST_ASSERT_EQUAL_UINT32(0, on.integrity.rounds);
}

static void test_a_commit_that_is_refused_heals_no_model(void) {
    with_a_wrong_model(LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_open(&on));
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATUS_CHECKSUM_MISMATCH, commit_what_was_not_loaded());
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MODEL, on.integrity.broken);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
    (void)rig_command(&on, LACONIC_WIRE_COMMAND_RESET);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
}

/* A rig that selects nothing sends its next frame: the model is that of COMMIT still. */
static void test_only_the_frame_of_a_commit_is_one(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_SUM);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    on.node.session.count[LACONIC_WIRE_SELECT] = 0;
    on.node.plant.vehicle.mass_kg *= 2;
    TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_STOP));
    wait_two_rounds();
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MODEL, on.integrity.broken);
}

/* Whatever state it is found in, and whichever wheel's encoder is next: the next frame, even one that is malformed,
 * leads back to FAULT. */
static void test_a_wrong_model_moves_in_no_state(void) {
    const laconic_frame malformed = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_COMMIT, .length = 3};
    with_a_wrong_model(LACONIC_INTEGRITY_SUM);
    for (uint8_t state = LACONIC_WIRE_STATE_READY; state <= LACONIC_WIRE_STATE_DRIVES; state++) {
        on.node.state = state;
        on.node.encoder_wheel = 0;
        bench_frame(&on, &malformed);
        TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
        TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MODEL, on.integrity.broken);
    }
}

static void test_a_wrong_model_is_found_behind_a_wrong_motion(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    on.node.plant.steps++;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MOTION, on.integrity.broken);
    on.node.plant.vehicle.mass_kg *= 2;
    wait_two_rounds();
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MODEL, on.integrity.broken);
}

/* RESET heals the motion whatever part of the model the round has come to, and whichever wheel's encoder is next. */
static void test_a_motion_that_was_wrong_is_sound_again_when_the_rig_resets_it(void) {
    const uint8_t checks[] = {LACONIC_INTEGRITY_MOTION, LACONIC_INTEGRITY_RANGE};
    for (size_t k = 0; k < sizeof checks; k++)
        for (uint8_t part = 0; part <= LACONIC_INTEGRITY_OF_MODEL; part++) {
            laconic_frame told;
            in_free_run_with(checks[k]);
            const laconic_integrity_limits limits = on.integrity.limits;
            on.node.encoder_wheel = 0;
            laconic_integrity_begin(&on.integrity, &on.node, &on.config, &limits, on.checks);
            on.integrity.has_vehicle = true;
            on.integrity.part = part;
            on.node.plant.state.x_m.value = 5000;
            bench_tick(&on);
            TEST_ASSERT_EQUAL(k == 0 ? LACONIC_INTEGRITY_OF_MOTION : LACONIC_INTEGRITY_OF_RANGE, on.integrity.broken);
            while (bench_next(&on, &told)) TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
            TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_RESET));
            TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_READY, on.node.state);
            TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
        }
}

/* A number changes after it was loaded; HELLO, which loads nothing, comes before COMMIT. */
static void test_a_frame_that_loads_nothing_hides_no_change_of_what_was_loaded(void) {
    const laconic_frame hello = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HELLO, .length = 8};
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_open(&on));
    on.node.loader.parameters.vehicle.mass_kg = 5;
    bench_frame(&on, &hello);
    (void)commit_what_was_not_loaded();
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATUS_MEMORY_CHANGED, on.node.answer[LACONIC_WIRE_COMMIT].status);
}

static void test_what_a_node_without_a_vehicle_has_found_stays_until_there_is_one(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    on.node.session.key ^= 1U;
    on.time_us = 12345;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MOTION, on.integrity.broken);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_EMPTY, on.node.state);
    TEST_ASSERT_EQUAL_UINT32(12345, on.node.heartbeat_us); /* as after power-up at this time */
    TEST_ASSERT_TRUE(rig_open(&on));
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MOTION, on.integrity.broken);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

/* It would lose what is being loaded for a motion that it does not have. */
static void test_a_node_without_a_vehicle_has_no_motion_to_be_out_of_range(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_RANGE);
    on.node.loader.frame_count = 3;
    on.node.plant.state.x_m.value = 5000;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
    TEST_ASSERT_EQUAL_UINT16(3, on.node.loader.frame_count);
}

/* Without any other check, too: the configuration is always compared. */
static void test_a_configuration_that_was_wrong_is_sound_again_when_no_check_is_chosen(void) {
    laconic_frame told;
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_SUM);
    const laconic_integrity_limits limits = on.integrity.limits;
    laconic_integrity_begin(&on.integrity, &on.node, &on.config, &limits, 0);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    on.node.config.nonce_seed ^= 1U;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_CONFIGURATION, on.integrity.broken);
    while (bench_next(&on, &told)) TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
    TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_RESET));
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

/* A wrong count of wheels leads behind the arrays of a vehicle, and a wrong pointer anywhere: neither is used. */
static void test_no_order_but_a_commit_uses_a_model_that_is_wrong(void) {
    const size_t bytes[] = {BYTE(plant.model.wheel_count), BYTE(plant.model.dof), BYTE(plant.integrator.step_s),
                            BYTE(plant.integrator.chosen), BYTE(plant.integrator.method)};
    const uint8_t orders[] = {LACONIC_WIRE_COMMAND_START_FREE_RUN, LACONIC_WIRE_COMMAND_RESET,
                              LACONIC_WIRE_COMMAND_START_LOCKSTEP};
    for (size_t k = 0; k < sizeof bytes / sizeof bytes[0]; k++)
        for (uint8_t bit = 0; bit < 32; bit++) {
            laconic_frame told;
            in_free_run_with(LACONIC_INTEGRITY_MOTION);
            ((uint8_t *)&on.node)[bytes[k] + bit / 8] ^= (uint8_t)(1U << bit % 8);
            bench_tick(&on);
            TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MODEL, on.integrity.broken);
            while (bench_next(&on, &told)) TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
            for (size_t order = 0; order < sizeof orders; order++) {
                TEST_ASSERT_EQUAL(LACONIC_WIRE_STATUS_WRONG_STATE, rig_command(&on, orders[order]));
                TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
            }
            TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MODEL, on.integrity.broken);
        }
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

static uint8_t seen;

/* Called when the node identifies itself, and last of all while it handles COMMIT. */
static const laconic_method *look_at_the_state(int32_t number) {
    seen = on.node.state;
    return laconic_method_by_number(number);
}

/* Whoever looks during a call, such as an interrupt or a function of the configuration, sees the fault. */
static void test_a_wrong_model_is_shown_as_a_fault_while_a_frame_is_handled(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    on.config.method = on.node.config.method = look_at_the_state;
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    on.node.plant.vehicle.mass_kg *= 2;
    wait_two_rounds();
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
    seen = 255;
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, seen);
    TEST_ASSERT_FALSE(on.node.model_is_wrong);
}

/* An estimate would read it with each heartbeat. That of a motion begins anew with RESET. */
static void test_an_estimate_ends_with_the_model_that_it_is_of(void) {
    laconic_frame told;
    in_free_run_with(LACONIC_INTEGRITY_MOTION);
    on.node.estimates = true;
    on.node.plant.steps++;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MOTION, on.integrity.broken);
    TEST_ASSERT_TRUE(on.node.estimates);
    in_free_run_with(LACONIC_INTEGRITY_MOTION);
    on.node.estimates = true;
    on.node.plant.model.wheel_count ^= 1 << 25;
    for (int k = 0; k < 20; k++) {
        on.time_us += TICK_US;
        bench_tick(&on);
        while (bench_next(&on, &told)) TEST_ASSERT_TRUE(told.id != LACONIC_WIRE_ID_BASE + LACONIC_WIRE_ERROR_ESTIMATE);
    }
    TEST_ASSERT_FALSE(on.node.estimates);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MODEL, on.integrity.broken);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_commit_that_is_refused_makes_no_vehicle);
    RUN_TEST(test_a_commit_that_is_refused_heals_no_model);
    RUN_TEST(test_only_the_frame_of_a_commit_is_one);
    RUN_TEST(test_a_wrong_model_moves_in_no_state);
    RUN_TEST(test_a_wrong_model_is_found_behind_a_wrong_motion);
    RUN_TEST(test_a_motion_that_was_wrong_is_sound_again_when_the_rig_resets_it);
    RUN_TEST(test_a_frame_that_loads_nothing_hides_no_change_of_what_was_loaded);
    RUN_TEST(test_what_a_node_without_a_vehicle_has_found_stays_until_there_is_one);
    RUN_TEST(test_a_node_without_a_vehicle_has_no_motion_to_be_out_of_range);
    RUN_TEST(test_a_configuration_that_was_wrong_is_sound_again_when_no_check_is_chosen);
    RUN_TEST(test_no_order_but_a_commit_uses_a_model_that_is_wrong);
    RUN_TEST(test_a_wrong_model_is_shown_as_a_fault_while_a_frame_is_handled);
    RUN_TEST(test_an_estimate_ends_with_the_model_that_it_is_of);
    return UNITY_END();
}
