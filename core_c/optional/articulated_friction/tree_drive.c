/* Motors of wheels and hinges, the supply that feeds both, and the loops and sampled servos that command hinges. */
#include "tree_step.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

/* Of a control period, by which it may miss whole steps. */
#ifdef LACONIC_SINGLE
#define TREE_FITS R(1e-3)
#else
#define TREE_FITS R(1e-6)
#endif

static real tree_drawn_A(const tree_model *m, const laconic_tree_input *in, const tree_state *state, real terminal_V,
                         real *per_volt) {
    real sum = R(0);
    for (int32_t i = 0; i < m->wheel_count + m->body_count; i++) {
        const laconic_tree_motor *a = &m->motor[i];
        if (a->circuit != LACONIC_MOTOR_DRIVEN || a->ampere_per_Nm == R(0)) continue;
        const bool wheel = i < m->wheel_count;
        const real command_V =
            wheel ? in->hinged.base.voltage_V[i] : tree_hinge_command(m, in, state, 1 + i - m->wheel_count);
        const motor_state s = tree_motor_at(a, command_V, tree_axis_speed(m, state, i), terminal_V);
        const bool whole = s.limit == LACONIC_LIMIT_VOLTAGE;
        const real duty = whole ? (command_V > R(0) ? R(1) : R(-1)) : s.voltage_V / terminal_V;
        const real current = s.current_A * duty;
        sum += current;
        *per_volt += whole ? a->gain_Nm_per_V * a->ampere_per_Nm : -current / terminal_V; /* c1 A/Nm = 1/R_a */
    }
    return sum;
}

real laconic_tree_terminal_voltage(const tree_model *m, const laconic_tree_input *in, const tree_state *state) {
    real volts = state->supply_voltage_V > R(0) ? state->supply_voltage_V : m->supply_V;
    if (!(m->supply_V > R(0))) return R(-1);
    if (!(m->supply_resistance_ohm > R(0))) return m->supply_V;
    for (int k = 0; k < SAG_ROUNDS; k++) {
        real per_volt = R(0);
        const real current = tree_drawn_A(m, in, state, volts, &per_volt);
        if (sag_round(&volts, m->supply_V, m->supply_resistance_ohm, current, per_volt)) break;
    }
    return volts;
}

/* ------------------------------------------------------------------------------------ control -- */

/* Steps of a period, at least 1; 0: it is not a whole number of them. */
static int32_t tree_steps_of(real period_s, real step_s) {
    const real count = period_s / step_s;
    if (!(period_s > R(0))) return 1;
    if (!(count < R(1e9))) return 0;
    const int32_t steps = (int32_t)(count + R(0.5));
    return steps >= 1 && magnitude(count - (real)steps) <= TREE_FITS * count ? steps : 0;
}

static real tree_looked(const tree_model *m, const tree_state *state, const laconic_tree_input *in, int32_t b) {
    const tree_body *link = &m->body[b];
    const real angle = in->hinge_angle_rad[b - 1] - heading_unwrapped(&state->hinge[b - 1]);
    const real rate = in->hinged.hinge_rate_rad_per_s[b - 1] - state->z[2 + b];
    if (!link->servo) return link->loop_V_per_rad * angle + link->loop_Vs_per_rad * rate;
    const real torque = link->servo_gain_Nm_per_rad * angle + link->servo_damping_Nms * rate;
    return link->servo_limit_Nm > R(0) ? cut(torque, link->servo_limit_Nm) : torque;
}

laconic_status laconic_tree_control(const tree_model *m, real step_s, tree_state *state, const laconic_tree_input *in,
                                    laconic_refusal *why) {
    for (int32_t b = 1; b <= m->body_count; b++) {
        const tree_body *link = &m->body[b];
        if (!link->sampled) continue;
        if (state->control_wait[b - 1] <= 0) {
            const int32_t steps = tree_steps_of(link->control_period_s, step_s);
            if (steps == 0) {
                const real count = link->control_period_s / step_s, whole = (real)(int32_t)cut(count + R(0.5), R(1e9));
                return refuse(why, LACONIC_STEP_DOES_NOT_FIT, (laconic_field)LACONIC_FIELD_OF_CONTROL_PERIOD, b, step_s,
                              link->control_period_s / (whole > R(1) ? whole : R(1)));
            }
            state->control_command[b - 1] = tree_looked(m, state, in, b);
            state->control_wait[b - 1] = steps;
        }
        state->control_wait[b - 1]--;
    }
    return LACONIC_OK;
}

#endif
