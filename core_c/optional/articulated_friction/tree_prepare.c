/* A vehicle with hinges on ground with friction → the constants of its tree, contacts, motors and loads. */
#include "geometry.h"
#include "tree_posture.h"

#if LACONIC_MAX_BODIES > 0 && LACONIC_WITH_FRICTION

/* ------------------------------------------------------------------------------------------ bodies -- */

static void tree_fill_carriage(laconic_tree_model *m, const laconic_tree_vehicle *v) {
    tree_body *link = &m->body[0];
    body b;
    laconic_body_of(&b, &v->hinged.base);
    const real spread = b.yaw_scale * b.radius_m;
    m->com_x_m = b.com_x_m;
    m->com_y_m = b.com_y_m;
    link->mass_kg = b.mass_kg;
    link->yaw_inertia_kgm2 = b.mass_kg * spread * spread;
    link->com_z_m = v->hinged.base.com_z_m;
}

static void tree_fill_path(laconic_tree_model *m, int32_t b) {
    tree_body *link = &m->body[b];
    const tree_body *on = &m->body[link->parent];
    for (int32_t k = 0; k < on->depth; k++) link->path[k] = on->path[k];
    link->path[on->depth] = b - 1;
    link->depth = on->depth + 1;
    link->group = link->hitch ? b : on->group;
}

static void tree_fill_control(tree_body *link, const laconic_tree_hinge *hinge) {
    link->servo_gain_Nm_per_rad = hinge->servo_gain_Nm_per_rad;
    link->servo_damping_Nms = hinge->servo_damping_Nms;
    link->servo_limit_Nm = hinge->servo_limit_Nm;
    link->loop_V_per_rad = hinge->loop_V_per_rad;
    link->loop_Vs_per_rad = hinge->loop_Vs_per_rad;
    link->control_period_s = hinge->control_period_s;
    link->servo = tree_has_servo(hinge);
    link->sampled = tree_has_loop(hinge) || (link->servo && hinge->control_period_s > R(0));
}

static void tree_fill_body(laconic_tree_model *m, const laconic_tree_vehicle *v, int32_t b) {
    const laconic_body *hung = &v->hinged.body[b - 1];
    const laconic_tree_hinge *hinge = &v->hinge[b - 1];
    tree_body *link = &m->body[b];
    link->parent = hung->parent;
    link->hinge = hung->hinge;
    link->hinge_x_m = hung->hinge_x_m - (hung->parent == 0 ? m->com_x_m : R(0));
    link->hinge_y_m = hung->hinge_y_m - (hung->parent == 0 ? m->com_y_m : R(0));
    link->com_x_m = hung->com_x_m;
    link->com_y_m = hung->com_y_m;
    link->com_z_m = hinge->com_z_m;
    link->mass_kg = hung->mass_kg;
    link->yaw_inertia_kgm2 = hung->yaw_inertia_kgm2;
    link->damping_Nms = hung->damping_Nms;
    link->stiffness_Nm = hung->stiffness_Nm;
    link->rest_rad = hung->rest_rad;
    link->dry_friction_Nm = hinge->dry_friction_Nm;
    link->stop_low_rad = hinge->stop_low_rad;
    link->stop_high_rad = hinge->stop_high_rad;
    link->hitch = hinge->hitch;
    link->stops = tree_has_stops(hinge);
    tree_fill_control(link, hinge);
    tree_fill_path(m, b);
}

/* The centre of mass of each rigid group, for its balance of moments. */
static void tree_fill_heights(laconic_tree_model *m) {
    real mass[TREE_BODIES], moment[TREE_BODIES];
    for (int32_t b = 0; b <= m->body_count; b++) mass[b] = moment[b] = R(0);
    for (int32_t b = 0; b <= m->body_count; b++) {
        mass[m->body[b].group] += m->body[b].mass_kg;
        moment[m->body[b].group] += m->body[b].mass_kg * m->body[b].com_z_m;
    }
    for (int32_t b = 0; b <= m->body_count; b++)
        if (m->body[b].group == b) m->body[b].com_z_m = mass[b] > R(0) ? moment[b] / mass[b] : R(0);
}

/* ------------------------------------------------------------------------------------------ wheels -- */

static void tree_fill_wheel(laconic_tree_model *m, const laconic_tree_vehicle *v, int32_t i) {
    const laconic_vehicle *base = &v->hinged.base;
    const laconic_wheel *wheel = &base->wheel[i];
    const wheel_values own = laconic_wheel_values(base, i);
    const bool fixed = wheel->kind == LACONIC_WHEEL_FIXED;
    laconic_tree_rim *w = &m->wheel[i];
    direction u;
    const real sine = laconic_pull_direction(&u, wheel);
    w->body = v->hinged.wheel_body[i];
    w->locked = wheel->locked;
    w->x_m = wheel->x_m - (w->body == 0 ? m->com_x_m : R(0));
    w->y_m = wheel->y_m - (w->body == 0 ? m->com_y_m : R(0));
    w->pull[0] = u.cosine;
    w->pull[1] = u.sine;
    w->drag = fixed ? R(1) : own_or_common(wheel->own_roller_drag, base->ground.roller_drag);
    w->arm_across_m = fixed ? R(0) : own.radius_m * laconic_direction_of_angle(wheel->roller_rad).cosine;
    w->rim[0] = own.radius_m * sine;
    w->rim[1] = w->drag * w->arm_across_m;
    w->rim_size = laconic_root(w->rim[0] * w->rim[0] + w->rim[1] * w->rim[1]);
    for (int k = 0; k < 2; k++) w->rolling[k] = w->rim[k] / w->rim_size;
    w->radius_m = own.radius_m;
    w->inertia_kgm2 = own.inertia_kgm2;
    w->friction_coefficient = own_or_common(wheel->own_friction_coefficient, base->ground.friction_coefficient);
    w->dry_Nm = own_or_common(wheel->own_axle_friction_Nm, base->ground.axle_friction_Nm);
    w->load_N = v->wheel[i].load_N;
    w->scrub_radius_m = v->wheel[i].scrub_radius_m;
    w->scrub_fade_m = v->wheel[i].scrub_fade_m;
    w->creep = v->wheel[i].creep;
}

/* The part of `damping` that is not back-EMF is viscous; `per_ampere`: torque, 0 where R_a is not known. */
static void tree_fill_motor(laconic_tree_motor *a, real gain, real damping, real viscous, real resistance_ohm,
                            real current_limit_A) {
    const real per_ampere = gain * resistance_ohm, part = viscous < damping ? viscous : damping;
    a->gain_Nm_per_V = gain;
    a->back_emf_Nms = damping - part;
    a->viscous_Nms = part;
    a->acts = gain != R(0) || damping > R(0);
    a->ampere_per_Nm = per_ampere != R(0) ? R(1) / per_ampere : R(0);
    a->torque_limit_Nm =
        current_limit_A > R(0) && per_ampere != R(0) ? magnitude(per_ampere) * current_limit_A : LACONIC_REAL_MAX;
}

static void tree_fill_motors(laconic_tree_model *m, const laconic_tree_vehicle *v) {
    const laconic_drive *drive = &v->hinged.base.drive;
    for (int32_t i = 0; i < m->wheel_count; i++) {
        const wheel_values own = laconic_wheel_values(&v->hinged.base, i);
        m->motor[i].circuit = v->hinged.base.wheel[i].motor_circuit;
        tree_fill_motor(&m->motor[i], own.motor_gain_Nm_per_V, own.motor_damping_Nms, drive->viscous_friction_Nms,
                        drive->winding_resistance_ohm, drive->current_limit_A);
    }
    for (int32_t b = 1; b <= m->body_count; b++) {
        const laconic_tree_hinge *hinge = &v->hinge[b - 1];
        const laconic_body *hung = &v->hinged.body[b - 1];
        laconic_tree_motor *a = &m->motor[m->wheel_count + b - 1];
        a->circuit = LACONIC_MOTOR_OPEN;
        a->torque_limit_Nm = LACONIC_REAL_MAX;
        if (hung->hinge != LACONIC_HINGE_MOTOR) continue;
        a->circuit = LACONIC_MOTOR_DRIVEN;
        tree_fill_motor(a, hung->gain_Nm_per_V, hung->damping_Nms, hinge->viscous_friction_Nms,
                        hinge->winding_resistance_ohm, hinge->current_limit_A);
        m->body[b].damping_Nms = a->viscous_Nms;
        a->viscous_Nms = R(0); /* books of the hinge */
    }
}

static void tree_fill_ground(laconic_tree_model *m, const laconic_vehicle *base) {
    m->gravity_m_per_s2 = R(LACONIC_GRAVITY_M_PER_S2);
#if LACONIC_WITH_SLOPE
    const direction slope = laconic_direction_of_angle(base->ground.slope_rad);
    const direction up = laconic_direction_of_angle(base->ground.slope_heading_rad);
    m->gravity_m_per_s2 *= slope.cosine;
    m->sloped = base->ground.slope_rad > R(0);
    m->pull_m_per_s2[0] = -R(LACONIC_GRAVITY_M_PER_S2) * slope.sine * up.cosine;
    m->pull_m_per_s2[1] = -R(LACONIC_GRAVITY_M_PER_S2) * slope.sine * up.sine;
#endif
    m->supply_V = base->drive.supply_V;
    m->supply_resistance_ohm = base->drive.supply_resistance_ohm;
    m->point_count = base->wheel_count + base->support_count;
    for (int32_t i = 0; i < base->support_count; i++) {
        m->support_m[i][0] = base->support[i].x_m - m->com_x_m;
        m->support_m[i][1] = base->support[i].y_m - m->com_y_m;
    }
}

/* ------------------------------------------------------------------------------------ what must hold -- */

/* The least inertia about a hinge, beside that of body 0, of which anything is left. */
#define TREE_LEAST_INERTIA (R(16) * LACONIC_EPSILON)

static laconic_status tree_check_inertias(laconic_tree_model *m, laconic_refusal *why) {
    const real whole = m->body[0].yaw_inertia_kgm2;
    for (int32_t b = 1; b <= m->body_count; b++) {
        tree_body *link = &m->body[b];
        const real own =
            link->yaw_inertia_kgm2 + link->mass_kg * (link->com_x_m * link->com_x_m + link->com_y_m * link->com_y_m);
        if (own > TREE_LEAST_INERTIA * whole) continue;
        if (link->hinge != LACONIC_HINGE_PRESCRIBED)
            return refuse(why, LACONIC_MASSLESS_HINGE, (laconic_field)LACONIC_FIELD_OF_BODY_YAW_INERTIA, b, own, R(0));
        link->padding_kgm2 = whole;
    }
    return LACONIC_OK;
}

static real tree_body_size(const tree_body *b) {
    return magnitude(b->hinge_x_m) + magnitude(b->hinge_y_m) + magnitude(b->com_x_m) + magnitude(b->com_y_m) +
           b->mass_kg + b->yaw_inertia_kgm2 + b->damping_Nms + b->stiffness_Nm + b->dry_friction_Nm +
           b->servo_gain_Nm_per_rad + b->servo_damping_Nms + b->servo_limit_Nm + magnitude(b->loop_V_per_rad) +
           magnitude(b->loop_Vs_per_rad) + b->com_z_m;
}

static bool tree_in_range(const laconic_tree_model *m) {
    real sum = m->supply_V + m->supply_resistance_ohm;
    for (int32_t b = 0; b <= m->body_count; b++) sum += tree_body_size(&m->body[b]);
    for (int32_t i = 0; i < m->wheel_count; i++) {
        const laconic_tree_rim *w = &m->wheel[i];
        sum += magnitude(w->x_m) + magnitude(w->y_m) + w->rim_size + w->inertia_kgm2 + R(1) / w->inertia_kgm2 +
               R(1) / w->rim_size + w->friction_coefficient + w->dry_Nm + w->load_N + w->scrub_radius_m +
               w->scrub_fade_m + w->creep;
    }
    for (int32_t i = 0; i < m->wheel_count + m->body_count; i++)
        sum += magnitude(m->motor[i].gain_Nm_per_V) + m->motor[i].back_emf_Nms + m->motor[i].viscous_Nms +
               magnitude(m->motor[i].ampere_per_Nm);
    return fits_squared(sum);
}

static void tree_sum_up(laconic_tree_model *m) {
    m->star = true;
    for (int32_t b = 0; b <= m->body_count; b++) {
        m->star = m->star && m->body[b].depth <= 1;
        m->mass_kg += m->body[b].mass_kg;
        m->controlled = m->controlled || m->body[b].sampled;
    }
    m->loads_given = m->wheel_count > 0 && m->wheel[0].load_N > R(0);
}

laconic_status laconic_tree_prepare(laconic_tree_model *model, const laconic_tree_vehicle *vehicle,
                                    laconic_refusal *why) {
    laconic_tree_model m = ALL_ZERO;
    laconic_status status = laconic_tree_check(vehicle, why);
    if (status != LACONIC_OK) return status;
    m.body_count = vehicle->hinged.body_count;
    m.wheel_count = vehicle->hinged.base.wheel_count;
    tree_fill_carriage(&m, vehicle);
    for (int32_t b = 1; b <= m.body_count; b++) tree_fill_body(&m, vehicle, b);
    for (int32_t i = 0; i < m.wheel_count; i++) tree_fill_wheel(&m, vehicle, i);
    tree_fill_motors(&m, vehicle);
    tree_fill_ground(&m, &vehicle->hinged.base);
    tree_fill_heights(&m);
    tree_sum_up(&m);
    status = tree_check_inertias(&m, why);
    if (status != LACONIC_OK) return status;
    if (!tree_in_range(&m)) return refuse(why, LACONIC_OVERFLOW, LACONIC_FIELD_NONE, 0, R(0), R(0));
    *model = m;
    return LACONIC_OK;
}

#endif
