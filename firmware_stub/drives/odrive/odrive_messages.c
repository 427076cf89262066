/* The payloads that a drive sends, by command. */
#include "../octets.h"
#include "odrive.h"

typedef void fill(const laconic_wheel_drive *drive, const odrive_axis *axis, uint8_t *data);

/* Power that the motor takes: what it gives off at the shaft and what its winding turns into heat. */
static laconic_real electrical_power(const laconic_wheel_drive *drive) {
    const laconic_drive_settings *settings = &drive->settings;
    return (settings->torque_constant_Nm_per_A * drive->speed_rad_per_s +
            settings->winding_resistance_ohm * drive->current_A) *
           drive->current_A;
}

static laconic_real torque(const laconic_wheel_drive *drive) {
    return drive->settings.torque_constant_Nm_per_A * drive->current_A;
}

/* Protocol 2, no product of ODrive Robotics (hardware 0.0.0), firmware 0.6.10, released. */
static void version(const laconic_wheel_drive *drive, const odrive_axis *axis, uint8_t *data) {
    (void)drive, (void)axis;
    data[0] = 2;
    data[5] = 6;
    data[6] = 10;
}

static void heartbeat(const laconic_wheel_drive *drive, const odrive_axis *axis, uint8_t *data) {
    (void)drive;
    octets_put_u32(data, axis->errors | axis->disarm_reason);
    data[4] = axis->state;
    data[5] = axis->result;
    data[6] = !axis->travelling;
}

static void error(const laconic_wheel_drive *drive, const odrive_axis *axis, uint8_t *data) {
    (void)drive;
    octets_put_u32(data, axis->errors);
    octets_put_u32(data + 4, axis->disarm_reason);
}

static void encoder_estimates(const laconic_wheel_drive *drive, const odrive_axis *axis, uint8_t *data) {
    octets_put_real(data, place_turns(odrive_place(axis, drive), drive->settings.encoder_counts));
    octets_put_real(data + 4, drive->speed_rad_per_s / (2 * ODRIVE_PI));
}

/* Set and measured are the same here, and 0 of a drive that is off. */
static void currents(const laconic_wheel_drive *drive, const odrive_axis *axis, uint8_t *data) {
    (void)axis;
    octets_put_real(data, drive->current_A);
    octets_put_real(data + 4, drive->current_A);
}

/* Drives have no thermal model: always 25 °C. */
static void temperature(const laconic_wheel_drive *drive, const odrive_axis *axis, uint8_t *data) {
    (void)drive, (void)axis;
    octets_put_real(data, 25);
    octets_put_real(data + 4, 25);
}

static void bus(const laconic_wheel_drive *drive, const odrive_axis *axis, uint8_t *data) {
    (void)axis;
    const laconic_real supply_V = drive->settings.supply_V;
    octets_put_real(data, supply_V);
    octets_put_real(data + 4, supply_V > 0 ? electrical_power(drive) / supply_V : 0);
}

static void torques(const laconic_wheel_drive *drive, const odrive_axis *axis, uint8_t *data) {
    (void)axis;
    octets_put_real(data, torque(drive));
    octets_put_real(data + 4, torque(drive));
}

static void powers(const laconic_wheel_drive *drive, const odrive_axis *axis, uint8_t *data) {
    (void)axis;
    octets_put_real(data, electrical_power(drive));
    octets_put_real(data + 4, torque(drive) * drive->speed_rad_per_s);
}

static fill *const fills[ODRIVE_COMMANDS] = {
    [ODRIVE_GET_VERSION] = version,
    [ODRIVE_HEARTBEAT] = heartbeat,
    [ODRIVE_GET_ERROR] = error,
    [ODRIVE_GET_ENCODER_ESTIMATES] = encoder_estimates,
    [ODRIVE_GET_IQ] = currents,
    [ODRIVE_GET_TEMPERATURE] = temperature,
    [ODRIVE_GET_BUS_VOLTAGE_CURRENT] = bus,
    [ODRIVE_GET_TORQUES] = torques,
    [ODRIVE_GET_POWERS] = powers,
};

bool odrive_sends(uint32_t command) { return command == ODRIVE_ADDRESS || fills[command] != NULL; }

void odrive_message(const laconic_drives *drives, int32_t i, odrive_command command, laconic_frame *frame) {
    const odrive_axis *axis = (const odrive_axis *)drives->axes + i;
    memset(frame, 0, sizeof *frame);
    frame->id = (uint32_t)axis->node_id << ODRIVE_COMMAND_BITS | (uint32_t)command;
    frame->length = 8;
    if (command == ODRIVE_ADDRESS) {
        frame->data[0] = axis->node_id;
        octets_put_u32(frame->data + 1, odrive_serial_number(i));
        octets_put_u16(frame->data + 5, ODRIVE_SERIAL_NUMBER_HIGH);
    } else {
        fills[command](&drives->drive[i], axis, frame->data);
    }
}
