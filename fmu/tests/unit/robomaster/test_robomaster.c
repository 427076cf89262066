/* Tests of robomaster/model.c: feedback in, the limited loops beside their formula, a command each period. */
#include "model_interface.h"
#include "network_bench.h"
#include "short_memory.h"

void setUp(void) { begin_test(); }
void tearDown(void) { end_test(); }

#define RPM 0.10471975511965977 /* rad/s */

static double period_s, ratio, kp, ki, limit_A;

static void begin(void) {
    const fmu_model *model = &instance()->model;
    OK(begin_from(0));
    period_s = model->period_s, ratio = model->gear_ratio;
    kp = model->proportional_As_per_rad, ki = model->integral_A_per_rad, limit_A = model->limit_A;
    take("CAN"); /* its bit rate */
}

static void feedback(uint32_t motor, int16_t rpm) {
    laconic_frame frame = {.id = 0x201 + motor, .length = 8};
    frame.data[2] = (uint8_t)((uint16_t)rpm >> 8);
    frame.data[3] = (uint8_t)(rpm & 255);
    ls_bus_put_frame(&out, &frame, false);
    give("CAN", &out);
    out.size = 0;
    update();
}

/* Currents of the next command, in its units. */
static void command(int16_t raw[4]) {
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, next());
    TEST_ASSERT_TRUE(told.frame.id == 0x200 && told.frame.length == 8 && !told.frame.extended);
    for (int k = 0; k < 4; k++) raw[k] = (int16_t)(told.frame.data[2 * k] << 8 | told.frame.data[2 * k + 1]);
}

static void feedback_is_a_speed_of_its_wheel(void) {
    begin();
    for (uint32_t k = 0; k < 4; k++) feedback(k, (int16_t)(1000 - 700 * (int)k));
    for (uint32_t k = 0; k < 4; k++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, (1000 - 700 * (int)k) * RPM / ratio, get_real("measured_rad_per_s", k + 1));
    TEST_ASSERT_EQUAL_INT32(4, get_integer("frames_heard"));
}

static void other_frames_are_no_feedback(void) {
    static const laconic_frame others[] = {{.id = 0x200, .length = 8, .data = {1, 1, 1, 1}},
                                           {.id = 0x205, .length = 8, .data = {1, 1, 1, 1}},
                                           {.id = 0x201, .length = 7, .data = {1, 1, 1, 1}},
                                           {.id = 0x201, .length = 8, .extended = true, .data = {1, 1, 1, 1}},
                                           {.id = 0x201, .length = 8, .remote = true, .data = {1, 1, 1, 1}},
                                           {.id = 0x201, .length = 8, .fd = true, .data = {1, 1, 1, 1}}};
    begin();
    instance()->model.can.fd_bit_rate_bit_per_s = 1000000; /* so that it hears the last */
    for (size_t k = 0; k < 6; k++) ls_bus_put_frame(&out, &others[k], false);
    give("CAN", &out);
    update();
    TEST_ASSERT_EQUAL_INT32(6, get_integer("frames_heard"));
    for (uint32_t k = 1; k <= 4; k++) TEST_ASSERT_TRUE(get_real("measured_rad_per_s", k) == 0);
    const fmi3ValueReference data = ref("CAN.Rx_Data", 0);
    const fmi3Binary value = out.bytes;
    OK(fmi3SetBinary(c, &data, 1, &out.size, &value, 1)); /* without its clock nothing comes */
    update();
    TEST_ASSERT_EQUAL_INT32(6, get_integer("frames_heard"));
}

/* i = K_p e + K_i I, limited; I stops while i is limited and e would drive it further beyond. */
static void currents_are_those_of_the_limited_loops(void) {
    const double wished[4] = {3, -2, 400, -400};
    double integral[4] = {0}, sum = 0;
    int16_t raw[4];
    begin();
    for (uint32_t k = 0; k < 4; k++) set_real("setpoint_rad_per_s", k + 1, wished[k]);
    for (uint32_t k = 0; k < 4; k++) feedback(k, 100);
    for (int n = 0; n < 40; n++) {
        if (n == 30) /* beyond its limit, and the error drives it back */
            for (uint32_t k = 2; k < 4; k++) {
                set_real("setpoint_rad_per_s", k + 1, 0);
                feedback(k, k == 2 ? 100 : -100);
                instance()->model.error_rad[k] = integral[k] = (k == 2 ? 10 : -10) * limit_A / ki;
            }
        step(n * period_s, period_s);
        TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("CAN"));
        told_to = 0;
        command(raw);
        for (uint32_t k = 0; k < 4; k++) {
            const bool turned = n >= 30 && k >= 2;
            const double rpm = turned && k == 3 ? -100 : 100;
            const double e = ratio * ((turned ? 0 : wished[k]) - rpm * RPM / ratio);
            const double amperes = kp * e + ki * integral[k];
            const double shown = amperes > limit_A ? limit_A : amperes < -limit_A ? -limit_A : amperes;
            if (!((amperes > limit_A && e > 0) || (amperes < -limit_A && e < 0))) integral[k] += e * period_s;
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, shown, get_real("current_A", k + 1));
            TEST_ASSERT_EQUAL_INT16((int16_t)lround(shown * 16384 / 20), raw[k]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, integral[k], instance()->model.error_rad[k]);
            sum += fabs(shown);
        }
    }
    TEST_ASSERT_TRUE(sum > 100);
    TEST_ASSERT_EQUAL_INT32(40, get_integer("frames_sent"));
}

/* At the limit itself a loop is not limited: its integral goes on. */
static void at_its_limit_a_loop_goes_on(void) {
    set_real("gear_ratio", 0, 1);
    set_real("proportional_gain_As_per_rad", 0, 1);
    set_real("current_limit_A", 0, 2);
    begin();
    set_real("setpoint_rad_per_s", 1, -2);
    set_real("setpoint_rad_per_s", 2, 2);
    step(0, period_s);
    TEST_ASSERT_TRUE(get_real("current_A", 1) == -2 && get_real("current_A", 2) == 2);
    TEST_ASSERT_TRUE(instance()->model.error_rad[0] == -2 * period_s && instance()->model.error_rad[1] == 2 * period_s);
}

/* A hundredth of a unit at a time, either way. */
static void currents_are_rounded_to_the_nearest_unit(void) {
    int16_t raw[4];
    set_real("gear_ratio", 0, 1);
    set_real("proportional_gain_As_per_rad", 0, 1);
    set_real("integral_gain_A_per_rad", 0, 0);
    begin();
    for (int n = 0; n < 100; n++) {
        const double units[2] = {-1.003 - 0.01 * n, 1.003 + 0.01 * n};
        for (uint32_t k = 0; k < 2; k++) set_real("setpoint_rad_per_s", k + 1, units[k] * 20 / 16384);
        step(n * period_s, period_s);
        TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("CAN"));
        told_to = 0;
        command(raw);
        for (uint32_t k = 0; k < 2; k++) TEST_ASSERT_EQUAL_INT16((int16_t)lround(units[k]), raw[k]);
    }
}

/* Outputs may be read in initialization, and settings changed behind it: what the first start sent is gone. */
/* However small the error is: it holds the integral, or drives it back. */
static void at_its_limit_a_loop_is_held_by_any_error(void) {
    set_real("gear_ratio", 0, 1);
    begin();
    const double beyond = 10 * limit_A / ki, error = 0.25;
    for (uint32_t k = 0; k < 4; k++) {
        instance()->model.error_rad[k] = k < 2 ? beyond : -beyond;
        set_real("setpoint_rad_per_s", k + 1, k % 2 == 0 ? error : -error);
    }
    step(0, period_s);
    const double *integral = instance()->model.error_rad;
    TEST_ASSERT_TRUE(integral[0] == beyond && integral[1] == beyond - error * period_s);
    TEST_ASSERT_TRUE(integral[2] == -beyond + error * period_s && integral[3] == -beyond);
}

/* Three thousandths beside the half, either way. */
static void currents_beside_a_half_go_to_the_nearer_unit(void) {
    static const double beside[4] = {0.497, 0.503, -0.497, -0.503};
    int16_t raw[4];
    set_real("gear_ratio", 0, 1);
    set_real("proportional_gain_As_per_rad", 0, 1);
    set_real("integral_gain_A_per_rad", 0, 0);
    begin();
    for (int whole = 0; whole < 3; whole++) {
        for (uint32_t k = 0; k < 4; k++)
            set_real("setpoint_rad_per_s", k + 1, (beside[k] + (k < 2 ? whole : -whole)) * 20 / 16384);
        step(whole * period_s, period_s);
        TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("CAN"));
        told_to = 0;
        command(raw);
        TEST_ASSERT_TRUE(raw[0] == whole && raw[1] == whole + 1 && raw[2] == -whole && raw[3] == -whole - 1);
    }
}

static void a_second_start_begins_anew(void) {
    OK(fmi3EnterInitializationMode(c, false, 0, 0, false, 0));
    TEST_ASSERT_TRUE(get_real("current_A", 1) == 0);
    set_integer("bit_rate_bit_per_s", 250000);
    OK(fmi3ExitInitializationMode(c));
    TEST_ASSERT_EQUAL(LS_BUS_CONFIGURATION, first_of("CAN"));
    TEST_ASSERT_EQUAL_UINT32(250000, (uint32_t)told.value);
    TEST_ASSERT_EQUAL(LS_BUS_CONFIGURATION, next());
    TEST_ASSERT_EQUAL(0, next());
}

static void each_period_has_its_command_however_long_the_step(void) {
    begin();
    step(0, 3.5 * period_s);
    take("CAN");
    told_to = 0;
    for (int k = 0; k < 3; k++) TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, next());
    TEST_ASSERT_EQUAL(0, next());
    step(3.5 * period_s, 0.4 * period_s);
    TEST_ASSERT_EQUAL(0, first_of("CAN"));
    step(3.9 * period_s, 0.1 * period_s);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("CAN"));
}

/* A step that ends a billionth of a period before it has reached it, with the sum of its times. */
static void a_period_ends_at_its_end_to_a_billionth(void) {
    begin();
    step(0, period_s * (1 - 5e-9));
    TEST_ASSERT_EQUAL(0, first_of("CAN"));
    double end_s = period_s * (1 - 1e-9);
    while (end_s / period_s + 1e-9 > 1) end_s = nextafter(end_s, 0);
    while (end_s / period_s + 1e-9 < 1) end_s = nextafter(end_s, 1);
    TEST_ASSERT_TRUE(end_s / period_s + 1e-9 == 1);
    fmu_model_advance(instance(), end_s);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("CAN"));
}

/* With bus notifications a command waits for the one before it; a newer one replaces it. */
static void a_command_that_waits_is_replaced(void) {
    int16_t raw[4];
    set_flag("org.fmi_standard.fmi_ls_bus.Can_BusNotifications");
    begin();
    set_real("setpoint_rad_per_s", 1, 1);
    step(0, period_s);
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("CAN"));
    const double first_A = get_real("current_A", 1);
    step(period_s, 2 * period_s);
    TEST_ASSERT_EQUAL(0, first_of("CAN"));
    ls_bus_put_id(&out, LS_BUS_CONFIRM, 0x200);
    give("CAN", &out);
    update();
    TEST_ASSERT_EQUAL_INT32(1, get_integer("frames_sent"));
    step(3 * period_s, 0.5 * period_s);
    take("CAN");
    told_to = 0;
    command(raw);
    const double third_A = get_real("current_A", 1);
    TEST_ASSERT_TRUE(third_A > first_A);
    TEST_ASSERT_EQUAL_INT16((int16_t)lround(third_A * 16384 / 20), raw[0]);
    TEST_ASSERT_EQUAL(0, next());
    TEST_ASSERT_EQUAL_INT32(2, get_integer("frames_sent"));
}

/* Off the bus no command goes; then the time of the bus lets it back. */
static void off_the_bus_time_brings_it_back(void) {
    set_flag("org.fmi_standard.fmi_ls_bus.Can_BusNotifications");
    begin();
    for (int k = 0; k < 32; k++) {
        ls_bus_put_error(&out, 1, LS_BUS_CRC_ERROR, LS_BUS_SECONDARY_ERROR_FLAG, true);
    }
    give("CAN", &out);
    out.size = 0;
    update();
    TEST_ASSERT_EQUAL_INT32(LS_BUS_BUS_OFF, instance()->model.can.status);
    const double off_s = (double)instance()->model.can.off_until_us * 1e-6;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 128 * 11 / (double)instance()->model.can.bit_rate_bit_per_s, off_s);
    step(0, off_s - 2e-6);
    TEST_ASSERT_EQUAL_INT32(LS_BUS_BUS_OFF, instance()->model.can.status);
    step(off_s - 2e-6, 2e-6);
    TEST_ASSERT_EQUAL_INT32(LS_BUS_ERROR_ACTIVE, instance()->model.can.status);
    ls_bus_put_error(&out, 1, LS_BUS_CRC_ERROR, LS_BUS_SECONDARY_ERROR_FLAG, true);
    for (int k = 0; k < 31; k++) ls_bus_put_error(&out, 1, LS_BUS_CRC_ERROR, LS_BUS_SECONDARY_ERROR_FLAG, true);
    give("CAN", &out);
    update();
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2 * off_s, (double)instance()->model.can.off_until_us * 1e-6); /* from now */
}

/* Its wait is told in whole microseconds, and the time of a step is rounded to the nearest one. */
static void off_the_bus_it_returns_at_the_nearest_microsecond(void) {
    for (int late = 0; late < 2; late++) {
        make();
        set_flag("org.fmi_standard.fmi_ls_bus.Can_BusNotifications");
        OK(begin_from(3));
        take("CAN");
        step(3, late ? 10.503e-6 : 10.497e-6);
        for (int k = 0; k < 32; k++) ls_bus_put_error(&out, 1, LS_BUS_CRC_ERROR, LS_BUS_SECONDARY_ERROR_FLAG, true);
        give("CAN", &out);
        out.size = 0;
        update();
        const can_controller *can = &instance()->model.can;
        const uint64_t wait_us = 128 * 11 * 1000000U / (uint32_t)can->bit_rate_bit_per_s;
        TEST_ASSERT_EQUAL_UINT64(wait_us + (late ? 11 : 10), can->off_until_us);
        const double end_s = 3 + (double)can->off_until_us * 1e-6, now_s = get_real("time", 0);
        step(now_s, end_s - 0.503e-6 - now_s);
        TEST_ASSERT_EQUAL_INT32(LS_BUS_BUS_OFF, can->status);
        step(end_s - 0.503e-6, 0.006e-6);
        TEST_ASSERT_EQUAL_INT32(LS_BUS_ERROR_ACTIVE, can->status);
    }
}

static void setpoints_are_read_before_initialization_and_outputs_are_not(void) {
    const fmi3ValueReference setpoint = ref("setpoint_rad_per_s", 0), current = ref("current_A", 0),
                             count = ref("frames_sent", 0);
    double values[4] = {1, 2, 3, 4};
    int32_t number = 7;
    OK(fmi3SetFloat64(c, &setpoint, 1, values, 4));
    values[3] = 0;
    OK(fmi3GetFloat64(c, &setpoint, 1, values, 4));
    TEST_ASSERT_TRUE(values[0] == 1 && values[3] == 4);
    ASSERT_REFUSED(fmi3GetFloat64(c, &current, 1, values, 4), "it has no value before initialization");
    ASSERT_REFUSED(fmi3GetInt32(c, &count, 1, &number, 1), "it has no value before initialization");
}

static void a_countdown_says_when_the_next_command_comes(void) {
    bool known;
    OK(begin_from(7));
    TEST_ASSERT_TRUE(countdown("CAN", &known) == 1e-6 && known); /* its bit rate is ready */
    take("CAN");
    const double period = instance()->model.period_s;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, period, countdown("CAN", &known));
    step(7, 0.25 * period);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.75 * period, countdown("CAN", &known));
    step(7 + 0.25 * period, 0.75 * period - 0.5e-6);
    TEST_ASSERT_TRUE(countdown("CAN", &known) == 1e-6);
    instance()->model.time_s = 7 + period - 5e-6;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 5e-6, countdown("CAN", &known));
    instance()->model.time_s = 7 + period - 0.5e-6;
    step(7 + period - 0.5e-6, 0.5e-6);
    TEST_ASSERT_TRUE(countdown("CAN", &known) == 1e-6); /* the command is ready */
    TEST_ASSERT_EQUAL(LS_BUS_CAN_TRANSMIT, first_of("CAN"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, period, countdown("CAN", &known));
}

static void at_its_start_it_tells_its_bit_rate_at_the_first_communication_point(void) {
    OK(begin_from(0));
    TEST_ASSERT_TRUE(update());
    const fmi3ValueReference clock = ref("CAN.Tx_Clock", 0);
    bool active = false;
    OK(fmi3GetClock(c, &clock, 1, &active));
    TEST_ASSERT_TRUE(active && instance()->model.port[0].offered == 13 + 10);
}

static void what_cannot_start_is_refused(void) {
    set_real("gear_ratio", 0, 0);
    ASSERT_REFUSED(begin_from(0), "gear_ratio: 0 turns no wheel; give another one");
    set_real("gear_ratio", 0, -19);
    OK(fmi3ExitInitializationMode(c));
    make();
    ASSERT_REFUSED(begin_from(5e9), "the start time 5000000000 s cannot be taken");
}

static void it_has_no_start_values_of_its_own(void) {
    TEST_ASSERT_FALSE(fmu_model_take_private(instance(), FMU_PRIVATE_START, 1));
}

static void a_reset_forgets_what_was_measured(void) {
    begin();
    for (uint32_t k = 0; k < 4; k++) {
        set_real("setpoint_rad_per_s", k + 1, 5);
        feedback(k, 500);
    }
    step(0, 4 * period_s);
    fmu_model *model = &instance()->model;
    model->start_needed = model->change_needed = model->is_due = true; /* another start, without a reset */
    update();
    TEST_ASSERT_TRUE(!model->start_needed && !model->change_needed && !model->is_due && model->periods == 0);
    for (int k = 0; k < 4; k++)
        TEST_ASSERT_TRUE(model->measured_rad_per_s[k] == 0 && model->error_rad[k] == 0 && model->current_A[k] == 0);
    OK(fmi3Reset(c));
    begin();
    TEST_ASSERT_TRUE(get_real("measured_rad_per_s", 1) == 0 && get_real("current_A", 1) == 0);
    TEST_ASSERT_TRUE(instance()->model.error_rad[0] == 0 && instance()->model.periods == 0);
    step(0, 0.5 * period_s);
    TEST_ASSERT_EQUAL(0, first_of("CAN"));
}

/* ---- tests of the glue around a model with a single bus terminal: what an instance needs, and what it does not
 * offer. */

static void its_clocks_need_event_mode(void) {
    const int before = short_memory_blocks;
    TEST_ASSERT_NULL(make_3(false));
    ASSERT_LOGGED("the clocks of a bus need event mode; import the FMU with it");
    TEST_ASSERT_EQUAL_INT(before, short_memory_blocks);
}

static void it_is_for_co_simulation_alone(void) {
    const int before = short_memory_blocks;
    TEST_ASSERT_NULL(fmi3InstantiateModelExchange("a", fmu_token_3, NULL, false, true, NULL, log_3));
    ASSERT_LOGGED("this FMU offers no Model Exchange; use Co-Simulation");
    TEST_ASSERT_EQUAL_INT(before, short_memory_blocks);
}

static void it_has_no_structural_parameters(void) {
    ASSERT_REFUSED(fmi3EnterConfigurationMode(c), "this FMU has no structural parameters");
    TEST_ASSERT_EQUAL(FMU_INSTANTIATED, instance()->mode);
}

/* The command of a period is due behind it, that of the next one not yet. */
static void a_step_tells_whether_its_terminal_has_an_event(void) {
    bool event = false, terminate = true, early = true;
    double end_s = 7;
    OK(begin_from(0));
    take("CAN"); /* its bit rate */
    const double one_s = instance()->model.period_s;
    OK(fmi3EnterStepMode(c));
    OK(fmi3DoStep(c, 0, one_s, true, &event, &terminate, &early, &end_s));
    TEST_ASSERT_TRUE(event && !terminate && !early && end_s == one_s);
    OK(fmi3EnterEventMode(c));
    take("CAN");
    OK(fmi3EnterStepMode(c));
    OK(fmi3DoStep(c, one_s, 0.5 * one_s, true, &event, NULL, NULL, NULL));
    TEST_ASSERT_FALSE(event);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(feedback_is_a_speed_of_its_wheel);
    RUN_TEST(other_frames_are_no_feedback);
    RUN_TEST(currents_are_those_of_the_limited_loops);
    RUN_TEST(at_its_limit_a_loop_goes_on);
    RUN_TEST(currents_are_rounded_to_the_nearest_unit);
    RUN_TEST(at_its_limit_a_loop_is_held_by_any_error);
    RUN_TEST(currents_beside_a_half_go_to_the_nearer_unit);
    RUN_TEST(a_second_start_begins_anew);
    RUN_TEST(each_period_has_its_command_however_long_the_step);
    RUN_TEST(a_period_ends_at_its_end_to_a_billionth);
    RUN_TEST(a_command_that_waits_is_replaced);
    RUN_TEST(off_the_bus_time_brings_it_back);
    RUN_TEST(off_the_bus_it_returns_at_the_nearest_microsecond);
    RUN_TEST(setpoints_are_read_before_initialization_and_outputs_are_not);
    RUN_TEST(a_countdown_says_when_the_next_command_comes);
    RUN_TEST(at_its_start_it_tells_its_bit_rate_at_the_first_communication_point);
    RUN_TEST(what_cannot_start_is_refused);
    RUN_TEST(it_has_no_start_values_of_its_own);
    RUN_TEST(a_reset_forgets_what_was_measured);
    RUN_TEST(its_clocks_need_event_mode);
    RUN_TEST(it_is_for_co_simulation_alone);
    RUN_TEST(it_has_no_structural_parameters);
    RUN_TEST(a_step_tells_whether_its_terminal_has_an_event);
    return UNITY_END();
}
