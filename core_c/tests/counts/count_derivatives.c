/* count_derivatives METHOD WHAT TIMES: so many steps of the three-wheeled carriage (WHAT step), or so often the
 * Jacobian, a tangent or an adjoint of its step, for instructions to be counted: the difference of two is the cost. */
#include "vehicles.h"

#include "laconic/derivatives.h"
#include <stdio.h>
#include <stdlib.h>

typedef struct bench {
    laconic_plant plant;
    laconic_input held;
    laconic_state_change before, after;
    laconic_step_jacobian jacobian;
} bench;

static laconic_status once(bench *b, const char *what) {
    const laconic_model *model = &b->plant.model;
    const laconic_integrator *integrator = &b->plant.integrator;
    laconic_state *state = &b->plant.state;
    if (strcmp(what, "jacobian") == 0)
        return laconic_step_jacobian_of(&b->jacobian, model, integrator, state, &b->held, false);
    if (strcmp(what, "tangent") == 0)
        return laconic_step_tangent(&b->after, model, integrator, state, &b->held, &b->before, &b->held, NULL);
    if (strcmp(what, "adjoint") == 0)
        return laconic_step_adjoint(&b->after, NULL, NULL, model, integrator, state, &b->held, &b->before);
    return laconic_step(model, integrator, state, &b->held);
}

int main(int argc, char **argv) {
    const laconic_vehicle vehicle = with_motors(three_wheels());
    const laconic_start start = start_with(1, 2, 3);
    const laconic_method *method = argc == 4 ? laconic_method_by_name(argv[1]) : NULL;
    static bench b;
    if (method == NULL || laconic_plant_start(&b.plant, &vehicle, method, REAL(0.01), &start, NULL) != LACONIC_OK)
        return 2;
    for (int i = 0; i < 3; i++) b.held.voltage_V[i] = REAL(3 - 2 * i);
    b.before.nu_rad_per_s[1] = b.before.x_m = REAL(1);
    laconic_status status = LACONIC_OK;
    for (long left = strtol(argv[3], NULL, 10); left > 0 && status == LACONIC_OK; left--) status = once(&b, argv[2]);
    printf("status %d\n", (int)status);
    return status != LACONIC_OK;
}
