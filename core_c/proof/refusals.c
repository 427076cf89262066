/* Functions that refuse leave the state as it was: here a state to which nobody can write. A first write ends a path,
 * and is an alarm; so whatever comes back has refused, and has written nothing before. */
#include "anything.h"

extern const laconic_state kept; /* any numbers */

#define KEPT ((laconic_state *)&kept)

static void refused_by(const laconic_method *method) {
    laconic_status status;
    laconic_real step_s;
    any_model(&model);
    any_inputs();
    ANYTHING(step_s);
    if (laconic_integrator_prepare(&integrator, method, &model, step_s, NULL) != LACONIC_OK) return;
    PERHAPS {
        status = laconic_step(&model, &integrator, KEPT, &input[0]);
        /*@ assert status != LACONIC_OK; */
    }
    PERHAPS {
        status = laconic_step_sampled(&model, &integrator, KEPT, &input[0], &input[1], &input[2]);
        /*@ assert status != LACONIC_OK; */
    }
}

void prove_refused_rk4(void) { refused_by(&laconic_rk4); }
void prove_refused_exponential_kahan(void) { refused_by(&laconic_exponential_kahan); }
void prove_refused_exponential_kahan_4(void) { refused_by(&laconic_exponential_kahan_4); }
void prove_refused_exact_flow(void) { refused_by(&laconic_exact_flow); }
void prove_refused_exact_flow_4(void) { refused_by(&laconic_exact_flow_4); }
void prove_refused_taylor_8(void) { refused_by(&laconic_taylor_8); }
void prove_refused_exponential_gauss_8(void) { refused_by(&laconic_exponential_gauss_8); }
void prove_refused_auto(void) { refused_by(&laconic_auto); }

void prove_refused_carry(void) {
    laconic_status status;
    any_model(&model);
    any_model(&other);
    other.wheel_count = model.wheel_count;
    status = laconic_state_carry(KEPT, &model, &other);
    /*@ assert status != LACONIC_OK; */
}
