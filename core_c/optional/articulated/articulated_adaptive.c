/* Parts that judge themselves, for auto: where wheels follow too fast for its rule of parts, and where nothing drives
 * or damps a vehicle, so that its energy shows whether a step was right.
 *
 * A part is taken whole and in two halves. The halves stand where both agree, as twists in the kinetic metric and as
 * angles: by rk4 first, which a body with inertia on a short trail needs, since its wheels then hardly turn it; else by
 * moebius-4, which leads light casters by exact maps. Those maps turn hinges while η rests, so a part is also refused
 * where that alone changes the energy. What is refused is halved, and a part that was right may be followed by one of
 * twice its length.
 *
 * A vehicle that nothing drives or damps keeps its energy: what a right part changes of it, an error of the method, is
 * taken back by scaling η. */
#include "articulated_step.h"

#if LACONIC_MAX_BODIES > 0

#define MOST_TRIALS 4096
#define ADAPTIVE_UNITS ((uint32_t)1 << 20) /* a step, as articulated_auto.c counts parts */
#ifdef LACONIC_SINGLE
#define LARGEST_DIFFERENCE R(1e-3) /* of a part and its halves, in speeds over all and in rad */
#define LARGEST_ENERGY_ERROR R(1e-3)
#define GROWTH_BY_ROUNDING R(1e-6)
#else
#define LARGEST_DIFFERENCE R(1e-6)
#define LARGEST_ENERGY_ERROR R(1e-6)
#define GROWTH_BY_ROUNDING R(1e-13)
#endif
#define LARGEST_CHANGE_BY_ANGLES R(1e-4) /* of the energy, as hinges turn alone */

/* ------------------------------------------------------------------------------------ energy -- */

/* Twists at the angles of one state with the velocities of another. */
static void sweep_mixed(articulated_sweep *s, const laconic_articulated_model *m,
                        const laconic_articulated_state *angles, const laconic_articulated_state *velocities,
                        const articulated_drive *drive) {
    real eta[LACONIC_MAX_VELOCITIES];
    take_posture_of(s, m, angles);
    take_eta(eta, m, velocities);
    (void)sweep_outward(s, m, eta, drive);
}

static real energy_of_state(const laconic_articulated_model *m, const laconic_articulated_state *state,
                            const articulated_drive *drive) {
    articulated_sweep s;
    sweep_mixed(&s, m, state, state, drive);
    return energy_of_twists(m, s.twist);
}

static bool is_idle(const articulated_drive *drive, const laconic_articulated_model *m) {
    if (drive->rotates || drive->turns) return false;
    for (int32_t b = 0; b <= m->body_count; b++)
        if (drive->force[b].x != R(0) || drive->force[b].y != R(0) || drive->force[b].z != R(0)) return false;
    for (int32_t b = 0; b < m->body_count; b++)
        if (drive->torque[b] != R(0) || drive->rate[b] != R(0) || drive->acceleration[b] != R(0)) return false;
    return true;
}

bool laconic_articulated_keeps_energy(const laconic_articulated_model *m, const articulated_course *course) {
    if (m->fastest_decay_per_s > R(0) || m->fastest_swing_per_s > R(0)) return false;
    return is_idle(&course->start, m) && (course->constant || is_idle(&course->end, m));
}

/* Scales η from its energy to another; false where they are too far apart for a mere error of a method. */
static bool restore_energy(laconic_articulated_state *state, const laconic_articulated_model *m, real now_J,
                           real energy_J) {
    if (!(magnitude(now_J - energy_J) <= LARGEST_ENERGY_ERROR * energy_J)) return false;
    if (!(magnitude(now_J - energy_J) > GROWTH_BY_ROUNDING * energy_J)) return true;
    const real less = laconic_root(energy_J / now_J) - R(1);
    for (int32_t i = 0; i < m->dof; i++) sum_add(&state->eta[i], less * state->eta[i].value);
    return true;
}

bool laconic_articulated_hold_energy(laconic_articulated_state *after, const laconic_articulated_state *before,
                                     const laconic_articulated_model *m, const articulated_drive *drive) {
    const real energy_J = energy_of_state(m, before, drive), now_J = energy_of_state(m, after, drive);
    if (now_J <= energy_J * (R(1) + GROWTH_BY_ROUNDING) && now_J >= energy_J * (R(1) - LARGEST_ENERGY_ERROR))
        return true;
    return restore_energy(after, m, now_J, energy_J);
}

/* ------------------------------------------------------------------------------------- parts -- */

typedef struct adaptive_part {
    const laconic_articulated_model *m;
    const articulated_course *course;
    real from, share; /* of the step */
    real energy_J;    /* that stays; below 0: it changes */
    bool stiff;       /* by moebius-4 */
} adaptive_part;

static laconic_status take_once(laconic_articulated_state *state, const adaptive_part *p, real from, real share) {
    laconic_articulated_factors factors[2];
    if (!p->stiff) return laconic_articulated_rk4(state, p->m, p->course, from, share, false, LACONIC_REAL_MAX, NULL);
    laconic_articulated_factors_of(factors, p->m, share * p->course->step_s);
    return laconic_articulated_moebius_4(state, p->m, factors, p->course, from, share, NULL);
}

/* Whether two states after one part agree, beside the energy of one. */
static bool states_agree(const laconic_articulated_model *m, const laconic_articulated_state *one,
                         const laconic_articulated_state *other, const articulated_drive *drive) {
    articulated_sweep a, b;
    sweep_mixed(&a, m, one, one, drive);
    sweep_mixed(&b, m, other, other, drive);
    const real energy_J = energy_of_twists(m, b.twist);
    for (int32_t k = 0; k <= m->body_count; k++) a.twist[k] = minus(a.twist[k], b.twist[k]);
    if (!(energy_of_twists(m, a.twist) <= LARGEST_DIFFERENCE * LARGEST_DIFFERENCE * energy_J)) return false;
    for (int32_t k = 0; k < m->body_count; k++)
        if (!(magnitude(laconic_articulated_turn_from_to(a.toward[k], b.toward[k])) <= LARGEST_DIFFERENCE))
            return false;
    return true;
}

/* Whether the angles of `after` leave the velocities of `before` their energy. */
static bool turns_lightly(const laconic_articulated_model *m, const laconic_articulated_state *before,
                          const laconic_articulated_state *after, const articulated_drive *drive) {
    articulated_sweep s;
    const real energy_J = energy_of_state(m, before, drive);
    sweep_mixed(&s, m, after, before, drive);
    return magnitude(energy_of_twists(m, s.twist) - energy_J) <= LARGEST_CHANGE_BY_ANGLES * energy_J;
}

/* The part in two halves, where it is right; else the state stays. */
static bool take_judged(laconic_articulated_state *state, const adaptive_part *p) {
    const articulated_drive *drive = p->course->constant ? &p->course->start : &p->course->end;
    const real half = R(0.5) * p->share;
    laconic_articulated_state once = *state, twice = *state;
    if (take_once(&once, p, p->from, p->share) != LACONIC_OK) return false;
    if (take_once(&twice, p, p->from, half) != LACONIC_OK) return false;
    if (take_once(&twice, p, p->from + half, half) != LACONIC_OK) return false;
    if (p->stiff && !turns_lightly(p->m, state, &twice, drive)) return false;
    if (!states_agree(p->m, &once, &twice, drive)) return false;
    if (p->energy_J >= R(0)) {
        const real now_J = energy_of_state(p->m, &twice, drive);
        if (!restore_energy(&twice, p->m, now_J, p->energy_J)) return false;
    }
    *state = twice;
    return true;
}

/* Refuses a step for the body whose wheels follow fastest; `largest`: of step times rate. */
static laconic_status refuse_trail(const laconic_articulated_model *m, const laconic_articulated_state *state,
                                   const articulated_drive *drive, real step_s, real largest, laconic_refusal *why) {
    articulated_sweep s;
    sweep_mixed(&s, m, state, state, drive);
    const real square_rate = rates_of_posture(&s, m).caster_square;
    const int32_t body = laconic_articulated_follower(&s, m, square_rate);
    if (body == 0) return refuse(why, LACONIC_STEP_SINGULAR, LACONIC_FIELD_STEP, 0, step_s, R(0.5) * step_s);
    const real longest = largest / laconic_root(square_rate);
    return refuse(why, LACONIC_STEP_BEYOND_TRAIL_LIMIT, (laconic_field)LACONIC_FIELD_OF_BODY_HINGE, body, step_s,
                  longest < R(0.5) * step_s ? longest : R(0.5) * step_s);
}

laconic_status laconic_articulated_adaptive(laconic_articulated_state *state, const laconic_articulated_model *m,
                                            const articulated_course *course, uint32_t done, laconic_refusal *why) {
    const real unit = R(1) / (real)ADAPTIVE_UNITS;
    laconic_articulated_state after = *state;
    uint32_t part = ADAPTIVE_UNITS;
    const real energy_J =
        laconic_articulated_keeps_energy(m, course) ? energy_of_state(m, state, &course->start) : R(-1);
    while (done % part != 0U) part /= 2U;
    for (int32_t trials = 0; done < ADAPTIVE_UNITS && trials < MOST_TRIALS; trials++) {
        adaptive_part p = {m, course, unit * (real)done, unit * (real)part, energy_J, false};
        bool taken = take_judged(&after, &p);
        p.stiff = !taken;
        if (!taken) taken = take_judged(&after, &p);
        if (taken) {
            done += part;
            if (done % (2U * part) == 0U && done < ADAPTIVE_UNITS) part *= 2U;
        } else if (part > 1U) {
            part /= 2U;
        } else {
            break;
        }
    }
    if (done < ADAPTIVE_UNITS) return refuse_trail(m, &after, &course->start, course->step_s, LARGEST_AUTO_RATE, why);
    *state = after;
    return LACONIC_OK;
}

#endif
