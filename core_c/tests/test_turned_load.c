#include "load.h"
#include "vehicles.h"

/* b = constant + cos θ · cosine + sin θ · sine, at the heading of a state and an angle further on. */
static void a_force_fixed_in_the_world_turns_against_the_body(void) {
    const laconic_model m = model_of(three_wheels());
    const laconic_input input = every_input();
    const double headings[] = {-2.5, -0.3, 0.0, 0.9, 3.0}, offsets[] = {-0.7, 0.0, 1.3};
    laconic_load load;
    size_t i, j;
    laconic_load_of(&load, &m, &input);
    for (i = 0; i < 5; i++)
        for (j = 0; j < 3; j++) {
            laconic_start start = start_with(0, 0, 0);
            const double angle = headings[i] + offsets[j];
            laconic_state state;
            vector b;
            start.heading_rad = REAL(headings[i]);
            state = state_of(&m, start);
            b = laconic_turned_load(&load, &state.heading, REAL(offsets[j]));
            ASSERT_NEAR(EITHER(1e-13, 5e-5),
                        (double)load.constant[0] + cos(angle) * (double)load.cosine[0] +
                            sin(angle) * (double)load.sine[0],
                        b.x);
            ASSERT_NEAR(EITHER(1e-13, 5e-5),
                        (double)load.constant[2] + cos(angle) * (double)load.cosine[2] +
                            sin(angle) * (double)load.sine[2],
                        b.z);
        }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_force_fixed_in_the_world_turns_against_the_body);
    return UNITY_END();
}
