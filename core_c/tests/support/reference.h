/* The carriage of (4.6) and (4.7) in plain doubles, by the paper's formulas: without ζ, with libm's sine.
 * For roller-carrying wheels; the tests of vehicles with constraints have equations of their own. */
#ifndef LACONIC_TEST_REFERENCE_H
#define LACONIC_TEST_REFERENCE_H

#include "vehicles.h"

typedef struct reference {
    double big_lambda, unit_inertia, radius;
    int wheels;
    double inertia[LACONIC_MAX_WHEELS], gain[LACONIC_MAX_WHEELS], damping[LACONIC_MAX_WHEELS]; /* J_i, c1_i, c2_i */
    double row[LACONIC_MAX_WHEELS][3];
    double inverse[3][3];
} reference;

typedef struct reference_state {
    double y[6 + LACONIC_MAX_WHEELS]; /* ν, x, y, θ, χ */
} reference_state;

static inline void invert3(double out[3][3], double a[3][3]) {
    double det = 0;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            out[c][r] = a[r1][c1] * a[r2][c2] - a[r1][c2] * a[r2][c1];
        }
    for (int c = 0; c < 3; c++) det += a[0][c] * out[c][0];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) out[r][c] /= det;
}

static inline void reference_inertia(const reference *p, double a[3][3]) {
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            a[r][c] = r == c ? 1.0 : 0.0;
            for (int i = 0; i < p->wheels; i++)
                a[r][c] += p->inertia[i] / p->unit_inertia * p->row[i][r] * p->row[i][c];
        }
}

static inline double own_or(laconic_real own, laconic_real common) { return (double)(own != 0 ? own : common); }

static inline reference reference_of(const laconic_vehicle *v) {
    reference p;
    double a[3][3];
    p.radius = (double)v->wheel_radius_m;
    p.unit_inertia = (double)v->mass_kg * p.radius * p.radius;
    p.big_lambda = sqrt((double)v->yaw_inertia_kgm2 / p.unit_inertia);
    p.wheels = v->wheel_count;
    for (int i = 0; i < p.wheels; i++) {
        const laconic_wheel *w = &v->wheel[i];
        const double s = (double)w->axle_rad + (double)w->roller_rad, sine = sin((double)w->roller_rad);
        const double px = (double)w->x_m - (double)v->com_x_m, py = (double)w->y_m - (double)v->com_y_m;
        const double size = p.radius / (own_or(w->own_radius_m, v->wheel_radius_m) * sine);
        p.row[i][0] = cos(s) * size;
        p.row[i][1] = sin(s) * size;
        p.row[i][2] = (px * sin(s) - py * cos(s)) / (p.radius * p.big_lambda) * size;
        p.inertia[i] = own_or(w->own_inertia_kgm2, v->wheel_inertia_kgm2);
        p.gain[i] = w->undriven ? 0 : own_or(w->own_motor_gain_Nm_per_V, v->motor_gain_Nm_per_V);
        p.damping[i] = w->undriven ? 0 : own_or(w->own_motor_damping_Nms, v->motor_damping_Nms);
    }
    reference_inertia(&p, a);
    invert3(p.inverse, a);
    return p;
}

static inline void reference_rate(const reference *p, const double *y, const laconic_input *in, double *rate) {
    const double fx = (double)in->world_force_N[0], fy = (double)in->world_force_N[1], th = y[5];
    const double along = cos(th) * fx + sin(th) * fy, across = cos(th) * fy - sin(th) * fx;
    const double rx = (double)in->world_force_point_m[0], ry = (double)in->world_force_point_m[1];
    double right[3];
    right[0] = p->radius * ((double)in->body_force_N[0] + along);
    right[1] = p->radius * ((double)in->body_force_N[1] + across);
    right[2] = ((double)in->body_moment_Nm + rx * across - ry * along) / p->big_lambda;
    for (int i = 0; i < p->wheels; i++) {
        const double speed = p->row[i][0] * y[0] + p->row[i][1] * y[1] + p->row[i][2] * y[2];
        const double torque =
            p->gain[i] * (double)in->voltage_V[i] - p->damping[i] * speed + (double)in->axle_torque_Nm[i];
        for (int k = 0; k < 3; k++) right[k] += p->row[i][k] * torque;
        rate[6 + i] = speed;
    }
    for (int k = 0; k < 3; k++) right[k] /= p->unit_inertia;
    right[0] += y[1] * y[2] / p->big_lambda;
    right[1] -= y[0] * y[2] / p->big_lambda;
    for (int k = 0; k < 3; k++)
        rate[k] = p->inverse[k][0] * right[0] + p->inverse[k][1] * right[1] + p->inverse[k][2] * right[2];
    rate[3] = p->radius * (y[0] * cos(th) - y[1] * sin(th));
    rate[4] = p->radius * (y[0] * sin(th) + y[1] * cos(th));
    rate[5] = y[2] / p->big_lambda;
}

/* Classical Runge–Kutta with steps so small that the error is rounding. */
static inline void reference_run(const reference *p, double *y, const laconic_input *in, double time, int steps) {
    const int n = 6 + p->wheels;
    const double h = time / steps;
    double k[4][6 + LACONIC_MAX_WHEELS], z[6 + LACONIC_MAX_WHEELS];
    for (int step = 0; step < steps; step++) {
        reference_rate(p, y, in, k[0]);
        for (int i = 0; i < n; i++) z[i] = y[i] + 0.5 * h * k[0][i];
        reference_rate(p, z, in, k[1]);
        for (int i = 0; i < n; i++) z[i] = y[i] + 0.5 * h * k[1][i];
        reference_rate(p, z, in, k[2]);
        for (int i = 0; i < n; i++) z[i] = y[i] + h * k[2][i];
        reference_rate(p, z, in, k[3]);
        for (int i = 0; i < n; i++) y[i] += h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
    }
}

#endif
