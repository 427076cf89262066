/* The node on a CAN interface of Linux (SocketCAN): frames to and from the kernel's structs, and one round of the node
 * on such a socket. */
#ifndef LACONIC_HOST_SOCKETCAN_H
#define LACONIC_HOST_SOCKETCAN_H

#include "laconic_node/integrity.h"
#include "laconic_secure/gate.h"

#include <linux/can.h>

/* The frame as the kernel takes it. Returns how many bytes are to be written: CAN_MTU or CANFD_MTU, or 0 iff the frame
 * is longer than its kind allows or this build has room for. */
size_t socketcan_put(struct canfd_frame *to, const laconic_frame *frame);

/* What was read, `size` bytes, as a frame. False iff it is not a frame of a bus (an error frame, or another size), or
 * one of CAN FD in a build without it. */
bool socketcan_take(laconic_frame *frame, const struct canfd_frame *from, size_t size);

/* A node on a socket that does not block and keeps the ends of frames. */
typedef struct socketcan_port {
    laconic_node *node;
    laconic_gate *gate;           /* NULL: everybody commands          */
    laconic_integrity *integrity; /* NULL: its memory is not watched   */
    int socket;
    bool waits; /* the kernel had no room for `unsent` */
    struct canfd_frame unsent;
    size_t unsent_size;
} socketcan_port;

/* The socket of an interface such as "can0", which is up. Returns -1 with errno where there is none, or it cannot do
 * CAN FD and this build does. */
int socketcan_open(const char *interface);

/* Takes the frames that wait, one period or step of the node, and sends its frames as far as the kernel takes them; the
 * rest are made later, from newer values. False, with errno, iff the interface has gone. */
bool socketcan_round(socketcan_port *port, uint32_t now_us);

/* Rounds until the interface has gone; errno tells why. `now_us`: the clock. */
void socketcan_serve(socketcan_port *port, uint32_t (*now_us)(void));

#endif
