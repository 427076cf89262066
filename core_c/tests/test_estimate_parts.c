/* Tests of the half steps of an estimate, where a half step yaws farther than the eighth order takes it. */
#include "laconic/estimate.h"
#include "methods.h"

static laconic_refusal why;

/* Damping is fast: half steps of exact-flow err nearly as much as the step. */
static laconic_vehicle stiff_wheels(void) {
    laconic_vehicle v = with_motors(three_wheels());
    v.motor_damping_Nms = REAL(100 * DAMPING);
    return v;
}

static laconic_estimate estimate_of(laconic_plant *plant, laconic_start start, double step_s) {
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
    laconic_estimate estimate = estimate_of(&plant, start, 0.2);
    assert_half_is_refused(&estimate, &plant);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, held, 1, &why));
    assert_twin_is_close(&estimate, &plant, start, held);
    TEST_ASSERT_EQUAL_UINT64(0, estimate.unknown);
}

static void a_sampled_step_that_yaws_too_far_is_compared_with_shorter_ones(void) {
    const laconic_start start = start_with(30, 10, 150);
    laconic_input samples[3] = {no_input(), no_input(), no_input()};
    laconic_plant plant;
    laconic_estimate estimate = estimate_of(&plant, start, 0.2);
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
    laconic_estimate estimate = estimate_of(&plant, start, 5);
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &held, 1, &why));
    laconic_estimate_read(&found, &estimate, &plant);
    TEST_ASSERT_EQUAL_UINT64(0, found.unknown);
    TEST_ASSERT_TRUE(found.now.nu_rad_per_s >= 0 && found.now.nu_rad_per_s < 4000);
}

/* A part so short that nothing can be prepared for it. */
static void parts_that_cannot_be_prepared_are_not_taken(void) {
    const laconic_input held = no_input();
    laconic_plant plant;
    laconic_estimate estimate = estimate_of(&plant, start_with(3, 1, 6), 0.2);
    estimate.finer.gyro_limit = 0;
    plant.integrator.step_s = REAL(20) * LACONIC_REAL_MIN; /* of which a quarter is too short */
    ASSERT_STATUS(LACONIC_OK, laconic_estimate_run(&estimate, &plant, &held, 1, &why));
    TEST_ASSERT_EQUAL_UINT64(0, estimate.unknown);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_held_step_that_yaws_too_far_is_compared_with_shorter_ones);
    RUN_TEST(a_sampled_step_that_yaws_too_far_is_compared_with_shorter_ones);
    RUN_TEST(a_step_that_yaws_too_far_in_all_parts_has_half_steps_of_its_own);
    RUN_TEST(parts_that_cannot_be_prepared_are_not_taken);
    return UNITY_END();
}
