/* The object dictionary: finds an object, and reads and writes it with the checks that SDO and PDO share. */
#include "canopen.h"
#include "objects.h"

#include <string.h>

#define NOTHING(...)
#define AT(member) offsetof(canopen_axis, member)
#define ROW(index, sub, last, type, access, from) {index, (sub) | (last) << 4, (type) | (access), (uint16_t)(from)},
#define FROM_AXIS(index, sub, last, type, access, member, initial, name) ROW(index, sub, last, type, access, AT(member))
#define FROM_ROW(index, sub, last, type, access, value, name) \
    ROW(index, sub, last, type, access, CANOPEN_FROM_ROW | (value))
#define FROM_CALL(index, sub, last, type, access, what, name) \
    ROW(index, sub, last, type, access, CANOPEN_FROM_CALL | CANOPEN_CALL_##what)

static const canopen_row rows[] = {CANOPEN_OBJECTS(NOTHING, FROM_AXIS, FROM_ROW, FROM_CALL)};
enum { ROWS = sizeof rows / sizeof rows[0] };

typedef struct limit {
    uint16_t index;
    uint8_t sub;
    int8_t low;
    uint16_t high; /* UINT16_MAX: that of the type */
} limit;
#define ONE_LIMIT(index, sub, low, high) {index, sub, low, (high) > UINT16_MAX ? UINT16_MAX : (uint16_t)(high)},
static const limit limits[] = {CANOPEN_LIMITS(ONE_LIMIT)};

const canopen_row *canopen_row_at(uint8_t number) { return number < ROWS ? &rows[number] : NULL; }

static bool is_of_pdo(uint16_t index) { return index >= 0x1400 && index < 0x1C00; }

uint8_t canopen_find(uint16_t index, uint8_t sub, uint32_t *abort) {
    const uint16_t first = is_of_pdo(index) ? (uint16_t)(index & ~3U) : index;
    *abort = CANOPEN_NO_OBJECT;
    for (uint8_t k = 0; k < (uint8_t)ROWS; k++) {
        if (rows[k].index != first) continue;
        if (sub >= canopen_sub(&rows[k]) && sub <= rows[k].subs >> 4) return k;
        *abort = CANOPEN_NO_SUB;
    }
    return CANOPEN_NO_ROW;
}

uint8_t canopen_size(const canopen_row *row) {
    static const uint8_t sizes[16] = {
        [CANOPEN_I8] = 1, [CANOPEN_I16] = 2, [CANOPEN_I32] = 4, [CANOPEN_U8] = 1, [CANOPEN_U16] = 2, [CANOPEN_U32] = 4};
    return sizes[row->form & 15U];
}

/* By the lowest bits of 0x1008, 0x1009 and 0x100A. */
const char *canopen_text(uint16_t index) {
    static const char *const texts[4] = {"Laconic drive", "simulated", "0.1.0", ""};
    return texts[index & 3U];
}

void canopen_put(uint8_t *bytes, uint32_t value, uint8_t count) {
    for (; count > 0; count--, value >>= 8) *bytes++ = (uint8_t)value;
}

uint32_t canopen_get(const uint8_t *bytes, uint8_t count) {
    uint32_t value = 0;
    while (count > 0) value = value << 8 | bytes[--count];
    return value;
}

/* --- reading ----------------------------------------------------------------------------------------------------- */

uint32_t canopen_cob_id(uint16_t stored) {
    return (stored & 0x7FFU) | (stored & CANOPEN_OFF ? 1U << 31 : 0U) | (stored & CANOPEN_NO_REMOTE ? 1U << 30 : 0U);
}

/* Current in thousandths of the rated current, which is the torque in thousandths of the rated torque, too. */
static int32_t permille(const canopen_node *on) {
    return canopen_rounded(1000 * on->drive->current_A / on->axis->rated_A);
}

static uint32_t milli(laconic_real value) { return (uint32_t)canopen_rounded(1000 * value); }

static uint32_t history_entry(const canopen_axis *axis, uint8_t sub, uint32_t *value) {
    if (sub > axis->history_count) return CANOPEN_NO_DATA;
    *value = sub == 0 ? axis->history_count : axis->history[sub - 1];
    return 0;
}

static uint32_t call(const canopen_node *on, canopen_call what, uint8_t sub) {
    const canopen_axis *axis = on->axis;
    const laconic_wheel_drive *drive = on->drive;
    switch (what) {
    case CANOPEN_CALL_DEVICE_TYPE: return 0x00020192; /* a servo drive after CiA 402 */
    case CANOPEN_CALL_SYNC_ID: return axis->sync_id;
    case CANOPEN_CALL_EMERGENCY_ID: return canopen_cob_id(axis->emergency_id);
    case CANOPEN_CALL_SDO_ID: return (sub == 1 ? 0x600U : 0x580U) + canopen_id(on);
    case CANOPEN_CALL_SERIAL_NUMBER: return canopen_id(on);
    case CANOPEN_CALL_STATUSWORD: return canopen_statusword(on);
    case CANOPEN_CALL_DEMAND: return (uint32_t)axis->demand;
    case CANOPEN_CALL_POSITION: return (uint32_t)drive->encoder.count;
    case CANOPEN_CALL_FOLLOWING_ERROR: return (uint32_t)(axis->demand - drive->encoder.count);
    case CANOPEN_CALL_DEMAND_SPEED: return (uint32_t)canopen_rounded(axis->speed);
    case CANOPEN_CALL_SPEED: return (uint32_t)canopen_rounded(canopen_actual_speed(drive));
    case CANOPEN_CALL_TORQUE: return (uint32_t)permille(on);
    case CANOPEN_CALL_SUPPLY: return milli(drive->settings.supply_V);
    case CANOPEN_CALL_RATED_CURRENT: return milli(axis->rated_A);
    case CANOPEN_CALL_RATED_TORQUE: return milli(axis->rated_A * drive->settings.torque_constant_Nm_per_A);
    case CANOPEN_CALL_COUNTS: return (uint32_t)drive->settings.encoder_counts;
    case CANOPEN_CALL_POSITION_UNIT: return 0x00B50000; /* increments, by the codes of CiA 303-2: */
    case CANOPEN_CALL_SPEED_UNIT: return 0x00B50300;    /* ... per second */
    default: return 0x00B55700;                         /* CANOPEN_CALL_ACCELERATION_UNIT: ... per square second */
    }
}

static uint32_t from_axis(const canopen_axis *axis, const canopen_row *row) {
    const uint8_t *at = (const uint8_t *)axis + row->from;
    uint16_t two;
    uint32_t four;
    switch (canopen_size(row)) {
    case 1: return *at;
    case 2: memcpy(&two, at, 2); return two;
    default: memcpy(&four, at, 4); return four;
    }
}

uint32_t canopen_read(const canopen_node *on, const canopen_row *row, uint16_t index, uint8_t sub, uint32_t *value) {
    const uint16_t what = row->from & (uint16_t)~CANOPEN_FROM;
    switch (row->from & CANOPEN_FROM) {
    case CANOPEN_FROM_AXIS: *value = from_axis(on->axis, row); break;
    case CANOPEN_FROM_ROW: *value = what; break;
    default:
        if (what == CANOPEN_CALL_PDO) return canopen_pdo_read(on->axis, index, sub, value);
        if (what == CANOPEN_CALL_HISTORY) return history_entry(on->axis, sub, value);
        *value = call(on, (canopen_call)what, sub);
        break;
    }
    return 0;
}

/* --- writing ----------------------------------------------------------------------------------------------------- */

static int32_t as_signed(uint32_t value, uint8_t size) {
    const uint32_t sign = 1U << (8U * size - 1U);
    return (int32_t)((value ^ sign) - sign);
}

static uint32_t check_limits(const canopen_row *row, uint8_t sub, uint32_t value) {
    const bool is_signed = (row->form & 15U) <= CANOPEN_I32;
    for (size_t k = 0; k < sizeof limits / sizeof limits[0]; k++) {
        const limit *its = &limits[k];
        if (its->index != row->index || its->sub != sub) continue;
        const int32_t number = is_signed ? as_signed(value, canopen_size(row)) : 0;
        if (is_signed ? number > its->high : its->high < UINT16_MAX && value > its->high) return CANOPEN_TOO_HIGH;
        if (is_signed ? number < its->low : value < (uint32_t)its->low) return CANOPEN_TOO_LOW;
    }
    return 0;
}

/* Values between the limits that are refused all the same. */
static uint32_t checked_number(uint16_t at, uint32_t value) {
    bool is_wrong = false;
    switch (at) {
    case AT(consumer): is_wrong = value >> 16 > 127; break;
    case AT(quick_stop_option):
        is_wrong = value == 3 || value == 4;
        break; /* ramps at the limits of current, voltage */
    case AT(mode): is_wrong = !canopen_has_mode((int8_t)value); break;
    default: break;
    }
    return is_wrong ? CANOPEN_VALUE : 0;
}

static uint32_t write_axis(const canopen_node *on, const canopen_row *row, uint8_t sub, uint32_t value) {
    uint32_t abort = check_limits(row, sub, value);
    if (abort == 0) abort = checked_number(row->from, value);
    if (abort != 0) return abort;
    const uint16_t before = on->axis->controlword;
    const uint16_t two = (uint16_t)value;
    uint8_t *at = (uint8_t *)on->axis + row->from;
    switch (canopen_size(row)) {
    case 1: *at = (uint8_t)value; break;
    case 2: memcpy(at, &two, 2); break;
    default: memcpy(at, &value, 4); break;
    }
    switch (row->from) {
    case AT(consumer): on->axis->trouble &= (uint8_t)~CANOPEN_LISTENS; break; /* the next heartbeat starts the watch */
    case AT(producer_ms): on->axis->producer_us = on->now_us; break;
    case AT(controlword): canopen_control(on, before); break;
    case AT(mode): canopen_take_mode(on); break;
    case AT(max_torque): on->drive->settings.current_limit_A = on->axis->rated_A * (laconic_real)value / 1000; break;
    case AT(target_position): on->axis->set_point |= CANOPEN_TARGET_IS_NEW; break;
    default: break;
    }
    return 0;
}

/* Identifiers that the predefined connections or CiA 301 reserve for something else are refused, and 29-bit ones. */
uint32_t canopen_store_cob_id(uint16_t *stored, uint32_t value) {
    const uint32_t id = value & 0x7FFU;
    const bool reserved = id < 0x80 || (id > 0x100 && id < 0x181) || (id > 0x580 && id < 0x600) ||
                          (id > 0x600 && id < 0x680) || id > 0x6DF;
    if ((value & 0x3FFFF800U) != 0 || reserved) return CANOPEN_VALUE;
    if (((*stored | value >> 16) & CANOPEN_OFF) == 0 && ((*stored ^ value) & 0x7FFU) != 0) return CANOPEN_PRESENT_STATE;
    *stored = (uint16_t)(id | (value >> 16 & (CANOPEN_OFF | CANOPEN_NO_REMOTE)));
    return 0;
}

static uint32_t write_sync_id(canopen_axis *axis, uint32_t value) {
    uint16_t id = CANOPEN_OFF;
    const uint32_t abort = value >> 30 != 0 ? CANOPEN_VALUE : canopen_store_cob_id(&id, value); /* sends no SYNC */
    if (abort == 0) axis->sync_id = id;
    return abort;
}

static uint32_t clear_history(canopen_axis *axis, uint32_t value) {
    if (value != 0) return CANOPEN_VALUE;
    axis->history_count = 0;
    return 0;
}

uint32_t canopen_write(const canopen_node *on, const canopen_row *row, uint16_t index, uint8_t sub, uint32_t value) {
    uint32_t present = 0;
    if (canopen_is_from_axis(row)) return write_axis(on, row, sub, value);
    switch (row->from) {
    case CANOPEN_FROM_CALL | CANOPEN_CALL_PDO: return canopen_pdo_write(on, index, sub, value);
    case CANOPEN_FROM_CALL | CANOPEN_CALL_HISTORY: return clear_history(on->axis, value);
    case CANOPEN_FROM_CALL | CANOPEN_CALL_SYNC_ID: return write_sync_id(on->axis, value);
    case CANOPEN_FROM_CALL | CANOPEN_CALL_EMERGENCY_ID:
        return value & 1U << 30 ? CANOPEN_VALUE : canopen_store_cob_id(&on->axis->emergency_id, value);
    default: /* a fact: only the value that it has */
        canopen_read(on, row, index, sub, &present);
        return value == present ? 0 : CANOPEN_VALUE;
    }
}
