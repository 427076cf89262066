/* One PARAMETER frame after the other becomes a vehicle, its start and its run. */
#include "laconic_node/loader.h"

#include "laconic_dbc.h"
#include "laconic_node/crc.h"
#include "laconic_wire.h"

#include <string.h>

typedef enum value_kind { REAL, INTEGER, WHEEL_KIND, FLAG } value_kind;

/* What must come, even if it is zero: as in a scene file, where nothing of a robot is assumed. */
typedef enum need {
    OPTIONAL,
    ALWAYS,
    WITH_WHEELS, /* where there are wheels                      */
    WITH_GROUP,  /* where another number of its group has come  */
    EACH,        /* wheel or support up to their number         */
    EACH_ROLLER  /* wheel with rollers                          */
} need;

typedef struct place {
    uint8_t field;
    uint8_t kind_and_need; /* value_kind, 16 · need */
    uint8_t items;         /* 0: the field is no list */
    uint8_t stride;
    uint16_t offset;
} place;

#define AT(member) (uint16_t)offsetof(laconic_parameters, member)
#define SCALAR(field, member, need) {(uint8_t)(field), REAL | need << 4, 0, 0, AT(member)}
#define COUNT(field, member, need) {(uint8_t)(field), INTEGER | need << 4, 0, 0, AT(member)}
#define PER_WHEEL(field, type, member, need) \
    {(uint8_t)(field), type | need << 4, LACONIC_MAX_WHEELS, sizeof(laconic_wheel), AT(vehicle.wheel[0].member)}
#define PER_SUPPORT(field, member) \
    {(uint8_t)(field), REAL | EACH << 4, LACONIC_MAX_SUPPORTS, sizeof(laconic_support), AT(vehicle.support[0].member)}

#define PLACES (sizeof places / sizeof places[0])

static const place places[] = {
    SCALAR(LACONIC_FIELD_MASS, vehicle.mass_kg, ALWAYS),
    SCALAR(LACONIC_FIELD_YAW_INERTIA, vehicle.yaw_inertia_kgm2, ALWAYS),
    SCALAR(LACONIC_FIELD_COM_X, vehicle.com_x_m, OPTIONAL),
    SCALAR(LACONIC_FIELD_COM_Y, vehicle.com_y_m, OPTIONAL),
    SCALAR(LACONIC_FIELD_COM_Z, vehicle.com_z_m, OPTIONAL),
    SCALAR(LACONIC_FIELD_WHEEL_RADIUS, vehicle.wheel_radius_m, ALWAYS),
    SCALAR(LACONIC_FIELD_WHEEL_INERTIA, vehicle.wheel_inertia_kgm2, WITH_WHEELS),
    SCALAR(LACONIC_FIELD_MOTOR_GAIN, vehicle.motor_gain_Nm_per_V, WITH_GROUP),
    SCALAR(LACONIC_FIELD_MOTOR_DAMPING, vehicle.motor_damping_Nms, WITH_GROUP),
    SCALAR(LACONIC_FIELD_FRICTION_COEFFICIENT, vehicle.friction_coefficient, OPTIONAL),
    SCALAR(LACONIC_FIELD_PAYLOAD_MASS, vehicle.payload.mass_kg, WITH_GROUP),
    SCALAR(LACONIC_FIELD_PAYLOAD_X, vehicle.payload.x_m, WITH_GROUP),
    SCALAR(LACONIC_FIELD_PAYLOAD_Y, vehicle.payload.y_m, WITH_GROUP),
    SCALAR(LACONIC_FIELD_PAYLOAD_YAW_INERTIA, vehicle.payload.yaw_inertia_kgm2, WITH_GROUP),
    COUNT(LACONIC_FIELD_WHEEL_COUNT, vehicle.wheel_count, ALWAYS),
    PER_WHEEL(LACONIC_FIELD_WHEEL_KIND, WHEEL_KIND, kind, EACH),
    PER_WHEEL(LACONIC_FIELD_WHEEL_X, REAL, x_m, EACH),
    PER_WHEEL(LACONIC_FIELD_WHEEL_Y, REAL, y_m, EACH),
    PER_WHEEL(LACONIC_FIELD_AXLE, REAL, axle_rad, EACH),
    PER_WHEEL(LACONIC_FIELD_ROLLER, REAL, roller_rad, EACH_ROLLER),
    PER_WHEEL(LACONIC_FIELD_WHEEL_LOCKED, FLAG, locked, OPTIONAL),
    COUNT(LACONIC_FIELD_SUPPORT_COUNT, vehicle.support_count, WITH_GROUP),
    PER_SUPPORT(LACONIC_FIELD_SUPPORT_X, x_m),
    PER_SUPPORT(LACONIC_FIELD_SUPPORT_Y, y_m),
    {LACONIC_FIELD_START_NU, REAL | OPTIONAL << 4, 3, sizeof(laconic_real), AT(start.nu_rad_per_s)},
    SCALAR(LACONIC_FIELD_START_X, start.x_m, OPTIONAL),
    SCALAR(LACONIC_FIELD_START_Y, start.y_m, OPTIONAL),
    SCALAR(LACONIC_FIELD_START_HEADING, start.heading_rad, OPTIONAL),
    COUNT(LACONIC_FIELD_METHOD, method, OPTIONAL),
    SCALAR(LACONIC_FIELD_STEP, step_s, ALWAYS),
};

void laconic_loader_begin(laconic_loader *loader) {
    memset(loader, 0, sizeof *loader);
    loader->checksum = LACONIC_CRC32_START;
}

static const place *find(uint8_t field, uint8_t item) {
    for (size_t k = 0; k < PLACES; k++) {
        if (places[k].field != field) continue;
        const bool fits = places[k].items == 0 ? item == 0 : item >= 1 && item <= places[k].items;
        return fits ? &places[k] : NULL;
    }
    return NULL;
}

/* Numbers for which the contract has a field and the core has no use yet. */
static bool is_reserved(uint8_t field) {
    return field >= LACONIC_WIRE_FIELD_RESISTANCE && field <= LACONIC_WIRE_FIELD_START_WHEEL_SPEED;
}

static void refuse(laconic_loader *loader, uint8_t status, uint8_t field, uint8_t item) {
    if (loader->status != 0) return;
    loader->status = status;
    loader->field = field;
    loader->item = item;
}

/* Value bits arrive in 32-bit pieces; a double is complete with its upper half. False: more to come, or refused. */
static bool assemble(laconic_loader *loader, const struct laconic_dbc_parameter_t *frame, laconic_real *value) {
    if (sizeof(laconic_real) == sizeof(uint32_t)) {
        if (frame->upper_half) refuse(loader, LACONIC_WIRE_STATUS_OUT_OF_RANGE, frame->field, frame->item);
        memcpy(value, &frame->value, sizeof(uint32_t));
        return !frame->upper_half;
    }
    if (!frame->upper_half) {
        if (loader->half_field != 0) /* the half before this one never got its upper part */
            refuse(loader, LACONIC_WIRE_STATUS_INPUT_INCOMPLETE, loader->half_field, loader->half_item);
        loader->half = frame->value;
        loader->half_field = frame->field;
        loader->half_item = frame->item;
        return false;
    }
    if (loader->half_field != frame->field || loader->half_item != frame->item) {
        refuse(loader, LACONIC_WIRE_STATUS_INPUT_INCOMPLETE, frame->field, frame->item);
        return false;
    }
    const uint64_t bits = ((uint64_t)frame->value << 32) | loader->half;
    memcpy(value, &bits, sizeof *value);
    loader->half_field = 0;
    return true;
}

static void store_real(laconic_loader *loader, void *to, const struct laconic_dbc_parameter_t *frame) {
    laconic_real value;
    if (assemble(loader, frame, &value)) memcpy(to, &value, sizeof value);
}

static void store_integer(laconic_loader *loader, void *to, uint8_t kind, const struct laconic_dbc_parameter_t *frame) {
    const int32_t number = (int32_t)frame->value;
    const bool flag = frame->value != 0;
    const uint32_t largest = kind == FLAG ? 1U : kind == WHEEL_KIND ? 127U : UINT32_MAX;
    if (frame->upper_half || frame->value > largest) {
        refuse(loader, LACONIC_WIRE_STATUS_OUT_OF_RANGE, frame->field, frame->item);
    } else if (kind == INTEGER) {
        memcpy(to, &number, sizeof number);
    } else if (kind == WHEEL_KIND) {
        *(laconic_wheel_kind *)to = (laconic_wheel_kind)frame->value;
    } else {
        memcpy(to, &flag, sizeof flag);
    }
}

void laconic_loader_take(laconic_loader *loader, const uint8_t data[8]) {
    struct laconic_dbc_parameter_t frame;
    const uint8_t head = data[1] & 0xF0U;
    loader->checksum = laconic_crc32(loader->checksum, &head, 1);
    loader->checksum = laconic_crc32(loader->checksum, data + 2, 6);
    loader->frame_count++;
    laconic_dbc_parameter_unpack(&frame, data, 8);
    const place *where = find(frame.field, frame.item);
    if (where == NULL) {
        refuse(loader,
               is_reserved(frame.field) ? LACONIC_WIRE_STATUS_NOT_SUPPORTED : LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN,
               frame.field, frame.item);
        return;
    }
    loader->given[frame.field] |= (uint32_t)1 << frame.item;
    uint8_t *to = (uint8_t *)&loader->parameters + where->offset;
    if (where->items > 0) to += (size_t)where->stride * (size_t)(frame.item - 1);
    const uint8_t kind = where->kind_and_need & 15U;
    if (kind == REAL) {
        store_real(loader, to, &frame);
    } else {
        store_integer(loader, to, kind, &frame);
    }
}

static bool any_of(const laconic_loader *loader, uint8_t first, uint8_t last) {
    uint32_t given = 0;
    for (; first <= last; first++) given |= loader->given[first];
    return given != 0;
}

static bool group_has_begun(const laconic_loader *loader, uint8_t field) {
    if (field == LACONIC_FIELD_SUPPORT_COUNT) return any_of(loader, LACONIC_FIELD_SUPPORT_X, LACONIC_FIELD_SUPPORT_Y);
    return field <= LACONIC_FIELD_MOTOR_DAMPING
               ? any_of(loader, LACONIC_FIELD_MOTOR_GAIN, LACONIC_FIELD_MOTOR_DAMPING)
               : any_of(loader, LACONIC_FIELD_PAYLOAD_MASS, LACONIC_FIELD_PAYLOAD_YAW_INERTIA);
}

/* Whether this item of the field must have come. Beyond the largest number of wheels or supports the count itself is
 * wrong, which the core says. */
static bool is_needed(const laconic_loader *loader, const place *where, int32_t item) {
    const laconic_vehicle *vehicle = &loader->parameters.vehicle;
    switch (where->kind_and_need >> 4) {
    case ALWAYS: return true;
    case WITH_WHEELS: return vehicle->wheel_count > 0;
    case WITH_GROUP: return group_has_begun(loader, where->field);
    case EACH: return item <= (where->field < LACONIC_FIELD_SUPPORT_X ? vehicle->wheel_count : vehicle->support_count);
    case EACH_ROLLER: return item <= vehicle->wheel_count && vehicle->wheel[item - 1].kind == LACONIC_WHEEL_ROLLER;
    default: return false;
    }
}

static bool something_is_missing(const laconic_loader *loader, uint8_t *field, uint8_t *item) {
    for (size_t k = 0; k < PLACES; k++) {
        const place *where = &places[k];
        *field = where->field;
        for (*item = where->items > 0; *item <= where->items; ++*item) {
            const bool given = (loader->given[where->field] >> *item & 1U) != 0;
            if (!given && is_needed(loader, where, *item)) return true;
        }
    }
    *field = 0;
    *item = 0;
    return false;
}

uint8_t laconic_loader_check(const laconic_loader *loader, uint16_t frame_count, uint32_t checksum, uint8_t *field,
                             uint8_t *item) {
    *field = loader->field;
    *item = loader->item;
    if (loader->status != 0) return loader->status;
    if (loader->half_field != 0) {
        *field = loader->half_field;
        *item = loader->half_item;
        return LACONIC_WIRE_STATUS_INPUT_INCOMPLETE;
    }
    if (loader->frame_count != frame_count || (loader->checksum ^ LACONIC_CRC32_END) != checksum)
        return LACONIC_WIRE_STATUS_CHECKSUM_MISMATCH;
    return something_is_missing(loader, field, item) ? LACONIC_WIRE_STATUS_PARAMETER_MISSING : 0;
}
