/* What a protocol of drives is to a node: constant functions and the memory of its axes. */
#ifndef LACONIC_DRIVES_PROTOCOL_H
#define LACONIC_DRIVES_PROTOCOL_H

#include "laconic_drives/drive.h"
#include "laconic_node/frame.h"
#include "laconic_wire.h" /* LACONIC_NODE_WITH_HINGES */

/* What a drive can turn: a wheel, or in a node with hinges a steering axis. Those of a vehicle count from its first
 * wheel; hinge b follows its last wheel as number wheel_count + b. */
#define LACONIC_DRIVE_AXES (LACONIC_MAX_WHEELS + LACONIC_NODE_WITH_HINGES * LACONIC_MAX_BODIES)

/* The drives of one vehicle on one bus, in the order of their axes. A wheel without motor has none, so drive k turns
 * wheel[k]. */
typedef struct laconic_drives {
    const struct laconic_drive_protocol *protocol; /* NULL: none */
    void *axes;                                    /* memory of the protocol: protocol->axis_bytes for each drive */
    int32_t count;
    laconic_real step_s;
    laconic_real watchdog_s; /* of silence of the controller that the drives bear; 0: what the protocol says */
    uint32_t now_us;         /* of the protocol's last call */
    uint8_t wheel[LACONIC_DRIVE_AXES]; /* or steering axis */
    laconic_wheel_drive drive[LACONIC_DRIVE_AXES];
} laconic_drives;

/* A protocol translates frames into targets and measured values into frames; it has neither clock nor bus. Time is a
 * count of microseconds that may wrap and never runs backwards; a late period comes late, so on_step may come twice at
 * the same time. Functions touch only `drives` and its axes. */
typedef struct laconic_drive_protocol {
    const char *name;
    uint16_t axis_bytes;       /* of one drive's state of the protocol; at most LACONIC_NODE_AXIS_BYTES */
    int16_t first_id, last_id; /* what settings.node_id may be; two drives have two ids                    */
    /* As after power-up. The axes are all zero. */
    void (*start)(laconic_drives *drives, uint32_t now_us);
    /* Takes a frame from the bus; frames for others are passed over. */
    void (*on_frame)(laconic_drives *drives, const laconic_frame *frame, uint32_t now_us);
    /* Once before each step of the core: ramps, watchdogs, and which cyclic frames are due. */
    void (*on_step)(laconic_drives *drives, uint32_t now_us);
    /* The next frame to send, made from the newest values; false iff there is none. */
    bool (*next_frame)(laconic_drives *drives, laconic_frame *frame);
} laconic_drive_protocol;

/* By number, as parameter DRIVE_PROTOCOL has them: 1 canopen, 2 odrive, 3 robomaster (C620), 4 moteus,
 * 5 robomaster-c610. */
extern const laconic_drive_protocol laconic_canopen, laconic_odrive, laconic_robomaster, laconic_moteus,
    laconic_robomaster_c610;

/* All protocols of this build, for adapters that choose by number; NULL if there is none. Links every protocol. */
const laconic_drive_protocol *laconic_drive_protocol_by_number(int32_t number);

#endif
