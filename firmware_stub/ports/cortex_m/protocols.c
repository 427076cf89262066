/* Which protocols of drives an image links. */
#include "protocols.h"

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
