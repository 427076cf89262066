/* Tests of integrity.c: numbers that no motion has are noticed, and none that one may have. */
#include "drive_scene.h"
#include "integrity_bench.h"

void setUp(void) {}
void tearDown(void) {}

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
    expect_out_of_range(&on.node.plant.state.zeta[0].rest, 1);
    in_free_run();
    expect_out_of_range(&on.node.plant.state.zeta[1].rest, 1);
    in_free_run();
    expect_out_of_range(&on.node.plant.state.zeta[2].rest, -1);
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

/* The range is checked whatever the node sends, and whichever wheel's encoder is next. */
static void test_a_node_that_sends_nothing_has_its_range_too(void) {
    in_free_run();
    on.node.send = 0;
    on.node.encoder_wheel = 0;
    expect_out_of_range(&on.node.plant.state.x_m.value, 2000);
}

static void test_each_wheel_of_a_vehicle_has_a_range(void) {
    for (int32_t count = 1; count <= LACONIC_MAX_WHEELS; count++) {
        in_free_run();
        TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_STOP));
        on.node.plant.model.wheel_count = count;
        expect_out_of_range(&on.node.input[0].voltage_V[count - 1], 1000);
    }
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
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) on.node.input[0].axle_torque_Nm[i] = 1000; /* behind the voltages */
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

static void test_the_limits_themselves_are_in_range(void) {
    const laconic_integrity_limits *limits = &on.integrity.limits;
    for (int sign = -1; sign <= 1; sign += 2) {
        in_free_run();
        TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_STOP));
        on.node.plant.state.x_m.value = (laconic_real)sign * limits->distance_m;
        on.node.plant.state.y_m.value = (laconic_real)-sign * limits->distance_m;
        on.node.input[0].voltage_V[2] = (laconic_real)sign * limits->voltage_V;
        on.node.input[0].voltage_V[3] = 1000; /* of no wheel */
        for (int i = 0; i < LACONIC_MAX_WHEELS; i++) on.node.plant.state.wheel_angle_set_rad[i] = (laconic_real)(i + 1);
        bench_tick(&on);
        TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
    }
}

static laconic_real size_of(laconic_real x) { return x < 0 ? -x : x; }

/* Whether the node as it was then is out of these limits. */
static bool is_beyond(const bench *then, laconic_real speed_m_per_s, laconic_real yaw_rate_rad_per_s) {
    const laconic_integrity_limits limits = {.speed_m_per_s = speed_m_per_s, .yaw_rate_rad_per_s = yaw_rate_rad_per_s};
    on = *then;
    on.integrity.limits = limits;
    bench_tick(&on);
    return on.integrity.broken == LACONIC_INTEGRITY_OF_RANGE;
}

/* Each by itself, on either side; of these motions some are faster forwards, others to the left. */
static void test_the_velocity_in_x_and_in_y_and_the_yaw_rate_each_have_their_limit(void) {
    static bench then;
    int fastest[2] = {0, 0};
    for (int k = 0; k < 6; k++) {
        laconic_real v[2];
        in_free_run();
        TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_STOP));
        on.node.plant.state.zeta[k / 2].value = k % 2 == 0 ? 3 : -3;
        then = on;
        const laconic_real yaw_rate = size_of(laconic_body_velocity(&on.node.plant.model, &on.node.plant.state, v));
        const int most = size_of(v[1]) > size_of(v[0]) ? 1 : 0;
        const laconic_real speed = size_of(v[most]), less = (laconic_real)0.99;
        fastest[most] += speed > 0;
        if (speed > 0) TEST_ASSERT_TRUE(!is_beyond(&then, speed, 0) && is_beyond(&then, less * speed, 0));
        if (yaw_rate > 0) TEST_ASSERT_TRUE(!is_beyond(&then, 0, yaw_rate) && is_beyond(&then, 0, less * yaw_rate));
    }
    TEST_ASSERT_TRUE(fastest[0] > 0 && fastest[1] > 0);
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

/* It may lie beyond every limit, or where no limit is. */
static void test_a_number_that_is_none_is_out_of_range_without_limits_too(void) {
    volatile laconic_real zero = 0;
    laconic_real *const numbers[] = {&on.node.plant.state.x_m.value, &on.node.plant.state.zeta[1].value,
                                     &on.node.plant.state.travel[2].value, &on.node.input[0].voltage_V[0]};
    for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++)
        for (int sign = -1; sign <= 1; sign++) { /* 0: not a number */
            in_free_run();
            memset(&on.integrity.limits, 0, sizeof on.integrity.limits);
            TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_STOP));
            expect_out_of_range(numbers[k], (laconic_real)sign / zero);
        }
}

static void test_a_node_that_plays_drives_is_in_range(void) {
    const laconic_vehicle vehicle = scene_vehicle(0);
    in_free_run();
    TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_STOP));
    scene_plant(&on.node.plant, &vehicle);
    on.node.drive_plan = scene_plan(3);
    TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_START_DRIVES));
    on.time_us += TICK_US;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_WIRE_STATE_DRIVES, on.node.state);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

static void test_a_limit_of_0_is_none(void) {
    in_free_run();
    memset(&on.integrity.limits, 0, sizeof on.integrity.limits);
    on.node.plant.state.x_m.value = 1000000;
    on.node.input[0].voltage_V[0] = 1000;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

/* Two of them may not pass for right because they agree. */
static void test_two_numbers_out_of_range_are_noticed_as_one_is(void) {
    laconic_state *const state = &on.node.plant.state;
    laconic_real *const rests[][2] = {{&state->x_m.rest, &state->y_m.rest},
                                      {&state->y_m.rest, &state->x_m.value},
                                      {&state->zeta[1].rest, &state->travel[1].rest},
                                      {&state->zeta[0].rest, &state->x_m.rest}};
    for (size_t k = 0; k < sizeof rests / sizeof rests[0]; k++) {
        in_free_run();
        *rests[k][0] = 1;
        expect_out_of_range(rests[k][1], 2000);
    }
    in_free_run();
    state->x_m.value = 2000;
    expect_out_of_range(&state->y_m.value, 2000);
    in_free_run();
    state->y_m.value = 2000;
    expect_out_of_range(&state->heading.rest, 2);
    in_free_run();
    on.node.input[0].voltage_V[0] = 60;
    expect_out_of_range(&on.node.input[0].voltage_V[1], 60);
    in_free_run();
    on.integrity.limits.speed_m_per_s = 0;
    state->x_m.rest = 1;
    expect_out_of_range(&state->zeta[2].value, -5000); /* which gives the yaw rate */
    in_free_run();
    on.node.state = 77;
    expect_out_of_range(&state->x_m.value, 2000);
}

static void test_a_vehicle_of_the_most_wheels_is_in_range(void) {
    in_free_run();
    TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_STOP));
    on.node.plant.model.wheel_count = LACONIC_MAX_WHEELS;
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) on.node.input[0].axle_torque_Nm[i] = 1000; /* behind the voltages */
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

/* As it is when its highest bit changes, and so does that of a number behind the wheels. */
static void test_a_count_of_wheels_below_none_has_no_voltage_out_of_range(void) {
    in_free_run();
    TEST_ASSERT_EQUAL(0, rig_command(&on, LACONIC_WIRE_COMMAND_STOP));
    on.node.plant.model.wheel_count = INT32_MIN + on.node.plant.model.wheel_count;
    on.node.input[0].voltage_V[9] = 1000;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_SOUND, on.integrity.broken);
}

/* Nothing is within it; 0 alone means none. */
static void test_a_limit_below_0_is_one(void) {
    in_free_run();
    on.integrity.limits.distance_m = -1;
    bench_tick(&on);
    TEST_ASSERT_EQUAL(LACONIC_INTEGRITY_OF_RANGE, on.integrity.broken);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_what_no_motion_has_is_out_of_range);
    RUN_TEST(test_a_node_that_sends_nothing_has_its_range_too);
    RUN_TEST(test_each_wheel_of_a_vehicle_has_a_range);
    RUN_TEST(test_a_number_that_is_none_is_out_of_range_at_rest_too);
    RUN_TEST(test_a_count_of_wheels_beyond_the_largest_reads_nothing_behind_them);
    RUN_TEST(test_the_limits_themselves_are_in_range);
    RUN_TEST(test_the_velocity_in_x_and_in_y_and_the_yaw_rate_each_have_their_limit);
    RUN_TEST(test_a_possible_motion_is_in_range);
    RUN_TEST(test_a_sum_of_nought_may_have_a_rest);
    RUN_TEST(test_a_number_that_is_none_is_out_of_range_without_limits_too);
    RUN_TEST(test_a_node_that_plays_drives_is_in_range);
    RUN_TEST(test_a_limit_of_0_is_none);
    RUN_TEST(test_two_numbers_out_of_range_are_noticed_as_one_is);
    RUN_TEST(test_a_vehicle_of_the_most_wheels_is_in_range);
    RUN_TEST(test_a_count_of_wheels_below_none_has_no_voltage_out_of_range);
    RUN_TEST(test_a_limit_below_0_is_one);
    return UNITY_END();
}
