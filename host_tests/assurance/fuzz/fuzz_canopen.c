/* Any frames to two CANopen drives, with time and faults between them: what the drives promise holds at every step.
 *
 * Input: records of 12 bytes: [which identifier] [node, length, remote] [time that passes] [what breaks] [payload]. */
#include "canopen/canopen.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { RECORD = 12, NODES = 2, FIRST_ID = 5 };

typedef struct bench {
    laconic_drives drives;
    canopen_axis axes[NODES];
    uint32_t now_us;
    laconic_real wheel_rad_per_s[NODES];
} bench;

static void must(bool holds) {
    if (!holds) abort();
}

static bool is_finite(laconic_real value) { return value - value == 0; }

static void power_up(bench *on) {
    const laconic_drive_settings settings = {
        .node_id = FIRST_ID,
        .encoder_counts = 4096,
        .gear_ratio = -20,
        .torque_constant_Nm_per_A = (laconic_real)0.05,
        .current_limit_A = 10,
        .supply_V = 24,
        .position_gain_per_s = 10,
        .speed_gain_As = (laconic_real)0.02,
        .speed_integral_gain_A = (laconic_real)0.1,
    };
    memset(on, 0, sizeof *on);
    on->drives.protocol = &laconic_canopen;
    on->drives.axes = on->axes;
    on->drives.count = NODES;
    on->drives.step_s = (laconic_real)0.001;
    for (int k = 0; k < NODES; k++) {
        laconic_drive_start(&on->drives.drive[k], &settings);
        on->drives.drive[k].settings.node_id += k;
    }
    laconic_canopen.start(&on->drives, 0);
}

/* An identifier that means something most of the time: the record names a function code and a node. */
static void fill(laconic_frame *frame, const uint8_t *record) {
    static const uint16_t functions[16] = {0,     0x80,  0x80,  0x180, 0x200, 0x280, 0x300, 0x400,
                                           0x500, 0x600, 0x600, 0x600, 0x600, 0x700, 0x701, 0x7E5};
    memset(frame, 0, sizeof *frame);
    frame->id = functions[record[0] & 15U];
    if (frame->id > 0x80 && frame->id != 0x701) frame->id += FIRST_ID + (record[1] & 1U);
    frame->length = 8;
    frame->remote = (record[1] & 0xE0U) == 0xE0U;
    if ((record[1] & 0x10U) != 0) frame->length = record[1] >> 1 & 7U;
    if (frame->id == 0) frame->length = 2;
    memcpy(frame->data, record + 4, 8);
}

static void check(const bench *on) {
    for (int k = 0; k < NODES; k++) {
        const canopen_axis *axis = &on->axes[k];
        const laconic_wheel_drive *drive = &on->drives.drive[k];
        const laconic_drive_mode mode = drive->target.mode;
        must(axis->state <= CANOPEN_FAULT && axis->history_count <= CANOPEN_HISTORY);
        must(mode == LACONIC_DRIVE_OFF || (axis->state >= CANOPEN_ENABLED && axis->state < CANOPEN_FAULT));
        must(canopen_has_mode(axis->mode_display));
        must(is_finite(axis->speed) && is_finite(axis->demand_rest) && is_finite(drive->target.speed_rad_per_s));
        must(axis->demand_rest >= 0 && axis->demand_rest <= 1);
        must(drive->current_A <= axis->rated_A && drive->current_A >= -axis->rated_A);
        for (int n = 0; n < 2 * CANOPEN_PDOS; n++) {
            const canopen_pdo *pdo = &axis->pdo[n];
            must(pdo->count <= CANOPEN_MAPPED);
            for (int m = 0; m < pdo->count; m++) must(canopen_row_at(pdo->row[m]) != NULL);
        }
    }
}

static void drain(bench *on) {
    laconic_frame frame;
    int left = 64; /* more than two nodes can have due */
    while (laconic_canopen.next_frame(&on->drives, &frame)) {
        must(--left > 0);
        must(frame.id > 0 && frame.id < 0x800 && frame.length <= 8 && !frame.extended && !frame.remote);
    }
}

static void step(bench *on) {
    const laconic_real step_s = on->drives.step_s;
    laconic_canopen.on_step(&on->drives, on->now_us);
    for (int k = 0; k < NODES; k++) {
        const laconic_real torque_Nm = laconic_drive_act(&on->drives.drive[k], step_s);
        must(is_finite(torque_Nm));
        on->wheel_rad_per_s[k] += torque_Nm / 2 * step_s;
        laconic_drive_measure(&on->drives.drive[k], on->wheel_rad_per_s[k] * step_s, on->wheel_rad_per_s[k]);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static bench on;
    power_up(&on);
    for (; size >= RECORD; data += RECORD, size -= RECORD) {
        laconic_frame frame;
        fill(&frame, data);
        laconic_canopen.on_frame(&on.drives, &frame, on.now_us);
        drain(&on);
        for (int n = data[2] >> 6; n > 0; n--) {
            on.now_us += 1000U * (data[2] & 31U) * (data[2] & 32U ? 64U : 1U);
            if (data[3] >> 4 == 0xE) /* faults by order that remain until the next one */
                laconic_drive_order(&on.drives.drive[data[3] & 1],
                                    (data[0] | (uint32_t)data[0] << 3) & LACONIC_DRIVE_ORDERS);
            if (data[3] > 0xF0) laconic_drive_fail(&on.drives.drive[data[3] & 1], 1U << (data[3] >> 1 & 3U));
            step(&on);
        }
        check(&on);
        drain(&on);
    }
    return 0;
}
