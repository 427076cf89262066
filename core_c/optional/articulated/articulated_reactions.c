/* Accelerations of one moment, and from them the forces that ground and hinges must deliver, from leaf to root.
 *
 * A body needs W_b = I_b X_b' − a(X_b) − F_b + D_b X_b, and what its children pull. Rows left over deliver their κ
 * (solved with η'), the wheels of a following hinge (W_ω − τ_b)/ℓ along their axle, and the hinge the rest: τ_b is
 * known of free and motor hinges and is W_ω of commanded ones. Wheels of one body that share an axle line share its
 * force (least norm). Wheels of coordinated bodies and of the carriage hold the carriage together: least norm over all
 * of them. What that leaves at body 0 is a check of the whole. */
#include "articulated_step.h"
#include "least_norm.h"

#if LACONIC_MAX_BODIES > 0

#define MAX_HOLDING (2 * LACONIC_MAX_WHEELS)

/* ------------------------------------------------------------------------------ accelerations -- */

static laconic_status moment_of(laconic_articulated_rates *rates, real *multiplier, articulated_sweep *s,
                                articulated_drive *drive, const laconic_articulated_model *m,
                                const laconic_articulated_state *state, const laconic_articulated_input *input,
                                laconic_refusal *why) {
    real eta[LACONIC_MAX_VELOCITIES], target[LACONIC_MAX_LEFT_ROWS];
    laconic_status status = laconic_articulated_input_check(m, input, why);
    if (status != LACONIC_OK) return status;
    laconic_articulated_drive_of(drive, m, input);
    take_posture_of(s, m, state);
    take_eta(eta, m, state);
    const int32_t unknown = sweep_outward(s, m, eta, drive);
    if (unknown != 0) return laconic_articulated_refuse_twist(unknown, m, drive, why);
    sweep_loads(s, m, drive);
    if (drive->rotates) laconic_articulated_add_world(s, m, drive, direction_of_heading(&state->heading));
    sweep_inward(s, m);
    project_root(s, m, eta, true);
    for (int32_t r = 0; r < m->row_count; r++) target[r] = -s->row_bias[r];
    return laconic_articulated_solve(rates->eta_rate, multiplier, s, m, target, why);
}

/* X' = B η' + γ */
static void twist_rates(laconic_articulated_rates *rates, const articulated_sweep *s,
                        const laconic_articulated_model *m) {
    const vector *column = carriage_columns(s, m);
    rates->twist[0] = s->twist[0];
    rates->twist_rate[0] = s->bias[0];
    for (int32_t i = 0; i < m->carriage_dof; i++)
        rates->twist_rate[0] = plus(rates->twist_rate[0], scaled(rates->eta_rate[i], column[i]));
    for (int32_t b = 1; b <= m->body_count; b++) {
        const laconic_link *link = &m->link[b - 1];
        const vector before = minus(rates->twist_rate[link->parent], s->bias[link->parent]);
        vector change = carried(link, s->toward[b - 1], before);
        if (link->motion == LACONIC_MOTION_FOLLOWING) change.z = following_rate(link, change);
        if (link->motion == LACONIC_MOTION_OWN) change.z = own_rate(m, link, rates->eta_rate);
        rates->twist[b] = s->twist[b];
        rates->twist_rate[b] = plus(s->bias[b], change);
    }
}

laconic_status laconic_articulated_rates_of(laconic_articulated_rates *rates, const laconic_articulated_model *model,
                                            const laconic_articulated_state *state,
                                            const laconic_articulated_input *input, laconic_refusal *why) {
    laconic_articulated_rates found = ALL_ZERO;
    articulated_sweep s;
    articulated_drive drive;
    const laconic_status status = moment_of(&found, NULL, &s, &drive, model, state, input, why);
    if (status != LACONIC_OK) return status;
    twist_rates(&found, &s, model);
    *rates = found;
    return LACONIC_OK;
}

/* ---------------------------------------------------------------------------------- reactions -- */

/* What a moment consists of, for the functions below. */
typedef struct reaction_moment {
    laconic_articulated_rates rates;
    articulated_sweep sweep;
    articulated_drive drive;
    real multiplier[LACONIC_MAX_LEFT_ROWS];
    vector needed[BODIES];           /* W_b                                                         */
    vector held[LACONIC_MAX_WHEELS]; /* row of a wheel that holds the carriage, seen at S_0         */
} reaction_moment;

/* W_b of each body by itself. World forces come in by the difference that they make to the loads. */
static void needs_of_bodies(reaction_moment *r, const laconic_articulated_model *m,
                            const laconic_articulated_state *state) {
    for (int32_t b = 0; b <= m->body_count; b++) {
        const laconic_link *link = b > 0 ? &m->link[b - 1] : NULL;
        const vector still = {R(0), R(0), m->mass_kg};
        const vector x = r->rates.twist[b],
                     given = plus(gyroscopic(b > 0 ? link->first_moment : still, x), r->drive.force[b]);
        const vector inert = form_times(b > 0 ? &link->inertia : &m->inertia, r->rates.twist_rate[b]);
        r->needed[b] = plus(minus(inert, given), form_times(b > 0 ? &link->drag : &m->drag, x));
        r->sweep.force[b] = none;
    }
    if (!r->drive.rotates) return;
    laconic_articulated_add_world(&r->sweep, m, &r->drive, direction_of_heading(&state->heading));
    for (int32_t b = 0; b <= m->body_count; b++) r->needed[b] = minus(r->needed[b], r->sweep.force[b]);
}

/* Torques of axles, and the part along of each wheel but for brakes. */
static void along_of_wheels(laconic_articulated_reactions *out, const reaction_moment *r,
                            const laconic_articulated_model *m, const laconic_articulated_input *input) {
    for (int32_t i = 0; i < m->wheel_count; i++) {
        const laconic_articulated_wheel *w = &m->wheel[i];
        const real speed = dot(w->roll, r->rates.twist[w->body]), gain = dot(w->roll, r->rates.twist_rate[w->body]);
        const real torque =
            w->gain_Nm_per_V * input->base.voltage_V[i] - w->damping_Nms * speed + input->base.axle_torque_Nm[i];
        out->wheel_torque_Nm[i] = torque;
        out->along_N[i] = (torque - w->inertia_kgm2 * gain) * w->inverse_arm_per_m;
        out->lateral_N[i] = out->brake_Nm[i] = R(0);
    }
}

/* Gives wheel i the force of one of its rows: along its axle, or of its brake. */
static void give_wheel(laconic_articulated_reactions *out, const laconic_articulated_model *m, int32_t i, bool brake,
                       real force) {
    if (!brake) {
        out->lateral_N[i] += force;
        return;
    }
    out->along_N[i] += force;
    out->brake_Nm[i] += force / m->wheel[i].inverse_arm_per_m;
}

typedef struct holding_rows {
    int32_t count;
    real row[MAX_HOLDING][3]; /* with levers over the vehicle's length */
    int32_t wheel[MAX_HOLDING];
    bool brake[MAX_HOLDING];
} holding_rows;

static void add_holding(holding_rows *h, const laconic_articulated_model *m, vector row, int32_t wheel, bool brake) {
    row.z /= m->length_m;
    store(h->row[h->count], row);
    h->wheel[h->count] = wheel;
    h->brake[h->count++] = brake;
}

static void hold_by_body(holding_rows *h, const laconic_articulated_model *m, int32_t b) {
    for (int32_t i = 0; i < m->wheel_count; i++) {
        if (m->wheel[i].body != b) continue;
        if (square(m->wheel[i].axle) > R(0)) add_holding(h, m, m->wheel[i].axle, i, false);
        if (m->wheel[i].locked) add_holding(h, m, m->wheel[i].pull, i, true);
    }
}

/* Shares a wrench among rows by least norm; returns what they do not deliver. */
static vector share_among(laconic_articulated_reactions *out, const laconic_articulated_model *m, const holding_rows *h,
                          vector needed) {
    real solver[MAX_HOLDING][3];
    vector rest = vector_of(needed.x, needed.y, needed.z / m->length_m);
    const vector wanted = rest;
    if (h->count == 0) return needed;
    laconic_least_norm(solver, (const real(*)[3])h->row, h->count);
    for (int32_t k = 0; k < h->count; k++) {
        const real force = dot(vec(solver[k]), wanted);
        rest = minus(rest, scaled(force, vec(h->row[k])));
        give_wheel(out, m, h->wheel[k], h->brake[k], force);
    }
    return vector_of(rest.x, rest.y, rest.z * m->length_m);
}

/* What its own wheels deliver to a body whose hinge torque is `torque`, where that is known. */
static vector wheels_deliver(const reaction_moment *r, const laconic_articulated_model *m, int32_t b, real torque) {
    const laconic_link *link = &m->link[b - 1];
    vector sum = none;
    for (int32_t k = 0; k < m->row_count; k++)
        if (m->row[k].body == b) sum = plus(sum, scaled(r->multiplier[k], m->row[k].axle));
    if (link->motion == LACONIC_MOTION_FOLLOWING) {
        const real moment = r->needed[b].z - sum.z - torque;
        sum = plus(sum, vector_of(moment * link->axle_per_lever.x, moment * link->axle_per_lever.y, moment));
    }
    return sum;
}

/* One body: its wheels, its hinge, and what it pulls at its parent. */
static void balance_body(laconic_articulated_reactions *out, reaction_moment *r, const laconic_articulated_model *m,
                         int32_t b) {
    const laconic_link *link = &m->link[b - 1];
    const direction d = r->sweep.toward[b - 1];
    holding_rows rows;
    rows.count = 0;
    real torque = R(0);
    if (link->motion <= LACONIC_MOTION_OWN)
        torque = hinge_torque(link, &r->drive, r->sweep.rate[b - 1], r->sweep.angle_rad[b - 1], b);
    const vector delivered = wheels_deliver(r, m, b, torque);
    if (link->motion != LACONIC_MOTION_COORDINATED) {
        hold_by_body(&rows, m, b);
        (void)share_among(out, m, &rows, delivered);
    }
    const vector left = minus(r->needed[b], delivered);
    if (link->motion >= LACONIC_MOTION_PRESCRIBED) torque = left.z;
    const vector force = turned(d, left.x, left.y);
    const vector pull = vector_of(force.x, force.y, link->hinge.x * force.y - link->hinge.y * force.x + torque);
    r->needed[link->parent] = plus(r->needed[link->parent], pull);
    out->hinge_torque_Nm[b - 1] = torque;
    out->hinge_force_N[b - 1][0] = left.x;
    out->hinge_force_N[b - 1][1] = left.y;
}

/* The carriage: its own wheels and those of coordinated bodies, whose axle lines go through their hinges. */
static void balance_carriage(laconic_articulated_reactions *out, const reaction_moment *r,
                             const laconic_articulated_model *m) {
    holding_rows rows;
    rows.count = 0;
    hold_by_body(&rows, m, 0);
    for (int32_t i = 0; i < m->wheel_count; i++) {
        const int32_t b = m->wheel[i].body;
        if (b == 0 || m->link[b - 1].motion != LACONIC_MOTION_COORDINATED) continue;
        if (!(square(m->wheel[i].axle) > R(0))) continue;
        const direction d = r->sweep.toward[b - 1];
        vector row = turned(d, m->wheel[i].axle.x, m->wheel[i].axle.y);
        row.z = m->link[b - 1].hinge.x * row.y - m->link[b - 1].hinge.y * row.x;
        add_holding(&rows, m, row, i, false);
    }
    const vector needed = r->needed[0], rest = share_among(out, m, &rows, needed);
    out->balance = magnitude(rest.x) + magnitude(rest.y) + magnitude(rest.z) / m->length_m;
}

/* A coordinated wheel's lateral force acts on its body; the hinge delivers that much less. */
static void correct_coordinated(laconic_articulated_reactions *out, const laconic_articulated_model *m) {
    for (int32_t i = 0; i < m->wheel_count; i++) {
        const int32_t b = m->wheel[i].body;
        if (b == 0 || m->link[b - 1].motion != LACONIC_MOTION_COORDINATED) continue;
        out->hinge_force_N[b - 1][0] -= out->lateral_N[i] * m->wheel[i].axle.x;
        out->hinge_force_N[b - 1][1] -= out->lateral_N[i] * m->wheel[i].axle.y;
    }
}

/* Largest reaction, margin, and the balance over the largest force. */
static void judge(laconic_articulated_reactions *out, const reaction_moment *r, const laconic_articulated_model *m,
                  const real *normal_N) {
    real scale = size(r->drive.force[0]);
    for (int32_t b = 0; b <= m->body_count; b++) {
        const laconic_form *inertia = b > 0 ? &m->link[b - 1].inertia : &m->inertia;
        scale += size(form_times(inertia, r->rates.twist_rate[b])) + size(r->drive.force[b]);
    }
    out->largest_N = R(0);
    out->no_slip_margin_N = R(0);
    for (int32_t i = 0; i < m->wheel_count; i++) {
        const laconic_articulated_wheel *w = &m->wheel[i];
        const vector x = r->rates.twist[w->body];
        const real parts = magnitude(w->roll.x * x.x) + magnitude(w->roll.y * x.y) + magnitude(w->roll.z * x.z);
        const real along = out->along_N[i], across = out->lateral_N[i];
        scale += w->damping_Nms * parts * magnitude(w->inverse_arm_per_m); /* of which a wheel's speed is the rest */
        const real reaction = laconic_root(along * along + across * across);
        if (!(reaction <= out->largest_N)) out->largest_N = reaction;
        scale += reaction;
        if (normal_N == NULL) continue;
        const real margin = m->friction_coefficient * normal_N[i] - reaction;
        if (i == 0 || !(margin >= out->no_slip_margin_N)) out->no_slip_margin_N = margin;
    }
    out->balance /= scale + LACONIC_EPSILON * R(LACONIC_GRAVITY_M_PER_S2) * m->mass_kg; /* at rest: of the weight */
}

laconic_status laconic_articulated_reactions_of(laconic_articulated_reactions *reactions,
                                                const laconic_articulated_model *model,
                                                const laconic_articulated_state *state,
                                                const laconic_articulated_input *input, const laconic_real *normal_N,
                                                laconic_refusal *why) {
    laconic_articulated_reactions out = ALL_ZERO;
    reaction_moment r;
    const laconic_status status = moment_of(&r.rates, r.multiplier, &r.sweep, &r.drive, model, state, input, why);
    if (status != LACONIC_OK) return status;
    twist_rates(&r.rates, &r.sweep, model);
    needs_of_bodies(&r, model, state);
    along_of_wheels(&out, &r, model, input);
    for (int32_t b = model->body_count; b >= 1; b--) balance_body(&out, &r, model, b);
    balance_carriage(&out, &r, model);
    correct_coordinated(&out, model);
    judge(&out, &r, model, normal_N);
    *reactions = out;
    return LACONIC_OK;
}

#endif
