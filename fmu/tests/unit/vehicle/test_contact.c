/* Tests of the contacts' state in Model Exchange, whose law of friction is smooth: where a wheel slips, and lifts. */
#include "fmi2_bench.h"
#include "model_interface.h"

void setUp(void) { begin_test(fmi2ModelExchange); }
void tearDown(void) { end_test(); }

#define STATES 14
#define DRAG 0.2

/* Rollers in front, which drag, and fixed wheels behind. */
static void begin(double mass_kg) {
    with_wheel_states();
    set("mass_kg", 0, mass_kg);
    set("ground_roller_drag", 0, DRAG);
    for (uint32_t k = 3; k <= 4; k++) set_integer("wheel_kind", k, LACONIC_WHEEL_FIXED);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
}

/* How fast a contact slips, along and across, as far as its law counts it: a roller gives way across but for its
 * drag. */
static void read_slip(uint32_t wheel, double slip[2]) {
    slip[0] = fabs(get("slip_along_m_per_s", wheel));
    slip[1] = (wheel < 3 ? DRAG : 1) * fabs(get("slip_across_m_per_s", wheel));
}

/* A motion in which the wheel slips along about as much as across. */
static double slip_both_ways(double state[STATES], uint32_t wheel) {
    double slip[2] = {0};
    for (int k = 0; k < STATES; k++) state[k] = k < 3 ? 1 + 0.3 * k : 0.4;
    for (int n = -50; n < 50 && !(slip[0] > 0.5 * slip[1] && slip[1] > 0.5 * slip[0]); n++) {
        state[9 + wheel] = 0.1 * n;
        OK(fmi2SetContinuousStates(c, state, STATES));
        read_slip(wheel, slip);
    }
    TEST_ASSERT_TRUE(slip[0] > 0.5 * slip[1] && slip[1] > 0.5 * slip[0]);
    return sqrt(slip[0] * slip[0] + slip[1] * slip[1]);
}

/* Also of wheels that carry hardly anything. */
static void a_contact_slips_above_the_width_of_the_law(void) {
    double state[STATES], scaled[STATES];
    for (int light = 0; light < 2; light++) {
        begin(light ? 0.05 : 8);
        for (uint32_t wheel = 1; wheel <= 4; wheel++) {
            const double slip = slip_both_ways(state, wheel);
            for (int above = 0; above < 2; above++) {
                const double by = LACONIC_SMOOTH_SLIP_M_PER_S * (above ? 1.05 : 0.95) / slip;
                for (int k = 0; k < STATES; k++) scaled[k] = by * state[k];
                OK(fmi2SetContinuousStates(c, scaled, STATES));
                TEST_ASSERT_TRUE(get("contact_state", wheel) == above);
            }
        }
    }
}

/* A fixed wheel that turns on the spot: its slip is its speed at the rim, to the last bit. */
static void a_contact_at_the_width_of_the_law_does_not_slip(void) {
    double state[STATES] = {0};
    with_wheel_states();
    set("wheel_radius_m", 0, 1);
    for (uint32_t k = 1; k <= 4; k++) set_integer("wheel_kind", k, LACONIC_WHEEL_FIXED);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    for (int above = 0; above < 2; above++) {
        const double width = LACONIC_SMOOTH_SLIP_M_PER_S;
        state[10] = above ? nextafter(width, 1) : width;
        OK(fmi2SetContinuousStates(c, state, STATES));
        TEST_ASSERT_TRUE(fabs(get("slip_along_m_per_s", 1)) == state[10] && get("slip_across_m_per_s", 1) == 0);
        TEST_ASSERT_TRUE(get("contact_state", 1) == above);
    }
}

/* The centre of mass above the axle in front: in numbers that doubles have exactly. */
static void a_wheel_that_carries_nothing_has_not_lifted(void) {
    double state[STATES] = {0};
    with_wheel_states();
    for (uint32_t k = 1; k <= 4; k++) {
        set("wheel_x_m", k, k < 3 ? 0.5 : -0.5);
        set("wheel_y_m", k, k % 2 ? 0.5 : -0.5);
    }
    set("com_x_m", 0, 0.5);
    set("com_z_m", 0, 0);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    OK(fmi2SetContinuousStates(c, state, STATES));
    for (uint32_t k = 1; k <= 4; k++) TEST_ASSERT_TRUE(get("contact_state", k) == 0);
    TEST_ASSERT_TRUE(instance()->model.ground.normal_N[2] == 0 && instance()->model.ground.normal_N[3] == 0);
}

/* Under so high a centre of mass that the vehicle would tilt. */
static void a_contact_that_lifts_is_told_by_2(void) {
    double state[STATES] = {0};
    int lifted = 0;
    with_wheel_states();
    set("com_z_m", 0, 5);
    initialise();
    OK(fmi2EnterContinuousTimeMode(c));
    state[0] = 3;
    OK(fmi2SetContinuousStates(c, state, STATES));
    TEST_ASSERT_TRUE(get("wheel_reaction_N", 1) != 0);
    for (uint32_t k = 1; k <= 4; k++) {
        const bool lifts = instance()->model.ground.normal_N[k - 1] < 0;
        TEST_ASSERT_TRUE(get("contact_state", k) == 2 || !lifts);
        TEST_ASSERT_TRUE(get("contact_state", k) < 2 || lifts);
        lifted += lifts;
    }
    TEST_ASSERT_TRUE(lifted > 0 && lifted < 4);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_contact_slips_above_the_width_of_the_law);
    RUN_TEST(a_contact_at_the_width_of_the_law_does_not_slip);
    RUN_TEST(a_wheel_that_carries_nothing_has_not_lifted);
    RUN_TEST(a_contact_that_lifts_is_told_by_2);
    return UNITY_END();
}
