/* What a port and the node must be compiled with alike, since it changes structs, as laconic/build.h has it for the
 * core: each definition is in the name of an empty function, and a port with another one does not link. Part of
 * node.h. */
#ifndef LACONIC_NODE_BUILD_H
#define LACONIC_NODE_BUILD_H

#include "laconic/laconic.h"
#include "laconic_drives/settings.h"
#include "laconic_node/frame.h"
#include "laconic_wire.h"

#if LACONIC_NODE_CAN_FD
#define LACONIC_NODE_BUILT_CAN_FD laconic_node_built_with_LACONIC_NODE_CAN_FD_1
#else
#define LACONIC_NODE_BUILT_CAN_FD laconic_node_built_with_LACONIC_NODE_CAN_FD_0
#endif
#if LACONIC_NODE_WITH_DRIVES
#define LACONIC_NODE_BUILT_DRIVES laconic_node_built_with_LACONIC_NODE_WITH_DRIVES_1
#else
#define LACONIC_NODE_BUILT_DRIVES laconic_node_built_with_LACONIC_NODE_WITH_DRIVES_0
#endif
#if LACONIC_NODE_DRIVES_ONLY
#define LACONIC_NODE_BUILT_DRIVES_ONLY laconic_node_built_with_LACONIC_NODE_DRIVES_ONLY_1
#else
#define LACONIC_NODE_BUILT_DRIVES_ONLY laconic_node_built_with_LACONIC_NODE_DRIVES_ONLY_0
#endif
#if LACONIC_NODE_WITH_SENSORS && LACONIC_NODE_WITH_XCP /* one name, since a node without both has no call more */
#define LACONIC_NODE_BUILT_SENSORS laconic_node_built_with_LACONIC_NODE_WITH_SENSORS_1_and_LACONIC_NODE_WITH_XCP_1
#elif LACONIC_NODE_WITH_SENSORS
#define LACONIC_NODE_BUILT_SENSORS laconic_node_built_with_LACONIC_NODE_WITH_SENSORS_1_and_LACONIC_NODE_WITH_XCP_0
#elif LACONIC_NODE_WITH_XCP
#define LACONIC_NODE_BUILT_SENSORS laconic_node_built_with_LACONIC_NODE_WITH_SENSORS_0_and_LACONIC_NODE_WITH_XCP_1
#else
#define LACONIC_NODE_BUILT_SENSORS laconic_node_built_with_LACONIC_NODE_WITH_SENSORS_0_and_LACONIC_NODE_WITH_XCP_0
#endif
#if LACONIC_NODE_WITH_SLIP && LACONIC_NODE_WITH_ESTIMATE
#define LACONIC_NODE_BUILT_ESTIMATE \
    LACONIC_JOINED(laconic_node_built_with_ESTIMATE_1_and_HINGES_1_and_SLIP_1_of_bodies_, LACONIC_MAX_BODIES)
#elif LACONIC_NODE_WITH_SLIP
#define LACONIC_NODE_BUILT_ESTIMATE \
    LACONIC_JOINED(laconic_node_built_with_ESTIMATE_0_and_HINGES_1_and_SLIP_1_of_bodies_, LACONIC_MAX_BODIES)
#elif LACONIC_NODE_WITH_HINGES && LACONIC_NODE_WITH_ESTIMATE /* one name, since a node without both has no call more */
#define LACONIC_NODE_BUILT_ESTIMATE \
    LACONIC_JOINED(laconic_node_built_with_ESTIMATE_1_and_HINGES_1_of_bodies_, LACONIC_MAX_BODIES)
#elif LACONIC_NODE_WITH_HINGES
#define LACONIC_NODE_BUILT_ESTIMATE \
    LACONIC_JOINED(laconic_node_built_with_ESTIMATE_0_and_HINGES_1_of_bodies_, LACONIC_MAX_BODIES)
#elif LACONIC_NODE_WITH_ESTIMATE
#define LACONIC_NODE_BUILT_ESTIMATE laconic_node_built_with_LACONIC_NODE_WITH_ESTIMATE_1
#else
#define LACONIC_NODE_BUILT_ESTIMATE laconic_node_built_with_LACONIC_NODE_WITH_ESTIMATE_0
#endif
#define LACONIC_NODE_BUILT_AXIS_BYTES \
    LACONIC_JOINED(laconic_node_built_with_LACONIC_NODE_AXIS_BYTES_, LACONIC_NODE_AXIS_BYTES)

#define LACONIC_NODE_BUILT(X) \
    X(LACONIC_NODE_BUILT_CAN_FD) \
    X(LACONIC_NODE_BUILT_DRIVES) \
    X(LACONIC_NODE_BUILT_DRIVES_ONLY) \
    X(LACONIC_NODE_BUILT_SENSORS) \
    X(LACONIC_NODE_BUILT_ESTIMATE) \
    X(LACONIC_NODE_BUILT_AXIS_BYTES)

LACONIC_NODE_BUILT(LACONIC_DECLARE_BUILT)

#define LACONIC_NODE_CALL_BUILT(name) name();
static inline void laconic_check_node_build(void){LACONIC_NODE_BUILT(LACONIC_NODE_CALL_BUILT)
                                                      LACONIC_BUILT(LACONIC_NODE_CALL_BUILT)}

#ifndef LACONIC_IN_CORE /* sources that are compiled together with the core, as those of an FMU */
#define laconic_node_init(...) (laconic_check_node_build(), laconic_node_init(__VA_ARGS__))
#endif

#endif
