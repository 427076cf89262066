/* Tests that motions by every method are, bit for bit, those of the version before, in every kind of step: with damping
 * slow and fast, under each force by itself, with inputs held and sampled, at any yaw, where a method refuses and where
 * auto takes another. Other tests compare motions with the reference; here no bit of them may change unnoticed. A
 * change on purpose goes with a line of the changelog: the message of a failed test has the new bits by method. */
#include "bits.h"

static void take_motions(const laconic_method *method) {
    for (int number = 0; number < MORE_VEHICLES; number++) {
        const laconic_vehicle vehicle = vehicle_number(number);
        take_run(&vehicle, method, 0.004, number < VEHICLES ? 60 : 20);
        take_run(&vehicle, method, 0.02, 10);
    }
}

static void motions_by_every_method(void) {
    static const uint64_t bits[] = {
        EITHER(0x314069324cf7fe09U, 0xcdbc1fedc7b0c908U), EITHER(0x11cf2b03942ed98fU, 0x01495e99d9cd49b1U),
        EITHER(0xc6a08413cc24bc81U, 0x109f84f9be63236bU), EITHER(0xab9b93ad809d1549U, 0x1a48a1048d1dfb7bU),
        EITHER(0x47f67a29f2025800U, 0xe8745f206a1031afU), EITHER(0x8662de9582d53a22U, 0x9772f6a893230337U),
        EITHER(0x923fe4569b542d67U, 0xf60e9453f4427e5dU), EITHER(0x314069324cf7fe09U, 0xcdbc1fedc7b0c908U),
    };
    expect_by_method(take_motions, bits);
}

/* From a fast start, with held and sampled inputs, however many of the steps are refused. */
static void take_fast_run(const laconic_vehicle *vehicle, const laconic_method *method, double step_s,
                          const laconic_start *start, const laconic_input samples[3]) {
    laconic_plant plant;
    laconic_outputs out;
    if (laconic_plant_start(&plant, vehicle, method, REAL(step_s), start, &why) != LACONIC_OK) {
        take_refusal();
        return;
    }
    for (int step = 0; step < 6; step++) {
        const laconic_real stable_s = laconic_largest_stable_step_s(method, &plant.model, &plant.state);
        const laconic_status status = step % 3 == 2 ? laconic_plant_run_sampled(&plant, samples, &why)
                                                    : laconic_plant_run(&plant, samples, 3, &why);
        if (status != LACONIC_OK) take_refusal();
        TAKE(stable_s);
        FILL(out);
        laconic_outputs_of(&out, &plant, samples);
        TAKE(out);
        TAKE(plant.state.travel);
    }
}

static laconic_start fast_start(double nu1, double nu2, double nu3, double heading) {
    laconic_start start = start_with(nu1, nu2, nu3);
    start.heading_rad = REAL(heading);
    start.x_m = REAL(-1.7);
    return start;
}

static void take_free_motions(const laconic_method *method) {
    const laconic_input none[3] = {no_input(), no_input(), no_input()};
    const double yaw_rate[5] = {0, 1.3, -9, 40, 600}, step_s[4] = {0.01, 0.1, 0.3, 1.5};
    laconic_vehicle vehicle = three_wheels();
    vehicle.com_x_m = REAL(0.03);
    for (int k = 0; k < 20; k++) {
        const laconic_start start = fast_start(2, -1, yaw_rate[k / 4], 1 - 3 * k);
        take_fast_run(&vehicle, method, step_s[k % 4], &start, none);
    }
}

static void free_motions_by_every_method(void) {
    static const uint64_t bits[] = {
        EITHER(0x4027080ca0fbf9e2U, 0x452a0b5bff23c16bU), EITHER(0x939d130b3310687bU, 0x19902230d2cef855U),
        EITHER(0x6fd9d1520a79d9baU, 0x7831cc55feb2bca0U), EITHER(0xe8968304200b5d0eU, 0x9014a7428a94a2b5U),
        EITHER(0x86d21348e87d7518U, 0x0564208413a12b2fU), EITHER(0x467b26613cf960ceU, 0x748a53ed28040e22U),
        EITHER(0x81ea3005da8cdf9cU, 0x9827feb9f2ab8a4dU), EITHER(0xf06912323e68e030U, 0xcdc828c34c6340aaU),
    };
    expect_by_method(take_free_motions, bits);
}

/* One step each with a yaw from 0.2 to 1.1 rad in steps of 0.4 %, where formulas for small angles give way to
 * others. */
static void take_yaws(const laconic_method *method) {
    const laconic_model model = model_of(three_wheels());
    const laconic_input input = no_input();
    laconic_integrator integrator;
    laconic_real nu3 = REAL(6);
    ASSERT_STATUS(LACONIC_OK, laconic_integrator_prepare(&integrator, method, &model, REAL(0.1), &why));
    for (int k = 0; k < 425; k++) {
        laconic_state state;
        laconic_pose pose;
        const laconic_start start = {{1, 2, k % 2 == 0 ? nu3 : -nu3}, 0, 0, 0, {0}};
        ASSERT_STATUS(LACONIC_OK, laconic_state_set(&state, &model, &start, &why));
        const laconic_real status = REAL(laconic_step(&model, &integrator, &state, &input));
        laconic_pose_of(&pose, &model, &state);
        TAKE(status);
        TAKE(pose);
        TAKE(state.zeta);
        nu3 *= REAL(1.004);
    }
}

static void every_yaw_by_every_method(void) {
    static const uint64_t bits[] = {
        EITHER(0xb3828cdfeecc6a87U, 0x80e9edbf082f51edU), EITHER(0xc97588f06fb53af3U, 0xdfade2e943492012U),
        EITHER(0xcb4962443912d65eU, 0x6374efb8845e29edU), EITHER(0x40aa1d2ad601ff2aU, 0x44e63578bac470edU),
        EITHER(0xb98338b17913e69fU, 0xea2a3fffb22e25cdU), EITHER(0x6680e2356d5b9b3eU, 0x8f66e6b948c76a2eU),
        EITHER(0xf09ea718f68e660fU, 0x3c70c2e7e41d3ee8U), EITHER(0xb3828cdfeecc6a87U, 0x80e9edbf082f51edU),
    };
    expect_by_method(take_yaws, bits);
}

/* Voltages alone; a moment; a force fixed in the body; one fixed in the world, which may turn or act at a point; each
 * with one sample that differs. */
static laconic_input one_kind(int kind, double size) {
    laconic_input input = no_input();
    if (kind == 0) input.voltage_V[0] = REAL(size), input.voltage_V[2] = REAL(2 - size);
    if (kind == 1) input.body_moment_Nm = REAL(0.3 * size);
    if (kind == 2) input.body_force_N[1] = REAL(4 * size);
    if (kind >= 3) input.world_force_N[0] = REAL(3 * size), input.world_force_N[1] = 1;
    if (kind == 4) input.world_force_point_m[0] = REAL(0.2), input.world_force_point_m[1] = REAL(0.1 * size);
    if (kind == 5) input.axle_torque_Nm[1] = REAL(0.2 * size);
    return input;
}

static void take_motions_under_one_force(const laconic_method *method) {
    for (int kind = 0; kind < 6; kind++)
        for (int number = 0; number < MORE_VEHICLES; number += 3) {
            const laconic_vehicle vehicle = vehicle_number(number);
            const laconic_start start = {{0}, 0, 0, REAL(0.5), {0}};
            for (int odd = 0; odd < 3; odd++) {
                const laconic_input samples[3] = {one_kind(kind, odd == 0 ? 2 : 1), one_kind(kind, odd == 1 ? 3 : 1),
                                                  one_kind(kind, odd == 2 ? -1 : 1)};
                take_fast_run(&vehicle, method, odd == 0 ? 0.01 : 0.08, &start, samples);
            }
        }
}

static void motions_under_one_force_by_every_method(void) {
    static const uint64_t bits[] = {
        EITHER(0x5c9a85fa2aee2888U, 0x2e515db6640eaebeU), EITHER(0x86e72418e0f9cc4fU, 0xb7ba3cdeaf256ca7U),
        EITHER(0xb277c6fdd726795bU, 0xbbeb761a5ec4a25fU), EITHER(0x0ade7fcb550cc053U, 0x4123b8fb7684bacbU),
        EITHER(0x8609e0f4f471de5bU, 0x878b408109e811bdU), EITHER(0xc66e069b2519fe98U, 0x8639d702ddecc2ceU),
        EITHER(0x174e1359d74d17bfU, 0x87e438a7852e957bU), EITHER(0xc1f48eeb73924eeeU, 0xa99928515af25594U),
    };
    expect_by_method(take_motions_under_one_force, bits);
}

/* Steps in which damping leaves little of the start, and steps that are refused or taken by another method. */
static void take_long_steps(const laconic_method *method) {
    const double step_s[4] = {0.05, 0.2, 1, 20}, speed[3] = {0, 3, 50};
    for (int number = 0; number < MORE_VEHICLES; number++)
        for (int k = 0; k < 12; k++) {
            laconic_vehicle vehicle = vehicle_number(number);
            laconic_input samples[3] = {every_input(), input_at(k), every_input()};
            laconic_start start = fast_start(0, 0, 0, 0.1);
            if (vehicle.wheel[0].kind != LACONIC_WHEEL_FIXED && number != 4 && number != 6)
                start = fast_start(0.3 * speed[k / 4], 0.1 * speed[k / 4], speed[k / 4], 0.1 - k);
            if (k % 3 == 1) samples[1] = samples[2] = samples[0];
            if (k % 3 == 2) samples[1] = samples[2] = samples[0] = one_kind(k % 2, 1);
            take_fast_run(&vehicle, method, step_s[k % 4], &start, samples);
        }
}

static void long_steps_by_every_method(void) {
    static const uint64_t bits[] = {
        EITHER(0xaf1ed8103bbcf380U, 0xf0e4224ee5093619U), EITHER(0xd090a3c257360a61U, 0x104bc41fcae29809U),
        EITHER(0x6e088eea1cf228c6U, 0x49e2ccff19e252f9U), EITHER(0xd1c11541916d5698U, 0x6b1489e3fa56b799U),
        EITHER(0x000ce3e70dfa0a95U, 0xaeac328f36177976U), EITHER(0x8cd6ecbc0f59a9e5U, 0x4aa76edd0f5cbc00U),
        EITHER(0x5ab06ca42594a4b3U, 0xe653381679c0b06eU), EITHER(0x5933c3aa2da91f3cU, 0xf293f199e9ec8d60U),
    };
    expect_by_method(take_long_steps, bits);
}

/* Another payload, another motor, another step, angles that are set, a start anew. */
static void take_changes(const laconic_method *method) {
    for (int number = 0; number < MORE_VEHICLES; number++) {
        laconic_vehicle vehicle = vehicle_number(number);
        const laconic_input input = input_at(number);
        laconic_start start = start_with(0, 0, 0);
        laconic_real angle[LACONIC_MAX_WHEELS];
        laconic_plant plant;
        laconic_contact contact;
        ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &vehicle, method, REAL(0.003), &start, &why));
        for (int change = 0; change < 6; change++) {
            ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 7, &why));
            for (int i = 0; i < LACONIC_MAX_WHEELS; i++) angle[i] = REAL(0.7 * i - 1);
            if (change == 1) laconic_wheel_angles_set(&plant.model, &plant.state, angle);
            vehicle.payload.mass_kg += REAL(0.5 * (change % 2));
            vehicle.payload.x_m = REAL(0.03);
            vehicle.motor_damping_Nms *= REAL(1.2);
            if (change == 2) ASSERT_STATUS(LACONIC_OK, laconic_plant_set_step(&plant, REAL(0.0017), &why));
            if (change == 4) ASSERT_STATUS(LACONIC_OK, laconic_plant_restart(&plant, &start, &why));
            ASSERT_STATUS(LACONIC_OK, laconic_plant_change(&plant, &vehicle, &why));
            ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&contact, &vehicle, &why));
            take_all(&plant, &contact, NULL, &input);
        }
    }
}

static void changes_by_every_method(void) {
    static const uint64_t bits[] = {
        EITHER(0xcd2710af044c6e7cU, 0xd463a7a18c32ae54U), EITHER(0x5232dde7904d7134U, 0x812fe8e4fd06aad9U),
        EITHER(0xbe57eb28d0524696U, 0x56b09690b88dc7b1U), EITHER(0xbf50ea676d8c7f67U, 0x8b4f4617f6e67757U),
        EITHER(0x8f892df642129f0cU, 0xf4bbf65245f873a0U), EITHER(0x4157d75233a81f13U, 0x7d73f5c4d099fc23U),
        EITHER(0xc2ecfa2ae4576d0eU, 0xcdce281fe645d501U), EITHER(0xcd2710af044c6e7cU, 0xd463a7a18c32ae54U),
    };
    expect_by_method(take_changes, bits);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(motions_by_every_method);
    RUN_TEST(free_motions_by_every_method);
    RUN_TEST(every_yaw_by_every_method);
    RUN_TEST(motions_under_one_force_by_every_method);
    RUN_TEST(long_steps_by_every_method);
    RUN_TEST(changes_by_every_method);
    return UNITY_END();
}
