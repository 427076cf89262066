/* Runs an articulated vehicle from plain numbers on standard input, for host_tests, which write them from recorded
 * references and judge what it prints.
 *
 *   vehicle  mass inertia com_x com_y friction slope slope_heading  H {parent kind hinge_x hinge_y mass com_x com_y
 *            inertia damping stiffness rest gain}  N {body kind x y axle roller radius inertia gain damping locked}
 *   method   name step
 *   input    a course: N voltages, N torques, 3 body wrench, 2 world force, 2 point, H hinge voltages, H hinge torques,
 *            H rates and 3 twists as polynomials in time (count, coefficients)
 *   start    vx vy yaw_rate x y heading  H angles  H rates       with the input at its start
 *   run      duration steps                                      along the input, from its start
 *   motion   prints t, velocity, pose, angles, rates, wheel speeds, wheel angles, energy
 *   rates    prints twists and their rates of all bodies at the state, under the input at its start
 *   reactions  prints wheel torques, along, lateral, brakes, hinge torques, hinge forces, balance
 * A refusal prints "refused: …" and ends the program with status 3. */
#include "run_words.h"

#define MAX_POWERS 8

typedef struct polynomial {
    int count;
    double power[MAX_POWERS];
} polynomial;

typedef struct course {
    laconic_articulated_input held;
    polynomial rate[LACONIC_MAX_BODIES], twist[3];
} course;

static laconic_articulated_vehicle vehicle;
static laconic_articulated_model model;
static laconic_articulated_integrator integrator;
static laconic_articulated_state state;
static course now;
static double time_s;

static void read_vehicle(void) {
    memset(&vehicle, 0, sizeof vehicle);
    vehicle.base.mass_kg = real_number();
    vehicle.base.yaw_inertia_kgm2 = real_number();
    vehicle.base.com_x_m = real_number();
    vehicle.base.com_y_m = real_number();
    vehicle.base.wheel_radius_m = 1;
    vehicle.base.friction_coefficient = real_number();
    vehicle.base.ground.slope_rad = real_number();
    vehicle.base.ground.slope_heading_rad = real_number();
    vehicle.body_count = (int32_t)number();
    for (int b = 0; b < vehicle.body_count; b++) {
        laconic_body *body = &vehicle.body[b];
        body->parent = (int32_t)number();
        body->hinge = (laconic_hinge_kind)(int)number();
        body->hinge_x_m = real_number();
        body->hinge_y_m = real_number();
        body->mass_kg = real_number();
        body->com_x_m = real_number();
        body->com_y_m = real_number();
        body->yaw_inertia_kgm2 = real_number();
        body->damping_Nms = real_number();
        body->stiffness_Nm = real_number();
        body->rest_rad = real_number();
        body->gain_Nm_per_V = real_number();
    }
    vehicle.base.wheel_count = (int32_t)number();
    for (int i = 0; i < vehicle.base.wheel_count; i++) {
        laconic_wheel *wheel = &vehicle.base.wheel[i];
        vehicle.wheel_body[i] = (int32_t)number();
        wheel->kind = (laconic_wheel_kind)(int)number();
        wheel->x_m = real_number();
        wheel->y_m = real_number();
        wheel->axle_rad = real_number();
        wheel->roller_rad = real_number();
        wheel->own_radius_m = real_number();
        wheel->own_inertia_kgm2 = real_number();
        wheel->own_motor_gain_Nm_per_V = real_number();
        wheel->own_motor_damping_Nms = real_number();
        wheel->locked = number() > 0;
    }
    check(laconic_articulated_prepare(&model, &vehicle, &why));
}

static void read_method(void) {
    char name[32];
    if (scanf("%31s", name) != 1) exit(2);
    check(laconic_articulated_integrator_prepare(&integrator, laconic_articulated_method_by_name(name), &model,
                                                 real_number(), &why));
}

static void read_polynomial(polynomial *p) {
    memset(p, 0, sizeof *p);
    p->count = (int)number();
    for (int k = 0; k < p->count; k++) p->power[k] = number();
}

static void read_input(void) {
    laconic_articulated_input *in = &now.held;
    memset(&now, 0, sizeof now);
    read_base_input(&in->base, model.wheel_count);
    read_many(in->hinge_voltage_V, model.body_count);
    read_many(in->hinge_torque_Nm, model.body_count);
    for (int b = 0; b < model.body_count; b++) read_polynomial(&now.rate[b]);
    for (int k = 0; k < 3; k++) read_polynomial(&now.twist[k]);
}

static double value_at(const polynomial *p, double t) {
    double sum = 0;
    for (int k = p->count - 1; k >= 0; k--) sum = sum * t + p->power[k];
    return sum;
}

static double rate_at(const polynomial *p, double t) {
    double sum = 0;
    for (int k = p->count - 1; k >= 1; k--) sum = sum * t + k * p->power[k];
    return sum;
}

static laconic_articulated_input input_at(double t) {
    laconic_articulated_input in = now.held;
    for (int b = 0; b < model.body_count; b++) {
        in.hinge_rate_rad_per_s[b] = (laconic_real)value_at(&now.rate[b], t);
        in.hinge_acceleration_rad_per_s2[b] = (laconic_real)rate_at(&now.rate[b], t);
    }
    for (int k = 0; k < 3; k++) {
        in.twist[k] = (laconic_real)value_at(&now.twist[k], t);
        in.twist_rate[k] = (laconic_real)rate_at(&now.twist[k], t);
    }
    return in;
}

static void read_start(void) {
    laconic_articulated_start start;
    const laconic_articulated_input in = input_at(0);
    memset(&start, 0, sizeof start);
    read_many(start.velocity_m_per_s, 2);
    start.yaw_rate_rad_per_s = real_number();
    start.x_m = real_number();
    start.y_m = real_number();
    start.heading_rad = real_number();
    read_many(start.hinge_angle_rad, model.body_count);
    read_many(start.hinge_rate_rad_per_s, model.body_count);
    check(laconic_articulated_state_set(&state, NULL, &model, &start, &in, &why));
    time_s = 0;
}

/* A held input is one struct, so that steps see that it does not vary. */
static void run(void) {
    const double duration = number();
    const long steps = (long)number();
    bool varies = false;
    for (int b = 0; b < model.body_count; b++) varies = varies || now.rate[b].count > 1;
    for (int k = 0; k < 3; k++) varies = varies || now.twist[k].count > 1;
    laconic_articulated_input ends[2];
    ends[0] = ends[1] = input_at(0);
    for (long i = 0; i < steps; i++) {
        const laconic_articulated_input *start = &ends[varies ? i % 2 : 0], *end = &ends[varies ? (i + 1) % 2 : 0];
        if (varies) ends[(i + 1) % 2] = input_at(duration * (double)(i + 1) / (double)steps);
        check(laconic_articulated_step(&model, &integrator, &state, start, end, &why));
    }
    time_s += duration;
}

static void print_motion(void) {
    laconic_articulated_motion m;
    laconic_articulated_motion_of(&m, &model, &state);
    printf("%.17g", time_s);
    print_many(m.velocity_m_per_s, 2);
    printf(" %.17g %.17g %.17g %.17g", (double)m.yaw_rate_rad_per_s, (double)m.x_m, (double)m.y_m,
           (double)m.heading_rad);
    print_many(m.hinge_angle_rad, model.body_count);
    print_many(m.hinge_rate_rad_per_s, model.body_count);
    print_many(m.wheel_speed_rad_per_s, model.wheel_count);
    print_many(m.wheel_angle_rad, model.wheel_count);
    printf(" %.17g\n", (double)m.energy_J);
}

static void print_vectors(const laconic_vector *v, int count) {
    for (int k = 0; k < count; k++) printf(" %.17g %.17g %.17g", (double)v[k].x, (double)v[k].y, (double)v[k].z);
}

static void print_rates(void) {
    laconic_articulated_rates r;
    const laconic_articulated_input in = input_at(0);
    check(laconic_articulated_rates_of(&r, &model, &state, &in, &why));
    print_vectors(r.twist, model.body_count + 1);
    print_vectors(r.twist_rate, model.body_count + 1);
    printf("\n");
}

static void print_reactions(void) {
    laconic_articulated_reactions r;
    const laconic_articulated_input in = input_at(0);
    check(laconic_articulated_reactions_of(&r, &model, &state, &in, NULL, &why));
    print_many(r.wheel_torque_Nm, model.wheel_count);
    print_many(r.along_N, model.wheel_count);
    print_many(r.lateral_N, model.wheel_count);
    print_many(r.brake_Nm, model.wheel_count);
    print_many(r.hinge_torque_Nm, model.body_count);
    print_many(r.hinge_force_N[0], 2 * model.body_count);
    printf(" %.17g\n", (double)r.balance);
}

int main(void) {
    char word[32];
    while (scanf("%31s", word) == 1) {
        if (strcmp(word, "vehicle") == 0)
            read_vehicle();
        else if (strcmp(word, "method") == 0)
            read_method();
        else if (strcmp(word, "input") == 0)
            read_input();
        else if (strcmp(word, "start") == 0)
            read_start();
        else if (strcmp(word, "run") == 0)
            run();
        else if (strcmp(word, "motion") == 0)
            print_motion();
        else if (strcmp(word, "rates") == 0)
            print_rates();
        else if (strcmp(word, "reactions") == 0)
            print_reactions();
        else
            return 2;
    }
    return 0;
}
