/* Tests of friction.c: constants of vehicles with friction at the ends of the scalar type's range, and beyond. */
#include "friction_vehicle.h"

#include "slipping.h"

/* Beyond it the square of a sum of sizes leaves the range. */
#define LIMIT EITHER(1.34078e154, 1.84467e19)
#define PART (0.6 * LIMIT) /* one of these fits, two do not */

/* M R², by which torques are divided. */
#define ENERGY_J 0.01

/* One wheel of 1 m under a body of 0.01 kg and 0.01 kg m²: each constant is 0, or near to 1. */
static laconic_vehicle unit_vehicle(void) {
    laconic_vehicle v = {0};
    v.mass_kg = v.yaw_inertia_kgm2 = v.wheel_inertia_kgm2 = v.motor_gain_Nm_per_V = REAL(ENERGY_J);
    v.wheel_radius_m = 1;
    add_wheel(&v, LACONIC_WHEEL_ROLLER, 0, 0, 0, PI / 2);
    v.ground.friction_coefficient = REAL(0.5);
    v.ground.roller_drag = REAL(0.5);
    v.drive.supply_V = 1;
    v.drive.winding_resistance_ohm = 1;
    return v;
}

static laconic_status status_of(const laconic_vehicle *v) {
    const laconic_model model = model_of(*v);
    laconic_friction f;
    return laconic_friction_of(&f, &model, v, &why);
}

/* With one constant of some size: alone it fits, beside a second one of this size it does not. */
static void counts(laconic_vehicle v) {
    ASSERT_STATUS(LACONIC_OK, status_of(&v));
    v.com_z_m = REAL(PART);
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, status_of(&v), why);
}

static void each_constant_of_ground_and_supply_counts_in_the_range(void) {
    laconic_vehicle v = unit_vehicle();
    v.com_z_m = REAL(PART);
    ASSERT_STATUS(LACONIC_OK, status_of(&v));
    v = unit_vehicle(), v.drive.supply_V = REAL(PART), counts(v);
    v = unit_vehicle(), v.drive.supply_resistance_ohm = REAL(PART), counts(v);
    v = unit_vehicle(), v.drive.winding_resistance_ohm = REAL(PART), counts(v);
    v = unit_vehicle(), v.ground.friction_coefficient = REAL(PART), counts(v);
    v = unit_vehicle(), v.ground.axle_friction_Nm = REAL(ENERGY_J * PART), counts(v);
    v = unit_vehicle(), v.support_count = 1, v.support[0].x_m = REAL(PART), counts(v);
    v = unit_vehicle(), v.mass_kg = v.yaw_inertia_kgm2 = v.wheel_inertia_kgm2 = REAL(PART / 10); /* the weight */
    v.motor_gain_Nm_per_V = v.mass_kg, counts(v);
}

static void each_constant_of_motor_and_wheel_counts_in_the_range(void) {
    laconic_vehicle v = unit_vehicle();
    v = unit_vehicle(), v.motor_gain_Nm_per_V = REAL(ENERGY_J * PART), counts(v);
    v = unit_vehicle(), v.motor_gain_Nm_per_V = REAL(ENERGY_J / PART), counts(v);  /* amperes per torque */
    v = unit_vehicle(), v.motor_gain_Nm_per_V = REAL(-ENERGY_J * PART), counts(v); /* a shaft that turns backwards */
    v = unit_vehicle(), v.motor_gain_Nm_per_V = REAL(-ENERGY_J / PART), counts(v);
    v = unit_vehicle(), v.motor_damping_Nms = REAL(ENERGY_J * PART), counts(v); /* back-EMF */
    v = unit_vehicle(), v.motor_damping_Nms = v.drive.viscous_friction_Nms = REAL(ENERGY_J * PART), counts(v);
    v = unit_vehicle(), v.wheel_inertia_kgm2 = REAL(ENERGY_J * PART), counts(v);
    v = unit_vehicle(), v.wheel_inertia_kgm2 = REAL(ENERGY_J * 2 / PART), counts(v); /* 1/j, and as much mobility */
}

/* 1/k² twice: what an impulse across the rollers moves, with the wheel held and with a wheel that rolls. */
static void rollers_that_hardly_drag_count_in_the_range_once_for_each_of_two_masses(void) {
    laconic_vehicle v = unit_vehicle();
    v.ground.roller_drag = REAL(1 / sqrt(0.3 * LIMIT));
    counts(v);
    v.com_z_m = REAL(0.3 * LIMIT);
    ASSERT_STATUS(LACONIC_OK, status_of(&v));
}

/* Beside a lever of 3, which makes the mass along the rollers' axis a tenth, the two masses count as they are. */
static void masses_across_rollers_count_in_the_range_whatever_the_mass_along_them(void) {
    laconic_vehicle v = unit_vehicle();
    v.wheel[0].x_m = 3;
    v.ground.roller_drag = REAL(1 / sqrt(0.3 * LIMIT));
    ASSERT_STATUS(LACONIC_OK, status_of(&v));
    v.com_z_m = REAL(PART);
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, status_of(&v), why);
}

/* A light and huge wheel: mobility and inertia each as large as its radius, over the vehicle's. */
static void a_huge_wheel_counts_in_the_range(void) {
    laconic_vehicle v = unit_vehicle();
    v.wheel[0].own_radius_m = REAL(0.32 * LIMIT);
    v.wheel_inertia_kgm2 = REAL(ENERGY_J * 0.32 * LIMIT);
    ASSERT_STATUS(LACONIC_OK, status_of(&v));
    v.wheel[0].own_radius_m = REAL(0.35 * LIMIT);
    v.wheel_inertia_kgm2 = REAL(ENERGY_J * 0.35 * LIMIT);
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, status_of(&v), why);
}

/* A wheel far along its own roller's axis, on free rollers: its lever across counts beside its place. */
static void a_wheel_far_off_counts_by_its_place_and_by_its_lever(void) {
    laconic_vehicle v = unit_vehicle();
    v.ground.roller_drag = 0;
    v.wheel[0].kind = LACONIC_WHEEL_ROLLER;
    v.wheel[0].x_m = REAL(0.4 * LIMIT);
    v.wheel[0].axle_rad = REAL(-PI / 2);
    ASSERT_STATUS(LACONIC_OK, status_of(&v));
    v.wheel[0].x_m = REAL(0.6 * LIMIT);
    ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, status_of(&v), why);
}

/* Normal loads of points that are hardly apart, wheels or supports: newtons for each newton metre. */
static void points_that_are_hardly_apart_count_in_the_range(void) {
    const double small = EITHER(1e-150, 1e-16), apart = EITHER(1e-152, 1e-18);
    for (int wheels = 1; wheels <= 3; wheels++) {
        laconic_vehicle v = unit_vehicle();
        v.mass_kg = REAL(1 / small);
        v.wheel_radius_m = v.wheel_inertia_kgm2 = v.yaw_inertia_kgm2 = REAL(small);
        v.wheel_count = 0;
        for (int i = 0; i < 3; i++) {
            const double x = apart * cos(2 * PI * i / 3), y = apart * sin(2 * PI * i / 3);
            if (i < wheels) {
                add_wheel(&v, LACONIC_WHEEL_ROLLER, x, y, 0, PI / 2);
            } else {
                v.support[v.support_count].x_m = REAL(x);
                v.support[v.support_count++].y_m = REAL(y);
            }
        }
        const laconic_model model = model_of(v);
        laconic_friction f;
        ASSERT_STATUS(LACONIC_OK, laconic_friction_of(&f, &model, &v, &why));
        double sum = 0;
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) sum += fabs((double)f.normal_load_of_wrench[i][k]);
        v.com_z_m = REAL(LIMIT - 0.5 * sum);
        ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, status_of(&v), why);
        v.com_z_m = REAL(LIMIT - 3 * sum);
        ASSERT_STATUS(LACONIC_OK, status_of(&v));
    }
}

static laconic_status start_with_wheel(int wheel, laconic_real speed, laconic_real nu) {
    laconic_start start = start_with((double)nu, 0, 0);
    const laconic_vehicle v = unit_vehicle();
    laconic_plant plant;
    start.wheel_speed_rad_per_s[wheel] = speed;
    return laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why);
}

/* At the end of the range of speeds a wheel still starts, given or rolling, beyond it not. */
static void wheels_start_up_to_the_end_of_the_range_of_speeds(void) {
    const laconic_real beyond = LARGEST_SPEED * (1 + 4 * LACONIC_EPSILON);
    for (int sign = -1; sign <= 1; sign += 2) {
        const laconic_real s = REAL(sign);
        ASSERT_STATUS(LACONIC_OK, start_with_wheel(0, s * LARGEST_SPEED, 0));
        ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_START_WHEEL_SPEED, 1, start_with_wheel(0, s * beyond, 0), why);
    }
    ASSERT_STATUS(LACONIC_OK, start_with_wheel(0, 0, LARGEST_SPEED));
    ASSERT_REFUSED(LACONIC_NOT_FINITE, LACONIC_FIELD_START_WHEEL_SPEED, 1, start_with_wheel(0, NOT_A_NUMBER, 0), why);
}

/* Speeds of wheels that it has not are not given. */
static void a_speed_beyond_the_last_wheel_is_not_read(void) {
    laconic_start start = start_with(3, 1, 2);
    laconic_vehicle v = robotino(0.5, 0, 0);
    laconic_plant plant;
    v.support_count = 1;
    const laconic_plant rolling = started(v, 1e-3, 3, 1, 2);
    start.wheel_speed_rad_per_s[3] = 7;
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why));
    ASSERT_NEAR_ALL(0, rolling.slip.wheel_speed_rad_per_s, plant.slip.wheel_speed_rad_per_s, 3);
    TEST_ASSERT_TRUE(plant.slip.wheel_speed_rad_per_s[3] == 0);
}

static void wheels_that_are_taken_over_are_those_that_there_are(void) {
    laconic_vehicle v = robotino(0.5, 0, 0);
    v.support_count = 1;
    const laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    const laconic_real speed[4] = {1, 2, 3, 4}, angle_rad[4] = {5, 6, 7, 8};
    laconic_slip slip;
    laconic_slip_take_over(&slip, &plant.friction, speed, angle_rad);
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_TRUE(slip.wheel_speed_rad_per_s[i] == (i < 3 ? speed[i] : 0));
        TEST_ASSERT_TRUE(slip.wheel_angle_rad[i].value == (i < 3 ? angle_rad[i] : 0));
    }
}

/* However high the body: nothing pushes it yet. */
static void wheels_start_with_equal_shares_of_the_weight(void) {
    laconic_vehicle v = robotino(0.5, 0, 0);
    v.com_z_m = 1;
    const laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    for (int i = 0; i < 3; i++)
        ASSERT_NEAR(EITHER(1e-12, 1e-4), 20 * LACONIC_GRAVITY_M_PER_S2 / 3, plant.slip.normal_N[i]);
}

/* Over M R²: a motor that gives 1 for 1 ampere has its limit as any other. */
static void a_motor_of_one_ampere_for_a_unit_of_torque_is_limited(void) {
    laconic_vehicle v = unit_vehicle();
    v.drive.current_limit_A = 3;
    const laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    TEST_ASSERT_TRUE(plant.friction.axle[0].torque_limit == 3);
    TEST_ASSERT_TRUE(plant.friction.axle[0].ampere == 1);
}

static void of_windings_that_are_not_known_no_current_is_either(void) {
    laconic_vehicle v = unit_vehicle();
    laconic_input input = no_input();
    v.drive.winding_resistance_ohm = v.drive.supply_V = 0;
    laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    input.voltage_V[0] = 2;
    run(&plant, &input, 1);
    TEST_ASSERT_TRUE(plant.friction.axle[0].ampere == 0);
    TEST_ASSERT_TRUE(plant.slip.current_A[0] == 0 && plant.slip.wheel_speed_rad_per_s[0] != 0);
}

/* It takes no current, whatever it brakes. */
static void a_motor_without_a_gain_is_a_damper_that_no_current_limits(void) {
    const laconic_input coasting = no_input();
    laconic_vehicle v = unit_vehicle();
    v.motor_gain_Nm_per_V = 0;
    v.motor_damping_Nms = 1;
    v.drive.current_limit_A = REAL(1e-3);
    laconic_plant plant = started(v, 1e-3, 5, 0, 0);
    run(&plant, &coasting, 1000);
    TEST_ASSERT_TRUE(plant.friction.axle[0].torque_limit == LACONIC_REAL_MAX);
    ASSERT_NEAR(EITHER(1e-6, 1e-4), 0, plant.slip.wheel_speed_rad_per_s[0]);
}

/* A limit of the current makes it a vehicle with friction, though its wheels do not slip. */
static void wheels_that_allow_no_motion_on_ideal_ground_are_refused(void) {
    laconic_vehicle v = unit_vehicle();
    v.ground.friction_coefficient = v.ground.roller_drag = 0;
    ASSERT_STATUS(LACONIC_OK, status_of(&v));
    v.wheel_count = 0;
    for (int i = 0; i < 3; i++) add_wheel(&v, LACONIC_WHEEL_FIXED, i, i * i, i, 0);
    ASSERT_REFUSED(LACONIC_NOTHING_MOVES, LACONIC_FIELD_WHEEL_KIND, 3, status_of(&v), why);
}

/* Then nothing of it is left for the motor's own voltage. */
static void friction_of_motor_and_gears_is_at_most_the_whole_damping(void) {
    laconic_vehicle v = with_drive(robotino(0.4, 0, 0));
    v.drive.viscous_friction_Nms = 3;
    const laconic_plant plant = started(v, 1e-3, 0, 0, 0);
    ASSERT_NEAR(EITHER(1e-12, 1e-5), 0.26 / (20 * 0.04 * 0.04), plant.friction.axle[1].viscous);
    TEST_ASSERT_TRUE(plant.friction.axle[1].back_emf == 0);
}

/* A caster beyond the wheels carries its part; with the centre of mass on the other side of them it lifts off. */
static void supports_start_with_the_loads_that_they_have_after_a_step(void) {
    const laconic_input coasting = no_input();
    for (int lifts = 0; lifts < 2; lifts++) {
        laconic_vehicle v = robotino(0.5, 0, 0);
        v.com_x_m = REAL(lifts ? -0.5 : 0.1);
        v.support_count = 1;
        v.support[0].x_m = REAL(0.4);
        laconic_plant plant = started(v, 1e-3, 0, 0, 0);
        const laconic_slip start = plant.slip;
        double weight = 0, moment = 0;
        for (int i = 0; i < 4; i++) {
            weight += (double)start.normal_N[i];
            moment += (double)(start.normal_N[i] * ((i < 3 ? v.wheel[i].x_m : v.support[0].x_m) - v.com_x_m));
        }
        TEST_ASSERT_TRUE(lifts ? start.normal_N[3] < 0 : start.normal_N[3] > 0);
        if (!lifts) ASSERT_NEAR(EITHER(1e-9, 1e-3), 20 * LACONIC_GRAVITY_M_PER_S2, weight);
        if (!lifts) ASSERT_NEAR(EITHER(1e-9, 1e-3), 0, moment);
        run(&plant, &coasting, 1);
        ASSERT_NEAR_ALL(EITHER(1e-9, 1e-3), start.normal_N, plant.slip.normal_N, 4);
    }
}

/* A small wheel beside the vehicle's others turns faster than the body. */
static void the_speed_at_which_a_wheel_would_roll_is_refused_with_its_sign(void) {
    for (int sign = -1; sign <= 1; sign += 2) {
        const laconic_start start = start_with(0, sign * 0.25 * (double)LARGEST_SPEED, 0);
        laconic_vehicle v = unit_vehicle();
        laconic_plant plant;
        v.wheel[0].own_radius_m = REAL(0.125);
        ASSERT_REFUSED(LACONIC_OVERFLOW, LACONIC_FIELD_START_WHEEL_SPEED, 1,
                       laconic_plant_start(&plant, &v, &laconic_auto, REAL(1e-3), &start, &why), why);
        ASSERT_NEAR(1e-6, 2 * sign, why.value / LARGEST_SPEED);
    }
}

/* So light that a wheel's constants leave the range where those of the vehicle do not. */
#define UNIT REAL(EITHER(0x1p-60, 0x1p-30)) /* M R² */
#define RANGE REAL(EITHER(0x1p512, 0x1p64)) /* whose square is the first beyond the range */
#define PLACE REAL(EITHER(0x1p459, 0x1p40)) /* the last place of the number below it */

static laconic_vehicle light_unicycle(void) {
    laconic_vehicle v = bare_body();
    v.mass_kg = v.yaw_inertia_kgm2 = v.wheel_inertia_kgm2 = UNIT;
    v.wheel_radius_m = 1;
    v.ground.friction_coefficient = REAL(0.5);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0, 0, 0, 0);
    return v;
}

/* Half a place that comes before three quarters of one is lost, behind them it is not. */
static void constants_of_an_axle_add_up_in_their_order_to_the_end_of_the_range(void) {
    for (int last = 0; last < 4; last++) {
        laconic_vehicle v = light_unicycle();
        v.motor_gain_Nm_per_V = (RANGE - 2 * PLACE) * UNIT;
        v.motor_damping_Nms = REAL(0.5) * PLACE * UNIT;
        if (last == 0) v.ground.axle_friction_Nm = REAL(0.75) * PLACE * UNIT;
        if (last == 1) v.ground.friction_coefficient = REAL(0.75) * PLACE;
        if (last == 2) v.drive.winding_resistance_ohm = 1 / (RANGE * (REAL(0.75) * PLACE));
        if (last == 3) {
            v.drive.viscous_friction_Nms = REAL(0.75) * PLACE * UNIT;
            v.motor_damping_Nms += v.drive.viscous_friction_Nms;
        }
        ASSERT_STATUS(LACONIC_OK, status_of(&v));
        v.motor_gain_Nm_per_V += PLACE * UNIT;
        ASSERT_STATUS(LACONIC_OVERFLOW, status_of(&v));
    }
}

/* Rollers that hardly drag make a contact's masses across them as large as what a light wheel turns by. The order in
 * which these are added decides the last digit. */
static void in_single_masses_across_rollers_add_up_behind_the_wheels_inertia(void) {
    static const struct {
        double drag, radius_m, inertia_kgm2;
        laconic_status status;
    } wheels[] = {{0x1.93bf9p-32, 0x1.e88d0cp+0, 0x1.7b0e12p-90, LACONIC_OVERFLOW},
                  {0x1.8bc99p-32, 0x1.9e9868p+0, 0x1.6307ap-90, LACONIC_OK}};
    for (size_t n = 0; n < sizeof wheels / sizeof wheels[0] && !IN_DOUBLE; n++) {
        laconic_vehicle v = light_unicycle();
        v.wheel[0].kind = LACONIC_WHEEL_ROLLER;
        v.wheel[0].roller_rad = REAL(PI / 2);
        v.wheel[0].own_radius_m = REAL(wheels[n].radius_m);
        v.wheel_inertia_kgm2 = REAL(wheels[n].inertia_kgm2);
        v.ground.roller_drag = REAL(wheels[n].drag);
        ASSERT_STATUS(wheels[n].status, status_of(&v));
    }
}

typedef struct wheel_in_range {
    double x_m, y_m, radius_m, inertia_kgm2;
    laconic_status status;
} wheel_in_range;

/* With this as its wheel. */
static void assert_status_with(laconic_vehicle v, const wheel_in_range *wheel) {
    v.wheel[0].x_m = REAL(wheel->x_m);
    v.wheel[0].y_m = REAL(wheel->y_m);
    v.wheel[0].own_radius_m = REAL(wheel->radius_m);
    v.wheel_inertia_kgm2 = REAL(wheel->inertia_kgm2);
    ASSERT_STATUS(wheel->status, status_of(&v));
}

/* Beside the height of the centre of mass the wheel's constants are half a place, which their last digits decide. */
static void in_single_levers_come_before_what_a_light_wheel_turns_by(void) {
    static const wheel_in_range wheels[] = {{480350, 333296, 0x1.110042p-1, 0x1.b2a2f4p-68, LACONIC_OVERFLOW},
                                            {484426, 208895, 0x1.9e51e4p+0, 0x1.d5206cp-67, LACONIC_OK}};
    for (size_t n = 0; n < sizeof wheels / sizeof wheels[0] && !IN_DOUBLE; n++) {
        laconic_vehicle v = light_unicycle();
        v.com_z_m = RANGE - PLACE;
        assert_status_with(v, &wheels[n]);
    }
}

/* The contact's mass along the wheel is at most 1, but decides whether the wheel's constants are half a place of the
 * centre of mass's height, and with this whether that is half a place of the gain. */
static void in_single_the_mass_along_a_wheel_counts_where_larger_constants_are_near_half_a_place(void) {
    static const wheel_in_range wheels[] = {{23, 6, 1.8, 0x1.19ac34p-42, LACONIC_OVERFLOW},
                                            {27, 1, 1.15, 0x1.37d2dp-43, LACONIC_OK}};
    for (size_t n = 0; n < sizeof wheels / sizeof wheels[0] && !IN_DOUBLE; n++) {
        laconic_vehicle v = light_unicycle();
        v.com_z_m = REAL(0x1p39 - 0x1p15);
        v.motor_gain_Nm_per_V = (RANGE - PLACE) * UNIT;
        assert_status_with(v, &wheels[n]);
    }
}

/* Squares of levers are about half a place of the largest number. In single the levers themselves decide, and the order
 * in which they are added. */
static void in_single_levers_count_beside_their_squares(void) {
    static const struct {
        double x_m, y_m;
        laconic_status status;
    } places[] = {{741454.5, 0, LACONIC_OK},
                  {741455, 0, LACONIC_OVERFLOW},
                  {734537.375, 101043.703, LACONIC_OK},
                  {604715, 429039.094, LACONIC_OVERFLOW}};
    for (size_t n = 0; n < sizeof places / sizeof places[0]; n++) {
        laconic_vehicle v = light_unicycle();
        v.wheel_inertia_kgm2 = (RANGE - PLACE) * UNIT;
        v.wheel[0].x_m = REAL(places[n].x_m);
        v.wheel[0].y_m = REAL(places[n].y_m);
        ASSERT_STATUS(IN_DOUBLE ? LACONIC_OK : places[n].status, status_of(&v));
    }
}

/* Of a wheel so much larger than its vehicle all that is left to find is what rounding hides: in double just that. */
static void what_rounding_hides_in_a_huge_wheel_counts_as_solved(void) {
    laconic_vehicle v = bare_body();
    laconic_start start = start_with(-0.25, 0.125, 0);
    const laconic_input input = no_input();
    laconic_plant plant;
    v.mass_kg = v.yaw_inertia_kgm2 = v.wheel_radius_m = v.ground.axle_friction_Nm = 1;
    v.wheel_inertia_kgm2 = 2;
    v.ground.friction_coefficient = REAL(0.25);
    add_wheel(&v, LACONIC_WHEEL_FIXED, 0.5, 0, 0.7, 0);
    v.wheel[0].own_radius_m = REAL(EITHER(1e16, 1e4));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, 1, &start, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 1, &why));
}

/* Of tiny wheels the square of a contact's impulse leaves the range: it tells no direction in which it slips. */
static void a_contact_whose_impulse_cannot_be_squared_does_not_slip(void) {
    laconic_vehicle v = bare_body();
    laconic_start start = start_with(0.625, 0, -0.5);
    laconic_input input = no_input();
    laconic_plant plant;
    v.yaw_inertia_kgm2 = REAL(0.25);
    v.wheel_radius_m = REAL(EITHER(1e-60, 1e-9));
    v.wheel_inertia_kgm2 = REAL(0.005);
    v.motor_damping_Nms = REAL(EITHER(1, 100));
    v.ground.friction_coefficient = 4;
    add_wheel(&v, LACONIC_WHEEL_FIXED, EITHER(1, 0.5), 0, EITHER(1.4, 0.7), 0);
    if (IN_DOUBLE) add_wheel(&v, LACONIC_WHEEL_FIXED, 1, 1, 2.4, 0);
    input.body_force_N[1] = -2;
    input.voltage_V[0] = REAL(-0.1);
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &v, &laconic_auto, REAL(0.001), &start, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 1, &why));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(each_constant_of_ground_and_supply_counts_in_the_range);
    RUN_TEST(each_constant_of_motor_and_wheel_counts_in_the_range);
    RUN_TEST(rollers_that_hardly_drag_count_in_the_range_once_for_each_of_two_masses);
    RUN_TEST(masses_across_rollers_count_in_the_range_whatever_the_mass_along_them);
    RUN_TEST(a_huge_wheel_counts_in_the_range);
    RUN_TEST(a_wheel_far_off_counts_by_its_place_and_by_its_lever);
    RUN_TEST(points_that_are_hardly_apart_count_in_the_range);
    RUN_TEST(wheels_start_up_to_the_end_of_the_range_of_speeds);
    RUN_TEST(a_speed_beyond_the_last_wheel_is_not_read);
    RUN_TEST(wheels_that_are_taken_over_are_those_that_there_are);
    RUN_TEST(wheels_start_with_equal_shares_of_the_weight);
    RUN_TEST(a_motor_of_one_ampere_for_a_unit_of_torque_is_limited);
    RUN_TEST(of_windings_that_are_not_known_no_current_is_either);
    RUN_TEST(a_motor_without_a_gain_is_a_damper_that_no_current_limits);
    RUN_TEST(wheels_that_allow_no_motion_on_ideal_ground_are_refused);
    RUN_TEST(friction_of_motor_and_gears_is_at_most_the_whole_damping);
    RUN_TEST(supports_start_with_the_loads_that_they_have_after_a_step);
    RUN_TEST(the_speed_at_which_a_wheel_would_roll_is_refused_with_its_sign);
    RUN_TEST(constants_of_an_axle_add_up_in_their_order_to_the_end_of_the_range);
    RUN_TEST(in_single_masses_across_rollers_add_up_behind_the_wheels_inertia);
    RUN_TEST(in_single_levers_come_before_what_a_light_wheel_turns_by);
    RUN_TEST(in_single_the_mass_along_a_wheel_counts_where_larger_constants_are_near_half_a_place);
    RUN_TEST(in_single_levers_count_beside_their_squares);
    RUN_TEST(what_rounding_hides_in_a_huge_wheel_counts_as_solved);
    RUN_TEST(a_contact_whose_impulse_cannot_be_squared_does_not_slip);
    return UNITY_END();
}
