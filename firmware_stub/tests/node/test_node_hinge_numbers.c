/* Tests of numbers of hinges: which commands a hinge takes where wheels slip, raw numbers of each kind in their order,
 * and the watch over memory of vehicles with hinges. */
#include "hinge_bench.h"
#include "laconic_node/integrity.h"

void setUp(void) { bench_begin(); }
void tearDown(void) {}

/* ----------------------------------------------------------------------------- commands that slip -- */

typedef struct hinge_choice {
    parameter more[3];
    bool voltages, rates, angles; /* what this hinge takes */
} hinge_choice;

static const hinge_choice choices[] = {
    {{INTEGER(BODY_HINGE, 1, LACONIC_HINGE_MOTOR), NUMBER(HINGE_GAIN, 1, 0.5), NUMBER(HINGE_DAMPING, 1, 1)},
     true,
     false,
     false},
    {{INTEGER(BODY_HINGE, 1, LACONIC_HINGE_MOTOR), NUMBER(HINGE_GAIN, 1, 0.5), NUMBER(LOOP_ANGLE_GAIN, 1, 20)},
     true,
     false,
     true},
    {{INTEGER(BODY_HINGE, 1, LACONIC_HINGE_MOTOR), NUMBER(HINGE_GAIN, 1, 0.5), NUMBER(LOOP_RATE_GAIN, 1, 2)},
     true,
     true,
     false},
    {{INTEGER(BODY_HINGE, 1, LACONIC_HINGE_PRESCRIBED), NUMBER(SCRUB_RADIUS, 3, 0.01), NUMBER(BODY_MASS, 1, 2)},
     false,
     true,
     false},
    {{INTEGER(BODY_HINGE, 1, LACONIC_HINGE_FREE), NUMBER(SERVO_DAMPING, 1, 3), NUMBER(BODY_MASS, 1, 2)},
     false,
     true,
     false},
    {{INTEGER(BODY_HINGE, 1, LACONIC_HINGE_FREE), NUMBER(SERVO_GAIN, 1, 30), NUMBER(SERVO_DAMPING, 1, 3)},
     false,
     false,
     true},
    {{INTEGER(BODY_HINGE, 1, LACONIC_HINGE_FREE), NUMBER(HINGE_DAMPING, 1, 0.1), NUMBER(BODY_MASS, 1, 2)},
     false,
     false,
     false},
};

static void start_slipping_with(const parameter more[3]) {
    const parameter friction = NUMBER(GROUND_FRICTION_COEFFICIENT, 0, 0.3);
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    begin_tricycle(&prescribed);
    TEST_ASSERT_EQUAL_UINT8(0, send_parameter(&friction));
    for (int k = 0; k < 3; k++) TEST_ASSERT_EQUAL_UINT8(0, send_parameter(&more[k]));
    TEST_ASSERT_EQUAL_UINT8(0, commit());
    TEST_ASSERT_TRUE(node.hinges.slips);
    bench_start_lockstep();
}

/* Page 0 holds rates or angles, page 3 voltages; a number for a hinge that takes none of its kind is refused. */
static void a_hinge_that_slips_takes_the_commands_of_its_drive_and_no_others(void) {
    for (size_t k = 0; k < sizeof choices / sizeof choices[0]; k++) {
        const hinge_choice *it = &choices[k];
        start_slipping_with(it->more);
        const uint16_t before = node.counters.refused;
        steer(3, 250, 0, 0, false);
        TEST_ASSERT_EQUAL_UINT16(before + (it->voltages ? 0U : 1U), node.counters.refused);
        TEST_ASSERT_TRUE((node.hinges.input[0].hinge_voltage_V[0] != 0) == it->voltages);
        const uint16_t between = node.counters.refused;
        steer(0, 400, 0, 0, false);
        TEST_ASSERT_EQUAL_UINT16(between + (it->rates || it->angles ? 0U : 1U), node.counters.refused);
        TEST_ASSERT_TRUE((node.hinges.input[0].hinge_rate_rad_per_s[0] != 0) == it->rates);
        TEST_ASSERT_TRUE((node.hinges.angle_rad[0] != 0) == it->angles);
        steer(1, 0, 0, 0, false); /* from the fourth hinge on, of one */
        TEST_ASSERT_EQUAL_UINT16(between + (it->rates || it->angles ? 1U : 2U), node.counters.refused);
    }
}

static void a_step_that_the_core_refuses_ends_a_run_that_slips(void) {
    const laconic_real largest = LACONIC_REAL_MAX;
    start_slipping_with(choices[5].more);
    node.hinges.tree.body[0].x = largest; /* as if a bit had flipped */
    bench_step(3);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    TEST_ASSERT_EQUAL_UINT64(0, node.plant.steps);
    TEST_ASSERT_TRUE(node.hinges.tree.body[0].x == largest);
}

/* ------------------------------------------------------------------------------------ raw numbers -- */

static void put_raw(const laconic_real *number, size_t bytes) {
    uint8_t segment = 0;
    for (size_t at = 0; at < bytes; at += 6, segment++) {
        uint8_t payload[LACONIC_FRAME_BYTES] = {0, (uint8_t)(segment << 4)};
        memcpy(payload + 2, (const uint8_t *)number + at, bytes - at < 6 ? bytes - at : 6);
        bench_send(LACONIC_WIRE_RAW_INPUT, payload);
    }
}

/* Voltage and torque of a hinge, then the kinds that a vehicle has; wheels' numbers come before all of them. */
static void raw_numbers_of_hinges_come_in_the_order_of_their_bits(void) {
    const laconic_real number[8] = {1, 2, 3, (laconic_real)0.4, (laconic_real)0.5, (laconic_real)0.6, 7, 8};
    const uint8_t forces = LACONIC_RAW_HINGE_VOLTAGE | LACONIC_RAW_HINGE_TORQUE;
    load_tricycle(&coordinated);
    TEST_ASSERT_EQUAL_UINT8(0, select_bits(0, 0, LACONIC_RAW_VOLTAGE, 0, forces | LACONIC_RAW_TWIST));
    bench_start_lockstep();
    put_raw(number, sizeof number);
    const laconic_articulated_input *held = node.raw_input.hinged;
    for (int k = 0; k < 3; k++) TEST_ASSERT_TRUE(node.raw_input.hinged != NULL && held->twist[k] == number[5 + k]);
    TEST_ASSERT_TRUE(held->hinge_voltage_V[0] == number[3] && held->hinge_torque_Nm[0] == number[4]);
    TEST_ASSERT_TRUE(node.raw_input.complete && !node.raw_input.broken);
}

static void raw_angles_reach_the_servos_of_a_vehicle_that_slips(void) {
    const laconic_real number[3] = {(laconic_real)0.4, (laconic_real)0.5, (laconic_real)0.6};
    start_slipping_with(choices[5].more);
    bench_control(LACONIC_WIRE_COMMAND_STOP, 0, 0);
    TEST_ASSERT_EQUAL_UINT8(
        0, select_bits(0, 0, 0, 0, LACONIC_RAW_HINGE_TORQUE | LACONIC_RAW_STEERING_RATE | LACONIC_RAW_STEERING_ANGLE));
    bench_start_lockstep();
    put_raw(number, sizeof number);
    TEST_ASSERT_TRUE(node.raw_input.complete);
    TEST_ASSERT_TRUE(node.raw_input.hinged[0].hinge_torque_Nm[0] == number[0]);
    TEST_ASSERT_TRUE(node.raw_input.hinged[0].hinge_rate_rad_per_s[0] == number[1]);
    TEST_ASSERT_TRUE(node.raw_input.angle_rad[0] == number[2]);
}

#define HELD_TORQUE 0x10 /* its bit of byte 4 */

static void raw_outputs_of_every_kind_stand_in_the_order_of_their_bits(void) {
    const uint8_t raw = LACONIC_RAW_POSE | LACONIC_RAW_WHEEL_SPEED | LACONIC_RAW_WHEEL_ANGLE | LACONIC_RAW_ENERGY;
    load_tricycle(&prescribed);
    TEST_ASSERT_EQUAL_UINT8(0, select_bits(0, raw, HELD_TORQUE, 0x38, 0));
    bench_start_lockstep();
    steer(0, 600, 0, 0, false);
    bench_step(30);
    const laconic_articulated_motion now = motion();
    const laconic_real *out = node.raw_output.number;
    TEST_ASSERT_EQUAL_UINT16((3 + 3 + 3 + 1 + 3 + 3 + 1 + 1) * sizeof(laconic_real), node.raw_output.size);
    TEST_ASSERT_TRUE(out[0] == now.x_m && out[1] == now.y_m && out[2] == now.heading_rad && now.x_m != 0);
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_TRUE(out[3 + i] == now.wheel_speed_rad_per_s[i] && out[6 + i] == now.wheel_angle_rad[i]);
        TEST_ASSERT_TRUE(out[10 + i] == 0); /* no torque is held */
    }
    TEST_ASSERT_TRUE(out[9] == now.energy_J && now.energy_J > 0);
    TEST_ASSERT_TRUE(out[13] == now.velocity_m_per_s[0] && out[15] == now.yaw_rate_rad_per_s);
    TEST_ASSERT_TRUE(out[16] == now.hinge_angle_rad[0] && out[17] == now.hinge_rate_rad_per_s[0]);
}

/* -------------------------------------------------------------------------------------- the watch -- */

/* A flipped bit of the motion or of the model between two calls ends the run. */
static void memory_of_hinges_is_watched(void) {
    static const laconic_integrity_limits none = {0, 0, 0, 0};
    static laconic_integrity watch;
    const laconic_node_config config = node.config;
    for (int of_model = 0; of_model < 2; of_model++) {
        bench_begin();
        laconic_node_config original = config;
        load_tricycle(&prescribed);
        bench_start_lockstep();
        laconic_integrity_begin(&watch, &node, &original, &none, LACONIC_INTEGRITY_ALL);
        watch.has_vehicle = true;
        node.config = original;
        if (of_model)
            node.hinges.model.wheel_count ^= 4;
        else
            node.hinges.state.hinge[0].rest += 1;
        laconic_integrity_on_tick(&watch, &node, now_us);
        TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
        TEST_ASSERT_EQUAL_UINT8(of_model ? LACONIC_INTEGRITY_OF_MODEL : LACONIC_INTEGRITY_OF_MOTION, watch.broken);
    }
}

static laconic_node_config original;
static laconic_integrity range_watch;

static void watch_range(laconic_integrity_limits limits) {
    original = node.config;
    laconic_integrity_begin(&range_watch, &node, &original, &limits, LACONIC_INTEGRITY_RANGE);
    range_watch.has_vehicle = true;
    laconic_integrity_on_tick(&range_watch, &node, now_us);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_INTEGRITY_SOUND, range_watch.broken);
}

#define EXPECT_OUT_OF_RANGE(number, wrong) expect_out_of_range(number, wrong, #number)

static void expect_out_of_range(laconic_real *number, laconic_real wrong, const char *name) {
    const laconic_real right = *number;
    const uint8_t state = node.state;
    *number = wrong;
    laconic_integrity_on_tick(&range_watch, &node, now_us);
    TEST_ASSERT_EQUAL_UINT8_MESSAGE(LACONIC_INTEGRITY_OF_RANGE, range_watch.broken, name);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_WIRE_STATE_FAULT, node.state);
    *number = right;
    node.state = state;
    node.input[0].voltage_V[0] = 0;
    range_watch.broken = LACONIC_INTEGRITY_SOUND;
    laconic_integrity_on_tick(&range_watch, &node, now_us);
    TEST_ASSERT_EQUAL_UINT8(LACONIC_INTEGRITY_SOUND, range_watch.broken);
}

/* The ones of both kinds of vehicle: places, headings, angles, voltages. */
static void expect_limits_of(laconic_sum *x_m, laconic_sum *y_m, laconic_heading *heading, laconic_heading *hinge) {
    EXPECT_OUT_OF_RANGE(&x_m->value, 101);
    EXPECT_OUT_OF_RANGE(&y_m->value, -101);
    EXPECT_OUT_OF_RANGE(&x_m->rest, 1);
    EXPECT_OUT_OF_RANGE(&y_m->rest, -1);
    EXPECT_OUT_OF_RANGE(&heading->rest, 2);
    EXPECT_OUT_OF_RANGE(&hinge->rest, -2);
    EXPECT_OUT_OF_RANGE(&node.input[0].voltage_V[2], 51);
}

static void numbers_of_hinges_that_cannot_be_end_the_run(void) {
    const laconic_integrity_limits limits = {
        .speed_m_per_s = 10, .yaw_rate_rad_per_s = 20, .voltage_V = 50, .distance_m = 100};
    laconic_articulated_state *state = &node.hinges.state;
    load_tricycle(&prescribed);
    bench_start_lockstep();
    bench_step(1);
    watch_range(limits);
    expect_limits_of(&state->x_m, &state->y_m, &state->heading, &state->hinge[0]);
    EXPECT_OUT_OF_RANGE(&state->eta[0].value, 1000);
    EXPECT_OUT_OF_RANGE(&state->eta[0].rest, 1);
    EXPECT_OUT_OF_RANGE(&state->hinge_rate_rad_per_s[0], LACONIC_REAL_MAX * 2);
    bench_begin();
    begin_slipping();
    TEST_ASSERT_EQUAL_UINT8(0, commit());
    bench_start_lockstep();
    bench_step(1);
    watch_range(limits);
    laconic_tree_state *tree = &node.hinges.tree;
    expect_limits_of(&tree->x_m, &tree->y_m, &tree->heading, &tree->hinge[0]);
    EXPECT_OUT_OF_RANGE(&tree->z[0], 11);
    EXPECT_OUT_OF_RANGE(&tree->z[1], -11);
    EXPECT_OUT_OF_RANGE(&tree->z[2], 21);
    EXPECT_OUT_OF_RANGE(&tree->z[3], LACONIC_REAL_MAX * 2);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_hinge_that_slips_takes_the_commands_of_its_drive_and_no_others);
    RUN_TEST(a_step_that_the_core_refuses_ends_a_run_that_slips);
    RUN_TEST(raw_numbers_of_hinges_come_in_the_order_of_their_bits);
    RUN_TEST(raw_angles_reach_the_servos_of_a_vehicle_that_slips);
    RUN_TEST(raw_outputs_of_every_kind_stand_in_the_order_of_their_bits);
    RUN_TEST(memory_of_hinges_is_watched);
    RUN_TEST(numbers_of_hinges_that_cannot_be_end_the_run);
    return UNITY_END();
}
