/* The rarer parts of coordinated steering: roots, and refusals of a twist. */
#include "articulated_step.h"

#if LACONIC_MAX_BODIES > 0

real laconic_articulated_inverse_root(real x) {
    const real root = laconic_root(x);
    return root > R(0) && is_finite(root) ? R(1) / root : R(0);
}

laconic_status laconic_articulated_refuse_twist(int32_t hinge, const laconic_articulated_model *m,
                                                const articulated_drive *drive, laconic_refusal *why) {
    if (hinge < 1) return refuse(why, LACONIC_TWIST_ZERO, (laconic_field)LACONIC_FIELD_OF_TWIST, 0, R(0), R(0));
    const direction w = twist_at_hinge(&m->link[hinge - 1], drive->twist[0]);
    return refuse(why, LACONIC_TWIST_ZERO, (laconic_field)LACONIC_FIELD_OF_BODY_HINGE, hinge,
                  laconic_root(w.cosine * w.cosine + w.sine * w.sine), R(0));
}

/* T and T' must be motions that the carriage's own wheels allow. A row whose lever is rounding alone is measured by the
 * vehicle's size, so that a turn about its own axle is none that slides. */
static laconic_status check_against_wheels(const laconic_articulated_model *m, const articulated_drive *drive,
                                           laconic_refusal *why) {
    for (int k = 0; k < 2; k++)
        for (int32_t i = 0; i < m->held_count; i++) {
            const vector t = drive->twist[k], row = m->held[i];
            const real whole = (magnitude(row.x) + magnitude(row.y)) *
                                   (magnitude(t.x) + magnitude(t.y) + m->length_m * magnitude(t.z)) +
                               magnitude(row.z * t.z); /* row.z and t.x may both be roundings of 0 */
            const real off = magnitude(dot(row, t));
            if (off > R(10) * LACONIC_RANK_TOLERANCE * whole)
                return refuse(why, LACONIC_TWIST_AGAINST_WHEELS,
                              (laconic_field)(k == 0 ? LACONIC_FIELD_OF_TWIST : LACONIC_FIELD_OF_TWIST_RATE), 0,
                              off / whole, R(0));
        }
    return LACONIC_OK;
}

/* Refuses a turn of hinge b beyond the largest sine, or beyond a quarter turn. */
static laconic_status check_turn(const laconic_link *link, int32_t b, vector from, vector to, real largest_sine,
                                 laconic_refusal *why) {
    const direction d = from_to(twist_at_hinge(link, from), twist_at_hinge(link, to));
    const real square_size = d.cosine * d.cosine + d.sine * d.sine;
    if (d.cosine > R(0) && d.sine * d.sine <= largest_sine * largest_sine * square_size) return LACONIC_OK;
    return refuse(why, LACONIC_TWIST_JUMPS, (laconic_field)LACONIC_FIELD_OF_BODY_HINGE, b,
                  laconic_articulated_angle_of(d), largest_sine < R(1) ? largest_sine : R(1.57079632679489661923));
}

laconic_status laconic_articulated_check_twist(const laconic_articulated_model *m, const articulated_drive *from,
                                               const articulated_drive *to, real largest_sine, laconic_refusal *why) {
    laconic_status status = check_against_wheels(m, to, why);
    for (int32_t b = 1; status == LACONIC_OK && b <= m->body_count; b++) {
        const laconic_link *link = &m->link[b - 1];
        if (link->motion != LACONIC_MOTION_COORDINATED) continue;
        const direction w = twist_at_hinge(link, to->twist[0]);
        if (!(w.cosine * w.cosine + w.sine * w.sine > least_square_of(to->twist[0])))
            return laconic_articulated_refuse_twist(b, m, to, why);
        status = check_turn(link, b, from->twist[0], to->twist[0], largest_sine, why);
    }
    return status;
}

#endif
