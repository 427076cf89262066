/* The methods in this image. */
#ifndef METHODS_H
#define METHODS_H

#include "laconic/laconic.h"

/* For laconic_node_config.method. */
const laconic_method *port_method(int32_t number);

#endif
