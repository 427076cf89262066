/* A state from the numbers of an outer integrator, whatever it has let ν drift off the constraints. */
#include "zeta.h"

laconic_status laconic_state_place(laconic_state *state, const laconic_model *model, const laconic_start *motion,
                                   laconic_refusal *why) {
    laconic_start at_rest = *motion;
    const vector zeta = zeta_of_nu(model, motion->nu_rad_per_s);
    laconic_status status;
    int k;
    for (k = 0; k < 3; k++) {
        if (!is_finite(motion->nu_rad_per_s[k]))
            return refuse(why, LACONIC_NOT_FINITE, LACONIC_FIELD_START_NU, k + 1, motion->nu_rad_per_s[k], R(0));
        at_rest.nu_rad_per_s[k] = R(0);
    }
    if (!(square(zeta) <= LARGEST_SPEED * LARGEST_SPEED))
        return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_START_NU, 0, size(vec(motion->nu_rad_per_s)), R(0));
    status = laconic_state_set(state, model, &at_rest, why);
    if (status == LACONIC_OK) set_zeta(state, zeta);
    return status;
}
