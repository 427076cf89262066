/* Tests of how a model changes with its vehicle, beside those of the steps that follow from it
 * (test_step_derivatives.c): of which numbers it is no change at all. */
#include "laconic/derivatives.h"
#include "vehicles.h"

static laconic_model_change change_of(const laconic_model *m, const laconic_vehicle *v, const laconic_vehicle *by) {
    laconic_model_change change;
    memset(&change, 0, sizeof change);
    ASSERT_STATUS(LACONIC_OK, laconic_model_tangent(&change, m, v, by));
    return change;
}

/* A change of every number of the body and of the wheels that it has. */
static laconic_vehicle some_change_of(const laconic_vehicle *v) {
    laconic_vehicle by;
    memset(&by, 0, sizeof by);
    by.mass_kg = REAL(1);
    by.yaw_inertia_kgm2 = REAL(0.02);
    by.com_x_m = REAL(0.01);
    by.com_y_m = REAL(-0.02);
    by.wheel_radius_m = REAL(0.004);
    by.wheel_inertia_kgm2 = REAL(0.001);
    for (int i = 0; i < v->wheel_count; i++) by.wheel[i].axle_rad = REAL(0.1);
    return by;
}

/* Fixed, locked and of another radius: each would bind the vehicle or turn with it. */
static void add_what_is_not_there(laconic_vehicle *v, laconic_vehicle *by) {
    for (int i = v->wheel_count; i < LACONIC_MAX_WHEELS; i++) {
        v->wheel[i].kind = LACONIC_WHEEL_FIXED;
        v->wheel[i].locked = true;
        v->wheel[i].x_m = REAL(0.3);
        v->wheel[i].axle_rad = REAL(0.8);
        v->wheel[i].own_radius_m = REAL(0.02);
        by->wheel[i].x_m = by->wheel[i].axle_rad = by->wheel[i].own_radius_m = REAL(0.7);
    }
}

static void wheels_that_a_vehicle_has_not_change_nothing(void) {
    const laconic_vehicle vehicles[] = {three_wheels(), differential_drive(), caster(), bare_body()};
    for (int n = 0; n < 4; n++) {
        laconic_vehicle v = with_motors(vehicles[n]), by = some_change_of(&v);
        const laconic_model m = model_of(v);
        const laconic_model_change without = change_of(&m, &v, &by);
        add_what_is_not_there(&v, &by);
        const laconic_model_change with = change_of(&m, &v, &by);
        TEST_ASSERT_EQUAL_MEMORY(&without, &with, sizeof with);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(wheels_that_a_vehicle_has_not_change_nothing);
    return UNITY_END();
}
