#include "vehicles.h"

static void it_is_the_pose_to_the_last_bit(void) {
    laconic_vehicle v = three_wheels();
    laconic_start start = start_with(1, 2, 3);
    laconic_model m = model_of(v);
    laconic_state state;
    laconic_pose pose;
    laconic_real x, y, heading;
    double angle;
    for (angle = -40; angle < 40; angle += 1.7) {
        start.x_m = REAL(angle / 3);
        start.y_m = REAL(-angle);
        start.heading_rad = REAL(angle);
        state = state_of(&m, start);
        laconic_pose_of(&pose, &m, &state);
        laconic_position(&state, &x, &y, &heading);
        TEST_ASSERT_TRUE(x == pose.x_m && y == pose.y_m && heading == pose.heading_rad);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(it_is_the_pose_to_the_last_bit);
    return UNITY_END();
}
