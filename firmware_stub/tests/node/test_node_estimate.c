/* Tests of the error estimate that a node sends: its pages, when it begins and ends, and the bits, which stay. */
#include "node_internal.h" /* before the bench, whose `node` would be shadowed */

#define BENCH_WITH_MASTER
#include "bench.h"
#include "drive_scene.h"
#include "unity.h"

#define CHOSEN 0x20U     /* of SELECT, with the take_ bits */
#define CYCLE_US 100000U /* of ERROR_ESTIMATE */

static uint8_t data[LACONIC_FRAME_BYTES];
static laconic_refusal why;

void setUp(void) { bench_begin(); }

void tearDown(void) {}

static void load_turning(void) {
    laconic_vehicle vehicle = scene_vehicle(0);
    vehicle.motor_gain_Nm_per_V = 1;
    vehicle.motor_damping_Nms = REAL(0.1);
    vehicle.com_x_m = REAL(0.05);
    memset(&node.start, 0, sizeof node.start);
    node.start.nu_rad_per_s[0] = 30;
    node.start.nu_rad_per_s[2] = 40;
    TEST_ASSERT_EQUAL_INT(
        LACONIC_OK, laconic_plant_start(&node.plant, &vehicle, &laconic_exact_flow, SCENE_STEP_S, &node.start, &why));
    node.state = LACONIC_WIRE_STATE_READY;
}

/* The next heartbeat makes the pages due. */
static void pass_a_cycle(void) {
    now_us += CYCLE_US;
    laconic_node_on_tick(&node, now_us);
}

static struct laconic_dbc_error_estimate_t page(uint8_t number) {
    struct laconic_dbc_error_estimate_t frame;
    memset(&frame, 0, sizeof frame);
    TEST_ASSERT_TRUE(bench_receive(LACONIC_WIRE_ERROR_ESTIMATE, data));
    TEST_ASSERT_EQUAL_INT(0, laconic_dbc_error_estimate_unpack(&frame, data, 8));
    TEST_ASSERT_EQUAL_UINT8(number, frame.page);
    return frame;
}

/* All pages of an instant, beside the core's estimate. */
static void assert_pages(const laconic_errors *expected) {
    TEST_ASSERT_TRUE(page(0).nu == (float)expected->now.nu_rad_per_s);
    TEST_ASSERT_TRUE(page(1).place == (float)expected->now.place_m);
    TEST_ASSERT_TRUE(page(2).heading == (float)expected->now.heading_rad);
    TEST_ASSERT_TRUE(page(3).wheel_angle == (float)expected->now.wheel_angle_rad);
    TEST_ASSERT_TRUE(page(4).largest_nu == (float)expected->largest.nu_rad_per_s);
    TEST_ASSERT_TRUE(page(5).largest_place == (float)expected->largest.place_m);
    TEST_ASSERT_TRUE(page(6).largest_heading == (float)expected->largest.heading_rad);
    TEST_ASSERT_TRUE(page(7).largest_wheel_angle == (float)expected->largest.wheel_angle_rad);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_ERROR_ESTIMATE, data));
}

static laconic_estimate estimate_of(const laconic_plant *plant) {
    laconic_estimate estimate;
    TEST_ASSERT_EQUAL_INT(LACONIC_OK, laconic_estimate_start(&estimate, plant, LACONIC_ESTIMATE_USUAL,
                                                             laconic_finer_method(plant), &why));
    return estimate;
}

static void unless_chosen_there_is_none(void) {
    load_turning();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(LACONIC_NODE_SEND_NU, 0, 0));
    bench_start_lockstep();
    bench_step(50);
    pass_a_cycle();
    TEST_ASSERT_FALSE(node.estimates);
    TEST_ASSERT_EQUAL_INT(0, node.estimate.taken);
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_ERROR_ESTIMATE, data));
}

static void its_pages_are_the_cores_numbers_every_100_ms(void) {
    load_turning();
    laconic_plant plant = node.plant;
    laconic_estimate estimate = estimate_of(&plant);
    laconic_input held = {.voltage_V = {5, 5, 5}};
    laconic_errors errors;
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN));
    bench_start_lockstep();
    for (int k = 0; k < 3; k++) {
        bench_step(70);
        TEST_ASSERT_EQUAL_INT(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &held, 70, &why));
        laconic_estimate_read(&errors, &estimate, &plant);
        TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_ERROR_ESTIMATE, data));
        pass_a_cycle();
        assert_pages(&errors);
        TEST_ASSERT_TRUE(errors.now.place_m > 0);
    }
    TEST_ASSERT_EQUAL_MEMORY(&plant.state, &node.plant.state, sizeof plant.state);
}

/* Steps between the pages do not mix two instants. */
static void pages_are_of_one_instant(void) {
    laconic_errors errors;
    load_turning();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN));
    bench_start_lockstep();
    bench_step(40);
    laconic_estimate_read(&errors, &node.estimate, &node.plant);
    pass_a_cycle();
    TEST_ASSERT_TRUE(page(0).nu == (float)errors.now.nu_rad_per_s);
    bench_sync(40);
    bench_tick_lockstep();
    TEST_ASSERT_TRUE(page(1).place == (float)errors.now.place_m);
}

static void it_begins_anew_with_reset_and_ends_with_open(void) {
    load_turning();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN));
    bench_start_lockstep();
    bench_step(60);
    const laconic_real place_m = node.estimate.largest.place_m;
    TEST_ASSERT_TRUE(place_m > 0);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
    TEST_ASSERT_TRUE(node.estimates && node.estimate.largest.place_m < place_m);
    pass_a_cycle();
    TEST_ASSERT_TRUE(page(0).nu < 1e-5F);
    TEST_ASSERT_EQUAL_UINT8(0, bench_open(7));
    TEST_ASSERT_FALSE(node.estimates);
    pass_a_cycle();
    TEST_ASSERT_FALSE(bench_receive(LACONIC_WIRE_ERROR_ESTIMATE, data));
}

static void it_can_be_left_out_again(void) {
    load_turning();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN));
    TEST_ASSERT_TRUE(node.estimates);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, 0));
    TEST_ASSERT_FALSE(node.estimates);
}

static void without_a_vehicle_it_is_refused(void) {
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATUS_WRONG_STATE, bench_select(LACONIC_NODE_SEND_NU, 0, CHOSEN));
    TEST_ASSERT_EQUAL_UINT8(0, node.send);
}

static void half_a_step_that_cannot_be_prepared_is_refused_with_its_field(void) {
    load_turning();
    node.plant.integrator.step_s = 12 * LACONIC_REAL_MIN;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_OVERFLOW, bench_select(LACONIC_NODE_SEND_NU, 0, CHOSEN));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_STEP, node.answer[LACONIC_WIRE_SELECT].field);
    TEST_ASSERT_EQUAL_UINT8(0, node.answer[LACONIC_WIRE_SELECT].item);
    TEST_ASSERT_FALSE(node.estimates);
    TEST_ASSERT_EQUAL_UINT8(0, node.send);
}

static void free_run_is_watched_and_goes_on_when_it_stops(void) {
    load_turning();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN));
    laconic_plant plant = node.plant;
    laconic_estimate estimate = estimate_of(&plant);
    const laconic_input held = {.voltage_V = {0}};
    laconic_errors errors;
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 500, 0));
    for (int k = 0; k < 100; k++) {
        now_us += 1000;
        laconic_node_on_tick(&node, now_us);
    }
    TEST_ASSERT_EQUAL_UINT64(100, node.plant.steps);
    TEST_ASSERT_EQUAL_INT(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &held, 100, &why));
    laconic_estimate_read(&errors, &estimate, &plant);
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0));
    pass_a_cycle();
    assert_pages(&errors);
}

static void sampled_steps_are_watched(void) {
    load_turning();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN | LACONIC_RAW_SAMPLED | LACONIC_RAW_VOLTAGE));
    TEST_ASSERT_TRUE((node.raw_input.take & LACONIC_RAW_SAMPLED) != 0);
    TEST_ASSERT_TRUE((node.raw_input.take & CHOSEN) == 0);
    bench_start_lockstep();
    node.lockstep.steps_due = 1;
    for (int k = 0; k < 3; k++) node.input[k].voltage_V[0] = REAL(1 + k);
    laconic_plant plant = node.plant;
    laconic_estimate estimate = node.estimate;
    TEST_ASSERT_EQUAL_INT(LACONIC_OK, laconic_estimate_run_sampled(&estimate, &plant, node.input, &why));
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(1, node.plant.steps);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_LOCKSTEP, node.state); /* no fault */
    TEST_ASSERT_EQUAL_INT(1, node.estimate.taken);
    TEST_ASSERT_EQUAL_MEMORY(estimate.local, node.estimate.local, sizeof estimate.local);
}

/* 120 ms of drives that are commanded a current, from a yawing start: over a heartbeat, which
 * is sent where the estimate is. */
static void play_drives(uint8_t take) {
    laconic_frame frame = {.id = 0x200, .length = 8, .data = {3, 232, 0, 0, 3, 232}};
    load_turning();
    node.drive_plan = scene_plan(3);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, take));
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
    laconic_node_on_frame(&node, &frame, now_us);
    for (int k = 0; k < 120; k++) {
        now_us += 1000;
        laconic_node_on_tick(&node, now_us);
    }
    TEST_ASSERT_EQUAL_UINT64(120, node.plant.steps);
    TEST_ASSERT_EQUAL(take == CHOSEN, bench_receive(LACONIC_WIRE_HEARTBEAT, data));
    TEST_ASSERT_TRUE(node.input[0].axle_torque_Nm[0] > REAL(0.01));
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0));
}

static void drives_are_watched_and_keep_their_bits(void) {
    play_drives(0);
    const laconic_state without = node.plant.state;
    bench_begin();
    play_drives(CHOSEN);
    TEST_ASSERT_EQUAL_MEMORY(&without, &node.plant.state, sizeof without);
    laconic_errors errors;
    laconic_estimate_read(&errors, &node.estimate, &node.plant);
    TEST_ASSERT_EQUAL_UINT64(0, errors.unknown);
    TEST_ASSERT_TRUE(errors.now.place_m > 2 * errors.rounding.place_m || sizeof(laconic_real) == 4);
    TEST_ASSERT_TRUE(errors.now.place_m > 0 && errors.now.place_m < REAL(1e-4));
    pass_a_cycle();
    assert_pages(&errors);
}

/* They end in FAULT, as without an estimate, which has not moved; `steps`: in one SYNC. */
static void expect_refused(uint32_t steps) {
    const laconic_real nothing = REAL(now_us - now_us);
    bench_begin();
    load_turning();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN));
    bench_start_lockstep();
    bench_step(20);
    const int32_t taken = node.estimate.taken;
    const laconic_estimate before = node.estimate;
    node.input[0].voltage_V[0] = nothing / nothing;
    bench_sync(steps);
    bench_tick_lockstep();
    TEST_ASSERT_EQUAL_MEMORY(before.local, node.estimate.local, sizeof before.local);
    TEST_ASSERT_EQUAL_MEMORY(before.first_path_m, node.estimate.first_path_m, sizeof before.first_path_m);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    TEST_ASSERT_EQUAL_UINT64(20, node.plant.steps);
    TEST_ASSERT_TRUE(taken > 0);
}

static void refused_steps_are_refused_as_without(void) {
    expect_refused(20);
    expect_refused(1);
}

static void a_refused_step_of_drives_and_a_refused_reset_are_refused_as_without(void) {
    const laconic_real nothing = REAL(now_us - now_us);
    load_turning();
    node.drive_plan = scene_plan(3);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN));
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
    node.input[0].voltage_V[0] = nothing / nothing;
    now_us += 1000;
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    TEST_ASSERT_EQUAL_INT(0, node.estimate.taken);
    node.start.x_m = nothing / nothing;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_NOT_FINITE, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
}

static void windows_that_are_not_known_are_told_up_to_65535(void) {
    load_turning();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN));
    node.estimate.unknown = 300;
    pass_a_cycle();
    TEST_ASSERT_EQUAL_UINT16(300, page(0).unknown);
    node.estimate.unknown = 70000;
    pass_a_cycle();
    TEST_ASSERT_EQUAL_UINT16(65535, page(0).unknown);
}

static void reset_begins_none_that_was_not_chosen(void) {
    load_turning();
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
    TEST_ASSERT_FALSE(node.estimates);
}

static void each_page_has_its_number(void) {
    load_turning();
    node.estimated.now = (laconic_error){1, 2, 3, 4};
    node.estimated.largest = (laconic_error){5, 6, 7, 8};
    for (node.estimate_page = 0; node.estimate_page < LACONIC_NODE_ESTIMATE_PAGES; node.estimate_page++) {
        float number;
        laconic_node_pack(&node, LACONIC_WIRE_ERROR_ESTIMATE, data);
        memcpy(&number, data + 2, sizeof number);
        TEST_ASSERT_TRUE(number == (float)(node.estimate_page + 1));
        TEST_ASSERT_EQUAL_UINT8(node.estimate_page, data[1] >> 4);
    }
}

/* Where damping is fast a step, auto is of another order than the method that measures it. */
static void a_stiff_vehicles_error_is_measured_by_the_finer_method(void) {
    laconic_vehicle vehicle = scene_vehicle(0);
    vehicle.motor_gain_Nm_per_V = 1;
    vehicle.motor_damping_Nms = 1000;
    TEST_ASSERT_EQUAL_INT(LACONIC_OK,
                          laconic_plant_start(&node.plant, &vehicle, &laconic_auto, SCENE_STEP_S, &node.start, &why));
    node.state = LACONIC_WIRE_STATE_READY;
    TEST_ASSERT_TRUE(node.plant.integrator.stiff);
    TEST_ASSERT_TRUE(laconic_finer_method(&node.plant) != node.plant.integrator.method);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN));
    TEST_ASSERT_TRUE(node.estimate.finer.method == laconic_finer_method(&node.plant));
}

static void a_step_of_drives_counts_once(void) {
    load_turning();
    node.drive_plan = scene_plan(3);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN));
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
    now_us += 1000;
    laconic_node_on_tick(&node, now_us);
    TEST_ASSERT_EQUAL_UINT64(1, node.plant.steps);
    TEST_ASSERT_EQUAL_INT(1, node.estimate.taken);
}

/* Of sampled inputs the last is what the next step begins with. A step that is refused was not taken. */
static void sampled_inputs_end_with_their_last_and_a_refused_step_counts_not(void) {
    load_turning();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN | LACONIC_RAW_SAMPLED | LACONIC_RAW_VOLTAGE));
    bench_start_lockstep();
    for (int k = 0; k < 3; k++) node.input[k].voltage_V[0] = REAL(1 + k);
    bench_sync(1);
    bench_tick_lockstep();
    TEST_ASSERT_EQUAL_INT(1, node.estimate.taken);
    TEST_ASSERT_EQUAL_MEMORY(&node.input[2], &node.estimate.input, sizeof node.input[2]);
    node.input[0].voltage_V[0] = LACONIC_REAL_MAX * 2;
    bench_sync(1);
    bench_tick_lockstep();
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    TEST_ASSERT_EQUAL_INT(0, node.estimate.taken);
}

/* The error of steps that were not taken is not asked for, however many were left. */
static void steps_behind_a_refused_one_are_not_watched(void) {
    uint64_t unknown[2];
    for (int k = 0; k < 2; k++) {
        expect_refused(k == 0 ? 1 : 20);
        unknown[k] = node.estimate.unknown;
    }
    TEST_ASSERT_EQUAL_UINT64(unknown[0], unknown[1]);
}

static void a_reset_that_cannot_begin_it_names_the_field(void) {
    load_turning();
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN));
    node.plant.integrator.step_s = 12 * LACONIC_REAL_MIN;
    TEST_ASSERT_EQUAL_UINT8(LACONIC_OVERFLOW, bench_control(LACONIC_WIRE_COMMAND_RESET, 0, 0));
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_STEP, node.answer[LACONIC_WIRE_CONTROL].field);
}

/* Step by step as the core watches the same torques. */
static void steps_of_drives_are_watched_as_the_core_does(void) {
    const laconic_frame frame = {.id = 0x200, .length = 8, .data = {3, 232, 0, 0, 0, 0, 3, 232}};
    load_turning();
    node.drive_plan = scene_plan(3);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN));
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_DRIVES, 0, 0));
    laconic_plant plant = node.plant;
    laconic_estimate estimate = estimate_of(&plant);
    for (int k = 0; k < 6; k++) {
        if (k == 3) laconic_node_on_frame(&node, &frame, now_us);
        now_us += 1000;
        laconic_node_on_tick(&node, now_us);
        const laconic_input held = node.input[0];
        TEST_ASSERT_EQUAL_INT(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &held, 1, &why));
        TEST_ASSERT_EQUAL_MEMORY(&plant.state, &node.plant.state, sizeof plant.state);
        TEST_ASSERT_EQUAL_INT(estimate.taken, node.estimate.taken);
        TEST_ASSERT_EQUAL_INT(estimate.length, node.estimate.length);
        TEST_ASSERT_EQUAL_MEMORY(estimate.local, node.estimate.local, sizeof estimate.local);
    }
}

/* ------------------------------------------------------------------------------ a master of XCP -- */

static void calibrated_numbers_begin_it_anew_and_a_master_reads_it(void) {
    load_turning();
    laconic_xcp_adopt(&node, &node.plant.vehicle);
    DONE_BY(0xFF, 0);
    REFUSED(XCP_ACCESS_DENIED, 0xF4, 4, 0, 0, BYTES(OUTPUT(37, 0)));
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN));
    node.estimated.now.place_m = REAL(0.25);
    node.estimated.largest.nu_rad_per_s = REAL(0.5);
    TEST_ASSERT_EQUAL_FLOAT(0.25F, real_at(OUTPUT(37, 1)));
    TEST_ASSERT_EQUAL_FLOAT(0.5F, real_at(OUTPUT(37, 4)));
    REFUSED(XCP_ACCESS_DENIED, 0xF4, 4, 0, 0, BYTES(OUTPUT(37, 8)));
    bench_start_lockstep();
    bench_step(64);
    TEST_ASSERT_TRUE(node.estimate.taken > 0);
    TEST_ASSERT_EQUAL_HEX8(DONE, write_real(PARAMETER(LACONIC_FIELD_MASS, 0), 20));
    TEST_ASSERT_TRUE(node.estimates && node.estimate.taken == 0);
}

static void calibrated_numbers_act_also_where_it_cannot_begin(void) {
    load_turning();
    laconic_xcp_adopt(&node, &node.plant.vehicle);
    DONE_BY(0xFF, 0);
    TEST_ASSERT_EQUAL_UINT8(0, bench_select(0, 0, CHOSEN));
    node.plant.integrator.step_s = 12 * LACONIC_REAL_MIN;
    TEST_ASSERT_EQUAL_HEX8(DONE, write_real(PARAMETER(LACONIC_FIELD_MASS, 0), 20));
    TEST_ASSERT_FALSE(node.estimates);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_OVERFLOW, node.answer[LACONIC_WIRE_HELLO].status);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_FIELD_STEP, node.answer[LACONIC_WIRE_HELLO].field);
    TEST_ASSERT_TRUE(node.plant.vehicle.mass_kg == 20);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(unless_chosen_there_is_none);
    RUN_TEST(its_pages_are_the_cores_numbers_every_100_ms);
    RUN_TEST(pages_are_of_one_instant);
    RUN_TEST(it_begins_anew_with_reset_and_ends_with_open);
    RUN_TEST(it_can_be_left_out_again);
    RUN_TEST(without_a_vehicle_it_is_refused);
    RUN_TEST(half_a_step_that_cannot_be_prepared_is_refused_with_its_field);
    RUN_TEST(free_run_is_watched_and_goes_on_when_it_stops);
    RUN_TEST(sampled_steps_are_watched);
    RUN_TEST(drives_are_watched_and_keep_their_bits);
    RUN_TEST(refused_steps_are_refused_as_without);
    RUN_TEST(a_refused_step_of_drives_and_a_refused_reset_are_refused_as_without);
    RUN_TEST(windows_that_are_not_known_are_told_up_to_65535);
    RUN_TEST(reset_begins_none_that_was_not_chosen);
    RUN_TEST(each_page_has_its_number);
    RUN_TEST(a_stiff_vehicles_error_is_measured_by_the_finer_method);
    RUN_TEST(a_step_of_drives_counts_once);
    RUN_TEST(sampled_inputs_end_with_their_last_and_a_refused_step_counts_not);
    RUN_TEST(steps_behind_a_refused_one_are_not_watched);
    RUN_TEST(a_reset_that_cannot_begin_it_names_the_field);
    RUN_TEST(steps_of_drives_are_watched_as_the_core_does);
    RUN_TEST(calibrated_numbers_begin_it_anew_and_a_master_reads_it);
    RUN_TEST(calibrated_numbers_act_also_where_it_cannot_begin);
    return UNITY_END();
}
