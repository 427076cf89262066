/* Runs the RK4 step that CasADi generated for the scene: peer_step(x, u) → x⁺. */
#include "peer.h"

#include <string.h>

int peer_step(const double **arg, double **res, long long *iw, double *w, int mem);

static double state[PEER_STATES], next[PEER_STATES], work[PEER_CASADI_WORK];
static long long integer_work[PEER_CASADI_INTEGER_WORK];

void peer_reset(void) {
    memset(state, 0, sizeof state);
    memcpy(state, peer_start, sizeof peer_start);
}

/* `steps` steps, `steps_per_second` of them a second, through the voltages in a cycle. */
void peer_run(long steps, long steps_per_second) {
    const double *arg[PEER_CASADI_ARGUMENTS] = {state};
    double *res[PEER_CASADI_RESULTS] = {next};
    for (int segment = 0; steps > 0; segment = (segment + 1) % PEER_SEGMENTS) {
        const long whole = (long)(peer_segment_s[segment] * (double)steps_per_second + 0.5);
        const long count = whole < steps ? whole : steps;
        arg[1] = peer_voltage_V[segment];
        for (long i = 0; i < count; i++) {
            peer_step(arg, res, integer_work, work, 0);
            memcpy(state, next, sizeof state);
        }
        steps -= count;
    }
}

void peer_state(double *out) { memcpy(out, state, sizeof state); }
