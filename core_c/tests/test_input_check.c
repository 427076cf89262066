#include "vehicles.h"

static laconic_model model;
static laconic_refusal why;

static void a_finite_input_is_accepted(void) {
    const laconic_input input = every_input();
    ASSERT_STATUS(LACONIC_OK, laconic_input_check(&model, &input, &why));
}

static void what_lies_beyond_the_last_wheel_is_not_read(void) {
    laconic_input input = every_input();
    input.voltage_V[3] = input.axle_torque_Nm[3] = NOT_A_NUMBER;
    ASSERT_STATUS(LACONIC_OK, laconic_input_check(&model, &input, &why));
}

static void every_number_that_is_not_finite_is_named(void) {
    laconic_input good = every_input(), in;
#define REFUSES(member, bad, field, item) \
    in = good; \
    in.member = bad; \
    ASSERT_REFUSED(LACONIC_NOT_FINITE, field, item, laconic_input_check(&model, &in, &why), why)
    REFUSES(voltage_V[2], NOT_A_NUMBER, LACONIC_FIELD_VOLTAGE, 3);
    REFUSES(axle_torque_Nm[0], INFINITE, LACONIC_FIELD_AXLE_TORQUE, 1);
    REFUSES(body_force_N[1], -INFINITE, LACONIC_FIELD_BODY_FORCE, 2);
    REFUSES(body_moment_Nm, NOT_A_NUMBER, LACONIC_FIELD_BODY_MOMENT, 0);
    REFUSES(world_force_N[0], INFINITE, LACONIC_FIELD_WORLD_FORCE, 1);
    REFUSES(world_force_point_m[1], NOT_A_NUMBER, LACONIC_FIELD_WORLD_FORCE_POINT, 2);
#undef REFUSES
}

int main(void) {
    UNITY_BEGIN();
    model = model_of(three_wheels());
    RUN_TEST(a_finite_input_is_accepted);
    RUN_TEST(what_lies_beyond_the_last_wheel_is_not_read);
    RUN_TEST(every_number_that_is_not_finite_is_named);
    return UNITY_END();
}
