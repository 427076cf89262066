#include "laconic_node/loader.h"

#include "laconic_dbc.h"
#include "laconic_node/crc.h"
#include "laconic_wire.h"

#include <string.h>

typedef enum value_kind { REAL, INTEGER, WHEEL_KIND, FLAG } value_kind;

typedef struct place {
    uint8_t field;
    uint8_t kind;
    uint8_t items; /* 0: the field is no list */
    uint8_t stride;
    uint16_t offset;
} place;

#define AT(member) (uint16_t) offsetof(laconic_parameters, member)
#define SCALAR(field, member) {(uint8_t)(field), REAL, 0, 0, AT(member)}
#define PER_WHEEL(field, type, member) \
    {(uint8_t)(field), type, LACONIC_MAX_WHEELS, sizeof(laconic_wheel), AT(vehicle.wheel[0].member)}
#define PER_SUPPORT(field, member) \
    {(uint8_t)(field), REAL, LACONIC_MAX_SUPPORTS, sizeof(laconic_support), AT(vehicle.support[0].member)}

static const place places[] = {
    SCALAR(LACONIC_FIELD_MASS, vehicle.mass_kg),
    SCALAR(LACONIC_FIELD_YAW_INERTIA, vehicle.yaw_inertia_kgm2),
    SCALAR(LACONIC_FIELD_COM_X, vehicle.com_x_m),
    SCALAR(LACONIC_FIELD_COM_Y, vehicle.com_y_m),
    SCALAR(LACONIC_FIELD_COM_Z, vehicle.com_z_m),
    SCALAR(LACONIC_FIELD_WHEEL_RADIUS, vehicle.wheel_radius_m),
    SCALAR(LACONIC_FIELD_WHEEL_INERTIA, vehicle.wheel_inertia_kgm2),
    SCALAR(LACONIC_FIELD_MOTOR_GAIN, vehicle.motor_gain_Nm_per_V),
    SCALAR(LACONIC_FIELD_MOTOR_DAMPING, vehicle.motor_damping_Nms),
    SCALAR(LACONIC_FIELD_FRICTION_COEFFICIENT, vehicle.friction_coefficient),
    SCALAR(LACONIC_FIELD_PAYLOAD_MASS, vehicle.payload.mass_kg),
    SCALAR(LACONIC_FIELD_PAYLOAD_X, vehicle.payload.x_m),
    SCALAR(LACONIC_FIELD_PAYLOAD_Y, vehicle.payload.y_m),
    SCALAR(LACONIC_FIELD_PAYLOAD_YAW_INERTIA, vehicle.payload.yaw_inertia_kgm2),
    {LACONIC_FIELD_WHEEL_COUNT, INTEGER, 0, 0, AT(vehicle.wheel_count)},
    PER_WHEEL(LACONIC_FIELD_WHEEL_KIND, WHEEL_KIND, kind),
    PER_WHEEL(LACONIC_FIELD_WHEEL_X, REAL, x_m),
    PER_WHEEL(LACONIC_FIELD_WHEEL_Y, REAL, y_m),
    PER_WHEEL(LACONIC_FIELD_AXLE, REAL, axle_rad),
    PER_WHEEL(LACONIC_FIELD_ROLLER, REAL, roller_rad),
    PER_WHEEL(LACONIC_FIELD_WHEEL_LOCKED, FLAG, locked),
    {LACONIC_FIELD_SUPPORT_COUNT, INTEGER, 0, 0, AT(vehicle.support_count)},
    PER_SUPPORT(LACONIC_FIELD_SUPPORT_X, x_m),
    PER_SUPPORT(LACONIC_FIELD_SUPPORT_Y, y_m),
    {LACONIC_FIELD_START_NU, REAL, 3, sizeof(laconic_real), AT(start.nu_rad_per_s)},
    SCALAR(LACONIC_FIELD_START_X, start.x_m),
    SCALAR(LACONIC_FIELD_START_Y, start.y_m),
    SCALAR(LACONIC_FIELD_START_HEADING, start.heading_rad),
    {LACONIC_FIELD_METHOD, INTEGER, 0, 0, AT(method)},
    SCALAR(LACONIC_FIELD_STEP, step_s),
};

void laconic_loader_begin(laconic_loader *loader) {
    memset(loader, 0, sizeof *loader);
    loader->checksum = LACONIC_CRC32_START;
}

static const place *find(uint8_t field, uint8_t item) {
    for (size_t k = 0; k < sizeof places / sizeof places[0]; k++) {
        if (places[k].field != field) continue;
        const bool fits = places[k].items == 0 ? item == 0 : item >= 1 && item <= places[k].items;
        return fits ? &places[k] : NULL;
    }
    return NULL;
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

static void store_integer(laconic_loader *loader, void *to, uint8_t kind,
                          const struct laconic_dbc_parameter_t *frame) {
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
        refuse(loader, LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN, frame.field, frame.item);
        return;
    }
    uint8_t *to = (uint8_t *)&loader->parameters + where->offset;
    if (where->items > 0) to += (size_t)where->stride * (size_t)(frame.item - 1);
    if (where->kind == REAL) {
        store_real(loader, to, &frame);
    } else {
        store_integer(loader, to, where->kind, &frame);
    }
}

uint8_t laconic_loader_check(const laconic_loader *loader, uint16_t frame_count, uint32_t checksum) {
    if (loader->status != 0) return loader->status;
    if (loader->half_field != 0) return LACONIC_WIRE_STATUS_INPUT_INCOMPLETE;
    if (loader->frame_count != frame_count || (loader->checksum ^ LACONIC_CRC32_END) != checksum)
        return LACONIC_WIRE_STATUS_CHECKSUM_MISMATCH;
    return 0;
}
