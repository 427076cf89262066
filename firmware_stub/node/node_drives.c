/* Drives between the bus and the wheels: one step of all of them a period. */
#include "node_internal.h"

#if LACONIC_NODE_WITH_DRIVES

static const laconic_drive_protocol *protocol_of(const laconic_node *node, const laconic_drive_plan *plan) {
    const laconic_drive_protocol *protocol =
        node->config.protocol == NULL ? NULL : node->config.protocol(plan->protocol);
    return protocol != NULL && protocol->axis_bytes <= LACONIC_NODE_AXIS_BYTES ? protocol : NULL;
}

uint8_t laconic_node_check_drives(const laconic_node *node, const laconic_drive_plan *plan, int32_t wheel_count,
                                  uint8_t *field, uint8_t *item) {
    laconic_refusal why = {0};
    if (plan->protocol == 0) return 0;
    const laconic_drive_protocol *protocol = protocol_of(node, plan);
    *field = LACONIC_DRIVES_FIELD_DRIVE_PROTOCOL;
    if (protocol == NULL) return LACONIC_WIRE_STATUS_NOT_SUPPORTED;
    const laconic_status status = laconic_drive_plan_check(plan, protocol, wheel_count, &why);
    *field = (uint8_t)why.field;
    *item = (uint8_t)why.item;
    return (uint8_t)status;
}

/* The rate at which one step is a period: 1 to 10,000 Hz, and whole. 0: there is none. */
static uint32_t rate_of(laconic_real step_s) {
    const laconic_real rate_Hz = 1 / step_s;
    const laconic_real slack = (laconic_real)1e-4; /* far more than rounding errors */
    if (!(rate_Hz < (laconic_real)10000.5)) return 0;
    const uint32_t whole = (uint32_t)(rate_Hz + (laconic_real)0.5);
    const laconic_real off = rate_Hz - (laconic_real)whole;
    return off < slack * rate_Hz && off > -slack * rate_Hz ? whole : 0;
}

#if LACONIC_NODE_WITH_HINGES
static void start_with_hinges(laconic_node *node, const laconic_drive_protocol *protocol, uint32_t now_us) {
    laconic_node_hinges *hinges = &node->hinges;
    const laconic_real step_s = hinges->integrator.step_s;
#if LACONIC_NODE_WITH_SLIP
    if (hinges->slips) {
        laconic_drives_start_slipping(&node->drives, &node->drive_plan, protocol, node->axes, &hinges->tree_model,
                                      &hinges->tree, step_s, now_us);
        return;
    }
#endif
    laconic_drives_start_with_hinges(&node->drives, &node->drive_plan, protocol, node->axes, &hinges->model,
                                     &hinges->state, step_s, now_us);
}
#endif

uint8_t laconic_node_start_drives(laconic_node *node, uint32_t now_us, uint8_t *field) {
    const laconic_drive_protocol *protocol = protocol_of(node, &node->drive_plan);
    if (!may_start(node)) return LACONIC_WIRE_STATUS_WRONG_STATE;
    const uint32_t rate_Hz = rate_of(node->plant.integrator.step_s);
    *field = rate_Hz == 0 ? LACONIC_FIELD_STEP : LACONIC_DRIVES_FIELD_DRIVE_PROTOCOL;
    if (rate_Hz == 0) return LACONIC_WIRE_STATUS_OUT_OF_RANGE;
    if (protocol == NULL) return LACONIC_WIRE_STATUS_PARAMETER_MISSING;
    *field = 0;
    laconic_node_clear_inputs(node);
    laconic_node_begin_periods(node, rate_Hz, 1, now_us);
#if LACONIC_NODE_WITH_HINGES
    if (has_hinges(node)) {
        start_with_hinges(node, protocol, now_us);
        return 0;
    }
#endif
    laconic_drives_start(&node->drives, &node->drive_plan, protocol, node->axes, &node->plant, now_us);
    return 0;
}

#if LACONIC_NODE_WITH_HINGES

#if LACONIC_NODE_WITH_SLIP
/* A step of a vehicle that slips, with the brakes by order. */
static laconic_status step_braked(laconic_node *node, laconic_refusal *why) {
    laconic_real other_Nm[LACONIC_DRIVE_AXES];
    laconic_tree_model *model = &node->hinges.tree_model;
    const bool brakes = LACONIC_NODE_WITH_DRIVE_FAULTS && laconic_drives_brakes(&node->drives, other_Nm);
    if (brakes) laconic_drives_exchange_dry_friction(&node->drives, model, other_Nm);
    const laconic_status status = laconic_node_step_hinges(node, 1, why);
    if (brakes) laconic_drives_exchange_dry_friction(&node->drives, model, other_Nm);
    return status;
}

static laconic_status step_tree_by_drives(laconic_node *node, uint32_t now_us, laconic_refusal *why) {
    laconic_node_hinges *hinges = &node->hinges;
    const laconic_tree_state before = hinges->tree;
    laconic_drives_act_with_hinges(&node->drives, &hinges->model, &node->input[0], hinges->input, now_us);
    hinges->input[0] = hinges->input[1];
    const laconic_status status = step_braked(node, why);
    if (status == LACONIC_OK)
        laconic_drives_measure_slipping(&node->drives, &hinges->tree_model, &before, &hinges->tree);
    return status;
}
#endif

static laconic_status step_ideal_by_drives(laconic_node *node, uint32_t now_us, laconic_refusal *why) {
    laconic_node_hinges *hinges = &node->hinges;
    const laconic_articulated_state before = hinges->state;
    laconic_drives_act_with_hinges(&node->drives, &hinges->model, &node->input[0], hinges->input, now_us);
    hinges->changes = true;
    const laconic_status status = laconic_node_step_hinges(node, 1, why);
    if (status == LACONIC_OK)
        laconic_drives_measure_with_hinges(&node->drives, &hinges->model, &before, &hinges->state);
    return status;
}

static laconic_status step_with_hinges(laconic_node *node, uint32_t now_us, laconic_refusal *why) {
#if LACONIC_NODE_WITH_SLIP
    const laconic_status status =
        slips(node) ? step_tree_by_drives(node, now_us, why) : step_ideal_by_drives(node, now_us, why);
#else
    const laconic_status status = step_ideal_by_drives(node, now_us, why);
#endif
    if (status != LACONIC_OK) laconic_drives_off(&node->drives);
    return status;
}
#endif

static laconic_status step_unwatched(laconic_node *node, uint32_t now_us, laconic_refusal *why) {
#if LACONIC_NODE_WITH_HINGES
    if (has_hinges(node)) return step_with_hinges(node, now_us, why);
#endif
#if LACONIC_NODE_WITH_SENSORS
    if (laconic_node_watches(node)) {
        laconic_sensor_moment before;
        laconic_sensors_before(&before, &node->plant);
        const laconic_status status = laconic_drives_step(&node->drives, &node->plant, &node->input[0], now_us, why);
        if (status != LACONIC_OK) return status;
        return laconic_sensors_after(&node->sensors, &node->plant, &node->input[0], &before, why);
    }
#endif
    return laconic_drives_step(&node->drives, &node->plant, &node->input[0], now_us, why);
}

static laconic_status step(laconic_node *node, uint32_t now_us, laconic_refusal *why) {
#if LACONIC_NODE_WITH_ESTIMATE
    if (estimates(node)) {
        const laconic_state before = node->plant.state;
        const laconic_status status = step_unwatched(node, now_us, why);
        if (status == LACONIC_OK) laconic_node_watch_taken(node, &before);
        return status;
    }
#endif
    return step_unwatched(node, now_us, why);
}

/* Whoever reads the torques must miss no step, or his own steps are others from there on: the next one waits until the
 * raw numbers of the last have been sent. */
static bool is_read(const laconic_node *node) {
    const uint32_t raw = BIT_OF(LACONIC_WIRE_RAW_OUTPUT) | BIT_OF(LACONIC_WIRE_RAW_OUTPUT_FD);
    return (node->raw_output.send & LACONIC_RAW_HELD_TORQUE) == 0 || (node->pending & raw) == 0;
}

void laconic_node_run_drives(laconic_node *node, uint32_t now_us) {
    laconic_refusal why = {0};
    if (!is_read(node) || !laconic_node_period_is_due(node, now_us)) return;
    if (step(node, now_us, &why) != LACONIC_OK) {
        laconic_node_fail(node, &why, 0);
        return;
    }
#if LACONIC_NODE_WITH_XCP
    laconic_daq_event(node);
#endif
    laconic_node_end_period(node);
}

uint8_t laconic_node_order_drive(laconic_node *node, const uint8_t *data) {
    const uint32_t orders = word32(data + 4);
    const bool upper_half = (data[1] & 16U) != 0;
    if (!plays_drives(node)) return LACONIC_WIRE_STATUS_WRONG_STATE;
    for (int32_t k = 0; k < node->drives.count; k++) {
        if (node->drives.wheel[k] + 1 != data[3]) continue;
        if (upper_half || (orders & ~LACONIC_DRIVE_ORDERS) != 0) return LACONIC_WIRE_STATUS_OUT_OF_RANGE;
        const bool rolls = has_hinges(node) && !slips(node); /* such wheels hold each other: a brake has no share */
        if (rolls && (orders & LACONIC_DRIVE_ORDER_HELD) != 0) return LACONIC_WIRE_STATUS_NOT_SUPPORTED;
        laconic_drive_order(&node->drives.drive[k], orders);
        return 0;
    }
    return LACONIC_WIRE_STATUS_PARAMETER_UNKNOWN; /* that wheel has no drive */
}

#else
typedef int laconic_node_has_no_drives; /* a file without a declaration is no C */
#endif
