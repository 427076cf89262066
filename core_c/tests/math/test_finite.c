/* Tests that all results of accepted vehicles are finite: constants, states, and what is computed from two models when
 * a vehicle changes. */
#include "vehicles.h"

static uint64_t seed;

static double chance(void) { /* from 0 to 1, by xorshift: the same on all platforms */
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (double)(seed >> 11) / 9007199254740992.0;
}

static bool one_in(int count) { return chance() * count < 1; }

/* Any size that the scalar type has, with its ends; one number in three has a size that is usual for robots. */
static laconic_real extreme(void) {
    const double decades = EITHER(307, 37);
    if (one_in(30)) return LACONIC_REAL_MAX;
    if (one_in(30)) return LACONIC_REAL_MIN * REAL(0.01);
    if (one_in(30)) return 0;
    if (one_in(3)) return REAL(pow(10, 4 * chance() - 3));
    return REAL(pow(10, (one_in(2) ? 1.0 : 0.5) * decades * (2 * chance() - 1)));
}

static laconic_real usual(void) { return one_in(6) ? extreme() : REAL(pow(10, 4 * chance() - 3)); }

static laconic_real either_sign(laconic_real x) { return one_in(2) ? -x : x; }

static laconic_vehicle any_vehicle(void) {
    laconic_vehicle v = bare_body();
    int32_t i, wheels = (int32_t)(5 * chance());
    v.mass_kg = usual();
    v.yaw_inertia_kgm2 = usual();
    v.com_x_m = either_sign(usual());
    v.com_z_m = usual();
    v.wheel_radius_m = usual();
    v.wheel_inertia_kgm2 = usual();
    v.motor_gain_Nm_per_V = either_sign(usual());
    v.motor_damping_Nms = usual();
    for (i = 0; i < wheels; i++) {
        add_wheel(&v, one_in(4) ? LACONIC_WHEEL_FIXED : LACONIC_WHEEL_ROLLER, (double)either_sign(usual()),
                  (double)either_sign(usual()), 7 * chance(), one_in(2) ? PI / 2 : 3 * chance());
        v.wheel[i].locked = one_in(8);
    }
    v.support_count = one_in(2) ? 1 : 0;
    v.support[0].x_m = either_sign(usual());
    return v;
}

static void change(laconic_vehicle *v) {
    switch ((int)(4 * chance())) {
    case 0: v->mass_kg = extreme(); break;
    case 1: v->yaw_inertia_kgm2 = extreme(); break;
    case 2: v->wheel_radius_m = extreme(); break;
    default:
        v->payload.mass_kg = usual();
        v->payload.x_m = either_sign(extreme());
        v->payload.y_m = either_sign(usual());
        v->payload.yaw_inertia_kgm2 = extreme();
    }
}

static void assert_finite(const laconic_real *numbers, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite((double)numbers[i])) TEST_FAIL_MESSAGE("a number that was accepted is not finite");
}

#define ASSERT_FINITE(array) assert_finite((const laconic_real *)(array), sizeof(array) / (sizeof(laconic_real)))

static void assert_model_finite(const laconic_model *m) {
    const size_t first = offsetof(laconic_model, nu_of_zeta); /* from there on all members are numbers */
    assert_finite(&m->nu_of_zeta[0][0], (sizeof *m - first) / sizeof(laconic_real));
}

static void assert_plant_finite(const laconic_plant *p) {
    const laconic_state *s = &p->state;
    laconic_real out[3];
    laconic_pose pose;
    assert_model_finite(&p->model);
    ASSERT_FINITE(p->integrator.decay);
    ASSERT_FINITE(s->zeta);
    ASSERT_FINITE(s->travel);
    ASSERT_FINITE(s->wheel_angle_set_rad);
    assert_finite(&s->x_m.value, 4);
    laconic_nu(&p->model, s, out);
    ASSERT_FINITE(out);
    out[2] = laconic_body_velocity(&p->model, s, out);
    ASSERT_FINITE(out);
    laconic_pose_of(&pose, &p->model, s);
    assert_finite(&pose.x_m, sizeof pose / sizeof(laconic_real));
    out[0] = laconic_energy_J(&p->model, s);
    assert_finite(out, 1);
}

static void assert_contact_finite(const laconic_vehicle *v) {
    laconic_contact c;
    if (laconic_contact_prepare(&c, v, NULL) != LACONIC_OK) return;
    assert_finite(&c.multiplier[0][0], 3 * (size_t)c.constraint_count);
    assert_finite(&c.normal_load_of_wrench[0][0], 3 * (size_t)c.point_count);
    assert_finite(&c.point_m[0][0], 2 * (size_t)c.point_count);
    assert_finite(c.inverse_arm_per_m, (size_t)v->wheel_count);
    assert_finite(&c.wheel_rows[0][0], 3 * (size_t)v->wheel_count);
    ASSERT_FINITE(c.inertia);
}

static int accepted; /* counted, so that refusing everything fails the test */

static void change_and_step(laconic_plant *plant, laconic_vehicle v) {
    const laconic_plant before = *plant;
    const laconic_input input = no_input();
    change(&v);
    if (laconic_plant_change(plant, &v, NULL) != LACONIC_OK) {
        TEST_ASSERT_EQUAL_MEMORY(&before, plant, sizeof before);
        return;
    }
    accepted++;
    assert_plant_finite(plant);
    assert_contact_finite(&v);
    (void)laconic_step(&plant->model, &plant->integrator, &plant->state, &input);
    assert_plant_finite(plant);
}

static void extreme_vehicles_and_changes_are_refused_or_finite(void) {
    seed = 88172645463325252U;
    for (int i = 0; i < 3000; i++) {
        const laconic_vehicle v = any_vehicle();
        const laconic_method *method = laconic_method_by_number(i % LACONIC_METHOD_COUNT);
        laconic_start start = start_with(0, 0, 0);
        laconic_plant plant;
        memset(&plant, 0, sizeof plant);
        start.x_m = either_sign(extreme());
        for (int k = 0; k < 3 && !one_in(2); k++) start.nu_rad_per_s[k] = either_sign(usual());
        if (laconic_plant_start(&plant, &v, method, usual(), &start, NULL) != LACONIC_OK) continue;
        assert_plant_finite(&plant);
        assert_contact_finite(&v);
        for (int k = 0; k < 8; k++) change_and_step(&plant, v);
    }
    TEST_ASSERT_TRUE(accepted > 2000);
}

/* The first two that were found: Λ became infinite, and then ν. */
static void a_payload_whose_inertia_leaves_the_range_is_refused_in_motion(void) {
    const laconic_start start = start_with(1, 0, 0);
    laconic_vehicle v = bare_body();
    laconic_plant plant, before;
    laconic_refusal why;
    memset(&plant, 0, sizeof plant);
    v.mass_kg = REAL(0.5);
    v.yaw_inertia_kgm2 = v.wheel_radius_m = REAL(1);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(0.01), &start, &why));
    before = plant;
    v.payload.mass_kg = REAL(0.1);
    v.payload.yaw_inertia_kgm2 = LACONIC_REAL_MAX;
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_PAYLOAD_YAW_INERTIA, 0, laconic_plant_change(&plant, &v, &why), why);
    v.payload.yaw_inertia_kgm2 = REAL(1);
    v.payload.x_m = REAL(EITHER(2e154, 2e19));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_PAYLOAD_X, 0, laconic_plant_change(&plant, &v, &why), why);
    TEST_ASSERT_EQUAL_MEMORY(&before, &plant, sizeof plant);
}

/* Both vehicles are accepted, but the motion of the one is out of range in the other. */
static void a_motion_that_the_new_vehicle_cannot_have_is_refused(void) {
    const laconic_start start = start_with(0, 0, EITHER(1e60, 1e8));
    laconic_vehicle v = bare_body();
    laconic_plant plant, before;
    laconic_refusal why;
    memset(&plant, 0, sizeof plant);
    v.yaw_inertia_kgm2 = REAL(EITHER(1e-30, 1e-8));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(0.01), &start, &why));
    before = plant;
    v.yaw_inertia_kgm2 = REAL(EITHER(1e30, 1e4));
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_plant_change(&plant, &v, &why), why);
    TEST_ASSERT_EQUAL_MEMORY(&before, &plant, sizeof plant);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(extreme_vehicles_and_changes_are_refused_or_finite);
    RUN_TEST(a_payload_whose_inertia_leaves_the_range_is_refused_in_motion);
    RUN_TEST(a_motion_that_the_new_vehicle_cannot_have_is_refused);
    return UNITY_END();
}
