/* Tests of cut_change.c: the derivatives of a step whose gain of energy was cut, against differences of the step. */
#include "laconic/derivatives.h"
#include "methods.h"

#define SMALL EITHER(1e-6, 4e-3)
#define CLOSE EITHER(1e-7, 1e-2)

/* exponential-kahan-4 would gain 3e-4 of the energy in this step, more than the forces can supply. */
typedef struct cut_case {
    laconic_vehicle vehicle;
    laconic_start start;
    laconic_input held;
} cut_case;

static cut_case case_under(double force_N) {
    cut_case c = {three_wheels(), start_with(0.8, -0.5, 9), no_input()};
    c.vehicle.com_x_m = REAL(0.01);
    c.held.body_force_N[1] = c.held.world_force_N[0] = REAL(force_N);
    return c;
}

static laconic_plant plant_of(const cut_case *c) {
    laconic_plant plant;
    ASSERT_STATUS(LACONIC_OK,
                  laconic_plant_start(&plant, &c->vehicle, &laconic_exponential_kahan_4, REAL(0.4), &c->start, NULL));
    return plant;
}

static double energy_of(const laconic_plant *plant) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += pow((double)plant->state.zeta[k].value, 2);
    return sum;
}

/* A direction of the motion, the force in the world, the vehicle. */
static cut_case moved(cut_case c, int direction, double by) {
    const double nu[3] = {0.3, -0.6, 0.5};
    if (direction == 0)
        for (int k = 0; k < 3; k++) c.start.nu_rad_per_s[k] += REAL(by * nu[k]);
    if (direction == 0) c.start.heading_rad += REAL(0.4 * by);
    if (direction == 1) c.held.world_force_N[1] += REAL(by), c.held.body_force_N[0] -= REAL(0.5 * by);
    if (direction == 2) c.vehicle.mass_kg += REAL(by), c.vehicle.yaw_inertia_kgm2 -= REAL(0.02 * by);
    if (direction == 2) c.vehicle.com_x_m += REAL(0.01 * by), c.vehicle.wheel[1].axle_rad += REAL(0.1 * by);
    return c;
}

static void tangent_of(laconic_state_change *after, const cut_case *c, int direction) {
    const laconic_plant plant = plant_of(c);
    laconic_state_change before;
    laconic_input input = no_input();
    laconic_vehicle vehicle;
    laconic_model_change by_model;
    memset(&before, 0, sizeof before);
    memset(&vehicle, 0, sizeof vehicle);
    if (direction == 0) before.nu_rad_per_s[0] = REAL(0.3), before.nu_rad_per_s[1] = REAL(-0.6);
    if (direction == 0) before.nu_rad_per_s[2] = REAL(0.5), before.heading_rad = REAL(0.4);
    if (direction == 1) input.world_force_N[1] = REAL(1), input.body_force_N[0] = REAL(-0.5);
    if (direction == 2) vehicle.mass_kg = REAL(1), vehicle.yaw_inertia_kgm2 = REAL(-0.02);
    if (direction == 2) vehicle.com_x_m = REAL(0.01), vehicle.wheel[1].axle_rad = REAL(0.1);
    ASSERT_STATUS(LACONIC_OK, laconic_model_tangent(&by_model, &plant.model, &c->vehicle, &vehicle));
    ASSERT_STATUS(LACONIC_OK, laconic_step_tangent(after, &plant.model, &plant.integrator, &plant.state, &c->held,
                                                   &before, &input, &by_model));
}

static void nu_after(double nu[3], const cut_case *c) {
    laconic_plant plant = plant_of(c);
    laconic_real found[3];
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &c->held, 1, NULL));
    laconic_nu(&plant.model, &plant.state, found);
    for (int k = 0; k < 3; k++) nu[k] = (double)found[k];
}

static void changes_as_differences_say(const cut_case *c, int direction) {
    const cut_case high_case = moved(*c, direction, SMALL), low_case = moved(*c, direction, -SMALL);
    laconic_state_change after;
    double high[3], low[3], size = 0;
    tangent_of(&after, c, direction);
    nu_after(high, &high_case);
    nu_after(low, &low_case);
    for (int k = 0; k < 3; k++) size = fmax(size, fabs((double)after.nu_rad_per_s[k]));
    for (int k = 0; k < 3; k++)
        ASSERT_NEAR(CLOSE * size, (high[k] - low[k]) / (2 * SMALL), (double)after.nu_rad_per_s[k]);
}

static void the_gain_is_cut(void) {
    const cut_case c = case_under(0);
    laconic_plant plant = plant_of(&c);
    const double before = energy_of(&plant);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &c.held, 1, NULL));
    ASSERT_NEAR(EITHER(1e-14, 1e-6), 1, energy_of(&plant) / before);
}

static void the_tangent_along_a_motion_is_what_differences_show(void) {
    const cut_case free = case_under(0), pushed = case_under(EITHER(1e-4, 1e-3));
    changes_as_differences_say(&free, 0);
    changes_as_differences_say(&pushed, 0);
}

static void the_tangent_along_the_vehicle_is_what_differences_show(void) {
    const cut_case free = case_under(0), pushed = case_under(EITHER(1e-4, 1e-3));
    changes_as_differences_say(&free, 2);
    changes_as_differences_say(&pushed, 2);
}

/* In single the differences are so large that the forces supply the gain. */
static void the_tangent_along_weak_forces_is_what_differences_show(void) {
    const cut_case pushed = case_under(1e-4);
    laconic_state_change after;
    if (IN_DOUBLE)
        changes_as_differences_say(&pushed, 1);
    else
        tangent_of(&after, &pushed, 1);
}

/* What the step does otherwise is not touched: it has the derivatives of its method. */
static void a_step_that_is_not_cut_has_the_derivatives_of_its_method(void) {
    cut_case c = case_under(0);
    c.start = start_with(0.8, -0.5, 2); /* loses 5e-8 */
    for (int direction = 0; direction < 3; direction++) changes_as_differences_say(&c, direction);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(the_gain_is_cut);
    RUN_TEST(the_tangent_along_a_motion_is_what_differences_show);
    RUN_TEST(the_tangent_along_the_vehicle_is_what_differences_show);
    RUN_TEST(the_tangent_along_weak_forces_is_what_differences_show);
    RUN_TEST(a_step_that_is_not_cut_has_the_derivatives_of_its_method);
    return UNITY_END();
}
