/* States of an axis: procedures, closed loop, and the errors that disarm it. */
#include "odrive.h"

/* A calibrated drive that calibrates again: the procedure takes this long and changes nothing. */
enum { PROCEDURE_US = 200000 };

/* States that are procedures of a drive which has motor and encoder: 3 full calibration, 4 motor calibration, 6 index
 * search, 7 encoder offset, 10 direction find, 12 and 13 hall calibrations. */
static bool is_procedure(uint32_t state) { return state <= 13 && 0x34D8U >> state & 1U; }

static void enter(odrive_axis *axis, odrive_state state, odrive_result result) {
    axis->state = (uint8_t)state;
    axis->result = (uint8_t)result;
    axis->travelling = false;
}

void odrive_disarm(odrive_axis *axis, laconic_wheel_drive *drive, uint32_t error) {
    axis->errors |= error;
    if (axis->state != ODRIVE_IDLE) {
        axis->disarm_reason |= error;
        enter(axis, ODRIVE_IDLE, ODRIVE_DISARMED);
    }
    laconic_drive_off(drive);
}

void odrive_clear_errors(odrive_axis *axis, laconic_wheel_drive *drive) {
    axis->errors = axis->disarm_reason = 0;
    axis->result = axis->state == ODRIVE_IDLE ? ODRIVE_SUCCESS : axis->result;
    if (drive->faults) laconic_drive_clear(drive);
}

/* Of the input modes 0 to 3, 5 and 6. */
static bool is_modelled(const odrive_axis *axis) {
    const bool control = axis->control_mode - ODRIVE_TORQUE <= ODRIVE_POSITION - ODRIVE_TORQUE;
    return control && axis->input_mode <= ODRIVE_TORQUE_RAMP && (0x6FU >> axis->input_mode & 1U) != 0;
}

/* Position control begins where the shaft is (Controller::control_mode_updated of 0.5.6). */
static void begin_where_it_is(odrive_axis *axis, const laconic_wheel_drive *drive) {
    if (axis->control_mode == ODRIVE_POSITION) axis->input_place = axis->place = odrive_place(axis, drive);
    axis->travelling = false;
}

void odrive_set_mode(odrive_axis *axis, const laconic_wheel_drive *drive, uint32_t control_mode, uint32_t input_mode) {
    axis->control_mode = control_mode;
    axis->input_mode = input_mode;
    begin_where_it_is(axis, drive);
}

/* Axis::start_closed_loop_control of 0.5.6. Errors are cleared first: its motor disarms again as long as one is set. */
static void close_loop(odrive_axis *axis, laconic_wheel_drive *drive, uint32_t now_us) {
    if (axis->errors != 0) {
        enter(axis, ODRIVE_IDLE, ODRIVE_DISARMED);
        return;
    }
    begin_where_it_is(axis, drive);
    axis->speed = axis->torque = 0;
    axis->fed_us = now_us;
    enter(axis, ODRIVE_CLOSED_LOOP_CONTROL, ODRIVE_BUSY);
}

void odrive_request(laconic_drives *drives, int32_t i, uint32_t state, uint32_t now_us) {
    odrive_axis *axis = odrive_axis_of(drives, i);
    laconic_wheel_drive *drive = &drives->drive[i];
    if (state == ODRIVE_UNDEFINED || (state == ODRIVE_CLOSED_LOOP_CONTROL && axis->state == state)) return;
    const bool was_busy = axis->state != ODRIVE_IDLE;
    laconic_drive_off(drive);
    axis->state_us = now_us;
    if (state == ODRIVE_CLOSED_LOOP_CONTROL)
        close_loop(axis, drive, now_us);
    else if (is_procedure(state))
        enter(axis, (odrive_state)state, ODRIVE_BUSY);
    else if (state == ODRIVE_IDLE)
        enter(axis, ODRIVE_IDLE, was_busy ? ODRIVE_CANCELLED : ODRIVE_SUCCESS);
    else if (state == ODRIVE_STARTUP_SEQUENCE) /* nothing is configured to run at startup */
        enter(axis, ODRIVE_IDLE, ODRIVE_SUCCESS);
    else
        enter(axis, ODRIVE_IDLE, state == ODRIVE_HOMING ? ODRIVE_HOMING_WITHOUT_ENDSTOP : ODRIVE_INVALID_STATE);
}

/* Faults of the drive are bits 0 to 7. */
static uint32_t errors_of(uint32_t faults) {
    static const uint32_t errors[] = {
        ODRIVE_MISSING_ESTIMATE,         /* encoder     */
        ODRIVE_SPINOUT_DETECTED,         /* stall       */
        ODRIVE_INVERTER_OVER_TEMP,       /* temperature */
        ODRIVE_VELOCITY_LIMIT_VIOLATION, /* overspeed   */
        ODRIVE_DC_BUS_UNDER_VOLTAGE,     /* supply      */
        ODRIVE_WATCHDOG_TIMER_EXPIRED,   /* watchdog    */
        ODRIVE_POSITION_LIMIT_VIOLATION, /* following   */
        ODRIVE_BAD_CONFIG,               /* target      */
    };
    uint32_t bits = 0;
    for (size_t k = 0; k < sizeof errors / sizeof errors[0]; k++)
        if (faults >> k & 1U) bits |= errors[k];
    return bits;
}

static bool is_silent(const laconic_drives *drives, const odrive_axis *axis, uint32_t now_us) {
    return drives->watchdog_s > 0 && (laconic_real)(now_us - axis->fed_us) > drives->watchdog_s * 1000000;
}

/* controller.config.vel_limit_tolerance is 1.2. */
static bool is_too_fast(const odrive_axis *axis, const laconic_wheel_drive *drive) {
    const laconic_real limit = axis->speed_limit * (2 * ODRIVE_PI) * (laconic_real)1.2;
    return drive->speed_rad_per_s > limit || drive->speed_rad_per_s < -limit;
}

void odrive_supervise(laconic_drives *drives, int32_t i, uint32_t now_us) {
    odrive_axis *axis = odrive_axis_of(drives, i);
    laconic_wheel_drive *drive = &drives->drive[i];
    if (axis->state == ODRIVE_CLOSED_LOOP_CONTROL && is_silent(drives, axis, now_us))
        laconic_drive_fail(drive, LACONIC_DRIVE_FAULT_WATCHDOG);
    if (drive->faults) odrive_disarm(axis, drive, errors_of(drive->faults));
    if (axis->state == ODRIVE_CLOSED_LOOP_CONTROL) {
        if (is_too_fast(axis, drive)) odrive_disarm(axis, drive, ODRIVE_VELOCITY_LIMIT_VIOLATION);
        if (!is_modelled(axis)) odrive_disarm(axis, drive, ODRIVE_BAD_CONFIG);
    } else if (axis->state != ODRIVE_IDLE && now_us - axis->state_us >= PROCEDURE_US) {
        enter(axis, ODRIVE_IDLE, ODRIVE_SUCCESS);
    }
}
