/* Runs an articulated vehicle on ground with friction from plain numbers on standard input, for host_tests.
 *
 *   vehicle  mass inertia com_x com_y com_z  friction drag axle_friction slope slope_heading
 *            supply supply_resistance current_limit winding_resistance viscous
 *            H {parent kind hinge_x hinge_y mass com_x com_y inertia damping stiffness rest gain com_z hitch dry
 *            stop_low stop_high servo_gain servo_damping servo_limit viscous resistance current_limit loop_V loop_Vs
 *            period}  N {body kind x y axle roller radius inertia gain damping locked friction drag axle_friction
 *            circuit load scrub_radius scrub_fade creep}  S {x y}
 *   start    vx vy yaw_rate x y heading  H angles  H rates  N wheel speeds
 *   input    N voltages, N torques, 3 body wrench, 2 world force, 2 point, H voltages, H torques, H rates, H angles
 *   run      step steps            as often as said
 *   trace    step steps            the same, and prints the state after each step as `state` does
 *   passes   prints how many steps took 0, 1 … 50 passes, then after how many steps but the first energy had grown
 *   state    prints pose, angles, z, wheel speeds, velocities of the bodies, grips, scrub, dry, stops, drives, loads
 *   books    prints energy, spring, supply, outer, servo, slip, scrub, axle, hinge, stop, motor, supply loss, numerical
 *   outputs  prints slips along and across, contact states, forces, loads, hinge torques, currents, limits
 * A refusal prints "refused: …" and ends the program with status 3. */
#include "laconic/articulated_friction.h"
#include "run_words.h"

static laconic_tree_vehicle vehicle;
static laconic_tree_model model;
static laconic_tree_state state;
static laconic_tree_input input;
static long passes[52], growths;
static double last_energy_J = -1; /* below 0: of springs it is known from the first step on */

static void read_numbers(laconic_real *into[], int count) {
    for (int k = 0; k < count; k++) *into[k] = real_number();
}

static void read_body(int b) {
    laconic_body *body = &vehicle.hinged.body[b];
    laconic_tree_hinge *hinge = &vehicle.hinge[b];
    body->parent = (int32_t)number();
    body->hinge = (laconic_hinge_kind)(int)number();
    laconic_real *first[] = {&body->hinge_x_m, &body->hinge_y_m,        &body->mass_kg,     &body->com_x_m,
                             &body->com_y_m,   &body->yaw_inertia_kgm2, &body->damping_Nms, &body->stiffness_Nm,
                             &body->rest_rad,  &body->gain_Nm_per_V,    &hinge->com_z_m};
    read_numbers(first, 11);
    hinge->hitch = number() > 0;
    laconic_real *second[] = {&hinge->dry_friction_Nm,       &hinge->stop_low_rad,           &hinge->stop_high_rad,
                              &hinge->servo_gain_Nm_per_rad, &hinge->servo_damping_Nms,      &hinge->servo_limit_Nm,
                              &hinge->viscous_friction_Nms,  &hinge->winding_resistance_ohm, &hinge->current_limit_A,
                              &hinge->loop_V_per_rad,        &hinge->loop_Vs_per_rad,        &hinge->control_period_s};
    read_numbers(second, 12);
}

static void read_wheel(int i) {
    laconic_wheel *wheel = &vehicle.hinged.base.wheel[i];
    laconic_tree_wheel *more = &vehicle.wheel[i];
    vehicle.hinged.wheel_body[i] = (int32_t)number();
    wheel->kind = (laconic_wheel_kind)(int)number();
    laconic_real *first[] = {&wheel->x_m,
                             &wheel->y_m,
                             &wheel->axle_rad,
                             &wheel->roller_rad,
                             &wheel->own_radius_m,
                             &wheel->own_inertia_kgm2,
                             &wheel->own_motor_gain_Nm_per_V,
                             &wheel->own_motor_damping_Nms};
    read_numbers(first, 8);
    wheel->locked = number() > 0;
    laconic_real *second[] = {&wheel->own_friction_coefficient, &wheel->own_roller_drag, &wheel->own_axle_friction_Nm};
    read_numbers(second, 3);
    wheel->motor_circuit = (int32_t)number();
    laconic_real *third[] = {&more->load_N, &more->scrub_radius_m, &more->scrub_fade_m, &more->creep};
    read_numbers(third, 4);
}

static void read_vehicle(void) {
    laconic_vehicle *base = &vehicle.hinged.base;
    memset(&vehicle, 0, sizeof vehicle);
    base->wheel_radius_m = 1;
    laconic_real *numbers[] = {&base->mass_kg,
                               &base->yaw_inertia_kgm2,
                               &base->com_x_m,
                               &base->com_y_m,
                               &base->com_z_m,
                               &base->ground.friction_coefficient,
                               &base->ground.roller_drag,
                               &base->ground.axle_friction_Nm,
                               &base->ground.slope_rad,
                               &base->ground.slope_heading_rad,
                               &base->drive.supply_V,
                               &base->drive.supply_resistance_ohm,
                               &base->drive.current_limit_A,
                               &base->drive.winding_resistance_ohm,
                               &base->drive.viscous_friction_Nms};
    read_numbers(numbers, 15);
    vehicle.hinged.body_count = (int32_t)number();
    for (int b = 0; b < vehicle.hinged.body_count; b++) read_body(b);
    base->wheel_count = (int32_t)number();
    for (int i = 0; i < base->wheel_count; i++) read_wheel(i);
    base->support_count = (int32_t)number();
    for (int i = 0; i < base->support_count; i++) {
        base->support[i].x_m = real_number();
        base->support[i].y_m = real_number();
    }
    check(laconic_tree_prepare(&model, &vehicle, &why));
}

static void read_start(void) {
    laconic_tree_start start;
    memset(&start, 0, sizeof start);
    laconic_articulated_start *h = &start.hinged;
    laconic_real *numbers[] = {
        &h->velocity_m_per_s[0], &h->velocity_m_per_s[1], &h->yaw_rate_rad_per_s, &h->x_m, &h->y_m, &h->heading_rad};
    read_numbers(numbers, 6);
    read_many(h->hinge_angle_rad, model.body_count);
    read_many(h->hinge_rate_rad_per_s, model.body_count);
    read_many(start.wheel_speed_rad_per_s, model.wheel_count);
    start.wheels_stand = true;
    check(laconic_tree_state_set(&state, &model, &start, &why));
    last_energy_J = -1;
}

static void read_input(void) {
    laconic_articulated_input *in = &input.hinged;
    memset(&input, 0, sizeof input);
    read_base_input(&in->base, model.wheel_count);
    read_many(in->hinge_voltage_V, model.body_count);
    read_many(in->hinge_torque_Nm, model.body_count);
    read_many(in->hinge_rate_rad_per_s, model.body_count);
    read_many(input.hinge_angle_rad, model.body_count);
}

static void print_state(void) {
    laconic_tree_outputs out;
    laconic_tree_outputs_of(&out, &model, &state);
    const int h = model.body_count, n = model.wheel_count;
    printf("%.17g %.17g %.17g", (double)out.motion.x_m, (double)out.motion.y_m, (double)out.motion.heading_rad);
    print_many(out.motion.hinge_angle_rad, h);
    print_many(state.z, 3 + h);
    print_many(state.wheel_speed_rad_per_s, n);
    for (int b = 0; b <= h; b++)
        printf(" %.17g %.17g %.17g", (double)state.body[b].x, (double)state.body[b].y, (double)state.body[b].z);
    print_many(state.grip_N[0], 2 * n);
    print_many(state.scrub_Nm, n);
    print_many(state.dry_Nm, h);
    print_many(state.stop_Nm[0], 2 * h);
    print_many(state.drive_Nm, h);
    print_many(state.normal_N, model.point_count);
    printf("\n");
}

static double energy_J(void) {
    laconic_tree_outputs out;
    laconic_tree_outputs_of(&out, &model, &state);
    return (double)(out.motion.energy_J + out.spring_energy_J);
}

static void run(bool traced) {
    const laconic_real step = real_number();
    const long steps = (long)number();
    for (long i = 0; i < steps; i++) {
        check(laconic_tree_step(&model, step, &state, &input, &why));
        const double after = energy_J();
        growths += last_energy_J >= 0 && after > last_energy_J;
        last_energy_J = after;
        passes[state.passes < 51 ? state.passes : 51]++;
        if (traced) print_state();
    }
}

static void print_passes(void) {
    for (int k = 0; k < 52; k++) printf("%ld ", passes[k]);
    printf("%ld\n", growths);
    memset(passes, 0, sizeof passes);
    growths = 0;
}

static void print_books(void) {
    laconic_tree_outputs o;
    laconic_tree_outputs_of(&o, &model, &state);
    const laconic_real books[] = {o.motion.energy_J, o.spring_energy_J, o.supply_energy_J, o.outer_work_J,
                                  o.servo_work_J,    o.slip_loss_J,     o.scrub_loss_J,    o.axle_loss_J,
                                  o.hinge_loss_J,    o.stop_loss_J,     o.motor_loss_J,    o.supply_loss_J,
                                  o.numerical_loss_J};
    print_many(books, 13);
    printf("\n");
}

static void print_outputs(void) {
    laconic_tree_outputs o;
    laconic_tree_outputs_of(&o, &model, &state);
    const int h = model.body_count, n = model.wheel_count;
    print_many(o.slip_along_m_per_s, n);
    print_many(o.slip_across_m_per_s, n);
    for (int i = 0; i < n; i++) printf(" %d", (int)o.contact_state[i]);
    print_many(o.along_N, n);
    print_many(o.lateral_N, n);
    print_many(o.normal_N, model.point_count);
    print_many(o.hinge_torque_Nm, h);
    print_many(o.friction_torque_Nm, h);
    print_many(o.stop_torque_Nm, h);
    print_many(o.motor_current_A, n + h);
    for (int i = 0; i < n + h; i++) printf(" %d", (int)o.drive_limit[i]);
    printf(" %.17g %.17g\n", (double)o.supply_current_A, (double)o.supply_voltage_V);
}

int main(void) {
    char word[32];
    while (scanf("%31s", word) == 1) {
        if (strcmp(word, "vehicle") == 0)
            read_vehicle();
        else if (strcmp(word, "start") == 0)
            read_start();
        else if (strcmp(word, "input") == 0)
            read_input();
        else if (strcmp(word, "run") == 0 || strcmp(word, "trace") == 0)
            run(word[0] == 't');
        else if (strcmp(word, "passes") == 0)
            print_passes();
        else if (strcmp(word, "state") == 0)
            print_state();
        else if (strcmp(word, "books") == 0)
            print_books();
        else if (strcmp(word, "outputs") == 0)
            print_outputs();
        else
            return 2;
    }
    return 0;
}
