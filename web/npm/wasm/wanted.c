/* Voltages that hold a wanted velocity, torques that give a wanted acceleration: the least in norm, by the core's own
 * forcing and derivative.
 *
 * Of the accelerations that unit voltages cause, b_i = forcing of wheel i, the voltages U with Σ b_i U_i = −ζ'(0) hold
 * the motion, where ζ'(0) is the acceleration without input. */
#include "web.h"

#define SMALLEST_PIVOT 1e-12

typedef struct effects {
    int32_t wheels;
    double of[LACONIC_MAX_WHEELS][3]; /* b of each wheel's unit */
} effects;

static void effects_of(effects *e, const laconic_model *model, bool of_torques) {
    static laconic_input one;
    e->wheels = model->wheel_count;
    for (int32_t i = 0; i < e->wheels; i++) {
        laconic_forcing forcing;
        __builtin_memset(&one, 0, sizeof one);
        if (of_torques)
            one.axle_torque_Nm[i] = 1;
        else
            one.voltage_V[i] = 1;
        laconic_forcing_of(&forcing, model, &one);
        for (int32_t k = 0; k < 3; k++) e->of[i][k] = forcing.constant[k];
    }
}

static void add_row(double m[3][4], int32_t to, int32_t from, double factor) {
    for (int32_t j = 0; j < 4; j++) m[to][j] += factor * m[from][j];
}

/* (B Bᵀ) y = b by elimination on the diagonal; a direction in which no wheel pushes gets 0. */
static void solve(double y[3], double m[3][4]) {
    bool used[3] = {false, false, false};
    const double size = m[0][0] + m[1][1] + m[2][2];
    for (int32_t turn = 0; turn < 3; turn++) {
        int32_t p = -1;
        for (int32_t k = 0; k < 3; k++)
            if (!used[k] && m[k][k] > SMALLEST_PIVOT * size && (p < 0 || m[k][k] > m[p][p])) p = k;
        if (p < 0) break;
        used[p] = true;
        for (int32_t k = 0; k < 3; k++)
            if (k != p) add_row(m, k, p, -m[k][p] / m[p][p]);
    }
    for (int32_t k = 0; k < 3; k++) y[k] = used[k] ? m[k][3] / m[k][k] : 0;
}

static void least(double *wanted, const effects *e, const double b[3]) {
    double m[3][4], y[3];
    for (int32_t j = 0; j < 3; j++) {
        m[j][3] = b[j];
        for (int32_t k = 0; k < 3; k++) {
            m[j][k] = 0;
            for (int32_t i = 0; i < e->wheels; i++) m[j][k] += e->of[i][j] * e->of[i][k];
        }
    }
    solve(y, m);
    for (int32_t i = 0; i < e->wheels; i++) wanted[i] = e->of[i][0] * y[0] + e->of[i][1] * y[1] + e->of[i][2] * y[2];
}

/* ν in which the origin of the body moves so. */
static void nu_of(double nu[3], const laconic_model *model, double forward, double left, double turn) {
    nu[0] = (forward - turn * model->com_y_m) / model->wheel_radius_m;
    nu[1] = (left + turn * model->com_x_m) / model->wheel_radius_m;
    nu[2] = turn * model->yaw_scale;
}

/* The nearest motion that the wheels allow: ζ, and ν with it. */
static bool allowed(double zeta[3], double nu[3], const laconic_model *model) {
    static laconic_state state;
    static laconic_start motion;
    for (int32_t k = 0; k < 3; k++) motion.nu_rad_per_s[k] = nu[k];
    if (laconic_state_project(&state, model, &motion, NULL) != LACONIC_OK) return false;
    for (int32_t k = 0; k < 3; k++) zeta[k] = state.zeta[k].value;
    laconic_nu(model, &state, nu);
    return true;
}

/* Without a model of rolling (skid steering): the voltage at which each motor idles while its wheel rolls. */
static void idle_voltages(laconic_web_robot *robot, const double nu[3]) {
    const laconic_vehicle *v = &robot->plant.vehicle;
    for (int32_t i = 0; i < v->wheel_count; i++) {
        const laconic_friction_wheel *w = &robot->plant.friction.wheel[i];
        const laconic_friction_axle *axle = &robot->plant.friction.axle[i];
        const double speed = (w->along[0] * nu[0] + w->along[1] * nu[1] + w->along[2] * nu[2]) / w->rim_along;
        robot->wanted[i] = axle->gain != 0 ? (axle->back_emf + axle->viscous) * speed / axle->gain : 0;
    }
}

/* Voltages that hold the velocity [m/s, rad/s] of the body's origin, on ideal ground; NULL where there are none. */
WEB_EXPORT(laconic_web_voltages_for)
const double *laconic_web_voltages_for(laconic_web_robot *robot, double forward, double left, double turn) {
    static effects e;
    static laconic_input none;
    const laconic_model *model = robot->rolls ? &robot->rolling : &robot->plant.model;
    double nu[3], zeta[3];
    laconic_rates rates;
    nu_of(nu, model, forward, left, turn);
    if (!robot->rolls) {
        idle_voltages(robot, nu);
        return robot->wanted;
    }
    if (!allowed(zeta, nu, model)) return NULL;
    laconic_derivative(&rates, model, nu, 0, &none);
    for (int32_t k = 0; k < 3; k++) nu[k] = -rates.nu_rad_per_s2[k];
    if (!allowed(zeta, nu, model)) return NULL;
    effects_of(&e, model, false);
    least(robot->wanted, &e, zeta);
    return robot->wanted;
}

/* Torques on the axles that accelerate the body's origin so [m/s², rad/s²] from rest; NULL where there are none. */
WEB_EXPORT(laconic_web_torques_for)
const double *laconic_web_torques_for(laconic_web_robot *robot, double forward, double left, double turn) {
    static effects e;
    double rate[3], zeta_rate[3];
    const laconic_model *model = &robot->rolling;
    if (!robot->rolls) return NULL;
    nu_of(rate, model, forward, left, turn);
    if (!allowed(zeta_rate, rate, model)) return NULL;
    effects_of(&e, model, true);
    least(robot->wanted, &e, zeta_rate);
    return robot->wanted;
}

/* Whether the robot rolls on ideal ground; else fixed wheels keep it from every turn, or from every motion. */
WEB_EXPORT(laconic_web_rolls) bool laconic_web_rolls(const laconic_web_robot *robot) { return robot->rolls; }

/* The nearest velocity of the body's origin that the wheels allow: 0 forward, 1 left, 2 turn of it. NaN where it is
 * beyond the range. */
WEB_EXPORT(laconic_web_allowed)
double laconic_web_allowed(laconic_web_robot *robot, double forward, double left, double turn, int32_t component) {
    double nu[3], zeta[3];
    const laconic_model *model = &robot->rolling;
    if (!robot->rolls) return component == 0 ? forward : component == 2 ? turn : 0;
    nu_of(nu, model, forward, left, turn);
    if (!allowed(zeta, nu, model)) return __builtin_nan("");
    const double yaw = nu[2] / model->yaw_scale;
    if (component == 2) return yaw;
    return component == 0 ? nu[0] * model->wheel_radius_m + yaw * model->com_y_m
                          : nu[1] * model->wheel_radius_m - yaw * model->com_x_m;
}
