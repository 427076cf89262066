/* Frames that move the vehicle: voltages, raw inputs, SYNC. */
#include "node_internal.h"

#include "laconic_dbc.h"

#if LACONIC_MAX_WHEELS > 24
#error "laconic: VOLTAGE numbers eight groups of three wheels: LACONIC_MAX_WHEELS must be at most 24"
#endif

#define MOST_STEPS 1000000U /* of one SYNC */

/* Resets the watchdog when the voltages of all groups have come. */
static void feed(laconic_node *node, uint8_t group, uint32_t now_us) {
    const int32_t wheels = node->plant.model.wheel_count;
    const int32_t groups = wheels > 3 ? (wheels + 2) / 3 : 1;
    node->groups_seen = (uint8_t)(node->groups_seen | (1U << group));
    if (node->groups_seen != (1U << groups) - 1U) return;
    node->groups_seen = 0;
    node->free_run.fed_us = now_us;
}

static bool may_set_voltages(const laconic_node *node, bool with_sync) {
    const bool lockstep = node->state == LACONIC_WIRE_STATE_LOCKSTEP;
    return listens_to_voltages(node) && node->lockstep.steps_due == 0 && (lockstep || !with_sync);
}

bool laconic_node_voltage(laconic_node *node, const uint8_t *data, uint32_t now_us) {
    struct laconic_dbc_voltage_t frame;
    laconic_dbc_voltage_unpack(&frame, data, 8);
    const int32_t wheels = node->plant.model.wheel_count;
    const int32_t first = 3 * (int32_t)frame.group;
    if (!may_set_voltages(node, frame.sync != 0) || (first >= wheels && first > 0)) return false;
    const int16_t raw[3] = {frame.voltage_1, frame.voltage_2, frame.voltage_3};
    for (int32_t k = 0; k < 3 && first + k < wheels; k++)
        node->input[0].voltage_V[first + k] = (laconic_real)raw[k] / LACONIC_WIRE_VOLTAGE_VOLTAGE_1_PER_UNIT;
    if (frame.overrange) count(&node->counters.overrange);
    feed(node, frame.group, now_us);
    if (frame.sync) laconic_node_sync(node, 1, 0, frame.counter);
    return true;
}

bool laconic_node_voltage_fd(laconic_node *node, const uint8_t *data, uint32_t now_us) {
    const bool with_sync = (data[3] & 1U) != 0;
    const int32_t wheels = node->plant.model.wheel_count;
    if (!may_set_voltages(node, with_sync) || wheels > 16) return false; /* the frame has room for 16 */
    for (int32_t k = 0; k < wheels; k++) {
        const int16_t raw = (int16_t)(data[4 + 2 * k] | data[5 + 2 * k] << 8);
        node->input[0].voltage_V[k] = (laconic_real)raw / LACONIC_WIRE_VOLTAGE_FD_VOLTAGE_1_PER_UNIT;
    }
    if (data[3] & 2U) count(&node->counters.overrange);
    node->groups_seen = 0;
    node->free_run.fed_us = now_us;
    if (with_sync) laconic_node_sync(node, 1, 0, data[2] & 15U);
    return true;
}

#if LACONIC_NODE_WITH_HINGES
bool laconic_node_steering(laconic_node *node, const uint8_t *data) {
    const bool with_sync = (data[1] & 16U) != 0;
    int16_t raw[3];
    for (int k = 0; k < 3; k++) raw[k] = (int16_t)word16(data + 2 + 2 * k);
    if (!may_set_voltages(node, with_sync) || !laconic_node_take_steering(node, data[1] >> 5, raw)) return false;
    if (with_sync) laconic_node_sync(node, 1, 0, data[1] & 15U);
    return true;
}
#endif

bool laconic_node_raw(laconic_node *node, const uint8_t *bytes, uint8_t segment, uint8_t mask, uint8_t size) {
    if (node->state != LACONIC_WIRE_STATE_LOCKSTEP || node->lockstep.steps_due > 0) return false;
#if LACONIC_NODE_WITH_HINGES
    node->raw_input.hinged = node->hinges.input; /* of this node, which may be a copy of another */
#if LACONIC_NODE_WITH_SLIP
    node->raw_input.angle_rad = node->hinges.angle_rad;
#endif
#endif
    return laconic_raw_take(&node->raw_input, node->input, node->plant.model.wheel_count, segment, mask, bytes, size);
}

static uint8_t sync_status(const laconic_node *node, uint32_t steps, uint16_t input_frames) {
    const bool sampled = (node->raw_input.take & LACONIC_RAW_SAMPLED) != 0;
    if (node->state != LACONIC_WIRE_STATE_LOCKSTEP) return LACONIC_WIRE_STATUS_WRONG_STATE;
    if (node->lockstep.steps_due > 0) return LACONIC_WIRE_STATUS_BUSY;
    if (steps == 0 || steps > MOST_STEPS || (sampled && steps != 1)) return LACONIC_WIRE_STATUS_OUT_OF_RANGE;
    if (!laconic_raw_is_whole(&node->raw_input, input_frames)) return LACONIC_WIRE_STATUS_INPUT_INCOMPLETE;
    return 0;
}

void laconic_node_sync(laconic_node *node, uint32_t steps, uint16_t input_frames, uint8_t request) {
    const uint8_t status = sync_status(node, steps, input_frames);
    if (status != LACONIC_WIRE_STATUS_BUSY) laconic_raw_restart(&node->raw_input);
    if (status != 0) {
        node->answer[LACONIC_WIRE_SYNC].request = request;
        const laconic_node_result answer = {.command = LACONIC_WIRE_COMMAND_SYNC, .status = status};
        laconic_node_answer(node, LACONIC_WIRE_SYNC, answer);
        return;
    }
    node->lockstep.steps_due = steps;
    node->lockstep.request = request;
}
