/* rk4 and circle: classical Runge-Kutta for η and all angles, of order 4. Mean twists, for pose and wheel angles, come
 * from the same stages by Simpson's weights.
 *
 * circle moves following angles by exact maps of the circle instead (articulated_circle.h), so that no caster is too
 * fast for it: the commutator-free method of order 4 of Celledoni, Marthinsen and Owren (2003). With the flows F_g of
 * the stages and z = exp(hF) z₀ for the map of a constant flow, the stages are
 *
 *     z₂ = exp(½hF₁) z₀,   z₃ = exp(½hF₂) z₀,   z₄ = exp(h(F₃ − ½F₁)) z₂,
 *     z⁺ = exp(h(−F₁ + 2F₂ + 2F₃ + 3F₄)/12) exp(h(3F₁ + 2F₂ + 2F₃ − F₄)/12) z₀ */
#include "articulated_circle.h"

#if LACONIC_MAX_BODIES > 0

static const real stage_at[4] = {R(0), R(0.5), R(0.5), R(1)};
static const real stage_weight[4] = {R(1), R(2), R(2), R(1)}; /* over 6 */

/* What a step collects over its stages. */
typedef struct stage_sums {
    articulated_increment by;
    real angle_rad[LACONIC_MAX_BODIES]; /* of the stage, from the start of the step */
    circle_flow flow[LACONIC_MAX_BODIES][4];
    direction second[LACONIC_MAX_BODIES]; /* z₂ */
} stage_sums;

int32_t laconic_articulated_follower(const articulated_sweep *s, const laconic_articulated_model *m, real square_rate) {
    int32_t fastest = 0;
    if (!(square_rate > R(0))) return 0;
    for (int32_t b = m->body_count; b > 0; b--) {
        const laconic_link *link = &m->link[b - 1];
        if (link->motion == LACONIC_MOTION_FOLLOWING &&
            square_following_rate(link, s->twist[b]) >= R(0.999) * square_rate)
            fastest = b;
    }
    return fastest;
}

/* Casters and yaw rates that are too fast for a stable step. */
static laconic_status check_rates(const articulated_sweep *s, const laconic_articulated_model *m, real h, bool circle,
                                  real largest, laconic_refusal *why) {
    const posture_rates fast = rates_of_posture(s, m);
    if (!circle && !(h * h * fast.caster_square <= largest * largest))
        return refuse(why, LACONIC_STEP_BEYOND_TRAIL_LIMIT, (laconic_field)LACONIC_FIELD_OF_BODY_HINGE,
                      laconic_articulated_follower(s, m, fast.caster_square), h,
                      largest / laconic_root(fast.caster_square));
    if (!(h * fast.yaw <= largest))
        return refuse(why, LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT, LACONIC_FIELD_STEP, 0, h, largest / fast.yaw);
    return LACONIC_OK;
}

INLINE bool on_circle(const laconic_link *link, bool circle) {
    return circle && link->motion == LACONIC_MOTION_FOLLOWING;
}

/* z of the next stage g + 1 of a following hinge; after the last stage z⁺, with the turn of both maps. */
INLINE direction next_on_circle(stage_sums *sums, int32_t b, int g, direction start, real h) {
    const circle_flow *f = sums->flow[b];
    const circle_flow nothing = {R(0), R(0), R(0)};
    if (g == 0) return sums->second[b] = circle_map(start, f[0], R(0.5) * h);
    if (g == 1) return circle_map(start, f[1], R(0.5) * h);
    if (g == 2) return circle_map(sums->second[b], flows_added(f[2], R(-0.5), f[0]), h);
    const circle_flow inner = flows_added(flows_added(nothing, R(2), f[1]), R(2), f[2]);
    const circle_flow early = flows_added(flows_added(inner, R(3), f[0]), R(-1), f[3]);
    const circle_flow late = flows_added(flows_added(inner, R(-1), f[0]), R(3), f[3]);
    const direction middle = circle_map(start, early, h * (R(1) / R(12)));
    const direction end = circle_map(middle, late, h * (R(1) / R(12)));
    sums->by.turn_rad[b] =
        laconic_articulated_turn_from_to(start, middle) + laconic_articulated_turn_from_to(middle, end);
    return end;
}

/* Directions of the next stage from rates of this one. */
INLINE void turn_hinges(stage_sums *sums, articulated_sweep *s, const laconic_articulated_model *m,
                        const articulated_sweep *start, int g, real h, real ahead, bool circle) {
    for (int32_t b = 0; b < m->body_count; b++) {
        const laconic_link *link = &m->link[b];
        if (on_circle(link, circle)) {
            sums->flow[b][g] = circle_flow_of(link, s->twist[link->parent]);
            s->toward[b] = next_on_circle(sums, b, g, start->toward[b], h);
            if (link->stiffness_Nm > R(0))
                s->angle_rad[b] =
                    start->angle_rad[b] + laconic_articulated_turn_from_to(start->toward[b], s->toward[b]);
            continue;
        }
        if (link->motion == LACONIC_MOTION_COORDINATED) continue;
        sums->by.turn_rad[b] += stage_weight[g] * s->rate[b];
        if (g == 3) continue; /* no stage follows */
        const real turn = ahead * s->rate[b];
        s->toward[b] = turned_by(start->toward[b], turn);
        s->angle_rad[b] = start->angle_rad[b] + turn;
    }
}

/* Directions and angles of the start, which are those of the first stage. */
INLINE void begin_hinges(stage_sums *sums, articulated_sweep *s, articulated_sweep *start,
                         const laconic_articulated_model *m, const laconic_articulated_state *state) {
    start->angle_rad[0] = R(0); /* as in take_posture_of */
    for (int32_t b = 0; b < m->body_count; b++) {
        take_hinge_of(start, m, state, b);
        s->toward[b] = start->toward[b];
        s->angle_rad[b] = start->angle_rad[b];
        sums->by.turn_rad[b] = R(0);
    }
    forget_sizes(s, m);
}

/* η' and mean twists; η of the next stage. */
INLINE void add_stage(stage_sums *sums, const articulated_sweep *s, const laconic_articulated_model *m, real *eta,
                      const real *eta0, const real *eta_rate, int g, real ahead) {
    const real share = stage_weight[g];
    if (g == 0) { /* the weight is 1, and nothing is there yet */
        for (int32_t i = 0; i < m->dof; i++) {
            sums->by.eta[i] = eta_rate[i];
            eta[i] = eta0[i] + ahead * eta_rate[i];
        }
        for (int32_t b = 0; b <= m->body_count; b++) sums->by.mean[b] = s->twist[b];
        return;
    }
    for (int32_t i = 0; i < m->dof; i++) {
        sums->by.eta[i] += share * eta_rate[i];
        eta[i] = eta0[i] + ahead * eta_rate[i];
    }
    for (int32_t b = 0; b <= m->body_count; b++) sums->by.mean[b] = plus(sums->by.mean[b], scaled(share, s->twist[b]));
}

/* From sums with weights over 6 to what the step adds. Coordinated hinges are where the last stage has them. */
INLINE void end_sums(stage_sums *sums, const laconic_articulated_model *m, const articulated_sweep *start,
                     const articulated_sweep *s, const real *correction, real h, bool circle) {
    const real sixth = R(1) / R(6), step_sixth = h * sixth;
    for (int32_t i = 0; i < m->dof; i++) sums->by.eta[i] *= step_sixth;
    for (int32_t i = 0; m->row_count > 0 && i < m->dof; i++) sums->by.eta[i] += correction[i];
    for (int32_t b = 0; b <= m->body_count; b++) sums->by.mean[b] = scaled(sixth, sums->by.mean[b]);
    for (int32_t b = 0; b < m->body_count; b++) {
        if (m->link[b].motion == LACONIC_MOTION_COORDINATED)
            sums->by.turn_rad[b] = laconic_articulated_turn_from_to(start->toward[b], s->toward[b]);
        else if (!on_circle(&m->link[b], circle))
            sums->by.turn_rad[b] *= step_sixth;
    }
}

/* Rows left over drift by the error of a step. The first stage of the next one knows how to restore them, and what that
 * changes in its own rates is of the order of the drift times h, beyond the method's order. */
INLINE void restore_rows(real *eta, const laconic_articulated_model *m, const real *correction) {
    for (int32_t i = 0; m->row_count > 0 && i < m->dof; i++) eta[i] += correction[i];
}

INLINE laconic_status runge_kutta(stage_sums *sums, const laconic_articulated_state *state,
                                  const laconic_articulated_model *m, const articulated_course *course, real from,
                                  real share, bool circle, real largest, laconic_refusal *why) {
    articulated_sweep s, start;
    articulated_moment moment;
    const real h = share * course->step_s;
    const bool rotates = course->start.rotates || (!course->constant && course->end.rotates);
    const direction heading = rotates ? direction_of_heading(&state->heading) : direction_with(R(1), R(0));
    direction facing = heading;
    real eta0[LACONIC_MAX_VELOCITIES], eta[LACONIC_MAX_VELOCITIES], rate[LACONIC_MAX_VELOCITIES];
    real correction[LACONIC_MAX_VELOCITIES];
    begin_hinges(sums, &s, &start, m, state);
    for (int32_t i = 0; i < m->dof; i++) eta[i] = eta0[i] = state->eta[i].value;
    laconic_articulated_begin_moment(&moment, course);
    for (int g = 0; g < 4; g++) {
        const articulated_drive *drive = commands_of(&moment, course, m, from + share * stage_at[g]);
        const real ahead = h * (g < 3 ? stage_at[g + 1] : R(0));
        laconic_status status = accelerations(rate, g == 0 ? correction : NULL, &s, m, eta, drive, facing, why);
        if (status == LACONIC_OK && g == 0) status = check_rates(&s, m, h, circle, largest, why);
        if (status != LACONIC_OK) return status;
        if (g == 0) {
            sums->by.bend = scaled(R(-1), s.twist[0]);
            restore_rows(eta0, m, correction);
        }
        if (drive->rotates) facing = turned_by(heading, ahead * s.twist[0].z);
        add_stage(sums, &s, m, eta, eta0, rate, g, ahead);
        turn_hinges(sums, &s, m, &start, g, h, ahead, circle);
    }
    sums->by.bend = plus(sums->by.bend, s.twist[0]);
    end_sums(sums, m, &start, &s, correction, h, circle);
    return LACONIC_OK;
}

static laconic_status plain_stages(stage_sums *sums, const laconic_articulated_state *state,
                                   const laconic_articulated_model *m, const articulated_course *course, real from,
                                   real share, real largest, laconic_refusal *why) {
    return runge_kutta(sums, state, m, course, from, share, false, largest, why);
}

static laconic_status circle_stages(stage_sums *sums, const laconic_articulated_state *state,
                                    const laconic_articulated_model *m, const articulated_course *course, real from,
                                    real share, real largest, laconic_refusal *why) {
    return runge_kutta(sums, state, m, course, from, share, true, largest, why);
}

laconic_status laconic_articulated_rk4(laconic_articulated_state *state, const laconic_articulated_model *m,
                                       const articulated_course *course, real from, real share, bool circle,
                                       real largest, laconic_refusal *why) {
    stage_sums sums;
    laconic_status status = circle ? circle_stages(&sums, state, m, course, from, share, largest, why)
                                   : plain_stages(&sums, state, m, course, from, share, largest, why);
    if (status != LACONIC_OK) return status;
    status = laconic_articulated_accept(state, m, &sums.by, share * course->step_s);
    return status == LACONIC_OK ? status : refuse(why, status, LACONIC_FIELD_STEP, 0, share * course->step_s, R(0));
}

#endif
