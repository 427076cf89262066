/* One client of the node's port: its connection, its SLCAN channel, and the bytes that wait for it. */
#ifndef LACONIC_HOST_STATION_H
#define LACONIC_HOST_STATION_H

#include "laconic_node/slcan.h"

#include <sys/types.h>

/* A client sends what a bus carries and no more, or a flood of its own would keep all others from the bus: 1 Mbit/s is
 * nine frames of 8 bytes a millisecond, of 22 letters each. The rest waits in its connection.
 * With several clients little waits for each, here and in the system's queue: frames for one that does not read
 * shall be lost, not old. */
enum {
    STATION_OUT_SIZE = 1 << 16,
    STATION_SHARED_ROOM = 1 << 12,
    STATION_LETTERS_PER_MS = 250,
    STATION_MOST_LETTERS = 4096
};

typedef struct station {
    int socket;  /* -1: there is no client                                              */
    bool is_rig; /* it gets the node's own frames, not only those of its drives */
    bool speaks; /* to the node itself                                         */
    laconic_slcan slcan;
    char out[STATION_OUT_SIZE];
    size_t out_count;
    size_t room;         /* of `out`, as long as the port is served              */
    size_t letters;      /* that it may send now, on a port with several clients */
    uint32_t letters_us; /* when they were counted                               */
} station;

/* Without client, its channel closed. `rate`: as laconic_slcan_init() takes it. */
void station_clear(station *it, char rate);
/* The connection of a waiting client; -1 where there is none, or its number is beyond what can be waited for. */
int station_connection(int listening);
/* Accepts a waiting client; nothing happens where there is none. */
void station_accept(station *it, int listening, char rate);

/* It may send more letters as time passes. */
void station_earn(station *it, uint32_t now_us);

/* Reads into `bytes`; the result of recv(). */
ssize_t station_read(const station *it, char *bytes, size_t size);
/* Whether one frame more has room among the bytes that wait. */
bool station_has_room(const station *it);
/* The frame waits to be sent. False iff there is no room: a client that does not read loses it, as on a full bus. */
bool station_write(station *it, const laconic_frame *frame);
/* The answer to a command of SLCAN waits to be sent. */
void station_reply(station *it);
/* Sends what the connection takes now. */
void station_flush(station *it);

#endif
