/* Tests of drives.c: drives of one vehicle turn its wheels, and measure what these do. */
#include "drive_scene.h"
#include "unity.h"

static laconic_drives drives;
static laconic_plant plant;
static laconic_input held;
static uint64_t axes[LACONIC_MAX_WHEELS];
static uint32_t last_us, calls;
static bool answers;

static void begin(laconic_drives *all, uint32_t now_us) {
    (void)all;
    last_us = now_us;
    calls = 0;
}
static void frame(laconic_drives *all, const laconic_frame *got, uint32_t now_us) {
    all->drive[got->data[0]].target.mode = LACONIC_DRIVE_SPEED;
    all->drive[got->data[0]].target.speed_rad_per_s = got->data[1];
    last_us = now_us;
}
static void before_step(laconic_drives *all, uint32_t now_us) {
    (void)all;
    last_us = now_us;
    calls++;
}
static bool give(laconic_drives *all, laconic_frame *made) {
    (void)all;
    memset(made, 0, sizeof *made);
    return answers;
}
static const laconic_drive_protocol protocol = {.name = "test",
                                                .axis_bytes = 8,
                                                .first_id = 1,
                                                .last_id = 9,
                                                .start = begin,
                                                .on_frame = frame,
                                                .on_step = before_step,
                                                .next_frame = give};

static void load(laconic_real friction, const laconic_drive_plan *plan) {
    const laconic_vehicle vehicle = scene_vehicle(friction);
    scene_plant(&plant, &vehicle);
    memset(&held, 0, sizeof held);
    laconic_drives_start(&drives, plan, &protocol, axes, &plant, 1000);
}

void setUp(void) {
    const laconic_drive_plan plan = scene_plan(0);
    load(0, &plan);
}
void tearDown(void) {}

static void ask(int drive, laconic_real speed_rad_per_s) {
    drives.drive[drive].target.mode = LACONIC_DRIVE_SPEED;
    drives.drive[drive].target.speed_rad_per_s = speed_rad_per_s;
}

static void step(int count) {
    for (int k = 0; k < count; k++)
        TEST_ASSERT_EQUAL_INT(LACONIC_OK, laconic_drives_step(&drives, &plant, &held, 1000, NULL));
}

static laconic_real wheel_angle(int wheel) {
    laconic_real angle[LACONIC_MAX_WHEELS];
    laconic_plant_wheel_angles(&plant, angle);
    return angle[wheel];
}

static void a_start_is_a_power_up_with_every_drive_off(void) {
    memset(axes, 255, sizeof axes);
    drives.drive[0].encoder.count = 77;
    setUp();
    TEST_ASSERT_EQUAL_INT(4, drives.count);
    TEST_ASSERT_TRUE(drives.drive[0].encoder.count == 0 && drives.drive[0].target.mode == LACONIC_DRIVE_OFF);
    TEST_ASSERT_TRUE(axes[3] == 0 && axes[4] != 0 && drives.step_s == SCENE_STEP_S);
}

static void a_wheel_without_a_node_id_has_no_drive(void) {
    laconic_drive_plan plan = scene_plan(0);
    plan.drive[1].node_id = -1;
    load(0, &plan);
    TEST_ASSERT_EQUAL_INT(3, drives.count);
    TEST_ASSERT_EQUAL_UINT8(2, drives.wheel[1]);
    held.axle_torque_Nm[1] = REAL(0.25);
    ask(1, 10);
    step(1);
    TEST_ASSERT_TRUE(held.axle_torque_Nm[1] == REAL(0.25)); /* which is no drive's */
    TEST_ASSERT_TRUE(held.axle_torque_Nm[2] == drives.drive[1].torque_Nm && drives.drive[1].torque_Nm > 0);
}

/* Both plants from the same start, one behind drives, one fed with their torques. */
static void move_both(laconic_plant *fed, laconic_real friction, int steps) {
    const laconic_drive_plan plan = scene_plan(0);
    const laconic_vehicle vehicle = scene_vehicle(friction);
    load(friction, &plan);
    scene_plant(fed, &vehicle);
    for (int k = 0; k < steps; k++) {
        laconic_input torques;
        for (int i = 0; i < 4; i++) ask(i, (laconic_real)((k / 300 + i) % 5) * 30);
        step(1);
        memset(&torques, 0, sizeof torques);
        for (int i = 0; i < 4; i++) torques.axle_torque_Nm[i] = drives.drive[i].torque_Nm;
        laconic_plant_run(fed, &torques, 1, NULL);
    }
}

static void drives_move_the_plant_as_torques_that_are_given_to_it_do(void) {
    static laconic_plant fed;
    move_both(&fed, 0, 2000);
    TEST_ASSERT_EQUAL_MEMORY(&fed.state, &plant.state, sizeof fed.state);
    move_both(&fed, REAL(0.3), 1000);
    TEST_ASSERT_EQUAL_MEMORY(&fed.state, &plant.state, sizeof fed.state);
    TEST_ASSERT_EQUAL_MEMORY(&fed.slip, &plant.slip, sizeof fed.slip);
}

/* Counts of the encoder against the plant's angle: 8192 · 20 counts a turn. */
static void counts_follow_the_wheels_angle(void) {
    const laconic_real counts_per_rad = REAL(8192.0 * 20 / 6.28318530717958647693);
    for (int i = 0; i < 4; i++) ask(i, i % 2 ? 40 : -60);
    step(3000);
    for (int i = 0; i < 4; i++) {
        const laconic_real off = wheel_angle(i) * counts_per_rad - (laconic_real)drives.drive[i].encoder.count;
        TEST_ASSERT_TRUE(off > -2 && off < 2);
    }
}

/* Far from where it began an angle in single precision has steps of 8 mrad, two hundred counts. */
static void counts_lose_nothing_after_many_turns(void) {
    for (int i = 0; i < 4; i++) ask(i, 400);
    step(3000);
    for (int j = 0; j < 3; j++) plant.state.travel[j].value += 100000;
    const int64_t before = drives.drive[0].encoder.count;
    step(1000);
    const int64_t turned = drives.drive[0].encoder.count - before;
    TEST_ASSERT_INT_WITHIN(30, 521519, (int)turned); /* 400 rad of the shaft, 8192 counts a turn */
}

static void on_ground_with_friction_drives_turn_and_measure_the_wheels_own_motion(void) {
    const laconic_drive_plan plan = scene_plan(0);
    load(REAL(0.6), &plan);
    for (int i = 0; i < 4; i++) ask(i, 100);
    step(3000);
    for (int i = 0; i < 4; i++)
        TEST_ASSERT_TRUE(drives.drive[i].speed_rad_per_s > 98 && drives.drive[i].speed_rad_per_s < 102);
    const laconic_real off =
        wheel_angle(2) * REAL(8192.0 * 20 / 6.28318530717958647693) - (laconic_real)drives.drive[2].encoder.count;
    TEST_ASSERT_TRUE(off > -2 && off < 2);
}

static void a_start_in_motion_measures_the_wheels_speed(void) {
    const laconic_drive_plan plan = scene_plan(0);
    const laconic_vehicle vehicle = scene_vehicle(0);
    laconic_start start;
    memset(&start, 0, sizeof start);
    start.nu_rad_per_s[0] = 10;
    laconic_plant_start(&plant, &vehicle, &laconic_auto, SCENE_STEP_S, &start, NULL);
    laconic_drives_start(&drives, &plan, &protocol, axes, &plant, 0);
    TEST_ASSERT_TRUE(drives.drive[0].speed_rad_per_s > 199 && drives.drive[0].speed_rad_per_s < 201);
}

static void hold_wheel(laconic_real friction) {
    laconic_drive_plan plan = scene_plan(0);
    plan.drive[0].stall_time_s = REAL(0.2);
    plan.drive[0].speed_gain_As = 1;
    load(friction, &plan);
    ask(0, 100);
    step(200);
    drives.drive[0].brake_Nm = 10; /* the drive has 6 */
    step(400);
}

static void a_brake_by_order_stalls_its_drive(void) {
    for (int k = 0; k < 2; k++) {
        hold_wheel(k == 0 ? 0 : REAL(0.8));
        TEST_ASSERT_EQUAL_UINT32(LACONIC_DRIVE_FAULT_STALL, drives.drive[0].faults);
        TEST_ASSERT_TRUE(drives.drive[0].speed_rad_per_s < REAL(0.5) && drives.drive[0].speed_rad_per_s > REAL(-0.5));
    }
}

static void brakes_on_all_wheels_stop_the_vehicle_and_keep_it(void) {
    for (int i = 0; i < 4; i++) ask(i, 200);
    step(2000);
    for (int i = 0; i < 4; i++) {
        laconic_drive_off(&drives.drive[i]);
        drives.drive[i].brake_Nm = 3;
    }
    step(2000);
    const int64_t count = drives.drive[0].encoder.count;
    step(1000);
    TEST_ASSERT_INT_WITHIN(1, 0, (int)(drives.drive[0].encoder.count - count));
}

static void a_brake_stops_its_wheel_within_a_step_as_far_as_it_is_strong_enough(void) {
    laconic_wheel_drive *drive = &drives.drive[0];
    drive->torque_Nm = REAL(0.5);
    drive->brake_Nm = 1;
    TEST_ASSERT_TRUE(laconic_drive_brake(drive, &plant, 0, 10, 1) == -1);
    TEST_ASSERT_TRUE(laconic_drive_brake(drive, &plant, 0, -10, 1) == 1);
    TEST_ASSERT_TRUE(laconic_drive_brake(drive, &plant, 0, 0, 1) == REAL(-0.5)); /* against the drive alone */
    drive->brake_Nm = 1000;
    const laconic_real whole = laconic_drive_brake(drive, &plant, 0, 1, 1) + REAL(0.5);
    const laconic_real half = laconic_drive_brake(drive, &plant, 0, 1, REAL(0.5)) + REAL(0.5);
    TEST_ASSERT_TRUE(whole < 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, (double)whole / 2, (double)half);
}

/* The only motion that its two fixed wheels leave this vehicle is a turn about the first of them. */
static void a_wheel_that_no_motion_turns_is_not_braked(void) {
    laconic_vehicle vehicle = {.mass_kg = 20, .yaw_inertia_kgm2 = 1, .wheel_radius_m = REAL(0.05)};
    vehicle.wheel_count = 2;
    vehicle.wheel[0].kind = vehicle.wheel[1].kind = LACONIC_WHEEL_FIXED;
    vehicle.wheel[0].axle_rad = REAL(1.57079632679489661923);
    vehicle.wheel[1].x_m = 1;
    scene_plant(&plant, &vehicle);
    drives.drive[0].brake_Nm = drives.drive[1].brake_Nm = 1000;
    TEST_ASSERT_TRUE(laconic_drive_brake(&drives.drive[0], &plant, 0, 1, 1) == 0);
    TEST_ASSERT_TRUE(laconic_drive_brake(&drives.drive[1], &plant, 1, 1, 1) < 0);
}

static void a_refused_step_switches_every_drive_off(void) {
    laconic_refusal why;
    ask(0, 100);
    step(10);
    held.body_force_N[0] = REAL(1e38) * REAL(1e38);
    held.body_force_N[0] -= held.body_force_N[0]; /* NaN */
    if (held.body_force_N[0] == held.body_force_N[0]) held.body_force_N[0] = LACONIC_REAL_MAX * 2;
    TEST_ASSERT_TRUE(laconic_drives_step(&drives, &plant, &held, 1000, &why) != LACONIC_OK);
    TEST_ASSERT_EQUAL_INT(LACONIC_DRIVE_OFF, drives.drive[0].target.mode);
    TEST_ASSERT_TRUE(drives.drive[0].torque_Nm == 0 && plant.steps == 10);
}

static void the_protocols_time_never_runs_backwards(void) {
    laconic_frame got = {.id = 1};
    laconic_drives_on_frame(&drives, &got, 2000);
    laconic_drives_step(&drives, &plant, &held, 1500, NULL);
    TEST_ASSERT_EQUAL_UINT32(2000, last_us);
    laconic_drives_step(&drives, &plant, &held, 2500, NULL);
    TEST_ASSERT_EQUAL_UINT32(2500, last_us);
    TEST_ASSERT_EQUAL_UINT32(2, calls);
}

static void frames_go_through_the_protocol(void) {
    laconic_frame got = {.id = 1, .length = 2, .data = {2, 50}};
    laconic_drives_on_frame(&drives, &got, 2000);
    TEST_ASSERT_TRUE(drives.drive[2].target.speed_rad_per_s == 50);
    answers = true;
    TEST_ASSERT_TRUE(laconic_drives_next_frame(&drives, &got));
    answers = false;
    TEST_ASSERT_FALSE(laconic_drives_next_frame(&drives, &got));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_start_is_a_power_up_with_every_drive_off);
    RUN_TEST(a_wheel_without_a_node_id_has_no_drive);
    RUN_TEST(drives_move_the_plant_as_torques_that_are_given_to_it_do);
    RUN_TEST(counts_follow_the_wheels_angle);
    RUN_TEST(counts_lose_nothing_after_many_turns);
    RUN_TEST(on_ground_with_friction_drives_turn_and_measure_the_wheels_own_motion);
    RUN_TEST(a_start_in_motion_measures_the_wheels_speed);
    RUN_TEST(a_brake_by_order_stalls_its_drive);
    RUN_TEST(brakes_on_all_wheels_stop_the_vehicle_and_keep_it);
    RUN_TEST(a_brake_stops_its_wheel_within_a_step_as_far_as_it_is_strong_enough);
    RUN_TEST(a_wheel_that_no_motion_turns_is_not_braked);
    RUN_TEST(a_refused_step_switches_every_drive_off);
    RUN_TEST(the_protocols_time_never_runs_backwards);
    RUN_TEST(frames_go_through_the_protocol);
    return UNITY_END();
}
