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
        EITHER(0x5e6d19ec7b760359U, 0x9e90471b0f7a0c26U), EITHER(0xb5730bc5b4ec8833U, 0x35fabf258aa2e999U),
        EITHER(0x50f8c8a4471bd43bU, 0xeb3ae21949d06d76U), EITHER(0x0e4223c959bac127U, 0xefb7e6e8a9350c7fU),
        EITHER(0x84c08eb893597120U, 0xfa934a52705fbd6cU), EITHER(0x64acebb0688e50a1U, 0xb9a1ce6f3752fa46U),
        EITHER(0x9c83dcf17db75d5bU, 0x4c8033b1be747bb9U), EITHER(0x5e6d19ec7b760359U, 0x9e90471b0f7a0c26U),
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
        memset(&out, 0, sizeof out);
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
        EITHER(0x3cabf0d314ba9d9eU, 0x486fc2b32dbf7b8bU), EITHER(0x36b8b8ee6d30a95bU, 0xb5a31fe3d525f1c5U),
        EITHER(0x4a0a5c91c6320c5aU, 0xb807046d41264670U), EITHER(0x78bde5d55cabdeb2U, 0xccaaa02d1adda3a5U),
        EITHER(0x0c463476fd267544U, 0xcf570c9e385180bfU), EITHER(0x48d93080d86d7c32U, 0x99c863c06fd26f72U),
        EITHER(0xcfb159ade3516decU, 0x855f5efdb98fb77dU), EITHER(0xda6d7fb714d70470U, 0x399d8b01dfe083faU),
    };
    expect_by_method(take_free_motions, bits);
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
        EITHER(0xb2f5b2b24cb9c0f4U, 0xdf109075ae464875U), EITHER(0x75fb411b59a7ceb9U, 0xff0a3b0e0365780bU),
        EITHER(0xce7cff30df7c476cU, 0xa315716b53361f0dU), EITHER(0x0c8f078ba944cceaU, 0x0533b2545ad10768U),
        EITHER(0x389a80d247ff39f8U, 0x0760a30bacb3fea3U), EITHER(0xff80d304c8ddb015U, 0x1dcbbad4f5fb3ca1U),
        EITHER(0x55c8ca9ae011ba11U, 0xad02c38a2f5f7a38U), EITHER(0xa985805dc24fc642U, 0x42a125848becb71bU),
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
        EITHER(0x2d227cd21a3b3a78U, 0xf12f9f17886a44b1U), EITHER(0x3481fdd22a54eb75U, 0xc7666bb26f9b86e8U),
        EITHER(0x3b153cf1d816860bU, 0x0861af80c42dbf01U), EITHER(0xc7125dc4fda4e1e1U, 0xd58ff4dbd1ae0a11U),
        EITHER(0xd168de66e8a44a97U, 0xc26593a3a4e56375U), EITHER(0x13ca7a6bf8cd552bU, 0xe5e37b073cbe67cbU),
        EITHER(0x507e7b930eef71beU, 0x6bc88607da9029dfU), EITHER(0xff22e08fd5e9c81bU, 0xbb963da55133de75U),
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
        EITHER(0x408649c5a011d1f2U, 0x7c08ba38dc10a3a6U), EITHER(0x654b6892a1933ad6U, 0x494dfb42cb93fd19U),
        EITHER(0xf5afc87a0b2f69e7U, 0x49f618186b48d364U), EITHER(0x6c6ae493c17ee314U, 0x4a065e3a4a3300b3U),
        EITHER(0xd1d56ed9185a63c8U, 0x8d12238146a154ccU), EITHER(0xc5578ef6007246ecU, 0x6a6b1ce249e925bfU),
        EITHER(0x15bf28ac09ee5e07U, 0x6cbbf5935a4fc4abU), EITHER(0x408649c5a011d1f2U, 0x7c08ba38dc10a3a6U),
    };
    expect_by_method(take_changes, bits);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(motions_by_every_method);
    RUN_TEST(free_motions_by_every_method);
    RUN_TEST(motions_under_one_force_by_every_method);
    RUN_TEST(long_steps_by_every_method);
    RUN_TEST(changes_by_every_method);
    return UNITY_END();
}
