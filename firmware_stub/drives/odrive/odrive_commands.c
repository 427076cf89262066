/* What messages of the controller do. A message that is too short, or that holds no finite number where one belongs,
 * does nothing. */
#include "../octets.h"
#include "odrive.h"

typedef void action(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us);

enum { EXTENT_NONE = 0, EXTENT_BYTE = 1, EXTENT_WORD = 4, EXTENT_ADDRESS = 7, EXTENT_FULL = 8 };
enum { REBOOT_PLAIN = 0, REBOOT_SAVE = 1 };

/* Larger speeds, accelerations and torques are taken as this one: no shaft has them. */
static const laconic_real most = 1000000;

/* Reads a number that is at least `least`; false: it is not, or not finite. */
static bool read(const uint8_t *from, laconic_real least, laconic_real *value) {
    const laconic_real number = octets_real(from);
    if (!is_finite(number) || number < least) return false;
    *value = number > most ? most : number;
    return true;
}

/* The same of the two numbers of a message; both or none. */
static bool read_both(const laconic_frame *frame, laconic_real least, laconic_real *first, laconic_real *second) {
    laconic_real value;
    if (!read(frame->data, least, &value) || !read(frame->data + 4, least, second)) return false;
    *first = value;
    return true;
}

static laconic_wheel_drive *drive_of(laconic_drives *drives, int32_t i) { return &drives->drive[i]; }

static void estop(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    (void)frame, (void)now_us;
    odrive_disarm(odrive_axis_of(drives, i), drive_of(drives, i), ODRIVE_ESTOP_REQUESTED);
}

/* To every node: the drive with this serial number gets the node id. */
static void address(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    (void)now_us;
    const bool is_it = octets_u32(frame->data + 1) == odrive_serial_number(i) &&
                       octets_u16(frame->data + 5) == ODRIVE_SERIAL_NUMBER_HIGH;
    if (is_it && frame->data[0] < ODRIVE_EVERY_NODE) odrive_axis_of(drives, i)->node_id = frame->data[0];
}

static void axis_state(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    odrive_request(drives, i, octets_u32(frame->data), now_us);
}

static void controller_mode(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    (void)now_us;
    odrive_set_mode(odrive_axis_of(drives, i), drive_of(drives, i), octets_u32(frame->data),
                    octets_u32(frame->data + 4));
}

/* Feed-forwards in thousandths: input_vel_scale and input_torque_scale are 1000 by default. */
static void input_pos(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    (void)now_us;
    odrive_axis *axis = odrive_axis_of(drives, i);
    const laconic_real turns = octets_real(frame->data);
    if (!is_finite(turns)) return;
    axis->input_place = place_at(turns, drive_of(drives, i)->settings.encoder_counts);
    axis->input_speed = (laconic_real)(int16_t)octets_u16(frame->data + 4) / 1000;
    axis->input_torque = (laconic_real)(int16_t)octets_u16(frame->data + 6) / 1000;
    axis->travelling = axis->state == ODRIVE_CLOSED_LOOP_CONTROL && axis->input_mode == ODRIVE_TRAP_TRAJ;
}

static void input_vel(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    (void)now_us;
    odrive_axis *axis = odrive_axis_of(drives, i);
    read_both(frame, -most, &axis->input_speed, &axis->input_torque);
}

static void input_torque(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    (void)now_us;
    read(frame->data, -most, &odrive_axis_of(drives, i)->input_torque);
}

/* Infinity is no limit of the speed. The current is never more than the scene has it. */
static void limits(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    (void)now_us;
    odrive_axis *axis = odrive_axis_of(drives, i);
    laconic_drive_settings *settings = &drive_of(drives, i)->settings;
    const laconic_real speed = octets_real(frame->data), current_A = octets_real(frame->data + 4);
    if (!(speed >= 0) || !(current_A >= 0)) return;
    axis->speed_limit = is_finite(speed) ? speed : LACONIC_REAL_MAX;
    settings->speed_limit_rad_per_s = speed < most ? speed * (2 * ODRIVE_PI) : 0;
    if (speed == 0) settings->speed_limit_rad_per_s = LACONIC_REAL_MIN; /* 0 is no limit to the drive */
    settings->current_limit_A = current_A < axis->most_current_A ? current_A : axis->most_current_A;
}

static void travel_speed(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    (void)now_us;
    read(frame->data, LACONIC_EPSILON, &odrive_axis_of(drives, i)->travel_speed);
}

static void travel_accelerations(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    (void)now_us;
    odrive_axis *axis = odrive_axis_of(drives, i);
    read_both(frame, LACONIC_EPSILON, &axis->travel_acceleration, &axis->travel_deceleration);
}

static void inertia(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    (void)now_us;
    read(frame->data, 0, &odrive_axis_of(drives, i)->inertia);
}

/* Enter_DFU_Mode and actions that would erase or load firmware are refused as no drive can: nothing happens. */
static void reboot(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    odrive_axis *axis = odrive_axis_of(drives, i);
    const uint8_t what = frame->length > 0 ? frame->data[0] : REBOOT_PLAIN; /* 0.5 has no byte here */
    if (what != REBOOT_PLAIN && what != REBOOT_SAVE) return;
    if (what == REBOOT_SAVE) {
        axis->saved = drive_of(drives, i)->settings;
        axis->saved.node_id = axis->node_id;
    }
    odrive_restart(drives, i, now_us);
}

static void clear_errors(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    (void)frame, (void)now_us;
    odrive_clear_errors(odrive_axis_of(drives, i), drive_of(drives, i));
}

/* The shaft stays; its place gets another number. */
static void absolute_position(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    (void)now_us;
    const laconic_wheel_drive *drive = drive_of(drives, i);
    const laconic_real turns = octets_real(frame->data);
    const drive_place place = {drive->encoder.count, 0};
    if (is_finite(turns))
        odrive_axis_of(drives, i)->zero = place_difference(place, place_at(turns, drive->settings.encoder_counts));
}

static void position_gain(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    (void)now_us;
    read(frame->data, 0, &drive_of(drives, i)->settings.position_gain_per_s);
}

/* Torque for an error of 1 turn/s, and for its integral of 1 turn. */
static void speed_gains(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    (void)now_us;
    laconic_drive_settings *settings = &drive_of(drives, i)->settings;
    laconic_real gain, integral;
    if (!read_both(frame, 0, &gain, &integral)) return;
    const laconic_real torque_per_current = settings->torque_constant_Nm_per_A * (2 * ODRIVE_PI);
    settings->speed_gain_As = gain / torque_per_current;
    settings->speed_integral_gain_A = integral / torque_per_current;
}

/* Messages that are not here, RxSdo and Enter_DFU_Mode among them, only feed the watchdog. */
static const struct {
    uint8_t command, extent; /* bytes that the message needs */
    action *act;
} rows[] = {
    {ODRIVE_ESTOP, EXTENT_NONE, estop},
    {ODRIVE_ADDRESS, EXTENT_ADDRESS, address},
    {ODRIVE_SET_AXIS_STATE, EXTENT_WORD, axis_state},
    {ODRIVE_SET_CONTROLLER_MODE, EXTENT_FULL, controller_mode},
    {ODRIVE_SET_INPUT_POS, EXTENT_FULL, input_pos},
    {ODRIVE_SET_INPUT_VEL, EXTENT_FULL, input_vel},
    {ODRIVE_SET_INPUT_TORQUE, EXTENT_WORD, input_torque},
    {ODRIVE_SET_LIMITS, EXTENT_FULL, limits},
    {ODRIVE_SET_TRAJ_VEL_LIMIT, EXTENT_WORD, travel_speed},
    {ODRIVE_SET_TRAJ_ACCEL_LIMITS, EXTENT_FULL, travel_accelerations},
    {ODRIVE_SET_TRAJ_INERTIA, EXTENT_WORD, inertia},
    {ODRIVE_REBOOT, EXTENT_NONE, reboot},
    {ODRIVE_CLEAR_ERRORS, EXTENT_NONE, clear_errors},
    {ODRIVE_SET_ABSOLUTE_POSITION, EXTENT_WORD, absolute_position},
    {ODRIVE_SET_POS_GAIN, EXTENT_WORD, position_gain},
    {ODRIVE_SET_VEL_GAINS, EXTENT_FULL, speed_gains},
};

static void act(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t command, uint32_t now_us) {
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++)
        if (rows[k].command == command && frame->length >= rows[k].extent) rows[k].act(drives, i, frame, now_us);
}

/* CANSimple::do_command of 0.5.6: every message to an axis feeds its watchdog, and a request is a remote frame or an
 * empty one. */
void odrive_take(laconic_drives *drives, int32_t i, const laconic_frame *frame, uint32_t now_us) {
    odrive_axis *axis = odrive_axis_of(drives, i);
    const uint32_t command = frame->id & (ODRIVE_COMMANDS - 1);
    const bool request = frame->remote || frame->length == 0;
    axis->fed_us = now_us;
    if (request && odrive_sends(command))
        axis->pending |= 1U << command;
    else if (!frame->remote)
        act(drives, i, frame, command, now_us);
}
