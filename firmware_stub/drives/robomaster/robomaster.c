/* RoboMaster C620 and C610: brushless speed controllers that take a current each, four in a frame. From the user guides
 * "RoboMaster C620 Brushless DC Motor Speed Controller" and "RoboMaster C610 Brushless DC Motor Speed Controller",
 * chapters "CAN Communication Protocol":
 *
 *   commands   standard frames 0x200 (controllers 1 to 4) and 0x1FF (5 to 8) of eight bytes, at 1 Mbit/s: a signed
 *              16-bit number for each controller in turn, high byte first; ±16384 is ±20 A (C620), ±10000 is ±10 A
 *              (C610)
 *   feedback   0x200 + number, a thousand times a second by default: angle of the rotor (0 to 8191 for a turn), its
 *              speed in rpm, torque current in the units of the command, each of two bytes, high byte first; byte 6:
 *              temperature of the motor in °C (C620), nothing (C610); byte 7: nothing
 *
 * They have no speed loop: the controller on the bus closes it, at each feedback. They have no command that clears a
 * fault, so a fault that has no cause any more ends at the next command. The temperature is constant, since drives have
 * no thermal model. The guides do not state what follows when commands cease: without DRIVE_WATCHDOG the last command
 * stays, with it the drive goes off so long after a command, and on again by
 * the next one. */
#include "laconic_drives/protocol.h"

enum { COMMAND_1_TO_4 = 0x200, COMMAND_5_TO_8 = 0x1FF, FEEDBACK = 0x200, TURN = 8192, PERIOD_US = 1000 };

#define TEMPERATURE_C 25U

typedef struct kind {
    int32_t full_scale; /* of the command */
    laconic_real full_scale_A;
    uint8_t temperature_C;
} kind;

static const kind c620 = {16384, 20, TEMPERATURE_C};
static const kind c610 = {10000, 10, 0};

/* Of one controller. */
typedef struct axis {
    uint32_t next_us; /* when feedback is due                                            */
    uint32_t fed_us;  /* when the last command came                                      */
    uint16_t is_due;  /* feedback is to be sent                                          */
    uint16_t is_fed;  /* a command has come: silence before the first one is no fault    */
} axis;

static axis *axis_of(const laconic_drives *drives, int32_t k) { return (axis *)drives->axes + k; }

static const kind *kind_of(const laconic_drives *drives) {
    return drives->protocol == &laconic_robomaster ? &c620 : &c610;
}

static void start(laconic_drives *drives, uint32_t now_us) {
    for (int32_t k = 0; k < drives->count; k++) axis_of(drives, k)->next_us = now_us + PERIOD_US;
}

static void command(laconic_wheel_drive *drive, const kind *of, const uint8_t *data) {
    const int16_t raw = (int16_t)(data[0] << 8 | data[1]);
    const int32_t most = of->full_scale;
    const int32_t value = raw > most ? most : raw < -most ? -most : raw;
    if (drive->faults & ~drive->causes) laconic_drive_clear(drive);
    drive->target.mode = LACONIC_DRIVE_CURRENT;
    drive->target.current_A = (laconic_real)value * (of->full_scale_A / (laconic_real)most);
}

static void on_frame(laconic_drives *drives, const laconic_frame *frame, uint32_t now_us) {
    const bool low = frame->id == COMMAND_1_TO_4;
    if ((!low && frame->id != COMMAND_5_TO_8) || frame->extended || frame->remote || frame->fd) return;
    if (frame->length != 8) return;
    for (int32_t k = 0; k < drives->count; k++) {
        const int32_t place = drives->drive[k].settings.node_id - (low ? 1 : 5);
        if (place < 0 || place > 3 || laconic_drive_is_off_bus(&drives->drive[k])) continue;
        command(&drives->drive[k], kind_of(drives), &frame->data[2 * place]);
        axis_of(drives, k)->fed_us = now_us;
        axis_of(drives, k)->is_fed = 1;
    }
}

/* A vehicle whose step is longer than a millisecond has nothing new in between: its feedback comes each step. */
static bool feedback_is_due(const laconic_drives *drives, axis *of, uint32_t now_us) {
    if (drives->step_s * (laconic_real)1e6 >= (laconic_real)PERIOD_US) return true;
    if ((int32_t)(now_us - of->next_us) < 0) return false;
    of->next_us += PERIOD_US;
    return true;
}

static void on_step(laconic_drives *drives, uint32_t now_us) {
    const uint32_t watchdog_us = (uint32_t)(drives->watchdog_s * (laconic_real)1e6);
    for (int32_t k = 0; k < drives->count; k++) {
        axis *of = axis_of(drives, k);
        if (watchdog_us > 0 && of->is_fed && now_us - of->fed_us > watchdog_us)
            laconic_drive_fail(&drives->drive[k], LACONIC_DRIVE_FAULT_WATCHDOG);
        if (feedback_is_due(drives, of, now_us)) of->is_due = 1;
        if (laconic_drive_is_off_bus(&drives->drive[k]) || laconic_drive_is_mute(&drives->drive[k])) of->is_due = 0;
    }
}

static void put16(uint8_t *to, laconic_real value) {
    const laconic_real half = (laconic_real)0.5;
    const laconic_real bounded = value > 32767 ? 32767 : value < -32768 ? -32768 : value;
    const int32_t number = (int32_t)(bounded < 0 ? bounded - half : bounded + half);
    to[0] = (uint8_t)((uint32_t)number >> 8 & 255U);
    to[1] = (uint8_t)((uint32_t)number & 255U);
}

/* The encoder of a motor has its own number of counts; its turn is told in 8192 parts, found by long division. */
static laconic_real angle_of(const laconic_wheel_drive *drive) {
    const uint32_t turn = (uint32_t)drive->settings.encoder_counts;
    uint32_t rest = (uint32_t)laconic_drive_shaft_count(drive), parts = 0;
    for (int32_t part = TURN; part > 1; part /= 2) {
        const bool is_beyond = 2U * rest >= turn;
        rest = 2U * rest - (is_beyond ? turn : 0);
        parts = 2U * parts + (is_beyond ? 1U : 0U);
    }
    return (laconic_real)parts;
}

static void feedback(const laconic_wheel_drive *drive, const kind *of, laconic_frame *frame) {
    const laconic_real rpm_per_rad_per_s = (laconic_real)9.54929658551372014613;
    const laconic_frame empty = {.id = FEEDBACK + (uint32_t)drive->settings.node_id, .length = 8};
    *frame = empty;
    put16(&frame->data[0], angle_of(drive));
    put16(&frame->data[2], drive->speed_rad_per_s * rpm_per_rad_per_s);
    put16(&frame->data[4], drive->current_A * ((laconic_real)of->full_scale / of->full_scale_A));
    frame->data[6] = of->temperature_C;
}

static bool next_frame(laconic_drives *drives, laconic_frame *frame) {
    for (int32_t k = 0; k < drives->count; k++) {
        if (!axis_of(drives, k)->is_due) continue;
        axis_of(drives, k)->is_due = 0;
        feedback(&drives->drive[k], kind_of(drives), frame);
        return true;
    }
    return false;
}

const laconic_drive_protocol laconic_robomaster = {.name = "robomaster",
                                                   .axis_bytes = sizeof(axis),
                                                   .first_id = 1,
                                                   .last_id = 8,
                                                   .start = start,
                                                   .on_frame = on_frame,
                                                   .on_step = on_step,
                                                   .next_frame = next_frame};

const laconic_drive_protocol laconic_robomaster_c610 = {.name = "robomaster-c610",
                                                        .axis_bytes = sizeof(axis),
                                                        .first_id = 1,
                                                        .last_id = 8,
                                                        .start = start,
                                                        .on_frame = on_frame,
                                                        .on_step = on_step,
                                                        .next_frame = next_frame};
