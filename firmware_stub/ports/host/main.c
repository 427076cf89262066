/* The node as a process: SLCAN on a TCP socket, so that python-can's `slcan` connects to it as to a board.
 *
 *     laconic-node-double [--port N] [--id-base 0xNNN] [--bitrate N] [--once | --with-parent] [--shared] [--key FILE]
 *     laconic-node-double --socketcan can0 [--id-base 0xNNN] [--key FILE]
 *
 * Prints "listening on 127.0.0.1:PORT" (port 0: any free one). The node keeps its vehicle between clients, as a
 * board does. Like a serial line it has one client at a time; a second one gets a line of text and is disconnected.
 * With --shared its port is a bus: clients are stations that hear each other. Frames to and from the node itself pass
 * among those that have spoken to it, and before anybody has, to all: a controller hears its drives, and XCP. */
#define _GNU_SOURCE
#include "laconic_node/integrity.h"
#include "laconic_secure/gate.h"
#include "laconic_wire.h"
#include "station.h"
#ifdef __linux__
#include "socketcan.h"
#endif

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { BUS_DIED = 1, BAD_INPUT = 2, MOST_STATIONS = 4, LETTERS_WAIT_US = 1000 };

typedef struct options {
    unsigned long port, id_base;
    char rate; /* '0' … '8', 0: any */
    bool once, shared, with_parent;
    const char *interface; /* of SocketCAN, NULL: none */
    const char *key;       /* file, NULL: everybody commands */
} options;

typedef struct board {
    laconic_node node;
    laconic_integrity integrity;
    laconic_gate gate; /* where `guarded` */
    bool guarded;
    station station[MOST_STATIONS];
    int stations;            /* that there is room for: 1, or all with --shared  */
    int refused;             /* socket of the last refused client, -1: none     */
    int clients;             /* so far */
    unsigned long not_taken; /* frames that clients did not read in time */
} board;

static volatile sig_atomic_t is_over;

static void be_over(int number) { is_over = number; }

/* SIGTERM and Ctrl-C are heard while the port waits, and nowhere else. `heard` is the mask for that. */
static void hear_the_end(sigset_t *heard) {
    const struct sigaction action = {.sa_handler = be_over};
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGTERM);
    sigaddset(&signals, SIGINT);
    sigprocmask(SIG_BLOCK, &signals, heard);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGINT, &action, NULL);
}

static const char help[] =
    "usage: laconic-node-double|laconic-node-single [--port N] [--id-base 0xNNN] [--bitrate N] [--once]\n"
    "       [--with-parent] [--shared] [--key FILE] | --socketcan can0 [--key FILE]\n\n"
    "The CAN node as a process, computing in double or single precision: SLCAN on a TCP socket of this machine.\n"
    "Prints \"listening on 127.0.0.1:PORT\" and serves one client at a time until it is ended (Ctrl-C, SIGTERM).\n\n"
    "  --port N         TCP port, 0 to 65535; 0 (default): any free one\n"
    "  --id-base 0xNNN  the node's first CAN identifier, a multiple of 32 up to 0x7E0 (default: 0x%X)\n"
    "  --bitrate N      refuse clients that set another rate, as a real bus would (default: any rate)\n"
    "  --once           end when the first client leaves\n"
    "  --with-parent    end when standard input ends: a pipe of a program that starts the node and may be killed\n"
    "  --shared         serve up to four clients, which hear each other's frames; frames from and to the node itself\n"
    "                   pass only among clients that have sent it one (XCP: among all), and to all until a client has\n"
    "  --socketcan IF   serve a CAN interface of Linux instead, such as can0, which must be up: no port is opened\n"
    "  --key FILE       take commands only with codes by the key in FILE, 32 hexadecimal digits (docs/rig-ports.md)\n"
    "  -h, --help       this text\n"
    "\n"
    "Drive it:  laconic rig SCENE --interface slcan --channel socket://127.0.0.1:PORT\n";

/* BELL is SLCAN's error. The rest is no frame, so a program skips it, but a person can read it. */
static const char occupied[] = "\aoccupied: this line has one client at a time, and another one is on it\r";
static const char occupied_shared[] = "\aoccupied: this port has four clients at most, and four are on it\r";

static int complain(const char *what, const char *remedy) {
    fprintf(stderr, "laconic-node: %s: %s\n", what, remedy);
    return BAD_INPUT;
}

static uint32_t now_us(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (uint32_t)((uint64_t)time.tv_sec * 1000000U + (uint64_t)time.tv_nsec / 1000U);
}

/* Different at each start, so that a recorded handshake does not open a session with a later process. */
static uint32_t nonce_seed(void) {
    uint32_t seed = (uint32_t)time(NULL) ^ (uint32_t)getpid() << 16;
    FILE *noise = fopen("/dev/urandom", "rb");
    if (noise == NULL) return seed;
    if (fread(&seed, sizeof seed, 1, noise) != 1) seed ^= now_us();
    fclose(noise);
    return seed;
}

/* XCP's frames pass to all stations: their master is no rig. A node with a key has codes of the rig there instead. */
static bool is_of_master(const board *port, uint32_t offset) {
    return LACONIC_NODE_WITH_XCP && !port->guarded &&
           (offset == LACONIC_WIRE_XCP_COMMAND || offset == LACONIC_WIRE_XCP_RESPONSE);
}

/* A frame between node and rig. */
static bool is_own(const board *port, const laconic_frame *frame) {
    const uint32_t offset = frame->id - port->node.config.id_base;
    return !frame->extended && offset < LACONIC_NODE_ID_STRIDE && !is_of_master(port, offset);
}

/* Every frame is fetched as long as somebody has room for it; who has none loses it. */
static bool has_room(const board *port) {
    for (int k = 0; k < port->stations; k++)
        if (station_has_room(&port->station[k])) return true;
    return false;
}

static void give(board *port, station *it, const laconic_frame *frame) {
    if (!station_write(it, frame)) port->not_taken++;
}

static void fetch_frames(board *port) {
    laconic_frame frame;
    while (has_room(port) && laconic_integrity_next_frame(&port->integrity, &port->node, &frame)) {
        if (port->guarded) laconic_gate_sent(&port->gate, &frame);
        const bool own = is_own(port, &frame);
        for (int k = 0; k < port->stations; k++)
            if (!own || port->station[k].is_rig) give(port, &port->station[k], &frame);
    }
}

static void step_node(board *port) {
    laconic_integrity_on_tick(&port->integrity, &port->node, now_us());
    fetch_frames(port);
}

/* Before a rig has spoken every station may be one: it waits for the node's sign of life. */
static bool has_rig(const board *port) {
    for (int k = 0; k < port->stations; k++)
        if (port->station[k].speaks) return true;
    return false;
}

static void make_rig(board *port, station *sender) {
    for (int k = 0; k < port->stations && !has_rig(port); k++) port->station[k].is_rig = false;
    sender->is_rig = sender->speaks = true;
}

/* To the node; with a key only what its holder sends. */
static void hand_over(board *port, const laconic_frame *frame) {
    laconic_frame copy = *frame;
    if (!port->guarded || laconic_gate_take(&port->gate, frame, &copy))
        laconic_integrity_on_frame(&port->integrity, &port->node, &copy, now_us());
}

/* A frame of one station goes to the node and to all other stations; what a rig tells the node, to rigs only. */
static void take_frame(board *port, station *sender, const laconic_frame *frame) {
    const bool own = is_own(port, frame);
    if (own) make_rig(port, sender);
    for (int k = 0; k < port->stations; k++)
        if (&port->station[k] != sender && (!own || port->station[k].is_rig)) give(port, &port->station[k], frame);
    hand_over(port, frame);
    step_node(port);
}

static void take_bytes(board *port, station *sender, const char *bytes, ssize_t count) {
    laconic_frame frame;
    for (ssize_t k = 0; k < count; k++) {
        switch (laconic_slcan_feed(&sender->slcan, bytes[k], &frame)) {
        case LACONIC_SLCAN_FRAME:
            station_reply(sender);
            take_frame(port, sender, &frame);
            break;
        case LACONIC_SLCAN_REPLY: station_reply(sender); break;
        default: break;
        }
    }
}

/* Whether a client may send. One alone, as on a serial line, always may. */
static bool may_send(const board *port, const station *client) { return port->stations == 1 || client->letters > 0; }

/* False iff the client has disconnected. Reads all waiting bytes, so that a disconnection is noticed before the next
 * client is refused; at most 16 blocks, since the node must be stepped in time. */
static bool read_client(board *port, station *client) {
    char bytes[STATION_MOST_LETTERS];
    ssize_t count = 1;
    station_earn(client, now_us());
    for (int rounds = 0; rounds < 16 && count > 0 && may_send(port, client); rounds++) {
        count = station_read(client, bytes, port->stations == 1 ? sizeof bytes : client->letters);
        take_bytes(port, client, bytes, count);
        if (port->stations > 1 && count > 0) client->letters -= (size_t)count;
    }
    return count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
}

/* `end`: the number behind the highest one in any set. */
static void watch(int number, fd_set *set, int *end) {
    if (number < 0) return;
    FD_SET(number, set);
    if (number >= *end) *end = number + 1;
}

/* A parent that ends in any way, also by SIGKILL, closes its end of the pipe; what it writes has no meaning. */
static void look_at_parent(int parent) {
    char bytes[256];
    const ssize_t count = read(parent, bytes, sizeof bytes);
    if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) is_over = SIGHUP;
}

/* pselect() waits to the microsecond on every system with POSIX; ppoll() is not everywhere. */
static void wait_for_work(const board *port, int listening, int parent, const sigset_t *heard) {
    uint32_t idle_us = laconic_node_idle_us(&port->node, now_us());
    fd_set readable, writable;
    int end = 0;
    FD_ZERO(&readable);
    FD_ZERO(&writable);
    watch(listening, &readable, &end);
    watch(parent, &readable, &end);
    watch(port->refused, &readable, &end);
    for (int k = 0; k < port->stations; k++) {
        if (may_send(port, &port->station[k]))
            watch(port->station[k].socket, &readable, &end);
        else if (idle_us > LETTERS_WAIT_US)
            idle_us = LETTERS_WAIT_US;
        if (port->station[k].out_count > 0) watch(port->station[k].socket, &writable, &end);
    }
    const struct timespec timeout = {idle_us / 1000000U, (long)(idle_us % 1000000U) * 1000L};
    const int count = pselect(end, &readable, &writable, NULL, &timeout, heard);
    if (parent >= 0 && count > 0 && FD_ISSET(parent, &readable)) look_at_parent(parent);
}

static void send_occupied(const board *port) {
    const char *why = port->stations == 1 ? occupied : occupied_shared;
    (void)send(port->refused, why, strlen(why), MSG_DONTWAIT);
}

/* Accepts a client too many only to send it the reason; without an answer its user would search for another fault. */
static void refuse_second(board *port, int listening) {
    const int second = station_connection(listening);
    if (second < 0) return;
    if (port->refused >= 0) close(port->refused);
    port->refused = second;
    send_occupied(port);
}

/* Sends the reason again when the refused client sends something, since programs often flush a serial line after
 * opening it, and then ends the connection. The socket stays open until the client disconnects: closing it earlier
 * would reset the connection, and the client would lose the text. */
static void answer_refused(board *port) {
    char rest[256];
    const ssize_t count = port->refused < 0 ? -1 : recv(port->refused, rest, sizeof rest, MSG_DONTWAIT);
    if (count > 0) {
        send_occupied(port);
        shutdown(port->refused, SHUT_WR);
    } else if (port->refused >= 0 && (count == 0 || (errno != EAGAIN && errno != EINTR))) {
        close(port->refused);
        port->refused = -1;
    }
}

/* True iff a client has left. */
static bool serve_station(board *port, station *it, int listening, char rate) {
    if (it->socket < 0) {
        station_accept(it, listening, rate);
        it->is_rig = it->socket >= 0 && !has_rig(port);
        port->clients += it->socket >= 0;
        return false;
    }
    if (read_client(port, it)) return false;
    close(it->socket);
    station_clear(it, rate);
    return true;
}

static bool is_full(const board *port) {
    for (int k = 0; k < port->stations; k++)
        if (port->station[k].socket < 0) return false;
    return true;
}

/* Until a signal ends it, with --with-parent the parent does, or with --once the first client leaves. */
static void serve(board *port, int listening, const options *settings) {
    sigset_t heard;
    hear_the_end(&heard);
    port->stations = settings->shared ? MOST_STATIONS : 1;
    port->refused = -1;
    for (int k = 0; k < MOST_STATIONS; k++) {
        port->station[k].room = settings->shared ? STATION_SHARED_ROOM : STATION_OUT_SIZE;
        station_clear(&port->station[k], settings->rate);
    }
    while (!is_over) {
        wait_for_work(port, listening, settings->with_parent ? STDIN_FILENO : -1, &heard);
        const bool was_full = is_full(port);
        for (int k = 0; k < port->stations; k++)
            if (serve_station(port, &port->station[k], listening, settings->rate) && settings->once) return;
        if (was_full && is_full(port)) refuse_second(port, listening);
        answer_refused(port);
        step_node(port);
        for (int k = 0; k < port->stations; k++) station_flush(&port->station[k]);
    }
}

static int open_listener(unsigned long number, unsigned long *port) {
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons((uint16_t)number)};
    socklen_t size = sizeof address;
    const int on = 1;
    const int listening = socket(AF_INET, SOCK_STREAM, 0);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (listening < 0) return -1;
    setsockopt(listening, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (fcntl(listening, F_SETFL, O_NONBLOCK) != 0 || bind(listening, (struct sockaddr *)&address, size) != 0 ||
        listen(listening, 4) != 0 || getsockname(listening, (struct sockaddr *)&address, &size) != 0) {
        close(listening);
        return -1;
    }
    *port = ntohs(address.sin_port);
    return listening;
}

static char rate_letter(unsigned long bitrate) {
    static const unsigned long rates[] = {10000, 20000, 50000, 100000, 125000, 250000, 500000, 800000, 1000000};
    for (size_t k = 0; k < sizeof rates / sizeof rates[0]; k++)
        if (rates[k] == bitrate) return (char)('0' + (char)k);
    return 0;
}

static bool number(const char *text, unsigned long largest, unsigned long *value) {
    char *end;
    errno = 0;
    *value = strtoul(text, &end, 0);
    return errno == 0 && end != text && *end == 0 && *value <= largest;
}

static bool asks_for_help(int count, char **words) {
    for (int k = 1; k < count; k++)
        if (strcmp(words[k], "--help") == 0 || strcmp(words[k], "-h") == 0) return true;
    return false;
}

static int parse(int count, char **words, options *settings) {
    unsigned long rate;
    for (int k = 1; k < count; k++) {
        const char *value = k + 1 < count ? words[k + 1] : "";
        if (strcmp(words[k], "--once") == 0) {
            settings->once = true;
        } else if (strcmp(words[k], "--shared") == 0) {
            settings->shared = true;
        } else if (strcmp(words[k], "--with-parent") == 0) {
            settings->with_parent = true;
        } else if (strcmp(words[k], "--socketcan") == 0) {
            if (*value == 0) return complain("--socketcan", "name a CAN interface, such as can0");
            settings->interface = value;
            k++;
        } else if (strcmp(words[k], "--key") == 0) {
            if (*value == 0) return complain("--key", "name a file with 32 hexadecimal digits");
            settings->key = value;
            k++;
        } else if (strcmp(words[k], "--port") == 0) {
            if (!number(value, 65535, &settings->port)) return complain("--port", "give a number from 0 to 65535");
            k++;
        } else if (strcmp(words[k], "--id-base") == 0) {
            if (!number(value, 0x7E0, &settings->id_base) || settings->id_base % LACONIC_NODE_ID_STRIDE != 0)
                return complain("--id-base", "give a multiple of 32 from 0 to 0x7E0");
            k++;
        } else if (strcmp(words[k], "--bitrate") == 0) {
            settings->rate = number(value, 1000000, &rate) ? rate_letter(rate) : (char)0;
            if (settings->rate == 0) return complain("--bitrate", "give one of SLCAN's rates, such as 500000");
            k++;
        } else {
            return complain(words[k], "unknown option; see --help");
        }
    }
    if (settings->with_parent && settings->interface != NULL)
        return complain("--with-parent", "watches a node on a port; leave it out with --socketcan");
    return 0;
}

/* 32 hexadecimal digits, with blanks around them at most. */
static bool read_key(const char *name, uint8_t key[LACONIC_AES_BYTES]) {
    char text[2 * LACONIC_AES_BYTES + 8];
    FILE *file = fopen(name, "r");
    if (file == NULL) return false;
    const size_t length = fread(text, 1, sizeof text - 1, file);
    (void)fclose(file);
    text[length] = '\0';
    for (size_t k = 0; k < LACONIC_AES_BYTES; k++) {
        unsigned byte;
        if (strspn(text + 2 * k, "0123456789abcdefABCDEF") < 2 || sscanf(text + 2 * k, "%2x", &byte) != 1) return false;
        key[k] = (uint8_t)byte;
    }
    return strspn(text + 2 * LACONIC_AES_BYTES, " \r\n") == length - 2 * LACONIC_AES_BYTES;
}

static void tell_of_codes(const laconic_gate *gate) {
    for (int k = 0; k < LACONIC_SECOC_STATUSES; k++)
        printf("%s: %u\n", laconic_secoc_text((laconic_secoc_status)k), (unsigned)gate->refused[k]);
    printf("without a code: %u\n", (unsigned)gate->bare);
}

/* The exit status, 0 where the key could be read. */
static int guard(board *port, const options *settings) {
    uint8_t key[LACONIC_AES_BYTES];
    port->guarded = settings->key != NULL;
    if (!port->guarded) return 0;
    if (!read_key(settings->key, key))
        return complain(settings->key, "holds no key; give a file with 32 hexadecimal digits");
    laconic_gate_init(&port->gate, (uint32_t)settings->id_base, key);
    return 0;
}

#ifdef __linux__
/* The exit status: an interface can be refused and can go, but it does not end by itself. */
static int serve_interface(board *of, const char *interface) {
    laconic_gate *gate = of->guarded ? &of->gate : NULL;
    socketcan_port port = {
        .node = &of->node, .integrity = &of->integrity, .gate = gate, .socket = socketcan_open(interface)};
    if (port.socket < 0) {
        fprintf(stderr, "laconic-node: --socketcan %s: cannot be opened: %s; see `ip link show type can`\n", interface,
                strerror(errno));
        return BAD_INPUT;
    }
    printf("serving %s\n", interface);
    fflush(stdout);
    socketcan_serve(&port, now_us);
    fprintf(stderr, "laconic-node: %s: %s\n", interface, strerror(errno));
    close(port.socket);
    return BUS_DIED;
}
#else
static int serve_interface(board *of, const char *interface) {
    (void)of;
    (void)interface;
    return complain("--socketcan", "only Linux has such interfaces; serve a port instead (--port)");
}
#endif

int main(int count, char **words) {
    static board port;
    static const laconic_integrity_limits any_finite_number = {0, 0, 0, 0};
    options settings = {.id_base = LACONIC_WIRE_ID_BASE};
    unsigned long chosen;
    if (asks_for_help(count, words)) return printf(help, (unsigned)LACONIC_WIRE_ID_BASE) < 0;
    int bad = parse(count, words, &settings);
    if (bad == 0) bad = guard(&port, &settings);
    if (bad != 0) return bad;
    const laconic_node_config config = {(uint16_t)settings.id_base, LACONIC_NODE_CAN_FD != 0, laconic_method_by_number,
                                        nonce_seed(), laconic_drive_protocol_by_number};
    if (!laconic_node_init(&port.node, &config, now_us()))
        return complain("--id-base", "give a multiple of 32 from 0 to 0x7E0");
    laconic_integrity_begin(&port.integrity, &port.node, &config, &any_finite_number, LACONIC_INTEGRITY_ALL);
    if (settings.interface != NULL) return serve_interface(&port, settings.interface);
    signal(SIGPIPE, SIG_IGN); /* a client that has gone is noticed by reading from it */
    const int listening = open_listener(settings.port, &chosen);
    if (listening < 0) return complain(strerror(errno), "the port is taken or not allowed; choose another --port");
    printf("listening on 127.0.0.1:%lu\n", chosen);
    fflush(stdout);
    serve(&port, listening, &settings);
    if (port.guarded) tell_of_codes(&port.gate);
    if (settings.shared) printf("clients %d, frames not taken %lu\n", port.clients, port.not_taken);
    close(listening);
    return 0;
}
