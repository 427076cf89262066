#include "zeta.h"

/* χ' = Ξ ν */
void laconic_wheel_speeds(const laconic_model *model, const laconic_state *state, laconic_real *speed_rad_per_s) {
    real zeta[3];
    int32_t i;
    take_zeta(zeta, state);
    for (i = 0; i < LACONIC_WHEELS(model); i++) speed_rad_per_s[i] = dot(model->wheel_of_zeta[i], zeta);
}
