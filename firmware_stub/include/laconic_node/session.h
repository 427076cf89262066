/* State of the handshake with a rig and counts of the rig's frames. Internal to the node; protection.h describes
 * their use. */
#ifndef LACONIC_NODE_SESSION_H
#define LACONIC_NODE_SESSION_H

#include "laconic_wire.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct laconic_node_session {
    bool has_nonce;             /* a HELLO has come since power-up                                     */
    bool open;                  /* an OPEN has been accepted since power-up                            */
    uint8_t request;            /* of the last HELLO                                                   */
    uint32_t nonce, last_nonce; /* for the next OPEN; of the last accepted OPEN                        */
    uint32_t number, key, run_key;
    /* of the last right frame, behind those of all nodes that of STEERING; 0: none since OPEN or START               */
    uint32_t count[LACONIC_WIRE_RIG_OFFSETS + LACONIC_NODE_WITH_HINGES];
    uint32_t armed, deaf; /* motion frames, bit = offset: the last one was right; was refused    */
} laconic_node_session;

#endif
