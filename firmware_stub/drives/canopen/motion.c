/* Modes of operation: from the objects of targets and limits to the target of the drive, once before each step of the
 * core. Speeds in counts/s, positions in counts of the encoder. */
#include "canopen.h"

#define MOST_COUNTS ((laconic_real)2147483520) /* the largest number below 2^31 of single precision */
static const laconic_real two_pi = (laconic_real)6.283185307179586;

static laconic_real limited(laconic_real value, laconic_real limit) {
    return value > limit ? limit : value < -limit ? -limit : value;
}

static laconic_real magnitude(laconic_real value) { return value < 0 ? -value : value; }

laconic_real canopen_actual_speed(const laconic_wheel_drive *drive) {
    return drive->speed_rad_per_s * (laconic_real)drive->settings.encoder_counts / two_pi;
}

int32_t canopen_rounded(laconic_real value) {
    if (!(value < MOST_COUNTS)) return value >= MOST_COUNTS ? INT32_MAX : 0;
    if (value <= -MOST_COUNTS) return -INT32_MAX;
    return (int32_t)(value < 0 ? value - (laconic_real)0.5 : value + (laconic_real)0.5);
}

bool canopen_has_mode(int8_t mode) {
    return mode == 0 || (mode > 0 && mode <= CANOPEN_CYCLIC_TORQUE && (CANOPEN_MODES >> (mode - 1) & 1) != 0);
}

static bool follows_position(const canopen_axis *axis) {
    return axis->mode_display == CANOPEN_PROFILE_POSITION || axis->mode_display == CANOPEN_CYCLIC_POSITION;
}

/* Of two positions of 32 bits that wrap, the one beyond the demand that is nearest to it. */
static laconic_real way_to(const canopen_axis *axis, int32_t position) {
    const int32_t counts = (int32_t)((uint32_t)position - (uint32_t)axis->demand);
    return (laconic_real)counts - axis->demand_rest;
}

static void arrive(canopen_axis *axis, int32_t position) {
    axis->demand += (int32_t)((uint32_t)position - (uint32_t)axis->demand);
    axis->demand_rest = 0;
}

static void advance(canopen_axis *axis, laconic_real counts) {
    const laconic_real sum = limited(axis->demand_rest + counts, MOST_COUNTS);
    int32_t whole = (int32_t)sum;
    if ((laconic_real)whole > sum) whole--;
    axis->demand += whole;
    axis->demand_rest = sum - (laconic_real)whole;
}

/* At the transition to operation enabled, and with another mode: the demand begins where the wheel is. */
void canopen_begin_motion(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    axis->speed = canopen_actual_speed(on->drive);
    axis->demand = on->drive->encoder.count;
    axis->demand_rest = on->drive->encoder.rest;
    axis->goal = (int32_t)axis->demand;
    axis->left_s = 0;
    axis->set_point = 0;
    axis->trouble &= (uint8_t)~CANOPEN_FOLLOWS_BADLY;
}

/* Mode 0 and the mode that there is change nothing; a drive that slows down goes on doing so. */
void canopen_take_mode(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    if (axis->mode == 0 || axis->mode == axis->mode_display) return;
    axis->mode_display = axis->mode;
    if (axis->state == CANOPEN_ENABLED && axis->ending == CANOPEN_NO_ENDING) canopen_begin_motion(on);
}

/* --- ramps ------------------------------------------------------------------------------------------------------- */

/* The speed one step later, on the way from `from` to `to`. */
static laconic_real ramp(laconic_real from, laconic_real to, laconic_real up, laconic_real down) {
    const bool slows = from > 0 ? to < from : to > from;
    const laconic_real most = slows && from != 0 ? down : up;
    return from + limited(to - from, most);
}

static void slow_down(const canopen_node *on, int which) {
    canopen_axis *axis = on->axis;
    const laconic_real rate = (laconic_real)(which == 2 ? axis->quick_deceleration : axis->deceleration);
    axis->speed = ramp(axis->speed, 0, 0, rate * on->step_s);
}

/* --- modes ------------------------------------------------------------------------------------------------------- */

static void profile_velocity(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    const laconic_real target = limited((laconic_real)axis->target_speed, (laconic_real)axis->max_speed);
    axis->speed = ramp(axis->speed, target, (laconic_real)axis->acceleration * on->step_s,
                       (laconic_real)axis->deceleration * on->step_s);
}

/* The greatest speed from which the drive can still stop within `way`: v² = 2·a·way, by one of Heron's rounds from the
 * present speed, which is near it while the drive slows down. */
static laconic_real braking_speed(laconic_real speed, laconic_real way, laconic_real deceleration) {
    const laconic_real square = 2 * deceleration * way;
    if (speed * speed <= square) return LACONIC_REAL_MAX;
    return (speed + square / speed) / 2;
}

void canopen_new_set_point(const canopen_node *on, uint16_t before) {
    canopen_axis *axis = on->axis;
    const uint16_t word = axis->controlword;
    if ((word & CANOPEN_NEW_SET_POINT) == 0) axis->set_point &= (uint8_t)~CANOPEN_SET_POINT_HELD;
    if (axis->mode_display != CANOPEN_PROFILE_POSITION || (word & ~before & CANOPEN_NEW_SET_POINT) == 0) return;
    const bool is_moving = (axis->set_point & CANOPEN_SET_POINT_MOVES) != 0;
    if ((axis->set_point & CANOPEN_SET_POINT_WAITS) != 0 && (word & CANOPEN_AT_ONCE) == 0) return; /* no room */
    const uint32_t origin = (word & CANOPEN_RELATIVE) != 0 ? (uint32_t)axis->goal : 0U;
    const int32_t goal = (int32_t)(origin + (uint32_t)axis->target_position);
    axis->set_point |= CANOPEN_SET_POINT_HELD;
    if (is_moving && (word & CANOPEN_AT_ONCE) == 0) {
        axis->next_goal = goal;
        axis->set_point |= CANOPEN_SET_POINT_WAITS;
    } else {
        axis->goal = goal;
        axis->set_point = CANOPEN_SET_POINT_MOVES | CANOPEN_SET_POINT_HELD;
    }
}

static void end_set_point(canopen_axis *axis) {
    arrive(axis, axis->goal);
    axis->speed = 0;
    if ((axis->set_point & CANOPEN_SET_POINT_WAITS) != 0) {
        axis->goal = axis->next_goal;
        axis->set_point &= (uint8_t)~CANOPEN_SET_POINT_WAITS;
    } else {
        axis->set_point &= (uint8_t)~CANOPEN_SET_POINT_MOVES;
    }
}

static void profile_position(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    if ((axis->set_point & CANOPEN_SET_POINT_MOVES) == 0) return;
    const laconic_real up = (laconic_real)axis->acceleration * on->step_s, down = (laconic_real)axis->deceleration;
    const uint32_t most = axis->profile_speed < axis->max_speed ? axis->profile_speed : axis->max_speed;
    const laconic_real way = way_to(axis, axis->goal), distance = magnitude(way), direction = way < 0 ? -1 : 1;
    laconic_real speed = direction * axis->speed; /* towards the goal */
    if (speed < 0) {
        speed = ramp(speed, 0, 0, down * on->step_s);
    } else {
        const laconic_real brake = braking_speed(speed, distance, down);
        speed = ramp(speed, (laconic_real)most, up, down * on->step_s);
        if (speed > brake) speed = brake;
    }
    axis->speed = direction * speed;
    if (speed >= 0 && distance <= speed * on->step_s)
        end_set_point(axis);
    else
        advance(axis, axis->speed * on->step_s);
}

static laconic_real interpolation_period_s(const canopen_axis *axis) {
    laconic_real period = axis->period;
    for (int8_t k = axis->period_exponent; k < 0; k++) period /= 10;
    return period;
}

/* From where the demand is to 0x607A, straight, in the interpolation period; the drive begins to move at the first
 * target that comes after operation was enabled. */
static void cyclic_position(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    if ((axis->set_point & CANOPEN_TARGET_IS_NEW) != 0) {
        axis->set_point = 0;
        axis->goal = axis->target_position;
        axis->left_s = interpolation_period_s(axis);
        if (axis->left_s < on->step_s) axis->left_s = on->step_s;
    }
    axis->speed = 0;
    if (axis->left_s <= 0) return;
    axis->speed = way_to(axis, axis->goal) / axis->left_s;
    axis->left_s -= on->step_s;
    if (axis->left_s > on->step_s / 1024) {
        advance(axis, axis->speed * on->step_s);
    } else {
        axis->left_s = 0;
        arrive(axis, axis->goal);
    }
}

/* --- the drive's target ------------------------------------------------------------------------------------------ */

static laconic_real amperes(const canopen_axis *axis, int32_t permille) {
    return axis->rated_A * (laconic_real)permille / 1000;
}

static void set_target(const canopen_node *on, laconic_drive_mode mode, laconic_real speed, laconic_real current_A) {
    const laconic_drive_target target = {
        .mode = mode,
        .position_count = on->axis->demand,
        .position_rest = on->axis->demand_rest,
        .speed_rad_per_s = speed * two_pi / (laconic_real)on->drive->settings.encoder_counts,
        .current_A = current_A,
    };
    on->drive->target = target;
}

static void run_mode(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    const laconic_real offset_A = amperes(axis, axis->torque_offset);
    switch (axis->mode_display) {
    case CANOPEN_PROFILE_POSITION:
        profile_position(on);
        set_target(on, LACONIC_DRIVE_POSITION, axis->speed, 0);
        break;
    case CANOPEN_PROFILE_VELOCITY:
        profile_velocity(on);
        set_target(on, LACONIC_DRIVE_SPEED, axis->speed, 0);
        break;
    case CANOPEN_CYCLIC_POSITION:
        cyclic_position(on);
        set_target(on, LACONIC_DRIVE_POSITION, axis->speed + (laconic_real)axis->speed_offset, offset_A);
        break;
    case CANOPEN_CYCLIC_VELOCITY:
        axis->speed = (laconic_real)axis->target_speed + (laconic_real)axis->speed_offset;
        set_target(on, LACONIC_DRIVE_SPEED, axis->speed, offset_A);
        break;
    case CANOPEN_CYCLIC_TORQUE:
        axis->speed = canopen_actual_speed(on->drive);
        set_target(on, LACONIC_DRIVE_CURRENT, 0, amperes(axis, axis->target_torque + axis->torque_offset));
        break;
    default: set_target(on, LACONIC_DRIVE_OFF, 0, 0); break;
    }
}

/* --- supervision ------------------------------------------------------------------------------------------------- */

static laconic_real following_error(const canopen_node *on) {
    const canopen_axis *axis = on->axis;
    return (laconic_real)(axis->demand - on->drive->encoder.count) + axis->demand_rest - on->drive->encoder.rest;
}

static void watch_following(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    const bool bad = axis->following_window != UINT32_MAX && follows_position(axis) &&
                     magnitude(following_error(on)) > (laconic_real)axis->following_window;
    if (!bad || (axis->trouble & CANOPEN_FOLLOWS_BADLY) == 0) axis->following_us = on->now_us;
    axis->trouble &= (uint8_t)~CANOPEN_FOLLOWS_BADLY;
    if (!bad) return;
    axis->trouble |= CANOPEN_FOLLOWS_BADLY;
    if (on->now_us - axis->following_us >= 1000U * axis->following_ms) canopen_fault(on, 0x8611);
}

static bool halts(const canopen_axis *axis) { return (axis->controlword & CANOPEN_HALT) != 0; }

static bool is_within(laconic_real value, laconic_real window) { return magnitude(value) <= window; }

static bool stands(const canopen_node *on) {
    const canopen_axis *axis = on->axis;
    return axis->speed == 0 && is_within(canopen_actual_speed(on->drive), (laconic_real)axis->speed_threshold);
}

/* Stopping, from whatever mode, is a ramp of the speed to 0; it ends when the wheel stands, too. A halt that ends lets
 * a position mode go on from where the wheel is. */
void canopen_move(const canopen_node *on) {
    canopen_axis *axis = on->axis;
    if (axis->state < CANOPEN_ENABLED || axis->state == CANOPEN_FAULT) return;
    const bool is_ending = axis->ending != CANOPEN_NO_ENDING;
    if (!is_ending && !halts(axis)) {
        watch_following(on);
        if (axis->state == CANOPEN_ENABLED) run_mode(on);
        return;
    }
    slow_down(on, is_ending ? axis->ramp : axis->halt_option);
    set_target(on, LACONIC_DRIVE_SPEED, axis->speed, 0);
    axis->demand = on->drive->encoder.count;
    axis->demand_rest = on->drive->encoder.rest;
    axis->left_s = 0;
    if (is_ending && stands(on) && axis->ending != axis->state) canopen_go(on, axis->ending);
}

/* The statusword's bits 10 target reached, 11 internal limit active, 12 and 13 by mode. */
uint16_t canopen_mode_bits(const canopen_node *on) {
    enum { REACHED = 1024, LIMITED = 2048, BIT_12 = 4096, FOLLOWING_ERROR = 8192 };
    const canopen_axis *axis = on->axis;
    const laconic_real actual = canopen_actual_speed(on->drive);
    const bool still = is_within(actual, (laconic_real)axis->speed_threshold);
    uint16_t bits = on->drive->limits != 0 ? LIMITED : 0;
    if (axis->state < CANOPEN_ENABLED || axis->state == CANOPEN_FAULT) return 0;
    if (axis->trouble & CANOPEN_FOLLOWS_BADLY) bits |= FOLLOWING_ERROR;
    if (axis->ending != CANOPEN_NO_ENDING || halts(axis)) return bits | (stands(on) ? REACHED : 0);
    switch (axis->mode_display) {
    case CANOPEN_PROFILE_POSITION:
        if ((axis->set_point & CANOPEN_SET_POINT_MOVES) == 0 &&
            is_within(following_error(on), (laconic_real)axis->position_window))
            bits |= REACHED;
        if ((axis->set_point & (CANOPEN_SET_POINT_HELD | CANOPEN_SET_POINT_WAITS)) != 0) bits |= BIT_12;
        break;
    case CANOPEN_PROFILE_VELOCITY:
        if (is_within(actual - (laconic_real)axis->target_speed, (laconic_real)axis->speed_window)) bits |= REACHED;
        if (still) bits |= BIT_12;
        break;
    case CANOPEN_CYCLIC_POSITION:
    case CANOPEN_CYCLIC_VELOCITY:
    case CANOPEN_CYCLIC_TORQUE: bits |= BIT_12; break;
    default: break;
    }
    return bits;
}
