/* Normal loads of wheels and supports of a vehicle with hinges, by the core's statics of one rigid carriage after the
 * other: trailers first, each of which leaves a part of its weight to the body that it hangs on. */
#include "core_words.h"
#include "parts.h"

#define BODIES (LACONIC_MAX_BODIES + 1)

typedef struct place {
    double x, y; /* from the carriage's centre of mass, axes of the world */
} place;

/* Where each body is: the place of its frame, and that frame's axes as heading, cosine and sine. */
typedef struct posture {
    const laconic_articulated_vehicle *vehicle;
    place origin[BODIES];
    laconic_heading facing[BODIES];
    double axis[BODIES][2];
    int32_t group[BODIES]; /* the body with whose rigid carriage it stands */
} posture;

/* Weights that a rigid carriage bears, and their moments. */
typedef struct weights {
    double sum_N, x_Nm, y_Nm;
} weights;

static place point_of(const posture *p, int32_t body, double x_m, double y_m) {
    const double c = p->axis[body][0], s = p->axis[body][1];
    const place found = {p->origin[body].x + (c * x_m - s * y_m), p->origin[body].y + (s * x_m + c * y_m)};
    return found;
}

static void find_posture(posture *p, const fmu_model *self) {
    const laconic_articulated_vehicle *v = p->vehicle = &self->in_use;
    p->facing[0] = self->state.heading;
    fmu_turn(p->axis[0], &p->facing[0], 1.0, 0.0);
    p->origin[0] = point_of(p, 0, -self->prepared.com_x_m, -self->prepared.com_y_m);
    for (int32_t b = 1; b <= v->body_count; b++) {
        const laconic_body *body = &v->body[b - 1];
        p->origin[b] = point_of(p, body->parent, body->hinge_x_m, body->hinge_y_m);
        p->facing[b] = p->facing[body->parent];
        p->facing[b].fraction =
            (laconic_binary_angle)(p->facing[body->parent].fraction + self->state.hinge[b - 1].fraction);
        fmu_turn(p->axis[b], &p->facing[b], 1.0, 0.0);
        p->group[b] = self->hinge_is_ball[b - 1] ? b : p->group[body->parent];
    }
}

static void add_weight(weights *w, double newtons, place at) {
    w->sum_N += newtons;
    w->x_Nm += newtons * at.x;
    w->y_Nm += newtons * at.y;
}

static place shifted(place at, const double by_m[2]) {
    const place moved = {at.x + by_m[0], at.y + by_m[1]};
    return moved;
}

static void find_weights(weights carried[BODIES], const posture *p, const double shift_m[2]) {
    const laconic_articulated_vehicle *v = p->vehicle;
    const laconic_vehicle *base = &v->base;
    add_weight(&carried[0], LACONIC_GRAVITY_M_PER_S2 * base->mass_kg,
               shifted(point_of(p, 0, base->com_x_m, base->com_y_m), shift_m));
    add_weight(&carried[0], LACONIC_GRAVITY_M_PER_S2 * base->payload.mass_kg,
               shifted(point_of(p, 0, base->payload.x_m, base->payload.y_m), shift_m));
    for (int32_t b = 1; b <= v->body_count; b++) {
        const laconic_body *body = &v->body[b - 1];
        add_weight(&carried[p->group[b]], LACONIC_GRAVITY_M_PER_S2 * body->mass_kg,
                   point_of(p, b, body->com_x_m, body->com_y_m));
    }
}

/* A rigid carriage with free rollers in the places of its wheels. */
static void find_carriage(laconic_vehicle *rigid, const posture *p, int32_t group, const weights *carried) {
    const laconic_articulated_vehicle *v = p->vehicle;
    const laconic_vehicle none = {0};
    *rigid = none;
    rigid->mass_kg = rigid->yaw_inertia_kgm2 = rigid->wheel_radius_m = 1.0;
    rigid->com_x_m = carried->x_Nm / carried->sum_N;
    rigid->com_y_m = carried->y_Nm / carried->sum_N;
    for (int32_t i = 0; i < v->base.wheel_count; i++) {
        if (p->group[v->wheel_body[i]] != group) continue;
        const place at = point_of(p, v->wheel_body[i], v->base.wheel[i].x_m, v->base.wheel[i].y_m);
        laconic_wheel *wheel = &rigid->wheel[rigid->wheel_count];
        wheel->kind = LACONIC_WHEEL_ROLLER;
        wheel->roller_rad = 1.5; /* any but 0: loads ask for places alone */
        wheel->x_m = at.x;
        wheel->y_m = at.y;
        rigid->wheel_count++;
    }
    rigid->support_count = group == 0 ? v->base.support_count : 1;
    for (int32_t k = 0; k < rigid->support_count; k++) {
        const laconic_support *support = &v->base.support[k];
        const place at = group == 0 ? point_of(p, 0, support->x_m, support->y_m) : p->origin[group];
        rigid->support[k].x_m = at.x;
        rigid->support[k].y_m = at.y;
    }
}

/* Loads of one rigid carriage; returns that of its ball, which the body that it hangs on bears. */
static double share_loads(fmu_model *self, const posture *p, int32_t group, const weights *carried) {
    laconic_vehicle rigid;
    laconic_contact contact;
    int32_t point = 0;
    if (!(carried->sum_N > 0.0)) return 0.0;
    find_carriage(&rigid, p, group, carried);
    if (laconic_contact_prepare(&contact, &rigid, NULL) != LACONIC_OK) return 0.0;
    for (int32_t i = 0; i < p->vehicle->base.wheel_count; i++)
        if (p->group[p->vehicle->wheel_body[i]] == group)
            self->wheel_load_N[i] = contact.normal_load_of_wrench[point++][0] * carried->sum_N;
    for (int32_t k = 0; group == 0 && k < rigid.support_count; k++)
        self->support_load_N[k] = contact.normal_load_of_wrench[point++][0] * carried->sum_N;
    return group == 0 ? 0.0 : contact.normal_load_of_wrench[point][0] * carried->sum_N;
}

void fmu_articulated_loads(fmu_model *self, const double shift_m[2]) {
    posture p = {0};
    weights carried[BODIES] = {{0.0, 0.0, 0.0}};
    for (int32_t i = 0; i < LACONIC_MAX_WHEELS; i++) self->wheel_load_N[i] = 0.0;
    for (int32_t k = 0; k < LACONIC_MAX_SUPPORTS; k++) self->support_load_N[k] = 0.0;
    find_posture(&p, self);
    find_weights(carried, &p, shift_m);
    for (int32_t g = p.vehicle->body_count; g >= 0; g--) {
        if (p.group[g] != g) continue;
        const double on_ball_N = share_loads(self, &p, g, &carried[g]);
        if (g > 0) add_weight(&carried[p.group[p.vehicle->body[g - 1].parent]], on_ball_N, p.origin[g]);
    }
}
