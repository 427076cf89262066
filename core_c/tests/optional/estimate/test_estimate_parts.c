/* Tests of the half steps of an estimate, where a half step yaws farther than the eighth order takes it. */
#include "estimate_parts.h"

#include "estimates.h"
#include "laconic/estimate.h"
#include "methods.h"

static laconic_refusal why;

/* Damping is fast: half steps of a splitting err nearly as much as the step. */
static laconic_vehicle stiff_wheels(void) {
    laconic_vehicle v = with_motors(three_wheels());
    v.motor_damping_Nms = REAL(100 * DAMPING);
    return v;
}

static laconic_estimate estimate_started(laconic_plant *plant, laconic_start start, double step_s) {
    const laconic_vehicle v = stiff_wheels();
    laconic_estimate estimate;
    memset(plant, 0, sizeof *plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(plant, &v, &laconic_exact_flow, REAL(step_s), &start, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&estimate, plant, 1, laconic_finer_method(plant), &why));
    TEST_ASSERT_EQUAL_PTR(&laconic_exponential_gauss_8, estimate.finer.method);
    return estimate;
}

/* The finer method takes no half of this step. */
static void assert_half_is_refused(const laconic_estimate *estimate, const laconic_plant *plant) {
    const laconic_input held = no_input();
    laconic_state state = plant->state;
    laconic_status status = LACONIC_OK;
    laconic_run(&plant->model, &estimate->finer, &state, &held, 2, &status);
    TEST_ASSERT_EQUAL_INT(LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, status);
}

static laconic_real difference(laconic_sum a, laconic_sum b) { return (a.value - b.value) + (a.rest - b.rest); }

/* How far the estimate's twin is from the motion by as many steps of eighth order, beside the plant's distance. */
static void assert_twin_is_close(const laconic_estimate *estimate, const laconic_plant *plant, laconic_start start,
                                 const laconic_input inputs[3]) {
    const laconic_vehicle v = stiff_wheels();
    laconic_plant fine;
    const int steps = 512;
    memset(&fine, 0, sizeof fine);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&fine, &v, &laconic_exponential_gauss_8,
                                                  plant->integrator.step_s / (laconic_real)steps, &start, &why));
    for (int k = 0; k < steps; k++) {
        laconic_input held = inputs[0];
        const laconic_real at = ((laconic_real)k + REAL(0.5)) / (laconic_real)steps;
        held.body_moment_Nm += at * (inputs[2].body_moment_Nm - inputs[0].body_moment_Nm);
        ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&fine, &held, 1, &why));
    }
    const double off = hypot((double)difference(plant->state.x_m, fine.state.x_m),
                             (double)difference(plant->state.y_m, fine.state.y_m));
    const double left = hypot((double)difference(estimate->twin.x_m, fine.state.x_m),
                              (double)difference(estimate->twin.y_m, fine.state.y_m));
    TEST_ASSERT_TRUE(off > 1e-6);
    TEST_ASSERT_TRUE(left < 0.05 * off);
}

static void a_held_step_that_yaws_too_far_is_compared_with_shorter_ones(void) {
    const laconic_start start = start_with(30, 10, 150);
    const laconic_input held[3] = {no_input(), no_input(), no_input()};
    laconic_plant plant;
    laconic_estimate estimate = estimate_started(&plant, start, 0.2);
    assert_half_is_refused(&estimate, &plant);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, held, 1, &why));
    assert_twin_is_close(&estimate, &plant, start, held);
    TEST_ASSERT_EQUAL_UINT64(0, estimate.unknown);
}

static void a_sampled_step_that_yaws_too_far_is_compared_with_shorter_ones(void) {
    const laconic_start start = start_with(30, 10, 150);
    laconic_input samples[3] = {no_input(), no_input(), no_input()};
    laconic_plant plant;
    laconic_estimate estimate = estimate_started(&plant, start, 0.2);
    assert_half_is_refused(&estimate, &plant);
    samples[1].body_moment_Nm = REAL(1);
    samples[2].body_moment_Nm = REAL(2);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run_sampled(&estimate, &plant, samples, &why));
    assert_twin_is_close(&estimate, &plant, start, samples);
}

/* Hundreds of radians: then its own half steps, and the estimate is still one. */
static void a_step_that_yaws_too_far_in_all_parts_has_half_steps_of_its_own(void) {
    const laconic_start start = start_with(0, 0, 4000);
    const laconic_input held = no_input();
    laconic_plant plant;
    laconic_errors found;
    laconic_estimate estimate = estimate_started(&plant, start, 5);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &held, 1, &why));
    laconic_estimate_read(&found, &estimate, &plant);
    TEST_ASSERT_EQUAL_UINT64(0, found.unknown);
    TEST_ASSERT_TRUE(found.now.nu_rad_per_s >= 0 && found.now.nu_rad_per_s < 4000);
}

/* A part so short that nothing can be prepared for it. */
static void parts_that_cannot_be_prepared_are_not_taken(void) {
    const laconic_input held = no_input();
    laconic_plant plant;
    laconic_estimate estimate = estimate_started(&plant, start_with(3, 1, 6), 0.2);
    laconic_state expected = plant.state;
    laconic_status status = LACONIC_OK;
    estimate.finer.gyro_limit = 0;
    laconic_run(&plant.model, &estimate.halves, &expected, &held, 2, &status);
    ASSERT_STATUS(LACONIC_OK, status);
    plant.integrator.step_s = REAL(20) * LACONIC_REAL_MIN; /* of which a quarter is too short */
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &held, 1, &why));
    TEST_ASSERT_EQUAL_UINT64(0, estimate.unknown);
    TEST_ASSERT_EQUAL_MEMORY(&expected, &estimate.twin, sizeof expected);
}

static void the_finer_method_is_the_plants_own_unless_damping_is_fast(void) {
    const laconic_vehicle v = three_wheels(), stiff = stiff_wheels();
    const laconic_start start = start_with(0, 0, 0);
    laconic_plant plant;
    memset(&plant, 0, sizeof plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_exact_flow, REAL(0.02), &start, &why));
    TEST_ASSERT_EQUAL_PTR(&laconic_exact_flow, laconic_finer_method(&plant));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &stiff, &laconic_exact_flow, REAL(0.02), &start, &why));
    TEST_ASSERT_EQUAL_PTR(&laconic_exponential_gauss_8, laconic_finer_method(&plant));
}

/* ------------------------------------------------------------------------------- how many parts -- */

/* The end of a step whose input is held, in so many equal parts. */
static laconic_state in_parts(const laconic_plant *plant, const laconic_method *method, int parts,
                              const laconic_input *held) {
    laconic_integrator part;
    laconic_state state = plant->state;
    laconic_status status = LACONIC_OK;
    const laconic_real part_s = plant->integrator.step_s / (laconic_real)parts;
    ASSERT_STATUS(LACONIC_OK, laconic_integrator_prepare(&part, method, &plant->model, part_s, &why));
    laconic_run(&plant->model, &part, &state, held, (uint64_t)parts, &status);
    ASSERT_STATUS(LACONIC_OK, status);
    return state;
}

/* A vehicle without damping that yaws at 0.75 of what a method takes in so many parts of a step: in half as many it
 * refuses them. */
static laconic_plant yawing_for(const laconic_method *own, const laconic_method *finer, int parts) {
    const laconic_vehicle v = three_wheels();
    const laconic_model m = model_of(v);
    const laconic_integrator part = integrator_of(finer, &m, 0.02 / parts);
    const laconic_start start = start_with(0, 0, 0.75 * (double)part.gyro_limit);
    laconic_plant plant;
    memset(&plant, 0, sizeof plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, own, REAL(0.02), &start, &why));
    return plant;
}

static void assert_parts(const laconic_method *own, const laconic_method *finer, int parts,
                         const laconic_method *expected_method, int expected_parts) {
    const laconic_plant plant = yawing_for(own, finer, parts);
    laconic_input inputs[3] = {no_input(), no_input(), no_input()};
    laconic_estimate estimate;
    inputs[0].body_force_N[0] = REAL(0.1);
    inputs[1].body_moment_Nm = inputs[2].body_moment_Nm = NOT_A_NUMBER; /* held: nobody reads them */
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&estimate, &plant, 1, finer, &why));
    TEST_ASSERT_EQUAL_UINT64(1, laconic_estimate_before(&estimate, &plant, inputs, 1, 1));
    const laconic_state expected = in_parts(&plant, expected_method, expected_parts, inputs);
    TEST_ASSERT_EQUAL_MEMORY(&expected, &estimate.twin, sizeof expected);
    TEST_ASSERT_EQUAL_UINT64(0, estimate.unknown);
}

static void a_step_is_taken_in_the_fewest_parts_up_to_64(void) {
    for (int parts = 2; parts <= 64; parts *= 2)
        assert_parts(&laconic_exact_flow, &laconic_exponential_gauss_8, parts, &laconic_exponential_gauss_8, parts);
    assert_parts(&laconic_exact_flow, &laconic_exponential_gauss_8, 128, &laconic_exact_flow, 2);
}

/* Whichever the two methods are. */
static void any_other_method_than_the_plants_has_shorter_parts(void) {
    assert_parts(&laconic_rk4, &laconic_exponential_gauss_8, 4, &laconic_exponential_gauss_8, 4);
    assert_parts(&laconic_exponential_gauss_8, &laconic_rk4, 4, &laconic_rk4, 4);
}

/* A moment that grows along a straight line, in four parts: each has the line's values at its start, middle and end. */
static void shorter_parts_of_a_sampled_step_have_the_inputs_of_their_moments(void) {
    const laconic_plant plant = yawing_for(&laconic_exact_flow, &laconic_exponential_gauss_8, 4);
    laconic_input samples[3] = {no_input(), no_input(), no_input()}, at[3] = {no_input(), no_input(), no_input()};
    const laconic_integrator part = integrator_of(&laconic_exponential_gauss_8, &plant.model, 0.005);
    laconic_state expected = plant.state;
    laconic_estimate estimate;
    for (int k = 0; k < 3; k++) samples[k].body_force_N[1] = REAL(100 * k);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&estimate, &plant, 1, &laconic_exponential_gauss_8, &why));
    (void)laconic_estimate_before(&estimate, &plant, samples, 3, 1);
    for (int j = 0; j < 4; j++) {
        for (int k = 0; k < 3; k++) at[k].body_force_N[1] = REAL(25 * (2 * j + k));
        ASSERT_STATUS(LACONIC_OK, laconic_step_sampled(&plant.model, &part, &expected, &at[0], &at[1], &at[2]));
    }
    ASSERT_NEAR(100 * ROUNDING, expected.x_m.value, estimate.twin.x_m.value);
    ASSERT_NEAR(100 * ROUNDING, expected.y_m.value, estimate.twin.y_m.value);
    TEST_ASSERT_TRUE(hypot((double)expected.x_m.value, (double)expected.y_m.value) > 1e-4);
}

/* ------------------------------------------------------------------------------ what is refused -- */

/* The second half step is refused, yet the shorter parts start where the step does. */
static void shorter_parts_start_where_the_step_does(void) {
    const laconic_vehicle v = three_wheels();
    const laconic_start start = start_with(0, 0, 0);
    const laconic_model m = model_of(v);
    const double limit = (double)integrator_of(&laconic_exponential_gauss_8, &m, 0.01).gyro_limit;
    laconic_plant plant;
    laconic_estimate estimate;
    laconic_input held = no_input();
    memset(&plant, 0, sizeof plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_exact_flow, REAL(0.02), &start, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&estimate, &plant, 1, &laconic_exponential_gauss_8, &why));
    held.body_moment_Nm = REAL(1);
    const laconic_state slowly = in_parts(&plant, &laconic_exact_flow, 1, &held);
    laconic_real nu[3];
    laconic_nu(&plant.model, &slowly, nu);
    held.body_moment_Nm = REAL(2.4 * limit / (double)nu[2]); /* 1.2 of the limit after the first half */
    (void)laconic_estimate_before(&estimate, &plant, &held, 1, 1);
    const laconic_state expected = in_parts(&plant, &laconic_exponential_gauss_8, 4, &held);
    TEST_ASSERT_EQUAL_MEMORY(&expected, &estimate.twin, sizeof expected);
}

/* In the first half a force drives the vehicle beyond all places, in the second none that is as large acts. */
static void a_first_half_that_is_refused_counts_though_the_second_is_taken(void) {
    const laconic_start start = start_with(0, 0, 0);
    const laconic_vehicle v = caster();
    laconic_plant plant;
    laconic_estimate estimate;
    laconic_input samples[3] = {no_input(), no_input(), no_input()};
    memset(&plant, 0, sizeof plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_rk4, REAL(1), &start, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&estimate, &plant, 1, NULL, &why));
    samples[0].body_force_N[0] = REAL(EITHER(5e21, 7e9));
    laconic_state state = plant.state;
    laconic_input at[5];
    for (int k = 0; k < 5; k++) {
        at[k] = no_input(); /* the parabola at quarters of the step */
        at[k].body_force_N[0] = REAL(0.125 * (4 - k) * (2 - k)) * samples[0].body_force_N[0];
    }
    ASSERT_STATUS(LACONIC_OVERFLOW,
                  laconic_step_sampled(&plant.model, &estimate.halves, &state, &at[0], &at[1], &at[2]));
    ASSERT_STATUS(LACONIC_OK, laconic_step_sampled(&plant.model, &estimate.halves, &state, &at[2], &at[3], &at[4]));
    (void)laconic_estimate_before(&estimate, &plant, samples, 3, 1);
    TEST_ASSERT_EQUAL_UINT64(1, estimate.unknown);
    TEST_ASSERT_EQUAL_MEMORY(&plant.state, &estimate.twin, sizeof state);
}

/* Where the finer one refuses, the half steps of the plant's own method have panels half as long, too. */
static void own_half_steps_have_shorter_panels(void) {
    const laconic_vehicle v = stiff_wheels();
    const laconic_start start = start_with(3, 1, 6);
    const laconic_input held = every_input();
    laconic_plant plant;
    laconic_estimate estimate;
    memset(&plant, 0, sizeof plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_exponential_gauss_8, REAL(0.02), &start, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_start(&estimate, &plant, 1, NULL, &why));
    laconic_estimate own = estimate;
    own.finer.gyro_limit = 0;
    (void)laconic_estimate_before(&estimate, &plant, &held, 1, 1);
    (void)laconic_estimate_before(&own, &plant, &held, 1, 1);
    TEST_ASSERT_EQUAL_MEMORY(&estimate.twin, &own.twin, sizeof own.twin);
    const laconic_state usual = in_parts(&plant, &laconic_exponential_gauss_8, 2, &held);
    TEST_ASSERT_TRUE(memcmp(&usual, &own.twin, sizeof usual) != 0);
    TEST_ASSERT_EQUAL_UINT64(0, own.unknown);
}

/* Tests of carried.c: an error that was, in the coordinates of another model. */

/* Velocity of the body's origin, or with an error of travel its way, and the yaw. */
static void of_origin(double motion[3], const laconic_model *m, const laconic_real zeta[3]) {
    const double ahead = (double)dot(vec(m->velocity_of_zeta[0]), vec(zeta));
    const double aside = (double)dot(vec(m->velocity_of_zeta[1]), vec(zeta));
    const double yaw = (double)dot(vec(m->yaw_rate_of_zeta), vec(zeta));
    motion[0] = ahead + yaw * (double)m->com_y_m;
    motion[1] = aside - yaw * (double)m->com_x_m;
    motion[2] = yaw;
}

/* Another mass in another place. */
static laconic_vehicle changed(laconic_vehicle v) {
    v.payload.mass_kg = REAL(8);
    v.payload.x_m = REAL(0.15);
    v.payload.y_m = REAL(-0.2);
    v.payload.yaw_inertia_kgm2 = REAL(0.4);
    return v;
}

/* ν, and so an error of it, is of the same motion of the body's origin in either model; the place is that of S, and an
 * error of the heading turns what lies between the one and the other. */
static void an_error_is_of_the_same_motion_in_another_model(void) {
    const laconic_vehicle v = with_motors(three_wheels()), other = changed(v);
    laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(2, 1, 4), 0.01);
    laconic_estimate estimate = estimate_of(&plant, 16);
    double velocity[2][3], way[2][3];
    for (int k = 0; k < 3; k++) {
        estimate.zeta[k] = REAL(0.3 - 0.2 * k);
        estimate.travel[k] = REAL(0.1 * k - 0.25);
    }
    estimate.place_m[0] = REAL(0.5);
    estimate.place_m[1] = REAL(-0.7);
    plant.state.heading.fraction = laconic_binary_angle_of(REAL(0.6));
    const laconic_plant before = plant;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &other, &why));
    laconic_estimate carried = estimate;
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&carried, &before, &plant, NULL, &why));
    of_origin(velocity[0], &before.model, estimate.zeta);
    of_origin(velocity[1], &plant.model, carried.zeta);
    of_origin(way[0], &before.model, estimate.travel);
    of_origin(way[1], &plant.model, carried.travel);
    for (int k = 0; k < 3; k++) {
        ASSERT_NEAR(10 * ROUNDING, velocity[0][k], velocity[1][k]);
        ASSERT_NEAR(10 * ROUNDING, way[0][k], way[1][k]);
    }
    const double x = (double)(plant.model.com_x_m - before.model.com_x_m), c = cos(0.6), s = sin(0.6);
    const double y = (double)(plant.model.com_y_m - before.model.com_y_m);
    ASSERT_NEAR(10 * ROUNDING, 0.5 - way[0][2] * (s * x + c * y), carried.place_m[0]);
    ASSERT_NEAR(10 * ROUNDING, -0.7 + way[0][2] * (c * x - s * y), carried.place_m[1]);
}

static laconic_estimate carried_with(const laconic_plant *before, const laconic_plant *plant,
                                     laconic_estimate estimate) {
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&estimate, before, plant, NULL, &why));
    return estimate;
}

/* Of sizes each component counts with the magnitude of what an error along it becomes. */
static void doubts_and_floors_are_carried_as_sizes(void) {
    bool turned = false;
    for (int n = 0; n < 24; n++) {
        laconic_vehicle v = with_motors(n % 2 == 0 ? three_wheels() : mecanum()), other;
        if (n % 3 == 0) v = with_own_wheels(v);
        v.payload.mass_kg = REAL(25 - n);
        v.payload.x_m = REAL(0.3 - 0.2 * (n % 4));
        v.payload.y_m = REAL(0.1 * (n % 3) - 0.2);
        other = v;
        other.payload.mass_kg = REAL(1 + n);
        other.payload.x_m = REAL(0.1 * (n % 5) - 0.2);
        other.payload.y_m = REAL(0.3 - 0.1 * (n % 7));
        other.payload.yaw_inertia_kgm2 = REAL(0.02 * n * n);
        laconic_plant plant = plant_by(&laconic_rk4, &v, start_with(0, 0, 0), 0.01);
        const laconic_plant before = plant;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &other, &why));
        laconic_estimate estimate = estimate_of(&before, 16);
        double expected[3] = {0, 0, 0}, every = 0;
        for (int k = 0; k < 3; k++) {
            laconic_estimate along = estimate_of(&before, 16);
            along.zeta[k] = 1;
            along = carried_with(&before, &plant, along);
            for (int i = 0; i < 3; i++) expected[i] += fabs((double)along.zeta[i]) * (0.1 + 0.2 * k);
            for (int i = 0; i < 3; i++) every += fabs((double)along.zeta[i]) / sqrt(3);
            turned |= along.zeta[k] < 0;
            estimate.doubt_zeta[k] = estimate.doubt_travel[k] = REAL(0.1 + 0.2 * k);
        }
        estimate.floor_zeta = REAL(0.5);
        estimate.floor_travel = REAL(0.25);
        estimate = carried_with(&before, &plant, estimate);
        ASSERT_NEAR_ALL(10 * ROUNDING, expected, estimate.doubt_zeta, 3);
        ASSERT_NEAR_ALL(10 * ROUNDING, expected, estimate.doubt_travel, 3);
        ASSERT_NEAR(10 * ROUNDING, 0.5 * every, estimate.floor_zeta);
        ASSERT_NEAR(10 * ROUNDING, 0.25 * every, estimate.floor_travel);
    }
    TEST_ASSERT_TRUE(turned); /* an axis of one model is against that of the other */
}

/* A refusal is told where there is one: with friction, too, a change that is made leaves it as it was. */
static void a_change_that_is_made_tells_no_refusal(void) {
    laconic_vehicle v = with_motors(mecanum());
    v.ground.friction_coefficient = REAL(0.5);
    laconic_vehicle loaded = v;
    loaded.payload.mass_kg = REAL(2);
    laconic_plant plant = plant_by(&laconic_auto, &v, start_with(0, 0, 0), 0.01);
    const laconic_plant before = plant;
    laconic_estimate estimate = estimate_of(&plant, 16);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &loaded, &why));
    memset(&why, 0, sizeof why);
    why.status = LACONIC_NOT_FINITE;
    why.item = 7;
    const laconic_refusal as_it_was = why;
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_carry(&estimate, &before, &plant, NULL, &why));
    TEST_ASSERT_EQUAL_MEMORY(&as_it_was, &why, sizeof why);
}

/* The change takes S outwards, where a place is known to fewer digits, and the body drives back: no window ends out
 * there, and none does where its first step is refused. */
static void a_step_that_is_refused_after_a_change_leaves_nothing_in_the_estimate(void) {
    const laconic_vehicle v = with_motors(three_wheels());
    laconic_vehicle loaded = v;
    loaded.payload.mass_kg = 30;
    loaded.payload.x_m = REAL(-1);
    laconic_plant plant = plant_by(&laconic_auto, &v, start_with(0, 0, 0), 0.01);
    const laconic_plant before = plant;
    laconic_estimate estimate = estimate_of(&plant, 16);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &loaded, &why));
    estimate = carried_with(&before, &plant, estimate);
    laconic_plant other = plant;
    laconic_estimate without = estimate;
    laconic_input input = no_input();
    input.voltage_V[0] = NOT_A_NUMBER;
    ASSERT_STATUS(LACONIC_NOT_FINITE, laconic_estimate_run(&estimate, &plant, &input, 1, &why));
    input = no_input();
    input.body_force_N[0] = 50;
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &input, 50, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&without, &other, &input, 50, &why));
    const laconic_errors found = errors_now(&estimate, &plant), expected = errors_now(&without, &other);
    TEST_ASSERT_EQUAL_MEMORY(&expected.now, &found.now, sizeof found.now);
    TEST_ASSERT_EQUAL_MEMORY(&expected.largest, &found.largest, sizeof found.largest);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_held_step_that_yaws_too_far_is_compared_with_shorter_ones);
    RUN_TEST(a_sampled_step_that_yaws_too_far_is_compared_with_shorter_ones);
    RUN_TEST(a_step_that_yaws_too_far_in_all_parts_has_half_steps_of_its_own);
    RUN_TEST(parts_that_cannot_be_prepared_are_not_taken);
    RUN_TEST(the_finer_method_is_the_plants_own_unless_damping_is_fast);
    RUN_TEST(a_step_is_taken_in_the_fewest_parts_up_to_64);
    RUN_TEST(any_other_method_than_the_plants_has_shorter_parts);
    RUN_TEST(shorter_parts_of_a_sampled_step_have_the_inputs_of_their_moments);
    RUN_TEST(shorter_parts_start_where_the_step_does);
    RUN_TEST(a_first_half_that_is_refused_counts_though_the_second_is_taken);
    RUN_TEST(own_half_steps_have_shorter_panels);
    RUN_TEST(an_error_is_of_the_same_motion_in_another_model);
    RUN_TEST(doubts_and_floors_are_carried_as_sizes);
    RUN_TEST(a_change_that_is_made_tells_no_refusal);
    RUN_TEST(a_step_that_is_refused_after_a_change_leaves_nothing_in_the_estimate);
    return UNITY_END();
}
