/* Tests of idle_motors.c: a voltage for a wheel without a motor is told once in a run, and beside other warnings. */
#include "fmi2_bench.h"
#include "grip_warning.h"
#include "model_interface.h"

void setUp(void) { begin_test(fmi2CoSimulation); }
void tearDown(void) { end_test(); }

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
    RUN_TEST(each_wheel_without_a_motor_is_told_by_its_number);
    RUN_TEST(it_is_told_again_in_another_run);
    RUN_TEST(motors_may_lose_their_gain_in_a_run_and_get_it_back);
    RUN_TEST(warnings_of_voltage_and_of_ground_do_not_end_each_other);
    return UNITY_END();
}
