/* Frames that configure the node: CONTROL, PARAMETER, COMMIT and SELECT, each answered by RESULT. */
#include "node_internal.h"

#include "laconic_dbc.h"

#include <string.h>

void laconic_node_answer_again(laconic_node *node, uint8_t offset) {
    node->answers_due = (uint16_t)(node->answers_due | BIT(offset));
    node->pending |= BIT(LACONIC_WIRE_RESULT);
}

void laconic_node_answer(laconic_node *node, uint8_t offset, uint8_t command, uint8_t status, uint8_t field,
                         uint8_t item) {
    laconic_node_result *answer = &node->answer[offset];
    answer->command = command;
    answer->status = status;
    answer->field = field;
    answer->item = item;
    laconic_node_answer_again(node, offset);
    if (status != 0) count(&node->counters.refused);
}

static uint8_t begin(laconic_node *node) {
    laconic_loader_begin(&node->loader);
    return 0;
}

/* Begins a run with a new key: motion frames that were sent for an earlier run no longer pass. */
static uint8_t start(laconic_node *node, uint8_t state) {
    if (node->state != LACONIC_WIRE_STATE_READY) return LACONIC_WIRE_STATUS_WRONG_STATE;
    laconic_node_begin_run(node);
    laconic_raw_restart(&node->raw_input);
    node->groups_seen = 0;
    node->state = state;
    return 0;
}

/* Periods of a whole number of steps, 1 to 1000 periods a second; rate 0: one step a period. Computed in
 * laconic_real, so that an image in single precision needs no arithmetic in double. */
static bool choose_rate(laconic_node_free_run *run, uint16_t rate_Hz, laconic_real step_s) {
    const laconic_real half = (laconic_real)0.5;
    const laconic_real slack = (laconic_real)1e-4; /* of a step: far more than rounding errors */
    const laconic_real own_rate_Hz = 1 / step_s;
    if (!(own_rate_Hz < (laconic_real)1e6)) return false;
    run->rate_Hz = rate_Hz > 0 ? rate_Hz : (uint32_t)(own_rate_Hz + half);
    if (run->rate_Hz < 1 || run->rate_Hz > 1000U) return false;
    const laconic_real steps = own_rate_Hz / (laconic_real)run->rate_Hz;
    if (!(steps > half) || !(steps < LACONIC_NODE_STEPS_PER_TICK + half)) return false;
    run->steps_per_period = (uint32_t)(steps + half);
    const laconic_real off = steps - (laconic_real)run->steps_per_period;
    return off < slack && off > -slack;
}

static uint8_t start_free_run(laconic_node *node, const struct laconic_dbc_control_t *frame, uint32_t now_us) {
    laconic_node_free_run run = {0};
    if (node->state != LACONIC_WIRE_STATE_READY) return LACONIC_WIRE_STATUS_WRONG_STATE;
    if (!choose_rate(&run, frame->rate, node->plant.integrator.step_s)) return LACONIC_WIRE_STATUS_OUT_OF_RANGE;
    node->free_run.watchdog_us = 1000U * (uint32_t)frame->watchdog;
    laconic_node_begin_periods(node, run.rate_Hz, run.steps_per_period, now_us);
    return start(node, LACONIC_WIRE_STATE_FREE_RUN);
}

#if LACONIC_NODE_WITH_DRIVES
static uint8_t start_drives(laconic_node *node, uint32_t now_us, uint8_t *field) {
    const uint8_t status = laconic_node_start_drives(node, now_us, field);
    return status == 0 ? start(node, LACONIC_WIRE_STATE_DRIVES) : status;
}
#endif

static uint8_t stop(laconic_node *node) {
#if LACONIC_NODE_WITH_DRIVES
    if (plays_drives(node)) laconic_drives_off(&node->drives);
#endif
    if (is_running(node)) node->state = LACONIC_WIRE_STATE_READY;
    node->lockstep.steps_due = 0;
    node->session.deaf = 0;
    laconic_node_clear_inputs(node);
    return 0;
}

void laconic_node_make_idle(laconic_node *node) {
    stop(node);
    laconic_loader_begin(&node->loader);
    node->send = 0;
    node->raw_input.take = 0;
    node->raw_output.send = 0;
    node->answers_due = 0;
    node->pending = 0;
}

static uint8_t reset(laconic_node *node, uint8_t *field, uint8_t *item) {
    laconic_refusal why = {0};
    if (node->state == LACONIC_WIRE_STATE_EMPTY) return LACONIC_WIRE_STATUS_WRONG_STATE;
    const laconic_status status = laconic_plant_restart(&node->plant, &node->start, &why);
#if LACONIC_NODE_WITH_SENSORS
    laconic_node_start_sensors(node, &node->sensors.settings);
#endif
    stop(node);
    node->state = LACONIC_WIRE_STATE_READY;
    memset(&node->counters, 0, sizeof node->counters);
    *field = (uint8_t)why.field;
    *item = (uint8_t)why.item;
    return (uint8_t)status;
}

void laconic_node_control(laconic_node *node, const uint8_t *data, uint32_t now_us) {
    struct laconic_dbc_control_t frame;
    uint8_t status;
    uint8_t field = 0;
    uint8_t item = 0;
    laconic_dbc_control_unpack(&frame, data, 8);
    switch (frame.command) {
    case LACONIC_WIRE_COMMAND_BEGIN: status = begin(node); break;
    case LACONIC_WIRE_COMMAND_START_LOCKSTEP: status = start(node, LACONIC_WIRE_STATE_LOCKSTEP); break;
    case LACONIC_WIRE_COMMAND_START_FREE_RUN: status = start_free_run(node, &frame, now_us); break;
#if LACONIC_NODE_WITH_DRIVES
    case LACONIC_WIRE_COMMAND_START_DRIVES: status = start_drives(node, now_us, &field); break;
#endif
    case LACONIC_WIRE_COMMAND_STOP: status = stop(node); break;
    case LACONIC_WIRE_COMMAND_RESET: status = reset(node, &field, &item); break;
    default: status = LACONIC_WIRE_STATUS_UNKNOWN_COMMAND; break;
    }
    laconic_node_answer(node, LACONIC_WIRE_CONTROL, frame.command, status, field, item);
}

/* Each PARAMETER has its own answer, so that the rig notices a lost one at once. The first refusal stays until
 * BEGIN. */
void laconic_node_parameter(laconic_node *node, const uint8_t *data) {
    const laconic_loader *loader = &node->loader;
#if LACONIC_NODE_WITH_DRIVES && LACONIC_NODE_WITH_DRIVE_FAULTS
    if (data[2] == LACONIC_WIRE_FIELD_DRIVE_FAULTS) { /* an order for now, no number of a vehicle */
        const uint8_t status = laconic_node_order_drive(node, data);
        laconic_node_answer(node, LACONIC_WIRE_PARAMETER, LACONIC_WIRE_COMMAND_PARAMETER, status, data[2], data[3]);
        return;
    }
#endif
    laconic_loader_take(&node->loader, data);
    laconic_node_answer(node, LACONIC_WIRE_PARAMETER, LACONIC_WIRE_COMMAND_PARAMETER, loader->status, loader->field,
                        loader->item);
}

/* The loaded parameters become the vehicle, or nothing changes. */
static uint8_t adopt(laconic_node *node, uint8_t *field, uint8_t *item) {
    const laconic_parameters *new = &node->loader.parameters;
    const laconic_method *method = node->config.method(new->method);
    laconic_refusal why = {0};
    if (method == NULL) {
        *field = LACONIC_FIELD_METHOD;
        return LACONIC_METHOD_UNKNOWN;
    }
#if LACONIC_NODE_WITH_DRIVES
    const uint8_t refused = laconic_node_check_drives(node, &new->drives, new->vehicle.wheel_count, field, item);
    if (refused != 0) return refused;
#endif
    laconic_status status = LACONIC_OK;
#if LACONIC_NODE_WITH_SENSORS
    status = laconic_sensor_settings_check(&new->sensors, new->vehicle.wheel_count, &why);
#endif
    if (status == LACONIC_OK)
        status = laconic_plant_start(&node->plant, &new->vehicle, method, new->step_s, &new->start, &why);
    *field = (uint8_t)why.field;
    *item = (uint8_t)why.item;
    if (status != LACONIC_OK) return (uint8_t)status;
#if LACONIC_NODE_WITH_SENSORS
    laconic_node_start_sensors(node, &new->sensors);
#endif
#if LACONIC_NODE_WITH_DRIVES
    node->drive_plan = new->drives;
#endif
    node->start = new->start;
    node->state = LACONIC_WIRE_STATE_READY;
    memset(node->input, 0, sizeof node->input);
    laconic_node_clear_inputs(node);
    return 0;
}

void laconic_node_commit(laconic_node *node, const uint8_t *data) {
    uint8_t field = 0;
    uint8_t item = 0;
    uint8_t status = LACONIC_WIRE_STATUS_WRONG_STATE;
    if (!is_running(node))
        status = laconic_loader_check(&node->loader, word16(data + 2), word32(data + 4), &field, &item);
    if (status == 0) status = adopt(node, &field, &item);
    laconic_node_answer(node, LACONIC_WIRE_COMMIT, LACONIC_WIRE_COMMAND_COMMIT, status, field, item);
}

void laconic_node_select(laconic_node *node, const uint8_t *data) {
    const uint8_t raw_fd = data[3] >> 7;
    uint8_t status = 0;
    if (listens_to_voltages(node)) {
        status = LACONIC_WIRE_STATUS_WRONG_STATE;
    } else if ((raw_fd || data[2] & LACONIC_NODE_SEND_STATE_FD) && !node->config.can_fd) {
        status = LACONIC_WIRE_STATUS_NOT_SUPPORTED;
    } else if (!LACONIC_NODE_WITH_SENSORS && ((data[2] & SENDS_OF_SENSORS) | (data[3] & RAW_OF_SENSORS)) != 0) {
        status = LACONIC_WIRE_STATUS_NOT_SUPPORTED;
    } else {
        node->send = data[2];
        node->raw_fd = raw_fd != 0;
        node->raw_output.send = data[3] & 0x7FU;
        node->raw_input.take = data[4];
        laconic_node_clear_inputs(node);
    }
    laconic_node_answer(node, LACONIC_WIRE_SELECT, LACONIC_WIRE_COMMAND_SELECT, status, 0, 0);
}
