/* The methods and the protocols of drives in this image: all, or the one of each that LACONIC_NODE_ONE_METHOD and
 * LACONIC_NODE_ONE_PROTOCOL with their ..._NUMBER name. A node without drives has no protocol, and no place for one in
 * its configuration. */
#ifndef LINKED_H
#define LINKED_H

#include "laconic_node/node.h"

/* For laconic_node_config.method. */
const laconic_method *port_method(int32_t number);

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
