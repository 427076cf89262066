/* Memory that changed without a call is noticed, told and ends the run; sound memory never is. */
#include "../campaign/rig.h"

#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static bench on;

/* Which bit changes before which event of the session; events count from 1. */
typedef struct fault {
    size_t byte;
    uint8_t bits;
    int before, events;
    uint32_t at_us, noticed_us;
    uint8_t noticed; /* first */
} fault;

static void change(bench *at, void *with) {
    fault *it = with;
    it->events++;
    if (it->events == it->before) {
        ((uint8_t *)&at->node)[it->byte] ^= it->bits;
        it->at_us = at->time_us;
    }
    if (it->noticed != 0 || at->integrity.broken == 0) return;
    it->noticed = at->integrity.broken;
    it->noticed_us = at->time_us;
}

enum { IN_LOADING = 20, IN_FREE_RUN = 150 };

/* A session in which these bits change. */
static fault session_with(size_t byte, uint8_t bits, int before, uint8_t checks) {
    fault it = {.byte = byte, .bits = bits, .before = before};
    bench_power_up(&on, 7, 0xFFFFF000U, checks);
    (void)rig_session(&on, NULL, change, &it);
    return it;
}

#define BYTE(member) offsetof(laconic_node, member)

static void test_a_sound_node_moves_as_one_that_is_not_watched(void) {
    static bench alone;
    bench_power_up(&alone, 7, 0xFFFFF000U, 0);
    TEST_ASSERT_TRUE(rig_session(&alone, NULL, NULL, NULL));
    bench_power_up(&on, 7, 0xFFFFF000U, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
    TEST_ASSERT_TRUE(same_motion(&on.node, &alone.node));
    TEST_ASSERT_TRUE(on.integrity.rounds >= 4);
}

static void test_a_changed_model_ends_the_run_within_a_second(void) {
    const size_t bytes[] = {BYTE(plant.model.decay_per_s), BYTE(plant.vehicle.mass_kg), BYTE(start.heading_rad),
                            BYTE(plant.integrator.decay),  BYTE(sensors.settings),      BYTE(drive_plan),
                            BYTE(plant.friction) + 100};
    for (size_t k = 0; k < sizeof bytes / sizeof bytes[0]; k++) {
        const fault it = session_with(bytes[k], 1, IN_FREE_RUN, LACONIC_INTEGRITY_ALL);
        TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MODEL, on.integrity.broken);
        TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
        TEST_ASSERT_TRUE(it.noticed_us > 0 && it.noticed_us - it.at_us <= 1020000U);
        for (int i = 0; i < 3; i++) TEST_ASSERT_TRUE(on.node.input[0].voltage_V[i] == 0);
        TEST_ASSERT_EQUAL(LACONIC_WIRE_STATUS_MEMORY_CHANGED, on.node.answer[LACONIC_WIRE_SYNC].status);
        TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MODEL, on.node.answer[LACONIC_WIRE_SYNC].item);
    }
}

static void test_only_commit_heals_a_changed_model(void) {
    session_with(BYTE(plant.model.decay_per_s), 1, IN_FREE_RUN, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_open(&on));
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
    (void)rig_command(&on, LACONIC_WIRE_COMMAND_RESET);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

static void test_a_changed_motion_is_noticed_by_the_next_call(void) {
    const size_t bytes[] = {BYTE(plant.state.zeta),
                            BYTE(plant.state.heading.fraction),
                            BYTE(plant.steps),
                            BYTE(input[0].voltage_V),
                            BYTE(session.run_key),
                            BYTE(free_run.next_us),
                            BYTE(plant.integrator.chosen),
                            BYTE(plant.model.wheel_count),
                            BYTE(state)};
    for (size_t k = 0; k < sizeof bytes / sizeof bytes[0]; k++) {
        const fault it = session_with(bytes[k], 2, IN_FREE_RUN, LACONIC_INTEGRITY_ALL);
        TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MOTION, it.noticed);
        TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
        TEST_ASSERT_TRUE(it.noticed_us - it.at_us <= TICK_US);
    }
}

static void test_reset_heals_a_changed_motion(void) {
    session_with(BYTE(plant.state.zeta), 2, IN_FREE_RUN, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
    TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_RESET));
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_READY, on.node.state);
    TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_START_FREE_RUN));
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

static void in_free_run(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_RANGE);
    (void)rig_session(&on, NULL, NULL, NULL);
    TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_RESET));
    TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_START_FREE_RUN));
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FREE_RUN, on.node.state);
}

/* A number that no motion has is noticed after the tick, FAULT and its item told. */
static void expect_out_of_range(void *to, laconic_real value) {
    memcpy(to, &value, sizeof value);
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_RANGE, on.integrity.broken);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
}

static void test_what_no_motion_has_is_out_of_range(void) {
    in_free_run();
    expect_out_of_range(&on.node.plant.state.zeta[0].value, 1000);
    in_free_run();
    expect_out_of_range(&on.node.plant.state.zeta[2].value, -5000);
    in_free_run();
    expect_out_of_range(&on.node.plant.state.x_m.value, 2000);
    in_free_run();
    expect_out_of_range(&on.node.plant.state.y_m.value, -2000);
    in_free_run();
    expect_out_of_range(&on.node.plant.state.x_m.rest, 1);
    in_free_run();
    expect_out_of_range(&on.node.plant.state.y_m.rest, -1);
    in_free_run();
    expect_out_of_range(&on.node.plant.state.travel[1].rest, -1);
    in_free_run();
    expect_out_of_range(&on.node.plant.state.zeta[1].rest, 1);
    in_free_run();
    expect_out_of_range(&on.node.plant.state.travel[2].rest, 1);
    in_free_run();
    expect_out_of_range(&on.node.plant.state.heading.rest, (laconic_real)1.5);
    in_free_run();
    expect_out_of_range(&on.node.input[0].voltage_V[1], 60);
    in_free_run();
    on.node.state = 77;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_RANGE, on.integrity.broken);
}

/* A node that stands still takes no step that the core would refuse. */
static void test_a_number_that_is_none_is_out_of_range_at_rest_too(void) {
    volatile laconic_real zero = 0;
    laconic_real *const numbers[] = {&on.node.plant.state.x_m.value, &on.node.plant.state.heading.rest,
                                     &on.node.input[0].voltage_V[2], &on.node.plant.state.travel[0].value};
    for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
        in_free_run();
        TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_STOP));
        expect_out_of_range(numbers[k], zero / zero);
    }
}

static void test_a_count_of_wheels_beyond_the_largest_reads_nothing_behind_them(void) {
    in_free_run();
    TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_STOP));
    on.node.plant.model.wheel_count = LACONIC_MAX_WHEELS + 100;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

static void test_two_changes_that_cancel_in_the_sum_of_words_are_noticed_by_the_other(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    uint32_t word[2];
    memcpy(word, &on.node.plant.state, sizeof word);
    word[0]++;
    word[1]--;
    memcpy(&on.node.plant.state, word, sizeof word);
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MOTION, on.integrity.broken);
}

static void test_a_possible_motion_is_in_range(void) {
    in_free_run();
    for (int k = 0; k < 50; k++) {
        on.time_us += TICK_US;
        bench_tick(&on);
    }
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_TIMEOUT, on.node.state);
}

static void test_a_sum_of_nought_may_have_a_rest(void) {
    in_free_run();
    TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_STOP));
    on.node.plant.state.x_m.value = 0;
    on.node.plant.state.x_m.rest = LACONIC_EPSILON;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
    on.node.plant.state.x_m.rest = 4 * LACONIC_EPSILON; /* the most, on either side */
    on.node.plant.state.y_m.value = 0;
    on.node.plant.state.y_m.rest = -4 * LACONIC_EPSILON;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
    on.node.plant.state.x_m.rest = 5 * LACONIC_EPSILON;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_RANGE, on.integrity.broken);
}

static void test_what_stood_in_its_memory_before_does_not_matter(void) {
    static laconic_integrity clean, dirty;
    in_free_run();
    memset(&clean, 0, sizeof clean);
    memset(&dirty, 0xA5, sizeof dirty);
    laconic_integrity_begin(&clean, &on.node, &on.config, &on.integrity.limits, on.checks);
    laconic_integrity_begin(&dirty, &on.node, &on.config, &on.integrity.limits, on.checks);
    TEST_ASSERT_EQUAL_MEMORY(&clean, &dirty, sizeof clean);
}

static void test_a_limit_of_0_is_none(void) {
    in_free_run();
    memset(&on.integrity.limits, 0, sizeof on.integrity.limits);
    on.node.plant.state.x_m.value = 1000000;
    on.node.input[0].voltage_V[0] = 1000;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

static void test_loaded_numbers_that_changed_are_refused_at_commit(void) {
    session_with(BYTE(loader.parameters.vehicle.mass_kg), 1, IN_LOADING, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATUS_MEMORY_CHANGED, on.node.answer[LACONIC_WIRE_PARAMETER].status);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATUS_MEMORY_CHANGED, on.node.answer[LACONIC_WIRE_COMMIT].status);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_LOADED, on.node.answer[LACONIC_WIRE_COMMIT].item);
    TEST_ASSERT_EQUAL(0, on.node.answer[LACONIC_WIRE_COMMIT].field);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_EMPTY, on.node.state);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
}

static void test_a_changed_configuration_is_repaired_and_told(void) {
    const size_t bytes[] = {BYTE(config.id_base), BYTE(config.can_fd), BYTE(config.method), BYTE(config.nonce_seed),
                            BYTE(config.protocol)};
    for (size_t k = 0; k < sizeof bytes / sizeof bytes[0]; k++) {
        session_with(bytes[k], 1, IN_FREE_RUN, LACONIC_INTEGRITY_SUM);
        TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_CONFIGURATION, on.node.answer[LACONIC_WIRE_SYNC].item);
        TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
        TEST_ASSERT_EQUAL_HEX16(LACONIC_WIRE_ID_BASE, on.node.config.id_base);
        TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    }
}

static void test_without_a_vehicle_the_node_begins_as_after_power_up(void) {
    const size_t bytes[] = {BYTE(config.id_base), BYTE(session.key), BYTE(state)};
    for (size_t k = 0; k < sizeof bytes / sizeof bytes[0]; k++) {
        session_with(bytes[k], 1, IN_LOADING, LACONIC_INTEGRITY_ALL);
        TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_EMPTY, on.node.state);
        TEST_ASSERT_FALSE(on.integrity.has_vehicle);
        TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    }
}

static void test_numbers_that_were_loaded_before_are_then_forgotten(void) {
    static laconic_integrity fresh;
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    on.node.loader.parameters.vehicle.mass_kg = 5;
    laconic_integrity_begin(&on.integrity, &on.node, &on.config, &on.integrity.limits, on.checks);
    on.node.session.key ^= 1U;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_EMPTY, on.node.state);
    laconic_integrity_begin(&fresh, &on.node, &on.config, &on.integrity.limits, on.checks);
    TEST_ASSERT_EQUAL_MEMORY(&fresh.loaded, &on.integrity.loaded, sizeof fresh.loaded);
}

/* Evenly: ticks of 5 ms find one slice or two due, and a round lasts its half second. */
static void test_a_round_over_the_model_lasts_its_time(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    const uint32_t rounds = on.integrity.rounds, ticks = 4 * LACONIC_INTEGRITY_ROUND_US / TICK_US;
    for (uint32_t k = 0; k < ticks; k++) {
        on.time_us += TICK_US;
        bench_tick(&on);
    }
    TEST_ASSERT_TRUE(on.integrity.rounds - rounds >= 3);
    TEST_ASSERT_TRUE(on.integrity.rounds - rounds <= 5);
}

static void test_a_tick_sees_few_slices_however_late_it_comes(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    for (int k = 0; k < 20; k++) {
        const uint32_t before = on.integrity.slices;
        const uint32_t rounds = on.integrity.rounds;
        on.time_us += 10000000U;
        bench_tick(&on);
        if (on.integrity.rounds == rounds)
            TEST_ASSERT_EQUAL(before + LACONIC_INTEGRITY_SLICES_PER_TICK, on.integrity.slices);
        TEST_ASSERT_TRUE(on.integrity.rounds <= rounds + 1);
    }
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

static void test_sampled_inputs_and_slip_count_as_motion_where_they_are_used(void) {
    const size_t bytes[] = {BYTE(input[2].voltage_V), BYTE(plant.slip)};
    for (size_t k = 0; k < sizeof bytes / sizeof bytes[0]; k++) {
        for (int used = 0; used < 2; used++) {
            bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_MOTION);
            TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
            on.node.plant.friction.acts = used == 1;
            on.node.raw_input.take = used == 1 ? LACONIC_RAW_SAMPLED : 0;
            laconic_integrity_begin(&on.integrity, &on.node, &on.config, &on.integrity.limits, on.checks);
            on.integrity.has_vehicle = true;
            ((uint8_t *)&on.node)[bytes[k]] ^= 1U;
            bench_tick(&on);
            TEST_ASSERT_EQUAL(used == 1 ? LACONIC_INTEGRITY_OF_MOTION : LACONIC_INTEGRITY_SOUND, on.integrity.broken);
        }
    }
}

/* A RESULT that nothing has asked for would be looked for without end. */
static void test_what_waits_to_be_sent_is_checked_before_it_is_fetched(void) {
    const size_t bytes[] = {BYTE(pending) + 1, BYTE(pending) + 3, BYTE(raw_output.size)};
    for (size_t k = 0; k < sizeof bytes / sizeof bytes[0]; k++) {
        laconic_frame frame;
        bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
        TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
        ((uint8_t *)&on.node)[bytes[k]] ^= 9U;
        TEST_ASSERT_TRUE(bench_next(&on, &frame));
        TEST_ASSERT_EQUAL_HEX32(LACONIC_WIRE_ID_BASE + LACONIC_WIRE_RESULT, frame.id);
        TEST_ASSERT_EQUAL(LACONIC_WIRE_STATUS_MEMORY_CHANGED, frame.data[3]);
        TEST_ASSERT_FALSE(bench_next(&on, &frame));
    }
}

static void test_a_node_whose_queue_is_not_checked_sends_as_ever(void) {
    laconic_frame frame;
    in_free_run();
    on.node.pending = 1U << LACONIC_WIRE_HEARTBEAT;
    TEST_ASSERT_TRUE(bench_next(&on, &frame));
    TEST_ASSERT_EQUAL_HEX32(LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HEARTBEAT, frame.id);
}

static void test_a_frame_for_others_and_one_that_commits_nothing_change_no_sum(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    const laconic_memory_sum before = on.integrity.model;
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_COMMIT, .length = 8, .extended = true};
    bench_frame(&on, &frame);
    frame.extended = false;
    bench_frame(&on, &frame);
    TEST_ASSERT_EQUAL_MEMORY(&before, &on.integrity.model, sizeof before);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_sound_node_moves_as_one_that_is_not_watched);
    RUN_TEST(test_a_changed_model_ends_the_run_within_a_second);
    RUN_TEST(test_only_commit_heals_a_changed_model);
    RUN_TEST(test_a_changed_motion_is_noticed_by_the_next_call);
    RUN_TEST(test_reset_heals_a_changed_motion);
    RUN_TEST(test_what_no_motion_has_is_out_of_range);
    RUN_TEST(test_a_number_that_is_none_is_out_of_range_at_rest_too);
    RUN_TEST(test_a_count_of_wheels_beyond_the_largest_reads_nothing_behind_them);
    RUN_TEST(test_two_changes_that_cancel_in_the_sum_of_words_are_noticed_by_the_other);
    RUN_TEST(test_a_possible_motion_is_in_range);
    RUN_TEST(test_a_sum_of_nought_may_have_a_rest);
    RUN_TEST(test_what_stood_in_its_memory_before_does_not_matter);
    RUN_TEST(test_a_limit_of_0_is_none);
    RUN_TEST(test_loaded_numbers_that_changed_are_refused_at_commit);
    RUN_TEST(test_a_changed_configuration_is_repaired_and_told);
    RUN_TEST(test_without_a_vehicle_the_node_begins_as_after_power_up);
    RUN_TEST(test_numbers_that_were_loaded_before_are_then_forgotten);
    RUN_TEST(test_a_round_over_the_model_lasts_its_time);
    RUN_TEST(test_a_tick_sees_few_slices_however_late_it_comes);
    RUN_TEST(test_sampled_inputs_and_slip_count_as_motion_where_they_are_used);
    RUN_TEST(test_what_waits_to_be_sent_is_checked_before_it_is_fetched);
    RUN_TEST(test_a_node_whose_queue_is_not_checked_sends_as_ever);
    RUN_TEST(test_a_frame_for_others_and_one_that_commits_nothing_change_no_sum);
    return UNITY_END();
}
