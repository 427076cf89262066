/* Tests of vehicle/serialize.c: bytes of states that could not be, and states of Model Exchange with what follows. */
#include "fmi2_bench.h"
#include "model_interface.h"
#include "stream.h"

void setUp(void) {
    log_clear();
    c = NULL;
    make(fmi2CoSimulation);
}
void tearDown(void) {
    fmi2FreeInstance(c);
    c = NULL;
}

static void with_wheel_states(void) {
    make(fmi2ModelExchange);
    set("friction_coefficient", 0, 0);
    set("ground_friction_coefficient", 0, 0.4);
    fmu_model_made(&instance()->model);
}

static fmi2Byte bytes[65536];

static size_t write(void) {
    fmi2FMUstate kept = NULL;
    size_t size = 0;
    OK(fmi2GetFMUstate(c, &kept));
    OK(fmi2SerializedFMUstateSize(c, kept, &size));
    OK(fmi2SerializeFMUstate(c, kept, bytes, size));
    OK(fmi2FreeFMUstate(c, &kept));
    return size;
}

static fmi2Status read(size_t size) {
    fmi2FMUstate kept = NULL;
    const fmi2Status status = fmi2DeSerializeFMUstate(c, bytes, size, &kept);
    if (kept != NULL) OK(fmi2SetFMUstate(c, kept));
    OK(fmi2FreeFMUstate(c, &kept));
    return status;
}

/* Members as no run leaves them, in bytes with a right checksum. */
static void what_cannot_be_prepared_again_is_no_state(void) {
    fmu_model *model = &instance()->model;
    set("step_s", 0, 0.01);
    set_integer("encoder_counts_per_turn", 1, 4096);
    set("supply_V", 0, 12);
    set("winding_resistance_ohm", 0, 1.5);
    initialise();
    OK(read(write()));
    const fmu_model good = *model;
#define WRONG(member, value) \
    do { \
        model->member = (value); \
        ASSERT_REFUSED(read(write()), "are no possible state"); \
        *model = good; \
    } while (0)
    WRONG(plant.vehicle.mass_kg, 0);
    WRONG(plant.vehicle.wheel[1].roller_rad, 0);
    WRONG(plant.vehicle.drive.winding_resistance_ohm, -1);
    WRONG(plant.vehicle.com_z_m, -1);
    model->plant.vehicle.com_z_m = 1e154; /* each in its range, but not both */
    WRONG(plant.vehicle.friction_coefficient, 1e154);
    model->plant.vehicle.drive.supply_V = 1e154;
    WRONG(plant.vehicle.drive.supply_resistance_ohm, 1e154);
    WRONG(plant.integrator.step_s, NOT_A_NUMBER);
    WRONG(vehicle.wheel_count, 3);
    WRONG(sensors.settings.encoder_wrap, -1);
    WRONG(plant.slip.limit[0], 77);
    OK(read(write()));
}

/* Before the model is started, what is in the plant does not count. */
static void a_state_from_before_the_start_is_no_plant(void) {
    instance()->model.plant.vehicle.mass_kg = 0;
    OK(read(write()));
    OK(fmi2EnterInitializationMode(c));
    set("mass_kg", 0, 3);
    OK(fmi2ExitInitializationMode(c));
}

static void states_of_model_exchange_are_taken_up_with_what_follows_from_them(void) {
    double state[14], rate[14], again[14];
    for (int friction = 0; friction < 2; friction++) {
        const size_t count = friction ? 14 : 10;
        make(fmi2ModelExchange);
        if (friction) with_wheel_states();
        initialise();
        OK(fmi2EnterContinuousTimeMode(c));
        for (size_t k = 0; k < count; k++) state[k] = 0.2 * (double)k - 0.7;
        for (int read_first = 0; read_first < 2; read_first++) {
            OK(fmi2SetContinuousStates(c, state, count));
            if (read_first) (void)get("energy_J", 0); /* then the plant's state follows already */
            const size_t size = write();
            OK(fmi2GetDerivatives(c, rate, count));
            const double energy = get("energy_J", 0);
            for (size_t k = 0; k < count; k++) again[k] = -1;
            OK(fmi2SetContinuousStates(c, again, count));
            OK(read(size));
            OK(fmi2GetDerivatives(c, again, count));
            for (size_t k = 0; k < count; k++) TEST_ASSERT_TRUE(rate[k] == again[k]);
            TEST_ASSERT_TRUE(get("energy_J", 0) == energy && energy > 0);
            OK(fmi2GetContinuousStates(c, again, count));
            for (size_t k = 3; k < count; k++) TEST_ASSERT_TRUE(again[k] == state[k]);
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(what_cannot_be_prepared_again_is_no_state);
    RUN_TEST(a_state_from_before_the_start_is_no_plant);
    RUN_TEST(states_of_model_exchange_are_taken_up_with_what_follows_from_them);
    return UNITY_END();
}
