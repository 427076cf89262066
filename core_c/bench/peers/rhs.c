/* The right-hand side as a user would write it for a general solver, with constant matrices. */
#include "peer.h"

#include <math.h>

static void driven_part(const double *nu, const double *voltage_V, double force[3]) {
    for (int i = 0; i < PEER_WHEELS; i++) {
        const double *row = peer_wheel_rows[i];
        const double speed = row[0] * nu[0] + row[1] * nu[1] + row[2] * nu[2];
        const double torque = peer_gain * voltage_V[i] - peer_damping * speed;
        for (int k = 0; k < 3; k++) force[k] += row[k] * torque;
    }
}

void peer_derivative(const double *state, const double *voltage_V, double *rates) {
    const double *nu = state;
    const double yaw_rate = nu[2] / peer_yaw_scale;
    const double cosine = cos(state[5]), sine = sin(state[5]);
    double force[3] = {nu[1] * yaw_rate, -nu[0] * yaw_rate, 0};
    driven_part(nu, voltage_V, force);
    for (int k = 0; k < 3; k++) {
        const double *row = peer_inverse_inertia[k];
        rates[k] = row[0] * force[0] + row[1] * force[1] + row[2] * force[2];
    }
    rates[3] = peer_radius * (nu[0] * cosine - nu[1] * sine);
    rates[4] = peer_radius * (nu[0] * sine + nu[1] * cosine);
    rates[5] = yaw_rate;
    for (int i = 0; i < PEER_WHEELS; i++) {
        const double *row = peer_wheel_rows[i];
        rates[6 + i] = row[0] * nu[0] + row[1] * nu[1] + row[2] * nu[2];
    }
}

/* The signature that compiled integrators in Python require; `voltage_V` is their parameter array. */
void peer_rhs(double t, double *state, double *rates, double *voltage_V) {
    (void)t;
    peer_derivative(state, voltage_V, rates);
}
