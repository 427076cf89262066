/* The protocols of drives in this image: all, the one that LACONIC_NODE_ONE_PROTOCOL and
 * LACONIC_NODE_ONE_PROTOCOL_NUMBER name, or none in a node without drives, whose configuration has no place for them.
 */
#ifndef PROTOCOLS_H
#define PROTOCOLS_H

#include "laconic_node/node.h"

/* For laconic_node_config.protocol. */
const laconic_drive_protocol *port_protocol(int32_t number);

static inline void port_add_protocols(laconic_node_config *config) {
#if LACONIC_NODE_WITH_DRIVES
    config->protocol = port_protocol;
#else
    (void)config;
#endif
}

#endif
