/* Calls of the core's public functions on any input, for Frama-C's analyser: proof/__init__.py runs each entry. */
#include "any.h"

static laconic_contact contact;
static laconic_forcing forcing;
static laconic_rates rates;

static laconic_real any_real(void) {
    laconic_real number;
    ANYTHING(number);
    return number;
}

/* -------------------------------------------------------------------------- a vehicle of any bits -- */

void prove_vehicle_check(void) {
    any_vehicle();
    (void)laconic_vehicle_has_friction(&vehicle);
    (void)laconic_vehicle_check(&vehicle, any_refusal());
}

void prove_prepare(void) {
    countable_vehicle();
    (void)laconic_prepare(&model, &vehicle, any_refusal());
}

void prove_contact_prepare(void) {
    countable_vehicle();
    (void)laconic_contact_prepare(&contact, &vehicle, any_refusal());
}

void prove_matrices(void) {
    static laconic_matrices matrices;
    countable_vehicle();
    (void)laconic_matrices_of(&matrices, &vehicle, any_refusal());
}

void prove_friction_of(void) {
    static laconic_friction friction;
    countable_vehicle();
    any_model(&model);
    model.wheel_count = vehicle.wheel_count;
    (void)laconic_friction_of(&friction, &model, &vehicle, any_refusal());
}

void prove_motor_fit(void) {
    static laconic_motor motor;
    any_vehicle();
    ANYTHING(motor);
    (void)laconic_motor_fit(&vehicle, &motor, any_refusal());
}

/* ---------------------------------------------------------------------- a model with any numbers -- */

void prove_input(void) {
    any_model(&model);
    any_inputs();
    (void)laconic_input_check(&model, &input[0], any_refusal());
    laconic_forcing_of(&forcing, &model, &input[0]);
}

static void steps_of(const laconic_method *method) {
    laconic_status status;
    any_model(&model);
    any_state();
    any_inputs();
    if (laconic_integrator_prepare(&integrator, method, &model, any_real(), NULL) != LACONIC_OK) return;
    PERHAPS(void) laconic_step(&model, &integrator, &state, &input[0]);
    PERHAPS(void) laconic_run(&model, &integrator, &state, &input[0], any_count(), &status);
    PERHAPS(void) laconic_step_sampled(&model, &integrator, &state, &input[0], &input[1], &input[2]);
    status = (laconic_status)Frama_C_interval(0, LACONIC_STATUS_COUNT);
    laconic_step_refusal(any_refusal(), status, &model, &integrator, &state, input, ANY_BOOL() ? 1 : 3);
}

void prove_rk4(void) { steps_of(&laconic_rk4); }
void prove_exponential_kahan(void) { steps_of(&laconic_exponential_kahan); }
void prove_exponential_kahan_4(void) { steps_of(&laconic_exponential_kahan_4); }
void prove_exact_flow(void) { steps_of(&laconic_exact_flow); }
void prove_exact_flow_4(void) { steps_of(&laconic_exact_flow_4); }
void prove_taylor_8(void) { steps_of(&laconic_taylor_8); }
void prove_exponential_gauss_8(void) { steps_of(&laconic_exponential_gauss_8); }
void prove_auto(void) { steps_of(&laconic_auto); }

void prove_state(void) {
    any_model(&model);
    any_model(&other);
    other.wheel_count = model.wheel_count;
    any_state();
    ANYTHING(start);
    ANYTHING(of_wheels);
    PERHAPS(void) laconic_state_set(&state, &model, &start, any_refusal());
    PERHAPS(void) laconic_state_project(&state, &model, &start, any_refusal());
    PERHAPS laconic_wheel_angles_set(&model, &state, of_wheels);
    PERHAPS(void) laconic_state_carry(&state, &model, &other);
    laconic_wheel_angles(&model, &state, of_wheels);
}

void prove_outputs(void) {
    static laconic_pose pose;
    static laconic_reactions reactions;
    static laconic_grip grip;
    laconic_real two[2], three[3];
    any_model(&model);
    any_state();
    any_inputs();
    any_contact(&contact);
    ANYTHING(three);
    ANYTHING(grip);
    laconic_derivative(&rates, &model, three, any_real(), &input[0]);
    laconic_nu(&model, &state, three);
    laconic_pose_of(&pose, &model, &state);
    (void)laconic_body_velocity(&model, &state, two);
    laconic_wheel_speeds(&model, &state, of_wheels);
    laconic_wheel_torques(&model, &state, &input[0], of_wheels);
    (void)laconic_energy_J(&model, &state);
    laconic_reactions_of(&reactions, &contact, &model, &state, &input[0]);
    laconic_grip_watch(&grip, &contact, &model, &reactions, any_count());
}

/* -------------------------------------------------------------------- plants, friction, sensors -- */

void prove_plant_start(void) {
    countable_vehicle();
    ANYTHING(start);
    (void)laconic_plant_start(&plant, &vehicle, &laconic_rk4, any_real(), &start, any_refusal());
}

void prove_plant_run(void) {
    if (!any_plant(&laconic_rk4)) return;
    plant.friction.acts = false;
    PERHAPS(void) laconic_plant_run(&plant, &input[0], any_count(), any_refusal());
    PERHAPS(void) laconic_plant_run_sampled(&plant, input, any_refusal());
    PERHAPS(void) laconic_plant_set_step(&plant, any_real(), any_refusal());
}

/* With one number of wheels the loops over them have an end that the analyser knows. */
void prove_friction_step(void) {
    any_model(&model);
    model.wheel_count = 4;
    any_friction(&plant.friction, 4);
    any_state();
    any_inputs();
    ANYTHING(plant.slip);
    (void)laconic_friction_step(&plant.friction, &model, any_real(), &state, &plant.slip, &input[0]);
}

void prove_sensors(void) {
    static laconic_sensor_settings settings;
    static laconic_sensor_outputs outputs;
    ANYTHING(settings);
    (void)laconic_sensor_settings_check(&settings, Frama_C_interval(0, LACONIC_MAX_WHEELS), any_refusal());
    if (!any_plant(&laconic_rk4)) return;
    any_sensors();
    laconic_sensors_read(&outputs, &sensors, &plant, &input[0]);
}

/* ------------------------------------------------------------------------------------- texts -- */

void prove_texts(void) {
    static char text[200];
    ANYTHING(refusal);
    (void)laconic_message(&refusal, text, (size_t)Frama_C_interval(0, (int)sizeof text));
    (void)laconic_explanation(&refusal, text, (size_t)Frama_C_interval(0, (int)sizeof text));
}

void prove_names(void) {
    const int number = Frama_C_interval(-2147483647 - 1, 2147483647);
    (void)laconic_field_name((laconic_field)number);
    (void)laconic_field_path((laconic_field)number);
    (void)laconic_status_name((laconic_status)number);
    (void)laconic_arithmetic_text((laconic_arithmetic)number);
    (void)laconic_method_by_number(number);
    (void)laconic_method_by_name("rk4");
    (void)laconic_self_test();
}
