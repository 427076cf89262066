/* Calls of functions of derivatives.h that take a step, for Frama-C's analyser: by rk4. */
#include "laconic/derivatives.h"

#include "anything.h"

static laconic_step_jacobian columns;
static laconic_state_change before, after;
static laconic_input by_input;
static laconic_model_change by_constants;

static bool any_step(const laconic_method *method) {
    laconic_real step_s;
    any_model(&model);
    any_state();
    any_inputs();
    ANYTHING(step_s);
    ANYTHING(before);
    ANYTHING(after);
    ANYTHING(by_input);
    ANYTHING(by_constants);
    return laconic_integrator_prepare(&integrator, method, &model, step_s, NULL) == LACONIC_OK;
}

static void differentiate(const laconic_method *method, const laconic_derivation *of) {
    if (!any_step(method)) return;
    PERHAPS(void) laconic_step_jacobian_by(&columns, of, &model, &integrator, &state, &input[0], ANY_BOOL());
    PERHAPS(void)
    laconic_step_tangent_by(&after, of, &model, &integrator, &state, &input[0], &before, ANY_BOOL() ? &by_input : NULL,
                            ANY_BOOL() ? &by_constants : NULL);
    PERHAPS(void)
    laconic_step_adjoint_by(&before, ANY_BOOL() ? &by_input : NULL, ANY_BOOL() ? &by_constants : NULL, of, &model,
                            &integrator, &state, &input[0], &after);
}

void prove_derivatives_of_rk4(void) { differentiate(&laconic_rk4, &laconic_derivation_of_rk4); }
