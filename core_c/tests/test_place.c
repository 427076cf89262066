#include "vehicles.h"

static laconic_refusal why;

static void what_the_constraints_forbid_is_projected_away_and_the_rest_stays(void) {
    const laconic_model m = model_of(caster());
    laconic_start motion = start_with(0.5, 1e-3, 2);
    laconic_state state;
    laconic_pose pose;
    laconic_real nu[3];
    motion.x_m = REAL(4);
    motion.heading_rad = REAL(1);
    ASSERT_STATUS(LACONIC_OK, laconic_state_place(&state, &m, &motion, &why));
    laconic_nu(&m, &state, nu);
    laconic_pose_of(&pose, &m, &state);
    ASSERT_NEAR(ROUNDING, 0.5, nu[0]);
    ASSERT_NEAR(ROUNDING, 0, nu[1]);
    ASSERT_NEAR(2 * ROUNDING, 2, nu[2]);
    TEST_ASSERT_EQUAL_DOUBLE(4.0, (double)pose.x_m);
    ASSERT_NEAR(ROUNDING, 1, pose.heading_rad);
}

static void allowed_motions_are_set_as_they_are(void) {
    const laconic_model m = model_of(mecanum());
    const laconic_start motion = start_with(0.5, -1, 2);
    laconic_state placed;
    const laconic_state set = state_of(&m, motion);
    memset(&placed, 0, sizeof placed);
    ASSERT_STATUS(LACONIC_OK, laconic_state_place(&placed, &m, &motion, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&set.zeta, &placed.zeta, sizeof set.zeta);
}

static void refuses(laconic_start motion, laconic_status status, laconic_field field, int item) {
    const laconic_model m = model_of(caster());
    laconic_state state, before;
    memset(&state, 3, sizeof state);
    before = state;
    ASSERT_REFUSED(status, field, item, laconic_state_place(&state, &m, &motion, &why), why);
    TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
}

static void numbers_that_are_none_are_refused(void) {
    laconic_start motion = start_with(0, 0, 0);
    refuses(start_with(0, (double)NAN, 0), LACONIC_NOT_FINITE, LACONIC_FIELD_START_NU, 2);
    refuses(start_with((double)LACONIC_REAL_MAX, 0, (double)LACONIC_REAL_MAX), LACONIC_OVERFLOW, LACONIC_FIELD_START_NU,
            0);
    motion.y_m = INFINITE;
    refuses(motion, LACONIC_NOT_FINITE, LACONIC_FIELD_START_Y, 0);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(what_the_constraints_forbid_is_projected_away_and_the_rest_stays);
    RUN_TEST(allowed_motions_are_set_as_they_are);
    RUN_TEST(numbers_that_are_none_are_refused);
    return UNITY_END();
}
