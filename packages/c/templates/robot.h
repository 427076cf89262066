/* A TurtleBot3 Burger at rest, with the voltages that drive it on a curve to the left. Static: all zero where nothing is
 * set, and not on a small stack. */
static laconic_single_vehicle robot;
static laconic_single_input input;
static laconic_single_plant plant;

static laconic_single_status start_robot(void) {
    static laconic_single_start rest;
    robot.mass_kg = 0.883F;
    robot.yaw_inertia_kgm2 = 2.39e-3F;
    robot.wheel_radius_m = 0.033F;
    robot.wheel_inertia_kgm2 = 2.07e-5F;
    robot.motor_gain_Nm_per_V = 0.125F;
    robot.motor_damping_Nms = 0.235F;
    robot.wheel_count = 2;
    for (int i = 0; i < 2; i++) {
        robot.wheel[i].kind = LACONIC_SINGLE_WHEEL_FIXED;
        robot.wheel[i].y_m = i == 0 ? 0.08F : -0.08F;
        robot.wheel[i].axle_rad = -1.57079633F; /* rolls along +x */
    }
    input.voltage_V[0] = 5.5F;
    input.voltage_V[1] = 10.0F;
    return laconic_single_plant_start(&plant, &robot, &laconic_single_auto, 0.01F, &rest, NULL);
}

static laconic_single_pose pose_after(int steps, laconic_single_status *status) {
    laconic_single_pose pose;
    *status = laconic_single_plant_run(&plant, &input, (unsigned)steps, NULL);
    laconic_single_pose_of(&pose, &plant.model, &plant.state);
    return pose;
}
