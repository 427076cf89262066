/* The rig of recorded sessions. It reads keys from the node itself, since the handshake is not what these tests try. */
#include "rig.h"

#include "laconic_dbc.h"
#include "laconic_node/protection.h"

#include <string.h>

static const laconic_integrity_limits limits = {20, 100, 50, 1000}; /* ten times what this vehicle comes to */

void bench_power_up(bench *on, uint32_t nonce_seed, uint32_t start_us, uint8_t checks) {
    const laconic_node_config config = {LACONIC_WIRE_ID_BASE, true, laconic_method_by_number, nonce_seed,
                                        laconic_drive_protocol_by_number};
    memset(on, 0, sizeof *on);
    on->config = config;
    on->checks = checks;
    on->start_us = start_us;
    (void)laconic_node_init(&on->node, &on->config, start_us);
    if (checks != 0) laconic_integrity_begin(&on->integrity, &on->node, &on->config, &limits, checks);
}

uint32_t bench_node_time(const bench *on) {
    const int64_t drift = (int64_t)on->time_us * on->clock_ppm / 1000000;
    return on->start_us + on->shift_us + on->time_us + (uint32_t)drift;
}

void bench_frame(bench *on, const laconic_frame *frame) {
    const uint32_t now_us = bench_node_time(on);
    on->integrity.config = &on->config; /* a copy of a bench has its own */
    if (on->checks != 0)
        laconic_integrity_on_frame(&on->integrity, &on->node, frame, now_us);
    else
        laconic_node_on_frame(&on->node, frame, now_us);
}

void bench_tick(bench *on) {
    const uint32_t now_us = bench_node_time(on);
    on->integrity.config = &on->config;
    if (on->checks != 0)
        laconic_integrity_on_tick(&on->integrity, &on->node, now_us);
    else
        laconic_node_on_tick(&on->node, now_us);
}

bool bench_next(bench *on, laconic_frame *frame) {
    memset(frame, 0, sizeof *frame); /* frames are compared byte by byte */
    if (on->checks != 0) return laconic_integrity_next_frame(&on->integrity, &on->node, frame);
    return laconic_node_next_frame(&on->node, frame);
}

bool is_moving(const laconic_node *node) {
    return node->state == LACONIC_WIRE_STATE_LOCKSTEP || node->state == LACONIC_WIRE_STATE_FREE_RUN ||
           node->state == LACONIC_WIRE_STATE_TIMEOUT || node->state == LACONIC_WIRE_STATE_DRIVES;
}

static bool same_sum(const laconic_sum *a, const laconic_sum *b) { return memcmp(a, b, sizeof *a) == 0; }

bool same_motion(const laconic_node *a, const laconic_node *b) {
    const laconic_state *p = &a->plant.state, *q = &b->plant.state;
    bool same = a->plant.steps == b->plant.steps && same_sum(&p->x_m, &q->x_m) && same_sum(&p->y_m, &q->y_m) &&
                p->heading.turns == q->heading.turns && p->heading.fraction == q->heading.fraction &&
                memcmp(&p->heading.rest, &q->heading.rest, sizeof p->heading.rest) == 0;
    for (int k = 0; k < 3; k++)
        same = same && same_sum(&p->zeta[k], &q->zeta[k]) && same_sum(&p->travel[k], &q->travel[k]);
    return same;
}

/* ------------------------------------------------------------------------------------- events -- */

typedef struct rig {
    bench *on;
    recording *to;
    bench_watch watch;
    void *with;
    uint8_t status; /* of the last RESULT */
} rig;

static void happen(rig *it, const laconic_frame *frame) {
    laconic_frame sent;
    if (it->to != NULL) {
        const bus_event now = {it->on->time_us, frame == NULL, frame == NULL ? (laconic_frame){0} : *frame};
        it->to->event[it->to->events++] = now;
    }
    if (frame != NULL)
        bench_frame(it->on, frame);
    else
        bench_tick(it->on);
    while (bench_next(it->on, &sent)) {
        if (sent.id == LACONIC_WIRE_ID_BASE + LACONIC_WIRE_RESULT) it->status = sent.data[3];
        if (it->to != NULL) it->to->sent[it->to->frames++] = sent;
    }
    if (it->to != NULL) it->to->sent_until[it->to->events - 1] = it->to->frames;
    if (it->watch != NULL) it->watch(it->on, it->with);
}

static void protect(const laconic_node *node, laconic_frame *frame, uint8_t offset) {
    const laconic_node_session *session = &node->session;
    const uint32_t count = session->count[offset] + 1U;
    switch (laconic_wire[offset].key) {
    case LACONIC_WIRE_KEY_NONE: laconic_protect_plain(offset, frame->data, 1); break;
    case LACONIC_WIRE_KEY_NONCE:
        frame->data[2] = (uint8_t)session->nonce;
        frame->data[3] = (uint8_t)(session->nonce >> 8);
        laconic_protect_keyed(offset, frame->data, session->nonce, 1);
        break;
    case LACONIC_WIRE_KEY_SESSION: laconic_protect_keyed(offset, frame->data, session->key, count); break;
    default: laconic_protect_keyed(offset, frame->data, session->run_key, count); break;
    }
}

static void put(rig *it, uint8_t offset, const uint8_t payload[8]) {
    laconic_frame frame = {.id = LACONIC_WIRE_ID_BASE + (uint32_t)offset, .length = 8};
    memcpy(frame.data, payload, 8);
    protect(&it->on->node, &frame, offset);
    happen(it, &frame);
}

static void tick(rig *it) {
    it->on->time_us += TICK_US;
    happen(it, NULL);
}

static void handshake(rig *it) {
    const uint8_t nothing[8] = {0}, number[8] = {0, 0, 0, 0, 0x17, 0x05, 0x19, 0x04};
    put(it, LACONIC_WIRE_HELLO, nothing);
    it->status = 255;
    put(it, LACONIC_WIRE_OPEN, number);
}

static uint8_t control(rig *it, uint8_t command) {
    const struct laconic_dbc_control_t order = {.command = command, .rate = 100, .watchdog = WATCHDOG_MS};
    uint8_t data[8];
    laconic_dbc_control_pack(data, &order, 8);
    it->status = 255;
    put(it, LACONIC_WIRE_CONTROL, data);
    return it->status;
}

/* ------------------------------------------------------------------------------------ vehicle -- */

typedef struct number {
    uint8_t field, item;
    laconic_real value;
} number;

#define RIGHT_ANGLE ((laconic_real)1.5707963267948966)

/* Three omni wheels with motors and a damping that ends a motion in a second, its centre of mass aside. */
static const number reals[] = {
    {LACONIC_FIELD_MASS, 0, 10},
    {LACONIC_FIELD_YAW_INERTIA, 0, (laconic_real)0.225},
    {LACONIC_FIELD_COM_Y, 0, (laconic_real)0.02},
    {LACONIC_FIELD_WHEEL_RADIUS, 0, (laconic_real)0.05},
    {LACONIC_FIELD_WHEEL_INERTIA, 0, (laconic_real)0.009},
    {LACONIC_FIELD_MOTOR_GAIN, 0, (laconic_real)0.5},
    {LACONIC_FIELD_MOTOR_DAMPING, 0, (laconic_real)0.02},
    {LACONIC_FIELD_STEP, 0, (laconic_real)0.001},
    {LACONIC_FIELD_START_HEADING, 0, (laconic_real)0.3},
    {LACONIC_FIELD_WHEEL_X, 1, (laconic_real)0.05},
    {LACONIC_FIELD_WHEEL_X, 2, (laconic_real)-0.05},
    {LACONIC_FIELD_WHEEL_X, 3, 0},
    {LACONIC_FIELD_WHEEL_Y, 1, 0},
    {LACONIC_FIELD_WHEEL_Y, 2, 0},
    {LACONIC_FIELD_WHEEL_Y, 3, (laconic_real)0.06},
    {LACONIC_FIELD_AXLE, 1, 0},
    {LACONIC_FIELD_AXLE, 2, 2 * RIGHT_ANGLE},
    {LACONIC_FIELD_AXLE, 3, RIGHT_ANGLE},
    {LACONIC_FIELD_ROLLER, 1, RIGHT_ANGLE},
    {LACONIC_FIELD_ROLLER, 2, RIGHT_ANGLE},
    {LACONIC_FIELD_ROLLER, 3, RIGHT_ANGLE},
};

static void parameter(rig *it, uint8_t field, uint8_t item, uint32_t value, bool upper_half) {
    const struct laconic_dbc_parameter_t frame = {
        .field = field, .item = item, .value = value, .upper_half = upper_half};
    uint8_t data[8];
    laconic_dbc_parameter_pack(data, &frame, 8);
    it->on->time_us += 500;
    put(it, LACONIC_WIRE_PARAMETER, data);
}

static void load(rig *it) {
    for (size_t k = 0; k < sizeof reals / sizeof reals[0]; k++) {
        uint32_t half[2] = {0, 0};
        memcpy(half, &reals[k].value, sizeof reals[k].value);
        parameter(it, reals[k].field, reals[k].item, half[0], false);
        if (sizeof(laconic_real) == 8) parameter(it, reals[k].field, reals[k].item, half[1], true);
    }
    parameter(it, LACONIC_FIELD_WHEEL_COUNT, 0, 3, false);
    parameter(it, LACONIC_FIELD_METHOD, 0, 1, false);
    for (uint8_t wheel = 1; wheel <= 3; wheel++) parameter(it, LACONIC_FIELD_WHEEL_KIND, wheel, 1, false);
}

static uint8_t commit(rig *it) {
    const laconic_loader *loader = &it->on->node.loader;
    const struct laconic_dbc_commit_t frame = {.frame_count = loader->frame_count, .checksum = ~loader->checksum};
    uint8_t data[8];
    laconic_dbc_commit_pack(data, &frame, 8);
    it->status = 255;
    put(it, LACONIC_WIRE_COMMIT, data);
    return it->status;
}

static void voltages(rig *it, int k, uint8_t sync) {
    const int16_t sign = k / 50 % 2 == 0 ? 1 : -1;
    const struct laconic_dbc_voltage_t frame = {.sync = sync,
                                                .voltage_1 = (int16_t)(400 * sign),
                                                .voltage_2 = (int16_t)(-400 * sign),
                                                .voltage_3 = (int16_t)(200 + k)};
    uint8_t data[8];
    laconic_dbc_voltage_pack(data, &frame, 8);
    put(it, LACONIC_WIRE_VOLTAGE, data);
}

static int here(const rig *it) { return it->to == NULL ? 0 : it->to->events; }

static bool drive_free(rig *it) {
    if (control(it, LACONIC_WIRE_COMMAND_START_FREE_RUN) != 0) return false;
    for (int k = 0; k < FREE_TICKS; k++) {
        voltages(it, k, 0);
        tick(it); /* twice in a period, so that a clock that is fast has a tick for each of its own */
        tick(it);
    }
    return control(it, LACONIC_WIRE_COMMAND_STOP) == 0;
}

static bool drive_lockstep(rig *it) {
    if (control(it, LACONIC_WIRE_COMMAND_START_LOCKSTEP) != 0) return false;
    for (int k = 0; k <= LOCK_STEPS; k++) {
        voltages(it, k, 1);
        tick(it);
    }
    return control(it, LACONIC_WIRE_COMMAND_STOP) == 0;
}

bool rig_session(bench *on, recording *to, bench_watch watch, void *with) {
    rig it = {on, to, watch, with, 255};
    const uint8_t select[8] = {0, 0, LACONIC_NODE_SEND_NU | LACONIC_NODE_SEND_POSE, 0, 0};
    if (to != NULL) memset(to, 0, sizeof *to);
    tick(&it);
    handshake(&it);
    if (it.status != 0 || control(&it, LACONIC_WIRE_COMMAND_BEGIN) != 0) return false;
    load(&it);
    if (to != NULL) to->commit = here(&it);
    if (commit(&it) != 0) return false;
    put(&it, LACONIC_WIRE_SELECT, select);
    if (to != NULL) to->free_run = here(&it);
    if (it.status != 0 || !drive_free(&it)) return false;
    if (to != NULL) to->lockstep = here(&it);
    return drive_lockstep(&it);
}

bool rig_open(bench *on) {
    rig it = {on, NULL, NULL, NULL, 255};
    handshake(&it);
    return it.status == 0;
}

uint8_t rig_command(bench *on, uint8_t command) {
    rig it = {on, NULL, NULL, NULL, 255};
    return control(&it, command);
}
