/* SLCAN (Lawicel's ASCII protocol): CAN frames on a serial line, compatible with python-can's interface `slcan`.
 *
 * Understood   O L C open, listen only, close; S0…S8, sxxyy bit rate; t T r R classic frames; d D b B CAN FD frames
 *              (the CANable extension); Y2 Y5 data bit rate; V v N F Z0 Z1 version, number, flags, time stamps.
 * Answered     each line: CR for done, also of a frame; BEL for refused. Frames that the node sends are written as
 *              t/T/d/b lines.
 *
 * The reader gets one byte at a time and keeps one line; it drops a line that is too long, up to its end. */
#ifndef LACONIC_NODE_SLCAN_H
#define LACONIC_NODE_SLCAN_H

#include "laconic_node/frame.h"

#include <stddef.h>

/* "B" + 8 identifier digits + DLC + 64 bytes in hexadecimal + CR */
#define LACONIC_SLCAN_LINE (1 + 8 + 1 + 2 * LACONIC_FRAME_BYTES + 1)

typedef enum laconic_slcan_event {
    LACONIC_SLCAN_NOTHING = 0, /* the line is not complete                                 */
    LACONIC_SLCAN_FRAME,       /* *frame holds a frame, reply[] the answer to its line     */
    LACONIC_SLCAN_REPLY        /* reply[] holds the answer to a command; *frame unchanged  */
} laconic_slcan_event;

typedef struct laconic_slcan {
    bool open;
    bool listen_only;
    char required_rate; /* '0' … '8': with another S command no frame passes; 0: any */
    bool rate_is_wrong; /* the client has chosen another rate: no frame passes        */
    uint16_t length;    /* of the line so far; LACONIC_SLCAN_LINE: too long, drop it               */
    char line[LACONIC_SLCAN_LINE];
    char reply[8]; /* text of the last answer, ends with 0                       */
} laconic_slcan;

void laconic_slcan_init(laconic_slcan *slcan, char required_rate);

/* To be called for each byte received. Returns a frame only while the channel is open and not listen-only. */
laconic_slcan_event laconic_slcan_feed(laconic_slcan *slcan, char byte, laconic_frame *frame);

/* Writes the frame as a line with its CR and returns the length. Returns 0 iff the channel is closed, the rate wrong,
 * or the frame's length is one that its kind of CAN does not have or this build has no room for. */
size_t laconic_slcan_write(const laconic_slcan *slcan, const laconic_frame *frame, char text[LACONIC_SLCAN_LINE]);

/* A port with another definition than slcan.c does not link (build.h). */
#if LACONIC_NODE_CAN_FD
#define LACONIC_SLCAN_BUILT laconic_slcan_built_with_LACONIC_NODE_CAN_FD_1
#else
#define LACONIC_SLCAN_BUILT laconic_slcan_built_with_LACONIC_NODE_CAN_FD_0
#endif
void LACONIC_SLCAN_BUILT(void);
#define laconic_slcan_init(...) (LACONIC_SLCAN_BUILT(), laconic_slcan_init(__VA_ARGS__))

#endif
