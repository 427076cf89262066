/* One CAN frame, classic or FD. */
#ifndef LACONIC_NODE_FRAME_H
#define LACONIC_NODE_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#ifndef LACONIC_NODE_CAN_FD
#define LACONIC_NODE_CAN_FD 1 /* 0 leaves out the code and the memory for CAN FD */
#endif
#if LACONIC_NODE_CAN_FD
#define LACONIC_FRAME_BYTES 64
#else
#define LACONIC_FRAME_BYTES 8
#endif

typedef struct laconic_frame {
    uint32_t id;
    uint8_t length; /* bytes, not DLC code */
    bool extended;  /* 29-bit identifier   */
    bool remote;
    bool fd;
    bool bit_rate_switch;
    uint8_t data[LACONIC_FRAME_BYTES];
} laconic_frame;

/* True iff the frame has a length that its kind allows and this build has room for. Code that reads or writes the bytes
 * of a frame from outside asks first. */
static inline bool laconic_frame_fits(const laconic_frame *frame) {
    return frame->length <= (LACONIC_NODE_CAN_FD && frame->fd ? LACONIC_FRAME_BYTES : 8);
}

#endif
