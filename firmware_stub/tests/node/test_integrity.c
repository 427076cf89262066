/* Memory that changed without a call is noticed, told and ends the run; sound memory never is. */
#include "integrity_bench.h"
#include "laconic_dbc.h"
#include "laconic_node/protection.h"

void setUp(void) {}
void tearDown(void) {}

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
                            BYTE(lockstep.request),
                            BYTE(drives.protocol),
                            BYTE(drives.count),
                            BYTE(drives.wheel),
                            BYTE(state)};
    for (size_t k = 0; k < sizeof bytes / sizeof bytes[0]; k++) {
        const fault it = session_with(bytes[k], 2, IN_FREE_RUN, LACONIC_INTEGRITY_ALL);
        TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MOTION, it.noticed);
        TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
        TEST_ASSERT_TRUE(it.noticed_us - it.at_us <= TICK_US);
    }
}

static void test_what_is_noticed_is_refused_once(void) {
    in_free_run_with(LACONIC_INTEGRITY_ALL);
    const uint16_t refused = on.node.counters.refused;
    ((uint8_t *)&on.node)[BYTE(plant.state)] ^= 1U;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MOTION, on.integrity.broken);
    TEST_ASSERT_EQUAL(refused + 1, on.node.counters.refused);
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

static void test_what_stood_in_its_memory_before_does_not_matter(void) {
    static laconic_integrity clean, dirty;
    in_free_run();
    memset(&clean, 0, sizeof clean);
    memset(&dirty, 0xA5, sizeof dirty);
    laconic_integrity_begin(&clean, &on.node, &on.config, &on.integrity.limits, on.checks);
    laconic_integrity_begin(&dirty, &on.node, &on.config, &on.integrity.limits, on.checks);
    TEST_ASSERT_EQUAL_MEMORY(&clean, &dirty, sizeof clean);
    TEST_ASSERT_EQUAL_PTR(&on.config, clean.config);
}

static void test_loaded_numbers_that_changed_are_refused_at_commit(void) {
    session_with(BYTE(loader.parameters.vehicle.mass_kg), 1, IN_LOADING, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATUS_MEMORY_CHANGED, on.node.answer[LACONIC_WIRE_PARAMETER].status);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATUS_MEMORY_CHANGED, on.node.answer[LACONIC_WIRE_COMMIT].status);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_LOADED, on.node.answer[LACONIC_WIRE_COMMIT].item);
    TEST_ASSERT_EQUAL(0, on.node.answer[LACONIC_WIRE_COMMIT].field);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_EMPTY, on.node.state);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    session_with(BYTE(loader.field), 1, IN_LOADING, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATUS_MEMORY_CHANGED, on.node.answer[LACONIC_WIRE_COMMIT].status);
    TEST_ASSERT_EQUAL(0, on.node.answer[LACONIC_WIRE_COMMIT].field); /* which field it was, nobody knows */
}

/* Also those that change after the last PARAMETER: how many events come before COMMIT is counted in a sound session. */
static void test_numbers_that_change_just_before_commit_are_refused_there(void) {
    static recording sound;
    const uint32_t commit = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_COMMIT;
    memset(&sound, 0, sizeof sound);
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_session(&on, &sound, NULL, NULL));
    int before = 0;
    while (sound.event[before].is_tick || sound.event[before].frame.id != commit) before++;
    session_with(BYTE(loader.parameters.vehicle.mass_kg), 1, before, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_EQUAL(0, on.node.answer[LACONIC_WIRE_PARAMETER].status);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATUS_MEMORY_CHANGED, on.node.answer[LACONIC_WIRE_COMMIT].status);
}

static void test_a_changed_configuration_is_repaired_and_told(void) {
    const size_t bytes[] = {BYTE(config.id_base), BYTE(config.can_fd), BYTE(config.method), BYTE(config.nonce_seed),
                            BYTE(config.protocol)};
    for (size_t k = 0; k < sizeof bytes / sizeof bytes[0]; k++) {
        session_with(bytes[k], 1, IN_FREE_RUN, LACONIC_INTEGRITY_SUM);
        TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_CONFIGURATION, on.node.answer[LACONIC_WIRE_SYNC].item);
        TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
        TEST_ASSERT_EQUAL_HEX16(LACONIC_WIRE_ID_BASE, on.node.config.id_base);
        TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_RESET));
        TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
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

static void test_sampled_inputs_and_slip_count_as_motion_where_they_are_used(void) {
    const size_t bytes[] = {BYTE(input[2].voltage_V), BYTE(plant.slip)};
    for (size_t k = 0; k < sizeof bytes / sizeof bytes[0]; k++) {
        for (int used = 0; used < 3; used++) { /* 2: raw inputs, but not sampled ones */
            bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_MOTION);
            TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
            on.node.plant.friction.acts = used == 1;
            on.node.raw_input.take = used == 1 ? LACONIC_RAW_SAMPLED : used == 2 ? LACONIC_RAW_VOLTAGE : 0;
            laconic_integrity_begin(&on.integrity, &on.node, &on.config, &on.integrity.limits, on.checks);
            on.integrity.has_vehicle = true;
            bench_tick(&on);
            TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
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
        TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MOTION, on.integrity.broken);
        TEST_ASSERT_FALSE(bench_next(&on, &frame));
        on.time_us += TICK_US;
        bench_tick(&on); /* what was found once is told once */
        while (bench_next(&on, &frame)) TEST_ASSERT_TRUE(frame.id != LACONIC_WIRE_ID_BASE + LACONIC_WIRE_RESULT);
    }
}

/* Also where inputs were on, which end with it. */
static void test_what_was_found_before_a_frame_is_told_once(void) {
    laconic_frame frame;
    in_free_run_with(LACONIC_INTEGRITY_ALL);
    on.node.input[0].voltage_V[1] = 2;
    on.node.free_run.steps_per_period = 1;
    laconic_integrity_begin(&on.integrity, &on.node, &on.config, &on.integrity.limits, on.checks);
    on.integrity.has_vehicle = true;
    on.node.pending ^= 1U << LACONIC_WIRE_NU;
    TEST_ASSERT_TRUE(bench_next(&on, &frame));
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATUS_MEMORY_CHANGED, frame.data[3]);
    TEST_ASSERT_TRUE(on.node.input[0].voltage_V[1] == 0);
    while (bench_next(&on, &frame)) TEST_ASSERT_TRUE(frame.id != LACONIC_WIRE_ID_BASE + LACONIC_WIRE_RESULT);
    on.time_us += TICK_US;
    bench_tick(&on);
    while (bench_next(&on, &frame)) TEST_ASSERT_TRUE(frame.id != LACONIC_WIRE_ID_BASE + LACONIC_WIRE_RESULT);
}

/* The last bytes of a part are as many as its members have, and no word. */
static void test_each_bit_of_what_waits_is_watched_and_no_byte_behind_it(void) {
    for (int fill = 0; fill < 256; fill += 255) {
        bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_MOTION);
        TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
        memset(&on.node.raw_input.number, fill, sizeof on.node.raw_input.number);
        memset(&on.node.raw_output, fill, sizeof on.node.raw_output);
        on.node.raw_output.send = on.node.raw_input.take = 0;
        laconic_integrity_begin(&on.integrity, &on.node, &on.config, &on.integrity.limits, on.checks);
        const bench sealed = on;
        const size_t first[2] = {BYTE(raw_input.number), BYTE(raw_output.size)};
        const size_t end[2] = {BYTE(raw_input) + sizeof on.node.raw_input, BYTE(raw_output.segment) + 1};
        for (int part = 0; part < 2; part++)
            for (size_t bit = 8 * first[part]; bit < 8 * end[part]; bit++) {
                on = sealed;
                ((uint8_t *)&on.node)[bit / 8] ^= (uint8_t)(1U << bit % 8);
                bench_tick(&on);
                TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MOTION, on.integrity.broken);
            }
        on = sealed;
        memset(&on.node.raw_output.number, 0x5A, sizeof on.node.raw_output.number);
        memset((uint8_t *)&on.node.raw_output + offsetof(laconic_raw_output, segment) + 1, 0x5A, 1);
        bench_tick(&on);
        TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
    }
}

static void test_each_check_finds_what_it_is_for_and_nothing_else(void) {
    for (uint8_t checks = 1; checks <= LACONIC_INTEGRITY_ALL; checks++) {
        const bool sum = (checks & LACONIC_INTEGRITY_SUM) != 0, motion = (checks & LACONIC_INTEGRITY_MOTION) != 0;
        const uint8_t far = (checks & LACONIC_INTEGRITY_RANGE) != 0 ? LACONIC_INTEGRITY_OF_RANGE : 0;
        in_free_run_with(checks);
        on.node.plant.state.x_m.value = 5000;
        bench_tick(&on);
        TEST_ASSERT_EQUAL(motion ? LACONIC_INTEGRITY_OF_MOTION : far, on.integrity.broken);
        session_with(BYTE(start.heading_rad), 1, IN_FREE_RUN, checks);
        TEST_ASSERT_EQUAL(sum ? LACONIC_INTEGRITY_OF_MODEL : LACONIC_INTEGRITY_SOUND, on.integrity.broken);
        session_with(BYTE(loader.parameters.vehicle.mass_kg), 1, IN_LOADING, checks);
        TEST_ASSERT_EQUAL(motion ? LACONIC_WIRE_STATUS_MEMORY_CHANGED : 0, on.node.answer[LACONIC_WIRE_COMMIT].status);
    }
}

/* Commands of the session before are answered no more; what is told answers none. */
static void test_of_what_waits_only_the_finding_is_told(void) {
    laconic_frame frame;
    in_free_run();
    on.node.answers_due |= 1U << LACONIC_WIRE_CONTROL;
    on.node.pending |= 1U << LACONIC_WIRE_RESULT;
    on.node.plant.state.x_m.value = 5000;
    bench_tick(&on);
    TEST_ASSERT_TRUE(bench_next(&on, &frame));
    TEST_ASSERT_EQUAL_HEX32(LACONIC_WIRE_ID_BASE + LACONIC_WIRE_RESULT, frame.id);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATUS_MEMORY_CHANGED, frame.data[3]);
    TEST_ASSERT_EQUAL(0, on.node.answer[LACONIC_WIRE_SYNC].request);
    TEST_ASSERT_FALSE(bench_next(&on, &frame));
}

static void test_begin_forgets_what_was_loaded_and_its_sum(void) {
    static laconic_integrity fresh;
    const struct laconic_dbc_control_t order = {.command = LACONIC_WIRE_COMMAND_BEGIN};
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + LACONIC_WIRE_CONTROL, .length = 8};
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_open(&on));
    on.node.loader.parameters.vehicle.mass_kg = 5;
    laconic_integrity_begin(&on.integrity, &on.node, &on.config, &on.integrity.limits, on.checks);
    laconic_dbc_control_pack(frame.data, &order, 8);
    laconic_protect_keyed(LACONIC_WIRE_CONTROL, frame.data, on.node.session.key,
                          on.node.session.count[LACONIC_WIRE_CONTROL] + 1U);
    bench_frame(&on, &frame);
    TEST_ASSERT_TRUE(on.node.loader.parameters.vehicle.mass_kg == 0);
    laconic_integrity_begin(&fresh, &on.node, &on.config, &on.integrity.limits, on.checks);
    TEST_ASSERT_EQUAL_MEMORY(&fresh.loaded, &on.integrity.loaded, sizeof fresh.loaded);
}

static void test_a_new_session_forgets_what_was_loaded_and_its_sum(void) {
    static laconic_integrity fresh;
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
    const laconic_memory_sum before = on.integrity.loaded;
    TEST_ASSERT_TRUE(rig_open(&on));
    laconic_integrity_begin(&fresh, &on.node, &on.config, &on.integrity.limits, on.checks);
    TEST_ASSERT_EQUAL_MEMORY(&fresh.loaded, &on.integrity.loaded, sizeof before);
    TEST_ASSERT_TRUE(memcmp(&before, &fresh.loaded, sizeof before) != 0);
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

/* Only before a frame that loads is it compared: what changes and changes back meanwhile leaves nothing wrong. */
static void test_what_was_loaded_is_compared_before_frames_that_load_alone(void) {
    bench_power_up(&on, 7, 0, LACONIC_INTEGRITY_ALL);
    TEST_ASSERT_TRUE(rig_open(&on));
    for (uint32_t k = 0; k < 0x800U + LACONIC_NODE_ID_STRIDE; k++) {
        const bool extended = k < LACONIC_NODE_ID_STRIDE; /* the node's numbers, but in frames of another kind */
        const uint32_t id = extended ? LACONIC_WIRE_ID_BASE + k : k - LACONIC_NODE_ID_STRIDE;
        const laconic_frame frame = {.id = id, .length = 8, .extended = extended};
        const uint32_t offset = id - LACONIC_WIRE_ID_BASE;
        const bool loads = offset == LACONIC_WIRE_PARAMETER || offset == LACONIC_WIRE_COMMIT ||
                           offset == LACONIC_WIRE_CONTROL || offset == LACONIC_WIRE_OPEN;
        if (loads && !extended) continue;
        on.node.loader.parameters.vehicle.mass_kg = 5;
        bench_frame(&on, &frame);
        on.node.loader.parameters.vehicle.mass_kg = 0;
        TEST_ASSERT_EQUAL(0, on.node.loader.status);
    }
    TEST_ASSERT_TRUE(rig_session(&on, NULL, NULL, NULL));
}

/* In FAULT the heartbeat tells of drives, however many there seem to be; RESET, which stops what plays, touches none
 * of them. */
static void test_a_node_whose_count_of_drives_changed_goes_on_telling_that_it_lives(void) {
    for (uint8_t bit = 0; bit < 32; bit++) {
        laconic_frame frame;
        int heartbeats = 0;
        in_free_run_with(LACONIC_INTEGRITY_ALL);
        ((uint8_t *)&on.node)[BYTE(drives.count) + bit / 8] ^= (uint8_t)(1U << bit % 8);
        for (int k = 0; k < 20; k++) {
            on.time_us += TICK_US;
            bench_tick(&on);
            while (bench_next(&on, &frame)) heartbeats += frame.id == LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HEARTBEAT;
        }
        TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_MOTION, on.integrity.broken);
        TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_FAULT, on.node.state);
        TEST_ASSERT_TRUE(heartbeats > 0);
        TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_RESET));
        TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_READY, on.node.state);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_sound_node_moves_as_one_that_is_not_watched);
    RUN_TEST(test_a_changed_model_ends_the_run_within_a_second);
    RUN_TEST(test_only_commit_heals_a_changed_model);
    RUN_TEST(test_a_changed_motion_is_noticed_by_the_next_call);
    RUN_TEST(test_what_is_noticed_is_refused_once);
    RUN_TEST(test_reset_heals_a_changed_motion);
    RUN_TEST(test_two_changes_that_cancel_in_the_sum_of_words_are_noticed_by_the_other);
    RUN_TEST(test_what_stood_in_its_memory_before_does_not_matter);
    RUN_TEST(test_loaded_numbers_that_changed_are_refused_at_commit);
    RUN_TEST(test_numbers_that_change_just_before_commit_are_refused_there);
    RUN_TEST(test_a_changed_configuration_is_repaired_and_told);
    RUN_TEST(test_without_a_vehicle_the_node_begins_as_after_power_up);
    RUN_TEST(test_numbers_that_were_loaded_before_are_then_forgotten);
    RUN_TEST(test_sampled_inputs_and_slip_count_as_motion_where_they_are_used);
    RUN_TEST(test_what_waits_to_be_sent_is_checked_before_it_is_fetched);
    RUN_TEST(test_what_was_found_before_a_frame_is_told_once);
    RUN_TEST(test_each_bit_of_what_waits_is_watched_and_no_byte_behind_it);
    RUN_TEST(test_each_check_finds_what_it_is_for_and_nothing_else);
    RUN_TEST(test_of_what_waits_only_the_finding_is_told);
    RUN_TEST(test_begin_forgets_what_was_loaded_and_its_sum);
    RUN_TEST(test_a_new_session_forgets_what_was_loaded_and_its_sum);
    RUN_TEST(test_a_node_whose_queue_is_not_checked_sends_as_ever);
    RUN_TEST(test_a_frame_for_others_and_one_that_commits_nothing_change_no_sum);
    RUN_TEST(test_what_was_loaded_is_compared_before_frames_that_load_alone);
    RUN_TEST(test_a_node_whose_count_of_drives_changed_goes_on_telling_that_it_lives);
    return UNITY_END();
}
