/* Places and motion between them: whole counts and shares of a count are added apart. */
#include "place.h"
#include "octets.h"

static const laconic_real most_turns = 1073741824;  /* 2^30 */
static const laconic_real most_counts = 2147483520; /* the largest number below 2^31 of single precision */

static int64_t sum(int64_t a, int64_t b) { return (int64_t)((uint64_t)a + (uint64_t)b); }

drive_place place_moved(drive_place place, laconic_real counts) {
    if (counts != counts) return place;
    counts = real_within(counts, -most_counts, most_counts);
    int32_t whole = (int32_t)counts;
    if ((laconic_real)whole > counts) whole--;
    place.rest += counts - (laconic_real)whole;
    if (place.rest >= 1) {
        place.rest -= 1;
        whole++;
    }
    place.count = sum(place.count, whole);
    return place;
}

drive_place place_at(laconic_real turns, int32_t counts_per_turn) {
    turns = real_within(turns, -most_turns, most_turns);
    const int32_t whole = (int32_t)turns;
    const drive_place place = {(int64_t)whole * counts_per_turn, 0};
    return place_moved(place, (turns - (laconic_real)whole) * (laconic_real)counts_per_turn);
}

/* The quotient need not be exact, since what is left makes up for it; so it takes no division of 64 bits, which is a
 * function of its own on small processors. */
laconic_real place_turns(drive_place place, int32_t counts_per_turn) {
    const laconic_real about = (laconic_real)place.count / (laconic_real)counts_per_turn;
    const int32_t turns = (int32_t)real_within(about, -most_turns, most_turns);
    place.count = sum(place.count, -(int64_t)turns * counts_per_turn);
    return (laconic_real)turns + place_counts(place) / (laconic_real)counts_per_turn;
}

drive_place place_sum(drive_place a, drive_place b) {
    a.count = sum(a.count, b.count);
    return place_moved(a, b.rest);
}

drive_place place_difference(drive_place a, drive_place b) {
    a.count = (int64_t)((uint64_t)a.count - (uint64_t)b.count);
    return place_moved(a, -b.rest);
}

laconic_real place_counts(drive_place place) { return (laconic_real)place.count + place.rest; }

/* Where a motion is, seen from its target: the way that is left is not negative, and speeds are along it. */
typedef struct view {
    laconic_real way, speed, target_speed;
} view;

/* As much acceleration as allowed while the motion could still stop after the next step, else as little as stops at the
 * target: in the frame of the target, whose speed is zero there. */
static laconic_real acceleration(const drive_motion *motion, const view *course, laconic_real step_s) {
    const laconic_real along = course->speed - course->target_speed, most = motion->deceleration;
    const laconic_real faster = along + motion->acceleration * step_s;
    if (real_magnitude(course->speed) > motion->speed_limit) return course->speed > 0 ? -most : most;
    if (along < 0) return most;
    if (course->way - (along + faster) / 2 * step_s >= faster * faster / (2 * most))
        return real_magnitude(course->speed) < motion->speed_limit ? motion->acceleration : 0;
    const laconic_real braking = along * along / (2 * course->way);
    return braking < most ? -braking : -most;
}

/* True once the target is as near as a step comes. */
static bool ramp(const drive_motion *motion, view *course, laconic_real step_s) {
    const laconic_real before = course->speed, limit = motion->speed_limit;
    const laconic_real step = motion->deceleration * step_s;
    laconic_real after = before + acceleration(motion, course, step_s) * step_s;
    if ((real_magnitude(before) - limit) * (real_magnitude(after) - limit) < 0) after = after < 0 ? -limit : limit;
    course->speed = after;
    const laconic_real off = real_magnitude(after - course->target_speed),
                       target = real_magnitude(course->target_speed);
    const bool is_crossed = (before - course->target_speed) * (after - course->target_speed) <= 0;
    return (is_crossed || off < step) && course->way <= ((off > target ? off : target) * 2 + step) * step_s;
}

bool motion_step(drive_motion *motion, laconic_real step_s) {
    const laconic_real distance = place_counts(place_difference(motion->target, motion->place));
    const laconic_real side = distance < 0 ? -1 : 1, before = motion->speed;
    view course = {distance * side, before * side, motion->target_speed * side};
    const bool arrives = ramp(motion, &course, step_s);
    motion->speed = arrives ? motion->target_speed : course.speed * side;
    motion->target = place_moved(motion->target, motion->target_speed * step_s);
    motion->place = arrives ? motion->target : place_moved(motion->place, (before + motion->speed) / 2 * step_s);
    return arrives;
}
