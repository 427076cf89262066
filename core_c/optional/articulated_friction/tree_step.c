/* One step of a tree on ground with friction: backward Euler for bodies, hinges and wheels together, first order.
 *
 *   1. loops and sampled servos look; loads by statics; the supply's voltage
 *   2. the velocities of all bodies, unchanged in the world, at the angles ψ^ = ψ + ½ h ψ' in the axes at the end:
 *      their momenta Jᵀ m V, and M. Solving M z* = Jᵀ m V would project them onto the hinges there. A projection does
 *      not lengthen, so free motion never gains energy
 *   3. what is linear in ψ' joins M: viscous friction, springs at the next ψ^ + h ψ', drives without limits. All other
 *      laws of hinges are elements of the convex problem of tree_solver.h
 *   4. ψ⁺ = ψ + ½ h (ψ' + ψ'⁺), pose and wheel angles by the mean of old and new speeds, energies by kind
 *
 * A step that the solver refuses is taken in 2, 4 or 8 parts before it is refused. */
#include "tree_step.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION
#define TREE_MOST_PARTS 8
#define TREE_STANDING_M_PER_S R(1e-6) /* else a fading scrub that holds a stress would creep, ever slower, for ever */

/* ------------------------------------------------------------------------------------- free motion -- */

static void tree_find_posture(tree_part *p, const tree_state *s) {
    const tree_model *m = p->m;
    for (int32_t j = 0; j < m->body_count; j++) {
        const tree_body *link = &m->body[j + 1];
        const real turn = R(0.5) * p->h * s->z[3 + j];
        p->at.axes[j + 1] =
            direction_of_binary_angle((laconic_binary_angle)(s->hinge[j].fraction + laconic_binary_angle_of(turn)));
        p->ahead[j] = R(0);
        if (link->stiffness_Nm > R(0) || link->stops || link->servo)
            p->ahead[j] = heading_unwrapped(&s->hinge[j]) + turn;
    }
    tree_place(&p->at, m);
    for (int32_t i = 0; i < m->wheel_count; i++) tree_place_wheel(&p->place[i], &p->at, &m->wheel[i]);
}

/* Velocities that are constant in the world turn against the axes of body 0. */
static void tree_carry(tree_part *p, const tree_state *s) {
    const direction by = laconic_direction_of_angle(p->h * s->z[2]);
    for (int32_t b = 0; b <= p->m->body_count; b++) {
        const vector v = s->body[b];
        p->carried[b] = vector_of(by.cosine * v.x + by.sine * v.y, by.cosine * v.y - by.sine * v.x, v.z);
    }
}

static vector tree_seen(direction heading, const real world[2]) {
    return vector_of(heading.cosine * world[0] + heading.sine * world[1],
                     heading.cosine * world[1] - heading.sine * world[0], R(0));
}

/* Outer forces and the slope's pull on each body that is pulled, about its centre of mass. */
static void tree_pull(tree_part *p, const tree_state *s) {
    const laconic_input *in = &p->in->hinged.base;
    const bool world = in->world_force_N[0] != R(0) || in->world_force_N[1] != R(0);
    p->pulled = p->m->sloped ? p->m->body_count : 0;
    for (int32_t b = 1; b <= p->pulled; b++) p->pull[b] = none;
    p->pull[0] = vector_of(in->body_force_N[0], in->body_force_N[1], in->body_moment_Nm);
    p->end = direction_with(R(1), R(0));
    if (!world && !p->m->sloped) return;
    p->end = direction_of_binary_angle(
        (laconic_binary_angle)(s->heading.fraction + laconic_binary_angle_of(p->h * s->z[2])));
    const vector force = tree_seen(p->end, in->world_force_N), down = tree_seen(p->end, p->m->pull_m_per_s2);
    p->pull[0] = plus(p->pull[0], force);
    p->pull[0].z += in->world_force_point_m[0] * force.y - in->world_force_point_m[1] * force.x;
    for (int32_t b = 0; b <= p->pulled; b++) p->pull[b] = plus(p->pull[b], scaled(p->m->body[b].mass_kg, down));
}

INLINE vector tree_momentum(const tree_part *p, int32_t b) {
    const tree_body *link = &p->m->body[b];
    const vector v = p->carried[b];
    return vector_of(link->mass_kg * v.x, link->mass_kg * v.y, link->yaw_inertia_kgm2 * v.z);
}

/* Jᵀ (m V + h force) into free; M into the factor's place. */
static void tree_find_momenta(tree_part *p) {
    vector momentum[TREE_BODIES];
    momentum[0] = tree_momentum(p, 0);
    for (int32_t b = 1; b <= p->m->body_count; b++) momentum[b] = tree_momentum(p, b);
    for (int32_t b = 0; b <= p->pulled; b++) momentum[b] = plus(momentum[b], scaled(p->h, p->pull[b]));
    tree_gather(&p->factor.l, &p->problem.free, &p->at, p->m, momentum);
}

/* ------------------------------------------------------------------------------------------ hinges -- */

/* An element of the last bundle. */
INLINE const tree_element *tree_new_element(tree_problem *q, real low, real high, real compliance, real target,
                                            real guess) {
    tree_element *e = &q->element[q->element_count++];
    e->low = low;
    e->high = high;
    e->compliance = compliance;
    e->target = target;
    e->q = guess;
    return e;
}

INLINE tree_bundle *tree_new_bundle(tree_problem *q, const tree_body *on) {
    tree_bundle *b = &q->bundle[q->bundle_count];
    b->on = on;
    b->first = q->element + q->element_count;
    return b;
}

/* Keeps the bundle if it has elements. */
INLINE void tree_close_bundle(tree_problem *q, tree_bundle *b) {
    b->end = q->element + q->element_count;
    if (b->end > b->first) q->bundle_count++;
}

/* A gap that ψ^ has passed, by rounding or a larger step than the last, counts as 0: a stop never throws. */
static void tree_add_stops(tree_part *p, int32_t b, const tree_state *s) {
    const tree_body *link = &p->m->body[b];
    const real above = link->stop_high_rad - p->ahead[b - 1], below = link->stop_low_rad - p->ahead[b - 1];
    const real *torque_Nm = s->stop_Nm[b - 1];
    p->hinge[b - 1].stop = tree_new_element(&p->problem, R(0), LACONIC_REAL_MAX, R(0),
                                            above > R(0) ? above / p->h : R(0), p->h * torque_Nm[0]);
    (void)tree_new_element(&p->problem, -LACONIC_REAL_MAX, R(0), R(0), below < R(0) ? below / p->h : R(0),
                           p->h * torque_Nm[1]);
}

static void tree_add_prescribed(tree_part *p, int32_t b, const tree_state *s) {
    const real rate = p->in->hinged.hinge_rate_rad_per_s[b - 1];
    p->hinge[b - 1].drive =
        tree_new_element(&p->problem, -LACONIC_REAL_MAX, LACONIC_REAL_MAX, R(0), rate, p->h * s->drive_Nm[b - 1]);
    p->problem.free.hinge[b - 1] += p->m->body[b].padding_kgm2 * rate;
}

/* A drive's torque start − slope ψ', cut to the limit: with both an element, else part of the matrix. */
static void tree_drive_hinge(tree_part *p, int32_t b, real start, real slope, real limit, const tree_state *s) {
    tree_hinge_part *hinge = &p->hinge[b - 1];
    const bool limited = limit < LACONIC_REAL_MAX;
    if (limited && slope > R(0)) {
        hinge->drive = tree_new_element(&p->problem, -p->h * limit, p->h * limit, R(1) / (p->h * slope), start / slope,
                                        p->h * s->drive_Nm[b - 1]);
        return;
    }
    hinge->torque_Nm = limited ? cut(start, limit) : start;
    hinge->slope_Nms = slope;
    p->problem.free.hinge[b - 1] += p->h * hinge->torque_Nm;
    p->factor.l.node[b - 1].along[p->m->body[b].depth - 1] += p->h * slope;
}

static void tree_add_servo(tree_part *p, int32_t b, const tree_state *s) {
    const tree_body *link = &p->m->body[b];
    const real limit = link->servo_limit_Nm > R(0) ? link->servo_limit_Nm : LACONIC_REAL_MAX;
    if (link->sampled) {
        tree_drive_hinge(p, b, s->control_command[b - 1], R(0), LACONIC_REAL_MAX, s);
        return;
    }
    const real start = link->servo_gain_Nm_per_rad * (p->in->hinge_angle_rad[b - 1] - p->ahead[b - 1]) +
                       link->servo_damping_Nms * p->in->hinged.hinge_rate_rad_per_s[b - 1];
    tree_drive_hinge(p, b, start, link->servo_gain_Nm_per_rad * p->h + link->servo_damping_Nms, limit, s);
}

static void tree_add_motor(tree_part *p, int32_t b, const tree_state *s) {
    const laconic_tree_motor *motor = &p->m->motor[p->m->wheel_count + b - 1];
    const real volts = within_supply(tree_hinge_command(p->m, p->in, s, b), p->terminal_V);
    tree_drive_hinge(p, b, motor->gain_Nm_per_V * volts, motor->back_emf_Nms, motor->torque_limit_Nm, s);
}

static void tree_add_hinge(tree_part *p, int32_t b, const tree_state *s) {
    const tree_body *link = &p->m->body[b];
    tree_hinge_part *hinge = &p->hinge[b - 1];
    tree_bundle *elements = tree_new_bundle(&p->problem, link);
    const real spring = link->stiffness_Nm, h = p->h, bound = h * link->dry_friction_Nm;
    real torque = p->in->hinged.hinge_torque_Nm[b - 1];
    if (spring > R(0)) torque += spring * (link->rest_rad - p->ahead[b - 1]);
    p->problem.free.hinge[b - 1] += h * torque;
    p->factor.l.node[b - 1].along[link->depth - 1] += h * (link->damping_Nms + h * spring);
    hinge->drive = hinge->dry = hinge->stop = NULL;
    hinge->torque_Nm = hinge->slope_Nms = R(0);
    if (link->hinge == LACONIC_HINGE_PRESCRIBED) tree_add_prescribed(p, b, s);
    if (link->servo) tree_add_servo(p, b, s);
    if (tree_has_motor(p->m, b)) tree_add_motor(p, b, s);
    if (bound > R(0)) hinge->dry = tree_new_element(&p->problem, -bound, bound, R(0), R(0), h * s->dry_Nm[b - 1]);
    if (link->stops) tree_add_stops(p, b, s);
    tree_close_bundle(&p->problem, elements);
}

INLINE void tree_transform_hinge(tree_part *p, tree_bundle *b, bool star) {
    const tree_body *link = b->on;
    tree_row *row = &b->row;
    row->base = none;
    for (int32_t k = 0; k < link->depth - 1 && !star; k++) row->along[k] = R(0);
    row->along[star ? 0 : link->depth - 1] = R(1);
    tree_back_row(row, &p->factor, link, star);
}

/* ------------------------------------------------------------------------------------------ wheels -- */

INLINE void tree_fill_rows(tree_contact *c, const tree_part *p, const tree_place_of_wheel *w, bool star) {
    const direction u = w->pull;
    const real k = c->wheel->drag;
    c->row[0].base = vector_of(u.cosine, u.sine, w->x * u.sine - w->y * u.cosine);
    c->row[1].base = vector_of(-k * u.sine, k * u.cosine, k * (w->x * u.cosine + w->y * u.sine));
    for (int32_t l = 0; l < tree_depth(c->on, star); l++) {
        const int32_t b = c->on->path[l] + 1;
        const real x = w->x - p->at.hinge_x[b], y = w->y - p->at.hinge_y[b];
        c->row[0].along[l] = x * u.sine - y * u.cosine;
        c->row[1].along[l] = k * (x * u.cosine + y * u.sine);
    }
    tree_back_row(&c->row[0], &p->factor, c->on, star);
    tree_back_row(&c->row[1], &p->factor, c->on, star);
}

INLINE void tree_load_wheel(tree_contact *c, const tree_part *p, const tree_state *s, int32_t i) {
    const laconic_tree_rim *w = c->wheel;
    const laconic_tree_motor *a = &p->m->motor[i];
    const bool driven = a->circuit == LACONIC_MOTOR_DRIVEN;
    const real volts = driven ? within_supply(p->in->hinged.base.voltage_V[i], p->terminal_V) : R(0);
    friction_load *l = &c->load;
    l->grip = p->h * w->friction_coefficient * p->loads.carried_N[i];
    l->axle = p->h * w->dry_Nm;
    l->drive = p->h * a->gain_Nm_per_V * volts;
    l->drive_slope = a->circuit == LACONIC_MOTOR_OPEN ? R(0) : p->h * a->back_emf_Nms;
    l->drive_limit = driven && a->torque_limit_Nm < LACONIC_REAL_MAX ? p->h * a->torque_limit_Nm : LACONIC_REAL_MAX;
    l->viscous = p->h * a->viscous_Nms;
    l->free_speed = s->wheel_speed_rad_per_s[i] + p->h * p->in->hinged.base.axle_torque_Nm[i] / w->inertia_kgm2;
    c->push = w->inertia_kgm2 * l->free_speed;
    if (!w->locked) return;
    l->axle = R(2) * w->rim_size * l->grip + w->inertia_kgm2; /* more than the contact can overcome */
    l->drive = l->drive_slope = l->viscous = l->free_speed = c->push = R(0);
}

RARE real tree_creep_of(const tree_contact *c, const tree_state *s, int32_t i) {
    const real rim_speed = c->wheel->radius_m * magnitude(s->wheel_speed_rad_per_s[i]);
    if (!(c->load.grip > R(0)) || rim_speed < TREE_STANDING_M_PER_S) return R(0);
    return rim_speed * c->wheel->creep / c->load.grip;
}

RARE void tree_add_scrub(tree_part *p, const tree_state *s, int32_t i) {
    const laconic_tree_rim *w = &p->m->wheel[i];
    const real bound = p->h * w->friction_coefficient * p->loads.carried_N[i] * w->scrub_radius_m;
    if (!(bound > R(0))) return;
    tree_bundle *b = tree_new_bundle(&p->problem, &p->m->body[w->body]);
    const real rim_speed = w->radius_m * magnitude(s->wheel_speed_rad_per_s[i]);
    const bool fades = w->scrub_fade_m > R(0) && rim_speed > TREE_STANDING_M_PER_S;
    b->row.base = vector_of(R(0), R(0), R(1));
    for (int32_t k = 0; k < b->on->depth; k++) b->row.along[k] = R(1);
    tree_back_row(&b->row, &p->factor, b->on, false);
    p->scrub[i] = tree_new_element(&p->problem, -bound, bound, fades ? rim_speed / (w->scrub_fade_m * bound) : R(0),
                                   R(0), p->h * s->scrub_Nm[i]);
    tree_close_bundle(&p->problem, b);
}

INLINE void tree_add_wheel(tree_part *p, const tree_state *s, int32_t i, bool star) {
    tree_contact *c = &p->problem.contact[i];
    c->wheel = &p->m->wheel[i];
    c->on = &p->m->body[c->wheel->body];
    tree_fill_rows(c, p, &p->place[i], star);
    tree_load_wheel(c, p, s, i);
    c->creep = c->wheel->creep > R(0) ? tree_creep_of(c, s, i) : R(0);
    for (int k = 0; k < 2; k++) c->impulse[k] = p->h * s->grip_N[i][k];
    p->scrub[i] = NULL;
    if (c->wheel->scrub_radius_m > R(0)) tree_add_scrub(p, s, i);
}

/* --------------------------------------------------------------------------------------- the step -- */

INLINE void tree_build_rows(tree_part *p, const tree_state *s, bool star) {
    for (int32_t b = 0; b < p->problem.bundle_count; b++) tree_transform_hinge(p, &p->problem.bundle[b], star);
    for (int32_t i = 0; i < p->m->wheel_count; i++) tree_add_wheel(p, s, i, star);
}

RARE void tree_build_rows_deep(tree_part *p, const tree_state *s) { tree_build_rows(p, s, false); }

static void tree_build(tree_part *p, const tree_state *s) {
    tree_problem *q = &p->problem;
    q->m = p->m;
    q->contact_count = p->m->wheel_count;
    q->element_count = q->bundle_count = 0;
    for (int32_t b = 1; b <= p->m->body_count; b++) tree_add_hinge(p, b, s);
    laconic_tree_factor(&p->factor, p->m);
    tree_back_vector(&q->free, &p->factor, p->m);
    if (p->m->star)
        tree_build_rows(p, s, true);
    else
        tree_build_rows_deep(p, s);
    laconic_tree_prepare_problem(q);
}

static laconic_status tree_take(tree_part *p, tree_state *s) {
    tree_find_posture(p, s);
    laconic_tree_loads(&p->loads, p->m, &p->at, p->place, s);
    p->terminal_V = laconic_tree_terminal_voltage(p->m, p->in, s);
    tree_carry(p, s);
    tree_pull(p, s);
    tree_find_momenta(p);
    tree_build(p, s);
    p->passes = laconic_tree_solve(&p->problem);
    if (p->passes == 0) return LACONIC_STEP_UNSOLVED;
    tree_forward(p->z, &p->problem.nu, &p->factor, p->m);
    real sum = R(0);
    for (int32_t k = 0; k < 3 + p->m->body_count; k++) sum += magnitude(p->z[k]);
    return sum <= TREE_LARGEST ? laconic_tree_accept(p, s) : LACONIC_OVERFLOW;
}

RARE laconic_status tree_take_parts(tree_part *p, tree_state *s, int32_t count) {
    tree_state end = *s;
    laconic_status status = LACONIC_OK;
    for (int32_t k = 0; k < count && status == LACONIC_OK; k++) status = tree_take(p, &end);
    if (status == LACONIC_OK) *s = end;
    return status;
}

static laconic_status tree_finite(real value, int32_t field, int32_t item, laconic_refusal *why) {
    if (is_finite(value)) return LACONIC_OK;
    return refuse(why, LACONIC_NOT_FINITE, (laconic_field)field, item, value, R(0));
}

/* Finds which number it is. */
RARE laconic_status tree_refuse_input(const tree_model *m, const laconic_tree_input *in, laconic_refusal *why) {
    const laconic_articulated_input *h = &in->hinged;
    laconic_status status = LACONIC_OK;
    for (int32_t i = 0; status == LACONIC_OK && i < m->wheel_count; i++) {
        status = tree_finite(h->base.voltage_V[i], LACONIC_FIELD_VOLTAGE, i + 1, why);
        if (status == LACONIC_OK)
            status = tree_finite(h->base.axle_torque_Nm[i], LACONIC_FIELD_AXLE_TORQUE, i + 1, why);
    }
    for (int32_t b = 0; status == LACONIC_OK && b < m->body_count; b++) {
        status = tree_finite(h->hinge_voltage_V[b], LACONIC_FIELD_OF_HINGE_VOLTAGE, b + 1, why);
        if (status == LACONIC_OK)
            status = tree_finite(h->hinge_torque_Nm[b], LACONIC_FIELD_OF_HINGE_TORQUE, b + 1, why);
        if (status == LACONIC_OK)
            status = tree_finite(h->hinge_rate_rad_per_s[b], LACONIC_FIELD_OF_HINGE_RATE, b + 1, why);
        if (status == LACONIC_OK)
            status = tree_finite(in->hinge_angle_rad[b], LACONIC_FIELD_OF_HINGE_ANGLE, b + 1, why);
    }
    for (int32_t k = 0; status == LACONIC_OK && k < 2; k++) {
        status = tree_finite(h->base.body_force_N[k], LACONIC_FIELD_BODY_FORCE, k + 1, why);
        if (status == LACONIC_OK) status = tree_finite(h->base.world_force_N[k], LACONIC_FIELD_WORLD_FORCE, k + 1, why);
        if (status == LACONIC_OK)
            status = tree_finite(h->base.world_force_point_m[k], LACONIC_FIELD_WORLD_FORCE_POINT, k + 1, why);
    }
    return status == LACONIC_OK ? tree_finite(h->base.body_moment_Nm, LACONIC_FIELD_BODY_MOMENT, 0, why) : status;
}

/* Not finite where a number is not; or where finite ones are so large that their sum is not. */
static real tree_sum_of(const tree_model *m, const laconic_tree_input *in) {
    const laconic_input *base = &in->hinged.base;
    real sum = base->body_force_N[0] + base->body_force_N[1] + base->body_moment_Nm + base->world_force_N[0] +
               base->world_force_N[1] + base->world_force_point_m[0] + base->world_force_point_m[1];
    for (int32_t i = 0; i < m->wheel_count; i++) sum += base->voltage_V[i] + base->axle_torque_Nm[i];
    for (int32_t b = 0; b < m->body_count; b++)
        sum += in->hinged.hinge_voltage_V[b] + in->hinged.hinge_torque_Nm[b] + in->hinged.hinge_rate_rad_per_s[b] +
               in->hinge_angle_rad[b];
    return sum;
}

static laconic_status tree_check_step(const tree_model *m, real step_s, const tree_state *s,
                                      const laconic_tree_input *held, laconic_refusal *why) {
    bool room = heading_has_room(&s->heading);
    if (!is_finite(step_s)) return refuse(why, LACONIC_NOT_FINITE, LACONIC_FIELD_STEP, 0, step_s, R(0));
    if (!(step_s > R(0))) return refuse(why, LACONIC_NOT_POSITIVE, LACONIC_FIELD_STEP, 0, step_s, R(0));
    if (!is_finite(tree_sum_of(m, held))) {
        const laconic_status status = tree_refuse_input(m, held, why);
        if (status != LACONIC_OK) return status;
    }
    for (int32_t b = 0; b < m->body_count; b++) room = room && heading_has_room(&s->hinge[b]);
    return room ? LACONIC_OK : refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, R(0), R(0));
}

/* The step itself, or parts of it. */
static laconic_status tree_take_step(const tree_model *m, real step_s, tree_state *state, const laconic_tree_input *in,
                                     laconic_refusal *why) {
    tree_part p;
    p.m = m;
    p.in = in;
    p.h = step_s;
    laconic_status status = tree_take(&p, state);
    for (int32_t count = 2; count <= TREE_MOST_PARTS && status == LACONIC_STEP_UNSOLVED; count *= 2) {
        p.h = step_s / (real)count;
        status = tree_take_parts(&p, state, count);
    }
    if (status == LACONIC_OK) return status;
    return refuse(why, status, status == LACONIC_STEP_UNSOLVED ? LACONIC_FIELD_STEP : LACONIC_FIELD_NONE, 0, step_s,
                  R(0));
}

/* With loops and sampled servos, which a refusal leaves as they were. */
RARE laconic_status tree_take_controlled_step(const tree_model *m, real step_s, tree_state *state,
                                              const laconic_tree_input *in, laconic_refusal *why) {
    int32_t wait[TREE_HINGES];
    real command[TREE_HINGES];
    for (int32_t b = 0; b < m->body_count; b++) {
        wait[b] = state->control_wait[b];
        command[b] = state->control_command[b];
    }
    laconic_status status = laconic_tree_control(m, step_s, state, in, why);
    if (status == LACONIC_OK) status = tree_take_step(m, step_s, state, in, why);
    for (int32_t b = 0; status != LACONIC_OK && b < m->body_count; b++) {
        state->control_wait[b] = wait[b];
        state->control_command[b] = command[b];
    }
    return status;
}

laconic_status laconic_tree_step(const laconic_tree_model *model, laconic_real step_s, laconic_tree_state *state,
                                 const laconic_tree_input *held, laconic_refusal *why) {
    const laconic_status status = tree_check_step(model, step_s, state, held, why);
    if (status != LACONIC_OK) return status;
    if (model->controlled) return tree_take_controlled_step(model, step_s, state, held, why);
    return tree_take_step(model, step_s, state, held, why);
}

#endif
