/* The protocol as the node sees it. */
#include "moteus.h"

#include <string.h>

static void start(laconic_drives *drives, uint32_t now_us) {
    for (int32_t i = 0; i < drives->count; i++) {
        moteus_axis *axis = moteus_axis_of(drives, i);
        memset(axis, 0, sizeof *axis);
        axis->node_id = (uint8_t)drives->drive[i].settings.node_id;
        axis->given = axis->acting = moteus_blank();
        axis->home_state = 1; /* referenced to the rotor */
        axis->last_us = now_us;
        axis->zero = moteus_seen(&drives->drive[i]);
    }
}

/* Identifier: prefix (0 here) << 16 | source << 8 | destination. Bit 15 asks for a reply; whether the identifier has 11
 * or 29 bits does not matter. */
static void on_frame(laconic_drives *drives, const laconic_frame *frame, uint32_t now_us) {
    (void)now_us;
    const uint32_t destination = frame->id & 0xFFU;
    if (frame->remote || frame->id >> 16 != 0) return;
    for (int32_t i = 0; i < drives->count; i++) {
        const uint8_t node_id = moteus_axis_of(drives, i)->node_id;
        if (laconic_drive_is_off_bus(&drives->drive[i])) continue;
        if (destination == node_id || destination == MOTEUS_EVERY_ID) moteus_take(drives, i, frame);
    }
}

static void count_milliseconds(moteus_axis *axis, uint32_t now_us) {
    axis->elapsed_us += now_us - axis->last_us;
    axis->last_us = now_us;
    axis->milliseconds += axis->elapsed_us / 1000;
    axis->elapsed_us %= 1000;
}

static void on_step(laconic_drives *drives, uint32_t now_us) {
    for (int32_t i = 0; i < drives->count; i++) {
        moteus_axis *axis = moteus_axis_of(drives, i);
        count_milliseconds(axis, now_us);
        moteus_control(axis, &drives->drive[i], drives->step_s);
        if (laconic_drive_is_off_bus(&drives->drive[i])) axis->waits = false;
    }
}

/* On a bus the lowest identifier goes first: that of the lowest node id. */
static bool next_frame(laconic_drives *drives, laconic_frame *frame) {
    moteus_axis *first = NULL;
    for (int32_t i = 0; i < drives->count; i++) {
        moteus_axis *axis = moteus_axis_of(drives, i);
        if (axis->waits && (first == NULL || axis->node_id < first->node_id)) first = axis;
    }
    if (first == NULL) return false;
    moteus_reply(first, frame);
    return true;
}

const laconic_drive_protocol laconic_moteus = {
    .name = "moteus",
    .axis_bytes = sizeof(moteus_axis),
    .first_id = 1,
    .last_id = MOTEUS_EVERY_ID - 1,
    .start = start,
    .on_frame = on_frame,
    .on_step = on_step,
    .next_frame = next_frame,
};
