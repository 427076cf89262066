/* auto: rk4 in parts that are short beside the fastest motion, and where that takes too many, moebius-4. The rule in
 * full:
 *
 *   rate      the largest of: damping and springs (found when the model was prepared), speed over trail of each caster,
 *             yaw rate of each body (of the posture at a part's start)
 *   parts     1, 2, 4 … so that rate · part ≤ ¼: a relaxation is then followed to about 1e-5, slower motion far better
 *   rk4       takes each part, as long as there are at most 256 in a step
 *   moebius-4 beyond that, in 64 parts or as many more (to 256) as casters and yaw ask for. Decay may then be of any
 *             rate. A caster that is still too fast is led by exact maps and follows what is slower than a part
 *   halves    a part of moebius-4 that has no solution is taken in halves
 *   judged    where a caster is faster than all that (rate · step above 64), and where nothing drives or damps a
 *             vehicle with a short trail and these parts miss its energy: parts that judge themselves
 *             (articulated_adaptive.c)
 *
 * The rule depends on model, state and step alone, so the same run makes the same choices everywhere. */
#include "articulated_step.h"

#if LACONIC_MAX_BODIES > 0

#define WHOLE_STEP ((uint32_t)1 << 20) /* a step, in units in which parts are counted */
#define MOST_AUTO_PARTS ((uint32_t)256)
#define FEWEST_STIFF_PARTS ((uint32_t)64)
#define LARGEST_RATE_OF_PART R(0.25) /* rate · part */
#define SHORT_TRAIL_M R(0.012)
#define SHORT_SHARE R(0.04) /* of the vehicle's size */

/* Halves a part until the rate fits, no further than `smallest`. */
static uint32_t part_for(real part_per_unit, uint32_t part, uint32_t smallest, real rate_step) {
    while (part > smallest && (real)part * part_per_unit * rate_step > LARGEST_RATE_OF_PART) part /= 2U;
    return part;
}

/* A refusal by rk4 that other parts may cure; `why` then has the largest step. */
static bool is_too_long(laconic_status status) {
    return status == LACONIC_STEP_BEYOND_TRAIL_LIMIT || status == LACONIC_STEP_BEYOND_GYROSCOPIC_LIMIT;
}

typedef struct auto_progress {
    uint32_t done, part;
    bool stiff;
} auto_progress;

/* The largest part of a power of two that begins here and is no longer than `part`. */
static uint32_t aligned_part(const auto_progress *p) {
    uint32_t part = p->part;
    while (p->done % part != 0U) part /= 2U;
    return part;
}

static laconic_status explicit_part(laconic_articulated_state *state, const laconic_articulated_model *m,
                                    const articulated_course *course, auto_progress *p, laconic_refusal *found) {
    const real unit = R(1) / (real)WHOLE_STEP;
    const uint32_t part = aligned_part(p);
    const laconic_status status = laconic_articulated_rk4(state, m, course, unit * (real)p->done, unit * (real)part,
                                                          false, LARGEST_RATE_OF_PART, found);
    if (status == LACONIC_OK) {
        p->done += part;
        return status;
    }
    if (!is_too_long(status)) return status;
    const real longest = found->limit / course->step_s;
    p->part = part / 2U;
    while (p->part > WHOLE_STEP / MOST_AUTO_PARTS && !(unit * (real)p->part <= longest)) p->part /= 2U;
    p->stiff = p->part < WHOLE_STEP / MOST_AUTO_PARTS || !(unit * (real)p->part <= longest); /* or a rate is NaN */
    return LACONIC_OK;
}

static laconic_status stiff_part(laconic_articulated_state *state, const laconic_articulated_model *m,
                                 const articulated_course *course, auto_progress *p, laconic_refusal *found) {
    const real unit = R(1) / (real)WHOLE_STEP;
    const uint32_t part = aligned_part(p);
    laconic_articulated_factors factors[2];
    laconic_articulated_factors_of(factors, m, unit * (real)part * course->step_s);
    const laconic_status status =
        laconic_articulated_moebius_4(state, m, factors, course, unit * (real)p->done, unit * (real)part, found);
    if (status == LACONIC_OK) {
        p->done += part;
        return status;
    }
    if ((status != LACONIC_STEP_SINGULAR && status != LACONIC_OVERFLOW) || part == 1U) return status;
    p->part = part / 2U;
    return LACONIC_OK;
}

/* How many parts casters and yaw ask of moebius-4 at the posture of the step's start; 0: more than this rule has. */
static uint32_t stiff_part_size(const laconic_articulated_state *state, const laconic_articulated_model *m,
                                const articulated_course *course) {
    articulated_sweep s;
    real eta[LACONIC_MAX_VELOCITIES];
    take_posture_of(&s, m, state);
    take_eta(eta, m, state);
    if (sweep_outward(&s, m, eta, &course->start) != 0) return WHOLE_STEP;
    const posture_rates fast = rates_of_posture(&s, m);
    const real caster = laconic_root(fast.caster_square), rate = caster > fast.yaw ? caster : fast.yaw;
    if (!(caster * course->step_s <= LARGEST_AUTO_RATE)) return 0U;
    return part_for(R(1) / (real)WHOLE_STEP, WHOLE_STEP / FEWEST_STIFF_PARTS, WHOLE_STEP / MOST_AUTO_PARTS,
                    rate * course->step_s);
}

/* Takes what is left of a step in parts, on a copy, as a later part may be refused. */
RARE laconic_status step_in_parts(laconic_articulated_state *state, const laconic_articulated_model *m,
                                  const articulated_course *course, auto_progress p, laconic_refusal *why) {
    laconic_articulated_state after = *state;
    bool was_stiff = false;
    while (p.done < WHOLE_STEP) {
        laconic_refusal found = ALL_ZERO;
        if (p.stiff && !was_stiff) p.part = stiff_part_size(&after, m, course);
        was_stiff = p.stiff;
        if (p.part == 0U) {
            const laconic_status status = laconic_articulated_adaptive(&after, m, course, p.done, why);
            if (status == LACONIC_OK) *state = after;
            return status;
        }
        const laconic_status status =
            p.stiff ? stiff_part(&after, m, course, &p, &found) : explicit_part(&after, m, course, &p, &found);
        if (status != LACONIC_OK) return refuse(why, status, found.field, found.item, found.value, found.limit);
    }
    *state = after;
    return LACONIC_OK;
}

INLINE laconic_status auto_by_rates(laconic_articulated_state *state, const laconic_articulated_model *m,
                                    const laconic_articulated_integrator *integrator, const articulated_course *course,
                                    laconic_refusal *why) {
    auto_progress p = {0U, WHOLE_STEP / (uint32_t)integrator->parts, integrator->parts > (int32_t)MOST_AUTO_PARTS};
    laconic_refusal found = ALL_ZERO;
    if (p.part < WHOLE_STEP) return step_in_parts(state, m, course, p, why);
    const laconic_status status = explicit_part(state, m, course, &p, &found);
    if (status != LACONIC_OK) return refuse(why, status, found.field, found.item, found.value, found.limit);
    return p.done == WHOLE_STEP ? LACONIC_OK : step_in_parts(state, m, course, p, why);
}

/* Whether the wheels of a body lie so near to its hinge that errors of its angle count many times in its rate. */
static bool has_short_trail(const laconic_articulated_model *m) {
    for (int32_t b = 0; b < m->body_count; b++) {
        const vector n = m->link[b].axle_per_lever; /* 1/trail in size */
        const real inverse_square = n.x * n.x + n.y * n.y;
        if (m->link[b].motion != LACONIC_MOTION_FOLLOWING) continue;
        if (inverse_square * (SHORT_TRAIL_M * SHORT_TRAIL_M) > R(1)) return true;
        if (inverse_square * (SHORT_SHARE * SHORT_SHARE) * (m->length_m * m->length_m) > R(1)) return true;
    }
    return false;
}

/* A step of a vehicle that keeps its energy: by parts that judge themselves where the rule of parts misses it. */
RARE laconic_status step_that_keeps_energy(laconic_articulated_state *state, const laconic_articulated_model *m,
                                           const laconic_articulated_integrator *integrator,
                                           const articulated_course *course, laconic_refusal *why) {
    laconic_articulated_state after = *state;
    const articulated_drive *end = course->constant ? &course->start : &course->end;
    const laconic_status status = auto_by_rates(&after, m, integrator, course, why);
    if (status != LACONIC_OK || !laconic_articulated_hold_energy(&after, state, m, end))
        return laconic_articulated_adaptive(state, m, course, 0U, why);
    *state = after;
    return LACONIC_OK;
}

laconic_status laconic_articulated_auto(laconic_articulated_state *state, const laconic_articulated_model *m,
                                        const laconic_articulated_integrator *integrator,
                                        const articulated_course *course, laconic_refusal *why) {
    const bool is_damped = m->fastest_decay_per_s > R(0) || m->fastest_swing_per_s > R(0);
    if (!is_damped && has_short_trail(m) && laconic_articulated_keeps_energy(m, course))
        return step_that_keeps_energy(state, m, integrator, course, why);
    return auto_by_rates(state, m, integrator, course, why);
}

int32_t laconic_articulated_parts_for(real rate_step) {
    int32_t parts = 1;
    while (parts <= (int32_t)MOST_AUTO_PARTS && rate_step > LARGEST_RATE_OF_PART * (real)parts) parts *= 2;
    return parts;
}

#endif
