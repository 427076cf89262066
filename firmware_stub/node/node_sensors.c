/* IMU and encoders beside the plant: they watch it where the vehicle has them or SELECT asks for them. */
#include "node_internal.h"

#if LACONIC_NODE_WITH_SENSORS

bool laconic_node_watches(const laconic_node *node) {
#if LACONIC_NODE_WITH_XCP
    if (node->xcp.senses) return true;
#endif
    return node->has_sensors || (node->send & (LACONIC_NODE_SEND_IMU | LACONIC_NODE_SEND_ENCODER)) != 0 ||
           (node->raw_output.send & RAW_OF_SENSORS) != 0;
}

bool laconic_node_sensors_are_set(const laconic_sensor_settings *settings) {
    const uint8_t *bytes = (const uint8_t *)settings;
    for (size_t k = 0; k < sizeof *settings; k++)
        if (bytes[k] != 0) return true;
    return false;
}

uint8_t laconic_node_encoder_from(const laconic_node *node, int32_t wheel) {
    while (wheel < LACONIC_MAX_WHEELS && node->sensors.settings.encoder[wheel].counts_per_turn == 0) wheel++;
    return (uint8_t)wheel;
}

/* The settings have been checked with the vehicle. A frame that waits to be fetched names an encoder of the settings
 * before: without it the next one takes its place, or the frame falls away. */
void laconic_node_start_sensors(laconic_node *node, const laconic_sensor_settings *settings) {
    node->has_sensors = laconic_node_sensors_are_set(settings);
    (void)laconic_sensors_start(&node->sensors, settings, &node->plant, NULL);
    node->encoder_wheel = laconic_node_encoder_from(node, node->encoder_wheel);
    if (node->encoder_wheel >= LACONIC_MAX_WHEELS) node->pending &= ~BIT_OF(LACONIC_WIRE_ENCODER);
}

void laconic_node_publish_sensors(laconic_node *node, laconic_sensor_outputs *sensed) {
    if (((node->send & SENDS_OF_SENSORS) | (node->raw_output.send & RAW_OF_SENSORS)) == 0) return; /* as most do */
    node->angle_group = 0;
    node->encoder_wheel = laconic_node_encoder_from(node, 0);
    if (node->send & LACONIC_NODE_SEND_WHEEL_ANGLE && node->plant.model.wheel_count > 0)
        node->pending |= BIT_OF(LACONIC_WIRE_WHEEL_ANGLE);
    if (node->send & LACONIC_NODE_SEND_IMU) node->pending |= BIT_OF(LACONIC_WIRE_IMU);
    if (node->send & LACONIC_NODE_SEND_ENCODER && node->encoder_wheel < LACONIC_MAX_WHEELS)
        node->pending |= BIT_OF(LACONIC_WIRE_ENCODER);
    if (node->raw_output.send & RAW_OF_SENSORS)
        laconic_sensors_read(sensed, &node->sensors, &node->plant, &node->input[0]);
}

#else
typedef int laconic_node_has_no_sensors; /* a file without a declaration is no C */
#endif
