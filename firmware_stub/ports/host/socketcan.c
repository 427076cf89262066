/* The node on a CAN interface of Linux (SocketCAN). */
#define _GNU_SOURCE
#include "socketcan.h"

#include <errno.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

enum { FRAMES_AT_ONCE = 64 }; /* then the node is stepped, so that a full bus does not make it late */

/* --------------------------------------------------------------------------------- frames -- */

size_t socketcan_put(struct canfd_frame *to, const laconic_frame *frame) {
    memset(to, 0, sizeof *to);
    if (!laconic_frame_fits(frame)) return 0;
    to->can_id = frame->id | (frame->extended ? CAN_EFF_FLAG : 0U) | (frame->remote ? CAN_RTR_FLAG : 0U);
    to->len = frame->length;
    if (!frame->remote) memcpy(to->data, frame->data, frame->length);
    if (!frame->fd) return CAN_MTU; /* a struct can_frame has the same members at the same places */
    to->flags = frame->bit_rate_switch ? CANFD_BRS : 0;
    return CANFD_MTU;
}

bool socketcan_take(laconic_frame *frame, const struct canfd_frame *from, size_t size) {
    const bool fd = size == CANFD_MTU;
    if ((!fd && size != CAN_MTU) || from->can_id & CAN_ERR_FLAG) return false;
    if (from->len > (fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN) || (fd && !LACONIC_NODE_CAN_FD)) return false;
    memset(frame, 0, sizeof *frame);
    frame->extended = (from->can_id & CAN_EFF_FLAG) != 0;
    frame->remote = !fd && (from->can_id & CAN_RTR_FLAG) != 0;
    frame->id = from->can_id & (frame->extended ? CAN_EFF_MASK : CAN_SFF_MASK);
    frame->length = from->len;
    frame->fd = fd;
    frame->bit_rate_switch = fd && (from->flags & CANFD_BRS) != 0;
    if (!frame->remote) memcpy(frame->data, from->data, from->len);
    return true;
}

/* ---------------------------------------------------------------------------------- rounds -- */

/* Whether a call that failed shall simply be made again later. */
static bool is_passing(int error) {
    return error == EAGAIN || error == EWOULDBLOCK || error == EINTR || error == ENOBUFS;
}

static void hand_over(const socketcan_port *port, const laconic_frame *frame, uint32_t now_us) {
    if (port->integrity != NULL)
        laconic_integrity_on_frame(port->integrity, port->node, frame, now_us);
    else
        laconic_node_on_frame(port->node, frame, now_us);
}

static bool fetch(const socketcan_port *port, laconic_frame *frame) {
    if (port->integrity != NULL) return laconic_integrity_next_frame(port->integrity, port->node, frame);
    return laconic_node_next_frame(port->node, frame);
}

static bool receive(const socketcan_port *port, uint32_t now_us) {
    struct canfd_frame raw;
    laconic_frame frame;
    for (int k = 0; k < FRAMES_AT_ONCE; k++) {
        const ssize_t size = recv(port->socket, &raw, sizeof raw, MSG_DONTWAIT);
        if (size < 0) return is_passing(errno);
        if (socketcan_take(&frame, &raw, (size_t)size) &&
            (port->gate == NULL || laconic_gate_take(port->gate, &frame, &frame)))
            hand_over(port, &frame, now_us);
    }
    return true;
}

static bool transmit(socketcan_port *port) {
    laconic_frame frame;
    for (;;) {
        if (!port->waits) {
            if (!fetch(port, &frame)) return true;
            if (port->gate != NULL) laconic_gate_sent(port->gate, &frame);
            port->unsent_size = socketcan_put(&port->unsent, &frame);
            if (port->unsent_size == 0) continue;
        }
        port->waits = send(port->socket, &port->unsent, port->unsent_size, MSG_DONTWAIT | MSG_NOSIGNAL) < 0;
        if (port->waits) return is_passing(errno);
    }
}

bool socketcan_round(socketcan_port *port, uint32_t now_us) {
    if (!receive(port, now_us)) return false;
    if (port->integrity != NULL)
        laconic_integrity_on_tick(port->integrity, port->node, now_us);
    else
        laconic_node_on_tick(port->node, now_us);
    return transmit(port);
}

/* While the kernel has no room, POLLOUT may be there all the same (its queue is the interface's, ENOBUFS): a
 * millisecond passes before the next try. */
static void wait_for_work(const socketcan_port *port, uint32_t idle_us) {
    const uint32_t most_us = port->waits && idle_us > 1000U ? 1000U : idle_us;
    const struct timespec timeout = {most_us / 1000000U, (long)(most_us % 1000000U) * 1000L};
    struct pollfd fd = {port->socket, POLLIN, 0};
    ppoll(&fd, 1, &timeout, NULL);
}

void socketcan_serve(socketcan_port *port, uint32_t (*now_us)(void)) {
    do {
        wait_for_work(port, laconic_node_idle_us(port->node, now_us()));
    } while (socketcan_round(port, now_us()));
}

/* --------------------------------------------------------------------------------- opening -- */

static bool bind_to(int number, const char *interface) {
    const int takes_fd = LACONIC_NODE_CAN_FD != 0;
    struct ifreq request = {.ifr_ifindex = 0};
    struct sockaddr_can address = {.can_family = AF_CAN};
    if (strlen(interface) >= sizeof request.ifr_name) {
        errno = ENODEV;
        return false;
    }
    memcpy(request.ifr_name, interface, strlen(interface));
    if (ioctl(number, SIOCGIFINDEX, &request) != 0) return false;
    address.can_ifindex = request.ifr_ifindex;
    return setsockopt(number, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &takes_fd, sizeof takes_fd) == 0 &&
           bind(number, (struct sockaddr *)&address, sizeof address) == 0;
}

int socketcan_open(const char *interface) {
    const int number = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK, CAN_RAW);
    if (number < 0 || bind_to(number, interface)) return number;
    const int error = errno;
    close(number);
    errno = error;
    return -1;
}
