/* Tests of warnings.c: what is told of grip, of lift and of voltages without a motor, once in a run. */
#include "fmi2_bench.h"
#include "model_interface.h"
#include "parts.h"

#define FMU_SLIP 1U /* of fmu_instance.warnings_given */

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

static void begin_with_little_grip(void) {
    set("step_s", 0, 0.01);
    set("friction_coefficient", 0, 0.02);
    set("com_z_m", 0, 0.1);
    initialise();
}

static fmi2Component quiet(const fmi2CallbackFunctions *callbacks) {
    fmi2FreeInstance(c);
    c = fmi2Instantiate("one", fmi2CoSimulation, fmu_token_2, NULL, callbacks, fmi2False, fmi2True);
    begin_with_little_grip();
    set("voltage_V", 1, 14);
    return c;
}

static void nothing_is_watched_where_nobody_listens(void) {
    static const fmi2CallbackFunctions callbacks = {log_2, calloc, free, NULL, NULL}, silent = {0};
    const fmi2String errors[1] = {"logStatusError"};
    quiet(&silent);
    OK(step(0, 0.05));
    TEST_ASSERT_TRUE(instance()->warnings_given == 0);
    quiet(&callbacks);
    OK(fmi2SetDebugLogging(c, fmi2True, 1, errors));
    OK(step(0, 0.05));
    TEST_ASSERT_TRUE(instance()->warnings_given == 0);
    OK(fmi2SetDebugLogging(c, fmi2True, 0, NULL));
    log_clear();
    OK(step(0.05, 0.05));
    ASSERT_LOGGED("logStatusWarning: at 0.05 s wheel 1 needs");
    TEST_ASSERT_EQUAL_INT(1, lines);
    TEST_ASSERT_EQUAL_UINT32(1, instance()->warnings_given);
}

/* Of slip, or of what lifts where slip has been told before, at its own time. A step with such forces is refused. */
static void forces_beyond_the_range_are_told_in_place_of_slip_and_lift(void) {
    for (int told = 0; told < 2; told++) {
        make(fmi2ModelExchange);
        set("friction_coefficient", 0, 0.02);
        set("com_z_m", 0, 0.1);
        initialise();
        OK(fmi2EnterContinuousTimeMode(c));
        if (told) set("voltage_V", 1, 3);
        OK(fmi2CompletedIntegratorStep(c, fmi2True, NULL, NULL));
        TEST_ASSERT_EQUAL_UINT32(told, instance()->warnings_given);
        OK(fmi2SetTime(c, 3));
        set("body_force_N", 1, 1e160);
        log_clear();
        OK(fmi2CompletedIntegratorStep(c, fmi2True, NULL, NULL));
        ASSERT_LOGGED("at 3 s the forces on the ground leave the range of double precision; check the inputs");
        TEST_ASSERT_TRUE(lines == 1 && instance()->warnings_given == 3);
    }
}

static void a_limited_drive_on_ideal_ground_is_watched_for_slip(void) {
    set("step_s", 0, 0.01);
    set("friction_coefficient", 0, 0.02);
    set("com_z_m", 0, 0.1);
    set("supply_V", 0, 24);
    set("winding_resistance_ohm", 0, 1.5);
    initialise();
    set("voltage_V", 1, 14);
    log_clear();
    OK(step(0, 0.05));
    ASSERT_LOGGED("the model has no slip, so its motion no longer holds");
    const laconic_grip_event *event = &instance()->model.pending_slip;
    const double has_N = 0.02 * event->normal_N;
    char told[160];
    snprintf(told, sizeof told,
             "wheel %d needs %.4g N of grip and has %.4g N (friction_coefficient = 0.02): %.4g N are",
             (int)event->point, event->needed_N, has_N, event->needed_N - has_N);
    ASSERT_LOGGED(told);
    TEST_ASSERT_TRUE(event->needed_N > has_N && has_N > 0);
}

/* Both at once, each told one time, and again in another run. */
static void slip_and_lift_are_told_once_in_a_run(void) {
    for (int run = 0; run < 2; run++) {
        if (run > 0) OK(fmi2Reset(c));
        set("step_s", 0, 0.01);
        set("com_z_m", 0, 0.5);
        set("friction_coefficient", 0, 0.02);
        initialise();
        log_clear();
        set("body_force_N", 1, 2000);
        set("voltage_V", 1, 14);
        OK(step(0, 0.02));
        TEST_ASSERT_EQUAL_INT(2, lines);
        TEST_ASSERT_EQUAL_UINT32(3, instance()->warnings_given);
        OK(step(0.02, 0.02));
        TEST_ASSERT_EQUAL_INT(2, lines);
    }
}

/* What is told of one run is not told of the next, in which nothing slips. */
static void a_run_after_a_reset_has_its_own_warnings(void) {
    begin_with_little_grip();
    set("voltage_V", 1, 14);
    OK(step(0, 0.02));
    TEST_ASSERT_TRUE(instance()->warnings_given != 0);
    OK(fmi2Reset(c));
    begin_with_little_grip();
    log_clear();
    OK(step(0, 0.02));
    TEST_ASSERT_EQUAL_INT(0, lines);
    set("voltage_V", 1, 14);
    OK(step(0.02, 0.02));
    ASSERT_LOGGED("logStatusWarning: at 0.02 s wheel 1 needs");
}

/* They state that results are invalid; what else there is to tell, only who asks for it is told. */
static void warnings_are_told_also_where_logging_is_off(void) {
    static const fmi2CallbackFunctions callbacks = {log_2, calloc, free, NULL, NULL};
    fmi2FreeInstance(c);
    c = fmi2Instantiate("one", fmi2CoSimulation, fmu_token_2, NULL, &callbacks, fmi2False, fmi2False);
    begin_with_little_grip();
    set("motor_gain_Nm_per_V", 0, 0.21); /* an event */
    OK(step(0, 0.01));
    TEST_ASSERT_EQUAL_INT(0, lines);
    set("voltage_V", 1, 14);
    OK(step(0.01, 0.01));
    ASSERT_LOGGED("logStatusWarning: at 0.01 s wheel 1 needs");
}

/* Within a communication step of many internal ones, at the step where it begins. */
static void a_warning_has_the_time_of_its_internal_step(void) {
    const fmi2ValueReference voltage = ref("voltage_V", 1);
    const fmi2Integer first = 1;
    const double slope = 10;
    double begins = 0;
    for (int sloped = 1; sloped >= 0; sloped--) {
        make(fmi2CoSimulation);
        set("step_s", 0, 0.125);
        set("friction_coefficient", 0, 0.02);
        set("com_z_m", 0, 0.1);
        OK(fmi2SetupExperiment(c, fmi2False, 0, 3, fmi2False, 0));
        initialise();
        log_clear();
        if (sloped) {
            OK(fmi2SetRealInputDerivatives(c, &voltage, 1, &first, &slope));
            OK(step(3, 1));
        } else {
            set("voltage_V", 1, 14);
            OK(step(3, 1));
        }
        TEST_ASSERT_EQUAL_UINT32(FMU_SLIP, instance()->warnings_given & FMU_SLIP);
        begins = instance()->model.slip_s;
        TEST_ASSERT_TRUE(sloped ? begins > 3 && begins < 4 && fmod(begins, 0.125) == 0 : begins == 3);
    }
}

/* A vehicle that a moment turns faster and faster: as many steps by the importer tell the same time. */
static void a_warning_within_a_held_step_has_the_time_of_its_internal_step(void) {
    double begins[2];
    for (int single = 0; single < 2; single++) {
        make(fmi2CoSimulation);
        set("step_s", 0, 0.125);
        set("friction_coefficient", 0, 0.05);
        set("com_y_m", 0, 0.05);
        set("com_z_m", 0, 0.1);
        OK(fmi2SetupExperiment(c, fmi2False, 0, 3, fmi2False, 0));
        initialise();
        set("body_moment_Nm", 0, 2);
        for (int k = 0; k < (single ? 8 : 1); k++) OK(step(3 + 0.125 * k, single ? 0.125 : 1));
        TEST_ASSERT_EQUAL_UINT32(FMU_SLIP, instance()->warnings_given & FMU_SLIP);
        begins[single] = instance()->model.slip_s;
    }
    TEST_ASSERT_TRUE(begins[0] > 3 && begins[0] < 4 && begins[0] == begins[1]);
}

static void a_wheel_or_a_support_that_lifts_has_its_number(void) {
    initialise();
    for (int point = 1; point <= 6; point++) {
        const laconic_grip_event event = {.point = point, .needed_N = 1, .normal_N = -2, .margin_N = -3};
        char told[80];
        instance()->model.pending_lift = event;
        instance()->model.lift_s = 5;
        instance()->warnings_pending = FMU_LIFT_WARNING;
        fmu_model_settle_warnings(instance(), true);
        snprintf(told, sizeof told, "at 5 s %s %d lifts: its normal load would be -2 N",
                 point > 4 ? "support" : "wheel", point > 4 ? point - 4 : point);
        ASSERT_LOGGED(told);
    }
}

/* What is told of a wheel, whatever it needs and carries. */
static void settle_slip(double needed_N, double normal_N, double margin_N) {
    const laconic_grip_event event = {.point = 3, .needed_N = needed_N, .normal_N = normal_N, .margin_N = margin_N};
    instance()->model.pending_slip = event;
    instance()->model.slip_s = 5;
    instance()->warnings_pending = FMU_SLIP_WARNING;
    log_clear();
    fmu_model_settle_warnings(instance(), true);
    TEST_ASSERT_EQUAL_INT(1, lines);
}

static void a_wheel_has_grip_as_far_as_it_carries_something(void) {
    set("friction_coefficient", 0, 0.5);
    initialise();
    settle_slip(3, -2, -4);
    ASSERT_LOGGED("at 5 s wheel 3 needs 3 N of grip and has 0 N (friction_coefficient = 0.5): 3 N are missing");
    settle_slip(3, 0, -3);
    ASSERT_LOGGED("needs 3 N of grip and has 0 N");
    settle_slip(3, 0.5, -2.75);
    ASSERT_LOGGED("needs 3 N of grip and has 0.25 N (friction_coefficient = 0.5): 2.75 N are missing");
    settle_slip(3, 4, -1);
    ASSERT_LOGGED("needs 3 N of grip and has 2 N (friction_coefficient = 0.5): 1 N are missing");
}

/* Their sum says whether forces are within the range. */
static void forces_are_told_while_their_sum_is_a_number(void) {
    const double large = 1e308;
    initialise();
    settle_slip(large, -large, 0);
    ASSERT_LOGGED("needs 1e+308 N of grip");
    settle_slip(large, 0, -large);
    ASSERT_LOGGED("needs 1e+308 N of grip");
    settle_slip(large, large, 0);
    ASSERT_LOGGED("leave the range of double precision");
    settle_slip(large, 0, large);
    ASSERT_LOGGED("leave the range of double precision");
    settle_slip(1, NOT_A_NUMBER, 1);
    ASSERT_LOGGED("leave the range of double precision");
}

static void a_refused_step_gives_no_warning(void) {
    set("step_s", 0, 0.01);
    set("friction_coefficient", 0, 0.02);
    initialise();
    set("body_force_N", 1, 1.7e308);
    set("body_force_N", 2, 1.7e308);
    ASSERT_DISCARDED(step(0, 0.01), "is refused");
    TEST_ASSERT_EQUAL_INT(1, lines);
    TEST_ASSERT_TRUE(instance()->warnings_given == 0 && instance()->warnings_pending == 0);
}

/* A support is numbered from 1, as wheels are. It needs no grip; the wheels' slip is told when they have none left. */
static void a_support_that_lifts_is_told_and_slip_after_it(void) {
    set("step_s", 0, 0.01);
    set_integer("support_count", 0, 1);
    set("support_x_m", 1, -1);
    set("support_y_m", 1, 0);
    set("com_z_m", 0, 0.5);
    set("friction_coefficient", 0, 100);
    initialise();
    set("body_force_N", 1, 200);
    log_clear();
    OK(step(0, 0.01));
    ASSERT_LOGGED("at 0 s support 1 lifts: its normal load would be -");
    TEST_ASSERT_EQUAL_INT(1, lines);
    OK(step(0.01, 0.01));
    TEST_ASSERT_EQUAL_UINT32(2, instance()->warnings_given);
    set("friction_coefficient", 0, 0.02);
    OK(step(0.02, 0.01));
    ASSERT_LOGGED("at 0.02 s wheel ");
    ASSERT_LOGGED("(friction_coefficient = 0.02)");
    TEST_ASSERT_EQUAL_UINT32(3, instance()->warnings_given);
    TEST_ASSERT_EQUAL_INT(3, lines); /* with that of the change */
}

/* ---- a voltage for a wheel without a motor is told once in a run, and beside other warnings. */

/* 1 V, too, which is a voltage as any other; 0 V is none. */
static void each_wheel_without_a_motor_is_told_by_its_number(void) {
    for (uint32_t idle = 1; idle <= 4; idle++) {
        char told[80];
        make(fmi2CoSimulation);
        set_flag("wheel_undriven", idle);
        initialise();
        TEST_ASSERT_TRUE(instance()->model.idle_wheels);
        log_clear();
        for (uint32_t k = 1; k <= 4; k++) set("voltage_V", k, k == idle ? 0 : 5);
        TEST_ASSERT_EQUAL_INT(0, lines);
        set("voltage_V", idle, 1);
        snprintf(told, sizeof told, "voltage_V[%u]: 1 V has no effect: wheel %u has no motor", (unsigned)idle,
                 (unsigned)idle);
        ASSERT_LOGGED(told);
        set("voltage_V", idle, 6);
        TEST_ASSERT_EQUAL_INT(1, lines);
    }
}

static void it_is_told_again_in_another_run(void) {
    for (int run = 0; run < 2; run++) {
        if (run > 0) OK(fmi2Reset(c));
        set_flag("wheel_undriven", 1);
        initialise();
        log_clear();
        set("voltage_V", 1, 5);
        TEST_ASSERT_EQUAL_INT(1, lines);
    }
}

/* Gains of 1 N m/V, 0 and 1 again: for all wheels, while there are voltages. Nothing is sought where all have one. */
static void motors_may_lose_their_gain_in_a_run_and_get_it_back(void) {
    set("motor_gain_Nm_per_V", 0, 1);
    set("step_s", 0, 0.01);
    initialise();
    TEST_ASSERT_FALSE(instance()->model.idle_wheels);
    set("motor_gain_Nm_per_V", 0, 0);
    OK(step(0, 0.01));
    TEST_ASSERT_TRUE(instance()->model.idle_wheels);
    log_clear();
    set("voltage_V", 1, 5);
    ASSERT_LOGGED("voltage_V[1]: 5 V has no effect");
    set("motor_gain_Nm_per_V", 0, 1);
    OK(step(0.01, 0.01));
    TEST_ASSERT_FALSE(instance()->model.idle_wheels);
}

/* Of voltage, slip and lift each is told, whichever is first. */
static void warnings_of_voltage_and_of_ground_do_not_end_each_other(void) {
    for (int first = 0; first < 2; first++) {
        make(fmi2CoSimulation);
        set_flag("wheel_undriven", 2);
        set("step_s", 0, 0.01);
        set("com_z_m", 0, 0.5);
        set("friction_coefficient", 0, 0.02);
        initialise();
        log_clear();
        if (first == 0) set("voltage_V", 2, 5);
        TEST_ASSERT_EQUAL_INT(first == 0, lines);
        set("body_force_N", 1, 2000);
        set("voltage_V", 1, 14);
        OK(step(0, 0.01));
        TEST_ASSERT_EQUAL_INT(first == 0 ? 3 : 2, lines);
        if (first == 1) set("voltage_V", 2, 5);
        TEST_ASSERT_EQUAL_INT(3, lines);
        TEST_ASSERT_EQUAL_UINT32(FMU_SLIP_WARNING | FMU_LIFT_WARNING | FMU_IDLE_WARNING, instance()->warnings_given);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(nothing_is_watched_where_nobody_listens);
    RUN_TEST(forces_beyond_the_range_are_told_in_place_of_slip_and_lift);
    RUN_TEST(a_limited_drive_on_ideal_ground_is_watched_for_slip);
    RUN_TEST(slip_and_lift_are_told_once_in_a_run);
    RUN_TEST(a_run_after_a_reset_has_its_own_warnings);
    RUN_TEST(warnings_are_told_also_where_logging_is_off);
    RUN_TEST(a_warning_has_the_time_of_its_internal_step);
    RUN_TEST(a_warning_within_a_held_step_has_the_time_of_its_internal_step);
    RUN_TEST(a_wheel_or_a_support_that_lifts_has_its_number);
    RUN_TEST(a_wheel_has_grip_as_far_as_it_carries_something);
    RUN_TEST(forces_are_told_while_their_sum_is_a_number);
    RUN_TEST(a_refused_step_gives_no_warning);
    RUN_TEST(a_support_that_lifts_is_told_and_slip_after_it);
    RUN_TEST(each_wheel_without_a_motor_is_told_by_its_number);
    RUN_TEST(it_is_told_again_in_another_run);
    RUN_TEST(motors_may_lose_their_gain_in_a_run_and_get_it_back);
    RUN_TEST(warnings_of_voltage_and_of_ground_do_not_end_each_other);
    return UNITY_END();
}
