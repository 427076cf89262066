/* Tests of node/model.c: its bus and its clock. */
#include "node_bench.h"

static void what_nobody_takes_waits_in_the_node_and_is_told_once(void) {
    OK(begin_from(100));
    instance()->model.port[0].tx.size = LS_BUS_BUFFER_BYTES - 2 * LS_BUS_LARGEST_OPERATION;
    log_clear();
    step(100, 0);
    TEST_ASSERT_EQUAL_INT(0, lines);
    instance()->model.port[0].tx.size++;
    step(100, 0);
    ASSERT_LOGGED("logStatusWarning: CAN.Tx_Data is full at 100 s: more frames wait in the node");
    step(100, 0.5);
    TEST_ASSERT_EQUAL_INT(1, lines);
    TEST_ASSERT_TRUE(instance()->model.can.sent <= 1);
    instance()->model.port[0].tx.size = 0;
    step(100.5, 0);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("CAN"));
}

/* The time of the run, not of the node, whose clock begins with it. */
static void a_full_terminal_is_told_with_the_time_of_the_run(void) {
    OK(begin_from(100));
    step(100, 0.5);
    instance()->model.port[0].tx.size = LS_BUS_BUFFER_BYTES - LS_BUS_LARGEST_OPERATION;
    log_clear();
    step(100.5, 0.25);
    ASSERT_LOGGED("CAN.Tx_Data is full at 100.");
    double told_s = 0;
    TEST_ASSERT_EQUAL_INT(1, sscanf(strstr(logged, "full at ") + 8, "%lf", &told_s));
    TEST_ASSERT_TRUE(told_s >= 100.5 && told_s <= 100.75);
}

/* Also in the middle of a step, at the instant at which its time is over. */
static void off_the_bus_it_returns_when_its_time_is_over(void) {
    set_flag("org.fmi_standard.fmi_ls_bus.Can_BusNotifications");
    begin();
    take("CAN");
    for (int k = 0; k < 32; k++) ls_bus_put_error(&out, 1, LS_BUS_CRC_ERROR, LS_BUS_SECONDARY_ERROR_FLAG, true);
    give("CAN", &out);
    out.size = 0;
    update();
    TEST_ASSERT_EQUAL_INT32(LS_BUS_BUS_OFF, get_integer("bus_status"));
    TEST_ASSERT_EQUAL(LS_BUS_STATUS, first_of("CAN"));
    bool known;
    TEST_ASSERT_EQUAL_UINT64(1408, instance()->model.can.off_until_us);
    const double wait_s = countdown("CAN", &known);
    TEST_ASSERT_TRUE(wait_s <= 1408e-6 && known);
    step(0, 1407e-6);
    TEST_ASSERT_EQUAL_INT32(LS_BUS_BUS_OFF, get_integer("bus_status"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1e-6, countdown("CAN", &known));
    step(1407e-6, 1e-6);
    TEST_ASSERT_EQUAL_INT32(LS_BUS_ERROR_ACTIVE, get_integer("bus_status"));
    TEST_ASSERT_EQUAL_INT32(0, get_integer("transmit_errors"));
}

static void another_start_begins_at_its_time(void) {
    begin();
    step(0, 0.5);
    fmu_model *model = &instance()->model;
    model->start_needed = model->change_needed = model->is_full = true;
    model->stale = 0;
    update();
    TEST_ASSERT_TRUE(model->now_us == 0 && !model->is_full && !model->start_needed && !model->change_needed);
    TEST_ASSERT_EQUAL_UINT32(FMU_GROUPS_ALL, model->stale);
}

/* At a low bit rate the node's own instants come before the bus lets it back. */
static void off_a_slow_bus_the_node_ticks_on(void) {
    bool known;
    set_flag("org.fmi_standard.fmi_ls_bus.Can_BusNotifications");
    set_integer("bit_rate_bit_per_s", 1000);
    begin();
    for (int k = 0; k < 32; k++) ls_bus_put_error(&out, 1, LS_BUS_CRC_ERROR, LS_BUS_SECONDARY_ERROR_FLAG, true);
    give("CAN", &out);
    out.size = 0;
    update();
    take("CAN");
    step(0, 0.01);
    take("CAN");
    TEST_ASSERT_EQUAL_UINT64(1408000, instance()->model.can.off_until_us);
    const double idle_s = countdown("CAN", &known);
    TEST_ASSERT_TRUE(idle_s == laconic_node_idle_us(&instance()->model.node, 10000) * 1e-6 && idle_s < 1);
}

/* A scene with more wheels than the FMU has outputs for shows the first ones. */
static void wheels_are_shown_as_far_as_there_are_outputs(void) {
    cart(true);
    load();
    instance()->model.wheel_count = 1;
    begin();
    set_real("body_force_N", 1, 3);
    set_real("body_force_N", 2, 3);
    step(0, 0.1);
    TEST_ASSERT_TRUE(get_real("wheel_angle_rad", 1) != 0);
    TEST_ASSERT_TRUE(instance()->model.wheel_angle_rad[1] == 0);
}

/* A scene with fewer wheels leaves the outputs behind them. */
static void outputs_behind_the_last_wheel_stay(void) {
    cart(true);
    load();
    begin();
    fmu_model *model = &instance()->model;
    model->wheel_speed_rad_per_s[2] = model->wheel_angle_rad[2] = model->axle_torque_Nm[2] = 9;
    step(0, 0.1);
    TEST_ASSERT_TRUE(get_real("wheel_speed_rad_per_s", 3) == 9 && get_real("wheel_angle_rad", 3) == 9);
    TEST_ASSERT_TRUE(get_real("axle_torque_Nm", 3) == 9);
}

/* Those that are held, as drives play them. */
static void torques_are_those_at_the_axles(void) {
    cart(true);
    load();
    begin();
    set_real("body_force_N", 1, 3);
    step(0, 0.1);
    for (unsigned k = 0; k < 3; k++)
        for (uint32_t wheel = 0; wheel < 2; wheel++)
            instance()->model.node.input[k].axle_torque_Nm[wheel] = 10.0 * k + 1 + wheel;
    TEST_ASSERT_TRUE(get_real("axle_torque_Nm", 1) == 1 && get_real("axle_torque_Nm", 2) == 2);
}

/* Marks in the place of outputs stay until time passes, or an event. */
static void outputs_are_computed_once_after_each_step(void) {
    cart(true);
    load();
    begin();
    fmu_model *model = &instance()->model;
    step(0, 0.1);
    TEST_ASSERT_TRUE(get_real("x_m", 0) == 7);
    model->x_m = 99;
    TEST_ASSERT_TRUE(get_real("x_m", 0) == 99);
    fmu_model_refresh(instance(), FMU_GROUPS_ALL);
    TEST_ASSERT_TRUE(model->x_m == 99);
    update(); /* frames may have come */
    TEST_ASSERT_TRUE(get_real("x_m", 0) == 7);
    model->x_m = 99;
    step(0.1, 0.1);
    TEST_ASSERT_TRUE(get_real("x_m", 0) == 7);
}

/* The node answers in the event in which a frame comes: its answer can go at the end of it. */
static void an_answer_is_ready_in_the_event(void) {
    bool known;
    begin();
    take("CAN");
    bench_hello();
    by_bus();
    TEST_ASSERT_TRUE(countdown("CAN", &known) == 1e-6 && known);
    take("CAN");
    told_to = 0;
    while (next() != 0 && told.id != LACONIC_WIRE_ID_BASE + LACONIC_WIRE_CHALLENGE) {
    }
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, told.code);
    TEST_ASSERT_EQUAL_HEX32(LACONIC_WIRE_ID_BASE + LACONIC_WIRE_CHALLENGE, told.id);
}

/* The boot-up message of a CANopen drive is on its way when the run begins. */
static void what_drives_send_first_goes_at_the_start(void) {
    cart_with(1);
    load();
    begin();
    TEST_ASSERT_EQUAL_INT32(1, get_integer("frames_sent"));
    TEST_ASSERT_EQUAL(LS_BUS_CONFIGURATION, first_of("CAN"));
    TEST_ASSERT_EQUAL(LS_BUS_CONFIGURATION, next());
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, next());
    TEST_ASSERT_TRUE(told.id == 0x700 + 7 && told.frame.length == 1 && told.frame.data[0] == 0);
}

/* Outputs may be read in initialization, and settings changed behind it: what the first start sent is gone. */
static void a_second_start_begins_anew(void) {
    OK(fmi3EnterInitializationMode(c, false, 0, 0, false, 0));
    TEST_ASSERT_EQUAL_INT32(LS_BUS_ERROR_ACTIVE, get_integer("bus_status"));
    set_integer("bit_rate_bit_per_s", 250000);
    OK(fmi3ExitInitializationMode(c));
    TEST_ASSERT_EQUAL(LS_BUS_CONFIGURATION, first_of("CAN"));
    TEST_ASSERT_EQUAL_UINT32(250000, told.value);
    TEST_ASSERT_EQUAL(LS_BUS_CONFIGURATION, next());
    TEST_ASSERT_EQUAL(0, next());
}

/* What stands in the memory behind them is none of the rig's. */
static void as_many_frames_are_loaded_as_came(void) {
    cart(false);
    load();
    instance()->model.frame_count--; /* the COMMIT is still there */
    ASSERT_REFUSED(begin_from(0), "the scene in resources/start.bin cannot be loaded");
    instance()->model.frame_count++;
    OK(fmi3ExitInitializationMode(c));
}

static void inputs_are_read_before_initialization_and_outputs_are_not(void) {
    static const char *const reals[] = {"x_m", "heading_rad", "velocity_body_m_per_s", "nu_rad_per_s",
                                        "axle_torque_Nm"};
    static const char *const counts[] = {"node_state", "frames_sent", "wrong_operations", "bus_status"};
    double value = 7;
    int32_t number = 7;
    set_real("body_force_N", 2, 3);
    set_real("body_moment_Nm", 0, 4);
    TEST_ASSERT_TRUE(get_real("body_force_N", 2) == 3 && get_real("body_moment_Nm", 0) == 4);
    for (size_t k = 0; k < sizeof reals / sizeof reals[0]; k++) {
        const fmi3ValueReference output = ref(reals[k], k < 2 ? 0 : 1);
        ASSERT_REFUSED(fmi3GetFloat64(c, &output, 1, &value, 1), "it has no value before initialization");
    }
    for (size_t k = 0; k < sizeof counts / sizeof counts[0]; k++) {
        const fmi3ValueReference output = ref(counts[k], 0);
        ASSERT_REFUSED(fmi3GetInt32(c, &output, 1, &number, 1), "it has no value before initialization");
    }
}

static void at_its_start_it_tells_its_bit_rate_at_the_first_communication_point(void) {
    begin();
    TEST_ASSERT_TRUE(update());
    const fmi3ValueReference clock = ref("CAN.Tx_Clock", 0);
    bool active = false;
    OK(fmi3GetClock(c, &clock, 1, &active));
    TEST_ASSERT_TRUE(active && instance()->model.port[0].offered == 13 + 10);
}

static void an_empty_node_s_next_instant_is_its_heartbeat(void) {
    bool known;
    begin();
    TEST_ASSERT_TRUE(countdown("CAN", &known) == 1e-6 && known); /* its bit rate is ready */
    take("CAN");
    step(0, 1e-3);
    take("CAN");
    const double idle_s = countdown("CAN", &known);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, laconic_node_idle_us(&instance()->model.node, 1000) * 1e-6, idle_s);
    TEST_ASSERT_TRUE(idle_s > 1e-3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, laconic_node_idle_us(&node, 1000) * 1e-6, idle_s); /* as without an FMU */
    step(1e-3, idle_s);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("CAN"));
    TEST_ASSERT_EQUAL_HEX32(LACONIC_WIRE_ID_BASE + LACONIC_WIRE_HEARTBEAT, told.id);
}

static void times_are_rounded_to_microseconds_and_never_go_back(void) {
    begin();
    step(0, 1.497e-6);
    TEST_ASSERT_EQUAL_UINT64(1, instance()->model.now_us);
    step(1.497e-6, 0.006e-6);
    TEST_ASSERT_EQUAL_UINT64(2, instance()->model.now_us);
    instance()->model.time_s = 1e-6;
    OK(try_step(1e-6, 0));
    TEST_ASSERT_EQUAL_UINT64(2, instance()->model.now_us);
}

static void with_can_fd_the_node_hears_its_frames(void) {
    const laconic_frame frame = {.id = 1, .length = 12, .fd = true};
    static const int32_t rates[3] = {0, 1, 2000000};
    for (int k = 0; k < 3; k++) {
        const bool fd = k > 0;
        make();
        set_integer("fd_bit_rate_bit_per_s", rates[k]);
        begin();
        TEST_ASSERT_EQUAL(fd, instance()->model.node.config.can_fd);
        ls_bus_put_frame(&out, &frame, false);
        give("CAN", &out);
        out.size = 0;
        update();
        TEST_ASSERT_EQUAL_INT32(fd, get_integer("frames_heard"));
    }
    const fmi3ValueReference data = ref("CAN.Rx_Data", 0);
    ls_bus_put_frame(&out, &frame, false);
    const fmi3Binary value = out.bytes;
    OK(fmi3SetBinary(c, &data, 1, &out.size, &value, 1)); /* without its clock nothing comes */
    update();
    TEST_ASSERT_EQUAL_INT32(1, get_integer("frames_heard"));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(what_nobody_takes_waits_in_the_node_and_is_told_once);
    RUN_TEST(a_full_terminal_is_told_with_the_time_of_the_run);
    RUN_TEST(off_the_bus_it_returns_when_its_time_is_over);
    RUN_TEST(another_start_begins_at_its_time);
    RUN_TEST(off_a_slow_bus_the_node_ticks_on);
    RUN_TEST(wheels_are_shown_as_far_as_there_are_outputs);
    RUN_TEST(outputs_behind_the_last_wheel_stay);
    RUN_TEST(torques_are_those_at_the_axles);
    RUN_TEST(outputs_are_computed_once_after_each_step);
    RUN_TEST(an_answer_is_ready_in_the_event);
    RUN_TEST(what_drives_send_first_goes_at_the_start);
    RUN_TEST(a_second_start_begins_anew);
    RUN_TEST(as_many_frames_are_loaded_as_came);
    RUN_TEST(inputs_are_read_before_initialization_and_outputs_are_not);
    RUN_TEST(at_its_start_it_tells_its_bit_rate_at_the_first_communication_point);
    RUN_TEST(an_empty_node_s_next_instant_is_its_heartbeat);
    RUN_TEST(times_are_rounded_to_microseconds_and_never_go_back);
    RUN_TEST(with_can_fd_the_node_hears_its_frames);
    return UNITY_END();
}
