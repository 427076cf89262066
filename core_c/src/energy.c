/* The two integrals of the free motion. */
#include "zeta.h"

laconic_real laconic_energy_J(const laconic_model *model, const laconic_state *state) {
    const vector zeta = zeta_of(state);
    return R(0.5) * dot(zeta, zeta) * (model->mass_kg * model->wheel_radius_m * model->wheel_radius_m);
}

/* A G = V diag(√(1 + λ²x)) = G diag(1 + λ²x), as G = V diag(1/√(1 + λ²x)). */
laconic_real laconic_yaw_integral(const laconic_model *model, const laconic_state *state) {
    real sum = R(0);
    int k;
    for (k = 0; k < 3; k++) sum += model->nu_of_zeta[2][k] * model->inertia[k] * state->zeta[k].value;
    return sum;
}
