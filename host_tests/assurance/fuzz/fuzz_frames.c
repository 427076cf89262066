/* Any frames at any time, most of them with right protection so that the node accepts them: the node stays as
 * documented.
 *
 * Input: records of 10 bytes: [identifier offset and what to make wrong] [time that passes] [payload]. */
#include "laconic_node/node.h"
#include "laconic_node/protection.h"
#include "laconic_wire.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { RECORD = 10, SPOIL = 0x80, LONGER = 0x40 };

typedef struct bench {
    laconic_node node;
    uint32_t now_us;
} bench;

static void must(bool holds) {
    if (!holds) abort();
}

/* A small vehicle, so that the first frames can start a run. */
static void load(laconic_node *node) {
    const laconic_vehicle vehicle = {
        .mass_kg = 1,
        .yaw_inertia_kgm2 = 1,
        .wheel_radius_m = 1,
        .motor_gain_Nm_per_V = 1,
        .motor_damping_Nms = 1,
        .wheel_count = 2,
        .wheel = {{LACONIC_WHEEL_FIXED, false, 1, 0, 0, 0}, {LACONIC_WHEEL_FIXED, false, -1, 0, 0, 0}},
    };
    laconic_parameters *parameters = &node->loader.parameters;
    parameters->vehicle = vehicle;
    parameters->step_s = (laconic_real)0.001;
    must(laconic_plant_start(&node->plant, &vehicle, &laconic_rk4, parameters->step_s, &parameters->start, NULL) ==
         LACONIC_OK);
    node->xcp.page[LACONIC_XCP_WORKING_PAGE] = node->plant.vehicle;
    node->xcp.page[LACONIC_XCP_REFERENCE_PAGE] = node->plant.vehicle;
    node->state = LACONIC_WIRE_STATE_READY;
}

/* An XCP master connects, so that its commands need not find that. */
static void connect(laconic_node *node) {
    const laconic_frame frame = {
        .id = (uint32_t)node->config.id_base + LACONIC_WIRE_XCP_COMMAND, .length = 2, .data = {0xFF}};
    laconic_frame answer;
    laconic_node_on_frame(node, &frame, 0);
    while (laconic_node_next_frame(node, &answer)) continue; /* with those of the handshake */
    must(node->xcp.connected);
}

static void fill(laconic_frame *frame, const uint8_t *record, uint16_t id_base) {
    static const laconic_wire_row none = {8, 0, 0, 0, 0, 0};
    const uint8_t offset = record[0] & 31U;
    const laconic_wire_row *row = offset < LACONIC_WIRE_OFFSETS ? &laconic_wire[offset] : &none;
    memset(frame, 0, sizeof *frame);
    frame->id = (uint32_t)id_base + offset;
    frame->fd = row->fd != 0;
    frame->length = row->length;
    for (uint8_t k = 0; k < frame->length; k++) frame->data[k] = record[2 + k % 8];
}

/* Protects a frame as a rig that has lost no answer: each frame has the next count of its kind. */
static void protect(const bench *bench, laconic_frame *frame, uint8_t offset) {
    const laconic_node_session *session = &bench->node.session;
    if (offset >= LACONIC_WIRE_RIG_OFFSETS) return;
    switch (laconic_wire[offset].key) {
    case LACONIC_WIRE_KEY_NONE: laconic_protect_plain(offset, frame->data, frame->data[1]); break;
    case LACONIC_WIRE_KEY_NONCE:
        frame->data[2] = (uint8_t)session->nonce;
        frame->data[3] = (uint8_t)(session->nonce >> 8);
        laconic_protect_keyed(offset, frame->data, session->nonce, frame->data[1] & 15U);
        break;
    case LACONIC_WIRE_KEY_SESSION:
        laconic_protect_keyed(offset, frame->data, session->key, session->count[offset] + 1U);
        break;
    default: laconic_protect_keyed(offset, frame->data, session->run_key, session->count[offset] + 1U); break;
    }
}

/* The handshake, so that the inputs need not find it. */
static void open_session(bench *bench) {
    laconic_frame frame;
    uint8_t record[10] = {LACONIC_WIRE_HELLO};
    for (uint8_t offset = LACONIC_WIRE_HELLO; offset <= LACONIC_WIRE_OPEN; offset++) {
        record[0] = offset;
        fill(&frame, record, bench->node.config.id_base);
        protect(bench, &frame, offset);
        laconic_node_on_frame(&bench->node, &frame, 0);
    }
    must(bench->node.session.open);
}

/* Properties that docs/wire.md states for every state, and that the node runs on the page that XCP shows. */
static void check(const laconic_node *node) {
    const laconic_vehicle *page = &node->xcp.page[node->xcp.node_page];
    must(node->hinges.here || memcmp(page, &node->plant.vehicle, sizeof *page) == 0);
    const bool moves = node->state == LACONIC_WIRE_STATE_LOCKSTEP || node->state == LACONIC_WIRE_STATE_FREE_RUN;
    must(node->state <= LACONIC_WIRE_STATE_FAULT);
    for (int k = 0; !moves && k < LACONIC_MAX_WHEELS; k++) must(node->input[0].voltage_V[k] == 0);
}

static void drain(bench *bench) {
    laconic_frame frame;
    int left = 400; /* more than any answer has */
    while (laconic_node_next_frame(&bench->node, &frame)) {
        must(--left > 0);
        must(frame.id >= bench->node.config.id_base + LACONIC_WIRE_NODE_FIRST && frame.length <= LACONIC_FRAME_BYTES);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static bench bench, ready; /* with session and vehicle, made once */
    const laconic_node_config config = {LACONIC_WIRE_ID_BASE, true, laconic_method_by_number, 0,
                                        laconic_drive_protocol_by_number};
    if (!ready.node.session.open) {
        laconic_node_init(&ready.node, &config, 0);
        open_session(&ready);
        load(&ready.node);
        connect(&ready.node);
    }
    memcpy(&bench, &ready, sizeof bench);
    for (; size >= RECORD; data += RECORD, size -= RECORD) {
        laconic_frame frame;
        fill(&frame, data, config.id_base);
        if ((data[0] & SPOIL) == 0) protect(&bench, &frame, data[0] & 31U);
        if (data[0] & LONGER) frame.length = data[2] % (LACONIC_FRAME_BYTES + 1U);
        laconic_node_on_frame(&bench.node, &frame, bench.now_us);
        bench.now_us += 64U * data[1];
        laconic_node_on_tick(&bench.node, bench.now_us);
        check(&bench.node);
        drain(&bench);
    }
    return 0;
}
