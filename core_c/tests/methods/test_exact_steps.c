/* One step of made-up vehicles by every method beside the same map in 50 digits, which has no code of the core's:
 * rollers, fixed wheels, a locked one, wheels of their own, none; payloads, slopes, forces fixed in the world; damping
 * from slow to stiff, yaws of a step on both sides of the polynomials' bounds. */
#include "check.h"
#include "exact_steps.h"

/* The tables' numbers, one after the other. */
typedef struct reader {
    const double *at;
} reader;

static laconic_real next(reader *from) { return REAL(*from->at++); }

static void read_wheel(laconic_wheel *wheel, reader *from) {
    wheel->kind = (laconic_wheel_kind)next(from);
    wheel->locked = next(from) > 0;
    wheel->undriven = next(from) > 0;
    laconic_real *const to[8] = {&wheel->x_m,
                                 &wheel->y_m,
                                 &wheel->axle_rad,
                                 &wheel->roller_rad,
                                 &wheel->own_radius_m,
                                 &wheel->own_inertia_kgm2,
                                 &wheel->own_motor_gain_Nm_per_V,
                                 &wheel->own_motor_damping_Nms};
    for (int k = 0; k < 8; k++) *to[k] = next(from);
}

static void read_input(laconic_input *input, reader *from) {
    for (int i = 0; i < EXACT_WHEELS; i++) input->voltage_V[i] = next(from);
    for (int i = 0; i < EXACT_WHEELS; i++) input->axle_torque_Nm[i] = next(from);
    for (int k = 0; k < 2; k++) input->body_force_N[k] = next(from);
    input->body_moment_Nm = next(from);
    for (int k = 0; k < 2; k++) input->world_force_N[k] = next(from);
    for (int k = 0; k < 2; k++) input->world_force_point_m[k] = next(from);
}

typedef struct given {
    laconic_vehicle vehicle;
    laconic_real step_s;
    laconic_start start;
    laconic_input input;
} given;

static given read_case(int number) {
    reader from = {exact_given[number]};
    given g;
    memset(&g, 0, sizeof g);
    laconic_vehicle *v = &g.vehicle;
    laconic_real *const to[14] = {&v->mass_kg,
                                  &v->yaw_inertia_kgm2,
                                  &v->com_x_m,
                                  &v->com_y_m,
                                  &v->wheel_radius_m,
                                  &v->wheel_inertia_kgm2,
                                  &v->motor_gain_Nm_per_V,
                                  &v->motor_damping_Nms,
                                  &v->payload.mass_kg,
                                  &v->payload.x_m,
                                  &v->payload.y_m,
                                  &v->payload.yaw_inertia_kgm2,
                                  &v->ground.slope_rad,
                                  &v->ground.slope_heading_rad};
    for (int k = 0; k < 14; k++) *to[k] = next(&from);
    g.step_s = next(&from);
    for (int k = 0; k < 3; k++) g.start.nu_rad_per_s[k] = next(&from);
    g.start.heading_rad = next(&from);
    v->wheel_count = (int32_t)next(&from);
    for (int i = 0; i < EXACT_WHEELS; i++) read_wheel(&v->wheel[i], &from);
    read_input(&g.input, &from);
    TEST_ASSERT_TRUE(from.at == exact_given[number] + EXACT_GIVEN);
    return g;
}

/* The largest magnitude, but not below `least`. */
static double size_of(const double *values, int count, double least) {
    double size = least;
    for (int k = 0; k < count; k++) size = fabs(values[k]) > size ? fabs(values[k]) : size;
    return size;
}

static void assert_state(const given *g, const laconic_plant *plant, const double *expected) {
    laconic_real nu[3], angle[LACONIC_MAX_WHEELS];
    laconic_pose pose;
    double fastest = 0;
    laconic_nu(&plant->model, &plant->state, nu);
    laconic_pose_of(&pose, &plant->model, &plant->state);
    laconic_plant_wheel_angles(plant, angle);
    for (int k = 0; k < 3; k++) fastest = fmax(fastest, fabs((double)g->start.nu_rad_per_s[k]));
    const double turned = fastest * (double)g->step_s, rolled = turned * (double)g->vehicle.wheel_radius_m;
    const laconic_real position[2] = {pose.x_m, pose.y_m};
    /* Cramer's rule in a stiff step costs a digit. */
    ASSERT_NEAR_ALL(EITHER(2e-14, 6e-6) * size_of(expected, 3, 0), expected, nu, 3);
    /* One coefficient of the chord is exact to 3e-12 of what is of second order in the step. */
    ASSERT_NEAR_ALL(EITHER(6e-14, 2e-6) * size_of(expected + 3, 2, rolled), expected + 3, position, 2);
    ASSERT_NEAR(EITHER(4e-15, 4e-6) * size_of(expected + 5, 1, 0), expected[5], pose.heading_rad);
    ASSERT_NEAR_ALL(EITHER(4e-15, 4e-6) * size_of(expected + 6, g->vehicle.wheel_count, turned), expected + 6, angle,
                    g->vehicle.wheel_count);
}

/* False: the core does not take the step. */
static bool is_taken(const given *g, laconic_plant *plant, const laconic_method *method) {
    laconic_start rest;
    memset(&rest, 0, sizeof rest);
    memset(plant, 0, sizeof *plant);
    rest.heading_rad = g->start.heading_rad;
    if (laconic_plant_start(plant, &g->vehicle, method, g->step_s, &rest, NULL) != LACONIC_OK) return false;
    ASSERT_STATUS(LACONIC_OK, laconic_state_project(&plant->state, &plant->model, &g->start, NULL));
    return laconic_plant_run(plant, &g->input, 1, NULL) == LACONIC_OK;
}

static laconic_plant plant;

static void every_method_takes_the_step_that_its_derivation_states(void) {
    int taken = 0;
    for (int number = 0; number < EXACT_CASES; number++) {
        const given g = read_case(number);
        for (int k = 0; k < EXACT_METHODS; k++) {
            const double *expected = exact_found[number][k];
            const laconic_method *method = laconic_method_by_name(exact_method[k]);
            TEST_ASSERT_NOT_NULL(method);
            const bool is_refused = expected[0] >= REFUSED;
            TEST_ASSERT_EQUAL(!is_refused, is_taken(&g, &plant, method));
            if (is_refused) continue;
            assert_state(&g, &plant, expected);
            taken++;
        }
    }
    TEST_ASSERT_TRUE(taken > EXACT_CASES * (EXACT_METHODS - 1));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(every_method_takes_the_step_that_its_derivation_states);
    return UNITY_END();
}
