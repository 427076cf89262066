/* η' of a posture, as steps need it. Bodies on which nothing hangs, which most are, are done in one visit on the way
 * outward: their forces and inertias count at the parent at once, from registers. Others wait for their children. */
#ifndef LACONIC_ARTICULATED_VISIT_H
#define LACONIC_ARTICULATED_VISIT_H

#include "articulated_equations.h"

#if LACONIC_MAX_BODIES > 0

/* A following body on which nothing hangs: its forces and inertia count at the parent at once, from registers, by
 * constants for V alone, I and D with ω = −n·V/ℓ put in. `bias`: γ of the parent; NULL: it is 0. */
INLINE void visit_follower(articulated_sweep *s, const laconic_link *link, const articulated_drive *drive, int32_t b,
                           const vector *bias) {
    const direction d = s->toward[b - 1];
    const vector parent = s->twist[link->parent], force = drive->force[b];
    vector v = carried(link, d, parent), g = bias != NULL ? carried(link, d, *bias) : none;
    const real mx = link->axle_per_lever.x, my = link->axle_per_lever.y;
    v.z = -(mx * v.x + my * v.y);
    const real rate = v.z - parent.z, gx = g.x + rate * v.y, gy = g.y - rate * v.x;
    const vector a = gyroscopic(link->first_moment, v);
    const real torque = hinge_torque(link, drive, rate, s->angle_rad[b - 1], b), moment = a.z + force.z + torque;
    const laconic_form *in = &link->followed_inertia, *drag = &link->followed_drag;
    real x = a.x + force.x - mx * moment - (in->xx * gx + in->xy * gy);
    real y = a.y + force.y - my * moment - (in->xy * gx + in->yy * gy);
    if (LACONIC_WITH_DAMPING && link->drags) {
        x -= drag->xx * v.x + drag->xy * v.y;
        y -= drag->xy * v.x + drag->yy * v.y;
    }
    const vector pull = turned(d, x, y);
    const plane_form plane = {in->xx, in->xy, in->yy};
    vector *at = &s->force[link->parent];
    at->x += pull.x;
    at->y += pull.y;
    at->z += link->hinge.x * pull.y - link->hinge.y * pull.x - torque;
    pull_plane(&s->inertia[link->parent], link, d, plane);
    s->twist[b] = v;
    s->rate[b - 1] = rate;
}

/* Another body on which nothing hangs: its own hinge and its rows left over are its alone. */
INLINE void visit_other_leaf(articulated_sweep *s, const laconic_articulated_model *m, const articulated_drive *drive,
                             int32_t b, direction d, const child_motion *c) {
    const laconic_link *link = &m->link[b - 1];
    const laconic_form *in = &link->inertia;
    vector w = load_of(link, drive->force[b], c->twist, c->bias);
    if (link->motion <= LACONIC_MOTION_OWN) {
        const real torque = hinge_torque(link, drive, c->rate, s->angle_rad[b - 1], b);
        w.z += torque;
        s->force[link->parent].z -= torque;
    }
    if (link->motion == LACONIC_MOTION_OWN) {
        const int32_t i = m->carriage_dof + link->column;
        s->mass[i][i] = in->ww;
        s->push[i] = w.z;
        s->own[link->column] = pulled(link, d, vector_of(in->xw, in->yw, R(0)));
    }
    for (int32_t r = link->first_row; r < link->row_end; r++) {
        const vector axle = m->row[r].axle;
        if (link->motion == LACONIC_MOTION_OWN) s->row_of_own[r][link->column] = axle.z;
        s->row[r] = pulled(link, d, axle);
        s->row_bias[r] = dot(axle, c->bias);
        s->row_value[r] = dot(axle, c->twist);
    }
    pull_inertia(&s->inertia[link->parent], link, d, in);
    s->force[link->parent] = plus(s->force[link->parent], pulled(link, d, w));
}

/* A body on which others hang waits for them with its load and inertia. */
INLINE void visit_inner(articulated_sweep *s, const laconic_link *link, const articulated_drive *drive, int32_t b,
                        const child_motion *c) {
    s->bias[b] = c->bias;
    s->force[b] = load_of(link, drive->force[b], c->twist, c->bias);
    s->inertia[b] = link->inertia;
    if (link->motion > LACONIC_MOTION_OWN) return;
    const real torque = hinge_torque(link, drive, c->rate, s->angle_rad[b - 1], b);
    s->force[b].z += torque;
    s->force[link->parent].z -= torque;
}

/* A coordinated body on which nothing hangs rolls along its ξ with σμ, μ = |w|/|T|, whatever ψ: X = (σμ, 0, ω) with
 * γ = (σμ', 0, σU_θ' + ψ''). So it counts along U at once, and no vector is turned. */
INLINE bool visit_module(articulated_sweep *s, const articulated_drive *drive, const laconic_link *link, real sigma,
                         int32_t b) {
    const coordinated_motion c = coordinate(s, link, drive, b);
    const laconic_form *in = &link->inertia, *drag = &link->drag;
    const real mu = c.size * s->inverse_size[0], yaw = s->along[0].z;
    const vector v = vector_of(sigma * mu, R(0), sigma * yaw + c.rate), force = drive->force[b];
    const real gx = v.x * (c.growth - s->along_share), gw = sigma * s->along_rate.z + c.acceleration;
    real x = v.z * v.z * link->first_moment.x + force.x - (in->xx * gx + in->xw * gw);
    real moment = force.z - v.z * link->first_moment.x * v.x - (in->xw * gx + in->ww * gw);
    if (LACONIC_WITH_DAMPING && link->drags) {
        x -= drag->xx * v.x + drag->xw * v.z;
        moment -= drag->xw * v.x + drag->ww * v.z;
    }
    s->module_push += mu * x + yaw * moment;
    s->module_mass += mu * (in->xx * mu + R(2) * in->xw * yaw) + in->ww * yaw * yaw;
    s->twist[b] = v;
    s->rate[b - 1] = c.rate;
    return c.size > R(0);
}

/* One body, from its parent outward. Returns false for a coordinated hinge that gets no direction. */
INLINE bool visit(articulated_sweep *s, const laconic_articulated_model *m, const real *eta,
                  const articulated_drive *drive, int32_t b) {
    const laconic_link *link = &m->link[b - 1];
    const vector *bias = link->parent == 0 && !m->coordinated ? NULL : &s->bias[link->parent];
    if (link->is_plain_follower) {
        visit_follower(s, link, drive, b, bias);
        return true;
    }
    real rate = drive->rate[b - 1], acceleration = drive->acceleration[b - 1];
    if (link->motion == LACONIC_MOTION_COORDINATED) {
        if (link->is_leaf) return visit_module(s, drive, link, eta[0], b);
        const coordinated_motion commanded = coordinate(s, link, drive, b);
        if (!(commanded.size > R(0))) return false;
        rate = commanded.rate;
        acceleration = commanded.acceleration;
    }
    const direction d = s->toward[b - 1];
    const child_motion c =
        motion_of_child(link, d, s->twist[link->parent], bias, own_rate_or_0(m, link, eta), rate, acceleration);
    s->twist[b] = c.twist;
    s->rate[b - 1] = c.rate;
    if (!link->is_leaf)
        visit_inner(s, link, drive, b, &c);
    else
        visit_other_leaf(s, m, drive, b, d, &c);
    return true;
}

/* Inner bodies, to the root. */
INLINE void gather(articulated_sweep *s, const laconic_articulated_model *m) {
    for (int32_t b = m->last_inner; b >= 1; b--) {
        const laconic_link *link = &m->link[b - 1];
        if (link->is_leaf) continue;
        begin_rows(s, m, b);
        if (link->motion == LACONIC_MOTION_OWN) meet_own(s, m, b, &s->inertia[b], s->force[b].z);
        if (m->own_count + m->row_count > 0) pull_others(s, m, b);
        pull_inertia(&s->inertia[link->parent], link, s->toward[b - 1], &s->inertia[b]);
        s->force[link->parent] = plus(s->force[link->parent], pulled(link, s->toward[b - 1], s->force[b]));
    }
}

/* The same with forces that are fixed in the world: loads change after all twists are known. */
int32_t laconic_articulated_sweep_rotating(articulated_sweep *s, const laconic_articulated_model *m, const real *eta,
                                           const articulated_drive *drive, direction heading);

/* Twists, forces and inertias of a posture, summed at the root. Returns as sweep_outward does. */
INLINE int32_t sweep_all(articulated_sweep *s, const laconic_articulated_model *m, const real *eta,
                         const articulated_drive *drive, direction heading) {
    const laconic_form zero = {R(0), R(0), R(0), R(0), R(0), R(0)};
    if (drive->rotates) return laconic_articulated_sweep_rotating(s, m, eta, drive, heading);
    if (m->coordinated && !take_unit_twist(s, m, drive)) return -1;
    sweep_root(s, m, eta);
    s->force[0] = load_of_carriage(s, m, drive->force[0]);
    s->inertia[0] = zero;
    s->module_mass = s->module_push = R(0);
    if (m->own_count + m->row_count > 0) begin_inward(s, m);
    for (int32_t b = 1; b <= m->body_count; b++)
        if (!visit(s, m, eta, drive, b)) return b;
    gather(s, m);
    return 0;
}

/* η' and all twists of a posture whose directions are set. `correction` (NULL: not wanted) is the change of η that
 * restores the rows left over. */
INLINE laconic_status accelerations(real *eta_rate, real *correction, articulated_sweep *s,
                                    const laconic_articulated_model *m, const real *eta, const articulated_drive *drive,
                                    direction heading, laconic_refusal *why) {
    const int32_t unknown = sweep_all(s, m, eta, drive, heading);
    if (unknown != 0) return laconic_articulated_refuse_twist(unknown, m, drive, why);
    project_root(s, m, eta, true);
    if (solve_small(eta_rate, s, m) || solve_steered(eta_rate, correction, s, m)) return LACONIC_OK;
    return laconic_articulated_solve_rates(eta_rate, correction, s, m, why);
}

#endif
#endif
