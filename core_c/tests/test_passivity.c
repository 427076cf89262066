#include "passivity.h"

#include "vehicles.h"

/* ζ goes from 1 to 1.2 along the first axis in 0.1 s: |ζ|² grows by 0.44, which takes a mean drive of 2. */
static bool growth_is_driven_by(real start, real middle, real end, real grown) {
    const laconic_model m = model_of(bare_body());
    const increment by = {{grown, 0, 0}, {REAL(1) + grown / 2, 0, 0}, {grown, 0, 0}};
    laconic_load load[3];
    const laconic_loads loads = {&load[0], &load[1], &load[2], false};
    laconic_state state;
    memset(load, 0, sizeof load);
    memset(&state, 0, sizeof state);
    state.zeta[0].value = REAL(1);
    load[0].constant[0] = start;
    load[1].constant[0] = middle;
    load[2].constant[0] = end;
    return passive(&m, &state, REAL(0.1), &loads, (vector){REAL(1), 0, 0}, by);
}

static void growth_that_the_drive_pays_for_is_allowed(void) {
    TEST_ASSERT_TRUE(growth_is_driven_by(REAL(2), REAL(2), REAL(2), REAL(0.2)));
    TEST_ASSERT_TRUE(growth_is_driven_by(REAL(0), REAL(2), REAL(4), REAL(0.2)));
    TEST_ASSERT_TRUE(growth_is_driven_by(REAL(5), REAL(5), REAL(5), REAL(0.2)));
}

static void growth_out_of_nothing_is_not(void) {
    TEST_ASSERT_FALSE(growth_is_driven_by(REAL(0), REAL(0), REAL(0), REAL(0.2)));
    TEST_ASSERT_FALSE(growth_is_driven_by(REAL(-2), REAL(-2), REAL(-2), REAL(0.2)));
    TEST_ASSERT_FALSE(growth_is_driven_by(REAL(1), REAL(1), REAL(1), REAL(0.2)));
}

static void a_loss_is_always_allowed(void) {
    TEST_ASSERT_TRUE(growth_is_driven_by(REAL(0), REAL(0), REAL(0), REAL(-0.2)));
}

static void nan_is_not_passive(void) {
    TEST_ASSERT_FALSE(growth_is_driven_by(REAL(2), REAL(2), REAL(2), NOT_A_NUMBER));
    TEST_ASSERT_FALSE(growth_is_driven_by(NOT_A_NUMBER, REAL(2), REAL(2), REAL(0.2)));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(growth_that_the_drive_pays_for_is_allowed);
    RUN_TEST(growth_out_of_nothing_is_not);
    RUN_TEST(a_loss_is_always_allowed);
    RUN_TEST(nan_is_not_passive);
    return UNITY_END();
}
