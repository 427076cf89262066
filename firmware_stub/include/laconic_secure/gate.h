/* Lets to a node only what the holder of the key sends: it stands between a port and laconic_node_on_frame().
 *
 * Frames of the rig are full, so the code of each follows in a frame of its own (SecOC's cryptographic PDU) of 8
 * bytes, on the identifier behind all others, base + 31:
 *
 *     byte 0    offset of the frame that it belongs to
 *     byte 1    freshness, its lower 8 bits
 *     bytes 2…  code, its upper 48 bits, over base + offset, the frame's data and the freshness
 *
 * The upper half of the freshness is the nonce of the node's last CHALLENGE, which differs at each power-up and OPEN;
 * the lower one counts the frames that were sent since. So nothing that was ever recorded passes again, and nobody
 * stores anything. After 2³² − 1 frames the count is used up, and the rig must begin a new session: a count that went
 * on would become another nonce, and the next CHALLENGE would make recorded frames pass. HELLO passes without a code:
 * it only asks for CHALLENGE. Frames for others (drives) pass as they are. */
#ifndef LACONIC_SECURE_GATE_H
#define LACONIC_SECURE_GATE_H

#include "laconic_node/frame.h"
#include "laconic_secure/secoc.h"

#define LACONIC_GATE_OFFSET 31U /* of the identifier of codes */

typedef struct laconic_gate {
    laconic_cmac_key key;
    uint32_t id_base;
    uint64_t freshness;                       /* of the last frame that passed, or was sealed         */
    bool waits;                               /* `held` waits for its code                            */
    laconic_frame held;                       /* the last frame of the rig                            */
    uint32_t refused[LACONIC_SECOC_STATUSES]; /* frames by reason; [OK]: those that passed            */
    uint32_t bare;                            /* frames that came without a code, or codes without one */
} laconic_gate;

void laconic_gate_init(laconic_gate *gate, uint32_t id_base, const uint8_t key[LACONIC_AES_BYTES]);

/* A frame from the bus. True: *out is to be given to the node. */
bool laconic_gate_take(laconic_gate *gate, const laconic_frame *frame, laconic_frame *out);

/* To be told of each frame that the node sends: a CHALLENGE begins a new freshness. */
void laconic_gate_sent(laconic_gate *gate, const laconic_frame *frame);

/* The rig's side: the frame that must follow this one. False iff none must, or there is none: laconic_gate_is_spent(),
 * or a frame whose length no frame has. */
bool laconic_gate_seal(laconic_gate *gate, const laconic_frame *frame, laconic_frame *code);

/* True iff this frame needs a code, and all that follow the last CHALLENGE have been used. */
bool laconic_gate_is_spent(const laconic_gate *gate, const laconic_frame *frame);

/* A port with another definition than gate.c does not link (laconic_node/build.h). */
#if LACONIC_NODE_CAN_FD
#define LACONIC_GATE_BUILT laconic_gate_built_with_LACONIC_NODE_CAN_FD_1
#else
#define LACONIC_GATE_BUILT laconic_gate_built_with_LACONIC_NODE_CAN_FD_0
#endif
void LACONIC_GATE_BUILT(void);
#define laconic_gate_init(...) (LACONIC_GATE_BUILT(), laconic_gate_init(__VA_ARGS__))

#endif
