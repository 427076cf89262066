/* Receives a vehicle, its start and its run number by number, apart from the vehicle that the node simulates. */
#ifndef LACONIC_NODE_LOADER_H
#define LACONIC_NODE_LOADER_H

#include "laconic/laconic.h"
#include "laconic_drives/settings.h"
#include "laconic_wire.h" /* LACONIC_NODE_WITH_SENSORS, LACONIC_NODE_WITH_HINGES */
#if LACONIC_NODE_WITH_HINGES
#include "laconic/articulated.h"
#if LACONIC_NODE_WITH_SLIP
#include "laconic/articulated_friction.h"
#endif

/* What a vehicle with hinges has besides its carriage and wheels: its bodies, start, and commands at the start. */
typedef struct laconic_node_bodies {
    int32_t body_count; /* 0: a vehicle without hinges */
    int32_t wheel_body[LACONIC_MAX_WHEELS];
    laconic_body body[LACONIC_MAX_BODIES];
    laconic_articulated_start start; /* its place and heading are those of every vehicle */
    laconic_real hinge_rate_rad_per_s[LACONIC_MAX_BODIES], twist[3];
#if LACONIC_NODE_WITH_SLIP
    laconic_tree_hinge tree_hinge[LACONIC_MAX_BODIES]; /* read on ground with friction */
    laconic_tree_wheel tree_wheel[LACONIC_MAX_WHEELS];
#endif
} laconic_node_bodies;
#endif

typedef struct laconic_parameters {
    laconic_vehicle vehicle;
    laconic_start start;
    laconic_real step_s;
    int32_t method;
#if LACONIC_NODE_WITH_DRIVES
    laconic_drive_plan drives;
#endif
#if LACONIC_NODE_WITH_SENSORS
    laconic_sensor_settings sensors;
#endif
#if LACONIC_NODE_WITH_HINGES
    laconic_node_bodies bodies;
#endif
} laconic_parameters;

/* The rows of drives, in a node that has them. */
#if LACONIC_NODE_WITH_DRIVES
#define LACONIC_LOADER_DRIVES(X) LACONIC_DRIVES_GROUP_ROWS(X, DRIVES) LACONIC_DRIVES_WHEEL_ROWS(X, DRIVES_WHEEL)
#else
#define LACONIC_LOADER_DRIVES(X)
#endif

/* The rows of sensors, in a node that has them. */
#if LACONIC_NODE_WITH_SENSORS
#define LACONIC_LOADER_SENSORS(X) LACONIC_SENSOR_FIELDS(X)
#else
#define LACONIC_LOADER_SENSORS(X)
#endif

/* The rows of bodies and hinges, in a node that has them. */
/* clang-format off */
#if LACONIC_NODE_WITH_SLIP
#define LACONIC_LOADER_SLIP(X) LACONIC_TREE_HINGE_FIELDS(X, TREE_HINGE) LACONIC_TREE_WHEEL_FIELDS(X, TREE_WHEEL)
#else
#define LACONIC_LOADER_SLIP(X)
#endif
#if LACONIC_NODE_WITH_HINGES
#define LACONIC_LOADER_HINGES(X) \
    LACONIC_BODY_FIELDS(X, BODY) LACONIC_WHEEL_BODY_FIELD(X, WHEEL_BODY) LACONIC_BODY_COUNT_FIELD(X, BODY_COUNT) \
    X(HINGE_COMMAND, 113, HINGE_RATE, hinge_rate_rad_per_s, steering_rate_rad_per_s, REAL, FINITE, NEVER) \
    X(HINGE_COMMAND, 115, TWIST, twist, steering_twist, REAL, FINITE, NEVER) \
    LACONIC_HINGE_START_FIELDS(X, HINGE_START) LACONIC_LOADER_SLIP(X)
#else
#define LACONIC_LOADER_HINGES(X)
#endif
/* clang-format on */

/* Number of fields that the loader receives. */
#define LACONIC_LOADER_ONE(of, number, ...) LACONIC_ROW_OF(number)(+1)
#define LACONIC_LOADER_EVERY(X) \
    LACONIC_PARAMETER_FIELDS(X) LACONIC_LOADER_DRIVES(X) LACONIC_LOADER_SENSORS(X) LACONIC_LOADER_HINGES(X)
#define LACONIC_LOADER_FIELDS (0 LACONIC_LOADER_EVERY(LACONIC_LOADER_ONE))

/* Bit = item from 1; bit 0 where the field has none. */
#if LACONIC_MAX_WHEELS < 8 && LACONIC_MAX_SUPPORTS < 8 && !LACONIC_NODE_WITH_HINGES
typedef uint8_t laconic_loader_items;
#else
typedef uint32_t laconic_loader_items;
#endif

typedef struct laconic_loader {
    uint8_t status;                /* LACONIC_WIRE_STATUS_… of the first refused frame; 0: none      */
    uint8_t field, item;           /* … and the field and item that it refuses                       */
    uint8_t half_field, half_item; /* of the double whose upper half is still to come; 0: none */
    uint16_t frame_count;
    uint32_t checksum; /* CRC-32 so far                                                  */
    uint32_t half;
    laconic_parameters parameters;
    laconic_loader_items given[LACONIC_LOADER_FIELDS];
} laconic_loader;

void laconic_loader_begin(laconic_loader *loader);

/* Takes one PARAMETER frame (8 bytes, protection already checked). */
void laconic_loader_take(laconic_loader *loader, const uint8_t data[8]);

/* 0 iff no frame was refused, none is missing, the checksum is right, and every number that a scene file must give has
 * come; else LACONIC_WIRE_STATUS_…, with the field and the item. The core checks the values when it prepares them. */
uint8_t laconic_loader_check(const laconic_loader *loader, uint16_t frame_count, uint32_t checksum, uint8_t *field,
                             uint8_t *item);

#if LACONIC_NODE_WITH_XCP
/* Where a number of the vehicle is in its struct. */
typedef struct laconic_loader_place {
    uint16_t offset;
    uint8_t stride; /* from item to item; 0: the field is a single number */
    uint8_t kind;   /* laconic_field_kind */
} laconic_loader_place;

/* False iff the vehicle has no such field or the field has no such item. `k` counts items from 0. */
bool laconic_loader_find(laconic_loader_place *place, uint8_t field, uint8_t k);
#endif

#endif
