/* Tests of batch_population.c: arrays of kinds, starts and outputs have the bits of one vehicle alone. */
#include "population.h"

#define MANY 12

static population all;
static laconic_vehicle vehicles[MANY];
static laconic_motor motors[MANY];
static laconic_batch_kind kinds[LANES];
static int32_t status[MANY];
static laconic_refusal why;

static laconic_motor motor(double resistance) {
    laconic_motor m;
    memset(&m, 0, sizeof m);
    m.resistance_ohm = REAL(resistance);
    m.torque_constant_Nm_per_A = REAL(0.05);
    m.back_emf_Vs_per_rad = REAL(0.05);
    m.gear_ratio = REAL(16);
    m.rotor_inertia_kgm2 = REAL(1e-5);
    return m;
}

static void make_vehicles(void) {
    all.random = 7;
    for (int i = 0; i < MANY; i++) {
        vehicles[i] = three_wheels();
        vehicles[i].mass_kg = REAL(between(&all, 1, 30));
        motors[i] = motor(between(&all, 1, 10));
    }
    memset(kinds, 0x55, sizeof kinds);
}

static void kinds_are_those_of_each_vehicle_with_its_motor(void) {
    make_vehicles();
    TEST_ASSERT_EQUAL_INT(0, laconic_batch_kinds_of(kinds, status, vehicles, motors, MANY, &laconic_auto, REAL(0.01)));
    for (int i = 0; i < MANY; i++) {
        laconic_vehicle fitted = vehicles[i];
        laconic_batch_kind kind;
        memset(&kind, 0x55, sizeof kind);
        ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&fitted, &motors[i], &why));
        ASSERT_STATUS(LACONIC_OK, laconic_batch_kind_of(&kind, &fitted, &laconic_auto, REAL(0.01), &why));
        TEST_ASSERT_EQUAL_INT(LACONIC_OK, status[i]);
        TEST_ASSERT_EQUAL_MEMORY(&kind, &kinds[i], sizeof kind);
        TEST_ASSERT_TRUE(vehicles[i].motor_gain_Nm_per_V == REAL(0)); /* stays as the caller has it */
    }
}

static void kinds_without_motors_are_those_of_the_vehicles_as_they_are(void) {
    make_vehicles();
    TEST_ASSERT_EQUAL_INT(0, laconic_batch_kinds_of(kinds, status, vehicles, NULL, MANY, &laconic_rk4, REAL(0.01)));
    laconic_batch_kind kind;
    ASSERT_STATUS(LACONIC_OK, laconic_batch_kind_of(&kind, &vehicles[3], &laconic_rk4, REAL(0.01), &why));
    TEST_ASSERT_TRUE(kind.model.mass_kg == kinds[3].model.mass_kg);
}

static void a_vehicle_that_is_refused_leaves_the_others_and_its_kind_alone(void) {
    make_vehicles();
    vehicles[2].mass_kg = REAL(-1);
    motors[5].resistance_ohm = REAL(0);
    memset(&kinds[2], 0, sizeof kinds[2]);
    TEST_ASSERT_EQUAL_INT(2, laconic_batch_kinds_of(kinds, status, vehicles, motors, MANY, &laconic_auto, REAL(0.01)));
    TEST_ASSERT_EQUAL_INT(LACONIC_NOT_POSITIVE, status[2]);
    TEST_ASSERT_EQUAL_INT(LACONIC_NOT_POSITIVE, status[5]);
    TEST_ASSERT_EQUAL_INT(LACONIC_OK, status[6]);
    TEST_ASSERT_TRUE(kinds[2].model.mass_kg == REAL(0));
}

static void contacts_are_those_of_each_vehicle(void) {
    static laconic_contact contacts[MANY];
    laconic_contact contact;
    make_vehicles();
    vehicles[1].com_z_m = REAL(-1);
    TEST_ASSERT_EQUAL_INT(1, laconic_batch_contacts_of(contacts, status, vehicles, NULL, MANY));
    TEST_ASSERT_NOT_EQUAL_INT(LACONIC_OK, status[1]);
    motors[2].resistance_ohm = REAL(0);
    TEST_ASSERT_EQUAL_INT(2, laconic_batch_contacts_of(contacts, status, vehicles, motors, MANY));
    TEST_ASSERT_EQUAL_INT(LACONIC_NOT_POSITIVE, status[2]);
    ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&contact, &vehicles[4], &why));
    TEST_ASSERT_TRUE(contact.normal_load_of_wrench[0][0] == contacts[4].normal_load_of_wrench[0][0]);
}

static void place_vehicles(void) {
    const laconic_batch_shape shape = {MANY, MANY, 3, 0};
    void *memory = (void *)(((uintptr_t)all.memory + 63) / 64 * 64);
    make_vehicles();
    for (int i = 0; i < MANY; i++) all.kind_of[i] = i;
    laconic_batch_kinds_of(kinds, status, vehicles, motors, MANY, &laconic_auto, REAL(0.01));
    TEST_ASSERT_TRUE(laconic_batch_place(&all.batch, memory, &shape, kinds, all.kind_of));
}

static void starts_are_those_of_each_lane(void) {
    laconic_start starts[3];
    laconic_state expected, found;
    memset(starts, 0, sizeof starts);
    for (int i = 0; i < 3; i++) {
        starts[i].nu_rad_per_s[1] = REAL(i + 1);
        starts[i].heading_rad = REAL(0.5 * i);
    }
    starts[1].x_m = NOT_A_NUMBER;
    place_vehicles();
    TEST_ASSERT_EQUAL_INT(1, laconic_batch_start(&all.batch, 4, 3, starts));
    TEST_ASSERT_EQUAL_INT(LACONIC_OK, all.batch.status[4]);
    TEST_ASSERT_EQUAL_INT(LACONIC_NOT_FINITE, all.batch.status[5]);
    ASSERT_STATUS(LACONIC_OK, laconic_state_set(&expected, &kinds[6].model, &starts[2], &why));
    found = expected;
    laconic_batch_store(&all.batch, 6, &found);
    TEST_ASSERT_EQUAL_MEMORY(&expected, &found, sizeof found);
}

static void outputs_are_those_of_a_plant_beside_it(void) {
    static laconic_outputs outputs[2], expected;
    static laconic_contact contacts[2], contact;
    static laconic_plant plant;
    laconic_start start;
    laconic_input input;
    memset(&start, 0, sizeof start);
    memset(&input, 0, sizeof input);
    start.nu_rad_per_s[0] = REAL(2);
    input.voltage_V[1] = REAL(3);
    place_vehicles();
    laconic_batch_start(&all.batch, 8, 1, &start);
    laconic_batch_set_input(&all.batch, 8, &input);
    laconic_batch_run(&all.batch, 0, all.batch.block_count, 20);
    TEST_ASSERT_EQUAL_INT(0, laconic_batch_contacts_of(contacts, status, &vehicles[7], &motors[7], 2));
    laconic_batch_outputs(&all.batch, 7, 2, contacts, outputs);

    laconic_vehicle fitted = vehicles[8];
    ASSERT_STATUS(LACONIC_OK, laconic_motor_fit(&fitted, &motors[8], &why));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_start(&plant, &fitted, &laconic_auto, REAL(0.01), &start, &why));
    ASSERT_STATUS(LACONIC_OK, laconic_plant_run(&plant, &input, 20, &why));
    laconic_outputs_of(&expected, &plant, &input);
    ASSERT_STATUS(LACONIC_OK, laconic_contact_prepare(&contact, &fitted, &why));
    laconic_plant_reactions(&expected.reactions, &plant, &contact, &input);
    TEST_ASSERT_EQUAL_MEMORY(&expected, &outputs[1], sizeof expected);

    memset(&expected.reactions, 0, sizeof expected.reactions); /* not set without a contact */
    memset(outputs, 0, sizeof outputs);
    laconic_batch_outputs(&all.batch, 8, 1, NULL, outputs);
    TEST_ASSERT_EQUAL_MEMORY(&expected, &outputs[0], sizeof expected);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(kinds_are_those_of_each_vehicle_with_its_motor);
    RUN_TEST(kinds_without_motors_are_those_of_the_vehicles_as_they_are);
    RUN_TEST(a_vehicle_that_is_refused_leaves_the_others_and_its_kind_alone);
    RUN_TEST(contacts_are_those_of_each_vehicle);
    RUN_TEST(starts_are_those_of_each_lane);
    RUN_TEST(outputs_are_those_of_a_plant_beside_it);
    return UNITY_END();
}
