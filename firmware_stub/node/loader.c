/* Stores the numbers of PARAMETER frames as a vehicle, its start and its run. */
#include "laconic_node/loader.h"

#include "laconic_dbc.h"
#include "laconic_node/crc.h"
#include "laconic_wire.h"

#include <string.h>

typedef struct location {
    uint8_t field;
    uint8_t kind_and_need; /* laconic_field_kind, 16 · laconic_field_need */
    uint8_t items;         /* 0: the field is a single number */
    uint8_t stride;
    uint16_t offset;
} location;

#define AT(member) (uint16_t)offsetof(laconic_parameters, member)
#define IN_VEHICLE(member) 0, 0, AT(vehicle.member)
#define IN_PAYLOAD(member) 0, 0, AT(vehicle.payload.member)
#define IN_COUNT(member) 0, 0, AT(vehicle.member##_count)
#define IN_WHEEL(member) LACONIC_MAX_WHEELS, sizeof(laconic_wheel), AT(vehicle.wheel[0].member)
#define IN_OWN(member) IN_WHEEL(own_##member)
#define IN_GROUND(member) 0, 0, AT(vehicle.ground.member)
#define IN_DRIVE(member) 0, 0, AT(vehicle.drive.member)
#define IN_SUPPORT(member) LACONIC_MAX_SUPPORTS, sizeof(laconic_support), AT(vehicle.support[0].member)
#define IN_START_ARRAY(member) \
    sizeof(((laconic_start *)NULL)->member) / sizeof(laconic_real), sizeof(laconic_real), AT(start.member)
#define IN_START(member) 0, 0, AT(start.member)
#define IN_RUN(member) 0, 0, AT(member)
#define IN_DRIVES(member) 0, 0, AT(drives.member)
#define IN_DRIVES_WHEEL(member) LACONIC_DRIVE_AXES, sizeof(laconic_drive_settings), AT(drives.drive[0].member)
#define IN_IMU(member) 0, 0, AT(sensors.imu.member)
#define IN_IMU_ARRAY(member) 2, sizeof(laconic_real), AT(sensors.imu.member)
#define IN_ENCODER(member) 0, 0, AT(sensors.encoder_##member)
#define IN_WHEEL_ENCODER(member) LACONIC_MAX_WHEELS, sizeof(laconic_encoder_settings), AT(sensors.encoder[0].member)
#if LACONIC_NODE_WITH_HINGES
#define IN_BODY(member) LACONIC_MAX_BODIES, sizeof(laconic_body), AT(bodies.body[0].member)
#define IN_WHEEL_BODY(member) LACONIC_MAX_WHEELS, sizeof(int32_t), AT(bodies.wheel_##member[0])
#define IN_BODY_COUNT(member) 0, 0, AT(bodies.member##_count)
#define IN_TREE_HINGE(member) LACONIC_MAX_BODIES, sizeof(laconic_tree_hinge), AT(bodies.tree_hinge[0].member)
#define IN_TREE_WHEEL(member) LACONIC_MAX_WHEELS, sizeof(laconic_tree_wheel), AT(bodies.tree_wheel[0].member)
#define ITEMS_OF(member) sizeof(((laconic_node_bodies *)NULL)->member) / sizeof(laconic_real)
#define IN_HINGE_COMMAND(member) ITEMS_OF(member), sizeof(laconic_real), AT(bodies.member)
#define IN_HINGE_START(member) \
    (ITEMS_OF(start.member) > 1 ? ITEMS_OF(start.member) : 0), sizeof(laconic_real), AT(bodies.start.member)
#endif
#define LOCATION(of, number, IDENTIFIER, member, name, KIND, RULE, NEED) \
    LACONIC_ROW_OF(number)({number, LACONIC_KIND_##KIND | LACONIC_NEED_##NEED << 4, IN_##of(member)}, )

static const location locations[LACONIC_LOADER_FIELDS] = {LACONIC_LOADER_EVERY(LOCATION)};

void laconic_loader_begin(laconic_loader *loader) {
    memset(loader, 0, sizeof *loader);
    loader->checksum = LACONIC_CRC32_START;
#if LACONIC_NODE_WITH_DRIVES
    laconic_drive_plan_begin(&loader->parameters.drives);
#endif
}

static const location *find(uint8_t field, uint8_t item) {
    for (size_t k = 0; k < LACONIC_LOADER_FIELDS; k++) {
        if (locations[k].field != field) continue;
        const bool is_within = locations[k].items == 0 ? item == 0 : item >= 1 && item <= locations[k].items;
        return is_within ? &locations[k] : NULL;
    }
    return NULL;
}

#if LACONIC_NODE_WITH_XCP
bool laconic_loader_find(laconic_loader_place *place, uint8_t field, uint8_t k) {
    const location *where = find(field, k);
    if (where == NULL || where->items > 0) where = find(field, (uint8_t)(k + 1U));
    if (where == NULL || where->offset >= sizeof(laconic_vehicle)) return false;
    place->stride = where->items > 0 ? where->stride : 0U;
    place->offset = (uint16_t)(where->offset + place->stride * k);
    place->kind = where->kind_and_need & 15U;
    return true;
}
#endif

/* In a node with hinges, of ground with friction under them. */
static bool is_of_slip(uint8_t field) {
    const bool numbered = field >= LACONIC_WIRE_FIELD_BODY_COM_Z && field <= LACONIC_WIRE_FIELD_CREEP;
    return !LACONIC_NODE_WITH_SLIP && numbered && field != LACONIC_WIRE_FIELD_HINGE_ANGLE; /* an input */
}

/* Fields of laconic.dbc that are not in the table: of a motor, which the rig fits, and what this build leaves out. */
static bool is_left_out(uint8_t field) {
    const bool of_slope = field == LACONIC_FIELD_SLOPE || field == LACONIC_FIELD_SLOPE_HEADING;
    const bool of_motor = field >= LACONIC_WIRE_FIELD_RESISTANCE && field <= LACONIC_WIRE_FIELD_ROTOR_INERTIA;
    const bool of_wheel = field >= LACONIC_FIELD_OWN_RADIUS && field <= LACONIC_FIELD_DRIVEN;
    const bool of_drives = field >= LACONIC_DRIVES_FIELD_DRIVE_PROTOCOL && field <= LACONIC_DRIVES_FIELD_LAST;
    const bool of_sensors = field >= LACONIC_SENSOR_FIELD_IMU_X && field < LACONIC_SENSOR_FIELD_COUNT;
    const bool of_friction = field >= LACONIC_FIELD_WHEEL_FRICTION_COEFFICIENT && field <= LACONIC_FIELD_MOTOR_CIRCUIT;
    return of_motor || (!LACONIC_WITH_OWN_WHEELS && of_wheel) || (!LACONIC_WITH_SLOPE && of_slope) ||
           (!LACONIC_WITH_FRICTION && of_friction && !of_slope) || (!LACONIC_NODE_WITH_DRIVES && of_drives) ||
           (!LACONIC_NODE_WITH_SENSORS && of_sensors) || (LACONIC_NODE_WITH_HINGES && is_of_slip(field));
}

static void refuse(laconic_loader *loader, uint8_t status, uint8_t field, uint8_t item) {
    if (loader->status != 0) return;
    loader->status = status;
    loader->field = field;
    loader->item = item;
}

/* Joins the 32-bit halves of a number. False: the upper half of a double is still to come, or the frame is refused. */
static bool assemble(laconic_loader *loader, const struct laconic_dbc_parameter_t *frame, laconic_real *value) {
    if (sizeof(laconic_real) == sizeof(uint32_t)) { /* single: a number has no second half */
        if (frame->upper_half) refuse(loader, LACONIC_WIRE_STATUS_OUT_OF_RANGE, frame->field, frame->item);
        memcpy(value, &frame->value, sizeof(uint32_t));
        return !frame->upper_half;
    }
    if (!frame->upper_half) {
        if (loader->half_field != 0) /* the upper half of the double before did not come */
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

/* An enumeration may be as short as one signed byte. */
#define LARGEST_OF_ENUMERATION 127U
#if LACONIC_NODE_WITH_HINGES
#define IS_HINGE_KIND(field) ((field) == LACONIC_FIELD_OF_BODY_HINGE)
#else
#define IS_HINGE_KIND(field) false
#endif

static void store_integer(laconic_loader *loader, void *to, uint8_t kind, const struct laconic_dbc_parameter_t *frame) {
    const int32_t number = (int32_t)frame->value;
    const bool flag = (frame->value != 0) != (kind == LACONIC_KIND_ABSENCE);
    const bool enumeration = kind == LACONIC_KIND_WHEEL_KIND || IS_HINGE_KIND(frame->field);
    const uint32_t largest = enumeration ? LARGEST_OF_ENUMERATION : kind == LACONIC_KIND_INTEGER ? UINT32_MAX : 1U;
    if (frame->upper_half || frame->value > largest) {
        refuse(loader, LACONIC_WIRE_STATUS_OUT_OF_RANGE, frame->field, frame->item);
#if LACONIC_NODE_WITH_HINGES
    } else if (IS_HINGE_KIND(frame->field)) {
        *(laconic_hinge_kind *)to = (laconic_hinge_kind)frame->value;
#endif
    } else if (kind == LACONIC_KIND_INTEGER) {
        memcpy(to, &number, sizeof number);
    } else if (kind == LACONIC_KIND_WHEEL_KIND) {
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
    const location *where = find(frame.field, frame.item);
    if (where == NULL) {
        refuse(loader,
               is_left_out(frame.field) ? LACONIC_WIRE_STATUS_NOT_SUPPORTED : LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN,
               frame.field, frame.item);
        return;
    }
    laconic_loader_items *items = &loader->given[where - locations];
    *items = (laconic_loader_items)(*items | (uint32_t)1 << frame.item);
    uint8_t *to = (uint8_t *)&loader->parameters + where->offset;
    if (where->items > 0) to += (size_t)where->stride * (size_t)(frame.item - 1);
    const uint8_t kind = where->kind_and_need & 15U;
    if (kind == LACONIC_KIND_REAL) {
        store_real(loader, to, &frame);
    } else {
        store_integer(loader, to, kind, &frame);
    }
}

static laconic_field_need need_of(const location *where) { return (laconic_field_need)(where->kind_and_need >> 4); }

/* Whether any field with that need has come. */
static bool any_given(const laconic_loader *loader, laconic_field_need need) {
    uint32_t items = 0;
    for (size_t k = 0; k < LACONIC_LOADER_FIELDS; k++)
        if (need_of(&locations[k]) == need) items |= loader->given[k];
    return items != 0;
}

/* Whether this item of a field with that need must have come. The core refuses counts beyond the largest number of
 * wheels or supports. */
static bool is_needed(const laconic_loader *loader, laconic_field_need need, int32_t item) {
    const laconic_vehicle *vehicle = &loader->parameters.vehicle;
    switch (need) {
    case LACONIC_NEED_ALWAYS: return true;
    case LACONIC_NEED_WITH_WHEELS: return vehicle->wheel_count > 0;
    case LACONIC_NEED_WITH_MOTOR:
    case LACONIC_NEED_WITH_PAYLOAD: return any_given(loader, need);
    case LACONIC_NEED_WITH_SUPPORTS: return any_given(loader, LACONIC_NEED_EACH_SUPPORT);
    case LACONIC_NEED_EACH_WHEEL: return item <= vehicle->wheel_count;
    case LACONIC_NEED_EACH_ROLLER:
        return item <= vehicle->wheel_count && vehicle->wheel[item - 1].kind == LACONIC_WHEEL_ROLLER;
    case LACONIC_NEED_EACH_SUPPORT: return item <= vehicle->support_count;
    default: return false;
    }
}

/* False for bodies beyond the last. */
static bool is_of_one(const laconic_loader *loader, uint8_t field, uint8_t item) {
#if LACONIC_NODE_WITH_HINGES
    const bool of_body = field >= LACONIC_FIELD_OF_BODY_PARENT && field <= LACONIC_FIELD_OF_HINGE_GAIN;
    return !of_body || item <= loader->parameters.bodies.body_count;
#else
    (void)loader;
    (void)field;
    (void)item;
    return true;
#endif
}

static bool something_is_missing(const laconic_loader *loader, uint8_t *field, uint8_t *item) {
    for (size_t k = 0; k < LACONIC_LOADER_FIELDS; k++) {
        *field = locations[k].field;
        for (*item = locations[k].items > 0; *item <= locations[k].items; ++*item) {
            const bool is_there = (loader->given[k] >> *item & 1U) != 0;
            if (!is_there && is_needed(loader, need_of(&locations[k]), *item) && is_of_one(loader, *field, *item))
                return true;
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
