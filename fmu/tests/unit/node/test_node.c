/* Tests of node/model.c: the node behind a bus terminal, beside the same node without one: what it is loaded with
 * and its motion to the last bit. */
#include "node_bench.h"

#include <sys/stat.h>
#include <unistd.h>

static void a_node_without_a_scene_is_empty_and_lives(void) {
    begin();
    take("CAN");
    step(0, 1);
    TEST_ASSERT_EQUAL_INT32(LACONIC_WIRE_STATE_EMPTY, get_integer("node_state"));
    TEST_ASSERT_TRUE(get_real("x_m", 0) == 0 && get_real("time", 0) == 1);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("CAN"));
    int beats = 0;
    do beats += told.frame.id == LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HEARTBEAT;
    while (next() == LS_BUS_CAN_TRANSMIT);
    TEST_ASSERT_TRUE(beats >= 9 && get_integer("frames_sent") == beats);
}

static void a_scene_is_loaded_before_the_run(void) {
    cart(false);
    load();
    begin();
    TEST_ASSERT_EQUAL_INT32(LACONIC_WIRE_STATE_READY, get_integer("node_state"));
    TEST_ASSERT_TRUE(get_real("x_m", 0) == 7 && get_real("heading_rad", 0) == 0.5 && get_integer("frames_sent") == 0);
    TEST_ASSERT_EQUAL_INT32(0, get_integer("frames_heard"));
    TEST_ASSERT_EQUAL(LS_BUS_CONFIGURATION, first_of("CAN")); /* its answers to the rig are not for the bus */
    TEST_ASSERT_EQUAL(LS_BUS_CONFIGURATION, next());
    TEST_ASSERT_EQUAL(0, next());
}

static void a_scene_that_is_not_whole_is_refused(void) {
    cart(false);
    kept_count--; /* without its COMMIT */
    load();
    ASSERT_REFUSED(begin_from(0), "the scene in resources/start.bin cannot be loaded; make the FMU anew");
}

static void frames_beyond_its_place_or_its_kind_are_no_start_values(void) {
    const uint8_t data[8] = {0};
    TEST_ASSERT_FALSE(give_private(LACONIC_WIRE_RIG_OFFSETS, data));
    TEST_ASSERT_FALSE(give_private(254, data));
    TEST_ASSERT_TRUE(give_private(LACONIC_WIRE_RIG_OFFSETS - 1, data));
    for (int k = 1; k < 4096; k++) TEST_ASSERT_TRUE(give_private(0, data));
    TEST_ASSERT_FALSE(give_private(0, data));
    TEST_ASSERT_TRUE(give_private(255, data)); /* identifiers that drives use */
}

static void identifiers_are_a_multiple_of_32_that_no_drive_uses(void) {
    const uint8_t second[8] = {2};
    set_integer("id_base", 33);
    ASSERT_REFUSED(begin_from(0), "id_base: 33 is no multiple of 32 from 0 to 2016");
    set_integer("id_base", 32);
    TEST_ASSERT_TRUE(give_private(255, second));
    ASSERT_REFUSED(fmi3ExitInitializationMode(c), "id_base: the drives use identifiers from 32 to 63; give another");
    set_integer("id_base", 64);
    OK(fmi3ExitInitializationMode(c));
    make();
    set_integer("id_base", 2016);
    begin();
    take("CAN");
    step(0, 0.2);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("CAN"));
    TEST_ASSERT_EQUAL_HEX32(2016 + LACONIC_WIRE_HEARTBEAT, told.id);
}

static void settings_that_have_no_effect_are_refused(void) {
    set_flag("drop_lost_frames");
    ASSERT_REFUSED(begin_from(0), "drop_lost_frames: has no effect without discard_on_lost_arbitration; set both");
    set_flag("discard_on_lost_arbitration");
    OK(fmi3ExitInitializationMode(c));
    make();
    ASSERT_REFUSED(begin_from(5e9), "the start time 5000000000 s cannot be taken");
}

/* --------------------------------------------------------------------------------------------- motion -- */

/* A free run with voltages, in both nodes at the same times. */
static void its_motion_is_that_of_the_node_to_the_last_bit(void) {
    double nu[3], velocity[2];
    laconic_real speed[LACONIC_MAX_WHEELS], angle[LACONIC_MAX_WHEELS];
    laconic_pose pose;
    cart(false);
    load();
    begin();
    TEST_ASSERT_EQUAL_UINT8(0, bench_control(LACONIC_WIRE_COMMAND_START_FREE_RUN, 1000, 250));
    bench_voltage(0, 3000, 0);
    by_bus();
    for (now_us = 0; now_us <= 200000; now_us += 1000) laconic_node_on_tick(&node, now_us);
    step(0, 0.05);
    step(0.05, 0.15);
    TEST_ASSERT_EQUAL_INT32(LACONIC_WIRE_STATE_FREE_RUN, get_integer("node_state"));
    laconic_pose_of(&pose, &node.plant.model, &node.plant.state);
    TEST_ASSERT_TRUE(get_real("x_m", 0) == pose.x_m && get_real("y_m", 0) == pose.y_m && pose.x_m != 7);
    TEST_ASSERT_TRUE(get_real("heading_rad", 0) == pose.heading_rad);
    const double yaw = laconic_body_velocity(&node.plant.model, &node.plant.state, velocity);
    laconic_nu(&node.plant.model, &node.plant.state, nu);
    TEST_ASSERT_TRUE(get_real("yaw_rate_rad_per_s", 0) == yaw);
    for (uint32_t k = 0; k < 3; k++) TEST_ASSERT_TRUE(get_real("nu_rad_per_s", k + 1) == nu[k]);
    laconic_plant_wheel_speeds(&node.plant, speed);
    laconic_plant_wheel_angles(&node.plant, angle);
    for (uint32_t k = 0; k < 2; k++) {
        TEST_ASSERT_TRUE(get_real("velocity_body_m_per_s", k + 1) == velocity[k]);
        TEST_ASSERT_TRUE(get_real("wheel_speed_rad_per_s", k + 1) == speed[k] && speed[k] != 0);
        TEST_ASSERT_TRUE(get_real("wheel_angle_rad", k + 1) == angle[k] && angle[k] != 0);
    }
    TEST_ASSERT_TRUE(get_real("wheel_speed_rad_per_s", 3) == 0);
    TEST_ASSERT_TRUE(get_integer("frames_heard") >= 3);
}

/* Drives have their own memory within the node, also in a state that was kept. */
static void drives_play_and_a_kept_state_takes_them_up_again(void) {
    fmi3FMUState state = NULL;
    cart(true);
    load();
    begin();
    TEST_ASSERT_EQUAL_INT32(LACONIC_WIRE_STATE_DRIVES, get_integer("node_state"));
    set_real("body_force_N", 1, 3);
    set_real("body_force_N", 2, -1);
    set_real("body_moment_Nm", 0, 0.5);
    step(0, 0.2);
    OK(fmi3GetFMUState(c, &state));
    step(0.2, 0.2);
    const double x = get_real("x_m", 0), heading = get_real("heading_rad", 0), torque = get_real("axle_torque_Nm", 2);
    TEST_ASSERT_TRUE(x != 7 && heading != 0.5);
    fmi3FreeInstance(c);
    c = NULL;
    make();
    load();
    OK(fmi3SetFMUState(c, state));
    OK(fmi3FreeFMUState(c, &state));
    step(0.2, 0.2);
    TEST_ASSERT_TRUE(get_real("x_m", 0) == x && get_real("heading_rad", 0) == heading);
    TEST_ASSERT_TRUE(get_real("axle_torque_Nm", 2) == torque);
    TEST_ASSERT_TRUE(instance()->model.node.drives.axes == instance()->model.node.axes);
}

/* Each of the forces moves the cart in its own way; a node without drives takes none. */
static void forces_act_while_drives_play(void) {
    double moved[4];
    for (uint32_t which = 0; which < 4; which++) {
        tearDown();
        setUp();
        cart(which < 3);
        load();
        begin();
        set_real(which == 2 ? "body_moment_Nm" : "body_force_N", which == 2 ? 0 : which % 3 + 1, 2.0);
        step(0, 0.2);
        moved[which] = fabs(get_real("x_m", 0) - 7) + fabs(get_real("y_m", 0)) + fabs(get_real("heading_rad", 0) - 0.5);
        TEST_ASSERT_TRUE((instance()->model.node.input[0].body_force_N[0] == 2) == (which == 0));
        TEST_ASSERT_TRUE((instance()->model.node.input[0].body_force_N[1] == 2) == (which == 1));
        TEST_ASSERT_TRUE((instance()->model.node.input[0].body_moment_Nm == 2) == (which == 2));
    }
    TEST_ASSERT_TRUE(moved[0] + moved[1] > 0 && moved[2] > 0 && moved[3] == 0);
}

static void a_refused_step_of_the_core_is_told(void) {
    cart(true);
    load();
    OK(begin_from(100));
    set_real("body_force_N", 1, 1.7e308);
    set_real("body_force_N", 2, 1.7e308);
    log_clear();
    step(100, 0.2);
    ASSERT_LOGGED("logStatusWarning: the core refused a step at 100.00");
    ASSERT_LOGGED("the node is in state fault until a rig resets it");
    TEST_ASSERT_TRUE(lines == 1 && get_integer("node_state") == LACONIC_WIRE_STATE_FAULT);
    step(100.2, 0.2);
    TEST_ASSERT_EQUAL_INT(1, lines);
}

/* ----------------------------------------------------------------------------- start values of a file -- */

#define FOLDER "/tmp/laconic_node_%ld"

/* resources/start.bin with the description's start values and what the rig has sent; `more` comes behind it. */
static fmi3Instance make_of_file(uint32_t more_offset) {
    static uint8_t bytes[16384];
    static const uint64_t head[2] = {2, 1};
    char folder[64], file[80];
    uint64_t hash = fmu_token_hash("{scene}"), count = fmu_built_in_start_count + kept_count + 1;
    fmu_stream to = {.to = bytes, .size = sizeof bytes, .at = 8};
    memcpy(bytes, "LACSTART", 8);
    for (int k = 0; k < 2; k++) {
        uint64_t number = head[k];
        fmu_stream_u64(&to, &number);
    }
    fmu_stream_u64(&to, &hash);
    fmu_stream_u64(&to, &count);
    for (size_t k = 0; k < fmu_built_in_start_count; k++) {
        uint64_t reference = fmu_built_in_starts[k].reference;
        double value = fmu_built_in_starts[k].value;
        fmu_stream_u64(&to, &reference);
        fmu_stream_reals(&to, &value, 1);
    }
    for (size_t k = 0; k <= kept_count; k++) {
        /* as package.py writes it */
        uint64_t reference = 0x80000000U + (k < kept_count ? kept[k].id - LACONIC_WIRE_ID_BASE : more_offset);
        fmu_stream_u64(&to, &reference);
        memcpy(bytes + to.at, k < kept_count ? kept[k].data : (const uint8_t[8]){0}, 8);
        to.at += 8;
    }
    uint64_t checksum = fmu_checksum(bytes, to.at);
    fmu_stream_u64(&to, &checksum);
    snprintf(folder, sizeof folder, FOLDER, (long)getpid());
    snprintf(file, sizeof file, "%s/start.bin", folder);
    mkdir(folder, 0700);
    FILE *stream = fopen(file, "wb");
    TEST_ASSERT_NOT_NULL(stream);
    fwrite(bytes, 1, to.at, stream);
    fclose(stream);
    fmi3Instance made =
        fmi3InstantiateCoSimulation("one", "{scene}", folder, false, true, true, false, NULL, 0, NULL, log_3, NULL);
    remove(file);
    rmdir(folder);
    return made;
}

static void a_scene_comes_from_the_file_and_again_after_a_reset(void) {
    cart(true);
    fmi3FreeInstance(c);
    c = make_of_file(255);
    TEST_ASSERT_NOT_NULL(c);
    begin();
    const int32_t sent_first = get_integer("frames_sent");
    set_real("body_moment_Nm", 0, 3);
    step(0, 0.2);
    TEST_ASSERT_TRUE(get_integer("frames_sent") > sent_first && get_real("heading_rad", 0) != 0.5);
    OK(fmi3Reset(c));
    begin();
    TEST_ASSERT_EQUAL_INT32(sent_first, get_integer("frames_sent"));
    TEST_ASSERT_TRUE(get_real("heading_rad", 0) == 0.5 && get_integer("node_state") == LACONIC_WIRE_STATE_DRIVES);
}

static void a_file_with_a_frame_of_no_place_is_refused(void) {
    cart(false);
    TEST_ASSERT_NULL(make_of_file(200));
    ASSERT_LOGGED("start.bin holds no start values for it: import the FMU anew");
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_node_without_a_scene_is_empty_and_lives);
    RUN_TEST(a_scene_is_loaded_before_the_run);
    RUN_TEST(a_scene_that_is_not_whole_is_refused);
    RUN_TEST(frames_beyond_its_place_or_its_kind_are_no_start_values);
    RUN_TEST(identifiers_are_a_multiple_of_32_that_no_drive_uses);
    RUN_TEST(settings_that_have_no_effect_are_refused);
    RUN_TEST(its_motion_is_that_of_the_node_to_the_last_bit);
    RUN_TEST(drives_play_and_a_kept_state_takes_them_up_again);
    RUN_TEST(forces_act_while_drives_play);
    RUN_TEST(a_refused_step_of_the_core_is_told);
    RUN_TEST(a_scene_comes_from_the_file_and_again_after_a_reset);
    RUN_TEST(a_file_with_a_frame_of_no_place_is_refused);
    return UNITY_END();
}
