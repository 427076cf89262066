/* The rows of the dictionary with their names, limits and values after power-up, for the EDS. Firmware does not call
 * this, so that its linker drops the names. */
#include "describe.h"

#include "canopen.h"
#include "objects.h"

#include <string.h>

typedef struct entry {
    uint16_t index;
    uint8_t sub, last, form;
    const char *name;
} entry;

#define OF_GROUP(index, kind, name) {index, 0, 0, kind, name},
#define OF_FIELD(index, sub, last, type, access, member, initial, name) {index, sub, last, (type) | (access), name},
#define OF_VALUE(index, sub, last, type, access, value, name) {index, sub, last, (type) | (access), name},
#define OF_CALL(index, sub, last, type, access, what, name) {index, sub, last, (type) | (access), name},
#define NOTHING(...)

static const entry entries[] = {CANOPEN_OBJECTS(NOTHING, OF_FIELD, OF_VALUE, OF_CALL)};
static const entry groups[] = {CANOPEN_OBJECTS(OF_GROUP, NOTHING, NOTHING, NOTHING)};

typedef struct limit {
    uint16_t index;
    uint8_t sub;
    int64_t low, high;
} limit;
#define ONE_LIMIT(index, sub, low, high) {index, sub, low, high},
static const limit limits[] = {CANOPEN_LIMITS(ONE_LIMIT)};

/* A fresh node, as after power-up: what it answers is the default. */
static bool value_after_power_up(laconic_canopen_object *object, const laconic_canopen_drive *of) {
    const laconic_drive_settings settings = {
        .node_id = of->node_id,
        .encoder_counts = of->encoder_counts,
        .torque_constant_Nm_per_A = (laconic_real)of->torque_constant_Nm_per_A,
        .current_limit_A = (laconic_real)of->current_limit_A,
        .supply_V = (laconic_real)of->supply_V,
    };
    canopen_axis axis;
    laconic_drives drives;
    uint32_t value = 0, abort;
    memset(&axis, 0, sizeof axis);
    memset(&drives, 0, sizeof drives);
    drives.axes = &axis;
    drives.count = 1;
    laconic_drive_start(&drives.drive[0], &settings);
    laconic_canopen.start(&drives, 0);
    const canopen_node on = {&axis, &drives.drive[0], 1, 0, 0};
    const canopen_row *row = canopen_row_at(canopen_find(object->index, object->sub, &abort));
    if (canopen_size(row) == 0) return false;
    if (canopen_read(&on, row, object->index, object->sub, &value) != 0) return false;
    const uint8_t size = canopen_size(row);
    const uint32_t sign = 1U << (8U * size - 1U), mask = size == 4 ? UINT32_MAX : (sign << 1) - 1U;
    value &= mask;
    object->value = object->type <= CANOPEN_I32 ? (int64_t)(int32_t)((value ^ sign) - sign) : (int64_t)value;
    return true;
}

static void add_limits(laconic_canopen_object *object) {
    for (size_t k = 0; k < sizeof limits / sizeof limits[0]; k++) {
        if (limits[k].index != object->index || limits[k].sub != object->sub) continue;
        object->has_limits = true;
        object->low = limits[k].low;
        object->high = limits[k].high;
    }
}

static void add_group(laconic_canopen_object *object, uint16_t row_index) {
    for (size_t k = 0; k < sizeof groups / sizeof groups[0]; k++) {
        if (groups[k].index != row_index) continue;
        object->group = groups[k].form;
        object->group_name = groups[k].name;
    }
}

/* The object that row `of` stands for as number `n` of all its indices and sub-indices; false iff there is none. */
static bool expand(const entry *of, uint32_t n, laconic_canopen_object *object) {
    const uint32_t subs = (uint32_t)of->last - of->sub + 1U;
    const uint32_t indices = of->index >= 0x1400 && of->index < 0x1C00 ? CANOPEN_PDOS : 1U;
    if (n >= subs * indices) return false;
    object->index = (uint16_t)(of->index + n / subs);
    object->sub = (uint8_t)(of->sub + n % subs);
    return true;
}

bool laconic_canopen_describe(uint32_t number, const laconic_canopen_drive *of_drive, laconic_canopen_object *object) {
    for (size_t k = 0; k < sizeof entries / sizeof entries[0]; k++) {
        const entry *of = &entries[k];
        uint32_t n = 0;
        memset(object, 0, sizeof *object);
        while (n < number && expand(of, n, object)) n++;
        if (!expand(of, n, object)) {
            number -= n;
            continue;
        }
        object->type = of->form & 15U;
        object->access = of->form & 0xF0U;
        object->name = of->name;
        object->is_one_of_many = of->last > of->sub;
        add_group(object, of->index);
        add_limits(object);
        object->has_value = value_after_power_up(object, of_drive);
        return true;
    }
    return false;
}
