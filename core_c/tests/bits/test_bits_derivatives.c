/* Tests that the derivatives of a step are, bit for bit, those of the version before: all columns of the Jacobian,
 * the tangent and the adjoint with inputs and constants of the model, by every method, and how a model changes with
 * each number of its vehicle. Items of wheels that a vehicle has not stay as they were. test_step_derivatives.c and
 * host_tests/tests/derivatives compare them with differences. */
#include "elementary.h"
#include "friction_internals.h"
#include "gauss_weight_change.h"
#include "heading.h"

#include "bits.h"
#include "laconic/derivatives.h"
#include "stack.h"

static laconic_vehicle every_number_of(const laconic_vehicle *vehicle, int part) {
    laconic_vehicle by;
    memset(&by, 0, sizeof by);
    if (part == 0 || part == 4) {
        by.mass_kg = 1;
        by.yaw_inertia_kgm2 = REAL(0.03);
        by.com_x_m = REAL(0.02);
        by.com_y_m = REAL(-0.01);
    }
    if (part == 1 || part == 4) {
        by.wheel_radius_m = REAL(0.004);
        by.wheel_inertia_kgm2 = REAL(0.001);
        by.motor_gain_Nm_per_V = REAL(0.07);
        by.motor_damping_Nms = REAL(0.05);
    }
    if (part == 2 || part == 4) by.payload = (laconic_payload){REAL(0.5), REAL(0.01), REAL(-0.02), REAL(0.004)};
    if (part == 2 || part == 4) by.ground.slope_rad = REAL(0.1), by.ground.slope_heading_rad = REAL(-0.3);
    for (int i = 0; part >= 3 && i < vehicle->wheel_count; i++) {
        laconic_wheel *w = &by.wheel[i];
        if (vehicle->wheel[0].kind != LACONIC_WHEEL_FIXED) {
            w->x_m = REAL(0.01 * i - 0.02);
            w->y_m = REAL(0.03 - 0.02 * i);
            w->axle_rad = REAL(0.2 + 0.1 * i);
        }
        w->roller_rad = REAL(0.3 - 0.2 * i);
        w->own_radius_m = REAL(0.002 * i - 0.001);
        w->own_inertia_kgm2 = REAL(0.0004);
        w->own_motor_gain_Nm_per_V = REAL(0.03 * i);
        w->own_motor_damping_Nms = REAL(0.02 - 0.006 * i);
    }
    return by;
}

#define KINDS_OF_CHANGE 5

static void constants_of_a_model_by_each_number_of_its_vehicle(void) {
    begin();
    for (int number = 0; number < MORE_VEHICLES; number++)
        for (int part = 0; part < KINDS_OF_CHANGE; part++) {
            const laconic_vehicle vehicle = vehicle_number(number), by = every_number_of(&vehicle, part);
            const laconic_model model = model_of(vehicle);
            laconic_model_change change;
            FILL(change);
            fill_stack(ALL_NAN);
            ASSERT_STATUS(LACONIC_OK, laconic_model_tangent(&change, &model, &vehicle, &by));
            TAKE(change);
        }
    expect(EITHER(0x549d0c6212befbb7U, 0x80284e0c09cbe384U));
}

static void take_jacobian(const laconic_plant *plant, const laconic_input *held, bool with_world_force) {
    static laconic_real by_state[(6 + LACONIC_MAX_WHEELS) * (6 + LACONIC_MAX_WHEELS)],
        by_input[(6 + LACONIC_MAX_WHEELS) * LACONIC_INPUT_NUMBERS(LACONIC_MAX_WHEELS)];
    laconic_step_jacobian j;
    FILL(j.by_nu);
    FILL(j.by_heading);
    FILL(j.by_voltage);
    FILL(j.by_axle_torque);
    FILL(j.by_body_force);
    FILL(j.by_body_moment);
    FILL(j.by_world_force);
    FILL(j.by_world_force_point);
    FILL(by_state);
    FILL(by_input);
    fill_stack(ALL_NAN);
    const laconic_real status =
        REAL(laconic_step_jacobian_of(&j, &plant->model, &plant->integrator, &plant->state, held, with_world_force));
    TAKE(status);
    if (status != 0) return;
    TAKE(j.by_nu);
    TAKE(j.by_heading);
    TAKE(j.by_voltage);
    TAKE(j.by_axle_torque);
    TAKE(j.by_body_force);
    TAKE(j.by_body_moment);
    TAKE(j.by_world_force);
    TAKE(j.by_world_force_point);
    laconic_jacobian_by_state(by_state, &j, &plant->model);
    laconic_jacobian_by_input(by_input, &j, &plant->model);
    TAKE(by_state);
    TAKE(by_input);
}

static laconic_state_change some_change(int number) {
    laconic_state_change change;
    memset(&change, 0, sizeof change);
    for (int i = 0; i < 3; i++) change.nu_rad_per_s[i] = REAL(0.3 * number - 0.5 * i + 0.2);
    change.x_m = REAL(0.1);
    change.y_m = REAL(0.2 - 0.1 * number);
    change.heading_rad = REAL(0.7 - 0.4 * number);
    for (int i = 0; i < LACONIC_MAX_WHEELS; i++) change.wheel_angle_rad[i] = REAL(0.3 - 0.2 * i + 0.1 * number);
    return change;
}

static void take_directions(const laconic_plant *plant, const laconic_input *held, int number) {
    const laconic_vehicle by = every_number_of(&plant->vehicle, KINDS_OF_CHANGE - 1);
    const laconic_state_change along = some_change(number);
    const laconic_input input = input_at(number + 3);
    laconic_state_change after, before;
    laconic_model_change change, gradient;
    laconic_input by_input;
    FILL(change);
    FILL(gradient);
    FILL(after);
    FILL(before);
    FILL(by_input);
    ASSERT_STATUS(LACONIC_OK, laconic_model_tangent(&change, &plant->model, &plant->vehicle, &by));
    fill_stack(ALL_NAN);
    laconic_step_tangent(&after, &plant->model, &plant->integrator, &plant->state, held, &along, &input, &change);
    TAKE(after);
    fill_stack(ALL_NAN);
    laconic_step_tangent(&after, &plant->model, &plant->integrator, &plant->state, held, &along, NULL, NULL);
    TAKE(after);
    fill_stack(ALL_NAN);
    laconic_step_adjoint(&before, &by_input, &gradient, &plant->model, &plant->integrator, &plant->state, held, &along);
    TAKE(before);
    TAKE(by_input);
    TAKE(gradient);
}

static void take_derivatives(const laconic_method *method) {
    const double step_s[3] = {0.004, 0.05, 0.4};
    for (int number = 0; number < MORE_VEHICLES; number++)
        for (int k = 0; k < 6; k++) {
            const laconic_vehicle vehicle = vehicle_number(number);
            const laconic_start motion = {{REAL(0.8), REAL(-0.5), REAL(k == 4 ? 200 : 2.4)}, 1, 2, REAL(0.9), {0}};
            const laconic_start still = start_with(0, 0, 0);
            laconic_input held = input_at(k);
            laconic_plant plant;
            if (k % 2 == 0) held.world_force_N[0] = held.world_force_N[1] = 0;
            if (laconic_plant_start(&plant, &vehicle, method, REAL(step_s[k % 3]), &still, &why) != LACONIC_OK)
                continue;
            ASSERT_STATUS(LACONIC_OK, laconic_state_project(&plant.state, &plant.model, &motion, &why));
            take_jacobian(&plant, &held, k % 4 == 0);
            take_directions(&plant, &held, k);
        }
}

static void derivatives_of_steps_by_every_method(void) {
    static const uint64_t bits[] = {
        EITHER(0xc0f4319f1be1a03bU, 0x24bd808a086eaf9cU), EITHER(0x3ac583ffa684a3d2U, 0x9090f94b0ef019daU),
        EITHER(0x5f0cf88b6e4ea528U, 0xe5faf36ecce5d2f2U), EITHER(0xe79aba29be052192U, 0x7d9be3bb1225a771U),
        EITHER(0x0e1d3a55b4d5b4c2U, 0x41d72877362243c3U), EITHER(0x7291e7f7c579ebe7U, 0x84bd74fe93b93598U),
        EITHER(0x4bfe45bdd4594e7bU, 0x9964be7ad24b9b48U), EITHER(0x06e630028333d608U, 0xc6dadc5949492691U),
    };
    expect_by_method(take_derivatives, bits);
}

static laconic_input one_world_force(void) {
    laconic_input input = no_input();
    input.world_force_N[0] = REAL(2);
    return input;
}

static void take_jacobians_at_every_yaw(const laconic_method *method) {
    const laconic_vehicle vehicle = three_wheels();
    const laconic_input held = one_world_force();
    laconic_real nu3 = REAL(0.5);
    for (int k = 0; k < 220; k++) {
        const laconic_start start = {{1, 2, k % 2 == 0 ? nu3 : -nu3}, 0, 0, REAL(0.3), {0}};
        laconic_plant plant;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &vehicle, method, REAL(0.1), &start, &why));
        take_jacobian(&plant, &held, false);
        nu3 *= REAL(1.025);
    }
}

static void derivatives_at_every_yaw_by_every_method(void) {
    static const uint64_t bits[] = {
        EITHER(0xa3ec1abc37cd18a7U, 0x85df876037583c9bU), EITHER(0x5d0e7de4e56d22ffU, 0xabb85a06532ce607U),
        EITHER(0x9642e8c673d81573U, 0x85d59f975660a63bU), EITHER(0x4da6f2e4b3d19dbfU, 0x03ce948d4513ce8bU),
        EITHER(0x7e94fc984c744737U, 0x0a525fb96b4759c7U), EITHER(0xb28b4a8b21a88013U, 0x75d6a72dba0342f3U),
        EITHER(0x9e09dc4115b98c87U, 0x65404a83b807d953U), EITHER(0xa7726a3206c31dddU, 0x992629a52fb88049U),
    };
    expect_by_method(take_jacobians_at_every_yaw, bits);
}

/* Neither the step nor its direction has a force fixed in the world, nor a slope: nothing rotates. */
static void take_tangents_in_body_axes(const laconic_method *method) {
    for (int number = 0; number < MORE_VEHICLES; number++) {
        const laconic_vehicle vehicle = vehicle_number(number);
        const laconic_vehicle by = every_number_of(&vehicle, 1);
        const laconic_start motion = {{REAL(0.8), REAL(-0.5), REAL(2.4)}, 1, 2, REAL(0.9), {0}};
        const laconic_start still = start_with(0, 0, 0);
        const laconic_state_change along = some_change(number);
        laconic_state_change after;
        laconic_model_change change;
        laconic_input held = input_at(number), input = input_at(number + 3);
        laconic_plant plant;
        held.world_force_N[0] = held.world_force_N[1] = input.world_force_N[0] = input.world_force_N[1] = 0;
        if (vehicle.ground.slope_rad > 0 ||
            laconic_plant_start(&plant, &vehicle, method, REAL(0.05), &still, &why) != LACONIC_OK)
            continue;
        ASSERT_STATUS(LACONIC_OK, laconic_state_project(&plant.state, &plant.model, &motion, &why));
        ASSERT_STATUS(LACONIC_OK, laconic_model_tangent(&change, &plant.model, &plant.vehicle, &by));
        for (int k = 0; k < 3; k++) {
            FILL(after);
            laconic_step_tangent(&after, &plant.model, &plant.integrator, &plant.state, &held, &along,
                                 k == 0 ? NULL : &input, k == 1 ? NULL : &change);
            TAKE(after);
        }
    }
}

static void tangents_in_body_axes_by_every_method(void) {
    static const uint64_t bits[] = {
        EITHER(0x7939f39a29a5252fU, 0x46ec8121ab5cdaa9U), EITHER(0x1df405f8cf4616e7U, 0xb7d09709b2a76947U),
        EITHER(0x6e5dd52af45edea2U, 0x06e52760dfc001f6U), EITHER(0x2f82585213dc3df0U, 0x2d1d2cf65f5d6087U),
        EITHER(0x388480b37bbfd2fdU, 0x036ca5fdf3be39b5U), EITHER(0xff4e40333a28b758U, 0x5411831f1cd69356U),
        EITHER(0x11e2f17b43b219f5U, 0xa39e9ecb350d2e7fU), EITHER(0x7939f39a29a5252fU, 0x46ec8121ab5cdaa9U),
    };
    expect_by_method(take_tangents_in_body_axes, bits);
}

/* At every damping of a panel, on both sides of the border between the two formulas of its sixth function. */
static void weights_of_panels_by_their_damping(void) {
    const linear_map every = {vector_of(1, 2, 3), vector_of(2, -1, REAL(0.5)), vector_of(3, REAL(0.5), 2)};
    static gauss_weight_change change;
    laconic_model m;
    memset(&m, 0, sizeof m);
    begin();
    for (int k = 0; k < 90; k++) {
        for (int i = 0; i < 3; i++) m.decay_per_s[i] = REAL(0.25 * k * (i + 1));
        FILL(change);
        fill_stack(ALL_NAN);
        laconic_gauss_weight_change_of(&change, &m, REAL(0.5), &every);
        TAKE(change);
    }
    expect(EITHER(0x8d888147d917b638U, 0x2e974b22c8daa907U));
}

/* Tests that the core's own functions give, bit for bit, what they gave in the version before: root, exponential, φ,
 * directions, polynomials, headings, noise, encoders, angles and counts of steps. test_elementary.c, test_heading.c and
 * test_sensors_range.c compare them with the host's library. */

#define TAKE_ONE(number) \
    do { \
        const laconic_real one = (number); \
        TAKE(one); \
    } while (0)

static void take_whole(uint64_t whole) {
    for (int k = 0; k < 8; k++) hash = (hash ^ ((whole >> (8 * k)) & 255U)) * 1099511628211U;
}

static void take_direction(direction d) {
    TAKE_ONE(d.cosine);
    TAKE_ONE(d.sine);
}

static void roots_and_exponentials(void) {
    const laconic_real odd[8] = {0,        -1,          REAL(4), REAL(0.25), LACONIC_REAL_MAX, LACONIC_REAL_MIN,
                                 INFINITE, NOT_A_NUMBER};
    begin();
    for (int k = 0; k < 8; k++) {
        TAKE_ONE(laconic_root(odd[k]));
        TAKE_ONE(laconic_decaying_exponential(odd[k]));
    }
    laconic_real x = REAL(1e-30);
    for (int k = 0; k < 600; k++) {
        TAKE_ONE(laconic_root(x));
        x *= REAL(1.27);
    }
    for (int k = 0; k < 2000; k++) TAKE_ONE(laconic_decaying_exponential(REAL(0.4) * REAL(k)));
    for (int k = 0; k < 300; k++) TAKE_ONE(laconic_decaying_exponential(REAL(0.01) * REAL(k)));
    expect(EITHER(0x0b7d4b3dafe73724U, 0x23c8178edad95332U));
}

static void exponential_integrals(void) {
    laconic_real a = REAL(1e-9);
    begin();
    for (int k = 0; k < 500; k++) {
        laconic_real phi[6] = {0};
        laconic_phi(phi, k == 0 ? 0 : a);
        TAKE(phi);
        a *= REAL(1.06);
    }
    expect(EITHER(0xd8267f050eb84b84U, 0x09636d23b6618340U));
}

static void directions_of_angles(void) {
    begin();
    for (int k = -2000; k < 2000; k++) take_direction(laconic_direction_of_angle(REAL(0.0123) * REAL(k)));
    laconic_real angle = REAL(0.7);
    for (int k = 0; k < 200; k++) {
        take_direction(laconic_direction_of_angle(angle));
        take_whole(laconic_binary_angle_of(angle));
        take_whole(laconic_binary_angle_of(-angle));
        TAKE_ONE(laconic_angle_wrapped(angle));
        TAKE_ONE(laconic_angle_wrapped(-angle));
        angle *= REAL(1.3);
    }
    TAKE_ONE(laconic_angle_wrapped(REAL(3.14159265358979323846)));
    TAKE_ONE(laconic_angle_wrapped(-REAL(3.14159265358979323846)));
    TAKE_ONE(laconic_angle_wrapped(INFINITE));
    laconic_binary_angle binary = 0;
    for (int k = 0; k < 1000; k++) {
        take_direction(laconic_direction_of_binary_angle(binary));
        binary = (laconic_binary_angle)(binary + (laconic_binary_angle)EITHER(0x0123456789abcdefU, 0x01234567U));
    }
    expect(EITHER(0x09dc2127f2f56c45U, 0x4046552db638a751U));
}

static void polynomials(void) {
    begin();
    for (int k = -64; k <= 64; k++) {
        const laconic_real x = REAL(0.0123) * REAL(k), z = x * x, small = REAL(0.015625) / 64 * REAL(k);
        TAKE_ONE(poly_sin(x, z));
        TAKE_ONE(poly_cos(z));
        TAKE_ONE(poly_sinc(small));
        TAKE_ONE(poly_j1(small));
        TAKE_ONE(poly_tangent(small));
    }
    expect(EITHER(0x4cdd2d3e61e40392U, 0xd4675b5241be272aU));
}

static void headings(void) {
    laconic_heading heading = {0, 0, 0};
    begin();
    laconic_real by = REAL(1e-6);
    for (int k = 0; k < 300; k++) {
        take_whole(heading_advance(&heading, k % 3 == 2 ? -REAL(1.7) * by : by));
        take_whole((uint64_t)heading.turns);
        take_whole(heading.fraction);
        TAKE_ONE(heading.rest);
        TAKE_ONE(heading_wrapped(&heading));
        TAKE_ONE(heading_unwrapped(&heading));
        by *= REAL(1.1);
    }
    expect(EITHER(0x21e10d625933362bU, 0xbfa24105a2810b3dU));
}

static void noise(void) {
    begin();
    for (uint64_t k = 0; k < 500; k++) {
        laconic_real pair[2];
        laconic_normal_pair(pair, k / 7 * 0x9e3779b97f4a7c15U, (uint32_t)(k % 7), k * k * k);
        TAKE(pair);
    }
    expect(EITHER(0x164152490ebcb271U, 0xb5f9d60448d4bba5U));
}

static void encoders(void) {
    begin();
    for (int32_t number = 0; number < 6; number++) {
        const laconic_encoder_settings settings = {1 + 777 * number, REAL(number == 2 ? 0 : 2.5 - number)};
        laconic_encoder encoder = {0, 0};
        laconic_real turned = REAL(0.001);
        for (int k = 0; k < 80; k++) {
            take_whole(laconic_encoder_turn(&encoder, &settings, k % 4 == 3 ? -3 * turned : turned));
            take_whole((uint64_t)encoder.count);
            TAKE_ONE(encoder.rest);
            take_whole((uint64_t)laconic_encoder_place(&encoder, settings.counts_per_turn));
            take_whole((uint64_t)laconic_encoder_turns(&encoder, settings.counts_per_turn));
            take_whole((uint64_t)laconic_encoder_shown(&encoder, 0));
            take_whole((uint64_t)laconic_encoder_shown(&encoder, 1000 + number));
            turned *= REAL(1.35);
        }
    }
    expect(EITHER(0x692e0d54be15e836U, 0x055523ee336489bfU));
}

static void counts_of_steps(void) {
    const double interval[8] = {0, -1, 1e-3, 0.01, 1, 3600, 1e12, 1e17};
    begin();
    for (int k = 0; k < 8; k++)
        for (int n = 0; n < 12; n++) {
            const double step = n == 0 ? 0 : n == 1 ? -1 : n == 2 ? (double)INFINITY : 1e-5 * n * n * n;
            uint64_t steps = 0;
            memset(&why, 0, sizeof why);
            take_whole((uint64_t)laconic_steps_in(interval[k] * (1 + 1e-9 * n), step, &steps, &why));
            take_refusal();
            take_whole(steps);
        }
    expect(EITHER(0xc054bf0899bdf561U, 0xa5aae9c35a064b49U));
}

static void quick_roots(void) {
    laconic_real x = LACONIC_REAL_MIN;
    begin();
    for (int k = 0; k < 2000; k++) {
        TAKE_ONE(quick_root(x));
        x *= EITHER(REAL(2.03), REAL(1.091));
    }
    expect(EITHER(0xa78314da3f5c44adU, 0xb8a2772ea584677eU));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(constants_of_a_model_by_each_number_of_its_vehicle);
    RUN_TEST(derivatives_of_steps_by_every_method);
    RUN_TEST(derivatives_at_every_yaw_by_every_method);
    RUN_TEST(tangents_in_body_axes_by_every_method);
    RUN_TEST(weights_of_panels_by_their_damping);
    RUN_TEST(roots_and_exponentials);
    RUN_TEST(quick_roots);
    RUN_TEST(exponential_integrals);
    RUN_TEST(directions_of_angles);
    RUN_TEST(polynomials);
    RUN_TEST(headings);
    RUN_TEST(noise);
    RUN_TEST(encoders);
    RUN_TEST(counts_of_steps);
    return UNITY_END();
}
