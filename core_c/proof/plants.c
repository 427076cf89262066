/* Calls of the functions of plants, of the friction step and of sensors, for Frama-C's analyser. Their numbers are any;
 * counts and flags are as the functions that prepare leave them. */
#include "any_plant.h"

static laconic_contact contact;
static laconic_rates rates;

void prove_plant_start(void) {
    laconic_real step_s;
    countable_vehicle();
    ANYTHING(start);
    ANYTHING(step_s);
    (void)laconic_plant_start(&plant, &vehicle, &laconic_rk4, step_s, &start, any_refusal());
}

void prove_plant_run(void) {
    if (!any_plant(&laconic_rk4)) return;
    plant.friction.acts = false;
    PERHAPS(void) laconic_plant_run(&plant, &input[0], any_count(), any_refusal());
    PERHAPS(void) laconic_plant_run_sampled(&plant, input, any_refusal());
    PERHAPS(void) laconic_plant_set_step(&plant, plant.integrator.step_s, any_refusal());
}

void prove_plant_restart(void) {
    if (!any_plant(&laconic_rk4)) return;
    plant.friction.acts = false;
    ANYTHING(start);
    (void)laconic_plant_restart(&plant, &start, any_refusal());
}

void prove_plant_outputs(void) {
    static laconic_outputs outputs;
    static laconic_reactions reactions;
    if (!any_plant(&laconic_rk4)) return;
    any_contact(&contact);
    laconic_plant_wheel_speeds(&plant, of_wheels);
    laconic_plant_wheel_angles(&plant, of_wheels);
    (void)laconic_plant_energy_J(&plant);
    PERHAPS laconic_outputs_of(&outputs, &plant, &input[0]);
    PERHAPS laconic_plant_reactions(&reactions, &plant, &contact, &input[0]);
}

/* -------------------------------------------------------------------------------------- friction -- */

static void any_friction_now(void) {
    any_model(&model);
    any_friction(&plant.friction, model.wheel_count);
    any_state();
    any_inputs();
    ANYTHING(plant.slip);
    ANYTHING(plant.integrator.step_s);
}

void prove_friction_moment(void) {
    laconic_real nu[3], of_rates[LACONIC_MAX_WHEELS];
    any_friction_now();
    ANYTHING(nu);
    ANYTHING(of_wheels);
    (void)laconic_friction_energy_J(&plant.friction, &state, &plant.slip);
    laconic_friction_derivative(&rates, of_rates, &plant.friction, &model, nu, nu[0], of_wheels, &input[0]);
    laconic_slip_smooth(&plant.slip, &plant.friction, &state, &input[0]);
}

/* For each number of wheels an entry: loops over them then have an end that the analyser knows, and it sees that what
 * one loop writes is what the next one reads. */
static void friction_step_of(int32_t wheels) {
    any_friction_now();
    model.wheel_count = wheels;
    any_friction(&plant.friction, wheels);
    (void)laconic_friction_step(&plant.friction, &model, plant.integrator.step_s, &state, &plant.slip, &input[0]);
}

void prove_friction_step_0(void) { friction_step_of(0); }
void prove_friction_step_1(void) { friction_step_of(1); }
void prove_friction_step_2(void) { friction_step_of(2); }
void prove_friction_step_3(void) { friction_step_of(3); }
void prove_friction_step_4(void) { friction_step_of(4); }
void prove_friction_step_5(void) { friction_step_of(5); }
void prove_friction_step_6(void) { friction_step_of(6); }
void prove_friction_step_7(void) { friction_step_of(7); }
void prove_friction_step_8(void) { friction_step_of(8); }
void prove_friction_step_9(void) { friction_step_of(9); }
void prove_friction_step_10(void) { friction_step_of(10); }
void prove_friction_step_11(void) { friction_step_of(11); }
void prove_friction_step_12(void) { friction_step_of(12); }
void prove_friction_step_13(void) { friction_step_of(13); }
void prove_friction_step_14(void) { friction_step_of(14); }
void prove_friction_step_15(void) { friction_step_of(15); }
void prove_friction_step_16(void) { friction_step_of(16); }

/* --------------------------------------------------------------------------------------- sensors -- */

void prove_encoders(void) {
    static laconic_encoder encoder;
    static laconic_encoder_settings settings;
    laconic_real turned, pair[2];
    ANYTHING(encoder);
    ANYTHING(settings);
    ANYTHING(turned);
    encoder.count = Frama_C_long_long_interval(-MOST_COUNTS, MOST_COUNTS);
    (void)laconic_encoder_place(&encoder, Frama_C_interval(1, 2147483647));
    (void)laconic_encoder_turns(&encoder, Frama_C_interval(1, 2147483647));
    (void)laconic_encoder_shown(&encoder, Frama_C_interval(0, 2147483647));
    (void)laconic_encoder_turn(&encoder, &settings, turned);
    laconic_normal_pair(pair, any_count(), Frama_C_unsigned_int_interval(0, 0xFFFFFFFFU), any_count());
}

void prove_sensor_settings(void) {
    static laconic_sensor_settings settings;
    ANYTHING(settings);
    (void)laconic_sensor_settings_check(&settings, Frama_C_interval(0, LACONIC_MAX_WHEELS), any_refusal());
}

void prove_sensors_read(void) {
    static laconic_sensor_outputs outputs;
    static laconic_sensor_moment before;
    if (!any_plant(&laconic_rk4)) return;
    any_sensors();
    PERHAPS laconic_sensors_read(&outputs, &sensors, &plant, &input[0]);
    PERHAPS {
        laconic_sensors_before(&before, &plant);
        (void)laconic_sensors_after(&sensors, &plant, &input[0], &before, any_refusal());
    }
}

void prove_imu(void) {
    static laconic_imu_settings imu;
    static laconic_imu_sample sample;
    laconic_real nu[3], by[3], rate[3], two[2], yaw_rate;
    any_model(&model);
    ANYTHING(imu);
    ANYTHING(sample);
    ANYTHING(nu);
    ANYTHING(by);
    ANYTHING(rate);
    laconic_acceleration_of_rates(two, &model, nu, rate);
    laconic_acceleration_tangent(two, &model, nu, by, rate);
    laconic_imu_feel(&sample, &imu, &model, nu, rate, nu[0]);
    laconic_imu_show(&imu, &sample, any_count(), nu[1], two, &yaw_rate);
}
