/* Steps in lockstep and in free run, and the watchdog. */
#include "node_internal.h"

#include <string.h>

void laconic_node_clear_inputs(laconic_node *node) {
    memset(node->input, 0, sizeof node->input);
#if LACONIC_NODE_WITH_HINGES
    if (has_hinges(node)) laconic_node_clear_hinge_inputs(node);
#endif
    if (!LACONIC_NODE_DRIVES_ONLY) laconic_raw_restart(&node->raw_input);
}

/* Makes the frames that SELECT has chosen due, with outputs of the present state. */
void laconic_node_publish(laconic_node *node) {
    if (node->send & LACONIC_NODE_SEND_NU) node->pending |= BIT_OF(LACONIC_WIRE_NU);
    if (node->send & LACONIC_NODE_SEND_POSE) node->pending |= BIT_OF(LACONIC_WIRE_POSE);
    if (node->send & LACONIC_NODE_SEND_WHEEL_SPEED && node->plant.model.wheel_count > 0)
        node->pending |= BIT_OF(LACONIC_WIRE_WHEEL_SPEED);
    if (node->send & LACONIC_NODE_SEND_STATE_FD) node->pending |= BIT_OF(LACONIC_WIRE_STATE_FD);
    node->wheel_group = 0;
#if LACONIC_NODE_WITH_HINGES
    if (has_hinges(node)) laconic_node_publish_hinges(node);
#endif
#if LACONIC_NODE_WITH_SENSORS
    laconic_sensor_outputs sensed;
    laconic_node_publish_sensors(node, &sensed);
    const laconic_sensor_outputs *outputs = &sensed;
#else
    const laconic_sensor_outputs *outputs = NULL;
#endif
#if LACONIC_NODE_WITH_HINGES
    if (has_hinges(node))
        laconic_node_collect_hinges(&node->raw_output, node);
    else
#endif
        laconic_raw_collect(&node->raw_output, &node->plant, &node->input[0], outputs);
    if (node->raw_output.size > 0)
        node->pending |= node->raw_fd ? BIT_OF(LACONIC_WIRE_RAW_OUTPUT_FD) : BIT_OF(LACONIC_WIRE_RAW_OUTPUT);
}

void laconic_node_fail(laconic_node *node, const laconic_refusal *why, uint8_t request) {
    if (!LACONIC_NODE_DRIVES_ONLY) node->lockstep.steps_due = 0;
    node->state = LACONIC_WIRE_STATE_FAULT;
    laconic_node_clear_inputs(node);
    const laconic_node_result answer = {0, LACONIC_WIRE_COMMAND_SYNC, (uint8_t)why->status, (uint8_t)why->field,
                                        (uint8_t)why->item};
    node->answer[LACONIC_WIRE_SYNC].request = request;
    laconic_node_answer(node, LACONIC_WIRE_SYNC, answer);
}

static laconic_status step_unwatched(laconic_node *node, uint64_t steps, laconic_refusal *why) {
#if LACONIC_NODE_WITH_HINGES
    if (has_hinges(node)) return laconic_node_step_hinges(node, steps, why);
#endif
#if LACONIC_NODE_WITH_SENSORS
    if (laconic_node_watches(node))
        return laconic_sensors_run(&node->sensors, &node->plant, &node->input[0], steps, why);
#endif
    return laconic_plant_run(&node->plant, &node->input[0], steps, why);
}

/* With an estimate in the parts that it asks for, which changes no bit. */
static laconic_status step(laconic_node *node, uint64_t steps, laconic_refusal *why) {
#if LACONIC_NODE_WITH_ESTIMATE
    laconic_status status = LACONIC_OK;
    while (estimates(node) && steps > 0 && status == LACONIC_OK) {
        const uint64_t now = laconic_node_begin_watched(node, 1, steps), before = node->plant.steps;
        status = step_unwatched(node, now, why);
        laconic_node_end_watched(node, node->plant.steps - before);
        steps -= now;
    }
    if (estimates(node)) return status;
#endif
    return step_unwatched(node, steps, why);
}

static laconic_status step_sampled_unwatched(laconic_node *node, laconic_refusal *why) {
#if LACONIC_NODE_WITH_HINGES
    if (has_hinges(node)) return laconic_node_step_hinges_sampled(node, why);
#endif
#if LACONIC_NODE_WITH_SENSORS
    if (laconic_node_watches(node)) return laconic_sensors_run_sampled(&node->sensors, &node->plant, node->input, why);
#endif
    return laconic_plant_run_sampled(&node->plant, node->input, why);
}

static laconic_status step_sampled(laconic_node *node, laconic_refusal *why) {
#if LACONIC_NODE_WITH_ESTIMATE
    if (estimates(node)) {
        laconic_node_begin_watched(node, 3, 1);
        const laconic_status status = step_sampled_unwatched(node, why);
        laconic_node_end_watched(node, status == LACONIC_OK);
        return status;
    }
#endif
    return step_sampled_unwatched(node, why);
}

void laconic_node_run_lockstep(laconic_node *node) {
    laconic_refusal why = {0};
    uint32_t steps = node->lockstep.steps_due;
    if (steps == 0) return;
    if (steps > LACONIC_NODE_STEPS_PER_TICK) steps = LACONIC_NODE_STEPS_PER_TICK;
#if LACONIC_NODE_WITH_XCP
    steps = laconic_daq_steps(node, steps);
    if (steps == 0) return;
#endif
    const bool sampled = (node->raw_input.take & LACONIC_RAW_SAMPLED) != 0; /* SYNC lets pass one step of these alone */
    const laconic_status status = sampled ? step_sampled(node, &why) : step(node, steps, &why);
    if (status != LACONIC_OK) {
        laconic_node_fail(node, &why, node->lockstep.request);
        return;
    }
#if LACONIC_NODE_WITH_XCP
    laconic_daq_event(node);
#endif
    node->lockstep.steps_due -= steps;
    if (node->lockstep.steps_due == 0) laconic_node_publish(node);
}

/* The watchdog: without new voltages for too long the vehicle coasts without voltage until the rig sends STOP and
 * START. The time of a frame may be later than that of the tick that follows it, so the difference has a sign. */
static void watch(laconic_node *node, uint32_t now_us) {
    const laconic_node_free_run *run = &node->free_run;
    if (node->state != LACONIC_WIRE_STATE_FREE_RUN || run->watchdog_us == 0) return;
    if ((int32_t)(now_us - run->fed_us) <= (int32_t)run->watchdog_us) return;
    node->state = LACONIC_WIRE_STATE_TIMEOUT;
    laconic_node_clear_inputs(node);
}

void laconic_node_begin_periods(laconic_node *node, uint32_t rate_Hz, uint32_t steps_per_period, uint32_t now_us) {
    laconic_node_free_run *run = &node->free_run;
    run->rate_Hz = rate_Hz;
    run->steps_per_period = steps_per_period;
    run->fed_us = now_us;
    run->next_us = now_us + 1000000U / rate_Hz;
    run->next_rest = 1000000U % rate_Hz;
    run->worst_lateness_us = 0;
}

/* No period is ever left out: one that is late is computed late, and counted when it is late by a period or more. */
bool laconic_node_period_is_due(laconic_node *node, uint32_t now_us) {
    laconic_node_free_run *run = &node->free_run;
    const uint32_t late = now_us - run->next_us;
    if ((int32_t)late < 0) return false;
    if (late > run->worst_lateness_us) run->worst_lateness_us = late;
    if (late >= 1000000U / run->rate_Hz) count(&node->counters.late_periods);
    return true;
}

void laconic_node_end_period(laconic_node *node) {
    laconic_node_free_run *run = &node->free_run;
    run->next_us += 1000000U / run->rate_Hz;
    run->next_rest += 1000000U % run->rate_Hz;
    if (run->next_rest >= run->rate_Hz) {
        run->next_rest -= run->rate_Hz;
        run->next_us++;
    }
    laconic_node_publish(node);
}

/* All steps of a period, one by one while a master of XCP measures. */
static laconic_status step_period(laconic_node *node, laconic_refusal *why) {
    uint32_t rest_steps = node->free_run.steps_per_period;
#if LACONIC_NODE_WITH_XCP
    for (; rest_steps > 0 && laconic_daq_runs(&node->xcp); rest_steps--) {
        const laconic_status status = step(node, 1, why);
        if (status != LACONIC_OK) return status;
        laconic_daq_event(node);
    }
    if (rest_steps == 0) return LACONIC_OK;
#endif
    return step(node, rest_steps, why);
}

void laconic_node_run_free(laconic_node *node, uint32_t now_us) {
    laconic_refusal why = {0};
    watch(node, now_us);
    if (!laconic_node_period_is_due(node, now_us)) return;
    const laconic_status status = step_period(node, &why);
    if (status != LACONIC_OK)
        laconic_node_fail(node, &why, 0);
    else
        laconic_node_end_period(node);
}
