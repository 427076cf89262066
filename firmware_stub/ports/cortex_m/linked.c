/* Which methods and protocols of drives an image links. */
#include "linked.h"

const laconic_method *port_method(int32_t number) {
#ifdef LACONIC_NODE_ONE_METHOD
    return number == LACONIC_NODE_ONE_METHOD_NUMBER ? &LACONIC_NODE_ONE_METHOD : NULL;
#else
    return laconic_method_by_number(number);
#endif
}

const laconic_drive_protocol *port_protocol(int32_t number) {
#if !LACONIC_NODE_WITH_DRIVES
    (void)number;
    return NULL;
#elif defined(LACONIC_NODE_ONE_PROTOCOL)
    return number == LACONIC_NODE_ONE_PROTOCOL_NUMBER ? &LACONIC_NODE_ONE_PROTOCOL : NULL;
#else
    return laconic_drive_protocol_by_number(number);
#endif
}
