/* Places and motion between them: whole counts and shares of a count are added apart. */
#include "place.h"
#include "octets.h"

static const laconic_real most_turns = 1073741824;                  /* 2^30 */
static const laconic_real most_counts = (laconic_real)1.1529215e18; /* about 2^60 */

static int64_t sum(int64_t a, int64_t b) { return (int64_t)((uint64_t)a + (uint64_t)b); }

drive_place place_moved(drive_place place, laconic_real counts) {
    if (counts != counts) return place;
    counts = real_within(counts, -most_counts, most_counts);
    int64_t whole = (int64_t)counts;
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

laconic_real place_turns(drive_place place, int32_t counts_per_turn) {
    const int64_t whole = place.count / counts_per_turn;
    const laconic_real counts = (laconic_real)(place.count - whole * counts_per_turn) + place.rest;
    return (laconic_real)whole + counts / (laconic_real)counts_per_turn;
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

/* The acceleration of the next step: as much as allowed while the motion could still stop after it, else as little as
 * stops at the target. In the frame of the target, whose speed is zero there. */
static laconic_real acceleration(const drive_motion *motion, laconic_real distance, laconic_real step_s) {
    const laconic_real speed = motion->speed - motion->target_speed;
    const laconic_real slower = speed > 0 ? -motion->deceleration : motion->deceleration;
    if (real_magnitude(motion->speed) > motion->speed_limit)
        return motion->speed > 0 ? -motion->deceleration : motion->deceleration;
    if (speed * distance < 0 || distance == 0) return speed == 0 ? 0 : slower;
    const laconic_real fast = real_magnitude(speed), far = real_magnitude(distance);
    const laconic_real faster = fast + motion->acceleration * step_s;
    const laconic_real left = far - (fast + faster) / 2 * step_s;
    if (left >= faster * faster / (2 * motion->deceleration)) {
        if (real_magnitude(motion->speed) >= motion->speed_limit) return 0;
        return distance > 0 ? motion->acceleration : -motion->acceleration;
    }
    const laconic_real needed = fast * fast / (2 * far);
    if (needed >= motion->deceleration) return slower;
    return speed > 0 ? -needed : needed;
}

/* No acceleration: at the limit of the speed until the step that would pass the target. */
static bool glide(drive_motion *motion, laconic_real distance, laconic_real step_s) {
    motion->speed = distance < 0 ? -motion->speed_limit : motion->speed_limit;
    return distance == 0 || (distance - motion->speed * step_s < 0) != (distance < 0);
}

static bool ramp(drive_motion *motion, laconic_real distance, laconic_real step_s) {
    const laconic_real before = motion->speed, change = acceleration(motion, distance, step_s) * step_s;
    laconic_real after = before + change;
    const laconic_real limit = motion->speed_limit;
    const laconic_real least = real_magnitude(before) < real_magnitude(after) ? before : after;
    const laconic_real most = real_magnitude(before) < real_magnitude(after) ? after : before;
    if (real_magnitude(least) < limit && real_magnitude(most) > limit) after = after < 0 ? -limit : limit;
    motion->speed = after;
    const laconic_real off = real_magnitude(after - motion->target_speed);
    const bool crossed = (before - motion->target_speed) * (after - motion->target_speed) <= 0;
    const bool slow = crossed || off < motion->deceleration * step_s;
    const laconic_real fastest =
        off > real_magnitude(motion->target_speed) ? off : real_magnitude(motion->target_speed);
    return slow && real_magnitude(distance) <= fastest * 2 * step_s + motion->deceleration * step_s * step_s;
}

bool motion_step(drive_motion *motion, laconic_real step_s) {
    const laconic_real distance = place_counts(place_difference(motion->target, motion->place)), before = motion->speed;
    const bool gradual = is_finite(motion->acceleration);
    const bool arrives = gradual ? ramp(motion, distance, step_s) : glide(motion, distance, step_s);
    motion->target = place_moved(motion->target, motion->target_speed * step_s);
    const laconic_real mean = gradual ? (before + motion->speed) / 2 : motion->speed;
    motion->place = arrives ? motion->target : place_moved(motion->place, mean * step_s);
    if (arrives) motion->speed = motion->target_speed;
    return arrives;
}
