/* The motions at which the equations of Kahan's method have no solution: det(E − ½h[(g·ζ)(·×w) + (ζ×w)(g·)]) = 0, a
 * cubic in the size of ζ. */
#ifndef LACONIC_TEST_KAHAN_H
#define LACONIC_TEST_KAHAN_H

#include "stiff.h"

static inline double kahan_determinant(const laconic_model *m, const laconic_state *state, double half_step) {
    double g[3], w[3], z[3], zeta_cross_w[3], a[3][3], yaw = 0;
    for (int r = 0; r < 3; r++) {
        g[r] = (double)m->nu_of_zeta[2][r];
        w[r] = (double)m->gyro[r];
        z[r] = (double)state->zeta[r].value;
        yaw += g[r] * z[r];
    }
    for (int r = 0; r < 3; r++) zeta_cross_w[r] = z[(r + 1) % 3] * w[(r + 2) % 3] - z[(r + 2) % 3] * w[(r + 1) % 3];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) a[r][c] = (r == c ? 1.0 : 0.0) - half_step * zeta_cross_w[r] * g[c];
    for (int r = 0; r < 3; r++) { /* (Δ×w)_r = Δ_{r+1} w_{r+2} − Δ_{r+2} w_{r+1} */
        a[r][(r + 1) % 3] -= half_step * yaw * w[(r + 2) % 3];
        a[r][(r + 2) % 3] += half_step * yaw * w[(r + 1) % 3];
    }
    return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
           a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

static inline laconic_state scaled_motion(const laconic_model *m, double scale) {
    return moving(m, 91.7 * scale, 97.0 * scale, -8.4 * scale);
}

/* Scale of a motion at which the determinant vanishes, by bisection. */
static inline double singular_scale(const laconic_model *m, double half_step) {
    double low = 0, high;
    for (high = 0.01; high < 1e3; low = high, high *= 1.2) {
        const laconic_state state = scaled_motion(m, high);
        if (kahan_determinant(m, &state, half_step) < 0) break;
    }
    TEST_ASSERT_TRUE_MESSAGE(high < 1e3, "no singular state in this direction");
    for (int k = 0; k < 80; k++) {
        const double middle = 0.5 * (low + high);
        const laconic_state state = scaled_motion(m, middle);
        if (kahan_determinant(m, &state, half_step) < 0)
            high = middle;
        else
            low = middle;
    }
    return high;
}

/* Where the determinant is within rounding of 0, the step is refused: its increment is too long or not finite. */
static inline void assert_singular_step_refused(const laconic_method *method, double half_step) {
    const laconic_model m = model_of(three_wheels());
    const laconic_integrator in = integrator_of(method, &m, 1.0);
    const laconic_input input = no_input(), alike = input;
    const double scale = singular_scale(&m, half_step);
    for (int k = -400; k <= 400; k++) {
        laconic_state state = scaled_motion(&m, scale * (1 + k * 0.25 * (double)LACONIC_EPSILON)), before = state;
        const laconic_status status = laconic_step(&m, &in, &state, &input);
        TEST_ASSERT_TRUE(status == LACONIC_STEP_GAINS_ENERGY || status == LACONIC_STEP_SINGULAR);
        TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
        ASSERT_STATUS(status, laconic_step_sampled(&m, &in, &state, &input, &alike, &alike));
    }
}

#endif
