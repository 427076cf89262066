/* Calls of every public function of the core, for Frama-C's analyser: `laconic soak proof` runs each entry. */
#include "anything.h"

/* ------------------------------------------------------------------------------- a vehicle of any bits -- */

void prove_vehicle_check(void) {
    any_vehicle();
    (void)laconic_vehicle_has_friction(&vehicle);
    if (laconic_vehicle_check(&vehicle, any_refusal()) == LACONIC_OK) {
        /*@ assert 0 <= vehicle.wheel_count <= LACONIC_MAX_WHEELS; */
        /*@ assert 0 <= vehicle.support_count <= LACONIC_MAX_SUPPORTS; */
    }
}

void prove_prepare(void) {
    countable_vehicle();
    (void)laconic_prepare(&model, &vehicle, any_refusal());
}

static laconic_contact contact;

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

/* ---------------------------------------------------------------------------- a model with any numbers -- */

static const laconic_method *any_method(void) {
    return laconic_method_by_number(Frama_C_interval(-1, LACONIC_METHOD_COUNT));
}

static laconic_real any_real(void) {
    laconic_real number;
    ANYTHING(number);
    return number;
}

void prove_integrator_prepare(void) {
    any_model(&model);
    any_state();
    (void)laconic_integrator_prepare(&integrator, any_method(), &model, any_real(), any_refusal());
}

void prove_largest_stable_step(void) {
    const laconic_method *method = any_method();
    any_model(&model);
    any_state();
    if (method != NULL) (void)laconic_largest_stable_step_s(method, &model, &state);
}

void prove_input(void) {
    static laconic_forcing forcing;
    any_model(&model);
    any_inputs();
    (void)laconic_input_check(&model, &input[0], any_refusal());
    laconic_forcing_of(&forcing, &model, &input[0]);
}

/* One method after another: what an integrator holds is any number. */
static void prove_steps_of(const laconic_method *method) {
    laconic_status status;
    any_model(&model);
    any_state();
    any_inputs();
    if (laconic_integrator_prepare(&integrator, method, &model, any_real(), NULL) != LACONIC_OK) return;
    PERHAPS(void) laconic_step(&model, &integrator, &state, &input[0]);
    PERHAPS(void)
    laconic_run(&model, &integrator, &state, &input[0], any_count(), &status);
    PERHAPS(void) laconic_step_sampled(&model, &integrator, &state, &input[0], &input[1], &input[2]);
    status = (laconic_status)Frama_C_interval(0, LACONIC_STATUS_COUNT);
    laconic_step_refusal(any_refusal(), status, &model, &integrator, &state, input, ANY_BOOL() ? 1 : 3);
}

void prove_rk4(void) { prove_steps_of(&laconic_rk4); }
void prove_exponential_kahan(void) { prove_steps_of(&laconic_exponential_kahan); }
void prove_exponential_kahan_4(void) { prove_steps_of(&laconic_exponential_kahan_4); }
void prove_exact_flow(void) { prove_steps_of(&laconic_exact_flow); }
void prove_exact_flow_4(void) { prove_steps_of(&laconic_exact_flow_4); }
void prove_taylor_8(void) { prove_steps_of(&laconic_taylor_8); }
void prove_exponential_gauss_8(void) { prove_steps_of(&laconic_exponential_gauss_8); }
void prove_auto(void) { prove_steps_of(&laconic_auto); }

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

void prove_steps_in(void) {
    uint64_t steps;
    (void)laconic_steps_in(any_real(), any_real(), &steps, any_refusal());
}

void prove_outputs(void) {
    static laconic_pose pose;
    static laconic_rates rates;
    laconic_real two[2], three[3];
    any_model(&model);
    any_state();
    any_inputs();
    ANYTHING(three);
    laconic_derivative(&rates, &model, three, any_real(), &input[0]);
    laconic_nu(&model, &state, three);
    laconic_pose_of(&pose, &model, &state);
    laconic_position(&state, &two[0], &two[1], &three[0]);
    (void)laconic_angle_wrapped(any_real());
    (void)laconic_body_velocity(&model, &state, two);
    laconic_wheel_speeds(&model, &state, of_wheels);
    laconic_wheel_torques(&model, &state, &input[0], of_wheels);
    (void)laconic_energy_J(&model, &state);
    (void)laconic_yaw_integral(&model, &state);
    (void)laconic_condition_number(&model);
}

/* ------------------------------------------------------------------------- contacts as prepared, or any -- */

void prove_reactions(void) {
    static laconic_reactions reactions, change;
    static laconic_grip grip;
    static laconic_motion at;
    static laconic_variation by;
    static laconic_rates rates;
    static laconic_motion_change outputs;
    any_model(&model);
    any_state();
    any_inputs();
    any_contact(&contact);
    ANYTHING(grip);
    ANYTHING(at);
    ANYTHING(by);
    laconic_reactions_of(&reactions, &contact, &model, &state, &input[0]);
    laconic_grip_watch(&grip, &contact, &model, &reactions, any_count());
    laconic_reactions_tangent(&change, &contact, &model, &at, &input[0], &reactions, &by);
    laconic_derivative_tangent(&rates, &model, &at, &input[0], &by);
    laconic_motion_tangent(&outputs, &model, &at, &by);
}

/* -------------------------------------------------------------------------------------------- texts -- */

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
    (void)laconic_field_traits_of((laconic_field)number);
    (void)laconic_status_name((laconic_status)number);
    (void)laconic_arithmetic_text((laconic_arithmetic)number);
    (void)laconic_method_by_number(number);
    (void)laconic_method_by_name("rk4");
    (void)laconic_self_test();
}
