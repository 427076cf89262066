/* What the node's proofs know of numbers and frames: nothing. */
#ifndef LACONIC_PROOF_ANY_FRAME_H
#define LACONIC_PROOF_ANY_FRAME_H

#include "laconic_node/frame.h"

#include "__fc_builtin.h"

#define ANYTHING(thing) Frama_C_make_unknown((char *)&(thing), sizeof(thing))
#define ANY_BOOL() ((bool)Frama_C_interval(0, 1))
#define ANY_WORD() Frama_C_unsigned_int_interval(0, 0xFFFFFFFFU)

static laconic_frame frame;

/* As a port makes it: at most so many bytes as a frame holds. */
static void any_frame(void) {
    ANYTHING(frame);
    frame.extended = ANY_BOOL();
    frame.remote = ANY_BOOL();
    frame.fd = ANY_BOOL();
    frame.bit_rate_switch = ANY_BOOL();
    frame.length = Frama_C_unsigned_char_interval(0, LACONIC_FRAME_BYTES);
}

#endif
