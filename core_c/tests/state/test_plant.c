/* Tests of plant.c: start, run and change of a vehicle that counts its steps. */
#include "methods.h"
#include "stack.h"

static laconic_refusal why;

static laconic_plant plant_of(laconic_vehicle v, const laconic_method *method, double step) {
    const laconic_start start = start_with(1, 2, 3);
    laconic_plant plant;
    memset(&plant, 0, sizeof plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, method, REAL(step), &start, &why));
    return plant;
}

static void running_is_stepping(void) {
    laconic_plant plant = plant_of(with_motors(three_wheels()), &laconic_rk4, 0.01);
    const laconic_input input = every_input();
    laconic_state state = plant.state;
    TEST_ASSERT_EQUAL_UINT64(0, plant.steps);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 30, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 20, NULL));
    take_steps(&laconic_rk4, &plant.model, &state, &input, 0.01, 50);
    TEST_ASSERT_EQUAL_UINT64(50, plant.steps);
    TEST_ASSERT_EQUAL_MEMORY(&state, &plant.state, sizeof state);
}

static void a_refused_start_changes_nothing(void) {
    laconic_plant plant = plant_of(three_wheels(), &laconic_rk4, 0.01), before = plant;
    laconic_vehicle v = three_wheels();
    laconic_start start = start_with(0, 0, 0);
    v.mass_kg = 0;
    ASSERT_REFUSED(LACONIC_NOT_POSITIVE, LACONIC_FIELD_MASS, 0,
                   laconic_plant_start(&plant, &v, &laconic_rk4, REAL(0.01), &start, &why), why);
    v = three_wheels();
    ASSERT_REFUSED(LACONIC_NOT_POSITIVE, LACONIC_FIELD_STEP, 0,
                   laconic_plant_start(&plant, &v, &laconic_rk4, REAL(0), &start, &why), why);
    start.x_m = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_START_X, 0,
                   laconic_plant_start(&plant, &v, &laconic_rk4, REAL(0.01), &start, &why), why);
    TEST_ASSERT_EQUAL_MEMORY(&before, &plant, sizeof plant);
}

/* Sanitizers see a read beyond the wheels; the largest count crashes without them, too. */
static void more_wheels_than_there_is_room_for_are_refused_before_any_of_them_is_read(void) {
    const int32_t counts[] = {LACONIC_MAX_WHEELS + 1, INT32_MAX, (int32_t)UINT32_MAX};
    laconic_plant plant = plant_of(three_wheels(), &laconic_auto, 0.01), before = plant;
    const laconic_start start = start_with(0, 0, 0);
    for (size_t k = 0; k < sizeof counts / sizeof counts[0]; k++) {
        laconic_vehicle v = with_motors(three_wheels());
        v.drive.supply_V = 12;
        v.ground.friction_coefficient = REAL(0.5);
        v.wheel_count = counts[k];
        TEST_ASSERT_FALSE(laconic_vehicle_has_friction(&v));
        ASSERT_REFUSED(LACONIC_TOO_MANY_WHEELS, LACONIC_FIELD_WHEEL_COUNT, 0,
                       laconic_plant_start(&plant, &v, &laconic_auto, REAL(0.01), &start, &why), why);
        ASSERT_REFUSED(LACONIC_TOO_MANY_WHEELS, LACONIC_FIELD_WHEEL_COUNT, 0, laconic_plant_change(&plant, &v, &why),
                       why);
    }
    TEST_ASSERT_EQUAL_MEMORY(&before, &plant, sizeof plant);
}

static void a_refused_step_stops_the_run_after_what_was_taken(void) {
    laconic_plant plant = plant_of(three_wheels(), &laconic_rk4, 0.1);
    laconic_input input = no_input();
    input.body_moment_Nm = REAL(10); /* yaws faster and faster until the step is beyond the gyroscopic limit */
    ASSERT_REFUSED(LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, LACONIC_FIELD_STEP, 0,
                   laconic_plant_run(&plant, &input, 100000, &why), why);
    TEST_ASSERT_TRUE(plant.steps > 0 && plant.steps < 100000);
    TEST_ASSERT_TRUE((double)why.limit < 0.1);
}

/* What stands behind the three samples of a step is none of them. */
static void of_a_refused_sampled_step_three_samples_are_asked(void) {
    laconic_vehicle v = three_wheels();
    laconic_plant plant = plant_of(v, &laconic_rk4, 0.1);
    const laconic_start start = start_with(0, 0, EITHER(1e60, 1e8));
    laconic_input samples[4] = {no_input(), no_input(), no_input(), no_input()};
    samples[3].body_moment_Nm = NOT_A_NUMBER;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_restart(&plant, &start, &why));
    ASSERT_REFUSED(LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, LACONIC_FIELD_STEP, 0,
                   laconic_plant_run_sampled(&plant, samples, &why), why);
    samples[2].body_moment_Nm = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_BODY_MOMENT, 0, laconic_plant_run_sampled(&plant, samples, &why),
                   why);
}

static void steps_that_are_taken_refuse_nothing(void) {
    const laconic_refusal untouched = {LACONIC_NEGATIVE, LACONIC_FIELD_MASS, 3, REAL(1), REAL(2)};
    const laconic_input samples[3] = {no_input(), no_input(), no_input()};
    for (int friction = 0; friction < 2; friction++) {
        laconic_vehicle v = three_wheels();
        if (friction) v.ground.friction_coefficient = REAL(0.5);
        laconic_plant plant = plant_of(v, &laconic_auto, 0.001);
        why = untouched;
        for (uint64_t steps = 0; steps < 3; steps++) {
            fill_stack(ALL_NAN);
            ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, samples, steps, &why));
        }
        ASSERT_STATUS(LACONIC_OK, laconic_plant_run_sampled(&plant, samples, &why));
        TEST_ASSERT_EQUAL_UINT64(4, plant.steps);
        TEST_ASSERT_EQUAL_MEMORY(&untouched, &why, sizeof why);
    }
}

static void an_input_that_is_not_finite_is_named(void) {
    laconic_plant plant = plant_of(three_wheels(), &laconic_auto, 0.1);
    laconic_input input = no_input();
    input.body_force_N[1] = NOT_A_NUMBER;
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_BODY_FORCE, 2, laconic_plant_run(&plant, &input, 1, &why), why);
}

static void the_count_of_steps_goes_on_with_another_step_size(void) {
    laconic_plant plant = plant_of(with_motors(three_wheels()), &laconic_rk4, 0.01), before;
    const laconic_input input = no_input();
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 5, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_set_step(&plant, REAL(0.02), &why));
    TEST_ASSERT_EQUAL_UINT64(5, plant.steps);
    ASSERT_NEAR(ROUNDING, 0.02, plant.integrator.step_s);
    before = plant;
    ASSERT_REFUSED(LACONIC_STEP_BEYOND_DAMPING_LIMIT, LACONIC_FIELD_STEP, 0,
                   laconic_plant_set_step(&plant, REAL(100), &why), why);
    TEST_ASSERT_EQUAL_MEMORY(&before, &plant, sizeof plant);
}

static void a_payload_in_motion_leaves_the_body_where_it_is(void) {
    laconic_plant plant = plant_of(three_wheels(), &laconic_exact_flow, 0.01);
    laconic_vehicle v = three_wheels();
    laconic_pose before, after;
    v.payload.mass_kg = REAL(5);
    v.payload.x_m = REAL(0.3);
    laconic_pose_of(&before, &plant.model, &plant.state);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &v, &why));
    laconic_pose_of(&after, &plant.model, &plant.state);
    ASSERT_NEAR(ROUNDING, before.origin_x_m, after.origin_x_m);
    ASSERT_NEAR(ROUNDING, before.origin_y_m, after.origin_y_m);
    ASSERT_NEAR(2 * ROUNDING, 15, plant.model.mass_kg);
    TEST_ASSERT_EQUAL_DOUBLE(5.0, (double)plant.vehicle.payload.mass_kg);
}

static void a_refused_change_changes_nothing(void) {
    laconic_plant plant = plant_of(three_wheels(), &laconic_rk4, 0.1), before = plant;
    laconic_vehicle v = three_wheels();
    v.wheel[v.wheel_count++] = v.wheel[0];
    ASSERT_REFUSED(LACONIC_ABOVE_LIMIT, LACONIC_FIELD_WHEEL_COUNT, 0, laconic_plant_change(&plant, &v, &why), why);
    TEST_ASSERT_TRUE(why.value == 4 && why.limit == 3);
    v = three_wheels();
    v.payload.mass_kg = REAL(-1);
    ASSERT_REFUSED(LACONIC_NEGATIVE, LACONIC_FIELD_PAYLOAD_MASS, 0, laconic_plant_change(&plant, &v, &why), why);
    v = three_wheels();
    v.motor_damping_Nms = REAL(1000);
    ASSERT_REFUSED(LACONIC_STEP_BEYOND_DAMPING_LIMIT, LACONIC_FIELD_STEP, 0, laconic_plant_change(&plant, &v, &why),
                   why);
    TEST_ASSERT_EQUAL_MEMORY(&before, &plant, sizeof plant);
}

/* On wheels of a tenth of the radius the same motion is ten times as fast in ν. */
static void a_motion_that_a_changed_vehicle_cannot_have_is_refused(void) {
    const double fastest = EITHER(1e77, 1e9);
    laconic_vehicle v = three_wheels();
    laconic_plant plant = plant_of(v, &laconic_exact_flow, 0.01);
    const laconic_start start = start_with(0.5 * fastest, 0, 0);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_restart(&plant, &start, &why));
    const laconic_plant before = plant;
    v.wheel_radius_m *= REAL(0.1);
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, laconic_plant_change(&plant, &v, &why), why);
    TEST_ASSERT_TRUE(why.value == 0);
    TEST_ASSERT_TRUE(why.limit == 0);
    TEST_ASSERT_EQUAL_MEMORY(&before.state, &plant.state, sizeof plant.state);
    v.wheel_radius_m *= 9;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &v, &why));
}

static void a_restart_begins_again_with_the_same_vehicle(void) {
    const laconic_input input = no_input();
    laconic_start start = start_with(1, 2, 3);
    for (int friction = 0; friction < 2; friction++) {
        laconic_vehicle v = three_wheels();
        if (friction) v.ground.friction_coefficient = REAL(0.5);
        laconic_plant plant = plant_of(v, &laconic_auto, 0.001), fresh = plant, before;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 5, &why));
        TEST_ASSERT_TRUE(friction || memcmp(&plant.state, &fresh.state, sizeof fresh.state) != 0);
        ASSERT_STATUS(LACONIC_OK, laconic_plant_restart(&plant, &start, &why));
        TEST_ASSERT_EQUAL_MEMORY(&fresh, &plant, sizeof plant);
        ASSERT_NEAR(ROUNDING, laconic_plant_energy_J(&fresh), laconic_plant_energy_J(&plant));
        before = plant;
        start.x_m = NOT_A_NUMBER;
        ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_START_X, 0, laconic_plant_restart(&plant, &start, &why), why);
        start.x_m = 0;
        start.heading_rad = REAL(1e30);
        ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_START_HEADING, 0, laconic_plant_restart(&plant, &start, &why),
                       why);
        start.heading_rad = 0;
        if (friction) {
            start.wheel_speed_rad_per_s[1] = NOT_A_NUMBER;
            ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_START_WHEEL_SPEED, 2,
                           laconic_plant_restart(&plant, &start, &why), why);
        }
        TEST_ASSERT_EQUAL_MEMORY(&before, &plant, sizeof plant);
        start = start_with(1, 2, 3);
    }
}

/* A vehicle with friction takes the friction step alone, which auto stands for: by its whole name. */
static void with_friction_no_method_but_auto_is_taken(void) {
    const char *const names[] = {"", "a", "aut", "buto", "aato", "auuo", "auta", "autob", "auto-8"};
    const laconic_start start = start_with(1, 2, 3);
    laconic_vehicle v = three_wheels();
    laconic_plant plant;
    memset(&plant, 0, sizeof plant);
    v.ground.friction_coefficient = REAL(0.5);
    laconic_method method = laconic_auto;
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        method.name = names[k];
        ASSERT_REFUSED(LACONIC_METHOD_WITHOUT_FRICTION, LACONIC_FIELD_METHOD, 0,
                       laconic_plant_start(&plant, &v, &method, REAL(0.001), &start, &why), why);
    }
    method.name = "auto";
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &method, REAL(0.001), &start, &why));
    TEST_ASSERT_EQUAL_STRING("friction", plant.integrator.chosen->name);
    TEST_ASSERT_EQUAL_INT32(1, plant.integrator.chosen->order);
}

/* Wheels that hold begin as they roll: as fast as on ideal ground, and without slip they have turned as far. */
static void wheels_that_roll_turn_as_on_ideal_ground(void) {
    laconic_vehicle v = three_wheels();
    laconic_plant ideal = plant_of(v, &laconic_auto, 0.001);
    v.ground.friction_coefficient = REAL(0.8);
    laconic_plant held = plant_of(v, &laconic_auto, 0.001);
    const laconic_input input = no_input();
    for (int k = 0; k < 2; k++) {
        laconic_real expected[2][3] = {{0}}, found[2][3] = {{0}};
        laconic_plant_wheel_speeds(&ideal, expected[0]);
        laconic_plant_wheel_angles(&ideal, expected[1]);
        laconic_plant_wheel_speeds(&held, found[0]);
        laconic_plant_wheel_angles(&held, found[1]);
        for (int i = 0; i < 3; i++) TEST_ASSERT_TRUE(expected[0][i] != 0 && (expected[1][i] != 0) == (k > 0));
        ASSERT_NEAR_ALL(k == 0 ? 4 * ROUNDING : 1e-3, expected[0], found[0], 3);
        ASSERT_NEAR_ALL(1e-4, expected[1], found[1], 3);
        ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&ideal, &input, 20, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&held, &input, 20, &why));
    }
}

/* ½ (M v² + I θ'² + Σ J χ'²), with the wheels as they roll or, where they slip, as they turn. */
static void energy_is_that_of_the_body_and_of_its_wheels(void) {
    const double body = MASS * RADIUS * RADIUS * (1 + 2 * 2) + 0.225 * 1, turned[4] = {3, -1, 4, 20};
    laconic_vehicle v = mecanum();
    laconic_start start = start_with(1, 2, BIG_LAMBDA);
    for (int friction = 0; friction < 2; friction++) {
        laconic_plant plant;
        laconic_real speed[4];
        double sum = body;
        memset(&plant, 0, sizeof plant);
        if (friction) v.ground.friction_coefficient = REAL(0.5);
        for (int i = 0; i < 4 && friction; i++) start.wheel_speed_rad_per_s[i] = REAL(turned[i]);
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(0.001), &start, &why));
        laconic_plant_wheel_speeds(&plant, speed);
        for (int i = 0; i < 4; i++) sum += 0.009 * (double)speed[i] * (double)speed[i];
        for (int i = 0; i < 4 && friction; i++) TEST_ASSERT_TRUE((double)speed[i] == turned[i]);
        ASSERT_NEAR(8 * ROUNDING, 0.5 * sum, laconic_plant_energy_J(&plant));
    }
}

/* Steepest ascent along +x, then along +y: the robot gains g sin α a second away from it. */
static void a_slope_accelerates_downhill(void) {
    for (int axis = 0; axis < 2; axis++) {
        laconic_vehicle v = bare_body();
        laconic_plant plant;
        const laconic_start at_rest = start_with(0, 0, 0);
        const laconic_input none_acts = no_input();
        laconic_real nu[3];
        v.ground.slope_rad = REAL(0.2);
        v.ground.slope_heading_rad = REAL(axis * PI / 2);
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(0.01), &at_rest, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &none_acts, 50, &why));
        laconic_nu(&plant.model, &plant.state, nu);
        ASSERT_NEAR(EITHER(1e-12, 1e-5), -LACONIC_GRAVITY_M_PER_S2 * sin(0.2) * 0.5 / RADIUS, nu[axis]);
        ASSERT_NEAR(EITHER(1e-12, 1e-5), 0, nu[1 - axis]);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(running_is_stepping);
    RUN_TEST(a_refused_start_changes_nothing);
    RUN_TEST(more_wheels_than_there_is_room_for_are_refused_before_any_of_them_is_read);
    RUN_TEST(a_refused_step_stops_the_run_after_what_was_taken);
    RUN_TEST(of_a_refused_sampled_step_three_samples_are_asked);
    RUN_TEST(steps_that_are_taken_refuse_nothing);
    RUN_TEST(an_input_that_is_not_finite_is_named);
    RUN_TEST(the_count_of_steps_goes_on_with_another_step_size);
    RUN_TEST(a_payload_in_motion_leaves_the_body_where_it_is);
    RUN_TEST(a_refused_change_changes_nothing);
    RUN_TEST(a_motion_that_a_changed_vehicle_cannot_have_is_refused);
    RUN_TEST(a_restart_begins_again_with_the_same_vehicle);
    RUN_TEST(with_friction_no_method_but_auto_is_taken);
    RUN_TEST(wheels_that_roll_turn_as_on_ideal_ground);
    RUN_TEST(energy_is_that_of_the_body_and_of_its_wheels);
    RUN_TEST(a_slope_accelerates_downhill);
    return UNITY_END();
}
