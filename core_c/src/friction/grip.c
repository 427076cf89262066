/* Could the ground supply the reactions of the no-slip model? First and worst instant of slipping and of lifting. */
#include "common.h"
#include "elementary.h"

typedef struct finding { /* the worst point of one instant */
    int32_t point;
    real by_N; /* margin or normal load, below zero */
} finding;

static real needed(const laconic_reactions *r, int32_t wheel) {
    return laconic_root(r->along_N[wheel] * r->along_N[wheel] + r->lateral_N[wheel] * r->lateral_N[wheel]);
}

/* NaN counts as worse than every number. */
static void keep_worse(finding *worst, int32_t index, real value, real limit) {
    if (value >= limit || (worst->point != 0 && value >= worst->by_N)) return;
    worst->point = index + 1;
    worst->by_N = value;
}

/* Also notes each wheel that slips. */
static finding worst_slip(laconic_grip *grip, const laconic_contact *c, const laconic_reactions *r, int32_t wheels,
                          real rounding_N) {
    finding worst = {0, R(0)};
    if (r->no_slip_margin_N >= -rounding_N || !(c->friction_coefficient > R(0))) return worst;
    for (int32_t i = 0; i < wheels; i++) {
        const real needed_N = needed(r, i), margin_N = c->friction_coefficient * r->normal_N[i] - needed_N;
        if (needed_N <= rounding_N) continue; /* it may lift, but without a reaction it does not slip */
        if (!(margin_N >= -rounding_N)) grip->wheel_slips[i] = true;
        keep_worse(&worst, i, margin_N, -rounding_N);
    }
    return worst;
}

static finding worst_lift(const laconic_contact *c, const laconic_reactions *r, real rounding_N) {
    finding worst = {0, R(0)};
    for (int32_t i = 0; i < c->point_count; i++) keep_worse(&worst, i, r->normal_N[i], -rounding_N);
    return worst;
}

static void enter(laconic_grip_event *first, laconic_grip_event *worst, uint64_t *count, const laconic_grip_event *now,
                  bool is_worse) {
    if (*count == 0) *first = *now;
    if (*count == 0 || is_worse) *worst = *now;
    (*count)++;
}

static laconic_grip_event event_of(const laconic_contact *c, const laconic_reactions *r, int32_t point, int32_t wheels,
                                   uint64_t steps) {
    laconic_grip_event event;
    event.steps = steps;
    event.point = point;
    event.normal_N = r->normal_N[point - 1];
    event.needed_N = point <= wheels ? needed(r, point - 1) : R(0);
    event.margin_N = c->friction_coefficient * event.normal_N - event.needed_N;
    return event;
}

void laconic_grip_watch(laconic_grip *grip, const laconic_contact *contact, const laconic_model *model,
                        const laconic_reactions *reactions, uint64_t steps) {
    const int32_t wheels = LACONIC_WHEELS(model);
    const real rounding_N = LACONIC_RANK_TOLERANCE * (model->mass_kg * R(LACONIC_GRAVITY_M_PER_S2));
    const finding slip = worst_slip(grip, contact, reactions, wheels, rounding_N);
    const finding lift = worst_lift(contact, reactions, rounding_N);
    laconic_grip_event now;
    grip->instants++;
    if (slip.point != 0) {
        now = event_of(contact, reactions, slip.point, wheels, steps);
        enter(&grip->first_slip, &grip->worst_slip, &grip->slipping, &now, slip.by_N < grip->worst_slip.margin_N);
    }
    if (lift.point != 0) {
        now = event_of(contact, reactions, lift.point, wheels, steps);
        enter(&grip->first_lift, &grip->worst_lift, &grip->lifting, &now, lift.by_N < grip->worst_lift.normal_N);
    }
}
