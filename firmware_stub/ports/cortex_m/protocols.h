/* The protocols of drives in this image. */
#ifndef PROTOCOLS_H
#define PROTOCOLS_H

#include "laconic_drives/protocol.h"

/* For laconic_node_config.protocol. */
const laconic_drive_protocol *port_protocol(int32_t number);

#endif
