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
        EITHER(0x9d104065797ccc9cU, 0xc2ffb405e747ed0eU), EITHER(0xb0c35a5bfca9dc53U, 0x4ce8a0810ed87ae7U),
        EITHER(0x2f6b7dded678c2bfU, 0x2821382001d0152fU), EITHER(0x6d4b87f2ac5753bfU, 0xc83e8d8037257c7bU),
        EITHER(0x2602cfe174a0bfefU, 0xfbd7e8305349555dU), EITHER(0x0c3687500ecffb74U, 0xc0bbb546e513c2ceU),
        EITHER(0x9ca569344c0a1833U, 0xfb732d4477c270bbU), EITHER(0x171b44c9531ee0aaU, 0x8fd56a4e56d438c4U),
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
        EITHER(0xc453fae64bdd9128U, 0x63a9d4f03dbf6bc9U), EITHER(0x0e2766e500fcbeddU, 0x987067ee4b3182b9U),
        EITHER(0x22333f9c159a4d32U, 0xbcaa57be5e78dc69U), EITHER(0x84b2d89310da5510U, 0xafcfcbfe506d6669U),
        EITHER(0x0adbf1a717336871U, 0xf658c4cb1dd01ad6U), EITHER(0x5c00a81c33c66ad9U, 0x7e14a4a184ae9ee0U),
        EITHER(0x1b19cfc3bdb343cfU, 0xe047ee9c9d31948eU), EITHER(0x77d1639b1c494d04U, 0xe6c754d0ae953d50U),
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
    RUN_TEST(motions_under_one_force_by_every_method);
    RUN_TEST(long_steps_by_every_method);
    RUN_TEST(changes_by_every_method);
    return UNITY_END();
}
