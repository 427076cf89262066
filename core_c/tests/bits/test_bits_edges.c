/* Tests that what happens exactly at an edge between two ways to compute is, bit for bit, as in the version before:
 * numbers are chosen so that nothing is rounded before the comparison. Either side of an edge is right, but hosts and
 * boards must take the same. */
#include "friction.h" /* first, since its internals shadow names of the others */

#include "bits.h"
#include "laconic/derivatives.h"

/* --------------------------------------------------------------------------- rotation of a free body -- */

/* M = 1 kg, R = ½ m and I_S = M R², so that all constants are powers of two: ν is ζ, the yaw rate ν3. */
static laconic_vehicle body_of_round_numbers(void) {
    laconic_vehicle v = bare_body();
    v.mass_kg = 1;
    v.wheel_radius_m = REAL(0.5);
    v.yaw_inertia_kgm2 = REAL(0.25);
    return v;
}

static void take_jacobian_by_nu(const laconic_plant *plant, const laconic_input *held) {
    laconic_step_jacobian j;
    memset(&j, 0, sizeof j);
    if (laconic_step_jacobian_of(&j, &plant->model, &plant->integrator, &plant->state, held, true) != LACONIC_OK)
        return;
    TAKE(j.by_nu);
    TAKE(j.by_heading);
    TAKE(j.by_body_force);
    TAKE(j.by_world_force);
}

/* Yaws of k/64 and of k/4 in a step. */
static void take_yaws_of_round_numbers(const laconic_method *method) {
    for (int k = -80; k <= 80; k++)
        for (int coarse = 0; coarse < 2; coarse++) {
            const laconic_vehicle vehicle = body_of_round_numbers();
            const laconic_start start = {{2, -1, REAL(k) / (coarse ? 1 : 16)}, 0, 0, 0, {0}};
            laconic_input held = no_input();
            laconic_plant plant;
            laconic_contact contact;
            ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&contact, &vehicle, &why));
            held.body_force_N[0] = 1;
            held.world_force_N[1] = REAL(coarse ? 0 : 0.5);
            ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &vehicle, method, REAL(0.25), &start, &why));
            take_jacobian_by_nu(&plant, &held);
            if (laconic_plant_run(&plant, &held, 1, &why) != LACONIC_OK) continue;
            take_all(&plant, &contact, NULL, &held);
        }
}

static void yaws_of_round_numbers_by_every_method(void) {
    static const uint64_t bits[] = {
        EITHER(0x057caa6cc35c00dbU, 0xc85b9ef9a12063d9U), EITHER(0x33690320164b9275U, 0x9f6e2ffad888ee49U),
        EITHER(0xbad024c47a5ea395U, 0xab32909cacdb0ceeU), EITHER(0xf584da37f7c62b29U, 0xd2b864a636d5c516U),
        EITHER(0x1991570e67505389U, 0xd846633239dda797U), EITHER(0x76ab858ede5bdbb3U, 0xf80465ab21693c35U),
        EITHER(0xa60722658439f6f5U, 0x7a3415d8cfe66434U), EITHER(0xbab461522f3ca337U, 0x6c0449694ae2116eU),
    };
    expect_by_method(take_yaws_of_round_numbers, bits);
}

/* Wheels whose columns are equally long: the axes turn by 45°, to one side or the other. */
static void axes_that_turn_by_half_a_right_angle(void) {
    begin();
    for (int k = 0; k < 16; k++) {
        laconic_vehicle vehicle = body_of_round_numbers();
        laconic_model model;
        vehicle.wheel_inertia_kgm2 = REAL(k % 4 < 2 ? 0.25 : 0);
        vehicle.motor_damping_Nms = REAL(0.5);
        add_wheel(&vehicle, LACONIC_WHEEL_ROLLER, k % 2 == 0 ? 0.5 : -0.5, 0, k / 8 == 0 ? 0 : QUARTER_TURN,
                  QUARTER_TURN);
        if (k / 4 % 2 == 1) add_wheel(&vehicle, LACONIC_WHEEL_ROLLER, 0, 0, QUARTER_TURN, QUARTER_TURN);
        ASSERT_STATUS(LACONIC_OK, laconic_prepare(&model, &vehicle, &why));
        TAKE(model.nu_of_zeta);
        TAKE(model.wheel_of_zeta);
        TAKE(model.inertia);
        TAKE(model.decay_per_s);
    }
    expect(EITHER(0x3d6a414cb038df3bU, 0xcc0cd2b73fed957bU));
}

/* Two locked wheels, and one that is fixed and locked, beside others. */
static void vehicles_with_several_brakes(void) {
    begin();
    for (int k = 0; k < 4; k++) {
        laconic_vehicle vehicle = k < 2 ? three_wheels() : caster();
        vehicle.support_count = 1;
        vehicle.friction_coefficient = REAL(0.5);
        vehicle.com_z_m = REAL(0.1);
        if (k >= 2) add_wheel(&vehicle, LACONIC_WHEEL_ROLLER, 0.2, 0.1, 0.3, 1.1);
        vehicle.wheel[0].locked = k != 3;
        vehicle.wheel[k == 0 ? 1 : vehicle.wheel_count - 1].locked = k != 2;
        take_run(&vehicle, &laconic_auto, 0.01, 20);
    }
    expect(EITHER(0x8c5a34f504b5f7bdU, 0x52fa5732c8fe8103U));
}

/* -------------------------------------------------------------------------------- the friction solver -- */

/* Row 1 along x, row 2 along y, a rim and an inertia of 1: no number of it is rounded. */
static void put_round_wheel(problem *p, double x, double y, double drag) {
    friction_wheel *w = &p->wheel[p->count++];
    memset(w, 0, sizeof *w);
    w->along[0] = w->across[1] = 1;
    w->along[2] = REAL(-y);
    w->across[2] = REAL(x);
    w->rim_along = w->inertia = 1;
    w->drag = REAL(drag);
    laconic_friction_prepare(w);
}

static void put_round_load(problem *p, double grip, double drive) {
    friction_load *l = &p->load[p->count - 1];
    l->grip = REAL(grip);
    l->drive = REAL(drive);
    l->drive_slope = 2;
    l->drive_limit = REAL(0.25);
}

static void take_solution(problem *p) {
    const laconic_real passes = REAL(solve(p));
    TAKE(passes);
    if (passes == 0) return; /* then they mean nothing */
    TAKE(p->nu);
    TAKE(p->speed);
    TAKE(p->impulse);
}

/* Impulses just at the grip, within and without slip; a motor just at its limit; a guess that is just not too large. */
static void contacts_at_the_border_of_what_they_hold(void) {
    begin();
    for (int k = 0; k < 320; k++) {
        problem p;
        memset(&p, 0, sizeof p);
        for (int i = 0; i < 1 + k % 4; i++) {
            put_round_wheel(&p, i % 2 == 0 ? 1 : -1, i < 2 ? 0.5 : -0.5, k / 4 % 2);
            put_round_load(&p, k % 3 == 0 ? 0.5 : 2, 0.125 * (k / 8 % 5 - 2));
            p.impulse[i][k / 40 % 2] = k / 80 < 2 ? p.load[i].grip : EITHER(REAL(1e4), 100);
            p.load[i].free_speed = REAL(k / 16 % 3 - 1) * (k / 80 < 2 ? p.load[i].grip : 1);
        }
        p.free[0] = REAL(k / 80 % 2);
        p.free[1] = REAL(0.5 * (k / 20 % 3));
        p.free[2] = REAL(0.25 * (k / 10 % 2));
        take_solution(&p);
    }
    expect(EITHER(0xa4a9f05dbf0f64dfU, 0xabdc37cbe80d7d30U));
}

/* Directions without a sine of the host's library: legs of right triangles. */
static const laconic_real direction_of[6][2] = {{1, 0},
                                                {0, 1},
                                                {REAL(0.6), REAL(0.8)},
                                                {REAL(-0.8), REAL(0.6)},
                                                {REAL(0.28), REAL(-0.96)},
                                                {REAL(-0.96), REAL(-0.28)}};

/* From 1 to `count`: decades, so that 1 of them is usual and the others are far off. */
static laconic_real power(uint32_t *at, int count) {
    laconic_real number = 1;
    *at = *at * 1664525U + 1013904223U;
    for (uint32_t k = (*at >> 16) % (uint32_t)count; k > 0; k--) number /= 8;
    return number * (1 + REAL(*at >> 8) / 16777216);
}

static void put_any_wheel(problem *p, uint32_t *at) {
    friction_wheel *w = &p->wheel[p->count];
    friction_load *l = &p->load[p->count++];
    const laconic_real *u = direction_of[(*at >> 9) % 6], *r = direction_of[(*at >> 13) % 6];
    const laconic_real x = power(at, 3) - power(at, 3), y = power(at, 3) - power(at, 3);
    memset(w, 0, sizeof *w);
    w->along[0] = u[0];
    w->along[1] = u[1];
    w->along[2] = x * u[1] - y * u[0];
    w->across[0] = -u[1];
    w->across[1] = u[0];
    w->across[2] = x * u[0] + y * u[1];
    w->rim_along = r[0] > 0 ? r[0] : 1;
    w->rim_across = r[0] > 0 ? r[1] : 0;
    w->inertia = power(at, 10);
    w->drag = *at % 3 == 0 ? 0 : power(at, 20);
    laconic_friction_prepare(w);
    l->grip = *at % 7 == 0 ? LACONIC_REAL_MAX : power(at, 10);
    l->axle = *at % 2 == 0 ? 0 : power(at, 10);
    l->drive = power(at, 5) - power(at, 5);
    l->drive_slope = *at % 3 == 1 ? 0 : power(at, 6);
    l->drive_limit = *at % 2 == 1 ? LACONIC_REAL_MAX : power(at, 5);
    l->viscous = *at % 5 < 2 ? 0 : power(at, 6);
    l->free_speed = power(at, 5) - power(at, 5);
}

/* Contacts that hold each other, light wheels, guesses far off: some need passes of every kind, and a few more than
 * there are. */
static void contacts_of_every_kind_solved_from_any_guess(void) {
    uint32_t at = 11;
    begin();
    for (int n = 0; n < 1500; n++) {
        problem p;
        memset(&p, 0, sizeof p);
        for (int i = 0; i < 1 + n % 16; i++) put_any_wheel(&p, &at);
        for (int m = 0; m < 3; m++) p.free[m] = power(&at, 6) - power(&at, 6);
        for (int i = 0; i < p.count; i++)
            for (int m = 0; m < 2; m++)
                p.impulse[i][m] = n % 3 == 0 ? 0 : (power(&at, 4) - power(&at, 4)) * REAL(n % 500);
        take_solution(&p);
        if (!isfinite((double)p.nu[0])) continue;
        for (int m = 0; m < 3; m++) p.free[m] = p.nu[m]; /* and on from there, with little that changes */
        take_solution(&p);
    }
    expect(EITHER(0x931e0d913c4ef66cU, 0x41199441aebe89a1U));
}

/* ------------------------------------------------------------------- the ends of the range of a vehicle -- */

static const size_t numbers[] = {
    offsetof(laconic_vehicle, mass_kg),
    offsetof(laconic_vehicle, yaw_inertia_kgm2),
    offsetof(laconic_vehicle, com_x_m),
    offsetof(laconic_vehicle, com_y_m),
    offsetof(laconic_vehicle, com_z_m),
    offsetof(laconic_vehicle, wheel_radius_m),
    offsetof(laconic_vehicle, wheel_inertia_kgm2),
    offsetof(laconic_vehicle, motor_gain_Nm_per_V),
    offsetof(laconic_vehicle, motor_damping_Nms),
    offsetof(laconic_vehicle, friction_coefficient),
    offsetof(laconic_vehicle, wheel[0].x_m),
    offsetof(laconic_vehicle, wheel[1].y_m),
    offsetof(laconic_vehicle, wheel[1].own_inertia_kgm2),
    offsetof(laconic_vehicle, wheel[1].own_motor_gain_Nm_per_V),
    offsetof(laconic_vehicle, wheel[1].own_motor_damping_Nms),
    offsetof(laconic_vehicle, support[0].x_m),
    offsetof(laconic_vehicle, drive.supply_V),
    offsetof(laconic_vehicle, drive.supply_resistance_ohm),
    offsetof(laconic_vehicle, drive.winding_resistance_ohm),
};
#define NUMBERS (sizeof numbers / sizeof numbers[0])

static laconic_real number_of(const laconic_vehicle *vehicle, size_t which) {
    laconic_real number;
    memcpy(&number, (const unsigned char *)vehicle + numbers[which], sizeof number);
    return number;
}

static laconic_vehicle with_number(laconic_vehicle vehicle, size_t which, laconic_real number) {
    memcpy((unsigned char *)&vehicle + numbers[which], &number, sizeof number);
    return vehicle;
}

typedef bool (*taken_by)(const laconic_vehicle *vehicle);

static bool taken_by_prepare(const laconic_vehicle *vehicle) {
    laconic_model model;
    return laconic_prepare(&model, vehicle, NULL) == LACONIC_OK;
}

static bool taken_by_contact(const laconic_vehicle *vehicle) {
    laconic_contact contact;
    return laconic_contact_prepare(&contact, vehicle, NULL) == LACONIC_OK;
}

static bool taken_by_friction(const laconic_vehicle *vehicle) {
    laconic_model model;
    laconic_friction friction;
    return laconic_prepare(&model, vehicle, NULL) == LACONIC_OK &&
           laconic_friction_of(&friction, &model, vehicle, NULL) == LACONIC_OK;
}

/* The last number that is taken, to a hundredth of it, of those ever larger or ever smaller. */
static laconic_real border_of(taken_by taken, const laconic_vehicle *vehicle, size_t which, bool upwards) {
    laconic_real number = number_of(vehicle, which), factor = EITHER(REAL(0x1p64), REAL(0x1p16));
    if (number == 0) number = 1;
    for (int k = 0; k < EITHER(12, 10); k++) {
        const laconic_real by = upwards ? factor : 1 / factor;
        for (int times = 0; times < 20; times++) {
            const laconic_vehicle other = with_number(*vehicle, which, number * by);
            if (number * by == 0 || !taken(&other)) break;
            number *= by;
        }
        const int left = EITHER(6, 4) - k - 1; /* 2⁶⁴, 2³², … 2, then 1 + ½, 1 + ¼, … */
        factor = left >= 0 ? REAL(ldexp(1, 1 << left)) : 1 + REAL(ldexp(1, left));
    }
    return number;
}

/* Beside each other number that is itself within a factor of three of its own border. */
static void take_borders(taken_by taken, laconic_vehicle vehicle) {
    vehicle.support_count = 1;
    for (size_t k = 0; k < 2 * NUMBERS; k++) {
        const laconic_real near = border_of(taken, &vehicle, k / 2, k % 2 == 0) * (k % 2 == 0 ? REAL(0.4) : REAL(2.5));
        const laconic_vehicle beside = with_number(vehicle, k / 2, near);
        for (size_t other = k / 2 * 2 + 2; other < 2 * NUMBERS && taken(&beside); other++) {
            const laconic_real border = border_of(taken, &beside, other / 2, other % 2 == 0);
            TAKE(border);
        }
    }
}

/* Where a wheel has inertia, others are refused before they leave the range: their condition number is too large. */
static laconic_vehicle without_wheel_inertia(void) {
    laconic_vehicle v = vehicle_number(0);
    v.wheel_inertia_kgm2 = 0;
    return v;
}

static void borders_of_models(void) {
    begin();
    take_borders(taken_by_prepare, without_wheel_inertia());
    take_borders(taken_by_prepare, vehicle_number(1));
    take_borders(taken_by_prepare, vehicle_number(0));
    expect(EITHER(0xde3d7e5af4b32505U, 0xd4bcaa67544cddf2U));
}

/* On one spot it may only turn: nothing of it is gyroscopic. */
static laconic_vehicle turning_on_a_spot(void) {
    laconic_vehicle v = bare_body();
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0, 0, 0, 0);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0, 0.2, 0, 0);
    v.wheel[0].locked = true;
    v.wheel_inertia_kgm2 = 0;
    return v;
}

static void borders_of_a_model_that_only_turns(void) {
    begin();
    take_borders(taken_by_prepare, turning_on_a_spot());
    expect(EITHER(0x222f9673cff9c765U, 0xf35a73efca950b43U));
}

static void borders_of_contacts(void) {
    begin();
    take_borders(taken_by_contact, vehicle_number(2));
    expect(EITHER(0x1dfd44410ffddaa9U, 0xa07c68f66c0e7da1U));
}

/* The same robot in another unit of length: arms and normal loads leave the range together. */
static laconic_vehicle in_length(laconic_vehicle v, laconic_real length) {
    v.yaw_inertia_kgm2 *= length * length;
    v.wheel_inertia_kgm2 *= length * length;
    v.wheel_radius_m *= length;
    v.com_x_m *= length;
    v.com_y_m *= length;
    v.com_z_m *= length;
    v.mass_kg /= length; /* so that torques keep their size beside those of inertia */
    for (int i = 0; i < v.wheel_count; i++) {
        v.wheel[i].x_m *= length;
        v.wheel[i].y_m *= length;
    }
    for (int i = 0; i < v.support_count; i++) {
        v.support[i].x_m *= length;
        v.support[i].y_m *= length;
    }
    return v;
}

/* Each length that a factor of 1.07 after the other leads to, towards both ends of the range. */
static void borders_of_lengths(void) {
    static const taken_by taken[3] = {taken_by_prepare, taken_by_contact, taken_by_friction};
    begin();
    for (int number = 0; number < 5; number++)
        for (int upwards = 0; upwards < 2; upwards++) {
            const laconic_vehicle vehicle = number < 4 ? vehicle_number(number) : slipping_vehicle(2);
            laconic_real length = 1;
            int counts[3] = {0, 0, 0};
            for (int k = 0; k < EITHER(6000, 800); k++, length *= upwards ? REAL(1.0625) : REAL(0.9375)) {
                const laconic_vehicle other = in_length(vehicle, length);
                if (length == 0 || !isfinite((double)length)) break;
                for (int which = number < 4 ? 0 : 2; which < (number < 4 ? 2 : 3); which++)
                    counts[which] += taken[which](&other);
            }
            const laconic_real told[3] = {REAL(counts[0]), REAL(counts[1]), REAL(counts[2])};
            TAKE(told);
        }
    expect(EITHER(0x19122fea8b271b08U, 0x716bcd43a7e0a0ddU));
}

static void borders_of_friction(void) {
    begin();
    take_borders(taken_by_friction, slipping_vehicle(2));
    expect(EITHER(0xded3edfab43dd343U, 0x0b4b34be714c0e0dU));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(yaws_of_round_numbers_by_every_method);
    RUN_TEST(axes_that_turn_by_half_a_right_angle);
    RUN_TEST(vehicles_with_several_brakes);
    RUN_TEST(contacts_of_every_kind_solved_from_any_guess);
    RUN_TEST(contacts_at_the_border_of_what_they_hold);
    RUN_TEST(borders_of_models);
    RUN_TEST(borders_of_a_model_that_only_turns);
    RUN_TEST(borders_of_contacts);
    RUN_TEST(borders_of_lengths);
    RUN_TEST(borders_of_friction);
    return UNITY_END();
}
