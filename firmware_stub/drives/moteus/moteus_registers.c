/* The registers by number: where their value is, and what 1 is worth in each type. */
#include "../octets.h"
#include "moteus.h"

typedef enum scale {
    INTEGER,
    POSITION,
    VELOCITY,
    ACCELERATION,
    CURRENT, /* and temperature */
    RATIO,   /* "PWM": kp_scale and its like */
    VOLTAGE,
    TORQUE,
    TIME,
    POWER,
    SCALES
} scale;

/* What 1 is worth in int8, int16 and int32 (registers.md, Mappings). */
static const laconic_real worth[SCALES][3] = {
    [INTEGER] = {1, 1, 1},
    [POSITION] = {(laconic_real)1e-2, (laconic_real)1e-4, (laconic_real)1e-5},
    [VELOCITY] = {(laconic_real)0.1, (laconic_real)0.00025, (laconic_real)1e-5},
    [ACCELERATION] = {(laconic_real)0.05, (laconic_real)1e-3, (laconic_real)1e-5},
    [CURRENT] = {1, (laconic_real)0.1, (laconic_real)1e-3},
    [RATIO] = {(laconic_real)(1 / 127.0), (laconic_real)(1 / 32767.0), (laconic_real)(1 / 2147483647.0)},
    [VOLTAGE] = {(laconic_real)0.5, (laconic_real)0.1, (laconic_real)1e-3},
    [TORQUE] = {(laconic_real)0.5, (laconic_real)0.01, (laconic_real)1e-3},
    [TIME] = {(laconic_real)0.01, (laconic_real)1e-3, (laconic_real)1e-6},
    [POWER] = {10, (laconic_real)0.05, (laconic_real)1e-4},
};

typedef enum access { READ, WRITE, ABSENT /* not modelled: writes but of NaN are refused */ } access;

typedef struct row {
    uint16_t number;
    uint8_t scale, access;
    uint16_t offset; /* of a laconic_real in moteus_axis */
} row;

#define COMMAND(member) WRITE, offsetof(moteus_axis, given.member)
#define STATUS(member) READ, offsetof(moteus_axis, status.member)

/* By number. Registers that are not here, the phases' PWM and voltages among them, are unknown to this drive. */
static const row rows[] = {
    {0x000, INTEGER, STATUS(mode)},
    {0x001, POSITION, STATUS(position)},
    {0x002, VELOCITY, STATUS(velocity)},
    {0x003, TORQUE, STATUS(torque)},
    {0x004, CURRENT, STATUS(q_current_A)},
    {0x005, CURRENT, STATUS(zero)}, /* direct current */
    {0x006, POSITION, STATUS(zero)},
    {0x007, POWER, STATUS(power_W)},
    {0x00A, CURRENT, STATUS(zero)}, /* motor temperature, as without thermistor */
    {0x00B, INTEGER, STATUS(trajectory_complete)},
    {0x00C, INTEGER, STATUS(home_state)},
    {0x00D, VOLTAGE, STATUS(voltage_V)},
    {0x00E, CURRENT, STATUS(temperature_C)},
    {0x00F, INTEGER, STATUS(fault)},
    {0x01C, CURRENT, COMMAND(q_current_A)},
    {0x01D, CURRENT, COMMAND(d_current_A)},
    {0x020, POSITION, COMMAND(position)},
    {0x021, VELOCITY, COMMAND(velocity)},
    {0x022, TORQUE, COMMAND(feedforward_torque)},
    {0x023, RATIO, COMMAND(kp_scale)},
    {0x024, RATIO, COMMAND(kd_scale)},
    {0x025, TORQUE, COMMAND(maximum_torque)},
    {0x026, POSITION, COMMAND(stop_position)},
    {0x027, TIME, COMMAND(timeout_s)},
    {0x028, VELOCITY, COMMAND(velocity_limit)},
    {0x029, ACCELERATION, COMMAND(acceleration_limit)},
    {0x02A, VOLTAGE, ABSENT, offsetof(moteus_axis, given.fixed_voltage)},
    {0x02B, RATIO, COMMAND(integral_limit_scale)},
    {0x02C, CURRENT, ABSENT, offsetof(moteus_axis, given.fixed_current)},
    {0x02D, INTEGER, COMMAND(ignore_bounds)},
    {0x030, TORQUE, STATUS(torque_of_kp)},
    {0x031, TORQUE, STATUS(zero)}, /* servo.pid_position.ilimit is 0 */
    {0x032, TORQUE, STATUS(torque_of_kd)},
    {0x033, TORQUE, READ, offsetof(moteus_axis, given.feedforward_torque)},
    {0x034, TORQUE, STATUS(command_torque)},
    {0x038, POSITION, STATUS(control_position)},
    {0x039, VELOCITY, STATUS(control_velocity)},
    {0x03A, TORQUE, STATUS(command_torque)},
    {0x03B, POSITION, STATUS(position_error)},
    {0x03C, VELOCITY, STATUS(velocity_error)},
    {0x03D, TORQUE, STATUS(torque_error)},
    {0x040, POSITION, COMMAND(lower_bound)},
    {0x041, POSITION, COMMAND(upper_bound)},
    {0x042, TORQUE, COMMAND(feedforward_torque)},
    {0x043, RATIO, COMMAND(kp_scale)},
    {0x044, RATIO, COMMAND(kd_scale)},
    {0x045, TORQUE, COMMAND(maximum_torque)},
    {0x046, TIME, COMMAND(timeout_s)},
    {0x047, RATIO, COMMAND(integral_limit_scale)},
    {0x048, INTEGER, COMMAND(ignore_bounds)},
    {0x050, POSITION, STATUS(encoder_position)},
    {0x051, VELOCITY, STATUS(encoder_velocity)},
    {0x052, POSITION, STATUS(zero)}, /* no second and third encoder */
    {0x053, VELOCITY, STATUS(zero)},
    {0x054, POSITION, STATUS(zero)},
    {0x055, VELOCITY, STATUS(zero)},
    {0x058, INTEGER, STATUS(encoder_validity)},
    {0x05C, INTEGER, STATUS(zero)}, /* no pins */
    {0x05D, INTEGER, STATUS(zero)},
    {0x05E, INTEGER, STATUS(zero)},
    {0x05F, INTEGER, STATUS(zero)},
    {0x071, INTEGER, STATUS(zero)}, /* clock trim */
    {0x140, INTEGER, STATUS(zero)}, /* no gate driver */
    {0x141, INTEGER, STATUS(zero)},
};

enum {
    MODE = 0x000,
    MILLISECONDS = 0x070,
    MODEL = 0x100,
    FIRMWARE = 0x101,
    REGISTER_MAP = 0x102,
    MULTIPLEX_ID = 0x110
};
enum { SERIAL_NUMBER = 0x120, SET_OUTPUT_NEAREST = 0x130, SET_OUTPUT_EXACT, REQUIRE_REINDEX, RECAPTURE };
enum { UUID = 0x150, UUID_MASK = 0x154, UUID_MASK_CAPABLE = 0x158 };

static const row *find(uint32_t number) {
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++)
        if (rows[k].number == number) return &rows[k];
    return NULL;
}

static laconic_real *value_of(moteus_axis *axis, const row *which) {
    return (laconic_real *)(void *)((uint8_t *)axis + which->offset);
}

static int32_t integer(uint32_t type, const uint8_t *from) {
    return type == MOTEUS_INT8    ? (int32_t)(int8_t)from[0]
           : type == MOTEUS_INT16 ? (int32_t)(int16_t)octets_u16(from)
                                  : (int32_t)octets_u32(from);
}

static laconic_real decode(scale of, uint32_t type, const uint8_t *from) {
    static const int32_t not_set[] = {INT8_MIN, INT16_MIN, INT32_MIN};
    if (type == MOTEUS_FLOAT) return octets_real(from);
    const int32_t raw = integer(type, from);
    if (of != INTEGER && raw == not_set[type]) return real_not_a_number();
    return (laconic_real)raw * worth[of][type];
}

/* Integers end at their largest magnitude but one: the most negative means NaN. Shares are cut off, not rounded. */
static void encode(laconic_real value, scale of, uint32_t type, uint8_t *to) {
    static const int32_t largest[] = {INT8_MAX, INT16_MAX, INT32_MAX};
    if (type == MOTEUS_FLOAT) {
        octets_put_real(to, value);
        return;
    }
    const laconic_real count = value / worth[of][type], most = (laconic_real)largest[type];
    int32_t raw = -largest[type] - 1;
    if (is_finite(value)) raw = count >= most ? largest[type] : count <= -most ? -largest[type] : (int32_t)count;
    if (type == MOTEUS_INT32) octets_put_u32(to, (uint32_t)raw);
    if (type == MOTEUS_INT16) octets_put_u16(to, (uint32_t)raw);
    if (type == MOTEUS_INT8) to[0] = (uint8_t)raw;
}

/* The UUID of drive i: "laconic wheel" and its number. */
static uint32_t uuid_word(int32_t i, uint32_t word) {
    static const uint8_t text[16] = "laconic wheel";
    return octets_u32(text + 4 * word) | (word == 3 ? (uint32_t)(i + 1) << 24 : 0);
}

/* Registers with a place of their own. False: not one of them. */
static bool write_special(laconic_drives *drives, int32_t i, uint32_t number, uint32_t type, const uint8_t *from) {
    moteus_axis *axis = moteus_axis_of(drives, i);
    const laconic_wheel_drive *drive = &drives->drive[i];
    switch (number) {
    case SET_OUTPUT_NEAREST:
    case SET_OUTPUT_EXACT:
        moteus_set_output(axis, drive, decode(POSITION, type, from), number == SET_OUTPUT_EXACT);
        return true;
    case REQUIRE_REINDEX:
        axis->zero = moteus_seen(drive);
        axis->home_state = 1;
        return true;
    case RECAPTURE: moteus_forget_control(axis); return true;
    case UUID_MASK:
    case UUID_MASK + 1:
    case UUID_MASK + 2:
    case UUID_MASK + 3:
        axis->discarded = type != MOTEUS_INT32 || octets_u32(from) != uuid_word(i, number - UUID_MASK);
        return true;
    default: return false;
    }
}

/* 0 to 4, 9 to 13 and 15; of a number with a share its whole part, as the firmware takes it. */
static bool is_modelled(laconic_real mode) { return mode >= 0 && mode < 16 && (0xBE1FU >> (uint32_t)mode & 1U) != 0; }

/* A mode that is not modelled is refused as the controller refuses a number that is no mode. */
static uint32_t write_mode(moteus_axis *axis, laconic_real mode) {
    if (!is_modelled(mode)) return MOTEUS_UNKNOWN_REGISTER;
    moteus_set_mode(axis, mode);
    return 0;
}

uint32_t moteus_write(laconic_drives *drives, int32_t i, uint32_t number, uint32_t type, const uint8_t *from) {
    moteus_axis *axis = moteus_axis_of(drives, i);
    if (number == MODE) return write_mode(axis, decode(INTEGER, type, from));
    if (write_special(drives, i, number, type, from)) return 0;
    const row *which = find(number);
    uint8_t unused[4];
    if (which == NULL)
        return moteus_read(drives, i, number, MOTEUS_INT32, unused) ? MOTEUS_UNKNOWN_REGISTER : MOTEUS_NOT_WRITEABLE;
    if (which->access == READ) return MOTEUS_NOT_WRITEABLE;
    const laconic_real value = decode((scale)which->scale, type, from);
    if (which->access == ABSENT && value == value) return MOTEUS_UNKNOWN_REGISTER;
    *value_of(axis, which) = value;
    return 0;
}

/* Words of 32 bits, which are read as int32 alone. */
static bool register_word(int32_t i, uint32_t number, uint32_t *value) {
    *value = 0;
    if (number == REGISTER_MAP) *value = 5;
    if (number == SERIAL_NUMBER) *value = (uint32_t)i + 1;
    if (number >= UUID && number < UUID_MASK) *value = uuid_word(i, number - UUID);
    return (number >= MODEL && number <= REGISTER_MAP) || (number >= SERIAL_NUMBER && number < SERIAL_NUMBER + 3) ||
           (number >= UUID && number < UUID_MASK);
}

/* It wraps within the integer that is asked for; as a float it counts to 2^23. */
static void put_milliseconds(uint32_t milliseconds, uint32_t type, uint8_t *to) {
    if (type == MOTEUS_FLOAT) octets_put_real(to, (laconic_real)(milliseconds % 8388608U));
    if (type == MOTEUS_INT32) octets_put_u32(to, milliseconds);
    if (type == MOTEUS_INT16) octets_put_u16(to, milliseconds);
    if (type == MOTEUS_INT8) to[0] = (uint8_t)milliseconds;
}

uint32_t moteus_read(laconic_drives *drives, int32_t i, uint32_t number, uint32_t type, uint8_t *to) {
    moteus_axis *axis = moteus_axis_of(drives, i);
    const row *which = find(number);
    uint32_t value;
    if (which != NULL) {
        encode(*value_of(axis, which), (scale)which->scale, type, to);
    } else if (number == MILLISECONDS) {
        put_milliseconds(axis->milliseconds, type, to);
    } else if (number == UUID_MASK_CAPABLE) {
        encode(1, INTEGER, type, to);
    } else if (type == MOTEUS_INT32 && register_word(i, number, &value)) {
        octets_put_u32(to, value);
    } else {
        return MOTEUS_UNKNOWN_REGISTER;
    }
    return 0;
}
