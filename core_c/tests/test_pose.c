#include "vehicles.h"

static void the_origin_lies_where_the_heading_puts_it(void) {
    laconic_vehicle v = three_wheels();
    laconic_start start = start_with(0, 0, 0);
    laconic_model m;
    laconic_state state;
    laconic_pose pose;
    double heading;
    v.com_x_m = REAL(0.13);
    v.com_y_m = REAL(-0.07);
    m = model_of(v);
    start.x_m = REAL(2);
    start.y_m = REAL(-1);
    for (heading = -9; heading < 9; heading += 0.77) {
        start.heading_rad = REAL(heading);
        state = state_of(&m, start);
        laconic_pose_of(&pose, &m, &state);
        ASSERT_NEAR(2 * ROUNDING, 2 - (0.13 * cos(heading) + 0.07 * sin(heading)), pose.origin_x_m);
        ASSERT_NEAR(2 * ROUNDING, -1 - (0.13 * sin(heading) - 0.07 * cos(heading)), pose.origin_y_m);
        ASSERT_NEAR(EITHER(1e-14, 4e-6), heading, pose.heading_rad);
        ASSERT_NEAR(EITHER(1e-14, 4e-6), atan2(sin(heading), cos(heading)), pose.heading_wrapped_rad);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_origin_lies_where_the_heading_puts_it);
    return UNITY_END();
}
