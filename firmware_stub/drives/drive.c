/* One motor drive: its loops and limits, its encoder, its faults. */
#include "laconic_drives/drive.h"

#include "laconic_wire.h" /* LACONIC_NODE_WITH_HINGES */

#include <string.h>

#define R(number) ((laconic_real)(number))
#define TURN_RAD R(6.28318530717958647693)

void laconic_drive_start(laconic_wheel_drive *drive, const laconic_drive_settings *settings) {
    drive->settings = *settings;
    memset((uint8_t *)drive + sizeof drive->settings, 0, sizeof *drive - sizeof drive->settings);
}

/* --------------------------------------------------------------------------------- limits -- */

/* The value within its bounds; sets the limit's bit where it was beyond. NaN stays NaN. */
static laconic_real within(laconic_wheel_drive *drive, laconic_real value, laconic_real least, laconic_real most,
                           uint8_t limit) {
    if (value > most)
        value = most;
    else if (value < least)
        value = least;
    else
        return value;
    drive->limits = (uint8_t)(drive->limits | limit);
    return value;
}

/* The currents that the supply drives through the winding against the back-EMF. Beyond the speed at which the back-EMF
 * reaches the supply these are braking currents alone, as the diodes of a bridge let them flow. The current's own limit
 * comes last, so it always holds. */
static laconic_real limit_current(laconic_wheel_drive *drive, laconic_real current_A) {
    const laconic_drive_settings *s = &drive->settings;
    if (s->supply_V > 0 && s->winding_resistance_ohm > 0) {
        const laconic_real constant = s->back_emf_Vs_per_rad > 0 ? s->back_emf_Vs_per_rad : s->torque_constant_Nm_per_A;
        const laconic_real back_emf_V = constant * drive->speed_rad_per_s;
        current_A = within(drive, current_A, (-s->supply_V - back_emf_V) / s->winding_resistance_ohm,
                           (s->supply_V - back_emf_V) / s->winding_resistance_ohm, LACONIC_DRIVE_AT_SUPPLY);
    }
    return within(drive, current_A, -s->current_limit_A, s->current_limit_A, LACONIC_DRIVE_AT_CURRENT);
}

/* ---------------------------------------------------------------------------------- loops -- */

/* Set speed of the position loop. The difference of the counts is exact, however far the shaft has turned. */
static laconic_real position_loop(const laconic_wheel_drive *drive) {
    const laconic_drive_target *target = &drive->target;
    const int64_t counts = (int64_t)((uint64_t)target->position_count - (uint64_t)drive->encoder.count);
    const laconic_real error_rad =
        ((laconic_real)counts + target->position_rest) * (TURN_RAD / (laconic_real)drive->settings.encoder_counts);
    return drive->settings.position_gain_per_s * error_rad + target->speed_rad_per_s;
}

/* Wanted current of the speed loop. The integral takes up no error while a limit holds the current back from what that
 * error asks for, so it does not wind up. */
static laconic_real speed_loop(laconic_wheel_drive *drive, laconic_real set_rad_per_s, laconic_real step_s) {
    const laconic_drive_settings *s = &drive->settings;
    if (s->speed_limit_rad_per_s > 0)
        set_rad_per_s =
            within(drive, set_rad_per_s, -s->speed_limit_rad_per_s, s->speed_limit_rad_per_s, LACONIC_DRIVE_AT_SPEED);
    const laconic_real error = set_rad_per_s - drive->speed_rad_per_s;
    const laconic_real integral = drive->integral_A + s->speed_integral_gain_A * error * step_s;
    const laconic_real sum_A = s->speed_gain_As * error + drive->target.current_A + integral;
    const laconic_real current_A = limit_current(drive, sum_A);
    if (sum_A == current_A || (sum_A - current_A) * error < 0) drive->integral_A = integral;
    return current_A;
}

static laconic_real set_current(laconic_wheel_drive *drive, laconic_real step_s) {
    if (drive->target.mode == LACONIC_DRIVE_POSITION) return speed_loop(drive, position_loop(drive), step_s);
    if (drive->target.mode == LACONIC_DRIVE_SPEED) return speed_loop(drive, drive->target.speed_rad_per_s, step_s);
    drive->integral_A = 0;
    return limit_current(drive, drive->target.current_A);
}

/* The current follows its set value by an implicit Euler step, which no bandwidth makes overshoot. */
static laconic_real current_loop(laconic_wheel_drive *drive, laconic_real set_A, laconic_real step_s) {
    const laconic_real gain = drive->settings.current_bandwidth_rad_per_s * step_s;
    if (!(gain > 0)) return set_A;
    return limit_current(drive, drive->current_A + (set_A - drive->current_A) * (gain / (1 + gain)));
}

/* No motion for the settings' time though the current is at a limit. */
static void watch_for_stall(laconic_wheel_drive *drive, laconic_real step_s) {
    const uint64_t way_counts =
        (uint64_t)drive->encoder.count - (uint64_t)drive->stalled_count; /* 2^64 − 1: one back */
    const bool pushes = (drive->limits & (LACONIC_DRIVE_AT_CURRENT | LACONIC_DRIVE_AT_SUPPLY)) != 0;
    if (drive->settings.stall_time_s > 0 && pushes && way_counts + 1U <= 2U) {
        drive->stalled_s += step_s;
        if (drive->stalled_s >= drive->settings.stall_time_s) laconic_drive_fail(drive, LACONIC_DRIVE_FAULT_STALL);
    } else {
        drive->stalled_s = 0;
        drive->stalled_count = drive->encoder.count;
    }
}

void laconic_drive_off(laconic_wheel_drive *drive) {
    drive->target.mode = LACONIC_DRIVE_OFF;
    drive->limits = 0;
    drive->integral_A = 0;
    drive->current_A = 0;
    drive->torque_Nm = 0;
}

laconic_real laconic_drive_act(laconic_wheel_drive *drive, laconic_real step_s) {
    watch_for_stall(drive, step_s);
    drive->limits = 0;
    if (drive->faults != 0 || drive->target.mode == LACONIC_DRIVE_OFF) {
        laconic_drive_off(drive);
        return 0;
    }
    const laconic_real current_A = current_loop(drive, set_current(drive, step_s), step_s);
    const laconic_real torque_Nm = drive->settings.torque_constant_Nm_per_A * current_A * drive->settings.gear_ratio;
    if (!(torque_Nm - torque_Nm == 0)) { /* not finite */
        laconic_drive_fail(drive, LACONIC_DRIVE_FAULT_TARGET);
        return 0;
    }
    drive->current_A = current_A;
    drive->torque_Nm = torque_Nm;
    return torque_Nm;
}

#if LACONIC_NODE_WITH_HINGES
laconic_real laconic_drive_follow(laconic_wheel_drive *drive) {
    const laconic_real limit = drive->settings.speed_limit_rad_per_s;
    const bool by_place = drive->target.mode == LACONIC_DRIVE_POSITION;
    drive->limits = 0;
    if (drive->faults != 0 || drive->brake_Nm > 0 || (drive->target.mode != LACONIC_DRIVE_SPEED && !by_place)) return 0;
    laconic_real set_rad_per_s = by_place ? position_loop(drive) : drive->target.speed_rad_per_s;
    if (limit > 0) set_rad_per_s = within(drive, set_rad_per_s, -limit, limit, LACONIC_DRIVE_AT_SPEED);
    const laconic_real rate_rad_per_s = set_rad_per_s / drive->settings.gear_ratio;
    if (rate_rad_per_s - rate_rad_per_s == 0) return rate_rad_per_s;
    laconic_drive_fail(drive, LACONIC_DRIVE_FAULT_TARGET); /* not finite */
    return 0;
}
#endif

/* -------------------------------------------------------------------------------- encoder -- */

void laconic_drive_measure(laconic_wheel_drive *drive, laconic_real turned_rad, laconic_real wheel_speed_rad_per_s) {
    const laconic_drive_settings *s = &drive->settings;
    if (drive->causes & LACONIC_DRIVE_FAULT_ENCODER) {
        drive->speed_rad_per_s = 0;
        return;
    }
    const laconic_encoder_settings encoder = {s->encoder_counts, s->gear_ratio};
    if (!laconic_encoder_turn(&drive->encoder, &encoder, turned_rad))
        laconic_drive_fail(drive, LACONIC_DRIVE_FAULT_ENCODER);
    drive->speed_rad_per_s = wheel_speed_rad_per_s * s->gear_ratio;
}

int32_t laconic_drive_shaft_count(const laconic_wheel_drive *drive) {
    return laconic_encoder_place(&drive->encoder, drive->settings.encoder_counts);
}

/* --------------------------------------------------------------------------------- faults -- */

void laconic_drive_fail(laconic_wheel_drive *drive, uint32_t faults) {
    drive->faults |= faults;
    if (faults & LACONIC_DRIVE_FAULT_WATCHDOG) drive->unheard = true;
    laconic_drive_off(drive);
}

void laconic_drive_clear(laconic_wheel_drive *drive) {
    laconic_drive_off(drive);
    drive->faults = drive->causes;
    drive->stalled_s = 0;
    drive->stalled_count = drive->encoder.count;
}

void laconic_drive_break(laconic_wheel_drive *drive, uint32_t faults) {
    drive->causes |= faults;
    laconic_drive_fail(drive, faults);
}

void laconic_drive_mend(laconic_wheel_drive *drive, uint32_t faults) { drive->causes &= ~faults; }

void laconic_drive_order(laconic_wheel_drive *drive, uint32_t orders) {
    const uint32_t faults = orders & LACONIC_DRIVE_ORDER_FAULTS;
    drive->off_bus = (orders & LACONIC_DRIVE_ORDER_OFF_BUS) != 0;
    drive->mute = (orders & LACONIC_DRIVE_ORDER_SILENT) != 0;
    drive->brake_Nm = orders & LACONIC_DRIVE_ORDER_HELD ? R(LACONIC_DRIVE_HOLDS_NM) : 0;
    laconic_drive_mend(drive, LACONIC_DRIVE_ORDER_FAULTS & ~faults);
    if (faults != 0) laconic_drive_break(drive, faults);
}
