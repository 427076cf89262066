/* What a step of a tree leaves in the state: motion, forces for the next guess, energies by kind.
 *
 * With V⁺ = J z⁺ and V the carried velocities of the bodies, the equation of the step is Jᵀ m (V⁺ − V) = impulses, so
 *     T⁺ − T = Σ impulse · speed⁺ − ½ Σ m |V⁺ − V|² − ½ Σ J (s⁺ − s)²
 * exactly: the last two sums are the numerical loss, which includes that of the projection. A spring acts at the next
 * ψ^ = ψ^ + h ψ'⁺ and loses ½ k h² ψ'⁺² there. */
#include "tree_step.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

typedef struct tree_energies { /* of one part, in J */
    real supplied, outer, servo, slip, scrub, axle, hinge, stop, motor, numerical, spring;
} tree_energies;

static void tree_enter_bodies(tree_energies *e, const tree_part *p, const tree_state *s) {
    for (int32_t b = 0; b <= p->pulled; b++) e->outer += p->h * dot(p->pull[b], s->body[b]);
    for (int32_t b = 0; b <= p->m->body_count; b++) {
        const tree_body *link = &p->m->body[b];
        const vector change = minus(s->body[b], p->carried[b]);
        e->numerical += R(0.5) * (link->mass_kg * (change.x * change.x + change.y * change.y) +
                                  link->yaw_inertia_kgm2 * change.z * change.z);
    }
}

/* The electrical side of a motor at this speed. Returns its torque. */
INLINE real tree_enter_motor(tree_energies *e, const tree_part *p, tree_state *s, int32_t axis, real command_V,
                             real speed) {
    const laconic_tree_motor *a = &p->m->motor[axis];
    const motor_state motor = tree_motor_at(a, command_V, speed, p->terminal_V);
    const bool known = a->ampere_per_Nm != R(0); /* the electrical side */
    const real fed = p->h * motor.voltage_V * (known ? motor.current_A : a->gain_Nm_per_V * speed);
    s->current_A[axis] = motor.current_A;
    s->limit[axis] = (int32_t)motor.limit;
    const real torque = motor.torque - a->viscous_Nms * speed;
    e->supplied += fed;
    e->motor += fed - p->h * torque * speed;
    return torque;
}

static void tree_enter_wheel(tree_energies *e, const tree_part *p, tree_state *s, int32_t i) {
    const tree_contact *c = &p->problem.contact[i];
    const laconic_tree_rim *w = c->wheel;
    const real old = s->wheel_speed_rad_per_s[i], speed = c->speed, change = speed - old;
    const real torque = p->in->hinged.base.axle_torque_Nm[i];
    e->slip += c->impulse[0] * (c->moved[0] - w->rim[0] * speed) + c->impulse[1] * (c->moved[1] - w->rim[1] * speed);
    s->grip_N[i][0] = c->impulse[0] / p->h;
    s->grip_N[i][1] = c->impulse[1] / p->h;
    e->axle += p->h * w->dry_Nm * magnitude(speed);
    e->outer += p->h * torque * speed;
    e->numerical += R(0.5) * w->inertia_kgm2 * change * change;
    s->motor_torque_Nm[i] = torque;
    if (p->m->motor[i].acts)
        s->motor_torque_Nm[i] += tree_enter_motor(e, p, s, i, p->in->hinged.base.voltage_V[i], speed);
    sum_add(&s->wheel_angle_rad[i], R(0.5) * p->h * (old + speed));
    s->wheel_speed_rad_per_s[i] = speed;
    s->scrub_Nm[i] = R(0);
    if (p->scrub[i] == NULL) return;
    s->scrub_Nm[i] = p->scrub[i]->q / p->h;
    e->scrub += p->scrub[i]->q * s->body[w->body].z;
}

/* Torque on the body that servo, motor or prescribed rate gave. */
static real tree_drive_torque(const tree_part *p, tree_state *s, int32_t b) {
    const tree_hinge_part *hinge = &p->hinge[b - 1];
    s->drive_Nm[b - 1] = R(0);
    if (hinge->drive == NULL) return hinge->torque_Nm - hinge->slope_Nms * p->z[2 + b];
    s->drive_Nm[b - 1] = hinge->drive->q / p->h;
    return -s->drive_Nm[b - 1];
}

static void tree_enter_drive(tree_energies *e, const tree_part *p, tree_state *s, int32_t b) {
    const int32_t axis = p->m->wheel_count + b - 1;
    const real torque = tree_drive_torque(p, s, b), rate = p->z[2 + b];
    if (tree_has_motor(p->m, b)) {
        const real command_V = tree_hinge_command(p->m, p->in, s, b);
        if (p->m->motor[axis].acts) s->motor_torque_Nm[axis] = tree_enter_motor(e, p, s, axis, command_V, rate);
        return;
    }
    const bool limited = p->m->body[b].servo && p->hinge[b - 1].drive != NULL;
    const bool at_limit = limited && magnitude(torque) >= p->m->body[b].servo_limit_Nm;
    s->motor_torque_Nm[axis] = torque;
    s->limit[axis] = (int32_t)(at_limit ? LACONIC_LIMIT_CURRENT : LACONIC_LIMIT_NONE);
    e->servo += p->h * torque * rate;
}

/* The spring's energy moved from where it was booked to ψ^ and on to the next ψ^. */
static void tree_enter_spring(tree_energies *e, const tree_part *p, int32_t b) {
    const tree_body *link = &p->m->body[b];
    const real moved = p->h * p->z[2 + b], off = p->ahead[b - 1] + moved - link->rest_rad;
    const real before = p->ahead[b - 1] - link->rest_rad;
    if (!(link->stiffness_Nm > R(0))) return;
    e->spring += R(0.5) * link->stiffness_Nm * off * off;
    e->numerical += R(0.5) * link->stiffness_Nm * (moved * moved - before * before);
}

static void tree_enter_hinge(tree_energies *e, const tree_part *p, tree_state *s, int32_t b) {
    const tree_hinge_part *hinge = &p->hinge[b - 1];
    const real rate = p->z[2 + b];
    tree_enter_drive(e, p, s, b);
    tree_enter_spring(e, p, b);
    e->outer += p->h * p->in->hinged.hinge_torque_Nm[b - 1] * rate;
    e->hinge += p->h * p->m->body[b].damping_Nms * rate * rate;
    s->dry_Nm[b - 1] = s->stop_Nm[b - 1][0] = s->stop_Nm[b - 1][1] = R(0);
    if (hinge->dry != NULL) {
        s->dry_Nm[b - 1] = hinge->dry->q / p->h;
        e->hinge += hinge->dry->q * rate;
    }
    for (int k = 0; hinge->stop != NULL && k < 2; k++) {
        s->stop_Nm[b - 1][k] = hinge->stop[k].q / p->h;
        e->stop += hinge->stop[k].q * rate;
    }
}

/* The supply gives what the motors take and what its own resistance turns to heat. */
static void tree_enter_supply(const tree_energies *e, const tree_part *p, tree_state *s) {
    real loss = R(0);
    if (p->terminal_V > R(0)) {
        s->supply_current_A = e->supplied / (p->h * p->terminal_V);
        s->supply_voltage_V = p->terminal_V;
        loss = (p->m->supply_V - p->terminal_V) * s->supply_current_A * p->h;
    }
    sum_add(&s->supply_energy_J, e->supplied + loss);
    sum_add(&s->supply_loss_J, loss);
}

static void tree_enter(const tree_part *p, tree_state *s) {
    tree_energies e = ALL_ZERO;
    tree_enter_bodies(&e, p, s);
    for (int32_t i = 0; i < p->m->wheel_count; i++) tree_enter_wheel(&e, p, s, i);
    for (int32_t b = 1; b <= p->m->body_count; b++) tree_enter_hinge(&e, p, s, b);
    for (int32_t i = 0; i < p->m->point_count; i++) s->normal_N[i] = p->loads.statics_N[i];
    tree_enter_supply(&e, p, s);
    sum_add(&s->outer_work_J, e.outer);
    sum_add(&s->servo_work_J, e.servo);
    sum_add(&s->slip_loss_J, e.slip);
    sum_add(&s->scrub_loss_J, e.scrub);
    sum_add(&s->axle_loss_J, e.axle);
    sum_add(&s->hinge_loss_J, e.hinge);
    sum_add(&s->stop_loss_J, e.stop);
    sum_add(&s->motor_loss_J, e.motor);
    sum_add(&s->numerical_loss_J, e.numerical + s->spring_energy_J);
    s->spring_energy_J = e.spring;
}

/* S_0 moves by the mean of its old and new velocity in the world, the angles by that of their rates. */
laconic_status laconic_tree_accept(const tree_part *p, tree_state *s) {
    const real half = R(0.5) * p->h, *z = p->z;
    const real yaw = half * (s->z[2] + z[2]);
    real turns = magnitude(yaw);
    for (int32_t b = 1; b <= p->m->body_count; b++) turns += magnitude(half * (s->z[2 + b] + z[2 + b]));
    if (!(turns < LARGEST_YAW_CHANGE_RAD)) return LACONIC_OVERFLOW;
    const direction old = direction_of_binary_angle(s->heading.fraction);
    (void)heading_advance(&s->heading, yaw);
    const direction now = direction_of_binary_angle(s->heading.fraction);
    sum_add(&s->x_m, half * (old.cosine * s->z[0] - old.sine * s->z[1] + now.cosine * z[0] - now.sine * z[1]));
    sum_add(&s->y_m, half * (old.sine * s->z[0] + old.cosine * s->z[1] + now.sine * z[0] + now.cosine * z[1]));
    for (int32_t b = 1; b <= p->m->body_count; b++)
        (void)heading_advance(&s->hinge[b - 1], half * (s->z[2 + b] + z[2 + b]));
    for (int32_t k = 0; k < 3 + p->m->body_count; k++) s->z[k] = z[k];
    tree_velocities(s->body, &p->at, p->m, z);
    tree_enter(p, s);
    s->passes = p->passes;
    return LACONIC_OK;
}

#endif
