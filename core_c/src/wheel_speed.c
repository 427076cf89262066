#include "zeta.h"

/* χ' = Ξ ν */
void laconic_wheel_speeds(const laconic_model *model, const laconic_state *state, laconic_real *speed_rad_per_s) {
    const vector zeta = zeta_of(state);
    int32_t i;
    for (i = 0; i < LACONIC_WHEELS(model); i++) speed_rad_per_s[i] = dot(vec(model->wheel_of_zeta[i]), zeta);
}
