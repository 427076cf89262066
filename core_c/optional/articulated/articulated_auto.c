#include "articulated_step.h"
#if LACONIC_MAX_BODIES > 0
laconic_status laconic_articulated_auto(laconic_articulated_state *state, const laconic_articulated_model *m,
                                        const laconic_articulated_integrator *integrator,
                                        const articulated_course *course, laconic_refusal *why) {
    (void)integrator;
    return laconic_articulated_rk4(state, m, course, R(0), R(1), false, why);
}
laconic_status laconic_articulated_moebius_4(laconic_articulated_state *state, const laconic_articulated_model *m,
                                             const laconic_articulated_integrator *integrator,
                                             const articulated_course *course, real from, real share, int32_t level,
                                             laconic_refusal *why) {
    (void)integrator; (void)level;
    return laconic_articulated_rk4(state, m, course, from, share, false, why);
}
#endif
