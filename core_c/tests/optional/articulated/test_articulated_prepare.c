/* Tests of articulated_check.c, _bodies.c, _prepare.c and _examine.c: what a vehicle becomes, and what is refused. */
#include "hinged_vehicles.h"

#define OF(IDENTIFIER) ((laconic_field)LACONIC_FIELD_OF_##IDENTIFIER)

static laconic_refusal why;
static laconic_articulated_model model;

static laconic_status prepared(const laconic_articulated_vehicle *v) {
    memset(&model, 0, sizeof model);
    return laconic_articulated_prepare(&model, v, &why);
}

static void a_caster_and_a_trailer_follow(void) {
    laconic_articulated_vehicle v = with_two_casters();
    ASSERT_STATUS(LACONIC_OK, prepared(&v));
    TEST_ASSERT_EQUAL_INT(2, model.dof);
    TEST_ASSERT_EQUAL_INT(0, model.row_count);
    TEST_ASSERT_EQUAL_INT(LACONIC_MOTION_FOLLOWING, model.link[0].motion);
    ASSERT_NEAR(ROUNDING * 100, 1 / 0.04, fabs((double)model.link[0].axle_per_lever.y));
}

static void a_wheel_under_its_hinge_is_a_row_left_over(void) {
    laconic_articulated_vehicle v = tricycle(LACONIC_HINGE_MOTOR);
    ASSERT_STATUS(LACONIC_OK, prepared(&v));
    TEST_ASSERT_EQUAL_INT(LACONIC_MOTION_OWN, model.link[0].motion);
    TEST_ASSERT_EQUAL_INT(3, model.dof);
    TEST_ASSERT_EQUAL_INT(1, model.row_count);
}

static void a_second_axle_of_a_trailer_is_a_row_left_over(void) {
    laconic_articulated_vehicle v = with_trailer(free_carriage());
    hang_wheel(&v, 1, -0.6, 0.1, 0.004);
    ASSERT_STATUS(LACONIC_OK, prepared(&v));
    TEST_ASSERT_EQUAL_INT(LACONIC_MOTION_FOLLOWING, model.link[0].motion);
    TEST_ASSERT_EQUAL_INT(1, model.row_count);
}

static void coordinated_vehicles_have_one_velocity(void) {
    laconic_articulated_vehicle v = swerve(LACONIC_HINGE_COORDINATED, 4);
    ASSERT_STATUS(LACONIC_OK, prepared(&v));
    TEST_ASSERT_EQUAL_INT(1, model.dof);
    TEST_ASSERT_EQUAL_INT(0, model.row_count);
}

static void a_vehicle_without_hinges_is_a_carriage(void) {
    laconic_articulated_vehicle v = two_wheeler();
    ASSERT_STATUS(LACONIC_OK, prepared(&v));
    TEST_ASSERT_EQUAL_INT(2, model.dof);
}

/* The number of a refusal's body, wheel or component, and a line of text that names field and remedy. */
static void assert_named(laconic_status status, laconic_field field, int item, const laconic_articulated_vehicle *v,
                         const char *beginning, const char *remedy) {
    char text[400];
    const laconic_articulated_model before = model;
    memset(&why, 0, sizeof why);
    ASSERT_STATUS(status, laconic_articulated_prepare(&model, v, &why));
    TEST_ASSERT_EQUAL_MEMORY(&before, &model, sizeof model);
    TEST_ASSERT_EQUAL_STRING(laconic_field_name(field), laconic_field_name(why.field));
    TEST_ASSERT_EQUAL_INT(item, why.item);
    laconic_message(&why, text, sizeof text);
    TEST_ASSERT_EQUAL_STRING_LEN(beginning, text, strlen(beginning));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, remedy), text);
}

static void numbers_are_checked_body_by_body(void) {
    laconic_articulated_vehicle v = with_two_casters();
    v.body[1].mass_kg = -1;
    assert_named(LACONIC_NEGATIVE, OF(BODY_MASS), 2, &v, "vehicle.body[2].mass_kg: -1", "above");
    v = with_two_casters();
    v.body[0].com_y_m = NOT_A_NUMBER;
    assert_named(LACONIC_NOT_FINITE, OF(BODY_COM_Y), 1, &v, "vehicle.body[1].com_y_m: NaN", "give a number");
    v = with_two_casters();
    v.body[1].hinge_x_m = REAL(EITHER(1e200, 1e30));
    assert_named(LACONIC_OVERFLOW, OF(BODY_HINGE_X), 2, &v, "vehicle.body[2].hinge_x_m", "units");
    v = with_two_casters();
    v.base.mass_kg = 0;
    assert_named(LACONIC_NOT_POSITIVE, LACONIC_FIELD_MASS, 0, &v, "vehicle.mass_kg", "above 0");
    v = with_two_casters();
    v.body[0].stiffness_Nm = -2;
    assert_named(LACONIC_NEGATIVE, OF(HINGE_STIFFNESS), 1, &v, "vehicle.body[1].stiffness_Nm", "above");
    v = with_two_casters();
    v.body[1].rest_rad = REAL(EITHER(1e13, 1e6)); /* of whose sine not one digit would be right */
    assert_named(LACONIC_OVERFLOW, OF(HINGE_REST), 2, &v, "vehicle.body[2].rest_rad", "");
    TEST_ASSERT_TRUE(why.limit > 0 && why.limit < v.body[1].rest_rad);
}

static void bodies_and_hinges_must_exist(void) {
    laconic_articulated_vehicle v = with_two_casters();
    v.body_count = LACONIC_MAX_BODIES + 1;
    assert_named(LACONIC_TOO_MANY_BODIES, OF(BODY_COUNT), 0, &v, "vehicle.body: 9", "LACONIC_MAX_BODIES");
    v.body_count = -1;
    assert_named(LACONIC_TOO_MANY_BODIES, OF(BODY_COUNT), 0, &v, "vehicle.body: -1", "LACONIC_MAX_BODIES");
    v = with_two_casters();
    v.body[1].hinge = LACONIC_HINGE_UNSET;
    assert_named(LACONIC_HINGE_NOT_SET, OF(BODY_HINGE), 2, &v, "vehicle.body[2].hinge", "give its kind");
    v.body[1].hinge = (laconic_hinge_kind)7;
    assert_named(LACONIC_HINGE_KIND_UNKNOWN, OF(BODY_HINGE), 2, &v, "vehicle.body[2].hinge: 7", "1 (free)");
    v.body[1].hinge = (laconic_hinge_kind)-1;
    assert_named(LACONIC_HINGE_KIND_UNKNOWN, OF(BODY_HINGE), 2, &v, "vehicle.body[2].hinge: -1", "1 (free)");
    v = with_two_casters();
    v.wheel_body[3] = 3;
    assert_named(LACONIC_BODY_UNKNOWN, OF(WHEEL_BODY), 4, &v, "vehicle.wheel[4].body: 3", "to 2");
    v.wheel_body[3] = -1;
    assert_named(LACONIC_BODY_UNKNOWN, OF(WHEEL_BODY), 4, &v, "vehicle.wheel[4].body: -1", "to 2");
}

static void a_parent_comes_before_its_body(void) {
    laconic_articulated_vehicle v = with_two_casters();
    v.body[1].parent = 2; /* itself: a cycle */
    assert_named(LACONIC_BODY_UNKNOWN, OF(BODY_PARENT), 2, &v, "vehicle.body[2].parent: 2", "parents before");
    v.body[0].parent = 2; /* forward */
    assert_named(LACONIC_BODY_UNKNOWN, OF(BODY_PARENT), 1, &v, "vehicle.body[1].parent: 2", "parents before");
    v.body[0].parent = -1;
    assert_named(LACONIC_BODY_UNKNOWN, OF(BODY_PARENT), 1, &v, "vehicle.body[1].parent: -1", "parents before");
}

static void a_caster_of_trail_0_is_steered_freely_and_needs_inertia(void) {
    laconic_articulated_vehicle v = two_wheeler();
    laconic_body *fork = hang_body(&v, 0, LACONIC_HINGE_FREE, 0.22, 0, 0.6, 0.002, 0, 0);
    hang_wheel(&v, 1, 0, 0, 0);
    ASSERT_STATUS(LACONIC_OK, prepared(&v));
    TEST_ASSERT_EQUAL_INT(LACONIC_MOTION_OWN, model.link[0].motion);
    fork->yaw_inertia_kgm2 = 0;
    assert_named(LACONIC_MASSLESS_HINGE, OF(BODY_YAW_INERTIA), 1, &v, "vehicle.body[1].yaw_inertia_kgm2", "trail");
    v.base.wheel[2].y_m = REAL(0.03); /* the hinge lies on the axle line */
    assert_named(LACONIC_MASSLESS_HINGE, OF(BODY_YAW_INERTIA), 1, &v, "vehicle.body[1].yaw_inertia_kgm2", "prescribe");
    v.base.wheel[2].own_inertia_kgm2 = REAL(0.001); /* it rolls when the hinge turns: that is inertia */
    ASSERT_STATUS(LACONIC_OK, prepared(&v));
    v.base.wheel[2].x_m = REAL(-0.02); /* a trail */
    v.base.wheel[2].own_inertia_kgm2 = 0;
    ASSERT_STATUS(LACONIC_OK, prepared(&v));
    TEST_ASSERT_EQUAL_INT(LACONIC_MOTION_FOLLOWING, model.link[0].motion);
}

static void massless_steering_is_prescribed_or_follows(void) {
    laconic_articulated_vehicle v = tricycle(LACONIC_HINGE_MOTOR);
    v.body[0].mass_kg = v.body[0].yaw_inertia_kgm2 = 0;
    v.base.wheel[2].own_inertia_kgm2 = 0;
    assert_named(LACONIC_MASSLESS_HINGE, OF(BODY_YAW_INERTIA), 1, &v, "vehicle.body[1]", "prescribe");
    v.body[0].hinge = LACONIC_HINGE_PRESCRIBED;
    ASSERT_STATUS(LACONIC_OK, prepared(&v));
}

static void three_motor_driven_modules_are_refused_and_two_are_sound(void) {
    laconic_articulated_vehicle v = swerve(LACONIC_HINGE_MOTOR, 2);
    ASSERT_STATUS(LACONIC_OK, prepared(&v));
    TEST_ASSERT_EQUAL_INT(5, model.dof);
    v = swerve(LACONIC_HINGE_MOTOR, 3);
    assert_named(LACONIC_STEERED_TOO_OFTEN, OF(BODY_COUNT), 0, &v, "vehicle.body: 3 axle lines", "coordinated");
    v = swerve(LACONIC_HINGE_FREE, 4);
    assert_named(LACONIC_STEERED_TOO_OFTEN, OF(BODY_COUNT), 0, &v, "vehicle.body: 4 axle lines", "friction");
    v = tricycle(LACONIC_HINGE_MOTOR);
    hang_body(&v, 0, LACONIC_HINGE_MOTOR, 1.2, 0.5, 15, 0.25, 0, 0);
    hang_wheel(&v, 2, 0, 0, 0.06);
    assert_named(LACONIC_STEERED_TOO_OFTEN, OF(BODY_COUNT), 0, &v, "vehicle.body: 3 axle lines", "coordinated");
}

static void a_coordinated_wheel_rolls_along_its_body(void) {
    laconic_articulated_vehicle v = swerve(LACONIC_HINGE_COORDINATED, 4);
    v.base.wheel[2].axle_rad = REAL(ALONG + 0.01);
    assert_named(LACONIC_COORDINATED_WHEEL, LACONIC_FIELD_AXLE, 3, &v, "vehicle.wheel[3].axle_rad", "pi/2");
    v = swerve(LACONIC_HINGE_COORDINATED, 4);
    v.base.wheel[1].x_m = REAL(-0.02);
    assert_named(LACONIC_COORDINATED_WHEEL, LACONIC_FIELD_AXLE, 2, &v, "vehicle.wheel[2].axle_rad", "x_m = 0");
    v = swerve(LACONIC_HINGE_COORDINATED, 4);
    v.base.wheel[1].axle_rad = REAL(PI / 2); /* it turns backward: as good */
    ASSERT_STATUS(LACONIC_OK, prepared(&v));
    v.body[3].parent = 1;
    assert_named(LACONIC_COORDINATED_ON_BODY, OF(BODY_PARENT), 4, &v, "vehicle.body[4].parent", "prescribed");
}

static void a_twist_needs_wheels_that_hold_the_carriage_to_it(void) {
    laconic_articulated_vehicle v = swerve(LACONIC_HINGE_COORDINATED, 1);
    assert_named(LACONIC_COORDINATED_TOO_FEW, OF(BODY_COUNT), 0, &v, "vehicle.body: 1 axle lines", "2 are needed");
    v = swerve(LACONIC_HINGE_COORDINATED, 2);
    ASSERT_STATUS(LACONIC_OK, prepared(&v));
    v = tricycle(LACONIC_HINGE_COORDINATED);
    ASSERT_STATUS(LACONIC_OK, prepared(&v));
}

static void wheels_of_the_carriage_are_named_as_the_vehicle_counts_them(void) {
    laconic_articulated_vehicle v = two_wheeler();
    hang_caster(&v, 0.22, 0, 0.04);
    laconic_wheel *w = hang_wheel(&v, 0, 0.3, 0, 0);
    w->axle_rad = NOT_A_NUMBER;
    assert_named(LACONIC_NOT_FINITE, LACONIC_FIELD_AXLE, 4, &v, "vehicle.wheel[4].axle_rad", "number");
    w->axle_rad = REAL(0.3);
    w->x_m = REAL(0.5);
    hang_wheel(&v, 0, 0.4, 0.1, 0)->axle_rad = REAL(1.1);
    ASSERT_REFUSED(LACONIC_NOTHING_MOVES, LACONIC_FIELD_WHEEL_KIND, 5, prepared(&v), why);
}

static void friction_is_refused(void) {
    laconic_articulated_vehicle v = with_two_casters();
    v.base.ground.friction_coefficient = REAL(0.6);
    assert_named(LACONIC_FRICTION_WITH_HINGES, LACONIC_FIELD_GROUND_FRICTION_COEFFICIENT, 0, &v,
                 "ground.friction_coefficient: 0.6", "take it out");
    v = with_two_casters();
    v.base.drive.supply_V = 24;
    v.base.drive.winding_resistance_ohm = 1;
    assert_named(LACONIC_FRICTION_WITH_HINGES, LACONIC_FIELD_SUPPLY_VOLTAGE, 0, &v, "vehicle.drive.supply_V", "");
    v = with_two_casters();
    v.base.drive.current_limit_A = 3;
    v.base.drive.winding_resistance_ohm = 1;
    assert_named(LACONIC_FRICTION_WITH_HINGES, LACONIC_FIELD_CURRENT_LIMIT, 0, &v, "vehicle.drive.current_limit_A", "");
    v = with_two_casters();
    v.base.wheel[1].motor_circuit = LACONIC_MOTOR_OPEN;
    assert_named(LACONIC_FRICTION_WITH_HINGES, LACONIC_FIELD_MOTOR_CIRCUIT, 2, &v, "vehicle.wheel[2]", "");
}

static void methods_have_names_and_refuse_bad_steps(void) {
    laconic_articulated_integrator in;
    const laconic_articulated_model m = hinged_model(with_two_casters());
    memset(&in, 0, sizeof in);
    for (int k = 0; k < LACONIC_ARTICULATED_METHOD_COUNT; k++)
        TEST_ASSERT_EQUAL_INT(k, laconic_articulated_method_by_name(laconic_articulated_method_name(k)));
    TEST_ASSERT_EQUAL_INT(-1, laconic_articulated_method_by_name("euler"));
    TEST_ASSERT_EQUAL_STRING("", laconic_articulated_method_name(-1));
    TEST_ASSERT_EQUAL_STRING("", laconic_articulated_method_name(LACONIC_ARTICULATED_METHOD_COUNT));
    ASSERT_STATUS(LACONIC_METHOD_UNKNOWN, laconic_articulated_integrator_prepare(&in, -1, &m, REAL(0.01), &why));
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_articulated_integrator_prepare(&in, 0, &m, LACONIC_REAL_MIN, &why));
    ASSERT_STATUS(LACONIC_METHOD_UNKNOWN, laconic_articulated_integrator_prepare(&in, 4, &m, REAL(0.01), &why));
    char text[200];
    laconic_message(&why, text, sizeof text);
    for (int k = 0; k < LACONIC_ARTICULATED_METHOD_COUNT; k++)
        TEST_ASSERT_NOT_NULL(strstr(text, laconic_articulated_method_name(k)));
    TEST_ASSERT_NULL(strstr(text, "exact-flow"));
    ASSERT_STATUS(LACONIC_NOT_POSITIVE, laconic_articulated_integrator_prepare(&in, 0, &m, 0, &why));
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_articulated_integrator_prepare(&in, 0, &m, NOT_A_NUMBER, &why));
    ASSERT_STATUS(LACONIC_OVERFLOW, laconic_articulated_integrator_prepare(&in, 0, &m, REAL(1e30), &why));
    ASSERT_STATUS(LACONIC_STEP_BEYOND_DAMPING_LIMIT, laconic_articulated_integrator_prepare(&in, 1, &m, 3, &why));
    TEST_ASSERT_TRUE(why.limit > 0);
    ASSERT_STATUS(LACONIC_OK, laconic_articulated_integrator_prepare(&in, 1, &m, why.limit * REAL(0.99), &why));
    ASSERT_STATUS(LACONIC_OK, laconic_articulated_integrator_prepare(&in, 0, &m, 3, &why));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_caster_and_a_trailer_follow);
    RUN_TEST(a_wheel_under_its_hinge_is_a_row_left_over);
    RUN_TEST(a_second_axle_of_a_trailer_is_a_row_left_over);
    RUN_TEST(coordinated_vehicles_have_one_velocity);
    RUN_TEST(a_vehicle_without_hinges_is_a_carriage);
    RUN_TEST(numbers_are_checked_body_by_body);
    RUN_TEST(bodies_and_hinges_must_exist);
    RUN_TEST(a_parent_comes_before_its_body);
    RUN_TEST(a_caster_of_trail_0_is_steered_freely_and_needs_inertia);
    RUN_TEST(massless_steering_is_prescribed_or_follows);
    RUN_TEST(three_motor_driven_modules_are_refused_and_two_are_sound);
    RUN_TEST(a_coordinated_wheel_rolls_along_its_body);
    RUN_TEST(a_twist_needs_wheels_that_hold_the_carriage_to_it);
    RUN_TEST(wheels_of_the_carriage_are_named_as_the_vehicle_counts_them);
    RUN_TEST(friction_is_refused);
    RUN_TEST(methods_have_names_and_refuse_bad_steps);
    return UNITY_END();
}
