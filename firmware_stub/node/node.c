/* The node's three calls: a frame comes, time passes, a frame is fetched. */
#include "laconic_node/node.h"

#include "node_internal.h"

#include <string.h>

/* A build without CAN FD has no room for the 64 bytes of its frames. */
static bool is_usable(const laconic_node_config *config) {
    if (!LACONIC_NODE_CAN_FD && config->can_fd) return false;
    return config->id_base % LACONIC_NODE_ID_STRIDE == 0 && config->id_base <= 0x7E0U && config->method != NULL;
}

/* The definitions that every port must share (build.h). */
#define DEFINE_BUILT(name) \
    void name(void) {}
LACONIC_NODE_BUILT(DEFINE_BUILT)

bool(laconic_node_init)(laconic_node *node, const laconic_node_config *config, uint32_t now_us) {
    LACONIC_WIRE_BUILT();
    if (!is_usable(config)) return false;
    memset(node, 0, sizeof *node);
    node->config = *config;
    node->state = LACONIC_WIRE_STATE_EMPTY;
    node->heartbeat_us = now_us;
    laconic_loader_begin(&node->loader);
    if (!LACONIC_NODE_DRIVES_ONLY) laconic_raw_restart(&node->raw_input);
    return true;
}

static bool is_well_formed(const laconic_frame *frame, const laconic_wire_row *row) {
    if (row->fd && !LACONIC_NODE_CAN_FD) return false;
    return !frame->remote && frame->fd == (row->fd != 0) && frame->length == row->length;
}

static void sync(laconic_node *node, const uint8_t *data) {
    laconic_node_sync(node, word32(data + 2), word16(data + 6), data[1] & 15U);
}

/* Frames that move the vehicle. */
static bool dispatch_motion(laconic_node *node, uint8_t offset, const uint8_t *data, uint32_t now_us) {
    switch (offset) {
    case LACONIC_WIRE_SYNC: sync(node, data); return true;
    case LACONIC_WIRE_VOLTAGE: return laconic_node_voltage(node, data, now_us);
    case LACONIC_WIRE_RAW_INPUT: return laconic_node_raw(node, data + 2, data[1] >> 4, 15, 6);
#if LACONIC_NODE_WITH_HINGES
    case LACONIC_WIRE_STEERING: return laconic_node_steering(node, data);
#endif
    default: break;
    }
    if (!LACONIC_NODE_CAN_FD) return false;
    if (offset == LACONIC_WIRE_VOLTAGE_FD) return laconic_node_voltage_fd(node, data, now_us);
    return laconic_node_raw(node, data + 4, data[3], 255, 60);
}

static bool dispatch(laconic_node *node, uint8_t offset, const uint8_t *data, uint32_t now_us) {
    laconic_node_result answer;
    switch (offset) {
    case LACONIC_WIRE_HELLO: laconic_node_hello(node, data, now_us); return true;
    case LACONIC_WIRE_OPEN: laconic_node_open(node, data, now_us); return true;
    case LACONIC_WIRE_CONTROL: answer = laconic_node_control(node, data, now_us); break;
    case LACONIC_WIRE_SELECT: answer = laconic_node_select(node, data); break;
    case LACONIC_WIRE_COMMIT: answer = laconic_node_commit(node, data); break;
    case LACONIC_WIRE_PARAMETER: answer = laconic_node_parameter(node, data); break;
    default: return !LACONIC_NODE_DRIVES_ONLY && dispatch_motion(node, offset, data, now_us);
    }
    laconic_node_answer(node, offset, answer);
    return true;
}

/* True iff the frame is one that the rig sends now. HELLO and OPEN are checked by their own functions. */
static bool takes(laconic_node *node, uint8_t offset, const uint8_t *data) {
    const uint8_t key = laconic_wire[offset].key;
    if (key == LACONIC_WIRE_KEY_SESSION) return laconic_node_takes_command(node, offset, data);
    return key != LACONIC_WIRE_KEY_RUN || LACONIC_NODE_DRIVES_ONLY || laconic_node_takes_motion(node, offset, data);
}

void laconic_node_on_frame(laconic_node *node, const laconic_frame *frame, uint32_t now_us) {
    const uint32_t offset = frame->id - node->config.id_base;
    if (frame->extended || offset >= LACONIC_NODE_ID_STRIDE) { /* for another node, or for a drive */
#if LACONIC_NODE_WITH_DRIVES
        if (plays_drives(node) && laconic_frame_fits(frame)) laconic_drives_on_frame(&node->drives, frame, now_us);
#endif
        return;
    }
#if LACONIC_NODE_WITH_XCP
    if (offset == LACONIC_WIRE_XCP_COMMAND) {
        laconic_xcp_on_frame(node, frame);
        return;
    }
#endif
    if (!LACONIC_WIRE_FROM_RIG(offset) || !is_well_formed(frame, &laconic_wire[offset])) {
        count(&node->counters.malformed);
        return;
    }
    if (!takes(node, (uint8_t)offset, frame->data)) return;
    if (!dispatch(node, (uint8_t)offset, frame->data, now_us)) count(&node->counters.refused);
}

/* A controller of drives has the bus for itself, unless a rig asks for frames. */
static bool is_silent(const laconic_node *node) {
#if LACONIC_NODE_WITH_HINGES
    if (node->hinges.send != 0 || node->raw_output.send_hinges != 0) return false;
#endif
    return plays_drives(node) && node->send == 0 && node->raw_output.send == 0 && !estimates(node);
}

void laconic_node_on_tick(laconic_node *node, uint32_t now_us) {
    if ((int32_t)(now_us - node->heartbeat_us) >= (int32_t)LACONIC_NODE_HEARTBEAT_US) {
        node->heartbeat_us += LACONIC_NODE_HEARTBEAT_US;
        if (!is_silent(node)) node->pending |= BIT_OF(LACONIC_WIRE_HEARTBEAT);
        if (node->send & LACONIC_NODE_SEND_COUNTERS) node->pending |= BIT_OF(LACONIC_WIRE_COUNTERS);
#if LACONIC_NODE_WITH_ESTIMATE
        if (estimates(node)) laconic_node_publish_estimate(node);
#endif
    }
#if LACONIC_NODE_WITH_DRIVES
    if (plays_drives(node)) laconic_node_run_drives(node, now_us);
#endif
    if (LACONIC_NODE_DRIVES_ONLY) return;
    if (node->state == LACONIC_WIRE_STATE_LOCKSTEP) laconic_node_run_lockstep(node);
    if (node->state == LACONIC_WIRE_STATE_FREE_RUN || node->state == LACONIC_WIRE_STATE_TIMEOUT)
        laconic_node_run_free(node, now_us);
}

/* Counts the part that was sent; true iff the frame has more parts: wheel groups, counter pages, raw segments. */
static bool has_more(laconic_node *node, uint8_t offset) {
    switch (offset) {
    case LACONIC_WIRE_RESULT:
        node->answers_due = (uint16_t)(node->answers_due & (node->answers_due - 1U)); /* clears the lowest bit */
        return node->answers_due != 0;
    case LACONIC_WIRE_WHEEL_SPEED: node->wheel_group++; return 3 * node->wheel_group < node->plant.model.wheel_count;
#if LACONIC_NODE_WITH_SENSORS
    case LACONIC_WIRE_WHEEL_ANGLE: node->angle_group++; return 3 * node->angle_group < node->plant.model.wheel_count;
    case LACONIC_WIRE_ENCODER:
        node->encoder_wheel = laconic_node_encoder_from(node, node->encoder_wheel + 1);
        return node->encoder_wheel < LACONIC_MAX_WHEELS;
#endif
#if LACONIC_NODE_WITH_HINGES
    case LACONIC_WIRE_HINGE_ANGLE:
        node->hinges.angle_group++;
        return 3 * node->hinges.angle_group < node->hinges.model.body_count;
    case LACONIC_WIRE_HINGE_RATE:
        node->hinges.rate_group++;
        return 3 * node->hinges.rate_group < node->hinges.model.body_count;
#endif
#if LACONIC_NODE_WITH_ESTIMATE
    case LACONIC_WIRE_ERROR_ESTIMATE: node->estimate_page++; return node->estimate_page < LACONIC_NODE_ESTIMATE_PAGES;
#endif
    case LACONIC_WIRE_COUNTERS:
        node->counter_page = (uint8_t)((node->counter_page + 1U) % 3U);
        return node->counter_page != 0;
    case LACONIC_WIRE_RAW_OUTPUT:
    case LACONIC_WIRE_RAW_OUTPUT_FD: return node->raw_output.position < node->raw_output.size;
    default: return false;
    }
}

static bool frame_of_drives(laconic_node *node, laconic_frame *frame) {
#if LACONIC_NODE_WITH_DRIVES
    if (plays_drives(node)) return laconic_drives_next_frame(&node->drives, frame);
#endif
    (void)node;
    (void)frame;
    return false;
}

bool laconic_node_next_frame(laconic_node *node, laconic_frame *frame) {
    uint8_t offset = LACONIC_WIRE_RESULT;
#if LACONIC_NODE_WITH_XCP
    if (node->pending == 0 && laconic_xcp_next_frame(node, frame)) return true;
#endif
    if (node->pending == 0) return frame_of_drives(node, frame);
    while ((node->pending & BIT_OF(offset)) == 0) offset++;
    const laconic_wire_row *row = &laconic_wire[offset];
    frame->id = (uint32_t)node->config.id_base + offset;
    frame->length = row->length;
    frame->extended = false;
    frame->remote = false;
    frame->fd = row->fd != 0;
    frame->bit_rate_switch = frame->fd;
    laconic_node_pack(node, offset, frame->data);
    laconic_protect_plain(offset, frame->data, ++node->sent[offset - LACONIC_WIRE_NODE_FIRST]);
    if (!has_more(node, offset)) node->pending &= ~BIT_OF(offset);
    return true;
}

bool laconic_node_is_busy(const laconic_node *node) {
#if LACONIC_NODE_WITH_XCP
    if (laconic_daq_steps(node, 1) == 0) return false;
#endif
    return !LACONIC_NODE_DRIVES_ONLY && node->lockstep.steps_due > 0;
}

uint32_t laconic_node_idle_us(const laconic_node *node, uint32_t now_us) {
    const uint32_t heartbeat = node->heartbeat_us + LACONIC_NODE_HEARTBEAT_US - now_us;
    uint32_t idle = (int32_t)heartbeat < 0 ? 0U : heartbeat;
    if (is_running(node) && node->state != LACONIC_WIRE_STATE_LOCKSTEP) {
        const int32_t step = (int32_t)(node->free_run.next_us - now_us);
        if (step < (int32_t)idle) idle = step < 0 ? 0U : (uint32_t)step;
    }
    return laconic_node_is_busy(node) ? 0U : idle;
}
