/* The error estimate beside the plant: it watches the steps where SELECT has chosen ERROR_ESTIMATE. */
#include "node_internal.h"

#if LACONIC_NODE_WITH_ESTIMATE

laconic_status laconic_node_start_estimate(laconic_node *node, laconic_refusal *why) {
    const laconic_plant *plant = &node->plant;
    const laconic_status status =
        laconic_estimate_start(&node->estimate, plant, LACONIC_ESTIMATE_USUAL, laconic_finer_method(plant), why);
    node->estimates = status == LACONIC_OK;
    return status;
}

uint64_t laconic_node_begin_watched(laconic_node *node, int32_t samples, uint64_t steps) {
    return laconic_estimate_before(&node->estimate, &node->plant, node->input, samples, steps);
}

void laconic_node_end_watched(laconic_node *node, uint64_t steps) {
    if (steps > 0) laconic_estimate_after(&node->estimate, &node->plant, steps);
}

void laconic_node_watch_taken(laconic_node *node, const laconic_state *before) {
    const laconic_state now = node->plant.state;
    node->plant.state = *before;
    laconic_node_begin_watched(node, 1, 1);
    node->plant.state = now;
    laconic_node_end_watched(node, 1);
}

/* The pages of one instant: they are read here, and sent from what was read. */
void laconic_node_publish_estimate(laconic_node *node) {
    laconic_estimate_read(&node->estimated, &node->estimate, &node->plant);
    node->estimate_page = 0;
    node->pending |= BIT_OF(LACONIC_WIRE_ERROR_ESTIMATE);
}

#endif
