/* Frames that configure the node: CONTROL, PARAMETER, COMMIT and SELECT, each answered by RESULT. */
#include "node_internal.h"

#include "laconic_dbc.h"

#include <string.h>

void laconic_node_answer_again(laconic_node *node, uint8_t offset) {
    node->answers_due = (uint16_t)(node->answers_due | BIT_OF(offset));
    node->pending |= BIT_OF(LACONIC_WIRE_RESULT);
}

void laconic_node_answer(laconic_node *node, uint8_t offset, laconic_node_result answer) {
    answer.request = node->answer[offset].request;
    node->answer[offset] = answer;
    laconic_node_answer_again(node, offset);
    if (answer.status != 0) count(&node->counters.refused);
}

static uint8_t begin(laconic_node *node) {
    laconic_loader_begin(&node->loader);
    return 0;
}

/* Begins a run with a new key: motion frames that were sent for an earlier run no longer pass. */
static uint8_t start(laconic_node *node, uint8_t state) {
    if (!may_start(node)) return LACONIC_WIRE_STATUS_WRONG_STATE;
    laconic_node_begin_run(node);
    if (!LACONIC_NODE_DRIVES_ONLY) laconic_raw_restart(&node->raw_input);
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

static uint8_t start_lockstep(laconic_node *node) {
    return LACONIC_NODE_DRIVES_ONLY ? LACONIC_WIRE_STATUS_NOT_SUPPORTED : start(node, LACONIC_WIRE_STATE_LOCKSTEP);
}

static uint8_t start_free_run(laconic_node *node, const struct laconic_dbc_control_t *frame, uint32_t now_us) {
    laconic_node_free_run run = {0};
    if (LACONIC_NODE_DRIVES_ONLY) return LACONIC_WIRE_STATUS_NOT_SUPPORTED;
    if (!may_start(node)) return LACONIC_WIRE_STATUS_WRONG_STATE;
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
    if (!LACONIC_NODE_DRIVES_ONLY) node->lockstep.steps_due = 0;
    node->session.deaf = 0;
    laconic_node_clear_inputs(node);
    return 0;
}

void laconic_node_make_idle(laconic_node *node) {
    stop(node);
    laconic_loader_begin(&node->loader);
    node->send = 0;
    if (!LACONIC_NODE_DRIVES_ONLY) node->raw_input.take = 0;
    node->raw_output.send = 0;
#if LACONIC_NODE_WITH_HINGES
    laconic_node_deselect_hinges(node);
#endif
#if LACONIC_NODE_WITH_ESTIMATE
    node->estimates = false;
#endif
    node->answers_due = 0;
    node->pending = 0;
}

static uint8_t reset(laconic_node *node, uint8_t *field, uint8_t *item) {
    laconic_refusal why = {0};
    if (!has_model(node)) return LACONIC_WIRE_STATUS_WRONG_STATE;
#if LACONIC_NODE_WITH_HINGES
    laconic_status status = has_hinges(node) ? laconic_node_restart_hinges(node, &why)
                                             : laconic_plant_restart(&node->plant, &node->start, &why);
#else
    laconic_status status = laconic_plant_restart(&node->plant, &node->start, &why);
#endif
#if LACONIC_NODE_WITH_SENSORS
    if (!has_hinges(node)) laconic_node_start_sensors(node, &node->sensors.settings);
#endif
#if LACONIC_NODE_WITH_ESTIMATE
    if (estimates(node) && status == LACONIC_OK) status = laconic_node_start_estimate(node, &why);
#endif
    stop(node);
    node->state = LACONIC_WIRE_STATE_READY;
    memset(&node->counters, 0, sizeof node->counters);
    *field = (uint8_t)why.field;
    *item = (uint8_t)why.item;
    return (uint8_t)status;
}

laconic_node_result laconic_node_control(laconic_node *node, const uint8_t *data, uint32_t now_us) {
    struct laconic_dbc_control_t frame;
    laconic_node_result answer = {0};
    laconic_dbc_control_unpack(&frame, data, 8);
    answer.command = frame.command;
    switch (frame.command) {
    case LACONIC_WIRE_COMMAND_BEGIN: answer.status = begin(node); break;
    case LACONIC_WIRE_COMMAND_START_LOCKSTEP: answer.status = start_lockstep(node); break;
    case LACONIC_WIRE_COMMAND_START_FREE_RUN: answer.status = start_free_run(node, &frame, now_us); break;
#if LACONIC_NODE_WITH_DRIVES
    case LACONIC_WIRE_COMMAND_START_DRIVES: answer.status = start_drives(node, now_us, &answer.field); break;
#endif
    case LACONIC_WIRE_COMMAND_STOP: answer.status = stop(node); break;
    case LACONIC_WIRE_COMMAND_RESET: answer.status = reset(node, &answer.field, &answer.item); break;
    default: answer.status = LACONIC_WIRE_STATUS_UNKNOWN_COMMAND; break;
    }
    return answer;
}

/* Each PARAMETER has its own answer, so that the rig notices a lost one at once. The first refusal stays until
 * BEGIN. */
laconic_node_result laconic_node_parameter(laconic_node *node, const uint8_t *data) {
    const laconic_loader *loader = &node->loader;
#if LACONIC_NODE_WITH_DRIVES && LACONIC_NODE_WITH_DRIVE_FAULTS
    if (data[2] == LACONIC_WIRE_FIELD_DRIVE_FAULTS) { /* an order for now, no number of a vehicle */
        const laconic_node_result outcome = {0, LACONIC_WIRE_COMMAND_PARAMETER, laconic_node_order_drive(node, data),
                                             data[2], data[3]};
        return outcome;
    }
#endif
    laconic_loader_take(&node->loader, data);
    const laconic_node_result answer = {0, LACONIC_WIRE_COMMAND_PARAMETER, loader->status, loader->field, loader->item};
    return answer;
}

/* A vehicle that was loaded waits for START, with no inputs. */
static uint8_t take_loaded(laconic_node *node) {
    node->start = node->loader.parameters.start;
#if LACONIC_NODE_WITH_DRIVES
    node->drive_plan = node->loader.parameters.drives;
#endif
#if LACONIC_NODE_WITH_XCP
    laconic_xcp_adopt(node, &node->loader.parameters.vehicle);
#endif
    node->model_is_wrong = false;
    node->state = LACONIC_WIRE_STATE_READY;
    laconic_node_clear_inputs(node);
    return 0;
}

/* The loaded parameters become the vehicle, or nothing changes. */
static uint8_t adopt(laconic_node *node, uint8_t *field, uint8_t *item) {
    const laconic_parameters *new = &node->loader.parameters;
    const laconic_method *method = node->config.method(new->method);
    laconic_refusal why = {0};
#if LACONIC_NODE_WITH_HINGES
    if (new->bodies.body_count != 0) {
        const uint8_t of_hinges = laconic_node_adopt_hinges(node, field, item);
        return of_hinges != 0 ? of_hinges : take_loaded(node);
    }
#endif
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
#if LACONIC_NODE_WITH_ESTIMATE
    if (status == LACONIC_OK) node->estimates = false; /* of the vehicle before; SELECT begins another */
#endif
    *field = (uint8_t)why.field;
    *item = (uint8_t)why.item;
    if (status != LACONIC_OK) return (uint8_t)status;
#if LACONIC_NODE_WITH_SENSORS
    laconic_node_start_sensors(node, &new->sensors);
#endif
#if LACONIC_NODE_WITH_HINGES
    laconic_node_drop_hinges(node);
#endif
    return take_loaded(node);
}

laconic_node_result laconic_node_commit(laconic_node *node, const uint8_t *data) {
    laconic_node_result answer = {.command = LACONIC_WIRE_COMMAND_COMMIT, .status = LACONIC_WIRE_STATUS_WRONG_STATE};
    if (!is_running(node))
        answer.status =
            laconic_loader_check(&node->loader, word16(data + 2), word32(data + 4), &answer.field, &answer.item);
    if (answer.status == 0) answer.status = adopt(node, &answer.field, &answer.item);
    return answer;
}

#if LACONIC_NODE_WITH_ESTIMATE
#define ESTIMATE_LEFT_OUT 0U

/* The estimate begins here, with no error; a vehicle must be there. */
static uint8_t select_estimate(laconic_node *node, bool is_on, laconic_node_result *answer) {
    laconic_refusal why = {0};
    if (!is_on) node->estimates = false;
    if (!is_on) return 0;
    if (!has_model(node)) return LACONIC_WIRE_STATUS_WRONG_STATE;
    const laconic_status status = laconic_node_start_estimate(node, &why);
    answer->field = (uint8_t)why.field;
    answer->item = (uint8_t)why.item;
    return (uint8_t)status;
}
#else
#define ESTIMATE_LEFT_OUT SELECTS_ESTIMATE
#endif

laconic_node_result laconic_node_select(laconic_node *node, const uint8_t *data) {
    laconic_node_result answer = {.command = LACONIC_WIRE_COMMAND_SELECT};
    const uint8_t raw_fd = data[3] >> 7;
    const uint8_t raw =
        (uint8_t)((data[3] & 0x7FU) | ((uint32_t)data[4] << 3 & LACONIC_RAW_HELD_TORQUE)); /* its bit 4 */
    if (listens_to_voltages(node)) {
        answer.status = LACONIC_WIRE_STATUS_WRONG_STATE;
    } else if (((raw_fd || data[2] & LACONIC_NODE_SEND_STATE_FD) && !speaks_fd(node)) ||
#if LACONIC_NODE_WITH_HINGES
               !laconic_node_may_select_hinges(node, data) ||
#endif
               ((data[2] & SENDS_LEFT_OUT) | (raw & RAW_LEFT_OUT) | (data[4] & (TAKES_LEFT_OUT | ESTIMATE_LEFT_OUT))) !=
                   0) {
        answer.status = LACONIC_WIRE_STATUS_NOT_SUPPORTED;
    } else {
#if LACONIC_NODE_WITH_ESTIMATE
        answer.status = select_estimate(node, (data[4] & SELECTS_ESTIMATE) != 0, &answer);
        if (answer.status != 0) return answer;
#endif
        node->send = data[2];
        node->raw_fd = raw_fd != 0;
        node->raw_output.send = raw;
#if LACONIC_NODE_WITH_HINGES
        laconic_node_select_hinges(node, data);
#endif
        if (!LACONIC_NODE_DRIVES_ONLY) node->raw_input.take = data[4] & LACONIC_RAW_TAKES;
        laconic_node_clear_inputs(node);
    }
    return answer;
}
